#!/usr/bin/env python3
"""Compares volref with Mitsuba 3 (`scalar_rgb`, `volpath`) on the same scenes.

    mitsuba.py agree SCENE... [--spp N]               do both show the same picture?
    mitsuba.py efficiency SCENE... [--spp N] [--runs R]   error squared times CPU time, as a ratio

A SCENE is a file, or a name such as smoke/cornell. Needs Python 3.11 with `mitsuba` and `numpy`
(without them it says so and succeeds), and `cargo build --release`.

`agree` renders N samples with volref and twice N with Mitsuba (two seeds), and prints means and,
over blocks of 8 x 8 pixels and channels, z: the difference in standard deviations. Blocks whose
standard deviation is below 1e-4 of their value have no z, and must agree to 5e-4. For equal
pictures the root mean square of z is 1 and |z| > 3 in 0.3 % of the blocks (a little more where
light arrives by rare bright paths, whose variance is estimated too low).

`efficiency` alternates one-thread runs of both, each with a seed of its own. The error is the mean
over pixels and channels of (x - ref)^2 / (ref^2 + 0.01^2); ref is a long render of volref, whose
own noise is subtracted; all Mitsuba runs together are compared with it as in `agree`. Efficiency
is 1 / (error x CPU seconds). Neither start, loading nor writing counts: volref's time is the CPU
time of a run less that of a run of 2 samples, Mitsuba's the CPU time of a second and later call
of `render` on a loaded scene.

How scenes are translated, found by experiment with Mitsuba 3.9:

- The same in both: g > 0 scatters forward; a point or spot light of intensity I gives I/r^2; a
  spotlight falls linearly in the angle from `beam_width` to `cutoff_angle`; `irradiance` of a
  directional light; looking along +z, +x is to the left.
- Light turned n times is `max_depth` n + 1; boundaries of media do not count in either.
- Emitters of Mitsuba send light out of their front only. The back of a two-sided one is a second
  one, behind the first by 1e-5 of the largest coordinate.
- Mitsuba moves the origin of a ray off its surface by 9e-5 (1 + largest coordinate): a medium
  that ends so close before a wall, or at it, loses rays. A face of a box of medium that lies in a
  rectangle is moved *behind* it by 1e-3 of the largest coordinate. Other contacts of media with
  surfaces are left as they are.
- Media that overlap are refused, since Mitsuba knows one medium at a place, and so are emission of
  media, media that fill all space, ellipsoids and mirrored meshes.
- A grid of densities (`.vol` or `.bin`) is a `gridvolume` of a `heterogeneous` medium, put so that
  its voxels have volref's nodes in their middles; the medium ends with its shape. Where a box is
  larger than the grid it is cut off, as in volref; spheres and meshes are refused then. Mitsuba has
  one majorant for the whole grid, and no setting for another.
- Other densities (noise, layers, point clouds) are refused: Mitsuba has no form for them.
- Grey media are declared as such (`has_spectral_extinction` false), which Mitsuba is faster for.
"""

import argparse
import itertools
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from volref_scene import ROOT, Refused, coefficients, colour, find, mesh_corners, place, read, turns

HERE = Path(__file__).resolve().parent
try:
    import numpy as np
    from volref_grid import read_grid

    # This file has the name of the module that it needs.
    sys.path[:] = [p for p in sys.path if Path(p or ".").resolve() != HERE]
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    import drjit as dr
except ImportError as error:
    print(f"skipped: {error} (to compare with Mitsuba: pip install mitsuba numpy)")
    sys.exit(0)

BEHIND = 1e-5
OVERHANG = 1e-3
TINY = 1e-4


# --- Scenes ------------------------------------------------------------------------------------


def rgb(value):
    return {"type": "rgb", "value": value}


def transform(matrix):
    return mi.ScalarTransform4f(np.vstack([matrix, [0, 0, 0, 1]]))


def moved(matrix, points):
    return np.asarray(points, float) @ matrix[:, :3].T + matrix[:, 3]


def box_corners(low, high):
    return np.array(list(itertools.product(*zip(low, high))), float)


def rectangle(corner, u, v):
    """A parallelogram, its front along u x v."""
    normal = np.cross(u, v)
    normal /= np.linalg.norm(normal)
    if abs(np.dot(u, v)) > 1e-9 * np.linalg.norm(u) * np.linalg.norm(v):
        raise Refused("a parallelogram is not a rectangle of Mitsuba's")
    columns = [u / 2, v / 2, normal, corner + u / 2 + v / 2]
    return {"type": "rectangle", "to_world": transform(np.stack(columns, axis=1))}


