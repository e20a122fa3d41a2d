//! Renderers that `validate --run` calls, and what they leave behind.

use crate::folder::{Folder, Run};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longer than anything here takes, on any machine.
const LONG: Duration = Duration::from_secs(120);

/// A suite with goldens, and the renderer `renderer.sh`, which is called with the name of a case
/// and where its image goes. It can make a daemon: a process in a session of its own, without a
/// parent, without an environment, whose number goes into a file.
fn with_renderer(script: &str) -> Folder {
    let folder = Folder::with_goldens();
    let daemon = "daemon() { env -i setsid sh -c \"($1) & echo \\$! > $2.new; mv $2.new $2\"; }\n";
    folder.write("renderer.sh", format!("{daemon}{script}"));
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

/// What stands in `/proc` for the process whose number is in the file `name`.
fn process(folder: &Folder, name: &str) -> PathBuf {
    PathBuf::from(format!("/proc/{}/stat", folder.text(name).trim()))
}

/// Daemons run in a session of their own and belong to nobody; their time is over all the same.
#[test]
fn a_daemon_does_not_outlive_its_renderers_time() {
    let folder = with_renderer("daemon 'exec sleep 1000' pid; sleep 1000");
    let mut command = validate(&folder, &["smoke/plain", "--timeout", "1"]);
    let run = Run::of(command.output().unwrap());
    run.prints(
        4,
        "did not end within 1 s and was ended, with all that it had started",
    );
    assert!(!process(&folder, "pid").exists(), "the daemon is gone");
}

/// What a renderer leaves running is ended, and said; its image counts.
#[test]
fn what_a_renderer_leaves_running_is_said() {
    let folder = with_renderer("cp golden/$1.exr $2; daemon 'exec sleep 1000' pid");
    let mut command = validate(&folder, &["smoke/plain", "--report", "report"]);
    let run = Run::of(command.output().unwrap());
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let number = folder.text("pid").trim().to_owned();
    let note = format!(
        "note: the renderer left processes running, which were ended: sleep (process \
         {number})"
    );
    assert!(run.stdout.contains(&note), "{}", run.stdout);
    let page = folder.text("report/index.html");
    assert!(page.contains(&format!("sleep (process {number})")));
    assert!(!process(&folder, "pid").exists(), "the daemon is gone");

    let run = Run::of(
        validate(&folder, &["smoke/plain", "--json"])
            .output()
            .unwrap(),
    );
    let notes = run.json()["cases"][0]["notes"].clone();
    let left = notes
        .as_array()
        .unwrap()
        .iter()
        .filter(|note| note.as_str().unwrap().contains("left processes"));
    assert_eq!(left.count(), 1, "{notes}");
}

/// Of two renderers at work, one's end is not that of the other's daemon, which renders.
#[test]
fn each_renderer_has_its_own_daemons() {
    let folder = with_renderer(
        "case $1 in\n\
         smoke/plain)\n\
           daemon \"until [ -e over ]; do sleep 0.01; done; cp golden/$1.exr $2.new; \
                    mv $2.new $2\" pid\n\
           until [ -e $2 ]; do sleep 0.01; done;;\n\
         smoke/nearest)\n\
           until [ -e pid ]; do sleep 0.01; done\n\
           daemon 'exec sleep 1000' other\n\
           cp golden/$1.exr $2;;\n\
         *)\n\
           until ! [ -e /proc/$(cat other)/stat ]; do sleep 0.01; done\n\
           cp golden/$1.exr $2; touch over;;\n\
         esac\n",
    );
    let arguments = ["smoke/*", "--jobs", "3", "--timeout", "100", "--json"];
    let run = Run::of(validate(&folder, &arguments).output().unwrap());
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert_eq!(run.json()["summary"]["pass"], 3);
}

/// However volref ends, its renderers end too.
#[test]
fn renderers_end_with_volref() {
    for signal in ["KILL", "TERM", "INT"] {
        let folder = with_renderer("daemon 'exec sleep 1000' daemon; echo $$ > pid; sleep 1000");
        let mut command = validate(&folder, &["smoke/plain"]);
        let mut child = command.stdout(Stdio::null()).spawn().unwrap();
        until("the renderer starts", || folder.path("pid").exists());
        until("its number is written", || {
            folder.text("pid").ends_with('\n')
        });
        let kill = Command::new("kill")
            .args(["-s", signal, &child.id().to_string()])
            .status();
        assert!(kill.unwrap().success());
        child.wait().unwrap();
        for name in ["pid", "daemon"] {
            until(&format!("{name} ends after {signal}"), || {
                !process(&folder, name).exists()
            });
        }
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

/// A keeper is no command for people.
#[test]
fn keepers_are_not_shown() {
    let folder = Folder::with_suite();
    let help = folder.volref("--help");
    assert!(!help.stdout.contains("__keep"), "{}", help.stdout);
}
