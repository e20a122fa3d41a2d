#!/usr/bin/env python3
"""Renders a bundle with pygfx, which draws largest and smallest values along rays.

    pygfx_render.py DIR/SCENE.json OUTPUT                # OUTPUT: .exr, .npy or .pfm
    volref validate maximum --bits 8-srgb --serve 'scripts/peers/pygfx_render.py --serve {export:bundle}'

Needs `pip install pygfx volref` and Vulkan: where there is no card Mesa's lavapipe (Debian's mesa-vulkan-drivers).
Values are those that pygfx draws, sRGB codes of 8 bits, before they are filtered for the display.

pygfx has no step of its own choice, nor a transfer function with opacities. Its isosurfaces are one, opaque and lit.
"""

import numpy as np
import pygfx as gfx
import volref

TABLE = 1024
MATERIALS = {"maximum": gfx.VolumeMipMaterial, "minimum": gfx.VolumeMinipMaterial}


def camera_of(bundle):
    width, height = bundle.size
    aspect = width / height
    if bundle.parallel_height:
        camera = gfx.OrthographicCamera(aspect * bundle.parallel_height, bundle.parallel_height)
    else:
        # Its field of view is that of the mean of width and height.
        tangent = np.tan(np.radians(bundle.field_of_view) / 2) * (1 + aspect) / 2
        camera = gfx.PerspectiveCamera(2 * np.degrees(np.arctan(tangent)), aspect)
    camera.depth_range = bundle.near_and_far
    camera.local.matrix = bundle.camera_to_world
    return camera


def placed(visual, affine):
    """The visual in a group: each is turned, sized and moved by pygfx, and both together sheared."""
    left, sizes, right = np.linalg.svd(affine[:3, :3])
    sizes *= np.linalg.det(left) * np.linalg.det(right)
    group, outer, inner = gfx.Group(), np.eye(4), np.eye(4)
    outer[:3, :3], outer[:3, 3] = np.linalg.det(left) * left * sizes, affine[:3, 3]
    inner[:3, :3] = np.linalg.det(right) * right
    group.local.matrix, visual.local.matrix = outer, inner
    group.add(visual)
    return group


def render(bundle):
    bundle.allow("parallel", "placed", "sheared", "nearest", "formula", *MATERIALS)
    volume = bundle.volume
    if not volume.mode:
        volref.refuse("composited samples")
    table = volume.table(TABLE)
    look = np.column_stack([table.colours, np.ones(TABLE)]).astype(np.float32)
    material = MATERIALS[volume.mode["name"]](
        clim=table.range,
        map=gfx.TextureMap(gfx.Texture(look, dim=1, colorspace="physical"), wrap="clamp", filter="linear"),
        interpolation="nearest" if volume.is_nearest else "linear",
    )
    grid = gfx.Texture(np.ascontiguousarray(volume.values), dim=3, colorspace="physical")
    visual = gfx.Volume(gfx.Geometry(grid=grid), material)
    scene = gfx.Scene()
    scene.add(placed(visual, volume.affine))
    target = gfx.Texture(dim=2, size=(*bundle.size, 1), format="rgba8unorm")
    renderer = gfx.WgpuRenderer(target, pixel_ratio=1, ppaa="none")
    renderer.render(scene, camera_of(bundle), flush=True)
    codes = renderer.snapshot() / 255
    colours = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)[..., :3]
    return colours + (1 - codes[..., 3:]) * bundle.background


volref.main(render)
