"""Scenes of radiative bundles as LuxCore has them: properties by their keys, and meshes."""

import numpy as np
import pyluxcore
import volref

APART = 1e-3  # share by which media are smaller: LuxCore steps over a face that lies nearer to a surface
BEHIND = 1e-5  # distance of the back of a lamp, by its size


def properties(values, prefix=""):
    """LuxCore's properties of a dictionary."""
    result = pyluxcore.Properties()
    for key, value in values.items():
        result.Set(pyluxcore.Property(prefix + key, value if isinstance(value, list) else [value]))
    return result


def camera(bundle):
    """A camera whose screen is moved by the pixel that LuxCore's image is too low."""
    if bundle.parallel_height:
        volref.refuse("parallel rays")
    wide, lower, half = bundle.size[0] / bundle.size[1], 2 / bundle.size[1], np.tan(np.radians(bundle.field_of_view / 2))
    return {
        "type": "perspective",
        "lookat.orig": bundle.eye.tolist(),
        "lookat.target": (bundle.eye + bundle.forward).tolist(),
        "up": bundle.up.tolist(),
        "fieldofview": float(2 * np.degrees(np.arctan(half * min(1, wide)))),
        "screenwindow": [-wide, wide, -1 - lower, 1 - lower],
        "autovolume.enable": False,
        "cliphither": 1e-3,
        "clipyon": 1e6,
    }


def matte(part):
    """The material of a surface, or of a lamp that shines on its front."""
    if radiance := part.json.get("radiance"):
        return {"type": "matte", "kd": [0.0] * 3, "emission": radiance, "emission.theta": 90.0}
    if part.json["material"] != "diffuse":
        part.refuse(part.json["material"])
    return {"type": "matte", "kd": part.json["reflectance"]}


def two_sided(part, vertices, triangles):
    """Triangles of a lamp, and their backs just behind them."""
    if part.json["shape"]["kind"] != "rectangle":
        part.refuse(f"a {part.json['shape']['kind']} that shines on its inside")
    a, b, c = vertices[triangles[0]]
    normal = np.cross(b - a, c - a)
    behind = vertices - BEHIND * np.ptp(vertices, 0).max() * normal / np.linalg.norm(normal)
    return np.concatenate([vertices, behind]), np.concatenate([triangles, triangles[:, ::-1] + len(vertices)])


def volume(medium):
    absorption, scattering, emission, g = medium.coefficients()
    if emission.any():
        medium.refuse("a medium that emits")
    look = {"type": "homogeneous", "multiscattering": True, "asymmetry": [g] * 3}
    return look | {"absorption": absorption.tolist(), "scattering": scattering.tolist()}


def scene_of(bundle):
    scene = pyluxcore.Scene()
    scene.Parse(properties(camera(bundle), "scene.camera."))
    if any(sky := bundle.radiance["environment"]):
        scene.Parse(properties({"type": "constantinfinite", "color": sky}, "scene.lights.sky."))
    for part in bundle.surfaces + bundle.area_lights + bundle.media:
        name, is_medium = part.key.translate({ord("["): None, ord("]"): None}), "sigma_s" in part.json
        if is_medium:
            scene.Parse(properties(volume(part), f"scene.volumes.{name}-inside."))
        vertices, triangles = part.triangles(APART if is_medium else 0)
        if part.json.get("sides") == "both":
            vertices, triangles = two_sided(part, vertices, triangles)
        scene.DefineMesh(name, *([*map(tuple, of.tolist())] for of in (vertices, triangles)), None, None, None, None)
        look = {"type": "null", "volume.interior": f"{name}-inside"} if is_medium else matte(part)
        scene.Parse(properties(look, f"scene.materials.{name}."))
        scene.Parse(properties({"material": name, "shape": name}, f"scene.objects.{name}."))
    return scene
