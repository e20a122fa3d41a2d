#!/usr/bin/env python3
"""A volume renderer as a student writes it: plain Python and NumPy, all pixels at a time.

    volref export SCENE --to bundle -o DIR         # SCENE.json, and the bare densities beside it
    student.py DIR/SCENE.json OUTPUT               # OUTPUT: .npy, .pfm or .exr
    volref validate --serve 'student.py --serve {export:bundle}'

All that it knows of a scene stands in the bundle, formulas included; comments say what code is
for. It renders volumes, several together with their clips, projections and isosurfaces of one, and plots of transfer
functions; surfaces are refused, and so are radiative scenes, which `student_paths.py` renders. To see how a wrong
renderer is found out, let it make a mistake: `student.py --mistake gamma ...`. Numbers of n rays or samples are arrays of length n, vectors have the shape (3, n).
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from image_file import image_path, write_image

MISTAKES = {
    "nearest": "takes the nearest node where it should interpolate",
    "half-voxel": "looks half a voxel beside the right place",
    "no-opacity-correction": "gives a step its opacity whatever its length",
    "from-zero": "lets the largest value begin at 0",
    "inward-normal": "lets normals point into the dense part",
    "no-shadow": "leaves the volume shadow out",
    "upside-down": "stores the bottom row first",
    "gamma": "encodes the image for a display",
}
mistake = None  # the one to be made


def read_floats(path, shape):
    return np.fromfile(path, "<f4").astype(float).reshape(shape)


def column(vector):
    """One vector, to be combined with many."""
    return np.array(vector, float)[:, None]


def dot(a, b):
    return (a * b).sum(axis=0)


def length(vectors):
    return np.sqrt(dot(vectors, vectors))


def transparency(density, floor):
    return np.clip((np.exp(-(density**2)) - floor) / (1 - floor), 0, 1)


def by_points(points, key, value):
    """The curve through the points of a table, in straight lines; of two at one value the later holds there."""
    at, of = (np.array([point[name] for point in points], float) for name in ("value", key))
    right = np.searchsorted(at, value, "right").clip(1, len(at) - 1)
    width = at[right] - at[right - 1]
    share = np.where(width > 0, (value - at[right - 1]) / np.where(width > 0, width, 1), 1).clip(0, 1)
    return of[right - 1].T + (of[right] - of[right - 1]).T * share


def into(grid):
    """From the world into a grid: the inverse of its matrix, if it has one, and what is subtracted before."""
    matrix = np.array(grid.get("matrix", np.eye(3, 4)))
    return np.linalg.inv(matrix[:, :3]), matrix[:, 3:]


class Field:
    """Numbers or vectors at the nodes of a grid, and what lies between the nodes."""

    def __init__(self, grid, method, values):
        self.inverse, self.offset = into(grid)
        self.first, self.spacing = column(grid["first_node"]), column(grid["spacing"])
        nx, ny, nz = grid["nodes"]
        self.last = np.array([[nx - 1], [ny - 1], [nz - 1]])
        self.strides = np.array([[1], [nx], [nx * ny]])
        self.method = "nearest" if mistake == "nearest" else method
        self.values = values

    def at(self, points):
        u = (self.inverse @ (points - self.offset) - self.first) / self.spacing
        if mistake == "half-voxel":
            u = u + 0.5
        if self.method == "nearest":
            nearest = np.floor(u + 0.5).astype(int).clip(0, self.last)
            return self.values.take(dot(nearest, self.strides), axis=-1)
        low = np.floor(u).astype(int)
        x, y, z = (np.array([low, low + 1]).clip(0, self.last) * self.strides).swapaxes(0, 1)
        values = self.values.take(z[:, None, None] + y[:, None] + x, axis=-1)
        for f in u - low:  # along x, then y, then z
            a, b = values[..., 0, :], values[..., 1, :]
            values = a + (b - a) * f
        return values


def central_differences(values, spacing):
    """Gradients at the nodes; `values` in the order [z, y, x], as the file has them."""
    gradient = np.array(np.gradient(values, *spacing[::-1])[::-1])
    # A border node takes the gradient of the nearest inner node.
    for axis, nodes in enumerate(values.shape):
        gradient = gradient.take(np.arange(nodes).clip(1, nodes - 2), 1 + axis)
    return gradient


def box_span(corners, origins, directions):
    with np.errstate(divide="ignore"):
        a, b = ((column(corner) - origins) / directions for corner in corners)
    return np.minimum(a, b).max(axis=0), np.maximum(a, b).min(axis=0)


class Volume:
    def __init__(self, panel, folder):
        self.panel, self.grid = panel, panel["grid"]
        method = panel["interpolation"]["method"]
        values = read_floats(folder / self.grid["file"], self.grid["nodes"][::-1])
        self.density = Field(self.grid, method, values.ravel())
        if panel["phong"]:
            if min(values.shape) < 3:
                sys.exit("refused: this renderer takes gradients of grids of 3 nodes or more on each axis")
            gradient = central_differences(values, self.grid["spacing"]).reshape(3, -1)
            self.gradient = Field(self.grid, method, into(self.grid)[0].T @ gradient)
        self.modulation = panel.get("modulation")
        if self.modulation:
            second = read_floats(folder / self.modulation["file"], self.grid["nodes"][::-1])
            self.second = Field(self.grid, method, second.ravel())
        if panel["light"]:
            self.light = column(panel["light"]["position"])

    def span(self, origins, directions):
        """Where rays enter and leave what clips leave of the box; those that miss it leave before they enter."""
        inverse, offset = into(self.grid)
        corners = self.grid["box_min"], self.grid["box_max"]
        near, far = box_span(corners, inverse @ (origins - offset), inverse @ directions)
        for clip in self.panel.get("clips", []):
            if clip["kind"] == "box":
                begin, end = box_span((clip["min"], clip["max"]), origins, directions)
            else:
                height = dot(column(clip["normal"]), origins - column(clip["point"]))
                slope = dot(column(clip["normal"]), directions)
                with np.errstate(divide="ignore", invalid="ignore"):
                    at = -height / slope
                begin = np.where(slope > 0, at, np.where((slope == 0) & (height <= 0), np.inf, -np.inf))
                end = np.where(slope < 0, at, np.inf)
            near, far = np.maximum(near, begin), np.minimum(far, end)
        return near.clip(0), far

    def in_range(self, value):
        """The density of the formula, at a value of the volume."""
        low, high = self.panel["transfer_function"].get("range", (0, 0))
        return np.clip((value - low) / (high - low), 0, 1) if low < high else value

    def opacity_of_reference(self, density):
        transfer = self.panel["transfer_function"]
        if transfer["kind"] == "table":
            return by_points(transfer["points"], "opacity", density)
        return 1 - transparency(self.in_range(density), transfer["floor"])

    def factor(self, points):
        """Of opacities, by a second number."""
        if not self.modulation:
            return 1
        values, factors = np.array(self.modulation["points"]).T
        return np.interp(self.second.at(points), values, factors)

    def opacity(self, density, step):
        references = step / self.panel["transfer_function"]["reference_length"]
        if mistake == "no-opacity-correction":
            references = 1
        return 1 - (1 - self.opacity_of_reference(density)) ** references

    def colour(self, density):
        transfer = self.panel["transfer_function"]
        if transfer["kind"] == "table":
            return by_points(transfer["points"], "colour", density)
        colours = transfer["colours"]
        position = np.linspace(0, 1, len(colours))
        return np.array([np.interp(self.in_range(density), position, channel) for channel in zip(*colours)])

    def shade(self, colour, points, to_eye, two_sided=False):
        """Phong's reflection model; the normal of two sides is that of the eye's."""
        phong = self.panel["phong"]
        gradient = self.gradient.at(points)
        size = length(gradient)
        normal = -gradient / np.where(size > 0, size, 1)
        if two_sided:
            normal = np.where(dot(normal, to_eye) < 0, -normal, normal)
        if mistake == "inward-normal":
            normal = -normal
        to_light = (self.light - points) / length(self.light - points)
        cosine = dot(normal, to_light).clip(0)
        mirrored = 2 * cosine * normal - to_light
        highlight = dot(mirrored, to_eye).clip(0) ** phong["shininess"] * (cosine > 0)
        shaded = colour * (phong["ambient"] + phong["diffuse"] * cosine)
        return np.where(size > 0, shaded + phong["specular"] * highlight, colour)

    def light_arriving(self, points):
        """The share of light that the volume between each point and the light lets through."""
        shadow, distance = self.panel["shadow"], length(self.light - points)
        directions = (self.light - points) / distance
        near, far = self.span(points, directions)
        far = np.minimum(far, distance)
        by_table = self.panel["transfer_function"]["kind"] == "table"
        near, total = near.clip(0), np.zeros(len(far))
        for rays, t, step in samples(near, far, shadow["step"]):
            density = self.density.at(points[:, rays] + t * directions[:, rays])
            if by_table:
                with np.errstate(divide="ignore"):
                    density = -np.log1p(-self.opacity_of_reference(density))
            total[rays] += self.in_range(density) * step / shadow["reference_step"]
        return np.exp(-total) if by_table else np.minimum(1, np.exp(-total / 100))

    def radiance(self, density, points, to_eye, shading_volumes=None):
        """What samples send to the eye, in the shadow of volumes: of its own, if it is alone."""
        colour = self.colour(density)
        if self.panel["phong"]:
            colour = self.shade(colour, points, to_eye)
        if self.panel["shadow"] and mistake != "no-shadow":
            for volume in shading_volumes or [self]:
                colour = colour * volume.light_arriving(points)
        return colour if self.panel["transfer_function"]["kind"] == "table" else self.in_range(density) ** 2 * colour


def rays_of(panel, shift=0):
    """The eye, and a direction for every pixel, row by row from the top, `shift` pixels off its centre."""
    ray, width, height = panel["ray"], panel["width"], panel["height"]
    y, x = np.array(np.divmod(np.arange(width * height), width)) + shift
    right = column(ray["half_right"]) * (2 * x + 1 - width) / height
    down = column(ray["half_up"]) * (2 * y + 1 - height) / height
    if "orthographic_height" in ray:
        return column(ray["eye"]) + right - down, column(ray["forward"]) + 0 * right
    towards = column(ray["forward"]) + right - down
    return column(ray["eye"]), towards / length(towards)


def samples(near, far, step, backwards=False):
    """Step by step: the rays that go so far, where their samples lie, how long the steps are."""
    whole = (far - near).clip(0)
    count = np.ceil(whole / step).astype(int)
    last = whole - (count - 1) * step
    indices = range(count.max(initial=0))
    for i in reversed(indices) if backwards else indices:
        rays = np.flatnonzero(i < count)
        size = np.where(i == count[rays] - 1, last[rays], step)
        yield rays, near[rays] + i * step + size / 2, size


def draw_volume(panel, folder):
    volume = Volume(panel, folder)
    eye, directions = rays_of(panel)
    colour, opacity = np.zeros(directions.shape), np.zeros(directions.shape[1])
    backwards = panel["compositing"]["method"] == "back-to-front"
    near, far = volume.span(eye, directions)
    for rays, t, step in samples(near, far, panel["sampling"]["step"], backwards):
        points = eye_of(eye, rays) + t * directions[:, rays]
        density = volume.density.at(points)
        a = volume.opacity(density, step)
        # Most of the volume is empty; its samples change nothing.
        seen = np.flatnonzero(a > 0)
        rays, points, density, a = rays[seen], points[:, seen], density[seen], a[seen]
        light = volume.radiance(density, points, -directions[:, rays])
        if backwards:
            colour[:, rays] = a * light + (1 - a) * colour[:, rays]
            opacity[rays] = a + (1 - a) * opacity[rays]
        else:
            colour[:, rays] += (1 - opacity[rays]) * a * light
            opacity[rays] += (1 - opacity[rays]) * a
    return picture(panel, colour, opacity)


def picture(panel, colour, opacity):
    """Colours before the background, and opacity."""
    colour = colour + (1 - opacity) * column(panel["background"])
    return np.vstack([colour, opacity]).T.reshape(panel["height"], panel["width"], 4)


def draw_volumes(panel, folder):
    """Several volumes, each constant over each of its steps: the ends of all steps cut a ray into pieces."""
    if panel["surfaces"]:
        sys.exit("refused: this renderer knows no surfaces")
    volumes = []
    for volume in panel["volumes"]:
        clips = [panel["clips"][index] for index in volume["clips"]]
        volumes.append(Volume(volume | {"clips": clips, "light": panel["light"]}, folder))
    eye, directions = rays_of(panel)
    count = directions.shape[1]
    colour, opacity = np.zeros((3, count)), np.zeros(count)
    spans = [volume.span(eye, directions) for volume in volumes]
    # Of each volume: the step that a ray is in, where that ends, its extinction and its light.
    index = np.full((len(volumes), count), -1)
    end = np.array([np.where(near < far, near, np.inf) for near, far in spans])
    extinction, light = np.zeros((len(volumes), count)), np.zeros((len(volumes), 3, count))
    position = end.min(axis=0)
    while np.isfinite(position).any():
        for k, (volume, (near, far)) in enumerate(zip(volumes, spans)):
            rays = np.flatnonzero((end[k] == position) & np.isfinite(position))
            index[k, rays] += 1
            extinction[k, rays], begin = 0, end[k, rays]
            step = volume.panel["sampling"]["step"]
            goes_on = index[k, rays] < np.ceil((far - near)[rays] / step)
            end[k, rays] = np.where(goes_on, np.minimum(near[rays] + (index[k, rays] + 1) * step, far[rays]), np.inf)
            rays, begin = rays[goes_on], begin[goes_on]
            points = eye_of(eye, rays) + (begin + end[k, rays]) / 2 * directions[:, rays]
            density = volume.density.at(points)
            with np.errstate(divide="ignore"):
                a0 = volume.opacity_of_reference(density) * volume.factor(points)
                extinction[k, rays] = -np.log1p(-a0) / volume.panel["transfer_function"]["reference_length"]
            seen = a0 > 0  # its other samples change nothing
            light[k][:, rays[seen]] = volume.radiance(
                density[seen], points[:, seen], -directions[:, rays[seen]], volumes
            )
        following = end.min(axis=0)
        total = extinction.sum(axis=0)
        rays = np.flatnonzero((total > 0) & np.isfinite(following))
        # What is opaque hides what is not.
        weight = np.where(np.isinf(total), np.isinf(extinction), extinction)[:, rays]
        sent = (weight[:, None] * light[:, :, rays]).sum(axis=0) / weight.sum(axis=0)
        a = 1 - np.exp(-total[rays] * (following[rays] - position[rays]))
        colour[:, rays] += (1 - opacity[rays]) * a * sent
        opacity[rays] += (1 - opacity[rays]) * a
        position = following
    return picture(panel, colour, opacity)


def draw_field(panel, folder):
    """A projection, or isosurfaces: the mode of a bundle."""
    volume, mode = Volume(panel, folder), panel["mode"]
    eye, directions = rays_of(panel)
    near, far = volume.span(eye, directions)
    # What is exact is sampled more finely: largest values at the faces of cells are kinks.
    step = panel["sampling"]["step"] / (64 if mode["exact"] else 1)
    walk = ((r, t, h, volume.density.at(eye_of(eye, r) + t * directions[:, r])) for r, t, h in samples(near, far, step))
    if mode["name"] == "isosurface":
        image = surfaces(volume, walk, eye, directions)
    else:
        number = projection(mode, walk, len(near))
        if mode["name"] == "attenuated-maximum":
            image = np.array([number] * 3)
        elif "low" in mode:
            image = np.array([window(mode, number)] * 3)
        else:
            image = volume.colour(number)
        image = np.where(far > near, image, column(panel["background"]))
    return image.T.reshape(panel["height"], panel["width"], 3)


def eye_of(eye, rays):
    """Origins of some rays, which may all have the same."""
    return eye if eye.shape[1] == 1 else eye[:, rays]


def window(mode, value):
    return ((value - mode["low"]) / (mode["high"] - mode["low"])).clip(0, 1)


def projection(mode, walk, count):
    """The number of each ray."""
    name = mode["name"]
    most, least = np.full(count, -np.inf), np.full(count, np.inf)
    if mistake == "from-zero":
        most[:] = least[:] = 0
    total, way, depth = np.zeros((3, count))
    for rays, _, h, value in walk:
        total[rays] += value * h
        way[rays] += h
        if name == "attenuated-maximum":
            position = window(mode, value)
            value = position * np.exp(-mode["attenuation"] * depth[rays])
            depth[rays] += position * h
        most[rays] = np.maximum(most[rays], value)
        least[rays] = np.minimum(least[rays], value)
    if name == "mean":
        return total / np.where(way > 0, way, 1)
    return {"minimum": least, "sum": total}.get(name, most)


def surfaces(volume, walk, eye, directions):
    """Isosurfaces, composited from the eye on."""
    count = directions.shape[1]
    colour, opacity = np.zeros(directions.shape), np.zeros(count)
    before_t, before = np.zeros(count), np.full(count, np.nan)
    for rays, t, _, value in walk:
        last_t, last = before_t[rays], before[rays]
        passed = []
        for surface in volume.panel["mode"]["surfaces"]:
            here = np.flatnonzero(((last < surface["value"]) != (value < surface["value"])) & ~np.isnan(last))
            at = last_t[here] + (t - last_t)[here] * (surface["value"] - last[here]) / (value - last)[here]
            passed += [(at_one, ray, surface) for at_one, ray in zip(at, rays[here])]
        # A ray passes few surfaces in a step: one after the other, as they come.
        for at, ray, surface in sorted(passed, key=lambda one: one[0]):
            point = eye_of(eye, [ray]) + at * directions[:, [ray]]
            light = column(surface["colour"])
            if volume.panel["phong"]:
                light = volume.shade(light, point, -directions[:, [ray]], two_sided=True)
            colour[:, [ray]] += (1 - opacity[ray]) * surface["opacity"] * light
            opacity[ray] += (1 - opacity[ray]) * surface["opacity"]
        before_t[rays], before[rays] = t, value
    return colour + (1 - opacity) * column(volume.panel["background"])


def draw_plot(panel, folder):
    axes = panel["axes"]
    left, right, top, bottom = (axes[side] for side in ("left", "right", "top", "bottom"))
    image = read_floats(folder / panel["backdrop"]["file"], (panel["height"], panel["width"], 3))
    x, y = np.arange(panel["width"]) + 0.5, column(np.arange(panel["height"])) + 0.5
    inside = (x >= left) & (x <= right) & (y >= top) & (y <= bottom)

    def height(x, curve):
        density = axes["from"] + (axes["to"] - axes["from"]) * (x - left) / (right - left)
        value = transparency(np.maximum(density, axes["from"]), panel["floor"])
        return bottom - (bottom - top) * (value if curve == "transparency" else 1 - value)

    for curve in ("opacity", "transparency"):
        slope = height(x + 0.5, curve) - height(x - 0.5, curve)
        distance = abs(y - height(x, curve)) / np.sqrt(1 + slope**2)
        coverage = inside * (panel["line"]["half_width"] + 0.5 - distance).clip(0, 1)
        image += (panel[f"{curve}_colour"] - image) * coverage[:, :, None]
    return image


def command(render, description, mistakes, *numbers):
    """A renderer's command line: one bundle, or requests, a line each, until there are no more."""
    parser = argparse.ArgumentParser(description=description.partition("\n")[0])
    parser.add_argument("bundle", type=Path, nargs="?")
    parser.add_argument("output", type=image_path, nargs="?")
    parser.add_argument("--serve", action="store_true", help="stay, and read requests")
    parser.add_argument("--mistake", choices=mistakes, help=str(mistakes)[1:-1])
    for number, what in numbers:
        parser.add_argument(f"--{number}", type=int, help=what)
    options = parser.parse_args()
    if options.bundle and options.output:
        render(options.bundle, options.output, vars(options))
    elif not options.serve:
        parser.error("a bundle and an output, or --serve")
    for line in sys.stdin if options.serve else []:
        request = json.loads(line)
        try:
            render(Path(request["export:bundle"]), image_path(request["output"]), vars(options) | request)
            answer = {"image": request["output"]}
        except SystemExit as refusal:
            answer = {"cannot": str(refusal)}
        print(json.dumps(answer), flush=True)


def render(path, output, options):
    global mistake
    mistake = options["mistake"]
    bundle = json.loads(path.read_text("utf-8"))
    if bundle["schema"] != "volref/bundle/1":
        sys.exit(f"{path}: not a bundle that this renderer knows")
    pictures = []
    for panel in bundle["panels"]:
        draw = {"volume": draw_volume, "volumes": draw_volumes, "plot": draw_plot}.get(panel["shows"])
        if not draw:
            sys.exit(f"refused: a panel that shows {panel['shows']} (student_paths.py may know it)")
        if "mode" in panel:
            draw = draw_field
        pictures.append(draw(panel, path.parent))
    channels = min(one.shape[2] for one in pictures)  # a plot has no opacity
    image = np.concatenate([one[:, :, :channels] for one in pictures], axis=1)  # side by side
    if mistake == "upside-down":
        image = image[::-1]
    if mistake == "gamma":
        image[:, :, :3] **= 1 / 2.2
    write_image(output, image)


if __name__ == "__main__":
    command(render, __doc__, MISTAKES)
