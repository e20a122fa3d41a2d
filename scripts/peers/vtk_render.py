#!/usr/bin/env python3
"""Renders a bundle of a classified volume with VTK's ray caster for graphics cards.

    volref export SCENE --to bundle -o DIR
    vtk_render.py DIR/SCENE.json OUTPUT            # OUTPUT: .npy, .pfm or .exr
    vtk_render.py DIR/SCENE.json OUTPUT --step H   # another distance between samples
    volref validate limit --as vtk --serve 'vtk_render.py --serve {export:bundle} {step} --stock'

Needs `pip install vtk volref`; without a screen VTK uses EGL or OSMesa, in software where there is
no card. What VTK cannot say is refused by name.

VTK's tables take the opacity of a reference length, which VTK corrects for the step, and the colour,
of a formula times d^2. Where its model differs by design, lines of its shader are replaced (`SHADER` below);
--stock leaves them as they are. VTK.md beside this file tells what that changes, and by how much.
"""

import argparse

import numpy as np
import vtk
import volref
from vtk.util.numpy_support import numpy_to_vtk

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


def refuse_what_vtk_cannot_say(bundle):
    features = ["several", "placed", "shading", "clips", "surfaces"]
    if "shadow" in bundle.asks:
        volref.refuse("the volume shadow (VTK scatters light by a model of its own)")
    bundle.allow(*features, *BLENDS)
    panel, parts = bundle.panel, bundle.volumes
    if any(volume.has_jump for volume in parts if volume.json["transfer_function"]):
        volref.refuse("a table with a jump (VTK's runs in straight lines)")
    if any(surface["kind"] != "sphere" for surface in panel.get("surfaces", [])):
        volref.refuse("surfaces other than spheres (this script knows no others)")
    if any(volume.json.get("clips") != parts[0].json.get("clips") for volume in parts):
        volref.refuse("clips of some of the volumes (VTK's mapper cuts all alike)")


def tables(volume, white):
    """Opacity over the reference length, and the radiance of an opaque sample, over density; or that of white."""
    opacity, colour = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    transfer = volume.json["transfer_function"]
    if transfer["kind"] == "table":
        for point in transfer["points"]:
            opacity.AddPoint(point["value"], point["opacity"])
            colour.AddRGBPoint(point["value"], *([1, 1, 1] if white else point["colour"]))
        return opacity, colour
    table = volume.table(TABLE)
    for d, a, rgb in zip(np.linspace(*table.range, TABLE), table.opacities, table.colours):
        opacity.AddPoint(d, a)
        colour.AddRGBPoint(d, *([d**2] * 3 if white else rgb))
    return opacity, colour


def mode_tables(volume):
    """Opacity and colour over the values that a projection or isosurfaces show."""
    mode = volume.mode
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
        for point in volume.json["transfer_function"]["points"]:
            colour.AddRGBPoint(point["value"], *point["colour"])
    return opacity, colour


def look_of(volume, white=False, ambient=1, diffuse=0, specular=0):
    """What densities look like, by that share of each kind of light."""
    look, phong = vtk.vtkVolumeProperty(), volume.json["phong"]
    if volume.mode:
        opacity, colour = mode_tables(volume)
        for index, surface in enumerate(volume.mode.get("surfaces", [])):
            look.GetIsoSurfaceValues().SetValue(index, surface["value"])
    else:
        opacity, colour = tables(volume, white)
        look.SetScalarOpacityUnitDistance(volume.reference_length)
    look.SetScalarOpacity(opacity)
    look.SetColor(colour)
    if volume.is_nearest:
        look.SetInterpolationTypeToNearest()
    else:
        look.SetInterpolationTypeToLinear()
    look.SetShade(bool(phong))
    look.SetAmbient(ambient)
    look.SetDiffuse(diffuse)
    look.SetSpecular(specular)
    look.SetSpecularPower(phong["shininess"] if phong else 1)
    return look


