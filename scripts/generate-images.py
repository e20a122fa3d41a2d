#!/usr/bin/env python3
"""Writes the small images of fixtures/images: one picture in every way that other programs write it.

The picture has 8 × 6 pixels and the value x + 8·y + 64·c in column x, row y and channel c: whole
numbers up to 175, which half floats, whole numbers and 8-bit codes can hold. Names beginning with
`bad-` are files that must be refused. Needs Python 3 with OpenEXR (3.4 or later) and NumPy, and
`exrmaketiled` of OpenEXR's own tools.
"""

import pathlib
import struct
import subprocess
import zlib

import Imath
import numpy as np
import OpenEXR

WIDTH, HEIGHT = 8, 6
FOLDER = pathlib.Path(__file__).parent.parent / "fixtures" / "images"

y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
PICTURE = np.stack([x + 8 * y + 64 * c for c in range(3)], axis=-1)


def window(left, top, width, height):
    ends = (left, top), (left + width - 1, top + height - 1)
    return tuple(np.array(end, dtype=np.int32) for end in ends)


def planes(picture, dtype, names=("R", "G", "B")):
    return {name: np.ascontiguousarray(picture[..., c], dtype) for c, name in enumerate(names)}


def header(kind=OpenEXR.scanlineimage, **more):
    return {"compression": OpenEXR.ZIP_COMPRESSION, "type": kind, **more}


def exr(name, channels, **more):
    OpenEXR.File(header(**more), channels).write(str(FOLDER / name))


def exr_parts(name, parts):
    parts = [OpenEXR.Part(header(), channels, part) for part, channels in parts]
    OpenEXR.File(parts).write(str(FOLDER / name))


