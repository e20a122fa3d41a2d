"""Reads and writes the grids of volref's media that need no more than numpy: `.vol` and `.bin`.

As with scenes, only valid files are read, and what is not known is refused by name.
"""

import numpy as np

from volref_scene import Refused


class Lattice:
    """Values at regularly spaced nodes, `values[z, y, x]`.

    `first` is the place of the first node, `spacing` that between nodes, `low` and `high` are the
    corners of the box that volref fills: the outermost nodes, or half a spacing beyond them if the
    grid is centred on cells. An axis of one node is one spacing thick in either case.
    """

    def __init__(self, values, first, spacing, cells):
        self.values = np.asarray(values, np.float32)
        self.first, self.spacing = np.array(first, float), np.array(spacing, float)
        self.nodes = np.array(self.values.shape[::-1])
        beyond = np.where((self.nodes == 1) | cells, 0.5, 0.0) * self.spacing
        last = self.first + self.spacing * (self.nodes - 1)
        self.low, self.high = self.first - beyond, last + beyond

    def around_voxels(self):
        """The box whose equal division into voxels has the nodes in their middles."""
        low = self.first - 0.5 * self.spacing
        return low, low + self.spacing * self.nodes


def read_grid(path, table):
    """The grid that a `grid` table of a medium names."""
    for key in table.keys() - {"file", "centring"}:
        raise Refused(f"`{key}` of a grid is not known here")
    data = path.read_bytes()
    centring = table.get("centring", "nodes")
    if path.suffix == ".vol":
        return read_vol(data, centring == "cells")
    if path.suffix == ".bin":
        return read_course(data, centring == "cells")
    raise Refused(f"a grid of type {path.suffix} is not read here; .vol and .bin are")


def read_vol(data, cells):
    """Mitsuba's format, whose header gives a box."""
    if data[:4] != b"VOL\x03":
        raise Refused("the grid is no Mitsuba volume of version 3")
    kind, *nodes, channels = np.frombuffer(data, "<i4", 5, 4)
    types = {1: "<f4", 2: "<f2", 3: "u1"}
    if channels != 1 or kind not in types:
        raise Refused(f"a volume of type {kind} with {channels} channels is not a density")
    low, high = np.frombuffer(data, "<f4", 6, 24).astype(float).reshape(2, 3)
    values = np.frombuffer(data, types[kind], offset=48).astype(np.float32)
    values = values.reshape(nodes[::-1]) / np.float32(255 if kind == 3 else 1)
    nodes = np.array(nodes)
    # As volref takes it: the outermost samples on the faces of the box, unless centred on cells.
    halves = cells | (nodes == 1)
    spacing = (high - low) / np.where(halves, nodes, nodes - 1)
    return Lattice(values, low + np.where(halves, 0.5, 0.0) * spacing, spacing, cells)


def read_course(data, cells):
    """The course's format: one spacing for all axes, the first node at the origin."""
    nodes = np.frombuffer(data, "<i4", 3)
    size = np.frombuffer(data, "<f4", 3, 12).astype(float)
    if nodes[0] < 2:
        raise Refused("a course grid with a single node along x is not read here")
    values = np.frombuffer(data, "<f4", offset=24).reshape(nodes[::-1])
    return Lattice(values, [0.0] * 3, [size[0] / (nodes[0] - 1)] * 3, cells)


def write_vol(path, values, low, high):
    """Writes `values[z, y, x]` as a volume of `float32` in a box."""
    header = np.array([1, *values.shape[::-1], 1], "<i4").tobytes()
    box = np.array([*low, *high], "<f4").tobytes()
    path.write_bytes(b"VOL\x03" + header + box + values.astype("<f4").tobytes())
