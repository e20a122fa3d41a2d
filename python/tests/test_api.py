"""Arrays judged by the program."""

import dataclasses
import html
import os
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import volref
from volref._files import exr
from volref._kept import case_of


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


def test_conventions_are_accepted_where_that_is_asked_for(tmp_path):
    image = under_other_conventions(tmp_path, "sampled/thin")
    found = volref.check("sampled/thin", image)
    assert found.verdict == "convention" and not found.passed and not found
    accepted = volref.check("sampled/thin", image, accept_conventions=True)
    assert accepted.verdict == "convention" and accepted.passed and accepted
    mirrored = volref.check("sampled/thin", image[::-1], accept_conventions=True)
    assert mirrored.verdict == "fail" and not mirrored


def under_other_conventions(folder, name):
    """The image of a case whose opacities are in proportion to the step."""
    (case,) = volref.cases(name)
    fixtures = case.scene_file.resolve().parents[2]
    scene = case.scene_file.read_text().replace("../../", f"{fixtures.as_posix()}/")
    (folder / "other.toml").write_text(f'{scene}\n[classified.conventions]\nopacity = "linear"\n')
    return volref.render(folder / "other.toml")[:, :, :3]


class Tensor:
    """An array of another library."""

    def __init__(self, array):
        self.array = array

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.array, dtype=dtype)


def halves(*shape):
    """Numbers that every floating point type holds."""
    return np.random.default_rng(7).integers(1, 2048, shape).astype(np.float16) / 1024


def colours(image):
    """The image as (height, width, 3 or 4), with all that it means."""
    image = np.asarray(image, np.float32)
    image = image[:, :, np.newaxis] if image.ndim == 2 else image
    return np.repeat(image, 3, axis=2) if image.shape[2] == 1 else image


TAKEN = [halves(5, 4), halves(5, 4, 1), halves(5, 4, 3), halves(5, 4, 4), halves(3, 4, 4), halves(1, 1)]
TAKEN += [halves(4, 1, 1)]
TAKEN += [halves(5, 4, 3).astype(kind) for kind in ["<f2", ">f2", "<f4", ">f4", "<f8", ">f8"]]
TAKEN += [np.asfortranarray(halves(5, 4, count)) for count in (1, 3, 4)]
TAKEN += [halves(10, 8, 6)[::2, ::-2, ::2], np.broadcast_to(halves(5, 1, 1), (5, 4, 3)), halves(4, 5).T]
REFUSED = [halves(5, 4, count) for count in (0, 2, 5)]
REFUSED += [halves(3, 5, 6), halves(1, 5, 4, 3), halves(5, 5, 4, 3), halves(5), halves(), halves(0, 4, 3), halves(0, 4)]
REFUSED += [halves(5, 4, 3).astype(kind) for kind in [bool, "i1", "u2", "i4", "i8", "c8", "c16", "O", "U4"]]
REFUSED += [np.zeros((5, 4, 3), np.longdouble)] if np.dtype(np.longdouble).itemsize > 8 else []
REFUSED += [np.zeros((5, 4), [("R", "f4"), ("G", "f4"), ("B", "f4")])]


@pytest.mark.parametrize("array", TAKEN + REFUSED, ids=lambda array: f"{array.dtype}-{array.shape}")
def test_arrays_and_npy_files_are_taken_alike(array, tmp_path):
    is_taken = any(array is other for other in TAKEN)
    right = colours(array) if is_taken else halves(5, 4, 3).astype(np.float32)
    np.save(tmp_path / "right.npy", right)
    np.save(tmp_path / "image.npy", array)
    command = [volref.program(), "compare", tmp_path / "right.npy", tmp_path / "image.npy", "--gate=exact"]
    ran = subprocess.run(command, capture_output=True, text=True)
    assert ran.returncode == (0 if is_taken else 4), ran
    for given in [array, Tensor(array)]:
        if is_taken:
            assert volref.compare(right, given, gate="exact").passed
        else:
            with pytest.raises((TypeError, ValueError), match="the image has the (type|shape)"):
                volref.compare(right, given, gate="exact")


