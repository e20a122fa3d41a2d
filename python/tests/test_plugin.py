"""The plug-in, in runs of pytest of their own."""

import re
from pathlib import Path

import pytest
import volref

TESTS = """
import numpy as np
import pytest
import volref

def blank(case):
    scene = case.scene()["film"]
    return np.zeros((scene["height"], scene["width"], 3), np.float32)

def test_blank(volref_check):
    (case,) = volref.cases("figures/figure-1")
    volref_check(case, blank(case))

@pytest.mark.volref("figures/figure-[12]")
def test_marked(volref_case, volref_check):
    volref_check(volref_case, blank(volref_case), explain=0)

def test_unknown(volref_check):
    volref_check("figures/figure-9", np.zeros((4, 4, 3)))
"""


def test_what_is_wrong_is_said(pytester):
    pytester.makepyfile(TESTS)
    result = pytester.runpytest("--volref-report", "reports", "--volref-outputs", "images")
    result.assert_outcomes(failed=4)
    result.stdout.fnmatch_lines_random(
        [
            "volref: *",
            "E *figures/figure-1: fail",
            "E *nothing was drawn: *",
            "E *report of all tests, once they have ended: */reports/index.html",
            "volref: report: */reports/index.html",
            ">*volref_check(case, blank(case))",
            "test_what_is_wrong_is_said.py:11: Failed",
            "*no case matches*figure-9*did you mean*",
            "*test_marked?figures/figure-2?*",
        ]
    )
    page = (pytester.path / "reports/index.html").read_text(encoding="utf-8")
    # One page: a case that two tests judged stands there with each.
    tests = ["test_blank", "test_marked[figures/figure-1]"]
    names = [f"figures/figure-1 (test_what_is_wrong_is_said.py::{test})".replace("/", "&#x2f;") for test in tests]
    assert all(name in page for name in names) and "figure-2 (" not in page
    # It names the images that are kept, and no folder that is gone.
    assert f"--outputs {pytester.path / 'images'}" in page and "volref-results-" not in page
    assert (pytester.path / "images/figures/figure-1.exr").is_file()
    assert "pytest_plugin.py" not in result.stdout.str()


def test_conventions_are_accepted_where_that_is_asked_for(pytester):
    pytester.makepyfile(
        """
        import pytest
        import volref

        @pytest.mark.parametrize("accept", [True, False])
        def test_linear(tmp_path, volref_check, accept):
            (case,) = volref.cases("sampled/thin")
            scene = case.scene_file.read_text().replace("../../", f"{case.scene_file.resolve().parents[2].as_posix()}/")
            (tmp_path / "other.toml").write_text(scene + '\\n[classified.conventions]\\nopacity = "linear"\\n')
            image = volref.render(tmp_path / "other.toml")[:, :, :3]
            assert volref_check(case, image, accept_conventions=accept)
        """
    )
    result = pytester.runpytest()
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["E *sampled/thin: convention*"])


def test_what_is_right_passes(pytester):
    pytester.makepyfile(
        """
        import pytest
        import volref

        @pytest.mark.volref("figures/figure-1", "figure-4")
        def test_itself(volref_case, volref_check):
            assert volref_check(volref_case, volref.render(volref_case)).passed

        def test_noise(volref_check):
            image = volref.render("smoke/cornell", spp=4)
            result = volref_check("smoke/cornell", image, allow_inconclusive=True)
            assert result.verdict in ("pass", "inconclusive")
        """
    )
    pytester.runpytest().assert_outcomes(passed=3)


def test_a_page_is_that_of_the_last_run(pytester):
    for image, verdict in [("0 * right", "fail"), ("right", "pass")]:
        pytester.makepyfile(
            f"""
            import volref

            def test_image(volref_check):
                right = volref.render("figure-1")
                volref_check("figure-1", {image}, explain=0)
            """
        )
        pytester.runpytest("--volref-report", "pages", "-p", "no:cacheprovider")
        page = (pytester.path / "pages/index.html").read_text(encoding="utf-8")
        assert re.findall(r'<li data-verdict="(\w+)"', page) == [verdict]
    pytester.makepyfile("def test_nothing(): pass")
    pytester.runpytest("--volref-report", "pages")
    assert not (pytester.path / "pages/index.html").exists()


