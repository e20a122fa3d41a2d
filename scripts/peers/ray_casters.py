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
import platform
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
SLOW = "marschner-lobb opaque-shell sharp-peak"
MACHINE = f"{os.cpu_count()} cores ({platform.machine()}), no graphics card, shared with other work"


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
    "k3d": Renderer("--bits 8-linear --alpha premultiplied", page("k3d"), node_package("k3d")),
    "tutorial": Renderer("--as tutorial", page("tutorial"), lambda: "ray marcher, WebGL 2"),
    "nerfacc": Renderer("", python("nerfacc_render.py"), package("nerfacc")),
    "diffdrr": Renderer("", python("diffdrr_render.py"), package("diffdrr")),
    # The other cases of the family take POV-Ray ten minutes each.
    "povray": Renderer("", python("povray_render.py"), lambda: "3.7", ["limit", *(f"!limit/{case}" for case in SLOW.split())]),
    "mitsuba": path_tracer("run_mitsuba.py", "mitsuba", package("mitsuba")),
    "cycles": path_tracer("cycles_render.py", "bundle", package("bpy")),
    "luxcore": path_tracer("lux_render.py", "bundle", package("pyluxcore")),
    # Of 64 samples two cases cannot be decided.
    "pbrt": path_tracer("run_pbrt.py", "pbrt", lambda: "4", samples=128),
}


def validate(source, renderer, explain, file):
    """Lets volref judge images, and returns its results."""
    call = [VOLREF, "validate", *source, f"--explain={explain}", *renderer.options.split(), f"--json={file}"]
    code = subprocess.call(call)
    if code in (2, 3) or not file.is_file():
        sys.exit(code)
    return json.loads(file.read_text())


def render(name, folder):
    """Renders, and keeps the images as they will be judged. Returns what volref says: refusals and times."""
    renderer = RENDERERS[name]
    format = ["--format", "npy"] if renderer.command.startswith("node") else []
    with tempfile.TemporaryDirectory() as kept:
        kept = Path(kept)
        source = [*renderer.cases, *format, "--serve", renderer.command, "--keep", kept]
        rendered = validate(source, renderer, 0, kept / "results.json")
        for old in [*folder.glob("*/*.exr"), *folder.glob("*/*.png")]:
            old.unlink()
        stops = exposures()
        for image in sorted(kept.glob("*/*.*")):
            case = f"{image.parent.name}/{image.stem.partition('@')[0]}"
            pack(image, folder / image.parent.name, rendered["origin"]["bits"], stops[case])
    about = {
        "name": name,
        "version": renderer.version(),
        "date": str(datetime.date.today()),
        "command": f"scripts/peers/ray_casters.py {name}",
        "machine": MACHINE,
    }
    lines = [f"{key} = {json.dumps(value)}\n" for key, value in about.items()]
    (folder / "renderer.toml").write_text("".join(lines))
    return rendered


def judge(name, results, explain, renders):
    """Judges the images of a renderer, new ones or those that are kept, and keeps what the page shows."""
    folder = results / name
    folder.mkdir(parents=True, exist_ok=True)
    rendered = render(name, folder) if renders else json.loads((folder / "results.json").read_text())
    known = ["--known", os.path.relpath(folder / "known.toml")] if (folder / "known.toml").is_file() else []
    with tempfile.TemporaryDirectory() as place:
        source = ["--outputs", folder, "--only-present", *known]
        judged = validate(source, RENDERERS[name], explain, Path(place) / "results.json")
    cases = {case["name"]: case for case in [*rendered["cases"], *judged["cases"]]}
    origin = {key: judged["origin"][key] for key in ("profile", "bits", "alpha")}
    times = rendered["origin"]["seconds"]
    origin["seconds"] = {case: time for case, time in times.items() if cases[case]["verdict"] not in ("missing", "error")}
    values = {"schema": judged["schema"], "cases": [*map(shown, cases.values())], "origin": origin}
    (folder / "results.json").write_text(json.dumps(values, ensure_ascii=False, indent=0) + "\n")


def shown(case):
    """What the page takes from results: it measures again."""
    return case | {"metrics": {}, "work": {}, "seconds": 0}


def exposures():
    """Stops, by case."""
    listed = subprocess.run([VOLREF, "list", "--json"], capture_output=True, check=True, cwd=HERE)
    return {case["name"]: case["exposure"] for case in json.loads(listed.stdout)["cases"]}


def pack(image, folder, bits, exposure):
    """Keeps an image as small as it can be judged again: of 8 bits as a PNG, with noise as an EXR of 32 bits, else as
    one of 16 bits."""
    import OpenEXR

    if image.suffix == ".npy":
        planes = dict(zip("RGBA", np.load(image).astype(np.float32).transpose(2, 0, 1)))
    else:
        channels = OpenEXR.File(str(image), separate_channels=True).channels()
        planes = {name: channel.pixels for name, channel in channels.items()}
    target = folder / image.stem
    target.parent.mkdir(exist_ok=True)
    # The codes of a PNG are those at the exposure of its case, and without opacity.
    if bits and exposure == 0 and len(planes) == 3:
        from PIL import Image

        linear = np.stack([planes[name] for name in "RGB"], axis=-1)
        srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear.clip(0) ** (1 / 2.4) - 0.055)
        codes = np.round(255 * (linear if bits == "8-linear" else srgb)).astype(np.uint8)
        Image.fromarray(codes).save(f"{target}.png", optimize=True)
        return
    if "variance.R" not in planes and not bits:
        planes = {name: plane.astype(np.float16) for name, plane in planes.items()}
    planes = {name: np.ascontiguousarray(plane) for name, plane in planes.items()}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, planes).write(f"{target}.exr")


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
    parser.add_argument("--again", action="store_true", help="judge the kept images again, render nothing")
    parser.add_argument("--table", action="store_true", help="print the table, render nothing")
    parser.add_argument("--explain", type=float, default=10, metavar="SECONDS", help="for a case that fails [10]")
    parser.add_argument("--results", type=Path, default=HERE / "results", metavar="DIR")
    options = parser.parse_args()
    names = options.names or list(RENDERERS)
    if unknown := set(names) - set(RENDERERS):
        parser.error(f"no such renderer: {', '.join(unknown)}; there are {', '.join(RENDERERS)}")
    if not options.table:
        for name in names:
            judge(name, options.results, options.explain, renders=not options.again)
    there = [name for name in names if (options.results / name / "results.json").is_file()]
    print_table(there, options.results)


if __name__ == "__main__":
    main()
