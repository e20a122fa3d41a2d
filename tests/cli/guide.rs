//! The README and the guide: every command block is run, and the output that it shows is compared.
//!
//! | block | treatment |
//! | --- | --- |
//! | `sh` | each line is run |
//! | `text` | a session: lines after `$ ` are run, the others are their output; a number of seconds stands for any, `…` for any text, a line `…` for any lines |
//! | `toml`, `python`, `javascript`, `cpp` | a file for the commands below it |
//! | `json` | a value in each line |
//! | `rust` | run by rustdoc; in the guide only |
//!
//! Any other block is an error. Marks, HTML comments in the lines above a block, say the rest:
//! [`Mark`].

use crate::folder::{CLOUD, Folder, SIGN_OF_LIFE, copy, root};
use crate::needs::{NUMPY, is_there};
use std::fmt;
use std::path::Path;
use std::process::{Command, Stdio};
use toml::{Table, Value};

macro_rules! documents {
    ($($name:ident: $file:literal,)*) => {
        const DOCUMENTS: &[&str] = &[$($file),*];
        $(
            #[test]
            fn $name() {
                run($file);
            }
        )*
    };
}

documents! {
    readme: "README.md",
    accuracy_and_cost: "src/guide/accuracy_and_cost.md",
    adapters: "src/guide/adapters.md",
    comparing: "src/guide/comparing.md",
    effects: "src/guide/effects.md",
    speed: "src/guide/speed.md",
    findings: "src/guide/findings.md",
    fog_and_smoke: "src/guide/fog_and_smoke.md",
    hard_cases: "src/guide/hard_cases.md",
    peers: "src/guide/peers.md",
    reported: "src/guide/reported.md",
    scenes: "src/guide/scenes.md",
    staying: "src/guide/staying.md",
    gallery: "src/guide/gallery.md",
    several_machines: "src/guide/several_machines.md",
    sensitivities: "src/guide/sensitivities.md",
    suite: "src/guide/suite.md",
    in_your_tests: "src/guide/in_your_tests.md",
    volume_files: "src/guide/volume_files.md",
    working_on_volref: "src/guide/working_on_volref.md",
}

/// Links of the guide as rustdoc resolves them.
const RUSTDOC_LINKS: &str = "src/guide/links.md";

fn text(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap()
}

/// A remark to this test, above a block.
#[derive(Debug)]
enum Mark {
    /// `file: NAME`: the block is that file.
    File(String),
    /// `file: NAME, with the rest of BASE`: the tables of the block replace those of another file.
    FileUpon(String, String),
    /// `each line: a key of the medium in NAME`: each line is tried in that scene by itself.
    MediumKeys(String),
    /// `exit code N`: that of the last command; without the mark, 0 of all.
    ExitCode(i32),
    /// `needs NumPy`, or `needs PROGRAM`: run where that is there, a program being one of [`PROGRAMS`].
    Needs(&'static str),
    /// `not run: REASON`: one of [`REASONS`].
    NotRun(&'static Reason),
}

/// A reason not to run a block.
#[derive(Debug)]
struct Reason {
    words: &'static str,
    /// Every command of the block holds one of these.
    of: &'static [&'static str],
}

const REASONS: &[Reason] = &[
    // `Place::look_at` searches that script for the command.
    Reason {
        words: CHECKED,
        of: &["cargo"],
    },
    Reason {
        words: "minutes",
        of: &[
            "volref cost",
            "volref verify hard",
            "volref merge",
            "cargo test --lib",
            "--ignored",
            "scripts/check.sh",
            "scripts/nightly.sh",
            "cargo bench",
        ],
    },
    Reason {
        words: "writes goldens",
        of: &["volref accept"],
    },
    Reason {
        words: "CI writes no known failures",
        of: &["--known-update"],
    },
    Reason {
        words: "installs or opens something",
        of: &["cargo install", "cargo doc"],
    },
    Reason {
        words: "needs Mitsuba 3, pbrt-v4 or VTK",
        of: &["run_mitsuba.py", "run_pbrt.py", "vtk_render.py"],
    },
    Reason {
        words: "needs the ray casters",
        of: &[
            "ray_casters.py",
            "volref-page",
            "vispy_render.py",
            "pyvista_render.py",
            "checks.py",
        ],
    },
];

/// Programs that blocks may need.
const PROGRAMS: [&str; 3] = ["python3", "node", "c++"];

const CHECKED: &str = "scripts/check.sh runs it";

impl Mark {
    fn parse(text: &str) -> Option<Mark> {
        let (kind, rest) = text.split_once(": ").unwrap_or((text, ""));
        match kind {
            "file" => Some(match rest.split_once(", with the rest of ") {
                Some((name, base)) => Mark::FileUpon(name.to_owned(), base.to_owned()),
                None => Mark::File(rest.to_owned()),
            }),
            "each line" => rest
                .strip_prefix("a key of the medium in ")
                .map(|name| Mark::MediumKeys(name.to_owned())),
            "not run" => REASONS
                .iter()
                .find(|reason| reason.words == rest)
                .map(Mark::NotRun),
            "needs NumPy" => Some(Mark::Needs(NUMPY)),
            _ if text.starts_with("needs ") => PROGRAMS
                .into_iter()
                .find(|program| text.ends_with(&format!(" {program}")))
                .map(Mark::Needs),
            _ => Some(Mark::ExitCode(
                text.strip_prefix("exit code ")?.parse().ok()?,
            )),
        }
    }
}

/// A line of a document, for messages.
#[derive(Clone, Copy)]
struct Place<'a> {
    file: &'a str,
    line: usize,
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.line)
    }
}

