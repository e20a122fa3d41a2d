#!/usr/bin/env python3
"""Writes vectors/*.json: inputs and expected results of the formulas of volume rendering, for other programs.

Needs mpmath (pip install mpmath). Results are computed with 60 digits, or exactly with fractions, and rounded
once to 64 bits: nothing here shares code with volref, whose own code is held to the same numbers by
tests/library/vectors.rs. FLIP comes from NVIDIA's own program (pip install flip-evaluator).
"""

import json
import random
import struct
from fractions import Fraction
from pathlib import Path

from mpmath import mp, mpf

mp.dps = 60
FOLDER = Path(__file__).parent.parent / "vectors"
rng = random.Random(20261123)

ROUNDINGS = "a few dozen roundings of 64-bit floats; for 32-bit floats multiply it by 2^29"
EXACT = "integers, so exact"


def number(value):
    """The nearest 64-bit float, as JSON has it."""
    if isinstance(value, int):
        return value
    if isinstance(value, Fraction):
        value = mpf(value.numerator) / mpf(value.denominator)
    value = float(value)
    return int(value) if value == int(value) and abs(value) < 2**53 else value


class Topic:
    def __init__(self, name, about):
        self.name, self.about, self.functions, self.entries = name, about, {}, []

    def function(self, name, about, inputs, expected, absolute=0.0, relative=1e-13, because=ROUNDINGS):
        self.functions[name] = {
            "about": about,
            "inputs": inputs,
            "expected": expected,
            "absolute": absolute,
            "relative": relative,
            "because": because,
        }

    def add(self, function, inputs, expected):
        of = self.functions[function]
        self.entries.append(
            {
                "function": function,
                "inputs": [number(x) for x in inputs],
                "expected": [number(x) for x in expected],
                "absolute": of["absolute"],
                "relative": of["relative"],
            }
        )

    def write(self):
        lines = ",\n    ".join(json.dumps(entry) for entry in self.entries)
        functions = json.dumps(self.functions, indent=2).replace("\n", "\n  ")
        text = (
            f'{{\n  "schema": "volref/vectors/1",\n  "topic": {json.dumps(self.name)},\n'
            f'  "about": {json.dumps(self.about)},\n  "functions": {functions},\n'
            f'  "entries": [\n    {lines}\n  ]\n}}\n'
        )
        (FOLDER / f"{self.name}.json").write_text(text, encoding="utf-8")


def exactly(x):
    """A 64-bit float as the number that it is."""
    return Fraction(x)


def compositing():
    topic = Topic("compositing", "Samples of a ray, from the front, to colour and opacity (Porter & Duff 1984).")
    given = ["n", "n times red, green, blue, opacity: of each sample, the first in front"]
    result = ["red", "green", "blue, multiplied by opacity", "opacity"]
    topic.function("composite", "Colours as they are: each counts by its opacity.", given, result, absolute=1e-300)
    topic.function("composite_premultiplied", "Colours multiplied by opacity already.", given, result, absolute=1e-300)

    def composite(samples, premultiplied):
        colour, passed = [Fraction(0)] * 3, Fraction(1)
        for *rgb, a in samples:
            weight = passed if premultiplied else passed * exactly(a)
            colour = [c + weight * exactly(x) for c, x in zip(colour, rgb)]
            passed *= 1 - exactly(a)
        return [*colour, 1 - passed]

    cases = [
        [],
        [[1.0, 0.5, 0.25, 0.5]],
        [[0.2, 0.4, 0.6, 1.0], [9.0, 9.0, 9.0, 1.0]],
        [[0.5, 0.5, 0.5, 0.0], [1.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.5]],
        [[0.3, 0.6, 0.9, 2.0**-20]] * 5,
    ]
    cases += [[[rng.random() for _ in range(4)] for _ in range(n)] for n in (2, 3, 8, 40)]
    for samples in cases:
        flat = [len(samples), *(x for sample in samples for x in sample)]
        topic.add("composite", flat, composite(samples, False))
        topic.add("composite_premultiplied", flat, composite(samples, True))
    topic.write()


