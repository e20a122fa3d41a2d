"""What the package offers."""

from __future__ import annotations

import copy
import html
import os
import tempfile
import tomllib
import webbrowser
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._files import as_image, as_variance, write
from ._program import UnknownCase, call, own_suite, suite_arguments

#: The folder of a suite; ``None`` for that of VOLREF_SUITE, else the one within the program.
SuiteFolder = str | os.PathLike[str] | None


@dataclass(frozen=True)
class Case:
    """A case of the suite."""

    #: ``family/name``.
    name: str
    family: str
    #: ``deterministic``, ``stochastic`` or ``limit``.
    kind: str
    #: Rule by which images are compared.
    gate: str
    #: Document and figure that it reproduces.
    source: str
    #: Features of a correct image.
    shows: str
    #: The exact computation, in words.
    computes: str
    #: Exposure of 8-bit images, in stops: radiance times 2 to this power.
    exposure: float
    #: Scene file (TOML).
    scene_file: Path

    def scene(self) -> dict[str, Any]:
        """The scene as a dict, as its file states it: lengths in world units, angles in degrees. Names of
        files are absolute paths."""
        stated = tomllib.loads(self.scene_file.read_text(encoding="utf-8"))
        return _with_absolute_paths(stated, self.scene_file.parent)

    def __str__(self) -> str:
        return self.name


def _with_absolute_paths(value: Any, folder: Path) -> Any:
    """``value`` with every text that names a file below ``folder`` as its absolute path."""
    if isinstance(value, dict):
        return {key: _with_absolute_paths(item, folder) for key, item in value.items()}
    if isinstance(value, list):
        return [_with_absolute_paths(item, folder) for item in value]
    if isinstance(value, str) and "." in value and (folder / value).is_file():
        return str((folder / value).resolve())
    return value


@dataclass(frozen=True)
class Mistake:
    """A known mistake that would make the image."""

    name: str
    #: What is wrong, and what is right.
    advice: str


@dataclass(frozen=True)
class Result:
    """The verdict on an image of a case."""

    #: ``family/name``.
    name: str
    #: ``pass``, ``fail``, ``convention``, ``inconclusive``, ``missing`` or ``error``.
    verdict: str
    #: The rule, and the difference.
    reason: str
    #: Rule by which the image was compared.
    gate: str
    #: Known mistakes that explain the image, most likely first.
    looks_like: tuple[Mistake, ...]
    #: Conventions under which the image is right, if the verdict is ``convention``.
    conventions: tuple[str, ...]
    #: What was measured of a difference that nothing known explains, in sentences.
    difference: tuple[str, ...]
    #: Numbers by name.
    metrics: Mapping[str, float]
    #: The page of the report, if one was asked for.
    report: Path | None = None
    #: The page of the report, if one was asked for, and arguments of :func:`check` that make this result again.
    _page: str | None = field(default=None, repr=False, compare=False)
    _again: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)

    @property
    def passed(self) -> bool:
        """The verdict is ``pass``."""
        return self.verdict == "pass"

    def __bool__(self) -> bool:
        return self.passed

    def __str__(self) -> str:
        lines = [f"{self.name}: {self.verdict}", self.reason]
        for mistake in self.looks_like:
            lines.append(f"looks like {mistake.name}: {mistake.advice}")
        if self.difference:
            lines.append("no known mistake or convention explains it; measured:")
            lines.extend(f"  {sentence}" for sentence in self.difference)
        if self.report:
            lines.append(f"report: {self.report}")
        return "\n".join(lines)

    def page(self) -> str:
        """The report as an HTML page that works offline: both images, their difference, and why."""
        if self._page is not None:
            return self._page
        with tempfile.TemporaryDirectory(prefix="volref-") as folder:
            check(**{**self._again, "report": folder})
            return (Path(folder) / "index.html").read_text(encoding="utf-8")

    def show(self, height: int = 700) -> None:
        """Shows the report: in a notebook below the cell, ``height`` pixels high, else in the browser."""
        page = self.page()
        try:
            from IPython import get_ipython
            from IPython.display import HTML, display
        except ImportError:
            shell = None
        else:
            shell = get_ipython()
        if shell is not None:
            frame = f'<iframe srcdoc="{html.escape(page)}" width="100%" height="{height}"></iframe>'
            display(HTML(frame))
            return
        file = tempfile.NamedTemporaryFile("w", suffix=".html", encoding="utf-8", delete=False)
        with file:
            file.write(page)
        webbrowser.open(Path(file.name).as_uri())

    def _repr_html_(self) -> str:
        rows = [("verdict", f"{self.verdict} ({self.gate} gate)"), ("reason", self.reason)]
        rows += [("looks like", f"{mistake.name}: {mistake.advice}") for mistake in self.looks_like]
        rows += [("convention", words) for words in self.conventions]
        rows += [("measured", sentence) for sentence in self.difference]
        rows += [(name, f"{value:.6g}") for name, value in self.metrics.items()]
        cells = "".join(
            f"<tr><th style='text-align:left'>{html.escape(name)}</th>"
            f"<td style='text-align:left'>{html.escape(text)}</td></tr>"
            for name, text in rows
        )
        return f"<table><caption>{html.escape(self.name)}</caption>{cells}</table>"


