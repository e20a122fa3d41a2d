"""Arrays as image files: OpenEXR for radiance, PNG for 8-bit codes."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

# pytest shows the line that called volref, not the lines of volref.
__tracebackhide__ = True

#: Difference between two values of a background without noise, as a share of them.
SAME = 1e-4


def as_image(image: ArrayLike, name: str = "image") -> NDArray[Any]:
    """The array as float32 of shape (height, width, 3 or 4), or uint8 of shape (height, width, 3).

    Takes what src/film/npy_file.rs takes, and uint8. Raises TypeError for other types and ValueError for other
    shapes. NaN and infinity pass: volref says where they are.
    """
    if image is None:
        raise TypeError(f"the {name} is None: give an array")
    if isinstance(image, (str, bytes, Path)):
        raise TypeError(f"the {name} is text or a path: give an array")
    if np.ma.isMaskedArray(image):
        raise TypeError(f"the {name} is a masked array: fill it first")
    array = np.asarray(image)
    shape = array.shape
    if array.dtype == np.uint8:
        channels = (1, 3)
    elif array.dtype.kind == "f" and array.dtype.itemsize <= 8:
        channels = (1, 3, 4)
    else:
        raise TypeError(
            f"the {name} has the type {array.dtype}: give floating point of 16, 32 or 64 bits for linear radiance, or "
            "uint8 for sRGB"
        )
    if array.ndim == 2:
        array = array[:, :, np.newaxis]
    if array.ndim != 3 or array.shape[2] not in channels or 0 in array.shape:
        allowed = " or ".join(f"(height, width, {count})" for count in channels[1:])
        raise ValueError(
            f"the {name} has the shape {shape}: give {allowed}, or (height, width) for grey{_hint(array)}"
        )
    if array.shape[2] == 1:
        array = np.repeat(array, 3, axis=2)
    if array.dtype == np.uint8:
        return np.ascontiguousarray(array)
    with np.errstate(over="ignore"):
        stored = np.ascontiguousarray(array, dtype=np.float32)
    if (np.isinf(stored) & np.isfinite(array)).any():
        raise ValueError(f"the {name} has values beyond the range of 32-bit floats: {np.abs(array).max():g}")
    return stored


def _hint(array: NDArray[Any]) -> str:
    """What is probably meant by an array of the wrong shape, after a semicolon."""
    if array.size == 0:
        return "; it holds no values"
    if array.ndim == 3 and array.shape[0] in (1, 3, 4):
        return "; channels come last: give np.moveaxis(array, 0, -1)"
    if array.ndim == 4 and array.shape[0] == 1:
        return "; of a stack of one image give array[0]"
    if array.ndim == 4:
        return f"; give {array.shape[0]} renderings with seeds of their own as a list of arrays: list(array)"
    return ""


def as_variance(variance: ArrayLike, image: NDArray[Any]) -> NDArray[np.float32]:
    """The variance of the means, of the image's size, as float32 of shape (height, width, 3).

    Raises TypeError or ValueError if it is none, or if it is 0 where ``image`` is noisy.
    """
    array = as_image(variance, "variance")
    if array.dtype == np.uint8 or image.dtype == np.uint8:
        raise TypeError("a variance is floating point, and that of linear radiance")
    if array.shape[:2] != image.shape[:2]:
        raise ValueError(
            f"the variance has {array.shape[1]} × {array.shape[0]} pixels, the image "
            f"{image.shape[1]} × {image.shape[0]}"
        )
    array = array[:, :, :3]
    bad = ~(array >= 0) | np.isinf(array)
    if bad.any():
        row, column, channel = (int(index) for index in np.argwhere(bad)[0])
        raise ValueError(
            f"{int(bad.sum())} values of the variance are negative or not finite; the first is "
            f"{array[row, column, channel]} in channel {channel} of pixel ({column}, {row})"
        )
    if _is_without_noise(image[:, :, :3], array):
        raise ValueError(
            "the variance is 0 for most of the image; a variance of 0 says that the image has no noise: leave it out, "
            "or give the variance of the mean"
        )
    return array


def _is_without_noise(image: NDArray[np.float32], variance: NDArray[np.float32]) -> bool:
    """Whether ``variance`` is 0 for most values of ``image`` that are not 0, and most of these differ from the
    median of their channel; if it is 0 everywhere, whether any does. Both have shape (height, width, 3).

    Values without noise that are all the same are right: in a furnace, or of a background of one colour.
    """
    is_lit = image != 0
    is_sure = is_lit & (variance == 0)
    if 2 * is_sure.sum() <= is_lit.sum():
        return False
    differing = 0
    for channel in range(3):
        values = image[:, :, channel][is_sure[:, :, channel]]
        if values.size:
            with np.errstate(invalid="ignore"):
                usual = np.median(values)
                differing += int((np.abs(values - usual) > SAME * abs(usual)).sum())
    return differing > (is_sure.sum() / 2 if variance.any() else 0)


def as_depth(depth: Any, images: Sequence[NDArray[Any]]) -> NDArray[np.float32]:
    """Distances of the pixels of the one of ``images``, as float32 of shape (height, width)."""
    array = np.asarray(depth)
    if len(images) != 1 or images[0].dtype == np.uint8:
        raise ValueError("a depth belongs to one image of linear radiance")
    if array.dtype.kind != "f" or array.shape != images[0].shape[:2]:
        raise ValueError(
            f"the depth has the type {array.dtype} and the shape {array.shape}: give floating point of the shape "
            f"{images[0].shape[:2]}, (height, width)"
        )
    return array.astype(np.float32)


def write(
    path: Path,
    image: NDArray[Any],
    variance: NDArray[np.float32] | None = None,
    samples: int | None = None,
    depth: NDArray[np.float32] | None = None,
) -> Path:
    """Writes an image as ``path`` with the extension of its format; returns the file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if image.dtype == np.uint8:
        file = path.parent / f"{path.name}.png"
        file.write_bytes(png(image))
        return file
    channels = {name: image[:, :, index] for index, name in enumerate("RGBA"[: image.shape[2]])}
    if variance is not None:
        channels |= {f"variance.{name}": variance[:, :, index] for index, name in enumerate("RGB")}
    if depth is not None:
        channels["Z"] = depth
    if samples is not None:
        channels["samples.Y"] = np.full(image.shape[:2], samples, dtype=np.uint32)
    file = path.parent / f"{path.name}.exr"
    file.write_bytes(exr(channels))
    return file


