//! `volref validate --decide`: looks at more and more samples, with volref as the other renderer.

use crate::folder::Folder;
use serde_json::Value;

/// A suite of one stochastic case whose golden has little noise.
fn room() -> Folder {
    let folder =
        Folder::with_room("converged_samples = 8192\nresolution = 0.9\nmean_resolution = 0.03");
    folder.accept_all();
    folder
}

/// The renderer, with further arguments.
fn renderer(more: &str) -> String {
    let volref = env!("CARGO_BIN_EXE_volref");
    format!("{volref} render {{scene}} -o {{output}} --spp {{spp}} {more}")
}

/// The exit code and the result of the case.
fn validated(folder: &Folder, command: &str, more: &[&str]) -> (i32, Value) {
    let arguments = [
        "validate",
        "--run",
        command,
        "--spp",
        "16",
        "--explain",
        "0",
        "--json",
    ];
    let run = folder.volref(&[&arguments[..], more].concat());
    assert!(
        run.stderr.is_empty() || !run.stderr.contains("error"),
        "{}",
        run.stderr
    );
    (run.code, run.json()["cases"][0].clone())
}

fn notes(case: &Value) -> String {
    let notes = case["notes"].as_array().cloned().unwrap_or_default();
    let notes: Vec<&str> = notes.iter().filter_map(Value::as_str).collect();
    notes.join("\n")
}

#[test]
fn what_noise_leaves_open_is_decided() {
    let folder = room();
    let honest = renderer("--seed {seed}");
    let (code, open) = validated(&folder, &honest, &[]);
    assert_eq!((code, open["verdict"].as_str()), (5, Some("inconclusive")));

    let (code, case) = validated(&folder, &honest, &["--decide"]);
    assert_eq!(
        (code, case["verdict"].as_str()),
        (0, Some("pass")),
        "{case}"
    );
    assert!(notes(&case).contains(" looks, "), "{case}");
    // More than the 3 % of the manifest: three times what the noise of the golden hides, which takes an eighth
    // of its samples, about.
    let notes = notes(&case);
    let samples = notes
        .split(" looks, ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let samples: u32 = samples.unwrap().parse().unwrap();
    assert!(samples > 8192 / 16, "{notes}");

    // 16 samples do not show a wall that is 7 % too bright.
    let biased = renderer("--seed {seed} --change reflectance=0.07");
    let (code, open) = validated(&folder, &biased, &[]);
    assert_eq!((code, open["verdict"].as_str()), (5, Some("inconclusive")));
    let (code, case) = validated(&folder, &biased, &["--decide", "--budget", "5m"]);
    assert_eq!(
        (code, case["verdict"].as_str()),
        (1, Some("fail")),
        "{case}"
    );
}

/// An image that does not state its noise is rendered sixteen times.
#[test]
fn silent_images_are_decided_by_their_spread() {
    let folder = room();
    let arguments = ["--decide", "--format", "npy", "--keep", "kept"];
    let (code, case) = validated(&folder, &renderer("--seed {seed}"), &arguments);
    assert_eq!(
        (code, case["verdict"].as_str()),
        (0, Some("pass")),
        "{case}"
    );
    assert!(notes(&case).contains("3 looks"), "{case}");
    // What is kept is the image that was judged.
    let run = folder.volref(&["validate", "--outputs", "kept"]);
    assert_eq!(run.code, 0, "{} {}", run.stdout, run.stderr);
}

#[test]
fn what_ends_a_decision_is_said() {
    let folder = room();
    let honest = renderer("--seed {seed}");
    let (code, case) = validated(&folder, &honest, &["--decide", "--budget", "0s"]);
    assert_eq!((code, case["verdict"].as_str()), (5, Some("inconclusive")));
    assert!(notes(&case).contains("of the budget are left"), "{case}");

    let (code, case) = validated(
        &folder,
        &renderer("--seed 7"),
        &["--decide", "--format", "npy"],
    );
    assert_eq!((code, case["verdict"].as_str()), (5, Some("inconclusive")));
    assert!(notes(&case).contains("the same in every bit"), "{case}");
}

#[test]
fn usage() {
    let folder = Folder::with_goldens();
    for arguments in [
        &["--outputs", ".", "--decide"][..],
        &["--run", "true", "--budget", "1m"],
        &["--run", "true", "--decide", "--budget", "soon"],
        &["--run", "true", "--decide", "--budget=-1s"],
    ] {
        let run = folder.volref(&[&["validate"][..], arguments].concat());
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
    }
}
