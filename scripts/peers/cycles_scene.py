"""Scenes of radiative bundles as Blender has them: meshes with their materials, lamps, a camera."""

import bpy
import mathutils
import numpy as np

APART = 1e-5  # share by which media are smaller, so that no face of theirs lies in a surface


def material(kind, inputs, output="Surface"):
    """A material of one node."""
    look = bpy.data.materials.new("look")
    look.use_nodes = True
    look.node_tree.nodes.clear()
    node, end = (look.node_tree.nodes.new(name) for name in (kind, "ShaderNodeOutputMaterial"))
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    look.node_tree.links.new(node.outputs[0], end.inputs[output])
    return look


def diffuse(surface):
    if surface.json["material"] != "diffuse":
        surface.refuse(surface.json["material"])
    return material("ShaderNodeBsdfDiffuse", {"Color": (*surface.json["reflectance"], 1)})


def emission(lamp):
    look = material("ShaderNodeEmission", {"Color": (*lamp.json["radiance"], 1), "Strength": 1})
    if lamp.json["sides"] == "front":
        tree, front = look.node_tree, look.node_tree.nodes.new("ShaderNodeMath")
        front.operation, front.inputs[0].default_value = "SUBTRACT", 1
        tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"], front.inputs[1])
        tree.links.new(front.outputs[0], tree.nodes["Emission"].inputs["Strength"])
    return look


def volume(medium):
    *values, g = medium.coefficients()
    inputs = {f"{name} Coefficients": value for name, value in zip(("Absorption", "Scatter", "Emission"), values)}
    return material("ShaderNodeVolumeCoefficients", inputs | {"Anisotropy": g}, "Volume")


def put(data, matrix=mathutils.Matrix()):
    thing = bpy.data.objects.new("thing", data)
    thing.matrix_world = matrix
    bpy.context.scene.collection.objects.link(thing)
    return thing


def put_lamp(lamp):
    if lamp.json["kind"] == "point":
        data, matrix = bpy.data.lights.new("lamp", "POINT"), mathutils.Matrix.Translation(lamp.json["position"])
        data.color, data.shadow_soft_size, data.energy = lamp.json["intensity"], 0, 4 * np.pi
    elif lamp.json["kind"] == "spot":
        lamp.refuse("the edge of a spot")
    else:
        turn = mathutils.Vector(lamp.json["direction"]).to_track_quat("-Z", "Y")
        data, matrix = bpy.data.lights.new("lamp", "SUN"), turn.to_matrix().to_4x4()
        data.color, data.angle, data.energy = lamp.json["irradiance"], 0, 1
    put(data, matrix)


def put_scene(bundle):
    for parts, look in ((bundle.surfaces, diffuse), (bundle.area_lights, emission), (bundle.media, volume)):
        for part in parts:
            vertices, triangles = part.triangles(APART if look is volume else 0)
            data = bpy.data.meshes.new("shape")
            data.from_pydata(vertices.tolist(), [], triangles.tolist())
            data.materials.append(look(part))
            put(data)
    for lamp in bundle.lights:
        put_lamp(lamp)
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.clip_start, camera.clip_end = "VERTICAL", 1e-6, 1e7
    if bundle.parallel_height:
        camera.type, camera.ortho_scale = "ORTHO", bundle.parallel_height
    else:
        camera.angle_y = np.radians(bundle.field_of_view)
    bpy.context.scene.camera = put(camera, mathutils.Matrix(bundle.camera_to_world.tolist()))
