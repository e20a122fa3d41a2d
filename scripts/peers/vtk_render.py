#!/usr/bin/env python3
"""Renders a bundle of a classified volume with VTK's ray caster for graphics cards.

    volref export SCENE --to bundle -o DIR
    vtk_render.py DIR/SCENE.json OUTPUT            # OUTPUT: .npy, .pfm or .exr
    vtk_render.py DIR/SCENE.json OUTPUT --step H   # another distance between samples

Needs `pip install vtk numpy`; without a screen VTK uses EGL or OSMesa, in software where there is
no card. What VTK cannot say is refused by name.

VTK's tables take the opacity of a reference length, which VTK corrects for the step, and the colour,
of a formula times d^2. Where its model differs by design, lines of its shader are replaced (`SHADER` below);
--stock leaves them as they are. VTK.md beside this file tells what that changes, and by how much.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from image_file import image_path, write_image

TABLE = 4096  # entries of the tables that stand for the transfer function

# What VTK calls the modes that it has.
BLENDS = {
    "maximum": "MaximumIntensity",
    "minimum": "MinimumIntensity",
    "mean": "AverageIntensity",
    "isosurface": "IsoSurface",
}

SHADER = {
    # VTK takes its first sample a whole step behind the front face.
    "g_rayJitter = g_dirStep;": "g_rayJitter = 0.5 * g_dirStep;",
    # It stops where less than a 255th of the light would still come through.
    "g_opacityThreshold = 1.0 - 1.0 / 255.0;": "g_opacityThreshold = 1.0;",
    # For a light that has a place, it distorts normals by the proportions of the box,
    "(in_textureToEye[0] * vec4(shading_gradient.xyz, 0.0)).xyz":
        "(transpose(inverse(mat3(in_modelViewMatrix * in_volumeMatrix[0]))) * shading_gradient.xyz)",
    # gives neither ambient light nor highlight a colour, and so no factor of d^2,
    "in_ambient[lightingComponent] * ambient +": "in_ambient[lightingComponent] * color.rgb +",
    "in_specular[lightingComponent] * specular;":
        "in_specular[lightingComponent] * specular * color.rgb;",
    # and takes differences over n/(n - 1) spacings, n the nodes of an axis.
    "vec3(in_cellStep[index].x, 0.0, 0.0)": "vec3(1.0 / float(textureSize(volume, 0).x), 0.0, 0.0)",
    "vec3(0.0, in_cellStep[index].y, 0.0)": "vec3(0.0, 1.0 / float(textureSize(volume, 0).y), 0.0)",
    "vec3(0.0, 0.0, in_cellStep[index].z)": "vec3(0.0, 0.0, 1.0 / float(textureSize(volume, 0).z))",
}  # fmt: skip


def parts_of(panel):
    """The volumes of a panel, of which there is one but in "volumes"."""
    return panel.get("volumes", [panel])


def obstacles(panel):
    """What of a panel VTK's model has no word for."""
    if not panel["shows"].startswith("volume"):
        return [f"a {panel['shows']}, which is no volume"]
    if "mode" in panel and panel["mode"]["name"] not in BLENDS:
        return [f"mode = {panel['mode']['name']!r}"]
    found = []
    parts = parts_of(panel)
    for part in parts:
        values = [point["value"] for point in (part["transfer_function"] or {}).get("points", [])]
        if len(set(values)) < len(values):
            found.append("a table with a jump (VTK's runs in straight lines)")
    if panel.get("compositing", {}).get("method") == "continuous" and panel["sampling"] is None:
        found.append("a continuous integral without a step")
    if panel["shadow"]:
        found.append("the volume shadow (VTK scatters light by a model of its own)")
    if any(surface["kind"] != "sphere" for surface in panel.get("surfaces", [])):
        found.append("surfaces other than spheres (this script knows no others)")
    if any("modulation" in part for part in parts):
        found.append("opacities by a second number (this script gives VTK one)")
    if any(part["clips"] != parts[0]["clips"] for part in parts if "clips" in part):
        found.append("clips of some of the volumes (VTK's mapper cuts all alike)")
    return found