def opacity():
    topic = Topic("opacity", "Transfer functions, and opacity over a step.")
    topic.function(
        "opacity_over_step",
        "Opacity a, stated over a length h0, over a step h: 1 - (1 - a)^(h/h0), also where a is tiny.",
        ["a", "h", "h0"],
        ["opacity"],
        absolute=1e-300,
    )
    for a in (0.0, 1e-12, 1e-6, 0.1, 0.5, 0.9, 0.999999, 1.0):
        for h in (0.25, 1.0, 3.0):
            exact = 1 - (1 - mpf(a)) ** (mpf(h) / 2)
            topic.add("opacity_over_step", [a, h, 2.0], [exact])
    topic.function(
        "transfer_function",
        "Opacity by points in order of their values, joined by straight lines, constant beyond the outermost; of "
        "two points at one value the later holds there.",
        ["n", "n times value, opacity", "value"],
        ["opacity"],
        absolute=1e-16,
    )

    def through(points, x):
        x = exactly(x)
        points = [(exactly(v), exactly(a)) for v, a in points]
        if x < points[0][0]:
            return points[0][1]
        before = [i for i, (v, _) in enumerate(points) if v <= x][-1]
        if before + 1 == len(points):
            return points[-1][1]
        (v, a), (w, b) = points[before], points[before + 1]
        return a + (b - a) * (x - v) / (w - v)

    tables = [
        [(0.0, 0.0), (1.0, 1.0)],
        [(0.0, 0.0), (0.5, 0.75), (1.0, 0.25)],
        [(-2.0, 0.1), (0.25, 0.2), (0.25, 0.8), (3.0, 0.3)],
    ]
    for table in tables:
        for x in (-3.0, -0.5, 0.0, 0.1, 0.25, 0.3, 0.5, 0.9, 1.0, 4.0):
            flat = [len(table), *(y for point in table for y in point), x]
            topic.add("transfer_function", flat, [through(table, x)])
    topic.write()


