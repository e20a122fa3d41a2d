//! Loading volumes, and what happens to files that are none.

use glam::DVec3;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use volref::scene::{Model, Scene};
use volref::volume::*;

/// An empty folder of this test's own.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The message for `path`, without the folder in front of it.
fn message(folder: &Path, path: &Path) -> String {
    let options = LoadOptions {
        splatting: Splatting {
            resolution: Some(4),
            padding: 1,
        },
        ..LoadOptions::default()
    };
    let message = load(path, &options).unwrap_err().to_string();
    let front = format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR);
    match message.strip_prefix(&front) {
        Some(rest) => rest.to_owned(),
        None => panic!("{message:?} does not begin with the path"),
    }
}

/// A binary grid of one value, of spacing 1.
fn course_grid(nodes: [i32; 3], value: f32) -> Vec<u8> {
    let sizes = nodes.map(|count| (count - 1) as f32);
    let values = vec![value; nodes.iter().product::<i32>() as usize];
    let numbers = sizes.into_iter().chain(values);
    let counts = nodes.into_iter().flat_map(i32::to_le_bytes);
    counts.chain(numbers.flat_map(f32::to_le_bytes)).collect()
}

/// The files have holes instead of bytes: reading them would take minutes.
#[cfg(unix)]
#[test]
fn sizes_are_checked_before_reading() {
    use std::io::Write;
    const SIZE: u64 = 1 << 40;
    let folder = folder("sizes_are_checked_before_reading");
    let cloud = folder.join("huge.obj");
    File::create(&cloud).unwrap().set_len(SIZE).unwrap();
    assert_eq!(
        message(&folder, &cloud),
        "huge.obj: the file has 1099511627776 bytes, and at most 4294967296 are read: thin the cloud \
         out"
    );
    let grid = folder.join("huge.bin");
    let mut file = File::create(&grid).unwrap();
    file.write_all(&course_grid([2, 2, 2], 1.0)[..24]).unwrap();
    file.set_len(SIZE).unwrap();
    assert_eq!(
        message(&folder, &grid),
        "huge.bin: the header declares 2 × 2 × 2 samples of float32, 32 bytes, but 1099511627752 bytes \
         follow it: the file is truncated, has extra data, or has a wrong type or size in its header"
    );
}

/// A small volume of our own, one grid in many formats: see `scripts/generate-volumes.py`.
fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fixtures/volumes/formats")
        .join(name)
}

#[test]
fn all_formats_give_the_same_grid() {
    let spacing = DVec3::new(0.5, 1.0, 2.0);
    let lattice = Lattice::new([4, 3, 2], spacing, DVec3::new(-1.0, 2.0, 3.0)).unwrap();
    let value = |[i, j, k]: [usize; 3]| (i + 10 * j + 100 * k) as f32;
    let values = (0..24).map(|index| value(lattice.node(index))).collect();
    let expected = Grid::new(lattice, values).unwrap();
    for name in [
        "grid.vol",
        "raw.nrrd",
        "gzip.nrrd",
        "text.nrrd",
        "detached.nhdr",
        "grid.nii",
        "grid.nii.gz",
        "grid.mha",
        "packed.mhd",
        "bare.raw.toml",
        "xyz.raw.toml",
    ] {
        let loaded = load_hashed(&fixture(name), &LoadOptions::default()).unwrap();
        assert_eq!(loaded.grid, expected, "{name}");
    }
    // NPY states no positions; one array runs along x first, the other along z.
    let options = LoadOptions {
        spacing: Some(spacing),
        origin: Some(lattice.first()),
        ..LoadOptions::default()
    };
    let xyz = LoadOptions {
        axes: Some(AxisOrder::Xyz),
        ..options
    };
    for (name, options) in [
        ("grid.npy", options),
        ("fortran.npy", options),
        ("grid.npz", options),
        ("stored.npz", options),
        ("xyz.npy", xyz),
    ] {
        let loaded = load_hashed(&fixture(name), &options).unwrap();
        assert_eq!(loaded.grid, expected, "{name}");
        assert_eq!(loaded.to_world, None, "{name}");
    }
    // The course's grid has one spacing, and begins at the origin.
    let course = load(&fixture("grid.bin"), &LoadOptions::default()).unwrap();
    assert_eq!(course.values(), expected.values());
    assert_eq!(course.lattice().nodes(), [4, 3, 2]);
}

