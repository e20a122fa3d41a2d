"""Reads bundles of volref: one panel with a classified volume, its grid and its transfer function."""

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from image_file import image_path


def arguments(description):
    """A parser of the arguments that all renderers of bundles take."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("bundle", type=Path)
    parser.add_argument("output", type=image_path)
    parser.add_argument("--step", type=float, help="distance between samples, world units")
    return parser


def refuse(reason):
    """Ends the program: the renderer has no words for the scene."""
    sys.exit(f"refused: {reason}")


def load(path):
    """The panel of a bundle, and its values with the shape (z, y, x)."""
    bundle = json.loads(path.read_text("utf-8"))
    panels = bundle["panels"]
    if len(panels) > 1 or panels[0]["shows"] != "volume":
        refuse("more than one panel, or a plot")
    grid = panels[0]["grid"]
    if "mode" in panels[0]:
        refuse("a projection or isosurfaces")
    if "matrix" in grid:
        refuse("a volume placed by a matrix")
    values = np.fromfile(path.parent / grid["file"], "<f4")
    return panels[0], values.reshape(grid["nodes"][::-1])


def is_of_cells(grid):
    """True if the box reaches half a voxel beyond the outermost nodes."""
    beyond = np.subtract(grid["first_node"], grid["box_min"])
    return bool(np.all(beyond > 0.25 * np.array(grid["spacing"])))


def span(transfer):
    """The values of the first and the last point of a transfer function."""
    points = transfer.get("points")
    return (points[0]["value"], points[-1]["value"]) if points else (0.0, 1.0)


def looks(transfer, values):
    """Colours, and opacities over the reference length, of `values` between the first and the last point."""
    if "points" not in transfer:
        clear = (np.exp(-(values**2)) - transfer["floor"]) / (1 - transfer["floor"])
        place = np.linspace(0, 1, len(transfer["colours"]))
        channels = [np.interp(values, place, c) for c in np.transpose(transfer["colours"])]
        return np.stack(channels, 1) * values[:, None] ** 2, 1 - np.clip(clear, 0, 1)
    points = transfer["points"]
    at = np.array([point["value"] for point in points])
    k = np.clip(np.searchsorted(at, values, "right") - 1, 0, len(at) - 2)
    share = np.clip((values - at[k]) / np.maximum(at[k + 1] - at[k], 1e-300), 0, 1)

    def between(name):
        v = np.array([point[name] for point in points])
        t = share[:, None] if v.ndim > 1 else share
        return v[k] + (v[k + 1] - v[k]) * t

    return between("colour"), between("opacity")


def nearest(panel):
    """Distance from the eye to the box, 0 inside."""
    eye, grid = panel["ray"]["eye"], panel["grid"]
    return np.linalg.norm(np.clip(eye, grid["box_min"], grid["box_max"]) - eye)


def farthest(panel):
    """Distance from the eye to the farthest corner of the box."""
    box = np.array([panel["grid"]["box_min"], panel["grid"]["box_max"]])
    return np.linalg.norm(np.abs(box - panel["ray"]["eye"]).max(0))