/// A fenced block with the marks above it.
struct Block<'a> {
    place: Place<'a>,
    language: String,
    lines: Vec<String>,
    marks: Vec<Mark>,
}

fn blocks<'a>(file: &'a str, text: &str) -> Vec<Block<'a>> {
    let mut blocks = Vec::new();
    let mut marks = Vec::new();
    let mut lines = (1..).zip(text.lines());
    while let Some((line, text)) = lines.next() {
        let place = Place { file, line };
        if text.starts_with(WRITTEN_BY) || text == WRITTEN_END {
            // What a script wrote: tables, no blocks.
        } else if let Some(mark) = text.strip_prefix("<!-- ") {
            let mark = mark.strip_suffix(" -->").and_then(Mark::parse);
            marks.push(mark.unwrap_or_else(|| panic!("{place}: unknown mark {text}")));
        } else if let Some(language) = text.strip_prefix("```") {
            let within = lines.by_ref().map(|(_, text)| text);
            blocks.push(Block {
                place,
                language: language.to_owned(),
                lines: within
                    .take_while(|text| *text != "```")
                    .map(str::to_owned)
                    .collect(),
                marks: std::mem::take(&mut marks),
            });
        } else {
            assert!(marks.is_empty(), "{place}: a mark stands above a block");
        }
    }
    blocks
}

/// A command with the output shown below it: none where only the command stands.
struct Step {
    command: String,
    output: Option<Vec<String>>,
}

