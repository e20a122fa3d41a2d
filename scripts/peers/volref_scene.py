"""Reads volref's radiative scenes (TOML) into plain numbers, for adapters to other renderers.

It reads valid scenes: mistakes are for `volref render` to explain. What it does not know it
refuses by name; it never leaves anything out silently.
"""

import math
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class Refused(Exception):
    """The scene holds something that the adapter, or the other renderer, has no form for."""


def find(name):
    """The file of a scene given by path, or by name as in smoke/cornell."""
    for path in (Path(name), ROOT / "fixtures/scenes" / f"{name}.toml"):
        if path.is_file():
            return path
    raise FileNotFoundError(f"no scene {name}: neither a file nor in fixtures/scenes")


def read(path):
    """The tables of a scene, with defaults filled in and unknown keys refused."""
    with open(path, "rb") as file:
        scene = tomllib.load(file)
    known(scene, "the scene", "title film camera sampling radiative")
    if "radiative" not in scene:
        raise Refused("it is not a radiative scene")
    film = scene.setdefault("film", {})
    known(film, "[film]", "width height")
    camera = scene["camera"]
    known(camera, "[camera]", "eye target up vertical_fov")
    for missing in {"width", "height"} - film.keys() | {"vertical_fov"} - camera.keys():
        raise Refused(f"it leaves `{missing}` to a default of volref's")
    camera.setdefault("up", [0, 1, 0])
    radiative = scene["radiative"]
    known(radiative, "[radiative]", "scattering max_bounces environment surface medium light")
    radiative.setdefault("scattering", "multiple")
    radiative["environment"] = colour(radiative.get("environment", 0))
    for key in ("surface", "medium", "light"):
        radiative.setdefault(key, [])
    for surface in radiative["surface"]:
        known(surface, "a surface", f"rectangle {SOLIDS} {MOVES} diffuse mirror glass emitter")
    for medium in radiative["medium"]:
        keys = f"{SOLIDS} {MOVES} grid interpolation sigma_a sigma_s sigma_t albedo emission g"
        known(medium, "a medium", keys)
    for light in radiative["light"]:
        known(light, "a light", "point spot directional")
    return scene


SOLIDS = "sphere box mesh"
MOVES = "scale rotate translate"


def known(table, what, names):
    for key in table.keys() - set(names.split()):
        raise Refused(f"`{key}` of {what} is not known here")


def colour(value):
    """Three numbers; one number means all three."""
    return [float(value)] * 3 if isinstance(value, (int, float)) else [float(x) for x in value]


def turns(radiative):
    """How often light may be turned, by media and surfaces together; None for any number."""
    return {"none": 0, "single": 1, "multiple": radiative.get("max_bounces")}[
        radiative["scattering"]
    ]


def coefficients(medium):
    """Extinction and albedo by channel."""
    if "sigma_t" in medium:
        return colour(medium["sigma_t"]), colour(medium["albedo"])
    absorbs, scatters = colour(medium.get("sigma_a", 0)), colour(medium.get("sigma_s", 0))
    extinction = [a + s for a, s in zip(absorbs, scatters)]
    return extinction, [s / t if t > 0 else 0.0 for s, t in zip(scatters, extinction)]


def place(table):
    """Where a shape goes, as three rows of a matrix: scaled, then turned, then moved."""
    scale = table.get("scale", [1, 1, 1])
    turn = [[float(i == j) for j in range(3)] for i in range(3)]
    if rotate := table.get("rotate"):
        length = math.hypot(*rotate["axis"])
        x, y, z = (part / length for part in rotate["axis"])
        c, s = (f(math.radians(rotate["angle"])) for f in (math.cos, math.sin))
        d = 1 - c
        turn = [
            [c + d * x * x, d * x * y - s * z, d * x * z + s * y],
            [d * x * y + s * z, c + d * y * y, d * y * z - s * x],
            [d * x * z - s * y, d * y * z + s * x, c + d * z * z],
        ]
    move = table.get("translate", [0, 0, 0])
    return [[turn[i][j] * scale[j] for j in range(3)] + [float(move[i])] for i in range(3)]


def mesh_corners(file):
    """The vertices of a Wavefront OBJ file."""
    lines = (line.split() for line in open(file))
    return [[float(x) for x in words[1:4]] for words in lines if words[:1] == ["v"]]
