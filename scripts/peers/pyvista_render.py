#!/usr/bin/env python3
"""Renders a bundle with pyvista, as its users do: add_volume and a screenshot.

    pyvista_render.py DIR/SCENE.json OUTPUT --step H      # OUTPUT: .npy, .pfm or .exr; --processor cpu
    volref validate sampled --format npy --as pyvista-gpu --serve \\
        'scripts/peers/pyvista_render.py --serve {export:bundle} {step}'

Needs `pip install pyvista volref`; without a screen VTK uses EGL or OSMesa, in software where there is
no card. Values are those of the screenshot, codes of 8 bits divided by 255.

Three settings differ from the defaults, each by a method of pyvista or VTK: no multisampling, which mixes the
background into pixels at the faces of the box; the distance between samples; and for processors ten rays a pixel in
each direction, for VTK draws the image of its rays stretched by half a pixel at each side (--rays 1).
"""

import argparse

import numpy as np
import pyvista
import volref
from matplotlib.colors import ListedColormap

TABLE = 256  # entries of pyvista's tables, as add_volume has them
BLENDING = {"maximum": "maximum", "minimum": "minimum", "mean": "average"}


def image_of(volume):
    """The volume as ImageData. Values of cells are cell data, of which pyvista takes means at the points."""
    grid, of_cells = volume.grid, volume.is_of_cells
    nodes = np.array(grid["nodes"])
    if nodes.min() == 1:
        volref.refuse("one layer of nodes: VTK needs two")
    origin = grid["box_min"] if of_cells else grid["first_node"]
    image = pyvista.ImageData(dimensions=nodes + of_cells, spacing=grid["spacing"], origin=origin)
    (image.cell_data if of_cells else image.point_data)["values"] = volume.values.ravel()
    return image


def render(bundle, processor, rays):
    bundle.allow("parallel", "placed", "sheared", "nearest", "formula", *BLENDING)
    volume, table = bundle.volume, bundle.volume.table(TABLE)
    plotter = pyvista.Plotter(off_screen=True, window_size=bundle.size, lighting="none")
    plotter.disable_anti_aliasing()
    plotter.render_window.SetMultiSamples(0)
    plotter.background_color = bundle.background
    actor = plotter.add_volume(
        image_of(volume),
        scalars="values",
        clim=table.range,
        cmap=ListedColormap(table.colours),
        opacity=(np.ones(TABLE) if volume.mode else table.opacities) * 255,
        n_colors=TABLE,
        opacity_unit_distance=None if volume.mode else volume.reference_length,
        blending=BLENDING[volume.mode["name"]] if volume.mode else "composite",
        mapper="gpu" if processor == "gpu" else "fixed_point",
        shade=False,
        show_scalar_bar=False,
    )
    actor.prop.interpolation_type, actor.user_matrix = "nearest" if volume.is_nearest else "linear", volume.matrix
    actor.mapper.SetAutoAdjustSampleDistances(False)
    actor.mapper.SetLockSampleDistanceToInputSpacing(False)
    actor.mapper.SetSampleDistance(bundle.step)
    if processor == "cpu":
        actor.mapper.SetImageSampleDistance(1 / rays)
    camera = plotter.camera
    camera.position, camera.focal_point, camera.up = bundle.eye, bundle.eye + bundle.forward, bundle.up
    if bundle.parallel_height:
        camera.parallel_projection, camera.parallel_scale = True, bundle.parallel_height / 2
    else:
        camera.view_angle = bundle.field_of_view
    camera.clipping_range = bundle.near_and_far
    codes = plotter.screenshot(None, return_img=True)[..., :3]
    plotter.close()
    return codes / 255


parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
parser.add_argument("--processor", choices=["cpu", "gpu"], default="gpu")
parser.add_argument("--rays", type=float, default=10, help="of processors: rays a pixel, in each direction")
volref.main(render, parser)