impl Block<'_> {
    fn exit_code(&self) -> i32 {
        let code = self.marks.iter().find_map(|mark| match mark {
            Mark::ExitCode(code) => Some(*code),
            _ => None,
        });
        code.unwrap_or(0)
    }

    fn steps(&self) -> Vec<Step> {
        let mut steps: Vec<Step> = Vec::new();
        for line in &self.lines {
            if self.language == "sh" {
                let command = line.clone();
                steps.push(Step {
                    command,
                    output: None,
                });
            } else if let Some(command) = line.strip_prefix("$ ") {
                steps.push(Step {
                    command: command.to_owned(),
                    output: Some(Vec::new()),
                });
            } else {
                let step = steps.last_mut();
                let step =
                    step.unwrap_or_else(|| panic!("{}: output before a command", self.place));
                step.output.as_mut().unwrap().push(line.clone());
            }
        }
        steps
    }

    /// Does in `folder` what a reader would do with the block.
    fn try_out(&self, folder: &Folder) {
        let place = self.place;
        match self.language.as_str() {
            "sh" | "text" => {
                for mark in &self.marks {
                    match mark {
                        Mark::NotRun(reason) => return self.look_at(folder, reason),
                        Mark::Needs(need) if !is_there(need, &place.to_string()) => return,
                        Mark::Needs(_) | Mark::ExitCode(_) => {}
                        _ => panic!("{place}: {mark:?} marks files"),
                    }
                }
                self.run(folder);
            }
            "toml" => self.write(folder),
            "python" | "javascript" | "cpp" if matches!(self.marks[..], [Mark::File(_)]) => {
                self.write(folder);
            }
            "json" => self.lines.iter().for_each(|line| {
                let value = serde_json::from_str::<serde_json::Value>(line);
                assert!(value.is_ok(), "{place}: {line}");
            }),
            "rust" => assert!(place.file != "README.md", "{place}: nothing runs it"),
            // python/tests/test_guide.py, npm/test/guide.test.mjs, scripts/check-cmake.sh and
            // tests/cli/action.rs run such.
            "python" | "javascript" | "cmake" | "yaml"
                if place.file.ends_with("in_your_tests.md") => {}
            other => panic!("{place}: a block of {other:?}, which no test reads"),
        }
    }

    fn run(&self, folder: &Folder) {
        let steps = self.steps();
        assert!(!steps.is_empty(), "{}: a session without `$ `", self.place);
        for (at, step) in (1..).zip(&steps) {
            let expected = if at == steps.len() {
                self.exit_code()
            } else {
                0
            };
            let (code, printed) = shell(folder, &step.command);
            let message = format!("{}: {}\nprints\n\n{printed}", self.place, step.command);
            assert_eq!(code, expected, "{message}");
            if let Some(output) = &step.output {
                let [shown, printed] =
                    [output.join("\n"), printed].map(|text| comparable(text.trim_end()));
                assert!(lines_match(&shown, &printed), "{message}");
            }
        }
    }

    /// Without running a command, holds it to the reason and its parts to what there is.
    fn look_at(&self, folder: &Folder, reason: &Reason) {
        for Step { command, .. } in self.steps() {
            let place = self.place;
            let command = command.split(" #").next().unwrap().trim_end();
            assert!(
                reason.of.iter().any(|word| command.contains(word)),
                "{place}: {command} is not run for {:?}, of which nothing shows",
                reason.words
            );
            if reason.words == CHECKED {
                assert!(
                    text("scripts/check.sh").lines().any(|line| line == command),
                    "{place}: scripts/check.sh does not run {command}"
                );
            }
            let words = shell_words::split(command).unwrap();
            for script in words.iter().flat_map(|word| word.split(' ')) {
                let named = script.starts_with("scripts/");
                assert!(!named || root().join(script).is_file(), "{place}: {script}");
            }
            if let Some(at) = words.iter().position(|word| word == "--test") {
                let test = root().join("tests").join(&words[at + 1]);
                let found = test.with_extension("rs").is_file() || test.join("main.rs").is_file();
                assert!(found, "{place}: there is no {}", test.display());
            }
            if words[0] == "volref" {
                // Its arguments are read before the help is printed.
                let (code, printed) = shell(folder, &format!("{command} --help"));
                assert_eq!(code, 0, "{place}: {command}\n{printed}");
            }
        }
    }

    fn write(&self, folder: &Folder) {
        let place = self.place;
        let contents = self.lines.join("\n") + "\n";
        let table = |text: &str| text.parse::<Table>().unwrap();
        match &self.marks[..] {
            [Mark::File(name)] => folder.write(name, contents),
            [Mark::FileUpon(name, base)] => {
                let mut scene = table(&folder.text(base));
                scene.extend(table(&contents));
                folder.write(name, scene.to_string());
                let (code, printed) = shell(folder, &format!("volref plan {name}"));
                assert_eq!(code, 0, "{place}: {printed}");
            }
            [Mark::MediumKeys(name)] => {
                for line in self.lines.iter().filter(|line| !line.starts_with('#')) {
                    let mut scene = table(&folder.text(name));
                    let medium = medium(&mut scene);
                    let key = table(line);
                    if key.contains_key("procedural") {
                        // "brings sigma_a and sigma_s"
                        medium.remove("sigma_a");
                        medium.remove("sigma_s");
                    }
                    medium.extend(key);
                    folder.write("key.toml", scene.to_string());
                    let (code, printed) = shell(folder, "volref plan key.toml");
                    assert_eq!(code, 0, "{place}: {line}\n{printed}");
                }
            }
            _ => panic!("{place}: a mark says which file this is"),
        }
    }
}

/// The first medium of a scene.
fn medium(scene: &mut Table) -> &mut Table {
    let media = scene["radiative"].get_mut("medium").unwrap();
    let Some(Value::Table(medium)) = media.get_mut(0) else {
        panic!("media are tables");
    };
    medium
}