def grid_value(nodes, values, point):
    """Trilinear interpolation at a point in node coordinates, exactly."""
    base = [min(max(int(p // 1), 0), n - 2) for p, n in zip(point, nodes)]
    sum_ = Fraction(0)
    for corner in range(8):
        offset = [corner >> axis & 1 for axis in range(3)]
        weight = Fraction(1)
        for b, o, p in zip(base, offset, point):
            fraction = p - b
            weight *= fraction if o else 1 - fraction
        i, j, k = (b + o for b, o in zip(base, offset))
        sum_ += weight * values[i + nodes[0] * (j + nodes[1] * k)]
    return sum_


def grids():
    topic = Topic("grids", "Values on the nodes of a grid, x fastest: node (i, j, k) lies at (i, j, k) times the spacing.")
    given = ["nx", "ny", "nz", "spacing x, y, z", "nx ny nz values"]
    topic.function("trilinear", "Trilinear interpolation.", [*given, "point x, y, z"], ["value"], absolute=1e-15)
    topic.function(
        "gradient",
        "Central differences over two spacings at the nodes, at the border those of the nearest inner node, "
        "interpolated trilinearly; per length.",
        [*given, "point x, y, z"],
        ["x", "y", "z"],
        absolute=1e-14,
    )
    topic.function(
        "optical_depth",
        "Integral of the trilinear field from one point to another, both within the grid.",
        [*given, "from x, y, z", "to x, y, z"],
        ["depth"],
        absolute=1e-15,
        because="some roundings for each of at most a dozen cells; the integrand is a cubic in each, which two "
        "points of Gauss and Legendre, or Simpson's rule, integrate exactly",
    )

    def gradient_at(nodes, spacing, values, i, j, k):
        inner = [min(max(c, 1), n - 2) for c, n in zip((i, j, k), nodes)]
        strides = [1, nodes[0], nodes[0] * nodes[1]]
        at = sum(c * s for c, s in zip(inner, strides))
        return [(values[at + s] - values[at - s]) / (2 * h) for s, h in zip(strides, spacing)]

    for nodes, spacing in [((3, 3, 3), (1.0, 1.0, 1.0)), ((4, 3, 5), (0.5, 1.0, 0.25))]:
        count = nodes[0] * nodes[1] * nodes[2]
        values = [rng.randrange(0, 257) / 256 for _ in range(count)]
        exact = [exactly(v) for v in values]
        head = [*nodes, *spacing, *values]
        steps = [exactly(s) for s in spacing]
        size = [(n - 1) * s for n, s in zip(nodes, spacing)]
        in_nodes = lambda p: [exactly(x) / s for x, s in zip(p, steps)]
        points = [[f * s for f, s in zip(fs, size)] for fs in ((0, 0, 0), (1, 1, 1), (0.5, 0.5, 0.5))]
        points += [[rng.randrange(0, 1025) / 1024 * s for s in size] for _ in range(5)]
        by_axis = [[], [], []]
        for k in range(nodes[2]):
            for j in range(nodes[1]):
                for i in range(nodes[0]):
                    for axis, value in enumerate(gradient_at(nodes, steps, exact, i, j, k)):
                        by_axis[axis].append(value)
        for point in points:
            topic.add("trilinear", [*head, *point], [grid_value(nodes, exact, in_nodes(point))])
            topic.add("gradient", [*head, *point], [grid_value(nodes, of, in_nodes(point)) for of in by_axis])
        for start, end in zip(points, points[1:]):
            topic.add("optical_depth", [*head, *start, *end], [depth(nodes, exact, steps, start, end)])
    topic.write()


def depth(nodes, values, spacing, start, end):
    """The integral: between the planes of nodes the field is a cubic, which Simpson's rule integrates exactly."""
    a, b = ([exactly(x) / s for x, s in zip(p, spacing)] for p in (start, end))
    cuts = {Fraction(0), Fraction(1)}
    for x, y in zip(a, b):
        if x != y:
            low, high = sorted((x, y))
            cuts |= {(plane - x) / (y - x) for plane in range(int(low // 1), int(high // 1) + 1) if low <= plane <= high}
    cuts = sorted(cuts)
    at = lambda t: grid_value(nodes, values, [x + (y - x) * t for x, y in zip(a, b)])
    mean = sum((u - t) * (at(t) + 4 * at((t + u) / 2) + at(u)) / 6 for t, u in zip(cuts, cuts[1:]))
    length = mp.sqrt(sum(mpf(float(y)) ** 2 for y in [exactly(q) - exactly(p) for p, q in zip(start, end)]))
    return mpf(mean.numerator) / mpf(mean.denominator) * length


def boxes():
    topic = Topic("boxes", "The span of a ray within a box.")
    topic.function(
        "box_span",
        "Distances, in lengths of the direction, between which the ray is in the box: from its origin on. None of a "
        "ray that misses.",
        ["origin x, y, z", "direction x, y, z", "lowest x, y, z", "highest x, y, z"],
        ["near", "far"],
        absolute=1e-15,
    )
    low, high = [-1.0, -1.0, -1.0], [1.0, 2.0, 3.0]
    rays = [
        ([0.0, 0.0, -4.0], [0.0, 0.0, 1.0]),
        ([0.0, 0.0, -4.0], [0.0, 0.0, -1.0]),
        ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ([5.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([0.5, 0.5, -4.0], [0.0, 0.0, 2.0]),
        ([-3.0, -3.0, -3.0], [1.0, 1.0, 1.0]),
        ([-3.0, 0.0, 0.0], [1.0, -0.0, 0.0]),
        ([-4.0, 3.0, 1.0], [1.0, -0.5, 0.125]),
        ([-4.0, 9.0, 1.0], [1.0, -0.5, 0.125]),
    ]
    rays += [([rng.randrange(-64, 65) / 8 for _ in "xyz"], [rng.randrange(1, 17) / 8 for _ in "xyz"]) for _ in range(12)]
    for origin, direction in rays:
        near, far = Fraction(0), None
        hit = True
        for o, d, a, b in zip(origin, direction, low, high):
            o, d, a, b = (exactly(x) for x in (o, d, a, b))
            if d == 0:
                hit &= a <= o <= b
                continue
            t, u = sorted(((a - o) / d, (b - o) / d))
            near, far = max(near, t), u if far is None else min(far, u)
        touches = near == far  # whether a touch counts is a convention
        if hit and touches:
            continue
        hit &= near < far
        topic.add("box_span", [*origin, *direction, *low, *high], [near, far] if hit else [])
    topic.write()


def phase():
    topic = Topic("henyey_greenstein", "The phase function of Henyey & Greenstein 1941; g > 0 is forward.")
    topic.function(
        "value",
        "Per steradian; cos is that between the directions of travel before and after.",
        ["g", "cos"],
        ["value"],
        relative=1e-11,
        because="1 + g^2 - 2g cos, a difference of terms of about 2, is 1e-4 at g = 0.99 straight ahead",
    )
    topic.function(
        "sample",
        "The cosine that a number u in [0, 1) gives by inversion, u = 0 backward, and its density per steradian.",
        ["g", "u"],
        ["cos", "density"],
        absolute=1e-12,
        relative=1e-11,
        because="the inversion divides by 2g, and must be done another way where g is small",
    )

    def value(g, cos):
        g, cos = mpf(g), mpf(cos)
        return (1 - g * g) / (4 * mp.pi * (1 + g * g - 2 * g * cos) ** mpf("1.5"))

    for g in (-0.95, -0.5, 0.0, 1e-9, 0.3, 0.85, 0.99):
        for cos in (-1.0, -0.25, 0.0, 0.5, 0.999, 1.0):
            topic.add("value", [g, cos], [value(g, cos)])
        for u in (0.0, 0.125, 0.5, 0.7, 0.999):
            if g == 0:
                cos = 2 * mpf(u) - 1
            else:
                fraction = (1 - mpf(g) ** 2) / (1 - mpf(g) + 2 * mpf(g) * mpf(u))
                cos = (1 + mpf(g) ** 2 - fraction**2) / (2 * mpf(g))
            topic.add("sample", [g, u], [cos, value(g, cos)])
    topic.write()


def flight():
    topic = Topic("free_flight", "Flight between collisions, and transmittance, in a homogeneous medium.")
    topic.function("transmittance", "exp(-sigma length).", ["sigma", "length"], ["transmittance"], absolute=1e-300)
    topic.function(
        "sample",
        "The distance that a number u in [0, 1) gives by inversion, -ln(1 - u)/sigma, and its density per length.",
        ["sigma", "u"],
        ["distance", "density"],
        absolute=1e-300,
    )
    topic.function(
        "delta_tracking",
        "Mean and variance of the estimate 1 or 0: whether no real collision is met along the length, where tentative "
        "ones have the majorant's rate.",
        ["sigma", "majorant", "length"],
        ["mean", "variance"],
        absolute=1e-300,
    )
    topic.function(
        "ratio_tracking",
        "Mean and variance of the product of 1 - sigma/majorant over the tentative collisions (Novak et al. 2014).",
        ["sigma", "majorant", "length"],
        ["mean", "variance"],
        absolute=1e-15,
    )
    for sigma in (0.0, 1e-9, 0.5, 3.0):
        for length in (0.25, 2.0, 50.0):
            topic.add("transmittance", [sigma, length], [mp.exp(-mpf(sigma) * mpf(length))])
    for sigma in (0.5, 3.0):
        for u in (0.0, 1e-12, 0.25, 0.5, 0.999):
            t = -mp.log(1 - mpf(u)) / mpf(sigma)
            topic.add("sample", [sigma, u], [t, mpf(sigma) * (1 - mpf(u))])
    for sigma, majorant, length in [(0.5, 1.0, 2.0), (1.0, 1.0, 1.0), (0.25, 4.0, 1.0), (2.0, 3.0, 0.5)]:
        s, m, x = mpf(sigma), mpf(majorant), mpf(length)
        mean = mp.exp(-s * x)
        topic.add("delta_tracking", [sigma, majorant, length], [mean, mean * (1 - mean)])
        square = mp.exp(-m * x * (1 - (1 - s / m) ** 2))
        topic.add("ratio_tracking", [sigma, majorant, length], [mean, square - mean * mean])
    topic.write()


def cameras():
    topic = Topic("cameras", "Rays of a pinhole camera: right-handed, y up; looking along +z, +x points left.")
    topic.function(
        "camera_ray",
        "The unit direction through the centre of a pixel, counted from the top left.",
        ["eye x, y, z", "target x, y, z", "up x, y, z", "vertical field of view, degrees", "width", "height", "column", "row"],
        ["x", "y", "z"],
        absolute=1e-15,
    )
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    norm = lambda a: [x / mp.sqrt(sum(y * y for y in a)) for x in a]
    views = [
        ([0, 0, -4], [0, 0, 0], [0, 1, 0], 45, 4, 3),
        ([1, 2, 3], [0, 0.5, -1], [0, 1, 0], 60, 5, 5),
        ([0, 5, 0], [0, 0, 0], [0, 0, 1], 20, 2, 8),
    ]
    for eye, target, up, fov, width, height in views:
        forward = norm([mpf(t) - mpf(e) for t, e in zip(target, eye)])
        right = norm(cross(forward, [mpf(u) for u in up]))
        upward = cross(right, forward)
        half = mp.tan(mp.radians(mpf(fov)) / 2)
        for column, row in [(0, 0), (width - 1, 0), (width // 2, height // 2), (0, height - 1)]:
            x = (2 * mpf(column) + 1 - width) / height * half
            y = (height - 2 * mpf(row) - 1) / height * half
            ray = norm([f + x * r + y * u for f, r, u in zip(forward, right, upward)])
            topic.add("camera_ray", [*eye, *target, *up, fov, width, height, column, row], ray)
    topic.write()


def codes():
    topic = Topic("codes", "Numbers as images store them.")
    topic.function(
        "srgb_code",
        "Linear radiance, clipped to [0, 1], to a code of 8 bits by the sRGB curve (IEC 61966-2-1), rounded to the nearest.",
        ["radiance"],
        ["code"],
        relative=0.0,
        because=EXACT,
    )
    topic.function("srgb_radiance", "A code of 8 bits to linear radiance.", ["code"], ["radiance"], absolute=1e-16)
    topic.function(
        "half",
        "The bits of a float of 32 bits to those of the nearest half float, ties to even (IEEE 754).",
        ["bits of the float"],
        ["bits of the half"],
        relative=0.0,
        because=EXACT,
    )

    def encoded(x):
        x = min(max(mpf(x), 0), 1)
        y = x * mpf("12.92") if x <= mpf("0.0031308") else mpf("1.055") * x ** (1 / mpf("2.4")) - mpf("0.055")
        return int(mp.floor(255 * y + mpf("0.5")))

    for x in (-1.0, 0.0, 1e-5, 0.002, 0.0031308, 0.01, 0.18, 0.2140411, 0.5, 0.9, 0.999, 1.0, 7.0):
        topic.add("srgb_code", [x], [encoded(x)])
    for code in (0, 1, 10, 11, 55, 128, 200, 254, 255):
        y = mpf(code) / 255
        x = y / mpf("12.92") if y <= mpf("0.04045") else ((y + mpf("0.055")) / mpf("1.055")) ** mpf("2.4")
        topic.add("srgb_radiance", [code], [x])
    values = [0.0, -0.0, 1.0, -2.0, 65504.0, 65519.0, 65520.0, 1e30, 2.0**-14, 2.0**-24, 2.0**-25, 1.5 * 2.0**-25]
    values += [1 + 2.0**-11, 1 + 3 * 2.0**-11, 0.1, 3.14159274, float("inf"), float("-inf")]
    for value in values:
        (bits,) = struct.unpack("<I", struct.pack("<f", value))
        try:
            (half,) = struct.unpack("<H", struct.pack("<e", struct.unpack("<f", struct.pack("<f", value))[0]))
        except OverflowError:
            half = 0x7C00 if value > 0 else 0xFC00
        topic.add("half", [bits], [half])
    topic.write()


def perceived():
    import flip_evaluator
    import numpy as np

    topic = Topic("flip", "The difference that an eye perceives between two images (FLIP, Andersson et al. 2020).")
    topic.function(
        "flip_mean",
        "Mean over the pixels of FLIP for displays of low dynamic range, at 67.0206 pixels per degree.",
        ["width", "height", "3 width height codes of 8-bit sRGB of the reference, row by row", "likewise of the test"],
        ["mean"],
        absolute=2e-5,
        relative=0.0,
        because="NVIDIA's program computes in 32-bit floats",
    )
    width, height = 9, 7
    noise = np.array([[[rng.randrange(256) for _ in "rgb"] for _ in range(width)] for _ in range(height)])
    ramp = np.array([[[28 * x, 36 * y, 128] for x in range(width)] for y in range(height)])
    dot = np.zeros_like(ramp)
    dot[3, 4] = [255, 128, 0]
    for reference, test in [
        (ramp, ramp),
        (np.zeros_like(ramp), np.full_like(ramp, 255)),
        (ramp, np.roll(ramp, 1, axis=1)),
        (ramp, noise),
        (dot, np.zeros_like(dot)),
        (ramp, np.clip(ramp + 10, 0, 255)),
    ]:
        images = [np.ascontiguousarray(image / 255, dtype=np.float32) for image in (reference, test)]
        # 0.7 m before a display 0.7 m wide, of 3840 pixels.
        parameters = {"ppd": float(0.7 * 3840 / 0.7 * np.pi / 180)}
        _, mean, _ = flip_evaluator.evaluate(*images, "LDR", True, False, True, parameters)
        flat = [int(code) for image in (reference, test) for code in image.reshape(-1)]
        topic.add("flip_mean", [width, height, *flat], [float(mean)])
    topic.write()


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for write in (compositing, opacity, grids, boxes, phase, flight, cameras, codes, perceived):
        write()