def tables(vtk, transfer, colours):
    """Opacity over the reference length, and the radiance of an opaque sample, over density."""
    if transfer["kind"] == "table":
        opacity, colour = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
        for point in transfer["points"]:
            opacity.AddPoint(point["value"], point["opacity"])
            colour.AddRGBPoint(point["value"], *(colours or [point["colour"]])[0])
        return opacity, colour
    density = np.linspace(0, 1, TABLE)
    clear = (np.exp(-(density**2)) - transfer["floor"]) / (1 - transfer["floor"])
    position = np.linspace(0, 1, len(colours))
    channels = [np.interp(density, position, c) * density**2 for c in np.array(colours).T]
    opacity, colour = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    for d, t, *rgb in zip(density, np.clip(clear, 0, 1), *channels):
        opacity.AddPoint(d, 1 - t)
        colour.AddRGBPoint(d, *rgb)
    return opacity, colour


def mode_tables(vtk, panel):
    """Opacity and colour over the values that a projection or isosurfaces show."""
    mode = panel["mode"]
    opacity, colour = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    if mode["name"] == "isosurface":
        surfaces = sorted(mode["surfaces"], key=lambda surface: surface["value"])
        values = [surface["value"] for surface in surfaces]
        # Steps between the values, over a tenth of the way from one to the next.
        for surface, before, after in zip(surfaces, [values[0] - 1] + values, values[1:] + [values[-1] + 1]):
            for value in (0.55 * surface["value"] + 0.45 * before, 0.55 * surface["value"] + 0.45 * after):
                opacity.AddPoint(value, surface["opacity"])
                colour.AddRGBPoint(value, *surface["colour"])
        return opacity, colour
    opacity.AddPoint(0, 1)
    if "low" in mode:
        colour.AddRGBPoint(mode["low"], 0, 0, 0)
        colour.AddRGBPoint(mode["high"], 1, 1, 1)
    else:
        for point in panel["transfer_function"]["points"]:
            colour.AddRGBPoint(point["value"], *point["colour"])
    return opacity, colour


def look_of(vtk, panel, colours, ambient=1, diffuse=0, specular=0):
    """What densities look like, by that share of each kind of light."""
    look = vtk.vtkVolumeProperty()
    if "mode" in panel:
        opacity, colour = mode_tables(vtk, panel)
        for index, surface in enumerate(panel["mode"].get("surfaces", [])):
            look.GetIsoSurfaceValues().SetValue(index, surface["value"])
    else:
        opacity, colour = tables(vtk, panel["transfer_function"], colours)
        look.SetScalarOpacityUnitDistance(panel["transfer_function"]["reference_length"])
    look.SetScalarOpacity(opacity)
    look.SetColor(colour)
    if panel["interpolation"]["method"] == "nearest":
        look.SetInterpolationTypeToNearest()
    else:
        look.SetInterpolationTypeToLinear()
    look.SetShade(bool(panel["phong"]))
    look.SetAmbient(ambient)
    look.SetDiffuse(diffuse)
    look.SetSpecular(specular)
    look.SetSpecularPower(panel["phong"]["shininess"] if panel["phong"] else 1)
    return look


def looks_of(vtk, panel, stock):
    """Looks whose pictures add up to that of the panel: the highlight is white."""
    colours, phong = (panel["transfer_function"] or {}).get("colours"), panel["phong"]
    if not phong:
        return [look_of(vtk, panel, colours)]
    ambient, diffuse, specular = phong["ambient"], phong["diffuse"], phong["specular"]
    if stock or "mode" in panel:
        return [look_of(vtk, panel, colours, ambient, diffuse, specular)]
    looks = [look_of(vtk, panel, colours, ambient, diffuse)]
    if specular:
        looks.append(look_of(vtk, panel, [[1, 1, 1]], 0, 0, specular))
    return looks


