#!/usr/bin/env python3
"""Compares the pictures of volref with those of Mitsuba 3 (`scalar_rgb`, `volpath`).

    mitsuba.py agree SCENE... [--spp N]               do both show the same picture?

A SCENE is a file, or a name such as smoke/cornell. Needs Python 3.11 with `mitsuba` and `numpy`
(without them it says so and succeeds), and `cargo build --release`.

`agree` renders N samples with volref and twice N with Mitsuba (two seeds), and prints means and,
over blocks of 8 x 8 pixels and channels, z: the difference in standard deviations. Blocks whose
standard deviation is below 1e-4 of their value have no z, and must agree to 5e-4. For equal
pictures the root mean square of z is 1 and |z| > 3 in 0.3 % of the blocks (a little more where
light arrives by rare bright paths, whose variance is estimated too low).

What an error costs in time is measured by `efficiency.py`.

Scenes are given to Mitsuba as `volref export --to mitsuba` writes them; what it cannot say is
refused there, by name. How it says the rest is explained in src/exchange/mitsuba.rs.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
try:
    import numpy as np

    # It sees to it that this file, which has the name of the module, is not taken for it.
    from run_mitsuba import load, mi, picture, read_exr
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
        """The image, and the variance of its pixels."""
        file = self.folder / f"{name}-{seed}.exr"
        command = [self.binary, "render", self.scene, "-o", file, "--spp", spp, "--seed", seed]
        if threads:
            command += ["--threads", threads]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"volref render {self.scene} failed:\n{done.stderr}")
        return read_exr(file)


class Mitsuba:
    def __init__(self, file, folder):
        self.scenes, self.folder = load(file), folder

    def render(self, spp, seed, threads=None):
        # Set only while it renders: with a single thread, reading or writing an EXR never ends.
        usual = max(2, dr.thread_count())
        dr.set_thread_count(threads or usual)
        image = picture(self.scenes, spp, seed)
        dr.set_thread_count(usual)
        mi.Bitmap(image.astype(np.float32)).write(str(self.folder / f"mitsuba-{seed}.exr"))
        return image


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
    image, variance = volref.render(options.spp, options.seed, options.threads)
    others = [mitsuba.render(options.spp, options.seed + k, options.threads) for k in (1, 2)]
    print_agreement(image, variance, others)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("mode", choices=["agree"])
    parser.add_argument("scene", nargs="+")
    parser.add_argument("--spp", type=int, default=256, help="samples per pixel [256]")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, help="[all cores]")
    parser.add_argument("--keep", type=Path, help="folder that all images are left in")
    parser.add_argument("--volref", type=Path, default=ROOT / "target/release/volref")
    options = parser.parse_args()
    if options.spp < 2:
        parser.error("--spp must be at least 2")
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
            agree(volref, mitsuba, options)
    return status


if __name__ == "__main__":
    sys.exit(main())
