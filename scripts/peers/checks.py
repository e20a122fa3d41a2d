#!/usr/bin/env python3
"""Faults of renderers, shown without volref: the numbers of src/guide/findings.md.

    checks.py yt_order pygfx_moved ...        # all, if none is named; each needs its renderer alone
"""

import os
import sys

os.environ.setdefault("EGL_PLATFORM", "surfaceless")

import numpy as np


def yt_image(values, lens, extinction, depth=3.5):
    """Opaque red where values are below 1.5, green above; the eye looks along +z from z = -3 at a box from 0 to 1."""
    import yt
    from yt.visualization.volume_rendering.api import ColorTransferFunction, Scene, create_volume_source

    yt.set_log_level("error")
    data = yt.load_uniform_grid({"value": values}, values.shape, bbox=np.array([[0, 1.0]] * 3))
    source = create_volume_source(data.all_data(), ("stream", "value"))
    source.log_field = False
    scene = Scene()
    scene.add_source(source)
    camera = scene.add_camera(data, lens_type=lens)
    camera.resolution = (5, 5)
    camera.position = data.arr([0.5, 0.5, -3.0], "code_length")
    camera.focus = data.arr([0.5, 0.5, 0.5], "code_length")
    camera.switch_orientation(north_vector=[0, 1, 0])
    camera.width = data.arr([2, 2, depth], "code_length")
    look = ColorTransferFunction((0, 3), grey_opacity=True)
    look.red.y, look.green.y = 1.0 * (look.red.x < 1.5), 1.0 * (look.red.x >= 1.5)
    look.alpha.y = np.full(look.nbins, float(extinction))
    source.transfer_function = look
    return np.asarray(scene.render())[2, 2]


def yt_order():
    """Of a red half in front of a green one, both opaque, the red one should be seen."""
    values = np.ones((8, 8, 8))
    values[:, :, 4:] = 2
    for lens in ("plane-parallel", "perspective"):
        red, green = yt_image(values, lens, 200)[:2]
        print(f"{lens}: red {red:.3f}, green {green:.3f}")


def yt_depth():
    """The opacity of a box of extinction 0.2 and length 1 should be 0.181, whatever the depth of the camera."""
    for depth in (3.5, 7.0):
        print(f"depth {depth}: opacity {yt_image(np.ones((8, 8, 8)), 'plane-parallel', 0.2, depth)[3]:.4f}")


def pygfx_ball(spacing, offset, with_plane=False):
    """A ball as an isosurface, lit by a lamp beside the eye; moved with camera, lamp and the plane behind it."""
    import pygfx as gfx

    counts = np.round(40 / np.array(spacing)).astype(int) + 1
    x, y, z = (np.arange(count) * step - 20 for count, step in zip(counts, spacing))
    values = 20 - np.sqrt(x**2 + y[:, None] ** 2 + z[:, None, None] ** 2)
    white = gfx.Texture(np.ones((4, 4), np.float32), dim=1)
    look = gfx.VolumeIsoMaterial(clim=(-20, 20), threshold=8, step_size=0.25, substep_size=0.02, map=white)
    ball = gfx.Volume(gfx.Geometry(grid=gfx.Texture(values.astype(np.float32), dim=3)), look)
    ball.local.scale, ball.local.position = spacing, np.add(offset, -20)
    lamp = gfx.PointLight(intensity=3, decay=0)
    lamp.local.position = np.add(offset, [60, 40, 80])
    scene = gfx.Scene()
    scene.add(ball, lamp)
    if with_plane:
        plane = gfx.Mesh(gfx.plane_geometry(100, 100), gfx.MeshBasicMaterial(color="red", side="both"))
        plane.local.position = np.add(offset, [0, 0, -30])
        scene.add(plane)
    camera = gfx.PerspectiveCamera(40, 1, depth_range=(10, 400))
    camera.local.position = np.add(offset, [0, 0, 120])
    camera.look_at(offset)
    renderer = gfx.WgpuRenderer(gfx.Texture(dim=2, size=(64, 64, 1), format="rgba8unorm"), pixel_ratio=1, ppaa="none")
    renderer.render(scene, camera)
    return renderer.snapshot()[..., :3].astype(int)