@dataclass(frozen=True)
class Comparison:
    """The verdict on one image by another."""

    #: ``pass``, ``fail`` or ``inconclusive``.
    verdict: str
    #: The rule, and the difference.
    reason: str
    #: Rule by which the images were compared.
    gate: str
    #: Numbers by name.
    metrics: Mapping[str, float]

    @property
    def passed(self) -> bool:
        """The verdict is ``pass``."""
        return self.verdict == "pass"

    def __bool__(self) -> bool:
        return self.passed


@dataclass(frozen=True)
class Flip:
    """The difference that an eye perceives (FLIP, Andersson et al. 2020), from 0 to 1."""

    #: Mean over the pixels.
    mean: float
    #: Weighted 99th percentile.
    percentile: float


def cases(*filters: str, suite: SuiteFolder = None) -> list[Case]:
    """The cases that the filters name: families, cases, or patterns such as ``'figures/*'``; all without one.

    Raises UnknownCase for a filter without a match.
    """
    for given in filters:
        if not isinstance(given, str):
            raise TypeError(f"a filter is text, not {given!r}")
    listed = call(["list", *filters, *suite_arguments(suite)])["cases"]
    if listed and not Path(listed[0]["scene"]).is_file():
        # It was unpacked for that command alone: nothing can be kept here.
        own_suite()
        listed = call(["list", *filters, *suite_arguments(suite)])["cases"]
    return [
        Case(
            name=case["name"],
            family=case["family"],
            kind=case["class"],
            gate=case["gate"],
            source=case["source"],
            shows=case["shows"],
            computes=case["computes"],
            exposure=case["exposure"],
            scene_file=Path(case["scene"]).absolute(),
        )
        for case in listed
    ]


def _case(name: str | Case, suite: SuiteFolder) -> Case:
    if isinstance(name, Case):
        return name
    found = cases(name, suite=suite)
    if len(found) != 1:
        raise UnknownCase(f"{name!r} names {len(found)} cases: give one, as family/name")
    return found[0]


def scene(name: str | Case, suite: SuiteFolder = None) -> dict[str, Any]:
    """The scene of a case as a dict, as its file states it: lengths in world units, angles in degrees. Names of
    files are absolute paths.

    Raises UnknownCase if there is no such case.
    """
    return _case(name, suite).scene()


def export(name: str | Case, to: str, folder: str | os.PathLike[str], suite: SuiteFolder = None) -> Path:
    """Writes the scene of a case for another renderer into ``folder``; returns the file to render.

    ``to`` is ``mitsuba`` (3, XML), ``pbrt`` (v4) or ``bundle`` (a classified volume as numbers and formulas).
    Raises VolrefError if the format cannot say what the scene holds.
    """
    given = str(_case(name, suite).scene_file)
    value = call(["export", given, "--to", to, "--output", os.fspath(folder)])
    return Path(folder) / value["main"]


def render(
    scene: str | os.PathLike[str] | Case,
    *,
    spp: int | None = None,
    seed: int | None = None,
    step: str | None = None,
) -> NDArray[np.float32]:
    """The image of a case, or of a scene file, as volref renders it: float32 of shape (height, width, 3), or
    (height, width, 4) with opacity; linear radiance, premultiplied by opacity.

    ``spp``: samples per pixel, for Monte Carlo scenes; ``seed``: of their random numbers. ``step``: length of
    a step through a classified volume, such as ``"0.5 voxels"``; a number is in world units.
    """
    given = scene.scene_file if isinstance(scene, Case) else scene
    with tempfile.TemporaryDirectory(prefix="volref-") as folder:
        file = Path(folder) / "image.npy"
        arguments = ["render", os.fspath(given), "--output", str(file)]
        for name, value in [("--spp", spp), ("--seed", seed), ("--step", step)]:
            if value is not None:
                arguments += [name, str(value)]
        call(arguments)
        return np.load(file)


