#!/usr/bin/env python3
"""How the cost of an image grows: with the nodes of a grid, pixels, samples, lights and threads.

    growth.py [--runs R] [--largest N] [--plot FILE.svg]

Renders small scenes with `target/release/volref render`, or $VOLREF, by turns, and prints tables in Markdown:
seconds of the rendering, the median of R runs, and the exponent of the growth from row to row, log(cost ratio) /
log(size ratio). Start, reading and writing do not count: `volref render --json` states the seconds of the rendering, and
one thread is used, but for the last table. There, the efficiency of two threads is the time of one over twice that of two,
of volref and of two processes of one thread that run at once: what the machine itself allows.

The grid of 1024 x 1024 x 1024 nodes takes 4 GiB on disk and 9 GiB of memory; --largest 512 leaves it out. Needs NumPy, and
Matplotlib for --plot.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
VOLREF = os.environ.get("VOLREF", str(ROOT / "target/release/volref"))

CAMERA = """[camera]
eye = [1.9, 1.3, -1.6]
target = [0.5, 0.5, 0.5]
vertical_fov = 40
"""
CLASSIFIED = """[film]
width = {pixels}
height = {pixels}
{camera}
[classified]
step = {step}
[classified.volume]
file = "{grid}"
[transfer_function]
reference_length = 0.03
point = [
    {{ value = 0, colour = [0.2, 0.3, 0.8], opacity = 0.02 }},
    {{ value = 1, colour = [1, 0.45, 0.1], opacity = 0.3 }},
]
"""
MEDIUM = """[film]
width = {pixels}
height = {pixels}
{camera}
[radiative]
scattering = "multiple"
environment = [0.2, 0.3, 0.5]
{lights}
[[radiative.medium]]
{shape}
sigma_t = {sigma_t}
albedo = 0.9
"""
GRID = 'grid = {{ file = "{grid}" }}'
BOX = "box = { min = [0, 0, 0], max = [1, 1, 1] }"
SUN = "[[radiative.light]]\ndirectional = {{ direction = [{x}, -1, 0.3], irradiance = {strength} }}\n"


def write_grid(path, nodes):
    """Waves of twelve lengths in the unit cube, between 0 and 1, plane by plane."""
    x = np.linspace(0, 1, nodes, dtype="f4")
    spacing = 1 / (nodes - 1)
    header = (f"NRRD0004\ntype: float\ndimension: 3\nsizes: {nodes} {nodes} {nodes}\nspacings: {spacing!r} "
              f"{spacing!r} {spacing!r}\nendian: little\nencoding: raw\n\n")
    with open(path, "wb") as file:
        file.write(header.encode())
        for z in x:
            plane = 0.5 + 0.2 * np.sin(40 * x + 9 * z)[None, :] + 0.2 * np.sin(33 * x - 21 * z)[:, None]
            file.write((plane + 0.1 * np.sin(97 * (x[None, :] + x[:, None] + z))).astype("<f4").tobytes())


class Bench:
    def __init__(self, folder, runs):
        self.folder, self.runs, self.started = Path(folder), runs, 0

    def start(self, text, threads, options=()):
        self.started += 1
        scene = self.folder / f"scene-{self.started}.toml"
        scene.write_text(text)
        command = [VOLREF, "render", scene, "-o", scene.with_suffix(".exr"), "--threads", threads, "--json", *options]
        return subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, text=True)

    def seconds(self, text, threads=1, options=()):
        return rendered(self.start(text, threads, options))

    def sweep(self, texts):
        """Median seconds of each scene, or scene and options; all by turns."""
        pairs = [text if isinstance(text, tuple) else (text, ()) for text in texts]
        times = [[] for _ in pairs]
        for _ in range(self.runs):
            for (text, options), seconds in zip(pairs, times):
                seconds.append(self.seconds(text, options=options))
        return [statistics.median(seconds) for seconds in times]


def rendered(process):
    """Seconds of the rendering of a process, once it has ended."""
    printed, _ = process.communicate()
    if process.returncode:
        sys.exit("volref render failed")
    return json.loads(printed)["seconds"]


def exponents(sizes, seconds):
    pairs = zip(zip(sizes, seconds), zip(sizes[1:], seconds[1:]))
    return ["", *(f"{math.log(b / a) / math.log(n / m):.2f}" for (m, a), (n, b) in pairs)]


def table(title, axis, sizes, curves):
    print(f"\n**{title}**, seconds (exponent)\n")
    print(f"| {axis} | " + " | ".join(curves) + " |")
    print("| --- |" + " --- |" * len(curves))
    columns = {name: exponents(sizes, seconds) for name, seconds in curves.items()}
    for row, size in enumerate(sizes):
        cells = []
        for name, seconds in curves.items():
            exponent = columns[name][row]
            cells.append(f"{seconds[row]:.3g}" + (f" ({exponent})" if exponent else ""))
        print(f"| {size} | " + " | ".join(cells) + " |", flush=True)


def at_once(bench, text):
    """Mean seconds of two processes of one thread that run at the same time."""
    both = [bench.start(text, 1) for _ in range(2)]
    return statistics.mean(rendered(process) for process in both)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--largest", type=int, default=1024, help="nodes along an edge of the largest grid")
    parser.add_argument("--plot", type=Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(folder, options.runs)
        panels = []

        def measured(title, axis, sizes, curves):
            measured_curves = {name: bench.sweep(texts) for name, texts in curves.items()}
            table(title, axis, sizes, measured_curves)
            panels.append((title, axis, sizes, measured_curves))

        def classified(pixels, grid, step):
            return CLASSIFIED.format(camera=CAMERA, pixels=pixels, grid=grid, step=step)

        def medium(pixels, shape, lights=1, sigma_t=8):
            # One irradiance, however many lights share it.
            suns = "".join(SUN.format(x=0.1 * index, strength=6 / lights) for index in range(lights))
            return MEDIUM.format(camera=CAMERA, pixels=pixels, shape=shape, lights=suns, sigma_t=sigma_t)

        nodes = [n for n in (64, 128, 256, 512, 1024) if n <= options.largest]
        for n in nodes:
            write_grid(Path(folder) / f"{n}.nrrd", n)
        grids = [f"{n}.nrrd" for n in nodes]
        measured("Nodes along an edge of a grid", "nodes", nodes, {
            "ray caster, step 0.5 voxels": [classified(256, grid, '"0.5 voxels"') for grid in grids],
            "ray caster, one step for all": [classified(256, grid, 0.01) for grid in grids],
            "path tracer, 16 samples": [(medium(64, GRID.format(grid=grid)), ("--spp", "16")) for grid in grids],
        })
        for grid in grids[2:]:
            (Path(folder) / grid).unlink()
        sides = [64, 128, 256, 512, 1024]
        measured("Pixels", "pixels", [side * side for side in sides], {
            "ray caster, 128 nodes": [classified(side, "128.nrrd", 0.004) for side in sides],
            "path tracer, 4 samples": [(medium(side, BOX), ("--spp", "4")) for side in sides],
        })
        samples = [4, 16, 64, 256, 1024]
        measured("Samples per pixel", "samples", samples, {
            "path tracer, box": [(medium(64, BOX), ("--spp", str(spp))) for spp in samples],
            "path tracer, grid of 128 nodes":
                [(medium(64, GRID.format(grid="128.nrrd")), ("--spp", str(spp))) for spp in samples],
        })
        lights = [1, 4, 16, 64]
        measured("Lights", "lights", lights, {
            "path tracer, box": [(medium(64, BOX, n), ("--spp", "64")) for n in lights],
            "path tracer, grid of 128 nodes":
                [(medium(64, GRID.format(grid="128.nrrd"), n), ("--spp", "16")) for n in lights],
        })
        print("\n**Two threads**\n")
        print("| scene | one thread, s | two threads, s | efficiency | two processes at once: efficiency |")
        print("| --- | --- | --- | --- | --- |")
        scenes = {
            "ray caster, 1024 × 1024 pixels": classified(1024, "128.nrrd", 0.004),
            "path tracer, box, 256 × 256 pixels, 64 samples": medium(256, BOX),
            "path tracer, grid of 128 nodes, 128 × 128 pixels, 64 samples": medium(128, GRID.format(grid="128.nrrd")),
        }
        for name, text in scenes.items():
            rows = [(bench.seconds(text), bench.seconds(text, 2), at_once(bench, text)) for _ in range(options.runs)]
            one, two, both = (statistics.median(column) for column in zip(*rows))
            print(f"| {name} | {one:.2f} | {two:.2f} | {one / two / 2:.2f} | {one / both:.2f} |", flush=True)
    if options.plot:
        draw(options.plot, panels)


def draw(path, panels):
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "growth", "font.size": 9, "axes.grid": True, "grid.alpha": 0.3})
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(2, 2, figsize=(9, 7), constrained_layout=True)
    for plot, (title, axis, sizes, curves) in zip(axes.flat, panels):
        for (name, seconds), marker in zip(curves.items(), "os^"):
            plot.loglog(sizes, seconds, marker=marker, label=name)
        least = min(seconds[0] for seconds in curves.values())
        plot.loglog(sizes, [least * size / sizes[0] for size in sizes], "k:", linewidth=1, label="in proportion")
        plot.set(title=title, xlabel=axis, ylabel="seconds, one thread")
        plot.legend(fontsize=7)
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    main()
