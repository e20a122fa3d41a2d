//! One recogniser of what a file is, by its name and its first bytes, where it is not what was expected.

use std::path::Path;

/// Bytes at the beginning of a file that tell its kind.
pub const HEAD: usize = 512;

/// A kind of file.
pub struct FileKind {
    /// Its name, with an article.
    pub name: &'static str,
    /// Endings of its files, in small letters.
    pub endings: &'static [&'static str],
    /// Beginnings of its files, of which one is there.
    marks: &'static [Mark],
    /// Remedy for a volume in such a file, if it is not read as it is.
    pub as_volume: Option<&'static str>,
}

/// Bytes by which a kind is known.
enum Mark {
    /// These, from this byte on.
    At(usize, &'static [u8]),
    /// These words, in small or capital letters, within the [`HEAD`] of a text that begins with `<`.
    Markup(&'static str),
}

impl Mark {
    fn is_in(&self, first: &[u8]) -> bool {
        match *self {
            Mark::At(offset, bytes) => first.get(offset..).is_some_and(|it| it.starts_with(bytes)),
            Mark::Markup(words) => {
                let text = first.strip_prefix(b"\xef\xbb\xbf").unwrap_or(first);
                let text = text.trim_ascii_start();
                let mut windows = text.windows(words.len());
                text.starts_with(b"<")
                    && windows.any(|it| it.eq_ignore_ascii_case(words.as_bytes()))
            }
        }
    }
}

/// Remedy for formats of scanners and of medical software.
const CONVERT: &str = "write the volume as one .nii or .nrrd, as by `nibabel.save` or \
                       `SimpleITK.WriteImage`";

/// Remedy for the format of scanners, a slice a file.
pub const OF_SLICES: &str = "the slices of a folder become one file by `dcm2niix FOLDER`, or in Python by \
                      `SimpleITK.ReadImage(SimpleITK.ImageSeriesReader.GetGDCMSeriesFileNames(\"FOLDER\"))` \
                      and `SimpleITK.WriteImage`";

/// Remedy for compressed files.
const UNPACK: &str = "unpack the file, as by `gunzip`";

/// Remedy for point clouds.
const POINTS: &str = "write the points to an .obj, each as a line `v x y z`";

const VTK: &str = "in Python, values at points become an array by `grid = pyvista.read(\"a.vti\")` and \
                   `numpy.save(\"a.npy\", grid.point_data[NAME].reshape(grid.dimensions[::-1]))`; `spacing` \
                   and `origin` beside `file` in the scene are those of `grid`";

const VDB: &str = "in Python, a grid becomes an array by `grid = openvdb.read(\"a.vdb\", NAME)`, \
                   `grid.copyToArray(array, ijk=FIRST)` and `numpy.save(\"a.npy\", array)`; it has the order \
                   `axes = \"xyz\"`";

const TIFF: &str = "in Python, `numpy.save(\"a.npy\", tifffile.imread(\"a.tif\"))`";

const HDF5: &str = "in Python, `numpy.save(\"a.npy\", h5py.File(\"a.h5\")[NAME][:])`";

/// Kinds of files, one a row: name, endings, marks, and the remedy where a volume is not read from it.
macro_rules! kinds {
    ($($name:literal, $endings:expr, $marks:expr, $as_volume:expr;)+) => {
        [$(FileKind { name: $name, endings: &$endings, marks: &$marks, as_volume: $as_volume },)+]
    };
}

use Mark::{At, Markup};

/// Files that stand in place of the content, each with the remedy: no reader is meant to see them.
const STAND_INS: [FileKind; 3] = kinds! {
    "a pointer of Git LFS", [], [At(0, b"version https://git-lfs.github.com/spec/")],
        Some("run `git lfs pull` (in GitHub Actions: `lfs: true`)");
    "a web page", [".html", ".htm"], [Markup("<!doctype html"), Markup("<html")], Some(DOWNLOAD);
    "the message of a server of files", [], [Markup("<error><code>")], Some(DOWNLOAD);
};

const DOWNLOAD: &str = "download the file again, signed in where its server asks for it";

/// Kinds of files, those that are read as volumes or images among them.
const KINDS: [FileKind; 31] = kinds! {
    "an EXR image", [".exr"], [At(0, b"\x76\x2f\x31\x01")], None;
    "a PFM image", [".pfm"], [At(0, b"PF\n"), At(0, b"Pf\n")], None;
    "a NumPy array", [".npy"], [At(0, b"\x93NUMPY")], None;
    "a PNG image", [".png"], [At(0, b"\x89PNG\r\n\x1a\n")], None;
    "a JPEG image", [".jpg", ".jpeg"], [At(0, b"\xff\xd8\xff")], None;
    "a TIFF image", [".tif", ".tiff"], [At(0, b"II*\0"), At(0, b"MM\0*"), At(0, b"II+\0"), At(0, b"MM\0+")], Some(TIFF);
    "a Radiance HDR image", [], [At(0, b"#?RADIANCE")], None;
    "a GIF image", [".gif"], [At(0, b"GIF8")], None;
    "a PPM image", [".ppm"], [At(0, b"P6")], None;
    "a ZIP archive (as .npz is)", [".npz"], [At(0, b"PK\x03\x04")], None;
    "an NRRD file packed once more", [".nrrd.gz"], [],
        Some("unpack the file, as by `gunzip`; the format compresses by `encoding: gzip`");
    "raw samples, compressed", [".raw.gz"], [],
        Some("describe the samples by a .toml with the keys `file`, `type`, `endian`, `nodes`, and \
             `encoding = \"gzip\"`");
    "a FreeSurfer volume", [".mgz", ".mgh"], [],
        Some("in Python, `nibabel.save(nibabel.Nifti1Image.from_image(nibabel.load(\"a.mgz\")), \
             \"a.nii\")`");
    "a file compressed by gzip", [".nii.gz", ".obj.gz", ".vol.gz"], [At(0, b"\x1f\x8b\x08")], Some(UNPACK);
    "an NRRD file", [".nrrd", ".nhdr"], [At(0, b"NRRD000")], None;
    "a NIfTI-1 file", [".nii"], [At(344, b"n+1\0")], None;
    "a Mitsuba volume", [".vol"], [At(0, b"VOL\x03")], None;
    "a MetaImage", [".mha", ".mhd"], [At(0, b"ObjectType"), At(0, b"NDims")], None;
    "an Analyze image", [".hdr", ".img"], [], Some(CONVERT);
    "a DICOM file", [".dcm", ".ima"], [At(128, b"DICM")], Some(OF_SLICES);
    "a VTK file", [".vti", ".vtk", ".vtr", ".vts", ".vtu"], [At(0, b"# vtk DataFile"), Markup("<vtkfile")], Some(VTK);
    "an OpenVDB file", [".vdb"], [At(0, b" BDV")], Some(VDB);
    "a NanoVDB file", [".nvdb"], [At(0, b"NanoVDB")],
        Some("`nanovdb_convert a.nvdb a.vdb` writes an OpenVDB file, whose grids `openvdb` reads in Python");
    "an MRC file", [".mrc", ".rec", ".map"], [At(208, b"MAP ")],
        Some("in Python, `numpy.save(\"a.npy\", mrcfile.read(\"a.mrc\"))`; `spacing` beside `file` in the \
             scene is its `voxel_size`");
    "an HDF5 file", [".h5", ".hdf5", ".hdf"], [At(0, b"\x89HDF\r\n\x1a\n")], Some(HDF5);
    "raw samples", [".raw"], [],
        Some("describe the samples by a .toml with the keys `file`, `type`, `endian` and `nodes`");
    "a list of points", [".xyz"], [], Some(POINTS);
    "a PLY file", [".ply"], [At(0, b"ply\n"), At(0, b"ply\r")], Some(POINTS);
    "a PCD file", [".pcd"], [At(0, b"# .PCD")], Some(POINTS);
    "a mesh of glTF", [".glb"], [At(0, b"glTF")], None;
    "a PDF document", [".pdf"], [At(0, b"%PDF")], None;
};

/// If a file that begins with `first` holds something in place of its content: what it is, and the remedy.
pub fn stand_in(first: &[u8]) -> Option<String> {
    let kind = known(&STAND_INS, first)?;
    let remedy = kind.as_volume.unwrap_or_default();
    Some(format!("this is {}, not the file: {remedy}", kind.name))
}

/// The kind of a file that begins with `first`.
pub fn by_bytes(first: &[u8]) -> Option<&'static FileKind> {
    known(&KINDS, first)
}

fn known(kinds: &'static [FileKind], first: &[u8]) -> Option<&'static FileKind> {
    let first = &first[..first.len().min(HEAD)];
    let is_it = |kind: &&FileKind| kind.marks.iter().any(|mark| mark.is_in(first));
    kinds.iter().find(is_it)
}

/// The kind of a file at `path`, by its name.
pub fn by_name(path: &Path) -> Option<&'static FileKind> {
    KINDS.iter().find(|kind| kind.is_name(path))
}

impl FileKind {
    /// True if the name of the file at `path` is that of this kind.
    pub fn is_name(&self, path: &Path) -> bool {
        self.endings.iter().any(|ending| ends_in(path, ending))
    }
}

/// The name of the file at `path` ends in `ending`, in capitals or not, after at least one other
/// letter.
pub fn ends_in(path: &Path, ending: &str) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.to_ascii_lowercase();
    name.len() > ending.len() && name.ends_with(ending)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_in_place_of_a_file() {
        let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
        assert_eq!(
            stand_in(pointer).unwrap(),
            "this is a pointer of Git LFS, not the file: run `git lfs pull` (in GitHub Actions: \
             `lfs: true`)"
        );
        for page in [
            "<!DOCTYPE html><html><head>",
            "\u{feff}\n <!doctype HTML>",
            "<HTML lang=\"en\">",
            "<?xml version=\"1.0\"?>\n<!DOCTYPE html PUBLIC>",
            "<!-- saved --><html>",
            "<?xml version='1.0' encoding='UTF-8'?><Error><Code>AccessDenied</Code>",
        ] {
            let told = stand_in(page.as_bytes()).expect(page);
            assert!(told.contains("download the file again"), "{told}");
        }
        let scenes: [&[u8]; 6] = [
            b"<?xml version=\"1.0\"?><scene version=\"3.0.0\">",
            b"<medium type=\"procedural\"/>",
            b"# <html> in a comment",
            b"version = 1",
            b"<",
            b"",
        ];
        for scene in scenes {
            assert_eq!(stand_in(scene), None);
        }
    }

    /// Each is found, so that no row stands before it that takes its files.
    #[test]
    fn every_kind_is_known_by_its_marks_and_endings() {
        for kind in &KINDS {
            for mark in kind.marks {
                let bytes = match mark {
                    At(offset, bytes) => [&vec![0; *offset], *bytes].concat(),
                    Markup(words) => format!("<?xml?>\n{words} ").into_bytes(),
                };
                assert_eq!(by_bytes(&bytes).unwrap().name, kind.name);
            }
            for ending in kind.endings {
                let path = format!("A{}", ending.to_ascii_uppercase());
                assert_eq!(by_name(Path::new(&path)).unwrap().name, kind.name);
            }
        }
    }
}