def check(
    name: str | Case,
    image: ArrayLike | Sequence[ArrayLike] | Mapping[float, ArrayLike],
    variance: ArrayLike | None = None,
    *,
    samples: int | None = None,
    profile: str | os.PathLike[str] | None = None,
    accept_conventions: bool = False,
    explain: float = 10.0,
    report: str | os.PathLike[str] | None = None,
    outputs: str | os.PathLike[str] | None = None,
    suite: SuiteFolder = None,
) -> Result:
    """Judges ``image`` as the image of the case ``name``.

    ``image`` is an array (see :mod:`volref`); a list of arrays for several renderings with seeds of their own;
    or, for a case of the family ``limit``, a dict of arrays by the factor on the step: ``{1: a, 0.5: b, 0.25: c}``.

    ``variance``: variance of the mean of each value, radiance squared, of the image's shape; with the number of
    ``samples`` per pixel. Without it the noise of a Monte Carlo image is estimated.

    ``profile``: conventions by which to judge, ``vtk``, ``anari`` or a file. ``accept_conventions`` passes images
    that are right under other conventions. ``explain``: seconds for finding the mistake behind an image that
    fails; 0 for no search. ``report``: folder for a page. ``outputs``: folder in which the image is kept.

    Raises UnknownCase, TypeError and ValueError for arrays that are no image, and VolrefError.
    """
    again = copy.deepcopy({**locals(), "report": None, "outputs": None})
    case = _case(name, suite)
    if samples is not None and (samples != int(samples) or samples < 1):
        raise ValueError(f"samples is {samples}: give a whole number of samples per pixel, 1 or more")
    with tempfile.TemporaryDirectory(prefix="volref-") as temporary:
        folder = Path(outputs) if outputs is not None else Path(temporary)
        _write_all(folder, case.name, image, variance, samples)
        arguments = ["validate", case.name, "--outputs", str(folder), "--explain", repr(float(explain))]
        if profile is not None:
            arguments += ["--as", os.fspath(profile)]
        if accept_conventions:
            arguments.append("--accept-conventions")
        if report is not None:
            arguments += ["--report", os.fspath(report)]
        value = call([*arguments, *suite_arguments(suite)])
    found = value["cases"][0]
    page = None if report is None else Path(report) / "index.html"
    advice = {mistake["mistake"]: mistake["advice"] for mistake in value.get("looks_like", [])}
    return Result(
        name=found["name"],
        verdict=found["verdict"],
        reason=found["reason"],
        gate=found["gate"],
        looks_like=tuple(Mistake(mistake, advice.get(mistake, "")) for mistake in found["looks_like"]),
        conventions=tuple(found.get("conventions", ())),
        difference=tuple(found.get("difference", ())),
        metrics=found["metrics"],
        report=page,
        _page=page.read_text(encoding="utf-8") if page else None,
        _again=again,
    )


def _write_all(
    folder: Path,
    name: str,
    image: Any,
    variance: ArrayLike | None,
    samples: int | None,
) -> None:
    if isinstance(image, Mapping):
        wanted = [0.5**halvings for halvings in range(max(len(image), 1))]
        are_numbers = all(isinstance(factor, (int, float)) for factor in image)
        if not are_numbers or sorted(image, reverse=True) != wanted:
            raise ValueError(f"factors on the step are 1, 0.5, 0.25 and so on without a gap, not {list(image)}")
        named = {name if factor == 1 else f"{name}@{factor:g}": array for factor, array in image.items()}
    elif isinstance(image, (list, tuple)) and len(image) > 0 and all(hasattr(it, "shape") for it in image):
        named = {f"{name}.{index}": array for index, array in enumerate(image)}
    else:
        named = {name: image}
    if variance is not None and len(named) > 1:
        raise ValueError("a variance belongs to one image: of several renderings it is computed")
    if variance is not None and samples is None:
        raise ValueError("a variance goes with the number of samples per pixel that it is of: samples=N")
    arrays = {file: as_image(array) for file, array in named.items()}
    noise = None if variance is None else as_variance(variance, arrays[name])
    # Only now: what was kept before is lost to nothing that is no image.
    for old in (folder / name).parent.glob(f"{(folder / name).name}[.@]*"):
        old.unlink()
    for file, array in arrays.items():
        write(folder / file, array, noise, samples if array.dtype.kind == "f" else None)


def compare(
    reference: ArrayLike,
    image: ArrayLike,
    *,
    gate: str | None = None,
    exposure: float = 0.0,
    resolution: float | None = None,
    variance: ArrayLike | None = None,
    samples: int | None = None,
) -> Comparison:
    """Judges ``image`` by ``reference``, the right one; see :mod:`volref` for their shapes.

    ``gate``: ``exact``, ``deterministic``, ``perceptual`` or ``stochastic``; without one it follows from the
    images. ``exposure`` in stops, for 8-bit images. ``resolution`` in per cent: a larger bias of the mean must be
    seen. ``variance`` and ``samples`` are those of ``image``.
    """
    with tempfile.TemporaryDirectory(prefix="volref-") as temporary:
        test = as_image(image)
        noise = None if variance is None else as_variance(variance, test)
        files = [
            write(Path(temporary) / "reference", as_image(reference, "reference")),
            write(Path(temporary) / "image", test, noise, samples if test.dtype.kind == "f" else None),
        ]
        arguments = ["compare", *map(str, files), "--exposure", repr(float(exposure))]
        if gate is not None:
            arguments += ["--gate", gate]
        if resolution is not None:
            arguments += ["--resolution", repr(float(resolution))]
        found = call(arguments)["cases"][0]
    return Comparison(found["verdict"], found["reason"], found["gate"], found["metrics"])


def flip(reference: ArrayLike, image: ArrayLike, *, exposure: float = 0.0) -> Flip:
    """The difference that an eye perceives between two images, at 67 pixels per degree.

    Arrays of floating point are converted to sRGB at ``exposure``, in stops.
    """
    found = compare(reference, image, gate="perceptual", exposure=exposure)
    if "flip_mean" not in found.metrics:
        raise ValueError(found.reason)
    return Flip(found.metrics["flip_mean"], found.metrics["flip_weighted_p99"])
