//! Checks that an EXR holds everything that its header declares. The `exr` crate does not: it
//! accepts the corners of a window in any order, reads only the largest of several resolutions, and
//! leaves zeros if two entries of the offset table point to the same block.

use super::FilmError;
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
    let reason = match error.to_string().as_str() {
        // The words of the crate for the end of a file before the end of the image.
        "invalid: reference to missing bytes" => "the file ends too early".to_owned(),
        "invalid: file identifier missing" => {
            "it does not begin with the signature of the format".to_owned()
        }
        other => other.to_owned(),
    };
    FilmError::unreadable("EXR", reason)
}

/// Fails if a window of any part ends before it begins.
///
/// Source: <https://openexr.com/en/latest/OpenEXRFileLayout.html>, header: name, type and size of
/// each attribute, then its value; an empty name ends the header.
pub(super) fn check_windows(bytes: &[u8]) -> Result<(), FilmError> {
    /// Magic number and version.
    const PREAMBLE: usize = 8;
    let mut rest = bytes.get(PREAMBLE..).unwrap_or_default();
    // Of several headers, an empty one is the last.
    while rest.first().is_some_and(|&byte| byte != 0) {
        while let Some((name, value, after)) = attribute(rest) {
            if WINDOWS.contains(&name) {
                check_window(name, value)?;
            }
            rest = after;
        }
        rest = rest.get(1..).unwrap_or_default();
    }
    Ok(())
}

/// Name and value of the first attribute in `bytes`, and the rest.
fn attribute(bytes: &[u8]) -> Option<(&[u8], &[u8], &[u8])> {
    let (name, rest) = text(bytes)?;
    let (_type, rest) = text(rest)?;
    let (size, rest) = rest.split_first_chunk()?;
    let size = usize::try_from(i32::from_le_bytes(*size)).ok()?;
    let (value, rest) = rest.split_at_checked(size)?;
    Some((name, value, rest))
}

/// A non-empty text up to its terminating zero, and the rest.
fn text(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = bytes.iter().position(|&byte| byte == 0)?;
    (end > 0).then(|| (&bytes[..end], &bytes[end + 1..]))
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
    let whole = |tile: &TileCoordinates| tile.level_index == Vec2(0, 0);
    check_blocks_of(bytes, &|_| true)?;
    check_blocks_of(bytes, &whole)
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
