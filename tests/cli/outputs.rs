//! Outputs that cannot be written.

use crate::folder::{Folder, Run};

/// Every command that writes a file, and that file's option.
#[test]
fn every_output_is_refused_in_words_and_leaves_nothing() {
    let folder = Folder::with_goldens();
    for name in ["cloud.obj", "scene.toml"] {
        let scenes = Folder::with_scenes();
        folder.write(name, scenes.read(name));
    }
    assert_eq!(folder.volref("render scene.toml -o image.exr").code, 0);
    folder.write("plain", "a file");
    let before = folder.files();
    let commands: &[(&[&str], &str, &str)] = &[
        (&["render", "scene.toml"], "--output=", "exr"),
        (&["render", "scene.toml"], "--output=", "png"),
        (&["compare", "image.exr", "image.exr"], "--heatmap=", "png"),
        (&["verify", "curve"], "--json=", "json"),
        (&["verify", "curve"], "--junit=", "xml"),
        (&["list"], "--json=", "json"),
        (&["plan", "scene.toml"], "--json=", "json"),
        (&["compare", "image.exr", "image.exr"], "--json=", "json"),
    ];
    for (command, option, extension) in commands {
        for (place, parts) in [
            ("nowhere/out", &["nowhere"][..]),
            // A path below a regular file is unwritable for everybody, root included.
            ("plain/out", &["plain"]),
        ] {
            let path = format!("{place}.{extension}");
            let run = folder.volref(&[*command, &[&format!("{option}{path}")]].concat());
            run.expect(2, &[&format!("cannot write {path}: "), "help: "]);
            run.expect(2, parts);
            assert_eq!(folder.files(), before, "{command:?} {option}{path}");
        }
        let path = format!("{option}fixtures/{}.{extension}", "x".repeat(300));
        let run = folder.volref(&[*command, &[&path]].concat());
        run.expect(2, "cannot write fixtures/xxx");
        assert_eq!(folder.files(), before, "{command:?}");
    }
}

#[test]
fn a_folder_in_the_place_of_the_output() {
    let folder = Folder::with_scenes();
    folder.write("image.exr/inside", "kept");
    let before = folder.files();
    let run = folder.volref("render scene.toml -o image.exr");
    run.expect(2, "cannot write image.exr: it is a folder");
    let run = folder.volref("plan scene.toml --json=image.exr");
    run.expect(2, "cannot write image.exr");
    assert_eq!(folder.files(), before);
}

#[test]
fn extensions_that_stand_for_no_image() {
    let folder = Folder::with_scenes();
    for output in ["image.jpg", "image", "image.exr.gz", ".exr", "exr"] {
        let run = folder.volref(&["render", "scene.toml", "-o", output]);
        run.expect(2, &[output, ".exr", ".png"]);
        assert!(!folder.path(output).exists());
    }
    folder.volref("render scene.toml -o image.exr");
    let run = folder.volref("compare image.exr image.exr --heatmap map.exr");
    run.expect(2, "--heatmap … map.exr … .png");
    assert!(!folder.path("map.exr").exists());
}

#[test]
fn exposures_that_are_no_number() {
    let folder = Folder::with_scenes();
    for exposure in ["nan", "inf", "-inf"] {
        let option = format!("--exposure={exposure}");
        let run = folder.volref(&["render", "scene.toml", "-o", "image.png", &option]);
        run.expect(2, "exposure … from -64 to 64");
    }
    assert!(!folder.path("image.png").exists());
}

#[test]
fn json_has_one_form() {
    let folder = Folder::with_goldens();
    for command in ["verify", "selftest", "list"] {
        folder
            .volref(&[command, "--json", "results.json"])
            .expect(5, "no case matches");
    }
}

#[test]
fn failures_are_json_where_json_is_asked_for() {
    let folder = Folder::with_goldens();
    for (arguments, exit_code, said) in [
        (&["plan", "absent.toml", "--json"][..], 2, "absent.toml"),
        (&["verify", "absent", "--json"], 5, "no case matches"),
        (&["render", "--json"], 2, "required arguments"),
    ] {
        let run = folder.volref(arguments);
        assert_eq!(run.code, exit_code);
        let error = run.json();
        assert_eq!(error["schema"], "volref/error/1");
        assert_eq!(error["exit_code"], exit_code);
        assert!(error["error"].as_str().unwrap().contains(said), "{error}");
        assert!(run.stderr.contains(said), "{}", run.stderr);
    }
    let written = folder.volref("plan absent.toml --json=plan.json");
    assert_eq!(written.stdout, "");
    assert!(!folder.path("plan.json").exists());
}