/// Runs a command line as a reader would in the root of the repository; exit code, and all that is
/// printed, without the signs of life that depend on the time.
fn shell(folder: &Folder, line: &str) -> (i32, String) {
    // The search for a mistake has a time limit: on a slow machine it must not end before a reader's.
    let line = line
        .replace("cargo run --release -- ", "volref ")
        .replace("volref validate ", "volref validate --explain 600 ");
    let volref = folder.command(&[]);
    let programs = Path::new(volref.get_program()).parent().unwrap();
    let mut path = programs.as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap());
    let mut shell = Command::new("sh");
    shell
        .arg("-c")
        .arg(format!("exec 2>&1\n{line}"))
        .current_dir(folder.path(""));
    for (name, value) in volref.get_envs() {
        match value {
            Some(value) => shell.env(name, value),
            None => shell.env_remove(name),
        };
    }
    // In CI no golden is written: those of the repository are linked into the folder.
    let output = shell
        .env("PATH", path)
        .env("CI", "true")
        // The package, which readers have installed.
        .env("PYTHONPATH", root().join("python"))
        .stdin(Stdio::null());
    let output = output.output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let printed = text.split_inclusive('\n');
    (
        output.status.code().unwrap(),
        printed
            .filter(|line| !line.starts_with(SIGN_OF_LIFE))
            .collect(),
    )
}

/// The lines of `text`, spaces and seconds made equal.
fn comparable(text: &str) -> Vec<String> {
    let line = |line: &str| {
        let mut words: Vec<_> = line.split_whitespace().collect();
        for at in 1..words.len() {
            if words[at] == "s" && words[at - 1].parse::<f64>().is_ok() {
                words[at - 1] = "[seconds]";
            }
        }
        words.join(" ")
    };
    text.lines().map(line).collect()
}

/// Whether the lines of an output are those `shown`, of which a line `…` stands for any number.
fn lines_match(shown: &[String], printed: &[String]) -> bool {
    match shown.split_first() {
        None => printed.is_empty(),
        Some((line, rest)) if line == "…" => {
            (0..=printed.len()).any(|left_out| lines_match(rest, &printed[left_out..]))
        }
        Some((line, rest)) => printed
            .split_first()
            .is_some_and(|(first, others)| line_matches(line, first) && lines_match(rest, others)),
    }
}

/// Whether a line is the one `shown`, in which `…` stands for any text.
fn line_matches(shown: &str, printed: &str) -> bool {
    let Some((before, after)) = shown.split_once('…') else {
        return shown == printed;
    };
    let Some(rest) = printed.strip_prefix(before) else {
        return false;
    };
    let starts = rest.char_indices().map(|(at, _)| at).chain([rest.len()]);
    let mut ends = starts.map(|at| &rest[at..]);
    ends.any(|end| line_matches(after, end))
}

#[test]
fn outputs_are_compared() {
    let matches =
        |shown: &str, printed: &str| lines_match(&comparable(shown), &comparable(printed));
    assert!(matches("a  0.01 s\n…\nc", "a 2.50 s\nb\nb\nc"));
    assert!(matches("a\n…", "a"));
    assert!(matches("a … c …", "a b c d"));
    for (shown, printed) in [
        ("a 0.01 s", "b 0.01 s"),
        ("a", "a\nb"),
        ("a\nb", "a"),
        ("a\n…\nc", "a\nb"),
        ("a … c", "a b d"),
        ("0.01", "0.02"),
        ("", "a"),
    ] {
        assert!(!matches(shown, printed), "{shown:?} against {printed:?}");
    }
}

/// A folder like the root of the repository, with the files that a reader is supposed to have.
fn readers_folder() -> Folder {
    let folder = Folder::new();
    copy(&root().join("fixtures"), &folder.path("fixtures"));
    for name in ["golden", "scripts"] {
        std::os::unix::fs::symlink(root().join(name), folder.path(name)).unwrap();
    }
    folder.write("mine.obj", CLOUD);
    for (name, of) in [
        ("smoke.vol", "fixtures/volumes/formats/grid.vol"),
        ("scan.nii.gz", "fixtures/volumes/formats/grid.nii.gz"),
        ("block.xml", "fixtures/scenes/procedural/source-block.xml"),
        ("my-images/figure-3.exr", "golden/figures/figure-3.exr"),
        ("right.exr", "golden/figures/figure-3.exr"),
        ("yours.exr", "golden/figures/figure-3.exr"),
        ("yours.png", "golden/figures/figure-3.png"),
    ] {
        folder.write(name, folder.read(of));
    }
    folder
}