SAME_CASE = """
import volref

def test_wrong(volref_check):
    volref_check("figure-1", 0 * volref.render("figure-1"), explain=0)

def test_right(volref_check):
    volref_check("figure-1", volref.render("figure-1"))
"""


@pytest.mark.parametrize("workers", [[], ["-n", "1"], ["-n", "2"]], ids=["alone", "one", "two"])
def test_one_page_shows_all_tests(pytester, workers):
    if workers:
        pytest.importorskip("xdist")
    pytester.makepyfile(SAME_CASE)
    for _ in range(2):
        result = pytester.runpytest(*workers, "--volref-report", "pages")
        result.assert_outcomes(failed=1, passed=1)
        line = next(line for line in result.outlines if line.startswith("volref: report: "))
        page = Path(line.split("report: ")[1])
        text = page.read_text(encoding="utf-8")
        assert page == pytester.path / "pages/index.html" and "::test_wrong)" in text and "::test_right)" in text
        assert [file.name for file in page.parent.iterdir()] == ["index.html"]


def test_listing_tests_leaves_pages(pytester):
    page = pytester.path / "pages/index.html"
    page.parent.mkdir()
    page.write_text("earlier")
    pytester.makepyfile(SAME_CASE)
    pytester.runpytest("--collect-only", "--volref-report", "pages")
    assert page.read_text() == "earlier"


def test_pages_of_tests_that_change_the_folder(pytester):
    pytester.makepyfile(
        """
        import volref

        def test_image(volref_check, tmp_path, monkeypatch):
            monkeypatch.chdir(tmp_path)
            volref_check("figure-1", 0 * volref.render("figure-1"), explain=0)
        """
    )
    pytester.runpytest("--volref-report", "pages").assert_outcomes(failed=1)
    assert (pytester.path / "pages/index.html").is_file()


def test_in_parallel(pytester):
    pytest.importorskip("xdist")
    pytester.makepyfile(TESTS)
    result = pytester.runpytest("-n", "2", "--volref-report", "reports")
    result.assert_outcomes(failed=4)


@pytest.mark.parametrize("workers", [[], ["-n", "4"]], ids=["alone", "four"])
def test_tests_of_one_case_are_judged_by_their_own_image(pytester, workers):
    if workers:
        pytest.importorskip("xdist")
    pytester.makepyfile(
        """
        import pytest
        import volref

        @pytest.mark.parametrize("factor", [1, 0] * 12)
        def test_image(volref_check, factor):
            volref_check("figure-1", factor * volref.render("figure-1"), explain=0)
        """
    )
    result = pytester.runpytest(*workers, "--volref-outputs", "images", "-rfp")
    result.assert_outcomes(passed=12, failed=12)
    for outcome, factor in [("PASSED", 1), ("FAILED", 0)]:
        lines = [line for line in result.outlines if line.startswith(f"{outcome} ")]
        assert len(lines) == 12 and all(f"test_image[{factor}" in line for line in lines)
    assert [path.name for path in (pytester.path / "images").rglob("*")] == ["figures", "figure-1.exr"]


def test_no_page_is_written_beyond_a_link(pytester):
    home = pytester.mkdir("home")
    (home / "index.html").write_text("mine")
    pages = pytester.mkdir("pages")
    (pages / "index.html").symlink_to(home / "index.html")
    pytester.makepyfile(SAME_CASE)
    pytester.runpytest("--volref-report", "pages").assert_outcomes(failed=1, passed=1)
    assert (home / "index.html").read_text() == "mine" and not (pages / "index.html").is_symlink()


