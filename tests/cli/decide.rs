//! `volref validate --decide`: looks at more and more samples, with volref as the other renderer.

use crate::folder::Folder;
use serde_json::Value;
use volref::film::Film;

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
    assert!(notes(&case).contains("looks: "), "{case}");
    // More than the 3 % of the manifest: four times what the noise of the golden hides, which takes a fifteenth
    // of its samples, about.
    let notes = notes(&case);
    let samples = notes
        .split("samples per pixel: ")
        .nth(1)
        .and_then(|rest| rest.split(';').next());
    let samples: u32 = samples.unwrap().parse().unwrap();
    assert!(samples > 8192 / 32, "{notes}");

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
    assert!(notes(&case).contains("looks: 3;"), "{case}");
    // What is kept is the image that was judged.
    let run = folder.volref("validate --outputs kept");
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

/// Looks at images of the same random numbers are one look.
#[test]
fn a_renderer_without_seeds_is_told() {
    // As many pixels as it takes to be sure.
    let folder =
        Folder::with_room("converged_samples = 1024\nresolution = 0.9\nmean_resolution = 0.03");
    let scene = "fixtures/scenes/fog/room.toml";
    folder.edit(scene, "width = 16", "width = 48");
    folder.edit(scene, "height = 16", "height = 48");
    folder.accept_all();
    let (code, case) = validated(&folder, &renderer("--seed 7"), &["--decide"]);
    assert_eq!((code, case["verdict"].as_str()), (5, Some("inconclusive")));
    assert!(notes(&case).contains("share random numbers"), "{case}");
}

/// Not "inconclusive", whatever the first call showed.
#[cfg(unix)]
#[test]
fn a_later_crash_is_an_error() {
    let folder = room();
    let once = "if [ -e begun ]; then exit 3; fi; touch begun; ";
    let command = format!("sh -c '{once}{}'", renderer("--seed {seed}"));
    let (code, case) = validated(&folder, &command, &["--decide"]);
    assert_eq!(
        (code, case["verdict"].as_str()),
        (4, Some("error")),
        "{case}"
    );
    assert!(notes(&case).contains("call 2 failed"), "{case}");
}

/// Ctrl-C ends the decision, not the verdicts: a renderer that runs is ended.
#[cfg(unix)]
#[test]
fn an_interrupted_decision_keeps_its_verdicts() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};

    let folder = room();
    let once = "if [ -e begun ]; then sleep 600; fi; touch begun; ";
    let command = format!("sh -c '{once}{}'", renderer("--seed {seed}"));
    let arguments = [
        "validate",
        "--run",
        &command,
        "--spp",
        "16",
        "--explain",
        "0",
        "--json",
        "--decide",
    ];
    let mut child = folder
        .command(&arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let is_second = |line: &std::io::Result<String>| line.as_ref().unwrap().contains("look 2");
    let mut lines = lines.skip_while(move |line| !is_second(line));
    let _ = lines.next().expect("a second look");
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    let mut text = String::new();
    child
        .stdout
        .take()
        .unwrap()
        .read_to_string(&mut text)
        .unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(5), "{text}");
    let value: Value = serde_json::from_str(&text).unwrap();
    let case = &value["cases"][0];
    assert_eq!(case["verdict"], "inconclusive");
    assert!(notes(case).contains("; interrupted"), "{case}");
}

#[test]
fn usage() {
    let folder = Folder::with_goldens();
    for arguments in [
        &["--outputs", ".", "--decide"][..],
        &["--run", "true", "--budget", "1m"],
        &["--run", "true", "--decide", "--budget", "soon"],
        &["--run", "true", "--decide", "--budget=-1s"],
        &["--run", "true", "--decide", "--budget", "-5s"],
        &["--run", "true", "--decide", "--format", "png"],
    ] {
        let run = folder.volref(&[&["validate"][..], arguments].concat());
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
    }
}

/// Bad images from a later call on: the verdict is that on a single image of their kind.
#[cfg(unix)]
#[test]
fn bad_images_of_later_calls_fail_like_single_ones() {
    let folder = room();
    let image = |side: usize, pixel: &dyn Fn(usize) -> f32| {
        let means = (0..side * side).map(|at| [pixel(at); 3]).collect();
        let variances = vec![[0.01; 3]; side * side];
        Film::with_noise(side, side, means, variances, 16)
    };
    let images = [
        ("nan", image(16, &|_| f32::NAN)),
        (
            "infinite",
            image(16, &|at| if at == 40 { f32::INFINITY } else { 0.5 }),
        ),
        ("size", image(8, &|_| 0.5)),
    ];
    for (name, film) in &images {
        folder.write_film(&format!("{name}.exr"), film);
        folder.write(&format!("{name}.npy"), film.to_npy());
    }
    let kinds = images
        .iter()
        .flat_map(|(name, _)| [(name, "exr"), (name, "npy")]);
    for ((name, format), from) in kinds.zip([2, 3, 2, 5, 3, 2]) {
        let bad = format!("cp {name}.{format} {{output}}");
        let (code, alone) = validated(&folder, &bad, &["--format", format]);
        assert_eq!((code, alone["verdict"].as_str()), (1, Some("fail")));
        let good = renderer("--seed {seed}");
        let command = format!("sh -c 'if [ {{seed}} -lt {from} ]; then {good}; else {bad}; fi'");
        let kept = format!("kept-{name}-{format}");
        let arguments = ["--decide", "--format", format, "--keep", &kept];
        let (code, case) = validated(&folder, &command, &arguments);
        let said = format!("{name}.{format}: {case}");
        assert_eq!((code, &case["verdict"]), (1, &alone["verdict"]), "{said}");
        assert_eq!(case["metrics"], alone["metrics"], "{said}");
        assert_eq!(case["reason"], alone["reason"], "{said}");
        let call = format!("the image of call {from} cannot be added");
        assert!(notes(&case).contains(&call), "{said}");
        // What is kept is what failed.
        let kept = folder.read(&format!("{kept}/fog/room.{format}"));
        assert!(kept == folder.read(&format!("{name}.{format}")), "{said}");
    }
}
