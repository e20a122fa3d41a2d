#!/usr/bin/env python3
"""What it costs to call another renderer, and to divide the work among processes: tables in Markdown.

    overheads.py [--runs R] [--cases N]

Medians of R runs by turns, and their range; seconds of the wall clock. `student.py` draws eight cases, started for each image
(`--run`) and once for all (`--serve`). N small cases are verified in ten parts, and their results merged. Takes some minutes;
needs NumPy and a release build, or the program that $VOLREF names.
"""

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VOLREF = os.environ.get("VOLREF", str(ROOT / "target/release/volref"))
STUDENT = "python3 scripts/peers/student.py"
DRAWN = ["figures/figure-1", "figures/figure-2", "figures/figure-3", "figures/figure-4",
         "scenes/maximum", "scenes/maximum-exact", "scenes/mean", "scenes/minimum-exact"]
SCENE = """film = {{ width = 8, height = 8 }}
camera = {{ eye = [0, 0, -4], target = [0, 0, 0], vertical_fov = 40 }}
[radiative]
scattering = "none"
environment = 1
[[radiative.medium]]
sphere = {{ centre = [0, 0, 0], radius = 1 }}
sigma_a = {sigma_a}
"""
MANIFEST = """class = "deterministic"
source = "Beer's law"
shows = "A ball that absorbs."
computes = "exp(-chord)"
"""


def volref(folder, *words, **more):
    """Seconds of a command, and what it printed. It writes goldens, so that it must not run as in CI."""
    environment = {key: value for key, value in os.environ.items() if key not in ("CI", "VOLREF_SUITE")}
    before = time.perf_counter()
    done = subprocess.run([VOLREF, *words], cwd=folder, env=environment | more, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"volref {' '.join(words)}: {done.stdout}{done.stderr}")
    return time.perf_counter() - before, done.stdout


def table(columns, rows):
    print("| " + " | ".join(columns) + " |\n|" + " --- |" * len(columns))
    for name, seconds in rows:
        print(f"| {name} | {statistics.median(seconds):.2f} ({min(seconds):.2f} to {max(seconds):.2f}) |", flush=True)


def calls(runs):
    """Seconds of each run of all cases, by program that is started for each image, and that stays."""
    kinds = {"--run": f"{STUDENT} {{export:bundle}} {{output}}", "--serve": f"{STUDENT} --serve {{export:bundle}}"}
    seconds = {kind: [] for kind in kinds}
    for _ in range(runs):
        for kind, command in kinds.items():
            seconds[kind].append(volref(ROOT, "validate", *DRAWN, kind, command)[0])
    return [(f"`{kind}`", seconds[kind]) for kind in kinds]


def parts(folder, runs, count):
    """Seconds of one part of many cases in which there is one case, of ten parts, and of their merge."""
    scenes, manifests = folder / "many/fixtures/scenes/many", folder / "many/fixtures/cases/many"
    scenes.mkdir(parents=True)
    manifests.mkdir(parents=True)
    for number in range(count):
        (scenes / f"{number:05}.toml").write_text(SCENE.format(sigma_a=(number + 1) / count))
        (manifests / f"{number:05}.toml").write_text(MANIFEST)
    many = folder / "many"
    volref(many, "accept", "many", "--reason", "measured")
    one, ten, merged = [], [], []
    for _ in range(runs):
        for kept in ("one", "ten"):
            shutil.rmtree(many / kept, ignore_errors=True)
        verify = ["verify", "--results"]
        one.append(volref(many, *verify, "one", "--partition", f"slice:1/{count}")[0])
        ten.append(sum(volref(many, *verify, "ten", "--partition", f"slice:{part}/10")[0] for part in range(1, 11)))
        merged.append(volref(many, "merge", "ten")[0])
    return [(f"a part with one of {count} cases", one), (f"ten parts of {count} cases, one after the other", ten),
            ("`merge` of their results", merged)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3, help="[3]")
    parser.add_argument("--cases", type=int, default=10000, help="cases that are divided among ten parts [10000]")
    options = parser.parse_args()
    table(["eight cases, drawn by `student.py`", "s"], calls(options.runs))
    with tempfile.TemporaryDirectory() as folder:
        rows = parts(Path(folder), options.runs, options.cases)
        print("\nThe cases have 8 × 8 pixels.\n")
        table(["work divided", "s"], rows)


if __name__ == "__main__":
    main()
