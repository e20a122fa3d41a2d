//! `volref render`

use crate::folder::{Folder, assert_shown};
use volref::film::Film;

#[test]
fn exr() {
    let folder = Folder::with_scenes();
    let run = folder.volref("render scene.toml -o image.exr");
    assert_shown!(run.shown(), @r"
    exit code 0
    --- stdout
    image.exr: 12 × 10 pixels in [seconds]
    ");
    let film = folder.film("image.exr");
    assert_eq!((film.width(), film.height()), (12, 10));
    assert!(film.opacity().is_some());
    assert!(film.radiance().iter().flatten().any(|value| *value > 0.0));
}

#[test]
fn png_at_an_exposure() {
    let folder = Folder::with_scenes();
    folder.volref("render scene.toml -o image.exr");
    for exposure in ["0", "1.5", "-2"] {
        let arguments = [
            "render",
            "scene.toml",
            "-o",
            "image.PNG",
            "--exposure",
            exposure,
        ];
        assert_eq!(folder.volref(&arguments).code, 0);
        let expected = folder
            .film("image.exr")
            .srgb_codes(exposure.parse().unwrap());
        let (width, height, codes) = Film::codes_from_png(&folder.read("image.PNG")).unwrap();
        assert_eq!((width, height, codes), (12, 10, expected));
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let folder = Folder::with_scenes();
    folder.volref("render scene.toml -o all.exr");
    for threads in ["1", "2", "7"] {
        let run = folder.volref(&[
            "render",
            "scene.toml",
            "-o",
            "some.exr",
            "--threads",
            threads,
        ]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert_eq!(
            folder.read("some.exr"),
            folder.read("all.exr"),
            "{threads} threads"
        );
    }
}

#[test]
fn json() {
    let folder = Folder::with_scenes();
    let run = folder.volref("render curve.toml -o curve.png --json");
    assert_shown!(run.shown(), @r#"
    exit code 0
    --- stdout
    {
      "hash": "[hash]",
      "height": 12,
      "output": "curve.png",
      "scene": "curve.toml",
      "schema": "volref/render/1",
      "seconds": "[seconds]",
      "warnings": [],
      "width": 16
    }
    "#);
}

/// Values that `=` joins to their option; the file of depths in JSON.
#[test]
fn depth_and_its_file() {
    let folder = Folder::with_scenes();
    let render =
        |more: &[&str]| folder.volref(&[&["render", "scene.toml", "-o", "a.exr"], more].concat());
    render(&["--depth", "half"]).expect(2, "unexpected argument 'half'");
    let json = render(&["--json", "--depth=half"]).json();
    let expected = serde_json::json!({ "kind": "half", "file": "a.exr" });
    assert_eq!(json["depth"], expected);
    let beside = ["render", "scene.toml", "-o", "a.npy", "--depth", "--json"];
    let json = folder.volref(&beside).json();
    let expected = serde_json::json!({ "kind": "mean", "file": "a.depth.npy" });
    assert_eq!(json["depth"], expected);
    assert!(render(&["--json"]).json()["depth"].is_null());
}

#[test]
fn an_existing_image_is_replaced_and_nothing_left_beside_it() {
    let folder = Folder::with_scenes();
    folder.write("image.exr", "not an image");
    let before: Vec<_> = folder.files().into_keys().collect();
    assert_eq!(folder.volref("render scene.toml -o image.exr").code, 0);
    assert_eq!(folder.files().into_keys().collect::<Vec<_>>(), before);
    assert_eq!(folder.film("image.exr").width(), 12);
}

#[test]
fn panels_side_by_side() {
    let folder = Folder::with_scenes();
    let panels = "\n[[panel]]\n[[panel]]\nfilm.width = 5\nclassified.interpolation = \"nearest\"\n";
    folder.write("panels.toml", folder.text("scene.toml") + panels);
    folder.volref("render scene.toml -o one.exr");
    let run = folder.volref("render panels.toml -o two.exr");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let (one, two) = (folder.film("one.exr"), folder.film("two.exr"));
    assert_eq!((two.width(), two.height()), (12 + 5, 10));
    for row in 0..10 {
        assert_eq!(
            two.radiance()[17 * row..][..12],
            one.radiance()[12 * row..][..12]
        );
    }
}

/// A scene and the command line take the same numbers of samples, and refuse others alike.
#[test]
fn as_many_samples_as_a_scene_may_have() {
    let folder = Folder::with_scenes();
    for samples in ["0", "2147483649", "3000000000", "18446744073709551616"] {
        let message = format!("`samples` must lie in [1, 2147483648], got {samples}");
        let render = ["render", "curve.toml", "-o", "curve.png", "--spp", samples];
        folder.volref(&render).expect(2, &[&message]);
        let scene = format!(
            "[sampling]\nsamples = {samples}\n[radiative]\n\
             [camera]\neye = [0, 0, -3]\ntarget = [0, 0, 0]\n"
        );
        folder.write("samples.toml", scene);
        let render = ["render", "samples.toml", "-o", "samples.png"];
        folder.volref(&render).expect(2, &[&message]);
    }
    let most = [
        "render",
        "curve.toml",
        "-o",
        "curve.png",
        "--spp",
        "2147483648",
    ];
    folder.volref(&most).expect(0, "");
}

/// Found out before the work and not after it, and no other than `plan` has said.
#[cfg(unix)]
#[test]
fn an_image_that_there_is_no_memory_for() {
    let folder = Folder::new();
    folder.write(
        "large.toml",
        "[film]\nwidth = 16384\nheight = 16384\n[curve]\n",
    );
    let plan = folder.volref("plan large.toml --json").json();
    // Radiance and opacity.
    assert_eq!(plan["image"]["bytes"], 16_u64 << 28);
    let most = plan["image"]["most_bytes"].as_u64().unwrap();
    assert!(most > 48 << 28, "{most}");
    let plan = folder.volref("plan large.toml").stdout;
    assert!(
        plan.starts_with("image      16384 × 16384 pixels, 4.00 GiB; at most "),
        "{plan}"
    );
    let mut limited = std::process::Command::new("sh");
    limited
        .args([
            "-c",
            "ulimit -v 4000000 && exec \"$0\" render large.toml -o large.exr --threads 2",
        ])
        .arg(env!("CARGO_BIN_EXE_volref"))
        .current_dir(folder.path(""));
    let run = crate::folder::Run::of(limited.output().unwrap());
    let message = format!(
        "no memory for an image of 16384 × 16384 pixels: {:.2} GiB are held while it is rendered \
         and written; make film.width and film.height smaller",
        most as f64 / f64::from(1 << 30)
    );
    run.expect(2, &[&message]);
    assert!(!folder.path("large.exr").exists());
}

/// Conventions and the integral have one renderer each: `--reference` gives its image.
#[test]
fn the_reference_honours_conventions_and_integrals() {
    let folder = Folder::with_scenes();
    let hash = |name: &str, how: &[&str]| {
        let command = [&["render", name, "-o", "image.exr", "--json"], how].concat();
        folder.volref(&command).json()["hash"].clone()
    };
    let scene = |keys: &str| crate::folder::scene(keys).replace("../../volumes/", "");
    let whole = "[classified.conventions]\nlast_step = \"whole\"\n";
    for (name, keys) in [
        ("own.toml", ""),
        ("whole.toml", whole),
        ("continuous.toml", "compositing = \"continuous\"\n"),
    ] {
        folder.write(name, scene(keys));
        assert_eq!(hash(name, &["--reference"]), hash(name, &[]), "{name}");
    }
    let own = hash("own.toml", &["--reference"]);
    assert_ne!(own, hash("whole.toml", &["--reference"]));
    assert_ne!(own, hash("continuous.toml", &["--reference"]));
}
