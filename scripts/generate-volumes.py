#!/usr/bin/env python3
"""Writes the small volumes of fixtures/volumes/formats, one grid in every format that is read,
of fixtures/volumes/hard, the grids of the hard cases, of fixtures/volumes/limit, the fields of the
limits, of fixtures/volumes/sampled, small grids of 8 bits, and of fixtures/volumes/projections, one with a sign.

The grid of the formats has 4 × 3 × 2 nodes, spacing (0.5, 1, 2), its first node at (-1, 2, 3), and the value
i + 10·j + 100·k at node (i, j, k): values that every type of 8 bits or more can hold. Formats that
cannot say all of this (the course's grid) leave out what they cannot. Needs Python 3 alone.
"""

import gzip
import io
import math
import pathlib
import struct
import zipfile
import zlib

NODES = (4, 3, 2)
SPACING = (0.5, 1.0, 2.0)
FIRST = (-1.0, 2.0, 3.0)
VOLUMES = pathlib.Path(__file__).parent.parent / "fixtures" / "volumes"
FOLDER = VOLUMES / "formats"


def value(i, j, k):
    return i + 10 * j + 100 * k


X_FASTEST = [value(i, j, k) for k in range(2) for j in range(3) for i in range(4)]
LAST = tuple(f + s * (n - 1) for f, s, n in zip(FIRST, SPACING, NODES))


def write(name, data):
    (FOLDER / name).write_bytes(data)


def zipped(data):
    return gzip.compress(data, mtime=0)


def packed(order, letter, values):
    return struct.pack(f"{order}{len(values)}{letter}", *values)


def nrrd(kind, encoding, where, data=None, endian=None, sizes="4 3 2"):
    lines = ["NRRD0004", f"type: {kind}", "dimension: 3", f"sizes: {sizes}", f"encoding: {encoding}"]
    lines += [f"endian: {endian}"] if endian else []
    header = "\n".join(lines + where) + "\n"
    return header.encode() if data is None else header.encode() + b"\n" + data


def npy(kind, shape, fortran, data):
    header = f"{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}"
    header = header.ljust(-(len(header) + 11) % 64 + len(header)) + "\n"
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header.encode() + data


def npz(method, *arrays):
    """An archive of `arrays`, each with its name."""
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w", method) as archive:
        for name, data in arrays:
            entry = zipfile.ZipInfo(name + ".npy")
            entry.compress_type = method
            with archive.open(entry, "w", force_zip64=True) as file:
                file.write(data)
    return whole.getvalue()


def meta(kind, sizes, rows, offset, spacing, more, file):
    lines = ["ObjectType = Image", "NDims = 3", "BinaryData = True", *more]
    lines += ["TransformMatrix = " + " ".join(map(str, rows)), "Offset = " + " ".join(map(str, offset))]
    lines += ["CenterOfRotation = 0 0 0", "ElementSpacing = " + " ".join(map(str, spacing))]
    lines += ["DimSize = " + " ".join(map(str, sizes)), f"ElementType = {kind}", f"ElementDataFile = {file}"]
    return "\n".join(lines).encode() + b"\n"


