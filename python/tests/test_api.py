"""Arrays judged by the program."""

import os
import subprocess
import sys

import numpy as np
import pytest
import volref


@pytest.fixture(scope="session")
def figure():
    """The right image of figure 1, as volref renders it."""
    return volref.render("figures/figure-1")[:, :, :3]


def test_ten_lines_judge_three_arrays(figure):
    right = volref.check("figures/figure-1", figure)
    upside_down = volref.check("figures/figure-1", figure[::-1])
    half = volref.check("figures/figure-1", 0.5 * figure)
    assert right.passed and right
    assert not upside_down and upside_down.looks_like[0].name == "upside-down"
    assert half.verdict == "fail" and "× 0.5" in half.reason
    assert "looks like upside-down" in str(upside_down)


def test_types_and_orders_that_mean_the_same(figure):
    for same in [
        figure.astype(np.float64),
        np.asfortranarray(figure),
        np.dstack([figure, np.ones(figure.shape[:2], np.float32)]),
        figure.tolist(),
    ]:
        assert volref.check("figures/figure-1", np.asarray(same, dtype=float)).passed


def test_codes_are_srgb_at_the_exposure_of_the_case(figure):
    (case,) = volref.cases("figures/figure-1")
    linear = np.clip(figure * 2.0**case.exposure, 0, 1)
    codes = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    codes = np.round(255 * codes).astype(np.uint8)
    assert volref.check(case, codes).gate == "perceptual"
    assert volref.check(case, codes).passed
    assert not volref.check(case, codes[:, ::-1]).passed


def test_arrays_that_are_no_image(figure):
    for wrong, error, words in [
        (figure.astype(int), TypeError, "int64"),
        (figure.astype(complex), TypeError, "complex128"),
        (figure > 0, TypeError, "bool"),
        (figure[0, 0], ValueError, "shape"),
        (figure[:, :, :2], ValueError, "shape"),
        (np.zeros((0, 4, 3)), ValueError, "shape"),
        (figure[np.newaxis], ValueError, "shape"),
        (np.zeros((4, 4, 4), np.uint8), ValueError, "shape"),
    ]:
        with pytest.raises(error, match=words):
            volref.check("figures/figure-1", wrong)


def test_images_that_cannot_be_compared(figure):
    small = volref.check("figures/figure-1", figure[::2])
    assert small.verdict == "fail" and "render it at" in small.reason
    broken = figure.copy()
    broken[3, 5, 1] = np.nan
    nan = volref.check("figures/figure-1", broken)
    assert nan.verdict == "fail" and "(5, 3)" in nan.reason


def test_names_of_cases(figure):
    with pytest.raises(volref.UnknownCase, match="did you mean"):
        volref.check("figures/figure-11", figure)
    with pytest.raises(KeyError):
        volref.scene("nothing-like-it")
    with pytest.raises(volref.UnknownCase, match="5 cases"):
        volref.check("figures", figure)
    assert volref.check("figure-1", figure).name == "figures/figure-1"


def test_cases_and_scenes(tmp_path):
    cases = volref.cases("figures", "smoke")
    assert [case.name for case in cases][-1] == "smoke/cornell"
    assert len(volref.cases()) > 170
    scene = volref.scene("smoke/cornell")
    assert scene["film"]["width"] == 256 and scene["radiative"]["medium"]
    assert os.path.isabs(volref.scene("figure-3")["classified"]["volume"]["file"])
    with pytest.raises(volref.UnknownCase, match="did you mean"):
        volref.render("figures/figur-1")
    for format in ["mitsuba", "pbrt"]:
        assert volref.export("smoke/cornell", format, tmp_path / format).is_file()
    with pytest.raises(volref.VolrefError, match="bundle"):
        volref.export("smoke/cornell", "bundle", tmp_path)


