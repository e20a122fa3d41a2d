#!/usr/bin/env python3
"""Renders an exported scene with Mitsuba 3 (`scalar_rgb`) and writes what volref compares.

    run_mitsuba.py SCENE.xml OUTPUT.exr [--spp N] [--seed S] [--replicates R]

SCENE.xml is what `volref export --to mitsuba` writes. OUTPUT.exr holds R, G and B and, where the
picture has noise, the variance of their means (`variance.R`, `.G`, `.B`) and the samples per pixel
(`samples.Y`). Made for

    volref validate --run 'python3 scripts/peers/run_mitsuba.py {export:mitsuba} {output} \\
        --spp {spp} --seed {seed}'

Mitsuba tells the noise of a picture in no channel of its own, so the samples are divided among R
pictures with seeds of their own (64, or one for each sample if there are fewer), and the variance
of the mean is that of the pictures over R. N is rounded up to a multiple of their samples. What is
added for rounding, and when no noise is stated, is in `replicates.py`.

A scene that is said channel by channel (it has a parameter `channel`) is rendered three times,
N samples each, and of every picture that channel is taken.

Needs Python 3.9 with `mitsuba` and `numpy`.
"""

import argparse
import sys
import xml.etree.ElementTree
from pathlib import Path

import numpy as np
from replicates import seeds, shares, summary, write

# The neighbour `mitsuba.py` has the name of the module that is needed here.
HERE = Path(__file__).resolve().parent
sys.path[:] = [path for path in sys.path if Path(path or ".").resolve() != HERE]
import mitsuba as mi  # noqa: E402

mi.set_variant("scalar_rgb")

CHANNELS = ["red", "green", "blue"]


def parameters(scene):
    """Names and default values of the parameters of a scene."""
    root = xml.etree.ElementTree.parse(scene).getroot()
    return {default.get("name"): default.get("value") for default in root.iter("default")}


def load(file, settings=None):
    """The scene of a file, or one for each channel."""
    settings = settings or {}
    if "channel" in parameters(file):
        return [mi.load_file(str(file), channel=channel, **settings) for channel in CHANNELS]
    return [mi.load_file(str(file), **settings)]


def picture(scenes, spp, seed):
    """One picture of what `load` returned."""
    pictures = [np.array(mi.render(scene, spp=spp, seed=seed), float) for scene in scenes]
    if len(pictures) == 1:
        return pictures[0][:, :, :3]
    return np.stack([pictures[channel][:, :, channel] for channel in range(3)], axis=2)


def read_exr(file):
    """Radiance, and the variance of its noise: 0 where none is stated."""
    bitmap = mi.Bitmap(str(file))
    channels = {field.name: i for i, field in enumerate(bitmap.struct_())}
    values = np.array(bitmap, float)
    image = values[:, :, [channels[c] for c in "RGB"]]
    if "variance.R" not in channels:
        return image, np.zeros_like(image)
    return image, values[:, :, [channels[f"variance.{c}"] for c in "RGB"]]


def render(scenes, spp, seed, count):
    """Mean, variance of the mean, and samples per pixel, from at most `count` pictures."""
    samples, count = shares(spp, count)
    pictures = [picture(scenes, samples, one) for one in seeds(seed, count)]
    return *summary(pictures), count * samples


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("--spp", type=int, help="samples per pixel [the scene's]")
    parser.add_argument("--seed", type=int, help="any whole number from 0 on [the scene's]")
    parser.add_argument("--replicates", type=int, default=64, help="at most so many pictures [64]")
    parser.add_argument(
        "-D", dest="settings", action="append", default=[], metavar="NAME=VALUE",
        help="a parameter of the scene, such as -Dintegrator=volpathmis",
    )
    options = parser.parse_args()
    defaults = parameters(options.scene)
    spp = int(defaults.get("spp", 64)) if options.spp is None else options.spp
    seed = int(defaults.get("seed", 0)) if options.seed is None else options.seed
    if spp < 2 or seed < 0 or options.replicates < 2:
        parser.error("--spp and --replicates are at least 2, --seed is not negative")
    settings = dict(setting.split("=", 1) for setting in options.settings)
    scenes = load(options.scene, settings)
    write(options.output, *render(scenes, spp, seed, options.replicates))


if __name__ == "__main__":
    main()