def looks_of(volume, stock):
    """Looks whose pictures add up to that of the panel: the highlight is white."""
    phong = volume.json["phong"]
    if not phong:
        return [look_of(volume)]
    ambient, diffuse, specular = phong["ambient"], phong["diffuse"], phong["specular"]
    if stock or volume.mode:
        return [look_of(volume, False, ambient, diffuse, specular)]
    looks = [look_of(volume, False, ambient, diffuse)]
    if specular:
        looks.append(look_of(volume, True, 0, 0, specular))
    return looks


def image_of(volume):
    nodes, spacing, first = (np.array(volume.grid[key]) for key in ("nodes", "spacing", "first_node"))
    box_min, box_max = np.array(volume.grid["box_min"]), np.array(volume.grid["box_max"])
    values = volume.values
    image = vtk.vtkImageData()
    if volume.is_of_cells:
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
    for index in panel.get("volumes", [panel])[0].get("clips", []):
        clip = panel["clips"][index]
        if clip["kind"] == "plane":
            yield clip["point"], clip["normal"]
            continue
        for axis in np.eye(3):
            yield clip["min"], axis
            yield clip["max"], -axis


def mapper_of(bundle):
    mapper = vtk.vtkGPUVolumeRayCastMapper()
    for port, volume in enumerate(bundle.volumes):
        mapper.SetInputDataObject(port, image_of(volume))
    for point, normal in planes_of(bundle.panel):
        plane = vtk.vtkPlane()
        plane.SetOrigin(point)
        plane.SetNormal(normal)
        mapper.AddClippingPlane(plane)
    mapper.AutoAdjustSampleDistancesOff()
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.UseJitteringOff()
    mode = bundle.panel.get("mode", {"exact": False})
    # What is exact is sampled more finely; several volumes have one step.
    mapper.SetSampleDistance(bundle.step / (16 if mode["exact"] and not bundle.asked_step else 1))
    if "name" in mode:
        getattr(mapper, f"SetBlendModeTo{BLENDS[mode['name']]}")()
    return mapper


def camera_of(bundle):
    camera = vtk.vtkCamera()
    camera.SetPosition(bundle.eye)
    camera.SetFocalPoint(bundle.eye + bundle.forward)
    camera.SetViewUp(bundle.up)
    if bundle.parallel_height:
        camera.SetParallelProjection(True)
        camera.SetParallelScale(bundle.parallel_height / 2)
    else:
        camera.SetViewAngle(bundle.field_of_view)
    camera.SetClippingRange(bundle.near_and_far)
    return camera


def volume_of(mapper, parts, looks):
    """The volume, or several as one."""
    volumes = []
    for part, look in zip(parts, looks):
        volume = vtk.vtkVolume()
        volume.SetProperty(look)
        matrix = vtk.vtkMatrix4x4()
        matrix.DeepCopy(part.matrix.ravel())
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


def actor_of(surface, look):
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


def picture(bundle, mapper, looks, stock):
    """The picture as floats: VTK's usual buffers hold 8 bits, too few to be judged."""
    panel = bundle.panel
    volume = volume_of(mapper, bundle.volumes, looks)
    if not stock:
        for theirs, ours in SHADER.items():
            if "mode" in panel and "in_specular" in theirs:
                continue  # surfaces have white highlights
            volume.GetShaderProperty().AddFragmentShaderReplacement(theirs, False, ours, False)
    renderer = vtk.vtkRenderer()
    renderer.AddVolume(volume)
    for surface in panel.get("surfaces", []):
        renderer.AddActor(actor_of(surface, looks[0]))
    renderer.SetActiveCamera(camera_of(bundle))
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

    width, height = bundle.size
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


def render(bundle, stock):
    refuse_what_vtk_cannot_say(bundle)
    parts = bundle.volumes
    stock = stock or len(parts) > 1  # the shader of several volumes has other lines
    mapper = mapper_of(bundle)
    looks = zip(*(looks_of(volume, stock) for volume in parts))
    pictures = [picture(bundle, mapper, of_all, stock) for of_all in looks]
    behind = 1 - pictures[0][:, :, 3:]
    return sum(p[:, :, :3] for p in pictures) + behind * bundle.background


parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
parser.add_argument("--stock", action="store_true", help="VTK as it is, shader and all")
volref.main(render, parser)
