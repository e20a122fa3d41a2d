"""The plug-in, in runs of pytest of their own."""

import pytest

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
            "figures/figure-1: fail",
            "looks like black: *",
            "report: reports/figures/figure-1/index.html",
            "*no case matches*figure-9*did you mean*",
            "*test_marked?figures/figure-2?*",
        ]
    )
    assert (pytester.path / "reports/figures/figure-2/index.html").is_file()
    assert (pytester.path / "images/figures/figure-1.exr").is_file()


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


def test_the_page_of_a_mended_image_goes(pytester):
    for image, page in [("0 * right", True), ("right", False)]:
        pytester.makepyfile(
            f"""
            import volref

            def test_image(volref_check):
                right = volref.render("figure-1")
                volref_check("figure-1", {image}, explain=0)
            """
        )
        pytester.runpytest("--volref-report", "pages", "-p", "no:cacheprovider")
        assert (pytester.path / "pages/figures/figure-1/index.html").is_file() == page


def test_in_parallel(pytester):
    pytest.importorskip("xdist")
    pytester.makepyfile(TESTS)
    result = pytester.runpytest("-n", "2", "--volref-report", "reports")
    result.assert_outcomes(failed=4)


def test_a_mark_that_names_nothing(pytester):
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.volref("smok")
        def test_nothing(volref_case):
            pass
        """
    )
    result = pytester.runpytest()
    assert result.ret != 0
    result.stdout.fnmatch_lines(["*no case matches \"smok\"*did you mean \"smoke\"*"])


def test_no_option_writes_goldens(pytester):
    result = pytester.runpytest("--help")
    text = result.stdout.str()
    assert "--volref-report" in text and "--volref-outputs" in text
    assert "accept" not in text.split("images of volume renderers")[1].split("\n\n")[0]
