#!/usr/bin/env python3
"""Renders a bundle of a classified volume with pyvista, as its users do: add_volume and a screenshot.

    pyvista_render.py DIR/SCENE.json OUTPUT gpu --step H           # or cpu; OUTPUT: .npy, .pfm or .exr
    volref validate sampled --format npy --as pyvista-gpu --run \\
        'scripts/peers/pyvista_render.py {export:bundle} {output} gpu --step {step}'

Needs `pip install pyvista numpy`; without a screen VTK uses EGL or OSMesa, in software where there is
no card. Values are those of the screenshot, codes of 8 bits divided by 255.

Three settings differ from the defaults, each by a method of pyvista or VTK: no multisampling, which mixes the
background into pixels at the faces of the box; the distance between samples; and for processors ten rays a pixel in
each direction, for VTK draws the image of its rays stretched by half a pixel at each side (--rays 1).
"""

import numpy as np
import pyvista
from bundle import arguments, farthest, is_of_cells, load, looks, refuse, span
from image_file import write_image
from matplotlib.colors import ListedColormap

TABLE = 256  # entries of pyvista's tables, as add_volume has them


def image_of(panel, values):
    """The volume as ImageData. Values of cells are cell data, of which pyvista takes means at the points."""
    grid = panel["grid"]
    nodes, spacing = np.array(grid["nodes"]), grid["spacing"]
    if nodes.min() == 1:
        refuse("one layer of nodes: VTK needs two")
    if is_of_cells(grid):
        image = pyvista.ImageData(dimensions=nodes + 1, spacing=spacing, origin=grid["box_min"])
        image.cell_data["values"] = values.ravel()
    else:
        image = pyvista.ImageData(dimensions=nodes, spacing=spacing, origin=grid["first_node"])
        image.point_data["values"] = values.ravel()
    return image


def set_camera(camera, panel):
    ray = panel["ray"]
    camera.position = ray["eye"]
    camera.focal_point = np.add(ray["eye"], ray["forward"])
    camera.up = ray["half_up"]
    if "orthographic_height" in ray:
        camera.parallel_projection = True
        camera.parallel_scale = ray["orthographic_height"] / 2
    else:
        camera.view_angle = 2 * np.degrees(np.arctan(np.linalg.norm(ray["half_up"])))
    camera.clipping_range = (1e-3 * farthest(panel), 2 * farthest(panel))


def main():
    parser = arguments(__doc__.partition("\n")[0])
    parser.add_argument("processor", choices=["cpu", "gpu"])
    parser.add_argument("--rays", type=float, default=10, help="with cpu: rays a pixel, in each direction")
    options = parser.parse_args()
    panel, values = load(options.bundle)
    transfer = panel["transfer_function"]
    if panel["phong"]:
        refuse("shading")
    least, most = span(transfer)
    colours, opacities = looks(transfer, np.linspace(least, most, TABLE))
    plotter = pyvista.Plotter(
        off_screen=True, window_size=(panel["width"], panel["height"]), lighting="none"
    )
    plotter.disable_anti_aliasing()
    plotter.render_window.SetMultiSamples(0)
    plotter.background_color = panel["background"]
    actor = plotter.add_volume(
        image_of(panel, values),
        scalars="values",
        clim=(least, most),
        cmap=ListedColormap(colours),
        opacity=opacities * 255,
        n_colors=TABLE,
        opacity_unit_distance=transfer["reference_length"],
        mapper="gpu" if options.processor == "gpu" else "fixed_point",
        shade=False,
        show_scalar_bar=False,
    )
    actor.prop.interpolation_type = panel["interpolation"]["method"].replace("trilinear", "linear")
    mapper = actor.mapper
    mapper.SetAutoAdjustSampleDistances(False)
    mapper.SetLockSampleDistanceToInputSpacing(False)
    mapper.SetSampleDistance(options.step or panel["sampling"]["step"])
    if options.processor == "cpu":
        mapper.SetImageSampleDistance(1 / options.rays)
    set_camera(plotter.camera, panel)
    codes = plotter.screenshot(None, return_img=True)[..., :3]
    write_image(options.output, codes / 255)


if __name__ == "__main__":
    main()
