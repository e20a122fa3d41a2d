//! What some tests need beside Rust and a C compiler, and how much they try.
//!
//! A test asks [`is_there`] for each program. Where one is missing, the test passes and leaves a record for the last test
//! program, `tests/what_was_not_tried.rs`, which prints all of them: cargo shows nothing that a passing test prints. In
//! CI, where the environment holds `VOLREF_TEST_EVERYTHING`, such a test fails.
//!
//! Tests that need more than a package manager installs (Slurm, renderers to be built) are no such tests: they are
//! ignored, or campaigns of `scripts/nightly.sh`.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Python with NumPy, as a need.
#[allow(dead_code, reason = "not every test program needs it")]
pub const NUMPY: &str = "python3 with NumPy";

/// How much a test tries: `always`, and `nightly` where `VOLREF_NIGHTLY` was set when the tests were compiled.
#[allow(dead_code, reason = "not every test program tries more at night")]
pub const fn tries(always: usize, nightly: usize) -> usize {
    match option_env!("VOLREF_NIGHTLY") {
        Some(_) => nightly,
        None => always,
    }
}

const EVERYTHING: &str = "VOLREF_TEST_EVERYTHING";

/// True if the program `need`, or [`NUMPY`], is there; else `what` is not tried.
#[allow(dead_code, reason = "not every test program needs a program")]
pub fn is_there(need: &str, what: &str) -> bool {
    let (program, arguments) = match need {
        NUMPY => ("python3", ["-c", "import numpy"].as_slice()),
        program => (program, ["--version"].as_slice()),
    };
    let mut run = Command::new(program);
    run.args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let found = run.status().is_ok_and(|status| status.success());
    tried(found, need, what)
}

/// Notes whether `what` is tried, for which `need` is there; returns that.
pub fn tried(is_tried: bool, need: &str, what: &str) -> bool {
    let record = records().join(plain(what));
    if is_tried {
        // Of an earlier run.
        let _ = std::fs::remove_file(record);
        return true;
    }
    assert!(
        std::env::var_os(EVERYTHING).is_none_or(|value| value.is_empty()),
        "{what}: not tried, for that needs {need}; {EVERYTHING} asks for everything"
    );
    std::fs::create_dir_all(records()).unwrap();
    std::fs::write(record, format!("{need}: {what}\n")).unwrap();
    false
}

/// Folder of the records.
pub fn records() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("not-tried")
}

/// `text` as the name of a file.
fn plain(text: &str) -> String {
    let plain = |letter: char| match letter.is_ascii_alphanumeric() {
        true => letter,
        false => '-',
    };
    text.chars().map(plain).collect()
}