def write_exr():
    for name, dtype in ("half", np.float16), ("float", np.float32), ("uint", np.uint32):
        exr(f"{name}.exr", planes(PICTURE, dtype))
    for name in "NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A":
        compression = getattr(OpenEXR, f"{name}_COMPRESSION")
        # B44 loses digits of halves and keeps all others.
        exr(f"{name.lower()}.exr", planes(PICTURE, np.float32 if "B" in name else np.float16),
            compression=compression)
    for name in "DWAA", "DWAB":
        exr(f"bad-{name.lower()}.exr", planes(PICTURE, np.float16),
            compression=getattr(OpenEXR, f"{name}_COMPRESSION"))
    more = planes(PICTURE + 1000, np.float16, ("albedo.R", "albedo.G", "albedo.B"))
    more |= {"Z": np.zeros((HEIGHT, WIDTH), np.float32), "id.Y": np.zeros((HEIGHT, WIDTH), np.uint32)}
    exr("aovs.exr", planes(PICTURE, np.float16) | more)
    exr("layer.exr", planes(PICTURE, np.float32, ("Main.R", "Main.G", "Main.B")))
    exr("small-letters.exr", planes(PICTURE, np.float32, "rgb"))
    layers = planes(PICTURE, np.float32, ("View.Combined.R", "View.Combined.G", "View.Combined.B"))
    exr("combined.exr", layers | more)
    exr("bad-two-layers.exr", more | planes(PICTURE, np.float32, ("direct.R", "direct.G", "direct.B")))
    exr("grey.exr", {"Y": np.ascontiguousarray(PICTURE[..., 0], np.float32)})
    depth = {"Z": np.zeros((HEIGHT, WIDTH), np.float32)}
    exr_parts("parts.exr", [("depth", depth), ("beauty", planes(PICTURE, np.float16)),
                            ("normal", planes(PICTURE + 1000, np.float16))])
    tiles = OpenEXR.TileDescription()
    tiles.xSize, tiles.ySize = 4, 4
    exr("tiled.exr", planes(PICTURE, np.float16), kind=OpenEXR.tiledimage, tiles=tiles)
    for option, name in ("-m", "mips.exr"), ("-r", "rips.exr"):
        half, tiled = FOLDER / "half.exr", FOLDER / name
        subprocess.run(["exrmaketiled", option, "-t", "4", "4", half, tiled], check=True)

    # Two columns and one row of data outside on the upper left, and as many missing on the other
    # side.
    outside = np.full((HEIGHT, WIDTH, 3), 999)
    outside[1:, 2:] = PICTURE[:-1, :-2]
    exr("shifted.exr", planes(outside, np.float32), dataWindow=window(98, -51, WIDTH, HEIGHT),
        displayWindow=window(100, -50, WIDTH, HEIGHT))
    # More data than picture, on all sides.
    around = np.full((HEIGHT + 4, WIDTH + 6, 3), 999)
    around[2:-2, 3:-3] = PICTURE
    exr("overscan.exr", planes(around, np.float32),
        dataWindow=window(-3, -2, WIDTH + 6, HEIGHT + 4), displayWindow=window(0, 0, WIDTH, HEIGHT))
    exr("bad-elsewhere.exr", planes(PICTURE, np.float32),
        dataWindow=window(50, 50, WIDTH, HEIGHT), displayWindow=window(0, 0, WIDTH, HEIGHT))

    # The newer interface writes no fewer values than pixels.
    half = Imath.PixelType(Imath.PixelType.HALF)
    old = OpenEXR.Header(WIDTH, HEIGHT)
    old["channels"] = {"Y": Imath.Channel(half), "RY": Imath.Channel(half, 2, 2),
                       "BY": Imath.Channel(half, 2, 2)}
    file = OpenEXR.OutputFile(str(FOLDER / "bad-chroma.exr"), old)
    quarter = np.ones(WIDTH * HEIGHT // 4, np.float16).tobytes()
    file.writePixels({"Y": 4 * quarter, "RY": quarter, "BY": quarter})
    file.close()
    full = np.ones((HEIGHT, WIDTH), np.float16)
    exr("bad-full-chroma.exr", {"Y": full, "RY": full, "BY": full})
    deep = np.empty((HEIGHT, WIDTH), dtype=object)
    for place in np.ndindex(deep.shape):
        deep[place] = np.array([1, 2], np.float32)
    exr("bad-deep.exr", {name: deep for name in "RGBAZ"}, kind=OpenEXR.deepscanline,
        compression=OpenEXR.ZIPS_COMPRESSION)


def write_npy():
    for dtype in "<f2", ">f2", "<f4", ">f4", "<f8", ">f8":
        order = "big" if dtype[0] == ">" else "little"
        np.save(FOLDER / f"{order}-{dtype[1:]}.npy", PICTURE.astype(dtype))
    np.save(FOLDER / "fortran.npy", np.asfortranarray(PICTURE.astype("<f4")))
    for version in 2, 3:
        with open(FOLDER / f"version-{version}.npy", "wb") as file:
            np.lib.format.write_array(file, PICTURE.astype("<f4"), version=(version, 0))
    np.save(FOLDER / "grey.npy", PICTURE[..., 0].astype("<f4"))
    np.save(FOLDER / "grey-axis.npy", PICTURE[..., :1].astype("<f4"))
    opacity = np.full((HEIGHT, WIDTH, 1), 0.5)
    np.save(FOLDER / "opacity.npy", np.concatenate([PICTURE, opacity], axis=-1).astype("<f4"))
    np.save(FOLDER / "bad-uint8.npy", PICTURE.astype("u1"))
    np.save(FOLDER / "bad-int64.npy", PICTURE)
    np.save(FOLDER / "bad-complex.npy", PICTURE.astype("<c8"))
    np.save(FOLDER / "bad-planes.npy", np.moveaxis(PICTURE, -1, 0).astype("<f4"))
    np.save(FOLDER / "bad-stack.npy", PICTURE[None].astype("<f4"))
    np.save(FOLDER / "bad-line.npy", np.zeros(12, "<f4"))
    np.save(FOLDER / "bad-records.npy", np.zeros((2, 2), [("r", "<f4"), ("g", "<f4")]))
    np.save(FOLDER / "bad-objects.npy", np.array([[None, "x"]], dtype=object), allow_pickle=True)


def write_pfm():
    for name, order, scale in ("little", "<", -1.0), ("big", ">", 1.0), ("scaled", "<", -2.0):
        floats = (PICTURE[::-1] / abs(scale)).astype(f"{order}f4").tobytes()
        text = f"PF\n{WIDTH} {HEIGHT}\n{scale}\n"
        (FOLDER / f"{name}.pfm").write_bytes(text.encode() + floats)
    grey = PICTURE[::-1, :, 0].astype("<f4").tobytes()
    (FOLDER / "grey.pfm").write_bytes(f"Pf\n{WIDTH} {HEIGHT}\n-1\n".encode() + grey)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def rows(picture):
    """Rows of samples, each with filter 0."""
    if 0 in picture.shape:
        return b""
    return b"".join(b"\0" + np.ascontiguousarray(row).tobytes() for row in picture)


def png(name, picture, colour, bits=8, before=(), after=(), interlaced=False):
    data = rows(picture)
    if interlaced:
        # Adam7: first column and row, then steps, of each pass.
        passes = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4),
                  (1, 0, 2, 2), (0, 1, 1, 2)]
        data = b"".join(rows(picture[v::dv, u::du]) for u, v, du, dv in passes)
    head = struct.pack(">IIBBBBB", WIDTH, HEIGHT, bits, colour, 0, 0, int(interlaced))
    chunks = [(b"IHDR", head), *before, (b"IDAT", zlib.compress(data)), *after, (b"IEND", b"")]
    signature = b"\x89PNG\r\n\x1a\n"
    (FOLDER / name).write_bytes(signature + b"".join(chunk(*c) for c in chunks))


