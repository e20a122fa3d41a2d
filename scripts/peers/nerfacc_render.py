#!/usr/bin/env python3
"""Renders a bundle with nerfacc's volumetric rendering, by PyTorch on the processor.

    volref validate sampled limit --format npy --serve 'scripts/peers/nerfacc_render.py --serve {export:bundle} {step}'

Needs `pip install torch nerfacc volref`. nerfacc composites. Intervals, interpolation (grid_sample) and the transfer
function are the caller's, here as radiance fields have them: a density and a colour in the middle of each interval.
"""

import nerfacc
import numpy as np
import torch
import torch.nn.functional as F
import volref
from pixel_rays import crossings, pixel_rays

DENSEST = 1e9  # extinction of an opaque entry, over the reference length
TABLE = 4096


def render(bundle):
    bundle.allow()
    volume, step, (width, height) = bundle.volume, bundle.step, bundle.size
    near, far = pixel_rays(bundle)
    directions = (far - near) / np.linalg.norm(far - near, axis=-1, keepdims=True)
    origins = near if bundle.parallel_height else np.broadcast_to(bundle.eye, near.shape)
    enter, leave = crossings(origins, directions, volume.grid["box_min"], volume.grid["box_max"])
    first = enter[:, None] + step * np.arange(int(np.ceil((leave - enter).max() / step)) or 1)
    starts, stops = (torch.tensor(np.minimum(ends, leave[:, None])) for ends in (first, first + step))

    table = volume.table(TABLE)
    with np.errstate(divide="ignore"):
        extinctions = np.minimum(-np.log1p(-table.opacities), DENSEST) / volume.reference_length
    entries = torch.tensor(np.column_stack([table.colours, extinctions]))
    values = torch.tensor(volume.values, dtype=torch.float64)[None, None]
    low, spacing, nodes = (np.array(volume.grid[key]) for key in ("first_node", "spacing", "nodes"))
    # To places in the unit of grid_sample: -1 and 1 at the outer faces of voxels.
    scale, shift = 2 / (spacing * nodes), (0.5 - low / spacing) / nodes * 2 - 1
    origins, directions = torch.tensor(origins * scale + shift), torch.tensor(directions * scale)
    mode = "nearest" if volume.is_nearest else "bilinear"

    def field(starts, stops, _):
        places = origins[:, None] + directions[:, None] * ((starts + stops) / 2)[..., None]
        found = F.grid_sample(values, places[None, None], mode=mode, padding_mode="border", align_corners=False)[0, 0, 0]
        share = ((found - table.range[0]) / (table.range[1] - table.range[0])).clamp(0, 1) * (TABLE - 1)
        before = share.long().clamp(max=TABLE - 2)
        found = torch.lerp(entries[before], entries[before + 1], (share - before)[..., None])
        return found[..., :3], found[..., 3]

    background = torch.tensor(bundle.background, dtype=torch.float64)
    colours, *_ = nerfacc.rendering(starts, stops, rgb_sigma_fn=field, render_bkgd=background)
    return colours.reshape(height, width, 3).numpy()


volref.main(render)
