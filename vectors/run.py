#!/usr/bin/env python3
"""Holds an implementation to the vectors: python3 run.py [MISTAKE]. Put your own functions in place of these.

MISTAKE is one of order, correction, backward, shifted, gamma: what each runner must find.
"""

import json
import math
import struct
import sys
from pathlib import Path

MISTAKE = sys.argv[1] if len(sys.argv) > 1 else None

def composite(x, premultiplied=False):
    samples = [x[1 + 4 * i : 5 + 4 * i] for i in range(int(x[0]))]
    colour, opacity = [0.0] * 3, 0.0
    for r, g, b, a in reversed(samples) if MISTAKE == "order" else samples:
        weight = (1 - opacity) * (1 if premultiplied else a)
        colour = [c + weight * s for c, s in zip(colour, (r, g, b))]
        opacity += (1 - opacity) * a
    return [*colour, opacity]

def opacity_over_step(x):
    a, h, h0 = x
    if a == 1 or MISTAKE == "correction":
        return [a]
    return [-math.expm1(h / h0 * math.log1p(-a))]

def transfer_function(x):
    points, value = [x[1 + 2 * i : 3 + 2 * i] for i in range(int(x[0]))], x[-1]
    before = [point for point in points if point[0] <= value]
    after = points[len(before) :]
    if not before or not after:
        return [(after or before[-1:])[0][1]]
    (v, a), (w, b) = before[-1], after[0]
    return [a + (b - a) * (value - v) / (w - v)]

def trilinear(x):
    nodes, spacing = [int(n) for n in x[:3]], x[3:6]
    values, point = x[6 : 6 + math.prod(nodes)], x[-3:]
    at = [p / s - (0.5 if MISTAKE == "shifted" else 0) for p, s in zip(point, spacing)]
    base = [min(max(math.floor(p), 0), n - 2) for p, n in zip(at, nodes)]
    total = 0.0
    for corner in range(8):
        offset = [corner >> axis & 1 for axis in range(3)]
        weight = math.prod(p - b if o else 1 - (p - b) for p, b, o in zip(at, base, offset))
        i, j, k = (b + o for b, o in zip(base, offset))
        total += weight * values[i + nodes[0] * (j + nodes[1] * k)]
    return [total]

def box_span(x):
    near, far = 0.0, math.inf
    for o, d, low, high in zip(x[:3], x[3:6], x[6:9], x[9:]):
        if d == 0 and low <= o <= high:
            continue
        if d == 0:
            return []
        t, u = sorted(((low - o) / d, (high - o) / d))
        near, far = max(near, t), min(far, u)
    return [near, far] if near < far else []

def value(x):
    g, cos = (-x[0] if MISTAKE == "backward" else x[0]), x[1]
    return [(1 - g * g) / (4 * math.pi * (1 + g * g - 2 * g * cos) ** 1.5)]

def srgb_code(x):
    x = min(max(x[0], 0), 1)
    if MISTAKE == "gamma":
        return [round(255 * x ** (1 / 2.2))]
    return [math.floor(255 * (12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055) + 0.5)]

def half(x):
    number = struct.unpack("<f", struct.pack("<I", x[0]))[0]
    try:
        return list(struct.unpack("<H", struct.pack("<e", number)))
    except OverflowError:
        return [0x7C00 if number > 0 else 0xFC00]


passed = failed = without = 0
for file in sorted(Path(__file__).parent.glob("*.json")):
    for entry in json.loads(file.read_text(encoding="utf-8")).get("entries", []):
        premultiplied = entry["function"] == "composite_premultiplied"
        function = (lambda x: composite(x, True)) if premultiplied else globals().get(entry["function"])
        if function is None:
            without += 1
            continue
        found, expected = function(entry["inputs"]), entry["expected"]
        close = [abs(f - e) <= entry["absolute"] + entry["relative"] * abs(e) for f, e in zip(found, expected)]
        is_right = len(found) == len(expected) and all(close)
        passed, failed = passed + is_right, failed + (not is_right)
        if not is_right:
            print(f"{file.name}: {entry['function']}({entry['inputs']}) is {expected}, not {found}")
print(f"{passed} passed, {failed} failed, {without} of functions that this runner does not have")
sys.exit(failed > 0)