fn run(file: &str) {
    let folder = readers_folder();
    for block in blocks(file, &text(file)) {
        block.try_out(&folder);
    }
}

/// Pictures of the chapters.
const PICTURES: &str = "src/guide/images";

#[test]
fn every_chapter_is_tested_and_shown() {
    let module = text("src/guide.rs");
    let chapters = std::fs::read_dir(root().join("src/guide")).unwrap();
    for chapter in chapters {
        let name = chapter.unwrap().file_name().into_string().unwrap();
        let file = format!("src/guide/{name}");
        if file == PICTURES {
            continue;
        }
        assert!(
            file == RUSTDOC_LINKS || DOCUMENTS.contains(&file.as_str()),
            "{file} is not tested"
        );
        assert!(
            module.contains(&format!("include_str!(\"guide/{name}\")")),
            "{file} is not shown"
        );
    }
}

/// A page: what does not fit belongs in the guide.
#[test]
fn the_readme_is_short() {
    assert!(text("README.md").lines().count() <= 150);
}

/// Marks around the output of a command, which `scripts/speed.py` replaces.
const WRITTEN_BY: &str = "<!-- by ";
const WRITTEN_END: &str = "<!-- end -->";

/// Tables of measured speed are the output of commands.
#[test]
fn tables_of_speed_are_written_by_scripts() {
    let page = text("src/guide/speed.md");
    let mut rows = page.lines().filter(|line| line.starts_with('|')).count();
    for part in page.split(WRITTEN_BY).skip(1) {
        let (command, rest) = part.split_once(" -->").expect("a command");
        let (written, _) = rest.split_once(WRITTEN_END).expect("an end");
        let script = command.split(' ').next().unwrap();
        assert!(root().join(script).exists(), "no {script}");
        let table = written.lines().filter(|line| line.starts_with('|'));
        let count = table.count();
        assert!(count > 2, "{script} wrote no table");
        rows -= count;
    }
    assert_eq!(rows, 0, "rows of tables that no script writes");
}

/// The targets of links, `(target)` and `[label]: target`, with the labels of the latter.
fn links(text: &str) -> Vec<(Option<&str>, &str)> {
    let inline = text.split("](").skip(1).filter_map(|rest| {
        let (target, _) = rest.split_once(')')?;
        Some((None, target))
    });
    let defined = text.lines().filter_map(|line| {
        let (label, target) = line.strip_prefix('[')?.split_once("]: ")?;
        Some((Some(label), target))
    });
    inline.chain(defined).collect()
}

/// The anchors of the headings, by the rule that rustdoc and GitHub share.
fn anchors(text: &str) -> Vec<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| {
        let words = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = words
            .chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        kept.collect::<String>().replace(' ', "-")
    };
    headings.map(anchor).collect()
}

#[test]
fn links_lead_somewhere() {
    let rustdoc = text(RUSTDOC_LINKS);
    let known: Vec<_> = links(&rustdoc)
        .into_iter()
        .map(|(label, _)| label)
        .collect();
    for file in DOCUMENTS {
        let folder = root().join(file).parent().unwrap().to_owned();
        let text = text(file);
        for (label, target) in links(&text) {
            if target.starts_with("https://") {
                continue;
            }
            if let Some(anchor) = target.strip_prefix('#') {
                assert!(
                    anchors(&text).iter().any(|other| other == anchor),
                    "{file}: no {target}"
                );
                continue;
            }
            assert!(folder.join(target).exists(), "{file}: no {target}");
            // rustdoc shows a chapter without the files around it, and of a picture its description.
            assert!(
                *file == "README.md"
                    || target.ends_with(".png")
                    || target.ends_with(".svg")
                    || label.is_some() && known.contains(&label),
                "{file}: {target} is not in {RUSTDOC_LINKS}"
            );
        }
    }
}

/// Paths in running text are those of files.
#[test]
fn paths_lead_somewhere() {
    for file in DOCUMENTS {
        let text = text(file);
        let quoted = text.split('`').skip(1).step_by(2);
        let paths = quoted.filter(|word| {
            let folders = [
                "fixtures/",
                "golden/",
                "scripts/",
                "src/",
                "tests/",
                "fuzz/",
            ];
            folders.iter().any(|folder| word.starts_with(folder))
        });
        for path in paths.filter(|path| !path.contains(['<', ' ', '\n'])) {
            assert!(root().join(path).exists(), "{file}: no {path}");
        }
    }
}
