//! What lasts says what it does and how long it will take, on stderr.

use crate::folder::{Folder, SIGN_OF_LIFE};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// A process that ends with the test.
struct EndedRun(Child);

impl Drop for EndedRun {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Runs a command until it has said all the `parts`, in this order, each on a line of its own; then
/// ends it. Fails where it ends before.
fn said(mut command: Command, parts: &[&str]) -> String {
    let mut child = EndedRun(
        command
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap(),
    );
    let lines = BufReader::new(child.0.stderr.take().unwrap()).lines();
    let (mut all, mut left) = (String::new(), parts.iter().peekable());
    for line in lines {
        let line = line.unwrap();
        all.push_str(&line);
        all.push('\n');
        if left.peek().is_some_and(|part| line.contains(**part)) {
            assert!(line.starts_with(SIGN_OF_LIFE), "{line}");
            left.next();
        }
        if left.peek().is_none() {
            return all;
        }
    }
    panic!("{:?} was not said: {all}", left.next());
}

const FOG: &str = "\
film = { width = 64, height = 64 }
camera = { eye = [0, 0, -3], target = [0, 0, 0] }
[radiative]
environment = 1
[[radiative.medium]]
sphere = { centre = [0, 0, 0], radius = 1 }
";

/// How much is done and how much is left.
#[test]
fn a_render_of_many_samples() {
    let folder = Folder::new();
    folder.write("fog.toml", format!("{FOG}sigma_s = 2\nsigma_a = 1\n"));
    let render = "render fog.toml -o fog.exr --spp 1000000 --threads 2";
    said(folder.command(render), &[" left"]);
    assert!(!folder.path("fog.exr").exists());
}

/// In a pipe too: which case, and how much is done.
#[test]
fn the_suite() {
    let folder = Folder::new();
    let command = |arguments: &[&str]| {
        let mut command = folder.command(arguments);
        command.current_dir(env!("CARGO_MANIFEST_DIR"));
        command
    };
    said(command(&["verify", "--threads", "1"]), &["% done, "]);
    let quick = ["selftest", "--quick", "figures"];
    said(command(&quick), &["% done, "]);
}
