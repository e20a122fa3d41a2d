//! `volref render VOLUME`, and ranges of values.

use crate::folder::{Folder, Run, assert_holds};

/// A ball in noise-free air, in values of CT: -1000 outside, 300 inside, 1200 in its middle.
fn scan(folder: &Folder) {
    let mut text =
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 12 12 12\nencoding: text\n\n".to_owned();
    for index in 0..12 * 12 * 12 {
        let place = [index % 12, index / 12 % 12, index / 144].map(|at| f64::from(at) - 5.5);
        let radius = place.iter().map(|at| at * at).sum::<f64>().sqrt();
        let value = match radius {
            0.0..1.5 => 1200,
            1.5..4.5 => 300,
            _ => -1000,
        };
        text += &format!("{value}\n");
    }
    folder.write("scan.nrrd", text);
}

fn with_scan() -> Folder {
    let folder = Folder::with_scenes();
    scan(&folder);
    folder
}

fn render(folder: &Folder, more: &[&str]) -> Run {
    folder.volref(
        &[
            &["render", "scan.nrrd", "-o", "x.exr", "--size", "24"],
            more,
        ]
        .concat(),
    )
}

const MODES: [&str; 7] = [
    "composite",
    "maximum",
    "minimum",
    "mean",
    "sum",
    "attenuated-maximum",
    "isosurface",
];

/// The scene that is saved, in whatever folder, renders the same bits.
#[test]
fn a_saved_scene_renders_the_same_bits() {
    let folder = with_scan();
    folder.write("sub/here", "");
    for mode in MODES {
        for (file, back) in [
            ("mine.toml", "mine.toml"),
            ("sub/mine.toml", "sub/mine.toml"),
        ] {
            let more = [
                "--mode",
                mode,
                "--spacing",
                "1,1,2",
                "--save-scene",
                file,
                "--threads",
                "1",
            ];
            let run = render(&folder, &more);
            assert_eq!(run.code, 0, "{mode}: {}", run.stderr);
            let again = folder.volref(&["render", back, "-o", "y.exr", "--threads", "1"]);
            assert_eq!(again.code, 0, "{mode}: {}", again.stderr);
            let hash = |name| folder.film(name).pixel_hash();
            assert_eq!(hash("x.exr"), hash("y.exr"), "{mode}");
        }
    }
}

#[test]
fn sizes_ranges_and_options_that_make_no_picture() {
    let folder = with_scan();
    for (more, message) in [
        (
            &["--size", "1000000"][..],
            "expected a number of pixels from 1 to 16384",
        ),
        (
            &["--size", "640x0"],
            "expected a number of pixels from 1 to 16384",
        ),
        (
            &["--size", "nan"],
            "expected a number of pixels from 1 to 16384",
        ),
        (
            &["--range", "3,3"],
            "the range from 3 to 3 is empty: give the smaller number first",
        ),
        (&["--range", "4,-3"], "the range from 4 to -3 is empty"),
        (
            &["--range", "nan,3"],
            "expected two numbers with a comma between",
        ),
        (
            &["--range", "0,inf"],
            "expected two numbers with a comma between",
        ),
        (&["--spacing", "1,0,1"], "expected three numbers above 0"),
        (
            &["--elevation", "90"],
            "`elevation` must lie in (-90, 90), got 90",
        ),
        (&["--azimuth", "nan"], "expected a number of degrees"),
        (
            &["--mode", "attenuated-maximum", "--colormap", "heat"],
            "`attenuated-maximum` is shown in greys alone",
        ),
    ] {
        let render = [&["render", "scan.nrrd", "-o", "x.exr"], more].concat();
        folder.volref(&render).expect(2, &[message]);
        assert!(!folder.path("x.exr").exists());
    }
    for option in [
        &["--size", "8"][..],
        &["--mode", "maximum"],
        &["--save-scene", "a.toml"],
    ] {
        let render = [&["render", "scene.toml", "-o", "x.exr"], option].concat();
        folder
            .volref(&render)
            .expect(2, &["are for volume files", "volref plan"]);
    }
    folder
        .volref("render cloud.obj -o x.exr --spacing 1,1,1")
        .expect(2, "have positions of their own");
}