def pygfx_moved():
    """The pictures should not change where all is moved."""
    here, there = (pygfx_ball((1, 1, 1), (x, 0, 0)) for x in (0, 200))
    print(f"moved along x: mean code {here.mean():.2f} and {there.mean():.2f}")
    for z in (0, 200):
        lit = (pygfx_ball((1, 1, 1), (0, 0, z), with_plane=True)[..., 1] > 0).sum()
        print(f"in front of a plane, moved by {z} along z: {lit} pixels of the ball")


def pygfx_normals():
    """The same ball on finer grids: the pictures should hardly change."""
    reference = pygfx_ball((1, 1, 1), (0, 0, 0))
    for spacing in ((0.5, 0.5, 0.5), (1, 1, 0.5), (1, 1, 0.25)):
        picture = pygfx_ball(spacing, (0, 0, 0))
        off = (np.abs(picture - reference).max(2) > 8).sum()
        print(f"voxels {spacing}: mean code {picture.mean():.2f}, {off} of {(reference.max(2) > 0).sum()} lit pixels differ")


def vtk_picture(image, gpu, nearest=False, matrix=None, opacity=1.0, clear=False, other=None, eye=(0, 0, -5), lamp=None):
    """Values as greys from 0 to 1, in parallel from `eye`, 2 units in 200 pixels; lit by a lamp."""
    import vtk

    mapper = vtk.vtkGPUVolumeRayCastMapper() if gpu else vtk.vtkFixedPointVolumeRayCastMapper()
    mapper.AutoAdjustSampleDistancesOff()
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.SetSampleDistance(0.05)
    if not gpu:
        mapper.SetImageSampleDistance(0.1)
    colour, opacities = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    colour.AddRGBPoint(0, 0, 0, 0)
    colour.AddRGBPoint(1, 1, 1, 1)
    opacities.AddPoint(0, 0 if clear else opacity)
    opacities.AddPoint(1, opacity)
    look = vtk.vtkVolumeProperty()
    look.SetColor(colour)
    look.SetScalarOpacity(opacities)
    look.SetShade(lamp is not None)
    look.SetInterpolationTypeToNearest() if nearest else look.SetInterpolationTypeToLinear()
    volumes = []
    for port, one in enumerate([image] + [other] * (other is not None)):
        mapper.SetInputDataObject(port, one)
        volume = vtk.vtkVolume()
        volume.SetProperty(look)
        if matrix is not None:
            placed = vtk.vtkMatrix4x4()
            placed.DeepCopy(np.ravel(matrix))
            volume.SetUserMatrix(placed)
        volumes.append(volume)
    shown = volumes[0]
    if other is not None:
        shown = vtk.vtkMultiVolume()
        for port, volume in enumerate(volumes):
            shown.SetVolume(volume, port)
    shown.SetMapper(mapper)
    renderer = vtk.vtkRenderer()
    renderer.AddVolume(shown)
    if lamp is not None:
        renderer.SetAutomaticLightCreation(False)
        light = vtk.vtkLight()
        light.SetLightTypeToSceneLight()
        light.SetPositional(True)
        light.SetConeAngle(180)
        light.SetPosition(lamp)
        renderer.AddLight(light)
        look.SetAmbient(0)
        look.SetDiffuse(1)
        look.SetSpecular(0)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetParallelScale(1)
    camera.SetPosition(eye)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(0, 1, 0)
    camera.SetClippingRange(1, 10)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(200, 200)
    window.AddRenderer(renderer)
    window.Render()
    from vtk.util.numpy_support import vtk_to_numpy

    codes = vtk.vtkUnsignedCharArray()
    window.GetPixelData(0, 0, 199, 199, 0, codes, 0)
    return vtk_to_numpy(codes).reshape(200, 200, 3)[:, ::-1, 0].astype(int)  # x to the right


