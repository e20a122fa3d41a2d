#!/usr/bin/env python3
"""Compares volref with Mitsuba 3 (`scalar_rgb`, `volpath`) on the same scenes.

    mitsuba.py agree SCENE... [--spp N]               do both show the same picture?
    mitsuba.py efficiency SCENE... [--spp N] [--runs R]   error squared times CPU time, as a ratio

A SCENE is a file, or a name such as smoke/cornell. Needs Python 3.11 with `mitsuba` and `numpy`
(without them it says so and succeeds), and `cargo build --release`.

`agree` renders N samples with volref and twice N with Mitsuba (two seeds), and prints means and,
over blocks of 8 x 8 pixels and channels, z: the difference in standard deviations. Blocks whose
standard deviation is below 1e-4 of their value have no z, and must agree to 5e-4. For equal
pictures the root mean square of z is 1 and |z| > 3 in 0.3 % of the blocks (a little more where
light arrives by rare bright paths, whose variance is estimated too low).

`efficiency` alternates one-thread runs of both, each with a seed of its own. The error is the mean
over pixels and channels of (x - ref)^2 / (ref^2 + 0.01^2); ref is a long render of volref, whose
own noise is subtracted; all Mitsuba runs together are compared with it as in `agree`. Efficiency
is 1 / (error x CPU seconds). Neither start, loading nor writing counts: volref's time is the CPU
time of a run less that of a run of 2 samples, Mitsuba's the CPU time of a second and later call
of `render` on a loaded scene.

Scenes are given to Mitsuba as `volref export --to mitsuba` writes them; what it cannot say is
refused there, by name. How it says the rest is explained in src/exchange/mitsuba.rs.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
try:
    import numpy as np

    # It sees to it that this file, which has the name of the module, is not taken for it.
    from run_mitsuba import load, mi, picture
    import drjit as dr
except ImportError as error:
    print(f"skipped: {error} (to compare with Mitsuba: pip install mitsuba numpy)")
    sys.exit(0)

TINY = 1e-4


def find(name):
    """The file of a scene given by path, or by name as in smoke/cornell."""
    for path in (Path(name), ROOT / "fixtures/scenes" / f"{name}.toml"):
        if path.is_file():
            return path
    raise FileNotFoundError(f"no scene {name}: neither a file nor in fixtures/scenes")


class Refused(Exception):
    """The scene cannot be exported."""


# --- Renderers ---------------------------------------------------------------------------------


def cpu_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Volref:
    def __init__(self, binary, scene, folder):
        self.binary, self.scene, self.folder = binary, scene, folder

    def export(self):
        """The scene as Mitsuba takes it."""
        command = [self.binary, "export", self.scene, "--to", "mitsuba", "-o", self.folder, "--json"]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if done.returncode:
            raise Refused(done.stderr)
        return self.folder / json.loads(done.stdout)["main"]

    def render(self, spp, seed, threads, name="volref"):
        """The image, the variance of its pixels, and CPU seconds of the whole run."""
        file = self.folder / f"{name}-{seed}.exr"
        command = [self.binary, "render", self.scene, "-o", file, "--spp", spp, "--seed", seed]
        if threads:
            command += ["--threads", threads]
        before = cpu_of_children()
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        seconds = cpu_of_children() - before
        if done.returncode:
            sys.exit(f"volref render {self.scene} failed:\n{done.stderr}")
        return *read_exr(file), seconds


def read_exr(file):
    bitmap = mi.Bitmap(str(file))
    channels = {field.name: i for i, field in enumerate(bitmap.struct_())}
    values = np.array(bitmap, float)
    image = values[:, :, [channels[c] for c in "RGB"]]
    if "variance.R" not in channels:
        return image, np.zeros_like(image)
    return image, values[:, :, [channels[f"variance.{c}"] for c in "RGB"]]


class Mitsuba:
    def __init__(self, file, folder):
        self.scenes, self.folder = load(file), folder

    def render(self, spp, seed, threads=None):
        # Set only while it renders: with a single thread, reading or writing an EXR never ends.
        usual = max(2, dr.thread_count())
        dr.set_thread_count(threads or usual)
        before = time.process_time()
        image = picture(self.scenes, spp, seed)
        seconds = time.process_time() - before
        dr.set_thread_count(usual)
        mi.Bitmap(image.astype(np.float32)).write(str(self.folder / f"mitsuba-{seed}.exr"))
        return image, seconds


# --- What is measured --------------------------------------------------------------------------


def blocks(image):
    """Sums over blocks of 8 x 8 pixels; an incomplete margin is left out."""
    rows, columns = image.shape[0] // 8, image.shape[1] // 8
    image = image[: rows * 8, : columns * 8]
    return image.reshape(rows, 8, columns, 8, 3).sum(axis=(1, 3))


def deviations(difference, variance):
    # What neither renderer lights has no variance and no difference.
    return np.divide(difference, np.sqrt(variance), where=variance > 0, out=difference * 0)


def print_agreement(image, variance, others):
    """Compares an image of volref's with several of Mitsuba's."""
    mean = np.mean(others, axis=0)
    spread = np.var(others, axis=0, ddof=1) / len(others)
    a, b = image.mean((0, 1)), mean.mean((0, 1))
    whole = deviations(a - b, (variance + spread).mean((0, 1)) / (image[:, :, 0].size))
    print(f"  mean, volref        {a[0]:.6f} {a[1]:.6f} {a[2]:.6f}")
    print(f"  mean, Mitsuba       {b[0]:.6f} {b[1]:.6f} {b[2]:.6f}")
    relative = 100 * (a - b) / np.maximum(np.maximum(a, b), 1e-30)
    print("  volref - Mitsuba    " + " ".join(f"{r:+.3f}%" for r in relative), end="")
    print("   z of the mean " + " ".join(f"{z:+.1f}" for z in whole))
    difference = blocks(image) - blocks(mean)
    noise = blocks(variance) + blocks(spread)
    # Of blocks that show little but the sky, rounding decides: Mitsuba adds up in single precision.
    tiny = TINY * np.abs(blocks(image))
    by_lot = noise > tiny**2
    z = np.where(by_lot, deviations(difference, noise), 0)
    drawn = z[by_lot]
    places = np.abs(z).max(2)
    worst = np.unravel_index(places.argmax(), places.shape)
    print(f"  z of 8x8 blocks     root mean square {np.sqrt((drawn**2).mean()):.2f}", end="")
    print(f", |z| > 3 in {100 * (np.abs(drawn) > 3).mean():.2f} % of {drawn.size}", end="")
    print(f", largest {places.max():.1f} at pixel ({worst[1] * 8}, {worst[0] * 8})", flush=True)
    off = np.abs(difference[~by_lot]) > 5 * tiny[~by_lot]
    if off.any():
        print(f"  {off.sum()} blocks that hardly vary differ", flush=True)


def agree(volref, mitsuba, options):
    image, variance, _ = volref.render(options.spp, options.seed, options.threads)
    others = [mitsuba.render(options.spp, options.seed + k, options.threads)[0] for k in (1, 2)]
    print_agreement(image, variance, others)


class Reference:
    def __init__(self, image, variance):
        self.image, self.scale = image, image**2 + 0.01**2
        self.noise = variance / self.scale

    def squares(self, image):
        return (image - self.image) ** 2 / self.scale

    def error(self, image):
        return (self.squares(image) - self.noise).mean()


def efficiency(volref, mitsuba, options):
    if options.reference:
        long, variance = read_exr(options.reference)
    else:
        long, variance, _ = volref.render(options.reference_spp, 1 << 20, options.threads, "long")
    reference = Reference(long, variance)
    mitsuba.render(1, options.seed, 1)
    spp, rounds = options.spp, []
    ours, theirs = [], []
    for seed in range(options.seed + 1, options.seed + options.runs + 1):
        start = volref.render(2, seed, 1, "start")[2]
        image, _, whole = volref.render(spp, seed, 1)
        ours.append(image)
        # Of the whole run, the shorter one also rendered two samples.
        first = (whole - start) * spp / (spp - 2), reference.error(image)
        image, second = mitsuba.render(spp, seed, 1)
        theirs.append(image)
        rounds.append((*first, second, reference.error(image)))
    paths = long[:, :, 0].size * spp
    for name, seconds, error in (("volref ", 0, 1), ("Mitsuba", 2, 3)):
        times = [r[seconds] for r in rounds]
        errors = [r[error] for r in rounds]
        images = ours if name == "volref " else theirs
        squares = np.mean([reference.squares(image).mean(2) for image in images], axis=0)
        ordered = np.sort(squares.ravel())[::-1]
        share = ordered[: ordered.size // 100].sum() / ordered.sum()
        print(f"  {name} {paths / statistics.median(times) / 1e3:8.0f} thousand paths/s", end="")
        print(f"  error {statistics.median(errors):.5f} ({min(errors):.5f}", end="")
        print(f" to {max(errors):.5f}) with {spp} samples", end="")
        print(f", {100 * share:.0f} % of it in 1 % of the pixels")
    ratios = sorted(b * tb / (a * ta) for ta, a, tb, b in rounds)
    means = np.mean(rounds, axis=0)
    print(f"  efficiency, volref / Mitsuba: median {statistics.median(ratios):.2f}", end="")
    print(f" ({ratios[0]:.2f} to {ratios[-1]:.2f} in {len(rounds)} runs)", end="")
    print(f"; by mean errors and times {means[3] * means[2] / (means[1] * means[0]):.2f}")
    print(f"  the reference against all {len(theirs)} Mitsuba runs:")
    print_agreement(long, variance, theirs)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("mode", choices=["agree", "efficiency"])
    parser.add_argument("scene", nargs="+")
    parser.add_argument("--spp", type=int, help="samples per pixel [256; efficiency: 16]")
    parser.add_argument("--runs", type=int, default=5, help="rounds of efficiency [5]")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--reference", help="a long EXR of volref's, rendered before")
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--threads", type=int, help="where nothing is measured [all cores]")
    parser.add_argument("--keep", type=Path, help="folder that all images are left in")
    parser.add_argument("--volref", type=Path, default=ROOT / "target/release/volref")
    options = parser.parse_args()
    options.spp = options.spp or (256 if options.mode == "agree" else 16)
    if options.spp < 3 or options.runs < 2:
        parser.error("--spp must be at least 3 and --runs 2")
    if options.reference and len(options.scene) > 1:
        parser.error("--reference is for a single scene")
    if not os.access(options.volref, os.X_OK):
        print(f"there is no {options.volref}: `cargo build --release` makes it", file=sys.stderr)
        return 2
    status = 0
    for name in options.scene:
        with tempfile.TemporaryDirectory() as folder:
            try:
                path = find(name)
                folder = options.keep / path.stem if options.keep else Path(folder)
                folder.mkdir(parents=True, exist_ok=True)
                volref = Volref(options.volref, path, folder)
                mitsuba = Mitsuba(volref.export(), folder)
            except (Refused, FileNotFoundError) as error:
                print(f"{name}: refused: {error}", file=sys.stderr)
                status = 2
                continue
            print(f"{name}: {options.spp} samples, Mitsuba {mi.__version__}", flush=True)
            {"agree": agree, "efficiency": efficiency}[options.mode](volref, mitsuba, options)
    return status


if __name__ == "__main__":
    sys.exit(main())
