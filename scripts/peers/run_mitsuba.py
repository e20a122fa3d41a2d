#!/usr/bin/env python3
"""Renders an exported scene with Mitsuba 3 (`scalar_rgb`) and writes what volref compares.

    run_mitsuba.py SCENE.xml OUTPUT.exr [--spp N] [--seed S] [--replicates R]

SCENE.xml is what `volref export --to mitsuba` writes. OUTPUT.exr holds R, G and B and, where the
picture has noise, the variance of their means (`variance.R`, `.G`, `.B`) and the samples per pixel
(`samples.Y`). Made for

    volref validate --serve 'python3 scripts/peers/run_mitsuba.py --serve {export:mitsuba} {spp} {seed}'
    volref validate --run 'python3 scripts/peers/run_mitsuba.py {export:mitsuba} {output} \\
        --spp {spp} --seed {seed}'

Mitsuba tells the noise of a picture in no channel of its own, so the samples are divided among R
pictures with seeds of their own (64, or one for each sample if there are fewer), and the variance
of the mean is that of the pictures over R. N is rounded up to a multiple of their samples. What is
added for rounding, and when no noise is stated, is in `volref.save`.

A scene that is said channel by channel (it has a parameter `channel`) is rendered three times,
N samples each, and of every picture that channel is taken.

Needs Python 3.11 with `mitsuba` and `volref`.
"""

import argparse
import sys
import xml.etree.ElementTree
from pathlib import Path

import numpy as np
import volref
from replicates import seeds, shares

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


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene", type=Path, nargs="?")
    parser.add_argument("output", type=Path, nargs="?")
    parser.add_argument("--serve", action="store_true", help="stay, and read requests from standard input")
    parser.add_argument("--spp", type=int, help="samples per pixel [the scene's]")
    parser.add_argument("--seed", type=int, help="any whole number from 0 on [the scene's]")
    parser.add_argument("--replicates", type=int, default=64, help="at most so many pictures [64]")
    parser.add_argument(
        "-D", dest="settings", action="append", default=[], metavar="NAME=VALUE",
        help="a parameter of the scene, such as -Dintegrator=volpathmis",
    )
    options = parser.parse_args()
    if options.replicates < 2 or (options.spp or 2) < 2 or (options.seed or 0) < 0:
        parser.error("--spp and --replicates are at least 2, --seed is not negative")
    if options.serve:
        volref.serve(lambda request: render_to(Path(request["export:mitsuba"]), Path(request["output"]),
                                               request.get("spp"), request.get("seed"), options))  # fmt: skip
    elif options.output:
        render_to(options.scene, options.output, options.spp, options.seed, options)
    else:
        parser.error("give a scene and an output, or --serve")


def render_to(scene, output, spp, seed, options):
    """Renders with so many samples and that seed, or else those of the scene."""
    defaults = parameters(scene)
    spp = int(defaults.get("spp", 64)) if spp is None else spp
    seed = int(defaults.get("seed", 0)) if seed is None else seed
    settings = dict(setting.split("=", 1) for setting in options.settings)
    scenes, (samples, count) = load(scene, settings), shares(spp, options.replicates)
    volref.save(output, seeds=[picture(scenes, samples, one) for one in seeds(seed, count)], samples=samples)


if __name__ == "__main__":
    main()
