#!/usr/bin/env python3
"""Renders an exported scene with pbrt-v4 and writes what volref compares.

    run_pbrt.py SCENE.pbrt OUTPUT.exr [--spp N] [--seed S] [--replicates R] [--jobs J]
    volref validate --serve 'python3 scripts/peers/run_pbrt.py --serve {export:pbrt} {spp} {seed}'

SCENE.pbrt is what `volref export --to pbrt` writes; of a scene with colours the file of one channel, beside which are
those of the others. OUTPUT.exr holds the noise, too, as `run_mitsuba.py` states it. The program `pbrt` is the one that
$PBRT names, or else the first on $PATH.

pbrt follows light at four wavelengths at a time, drawn at random for each sample, and a picture of grey things is
therefore tinted and has noise of colour that says nothing of the scene. The exports are grey (a coloured scene is three
grey ones), so every sample takes the same four wavelengths (`--disable-wavelength-jitter`), and of the picture the green
is taken, divided by the green of a picture of a radiance of 1 everywhere: what is left is radiance. Any channel would
do; green has the most of the four and keeps the most digits.

Pictures are rendered side by side, each by one thread: with more, pbrt ends by a signal where the eye is in a medium
(`scene.cpp`: while `CreateMedia` goes through the jobs of media, the camera's thread takes one away in `GetMedium`).
"""

import argparse
import os
import shutil
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import volref

CHANNELS = ["red", "green", "blue"]
# A radiance of 1 from everywhere.
WHITE = """\
Film "rgb" "integer xresolution" [ 1 ] "integer yresolution" [ 1 ] "bool savefp16" [ false ]
Camera "perspective" Sampler "independent" "integer pixelsamples" [ 1 ] Integrator "volpath"
WorldBegin LightSource "infinite" "rgb L" [ 1 1 1 ]
"""


def green(scene, folder, spp, seed):
    """The green of one picture, of grey not yet radiance."""
    output = folder / f"{scene.stem}.{seed}.pfm"
    options = {"--nthreads": 1, "--spp": spp, "--seed": seed, "--outfile": output}
    program = shutil.which(os.environ.get("PBRT", "pbrt"))
    words = [program, "--quiet", "--disable-wavelength-jitter", *(str(word) for item in options.items() for word in item)]
    run = subprocess.run([*words, scene], capture_output=True, text=True)
    if run.returncode != 0:
        raise SystemExit(f"pbrt could not render {scene}: {(run.stderr + run.stdout).strip() or run.returncode}")
    # A PFM has three lines of text and 32-bit floats, rows from the bottom; pbrt writes the bytes of the machine.
    _, size, _, values = output.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    return np.frombuffer(values, "<f4").reshape(height, width, 3)[::-1, :, 1].astype(float)


def render(request, replicates, jobs):
    named, scene = os.environ.get("PBRT", "pbrt"), Path(request["export:pbrt"])
    stem, _, channel = scene.stem.rpartition(".")
    scenes = [scene.with_name(f"{stem}.{it}.pbrt") for it in CHANNELS] if channel in CHANNELS else [scene]
    if missing := [str(file) for file in scenes if not file.exists()]:
        raise SystemExit(f"a channel is missing: {', '.join(missing)}")
    if shutil.which(named) is None:
        raise SystemExit(f"$PBRT or the path: {named}, which is no program; how pbrt is built is in scripts/peers/README.md")
    own = {"spp": 64, "seed": 0} | {name: value for name, value in request.items() if value is not None}
    samples, seeds = volref.divided(own["spp"], own["seed"], replicates)
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(jobs) as side_by_side:
        white = Path(folder) / "white.pbrt"
        white.write_text(WHITE)
        unit = green(white, Path(folder), 1, 0)[0, 0]
        run = lambda seed: [green(file, Path(folder), samples, seed) / unit for file in scenes] * (3 // len(scenes))
        pictures = [np.stack(channels, axis=2) for channels in side_by_side.map(run, seeds)]
    volref.save(request["output"], seeds=pictures, samples=samples)


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--replicates", type=int, default=16, help="at most so many pictures [16]")
parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="pictures at the same time [a processor each]")
volref.main(render, parser, export="pbrt")
