"""What the package offers."""

from __future__ import annotations

import atexit
import copy
import html
import os
import shlex
import shutil
import tempfile
import tomllib
import webbrowser
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arguments import number, one_of, whole
from ._bundle import Bundle, bundle
from ._files import as_depth, as_image, as_variance, write
from ._kept import keep_images
from ._program import UnknownCase, VolrefError, call, own_suite, suite_arguments

# pytest shows the line that called volref, not the lines of volref.
__tracebackhide__ = True

#: The folder of a suite; ``None`` for that of VOLREF_SUITE, else the one within the program.
SuiteFolder = str | os.PathLike[str] | None

FORMATS = ("mitsuba", "pbrt", "bundle")
GATES = ("exact", "deterministic", "perceptual", "stochastic")
#: Numbers of samples per pixel of which a variance can be estimated and a file can tell.
SAMPLES = (2, 2**32 - 2)
#: Exposures, in stops.
EXPOSURES = (-64.0, 64.0)
#: Beginning of the name of a folder in which images are judged.
IMAGES = "volref-"
#: Characters that pytest shows of an object in an assertion.
SHOWN = 230


@dataclass(frozen=True)
class Case:
    """A case of the suite.

    - ``name``: ``family/name``.
    - ``family``: the first part of the name.
    - ``kind``: ``deterministic``, ``stochastic`` (Monte Carlo) or ``limit`` (no step: the integral itself).
    - ``gate``: rule by which images of linear radiance are compared, ``deterministic`` or ``stochastic``.
    - ``source``: document and figure that it reproduces.
    - ``shows``: features of a correct image.
    - ``computes``: the exact computation, in words.
    - ``exposure``: exposure of 8-bit images, in stops: radiance times 2 to this power.
    - ``scene_file``: scene file (TOML).
    """

    name: str
    family: str
    kind: str
    gate: str
    source: str
    shows: str
    computes: str
    exposure: float
    scene_file: Path

    def scene(self) -> dict[str, Any]:
        """The scene as a dict, as its file states it: lengths in world units, angles in degrees. Names of
        files are absolute paths."""
        stated = tomllib.loads(self.scene_file.read_text(encoding="utf-8"))
        return _with_absolute_paths(stated, self.scene_file.parent)

    def bundle(self, folder: str | os.PathLike[str] | None = None, *, step: float | None = None) -> Bundle:
        """The scene as numbers: values, tables, matrices, see :class:`volref.Bundle`. Its files are written into ``folder``,
        else into a temporary one for as long as this process. ``step`` in place of the scene's, world units."""
        if folder is None:
            folder = tempfile.mkdtemp(prefix="volref-bundle-")
            atexit.register(shutil.rmtree, folder, ignore_errors=True)
        return bundle(_exported(self.scene_file, "bundle", folder), step)

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
    """A known mistake that would make the image: its ``name``, and as ``advice`` what is wrong and what is right."""

    name: str
    advice: str