def vtk_image(values, extent=0.8):
    """Values, of shape (z, y, x), at nodes from -extent to extent: one for all axes, or x, y and z."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    image = vtk.vtkImageData()
    image.SetDimensions(values.shape[::-1])
    extent = np.broadcast_to(extent, 3)
    image.SetSpacing(2 * extent / (np.array(values.shape[::-1]) - 1))
    image.SetOrigin(-extent)
    image.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(values, np.float32).ravel(), deep=1))
    return image


def vtk_nearest():
    """Of five nodes at x = -0.8, -0.4 ... 0.8 with greys 0, 1/4 ... 1, colours should change at -0.6, -0.2, 0.2, 0.6."""
    image = vtk_image(np.broadcast_to(np.linspace(0, 1, 5), (5, 5, 5)))
    for name, gpu in (("graphics card", True), ("processor", False)):
        row = vtk_picture(image, gpu, nearest=True)[100]
        places = (np.flatnonzero(np.abs(np.diff(row)) > 20) + 1) / 100 - 1
        print(f"{name}: changes at x = {', '.join(f'{place:.2f}' for place in places)}")


def vtk_placed():
    """A box of 1.6 and opacity 0.5 over 1 should have 1 - 0.5^1.6 = 0.670, code 171; by a matrix, too."""
    ones = np.ones((3, 3, 3))
    print("spacing 0.8:", vtk_picture(vtk_image(ones), True, opacity=0.5)[100, 100])
    print("spacing 8, a matrix of 1/10:", vtk_picture(vtk_image(ones, 8), True, opacity=0.5, matrix=np.diag([0.1, 0.1, 0.1, 1]))[100, 100])


def vtk_several():
    """A box from -0.4 to 0.4 should be 80 of 200 pixels wide, also in a larger one that is clear."""
    box, clear = vtk_image(np.ones((3, 3, 3)), 0.4), vtk_image(np.zeros((3, 3, 3)), 0.8)
    print("alone:", (vtk_picture(box, True, clear=True)[100] > 20).sum(), "pixels")
    print("in the larger one:", (vtk_picture(box, True, clear=True, other=clear)[100] > 20).sum(), "pixels")


def vtk_unlit():
    """A ball lit by a lamp at its side should be as dark in a larger, clear volume as alone."""
    x = np.linspace(-0.8, 0.8, 33)
    distance = np.sqrt(x**2 + x[:, None] ** 2 + x[:, None, None] ** 2)
    ball, clear = vtk_image(np.clip(10 * (0.6 - distance), 0, 1), (0.8,) * 3), vtk_image(np.zeros((3, 3, 3)), 1)
    for name, other in (("alone", None), ("in the larger one", clear)):
        codes = vtk_picture(ball, True, clear=True, other=other, lamp=(5, 0, 0))
        print(f"{name}: mean code {codes[codes > 0].mean():.1f}")


def vtk_normals():
    """A ball lit by a lamp should look the same in a cube and in a box twice as long, from wherever it is seen."""

    def ball(extent):
        x, y, z = (np.linspace(-e, e, round(40 * e) + 1) for e in extent)
        distance = np.sqrt(x**2 + y[:, None] ** 2 + z[:, None, None] ** 2)
        return vtk_image(np.clip(10 * (0.6 - distance), 0, 1), extent)

    for eye in ((0, 0, -5), (3, 3, -3)):
        cube, box = (vtk_picture(ball(extent), True, clear=True, eye=eye, lamp=(2, 3, -4)) for extent in ((1, 1, 1), (1, 1, 2)))
        print(f"seen from {eye}: mean code {cube[cube > 0].mean():.1f} and {box[cube > 0].mean():.1f}")


def pyvista_cells():
    """A cell of 1 among cells of 0: within the cell the value should be 1."""
    import pyvista

    image = pyvista.ImageData(dimensions=(6, 6, 6))
    values = np.zeros((5, 5, 5))
    values[2, 2, 2] = 1
    image.cell_data["values"] = values.ravel()
    plotter = pyvista.Plotter(off_screen=True)
    actor = plotter.add_volume(image, scalars="values", show_scalar_bar=False)
    drawn = actor.mapper.GetInput()
    print(f"drawn: {drawn.GetPointData().GetScalars().GetRange()} at {drawn.GetNumberOfPoints()} points, cell data: "
          f"{drawn.GetCellData().GetScalars() is not None}")  # fmt: skip


# A lamp from (-5.3, -3.7) to (6.6, 4.2), seen such that a unit is a pixel, in the middle of 32 by 32.
SIDE, LAMP = 32, [(-5.3, -3.7, 0), (6.6, -3.7, 0), (6.6, 4.2, 0), (-5.3, 4.2, 0)]


def print_edges(image, label):
    """Of the lamp, by its light in the middle columns and rows; rows of the image run from the bottom."""
    half, light = SIDE // 2, image / image.max()
    across, up = light[half - 2 : half + 2].mean(0), light[:, half - 2 : half + 2].mean(1)
    edges = [-across[:half].sum(), across[half:].sum(), -up[:half].sum(), up[half:].sum()]
    print(f"{label}: x from {edges[0]:.2f} to {edges[1]:.2f}, y from {edges[2]:.2f} to {edges[3]:.2f}")


def cycles_first():
    """The edges of a lamp, the mean of 16 seeds, should be at x -5.3 and 6.6, y -3.7 and 4.2, with 4 samples as with 64."""
    import tempfile

    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine, scene.render.resolution_x, scene.render.resolution_y = "CYCLES", SIDE, SIDE
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.angle, camera.location = 2 * np.arctan(0.5), (0, 0, SIDE)
    mesh, look = bpy.data.meshes.new("lamp"), bpy.data.materials.new("light")
    mesh.from_pydata(LAMP, [], [(0, 1, 2, 3)])
    look.use_nodes = True
    nodes = look.node_tree.nodes
    nodes.clear()
    look.node_tree.links.new(nodes.new("ShaderNodeEmission").outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs[0])
    mesh.materials.append(look)
    for thing in (camera, bpy.data.objects.new("lamp", mesh)):
        scene.collection.objects.link(thing)
    scene.camera = camera
    for samples, offset in ((1, 0), (4, 0), (64, 0), (4, 1)):
        scene.cycles.samples, scene.cycles.use_sample_subset = samples + offset, True
        scene.cycles.sample_offset, scene.cycles.sample_subset_length = offset, samples
        images = []
        for scene.cycles.seed in range(1000, 1016):
            with tempfile.TemporaryDirectory() as folder:
                scene.render.filepath = f"{folder}/image.exr"
                bpy.ops.render.render(write_still=True)
                image = bpy.data.images.load(scene.render.filepath)
                image.colorspace_settings.name = "Non-Color"
                images.append(np.array(image.pixels[:]).reshape(SIDE, SIDE, 4)[:, :, 0])
        print_edges(np.mean(images, axis=0), f"{samples} samples from number {offset} on")


def lux_image(vertices, triangles, camera, albedo, side, samples, more=""):
    """A diffuse shape that emits 1, as LuxCore's path tracer shows it; rows from the bottom."""
    import time

    import pyluxcore

    pyluxcore.Init()
    pyluxcore.SetLogHandler(lambda line: None)
    scene, properties, settings = pyluxcore.Scene(), pyluxcore.Properties(), pyluxcore.Properties()
    look = f"type = matte\nkd = {albedo} {albedo} {albedo}\nemission = 1 1 1\nemission.theta = 90".splitlines()
    lines = ["scene.camera.type = perspective", "scene.camera.screenwindow = -1 1 -1 1", *camera.splitlines()]
    lines += [f"scene.materials.look.{line}" for line in look]
    lines += ["scene.objects.shape.material = look", "scene.objects.shape.shape = shape"]
    properties.SetFromString("\n".join(lines) + "\n")
    scene.DefineMesh("shape", vertices, triangles, None, None, None, None)
    scene.Parse(properties)
    settings.SetFromString(
        f"renderengine.type = PATHCPU\nsampler.type = RANDOM\nfilm.width = {side}\nfilm.height = {side}\n"
        "film.filter.type = BOX\nfilm.filter.width = 0.5\nfilm.imagepipelines.0.0.type = NOP\n"
        f"path.pathdepth.total = 1000\npath.pathdepth.diffuse = 1000\nbatch.haltspp = {samples}\n{more}"
    )
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(settings, scene))
    session.Start()
    while not session.HasDone():
        time.sleep(0.05)
        session.UpdateStats()
    session.Stop()
    image = np.zeros(side * side * 3, np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, image)
    return image.reshape(side, side, 3)[:, :, 0]


