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
[film]
width = 64
height = 64
[camera]
eye = [0, 0, -3]
target = [0, 0, 0]
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

/// A walk that would never come to an end is warned of before it is begun.
#[test]
fn a_render_without_an_end() {
    let folder = Folder::new();
    folder.write("deep.toml", format!("{FOG}sigma_s = 65536\nsigma_a = 0\n"));
    let note = "note: light deep inside this medium is scattered about 2.1e9 times, as its middle \
                is 6.554e4 mean free paths deep and little is absorbed; rendering may fail, at a \
                path of 2^26 scatterings; `max_bounces = 10000` bounds the work, and leaves out \
                scattering of higher order  (radiative.medium[0].sigma_s, line 11)";
    let render = ["render", "deep.toml", "-o", "deep.exr", "--spp", "1000000"];
    said(folder.command(&render), &[note]);
    let run = folder.volref("plan deep.toml");
    run.expect(0, "");
    assert!(
        run.stdout.contains(note.strip_prefix("note: ").unwrap()),
        "{}",
        run.stdout
    );
    for short in [
        "sigma_s = 65536\nsigma_a = 65.5\n",
        "sigma_s = 100\nsigma_a = 0\n",
        "sigma_s = 10000\nsigma_a = 0\ng = 0.9999\n",
    ] {
        folder.write("short.toml", format!("{FOG}{short}"));
        let run = folder.volref("plan short.toml");
        run.expect(0, "");
        assert!(!run.stdout.contains("warnings"), "{short}: {}", run.stdout);
    }
    let bounded = FOG.replace("environment = 1", "environment = 1\nmax_bounces = 10000");
    folder.write(
        "bounded.toml",
        format!("{bounded}sigma_s = 65536\nsigma_a = 0\n"),
    );
    let run = folder.volref("plan bounded.toml");
    assert!(!run.stdout.contains("warnings"), "{}", run.stdout);
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