@dataclass(frozen=True, repr=False)
class Result:
    """The verdict on an image of a case. It is true if the image passed.

    ``verdict`` is one of

    - ``pass``: the image agrees;
    - ``fail``: the image differs;
    - ``convention``: the image differs, and is right under other ``conventions``;
    - ``inconclusive``: no difference beyond noise, but the noise could hide too large a bias;
    - ``missing``: the case has no golden yet;
    - ``error``: the image or the golden cannot be used.

    The other fields:

    - ``name``: ``family/name``.
    - ``reason``: the rule, and the difference, in words.
    - ``gate``: rule by which the image was compared: ``deterministic``; ``stochastic`` for Monte Carlo images,
      by their noise; ``perceptual`` for ``uint8``; ``refinement`` for images with several steps.
    - ``looks_like``: known mistakes that explain an image that fails, most likely first.
    - ``conventions``: choices under which the image is right, in words, if the verdict is ``convention``.
    - ``difference``: what was measured of a difference that nothing known explains, in sentences.
    - ``change_agrees``: the scene with the change of parameters that ``difference`` states agrees with the image.
    - ``metrics``: numbers by name; the page of the report explains each.
    - ``report``: the page of the report, if one was asked for.
    - ``search_ended``: of an image that differs, false if the search for the cause was left out or ended by its limit.
    - ``known``: what the file of known failures says of it, if one was given: ``status``, ``reason``, ``link``,
      ``line`` and ``change``, where there are any.
    - ``profile``: the name of the profile of conventions that the image was judged by, if one was given.
    """

    name: str
    verdict: str
    reason: str
    gate: str
    looks_like: tuple[Mistake, ...]
    conventions: tuple[str, ...]
    difference: tuple[str, ...]
    change_agrees: bool
    metrics: Mapping[str, float] = field(hash=False)
    report: Path | None = None
    search_ended: bool | None = None
    known: Mapping[str, Any] | None = field(default=None, hash=False)
    profile: str | None = None
    #: The page of the report, if one was asked for, and arguments of :func:`check` that make this result again.
    _page: str | None = field(default=None, repr=False, compare=False)
    _again: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)

    @property
    def passed(self) -> bool:
        """The verdict is ``pass``, or ``convention`` where ``check`` was told to ``accept_conventions``."""
        accepts = bool(self._again.get("accept_conventions"))
        return self.verdict == "pass" or (accepts and self.verdict == "convention")

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        # In the order of use, for pytest shows the first part alone.
        fields: dict[str, Any] = {"name": self.name, "verdict": self.verdict}
        fields["looks_like"] = [mistake.name for mistake in self.looks_like]
        fields["conventions"] = [_shortened(words, 60) for words in self.conventions[:1]]
        fields["conventions"] += ["…"] * (len(self.conventions) > 1)
        return _represented("Result", fields, self.reason)

    def __str__(self) -> str:
        likely = f", looks like {self.looks_like[0].name}" if self.looks_like else ""
        by = f" (by the profile {self.profile})" if self.profile else ""
        lines = [f"{self.name}: {self.verdict}{by}{likely}", self.reason]
        for mistake in self.looks_like:
            lines.append(f"looks like {mistake.name}: {mistake.advice}")
        if self.difference:
            nothing = "nothing that was tried explains it; measured:"
            lines.append("a change of a parameter explains it:" if self.change_agrees else nothing)
            lines.extend(f"  {sentence}" for sentence in self.difference)
        if self.search_ended is False and not self.looks_like:
            lines.append("the cause was not looked for to the end: explain=60 gives the search a minute")
        if self.report:
            lines.append(f"report: {self.report}")
        return "\n".join(lines)

    def page(self) -> str:
        """The report as an HTML page that works offline: both images, their difference, and why."""
        if self._page is not None:
            return self._page
        with tempfile.TemporaryDirectory(prefix="volref-") as folder:
            check(**{**self._again, "report": folder})
            return without_folder((Path(folder) / "index.html").read_text(encoding="utf-8"), folder, "REPORT")

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
        rows += [("profile", self.profile)] if self.profile else []
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


def _shortened(words: str, most: int) -> str:
    return words if len(words) <= most else words[: most - 1] + "…"


def _represented(kind: str, fields: Mapping[str, Any], reason: str) -> str:
    """The fields in one line, with as much of the reason as pytest shows."""
    start = f"{kind}({', '.join(f'{name}={value!r}' for name, value in fields.items())}, reason="
    return f"{start}{_shortened(reason, max(SHOWN - len(start), 20))!r})"


@dataclass(frozen=True, repr=False)
class Comparison:
    """The verdict on one image by another. It is true if the verdict is ``pass``.

    - ``verdict``: ``pass``; ``fail``, the images differ or cannot be compared; or ``inconclusive``, the noise could
      hide too large a bias.
    - ``reason``: the rule, and the difference, in words.
    - ``gate``: rule by which the images were compared, one of those of :func:`compare`.
    - ``metrics``: numbers by name.
    """

    verdict: str
    reason: str
    gate: str
    metrics: Mapping[str, float] = field(hash=False)

    def __repr__(self) -> str:
        return _represented("Comparison", {"verdict": self.verdict, "gate": self.gate}, self.reason)

    @property
    def passed(self) -> bool:
        """The verdict is ``pass``."""
        return self.verdict == "pass"

    def __bool__(self) -> bool:
        return self.passed


@dataclass(frozen=True)
class Flip:
    """The difference that an eye perceives (FLIP, Andersson et al. 2020), from 0 to 1: ``mean`` over the pixels,
    and weighted 99th ``percentile``."""

    mean: float
    percentile: float