def test_codes_are_srgb_at_the_exposure_of_the_case(figure):
    (case,) = volref.cases("figures/figure-1")
    linear = np.clip(figure * 2.0**case.exposure, 0, 1)
    codes = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    codes = np.round(255 * codes).astype(np.uint8)
    assert volref.check(case, codes).gate == "perceptual"
    assert volref.check(case, codes).passed
    assert not volref.check(case, codes[:, ::-1]).passed
    # As radiance of 8 bits, sRGB or linear.
    for bits, given in [(8, codes), ("8-srgb", codes), ("8-linear", np.round(255 * linear).astype(np.uint8))]:
        result = volref.check(case, given, bits=bits)
        assert result.passed and result.gate == "deterministic"
    assert not volref.check(case, codes, bits="8-linear", explain=0).passed
    grey = volref.compare(codes[:, :, 0], codes[:, :, :1], gate="perceptual")
    assert grey.passed and grey.metrics["flip_mean"] == 0


def test_arrays_that_are_no_image(figure):
    for wrong, error, words in [
        (figure.astype(int), TypeError, "int64"),
        (figure.astype(complex), TypeError, "complex128"),
        (figure > 0, TypeError, "bool"),
        (figure[0, 0], ValueError, "shape"),
        (figure[:, :, :2], ValueError, "shape"),
        (np.zeros((0, 4, 3)), ValueError, "shape"),
        (figure[np.newaxis], ValueError, r"shape.*array\[0\]"),
        (np.stack([figure] * 5), ValueError, r"shape.*5 renderings.*list\(array\)"),
        (np.moveaxis(figure, 2, 0), ValueError, r"shape.*np\.moveaxis\(array, 0, -1\)"),
        ([], ValueError, "the list of images is empty"),
        (None, TypeError, "the image is None"),
        ("image.exr", TypeError, "the image is text"),
        (np.zeros((4, 4, 4), np.uint8), ValueError, "shape"),
    ]:
        with pytest.raises(error, match=words):
            volref.check("figures/figure-1", wrong)


def test_opacity_is_compared_where_it_says_something():
    case = "scenes/opacity-over-grey"
    right = volref.render(case)
    colours, opacity = right[:, :, :3], right[:, :, 3]
    assert volref.check(case, right).passed
    assert volref.check(case, colours).passed
    opaque = volref.check(case, np.dstack([colours, np.ones_like(opacity)]))
    assert not opaque.passed and opaque.looks_like[0].name == "opaque-background"
    assert not volref.check(case, np.dstack([colours, np.full_like(opacity, np.nan)]), explain=0).passed
    # Colours without the background, 0.1 everywhere.
    alone = colours - 0.1 * (1 - opacity)[:, :, np.newaxis]
    assert not volref.check(case, np.dstack([alone, opacity]), explain=0).passed
    assert volref.check(case, np.dstack([alone, opacity]), alpha="premultiplied").passed
    with np.errstate(invalid="ignore", divide="ignore"):
        straight = np.nan_to_num(alone / opacity[:, :, np.newaxis], posinf=0, neginf=0)
    assert volref.check(case, np.dstack([straight, opacity]), alpha="straight").passed
    # In a case that does not ask for opacity, 1 everywhere is what programs write for a display.
    figure = volref.render("figures/figure-3")
    assert volref.check("figures/figure-3", np.dstack([figure[:, :, :3], np.ones(figure.shape[:2], np.float32)])).passed
    assert volref.compare(figure, figure).passed
    assert not volref.compare(figure, np.dstack([figure[:, :, :3], 0.5 * figure[:, :, 3]])).passed