def grid_volume(lattice, shares, table):
    """A grid as a texture of Mitsuba's, by channel if the channels differ.

    The unit cube of a `gridvolume` is divided into equal voxels, with a value in the middle of
    each; so it is put where those middles are volref's nodes. Thus it is half a spacing larger on
    all sides than a grid of volref's centred on nodes; but a medium ends where its shape ends, and
    that is the box of the outermost nodes. Beyond the outermost values both are constant.
    """
    low, high = lattice.around_voxels()
    to_box = np.vstack([np.column_stack([np.diag(high - low), low]), [0, 0, 0, 1]])
    to_world = np.vstack([place(table), [0, 0, 0, 1]]) @ to_box
    values = lattice.values[..., None]
    if min(shares) < max(shares):
        values = values * np.array(shares, np.float32)
    return {
        "type": "gridvolume",
        "grid": mi.VolumeGrid(np.ascontiguousarray(values)),
        "raw": True,
        "filter_type": table.get("interpolation", "trilinear"),
        "wrap_mode": "clamp",
        "to_world": transform(to_world[:3]),
    }


class Translation:
    """A scene as Mitsuba takes it."""

    def __init__(self, path):
        self.folder = path.parent
        source = read(path)
        film, radiative = source["film"], source["radiative"]
        self.size = film["width"], film["height"]
        self.walls, self.bodies, self.parts = [], [], {}
        for table in radiative["surface"]:
            self.surface(table)
        for table in radiative["medium"]:
            self.medium(table)
        for table in radiative["light"]:
            self.light(table)
        if any(radiative["environment"]):
            self.add({"type": "constant", "radiance": rgb(radiative["environment"])})
        limit = turns(radiative)
        self.scene = {
            "type": "scene",
            "integrator": {"type": "volpath", "max_depth": -1 if limit is None else limit + 1},
            **self.media(),
            "sensor": self.sensor(source["camera"]),
            **self.parts,
        }

    def add(self, part):
        self.parts[f"part{len(self.parts)}"] = part

    def surface(self, table):
        if emitter := table.get("emitter"):
            return self.emitter(table, emitter)
        if "diffuse" in table:
            reflectance = rgb(colour(table["diffuse"]["reflectance"]))
            bsdf = {"type": "diffuse", "reflectance": reflectance}
            bsdf = {"type": "twosided", "front": bsdf}
        elif "mirror" in table:
            reflectance = rgb(colour(table["mirror"]["reflectance"]))
            bsdf = {"type": "conductor", "material": "none", "specular_reflectance": reflectance}
            bsdf = {"type": "twosided", "front": bsdf}
        else:
            bsdf = {"type": "dielectric", "int_ior": float(table["glass"]["index"]), "ext_ior": 1.0}
        shape, corners = self.shape(table)
        if shape["type"] == "rectangle" and "glass" not in table:
            self.walls.append(corners)
        self.add({**shape, "bsdf": bsdf})

    def emitter(self, table, emitter):
        sends = {
            "bsdf": {"type": "diffuse", "reflectance": rgb([0.0] * 3)},
            "emitter": {"type": "area", "radiance": rgb(colour(emitter["radiance"]))},
        }
        shape, corners = self.shape(table)
        self.add({**shape, **sends})
        if emitter.get("sides", "front") == "front":
            return
        if shape["type"] == "rectangle":
            a, u, v = corners[0], corners[1] - corners[0], corners[2] - corners[0]
            normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
            a = a - normal * BEHIND * np.abs(corners).max()
            self.add({**rectangle(a, v, u), **sends})
        elif shape["type"] == "sphere":
            reach = BEHIND * np.abs(corners).max()
            inner = {**shape, "radius": shape["radius"] - reach, "flip_normals": True}
            self.add({**inner, **sends})
        else:
            raise Refused("only rectangles and spheres can send out light on both sides here")

    def shape(self, table):
        """A shape, and points that span it: of a rectangle three corners and the fourth."""
        matrix = np.array(place(table))
        linear = matrix[:, :3]
        if given := table.get("rectangle"):
            corner = moved(matrix, given["corner"])
            u, v = linear @ given["edge_u"], linear @ given["edge_v"]
            if np.linalg.det(linear) < 0:
                u, v = v, u
            return rectangle(corner, u, v), corner + np.array([u * 0, u, v, u + v])
        if given := table.get("sphere"):
            scale = np.abs(table.get("scale", [1, 1, 1]))
            if scale.min() != scale.max():
                raise Refused("an ellipsoid is not a shape of Mitsuba's")
            centre, radius = moved(matrix, given["centre"]), float(given["radius"] * scale[0])
            shape = {"type": "sphere", "center": centre.tolist(), "radius": radius}
            return shape, centre + radius * box_corners([-1] * 3, [1] * 3)
        if given := table.get("box"):
            return self.box(matrix, given["min"], given["max"])
        if np.linalg.det(linear) < 0:
            raise Refused("a mirrored mesh turns inside out")
        file = self.folder / table["mesh"]["file"]
        corners = np.array(mesh_corners(file))
        shape = {"type": "obj", "filename": str(file), "face_normals": True}
        shape["to_world"] = transform(matrix)
        return shape, moved(matrix, box_corners(corners.min(0), corners.max(0)))

    @staticmethod
    def box(matrix, low, high):
        low, high = np.array(low, float), np.array(high, float)
        if np.any(low == high):
            raise Refused("a flat box has no faces to tell apart")
        # A mirrored box is a box: its axes, the right way round.
        turned = matrix.copy()
        if np.linalg.det(matrix[:, :3]) < 0:
            turned[:, 0], low[0], high[0] = -turned[:, 0], -high[0], -low[0]
        to_unit = np.column_stack([np.diag((high - low) / 2), (low + high) / 2])
        whole = np.vstack([turned, [0, 0, 0, 1]]) @ np.vstack([to_unit, [0, 0, 0, 1]])
        shape = {"type": "cube", "to_world": transform(whole[:3])}
        return shape, moved(turned, box_corners(low, high))

    def medium(self, table):
        if any(colour(table.get("emission", 0))):
            raise Refused("emission of media is not translated")
        if not any(key in table for key in ("sphere", "box", "mesh", "grid")):
            raise Refused("a medium that fills all space has no boundary to give to Mitsuba")
        extinction, albedo = coefficients(table)
        if not any(extinction):
            return
        lattice = None
        if "grid" in table:
            lattice = read_grid(self.folder / table["grid"]["file"], table["grid"])
            if not lattice.values.any():
                return
            table = self.within(lattice, table)
        if "box" in table:
            shape, corners = self.box_behind_walls(table)
        else:
            shape, corners = self.shape(table)
        for _, _, others in self.bodies:
            if not apart(corners, others):
                raise Refused("media overlap (or their bounding boxes do); Mitsuba cannot add them")
        most = max(extinction)
        g = float(table.get("g", 0))
        shares = [part / most for part in extinction]
        if lattice is None:
            kind, sigma_t = "homogeneous", rgb(shares)
        else:
            kind, sigma_t = "heterogeneous", grid_volume(lattice, shares, table)
        medium = {
            "type": kind,
            "sigma_t": sigma_t,
            "scale": most,
            "albedo": rgb(albedo),
            "has_spectral_extinction": min(extinction) < most,
            "phase": {"type": "hg", "g": g} if g else {"type": "isotropic"},
        }
        self.bodies.append((medium, shape, corners))

    def within(self, lattice, table):
        """The table of a medium, its shape cut off where its grid ends."""
        if "sphere" in table:
            centre, radius = np.array(table["sphere"]["centre"], float), table["sphere"]["radius"]
            low, high = centre - radius, centre + radius
        elif "mesh" in table:
            corners = np.array(mesh_corners(self.folder / table["mesh"]["file"]))
            low, high = corners.min(0), corners.max(0)
        else:
            box = table.get("box", {"min": lattice.low, "max": lattice.high})
            low, high = np.maximum(box["min"], lattice.low), np.minimum(box["max"], lattice.high)
            if np.any(low >= high):
                raise Refused("a grid and the box of its medium do not meet")
            return {**table, "box": {"min": low, "max": high}}
        if np.any(low < lattice.low) or np.any(high > lattice.high):
            raise Refused("a sphere or mesh of medium reaches beyond its grid")
        return table

    def box_behind_walls(self, table):
        """A box of medium, with those faces that lie in rectangles moved behind them."""
        matrix = np.array(place(table))
        low, high = np.array(table["box"]["min"], float), np.array(table["box"]["max"], float)
        corners = moved(matrix, box_corners(low, high))
        reach = np.abs(corners).max()
        signs = box_corners([0] * 3, [1] * 3).astype(int)
        for axis, side in itertools.product(range(3), range(2)):
            face = corners[signs[:, axis] == side]
            if any(in_plane(face, wall, 1e-6 * reach) for wall in self.walls):
                way = OVERHANG * reach / np.linalg.norm(matrix[:, axis])
                (low, high)[side][axis] += way if side else -way
        return self.box(matrix, low, high)

    def media(self):
        parts = {}
        for index, (medium, shape, _) in enumerate(self.bodies):
            parts[f"medium{index}"] = medium
            interior = {"type": "ref", "id": f"medium{index}"}
            self.add({**shape, "bsdf": {"type": "null"}, "interior": interior})
        return parts

    def light(self, table):
        if point := table.get("point"):
            intensity = rgb(colour(point["intensity"]))
            position = [float(x) for x in point["position"]]
            self.add({"type": "point", "position": position, "intensity": intensity})
        elif spot := table.get("spot"):
            inner, outer = float(spot["inner_angle"]), float(spot["outer_angle"])
            to_world = looking(spot["position"], spot["target"], [0, 1, 0])
            intensity = rgb(colour(spot["intensity"]))
            # Mitsuba divides by the difference of the angles.
            angles = {"beam_width": min(inner, outer * (1 - 1e-5)), "cutoff_angle": outer}
            self.add({"type": "spot", "to_world": to_world, "intensity": intensity, **angles})
        else:
            light = table["directional"]
            way = [float(x) for x in light["direction"]]
            irradiance = rgb(colour(light["irradiance"]))
            self.add({"type": "directional", "direction": way, "irradiance": irradiance})

    def sensor(self, camera):
        sensor = {
            "type": "perspective",
            "fov": float(camera["vertical_fov"]),
            "fov_axis": "y",
            "near_clip": 1e-4,
            "far_clip": 1e6,
            "to_world": looking(camera["eye"], camera["target"], camera["up"]),
            "sampler": {"type": "independent"},
            "film": {
                "type": "hdrfilm",
                "width": self.size[0],
                "height": self.size[1],
                "pixel_format": "rgb",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
        }
        for index, (_, shape, corners) in enumerate(self.bodies):
            if shape["type"] == "sphere":
                away = np.linalg.norm(np.array(camera["eye"]) - shape["center"])
                inside = away < shape["radius"]
            else:
                inside = in_box(camera["eye"], corners)
            if inside and shape["type"] == "obj":
                raise Refused("the eye may be inside the mesh of a medium")
            if inside:
                sensor["medium"] = {"type": "ref", "id": f"medium{index}"}
        return sensor


def looking(origin, target, up):
    origin, target, up = (np.array(v, float) for v in (origin, target, up))
    if np.linalg.norm(np.cross(target - origin, up)) < 1e-6 * np.linalg.norm(target - origin):
        up = np.roll(up, 1)
    return mi.ScalarTransform4f().look_at(origin.tolist(), target.tolist(), up.tolist())


def frame(corners):
    """Edges from the first corner of what `box_corners` spans."""
    return corners[[4, 2, 1]] - corners[0]


def in_box(point, corners):
    parts = np.linalg.solve(frame(corners).T, np.array(point, float) - corners[0])
    return bool(np.all((parts > 0) & (parts < 1)))


def in_plane(face, wall, tolerance):
    u, v = wall[1] - wall[0], wall[2] - wall[0]
    normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
    if np.abs((face - wall[0]) @ normal).max() > tolerance:
        return False
    # In the same plane is not enough: they must meet.
    middle = face.mean(0) - wall[0]
    parts = [middle @ u / (u @ u), middle @ v / (v @ v)]
    return all(-0.5 < part < 1.5 for part in parts)


def apart(a, b):
    """Whether a plane parts two boxes: separating axes."""
    sides, others = frame(a), frame(b)
    axes = [np.cross(f[i], f[i - 1]) for f in (sides, others) for i in range(3)]
    axes += [np.cross(u, v) for u in sides for v in others]
    return any((a @ n).min() >= (b @ n).max() or (b @ n).min() >= (a @ n).max() for n in axes)


# --- Renderers ---------------------------------------------------------------------------------


def cpu_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Volref:
    def __init__(self, binary, scene, folder):
        self.binary, self.scene, self.folder = binary, scene, folder

    def render(self, spp, seed, threads, name="volref"):
        """The image, the variance of its pixels, and CPU seconds of the whole run."""
        file = self.folder / f"{name}-{seed}.exr"
        command = [self.binary, "render", self.scene, "-o", file, "--spp", spp, "--seed", seed]
        if threads:
            command += ["--threads", threads]
        before = cpu_of_children()
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        seconds = cpu_of_children() - before
        if done.returncode:
            sys.exit(f"volref render {self.scene} failed:\n{done.stderr}")
        return *read_exr(file), seconds


def read_exr(file):
    bitmap = mi.Bitmap(str(file))
    channels = {field.name: i for i, field in enumerate(bitmap.struct_())}
    values = np.array(bitmap, float)
    image = values[:, :, [channels[c] for c in "RGB"]]
    if "variance.R" not in channels:
        return image, np.zeros_like(image)
    return image, values[:, :, [channels[f"variance.{c}"] for c in "RGB"]]


class Mitsuba:
    def __init__(self, translation, folder):
        self.scene, self.folder = mi.load_dict(translation.scene), folder

    def render(self, spp, seed, threads=None):
        # Set only while it renders: with a single thread, reading or writing an EXR never ends.
        usual = max(2, dr.thread_count())
        dr.set_thread_count(threads or usual)
        before = time.process_time()
        image = mi.render(self.scene, spp=spp, seed=seed)
        seconds = time.process_time() - before
        dr.set_thread_count(usual)
        image = np.array(image, float)[:, :, :3]
        mi.Bitmap(image.astype(np.float32)).write(str(self.folder / f"mitsuba-{seed}.exr"))
        return image, seconds


# --- What is measured --------------------------------------------------------------------------


def blocks(image):
    """Sums over blocks of 8 x 8 pixels; an incomplete margin is left out."""
    rows, columns = image.shape[0] // 8, image.shape[1] // 8
    image = image[: rows * 8, : columns * 8]
    return image.reshape(rows, 8, columns, 8, 3).sum(axis=(1, 3))


def deviations(difference, variance):
    # What neither renderer lights has no variance and no difference.
    return np.divide(difference, np.sqrt(variance), where=variance > 0, out=difference * 0)


def print_agreement(image, variance, others):
    """Compares an image of volref's with several of Mitsuba's."""
    mean = np.mean(others, axis=0)
    spread = np.var(others, axis=0, ddof=1) / len(others)
    a, b = image.mean((0, 1)), mean.mean((0, 1))
    whole = deviations(a - b, (variance + spread).mean((0, 1)) / (image[:, :, 0].size))
    print(f"  mean, volref        {a[0]:.6f} {a[1]:.6f} {a[2]:.6f}")
    print(f"  mean, Mitsuba       {b[0]:.6f} {b[1]:.6f} {b[2]:.6f}")
    relative = 100 * (a - b) / np.maximum(np.maximum(a, b), 1e-30)
    print("  volref - Mitsuba    " + " ".join(f"{r:+.3f}%" for r in relative), end="")
    print("   z of the mean " + " ".join(f"{z:+.1f}" for z in whole))
    difference = blocks(image) - blocks(mean)
    noise = blocks(variance) + blocks(spread)
    # Of blocks that show little but the sky, rounding decides: Mitsuba adds up in single precision.
    tiny = TINY * np.abs(blocks(image))
    by_lot = noise > tiny**2
    z = np.where(by_lot, deviations(difference, noise), 0)
    drawn = z[by_lot]
    places = np.abs(z).max(2)
    worst = np.unravel_index(places.argmax(), places.shape)
    print(f"  z of 8x8 blocks     root mean square {np.sqrt((drawn**2).mean()):.2f}", end="")
    print(f", |z| > 3 in {100 * (np.abs(drawn) > 3).mean():.2f} % of {drawn.size}", end="")
    print(f", largest {places.max():.1f} at pixel ({worst[1] * 8}, {worst[0] * 8})", flush=True)
    off = np.abs(difference[~by_lot]) > 5 * tiny[~by_lot]
    if off.any():
        print(f"  {off.sum()} blocks that hardly vary differ", flush=True)


def agree(volref, mitsuba, options):
    image, variance, _ = volref.render(options.spp, options.seed, options.threads)
    others = [mitsuba.render(options.spp, options.seed + k, options.threads)[0] for k in (1, 2)]
    print_agreement(image, variance, others)


class Reference:
    def __init__(self, image, variance):
        self.image, self.scale = image, image**2 + 0.01**2
        self.noise = variance / self.scale

    def squares(self, image):
        return (image - self.image) ** 2 / self.scale

    def error(self, image):
        return (self.squares(image) - self.noise).mean()


def efficiency(volref, mitsuba, options):
    if options.reference:
        long, variance = read_exr(options.reference)
    else:
        long, variance, _ = volref.render(options.reference_spp, 1 << 20, options.threads, "long")
    reference = Reference(long, variance)
    mitsuba.render(1, options.seed, 1)
    spp, rounds = options.spp, []
    ours, theirs = [], []
    for seed in range(options.seed + 1, options.seed + options.runs + 1):
        start = volref.render(2, seed, 1, "start")[2]
        image, _, whole = volref.render(spp, seed, 1)
        ours.append(image)
        # Of the whole run, the shorter one also rendered two samples.
        first = (whole - start) * spp / (spp - 2), reference.error(image)
        image, second = mitsuba.render(spp, seed, 1)
        theirs.append(image)
        rounds.append((*first, second, reference.error(image)))
    paths = long[:, :, 0].size * spp
    for name, seconds, error in (("volref ", 0, 1), ("Mitsuba", 2, 3)):
        times = [r[seconds] for r in rounds]
        errors = [r[error] for r in rounds]
        images = ours if name == "volref " else theirs
        squares = np.mean([reference.squares(image).mean(2) for image in images], axis=0)
        ordered = np.sort(squares.ravel())[::-1]
        share = ordered[: ordered.size // 100].sum() / ordered.sum()
        print(f"  {name} {paths / statistics.median(times) / 1e3:8.0f} thousand paths/s", end="")
        print(f"  error {statistics.median(errors):.5f} ({min(errors):.5f}", end="")
        print(f" to {max(errors):.5f}) with {spp} samples", end="")
        print(f", {100 * share:.0f} % of it in 1 % of the pixels")
    ratios = sorted(b * tb / (a * ta) for ta, a, tb, b in rounds)
    means = np.mean(rounds, axis=0)
    print(f"  efficiency, volref / Mitsuba: median {statistics.median(ratios):.2f}", end="")
    print(f" ({ratios[0]:.2f} to {ratios[-1]:.2f} in {len(rounds)} runs)", end="")
    print(f"; by mean errors and times {means[3] * means[2] / (means[1] * means[0]):.2f}")
    print(f"  the reference against all {len(theirs)} Mitsuba runs:")
    print_agreement(long, variance, theirs)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("mode", choices=["agree", "efficiency"])
    parser.add_argument("scene", nargs="+")
    parser.add_argument("--spp", type=int, help="samples per pixel [256; efficiency: 16]")
    parser.add_argument("--runs", type=int, default=5, help="rounds of efficiency [5]")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--reference", help="a long EXR of volref's, rendered before")
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--threads", type=int, help="where nothing is measured [all cores]")
    parser.add_argument("--keep", type=Path, help="folder that all images are left in")
    parser.add_argument("--volref", type=Path, default=ROOT / "target/release/volref")
    options = parser.parse_args()
    options.spp = options.spp or (256 if options.mode == "agree" else 16)
    if options.spp < 3 or options.runs < 2:
        parser.error("--spp must be at least 3 and --runs 2")
    if options.reference and len(options.scene) > 1:
        parser.error("--reference is for a single scene")
    if not os.access(options.volref, os.X_OK):
        print(f"there is no {options.volref}: `cargo build --release` makes it", file=sys.stderr)
        return 2
    status = 0
    for name in options.scene:
        try:
            path = find(name)
            translation = Translation(path)
        except (Refused, FileNotFoundError) as error:
            print(f"{name}: refused: {error}", file=sys.stderr)
            status = 2
            continue
        width, height = translation.size
        version = f"Mitsuba {mi.__version__}"
        print(f"{name}: {width} x {height}, {options.spp} samples, {version}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            folder = options.keep / path.stem if options.keep else Path(folder)
            folder.mkdir(parents=True, exist_ok=True)
            pair = Volref(options.volref, path, folder), Mitsuba(translation, folder)
            {"agree": agree, "efficiency": efficiency}[options.mode](*pair, options)
    return status


if __name__ == "__main__":
    sys.exit(main())