def lux_low():
    """The edges of a lamp should be at x -5.3 and 6.6, y -3.7 and 4.2."""
    camera = (
        f"scene.camera.lookat.orig = 0 0 {SIDE}\nscene.camera.lookat.target = 0 0 0\nscene.camera.up = 0 1 0\n"
        f"scene.camera.fieldofview = {2 * np.degrees(np.arctan(0.5))}"
    )
    print_edges(lux_image(LAMP, [(0, 1, 2), (0, 2, 3)], camera, 0, SIDE, 256), "lamp")


def lux_roulette():
    """A closed box of albedo 0.73 that emits 1 should have the radiance 1/(1 - 0.73) = 3.704 everywhere."""
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    inward = [(2, 3, 1, 0), (5, 7, 6, 4), (1, 5, 4, 0), (6, 7, 3, 2), (4, 6, 2, 0), (3, 7, 5, 1)]
    triangles = [half for a, b, c, d in inward for half in ((a, b, c), (a, c, d))]
    camera = (
        "scene.camera.lookat.orig = 0.1 0.2 0.5\nscene.camera.lookat.target = 0 0 -1\n"
        "scene.camera.up = 0 1 0\nscene.camera.fieldofview = 60"
    )
    for label, more in (("with roulette", ""), ("without", "path.russianroulette.depth = 1000\n")):
        image = lux_image(corners, triangles, camera, 0.73, 16, 256, more)
        print(f"{label}: {image.mean():.3f} ± {image.std() / 16:.3f}")


