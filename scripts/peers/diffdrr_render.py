#!/usr/bin/env python3
"""Renders a bundle of sums along rays with DiffDRR, X-ray images by PyTorch on the processor.

    volref validate scenes --format npy --serve 'scripts/peers/diffdrr_render.py --serve {export:bundle}'

Needs `pip install diffdrr volref`. Its renderer is Siddon, the default of its class DRR; --renderer trilinear is the
other. As that class does, it gives the renderer the source and the pixels of the detector in numbers of voxels. The
detector stands behind the volume.
"""

import argparse

import numpy as np
import torch
import volref
from diffdrr import renderers
from pixel_rays import crossings, pixel_rays

RENDERERS = {"siddon": renderers.Siddon, "trilinear": renderers.Trilinear}


def render(bundle, renderer):
    bundle.allow("placed", "sum")
    volume, (width, height) = bundle.volume, bundle.size
    if not volume.mode:
        volref.refuse("composited samples")
    if bundle.parallel_height:
        volref.refuse("parallel rays")
    _, pixels = pixel_rays(bundle)
    lengths = np.linalg.norm(pixels - bundle.eye, axis=-1)
    to_voxels = np.linalg.inv(volume.affine)
    source, target = (points @ to_voxels[:3, :3].T + to_voxels[:3, 3] for points in (bundle.eye[None], pixels))
    values = volume.values.T.astype(np.float64)
    arrays = values.copy(), source[None], target[None], lengths[None, None]
    sums = RENDERERS[renderer]()(*map(torch.tensor, arrays)).numpy().reshape(-1, 1)
    mode = volume.mode
    image = np.repeat((sums - mode["low"]) / (mode["high"] - mode["low"]), 3, axis=1).clip(0, 1)
    # Its sum is 0 where a ray meets nothing, and the scene shows its background.
    enter, leave = crossings(source, target - source, 0, np.array(values.shape) - 1)
    image[enter >= leave] = bundle.background
    return image.reshape(height, width, 3)


parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
parser.add_argument("--renderer", choices=RENDERERS, default="siddon")
volref.main(render, parser)
