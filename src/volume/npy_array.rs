//! NPY, an array of NumPy, and NPZ, a ZIP archive of them, of which one of a single array is read. The shape is
//! (z, y, x), or (x, y, z) if asked for. They state no positions: spacing and origin are options.

use super::error::{VolumeFault, refused};
use super::load_options::AxisOrder;
use super::orientation::Axes;
use super::samples::{VolumeRead, check_sizes, fill, read_grid, read_unpacked};
use super::source::VolumeSource;
use super::{Element, Endian, Lattice, Layout, LoadOptions};
use crate::files::decoder::{self, Guarded};
use crate::files::npy_header::NpyHeader;
use glam::DVec3;
use std::io::{self, Cursor, Read};
use zip::ZipArchive;
use zip::result::ZipResult;

pub(super) fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let layout = layout(&header(source)?, options)?;
    read_grid(source, &layout, &options.of_array())
}

/// Largest archive read, in bytes: 4 GiB, which are held in memory.
const MOST_BYTES: u64 = 1 << 32;

pub(super) fn read_archive(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let bytes = source.all(MOST_BYTES, "write the array as .npy")?;
    let mut archive = unzipped(|| ZipArchive::new(Cursor::new(bytes)))?;
    let count = archive.len();
    if count != 1 {
        return refused(format!(
            "the archive holds {count} arrays, and a volume is one: write it as `numpy.save(\"one.npy\", \
             numpy.load(\"a.npz\")[NAME])`"
        ));
    }
    let mut entry = Guarded(unzipped(|| archive.by_index(0))?);
    let layout = layout(&header(&mut entry)?, options)?;
    read_unpacked(&mut entry, source.length, &layout, &options.of_array())
}

/// What the decoder of archives returns; a fault also where it panics.
fn unzipped<T>(decode: impl FnOnce() -> ZipResult<T>) -> Result<T, VolumeFault> {
    let result = decoder::run(decode).map_err(|stopped| stopped.to_string());
    let result = result.and_then(|it| it.map_err(|error| error.to_string()));
    result.map_err(|error| {
        format!("no readable NPZ file: {error}; write one array by numpy.savez").into()
    })
}

/// The layout of the samples behind a header.
fn layout(header: &NpyHeader, options: &LoadOptions) -> Result<Layout, VolumeFault> {
    let (element, endian) = element(&header.descr)?;
    let order = options.axes.unwrap_or_default();
    let nodes = match (order, &header.shape[..]) {
        (AxisOrder::Zyx, &[z, y, x]) | (AxisOrder::Xyz, &[x, y, z]) => [x, y, z],
        _ => {
            return refused(format!(
                "an array of shape {:?}: a volume has the shape (z, y, x), one number at each place; save \
                 one channel, or one time, of it",
                header.shape
            ));
        }
    };
    let nodes = check_sizes(nodes.map(|count| count as u64))?;
    let spacing = options.spacing.unwrap_or(DVec3::ONE);
    let first = options.origin.unwrap_or_default();
    let upright = Axes::of(&Lattice::new(nodes, spacing, first)?);
    let axes = match header.fortran_order == (order == AxisOrder::Zyx) {
        true => upright.reversed(),
        false => upright,
    };
    Ok(Layout {
        endian,
        ..Layout::raw(element, axes)
    })
}

fn header(source: &mut impl Read) -> Result<NpyHeader, VolumeFault> {
    let mut bytes = Vec::new();
    read_up_to(NpyHeader::FIRST_BYTES, source, &mut bytes)?;
    let text = NpyHeader::text_at(&bytes).map_err(fault)?;
    read_up_to(text.end, source, &mut bytes)?;
    let (header, _) = NpyHeader::read(&bytes).map_err(fault)?;
    Ok(header)
}

/// Extends `bytes` to a number of bytes of the file, or to its end.
fn read_up_to(end: usize, source: &mut impl Read, bytes: &mut Vec<u8>) -> io::Result<()> {
    let begin = bytes.len();
    bytes.resize(end.max(begin), 0);
    let filled = fill(source, &mut bytes[begin..])?;
    bytes.truncate(begin + filled);
    Ok(())
}

fn fault(reason: String) -> VolumeFault {
    format!("not a readable NPY array: {reason}; write it by numpy.save, from an array of numbers of shape (z, y, x)")
        .into()
}

