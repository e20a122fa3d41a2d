#!/usr/bin/env python3
"""Puts faults of known size into a scene that Mitsuba 3 renders, and lets `volref validate --decide` judge.

    faults.py VOLREF PYTHON [--case smoke/cornell] [--budget 3m] [--spp 64] [--sizes 0.5 1 2 5]

VOLREF is the program, PYTHON an interpreter with `mitsuba`. Prints the table of `src/guide/peers.md`: of each fault
and size the verdict, the samples per pixel at which it was reached, and the change that the verdict names. The scene of
the case is edited, exported and rendered; volref judges by the golden of the scene as it is. At 64 samples two minutes for
the twenty faults of `smoke/cornell`, at 1024 half an hour.
"""

import argparse
import json
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


def scaled(text, pattern, factor, only=None):
    """`text` with the numbers that `pattern` has as its second group times `factor`, in match `only` or all."""
    count = 0

    def edit(match):
        nonlocal count
        count += 1
        if only not in (None, count - 1):
            return match[0]
        return match[1] + re.sub(r"[\d.]+", lambda number: repr(float(number[0]) * factor), match[2])

    edited = re.sub(pattern, edit, text, flags=re.M)
    assert edited != text, pattern
    return edited


# Of the Cornell room: what a fault of the share `s` makes of the scene.
FAULTS = {
    "density of both boxes": lambda text, s: scaled(text, r"^(sigma_t = )(.*)", 1 + s),
    "albedo of the white box (1 less)": lambda text, s: scaled(text, r"^(albedo = )(1)$", 1 - s),
    "g of the white box (0 more)": lambda text, s: text.rstrip("\n") + f"\ng = {s}\n",
    "light": lambda text, s: scaled(text, r"(radiance = )([\d.]+)", 1 + s),
    "the green wall": lambda text, s: scaled(text, r"^(diffuse = \{ reflectance = )(.*\])", 1 + s, only=0),
}


def samples(notes):
    """Samples per pixel of the last look, as the note says."""
    found = re.search(r"(\d+) samples per pixel", " ".join(notes))
    return found[1] if found else ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("volref")
    parser.add_argument("python")
    parser.add_argument("--case", default="smoke/cornell")
    parser.add_argument("--budget", default="3m")
    parser.add_argument("--spp", default="64")
    parser.add_argument("--sizes", nargs="+", type=float, default=[0.5, 1, 2, 5])
    options = parser.parse_args()
    scene = ROOT / "fixtures" / "scenes" / f"{options.case}.toml"
    print("| fault | " + " | ".join(f"{size:g} %" for size in options.sizes) + " |")
    print("| --- |" + " --- |" * len(options.sizes), flush=True)
    for name, fault in FAULTS.items():
        cells = []
        for size in options.sizes:
            with tempfile.TemporaryDirectory() as folder:
                wrong = Path(folder) / "wrong.toml"
                wrong.write_text(fault(scene.read_text(), size / 100))
                exported = [options.volref, "export", wrong, "--to", "mitsuba", "-o", Path(folder) / "export"]
                subprocess.run(exported, check=True, stdout=subprocess.DEVNULL)
                [xml] = Path(folder).glob("export/*.xml")
                command = shlex.join([options.python, str(HERE / "run_mitsuba.py"), str(xml)])
                run = [
                    options.volref, "validate", options.case, "--explain", "0", "--decide", "--budget", options.budget,
                    "--spp", options.spp, "--json", "--run", command + " {output} --spp {spp} --seed {seed}",
                ]
                done = subprocess.run(run, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            [case] = json.loads(done.stdout)["cases"]
            changes = case.get("changes", [])
            named = [change["words"] for change in changes if change["fits_best"]]
            # What these images cannot tell from it.
            named += ["or " + change["words"] for change in changes if change["alike"]][:2]
            print(name, size, json.dumps(case), file=sys.stderr, flush=True)
            words = [case["verdict"], samples(case.get("notes", [])) or options.spp, "; ".join(named)]
            cells.append(", ".join(word for word in words if word))
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
