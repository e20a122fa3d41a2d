#!/usr/bin/env python3
"""Lets volref judge ray casters as their users have them, and keeps what `volref gallery` makes a page of.

    ray_casters.py                             # all of them, an hour on two cores
    ray_casters.py vispy pygfx                 # some
    ray_casters.py --table                     # the table of src/guide/peers.md, of the results there are
    volref gallery scripts/peers/results/* -o gallery.html

Needs what README.md says for each, mitsuba for the images of path tracers, pillow, volref on the path or as $VOLREF, and
python3 with the packages as $PYTHON; the package volref is that of this checkout.
Each renderer stays, and is asked for every case that it may have words for. Results are kept as DIR/NAME: results.json,
renderer.toml, and the images as they are displayed, of several steps that with the shortest.
"""

import argparse
import datetime
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import numpy as np

HERE = Path(__file__).resolve().parent
PYTHON = os.environ.get("PYTHON", sys.executable)
VOLREF = os.environ.get("VOLREF", "volref")
os.environ["PYTHONPATH"] = str(HERE.parents[1] / "python")

BRICKS = "ramp-31-32-33 ramp-37-19-10 ramp-63-64-65 ramp-below-zero ramp-of-16-bits spots-of-8 spots-of-16 spots-in-a-row"
CASES = ["figures", "sampled", "limit", *(f"bricks/{name}" for name in BRICKS.split()), "scenes", "reported"]
# Of the metrics, the page shows the bias.
METRICS = ("mean_difference_", "mean_z_")


def python(script, *words):
    return " ".join([PYTHON, f"{HERE}/{script}", "--serve {export:bundle} {step}", *words])


def page(name):
    return f"node {HERE.parents[1]}/npm/volref-page.js {HERE}/pages/built/{name}.js --serve {{export:bundle}} {{step}}"


def package(name):
    return lambda: metadata.version(name)


def node_package(package):
    file = HERE / "pages" / "node_modules" / package / "package.json"
    return lambda: json.loads(file.read_text())["version"]


def vtk_by_pyvista():
    return f"{metadata.version('vtk')}, by pyvista {metadata.version('pyvista')}"


class Renderer(NamedTuple):
    options: str
    command: str
    version: Callable[[], str]
    cases: list[str] = CASES


def path_tracer(script, export, version, samples=64):
    """A renderer that tells its noise, at so many samples per pixel."""
    command = f"{PYTHON} {HERE}/{script} --serve {{export:{export}}} {{spp}} {{seed}}"
    return Renderer(f"--spp {samples}", command, version, ["known-answers", "smoke"])


RENDERERS = {
    "vtk": Renderer("--as vtk", python("vtk_render.py", "--stock"), package("vtk")),
    "vtk-gpu": Renderer("--as pyvista-gpu", python("pyvista_render.py"), vtk_by_pyvista),
    "vtk-cpu": Renderer("--as pyvista-cpu", python("pyvista_render.py", "--processor cpu"), vtk_by_pyvista),
    "vispy": Renderer("--as vispy", python("vispy_render.py"), package("vispy")),
    "napari": Renderer("--as vispy", f"xvfb-run -a {python('napari_render.py')}", package("napari")),
    "pygfx": Renderer("--bits 8-srgb", python("pygfx_render.py"), package("pygfx")),
    "yt": Renderer("", python("yt_render.py"), package("yt")),
    "vtk.js": Renderer("--as vtkjs", page("vtkjs"), node_package("@kitware/vtk.js")),
    "niivue": Renderer("--as niivue", page("niivue"), node_package("@niivue/niivue")),
    "three.js": Renderer("", page("three"), node_package("three")),
    "tutorial": Renderer("--as tutorial", page("tutorial"), lambda: "ray marcher, WebGL 2"),
    "mitsuba": path_tracer("run_mitsuba.py", "mitsuba", package("mitsuba")),
    "cycles": path_tracer("cycles_render.py", "bundle", package("bpy")),
    "luxcore": path_tracer("lux_render.py", "bundle", package("pyluxcore")),
    # Of 64 samples two cases cannot be decided.
    "pbrt": path_tracer("run_pbrt.py", "pbrt", lambda: "4", samples=128),
}


def validate(name, cases, options, explain, folder, file):
    command = RENDERERS[name].command
    format = [] if "{spp}" in command else ["--format", "npy"]
    call = [VOLREF, "validate", *cases, *format, f"--explain={explain}", *options.split()]
    code = subprocess.call([*call, "--serve", command, "--keep", folder, f"--json={file}"])
    if code == 3 or not file.is_file():
        sys.exit(code)
    return json.loads(file.read_text())


