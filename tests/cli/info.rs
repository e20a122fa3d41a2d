//! `volref info`.

use crate::folder::{Folder, assert_shown};
use serde_json::json;

fn fixture(name: &str) -> Vec<u8> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/volumes/formats");
    std::fs::read(folder.join(name)).unwrap()
}

fn with(names: &[&str]) -> Folder {
    let folder = Folder::new();
    for name in names {
        folder.write(name, fixture(name));
    }
    folder
}

#[test]
fn a_grid() {
    let folder = with(&["grid.nii"]);
    assert_shown!(folder.volref("info grid.nii").shown(), @r"
    exit code 0
    --- stdout
    grid.nii: NIfTI-1

    nodes       4 × 3 × 2, 24 in total
    spacing     (0.5, 1, 2)
    first node  (-1, 2, 3)
    box         (-1, 2, 3) to (0.5, 4, 5), centred on nodes
    space       RAS+ (right, anterior, superior), by the sform
    stored      int16, big endian, raw
                value = 0.5 · stored - 10
    values      0 to 123, mean 61.5
                1 zero, 23 nonzero

    histogram, bars logarithmic
          0 to 7.688  4  ▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇
      7.688 to 15.38  4  ▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇
      15.38 to 23.06  4  ▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇
      23.06 to 30.75  0
      30.75 to 38.44  0
      38.44 to 46.12  0
      46.12 to 53.81  0
      53.81 to  61.5  0
       61.5 to 69.19  0
      69.19 to 76.88  0
      76.88 to 84.56  0
      84.56 to 92.25  0
      92.25 to 99.94  0
      99.94 to 107.6  4  ▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇
      107.6 to 115.3  4  ▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇
      115.3 to   123  4  ▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇▇
    ");
}

#[test]
fn a_header_and_its_data() {
    let folder = with(&["grid.nii", "detached.nhdr", "detached.raw"]);
    let [grid, shown] = ["info grid.nii", "info detached.nhdr"].map(|it| folder.volref(it).shown());
    let (facts, histogram) = shown.split_once("\nhistogram").unwrap();
    // The values are those of `a_grid`.
    assert_eq!(histogram, grid.split_once("\nhistogram").unwrap().1);
    assert_shown!(facts, @r"
    exit code 0
    --- stdout
    detached.nhdr: NRRD

    nodes       4 × 3 × 2, 24 in total
    spacing     (0.5, 1, 2)
    first node  (-1, 2, 3)
    box         (-1, 2, 3) to (0.5, 4, 5), centred on nodes
    stored      uint8, raw, 2 × 3 × 4 in other order
    values      0 to 123, mean 61.5
                1 zero, 23 nonzero
    data in     detached.raw
    ");
}

#[test]
fn json() {
    let folder = with(&["grid.nii", "detached.nhdr", "detached.raw"]);
    let json = folder.volref("info grid.nii --json").json();
    assert_eq!(json["schema"], json!("volref/info/1"));
    assert_eq!(json["nodes"], json!([4, 3, 2]));
    assert_eq!(json["spacing"], json!([0.5, 1.0, 2.0]));
    assert_eq!(json["max"], json!([0.5, 4.0, 5.0]));
    assert_eq!(json["stored"]["scaling"]["slope"], json!(0.5));
    assert_eq!(json["values"]["mean"], json!(61.5));
    let json = folder.volref("info detached.nhdr --json").json();
    assert_eq!(json["files"][1]["path"], json!("detached.raw"));
    let hash = blake3::hash(&fixture("detached.raw")).to_hex().to_string();
    assert_eq!(json["files"][1]["blake3"], json!(hash));
}

#[test]
fn files_that_are_no_volumes() {
    let folder = with(&["detached.nhdr"]);
    for (file, part) in [
        ("nowhere.vol", "nowhere.vol: there is no such file"),
        ("detached.nhdr", "detached.raw: there is no such file"),
        ("smoke.vdb", "smoke.vdb: unsupported file extension"),
    ] {
        folder.volref(&["info", file]).expect(2, &[part]);
    }
}

/// Each of these would be another volume than the one that was meant.
#[test]
fn volumes_whose_header_or_text_says_something_else() {
    let folder = Folder::new();
    let nrrd = |kind: &str, encoding: &str, more: &str| {
        format!(
            "NRRD0005\ntype: {kind}\ndimension: 3\nsizes: 3 2 1\nencoding: {encoding}\n{more}\n"
        )
    };
    let raw = |more: &str| nrrd("uchar", "raw", more) + "\n123456";
    let mut nifti = fixture("grid.nii");
    nifti[280..328].fill(0);
    folder.write("zero.nii", nifti);
    folder.write("colour.nrrd", raw("kinds: RGB-color domain domain"));
    folder.write("inf.nrrd", raw("spacings: 1 2 3\naxis mins: 0 inf 0"));
    folder.write("cut.nrrd", nrrd("short", "text", "") + "1 2 3\n4 5 60");
    folder.write(
        "list.nhdr",
        nrrd("uchar", "raw", "data file: LIST\na.raw\nsp ace.raw"),
    );
    folder.write(
        "text.nhdr",
        nrrd("uchar", "text", "line skip: 1\ndata file: text.txt"),
    );
    folder.write("text.txt", "six numbers\n1 2 3\n4 300 6\n");
    for row in r#"colour.nrrd | colour.nrrd:6: axis 1 is not an axis of space
inf.nrrd | inf.nrrd:7: `axis mins` must be a finite number
cut.nrrd | cut.nrrd:8:5: sample 5 is "60", the last
list.nhdr | list.nhdr:6: the data are spread over several files
text.nhdr | text.nhdr: its data file text.txt:3:3: sample 4 is "300", no uint8
zero.nii | zero.nii: the node spacing must be positive"#
        .lines()
    {
        let (file, part) = row.split_once(" | ").unwrap();
        folder.volref(&["info", file]).expect(2, part);
    }
    // Unknown positions and a sign in a name are nothing wrong.
    folder.write(
        "nan.nhdr",
        nrrd(
            "uchar",
            "raw",
            "axis mins: nan nan nan\ndata file: 100%.raw",
        ),
    );
    folder.write("100%.raw", "123456");
    let run = folder.volref("info nan.nhdr");
    run.prints(0, "3 × 2 × 1, 6 in total");
}

#[test]
fn refusals_name_the_remedy() {
    let folder = Folder::new();
    let nrrd = |more: &str| {
        format!(
            "NRRD0005\ntype: uchar\ndimension: 3\nsizes: 3 2 1\nencoding: raw\n{more}\n\n123456"
        )
    };
    let raw =
        |more: &str| format!("file = \"six.raw\"\ntype = \"uint8\"\nnodes = [3, 2, 1]\n{more}\n");
    folder.write("six.raw", "123456");
    folder.write("scan.npy", "123456");
    folder.write("long.raw", "header123456");
    folder.write("endian.nrrd", nrrd("").replace("uchar", "short"));
    folder.write("dimension.nrrd", nrrd("").replace("dimension: 3\n", ""));
    folder.write(
        "four.nrrd",
        nrrd("").replace("3\nsizes: 3 2 1", "4\nsizes: 3 2 2 2"),
    );
    folder.write("colour.nrrd", nrrd("kinds: RGB-color domain domain"));
    folder.write("kinds.nrrd", nrrd("kinds: domain domain"));
    folder.write("away.nrrd", nrrd("data file: ../six.raw"));
    let mut nifti2 = fixture("grid.nii");
    nifti2[..4].copy_from_slice(&540_i32.to_be_bytes());
    folder.write("two.nii", nifti2);
    let mut pair = fixture("grid.nii");
    pair[344..348].copy_from_slice(b"ni1\0");
    folder.write("pair.nii", pair);
    let mut plane = fixture("grid.nii");
    plane[40..42].copy_from_slice(&2_i16.to_be_bytes());
    folder.write("plane.nii", plane);
    folder.write("plain.nii.gz", fixture("grid.nii"));
    folder.write("packed.nii", fixture("grid.nii.gz"));
    folder.write("text.nii", nrrd(""));
    folder.write("nifti.nrrd", fixture("grid.nii"));
    folder.write("meta.nrrd", "ObjectType = Image\n");
    folder.write("nodes.toml", raw("").replace("[3, 2, 1]", "[3.0, 2, 1]"));
    folder.write("spacing.toml", raw("spacing = \"1 1 2\""));
    folder.write("negative.toml", raw("header_bytes = -1"));
    folder.write("unknown.toml", raw("spacings = 2"));
    folder.write(
        "plane.nrrd",
        nrrd("").replace("3\nsizes: 3 2 1", "2\nsizes: 3 2"),
    );
    folder.write("plain.toml", raw("encoding = \"gzip\""));
    folder.write("header.toml", raw("").replace("six.raw", "long.raw"));
    for line in "\
endian.nrrd | has no field `endian`
dimension.nrrd | has no field `dimension`
four.nrrd | has 4 axes … `unu slice -a 3 -p 0 -i all.nrrd -o one.nrrd`
colour.nrrd | `unu slice
kinds.nrrd | `kinds` has 2 values, and the file 3 axes … give one for each axis
away.nrrd | `detached_anywhere = true` … `--detached-anywhere`
two.nii | NIfTI-2 … `nibabel.Nifti1Image.from_image`
pair.nii | .hdr and .img … `nibabel.save`
plane.nii | 2 axes … `data[:, :, None]`
plain.nii.gz | begins like a NIfTI-1 file … so that it ends in .nii
packed.nii | begins like a file compressed by gzip … so that it ends in .nii.gz
text.nii | begins like an NRRD file … so that it ends in .nrrd
nifti.nrrd | begins like a NIfTI-1 file … so that it ends in .nii
meta.nrrd | begins like a MetaImage … so that it ends in .mha
nodes.toml | nodes.toml:3:10: invalid type: floating point
spacing.toml | spacing.toml:4:11: expected one number or three
negative.toml | negative.toml:4:16: 
unknown.toml | unknown.toml:4:1: unknown field … `spacing`
plain.toml | the compressed stream of the data is damaged
header.toml | but 12 bytes follow it … `header_bytes = 6`
plane.nrrd | has 2 axes … a third axis of a single sample
scan.raw.gz | unsupported file extension … `encoding = \"gzip\"`
scan.img | .img: unsupported file extension … write the volume as one .nii or .nrrd, as by `nibabel.save`
scan.raw | unsupported file extension … describe the samples by a .toml
scan.npy | not a readable NPY array … numpy.save
scan.nrrd.gz | unsupported file extension … `gunzip`
scan.ply | unsupported file extension … a line `v x y z`"
        .lines()
    {
        let (file, parts) = line.split_once(" | ").unwrap();
        folder.volref(&["info", file]).expect(2, parts);
    }
}

/// What stands in place of a file, and formats that are not read, by their names and by their first bytes.
#[test]
fn files_that_are_something_else() {
    let folder = with(&["detached.nhdr", "bare.raw.toml"]);
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
    let page = "<!DOCTYPE html>\n<html><body>404 Not Found</body></html>\n";
    let told = "this is a pointer of Git LFS, not the file: run `git lfs pull` (in GitHub Actions: `lfs: true`)";
    for ending in [
        "obj", "bin", "vol", "nrrd", "nhdr", "nii", "nii.gz", "mha", "npy", "npz", "toml",
    ] {
        let name = format!("scan.{ending}");
        folder.write(&name, pointer);
        folder.volref(&["info", &name]).expect(2, &[told]);
        folder.write(&name, page);
        let message = "this is a web page, not the file: download the file again";
        folder.volref(&["info", &name]).expect(2, &[message]);
    }
    folder.write("detached.raw", pointer);
    folder.write("bare.raw", pointer);
    folder
        .volref("info detached.nhdr")
        .expect(2, &["detached.raw", told]);
    folder
        .volref("info bare.raw.toml")
        .expect(2, &["bare.raw", told]);

    let mut mrc = vec![0; 1024];
    mrc[208..212].copy_from_slice(b"MAP ");
    let mut dicom = vec![0; 200];
    dicom[128..132].copy_from_slice(b"DICM");
    for (name, misnamed, bytes, remedy) in [
        (
            "a.vti",
            "vti.nrrd",
            &b"<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">"[..],
            "pyvista.read",
        ),
        (
            "a.vtk",
            "vtk.vol",
            b"# vtk DataFile Version 3.0\n",
            "pyvista.read",
        ),
        ("a.vdb", "vdb.nrrd", b" BDV\0\0\0\0", "copyToArray"),
        ("a.nvdb", "nvdb.npy", b"NanoVDB0", "nanovdb_convert"),
        ("a.tif", "tif.npy", b"II*\0", "tifffile.imread"),
        ("a.tiff", "IM0001", b"MM\0*", "tifffile.imread"),
        ("a.mrc", "mrc.mha", &mrc, "mrcfile.read"),
        ("a.h5", "h5.bin", b"\x89HDF\r\n\x1a\n", "h5py.File"),
        ("a.dcm", "IM0002", &dicom, "dcm2niix"),
        ("a.mgz", "", b"", "nibabel.load"),
    ] {
        folder
            .volref(&["info", name])
            .expect(2, &["unsupported file extension", remedy]);
        if !misnamed.is_empty() {
            folder.write(misnamed, bytes);
            folder
                .volref(&["info", misnamed])
                .expect(2, &["begins like", remedy]);
        }
    }
    folder.write("slices/1.dcm", &dicom);
    folder
        .volref("info slices")
        .expect(2, "this is a directory … dcm2niix");
}

/// MetaImage and archives; what is behind gzip; names of Windows.
#[test]
fn archives_headers_and_streams() {
    let folder = with(&[
        "packed.mhd",
        "packed.zraw",
        "grid.npz",
        "xyz.npy",
        "gzip.nrrd",
    ]);
    folder.volref("info packed.mhd").prints(0, "packed.mhd: MetaImage … first node  (-1, 2, 3) … space       left-posterior-superior, as ITK takes it … stored      float32, little endian, zlib, 2 × 3 × 4 in other order … values      0 to 123, mean 61.5");
    folder.volref("info grid.npz").prints(0, "4 × 3 × 2");
    folder.volref("info xyz.npy").prints(0, "2 × 3 × 4");
    let mut padded = fixture("gzip.nrrd");
    padded.extend([0; 512]);
    folder.write("padded.nrrd", &padded);
    folder
        .volref("info padded.nrrd")
        .prints(0, "values      0 to 123");
    padded.extend(b"more");
    folder.write("padded.nrrd", &padded);
    folder
        .volref("info padded.nrrd")
        .expect(2, "zeros and then other bytes follow its end");

    let two = fixture("grid.npz");
    folder.write("cut.npz", &two[..two.len() - 30]);
    folder
        .volref("info cut.npz")
        .expect(2, "no readable NPZ file");
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1 1 1\nencoding: raw\ndata file: data\\a.raw\n";
    folder.write("windows.nhdr", header);
    folder.write("data/a.raw", "1");
    #[cfg(unix)]
    folder
        .volref("info windows.nhdr")
        .expect(2, "write … data/a.raw … with slashes");
    folder.write(
        "escape.raw.toml",
        "file = \"data\\a.raw\"\ntype = \"uint8\"\nnodes = [1, 1, 1]\n",
    );
    let scene = "[classified.volume]\nfile = \"data\\a.raw\"\n";
    folder.write("scene.toml", scene);
    let told = "a backslash in double quotes begins an escape";
    folder.volref("plan scene.toml").expect(2, &[told]);
    folder.volref("info escape.raw.toml").expect(
        2,
        "escape.raw.toml:1: … a backslash in double quotes begins an escape",
    );
}