def nifti(order, code, bits, data, rows, sizes=NODES, scaling=(0, 0)):
    header = bytearray(348)

    def put(at, form, *numbers):
        struct.pack_into(order + form, header, at, *numbers)

    put(0, "i", 348)
    put(40, "8h", 3, *sizes, 1, 1, 1, 1)
    put(70, "2h", code, bits)
    put(76, "8f", 1, 1, 1, 1, 0, 0, 0, 0)
    put(108, "3f", 352, *scaling)
    put(254, "h", 1)
    for row, at in zip(rows, (280, 296, 312)):
        put(at, "4f", *row)
    header[344:] = b"n+1\0"
    return bytes(header) + bytes(4) + data


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    floats = packed("<", "f", X_FASTEST)
    # One spacing, and the origin of the world for its first node.
    write("grid.bin", packed("<", "i", NODES) + packed("<", "f", (3, 2, 1)) + floats)
    box = packed("<", "f", FIRST + LAST)
    write("grid.vol", b"VOL\3" + packed("<", "i", (1, *NODES, 1)) + box + floats)

    directions = [
        "space: left-posterior-superior",
        "space directions: (0.5,0,0) (0,1,0) (0,0,2)",
        "space origin: (-1,2,3)",
    ]
    ends = ["axis mins: -1 2 3", "axis maxs: 0.5 4 5", "centers: node node node"]
    write("raw.nrrd", nrrd("float", "raw", directions, floats, "little"))
    shorts = packed(">", "h", X_FASTEST)
    write("gzip.nrrd", nrrd("short", "gzip", ends, zipped(shorts), "big"))
    text = " ".join(map(str, X_FASTEST)).encode() + b"\n"
    write("text.nrrd", nrrd("double", "text", ends, text))
    # z runs fastest and backwards, x slowest.
    turned = [value(i, j, k) for i in range(4) for j in range(3) for k in (1, 0)]
    where = ["space directions: (0,0,-2) (0,1,0) (0.5,0,0)", "space origin: (-1,2,5)"]
    where = ["space dimension: 3"] + where + ["data file: detached.raw", "byte skip: 3"]
    write("detached.nhdr", nrrd("uchar", "raw", where, sizes="2 3 4"))
    write("detached.raw", b"abc" + packed("<", "B", turned))

    # x runs backwards, as in many scans; stored s stands for 0.5 s - 10.
    mirrored = [value(3 - i, j, k) for k in range(2) for j in range(3) for i in range(4)]
    stored = [2 * (v + 10) for v in mirrored]
    rows = ((-0.5, 0, 0, 0.5), (0, 1, 0, 2), (0, 0, 2, 3))
    write("grid.nii", nifti(">", 4, 16, packed(">", "h", stored), rows, scaling=(0.5, -10)))
    rows = ((0.5, 0, 0, -1), (0, 1, 0, 2), (0, 0, 2, 3))
    write("grid.nii.gz", zipped(nifti("<", 64, 64, packed("<", "d", X_FASTEST), rows)))

    write("grid.npy", npy("<f4", (2, 3, 4), False, floats))
    z_fastest = [value(i, j, k) for i in range(4) for j in range(3) for k in range(2)]
    write("fortran.npy", npy(">i2", (2, 3, 4), True, packed(">", "h", z_fastest)))

    array = npy("<f4", (2, 3, 4), False, floats)
    write("grid.npz", npz(zipfile.ZIP_DEFLATED, ("volume", array)))
    write("stored.npz", npz(zipfile.ZIP_STORED, ("arr_0", array)))
    # As nibabel has arrays: (x, y, z).
    write("xyz.npy", npy("<f4", NODES, False, packed("<", "f", z_fastest)))
    write("xyz.raw", packed("<", "B", z_fastest))
    write(
        "xyz.raw.toml",
        b"""# An array (x, y, z) in C order: z runs fastest.
file = "xyz.raw"
type = "uint8"
nodes = [4, 3, 2]
axes = "xyz"
spacing = [0.5, 1, 2]
origin = [-1, 2, 3]
""",
    )

    # x runs backwards, as in the NIfTI; of the other, z runs fastest and x slowest.
    mirror = (-1, 0, 0, 0, 1, 0, 0, 0, 1)
    header = meta("MET_SHORT", NODES, mirror, (0.5, 2, 3), SPACING, ["BinaryDataByteOrderMSB = True"], "LOCAL")
    write("grid.mha", header + packed(">", "h", mirrored))
    data = zlib.compress(packed("<", "f", z_fastest))
    more = ["BinaryDataByteOrderMSB = False", "CompressedData = True", f"CompressedDataSize = {len(data)}"]
    turned = (0, 0, 1, 0, 1, 0, 1, 0, 0)
    write("packed.mhd", meta("MET_FLOAT", NODES[::-1], turned, FIRST, SPACING[::-1], more, "packed.zraw"))
    write("packed.zraw", data)

    write("bare.raw", b"\xff\xff" + packed(">", "I", X_FASTEST))
    write(
        "bare.raw.toml",
        b"""# Samples without a header, two bytes into their file.
file = "bare.raw"
type = "uint32"
endian = "big"
nodes = [4, 3, 2]
spacing = [0.5, 1, 2]
origin = [-1, 2, 3]
header_bytes = 2
""",
    )


def placed(kind, nodes, spacing, first, comment):
    """The first lines of an NRRD along the axes: its samples, and where they lie."""
    return directed(kind, nodes, ((spacing[0], 0, 0), (0, spacing[1], 0), (0, 0, spacing[2])), first, comment)