def image_of(vtk, grid, folder):
    from vtk.util.numpy_support import numpy_to_vtk

    nodes, spacing, first = (np.array(grid[key]) for key in ("nodes", "spacing", "first_node"))
    box_min, box_max = np.array(grid["box_min"]), np.array(grid["box_max"])
    values = np.fromfile(folder / grid["file"], "<f4").reshape(nodes[::-1])
    image = vtk.vtkImageData()
    if np.all(box_min < first - 0.25 * spacing):
        # Values of cells: the box reaches half a voxel beyond the outermost nodes.
        image.SetDimensions((nodes + 1).tolist())
        image.SetSpacing(spacing)
        image.SetOrigin(box_min)
        attributes = image.GetCellData()
    else:
        for axis in np.flatnonzero(nodes == 1):
            # Two layers on the faces, as along such an axis the field is constant.
            values = np.repeat(values, 2, axis=2 - axis)
            nodes[axis], first[axis] = 2, box_min[axis]
            spacing[axis] = box_max[axis] - box_min[axis]
        image.SetDimensions(nodes.tolist())
        image.SetSpacing(spacing)
        image.SetOrigin(first)
        attributes = image.GetPointData()
    attributes.SetScalars(numpy_to_vtk(np.ascontiguousarray(values).ravel(), deep=True))
    return image


def planes_of(panel):
    """Points and normals of the planes that clip the volumes."""
    for index in parts_of(panel)[0].get("clips", []):
        clip = panel["clips"][index]
        if clip["kind"] == "plane":
            yield clip["point"], clip["normal"]
            continue
        for axis in np.eye(3):
            yield clip["min"], axis
            yield clip["max"], -axis


def mapper_of(vtk, panel, folder, step):
    parts = parts_of(panel)
    mapper = vtk.vtkGPUVolumeRayCastMapper()
    for port, part in enumerate(parts):
        mapper.SetInputDataObject(port, image_of(vtk, part["grid"], folder))
    for point, normal in planes_of(panel):
        plane = vtk.vtkPlane()
        plane.SetOrigin(point)
        plane.SetNormal(normal)
        mapper.AddClippingPlane(plane)
    mapper.AutoAdjustSampleDistancesOff()
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.UseJitteringOff()
    mode = panel.get("mode", {"exact": False})
    if mode["exact"]:
        step = step or panel["sampling"]["step"] / 16
    # Several volumes have one step.
    mapper.SetSampleDistance(step or min(part["sampling"]["step"] for part in parts))
    if "mode" in panel:
        getattr(mapper, f"SetBlendModeTo{BLENDS[mode['name']]}")()
    return mapper


def camera_of(vtk, panel):
    ray = panel["ray"]
    eye, forward, up = (np.array(ray[key]) for key in ("eye", "forward", "half_up"))
    camera = vtk.vtkCamera()
    camera.SetPosition(eye)
    camera.SetFocalPoint(eye + forward)
    camera.SetViewUp(up)
    if "orthographic_height" in ray:
        camera.SetParallelProjection(True)
        camera.SetParallelScale(ray["orthographic_height"] / 2)
    else:
        camera.SetViewAngle(2 * np.degrees(np.arctan(np.linalg.norm(up))))
    corners = np.concatenate([corners_of(part["grid"]) for part in parts_of(panel)])
    reach = np.linalg.norm(np.abs(corners - eye).max(0))
    camera.SetClippingRange(1e-3 * reach, 2 * reach)
    return camera


