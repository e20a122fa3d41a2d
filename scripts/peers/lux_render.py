#!/usr/bin/env python3
"""Renders radiative bundles of volref with LuxCore's path tracer (pip install pyluxcore), and tells the noise.

    lux_render.py BUNDLE.json OUTPUT.exr
    volref validate smoke --serve 'python3 scripts/peers/lux_render.py --serve {export:bundle} {spp} {seed}'

LuxCore's image is one pixel too low, and its roulette brightens what it ends: the screen is moved, and no path is ended.
"""

import time

import numpy as np
import pyluxcore
import volref
from meshes import density_of, mesh, panel_of, samples_of

MOST = 1000  # times that light is turned
APART = 1e-3  # share by which media are smaller: LuxCore steps over a face that lies nearer to a surface
BEHIND = 1e-5  # distance of the back of a lamp, by its size


def properties(values, prefix=""):
    """LuxCore's properties of a dictionary."""
    result = pyluxcore.Properties()
    for key, value in values.items():
        result.Set(pyluxcore.Property(prefix + key, value if isinstance(value, list) else [value]))
    return result


def camera(ray, width, height):
    if "orthographic_height" in ray:
        volref.refuse("parallel rays")
    wide, lower = width / height, 2 / height
    eye, up = np.array(ray["eye"]), np.array(ray["half_up"])
    return {
        "type": "perspective",
        "lookat.orig": eye.tolist(),
        "lookat.target": (eye + ray["forward"]).tolist(),
        "up": (up / np.linalg.norm(up)).tolist(),
        "fieldofview": float(2 * np.degrees(np.arctan(np.linalg.norm(up) * min(1, wide)))),
        "screenwindow": [-wide, wide, -1 - lower, 1 - lower],
        "autovolume.enable": False,
        "cliphither": 1e-3,
        "clipyon": 1e6,
    }


def surface(part, key):
    if part["material"] != "diffuse":
        volref.refuse(f"{key}: {part['material']}")
    return {"type": "matte", "kd": part["reflectance"]}


def lamp(part, key):
    if part["sides"] == "both" and part["shape"]["kind"] != "rectangle":
        volref.refuse(f"{key}: a {part['shape']['kind']} that shines on its inside")
    return {"type": "matte", "kd": [0.0] * 3, "emission": part["radiance"], "emission.theta": 90.0}


def two_sided(vertices, triangles):
    """Triangles, and their backs just behind them."""
    a, b, c = vertices[triangles[0]]
    normal = np.cross(b - a, c - a)
    behind = vertices - BEHIND * np.ptp(vertices, 0).max() * normal / np.linalg.norm(normal)
    return np.concatenate([vertices, behind]), np.concatenate([triangles, triangles[:, ::-1] + len(vertices)])


def interior(part, key):
    return {"type": "null", "volume.interior": f"{key}-inside"}


def volume(medium, key):
    density, phase = density_of(medium, key), medium["phase"]
    if phase["kind"] != "henyey-greenstein":
        volref.refuse(f"{key}.phase: {phase['kind']}")
    if any(medium["emission"]):
        volref.refuse(f"{key}: a medium that emits")
    scaled = lambda name: (density * np.array(medium[name])).tolist()
    return {
        "type": "homogeneous",
        "absorption": scaled("sigma_a"),
        "scattering": scaled("sigma_s"),
        "asymmetry": [phase["g"]] * 3,
        "multiscattering": True,
    }


def scene_of(panel, folder):
    if panel["scattering"]["most"] is not None:
        volref.refuse("light that is turned a number of times")
    if panel["lights"]:
        volref.refuse(f"lights[0]: {panel['lights'][0]['kind']}")
    if panel["pixel"]["filter"] != "box":
        volref.refuse("the radiance in the middle of a pixel")
    scene = pyluxcore.Scene()
    scene.Parse(properties(camera(panel["ray"], panel["width"], panel["height"]), "scene.camera."))
    for i, medium in enumerate(panel["media"]):
        scene.Parse(properties(volume(medium, f"media[{i}]"), f"scene.volumes.media{i}-inside."))
    if any(panel["environment"]):
        scene.Parse(properties({"type": "constantinfinite", "color": panel["environment"]}, "scene.lights.sky."))
    for parts, look, shrunk in (("surfaces", surface, 0), ("area_lights", lamp, 0), ("media", interior, APART)):
        for i, part in enumerate(panel[parts]):
            name, key = f"{parts}{i}", f"{parts}[{i}]"
            vertices, triangles = mesh(part, key, folder, shrunk)
            if part.get("sides") == "both":
                vertices, triangles = two_sided(vertices, triangles)
            scene.DefineMesh(name, [*map(tuple, vertices.tolist())], [*map(tuple, triangles.tolist())], None, None, None, None)
            scene.Parse(properties(look(part, name), f"scene.materials.{name}."))
            scene.Parse(properties({"material": name, "shape": name}, f"scene.objects.{name}."))
    return scene


def picture(scene, width, height, samples, seed):
    settings = {
        "renderengine.type": "PATHCPU",
        "renderengine.seed": seed,
        "sampler.type": "RANDOM",
        "path.pathdepth.total": MOST,
        "path.pathdepth.diffuse": MOST,
        "path.pathdepth.glossy": MOST,
        "path.pathdepth.specular": MOST,
        "path.russianroulette.depth": MOST,
        "path.hybridbackforward.enable": False,
        "path.clamping.variance.maxvalue": 0.0,
        "film.width": width,
        "film.height": height,
        "film.filter.type": "BOX",
        "film.filter.width": 0.5,
        "film.imagepipelines.0.0.type": "NOP",
        "batch.haltspp": samples,
    }
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties(settings), scene))
    session.Start()
    while not session.HasDone():
        time.sleep(0.01)
        session.UpdateStats()
    session.Stop()
    image = np.zeros(width * height * 3, np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, image)
    return image.reshape(height, width, 3)[::-1]


def render(bundle):
    panel = panel_of(bundle)
    scene = scene_of(panel, bundle.path.parent)
    samples, seeds = samples_of(bundle, 16)
    size = panel["width"], panel["height"]
    volref.save(bundle.request["output"], seeds=[picture(scene, *size, samples, seed) for seed in seeds], samples=samples)


if __name__ == "__main__":
    pyluxcore.Init()
    volref.main(render)
