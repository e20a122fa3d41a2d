#!/usr/bin/env python3
"""Renders radiative bundles of volref with LuxCore's path tracer (pip install pyluxcore), and tells the noise.

    lux_render.py BUNDLE.json OUTPUT.exr
    volref validate smoke --serve 'python3 scripts/peers/lux_render.py --serve {export:bundle} {spp} {seed}'

LuxCore's image is one pixel too low, and its roulette brightens what it ends: the screen is moved, and no path is ended.
"""

import time

import numpy as np
import pyluxcore
import volref
from lux_scene import properties, scene_of

MOST = 1000  # times that light is turned


def picture(scene, size, samples, seed):
    settings = {
        "renderengine.type": "PATHCPU",
        "renderengine.seed": seed,
        "sampler.type": "RANDOM",
        **{f"path.pathdepth.{kind}": MOST for kind in ("total", "diffuse", "glossy", "specular")},
        "path.russianroulette.depth": MOST,
        "path.hybridbackforward.enable": False,
        "path.clamping.variance.maxvalue": 0.0,
        "film.width": size[0],
        "film.height": size[1],
        "film.filter.type": "BOX",
        "film.filter.width": 0.5,
        "film.imagepipelines.0.0.type": "NOP",
        "batch.haltspp": samples,
    }
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties(settings), scene))
    session.Start()
    while not session.HasDone():
        time.sleep(0.01)
        session.UpdateStats()
    session.Stop()
    image = np.zeros(size[0] * size[1] * 3, np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, image)
    return image.reshape(size[1], size[0], 3)[::-1]


def render(bundle):
    if bundle.radiance["scattering"]["most"] is not None:
        volref.refuse("light that is turned a number of times")
    if bundle.lights:
        bundle.lights[0].refuse(bundle.lights[0].json["kind"])
    if bundle.radiance["pixel"]["filter"] != "box":
        volref.refuse("the radiance in the middle of a pixel")
    scene = scene_of(bundle)
    samples, seeds = bundle.renderings(16)
    pictures = [picture(scene, bundle.size, samples, seed) for seed in seeds]
    volref.save(bundle.request["output"], seeds=pictures, samples=samples)


pyluxcore.Init()
volref.main(render)
