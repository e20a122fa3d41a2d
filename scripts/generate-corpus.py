#!/usr/bin/env python3
"""Writes small images to begin fuzzing with, into fuzz/corpus, and broken ones that must be refused,
bad-*, into fixtures/images.

They are of the kinds that renderers seldom write: palettes of few colours, interlaced and 16-bit
PNG; EXR in tiles, of several resolutions and several parts. The picture has 5 × 3 pixels. Needs
Python 3 alone: what is to be broken has to be written by hand.
"""

import pathlib
import struct
import zlib

ROOT = pathlib.Path(__file__).parent.parent
CORPUS = ROOT / "fuzz" / "corpus"
IMAGES = ROOT / "fixtures" / "images"
WIDTH, HEIGHT = 5, 3

# PNG: colour types, and the first column and row and the steps of each pass of Adam7.
GREY, RGB, PALETTE, GREY_ALPHA, RGBA = 0, 2, 3, 4, 6
PASSES = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2),
          (0, 1, 1, 2)]


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def packed(samples, bits):
    """Samples of a row, the leftmost in the highest bits."""
    number, count = 0, 0
    for sample in samples:
        number, count = number << bits | sample, count + bits
    padding = -count % 8
    return (number << padding).to_bytes((count + padding) // 8, "big")


def png(path, pixel, colour, bits=8, before=(), interlaced=False):
    """`pixel(x, y)` are the samples of a pixel."""
    data = b""
    for left, top, across, down in PASSES if interlaced else [(0, 0, 1, 1)]:
        columns = range(left, WIDTH, across)
        for y in range(top, HEIGHT, down) if columns else []:
            data += b"\0" + packed([sample for x in columns for sample in pixel(x, y)], bits)
    head = struct.pack(">IIBBBBB", WIDTH, HEIGHT, bits, colour, 0, 0, int(interlaced))
    chunks = [(b"IHDR", head), *before, (b"IDAT", zlib.compress(data)), (b"IEND", b"")]
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(chunk(*c) for c in chunks))


def colours(count):
    return b"PLTE", bytes(value for i in range(count) for value in (10 * i, 200 - i, 7 * i % 256))


def write_png():
    folder = CORPUS / "png"
    for bits in 1, 2, 4, 8:
        most = min(2**bits, 16)
        index = lambda x, y: [(x + WIDTH * y) % most]
        png(folder / f"palette-{bits}.png", index, PALETTE, bits, [colours(most)])
        name = folder / f"palette-{bits}-interlaced.png"
        png(name, index, PALETTE, bits, [colours(most)], interlaced=True)
        png(folder / f"grey-{bits}.png", index, GREY, bits)
    index = lambda x, y: [x + WIDTH * y]
    png(folder / "palette-opaque.png", index, PALETTE, 8, [colours(15), (b"tRNS", b"\xff" * 15)])
    wide = lambda x, y: [4000 * x, 65535 - 9000 * y, 257]
    png(folder / "rgb-16-interlaced.png", wide, RGB, 16, interlaced=True)
    png(folder / "grey-alpha-16.png", lambda x, y: [4000 * x, 65535], GREY_ALPHA, 16)
    png(folder / "rgba-interlaced.png", lambda x, y: [x, y, 9, 255], RGBA, interlaced=True)

    kind, table = colours(15)
    png(IMAGES / "bad-palette-length.png", index, PALETTE, 8, [(kind, table[:-1])])


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def box(left, top, right, bottom):
    return struct.pack("<4i", left, top, right, bottom)


WHOLE = box(0, 0, WIDTH - 1, HEIGHT - 1)
HALF, FLOAT = 1, 2
NONE, ZIPS = 0, 2


def exr_header(kind, data=WHOLE, display=WHOLE, compression=NONE, pixels=HALF, tiles=None,
               name=None, chunks=None):
    """Names of attributes are in the order in which OpenEXR writes them."""
    channels = b"".join(letter + b"\0" + struct.pack("<iiii", pixels, 0, 1, 1) for letter in
                        (b"B", b"G", b"R")) + b"\0"
    text = attribute("channels", "chlist", channels)
    if chunks is not None:
        text += attribute("chunkCount", "int", struct.pack("<i", chunks))
    text += attribute("compression", "compression", bytes([compression]))
    text += attribute("dataWindow", "box2i", data) + attribute("displayWindow", "box2i", display)
    text += attribute("lineOrder", "lineOrder", b"\0")
    if name is not None:
        text += attribute("name", "string", name.encode())
    text += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    text += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    text += attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    if tiles is not None:
        text += attribute("tiles", "tiledesc", struct.pack("<IIB", *tiles))
    if kind is not None:
        text += attribute("type", "string", kind.encode())
    return text + b"\0"


