//! Checks that an EXR holds every block of pixels that its header declares. The `exr` crate does not: it
//! leaves zeros if two entries of the offset table point to the same block.

use super::FilmError;
use exr::block::chunk::{CompressedBlock, TileCoordinates};
use exr::block::reader::ChunksReader;
use exr::error::Error;
use exr::math::Vec2;
use exr::meta::header::Header;
use std::collections::HashSet;
use std::io::Cursor;

/// The error for a file that the `exr` crate refuses.
pub(super) fn unreadable(error: Error) -> FilmError {
    match error {
        // The words of the crate for the end of a file before the end of the image.
        Error::Invalid(words) if words == "reference to missing bytes" => {
            FilmError::unreadable("EXR", "the file ends too early")
        }
        Error::NotSupported(words) => FilmError::unsuited(
            format!(
                "this EXR has something unknown to volref (\"{words}\"), though it may be right"
            ),
            "save it as a plain image: oiiotool in.exr --compression zip -o out.exr",
        ),
        other => FilmError::unreadable("EXR", format!("it is broken ({other}): write it again")),
    }
}

/// Fails if a block of pixels of any part and resolution is missing. Nothing is decompressed.
pub(super) fn check_blocks(bytes: &[u8]) -> Result<(), FilmError> {
    // The table of blocks is in the file, so that it bounds how many there can be.
    let mut blocks = exr::block::read(Cursor::new(bytes), false)
        .and_then(|reader| reader.filter_chunks(false, |_, _, _| true))
        .map_err(unreadable)?;
    let mut missing = HashSet::new();
    for (part, header) in blocks.headers().iter().enumerate() {
        let tiles = header.blocks_increasing_y_order();
        missing.extend(tiles.map(|tile| (part, tile.location)));
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
    let missing = missing.len();
    let reason = format!("of its {expected} blocks of pixels, {missing} are missing");
    Err(FilmError::unreadable("EXR", reason))
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