/// The range that a file gets is one that it could state.
#[test]
fn values_of_a_file_have_a_range_by_default() {
    let folder = with_scan();
    let scene = |range: &str| {
        format!(
            "[film]\nwidth = 12\nheight = 12\n[transfer_function]\nreference_length = 20\n{range}\
             [classified.volume]\nfile = \"scan.nrrd\"\n[classified.phong]\n"
        )
    };
    folder.write("default.toml", scene(""));
    folder.write("stated.toml", scene("range = [-1000, 1200]\n"));
    let run = folder.volref("render default.toml -o default.exr");
    run.prints(
        0,
        "note: values are shown from -1000.0 to 1200.0 by default … `range`",
    );
    let run = folder.volref("render stated.toml -o stated.exr");
    assert!(!run.stdout.contains("values are shown"), "{}", run.stdout);
    assert_eq!(folder.read("default.exr"), folder.read("stated.exr"));
    // The plain renderer maps values likewise, in the shadow, too.
    folder.write(
        "shadow.toml",
        scene("range = [-500, 800]\n") + "[classified.shadow]\nreference_step = 0.05\n",
    );
    let hashes = [&[][..], &["--reference"]].map(|how| {
        let render = [&["render", "shadow.toml", "-o", "shadow.exr"], how].concat();
        folder.volref(&render).prints(0, "");
        folder.film("shadow.exr").pixel_hash()
    });
    assert_eq!(hashes[0], hashes[1]);
    for (range, message) in [
        ("range = [3, 3]\n", "the range from 3 to 3 is empty"),
        ("range = [4, -3]\n", "the range from 4 to -3 is empty"),
        ("range = [nan, 3]\n", "`range` must be finite"),
        ("range = [0, 1e39]\n", "`range` must lie in"),
        (
            "range = [0, 1, 2]\n",
            "`range` must be two numbers, the smaller first",
        ),
    ] {
        folder.write("bad.toml", scene(range));
        folder
            .volref("render bad.toml -o x.exr")
            .expect(2, &["bad.toml:6:9", message]);
    }
}

/// Points of a table with a range are positions in it.
#[test]
fn points_with_a_range_are_positions_in_it() {
    let folder = with_scan();
    let scene = |range: &str, ends: [&str; 2]| {
        format!(
            "[film]\nwidth = 12\nheight = 12\n[transfer_function]\nreference_length = 20\n{range}\
             point = [{{ value = {}, colour = 0, opacity = 0 }}, {{ value = {}, colour = \"#bcbcbc\", opacity = 0.5 }}]\n\
             [classified.volume]\nfile = \"scan.nrrd\"\n",
            ends[0], ends[1]
        )
    };
    folder.write("a.toml", scene("range = [-1000, 1200]\n", ["0", "1"]));
    folder.write("b.toml", scene("", ["-1000", "1200"]));
    for name in ["a", "b"] {
        let run = folder.volref(&[
            "render",
            &format!("{name}.toml"),
            "-o",
            &format!("{name}.exr"),
        ]);
        assert_eq!(run.code, 0, "{}", run.stderr);
    }
    assert_eq!(
        folder.film("a.exr").pixel_hash(),
        folder.film("b.exr").pixel_hash()
    );
}

#[test]
fn a_camera_around_the_volume() {
    let folder = with_scan();
    let scene = |camera: &str| {
        format!(
            "[film]\nwidth = 12\nheight = 12\n[camera]\nup = [0, 0, 1]\n{camera}\n\
             [classified.volume]\nfile = \"scan.nrrd\"\n"
        )
    };
    folder.write("a.toml", scene("azimuth = 30\nelevation = 20\nzoom = 1.5"));
    let plan = folder.volref("plan a.toml");
    assert_holds(&plan.stdout, &["camera.eye"]);
    for (camera, message) in [
        ("azimuth = 3\neye = [0, 0, 9]", "mixes `eye` with `azimuth`"),
        ("zoom = 0", "`zoom` must lie in [0.01, 100], got 0"),
        (
            "elevation = 90",
            "`elevation` must lie in (-90, 90), got 90",
        ),
        (
            "zoom = 2\northographic_height = 3",
            "mixes `orthographic_height` with `zoom`",
        ),
    ] {
        folder.write("a.toml", scene(camera));
        folder.volref("plan a.toml").expect(2, &[message]);
    }
}
