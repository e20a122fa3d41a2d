"""What bundles of radiance hold: shapes as triangles, media as coefficients, samples divided among renderings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from ._arguments import whole
from ._program import refuse

# pytest shows the line that called volref, not the lines of volref.
__tracebackhide__ = True

#: Rings of a sphere. Its triangles lie within 1.6e-4 of its radius: the longest edges are those of squares of pi/128,
#: and (pi/128 * sqrt(2))^2 / 8 is 1.51e-4.
RINGS = 128


class Coefficients(NamedTuple):
    """A medium that is the same everywhere: coefficients by channel, per world unit, and the mean cosine of its
    phase function, Henyey and Greenstein's."""

    absorption: NDArray[np.float64]
    scattering: NDArray[np.float64]
    emission: NDArray[np.float64]
    g: float


@dataclass(frozen=True)
class Part:
    """A surface, lamp or medium. ``json`` is what the bundle says of it, and ``key`` where."""

    key: str
    json: dict[str, Any]
    folder: Path

    def refuse(self, reason: str) -> NoReturn:
        """Raises Refusal: the renderer has no words for what ``reason`` names of this part."""
        refuse(f"{self.key}: {reason}")

    def triangles(self, smaller: float = 0.0) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Vertices in the world, of shape (n, 3), and triangles, three numbers of vertices each, anticlockwise from
        the front. ``smaller``: share by which the shape shrinks about its middle. Raises Refusal for all space."""
        shape = self.json["shape"] or self.refuse("a medium that fills all space")
        vertices, triangles = SHAPES[shape["kind"]](shape, self.folder)
        middle = (vertices.min(0) + vertices.max(0)) / 2
        vertices = middle + (1 - smaller) * (vertices - middle)
        if self.json["matrix"]:
            matrix = np.array(self.json["matrix"])
            vertices = vertices @ matrix[:, :3].T + matrix[:, 3]
            if np.linalg.det(matrix[:, :3]) < 0:
                triangles = triangles[:, ::-1]
        a, b, c = vertices[triangles].transpose(1, 0, 2)
        return vertices, triangles[np.cross(b - a, c - a).any(1)]

    def coefficients(self) -> Coefficients:
        """The coefficients of a medium. Raises Refusal for a density that varies and for other phase functions."""
        density, phase = self.json["density"] or {"kind": "constant", "value": 1.0}, self.json["phase"]
        if density["kind"] != "constant":
            refuse(f"{self.key}.density: {density['kind']}")
        if phase["kind"] != "henyey-greenstein":
            refuse(f"{self.key}.phase: {phase['kind']}")
        scaled = (density["value"] * np.array(self.json[name]) for name in ("sigma_a", "sigma_s", "emission"))
        return Coefficients(*scaled, phase["g"])


def _rectangle(shape: dict[str, Any], _: Path) -> tuple[NDArray[Any], NDArray[Any]]:
    corner, u, v = (np.array(shape[name]) for name in ("corner", "edge_u", "edge_v"))
    return np.array([corner, corner + u, corner + u + v, corner + v]), np.array([(0, 1, 2), (0, 2, 3)])


def _box(shape: dict[str, Any], _: Path) -> tuple[NDArray[Any], NDArray[Any]]:
    x, y, z = np.transpose([shape["min"], shape["max"]])
    vertices = np.array([(a, b, c) for a in x for b in y for c in z])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([half for a, b, c, d in faces for half in ((a, b, c), (a, c, d))])


def _sphere(shape: dict[str, Any], _: Path) -> tuple[NDArray[Any], NDArray[Any]]:
    columns = 2 * RINGS
    polar, around = np.meshgrid(np.pi * np.arange(RINGS + 1) / RINGS, np.pi * np.arange(columns) / RINGS, indexing="ij")
    directions = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=2)
    row, column = np.indices((RINGS, columns)).reshape(2, -1)
    a, b = row * columns + column, row * columns + (column + 1) % columns
    triangles = np.concatenate([np.stack([a, a + columns, b + columns], 1), np.stack([a, b + columns, b], 1)])
    return shape["centre"] + shape["radius"] * directions.reshape(-1, 3), triangles


def _mesh(shape: dict[str, Any], folder: Path) -> tuple[NDArray[Any], NDArray[Any]]:
    vertices, triangles = np.fromfile(folder / shape["vertices"], "<f8"), np.fromfile(folder / shape["triangles"], "<u4")
    return vertices.reshape(-1, 3), triangles.reshape(-1, 3).astype(int)


SHAPES = {"rectangle": _rectangle, "box": _box, "sphere": _sphere, "mesh": _mesh}


def divided(samples: int, seed: int, most: int) -> tuple[int, list[int]]:
    """``samples`` per pixel divided among two to ``most`` renderings: samples of each, rounded up, and the seeds, of 31
    bits, none near another.

    The spread of renderings is the noise of their mean, for renderers that do not tell it; see :func:`save`.
    """
    most = whole("most", most, 2, 2**16)
    each = math.ceil(whole("samples", samples, 1, 2**31) / most)
    states = np.random.SeedSequence(whole("seed", seed, 0, 2**64 - 1)).generate_state(max(2, math.ceil(samples / each)))
    return each, [int(state) & 0x7FFFFFFF for state in states]
