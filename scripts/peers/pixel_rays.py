"""Rays through the middles of the pixels of a bundle, as arrays, for renderers that are given rays."""

import numpy as np


def pixel_rays(bundle):
    """Their points on the near and on the far plane, world units: arrays of shape (height × width, 3)."""
    width, height = bundle.size
    to_world = np.linalg.inv(bundle.projection @ bundle.view)
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, 1 - (np.arange(height) + 0.5) / height * 2)
    ends = [np.stack([x, y, np.full_like(x, depth), np.ones_like(x)], -1) @ to_world.T for depth in (-1, 1)]
    return [(end[..., :3] / end[..., 3:]).reshape(-1, 3) for end in ends]


def crossings(origins, directions, low, high):
    """Where rays enter and leave the box from `low` to `high`, in multiples of `directions`; equal where they miss it."""
    along = np.where(np.abs(directions) < 1e-12, 1e-12, directions)
    ends = np.stack([(low - origins) / along, (high - origins) / along])
    enter = ends.min(0).max(-1).clip(min=0)
    return enter, np.maximum(ends.max(0).min(-1), enter)
