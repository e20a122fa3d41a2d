#!/usr/bin/env python3
"""Renders a bundle of a classified volume with VTK's ray caster for graphics cards.

    volref export SCENE --to bundle -o DIR
    vtk_render.py DIR/SCENE.json OUTPUT            # OUTPUT: .npy, .pfm or .exr
    vtk_render.py DIR/SCENE.json OUTPUT --step H   # another distance between samples
    volref validate limit --as vtk --serve 'vtk_render.py --serve {export:bundle} {step} --stock'

Needs `pip install vtk volref`; without a screen VTK uses EGL or OSMesa, in software where there is
no card. What VTK cannot say is refused by name.

VTK's tables take the opacity of a reference length, which VTK corrects for the step, and the colour,
of a formula times d^2. Where its model differs by design, lines of its shader are replaced (`vtk_shader.py`);
--stock leaves them as they are. VTK.md beside this file tells what that changes, and by how much.
"""

import argparse

import numpy as np
import vtk
import volref
from vtk_looks import looks_of
from vtk_scene import renderer_of
from vtk_shader import replace_lines
from vtk_volumes import BLENDS, mapper_of, volume_of


def refuse_what_vtk_cannot_say(bundle):
    if "shadow" in bundle.asks:
        volref.refuse("the volume shadow (VTK scatters light by a model of its own)")
    bundle.allow("several", "parallel", "placed", "sheared", "nearest", "formula", "shading", "clips", "surfaces", *BLENDS)
    parts = bundle.volumes
    if len(parts) > 1 and "shading" in bundle.asks:
        volref.refuse("several volumes by a lamp (VTK lights them from the eye, or not at all)")
    if any(volume.has_jump for volume in parts if volume.json["transfer_function"]):
        volref.refuse("a table with a jump (VTK's runs in straight lines)")
    if any(surface["kind"] != "sphere" for surface in bundle.panel.get("surfaces", [])):
        volref.refuse("surfaces other than spheres (this script knows no others)")
    if any(volume.json.get("clips") != parts[0].json.get("clips") for volume in parts):
        volref.refuse("clips of some of the volumes (VTK's mapper cuts all alike)")


def drawn(renderer, size):
    """The picture as floats: VTK's usual buffers hold 8 bits, too few to be judged."""
    floats = vtk.vtkFramebufferPass()
    floats.SetDelegatePass(vtk.vtkRenderStepsPass())
    floats.SetColorFormat(vtk.vtkTextureObject.Float32)
    # With the depth format that it chooses itself, VTK 9.7 shows no volume in software.
    floats.SetDepthFormat(vtk.vtkTextureObject.Fixed32)
    renderer.SetPass(floats)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetSize(size)
    window.AddRenderer(renderer)
    window.Render()
    pixels = np.zeros((size[1], size[0], 4), np.float32)
    floats.GetColorTexture().Download().Download2D(vtk.VTK_FLOAT, pixels, size, 4, (0, 0))
    return pixels[::-1]


def render(bundle, stock):
    refuse_what_vtk_cannot_say(bundle)
    parts, mapper, pictures = bundle.volumes, mapper_of(bundle), []
    stock = stock or len(parts) > 1  # the shader of several volumes has other lines
    for looks in zip(*(looks_of(volume, stock) for volume in parts)):
        volume = volume_of(mapper, parts, looks)
        if not stock:
            replace_lines(volume, "mode" in bundle.panel)
        pictures.append(drawn(renderer_of(bundle, volume, looks[0]), bundle.size))
    behind = 1 - pictures[0][:, :, 3:]
    return sum(picture[:, :, :3] for picture in pictures) + behind * bundle.background


parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
parser.add_argument("--stock", action="store_true", help="VTK as it is, shader and all")
volref.main(render, parser)
