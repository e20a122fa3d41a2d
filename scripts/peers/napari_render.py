#!/usr/bin/env python3
"""Renders a bundle with napari, as its users do: an image layer and a screenshot of the canvas.

    xvfb-run -a napari_render.py DIR/SCENE.json OUTPUT         # OUTPUT: .npy, .pfm or .exr
    xvfb-run -a volref validate sampled --format npy --as vispy --serve \\
        'scripts/peers/napari_render.py --serve {export:bundle} {step}'

Needs `pip install napari PyQt6 volref` and a screen, such as Xvfb. Values are those of the screenshot, codes of 8 bits
divided by 255.

napari has no reference length: its colormap takes the opacities of a step. A step is no setting of its own, 0.8 voxels
always: it is set in the visual of vispy beneath, with which napari draws.
"""

import napari
import numpy as np
import volref
from napari.utils import Colormap

TABLE = 1024
RENDERING = {"maximum": "mip", "minimum": "minip", "mean": "average", "attenuated-maximum": "attenuated_mip"}

viewer = napari.Viewer(ndisplay=3)


def render(bundle):
    bundle.allow("parallel", "placed", "sheared", "nearest", "formula", *RENDERING)
    volume, (width, height) = bundle.volume, bundle.size
    table = volume.table(TABLE, per="length" if volume.mode else "step")
    opacities = np.ones(TABLE) if volume.mode else table.opacities
    look = np.column_stack([table.colours, opacities]).clip(0, 1)
    viewer.layers.clear()
    layer = viewer.add_image(
        volume.values,
        # Axes in the order z, y, x.
        affine=np.block([[volume.affine[2::-1, 2::-1], volume.affine[2::-1, 3:]], [np.eye(1, 4, 3)]]),
        rendering=RENDERING[volume.mode["name"]] if volume.mode else "translucent",
        attenuation=volume.mode.get("attenuation", 1) * volume.voxel if volume.mode else 1,
        colormap=Colormap(look, controls=np.linspace(0, 1, TABLE)),
        contrast_limits=table.range,
        interpolation3d="nearest" if volume.is_nearest else "linear",
        blending="translucent_no_depth",
    )
    visual = viewer.window._qt_viewer.canvas.layer_to_visual[layer]
    visual.node.relative_step_size = bundle.step / volume.voxel
    camera = viewer.camera
    camera.orientation = ("towards", "up", "right")
    tangent = np.tan(np.radians(bundle.field_of_view or 0) / 2)
    distance = (bundle.near_and_far[1] + bundle.near_and_far[0]) / 2
    camera.center = (bundle.eye + distance * bundle.forward)[::-1]
    camera.perspective = bundle.field_of_view or 0
    camera.zoom = height / (bundle.parallel_height or 2 * distance * tangent)
    camera.set_view_direction(bundle.forward[::-1], bundle.up[::-1])
    viewer.canvas.background_color_override = bundle.background
    codes = viewer.screenshot(size=(height, width), scale=1, canvas_only=True, flash=False)
    return codes[..., :3] / 255


volref.main(render)
