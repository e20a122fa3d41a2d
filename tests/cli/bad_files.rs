//! Volumes that cannot be used.

use crate::folder::{Folder, scene};

/// A course grid: int32 nodes, float32 sizes, float32 densities.
pub fn grid(nodes: [i32; 3], size: [f32; 3], densities: &[f32]) -> Vec<u8> {
    let nodes = nodes.iter().flat_map(|word| word.to_le_bytes());
    let floats = size.iter().chain(densities);
    nodes
        .chain(floats.flat_map(|word| word.to_le_bytes()))
        .collect()
}

/// Renders a scene of a volume with these contents, and expects a refusal.
fn refused(name: &str, contents: &[u8], parts: &[&str]) {
    let folder = Folder::new();
    folder.write(name, contents);
    let mut text = scene("").replace("../../volumes/cloud.obj", name);
    if name.ends_with(".bin") {
        text = text.replace("resolution = 8\npadding = 1\n", "");
    }
    folder.write("scene.toml", text);
    let before = folder.files();
    let run = folder.volref("render scene.toml -o image.exr");
    // The place of the key in the scene, then the file and what is wrong in it.
    run.expect(2, &["scene.toml:11:8: ", name]);
    run.expect(2, parts);
    assert_eq!(folder.files(), before, "nothing is written");
}

#[test]
fn grids() {
    let whole = grid([2, 2, 2], [1.0; 3], &[0.5; 8]);
    let bomb = grid([1 << 20, 1 << 20, 1 << 20], [1.0; 3], &[0.5; 8]);
    for (bytes, parts) in [
        (
            &whole[..0],
            &["ends after 0 of the 24 bytes of its header"][..],
        ),
        (
            &whole[..23],
            &["ends after 23 of the 24 bytes of its header"],
        ),
        (
            &whole[..24],
            &["32 bytes", "but 0 bytes follow", "truncated"],
        ),
        (
            &whole[..whole.len() - 1],
            &["32 bytes", "but 31 bytes follow", "truncated"],
        ),
        (
            &[&whole[..], b"more"].concat(),
            &["but 36 bytes follow", "has extra data"],
        ),
        // 2^60 voxels: refused by the header, before anything is allocated.
        (&bomb, &["1048576 × 1048576 × 1048576"]),
        (&grid([2, 0, 2], [1.0; 3], &[]), &["2 × 0 × 2 samples"]),
        (
            &grid([-2, 2, 2], [1.0; 3], &[]),
            &["-2 × 2 × 2 samples", "little endian"],
        ),
        (&grid([1, 1, 1], [1.0; 3], &[1.0]), &["1 × 1 × 1"]),
        (
            &grid([2, 2, 2], [0.0; 3], &[1.0; 8]),
            &["spacing must be positive"],
        ),
        (&grid([2, 2, 2], [f32::NAN; 3], &[1.0; 8]), &["NaN"]),
        (&grid([1, 1, 2], [1.0; 3], &[0.5, f32::NAN]), &["NaN"]),
        (&grid([1, 1, 2], [1.0; 3], &[0.5, f32::INFINITY]), &["inf"]),
    ] {
        refused("grid.bin", bytes, parts);
    }
}

#[test]
fn no_such_volume() {
    let folder = Folder::with_scenes();
    folder.remove("cloud.obj");
    let run = folder.volref("plan scene.toml");
    run.expect(2, "scene.toml:11:8: cloud.obj: there is no such file");
}

#[test]
fn a_folder_for_a_volume() {
    let folder = Folder::with_scenes();
    folder.edit("scene.toml", "cloud.obj", "clouds.obj");
    folder.write("clouds.obj/cloud.obj", "");
    let run = folder.volref("plan scene.toml");
    run.expect(2, "scene.toml:11:8: clouds.obj: this is a directory");
}

#[test]
fn an_unknown_kind_of_volume() {
    let folder = Folder::with_scenes();
    folder.edit("scene.toml", "cloud.obj", "cloud.vdb");
    folder.edit("scene.toml", "resolution = 8\npadding = 1\n", "");
    let run = folder.volref("plan scene.toml");
    run.expect(
        2,
        "scene.toml:11:8: cloud.vdb: unsupported file extension … .obj … .bin",
    );
}

/// A cube as six squares, around a corner of the origin.
const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n\
                    f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

/// A scene of a medium in the mesh `mesh.obj`.
fn with_mesh(mesh: &[u8]) -> Folder {
    let folder = Folder::new();
    folder.write("mesh.obj", mesh);
    folder.write(
        "scene.toml",
        "[film]\nwidth = 8\nheight = 8\n[camera]\neye = [3, 4, 5]\ntarget = [0.5, 0.5, 0.5]\n\
         [radiative]\nenvironment = 1\n[[radiative.medium]]\nmesh = { file = \"mesh.obj\" }\n\
         sigma_a = 1\n",
    );
    folder
}

/// However a program writes a mesh, the image is the same; what it has that is none says its line.
#[test]
fn meshes() {
    let image = |mesh: &[u8]| {
        let run = with_mesh(mesh).volref("render scene.toml -o image.exr --json");
        assert_eq!(run.code, 0, "{}", run.stderr);
        run.json()["hash"].as_str().unwrap().to_owned()
    };
    let cube = image(CUBE.as_bytes());
    let latin_1 = [&b"# Zo\xeb\no caf\xe9\n"[..], CUBE.as_bytes()].concat();
    for mesh in [
        &format!("\u{feff}{CUBE}").into_bytes()[..],
        &CUBE.replace('\n', "\r").into_bytes(),
        &CUBE.replace('\n', " # comment\n").into_bytes(),
        &CUBE.replace(" 0\n", " \\\n 0\n").into_bytes(),
        &CUBE.replace("f 1 2 6 5", "f 1 2 \\\n6 5").into_bytes(),
        &latin_1,
    ] {
        assert_eq!(image(mesh), cube, "{}", String::from_utf8_lossy(mesh));
    }
    let utf_16: Vec<u8> = "\u{feff}v 0 0 0\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    for (mesh, words) in [
        (
            &utf_16[..],
            "mesh.obj: this is not plain text (a zero byte or UTF-16): save it as UTF-8",
        ),
        (
            b"v 0 0 0\nv 0,5 0 0\n",
            "mesh.obj:2:3: x is \"0,5\", which is no finite number: write it like 0.5",
        ),
        (
            b"v 0 0 0\nv 1 0 0\nf 1 2 3\n",
            "mesh.obj:3:7: this face refers to vertex 3, but the file has 2",
        ),
        (
            b"v 0 0 0\nf 1 1\n",
            "mesh.obj:2:1: a face has three corners or more, this one has 2",
        ),
        (
            b"v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 2 0\n\nf 1 2 3 4\n",
            "mesh.obj:6:1: no fan of triangles from one corner covers this polygon, or it has no area or crosses itself: triangulate",
        ),
        (
            CUBE.strip_suffix("f 2 4 8 6\n").unwrap().as_bytes(),
            "mesh.obj: the edge from [1, 1, 0] to [1, 0, 0] belongs to the face in line 9, and a closed boundary",
        ),
    ] {
        let folder = with_mesh(mesh);
        let before = folder.files();
        let run = folder.volref("render scene.toml -o image.exr");
        run.expect(2, &["scene.toml:10:17: ", words]);
        assert_eq!(folder.files(), before, "nothing is written");
    }
}
