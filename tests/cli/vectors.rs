//! The runners of the test vectors, `vectors/run.*`: right as they are, and wrong with each mistake.

use crate::needs::is_there;
use std::path::{Path, PathBuf};
use std::process::Command;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("vectors")
}

const MISTAKES: [&str; 5] = ["order", "correction", "backward", "shifted", "gamma"];

/// Runs `command` as it is and with each mistake, where `program` is there.
fn judges(program: &str, command: impl Fn(Option<&str>) -> Command) {
    if !is_there(program, &format!("the test vectors by {program}")) {
        return;
    }
    let ran = |mistake| command(mistake).output().unwrap();
    let right = ran(None);
    let said = String::from_utf8(right.stdout).unwrap();
    assert!(right.status.success(), "{said}");
    assert!(said.contains(" 0 failed"), "{said}");
    for mistake in MISTAKES {
        let wrong = ran(Some(mistake));
        assert_eq!(wrong.status.code(), Some(1), "{program} {mistake}");
    }
}

#[test]
fn runners_find_mistakes() {
    for (program, name) in [("python3", "run.py"), ("node", "run.js")] {
        judges(program, |mistake| {
            let mut command = Command::new(program);
            command.arg(folder().join(name)).args(mistake);
            command
        });
    }
}

#[test]
fn the_runner_in_c_finds_mistakes() {
    if !is_there("cc", "the test vectors by cc") {
        return;
    }
    let build = tempfile::tempdir().unwrap();
    let program = build.path().join("run");
    let compiled = Command::new("cc")
        .args(["-O1", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&program)
        .arg(folder().join("run.c"))
        .arg("-lm")
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{compiled:?}");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "json")
        })
        .collect();
    files.sort();
    judges("cc", |mistake| {
        let mut command = Command::new(&program);
        command.args(&files);
        if let Some(mistake) = mistake {
            command.args(["-m", mistake]);
        }
        command
    });
}

#[test]
fn runners_are_short() {
    for name in ["run.py", "run.js", "run.c"] {
        let text = std::fs::read_to_string(folder().join(name)).unwrap();
        assert!(text.lines().count() <= 100, "{name}");
    }
}
