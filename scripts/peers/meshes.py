"""Shapes of radiative bundles as triangles, for renderers that know no others."""

import numpy as np
import volref

RINGS = 128  # of a sphere, whose triangles lie within 8e-5 of its radius


def mesh(part, key, folder, shrunk=0.0):
    """Vertices in the world, of shape (n, 3), and triangles, anticlockwise from the front; about its middle smaller by a share."""
    form = part["shape"] or volref.refuse(f"{key}: a medium that fills all space")
    vertices, triangles = KINDS[form["kind"]](form, folder)
    middle = (vertices.min(0) + vertices.max(0)) / 2
    vertices = middle + (1 - shrunk) * (vertices - middle)
    if part["matrix"]:
        matrix = np.array(part["matrix"])
        vertices = vertices @ matrix[:, :3].T + matrix[:, 3]
        if np.linalg.det(matrix[:, :3]) < 0:
            triangles = triangles[:, ::-1]
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    return vertices, triangles[np.cross(b - a, c - a).any(1)]


def rectangle(form, folder):
    corner, u, v = (np.array(form[name]) for name in ("corner", "edge_u", "edge_v"))
    return np.array([corner, corner + u, corner + u + v, corner + v]), np.array([(0, 1, 2), (0, 2, 3)])


def box(form, folder):
    x, y, z = np.transpose([form["min"], form["max"]])
    vertices = np.array([(a, b, c) for a in x for b in y for c in z])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([half for a, b, c, d in faces for half in ((a, b, c), (a, c, d))])


def sphere(form, folder):
    columns = 2 * RINGS
    polar, around = np.meshgrid(np.pi * np.arange(RINGS + 1) / RINGS, np.pi * np.arange(columns) / RINGS, indexing="ij")
    directions = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=2)
    row, column = np.indices((RINGS, columns)).reshape(2, -1)
    a, b = row * columns + column, row * columns + (column + 1) % columns
    triangles = np.concatenate([np.stack([a, a + columns, b + columns], 1), np.stack([a, b + columns, b], 1)])
    return form["centre"] + form["radius"] * directions.reshape(-1, 3), triangles


def triangles(form, folder):
    vertices, numbers = np.fromfile(folder / form["vertices"], "<f8"), np.fromfile(folder / form["triangles"], "<u4")
    return vertices.reshape(-1, 3), numbers.reshape(-1, 3).astype(int)


KINDS = {"rectangle": rectangle, "box": box, "sphere": sphere, "mesh": triangles}


def panel_of(bundle):
    """The panel of a radiative bundle."""
    if len(bundle.panels) != 1 or bundle.panels[0]["shows"] != "radiance":
        volref.refuse("several panels, or one that shows no radiance")
    return bundle.panels[0]


def samples_of(bundle, pictures):
    """Samples of each picture, and its seed: those that are asked for divided among at most so many."""
    from replicates import seeds, shares

    request, own = bundle.request, panel_of(bundle)["samples"] or {"per_pixel": 64, "seed": 0}
    samples, count = shares(request.get("spp") or own["per_pixel"], pictures)
    return samples, seeds(own["seed"] if request.get("seed") is None else request["seed"], count)


def density_of(medium, key):
    """The factor of all coefficients; a density that varies is refused."""
    density = medium["density"] or {"kind": "constant", "value": 1.0}
    if density["kind"] != "constant":
        volref.refuse(f"{key}.density: {density['kind']}")
    return density["value"]