def lux_weights():
    """Weights of light that is sampled and light that is hit should add up to 1. With the probability of roulette, 0.5, in
    the one alone, the same box should have the radiance that is printed; places on its walls are taken to be even."""
    random = np.random.default_rng(1)
    place, (share, angle) = np.append(random.uniform(-1, 1, (2, 10**6)), [[-1.0] * 10**6], axis=0), random.random((2, 10**6))
    around = 2 * np.pi * angle
    direction = np.array([np.sqrt(share) * np.cos(around), np.sqrt(share) * np.sin(around), np.sqrt(1 - share)])
    distances = (np.where(direction > 0, 1, -1) - place) / direction
    wall, distance = distances.argmin(0), distances.min(0)
    # Per solid angle: one of twelve triangles of area 2, and the cosine over pi.
    by_light = distance**2 / np.take_along_axis(np.abs(direction), wall[None], 0)[0] / 2 / 12
    by_surface = direction[2] / np.pi
    sums = by_light**2 / (by_light**2 + (0.5 * by_surface) ** 2) + by_surface**2 / (by_light**2 + by_surface**2)
    # Roulette begins at the third turn.
    print(f"weights add up to {sums.mean():.3f}, radiance {1 / 0.27 + (sums.mean() - 1) * 0.73**3 / 0.27:.3f}")


def lux_frame(z):
    """Vectors beside z, of the length of z and of 1, as LuxCore has them."""
    along = np.hypot(z[0], z[1])
    beside = np.where(along < 1e-5, [[1], [0], [0]], [-z[1], z[0], 0 * along] / np.where(along < 1e-5, 1, along))
    beside = beside.astype(np.float32)
    return np.cross(z, beside, axis=0), beside


def lux_turns():
    """A white box in a white sky has the radiance 1. Light that a medium turns, by frames of directions as LuxCore builds
    them, in 32 bits: with directions of length 1, and as they come out."""

    def faces(place, direction):
        with np.errstate(divide="ignore", over="ignore"):
            return np.where(direction == 0, np.inf, (np.sign(direction) - place) / direction).min(0)

    for label, normalise in (("of length 1", True), ("as they come out", False)):
        random, light, extinction = np.random.default_rng(1), np.zeros(100_000), 4
        alive = np.arange(light.size)
        place = random.uniform(-1, 1, (3, light.size)).astype(np.float32)
        place[2], direction = -1, np.zeros_like(place)
        direction[2] = 1
        for turn in range(1000):
            step = random.exponential(1 / extinction, alive.size).astype(np.float32)
            stays = step < faces(place, direction)
            # Half by light that is sampled, half by light that is hit, but for what is seen directly.
            light[alive[~stays]] += 0.5 if turn else 1
            alive, place, direction = alive[stays], (place + step * direction)[:, stays], direction[:, stays]
            ray = random.normal(size=place.shape)
            light[alive] += 0.5 * np.exp(-extinction * faces(place, ray / np.linalg.norm(ray, axis=0)))
            z = -direction / (np.linalg.norm(direction, axis=0) if normalise else 1)
            x, y = lux_frame(z)
            back = np.array([(z * axis).sum(0) for axis in (x, y, z)])
            cosine, around = random.uniform(-1, 1, alive.size), random.uniform(0, 2 * np.pi, alive.size)
            sine = np.sqrt(1 - cosine**2)
            a, b = lux_frame(back)
            a, b, c = (sine * np.cos(around) * a + sine * np.sin(around) * b + cosine * back).astype(np.float32)
            direction = x * a + y * b + z * c
        print(f"directions {label}: {light.mean():.3f} ± {light.std() / light.size**0.5:.3f}, median {np.median(light):.2f}")


