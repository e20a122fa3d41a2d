"""Means of pictures that differ by their seeds alone, with their noise, as volref reads them."""

import math

import numpy as np
from image_file import write_channels

# Both renderers calculate with 32 bits: of a hundred roundings on a path (2^-24 each, 6e-6
# together) those that are the same in every sample show in no spread.
ROUNDING = 1e-5


def shares(spp, most):
    """How `spp` samples are divided among at most `most` pictures: samples of each, pictures."""
    samples = math.ceil(spp / most)
    return samples, max(2, math.ceil(spp / samples))


def seeds(seed, count):
    """A seed of 31 bits for every picture, none of them near another."""
    states = np.random.SeedSequence(seed).generate_state(count)
    return [int(state) & 0x7FFFFFFF for state in states]


def summary(pictures):
    """Their mean and the variance of it: 0 in pixels that agree but for rounding, none if all do.

    Rounding is no noise. A gate that finds less noise than is stated cannot tell it from a picture
    that was denoised, and allows for rounding by itself.
    """
    pictures = np.asarray(pictures, float)
    mean = pictures.mean(0)
    spread = pictures.var(0, ddof=1) / len(pictures)
    variance = np.where(spread <= (ROUNDING * mean) ** 2, 0.0, spread)
    return mean, variance if variance.any() else None


def write(file, mean, variance, samples):
    """An EXR, with the noise in layers of its own where there is any."""
    channels = dict(zip("RGB", np.moveaxis(mean, 2, 0)))
    if variance is not None:
        names = ["variance.R", "variance.G", "variance.B"]
        channels.update(zip(names, np.moveaxis(variance, 2, 0)))
        channels["samples.Y"] = np.full(mean.shape[:2], samples)
    # By its last name only when it is whole.
    aside = file.with_name(f".{file.stem}.partial.exr")
    write_channels(aside, channels)
    aside.replace(file)