def corners_of(grid):
    """The corners of the box of a grid in the world."""
    ends = np.array([grid["box_min"], grid["box_max"]])
    corners = np.array([[ends[i, 0], ends[j, 1], ends[k, 2], 1] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    return corners @ np.array(grid.get("matrix", np.eye(3, 4))).T


def volume_of(vtk, mapper, parts, looks):
    """The volume, or several as one."""
    volumes = []
    for part, look in zip(parts, looks):
        volume = vtk.vtkVolume()
        volume.SetProperty(look)
        if "matrix" in part["grid"]:
            matrix = vtk.vtkMatrix4x4()
            matrix.DeepCopy(np.vstack([part["grid"]["matrix"], [0, 0, 0, 1]]).ravel())
            volume.SetUserMatrix(matrix)
        volumes.append(volume)
    if len(volumes) == 1:
        volumes[0].SetMapper(mapper)
        return volumes[0]
    together = vtk.vtkMultiVolume()
    together.SetMapper(mapper)
    for port, volume in enumerate(volumes):
        together.SetVolume(volume, port)
    return together


def actor_of(vtk, surface, look):
    """A sphere, lit as the volumes are by their look."""
    source = vtk.vtkSphereSource()
    source.SetRadius(surface["radius"])
    source.SetCenter(surface["centre"])
    source.SetThetaResolution(512)
    source.SetPhiResolution(512)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    if surface["matrix"]:
        matrix = vtk.vtkMatrix4x4()
        matrix.DeepCopy(np.vstack([surface["matrix"], [0, 0, 0, 1]]).ravel())
        actor.SetUserMatrix(matrix)
    material = actor.GetProperty()
    material.SetInterpolationToPhong()
    material.SetColor(surface["colour"])
    material.SetSpecularColor(1, 1, 1)
    lit = bool(surface["phong"])
    material.SetAmbient(look.GetAmbient() if lit else 1)
    material.SetDiffuse(look.GetDiffuse() if lit else 0)
    material.SetSpecular(look.GetSpecular() if lit else 0)
    material.SetSpecularPower(look.GetSpecularPower())
    return actor


def picture(vtk, panel, mapper, looks, stock):
    """The picture as floats: VTK's usual buffers hold 8 bits, too few to be judged."""
    volume = volume_of(vtk, mapper, parts_of(panel), looks)
    if not stock:
        for theirs, ours in SHADER.items():
            volume.GetShaderProperty().AddFragmentShaderReplacement(theirs, False, ours, False)
    renderer = vtk.vtkRenderer()
    renderer.AddVolume(volume)
    for surface in panel.get("surfaces", []):
        renderer.AddActor(actor_of(vtk, surface, looks[0]))
    renderer.SetActiveCamera(camera_of(vtk, panel))
    renderer.SetTwoSidedLighting(False)
    renderer.SetAutomaticLightCreation(False)
    if panel["light"]:
        light = vtk.vtkLight()
        light.SetLightTypeToSceneLight()
        light.SetPositional(True)
        light.SetConeAngle(180)
        light.SetPosition(panel["light"]["position"])
        renderer.AddLight(light)
    floats = vtk.vtkFramebufferPass()
    floats.SetDelegatePass(vtk.vtkRenderStepsPass())
    floats.SetColorFormat(vtk.vtkTextureObject.Float32)
    # With the depth format that it chooses itself, VTK 9.7 shows no volume in software.
    floats.SetDepthFormat(vtk.vtkTextureObject.Fixed32)
    renderer.SetPass(floats)

    width, height = panel["width"], panel["height"]
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    window.Render()
    pixels = np.zeros((height, width, 4), np.float32)
    texture = floats.GetColorTexture()
    texture.Download().Download2D(vtk.VTK_FLOAT, pixels, (width, height), 4, (0, 0))
    return pixels[::-1]


def render(vtk, panel, folder, step, stock):
    parts = parts_of(panel)
    stock = stock or len(parts) > 1  # the shader of several volumes has other lines
    mapper = mapper_of(vtk, panel, folder, step)
    looks = zip(*(looks_of(vtk, part, stock) for part in parts))
    pictures = [picture(vtk, panel, mapper, of_all, stock) for of_all in looks]
    behind = 1 - pictures[0][:, :, 3:]
    return sum(p[:, :, :3] for p in pictures) + behind * panel["background"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("bundle", type=Path)
    parser.add_argument("output", type=image_path)
    parser.add_argument("--stock", action="store_true", help="VTK as it is, shader and all")
    parser.add_argument("--step", type=float, help="distance between samples, world units")
    options = parser.parse_args()
    bundle = json.loads(options.bundle.read_text("utf-8"))
    if bundle["schema"] != "volref/bundle/1":
        sys.exit(f"{options.bundle}: not a bundle that this script knows")
    for panel in bundle["panels"]:
        found = obstacles(panel)
        if found:
            sys.exit(f"{options.bundle}: refused: " + "; ".join(found))
    try:
        import vtk
    except ImportError:
        sys.exit("VTK is missing: pip install vtk")
    image = np.zeros((bundle["image"]["height"], bundle["image"]["width"], 3))
    for panel in bundle["panels"]:
        columns = slice(panel["first_column"], panel["first_column"] + panel["width"])
        image[:, columns] = render(
            vtk, panel, options.bundle.parent, options.step, options.stock
        )
    write_image(options.output, image)


if __name__ == "__main__":
    main()