def test_noise(tmp_path):
    name = "smoke/cornell"
    image = volref.render(name, spp=16, seed=5)
    assert volref.check(name, image).passed
    with pytest.raises(ValueError, match="negative"):
        volref.check(name, image, -np.ones_like(image), samples=16)
    with pytest.raises(ValueError, match="pixels"):
        volref.check(name, image, np.ones((4, 4, 3)), samples=16)
    with pytest.raises(ValueError, match="whole number"):
        volref.check(name, image, samples=0)
    with pytest.raises(ValueError, match="samples=N"):
        volref.check(name, image, np.ones_like(image))
    with pytest.raises(ValueError, match="range of 32-bit"):
        volref.check(name, image.astype(float) * 1e300)
    with pytest.raises(TypeError, match="masked"):
        volref.check(name, np.ma.masked_less(image, 0.5))
    replicates = [volref.render(name, spp=8, seed=seed) for seed in (1, 2)]
    variance = (replicates[0] - replicates[1]) ** 2 / 4
    assert volref.check(name, replicates, outputs=tmp_path).passed
    assert (tmp_path / "smoke" / "cornell.1.exr").is_file()
    mean = (replicates[0] + replicates[1]) / 2
    stated = volref.check(name, mean, variance, samples=16)
    assert stated.gate == "stochastic"
    assert not volref.check(name, 1.05 * mean, explain=0).passed


def test_steps_of_a_limit():
    steps = {1: "0.25 voxels", 0.5: "0.125 voxels", 0.25: "0.0625 voxels"}
    images = {factor: volref.render("limit/smooth-blob", step=step) for factor, step in steps.items()}
    result = volref.check("limit/smooth-blob", images)
    assert result.passed and result.gate == "refinement"
    for wrong in [{}, {1: images[1], 0.3: images[0.5]}, {0.5: images[0.5]}, {"1": images[1]}]:
        with pytest.raises(ValueError, match="factors on the step"):
            volref.check("limit/smooth-blob", wrong)


def test_images_compared_with_each_other(figure):
    assert volref.compare(figure, figure).passed
    other = volref.compare(figure, 1.1 * figure)
    assert not other and other.gate == "deterministic" and other.metrics["max_abs_error"] > 0
    assert volref.compare(figure, np.nextafter(figure, 2), gate="exact").verdict == "fail"
    assert volref.flip(figure, figure) == volref.Flip(0.0, 0.0)
    shifted = volref.flip(figure, np.roll(figure, 3, axis=1), exposure=1)
    assert 0 < shifted.mean < shifted.percentile < 1
    with pytest.raises(ValueError, match="size"):
        volref.flip(figure, figure[::2])


def test_a_result_can_be_looked_at(figure, tmp_path, monkeypatch):
    result = volref.check("figures/figure-1", figure[::-1], report=tmp_path)
    assert result.report.read_text(encoding="utf-8").startswith("<!")
    assert "<b>" not in result._repr_html_() and "upside-down" in result._repr_html_()
    later = figure[::-1].copy()
    kept = volref.check("figures/figure-1", later, explain=0)
    later[:] = figure
    assert "0 of 49152 pixels" not in kept.page() and "✗" in kept.page()
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    volref.check("figures/figure-1", figure[::-1], explain=0).show()
    assert opened and opened[0].startswith("file://")


def test_where_nothing_can_be_written(tmp_path):
    """The suite is unpacked where that is possible, and said not to be where it is not."""
    (tmp_path / "file").write_text("")
    code = "import volref; print(len(volref.cases('figures')))"

    def run(**variables):
        environment = {**os.environ, **{name: str(path) for name, path in variables.items()}}
        return subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)

    (tmp_path / "temporary").mkdir()
    nowhere = tmp_path / "file" / "cache"
    assert run(VOLREF_CACHE=nowhere, TMPDIR=tmp_path / "temporary").stdout == "5\n"
    code = "import volref; (case,) = volref.cases('figure-1'); case.scene(); print(volref.render(case).shape)"
    shown = run(VOLREF_CACHE=nowhere, TMPDIR=tmp_path / "temporary")
    assert shown.stdout == "(256, 256, 4)\n", shown.stderr
    assert not list((tmp_path / "temporary").iterdir())
    assert "VOLREF_CACHE=DIR" in run(VOLREF_CACHE=nowhere, TMPDIR=nowhere).stderr


def test_without_the_program(tmp_path):
    code = "import volref; volref.cases()"
    environment = {**os.environ, "VOLREF_PROGRAM": str(tmp_path / "absent")}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert "VOLREF_PROGRAM names" in run.stderr
