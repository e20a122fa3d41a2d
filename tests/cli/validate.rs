//! `volref validate`: finished images, and renderers that are run.

use crate::folder::{Folder, Run, assert_shown};
use serde_json::Value;
use volref::film::Film;

/// A suite with goldens, and in `out/` a right image of every case.
fn with_images() -> Folder {
    let folder = Folder::with_goldens();
    for case in [
        "plots/curve",
        "smoke/nearest",
        "smoke/plain",
        "smoke/shadow",
    ] {
        folder.write(
            &format!("out/{case}.exr"),
            folder.read(&format!("golden/{case}.exr")),
        );
    }
    folder
}

fn film(folder: &Folder, name: &str) -> Film {
    Film::from_exr(&folder.read(name)).unwrap()
}

/// The result of the case of that name.
fn case(run: &Run, name: &str) -> Value {
    let json = run.json();
    let cases = json["cases"].as_array().unwrap();
    let found = cases.iter().find(|case| case["name"] == name);
    found
        .unwrap_or_else(|| panic!("{name} is not among the results"))
        .clone()
}

#[test]
fn right_images_pass() {
    let folder = with_images();
    let before = folder.files();
    let run = folder.volref(&["validate", "--outputs", "out"]);
    assert_shown!(run.shown(), @r"
    exit code 0
    --- stdout
    pass          plots/curve [seconds]
    pass          smoke/nearest [seconds]
    pass          smoke/plain [seconds]
    pass          smoke/shadow [seconds]

    4 cases: 4 passed
    ");
    assert_eq!(folder.files(), before, "validate writes nothing unasked");
}

/// What is there is judged, what is missing is said, and weighs more than a difference.
#[test]
fn missing_images() {
    let folder = with_images();
    folder.remove("out/smoke/plain.exr");
    let golden = film(&folder, "golden/smoke/nearest.exr");
    let dark = golden
        .radiance()
        .iter()
        .map(|p| p.map(|x| 0.5 * x))
        .collect();
    let dark = Film::new(golden.width(), golden.height(), dark);
    folder.write("out/smoke/nearest.exr", dark.to_exr().unwrap());
    let run = folder.volref(&["validate", "--outputs", "out", "--json"]);
    assert_eq!(run.code, 4);
    assert_eq!(case(&run, "smoke/plain")["verdict"], "missing");
    assert_eq!(case(&run, "smoke/nearest")["verdict"], "fail");
    assert_eq!(case(&run, "smoke/shadow")["verdict"], "pass");
    assert_eq!(run.json()["schema"], "volref/validate/1");
    assert_eq!(run.json()["summary"]["missing"], 1);

    let run = folder.volref(&["validate", "--outputs", "out", "--only-present", "--json"]);
    assert_eq!(run.code, 1);
    assert_eq!(run.json()["cases"].as_array().unwrap().len(), 3);
    let run = folder.volref(&[
        "validate",
        "smoke/plain",
        "--outputs",
        "out",
        "--only-present",
    ]);
    assert_eq!(run.code, 5);
    assert!(
        run.message().contains("nothing was compared"),
        "{}",
        run.stderr
    );
}

/// The mistake is named in the result of the case and for all together, with what to do.
#[test]
fn mistakes_are_named() {
    let folder = with_images();
    let run = folder.volref(&[
        "render",
        "fixtures/scenes/smoke/plain.toml",
        "-o",
        "right.exr",
    ]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let right = film(&folder, "right.exr");
    let bright = right.radiance().iter().map(|p| p.map(|x| 2.0 * x));
    let wrong = Film::new(right.width(), right.height(), bright.collect());
    folder.write("out/smoke/plain.exr", wrong.to_exr().unwrap());
    let run = folder.volref(&["validate", "--outputs", "out", "--json"]);
    assert_eq!(run.code, 1);
    assert_eq!(case(&run, "smoke/plain")["looks_like"][0], "bright-doubled");
    assert_eq!(
        case(&run, "smoke/shadow")["looks_like"],
        serde_json::json!([])
    );
    let likely = &run.json()["looks_like"][0];
    assert_eq!(likely["mistake"], "bright-doubled");
    assert_eq!(
        (likely["explains"].clone(), likely["of"].clone()),
        (1.into(), 1.into())
    );

    // A mistake of the scene: as though the volume had no opacity correction.
    folder.write(
        "wrong.toml",
        folder
            .text("fixtures/scenes/smoke/shadow.toml")
            .replace(
                "reference_length = \"0.2 voxels\"",
                "reference_length = \"0.5 voxels\"",
            )
            .replace("../../", "fixtures/"),
    );
    let run = folder.volref(&["render", "wrong.toml", "-o", "out/smoke/shadow.exr"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let run = folder.volref(&["validate", "shadow", "--outputs", "out"]);
    assert_eq!(run.code, 1);
    assert!(
        run.stdout
            .contains("looks like  opacity-uncorrected (1 of 1 case)"),
        "{}",
        run.stdout
    );
}

#[test]
fn images_that_are_none() {
    let folder = with_images();
    folder.write("out/smoke/plain.exr", "no image");
    let run = folder.volref(&["validate", "--outputs", "out", "--json"]);
    assert_eq!(run.code, 4);
    assert_eq!(case(&run, "smoke/plain")["verdict"], "error");

    folder.write("out/smoke/plain.exr", folder.read("golden/plots/curve.exr"));
    let run = folder.volref(&["validate", "--outputs", "out", "--json"]);
    assert_eq!(run.code, 1);
    let reason = case(&run, "smoke/plain")["reason"].clone();
    assert!(
        reason.as_str().unwrap().starts_with("size differs"),
        "{reason}"
    );

    let golden = film(&folder, "golden/smoke/plain.exr");
    let mut pixels = golden.radiance().to_vec();
    pixels[14][1] = f32::NAN;
    let broken = Film::new(golden.width(), golden.height(), pixels);
    folder.write("out/smoke/plain.exr", broken.to_exr().unwrap());
    let run = folder.volref(&["validate", "--outputs", "out", "--json"]);
    assert_eq!(run.code, 1);
    let found = case(&run, "smoke/plain");
    assert_eq!(found["metrics"]["non_finite_pixels"], 1.0);
    assert!(
        found["reason"].as_str().unwrap().contains("(2, 1)"),
        "{found}"
    );
}

/// A golden that cannot be trusted judges nothing; a missing image weighs more.
#[test]
fn goldens_are_not_trusted_blindly() {
    let folder = with_images();
    folder.edit(
        "golden/smoke/plain.toml",
        "first goldens",
        "second thoughts",
    );
    let run = folder.volref(&["validate", "--outputs", "out"]);
    assert_eq!(run.code, 3);
    folder.remove("out/smoke/plain.exr");
    let run = folder.volref(&["validate", "--outputs", "out"]);
    assert_eq!(run.code, 4);
}

#[test]
fn names_that_belong_to_no_case() {
    let folder = with_images();
    let golden = folder.read("golden/smoke/plain.exr");
    folder.write("out/smoke/plian.exr", &golden);
    folder.write("out/<script>'\"..exr", &golden);
    let run = folder.volref(&["validate", "--outputs", "out"]);
    assert_eq!(run.code, 0);
    assert!(
        run.stdout.contains("did you mean smoke/plain?"),
        "{}",
        run.stdout
    );
}

#[test]
fn usage() {
    let folder = with_images();
    for (arguments, said) in [
        (&["validate"][..], "--outputs <DIR>|--run <CMD>"),
        (
            &["validate", "--outputs", "nowhere"],
            "there is no folder nowhere",
        ),
        (&["validate", "--run", "render {scene}"], "{output}"),
        (
            &["validate", "--run", "r {output} {sceen}"],
            "{sceen} stands for nothing",
        ),
        (&["validate", "--run", "r '{output}"], "a quote is opened"),
        (
            &["validate", "--run", "r {output}", "--timeout", "-1"],
            "positive number of seconds",
        ),
        (
            &["validate", "--outputs", "out", "--junit", "golden/x.xml"],
            "among the goldens",
        ),
    ] {
        let run = folder.volref(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stdout);
        let message = run.stderr.replace('\n', " ");
        assert!(message.contains(said), "{arguments:?}: {message}");
    }
    assert_eq!(
        folder.volref(&["validate", "fog", "--outputs", "out"]).code,
        5
    );
}

/// volref itself is a renderer that can be run.
#[test]
fn a_renderer_is_run() {
    let folder = Folder::with_goldens();
    let renderer = env!("CARGO_BIN_EXE_volref");
    let command = format!("'{renderer}' render {{scene}} --output {{output}}");
    let run = folder.volref(&[
        "validate", "--run", &command, "--jobs", "2", "--keep", "kept",
    ]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert_eq!(
        film(&folder, "kept/smoke/plain.exr").pixel_hash(),
        film(&folder, "golden/smoke/plain.exr").pixel_hash()
    );
    let run = folder.volref(&["validate", "curve", "--run", &command, "--format", "png"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
}

#[cfg(unix)]
#[test]
fn renderers_that_fail() {
    let folder = Folder::with_goldens();
    for (script, verdict, said) in [
        ("exit 3", "error", "ended with exit code 3"),
        (
            "kill -KILL $$",
            "error",
            "crashed: it was ended by signal 9",
        ),
        ("sleep 1000", "error", "did not end within 0.5 s"),
        ("true", "missing", "wrote no image"),
        ("echo x > \"$0\"", "error", "not a readable EXR"),
    ] {
        let command = format!("sh -c '{script}' {{output}}");
        let run = folder.volref(&[
            "validate",
            "smoke/plain",
            "--run",
            &command,
            "--timeout",
            "0.5",
            "--json",
        ]);
        assert_eq!(run.code, 4, "{script}: {}", run.stdout);
        let found = case(&run, "smoke/plain");
        assert_eq!(found["verdict"], verdict, "{script}");
        assert!(
            found["reason"].as_str().unwrap().contains(said),
            "{script}: {found}"
        );
    }
}

/// A scene that a format cannot say is no image of the case, and nothing is run.
#[test]
fn scenes_that_cannot_be_exported() {
    let folder = Folder::with_goldens();
    let run = folder.volref(&[
        "validate",
        "smoke/plain",
        "--run",
        "false {export:mitsuba} {output}",
        "--json",
    ]);
    assert_eq!(run.code, 4);
    let found = case(&run, "smoke/plain");
    assert_eq!(found["verdict"], "missing");
    assert!(
        found["reason"]
            .as_str()
            .unwrap()
            .contains("classified volume"),
        "{found}"
    );
}

#[test]
fn reports_for_people_and_build_servers() {
    let folder = with_images();
    let run = folder.volref(&[
        "validate",
        "--outputs",
        "out",
        "--report",
        "report",
        "--junit",
        "r.xml",
        "--json",
        "r.json",
    ]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let page = folder.text("report/index.html");
    assert!(page.contains("smoke&#x2f;plain"), "names are escaped");
    assert!(
        !page.contains("http://") && !page.contains("https://"),
        "it needs no network"
    );
    assert!(folder.text("r.xml").contains("volref/smoke"));
    let json: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    assert_eq!(json["summary"]["pass"], 4);
}
