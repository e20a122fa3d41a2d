#!/usr/bin/env python3
"""Writes the small volumes of fixtures/volumes/formats: one grid in every format that is read.

The grid has 4 × 3 × 2 nodes, spacing (0.5, 1, 2), its first node at (-1, 2, 3), and the value
i + 10·j + 100·k at node (i, j, k): values that every type of 8 bits or more can hold. Formats that
cannot say all of this (the course's grid) leave out what they cannot. Needs Python 3 alone.
"""

import gzip
import pathlib
import struct

NODES = (4, 3, 2)
SPACING = (0.5, 1.0, 2.0)
FIRST = (-1.0, 2.0, 3.0)
FOLDER = pathlib.Path(__file__).parent.parent / "fixtures" / "volumes" / "formats"


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


main()