def directed(kind, nodes, axes, first, comment):
    """The same with axes that lead anywhere."""
    return [
        "NRRD0004",
        f"# {comment}",
        f"type: {kind}",
        "dimension: 3",
        "space dimension: 3",
        "sizes: " + " ".join(map(str, nodes)),
        "space directions: " + " ".join(f"({x},{y},{z})" for x, y, z in axes),
        "space origin: ({},{},{})".format(*first),
    ]


def hard(name, nodes, spacing, value, first=(0, 0, 0), centre="node", comment=""):
    """A text NRRD of `value(i, j, k)`; `first` is where the first value lies."""
    rows = [
        " ".join(str(value(i, j, k)) for i in range(nodes[0]))
        for k in range(nodes[2])
        for j in range(nodes[1])
    ]
    header = placed("double", nodes, spacing, first, comment) + [
        f"centers: {centre} {centre} {centre}",
        "encoding: text",
        "",
    ]
    (VOLUMES / "hard").mkdir(parents=True, exist_ok=True)
    (VOLUMES / "hard" / name).write_text("\n".join(header + rows) + "\n")


def hill(i, j, k):
    """Highest at node (2, 3, 2), lopsided; in sixty-fourths, so exact in single precision."""
    def part(n, top):
        return max(0, 4 - abs(n - top) * (2 if n > top else 1) - (n == 0))

    return part(i, 2) * part(j, 3) * part(k, 2) / 64


def hard_cases():
    hard("constant.nrrd", (5, 4, 3), (0.25, 0.25, 0.25), lambda *_: 0.7, comment="0.7 everywhere")
    hard("half.nrrd", (2, 2, 2), (1, 1, 1), lambda *_: 0.5, comment="0.5 everywhere, edge 1")
    hard("half-3.3.nrrd", (2, 2, 2), (3.3, 3.3, 3.3), lambda *_: 0.5, comment="0.5, edge 3.3")
    hard("ones.nrrd", (5, 4, 3), (1, 2, 4), lambda *_: 1, comment="1, three spacings")
    hard("empty.nrrd", (4, 4, 4), (0.25, 0.25, 0.25), lambda *_: 0, comment="nothing")
    hard("tenth.nrrd", (3, 3, 3), (1000, 1000, 200), lambda *n: (0.1, 0.10000001)[sum(n) % 2],
         (-1000, -1000, -400), comment="0.1 to an ulp of single precision, 2000 wide, 400 deep")
    hard("cell.nrrd", (2, 2, 2), (1, 1, 1), lambda i, j, k: i * j * k, comment="xyz in one cell")
    hard("ramp.nrrd", (2, 2, 2), (1, 1, 1), lambda i, j, k: k, comment="z")
    hard("linear.nrrd", (9, 9, 9), (0.125,) * 3, lambda i, j, k: (i + j + k) / 32,
         comment="(x + y + z)/4 in 8 x 8 x 8 cells")
    hard("thin.nrrd", (1, 16, 16), (1, 1, 1), lambda i, j, k: (j * k % 7) / 4, (0.5, 0.5, 0.5),
         "cell", "one voxel thick along x")
    hard("one.nrrd", (1, 1, 1), (1, 1, 1), lambda *_: 0.7, (0.5, 0.5, 0.5), "cell", "one voxel")
    hard("spacings.nrrd", (5, 4, 3), (1, 2, 4), lambda i, j, k: (i + 2 * j * j + 3 * k * i) % 5,
         comment="three spacings")
    sixteenth = (0.0625, 0.0625, 0.0625)
    hard("spike.nrrd", (17, 17, 17), sixteenth, lambda *n: int(n == (8, 8, 8)),
         comment="1 at node (8, 8, 8), else 0")
    hard("steps.nrrd", (2, 2, 5), (1, 1, 0.37), lambda i, j, k: (0.2, 0.2, 2, 0.2, 2)[k],
         comment="jumps between nodes along z, if the nearest node holds")
    hard("tiny-and-huge.nrrd", (2, 2, 2), (1, 1, 1), lambda i, j, k: ("1e-40", "3e38")[i],
         comment="a subnormal and a huge number of single precision")
    odd = {(0, 0, 0): "nan", (1, 2, 1): "inf", (2, 1, 3): "-inf", (3, 3, 3): "nan"}
    hard("not-finite.nrrd", (4, 4, 4), (0.25, 0.25, 0.25), lambda *n: odd.get(n, 0.7),
         comment="0.7, but for four values")
    for name, unit in (("", 1), ("-up", 2.0**40), ("-down", 2.0**-40)):
        hard(f"hill{name}.nrrd", (6, 6, 6), (0.25 * unit,) * 3, hill, (-0.5 * unit,) * 3,
             comment=f"a hill, nodes {0.25 * unit!r} apart")
    far = 2**20
    hard("hill-far.nrrd", (6, 6, 6), (0.25,) * 3, hill, (far - 0.5,) * 3,
         comment="the hill, moved by 2^20 along each axis")


