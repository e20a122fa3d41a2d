//! Links, pipes and left-overs, where volref chooses the names of files.

use crate::folder::{Folder, Run};
use std::collections::BTreeMap;
use std::os::unix::fs::symlink;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Longer than anything here takes, on any machine.
const LONG: Duration = Duration::from_secs(120);

/// A run that has to end: whoever opens a pipe without a reader waits.
fn ended(mut command: Command) -> Run {
    let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > LONG {
            child.kill().unwrap();
            panic!("{command:?} waits");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Run::of(child.wait_with_output().unwrap())
}

fn run(folder: &Folder, arguments: &[&str]) -> Run {
    ended(folder.command(arguments))
}

fn link(folder: &Folder, to: &str, name: &str) {
    let path = folder.path(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    symlink(folder.path(to), path).unwrap();
}

fn pipe(folder: &Folder, name: &str) {
    let path = folder.path(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let made = Command::new("mkfifo").arg(path).status().unwrap();
    assert!(made.success());
}

/// Puts into the place of a file what must not be written through: in turn a link to a user's file, a link that
/// leads nowhere, and a pipe. Each time `run` is to refuse it, and the user's files stay as they are.
fn traps(folder: &Folder, place: &str, run: impl Fn()) {
    folder.write("home/precious", "mine");
    let set = |trap: usize| match trap {
        0 => link(folder, "home/precious", place),
        1 => link(folder, "home/new", place),
        _ => pipe(folder, place),
    };
    for trap in 0..3 {
        let _ = std::fs::remove_file(folder.path(place));
        set(trap);
        run();
        assert_eq!(folder.text("home/precious"), "mine", "{place} {trap}");
        assert!(!folder.path("home/new").exists(), "{place} {trap}");
    }
    folder.remove(place);
}

/// What a user keeps elsewhere: also files that look like those of volref.
fn home(folder: &Folder) -> BTreeMap<String, Vec<u8>> {
    let rendering = format!("{}.rendering", "a".repeat(64));
    for below in ["", "room/"] {
        folder.write(&format!("home/{below}{rendering}"), "mine");
        folder.write(&format!("home/{below}notes.txt"), "mine");
        folder.write(&format!("home/{below}.volref-abcdef.partial"), "mine");
    }
    at_home(folder)
}

fn at_home(folder: &Folder) -> BTreeMap<String, Vec<u8>> {
    let mut files = folder.files();
    files.retain(|name, _| name.starts_with("home/"));
    files
}

#[test]
fn results_go_through_no_link_and_wait_at_no_pipe() {
    let folder = Folder::with_goldens();
    let part = ["verify", "smoke/plain", "--partition", "slice:1/1"];
    let before = home(&folder);
    for place in [".volref", ".volref/results"] {
        link(&folder, "home", place);
        run(&folder, &part).expect(2, "a symbolic link … move it away");
        assert_eq!(at_home(&folder), before, "{place}");
        folder.remove(place);
    }
    assert_eq!(run(&folder, &part).code, 0);
    let names = folder.files().into_keys();
    let results: Vec<String> = names.filter(|name| name.contains("/results/")).collect();
    assert_eq!(results.len(), 3, "{results:?}");
    for result in results {
        traps(&folder, &result, || {
            run(&folder, &part).expect(2, "move it away");
        });
    }
    // A link that the user names is meant.
    std::fs::create_dir(folder.path("elsewhere")).unwrap();
    link(&folder, "elsewhere", "kept");
    assert_eq!(
        run(&folder, &[&part[..], &["--results", "kept"]].concat()).code,
        0
    );
    assert!(folder.path("elsewhere/results").is_dir());
}

#[test]
fn goldens_stay_in_their_suite() {
    let folder = Folder::with_goldens();
    let accept = ["accept", "smoke/plain", "--reason", "denser"];
    folder.edit("fixtures/volumes/cloud.obj", "0.5 0.5 2", "0.5 0.5 3");
    let outside = Folder::new();
    for place in ["golden/smoke", "golden"] {
        std::fs::rename(folder.path(place), outside.path("moved")).unwrap();
        symlink(outside.path("moved"), folder.path(place)).unwrap();
        let before = outside.files();
        run(&folder, &accept).expect(2, "a symbolic link, not a folder: move it away");
        assert_eq!(outside.files(), before, "{place}");
        folder.remove(place);
        std::fs::rename(outside.path("moved"), folder.path(place)).unwrap();
    }
    traps(&folder, "golden/.lock", || {
        run(&folder, &accept).expect(2, ".lock … move it away");
    });
}

#[test]
fn reports_and_pictures_are_written_through_nothing() {
    let folder = Folder::with_goldens();
    let verify = ["verify", "smoke/plain", "--report", "report"];
    traps(&folder, "report/index.html", || {
        run(&folder, &verify).expect(2, "cannot write report/index.html … move it away");
    });
    let cost = [
        "cost",
        "fixtures/scenes/smoke/plain.toml",
        "--runs",
        "0",
        "--report",
        "costs",
    ];
    traps(&folder, "costs/index.html", || {
        run(&folder, &cost).expect(2, "cannot write costs/index.html … move it away");
    });
    folder.write(
        "images/smoke/plain.exr",
        folder.read("golden/smoke/plain.exr"),
    );
    let ctest = [
        "validate",
        "smoke/plain",
        "--outputs",
        "images",
        "--ctest",
        "pictures",
    ];
    traps(&folder, "pictures/smoke/plain/test.png", || {
        run(&folder, &ctest).expect(2, "pictures/smoke/plain/test.png … move it away");
    });
    std::fs::remove_dir_all(folder.path("pictures/smoke")).unwrap();
    link(&folder, "home", "pictures/smoke");
    run(&folder, &ctest).expect(2, "pictures/smoke … a symbolic link");
    assert_eq!(at_home(&folder).len(), 1);
    // A file that the user names is written through, as ever.
    link(&folder, "home/list", "list.json");
    run(&folder, &["list", "--json=list.json"]).expect(0, "");
    assert!(folder.path("home/list").is_file());
}

#[test]
fn kept_images_are_files() {
    let folder = Folder::with_goldens();
    folder.write(
        "renderer.sh",
        "cp golden/$1.exr own.exr; ln -s \"$PWD/own.exr\" $2\n",
    );
    let validate = |more: &[&str]| {
        let command = [
            "validate",
            "smoke/plain",
            "--run",
            "sh renderer.sh {case} {output}",
        ];
        run(&folder, &[&command[..], more].concat())
    };
    assert_eq!(validate(&["--keep", "kept"]).code, 0);
    let kept = folder.path("kept/smoke/plain.exr");
    assert!(!kept.is_symlink());
    assert!(folder.read("kept/smoke/plain.exr") == folder.read("golden/smoke/plain.exr"));
    folder.write("home/plain.exr", "mine");
    std::fs::remove_dir_all(folder.path("kept/smoke")).unwrap();
    link(&folder, "home", "kept/smoke");
    let refused = validate(&["--keep", "kept"]);
    refused.prints(4, "a symbolic link");
    assert_eq!(folder.text("home/plain.exr"), "mine");
}

/// A run with a cache in the folder, and what it says of it.
fn cached(folder: &Folder, arguments: &[&str]) -> (Run, String) {
    let mut command = folder.command(arguments);
    command.env("VOLREF_CACHE", folder.path("cache"));
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (Run::of(output), said)
}

/// Other files in the cache are no cases, and a link in it is replaced by the file.
#[test]
fn a_cache_holds_the_suite_and_nothing_else() {
    let folder = Folder::new();
    let list = ["list", "figures"];
    let (run, said) = cached(&folder, &list);
    assert_eq!(run.code, 0, "{said}");
    let suites = std::fs::read_dir(folder.path("cache/suite")).unwrap();
    let suite = suites.last().unwrap().unwrap().path();
    let cases = suite.join("fixtures/cases");
    let manifest = std::fs::read(cases.join("figures/figure-1.toml")).unwrap();
    std::fs::create_dir(cases.join("planted")).unwrap();
    for planted in ["figures/planted.toml", "planted/case.toml"] {
        std::fs::write(cases.join(planted), &manifest).unwrap();
    }
    std::fs::write(suite.join("golden/figures/planted.toml"), "").unwrap();
    assert_eq!(cached(&folder, &list).0.stdout, run.stdout);
    assert_eq!(cached(&folder, &["verify", "planted"]).0.code, 5);
    let golden = suite.join("golden/figures/figure-2.exr");
    std::fs::rename(&golden, folder.path("theirs.exr")).unwrap();
    symlink(folder.path("theirs.exr"), &golden).unwrap();
    cached(&folder, &list).0.expect(0, "");
    assert!(!golden.is_symlink());
}