def cases(*filters: str, suite: SuiteFolder = None) -> list[Case]:
    """The cases that the filters name: families, cases, or patterns such as ``'figures/*'``; those with ``!``
    before them are left out; all without one.

    Raises UnknownCase for a filter without a match.
    """
    for given in filters:
        if not isinstance(given, str):
            raise TypeError(f"a filter is text, not of type {type(given).__name__}")
        if not given or given.startswith("-"):
            # Not a case, and an option to the program.
            raise UnknownCase(f'no case matches "{given}" (volref.cases() lists all cases)')
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
    if not isinstance(name, str):
        raise TypeError(f"the name of a case is text, family/name, not of type {type(name).__name__}")
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

    ``to`` is ``mitsuba`` (3, XML), ``pbrt`` (v4) or ``bundle`` (any scene as numbers and formulas).
    Raises ValueError for another format, and VolrefError if the format cannot say what the scene holds.
    """
    one_of("to", to, FORMATS)
    return _exported(_case(name, suite).scene_file, to, folder)


def _exported(scene_file: Path, to: str, folder: str | os.PathLike[str]) -> Path:
    value = call(["export", str(scene_file), f"--to={to}", f"--output={os.fspath(folder)}"])
    return Path(folder) / value["main"]


def render(
    scene: str | os.PathLike[str] | Case,
    *,
    spp: int | None = None,
    seed: int | None = None,
    step: str | None = None,
    depth: str | None = None,
) -> NDArray[np.float32]:
    """The image of a case, or of a scene file, as volref renders it: float32 of shape (height, width, 3), or
    (height, width, 4) with opacity; linear radiance, in front of the background of the scene.

    ``spp``: samples per pixel, 1 or more, for Monte Carlo scenes; ``seed``: of their random numbers, 0 or more.
    ``step``: length of a step through a classified volume, such as ``"0.5 voxels"``; a number is in world units.
    ``depth``: in place of the image the depth of each pixel, float32 of shape (height, width), infinite where there is
    none: ``"mean"``, ``"half"``, ``"mean-along-view"`` or ``"half-along-view"``.
    """
    given = _scene_file(scene)
    if spp is not None:
        spp = whole("spp", spp, 1, 2**31)
    if seed is not None:
        seed = whole("seed", seed, 0, 2**64 - 1)
    with tempfile.TemporaryDirectory(prefix="volref-") as folder:
        file = Path(folder) / "image.npy"
        arguments = ["render", os.fspath(given), "--output", str(file)]
        for name, value in [("--spp", spp), ("--seed", seed), ("--step", step), ("--depth", depth)]:
            if value is not None:
                arguments.append(f"{name}={value}")
        call(arguments)
        return np.load(file if depth is None else file.with_suffix(".depth.npy"))


def _scene_file(scene: Any) -> str:
    """The file of a scene, for the program: the scene file of a case, or the path as it was given."""
    if isinstance(scene, Case):
        return str(scene.scene_file)
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"a scene is a case, or the path of a scene file, not of type {type(scene).__name__}")
    given = os.fspath(scene)
    if Path(given).is_file():
        # A file whose name begins with "-" is no option.
        return os.path.join(os.curdir, given) if given.startswith("-") else given
    if given.endswith(".toml"):
        # The program says why it cannot be read.
        return given
    return str(_case(given, None).scene_file)


def check(
    name: str | Case,
    image: ArrayLike | Sequence[ArrayLike] | Mapping[float, ArrayLike],
    variance: ArrayLike | None = None,
    *,
    samples: int | None = None,
    profile: str | os.PathLike[str] | None = None,
    bits: int | str | None = None,
    alpha: str | None = None,
    depth: ArrayLike | None = None,
    accept_conventions: bool = False,
    explain: float | None = None,
    report: str | os.PathLike[str] | None = None,
    outputs: str | os.PathLike[str] | None = None,
    known: str | os.PathLike[str] | None = None,
    suite: SuiteFolder = None,
    _kept: tuple[Path, str] | None = None,
) -> Result:
    """Judges ``image`` as the image of the case ``name``.

    ``image`` is an array (see :mod:`volref`); a list of arrays, or an iterator over
    them, for several renderings with seeds of their own; or, for a case of the family ``limit``, a dict of arrays
    by the factor on the step: ``{1: a, 0.5: b, 0.25: c}``.

    ``variance``: variance of the mean of each value, radiance squared, of the image's shape; with the number of
    ``samples`` per pixel, from 2 to 2**32 - 2. Without it the noise of a Monte Carlo image is estimated.

    ``bits``: bits of a channel to which the image was rounded, ``8``, ``"8-linear"`` or ``"8-srgb"``: differences up
    to half a code agree, and a ``uint8`` array is judged as the radiance of its codes.

    ``alpha``: ``"premultiplied"`` or ``"straight"`` for colours beside an opacity that leave out the background of the
    scene. ``depth``: distances, of shape (height, width), for cases that ask for depth.

    ``profile``: conventions by which to judge, ``vtk``, ``anari`` or a file. ``accept_conventions`` passes images
    that are right under other conventions, which a search finds. ``explain``: seconds for finding the mistake or the
    conventions behind an image that fails; 0 for no search, which is the default where the environment variable ``CI`` is set, else 10. ``report``: folder for a page. ``outputs``: folder in which the image is kept, in place
    of others of the case; no folder of a suite. ``known``: file of known failures, as of ``volref validate --known``:
    ``Result.known`` says what it says of this image.

    Raises UnknownCase, TypeError and ValueError for arrays that are no image, and VolrefError.
    """
    if isinstance(image, (str, Case)) and not isinstance(name, (str, Case)):
        raise TypeError("the case comes first, then the image: check(name, image)")
    if isinstance(image, Iterator):
        image = list(image)
    again = copy.deepcopy({**locals(), "report": None, "outputs": None, "_kept": None})
    case = _case(name, suite)
    samples = _samples(samples)
    if explain is not None:
        explain = number("explain", explain, "a number of seconds up to 1e9, 0 for no search", least=0.0, most=1e9)
    # Results that are kept for a page name the images, which are gone by then: in a folder that is known.
    beside = None if _kept is None else _kept[0]
    with tempfile.TemporaryDirectory(prefix=IMAGES, dir=beside) as temporary:
        # Judged here, and only copied to the others: another process may replace an image of the case there.
        folder = Path(temporary)
        try:
            files = _write_all(folder, case, image, variance, samples, depth)
            if outputs is not None:
                folder = Path(outputs)
                family = {other.name for other in cases(case.family, suite=suite)}
                keep_images(files, folder, case.name, family)
        except OSError as error:
            raise VolrefError(f"cannot write the image into {folder}: {error.strerror}") from None
        arguments = ["validate", case.name, f"--outputs={temporary}"]
        if explain is not None:
            arguments.append(f"--explain={explain!r}")
        if profile is not None:
            arguments.append(f"--as={os.fspath(profile)}")
        if bits is not None:
            arguments.append(f"--bits={bits}")
        if alpha is not None:
            arguments.append(f"--alpha={alpha}")
        if accept_conventions:
            arguments.append("--accept-conventions")
        if known is not None:
            arguments.append(f"--known={os.fspath(known)}")
        if report is not None:
            arguments.append(f"--report={os.fspath(report)}")
        if _kept is not None:
            arguments += [f"--results={_kept[0]}", f"--named={_kept[1]}"]
        value = call([*arguments, *suite_arguments(suite)])
    found = value["cases"][0]
    # Nobody finds a folder for temporary files again.
    reason = found["reason"].replace(f"{temporary}{os.sep}", "")
    if case.kind == "limit" and isinstance(image, (list, tuple)) and found["verdict"] != "pass":
        reason += "; a list is for seeds of their own: images by the step are a dict, {1: a, 0.5: b, 0.25: c}"
    page = None
    if report is not None:
        page = Path(report) / "index.html"
        text = without_folder(page.read_text(encoding="utf-8"), temporary, in_words(outputs))
        page.write_text(text, encoding="utf-8")
    advice = {mistake["mistake"]: mistake["advice"] for mistake in value.get("looks_like", [])}
    return Result(
        name=found["name"],
        verdict=found["verdict"],
        reason=reason,
        gate=found["gate"],
        looks_like=tuple(Mistake(mistake, advice.get(mistake, "")) for mistake in found["looks_like"]),
        conventions=tuple(found.get("conventions", ())),
        difference=tuple(found.get("difference", ())),
        change_agrees=found.get("change_agrees", False),
        metrics=found["metrics"],
        report=page,
        search_ended=found.get("search_ended"),
        known=found.get("known"),
        profile=value["judged_with"]["settings"].get("profile"),
        _page=None if page is None else page.read_text(encoding="utf-8"),
        _again=again,
    )


def in_words(outputs: str | os.PathLike[str] | None) -> str:
    """The folder of the images, for the commands that a page shows."""
    return "IMAGES" if outputs is None else html.escape(shlex.quote(os.path.abspath(outputs)))


def without_folder(page: str, folder: str, word: str) -> str:
    """The page with ``word`` in place of a folder that is gone, in the commands that it shows."""
    escaped = html.escape(folder).replace("/", "&#x2f;")
    return page.replace(escaped, word).replace(folder, word)


def _samples(samples: Any) -> int | None:
    return None if samples is None else whole("samples", samples, *SAMPLES)


def _variance(variance: ArrayLike | None, samples: int | None, image: NDArray[Any]) -> NDArray[np.float32] | None:
    """The variance of the means, of shape (height, width, 3), if one is given; it takes ``samples``."""
    if variance is None:
        return None
    if samples is None:
        raise ValueError("a variance goes with the number of samples per pixel that it is of: samples=N")
    return as_variance(variance, image)


def _write_all(
    folder: Path,
    case: Case,
    image: Any,
    variance: ArrayLike | None,
    samples: int | None,
    depth: ArrayLike | None,
) -> list[Path]:
    """Writes the images of a case into ``folder``; returns the files."""
    name = case.name
    if isinstance(image, Mapping):
        wanted = [0.5**halvings for halvings in range(max(len(image), 1))]
        are_numbers = all(isinstance(factor, (int, float)) for factor in image)
        if not are_numbers or sorted(image, reverse=True) != wanted:
            raise ValueError(f"factors on the step are 1, 0.5, 0.25 and so on without a gap, not {list(image)}")
        if len(image) > 1 and case.kind != "limit":
            raise ValueError(f"images by the step are for cases of the family limit: {name} takes one image")
        named = {name if factor == 1 else f"{name}@{factor:g}": array for factor, array in image.items()}
    elif isinstance(image, (list, tuple)) and len(image) == 0:
        raise ValueError("the list of images is empty")
    elif isinstance(image, (list, tuple)) and all(hasattr(it, "shape") for it in image):
        named = {f"{name}.{index}": array for index, array in enumerate(image)}
    else:
        named = {name: image}
    if variance is not None and len(named) > 1:
        raise ValueError("a variance belongs to one image: of several renderings it is computed")
    arrays = {file: as_image(array) for file, array in named.items()}
    depths = None if depth is None else as_depth(depth, list(arrays.values()))
    noise = _variance(variance, samples, next(iter(arrays.values())))
    return [
        write(folder / file, array, noise, samples if array.dtype.kind == "f" else None, depths)
        for file, array in arrays.items()
    ]


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

    ``gate``: ``exact`` (every bit, with opacity), ``deterministic``, ``perceptual`` or ``stochastic``; without one
    it follows from the images. ``exposure`` in stops, for 8-bit images. ``resolution`` in per cent: a larger bias
    of the mean must be seen. ``variance`` and ``samples`` are those of ``image``, as in :func:`check`.
    """
    if gate is not None:
        one_of("gate", gate, GATES)
    exposure = number("exposure", exposure, "a number of stops from -64 to 64", *EXPOSURES)
    samples = _samples(samples)
    with tempfile.TemporaryDirectory(prefix="volref-") as temporary:
        right, test = as_image(reference, "reference"), as_image(image)
        noise = _variance(variance, samples, test)
        files = [
            write(Path(temporary) / "reference", right),
            write(Path(temporary) / "image", test, noise, samples if test.dtype.kind == "f" else None),
        ]
        arguments = ["compare", *map(str, files), f"--exposure={exposure!r}"]
        if gate is not None:
            arguments.append(f"--gate={gate}")
        if resolution is not None:
            arguments.append(f"--resolution={resolution}")
        found = call(arguments)["cases"][0]
    reason = found["reason"].replace(f"{temporary}{os.sep}", "")
    return Comparison(found["verdict"], reason, found["gate"], found["metrics"])


def flip(reference: ArrayLike, image: ArrayLike, *, exposure: float = 0.0) -> Flip:
    """The difference that an eye perceives between two images, at 67 pixels per degree.

    Arrays of floating point are converted to sRGB at ``exposure``, in stops.
    """
    found = compare(reference, image, gate="perceptual", exposure=exposure)
    if "flip_mean" not in found.metrics:
        raise ValueError(found.reason)
    return Flip(found.metrics["flip_mean"], found.metrics["flip_weighted_p99"])
