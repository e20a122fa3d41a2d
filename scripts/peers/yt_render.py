#!/usr/bin/env python3
"""Renders a bundle with yt's volume source, on the processor.

    yt_render.py DIR/SCENE.json OUTPUT                # OUTPUT: .exr, .npy or .pfm
    volref validate sampled --serve 'scripts/peers/yt_render.py --serve {export:bundle} {step}'

Needs `pip install yt volref`. Values are those of yt's image, floats.

yt's transfer functions are colours and extinction, for a length of 1 of a ray's parameter, which goes from 0 to 1 over
the depth of the camera; opacities are linear in the length. yt takes values of cells, and means of eight of them at
their corners, between which it interpolates; of nodes it is given cells around them. It has no step, but a number of
samples for the way through each cell.
"""

import numpy as np
import volref
import yt
from yt.visualization.volume_rendering.api import ColorTransferFunction, Scene, create_volume_source

yt.set_log_level("error")

TABLE = 1024


def scene_of(bundle):
    volume = bundle.volume
    spacing, first, nodes = (np.array(volume.grid[key]) for key in ("spacing", "first_node", "nodes"))
    # A layer more on each side: at the border yt has no neighbours to take means of.
    values = {"value": np.pad(volume.values.T.astype(float), 1, mode="edge")}
    edges = np.stack([first - 1.5 * spacing, first + (nodes + 0.5) * spacing], 1)
    data = yt.load_uniform_grid(values, nodes + 2, bbox=edges)
    inside = data.box(edges[:, 0] + spacing, edges[:, 1] - spacing)
    source = create_volume_source(inside, ("stream", "value"))
    source.log_field = False
    source.use_ghost_zones = True
    source.num_samples = max(1, round(volume.voxel / bundle.step))
    scene = Scene()
    scene.add_source(source)
    return scene, source, data


def render(bundle):
    bundle.allow("parallel", "formula")
    scene, source, data = scene_of(bundle)
    (near, far), (width, height) = bundle.near_and_far, bundle.size
    middle = (near + far) / 2
    camera = scene.add_camera(data, lens_type="plane-parallel" if bundle.parallel_height else "perspective")
    camera.resolution = (width, height)
    camera.focus = data.arr(bundle.eye + middle * bundle.forward, "code_length")
    camera.position = data.arr(bundle.eye, "code_length")
    camera.switch_orientation(north_vector=bundle.up)
    tall = bundle.parallel_height or 2 * middle * np.tan(np.radians(bundle.field_of_view) / 2)
    depth = far - near if bundle.parallel_height else middle
    camera.width = data.arr([tall * width / height, tall, depth], "code_length")
    # The length of a ray's parameter in the middle of the image.
    length = depth
    if not bundle.parallel_height:
        centre, size = data.domain_center.d, data.domain_width.d
        length = np.linalg.norm(bundle.eye - centre) + np.linalg.norm(size) / 2
    table = bundle.volume.table(TABLE)
    extinction = -np.log1p(-table.opacities.clip(0, 1 - 1e-9)) / bundle.volume.reference_length * length
    look = ColorTransferFunction(table.range, nbins=TABLE, grey_opacity=True)
    for channel, curve in zip([look.red, look.green, look.blue], table.colours.T):
        channel.y = curve.copy()
    look.alpha.y = extinction
    source.transfer_function = look
    picture = np.asarray(scene.render()).swapaxes(0, 1)
    return picture[..., :3] + (1 - picture[..., 3:]).clip(0, 1) * bundle.background


volref.main(render)
