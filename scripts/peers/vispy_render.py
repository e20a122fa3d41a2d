#!/usr/bin/env python3
"""Renders a bundle with vispy's Volume visual: method "translucent", and those of projections.

    vispy_render.py DIR/SCENE.json OUTPUT --step H           # OUTPUT: .npy, .pfm or .exr
    volref validate sampled --format npy --as vispy --serve \\
        'scripts/peers/vispy_render.py --serve {export:bundle} {step}'

Needs `pip install vispy volref` and EGL. Values are those of the frame buffer, codes of 8 bits divided by 255.

vispy has no reference length: its colormap takes the opacities of a step. It begins rays at the near plane of the
camera, which it finds in single precision: the nearer the plane, the less exact are the rays.
"""

import os

os.environ.setdefault("EGL_PLATFORM", "surfaceless")

import numpy as np
import vispy
import volref

vispy.use("egl")
from vispy import gloo, scene
from vispy.color import Colormap
from vispy.visuals.transforms import MatrixTransform

TABLE = 1024  # entries of vispy's texture
METHODS = {"maximum": "mip", "minimum": "minip", "mean": "average", "attenuated-maximum": "attenuated_mip"}


def render(bundle):
    bundle.allow("parallel", "placed", "sheared", "nearest", "formula", *METHODS)
    volume, mode, size = bundle.volume, bundle.volume.mode, bundle.size
    table = volume.table(TABLE, per="length" if mode else "step")
    opacities = np.ones(TABLE) if mode else table.opacities
    canvas = scene.SceneCanvas(size=size, show=False)
    visual = scene.visuals.Volume(
        volume.values,
        clim=table.range,
        method=METHODS[mode["name"]] if mode else "translucent",
        # Of a voxel.
        attenuation=mode.get("attenuation", 1) * volume.voxel if mode else 1,
        cmap=Colormap(np.column_stack([table.colours, opacities]).clip(0, 1), np.linspace(0, 1, TABLE)),
        relative_step_size=bundle.step / volume.voxel,
        interpolation="nearest" if volume.is_nearest else "linear",
        texture_format="r32f",
        parent=canvas.scene,
    )
    # To pixels of the canvas, y down.
    pixels = np.diag([size[0] / 2, -size[1] / 2, 1, 1])
    pixels[:2, 3] = size[0] / 2, size[1] / 2
    visual.transform = MatrixTransform((pixels @ bundle.projection @ bundle.view @ volume.affine).T)
    visual.update_gl_state(depth_test=False)
    colour = gloo.Texture2D((*size[::-1], 4), internalformat="rgba8", format="rgba")
    background = (*bundle.background, 1)
    with gloo.FrameBuffer(colour, gloo.RenderBuffer(size[::-1])) as buffer:
        canvas.push_fbo(buffer, (0, 0), size)
        gloo.clear(color=background)
        canvas._draw_scene(bgcolor=background)
        codes = gloo.read_pixels((0, 0, *size), out_type="unsigned_byte")
        canvas.pop_fbo()
    canvas.close()
    return codes[..., :3] / 255


volref.main(render)
