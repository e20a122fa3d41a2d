#!/usr/bin/env python3
"""Renders a bundle with POV-Ray's media: emission and absorption by a density file, on the processor.

    volref validate limit --serve 'scripts/peers/povray_render.py --serve {export:bundle} {step}'

Needs POV-Ray 3.7 (Debian's povray) and `pip install volref`. A density file holds whole numbers of 16 bits; colours and
extinctions are maps of 256 entries, the most that POV-Ray takes. POV-Ray takes a number of samples for the way through
a medium, not a step: enough for the longest way.
"""

import subprocess
import tempfile
from pathlib import Path

import numpy as np
import volref

DENSEST = 1e3  # extinction of an opaque entry, over the reference length
TABLE = 256
CODES = 65535
FINER = 4  # its error is of the first order in the step: steps as asked for decide nothing


def vector(values):
    return f"<{', '.join(f'{value:.9g}' for value in values)}>"


def media(bundle, file):
    """Emission and absorption, with the density file that both read."""
    volume, grid = bundle.volume, bundle.volume.grid
    values, table = volume.values, volume.table(TABLE)
    low, high = min(values.min(), table.range[0]), max(values.max(), table.range[1])
    # A medium ends with its file, half a voxel short of the nodes that it is interpolated between.
    values = np.pad(values, 1, mode="edge")
    codes = np.round((values - low) / (high - low) * CODES).astype(">u2")
    file.write_bytes(np.array(values.shape[::-1], ">u2").tobytes() + codes.tobytes())

    at, entries = np.linspace(low, high, TABLE), np.linspace(*table.range, TABLE)
    with np.errstate(divide="ignore"):
        extinctions = np.minimum(-np.log1p(-table.opacities), DENSEST) / volume.reference_length
    spacing, first, nodes = (np.array(grid[key]) for key in ("spacing", "first_node", "nodes"))
    # Values of the nearest node fill cells. Interpolated ones lie at the lower corners of the same cells.
    corner = first - spacing * (1.5 if volume.is_nearest else 1)
    place = f"scale {vector((nodes + 2) * spacing)} translate {vector(corner)}"
    source = f'density_file df3 "{file.name}" interpolate {int(not volume.is_nearest)}'
    longest = np.linalg.norm(np.subtract(grid["box_max"], grid["box_min"]))
    samples = max(2, int(np.ceil(FINER * longest / bundle.step)))

    def part(kind, colours):
        colours = np.column_stack([np.interp(at, entries, channel) for channel in colours.T])
        listed = "".join(f"[{k / (TABLE - 1):.9g} rgb {vector(colour)}]" for k, colour in enumerate(colours))
        density = f"density {{ {source} color_map {{ {listed} }} {place} }}"
        return f"media {{ method 3 intervals 1 samples {samples}, {samples} {kind} 1 {density} }}"

    absorbed = np.repeat(extinctions[:, None], 3, axis=1)
    return part("emission", absorbed * table.colours) + part("absorption", absorbed)


def scene(bundle, folder):
    width, height = bundle.size
    kind, tall = "orthographic", bundle.parallel_height
    if not tall:
        kind, tall = "perspective", 2 * np.tan(np.radians(bundle.field_of_view) / 2)
    right, up = np.cross(bundle.forward, bundle.up) * tall * width / height, bundle.up * tall
    low, high = (vector(bundle.volume.grid[key]) for key in ("box_min", "box_max"))
    return f"""#version 3.7;
global_settings {{ assumed_gamma 1.0 max_trace_level 10 }}
background {{ rgb {vector(bundle.background)} }}
camera {{ {kind} location {vector(bundle.eye)} direction {vector(bundle.forward)} right {vector(right)} up {vector(up)} }}
box {{ {low} {high} hollow pigment {{ rgbt 1 }} finish {{ ambient 0 diffuse 0 }}
  interior {{ {media(bundle, folder / "values.df3")} }} }}
"""


def render(bundle):
    bundle.allow()
    if bundle.panel["compositing"]["method"] != "continuous":
        volref.refuse("samples at stated places: POV-Ray states their number")
    width, height = bundle.size
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "scene.pov").write_text(scene(bundle, folder))
        call = f"povray +Iscene.pov +Oimage.exr +FE +W{width} +H{height} -D -A".split()
        done = subprocess.run(call, cwd=folder, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(done.stderr[-2000:])
        Path(bundle.request["output"]).write_bytes((folder / "image.exr").read_bytes())


volref.main(render)
