#!/usr/bin/env python3
"""Renders an exported scene with pbrt-v4 and writes what volref compares.

    run_pbrt.py SCENE.pbrt OUTPUT.exr [--spp N] [--seed S] [--replicates R] [--jobs J]

SCENE.pbrt is what `volref export --to pbrt` writes; of a scene with colours the file of one channel,
beside which are those of the others. OUTPUT.exr holds R, G and B and, where the picture has noise,
the variance of their means (`variance.R`, `.G`, `.B`) and the samples per pixel (`samples.Y`). Made
for

    volref validate --run 'python3 scripts/peers/run_pbrt.py {export:pbrt} {output} \\
        --spp {spp} --seed {seed}'

The program `pbrt` is the one that $PBRT names, or else the first on $PATH.

pbrt follows light at four wavelengths at a time, drawn at random for each sample, and a picture of
grey things is therefore tinted and has noise of colour that says nothing of the scene. The
exports are grey (a coloured scene is three grey ones), so every sample takes the same four wavelengths
(`--disable-wavelength-jitter`), and of the picture the green is taken, divided by the green
of a picture of a radiance of 1 everywhere: what is left is radiance. Any channel would do; green
has the most of the four and keeps the most digits.

Noise is stated as `run_mitsuba.py` states it, by pictures with seeds of their own (16, or one for
each sample if there are fewer). They are rendered side by side, each by one thread: with more, pbrt
ends by a signal where the eye is in a medium (`scene.cpp`: while `CreateMedia` goes through the jobs
of media, the camera's thread takes one away in `GetMedium`).

Needs Python 3.11 with `volref`.
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
from replicates import seeds, shares

CHANNELS = ["red", "green", "blue"]
GREEN = 1

# A radiance of 1 from everywhere.
WHITE = """\
Film "rgb" "integer xresolution" [ 1 ] "integer yresolution" [ 1 ] "bool savefp16" [ false ]
Camera "perspective"
Sampler "independent" "integer pixelsamples" [ 1 ]
Integrator "volpath"
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
"""


def program():
    """Where pbrt is."""
    named = os.environ.get("PBRT")
    found = shutil.which(named or "pbrt")
    if found is None:
        wrong = f"$PBRT names {named}, which is no program" if named else "no program `pbrt` on $PATH, and no $PBRT"
        raise SystemExit(f"run_pbrt.py: {wrong}; how pbrt is built is in scripts/peers/README.md")
    return found


def read_pfm(path):
    """The picture in a PFM of three channels, rows from the top."""
    with open(path, "rb") as file:
        kind, size, scale = (file.readline().decode().split() for _ in range(3))
        if kind != ["PF"]:
            raise SystemExit(f"run_pbrt.py: {path} is no PFM of three channels")
        width, height = map(int, size)
        order = "<" if float(scale[0]) < 0 else ">"
        values = np.frombuffer(file.read(), f"{order}f4", count=width * height * 3)
    return values.reshape(height, width, 3)[::-1].astype(float)


class Pbrt:
    """The program, and a folder for what it writes."""

    def __init__(self, folder):
        self.program = program()
        self.folder = Path(folder)
        white = self.folder / "white.pbrt"
        white.write_text(WHITE)
        self.white = self.green(white, 1, 0)[0, 0]

    def green(self, scene, spp, seed):
        """The green of one picture, of grey not yet radiance."""
        output = self.folder / f"{scene.stem}.{seed}.pfm"
        command = [
            self.program, "--quiet", "--disable-wavelength-jitter", "--nthreads", "1",
            "--spp", str(spp), "--seed", str(seed), "--outfile", str(output), str(scene),
        ]
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode != 0:
            said = (run.stderr + run.stdout).strip() or f"it ended with {run.returncode}"
            raise SystemExit(f"run_pbrt.py: pbrt could not render {scene}: {said}")
        return read_pfm(output)[:, :, GREEN]

    def picture(self, scenes, spp, seed):
        """Radiance of a scene: a file, or one for each channel."""
        channels = [self.green(scene, spp, seed) / self.white for scene in scenes]
        return np.stack(channels * (3 // len(channels)), axis=2)


def files(scene):
    """The file of a grey scene, or the three of a coloured one."""
    name = scene.name.removesuffix(".pbrt")
    stem, _, channel = name.rpartition(".")
    if channel not in CHANNELS:
        return [scene]
    scenes = [scene.with_name(f"{stem}.{channel}.pbrt") for channel in CHANNELS]
    missing = [str(file) for file in scenes if not file.exists()]
    if missing:
        raise SystemExit(f"run_pbrt.py: a channel is missing: {', '.join(missing)}")
    return scenes


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel [64]")
    parser.add_argument("--seed", type=int, default=0, help="any whole number from 0 on [0]")
    parser.add_argument("--replicates", type=int, default=16, help="at most so many pictures [16]")
    parser.add_argument("--jobs", type=int, help="pictures at the same time [a processor each]")
    options = parser.parse_args()
    if options.spp < 2 or options.seed < 0 or options.replicates < 2:
        parser.error("--spp and --replicates are at least 2, --seed is not negative")
    scenes = files(options.scene)
    samples, count = shares(options.spp, options.replicates)
    jobs = options.jobs or os.cpu_count()
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(jobs) as side_by_side:
        pbrt = Pbrt(folder)
        renders = [
            side_by_side.submit(pbrt.picture, scenes, samples, seed)
            for seed in seeds(options.seed, count)
        ]
        pictures = [render.result() for render in renders]
    volref.save(options.output, seeds=pictures, samples=samples)


if __name__ == "__main__":
    main()