def judge(name, results, explain):
    """Judges a renderer, and keeps what the page shows."""
    options = RENDERERS[name].options
    with tempfile.TemporaryDirectory() as kept:
        kept = Path(kept)
        first = validate(name, RENDERERS[name].cases, options, explain, kept / "first", kept / "first.json")
        # A profile says nothing of several volumes, surfaces and clips.
        rest = [case["name"] for case in first["cases"] if "says nothing of" in case["reason"]]
        found = [first]
        if rest:
            found.append(validate(name, rest, "", explain, kept / "rest", kept / "rest.json"))
        cases = {case["name"]: case for values in found for case in values["cases"]}
        (results / name).mkdir(parents=True, exist_ok=True)
        stops = exposures()
        for case in cases:
            keep_image(kept / ("rest" if case in rest else "first"), case, results / name, stops[case])
    seconds = {case: time for values in found for case, time in values["origin"]["seconds"].items()}
    seconds = {case: time for case, time in seconds.items() if cases[case]["verdict"] not in ("missing", "error")}
    origin = {"profile": first["origin"].get("profile"), "seconds": seconds}
    values = {"schema": first["schema"], "cases": [*map(shown, cases.values())], "origin": origin}
    (results / name / "results.json").write_text(json.dumps(values, ensure_ascii=False, indent=0) + "\n")
    about = {
        "name": name,
        "version": RENDERERS[name].version(),
        "date": str(datetime.date.today()),
        "command": f"scripts/peers/ray_casters.py {name}",
    }
    lines = [f"{key} = {json.dumps(value)}\n" for key, value in about.items()]
    (results / name / "renderer.toml").write_text("".join(lines))


def shown(case):
    metrics = {key: value for key, value in case["metrics"].items() if key.startswith(METRICS)}
    return case | {"metrics": metrics, "work": {}}


def exposures():
    """Stops, by case."""
    listed = subprocess.run([VOLREF, "list", "--json"], capture_output=True, check=True, cwd=HERE)
    return {case["name"]: case["exposure"] for case in json.loads(listed.stdout)["cases"]}


def keep_image(source, case, folder, exposure):
    """The image of a case as it is displayed, in sRGB; of several steps that with the shortest."""
    from PIL import Image

    target = folder / f"{case}.png"
    target.unlink(missing_ok=True)
    names = [f"{case}{step}.npy" for step in ("@0.25", "@0.5", "")]
    file = next((source / name for name in names if (source / name).is_file()), source / f"{case}.exr")
    if file.is_file():
        linear = (radiance(file) * 2.0**exposure).clip(0, 1)
        codes = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        target.parent.mkdir(exist_ok=True)
        Image.fromarray(np.round(255 * codes).astype(np.uint8)).save(target, optimize=True)


def radiance(file):
    if file.suffix == ".npy":
        return np.load(file)[..., :3]
    from image_file import read_exr

    return read_exr(file)[0]


def said(file):
    """The cases that the renderer has words for, by verdict."""
    cases = {}
    for case in json.loads(file.read_text())["cases"]:
        if "not rendered: " not in case["reason"] and "refused: " not in case["reason"]:
            cases.setdefault(case["verdict"], []).append(case["name"])
    return cases


def print_table(names, results):
    print("| renderer | options | cases | pass | convention | other |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name in names:
        cases = said(results / name / "results.json")
        counts = [len(cases.pop(verdict, [])) for verdict in ("pass", "convention")]
        rest = [f"`{case}`" for others in cases.values() for case in others]
        options = RENDERERS[name].options.replace(f"{HERE}/", "")
        cells = [f"{name} {RENDERERS[name].version()}", f"`{options}`" if options else "", sum(counts) + len(rest), *counts]
        print("|", " | ".join(map(str, [*cells, ", ".join(rest) or "none"])), "|")


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(RENDERERS))
    parser.add_argument("--table", action="store_true", help="print the table, render nothing")
    parser.add_argument("--explain", type=float, default=10, metavar="SECONDS", help="for a case that fails [10]")
    parser.add_argument("--results", type=Path, default=HERE / "results", metavar="DIR")
    options = parser.parse_args()
    names = options.names or list(RENDERERS)
    if unknown := set(names) - set(RENDERERS):
        parser.error(f"no such renderer: {', '.join(unknown)}; there are {', '.join(RENDERERS)}")
    if not options.table:
        for name in names:
            judge(name, options.results, options.explain)
    there = [name for name in names if (options.results / name / "results.json").is_file()]
    print_table(there, options.results)


if __name__ == "__main__":
    main()
