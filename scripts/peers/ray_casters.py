#!/usr/bin/env python3
"""Lets volref judge ray casters as their users have them, and prints the table of src/guide/peers.md.

    ray_casters.py                             # all of them, a quarter of an hour on two cores
    ray_casters.py vispy tutorial              # some
    ray_casters.py --table                     # the table of the results there are

Needs what README.md says for each, volref on the path or as $VOLREF, and python3 with the packages as $PYTHON.
Each is judged over the families `sampled` and `limit` under its profile. Results are kept as DIR/NAME.json.
"""

import argparse
import json
import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

HERE = Path(__file__).resolve().parent
PYTHON = os.environ.get("PYTHON", sys.executable)
VOLREF = os.environ.get("VOLREF", "volref")
PLACES = "{export:bundle} {output}"


def page(name):
    return f"node {HERE}/pages/render.js {name} {PLACES} {{step}}"


def python(script, *words):
    return " ".join([f"{PYTHON} {HERE}/{script} {PLACES}", *words, "--step {step}"])


def package(name):
    return f"{name} {metadata.version(name)}"


def node_package(name):
    file = HERE / "pages" / "node_modules" / name / "package.json"
    return json.loads(file.read_text())["version"]


# Name: profile, command, version.
RENDERERS = {
    "vtk.js": ("vtkjs", page("vtkjs"), lambda: "vtk.js " + node_package("@kitware/vtk.js")),
    "niivue": ("niivue", page("niivue"), lambda: "niivue " + node_package("@niivue/niivue")),
    "vispy": ("vispy", python("vispy_render.py"), lambda: package("vispy")),
    "vtk-gpu": (
        "pyvista-gpu",
        python("pyvista_render.py", "gpu"),
        lambda: f"{package('vtk')}, graphics card, by {package('pyvista')}",
    ),
    "vtk-cpu": (
        "pyvista-cpu",
        python("pyvista_render.py", "cpu"),
        lambda: f"{package('vtk')}, processor, by {package('pyvista')}",
    ),
    "tutorial": ("tutorial", page("tutorial"), lambda: "ray marcher of tutorials, WebGL 2"),
}


def validate(name, results):
    profile, command, _ = RENDERERS[name]
    call = [VOLREF, "validate", "sampled", "limit", "--only-present", "--format", "npy", "--as", profile]
    code = subprocess.call([*call, "--run", command, f"--json={results / name}.json"])
    if code in (2, 3):
        sys.exit(code)


def said(file):
    """The cases that the renderer has words for, by verdict."""
    cases = {}
    for case in json.loads(file.read_text())["cases"]:
        if "refused:" not in case["reason"]:
            cases.setdefault(case["verdict"], []).append(case["name"])
    return cases


def print_table(names, results):
    print("| renderer | `--as` | cases | pass | fail |")
    print("| --- | --- | --- | --- | --- |")
    for name in names:
        profile, _, version = RENDERERS[name]
        cases = said(results / f"{name}.json")
        passed = cases.pop("pass", [])
        rest = [f"`{case}`" for others in cases.values() for case in others]
        cells = [version(), f"`{profile}`", len(passed) + len(rest), len(passed), ", ".join(rest) or "none"]
        print("|", " | ".join(map(str, cells)), "|")


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(RENDERERS))
    parser.add_argument("--table", action="store_true", help="print the table, render nothing")
    parser.add_argument("--results", type=Path, default=Path("ray-casters"), metavar="DIR")
    options = parser.parse_args()
    names = options.names or list(RENDERERS)
    if unknown := set(names) - set(RENDERERS):
        parser.error(f"no such renderer: {', '.join(unknown)}; there are {', '.join(RENDERERS)}")
    options.results.mkdir(exist_ok=True)
    if not options.table:
        for name in names:
            validate(name, options.results)
    print_table(names, options.results)


if __name__ == "__main__":
    main()