#[test]
fn data_elsewhere_are_read_only_when_asked_for() {
    let folder = folder("data_elsewhere");
    fs::create_dir(folder.join("below")).unwrap();
    let samples = [1, 2, 3, 4];
    fs::write(folder.join("samples.raw"), samples).unwrap();
    fs::write(folder.join("below/samples.raw"), samples).unwrap();
    let header = |name: &str| {
        format!(
            "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 1\nencoding: raw\ndata file: {name}\n"
        )
    };
    let description =
        |name: &str| format!("file = {name:?}\ntype = \"uint8\"\nnodes = [2, 2, 1]\n");
    let absolute = folder.join("samples.raw").display().to_string();
    let anywhere = LoadOptions {
        detached_anywhere: true,
        ..LoadOptions::default()
    };
    for (extension, text) in [
        ("nhdr", &header as &dyn Fn(&str) -> String),
        ("toml", &description),
    ] {
        let path = folder.join("below/header").with_extension(extension);
        for (name, inside) in [
            ("samples.raw", true),
            ("./samples.raw", true),
            ("../samples.raw", false),
            (&absolute, false),
        ] {
            fs::write(&path, text(name)).unwrap();
            match load(&path, &LoadOptions::default()) {
                Ok(grid) => assert_eq!((grid.range(), inside), ((1.0, 4.0), true), "{name}"),
                Err(error) => {
                    let end = format!(
                        ": its data are in {name:?}, outside its folder, which is not allowed: \
                        move the file beside the header, or set `detached_anywhere = true` \
                        beside `file` in the scene, not in the header (`--detached-anywhere` for \
                        `volref info`)"
                    );
                    assert!(!inside && error.to_string().ends_with(&end), "{error}");
                }
            }
            assert_eq!(load(&path, &anywhere).unwrap().range(), (1.0, 4.0));
        }
        fs::write(&path, text("nothing.raw")).unwrap();
        let message = load(&path, &LoadOptions::default())
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(": cannot open its data file "),
            "{message}"
        );
        assert!(
            message.ends_with("nothing.raw: there is no such file"),
            "{message}"
        );
    }
}

// Volume files in scenes.

/// The scene of this volume, in a folder with the small volumes.
fn scene(folder: &Path, keys: &str) -> Result<Scene, String> {
    let text =
        format!("film = {{ width = 4, height = 4 }}\n[classified]\n[classified.volume]\n{keys}\n");
    Scene::parse(&text, &folder.join("scene.toml")).map_err(|error| error.to_string())
}

fn grid_of(scene: &Scene) -> &Grid<f32> {
    match &scene.panels[0].model {
        Model::Classified(classified) => &classified.grid,
        _ => panic!("a classified volume"),
    }
}

#[test]
fn scenes_note_every_file_they_read() {
    let folder = folder("scenes_note_every_file");
    let inputs = |keys: &str| {
        let scene = scene(&folder, keys).unwrap();
        let names = scene.panels[0]
            .inputs
            .iter()
            .map(|input| input.name.clone());
        names.collect::<Vec<_>>()
    };
    fs::create_dir(folder.join("scans")).unwrap();
    for name in ["detached.nhdr", "detached.raw", "grid.vol"] {
        fs::copy(fixture(name), folder.join("scans").join(name)).unwrap();
    }
    assert_eq!(inputs("file = \"./scans/grid.vol\""), ["./scans/grid.vol"]);
    let data = Path::new("scans")
        .join("detached.raw")
        .display()
        .to_string();
    assert_eq!(
        inputs("file = \"scans/detached.nhdr\""),
        ["scans/detached.nhdr", &data]
    );
}