def test_images_are_not_kept_in_a_suite(pytester):
    for folder in ["golden", "fixtures/cases"]:
        (pytester.path / folder).mkdir(parents=True)
    pytester.makepyfile(SAME_CASE)
    result = pytester.runpytest("--volref-outputs", "images")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    (line,) = [line for line in result.errlines if line]
    assert line.startswith("ERROR: --volref-outputs: ") and "is in a suite" in line
    assert not (pytester.path / "images").exists()


def test_nothing_is_written_beside_goldens(pytester):
    golden = pytester.path / "baseline/figures/figure-1.toml"
    golden.parent.mkdir(parents=True)
    golden.write_text('schema = "volref/golden/1"\n')
    pytester.makepyfile(SAME_CASE)
    for option in ["--volref-report", "--volref-outputs"]:
        result = pytester.runpytest(option, "baseline")
        assert result.ret == pytest.ExitCode.USAGE_ERROR
        (line,) = [line for line in result.errlines if line]
        assert line.startswith(f"ERROR: {option}: ") and "holds goldens" in line
    assert [file.name for file in golden.parent.iterdir()] == ["figure-1.toml"]


MARKS = [
    ('@pytest.mark.volref("smok")', "volref_case", 'no case matches "smok"*did you mean "smoke"*'),
    ("@pytest.mark.volref(3)", "volref_case", "a filter is text, not of type int"),
    ('@pytest.mark.volref(case="smoke")', "volref_case", "the mark volref takes filters alone, as texts"),
    ('@pytest.mark.volref("figures")', "volref_check", "*the test does not take the argument volref_case"),
]


@pytest.mark.parametrize("mark, argument, words", MARKS, ids=["unknown", "number", "keyword", "no-argument"])
@pytest.mark.parametrize("workers", [[], ["-n", "1"]], ids=["alone", "parallel"])
def test_a_wrong_mark_is_one_line(pytester, workers, mark, argument, words):
    if workers:
        pytest.importorskip("xdist")
    pytester.makepyfile(f"import pytest\n\n{mark}\ndef test_nothing({argument}):\n    pass\n")
    result = pytester.runpytest(*workers)
    assert result.ret != 0
    result.stdout.fnmatch_lines([f"test_a_wrong_mark_is_one_line.py::test_nothing: {words}"])
    assert "Traceback" not in result.stdout.str() and "/pluggy/" not in result.stdout.str()
    assert "passed" not in result.stdout.str()


@pytest.mark.parametrize("mark", ["", "@pytest.mark.volref", "@pytest.mark.volref()"])
def test_no_filter_is_every_case(pytester, mark):
    pytester.makepyfile(f"import pytest\n\n{mark}\ndef test_all(volref_case):\n    pass\n")
    outcomes = pytester.runpytest().parseoutcomes()
    assert outcomes == {"passed": len(volref.cases())}


@pytest.mark.parametrize("option", ["--volref-suite", "--volref-report", "--volref-outputs"])
def test_a_wrong_folder_is_one_line(pytester, option):
    pytester.makepyfile(SAME_CASE)
    (pytester.path / "file").write_text("")
    result = pytester.runpytest(option, "file/folder")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    (line,) = [line for line in result.errlines if line]
    assert line.startswith(f"ERROR: {option}") and "file/folder" in line


def test_without_the_program_a_line_says_so(pytester, monkeypatch):
    monkeypatch.setenv("VOLREF_PROGRAM", "absent")
    pytester.makepyfile(
        test_one="def test_one(volref_case): pass",
        test_two="def test_two(volref_check): volref_check('figure-1', [[[0.0] * 3]])",
    )
    result = pytester.runpytest_subprocess("--continue-on-collection-errors")
    result.assert_outcomes(errors=1, failed=1)
    result.stdout.fnmatch_lines(
        ["test_one.py::test_one: VOLREF_PROGRAM names absent*", "E *VOLREF_PROGRAM names absent*", "test_two.py:1: *"]
    )
    assert "Traceback" not in result.stdout.str() and "subprocess" not in result.stdout.str()


