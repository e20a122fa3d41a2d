#!/usr/bin/env python3
"""Writes scenes of grid media into a folder, for comparisons with Mitsuba: nothing of it is kept here.

    cloud_scenes.py FOLDER

- `cloud-isotropic.toml`, `cloud-forward.toml`: a plume on 128 x 128 x 128 nodes, albedo 0.8, g 0
  and 0.4, under a uniform sky and a sun, 256 x 256 pixels. It rises from the bottom face of its
  box, where a medium that ends at the wrong place would show. The mean optical depth of columns
  through its middle is 4.
- `lumps-nodes.toml`, `lumps-cells.toml`, `lumps-nearest.toml`: 6 x 5 x 4 random nodes in a box of
  unequal sides, 64 x 64 pixels. Half a voxel is a tenth of this box: they tell whether grids are
  put in the right place. They are coloured, and their boxes are turned.

The same bytes every time. Needs Python 3.11 and numpy.
"""

import sys
from pathlib import Path

import numpy as np

NODES = 128
DEPTH = 4.0

CLOUD = """\
title = "Plume, {name}"

[film]
width = 256
height = 256

[camera]
eye = [0.5, 0.55, -2.2]
target = [0.5, 0.5, 0.5]
vertical_fov = 27

[radiative]
environment = [0.4, 0.5, 0.7]

[[radiative.light]]
directional = {{ direction = [-0.9, -0.8, 0.5], irradiance = [5, 4.5, 4] }}

[[radiative.medium]]
grid = {{ file = "cloud.vol" }}
sigma_t = {sigma_t:.6g}
albedo = 0.8
g = {g}
"""

LUMPS = """\
title = "Lumps, {name}"

[film]
width = 64
height = 64

[camera]
eye = [0.3, 0.8, -4.5]
target = [0, 0, 0]
vertical_fov = 30

[radiative]
environment = [0.4, 0.5, 0.7]

[[radiative.light]]
directional = {{ direction = [-0.9, -0.8, 0.5], irradiance = [5, 4.5, 4] }}

[[radiative.medium]]
grid = {{ file = "lumps.vol", centring = "{centring}" }}
interpolation = "{interpolation}"
rotate = {{ axis = [1, 2, 3], angle = 40 }}
scale = [1, 1.2, 0.9]
sigma_t = [3, 4, 5]
albedo = [0.9, 0.8, 0.7]
g = 0.3
"""


def octave(places, cells, random):
    """Random values at the nodes of a lattice of `cells` a side, smoothly between them."""
    lattice = random.random((cells + 2,) * 3)
    nodes = np.minimum((places * cells).astype(int), cells)
    part = places * cells - nodes
    part = part * part * (3 - 2 * part)
    for axis in range(3):
        shape = [1] * 3
        shape[axis] = -1
        weight = part.reshape(shape)
        lattice = lattice.take(nodes, axis) * (1 - weight) + lattice.take(nodes + 1, axis) * weight
    return lattice


def plume():
    """A column of balls that grow and sway with height, broken up by five octaves of noise."""
    places = np.linspace(0, 1, NODES)
    z, y, x = np.meshgrid(places, places, places, indexing="ij", sparse=True)
    balls = np.zeros((NODES,) * 3)
    for height in np.linspace(0, 0.8, 9):
        width = 0.05 + 0.1 * height
        centre_x = 0.5 + 0.1 * np.sin(7 * height)
        centre_z = 0.5 + 0.1 * np.sin(5 * height + 1)
        squared = (x - centre_x) ** 2 + (y - height) ** 2 + (z - centre_z) ** 2
        balls += np.exp(-squared / (2 * width**2))
    random = np.random.default_rng(20)
    noise = sum(octave(places, 4 << k, random) * 0.5 ** (k + 1) for k in range(5))
    density = np.maximum(balls * np.maximum(2.5 * noise - 0.75, 0) - 0.02, 0)
    # Smoke at its source is no denser without end.
    return 1 - np.exp(-3 * density)


def write_vol(path, values, low, high):
    """Writes `values[z, y, x]` as a volume of Mitsuba's, `float32`, in a box."""
    header = np.array([1, *values.shape[::-1], 1], "<i4").tobytes()
    box = np.array([*low, *high], "<f4").tobytes()
    path.write_bytes(b"VOL\x03" + header + box + values.astype("<f4").tobytes())


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    values = plume()
    write_vol(folder / "cloud.vol", values, [0] * 3, [1] * 3)
    # Along z, in columns of the middle: the trapezoidal rule, exact for linear interpolation.
    columns = np.trapezoid(values, dx=1 / (NODES - 1), axis=0)
    middle = columns[:, NODES // 3 : 2 * NODES // 3]
    sigma_t = DEPTH / middle.mean()
    for name, g in (("isotropic", 0), ("forward", 0.4)):
        text = CLOUD.format(name=name, g=g, sigma_t=sigma_t)
        (folder / f"cloud-{name}.toml").write_text(text)
    lumps = np.random.default_rng(21).random((4, 5, 6)) ** 2
    write_vol(folder / "lumps.vol", lumps, [-1, -0.8, -0.6], [1, 0.8, 0.6])
    for name in ("nodes", "cells", "nearest"):
        centring = "cells" if name == "cells" else "nodes"
        interpolation = "nearest" if name == "nearest" else "trilinear"
        text = LUMPS.format(name=name, centring=centring, interpolation=interpolation)
        (folder / f"lumps-{name}.toml").write_text(text)
    depths = columns * sigma_t
    print(f"plume: extinction up to {sigma_t:.3g}, {values.mean() * sigma_t:.3g} on average;", end=" ")
    print(f"optical depth of columns up to {depths.max():.3g}", end="")
    print(f", median of those above 0.01 {np.median(depths[depths > 0.01]):.3g}")


if __name__ == "__main__":
    main()