def test_depth_is_compared_where_it_is_asked_for():
    right = volref.render("scenes/mean-depth")
    depth = volref.render("scenes/mean-depth", depth="mean")
    assert depth.shape == right.shape[:2] and np.isinf(depth).any() and np.isfinite(depth).any()
    assert volref.check("scenes/mean-depth", right, depth=depth).passed
    found = volref.check("scenes/mean-depth", right, depth=volref.render("scenes/mean-depth", depth="half"), explain=0)
    assert not found.passed and "depth" in found.reason
    with pytest.raises(ValueError, match="shape"):
        volref.check("scenes/mean-depth", right, depth=right)


def test_the_image_before_the_case(figure):
    with pytest.raises(TypeError, match=r"^the case comes first, then the image: check\(name, image\)$"):
        volref.check(figure, "figures/figure-1")
    with pytest.raises(TypeError, match="not of type ndarray$"):
        volref.cases(figure)


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
    with pytest.raises(volref.UnknownCase, match="'figures' names 5 cases"):
        volref.render("figures")
    for wrong in ["", "-x", "--help", "--suite"]:
        for function in [volref.cases, volref.scene, volref.render]:
            with pytest.raises(volref.UnknownCase, match=r"no case matches.*volref\.cases\(\) lists all cases"):
                function(wrong)
    with pytest.raises(volref.UnknownCase, match=r"volref\.cases\(\) lists all cases"):
        volref.cases("nothing-like-it")


def test_a_scene_file_is_rendered(tmp_path, monkeypatch):
    (case,) = volref.cases("smoke/cornell")
    with pytest.raises(volref.VolrefError, match="absent.toml: cannot read the scene"):
        volref.render(tmp_path / "absent.toml")
    right = volref.render(case, spp=1)
    assert np.array_equal(volref.render(case.scene_file, spp=1), right)
    monkeypatch.chdir(case.scene_file.parent)
    assert np.array_equal(volref.render(case.scene_file.name, spp=1), right)


def test_arguments_out_of_range(figure, tmp_path):
    name = "smoke/cornell"
    for call, error, words in [
        (lambda: volref.render(name, spp=0), ValueError, "spp is 0: give a whole number from 1 to"),
        (lambda: volref.render(name, spp=1.5), ValueError, "spp is 1.5: give a whole number"),
        (lambda: volref.render(name, seed=-1), ValueError, "seed is -1: give a whole number from 0 to"),
        (lambda: volref.render("figure-3", step="x"), volref.VolrefError, "^step is 'x': expected a positive length"),
        (lambda: volref.render(3), TypeError, "not of type int"),
        (lambda: volref.check("figure-1", figure, explain=-1), ValueError, "explain is -1: give a number of sec"),
        (lambda: volref.check("figure-1", figure, explain="x"), TypeError, "explain is 'x', of type str"),
        (lambda: volref.check("figure-1", figure, explain=10**400), ValueError, "explain is 10+… .401 characters.: give"),
        (lambda: volref.check("figure-1", figure, explain=10**5000), ValueError, "explain is a number of thousands of"),
        (lambda: volref.check("figure-1", figure, explain=2e9), ValueError, "seconds up to 1e9"),
        (lambda: volref.render(name, spp=10**5000), ValueError, "spp is a number of thousands of digits: give a whole"),
        (lambda: volref.compare(figure, figure, exposure=-(10**400)), ValueError, "exposure is -10+… "),
        (lambda: volref.check("figure-1", figure, profile="-x"), volref.VolrefError, "^-x: cannot read the profile"),
        (lambda: volref.check("figure-1", {1: figure, 0.5: figure}), ValueError, "figures/figure-1 takes one image"),
        (lambda: volref.export(name, "mitsubs", tmp_path), ValueError, "mitsuba, pbrt, bundle .did you mean 'mitsuba'"),
        (lambda: volref.compare(figure, figure, gate="exct"), ValueError, "did you mean 'exact'"),
        (lambda: volref.compare(figure, figure, exposure=99), ValueError, "stops from -64 to 64"),
        (lambda: volref.compare(figure, figure, resolution=-1), volref.VolrefError, "^resolution is '-1': .* 100$"),
        (lambda: volref.cases(suite=tmp_path), volref.VolrefError, "contains no suite"),
    ]:
        with pytest.raises(error, match=words) as raised:
            call()
        assert "--" not in str(raised.value)