# Values of the limits are whole numbers from 0 to 255 * 256: what a sine is rounded by in its last
# place changes none, and 256 of them are a step of a table of 256 entries.
FULL = 255 * 256


def limit(name, nodes, low, high, value, comment):
    """A NRRD of 16 bits, gzipped, of `value(x, y, z)` in [0, 1] at nodes from `low` to `high`, the
    corners of the box; an axis of one node is as thick as the box."""
    def at(axis, index):
        if nodes[axis] == 1:
            return 0.5 * (low[axis] + high[axis])
        return low[axis] + (high[axis] - low[axis]) * index / (nodes[axis] - 1)

    values = [
        round(FULL * min(1, max(0, value(at(0, i), at(1, j), at(2, k)))))
        for k in range(nodes[2])
        for j in range(nodes[1])
        for i in range(nodes[0])
    ]
    spacing = [(h - l) / max(1, n - 1) for n, l, h in zip(nodes, low, high)]
    first = [at(axis, 0) for axis in range(3)]
    header = placed("ushort", nodes, spacing, first, comment) + [
        "endian: little",
        "encoding: gzip",
        "",
        "",
    ]
    (VOLUMES / "limit").mkdir(parents=True, exist_ok=True)
    data = "\n".join(header).encode() + zipped(packed("<", "H", values))
    (VOLUMES / "limit" / name).write_bytes(data)


def marschner_lobb(x, y, z):
    """Marschner & Lobb 1994, with their frequency and amplitude."""
    f, a = 6, 0.25
    ring = math.cos(2 * math.pi * f * math.cos(0.5 * math.pi * math.hypot(x, y)))
    return (1 - math.sin(0.5 * math.pi * z) + a * (1 + ring)) / (2 * (1 + a))