/// The names of commands in the help, which stand in groups.
#[cfg(target_os = "linux")]
fn commands(folder: &Folder) -> Vec<String> {
    let help = folder.volref("--help").stdout;
    let (_, list) = help.split_once("Usage:").unwrap();
    let lines = list.lines().take_while(|line| *line != "Options:");
    // Lines of a long description begin further to the right.
    let names = lines.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let names = names.filter(|name| !name.is_empty()).map(str::to_owned);
    names.collect()
}

/// Arguments with which the command prints something and ends without an error.
#[cfg(target_os = "linux")]
fn arguments(command: &str) -> &'static [&'static str] {
    match command {
        "verify" => &["curve"],
        "validate" => &["curve", "--outputs", "images"],
        "gallery" => &["images", "-o", "gallery.html"],
        "compare" => &["image.exr", "image.exr"],
        "render" => &["scene.toml", "-o", "out.exr"],
        "plan" | "sensitivity" => &["scene.toml"],
        "cost" => &["scene.toml", "--runs", "0", "--budget", "0.000001"],
        "export" => &["scene.toml", "--to", "bundle", "-o", "bundle"],
        "accept" => &["curve", "--reason", "none"],
        "merge" => &["kept"],
        "selftest" => &["curve", "--quick"],
        "info" => &["cloud.obj"],
        "completions" => &["bash"],
        "list" | "suite" | "schema" | "help" => &[],
        _ => panic!("no arguments for {command} here"),
    }
}

/// `/dev/full` is a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_stdout_is_an_error_of_every_command() {
    let folder = Folder::with_goldens();
    let scenes = Folder::with_scenes();
    for name in ["cloud.obj", "scene.toml"] {
        folder.write(name, scenes.read(name));
    }
    let room = Folder::with_room("converged_samples = 128\nresolution = 0.9");
    for (name, contents) in room.files() {
        folder.write(&name, contents);
    }
    folder.write("images/curve.exr", folder.read("golden/plots/curve.exr"));
    folder.write("image.exr", folder.read("golden/plots/curve.exr"));
    folder.volref("verify curve --results kept").expect(0, "");

    let judged = ["validate", "curve", "--outputs", "images"];
    folder
        .volref(&[&judged[..], &["--json=images/results.json"]].concat())
        .expect(0, "");

    let mut lines = vec![vec!["--version".to_owned()], vec!["--help".to_owned()]];
    let commands = commands(&folder);
    assert!(commands.len() > 15, "{commands:?}");
    for command in &commands {
        let line: Vec<String> = [command.as_str()]
            .iter()
            .chain(arguments(command))
            .map(|word| (*word).to_owned())
            .collect();
        let help = vec![command.clone(), "--help".to_owned()];
        let described = folder.volref(&["help", command]).stdout;
        if described.contains("--json[=<FILE>]") {
            lines.push([line.clone(), vec!["--json".to_owned()]].concat());
        }
        lines.extend((command != "help").then_some(help));
        lines.push(line);
    }
    assert!(
        lines
            .iter()
            .filter(|line| line.ends_with(&["--json".to_owned()]))
            .count()
            > 10
    );
    for line in lines {
        let words: Vec<&str> = line.iter().map(String::as_str).collect();
        let run = folder.volref(&words);
        assert!(
            run.code != 2 && !run.stdout.is_empty(),
            "{words:?}: {}",
            run.stderr
        );
        let full = std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let run = Run::of(folder.command(&words).stdout(full).output().unwrap());
        let shown = format!("{words:?}: {}", run.message());
        assert_eq!(run.code, 2, "{shown}");
        for part in [
            "cannot write to standard output: No space left",
            "help: free some space",
        ] {
            assert!(shown.contains(part), "{shown}");
        }
    }

    // The error of the command is said, too.
    let full = std::fs::File::options()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let mut command = folder.command("plan absent.toml --json");
    let run = Run::of(command.stdout(full).output().unwrap());
    run.expect(
        2,
        "absent.toml: cannot read … cannot write to standard output",
    );
}
