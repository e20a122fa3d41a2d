"""Writes linear RGB images, with opacity or without, 32-bit floats, with nothing but NumPy; reads EXR by Mitsuba."""

import argparse
import struct
from pathlib import Path

import numpy as np


def image_path(name):
    """The path of an image that can be written: a type of argument for argparse."""
    if Path(name).suffix not in WRITERS:
        raise argparse.ArgumentTypeError(f"{name}: an image ends in {', '.join(WRITERS)}")
    return Path(name)


def write_image(path, image):
    """Writes `image`, rows from the top, in the format that `path` ends in."""
    WRITERS[path.suffix](path, image)


def write_npy(path, image):
    np.save(path, image.astype("<f4"))


def write_pfm(path, image):
    height, width, _ = image.shape
    header = f"PF\n{width} {height}\n-1.0\n".encode()  # minus: little endian
    path.write_bytes(header + image[::-1, :, :3].astype("<f4").tobytes())  # no opacity


def write_exr(path, image):
    write_channels(path, dict(zip("RGBA", image.transpose(2, 0, 1))))


def write_channels(path, planes):
    """The simplest EXR there is: scan lines, not compressed, channels by name, 32-bit floats."""
    names = sorted(planes)
    planes = np.stack([planes[name] for name in names], axis=1).astype("<f4")
    height, _, width = planes.shape
    corner = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(name.encode() + struct.pack("<xiB3xii", 2, 0, 1, 1) for name in names)
    attributes = [
        (b"channels", b"chlist", channels + b"\0"),
        (b"compression", b"compression", b"\0"),
        (b"dataWindow", b"box2i", corner),
        (b"displayWindow", b"box2i", corner),
        (b"lineOrder", b"lineOrder", b"\0"),
        (b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
        (b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)),
        (b"screenWindowWidth", b"float", struct.pack("<f", 1)),
    ]
    header = struct.pack("<2i", 20000630, 2)
    for name, kind, value in attributes:
        header += name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value
    header += b"\0"
    # Where each row begins; then for each row its number, its size, and all of a channel at once.
    size = 4 * len(names) * width
    line = 8 + size
    begin = len(header) + 8 * height
    table = struct.pack(f"<{height}Q", *(begin + line * row for row in range(height)))
    rows = (struct.pack("<2i", row, size) + planes[row].tobytes() for row in range(height))
    path.write_bytes(header + table + b"".join(rows))


WRITERS = {".npy": write_npy, ".pfm": write_pfm, ".exr": write_exr}


def read_exr(file):
    """Radiance, and the variance of its noise: 0 where none is stated."""
    import mitsuba

    mitsuba.set_variant(mitsuba.variant() or "scalar_rgb")
    bitmap = mitsuba.Bitmap(str(file))
    channels = {field.name: i for i, field in enumerate(bitmap.struct_())}
    values = np.array(bitmap, float)
    image = values[:, :, [channels[c] for c in "RGB"]]
    if "variance.R" not in channels:
        return image, np.zeros_like(image)
    return image, values[:, :, [channels[f"variance.{c}"] for c in "RGB"]]
