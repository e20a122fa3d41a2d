//! The shell steps of `action.yml`, as the runner of GitHub would run them.

use crate::folder::Folder;
use std::path::Path;
use std::process::{Command, Output};

/// The commands of the steps with a shell, each with its variables.
fn steps() -> Vec<(String, Vec<(String, String)>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("action.yml")).unwrap();
    let mut steps = Vec::new();
    let mut variables = Vec::new();
    for line in text.lines().map(str::trim) {
        if line.starts_with("- name:") {
            variables.clear();
        } else if let Some(command) = line.strip_prefix("run: ") {
            steps.push((command.to_owned(), std::mem::take(&mut variables)));
        } else if let Some((name, value)) = line.split_once(": ")
            && name.starts_with("VOLREF_")
        {
            variables.push((name.to_owned(), value.to_owned()));
        }
    }
    steps
}

/// Runs step `index` with these inputs, in `folder`.
fn run(folder: &Folder, index: usize, inputs: &[(&str, &str)]) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_volref")).parent().unwrap();
    step(folder, index, inputs, program).output().unwrap()
}

/// Step `index` with these inputs, in `folder`, where the folder `program` is searched first.
fn step(folder: &Folder, index: usize, inputs: &[(&str, &str)], program: &Path) -> Command {
    let (command, variables) = steps().swap_remove(index);
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut shell = Command::new("bash");
    shell
        .args(["-c", &command])
        .current_dir(folder.path(""))
        .env("GITHUB_ACTION_PATH", env!("CARGO_MANIFEST_DIR"))
        .env("GITHUB_STEP_SUMMARY", folder.path("summary.md"))
        .env("GITHUB_OUTPUT", folder.path("output.txt"))
        .env("GITHUB_PATH", folder.path("path.txt"))
        .env("VOLREF_CACHE", "")
        .env("PATH", path);
    for (name, value) in variables {
        let value = inputs.iter().fold(value, |value, (input, given)| {
            value.replace(&format!("${{{{ {input} }}}}"), given)
        });
        let value = if value.starts_with("${{") {
            String::new()
        } else {
            value
        };
        shell.env(name, value);
    }
    shell
}

#[test]
fn the_steps_validate_report_and_end_with_the_verdict() {
    let folder = Folder::with_goldens();
    assert!(run(&folder, 0, &[]).status.success());
    std::fs::create_dir_all(folder.path("out/smoke")).unwrap();
    let golden = folder.read("golden/smoke/plain.exr");
    folder.write("out/smoke/plain.exr", golden.clone());
    let inputs = [
        ("inputs.outputs", "out"),
        ("inputs.cases", "smoke/*"),
        ("inputs.arguments", "--only-present --explain '0'"),
        ("inputs.report", "pages"),
    ];
    let output = run(&folder, 1, &inputs);
    assert!(output.status.success(), "{output:?}");
    assert_eq!(folder.text("output.txt"), "exit-code=0\n");
    assert!(folder.text("summary.md").contains("1 case: 1 passed"));
    for name in ["index.html", "results.json", "results.xml"] {
        assert!(folder.path("pages").join(name).is_file(), "{name}");
    }
    let code = [("steps.validate.outputs.exit-code", "1")];
    assert_eq!(run(&folder, 2, &code).status.code(), Some(1));

    // Another image of the same size.
    folder.write(
        "out/smoke/plain.exr",
        folder.read("golden/smoke/nearest.exr"),
    );
    folder.remove("output.txt");
    assert!(run(&folder, 1, &inputs).status.success());
    assert_eq!(folder.text("output.txt"), "exit-code=1\n");
    assert!(
        folder
            .text("summary.md")
            .contains("1 case: 0 passed, 1 failed")
    );

    folder.write("known.toml", "[\"smoke/plain\"]\nreason = \"nearest\"\n");
    folder.remove("output.txt");
    folder.remove("summary.md");
    let known = [&inputs[..], &[("inputs.known", "known.toml")]].concat();
    assert!(run(&folder, 1, &known).status.success());
    assert_eq!(folder.text("output.txt"), "exit-code=0\n");
    let summary = folder.text("summary.md");
    assert!(summary.contains("    known failures: 1 known"), "{summary}");

    let both = [("inputs.outputs", "out"), ("inputs.run", "x {output}")];
    assert_eq!(run(&folder, 1, &both).status.code(), Some(2));
}

/// A program `volref` that keeps the words it is called with, each behind a NUL.
fn with_listener() -> Folder {
    let folder = Folder::new();
    folder.write(
        "bin/volref",
        "#!/bin/sh\nprintf '\\0%s' \"$@\" > words\necho '::error::a renderer'\necho '```'\n",
    );
    let done = Command::new("chmod")
        .arg("+x")
        .arg(folder.path("bin/volref"))
        .status();
    assert!(done.unwrap().success());
    folder
}

