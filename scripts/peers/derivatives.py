#!/usr/bin/env python3
"""Derivatives of volref beside those of Mitsuba 3's `prbvolpath`, region by region.

    derivatives.py [--spp N] [CASE:NUMBER[:STEP] ...]

Ours is `volref sensitivity CASE --of NUMBER`, a difference of two renderings. Mitsuba's is path replay (Vicini,
Speierer & Jakob 2021), which goes backwards only: from a sum of pixels to the numbers, not to pixels. So sums over
4 x 4 regions of the image are compared (forward, pixel by pixel, `prbvolpath` refuses), all channels together,
each with the variance of runs with seeds of their own. Stated are the derivatives of the mean of the image, and the mean square of the regions' differences over their
variance: 1 is noise. An albedo of 1 can only be smaller: our difference is one-sided there, and takes a shorter step.

Needs Python 3.9 with `mitsuba` and `numpy`, LLVM 17 or newer (DRJIT_LIBLLVM_PATH names its library), and
`cargo build --release`.
"""

import argparse
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

ROOT = Path(__file__).resolve().parents[2]

mi.set_variant("llvm_ad_rgb")

#: By what the number of volref is called: the parameter of Mitsuba's scene, and how a change enters it.
PARAMETERS = {
    "density": (r"medium\d*\.sigma_t\.(data|value(\.value)?)", lambda value, t: value * (1 + t)),
    "albedo": (r"medium\d*\.albedo\.value(\.value)?", lambda value, t: value + t),
    "lamp": (r".*emitter\.radiance\.value", lambda value, t: value * (1 + t)),
    "light": (r".*\.(intensity|irradiance)\.value", lambda value, t: value * (1 + t)),
    "reflectance": (r".*\.reflectance\.value", lambda value, t: value * (1 + t)),
}
CASES = ["smoke/cornell:density", "smoke/cornell:lamp", "smoke/cornell:albedo.2:0.01", "fog/rate-0.1:density",
         "procedural/absorbing-grid:density", "procedural/coloured:density", "procedural/coloured:light",
         "procedural/gain-0.1:density", "fog/rate-0.3:density", "fog/scattering:density"]
CHANNELS = ["red", "green", "blue"]
#: Regions along an edge of the image, and runs of each.
EDGE, RUNS = 4, 8


def parameters_of(scene, name):
    """Names of the parameters that a number of volref is, and how a change enters them."""
    stem, _, index = name.partition(".")
    pattern, change = PARAMETERS[stem]
    names = [key for key, _ in mi.traverse(scene) if re.fullmatch(pattern, key)]
    if index:
        names = [key for key in names if key.startswith(f"medium{int(index) - 1}.")]
    if not names:
        raise SystemExit(f"Mitsuba's scene has no {name}: {[key for key, _ in mi.traverse(scene)]}")
    return names, change


def masks(height, width):
    """One image for each region: 1 within, 0 elsewhere."""
    rows, columns = (np.arange(size) * EDGE // size for size in (height, width))
    region = rows[:, None] * EDGE + columns[None, :]
    return [(region == at).astype(np.float32)[:, :, None].repeat(3, 2) for at in range(EDGE * EDGE)]


def derivatives(file, name, spp):
    """Of the sum of each region: mean and variance of the mean over the runs, by Mitsuba."""
    # A scene that is said channel by channel counts for that channel only.
    by_channel = 'name="channel"' in Path(file).read_text()
    settings = [{"channel": name} for name in CHANNELS] if by_channel else [{}]
    runs = np.zeros((RUNS, EDGE * EDGE))
    for channel, setting in enumerate(settings):
        scene = mi.load_file(str(file), integrator="prbvolpath", **setting)
        names, change = parameters_of(scene, name)
        film = scene.sensors()[0].film().size()
        for run in range(RUNS):
            for at, mask in enumerate(masks(film[1], film[0])):
                if by_channel:
                    mask = mask * np.eye(3, dtype=np.float32)[channel]
                parameters = mi.traverse(scene)
                kept = {key: dr.detach(type(parameters[key])(parameters[key])) for key in names}
                t = mi.Float(0.0)
                dr.enable_grad(t)
                for key in names:
                    parameters[key] = change(kept[key], t)
                parameters.update()
                # Not the same paths for every region: the regions are to be independent.
                one = (run + 1) * EDGE * EDGE + at
                image = mi.render(scene, parameters, spp=max(spp // RUNS, 1), seed=one)
                dr.backward(dr.sum(image[:, :, :3] * mi.TensorXf(mask), axis=None))
                runs[run, at] += float(dr.grad(t)[0])
                for key in names:
                    parameters[key] = kept[key]
                parameters.update()
    return runs.mean(0), runs.var(0, ddof=1) / RUNS


def read(path):
    bitmap = mi.Bitmap(str(path))
    channels = {field.name: i for i, field in enumerate(bitmap.struct_())}
    values = np.array(bitmap, float)
    return [values[:, :, [channels[f"{prefix}{c}"] for c in "RGB"]] for prefix in ("", "variance.")]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--spp", type=int, default=128)
    parser.add_argument("what", nargs="*", default=CASES)
    arguments = parser.parse_args()
    volref = os.environ.get("VOLREF", ROOT / "target/release/volref")
    print("| case | number | volref | Mitsuba | regions, squares over variance |")
    print("| --- | --- | --- | --- | --- |")
    for what in arguments.what:
        case, number, *step = what.split(":")
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)

            def call(*words):
                run = subprocess.run([volref, *words], cwd=ROOT, capture_output=True, text=True)
                if run.returncode:
                    raise SystemExit(run.stderr)

            ours = folder / "volref.exr"
            call("export", case, "--to", "mitsuba", "-o", folder)
            options = [f"--spp={arguments.spp}", "--seed=9", *(f"--step={one}" for one in step)]
            call("sensitivity", case, "--of", number, "-o", ours, *options)
            theirs, of_theirs = derivatives(folder / f"{Path(case).name}.xml", number, arguments.spp)
            image, variance = read(ours)
            regions = masks(*image.shape[:2])
            sums = np.array([(image * region).sum() for region in regions])
            # The three channels of a pixel share their random numbers: their errors add up.
            errors = np.sqrt(variance).sum(2) ** 2
            of_ours = np.array([(errors * region[:, :, 0]).sum() for region in regions])
            means = [f"{values.sum() / image.size:.5g} ± {math.sqrt(noise.sum()) / image.size:.1g}"
                     for values, noise in [(sums, of_ours), (theirs, of_theirs)]]
            squares = ((sums - theirs) ** 2 / (of_ours + of_theirs)).mean()
            print(f"| `{case}` | `{number}` | {means[0]} | {means[1]} | {squares:.2f} |", flush=True)


if __name__ == "__main__":
    main()