def balls(x, y, z):
    """Three soft balls that run into each other."""
    centres = ((-0.35, -0.3, 0.1, 0.38), (0.4, -0.1, -0.25, 0.32), (0.0, 0.45, 0.15, 0.3))
    return sum(
        math.exp(-((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / (r * r)) for a, b, c, r in centres
    ) / 1.25


def gyroid(x, y, z):
    """A gyroid of one and a half periods, in a ball: towards its rim the value falls."""
    p, q, r = (1.5 * math.pi * s for s in (x, y, z))
    wave = math.sin(p) * math.cos(q) + math.sin(q) * math.cos(r) + math.sin(r) * math.cos(p)
    return 0.5 + wave / 3.2


def marble(x, y, z):
    """Folded sheets that fill the box up to its faces."""
    fold = math.sin(2.1 * x + 1.3 * math.sin(2.4 * y) + 0.8 * math.sin(3.1 * z + 0.7))
    grain = math.sin(3.7 * x - 2.9 * y + 1.9 * z) * math.sin(2.3 * y + 3.3 * z + 1)
    return 0.5 + 0.36 * fold + 0.13 * grain


def torus(x, y, z):
    """1 on the ring of a torus that stands upright, 0 at a distance of 0.36."""
    return 1 - math.hypot(math.hypot(x, y) - 0.6, z) / 0.36


def shells(x, y, z):
    """1 in the middle and 0 at a distance of 1, with a wave on it."""
    r = math.sqrt(x * x + y * y + z * z)
    return 1 - r - 0.06 * math.sin(5 * x) * math.sin(5 * y + 1) * math.sin(5 * z + 2)


def lattice_of_balls(x, y, z):
    """3 x 3 x 3 soft balls."""
    def along(s):
        return s - 2 / 3 * min(1, max(-1, round(1.5 * s)))

    square = along(x) ** 2 + along(y) ** 2 + along(z) ** 2
    return math.exp(-square / 0.034)


def ripples(x, y, z):
    """Two sources of waves in a sheet."""
    waves = sum(
        math.cos(14 * math.hypot(x - a, y - b)) / (1 + 1.5 * math.hypot(x - a, y - b))
        for a, b in ((-0.45, -0.3), (0.5, 0.35))
    )
    return 0.5 + 0.3 * waves


def cells(x, y, z):
    """A number for each of 7 x 7 x 7 places, without a pattern."""
    i, j, k = (round(3 * s) + 3 for s in (x, y, z))
    return (i * 53 + j * 97 + k * 151 + i * j * 29 + j * k * 61 + k * i * 43) % 101 / 100


def limits():
    one = ((-1, -1, -1), (1, 1, 1))
    limit("marschner-lobb.nrrd", (40,) * 3, *one, marschner_lobb, "the signal of Marschner and Lobb 1994")
    limit("balls.nrrd", (28,) * 3, *one, balls, "three soft balls")
    limit("gyroid.nrrd", (30,) * 3, *one, gyroid, "a gyroid")
    limit("marble.nrrd", (22,) * 3, *one, marble, "folded sheets up to the border")
    limit("torus.nrrd", (37, 19, 10), *one, lambda x, y, z: torus(x, y, z), "a torus, three spacings")
    limit("shells.nrrd", (28,) * 3, *one, shells, "round, with a wave")
    limit("lattice.nrrd", (31,) * 3, *one, lattice_of_balls, "27 soft balls")
    limit("ripples.nrrd", (64, 64, 1), (-1, -1, -0.0625), (1, 1, 0.0625), ripples, "one voxel thick")
    limit("cells.nrrd", (7,) * 3, *one, cells, "7 x 7 x 7 numbers")
    limit("ramp.nrrd", (2, 2, 2), *one, lambda x, y, z: (x + y + z + 3) / 6, "a ramp along the diagonal")


def sampled(name, spacing, values, comment):
    """A NRRD of 8 bits, gzipped, of whole numbers `values[k][j][i]`, its box around the origin."""
    nodes = (len(values[0][0]), len(values[0]), len(values))
    first = [-0.5 * s * (n - 1) for n, s in zip(nodes, spacing)]
    header = placed("uchar", nodes, spacing, first, comment) + ["encoding: gzip", "", ""]
    bytes_of = bytes(value for layer in values for row in layer for value in row)
    (VOLUMES / "sampled").mkdir(parents=True, exist_ok=True)
    (VOLUMES / "sampled" / name).write_bytes("\n".join(header).encode() + zipped(bytes_of))


def at_indices(nodes, value):
    """`value(i, j, k)` at every node."""
    return [[[value(i, j, k) for i in range(nodes[0])] for j in range(nodes[1])] for k in range(nodes[2])]


def at_nodes(nodes, spacing, value):
    """`value(x, y, z)` in [0, 1], around the origin, as whole numbers up to 255."""
    def number(*index):
        point = [s * (i - 0.5 * (n - 1)) for i, n, s in zip(index, nodes, spacing)]
        return round(255 * min(1, max(0, value(*point))))

    return at_indices(nodes, number)


def rings(x, y, z):
    """Two rings, one through the other; the second is weaker."""
    first = math.hypot(math.hypot(x + 0.4, y - 0.1) - 0.62, z + 0.08)
    second = math.hypot(math.hypot(x - 0.42, z - 0.1) - 0.52, y)
    return max(1 - first / 0.34, 0.72 - 0.72 * second / 0.34)


def phantom(x, y, z):
    """A head: a skull with a nose towards -y, tissue, a hollow on either side, a clot on one."""
    r = math.sqrt((x / 0.85) ** 2 + (y / 0.8) ** 2 + (z / 0.9) ** 2)
    skull = 1.05 - abs(r - 0.9) / 0.22
    tissue = 0.42 * min(1, max(0, (0.9 - r) / 0.15))
    nose = 1.3 - math.sqrt(x * x + (y + 0.95) ** 2 + ((z + 0.1) / 1.5) ** 2) / 0.2
    clot = 0.95 - math.sqrt((x - 0.3) ** 2 + (y - 0.2) ** 2 + (z - 0.25) ** 2) / 0.35
    hollow = min(math.hypot(x - s * 0.28, y + 0.2) + 0.6 * abs(z) for s in (-1, 1))
    return max(skull, nose, clot, tissue - max(0, 0.4 - hollow))


# Fifths of 255, in a column of them.
STRIPES = (1, 1, 5, 5, 0, 0, 3, 3, 4, 1, 5, 0, 2, 4, 0, 5, 5, 2, 2, 3, 1, 0, 4, 5)


def block(i, j, k):
    """A fifth of 255 or more at every other node, without a pattern."""
    number = (i * 53 + j * 97 + k * 151 + i * j * 29 + j * k * 61 + k * i * 43) % 11
    return 51 * max(0, number - 5)


def small_grids():
    for name, nodes, spacing, value, comment in (
        ("rings.nrrd", (24, 18, 16), (0.125,) * 3, rings, "two rings, one through the other"),
        ("phantom.nrrd", (20, 26, 10), (0.125, 0.1, 0.25), phantom, "a head in thick slices"),
        ("waves.nrrd", (14, 12, 10), (0.2,) * 3, marble, "folded sheets up to the border"),
    ):
        sampled(name, spacing, at_nodes(nodes, spacing, value), comment)
    for name, nodes, spacing, value, comment in (
        ("blocks.nrrd", (5, 6, 7), (0.25,) * 3, block, "5 x 6 x 7 numbers"),
        ("column.nrrd", (2, 2, 24), (0.5, 0.5, 0.125), lambda i, j, k: 51 * STRIPES[k], "stripes along z"),
        ("constant.nrrd", (3, 4, 5), (0.5, 0.5, 0.25), lambda *_: 153, "153 everywhere"),
        ("impulse.nrrd", (7, 7, 7), (0.25,) * 3, lambda *n: 255 * (n == (2, 3, 4)), "255 at node (2, 3, 4)"),
        ("slope.nrrd", (6, 5, 9), (0.25,) * 3, lambda i, j, k: 15 + 12 * i + 15 * j + 15 * k, "a slope along all axes"),
    ):
        sampled(name, spacing, at_indices(nodes, value), comment)

    nodes, spacing = (16, 14, 12), (0.15, 0.15, 0.2)
    values = at_nodes(nodes, spacing, rings)
    axes = ((0.12, 0.09, 0), (0.09, -0.12, 0.03), (0, 0.04, 0.2))
    first = [-0.5 * sum(a[row] * (n - 1) for a, n in zip(axes, nodes)) for row in range(3)]
    header = directed("uchar", nodes, axes, [round(x, 6) for x in first], "two rings, on oblique left-handed axes")
    header += ["encoding: gzip", "", ""]
    bytes_of = bytes(value for layer in values for row in layer for value in row)
    (VOLUMES / "placed").mkdir(parents=True, exist_ok=True)
    (VOLUMES / "placed" / "oblique.nrrd").write_bytes("\n".join(header).encode() + zipped(bytes_of))


def chest(x, y, z):
    """Hounsfield units of a body in air: ribs around two lungs, a spine, and a vessel in one lung."""
    r = math.sqrt((x / 1.1) ** 2 + (y / 0.85) ** 2 + (z / 1.2) ** 2)
    body = min(40, -1000 + 5200 * max(0, 1 - r))
    lungs = [math.sqrt(((x - s * 0.45) / 0.34) ** 2 + (y / 0.5) ** 2 + (z / 0.75) ** 2) for s in (-1, 1)]
    body = max(-850, body - 4000 * max(0, 1 - min(lungs))) if r < 0.8 else body
    rib = abs(r - 0.84) / 0.09 + abs(math.sin(7 * z)) ** 4
    spine = math.hypot(x, y - 0.52) / 0.14
    vessel = math.hypot(x + 0.42 - 0.2 * z, y + 0.15 * math.sin(4 * z)) / 0.1
    return max(body, 700 * (1 - rib), 900 * (1 - spine), 300 * (1 - vessel) if abs(z) < 0.6 else -1000)


def signed():
    """A NRRD of 16 bits with a sign, gzipped."""
    nodes, spacing = (24, 20, 22), (0.1, 0.1, 0.125)
    first = [-0.5 * s * (n - 1) for n, s in zip(nodes, spacing)]
    header = placed("short", nodes, spacing, first, "Hounsfield units of a body in air")
    header += ["endian: little", "encoding: gzip", "", ""]

    def number(*index):
        return round(chest(*(f + s * i for f, s, i in zip(first, spacing, index))))

    layers = at_indices(nodes, number)
    values = [value for layer in layers for row in layer for value in row]
    (VOLUMES / "projections").mkdir(parents=True, exist_ok=True)
    data = "\n".join(header).encode() + zipped(packed("<", "h", values))
    (VOLUMES / "projections" / "chest.nrrd").write_bytes(data)


main()
hard_cases()
limits()
small_grids()
signed()
