#!/usr/bin/env python3
"""Renders an exported scene with Mitsuba 3 (`scalar_rgb`) and writes what volref compares.

    run_mitsuba.py SCENE.xml OUTPUT.exr [--spp N] [--seed S] [--replicates R] [-DNAME=VALUE]
    volref validate --serve 'python3 scripts/peers/run_mitsuba.py --serve {export:mitsuba} {spp} {seed}'

SCENE.xml is what `volref export --to mitsuba` writes. OUTPUT.exr holds R, G and B and, where the
picture has noise, the variance of their means (`variance.R`, `.G`, `.B`) and the samples per pixel
(`samples.Y`).

Mitsuba tells the noise of a picture in no channel of its own, so the samples are divided among R
pictures with seeds of their own, and the variance of the mean is that of the pictures over R. N is
rounded up to a multiple of their samples. What is added for rounding, and when no noise is stated, is in
`volref.save`.

A scene that is said channel by channel (it has a parameter `channel`) is rendered three times,
N samples each, and of every picture that channel is taken.

Needs Python 3.11 with `mitsuba` and `volref`.
"""

import argparse
import xml.etree.ElementTree

import mitsuba as mi
import numpy as np
import volref

mi.set_variant("scalar_rgb")

CHANNELS = ["red", "green", "blue"]


def parameters(scene):
    """Names and default values of the parameters of a scene."""
    root = xml.etree.ElementTree.parse(scene).getroot()
    return {default.get("name"): default.get("value") for default in root.iter("default")}


def load(file, settings={}):
    """The scene of a file, or one for each channel."""
    channels = [{"channel": name} for name in CHANNELS] if "channel" in parameters(file) else [{}]
    return [mi.load_file(str(file), **channel, **settings) for channel in channels]


def picture(scenes, spp, seed):
    """One picture of what `load` returned."""
    pictures = [np.array(mi.render(scene, spp=spp, seed=seed), float) for scene in scenes]
    if len(pictures) == 1:
        return pictures[0][:, :, :3]
    return np.stack([pictures[channel][:, :, channel] for channel in range(3)], axis=2)


def render(request, replicates, settings):
    """Renders with the samples and the seed that are asked for, or else those of the scene."""
    own = {"spp": 64, "seed": 0} | parameters(request["export:mitsuba"])
    spp, seed = (int(own[name] if request.get(name) is None else request[name]) for name in ("spp", "seed"))
    samples, seeds = volref.divided(spp, seed, replicates)
    scenes = load(request["export:mitsuba"], dict(setting.split("=", 1) for setting in settings))
    volref.save(request["output"], seeds=[picture(scenes, samples, seed) for seed in seeds], samples=samples)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--replicates", type=int, default=64, help="at most so many pictures [64]")
    parser.add_argument(
        "-D", dest="settings", action="append", default=[], metavar="NAME=VALUE",
        help="a parameter of the scene, such as -Dintegrator=volpathmis",
    )  # fmt: skip
    volref.main(render, parser, export="mitsuba")
