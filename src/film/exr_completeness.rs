//! Checks that an EXR holds everything that its header declares. The `exr` crate does not: it
//! accepts the corners of a window in any order, drops attributes it cannot read, reads only the largest
//! of several resolutions, and leaves zeros if two entries of the offset table point to the same block.

use super::FilmError;
use super::exr_meaning::check_compression;
use exr::block::chunk::{CompressedBlock, TileCoordinates};
use exr::block::reader::ChunksReader;
use exr::math::Vec2;
use exr::meta::header::Header;
use std::collections::HashSet;
use std::io::Cursor;

/// Attributes of a header that are windows.
const WINDOWS: [&[u8]; 2] = [b"displayWindow", b"dataWindow"];

/// The error for a file that the `exr` crate refuses.
pub(super) fn unreadable(error: exr::error::Error) -> FilmError {
    use exr::error::Error;
    let reason = match error {
        // The words of the crate for the end of a file before the end of the image.
        Error::Invalid(words) if words == "reference to missing bytes" => {
            "the file ends too early".to_owned()
        }
        Error::Invalid(words) if words == "file identifier missing" => {
            "it does not begin with the signature of the format".to_owned()
        }
        Error::Invalid(words) => {
            format!("it is broken (\"{words}\"): write it again; exrcheck finds more faults")
        }
        Error::NotSupported(words) => {
            return FilmError::unsuited(
                format!(
                    "this EXR has something unknown to volref (\"{words}\"), though it may be right"
                ),
                "look at it with exrheader, and save it as a plain image: oiiotool in.exr --compression zip -o \
                 out.exr",
            );
        }
        other => other.to_string(),
    };
    FilmError::unreadable("EXR", reason)
}

/// Bytes before the first header: magic number, version and flags.
const PREAMBLE: usize = 8;
/// The byte of the preamble with the flags, and that of several parts.
const FLAGS: usize = 5;
const SEVERAL_PARTS: u8 = 1 << 4;

/// Bytes of the value of `chromaticities`.
const CHROMATICITIES: usize = 32;

/// Fails if a header of any part has a window that ends before it begins, a compression that is not
/// read, or an attribute that says what pixels are and cannot be read.
///
/// Source: <https://openexr.com/en/latest/OpenEXRFileLayout.html>, header: name, type and size of
/// each attribute, then its value; an empty name ends the header, another one those of several parts.
pub(super) fn check_headers(bytes: &[u8]) -> Result<(), FilmError> {
    let Some((preamble, mut rest)) = bytes.split_at_checked(PREAMBLE) else {
        return Ok(());
    };
    let has_several_parts = preamble[FLAGS] & SEVERAL_PARTS != 0;
    loop {
        while let Some((name, value, after)) = attribute(rest) {
            if WINDOWS.contains(&name) {
                check_window(name, value)?;
            }
            match (name, value) {
                (b"compression", &[number]) => check_compression(number)?,
                (b"chromaticities", value) if value.len() != CHROMATICITIES => {
                    let reason = format!(
                        "its chromaticities have {} bytes, not {CHROMATICITIES}",
                        value.len()
                    );
                    return Err(FilmError::unreadable("EXR", reason));
                }
                _ => {}
            }
            rest = after;
        }
        // Anything but the header of a further part is left to the crate.
        match rest {
            [0, next, ..] if has_several_parts && *next != 0 => rest = &rest[1..],
            _ => return Ok(()),
        }
    }
}

/// The name and the value of the first attribute in `bytes`, and the bytes behind it; none if there is no whole one.
fn attribute(bytes: &[u8]) -> Option<(&[u8], &[u8], &[u8])> {
    let word = |bytes: &'_ [u8]| {
        bytes
            .iter()
            .position(|&byte| byte == 0)
            .filter(|&end| end > 0)
    };
    let (name, rest) = bytes.split_at(word(bytes)?);
    let (_type, rest) = rest[1..].split_at(word(&rest[1..])?);
    let (size, rest) = rest[1..].split_first_chunk()?;
    let size = usize::try_from(i32::from_le_bytes(*size)).ok()?;
    let (value, rest) = rest.split_at_checked(size)?;
    Some((name, value, rest))
}

fn check_window(name: &[u8], value: &[u8]) -> Result<(), FilmError> {
    let (numbers, _) = value.as_chunks::<4>();
    let &[left, top, right, bottom] = numbers else {
        return Ok(());
    };
    let [left, top, right, bottom] = [left, top, right, bottom].map(i32::from_le_bytes);
    if left <= right && top <= bottom {
        return Ok(());
    }
    Err(FilmError::unreadable(
        "EXR",
        format!(
            "its {} is empty: from ({left}, {top}) to ({right}, {bottom})",
            String::from_utf8_lossy(name)
        ),
    ))
}

/// Fails if a block of pixels of any part and resolution is missing, or if the offset table points
/// to a block of another resolution. Nothing is decompressed.
pub(super) fn check_blocks(bytes: &[u8]) -> Result<(), FilmError> {
    // Two walks: the reader gives blocks without the entry of the table that led to them, so that
    // entries exchanged between two resolutions show only where those of the largest, the only ones
    // that the decoder follows, are followed by themselves.
    check_blocks_of(bytes, &|_| true)?;
    check_blocks_of(bytes, &|tile| tile.level_index == Vec2(0, 0))
}

/// As [`check_blocks`], for the blocks with the indices `wanted`.
fn check_blocks_of(
    bytes: &[u8],
    wanted: &dyn Fn(&TileCoordinates) -> bool,
) -> Result<(), FilmError> {
    // The table of blocks is in the file, so that it bounds how many there can be.
    let mut blocks = exr::block::read(Cursor::new(bytes), false)
        .and_then(|reader| reader.filter_chunks(false, |_, tile, _| wanted(&tile)))
        .map_err(unreadable)?;
    let mut missing = HashSet::new();
    for (part, header) in blocks.headers().iter().enumerate() {
        let tiles = header.blocks_increasing_y_order();
        let tiles = tiles.map(|tile| tile.location).filter(wanted);
        missing.extend(tiles.map(|tile| (part, tile)));
    }
    let expected = missing.len();
    while let Some(block) = blocks.read_next_chunk() {
        let block = block.map_err(unreadable)?;
        let header = &blocks.headers()[block.layer_index];
        if let Some(tile) = tile(&block.compressed_block, header) {
            missing.remove(&(block.layer_index, tile));
        }
    }
    if missing.is_empty() {
        return Ok(());
    }
    Err(FilmError::unreadable(
        "EXR",
        format!(
            "of its {expected} blocks of pixels, {} are missing",
            missing.len()
        ),
    ))
}

/// Index of the block in its part.
fn tile(block: &CompressedBlock, header: &Header) -> Option<TileCoordinates> {
    match block {
        CompressedBlock::Tile(tile) => Some(tile.coordinates),
        CompressedBlock::ScanLine(lines) => {
            let first = i64::from(header.own_attributes.layer_position.y());
            let row = usize::try_from(i64::from(lines.y_coordinate) - first).ok()?;
            let rows = header.compression.scan_lines_per_block();
            (row % rows == 0).then(|| TileCoordinates {
                tile_index: Vec2(0, row / rows),
                level_index: Vec2(0, 0),
            })
        }
        CompressedBlock::DeepScanLine(_) | CompressedBlock::DeepTile(_) => None,
    }
}