def profile(name):
    """An ICC profile with nothing but a name."""
    text = name.encode() + b"\0"
    desc = b"desc" + bytes(4) + struct.pack(">I", len(text)) + text
    body = struct.pack(">I4sII", 1, b"desc", 144, len(desc)) + desc
    head = struct.pack(">I", 128 + len(body)) + b"test" + bytes.fromhex("04300000")
    head += b"mntrRGB XYZ " + bytes(12) + b"acsp"
    return head.ljust(128, b"\0") + body


def icc(name):
    return b"iCCP", b"profile\0\0" + zlib.compress(profile(name))


def write_png():
    grey, rgb, palette, grey_alpha, rgba = 0, 2, 3, 4, 6
    codes = PICTURE.astype("u1")
    wide = (PICTURE * 257).astype(">u2")
    opaque = np.full((HEIGHT, WIDTH, 1), 255)
    png("rgb-8.png", codes, rgb)
    # As far from the codes as 16 bits allow without rounding to their neighbours.
    png("rgb-16.png", (PICTURE * 257 + [128, 0, -128]).astype(">u2"), rgb, 16)
    png("grey-8.png", codes[..., 0], grey)
    png("grey-16.png", wide[..., 0], grey, 16)
    png("opaque.png", np.concatenate([codes, opaque], axis=-1).astype("u1"), rgba)
    png("interlaced.png", codes, rgb, interlaced=True)
    table = b"PLTE", codes.reshape(-1, 3).tobytes()
    indices = np.arange(WIDTH * HEIGHT, dtype="u1").reshape(HEIGHT, WIDTH)
    png("palette.png", indices, palette, before=[table])
    gamma = lambda value: (b"gAMA", struct.pack(">I", value))
    png("gamma.png", codes, rgb, before=[gamma(45455)])
    # sRGB overrules the other.
    png("srgb.png", codes, rgb, before=[gamma(100000), (b"sRGB", b"\0")])
    png("profile.png", codes, rgb, before=[icc("sRGB IEC61966-2.1")])
    png("bad-gamma.png", codes, rgb, before=[gamma(100000)])
    png("bad-profile.png", codes, rgb, before=[icc("Display P3")])
    png("bad-wide.png", codes, rgb, before=[(b"cICP", bytes([9, 16, 0, 1]))])
    png("bad-linear-profile.png", codes, rgb, before=[icc("Linear sRGB")])
    holed = np.concatenate([codes, opaque], axis=-1).astype("u1")
    holed[1, 3, 3] = 254
    png("bad-alpha.png", holed, rgba)
    png("bad-grey-alpha.png", holed[..., 2:], grey_alpha)
    png("bad-palette-alpha.png", indices, palette, before=[table, (b"tRNS", b"\xff\x80")])
    frame = struct.pack(">IIIIIHHBB", 0, WIDTH, HEIGHT, 0, 0, 1, 10, 0, 0)
    animated = [(b"acTL", struct.pack(">II", 1, 0)), (b"fcTL", frame)]
    png("bad-animated.png", codes, rgb, before=animated)
    whole = (FOLDER / "rgb-8.png").read_bytes()
    at = whole.index(b"IDAT") + 20
    broken = whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :]
    (FOLDER / "bad-crc.png").write_bytes(broken)


FOLDER.mkdir(parents=True, exist_ok=True)
write_exr()
write_npy()
write_pfm()
write_png()