/// Type of a number, and the order of its bytes.
fn element(descr: &str) -> Result<(Element, Endian), VolumeFault> {
    let endian = match descr.starts_with('>') {
        true => Endian::Big,
        false => Endian::Little,
    };
    let kind = match descr.strip_prefix(['<', '>', '|']) {
        // False and True.
        Some("b1") => "u1",
        kind => kind.unwrap_or_default(),
    };
    let code = |(name, element): &(&str, Element)| format!("{}{}", &name[..1], element.bytes());
    let found = Element::ALL.iter().find(|element| code(element) == kind);
    let shown: String = descr.chars().take(20).collect();
    let (_, element) = found.ok_or_else(|| {
        format!("numbers of the type {shown:?}, which are not read: save array.astype(np.float32)")
    })?;
    Ok((*element, endian))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{Grid, Orientation, read_volume};

    fn read_npy(bytes: &[u8], options: &LoadOptions) -> Result<Grid<f32>, VolumeFault> {
        read_volume("grid.npy", bytes, None, options)
    }

    fn npy(descr: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let text =
            format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\0".to_vec();
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.bytes());
        bytes.extend(data);
        bytes
    }

    /// The value 50 z + 10 y + x at each place: whole numbers of one byte hold it.
    #[test]
    fn either_order_of_memory_and_every_type_is_the_same_grid() {
        let value = |x: usize, y: usize, z: usize| (50 * z + 10 * y + x) as u8;
        let mut c_order = Vec::new();
        let mut fortran = Vec::new();
        for (a, b, c) in
            (0..4).flat_map(|a| (0..3).flat_map(move |b| (0..2).map(move |c| (a, b, c))))
        {
            fortran.push(value(a, b, c));
        }
        for (a, b, c) in
            (0..2).flat_map(|a| (0..3).flat_map(move |b| (0..4).map(move |c| (a, b, c))))
        {
            c_order.push(value(c, b, a));
        }
        let options = LoadOptions {
            spacing: Some(DVec3::new(0.5, 1.0, 2.0)),
            origin: Some(DVec3::new(-1.0, 2.0, 3.0)),
            orientation: Orientation::AsStored,
            ..LoadOptions::default()
        };
        let shape = "(2, 3, 4)";
        let plain = read_npy(&npy("|u1", "False", shape, &c_order), &options).unwrap();
        assert_eq!(plain.lattice().nodes(), [4, 3, 2]);
        assert_eq!(plain.lattice().spacing(), DVec3::new(0.5, 1.0, 2.0));
        assert_eq!(plain.lattice().first(), DVec3::new(-1.0, 2.0, 3.0));
        assert_eq!(plain.values()[..5], [0.0, 1.0, 2.0, 3.0, 10.0]);
        let turned = read_npy(&npy("|u1", "True", shape, &fortran), &options).unwrap();
        assert_eq!(turned, plain);
        macro_rules! as_type {
            ($descr:literal, $type:ty, $bytes:ident) => {
                let data = c_order.iter().flat_map(|&v| <$type>::from(v).$bytes());
                let data: Vec<u8> = data.collect();
                let other = read_npy(&npy($descr, "False", shape, &data), &options).unwrap();
                assert_eq!(other, plain, $descr);
            };
        }
        as_type!("<i2", i16, to_le_bytes);
        as_type!(">u2", u16, to_be_bytes);
        as_type!("<i4", i32, to_le_bytes);
        as_type!(">u4", u32, to_be_bytes);
        as_type!("<i8", i64, to_le_bytes);
        as_type!("<u8", u64, to_le_bytes);
        as_type!("<f2", half::f16, to_le_bytes);
        as_type!(">f4", f32, to_be_bytes);
        as_type!("<f8", f64, to_le_bytes);
    }

    #[test]
    fn what_is_no_volume_is_refused_with_a_remedy() {
        let read = |bytes: &[u8]| {
            read_npy(bytes, &LoadOptions::default())
                .unwrap_err()
                .to_string()
        };
        for (descr, shape, data, expected) in [
            ("<c8", "(1, 1, 1)", 8, "numbers of the type \"<c8\""),
            ("|O", "(1, 1, 1)", 8, "numbers of the type \"|O\""),
            (
                "<f4",
                "(1, 1)",
                4,
                "an array of shape [1, 1]: a volume has the shape (z, y, x)",
            ),
            ("<f4", "(1, 1, 1, 3)", 12, "an array of shape [1, 1, 1, 3]"),
            ("<f4", "(0, 1, 1)", 0, "has no node"),
            ("<f4", "(99999, 99999, 99999)", 4, "is too large"),
            ("<f4", "(1, 2, 1)", 4, "8 bytes, but 4 bytes follow it"),
            ("<f4", "(1, 2, 1)", 9, "8 bytes, but 9 bytes follow it"),
        ] {
            let message = read(&npy(descr, "False", shape, &vec![0; data]));
            assert!(message.contains(expected), "{message}");
        }
        let whole = npy("|u1", "False", "(1, 1, 1)", &[0]);
        for length in 0..whole.len() - 1 {
            let message = read(&whole[..length]);
            assert!(message.contains("NPY"), "{length}: {message}");
        }
    }
}
