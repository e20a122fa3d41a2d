#!/usr/bin/env python3
"""Renders a bundle of a classified volume with vispy's Volume visual, method "translucent".

    vispy_render.py DIR/SCENE.json OUTPUT --step H           # OUTPUT: .npy, .pfm or .exr
    volref validate sampled --format npy --as vispy --run \\
        'scripts/peers/vispy_render.py {export:bundle} {output} --step {step}'

Needs `pip install vispy numpy` and EGL. Values are those of the frame buffer, codes of 8 bits divided by 255.

vispy has no reference length: its colormap takes the opacities of a step. It begins rays at the near plane of the
camera, which it finds in single precision: the nearer the plane, the less exact are the rays.
"""

import os

os.environ.setdefault("EGL_PLATFORM", "surfaceless")

import numpy as np
import vispy
from bundle import arguments, farthest, load, looks, nearest, span
from image_file import write_image

vispy.use("egl")
from vispy import gloo, scene
from vispy.color import Colormap
from vispy.visuals.transforms import MatrixTransform

TABLE = 1024  # entries of vispy's texture


def projection(panel):
    """World to pixels of the canvas, y down; columns are multiplied."""
    ray, width, height = panel["ray"], panel["width"], panel["height"]
    far = 2 * farthest(panel)
    near = max(0.25 * nearest(panel), 1e-4 * far)
    size = np.linalg.norm(ray["half_up"])
    view = np.eye(4)
    view[:3, :3] = [np.divide(ray["half_right"], size), np.divide(ray["half_up"], size), np.negative(ray["forward"])]
    view[:3, 3] = -view[:3, :3] @ ray["eye"]
    if "orthographic_height" in ray:
        depth = [[0, 0, -2 / (far - near), -(far + near) / (far - near)], [0, 0, 0, 1]]
    else:
        depth = [[0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)], [0, 0, -1, 0]]
    sides = [[height / width / size, 0, 0, 0], [0, 1 / size, 0, 0]]
    pixels = np.diag([width / 2, -height / 2, 1, 1])
    pixels[:2, 3] = width / 2, height / 2
    return pixels @ np.array(sides + depth) @ view


def main():
    options = arguments(__doc__.partition("\n")[0]).parse_args()
    panel, values = load(options.bundle)
    grid, transfer = panel["grid"], panel["transfer_function"]
    size = panel["width"], panel["height"]
    step = options.step or panel["sampling"]["step"]
    least, most = span(transfer)
    colours, opacities = looks(transfer, np.linspace(least, most, TABLE))
    opacities = 1 - (1 - opacities) ** (step / transfer["reference_length"])
    canvas = scene.SceneCanvas(size=size, show=False)
    volume = scene.visuals.Volume(
        values,
        clim=(least, most),
        method="translucent",
        cmap=Colormap(np.column_stack([colours, opacities]), np.linspace(0, 1, TABLE)),
        relative_step_size=step / min(grid["spacing"]),
        interpolation=panel["interpolation"]["method"].replace("trilinear", "linear"),
        texture_format="r32f",
        parent=canvas.scene,
    )
    world = np.diag([*grid["spacing"], 1])
    world[:3, 3] = grid["first_node"]
    volume.transform = MatrixTransform((projection(panel) @ world).T)
    volume.update_gl_state(depth_test=False)
    colour = gloo.Texture2D((*size[::-1], 4), internalformat="rgba8", format="rgba")
    background = (*panel["background"], 1)
    with gloo.FrameBuffer(colour, gloo.RenderBuffer(size[::-1])) as buffer:
        canvas.push_fbo(buffer, (0, 0), size)
        gloo.clear(color=background)
        canvas._draw_scene(bgcolor=background)
        codes = gloo.read_pixels((0, 0, *size), out_type="unsigned_byte")
        canvas.pop_fbo()
    write_image(options.output, codes[..., :3] / 255)


if __name__ == "__main__":
    main()
