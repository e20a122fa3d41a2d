#!/usr/bin/env python3
"""Renders radiative bundles of volref with Blender's Cycles (pip install bpy), and tells the noise.

    cycles_render.py BUNDLE.json OUTPUT.exr
    volref validate smoke --serve 'python3 scripts/peers/cycles_render.py --serve {export:bundle} {spp} {seed}'
"""

import tempfile
from pathlib import Path

import bpy
import numpy as np
import volref
from cycles_scene import put_scene

MOST = 1024  # times that Cycles can turn light


def set_up(bundle):
    """Cycles without limits to light, denoiser and adaptive sampling."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene, most = bpy.context.scene, bundle.radiance["scattering"]["most"]
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = bundle.size
    scene.render.use_persistent_data = True  # of pictures that differ by their seeds alone
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = *bundle.radiance["environment"], 1
    if most == 0:
        volref.refuse("light that nothing turns")
    cycles = scene.cycles
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    for kind in ("max", "diffuse", "glossy", "transmission", "volume", "transparent_max"):
        setattr(cycles, f"{kind}_bounces", MOST if most is None or kind == "transparent_max" else most - 1)
    cycles.sample_clamp_indirect = cycles.sample_clamp_direct = cycles.light_sampling_threshold = 0
    cycles.volume_biased = True  # by steps, which media of one density need not
    # Cycles has no centre: a narrow filter stands for it; its box has the width of a pixel.
    cycles.pixel_filter_type = "BOX" if bundle.radiance["pixel"]["filter"] == "box" else "GAUSSIAN"
    cycles.filter_width = 0.01
    return scene


def picture(scene, samples, seed):
    # The first sample of a pixel lies in its middle, whatever the seed: it is left out.
    scene.cycles.use_sample_subset, scene.cycles.sample_offset = True, 1
    scene.cycles.samples, scene.cycles.sample_subset_length, scene.cycles.seed = samples + 1, samples, seed
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "image.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        image.colorspace_settings.name = "Non-Color"
        values = np.array(image.pixels[:]).reshape(image.size[1], image.size[0], 4)
        bpy.data.images.remove(image)
    return values[::-1, :, :3]


def render(bundle):
    scene = set_up(bundle)
    put_scene(bundle)
    samples, seeds = bundle.renderings(16)
    volref.save(bundle.request["output"], seeds=[picture(scene, samples, seed) for seed in seeds], samples=samples)


volref.main(render)
