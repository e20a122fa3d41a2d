"""Samples divided among pictures that differ by their seeds alone."""

import math

import numpy as np


def shares(spp, most):
    """How `spp` samples are divided among at most `most` pictures: samples of each, pictures."""
    samples = math.ceil(spp / most)
    return samples, max(2, math.ceil(spp / samples))


def seeds(seed, count):
    """A seed of 31 bits for every picture, none of them near another."""
    states = np.random.SeedSequence(seed).generate_state(count)
    return [int(state) & 0x7FFFFFFF for state in states]
