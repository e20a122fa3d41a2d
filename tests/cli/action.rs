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
    let (command, variables) = steps().swap_remove(index);
    let program = Path::new(env!("CARGO_BIN_EXE_volref")).parent().unwrap();
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
    shell.output().unwrap()
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

    let both = [("inputs.outputs", "out"), ("inputs.run", "x {output}")];
    assert_eq!(run(&folder, 1, &both).status.code(), Some(2));
}