#[test]
fn keys_of_volume_files() {
    let folder = folder("keys_of_volume_files");
    let mut odd = fs::read(fixture("grid.vol")).unwrap();
    odd[52..56].copy_from_slice(&f32::NAN.to_le_bytes());
    fs::write(folder.join("nan.vol"), &odd).unwrap();
    let oblique = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 1\nencoding: raw\n\
                   space directions: (3,4,0) (-4,3,0) (0,0,1)\n\n\x01\x02\x03\x04";
    fs::write(folder.join("oblique.nrrd"), oblique).unwrap();
    fs::write(folder.join("two.obj"), "v 0 0 0\nv 1 1 1\n").unwrap();

    let replaced = scene(&folder, "file = \"nan.vol\"\nreplace_non_finite = 0.25").unwrap();
    assert_eq!(grid_of(&replaced).values()[1], 0.25);
    let stored = scene(
        &folder,
        "file = \"oblique.nrrd\"\norientation = \"as-stored\"",
    )
    .unwrap();
    assert_eq!(
        grid_of(&stored).lattice().spacing(),
        DVec3::new(5.0, 5.0, 1.0)
    );
    // A classified volume stands as the file says, a medium along the axes of the world.
    assert!(scene(&folder, "file = \"oblique.nrrd\"").is_ok());
    let medium = "[camera]\neye = [0, 0, -9]\ntarget = [0, 0, 0]\n[radiative]\n\
                  [[radiative.medium]]\nsigma_t = 1\nalbedo = 0\ngrid = { file = \"oblique.nrrd\" }\n";
    let refused = Scene::parse(medium, &folder.join("scene.toml")).unwrap_err();
    let message = refused.to_string();
    assert!(
        message.contains("axis 1 of the file is rotated by 36.8699 degrees"),
        "{message}"
    );
    let cells = scene(
        &folder,
        "file = \"nan.vol\"\nreplace_non_finite = 0\ncentring = \"cells\"",
    );
    assert_eq!(
        grid_of(&cells.unwrap()).lattice().centring(),
        Centring::Cells
    );

    // Of a NumPy array the scene says where it lies, of a medium, too.
    for name in ["grid.npy", "fortran.npy"] {
        fs::copy(fixture(name), folder.join(name)).unwrap();
        let keys = format!("file = {name:?}\nspacing = [0.5, 1, 2]\norigin = [-1, 2, 3]");
        let expected = load(&fixture("raw.nrrd"), &LoadOptions::default()).unwrap();
        assert_eq!(*grid_of(&scene(&folder, &keys).unwrap()), expected);
        let keys = keys.replace('\n', ", ");
        let medium = format!(
            "[camera]\neye = [0, 0, -9]\ntarget = [0, 0, 0]\n[radiative]\n\
             [[radiative.medium]]\nsigma_t = 1\nalbedo = 0\ngrid = {{ {keys} }}\n"
        );
        let loaded = Scene::parse(&medium, &folder.join("scene.toml")).unwrap();
        let Model::Radiative(radiative) = &loaded.panels[0].model else {
            panic!("a medium");
        };
        let density = radiative.media[0].density.as_ref().unwrap();
        assert_eq!(density.bounds(), expected.lattice().bounds());
    }

    // The order of the axes by the scene, over that of a description.
    let expected = load(&fixture("grid.npy"), &LoadOptions::default()).unwrap();
    for name in [
        "xyz.npy",
        "bare.raw.toml",
        "bare.raw",
        "xyz.raw.toml",
        "xyz.raw",
    ] {
        fs::copy(fixture(name), folder.join(name)).unwrap();
    }
    for keys in [
        "file = \"xyz.npy\"\naxes = \"xyz\"",
        "file = \"grid.npy\"\naxes = \"zyx\"",
        "file = \"xyz.raw.toml\"",
        "file = \"xyz.raw.toml\"\naxes = \"xyz\"",
        "file = \"bare.raw.toml\"\naxes = \"zyx\"",
    ] {
        let read = scene(&folder, keys).unwrap();
        assert_eq!(grid_of(&read).values(), expected.values(), "{keys}");
    }
    let other = scene(&folder, "file = \"xyz.raw.toml\"\naxes = \"zyx\"").unwrap();
    assert_ne!(grid_of(&other).values(), expected.values());

    for row in r#"
file = "grid.npy"; spacing = [1, 0, 1] | :5:11: the node spacing must be positive and finite on every axis
file = "nan.vol"; spacing = [1, 1, 1] | :5:11: `spacing` does not apply to "nan.vol"
file = "grid.npy"; nodes = [1, 1, 1] | `nodes`
file = "nan.vol"; axes = "xyz" | :5:8: `axes` does not apply to "nan.vol"
file = "two.obj"; axes = "zyx" | :5:8: `axes` does not apply to "two.obj"
file = "grid.npy"; axes = "yxz" | `axes`
file = "a\b.vol" | there is no such file
file = "a\q.vol" | :4:11: missing escaped value
file = "nan.vol" | :4:8: 
file = "nan.vol" | voxel (1, 0, 0) in the order of the file holds NaN: values must be finite, and not beyond 3.4e38; correct it, or set `replace_non_finite` beside `file` in the scene
file = "nan.vol"; padding = 1 | :5:11: `padding` does not apply to "nan.vol"
file = "two.obj"; centring = "cells" | :5:12: `centring` does not apply to "two.obj"
file = "scan.raw"; centring = "cells" | scan.raw: unsupported file extension; supported are
file = "nan.vol"; detached_anywhere = 1 | :5:21: `detached_anywhere` must be true or false, not an integer
file = "nan.vol"; replace_non_finite = 1e39 | `replace_non_finite` must lie in"#
        .lines()
        .skip(1)
    {
        let (keys, expected) = row.split_once(" | ").unwrap();
        let message = scene(&folder, &keys.replace("; ", "\n")).unwrap_err();
        assert!(message.contains(expected), "{message}");
    }
}

// No bytes make a reader panic, and what it accepts is sound.
