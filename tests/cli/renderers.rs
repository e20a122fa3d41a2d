//! Renderers that `validate --run` calls, and what they leave behind.

use crate::folder::{Folder, Run};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longer than anything here takes, on any machine.
const LONG: Duration = Duration::from_secs(120);

/// A suite with goldens, and the renderer `renderer.sh`, which is called with the name of a case
/// and where its image goes.
fn with_renderer(script: &str) -> Folder {
    let folder = Folder::with_goldens();
    folder.write("renderer.sh", script);
    folder
}

fn validate(folder: &Folder, arguments: &[&str]) -> Command {
    let command = ["validate", "--run", "sh renderer.sh {case} {output}"];
    folder.command(&[&command[..], arguments].concat())
}

fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < LONG, "{what}");
        sleep(Duration::from_millis(10));
    }
}

/// Volref that is told to end ends its renderers first.
#[test]
fn renderers_end_with_volref() {
    for signal in ["TERM", "INT"] {
        let folder = with_renderer("echo $$ > pid; sleep 1000");
        let mut command = validate(&folder, &["smoke/plain"]);
        let mut child = command.stdout(Stdio::null()).spawn().unwrap();
        let has_started =
            || std::fs::read_to_string(folder.path("pid")).is_ok_and(|pid| pid.ends_with('\n'));
        until("the renderer starts", has_started);
        let kill = Command::new("kill")
            .args(["-s", signal, &child.id().to_string()])
            .status();
        assert!(kill.unwrap().success());
        child.wait().unwrap();
        let process = format!("/proc/{}/stat", folder.text("pid").trim());
        until("it ends", || !std::path::Path::new(&process).exists());
    }
}

/// CTest collects elements from all that a test prints, whoever's words they are.
#[test]
fn with_ctest_only_measurements_are_elements() {
    let forged = "<CTestMeasurementFile type='image/png' name='forged'>/etc/hostname\
                  </CTestMeasurementFile>";
    let folder = with_renderer(&format!(
        "case $1 in *plain) cp golden/$1.exr $2;; *) echo \"{forged}\"; exit 1;; esac"
    ));
    let of = |arguments: &[&str]| {
        let arguments = [arguments, &["--ctest", "pictures", "--explain=0"]].concat();
        Run::of(validate(&folder, &arguments).output().unwrap())
    };
    let run = of(&["smoke/plain", "smoke/nearest"]);
    run.prints(4, "&lt;CTestMeasurementFile");
    let (elements, words): (Vec<&str>, Vec<&str>) = run
        .stdout
        .lines()
        .partition(|line| line.starts_with("<CTestMeasurement"));
    assert!(words.iter().all(|line| !line.contains('<')), "{words:?}");
    assert!(elements.len() > 5, "{elements:?}");
    for line in elements {
        assert!(line.contains(" name=\"smoke/"), "{line}");
        assert!(!line.contains("hostname"), "{line}");
    }

    let json = of(&["smoke/nearest", "--json"]);
    assert!(!json.stdout.contains('<'), "{}", json.stdout);
    let reason = json.json()["cases"][0]["reason"].clone();
    assert!(reason.as_str().unwrap().contains(forged), "{reason}");

    folder.write("profile.toml", format!("{forged}\n"));
    for wrong in [
        &["--as", "profile.toml"][..],
        &[forged],
        &["--as=x", "--spp", forged],
    ] {
        let run = of(wrong);
        assert_ne!(run.code, 0, "{}", run.stdout);
        let said = run.stdout + &run.stderr;
        assert!(
            said.contains("&lt;CTestMeasurementFile") && !said.contains('<'),
            "{said}"
        );
    }
}

/// CDash compares pictures by these names alone.
#[test]
fn pictures_have_the_names_of_cdash() {
    let folder = with_renderer("cp golden/smoke/plain.exr $2");
    let run = Run::of(
        validate(&folder, &["smoke/plain", "--ctest=pictures"])
            .output()
            .unwrap(),
    );
    let named = |(name, file)| {
        let file = folder.path(&format!("pictures/smoke/plain/{file}.png"));
        format!(
            "<CTestMeasurementFile type=\"image/png\" name=\"{name}\">{}</CTestMeasurementFile>",
            file.display()
        )
    };
    let files = [
        ("ValidImage", "golden"),
        ("TestImage", "test"),
        ("DifferenceImage2", "difference"),
    ];
    run.prints(0, &files.map(named).each_ref().map(String::as_str));
}
