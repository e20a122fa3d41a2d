//! `volref export`.

use crate::folder::{Folder, assert_holds, assert_shown};

const SCENE: &str = "\
film = { width = 4, height = 3 }
camera = { eye = [0, 1, -6], target = [0, 1, 0] }

[radiative]
environment = 1

[[radiative.surface]]
mesh = { file = \"gem.obj\" }
diffuse = { reflectance = 0.5 }

[[radiative.medium]]
sphere = { centre = [0, 5, 0], radius = 1 }
sigma_s = 1
";

fn folder() -> Folder {
    let folder = Folder::new();
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    folder.write("gem.obj", mesh);
    folder.write("fog.toml", SCENE);
    folder
}

#[test]
fn says_what_was_written_and_how_to_render_it() {
    let folder = folder();
    let run = folder.volref("export fog.toml --to mitsuba -o 'out/a b'");
    insta::with_settings!({filters => vec![(r"\d+ bytes", "[n] bytes")]}, {
        assert_shown!(run.shown(), @r##"
        exit code 0
        --- stdout
        out/a b/fog.xml: [n] bytes
        out/a b/fog.mesh0.ply: [n] bytes

        to render it:
          mitsuba -m scalar_rgb -o fog.exr 'out/a b/fog.xml'
        "##);
    });
    let names: Vec<String> = folder.files().into_keys().collect();
    let written = ["out/a b/fog.mesh0.ply", "out/a b/fog.xml"];
    assert!(
        written
            .iter()
            .all(|name| names.contains(&(*name).to_owned())),
        "{names:?}"
    );
    assert_eq!(names.len(), 4, "nothing is left over: {names:?}");
    assert!(folder.text("out/a b/fog.xml").ends_with("</scene>\n"));
}

#[test]
fn as_json() {
    let run = folder().volref("export fog.toml --to pbrt -o out --json");
    assert_shown!(run.shown(), @r##"
    exit code 0
    --- stdout
    {
      "commands": [
        "pbrt out/fog.pbrt"
      ],
      "files": [
        "fog.pbrt",
        "fog.mesh0.ply"
      ],
      "folder": "out",
      "format": "pbrt",
      "main": "fog.pbrt",
      "scene": "fog.toml",
      "schema": "volref/export/1"
    }
    "##);
}

#[test]
fn an_export_replaces_the_one_before() {
    let folder = folder();
    folder.write("out/fog.xml", "old");
    folder.write("out/mine.txt", "mine");
    // A scene that was edited since.
    folder.edit("fog.toml", "sigma_s = 1\n", "sigma_s = 1.5\n");
    let run = folder.volref("export fog.toml --to mitsuba -o out");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(folder.text("out/fog.xml").starts_with("<scene"));
    assert_eq!(folder.text("out/mine.txt"), "mine");
}

#[test]
fn what_cannot_be_said_is_named_and_nothing_is_written() {
    let folder = folder();
    folder.edit("fog.toml", "sigma_s = 1\n", "sigma_s = 1\nemission = 1\n");
    let before = folder.files();
    let run = folder.volref("export fog.toml --to mitsuba -o out");
    assert_shown!(run.shown(), @r##"
    exit code 2
    --- stderr
      × mitsuba cannot represent radiative.medium[0]: an emissive medium
      help: nothing was written; remove these features from the scene or replace them
    "##);
    assert_eq!(folder.files(), before);
    assert!(!folder.path("out").exists());
}

#[test]
fn bad_arguments() {
    let folder = folder();
    let export = |scene: &str, format: &str, output: &str| {
        folder.volref(&["export", scene, "--to", format, "-o", output])
    };
    let before = folder.files();
    export("fog.toml", "mitsuba", "gem.obj").expect(2, "cannot write into gem.obj");
    export("gone.toml", "mitsuba", "out").expect(2, "gone.toml");
    let unknown = export("fog.toml", "blender", "out");
    assert_eq!(unknown.code, 2);
    assert_holds(&unknown.stderr, &["mitsuba, pbrt, bundle"]);
    assert_eq!(folder.files(), before);
    // A folder in the place of a file: nothing else is written either.
    folder.write("out/fog.xml/x", "");
    let before = folder.files();
    export("fog.toml", "mitsuba", "out").expect(2, "fog.xml: it is a folder");
    assert_eq!(folder.files(), before);
}

/// The grid of a scene alone: by a formula, with the map that places it.
#[test]
fn grids_alone() {
    let folder = Folder::new();
    let scene = "[classified.volume]\nfield = \"ramp\"\nnodes = [3, 2, 2]\nslope = [0.5, 0.25, 0]\n\
                 translate = [1, 0, 0]\nspacing = [0.1, 1, 1]\n";
    folder.write("ramp.toml", scene);
    assert_shown!(folder.volref("export ramp.toml --to raw -o out").shown(), @r#"
    exit code 0
    --- stdout
    out/ramp.raw.toml: 225 bytes
    out/ramp.raw: 48 bytes
    "#);
    let run = folder.volref("export ramp.toml --to raw -o out --json");
    let rows = [
        [1.0, 0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ];
    assert_eq!(run.json()["transform"], serde_json::json!(rows));
    assert_shown!(folder.text("out/ramp.raw.toml"), @r#"
    file = "ramp.raw"
    type = "float32"
    endian = "little"
    nodes = [3, 2, 2] # x, y, z; x runs fastest in the file
    spacing = [0.1, 1.0, 1.0]
    origin = [0.0, 0.0, 0.0] # position of the first node
    centring = "nodes"
    header_bytes = 0
    "#);
    let raw = folder.read("out/ramp.raw");
    let values: Vec<f32> = raw
        .chunks(4)
        .map(|word| f32::from_le_bytes(word.try_into().unwrap()))
        .collect();
    assert_eq!(values[..6], [0.0, 0.5, 1.0, 0.25, 0.75, 1.25]);
    folder
        .volref("export ramp.toml --to nrrd -o out")
        .expect(0, "");
    folder
        .volref("export ramp.toml --to npy -o out")
        .expect(0, "");
    let header = String::from_utf8_lossy(&folder.read("out/ramp.nrrd")).into_owned();
    assert_shown!(header[..header.find("\n\n").unwrap()], @r#"
    NRRD0004
    type: float
    dimension: 3
    space dimension: 3
    sizes: 3 2 2
    space directions: (0.1,0,0) (0,1,0) (0,0,1)
    space origin: (0,0,0)
    kinds: domain domain domain
    centerings: node node node
    endian: little
    encoding: raw
    "#);
    // What volref says of all three is the same.
    let values = |file: &str| folder.volref(&["info", file, "--json"]).json()["values"].clone();
    let right = values("out/ramp.raw.toml");
    assert_eq!(right["max"], 1.25);
    for file in ["out/ramp.nrrd", "out/ramp.npy.toml"] {
        assert_eq!(values(file), right, "{file}");
    }
    // None of a scene without a grid, and none written in part.
    folder.write("gem.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("fog.toml", SCENE);
    let before = folder.files();
    let run = folder.volref("export fog.toml --to nrrd -o out");
    run.expect(
        2,
        "nrrd cannot represent panel: this one has no classified volume",
    );
    folder.write(
        "both.toml",
        scene.to_owned() + "[[panel]]\n[[panel]]\nclassified.volume.slope = [1, 0, 0]\n",
    );
    for scene in ["both.toml", "scenes/rings-in-waves"] {
        let run = folder.volref(&["export", scene, "--to", "npy", "-o", "out"]);
        run.expect(2, "npy cannot represent panel: several volumes");
    }
    folder.remove("both.toml");
    assert_eq!(folder.files(), before);
}

/// A camera by a matrix, with its centre beside the middle: what each format says of it.
#[test]
fn a_camera_by_a_matrix() {
    let folder = folder();
    let camera = "matrix = [[0, 0, 1, 6], [0, 1, 0, 1], [-1, 0, 0, 2], [0, 0, 0, 1]], fl_x = 5, fl_y = 5, \
                  cx = 1, cy = 1.5";
    folder.edit("fog.toml", "eye = [0, 1, -6], target = [0, 1, 0]", camera);
    let export = |format: &str| folder.volref(&["export", "fog.toml", "--to", format, "-o", "out"]);
    assert_eq!(export("mitsuba").code, 0);
    assert_holds(
        &folder.text("out/fog.xml"),
        &[
            "name=\"principal_point_offset_x\" value=\"0.25\"",
            "name=\"principal_point_offset_y\" value=\"0\"",
        ],
    );
    assert_eq!(export("pbrt").code, 0);
    assert_holds(
        &folder.text("out/fog.pbrt"),
        &["\"float fov\" [ 90 ] \"float screenwindow\" [ -0.2 0.6 -0.3 0.3 ]"],
    );
    assert_eq!(export("bundle").code, 0);
    let bundle: serde_json::Value = serde_json::from_str(&folder.text("out/fog.json")).unwrap();
    let ray = &bundle["panels"][0]["ray"];
    let vector = |name: &str| [0, 1, 2].map(|at| ray[name][at].as_f64().unwrap());
    assert_eq!(vector("axis"), [-1.0, 0.0, 0.0]);
    assert_eq!(vector("eye"), [6.0, 1.0, 2.0]);
    // Pixel (0, 0): ((1/2 - 1)/5, -(1/2 - 3/2)/5, -1) in the camera.
    let [forward, right, up] = ["forward", "half_right", "half_up"].map(vector);
    let way =
        [0, 1, 2].map(|k| forward[k] + right[k] * (1.0 - 4.0) / 3.0 - up[k] * (1.0 - 3.0) / 3.0);
    assert!(
        (way[1] / -way[0] - 0.2).abs() < 1e-12 && (way[2] / -way[0] - 0.1).abs() < 1e-12,
        "{way:?}"
    );
    folder.edit("fog.toml", "fl_y = 5", "fl_y = 4");
    let run = export("mitsuba");
    assert_holds(
        &run.message(),
        &["pixels that are not square: give `fl_x` and `fl_y` one value"],
    );
    assert_eq!(export("pbrt").code, 0);
}