def samples(columns, rows, pixels=HALF):
    """All channels of a row, one after another, for each row."""
    letter = "e" if pixels == HALF else "f"
    values = [x + 8 * y + 64 * c for y in rows for c in (2, 1, 0) for x in columns]
    return struct.pack(f"<{len(values)}{letter}", *values)


def zipped(data):
    """Low and high bytes apart, differences of neighbours, deflated."""
    apart = data[0::2] + data[1::2]
    steps = apart[:1] + bytes((b - a + 128) % 256 for a, b in zip(apart, apart[1:]))
    # What does not shrink is stored as it is.
    return min(data, zlib.compress(steps), key=len)


def exr(path, flags, headers, chunks, several=False, offset_of=lambda i: i):
    """`offset_of(i)` is the chunk that entry i of the table of chunks leads to."""
    head = b"\x76\x2f\x31\x01" + struct.pack("<I", 2 | flags) + b"".join(headers)
    head += b"\0" if several else b""
    places = [len(head) + 8 * len(chunks)]
    for data in chunks:
        places.append(places[-1] + len(data))
    table = [struct.pack("<Q", places[offset_of(i)]) for i in range(len(chunks))]
    path.write_bytes(head + b"".join(table) + b"".join(chunks))


def lines(y, data, part=None):
    head = b"" if part is None else struct.pack("<i", part)
    return head + struct.pack("<ii", y, len(data)) + data


def tile(x, y, level, data, part=None):
    head = b"" if part is None else struct.pack("<i", part)
    return head + struct.pack("<5i", x, y, *level, len(data)) + data


TILED, SEVERAL = 0x200, 0x1000
SIDE = 2
ONE_LEVEL, MIPS, RIPS = 0, 1, 2


def all_tiles(levels, part=None):
    """The tiles of these levels, each a pair of halvings."""
    found = []
    for level in levels:
        width, height = (max(1, size >> step) for size, step in zip((WIDTH, HEIGHT), level))
        for y in range(0, height, SIDE):
            for x in range(0, width, SIDE):
                columns, rows = range(x, min(x + SIDE, width)), range(y, min(y + SIDE, height))
                found.append(tile(x // SIDE, y // SIDE, level, samples(columns, rows), part))
    return found


def write_exr():
    folder = CORPUS / "exr"
    rows = [samples(range(WIDTH), [y]) for y in range(HEIGHT)]
    scan_lines = [lines(y, row) for y, row in enumerate(rows)]
    exr(folder / "lines.exr", 0, [exr_header(None)], scan_lines)
    packed_lines = [lines(y, zipped(row)) for y, row in enumerate(rows)]
    exr(folder / "zips.exr", 0, [exr_header(None, compression=ZIPS)], packed_lines)
    single = [(0, 0)]
    mips = [(i, i) for i in range(3)]
    rips = [(i, j) for j in range(2) for i in range(3)]
    for name, mode, levels in (("tiles", ONE_LEVEL, single), ("mips", MIPS, mips),
                               ("rips", RIPS, rips)):
        header = exr_header("tiledimage", tiles=(SIDE, SIDE, mode))
        exr(folder / f"{name}.exr", TILED, [header], all_tiles(levels))
    parts = [("scanlineimage", None, [lines(y, row, 0) for y, row in enumerate(rows)]),
             ("tiledimage", (SIDE, SIDE, ONE_LEVEL), all_tiles(single, 1))]
    headers = [exr_header(kind, tiles=tiles, name=name, chunks=len(chunks))
               for (kind, tiles, chunks), name in zip(parts, ("beauty", "albedo"))]
    chunks = [c for _, _, chunks in parts for c in chunks]
    exr(folder / "parts-and-tiles.exr", SEVERAL, headers, chunks, several=True)

    header = exr_header("tiledimage", tiles=(SIDE, SIDE, ONE_LEVEL))
    twice = lambda i: 0 if i == 1 else i
    exr(IMAGES / "bad-tile-missing.exr", TILED, [header], all_tiles(single), offset_of=twice)
    exr(IMAGES / "bad-lines-missing.exr", 0, [exr_header(None)], scan_lines, offset_of=twice)
    # A tile of another resolution than its place in the table says: the `exr` crate panics.
    header = exr_header("tiledimage", tiles=(SIDE, SIDE, MIPS))
    swapped = lambda i: {0: 6, 6: 0}.get(i, i)
    exr(IMAGES / "bad-levels-swapped.exr", TILED, [header], all_tiles(mips), offset_of=swapped)
    # More pixels than any memory, in a file of some hundred bytes.
    huge = box(0, 0, 999_999_999, 999_999_999)
    exr(IMAGES / "bad-huge.exr", 0, [exr_header(None, data=huge, display=huge)], scan_lines)


write_png()
write_exr()