def mitsuba_floor():
    """A white floor below a white sky has the radiance 1, and so has a box of a medium of albedo 1 on it."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    place, black = mi.ScalarTransform4f, {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
    white = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 1.0}}
    film = {"type": "hdrfilm", "width": 24, "height": 24, "rfilter": {"type": "box"}}
    for gap in (0, 1e-3):
        parts = {
            "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 100000},
            "sky": {"type": "constant", "radiance": 1.0},
            "floor": {"type": "rectangle", "to_world": place().scale(20), "bsdf": {"type": "twosided", "of": white}},
            "below": {"type": "rectangle", "to_world": place().translate([0, 0, -0.5]).scale(19.5), "bsdf": {"type": "twosided", "of": black}},
            "box": {"type": "cube", "to_world": place().translate([0, 0, 1 + gap]), "bsdf": {"type": "null"},
                    "interior": {"type": "homogeneous", "albedo": 1.0, "sigma_t": 2.0}},
            "sensor": {"type": "perspective", "fov": 35, "film": film, "sampler": {"type": "independent"},
                       "to_world": place().look_at([4, 1, 3], [0, 0, 0.4], [0, 0, 1])},
        }  # fmt: skip
        scene = mi.load_dict({"type": "scene", **parts})
        means = [np.array(mi.render(scene, spp=32, seed=seed)).mean() for seed in range(8)]
        print(f"box {gap} above the floor: {np.mean(means):.4f} ± {np.std(means, ddof=1) / 8**0.5:.4f}")


def diffdrr_ends():
    """A voxel of 1 should count 1 wherever it stands on its axis, here of ten."""
    import torch
    from diffdrr.renderers import Siddon, Trilinear

    source, target = (torch.tensor([[[x, 0.0, 0.0]]], dtype=torch.float64) for x in (-20, 40))
    length = (target - source).norm(dim=-1).unsqueeze(1)
    for name, renderer, words in (("Siddon", Siddon(), {}), ("Trilinear", Trilinear(), {"n_points": 20001})):
        for at in (0, 5, 9):
            volume = torch.zeros(10, 1, 1, dtype=torch.float64)
            volume[at] = 1
            print(f"DiffDRR, {name}: voxel {at} counts {renderer(volume, source, target, length, **words).item():.4f}")


def povray_places():
    """The glow of the fourth of eight voxels should lie around 3.5, interpolated or not."""
    import subprocess
    import tempfile
    from pathlib import Path

    for interpolate in (0, 1, 2):
        with tempfile.TemporaryDirectory() as folder:
            values = np.array([0, 0, 0, 65535, 0, 0, 0, 0], ">u2")
            Path(folder, "v.df3").write_bytes(np.array([8, 1, 1], ">u2").tobytes() + values.tobytes())
            density = f'density {{ density_file df3 "v.df3" interpolate {interpolate} }}'
            Path(folder, "s.pov").write_text(
                "#version 3.7; global_settings { assumed_gamma 1 } camera { orthographic location <0.5, 0.5, -1> "
                "direction z right x up y / 16 } box { 0, 1 hollow pigment { rgbt 1 } finish { ambient 0 diffuse 0 } "
                f"interior {{ media {{ method 3 intervals 1 samples 4, 4 emission 1 {density} }} }} }}"
            )
            call = "povray +Is.pov +Oi.ppm +FP16 File_Gamma=1 +W128 +H8 -D -A".split()
            subprocess.run(call, cwd=folder, capture_output=True, check=True)
            data = Path(folder, "i.ppm").read_bytes()
        row = np.frombuffer(data[-6 * 128 * 8 :], ">u2").reshape(8, 128, 3)[4, :, 0] / 65535
        centre = (row * (np.arange(128) + 0.5)).sum() / row.sum() / 16
        print(f"POV-Ray, interpolate {interpolate}: the glow lies around {centre:.2f}")


CHECKS = [yt_order, yt_depth, pygfx_moved, pygfx_normals, vtk_nearest, vtk_placed, vtk_several, vtk_unlit, vtk_normals]
CHECKS += [pyvista_cells, diffdrr_ends, povray_places, cycles_first, lux_low, lux_roulette, lux_weights, lux_turns, mitsuba_floor]

if __name__ == "__main__":
    for check in CHECKS:
        if not sys.argv[1:] or check.__name__ in sys.argv[1:]:
            print(f"{check.__name__}: {check.__doc__}")
            check()