def exr(channels: dict[str, NDArray[np.float32] | NDArray[np.uint32]]) -> bytes:
    """An uncompressed OpenEXR file of channels of shape (height, width), 32-bit floats or whole numbers, by the
    file layout of its specification."""
    names = sorted(channels)
    height, width = channels[names[0]].shape

    def attribute(name: str, kind: str, value: bytes) -> bytes:
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    kinds, once = {"u": 0, "f": 2}, 1
    listed = b"".join(
        name.encode() + b"\0" + struct.pack("<iB3xii", kinds[channels[name].dtype.kind], 0, once, once)
        for name in names
    )
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = (
        struct.pack("<ii", 20000630, 2)
        + attribute("channels", "chlist", listed + b"\0")
        + attribute("compression", "compression", b"\0")
        + attribute("dataWindow", "box2i", window)
        + attribute("displayWindow", "box2i", window)
        + attribute("lineOrder", "lineOrder", b"\0")
        + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
        + attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0))
        + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
        + b"\0"
    )
    # Row by row, the channels of a row one after the other, each value as its 32 bits.
    bits = [np.ascontiguousarray(channels[name]).view(np.uint32) for name in names]
    rows = np.stack(bits, axis=1).astype("<u4")
    length = rows[0].nbytes
    first = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + row * (8 + length) for row in range(height)))
    lines = (struct.pack("<ii", row, length) + rows[row].tobytes() for row in range(height))
    return header + offsets + b"".join(lines)


def png(codes: NDArray[np.uint8]) -> bytes:
    """A PNG file of 8-bit sRGB."""
    height, width, _ = codes.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    unfiltered = np.zeros((height, 1 + 3 * width), dtype=np.uint8)
    unfiltered[:, 1:] = codes.reshape(height, 3 * width)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(unfiltered.tobytes()))
        + chunk(b"IEND", b"")
    )