def test_folders_that_cannot_be_written(figure, tmp_path):
    (tmp_path / "file").write_text("")
    for folder in ["outputs", "report"]:
        with pytest.raises(volref.VolrefError, match="file/folder|file.folder"):
            volref.check("figure-1", figure, **{folder: tmp_path / "file" / "folder"})


@pytest.fixture
def suite(tmp_path):
    """A suite of two cases, one with a name that begins with the other's and looks like its replicate."""
    (own,) = volref.cases("figures/figure-1")
    root = own.scene_file.parents[3]
    for name in ["plots/rate-0", "plots/rate-0.1"]:
        for folder, source in [("scenes", own.scene_file), ("cases", root / "fixtures/cases/figures/figure-1.toml")]:
            copy = tmp_path / "suite/fixtures" / folder / f"{name}.toml"
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, copy)
    (tmp_path / "suite/golden").mkdir()
    return tmp_path / "suite"


def kept(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


#: Images of the case plots/rate-0, and other files.
OLD = ["rate-0.exr", "rate-0.PFM", "rate-0.npy", "rate-0.png", "rate-0.0.exr", "rate-0.12.npy", "rate-0@0.5.exr"]
OLD += ["rate-0@0.25.pfm", "rate-0@5e-1.exr", "rate-0.variance.exr"]
OTHERS = ["rate-0.1.exr", "rate-0.1.2.exr", "rate-0.1@0.5.exr", "rate-0.toml", "rate-0.txt", "rate-0.notes.png"]
OTHERS += ["rate-0.variance.png", "rate-0@0.3.exr", "rate-0@half.exr", "rate-0", ".rate-0.exr", "rate-00.exr"]
OTHERS += ["rate-0.0.exr.bak", "rate-0.-1.exr", "rate-0.99999999999.exr", "rate-0.exr.sha256", "rate-0@5e-1_0.exr"]


@pytest.mark.parametrize("name", OLD + OTHERS)
def test_the_program_takes_the_same_files(name, suite, tmp_path):
    file = tmp_path / "images/plots" / name
    file.parent.mkdir(parents=True)
    file.write_text(name)
    filters = ["plots/rate-0", f"--outputs={tmp_path / 'images'}", f"--suite={suite}", "--only-present"]
    ran = subprocess.run([volref.program(), "validate", *filters], capture_output=True, text=True)
    is_compared = "nothing was compared" not in ran.stderr
    assert is_compared == (name in OLD), ran
    cases = {"plots/rate-0", "plots/rate-0.1"}
    assert (case_of(f"plots/{name}", cases) == "plots/rate-0") == (name in OLD)


def test_only_images_of_the_case_are_replaced(figure, suite, tmp_path):
    folder = tmp_path / "images"
    (folder / "plots" / "rate-0.7.exr").mkdir(parents=True)
    for name in OLD + OTHERS:
        (folder / "plots" / name).write_text(name)
    (folder / "rate-0.exr").write_text("at the top")
    outside = tmp_path / "outside.exr"
    outside.write_text("outside")
    (folder / "plots" / "rate-0.5.exr").symlink_to(outside)
    with pytest.raises(ValueError, match="shape"):
        volref.check("plots/rate-0", figure[:, :, :2], suite=suite, outputs=folder)
    assert (folder / "plots/rate-0.npy").is_file()
    volref.check("plots/rate-0", figure, suite=suite, outputs=folder)
    assert kept(folder) == sorted(["rate-0.exr", "plots/rate-0.exr", *(f"plots/{name}" for name in OTHERS)])
    assert all((folder / "plots" / name).read_text() == name for name in OTHERS)
    assert (folder / "plots/rate-0.exr").stat().st_size > figure.nbytes
    assert outside.read_text() == "outside" and not (folder / "plots/rate-0.5.exr").is_symlink()
    (folder / "plots/rate-0.exr").unlink()
    (folder / "plots/rate-0.exr").symlink_to(outside)
    volref.check("plots/rate-0", figure, suite=suite, outputs=folder)
    assert outside.read_text() == "outside" and not (folder / "plots/rate-0.exr").is_symlink()


def test_nothing_is_kept_in_a_suite_or_beyond_a_link(figure, suite, tmp_path):
    golden = tmp_path / "elsewhere/golden"
    (golden / "plots").mkdir(parents=True)
    for file in [suite / "golden/plots/rate-0.exr", golden / "plots/rate-0.exr", tmp_path / "home/rate-0.exr"]:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("mine")
    (golden / "plots/rate-0.toml").write_text('schema = "volref/golden/2"\n')
    (tmp_path / "link").symlink_to(suite)
    (tmp_path / "images").mkdir()
    (tmp_path / "images/plots").symlink_to(tmp_path / "home")
    before = kept(tmp_path)
    inside = [suite, suite / "golden", suite / "golden/new", suite / "fixtures/scenes", suite / "images"]
    for folder in [*inside, tmp_path / "link", golden, golden / "new"]:
        with pytest.raises(volref.VolrefError, match="is in a suite|holds goldens"):
            volref.check("plots/rate-0", figure, suite=suite, outputs=folder)
    with pytest.raises(volref.VolrefError, match="images.plots leads to another folder by a link"):
        volref.check("plots/rate-0", figure, suite=suite, outputs=tmp_path / "images")
    assert kept(tmp_path) == before
    # Goldens of no suite, in a folder of any name.
    shutil.copytree(golden, tmp_path / "baseline")
    for folder in ["baseline", "baseline/plots"]:
        with pytest.raises(volref.VolrefError, match="baseline.* holds goldens, such as rate-0.toml"):
            volref.check("plots/rate-0", figure, suite=suite, outputs=tmp_path / folder)
    assert (tmp_path / "baseline/plots/rate-0.exr").read_text() == "mine"
    # A name alone makes no golden.
    (tmp_path / "people/golden/images").mkdir(parents=True)
    volref.check("plots/rate-0", figure, suite=suite, outputs=tmp_path / "people/golden/images")
    # A folder that is meant may be a link.
    (tmp_path / "mine").mkdir()
    (tmp_path / "meant").symlink_to(tmp_path / "mine")
    volref.check("plots/rate-0", figure, suite=suite, outputs=tmp_path / "meant")
    assert kept(tmp_path / "mine") == ["plots/rate-0.exr"]


def test_images_of_one_case_from_several_threads(figure, tmp_path):
    """Each is judged by itself, and those that are kept last are of one call."""

    def images(index):
        factor, count = (1, 1) if index % 2 == 0 else (1.5, 1 + index % 3)
        return [figure * np.float32(factor + 1e-5 * (3 * index + number)) for number in range(count)]

    def is_judged_rightly(index):
        result = volref.check("figures/figure-1", images(index), explain=0, outputs=tmp_path)
        return result.verdict == ("pass" if index % 2 == 0 else "fail")

    with ThreadPoolExecutor(8) as threads:
        assert all(threads.map(is_judged_rightly, range(24)))
    names = kept(tmp_path)
    assert names == [f"figures/figure-1.{number}.exr" for number in range(len(names))]
    contents = [(tmp_path / name).read_bytes() for name in names]
    assert contents in [[exr(dict(zip("RGB", np.moveaxis(image, 2, 0)))) for image in images(i)] for i in range(24)]


def test_a_page_names_the_folder_of_the_images(figure, tmp_path):
    folder = tmp_path / "my images"
    page = volref.check("figure-1", 0 * figure, explain=0, report=tmp_path / "page", outputs=folder).report
    text = html.unescape(page.read_text(encoding="utf-8"))
    assert f"'{folder}'" in text and f"{tempfile.gettempdir()}/volref-" not in text


def test_exceptions_have_the_name_that_users_import():
    for error in [volref.VolrefError, volref.UnknownCase]:
        assert f"{error.__module__}.{error.__name__}" in ["volref.VolrefError", "volref.UnknownCase"]


def test_cases_and_scenes(tmp_path):
    cases = volref.cases("figures", "smoke")
    assert [case.name for case in cases][-1] == "smoke/cornell"
    assert len(volref.cases()) > 170
    scene = volref.scene("smoke/cornell")
    assert scene["film"]["width"] == 256 and scene["radiative"]["medium"]
    assert os.path.isabs(volref.scene("figure-3")["classified"]["volume"]["file"])
    with pytest.raises(volref.UnknownCase, match="did you mean"):
        volref.render("figures/figur-1")
    for format in ["mitsuba", "pbrt", "bundle"]:
        assert volref.export("smoke/cornell", format, tmp_path / format).is_file()
    with pytest.raises(volref.VolrefError, match="bundle"):
        volref.export("figure-1", "mitsuba", tmp_path)


def test_noise(tmp_path):
    name = "smoke/cornell"
    image = volref.render(name, spp=16, seed=5)
    assert volref.check(name, image).passed
    with pytest.raises(ValueError, match="negative"):
        volref.check(name, image, -np.ones_like(image), samples=16)
    with pytest.raises(ValueError, match="pixels"):
        volref.check(name, image, np.ones((4, 4, 3)), samples=16)
    for samples, error in [(0, ValueError), (1, ValueError), (1.5, ValueError), (2**32 - 1, ValueError)]:
        with pytest.raises(error, match="whole number from 2 to 4294967294"):
            volref.check(name, image, samples=samples)
    for samples, kind in [(True, "bool"), ("16", "str"), ([16], "list")]:
        with pytest.raises(TypeError, match=f"of type {kind}: give a whole number"):
            volref.check(name, image, samples=samples)
    for variance in [np.zeros_like(image), np.where(image > 1.5, 1.0, 0.0)]:
        with pytest.raises(ValueError, match="a variance of 0 says that the image has no noise"):
            volref.check(name, image, variance, samples=16)
    with pytest.raises(ValueError, match="samples=N"):
        volref.check(name, image, np.ones_like(image))
    with pytest.raises(ValueError, match="range of 32-bit"):
        volref.check(name, image.astype(float) * 1e300)
    with pytest.raises(TypeError, match="masked"):
        volref.check(name, np.ma.masked_less(image, 0.5))
    replicates = [volref.render(name, spp=8, seed=seed) for seed in (1, 2)]
    variance = (replicates[0] - replicates[1]) ** 2 / 4
    assert volref.check(name, iter(replicates), outputs=tmp_path).passed
    assert (tmp_path / "smoke" / "cornell.1.exr").is_file()
    mean = (replicates[0] + replicates[1]) / 2
    stated = volref.check(name, mean, variance, samples=16)
    assert stated.gate == "stochastic"
    # The largest count is not rounded to one that no file can hold.
    assert volref.check(name, mean, variance, samples=2**32 - 2).verdict in ["pass", "inconclusive"]
    assert not volref.check(name, 1.05 * mean, explain=0).passed


def test_a_furnace_has_no_noise():
    image = volref.render("known-answers/furnace-box", spp=2)
    assert volref.check("known-answers/furnace-box", image, np.zeros_like(image), samples=2).passed


def test_steps_of_a_limit():
    steps = {1: "0.25 voxels", 0.5: "0.125 voxels", 0.25: "0.0625 voxels"}
    images = {factor: volref.render("limit/smooth-blob", step=step) for factor, step in steps.items()}
    result = volref.check("limit/smooth-blob", images)
    assert result.passed and result.gate == "refinement"
    for wrong in [{}, {1: images[1], 0.3: images[0.5]}, {0.5: images[0.5]}, {"1": images[1]}]:
        with pytest.raises(ValueError, match="factors on the step"):
            volref.check("limit/smooth-blob", wrong)
    # Steps so long that their images differ by more than rounding.
    listed = [volref.render("limit/smooth-blob", step=f"{voxels} voxels") for voxels in (2, 1, 0.5)]
    listed = volref.check("limit/smooth-blob", listed, explain=0)
    assert not listed and "{1: a, 0.5: b, 0.25: c}" in listed.reason


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
    assert repr(result).startswith("Result(name='figures/figure-1', verdict='fail', looks_like=['upside-down'")
    assert len(repr(result)) <= 240 and "max_abs_error" not in repr(result)
    assert str(result).startswith("figures/figure-1: fail, looks like upside-down\n")
    assert len({result, dataclasses.replace(result)}) == 1
    later = figure[::-1].copy()
    kept = volref.check("figures/figure-1", later, explain=0)
    later[:] = figure
    assert "0 of 49152 pixels" not in kept.page() and "✗" in kept.page()
    # Folders for temporary files are gone when somebody reads the page.
    for page in [kept.page(), result.page(), result.report.read_text(encoding="utf-8")]:
        assert "--outputs=IMAGES" in page.replace("&#x3d;", "=") or "--outputs IMAGES" in page
        assert tempfile.gettempdir().replace("/", "&#x2f;") + "&#x2f;volref-" not in page
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
    assert [kept.name for kept in (tmp_path / "temporary").iterdir()] == ["volref"]
    assert "VOLREF_CACHE=DIR" in run(VOLREF_CACHE=nowhere, TMPDIR=nowhere).stderr


def test_without_the_program(tmp_path):
    code = "import volref; volref.cases()"
    environment = {**os.environ, "VOLREF_PROGRAM": str(tmp_path / "absent")}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert "VOLREF_PROGRAM names" in run.stderr


def test_another_program():
    code = "import volref; volref.cases()"
    environment = {**os.environ, "VOLREF_PROGRAM": sys.executable}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert run.stderr.splitlines()[-1].startswith("volref.VolrefError: VOLREF_PROGRAM names ")
    assert "is not volref" in run.stderr


def test_a_program_that_was_removed(tmp_path):
    """The package alone, in a folder without a program, and no program anywhere else."""
    shutil.copytree(Path(volref.__file__).parent, tmp_path / "volref")
    code = (
        "import shutil, sys, sysconfig; sys.path.insert(0, sys.argv[1]); shutil.which = lambda name: None; "
        "sysconfig.get_path = lambda *scheme: sys.argv[1]; sys.executable = sys.argv[1] + '/python'; "
        "import volref; volref.program()"
    )
    environment = {name: value for name, value in os.environ.items() if name != "VOLREF_PROGRAM"}
    run = subprocess.run([sys.executable, "-c", code, tmp_path], env=environment, capture_output=True, text=True)
    assert "it was removed, or the wheel held none" in run.stderr, run.stderr


def test_a_case_as_a_bundle(tmp_path):
    (case,) = volref.cases("sampled/constant")
    bundle = case.bundle()
    assert bundle.volume.values.shape == tuple(bundle.volume.grid["nodes"][::-1]) and bundle.path.is_file()
    kept = case.bundle(tmp_path, step=0.25)
    assert (kept.path.parent, kept.step) == (tmp_path, 0.25)
    assert {file.suffix for file in tmp_path.iterdir()} == {".json", ".raw"}


def test_a_result_names_its_profile(tmp_path):
    image = np.zeros((64, 64, 3))
    assert volref.check("sampled/constant", image, explain=0).profile is None
    (tmp_path / "mine.toml").write_text('name = "my renderer"\n[conventions]\n')
    result = volref.check("sampled/constant", image, profile=tmp_path / "mine.toml", explain=0)
    assert result.profile == "my renderer" and "(by the profile my renderer)" in str(result).splitlines()[0]
