#!/usr/bin/env python3
"""Renders radiative bundles of volref with Blender's Cycles (pip install bpy), and tells the noise.

    cycles_render.py BUNDLE.json OUTPUT.exr
    volref validate smoke --serve 'python3 scripts/peers/cycles_render.py --serve {export:bundle} {spp} {seed}'
"""

import tempfile
from pathlib import Path

import bpy
import mathutils
import numpy as np
import volref
from meshes import density_of, mesh, panel_of, samples_of

MOST = 1024  # times that Cycles can turn light
APART = 1e-5  # share by which media are smaller, so that no face of theirs lies in a surface


def material(build, output="Surface"):
    look = bpy.data.materials.new("look")
    look.use_nodes = True
    tree = look.node_tree
    tree.nodes.clear()
    link = lambda source, target: tree.links.new(source, target)
    link(build(tree.nodes.new, link).outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs[output])
    return look


def diffuse(surface, key):
    if surface["material"] != "diffuse":
        volref.refuse(f"{key}: {surface['material']}")

    def build(new, link):
        node = new("ShaderNodeBsdfDiffuse")
        node.inputs["Color"].default_value = *surface["reflectance"], 1
        return node

    return material(build)


def emission(lamp, key):
    def build(new, link):
        node = new("ShaderNodeEmission")
        node.inputs["Color"].default_value = *lamp["radiance"], 1
        node.inputs["Strength"].default_value = 1
        if lamp["sides"] == "front":
            front = new("ShaderNodeMath")
            front.operation = "SUBTRACT"
            front.inputs[0].default_value = 1
            link(new("ShaderNodeNewGeometry").outputs["Backfacing"], front.inputs[1])
            link(front.outputs[0], node.inputs["Strength"])
        return node

    return material(build)


def coefficients(medium, key):
    density, phase = density_of(medium, key), medium["phase"]
    if phase["kind"] != "henyey-greenstein":
        volref.refuse(f"{key}.phase: {phase['kind']}")

    def build(new, link):
        node = new("ShaderNodeVolumeCoefficients")
        for name, values in (("Absorption", "sigma_a"), ("Scatter", "sigma_s"), ("Emission", "emission")):
            node.inputs[f"{name} Coefficients"].default_value = density * np.array(medium[values])
        node.inputs["Anisotropy"].default_value = phase["g"]
        return node

    return material(build, "Volume")


def put(data, matrix=mathutils.Matrix()):
    thing = bpy.data.objects.new("thing", data)
    thing.matrix_world = matrix
    bpy.context.scene.collection.objects.link(thing)
    return thing


def put_mesh(part, key, folder, look, shrunk=0.0):
    vertices, triangles = mesh(part, key, folder, shrunk)
    data = bpy.data.meshes.new("shape")
    data.from_pydata(vertices.tolist(), [], triangles.tolist())
    data.materials.append(look)
    put(data)


def put_lamp(lamp, key):
    if lamp["kind"] == "spot":
        volref.refuse(f"{key}: the edge of a spot")
    data = bpy.data.lights.new("lamp", {"point": "POINT", "directional": "SUN"}[lamp["kind"]])
    data.color = lamp["intensity"] if lamp["kind"] == "point" else lamp["irradiance"]
    if lamp["kind"] == "point":
        data.shadow_soft_size, data.energy = 0, 4 * np.pi
        put(data, mathutils.Matrix.Translation(lamp["position"]))
    else:
        data.angle, data.energy = 0, 1
        put(data, mathutils.Vector(lamp["direction"]).to_track_quat("-Z", "Y").to_matrix().to_4x4())


def put_camera(ray):
    up, height = np.array(ray["half_up"]), np.linalg.norm(ray["half_up"])
    axes = np.array([np.cross(ray["forward"], up / height), up / height, np.negative(ray["forward"])])
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.clip_start, data.clip_end = "VERTICAL", 1e-6, 1e7
    if "orthographic_height" in ray:
        data.type, data.ortho_scale = "ORTHO", ray["orthographic_height"]
    else:
        data.angle_y = 2 * np.arctan(height)
    matrix = mathutils.Matrix.Translation(ray["eye"]) @ mathutils.Matrix(axes.T.tolist()).to_4x4()
    bpy.context.scene.camera = put(data, matrix)


def set_up(panel):
    """Cycles without limits to light, denoiser and adaptive sampling."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = panel["width"], panel["height"]
    scene.render.use_persistent_data = True  # of pictures that differ by their seeds alone
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = *panel["environment"], 1
    cycles, most = scene.cycles, panel["scattering"]["most"]
    if most == 0:
        volref.refuse("light that nothing turns")
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    for kind in ("max", "diffuse", "glossy", "transmission", "volume", "transparent_max"):
        setattr(cycles, f"{kind}_bounces", MOST if most is None or kind == "transparent_max" else most - 1)
    cycles.sample_clamp_indirect = cycles.sample_clamp_direct = cycles.light_sampling_threshold = 0
    cycles.volume_biased = True  # by steps, which media of one density need not
    # Cycles has no centre: a narrow filter stands for it; its box has the width of a pixel.
    cycles.pixel_filter_type = "BOX" if panel["pixel"]["filter"] == "box" else "GAUSSIAN"
    cycles.filter_width = 0.01
    return scene


def picture(scene, samples, seed):
    # The first sample of a pixel lies in its middle, whatever the seed: it is left out.
    scene.cycles.use_sample_subset, scene.cycles.sample_offset = True, 1
    scene.cycles.samples, scene.cycles.sample_subset_length, scene.cycles.seed = samples + 1, samples, seed
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "image.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        image.colorspace_settings.name = "Non-Color"
        values = np.array(image.pixels[:]).reshape(image.size[1], image.size[0], 4)
        bpy.data.images.remove(image)
    return values[::-1, :, :3]


def render(bundle):
    panel, folder = panel_of(bundle), bundle.path.parent
    scene = set_up(panel)
    for parts, look, shrunk in (("surfaces", diffuse, 0), ("area_lights", emission, 0), ("media", coefficients, APART)):
        for i, part in enumerate(panel[parts]):
            key = f"{parts}[{i}]"
            put_mesh(part, key, folder, look(part, key), shrunk)
    for i, lamp in enumerate(panel["lights"]):
        put_lamp(lamp, f"lights[{i}]")
    put_camera(panel["ray"])
    samples, seeds = samples_of(bundle, 16)
    volref.save(bundle.request["output"], seeds=[picture(scene, samples, seed) for seed in seeds], samples=samples)


if __name__ == "__main__":
    volref.main(render)