#[test]
fn arguments_are_split_as_a_shell_does() {
    let folder = with_listener();
    for (arguments, words) in [
        (
            r#"--spp 256 --format  npy"#,
            &["--spp", "256", "--format", "npy"][..],
        ),
        (r#""" -n -e -E '' --"#, &["", "-n", "-e", "-E", "", "--"]),
        (
            r#"--run 'a "b" \c' "d 'e' \"f\" \g""#,
            &["--run", r#"a "b" \c"#, r#"d 'e' "f" \g"#],
        ),
        (r"a\ b\\ x'y'z", &[r"a b\", "xyz"]),
        (
            "--spp 256 \\\n  --jobs 2\n'c\nd'",
            &["--spp", "256", "--jobs", "2", "c\nd"],
        ),
        (
            "$HOME * `id` ~ {a,b} %s",
            &["$HOME", "*", "`id`", "~", "{a,b}", "%s"],
        ),
        (" \n", &[]),
    ] {
        let inputs = [
            ("inputs.run", "-x {output}"),
            ("inputs.cases", " smoke/* figures"),
            ("inputs.arguments", arguments),
            ("inputs.report", "-pages"),
        ];
        let output = step(&folder, 1, &inputs, &folder.path("bin")).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{arguments}: {output:?}");
        let given = folder.text("words");
        let given: Vec<&str> = given.split('\0').skip(1).collect();
        let before = ["validate", "smoke/*", "figures", "--run=-x {output}"];
        let expected = [&before[..], words, &["--report", "./-pages"]].concat();
        assert_eq!(given[..expected.len()], expected, "{arguments}");
        assert_eq!(given.len(), expected.len() + 3, "{given:?}");
        folder.remove("words");

        // What is printed is neither obeyed nor Markdown.
        let printed = String::from_utf8(output.stdout).unwrap();
        let (stop, rest) = printed.split_once('\n').unwrap();
        let token = stop.strip_prefix("::stop-commands::").unwrap();
        assert!(rest.starts_with("::error::") && rest.ends_with(&format!("\n::{token}::\n")));
        assert!(folder.text("summary.md").contains("\n    ```\n"));
    }
}

#[test]
fn inputs_that_cannot_be_understood_are_refused_and_nothing_runs() {
    let folder = with_listener();
    for (input, value, said) in [
        (
            "inputs.arguments",
            "--spp 4 'a",
            "a quotation mark (') is not closed: --spp 4 'a",
        ),
        (
            "inputs.arguments",
            "a \"b\\\"",
            "a quotation mark (\") is not closed",
        ),
        (
            "inputs.arguments",
            "a \\",
            "nothing follows the last backslash",
        ),
        (
            "inputs.cases",
            "smoke --accept-conventions",
            "cases: --accept-conventions is an option",
        ),
        ("inputs.cases", "-h", "cases: -h is an option"),
    ] {
        let inputs = [("inputs.outputs", "out"), (input, value)];
        let output = step(&folder, 1, &inputs, &folder.path("bin")).output();
        let output = output.unwrap();
        assert_eq!(output.status.code(), Some(2), "{value}");
        let words = String::from_utf8(output.stderr).unwrap();
        assert!(words.contains(said), "{value}: {words}");
        assert!(!folder.path("words").exists(), "{value}");
    }
}

/// The binary of a release is taken with the checksum beside it alone.
#[test]
fn a_release_is_verified() {
    let release = include_str!("../../.github/workflows/release.yml");
    assert!(release.contains("> \"$asset.sha256\"") && release.contains(".tar.gz.sha256\n"));
    let folder = Folder::new();
    let asset = "owner/volref/releases/download/v1/volref-x86_64-unknown-linux-gnu.tar.gz";
    folder.write("volref", "#!/bin/sh\necho volref of the release\n");
    folder.write(asset, "");
    let pack = format!(
        "chmod +x volref && tar -czf {asset} volref && {{ sha256sum {asset} || shasum -a 256 {asset}; }}"
    );
    let packed = Command::new("sh")
        .args(["-c", &pack])
        .current_dir(folder.path(""))
        .output()
        .unwrap();
    assert!(packed.status.success(), "{packed:?}");
    let right = String::from_utf8(packed.stdout).unwrap();
    let install = || {
        // Without a volref of this machine.
        let mut step = step(&folder, 0, &[], Path::new("/usr/bin"));
        step.env("PATH", "/usr/bin:/bin")
            .env(
                "GITHUB_SERVER_URL",
                format!("file://{}", folder.path("").display()),
            )
            .env("GITHUB_ACTION_REPOSITORY", "owner/volref")
            .env("GITHUB_ACTION_REF", "v1")
            .env("RUNNER_OS", "Linux")
            .env("RUNNER_ARCH", "X64")
            .env("RUNNER_TEMP", folder.path("runner"));
        step.output().unwrap()
    };
    let checksum = format!("{asset}.sha256");
    let wrong = right.replacen(&right[..8], "00000000", 1);
    for (stated, said) in [
        (None, "the release has no checksum"),
        (Some(""), "another checksum than the release states"),
        (Some(&wrong[..]), "another checksum than the release states"),
        // Of a file that is nobody's business.
        (
            Some("e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  /dev/null\n"),
            "another checksum",
        ),
    ] {
        if let Some(stated) = stated {
            folder.write(&checksum, stated);
        }
        let output = install();
        assert_eq!(output.status.code(), Some(1), "{stated:?}");
        let words = String::from_utf8(output.stderr).unwrap();
        assert!(words.contains(said), "{stated:?}: {words}");
        assert!(!folder.path("path.txt").exists());
    }
    folder.write(&checksum, &right);
    let output = install();
    assert!(output.status.success(), "{output:?}");
    assert_eq!(output.stdout, b"volref of the release\n");
    assert!(folder.text("path.txt").ends_with("/volref/bin\n"));
}