def test_lines_of_volref_are_not_shown(pytester):
    pytester.makepyfile(
        """
        import numpy as np
        import volref

        def test_check():
            volref.check("figure-1", np.zeros((4, 4)) > 0)

        def test_fixture(volref_check):
            volref_check("figure-1", np.zeros((4, 4, 2)))

        def test_unknown():
            volref.render("figure-11")

        def test_folder():
            volref.check("figure-1", np.zeros((4, 4)), outputs=__file__)
        """
    )
    result = pytester.runpytest("--tb=short")
    result.assert_outcomes(failed=4)
    text = result.stdout.str()
    assert not any(file in text for file in ["_api.py", "_files.py", "_program.py", "pytest_plugin.py"])
    result.stdout.fnmatch_lines(
        [
            "E *TypeError: the image has the type bool*",
            "E *ValueError: the image has the shape (4, 4, 2)*",
            "E *volref.UnknownCase: no case matches*",
            "E *volref.VolrefError: cannot write the image into *",
        ]
    )


def test_an_assertion_shows_the_mistake(pytester):
    pytester.makepyfile(
        """
        import volref

        def test_image():
            assert volref.check("figure-1", 0.5 * volref.render("figure-1"))
        """
    )
    result = pytester.runpytest()
    start = "Result(name='figures/figure-1', verdict='fail', looks_like=['bright-halved'"
    result.stdout.fnmatch_lines([f"E *assert {start}*"])


def test_an_undecided_image_says_what_to_do(pytester):
    pytester.makepyfile(
        """
        import volref

        def test_image(volref_check):
            volref_check("fog/backward", volref.render("fog/backward", spp=2))
        """
    )
    result = pytester.runpytest()
    result.stdout.fnmatch_lines(["E *fog/backward: inconclusive", "E *samples=N*list*allow_inconclusive=True*"])


def test_fixtures_are_described(pytester):
    text = pytester.runpytest("--fixtures").stdout.str()
    _, *parts = re.split("^volref_", text, flags=re.MULTILINE)
    described = {part.split(" ")[0]: part for part in parts}
    assert "volref.Case" in described["case"]
    assert all(word in described["check"] for word in ["variance", "samples", "allow_inconclusive"])


def test_no_option_writes_goldens(pytester):
    result = pytester.runpytest("--help")
    text = result.stdout.str()
    assert "--volref-report" in text and "--volref-outputs" in text
    assert "accept" not in text.split("images of volume renderers")[1].split("\n\n")[0]


def test_a_known_failure_is_expected_until_it_is_mended(pytester):
    pytester.makepyfile(
        """
        import pytest
        import volref

        @pytest.mark.parametrize("factor", [0, 1])
        def test_image(volref_check, factor):
            volref_check("figure-1", factor * volref.render("figure-1")[:, :, :3], explain=0)

        def test_another(volref_check):
            volref_check("figure-2", 0 * volref.render("figure-2")[:, :, :3], explain=0)
        """
    )
    (pytester.path / "known.toml").write_text('["figures/figure-1"]\nreason = "no light yet"\nlink = "#7"\n')
    result = pytester.runpytest("-rx", "--volref-known", "known.toml")
    result.assert_outcomes(xfailed=1, failed=2)
    result.stdout.fnmatch_lines_random(
        ["*no light yet (#7)*", "E *mended: *known.toml:1: figures/figure-1 passes: remove the entry*"]
    )
    pytester.makeini("[pytest]\nvolref_known = known.toml\n")
    pytester.runpytest().assert_outcomes(xfailed=1, failed=2)
    (pytester.path / "known.toml").write_text('["figures/figure-11"]\nreason = "r"\n')
    result = pytester.runpytest()
    result.assert_outcomes(failed=3)
    result.stdout.fnmatch_lines(["*no case matches*figure-11*did you mean*"])
