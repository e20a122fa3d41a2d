"""Bundles: scenes as numbers, as ``volref export --to bundle`` writes them for other renderers."""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arguments import number, one_of, whole
from ._files import as_image, as_variance, exr, png
from ._program import VolrefError, refuse
from ._radiance import Part, divided

# pytest shows the line that called volref, not the lines of volref.
__tracebackhide__ = True

SCHEMA = "volref/bundle/1"
LENGTHS = ("step", "voxel", "length")
#: Features of scenes that :meth:`Bundle.allow` knows, beside the modes.
FEATURES = (
    *("several", "parallel", "placed", "sheared", "nearest", "formula"),
    *("shading", "shadow", "clips", "surfaces", "modulation"),
)
MODES = ("maximum", "minimum", "mean", "sum", "attenuated-maximum", "isosurface")
FORMATS = (".exr", ".npy", ".pfm", ".png")
#: Rounding of 32-bit renderers, of the mean: a smaller spread is no noise.
ROUNDING = 1e-5


class Table(NamedTuple):
    """Colours, of shape (n, 3), and opacities, of shape (n,), at n values from the first to the last of ``range``."""

    colours: NDArray[np.float64]
    opacities: NDArray[np.float64]
    range: tuple[float, float]


@dataclass(frozen=True)
class Volume:
    """A volume of a bundle. ``json`` is what the bundle says of it, ``step`` the distance between samples, world
    units."""

    json: dict[str, Any]
    folder: Path
    step: float
    mode: dict[str, Any] | None = None

    @property
    def grid(self) -> dict[str, Any]:
        """The grid as the bundle states it: nodes, spacing, first node and box, in the order x, y, z."""
        return self.json["grid"]

    @property
    def values(self) -> NDArray[np.float32]:
        """The values at the nodes, of shape (z, y, x)."""
        return self._array(self.grid["file"])

    def _array(self, name: str) -> NDArray[np.float32]:
        file, shape = self.folder / name, tuple(self.grid["nodes"][::-1])
        try:
            is_npy = file.suffix == ".npy"
            array = np.load(file, allow_pickle=False) if is_npy else np.fromfile(file, "<f4")
        except (OSError, ValueError) as error:
            raise VolrefError(f"{file}: {error}") from None
        if array.size != np.prod(shape):
            raise VolrefError(f"{file} has {array.size} values, and the bundle {shape} nodes: export the scene again")
        return array.reshape(shape).astype(np.float32, copy=False)

    @property
    def is_of_cells(self) -> bool:
        """The box reaches half a voxel beyond the outermost nodes, which are the centres of cells."""
        beyond = np.subtract(self.grid["first_node"], self.grid["box_min"])
        return bool(np.all(beyond > 0.25 * np.array(self.grid["spacing"])))

    @property
    def is_nearest(self) -> bool:
        """Values are those of the nearest node, not interpolated."""
        return self.json["interpolation"]["method"] == "nearest"

    @property
    def matrix(self) -> NDArray[np.float64]:
        """From coordinates of the grid to the world, 4 x 4: the unit matrix where the volume is not placed."""
        return np.vstack([self.grid.get("matrix", np.eye(3, 4)), [0, 0, 0, 1]])

    @property
    def affine(self) -> NDArray[np.float64]:
        """From indices (x, y, z) of nodes to the world, 4 x 4."""
        nodes = np.diag([*self.grid["spacing"], 1.0])
        nodes[:3, 3] = self.grid["first_node"]
        return self.matrix @ nodes

    @property
    def corners(self) -> NDArray[np.float64]:
        """The corners of the box in the world, of shape (8, 3)."""
        return self._corners(0)

    def _corners(self, beyond: float) -> NDArray[np.float64]:
        """The corners of the box with so many voxels more on each side."""
        more = beyond * np.array(self.grid["spacing"])
        ends = zip(self.grid["box_min"] - more, self.grid["box_max"] + more)
        return np.array([*itertools.product(*ends)]) @ self.matrix[:3, :3].T + self.matrix[:3, 3]

    @property
    def voxel(self) -> float:
        """The shortest edge of a voxel, world units."""
        return float(np.linalg.norm(self.affine[:3, :3], axis=0).min())

    @property
    def reference_length(self) -> float:
        """The length that the opacities of the transfer function are of, world units."""
        return float(self.json["transfer_function"]["reference_length"])

    @property
    def has_jump(self) -> bool:
        """Two points of the transfer function lie at one value."""
        values = [point["value"] for point in self._points()]
        return len(set(values)) < len(values)

    def _points(self) -> list[dict[str, Any]]:
        """The points of the transfer function, none of a formula; of a window the two ends of its greys."""
        transfer = self.json["transfer_function"]
        if transfer is not None:
            return transfer.get("points", [])
        if self.mode is None or "low" not in self.mode:
            refuse("colours without a transfer function")
        low, high = ({"value": self.mode[end], "opacity": 1.0} for end in ("low", "high"))
        return [low | {"colour": [0.0] * 3}, high | {"colour": [1.0] * 3}]

    def table(self, n: int, per: str = "length", step: float | None = None) -> Table:
        """Colours and opacities at ``n`` equally spaced values, from the first point of the transfer function to the
        last; of a formula, from 0 to 1 or the largest value, and its colours times the square of the value.

        ``per``: length that the opacities are of, ``"length"`` for the reference length, ``"voxel"`` for the
        shortest edge of a voxel, ``"step"`` for ``step``, or else that of the volume.
        """
        one_of("per", per, LENGTHS)
        points = self._points()
        most = 1.0 if points else max(1.0, float(self.values.max()))
        ends = (points[0]["value"], points[-1]["value"]) if points else (0.0, most)
        values = np.linspace(*ends, whole("n", n, 2, 2**24))
        colours, opacities = _by_points(points, values) if points else self._by_formula(values)
        if per != "length":
            length = self.voxel if per == "voxel" else step or self.step
            opacities = 1 - (1 - opacities) ** (length / self.reference_length)
        return Table(colours, opacities, ends)

    def _by_formula(self, values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        transfer = self.json["transfer_function"]
        clear = (np.exp(-(values**2)) - transfer["floor"]) / (1 - transfer["floor"])
        places = np.linspace(0, 1, len(transfer["colours"]))
        channels = [np.interp(values, places, channel) for channel in zip(*transfer["colours"])]
        return np.stack(channels, 1) * values[:, None] ** 2, 1 - clear.clip(0, 1)


def _by_points(points: list[dict[str, Any]], values: NDArray[np.float64]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Straight lines between points; of two at one value the later holds there."""
    at = np.array([point["value"] for point in points])
    right = np.searchsorted(at, values, "right").clip(1, len(at) - 1)
    width = at[right] - at[right - 1]
    share = np.where(width > 0, (values - at[right - 1]) / np.where(width > 0, width, 1), 1).clip(0, 1)
    looks = np.array([[*point["colour"], point["opacity"]] for point in points])
    looks = looks[right - 1] + (looks[right] - looks[right - 1]) * share[:, None]
    return looks[:, :3], looks[:, 3]


@dataclass(frozen=True)
class Bundle:
    """A scene as numbers. ``json`` is the bundle as it was read, ``request`` what was asked for beside it.

    What follows holds for bundles of one panel, see :meth:`alone`: cameras of each, :attr:`volumes` of classified ones,
    :attr:`surfaces`, :attr:`media` and lamps of radiance.
    """

    path: Path
    json: dict[str, Any]
    asked_step: float | None = None
    request: dict[str, Any] = field(default_factory=dict)

    @property
    def panels(self) -> list[dict[str, Any]]:
        """The panels as they were read."""
        return self.json.get("panels", [])

    def alone(self, index: int) -> Bundle:
        """The bundle of one of the panels."""
        return replace(self, json={**self.json, "panels": [self.panels[index]]})

    @property
    def panel(self) -> dict[str, Any]:
        """The panel of classified volumes as it was read. Raises Refusal if there is another, or none."""
        shows = self._only["shows"]
        if shows not in ("volume", "volumes"):
            refuse("a plot, which is no volume" if shows == "plot" else f"{shows}: no classified volume")
        return self._only

    @property
    def radiance(self) -> dict[str, Any]:
        """The panel of surfaces, lamps and media as it was read. Raises Refusal if there is another, or none."""
        if self._only["shows"] != "radiance":
            refuse(f"{self._only['shows']}: no radiance of surfaces and media")
        return self._only

    @property
    def _only(self) -> dict[str, Any]:
        if len(self.panels) != 1:
            refuse(f"{len(self.panels)} panels" if self.panels else "no panel of a classified volume")
        return self.panels[0]

    @property
    def _seen(self) -> dict[str, Any]:
        """The panel, which has a camera."""
        return self.radiance if self._only["shows"] == "radiance" else self.panel

    @property
    def surfaces(self) -> list[Part]:
        """The surfaces of :attr:`radiance` that do not shine."""
        return self._parts("surfaces")

    @property
    def area_lights(self) -> list[Part]:
        """The surfaces of :attr:`radiance` that shine."""
        return self._parts("area_lights")

    @property
    def lights(self) -> list[Part]:
        """The lamps of :attr:`radiance` that have no surface."""
        return self._parts("lights")

    @property
    def media(self) -> list[Part]:
        """The media of :attr:`radiance`."""
        return self._parts("media")

    def _parts(self, name: str) -> list[Part]:
        return [Part(f"{name}[{i}]", part, self.path.parent) for i, part in enumerate(self.radiance[name])]

    def renderings(self, most: int) -> tuple[int, list[int]]:
        """The samples per pixel that are asked for, or else the scene's, as :func:`divided` divides them."""
        own = self.radiance["samples"] or {"per_pixel": 64, "seed": 0}
        seed = self.request.get("seed")
        return divided(self.request.get("spp") or own["per_pixel"], own["seed"] if seed is None else seed, most)

    @property
    def asks(self) -> dict[str, str]:
        """Features that the picture takes beside one volume along the axes, seen from one point, interpolated between the
        points of a table and composited: names of :data:`FEATURES` or of a mode, with the words for it."""
        return self.panel["asks"]

    def allow(self, *features: str) -> None:
        """Raises Refusal if the picture takes features beside these; see :attr:`asks`."""
        for feature in features:
            one_of("feature", feature, FEATURES + MODES)
        if beside := [words for feature, words in self.asks.items() if feature not in features]:
            refuse("; ".join(beside))

    @property
    def volumes(self) -> list[Volume]:
        """The volumes."""
        panel = self.panel
        parts = panel.get("volumes", [panel])
        steps = [self.asked_step or part["sampling"]["step"] for part in parts]
        return [Volume(part, self.path.parent, step, panel.get("mode")) for part, step in zip(parts, steps)]

    @property
    def volume(self) -> Volume:
        """The only volume. Raises Refusal if there are several."""
        volumes = self.volumes
        if len(volumes) > 1:
            refuse(f"{len(volumes)} volumes")
        return volumes[0]

    @property
    def step(self) -> float:
        """Distance between samples, world units: that asked for, or else the scene's; of several volumes the
        shortest."""
        return min(volume.step for volume in self.volumes)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self._seen["width"], self._seen["height"]

    @property
    def background(self) -> tuple[float, float, float]:
        """The background, linear."""
        return tuple(self.panel["background"])

    @property
    def eye(self) -> NDArray[np.float64]:
        """The place of the eye."""
        return np.array(self._seen["ray"]["eye"])

    @property
    def forward(self) -> NDArray[np.float64]:
        """The unit vector along the line of sight, perpendicular to the image."""
        ray = self._seen["ray"]
        return np.array(ray.get("axis", ray["forward"]))

    @property
    def up(self) -> NDArray[np.float64]:
        """The unit vector up in the image."""
        return np.array(self._seen["ray"]["half_up"]) / self._half_height

    @property
    def _half_height(self) -> float:
        """Half the height of parallel rays, or the tangent of half the field of view."""
        return float(np.linalg.norm(self._seen["ray"]["half_up"]))

    @property
    def parallel_height(self) -> float | None:
        """The height of the image in the world, if rays are parallel."""
        return self._seen["ray"].get("orthographic_height")

    @property
    def field_of_view(self) -> float | None:
        """The vertical field of view in degrees, unless rays are parallel. Raises Refusal where that does not say
        where they go: :attr:`projection` does."""
        if "axis" in self._seen["ray"]:
            refuse("a camera whose image lies beside its axis, or whose pixels are not square")
        return None if self.parallel_height else float(2 * np.degrees(np.arctan(self._half_height)))

    @property
    def near_and_far(self) -> tuple[float, float]:
        """Depths that the boxes lie between, with half a voxel beyond their faces, where many renderers have theirs:
        half that of the nearest corner, and twice that of the farthest."""
        corners = np.concatenate([volume._corners(0.5) for volume in self.volumes])
        depths = (corners - self.eye) @ self.forward
        far = 2 * max(float(depths.max()), 1e-6 * float(np.abs(depths).max()))
        return max(0.5 * float(depths.min()), 1e-4 * far), far

    @property
    def view(self) -> NDArray[np.float64]:
        """From the world to the eye, 4 x 4, as in OpenGL: the eye looks along -z. Columns are multiplied."""
        matrix = np.eye(4)
        matrix[:3, :3] = np.cross(self.forward, self.up), self.up, -self.forward
        matrix[:3, 3] = -matrix[:3, :3] @ self.eye
        return matrix

    @property
    def camera_to_world(self) -> NDArray[np.float64]:
        """The inverse of :attr:`view`: columns are right, up, backward and the eye."""
        return np.linalg.inv(self.view)

    @property
    def projection(self) -> NDArray[np.float64]:
        """From the eye to clip coordinates, 4 x 4, as in OpenGL: y up, depths from -1 at :attr:`near_and_far` to 1."""
        (width, height), (near, far), half = self.size, self.near_and_far, self._half_height
        matrix = np.diag([height / width / half, 1 / half, 0.0, 0.0])
        if "axis" in self._seen["ray"]:
            ray = self._seen["ray"]
            halves, middle = np.array([ray["half_right"], ray["half_up"]]), np.array(ray["forward"])
            lengths = np.linalg.norm(halves, axis=1)
            scales = middle @ self.forward / lengths / [width / height, 1]
            matrix[[0, 1], [0, 1]] = scales
            matrix[:2, 2] = halves @ middle / lengths**2 / [width / height, 1]
        if self.parallel_height:
            matrix[2:, 2:] = [[-2 / (far - near), -(far + near) / (far - near)], [0, 1]]
        else:
            matrix[2:, 2:] = [[-(far + near) / (far - near), -2 * far * near / (far - near)], [-1, 0]]
        return matrix


def bundle(path: str | os.PathLike[str], step: float | None = None, request: dict[str, Any] | None = None) -> Bundle:
    """Reads what ``volref export --to bundle`` or :func:`volref.export` wrote; ``step`` in place of the scene's, world
    units.

    Raises VolrefError if it is none.
    """
    if step is not None and number("step", step, "a length above 0, world units", least=0.0) == 0:
        raise ValueError("step is 0: give a length above 0, world units")
    try:
        value = json.loads(Path(path).read_text("utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise VolrefError(f"{os.fspath(path)}: {error}") from None
    schema = value.get("schema") if isinstance(value, dict) else None
    if schema != SCHEMA:
        raise VolrefError(f"{os.fspath(path)}: its schema is {schema!r}, and this package reads {SCHEMA!r}")
    return Bundle(Path(path), value, step, request or {})


def save(
    path: str | os.PathLike[str],
    image: ArrayLike | None = None,
    *,
    variance: ArrayLike | None = None,
    seeds: Sequence[ArrayLike] | None = None,
    samples: int | None = None,
) -> Path:
    """Writes an image, see :mod:`volref`, as ``.exr``, ``.npy`` or ``.pfm``, or ``uint8`` as ``.png``; whole or not at
    all. Returns the path.

    ``variance``: that of the mean of each value, of ``samples`` per pixel together. ``seeds``, in place of the image:
    two or more renderings with seeds of their own, ``samples`` per pixel each, of which the mean is written and its
    variance computed. Noise takes an ``.exr``.
    """
    file = Path(path)
    one_of("the extension of the image", file.suffix, FORMATS)
    if (image is None) == (seeds is None):
        raise TypeError("give an image, or seeds")
    if seeds is not None:
        image, variance, samples = _mean(seeds, 1 if samples is None else samples)
    array = as_image(image)
    if (array.dtype == np.uint8) != (file.suffix == ".png"):
        raise TypeError(f"{file.suffix} of {array.dtype}: a .png holds uint8, sRGB; divide linear codes by 255")
    if variance is not None and file.suffix != ".exr":
        raise ValueError(f"{file.name}: an .exr alone holds a variance")
    channels = dict(zip("RGBA", np.moveaxis(array, 2, 0)))
    if variance is not None:
        if samples is None:
            raise ValueError("a variance goes with the number of samples per pixel that it is of: samples=N")
        noise = as_variance(variance, array) if seeds is None else np.asarray(variance, np.float32)
        channels |= {f"variance.{name}": noise[:, :, index] for index, name in enumerate("RGB")}
        channels["samples.Y"] = np.full(array.shape[:2], whole("samples", samples, 2, 2**32 - 2), np.uint32)
    aside = file.with_name(f".{file.stem}.partial{file.suffix}")
    if file.suffix == ".npy":
        np.save(aside, array)
    elif file.suffix == ".pfm":
        header = f"PF\n{array.shape[1]} {array.shape[0]}\n-1.0\n".encode()  # minus: little endian
        aside.write_bytes(header + array[::-1, :, :3].astype("<f4").tobytes())
    else:
        aside.write_bytes(exr(channels) if file.suffix == ".exr" else png(array))
    aside.replace(file)
    return file


def _mean(seeds: Sequence[ArrayLike], samples: int) -> tuple[NDArray[Any], NDArray[Any] | None, int]:
    """The mean of renderings, its variance, none if they agree but for rounding, and their samples together."""
    pictures = np.array([as_image(picture) for picture in seeds], float)
    if len(pictures) < 2:
        raise ValueError("seeds holds one rendering: give two or more, with seeds of their own")
    mean = pictures.mean(0)
    spread = (pictures.var(0, ddof=1) / len(pictures))[:, :, :3]
    spread[spread <= (ROUNDING * mean[:, :, :3]) ** 2] = 0
    return mean, spread if spread.any() else None, len(pictures) * whole("samples", samples, 1, 2**31)
