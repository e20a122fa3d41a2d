//! Names, keys, values and output that would have the terminal do what nobody asked for.

use crate::folder::{CLOUD, Folder, MANIFEST, Run, scene};

/// Escape, bell, delete, the escape of eight bits, and a text from right to left.
const EVIL: &str = "e\u{1b}[31m\u{7}\u{7f}\u{9b}2J\u{202e}x";

/// What the terminal is to obey rather than to show.
fn obeyed(text: &str) -> Vec<char> {
    let bidirectional = |c: char| matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    text.chars()
        .filter(|&c| c.is_control() && c != '\n' && c != '\t' || bidirectional(c))
        .collect()
}

/// A suite with goldens whose cases, scenes and files have hostile names, and single files.
fn hostile() -> Folder {
    let folder = Folder::new();
    folder.write("fixtures/volumes/cloud.obj", CLOUD);
    let case = format!("{EVIL}/{EVIL}");
    folder.write(&format!("fixtures/scenes/{case}.toml"), scene(""));
    let evil_text = "a \\u001b[31mtest\\u009b";
    let manifest = MANIFEST.replace("a test", evil_text);
    folder.write(&format!("fixtures/cases/{case}.toml"), manifest);
    folder.write(
        &format!("{EVIL}.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n",
    );
    let plain = scene("").replace("../../volumes/", "fixtures/volumes/");
    folder.write(&format!("{EVIL}.toml"), &plain);
    folder.write("key.toml", format!("{plain}\n[\"{evil_text}\"]\na = 1\n"));
    // No TOML, but a text of which the lines about the mistake are shown.
    folder.write("raw.toml", format!("# {EVIL}\r\n[film]\nwidth = {EVIL}\n"));
    folder.write(
        "value.toml",
        plain.replace("width = 12", &format!("width = \"{evil_text}\"")),
    );
    folder.write(
        "file.toml",
        plain.replace(
            "fixtures/volumes/cloud.obj",
            &format!("none{evil_text}.obj"),
        ),
    );
    folder.write(
        "bad.nrrd",
        format!("NRRD0004\n{EVIL}: {EVIL}\ntype: {EVIL}\n\n"),
    );
    folder.write(&format!("bad{EVIL}.exr"), "no image");
    folder.write("printer.sh", format!("printf '%s\\n' '{EVIL}'; exit 3\n"));
    folder
}

/// Whatever is hostile is seen, and obeyed by nobody: on both outputs of every command.
#[test]
fn no_control_character_reaches_the_terminal() {
    let folder = hostile();
    let file = |ending: &str| format!("{EVIL}{ending}");
    let (scene, cloud, case) = (file(".toml"), file(".obj"), format!("{EVIL}/{EVIL}"));
    let (image, bad) = (file(".exr"), format!("bad{EVIL}.exr"));
    let in_suite = format!("fixtures/scenes/{case}.toml");
    let commands: &[&[&str]] = &[
        &["list"],
        &["list", "--json"],
        &["list", EVIL],
        &["list", &format!("no{EVIL}")],
        &["list", "--suite", EVIL],
        &["verify"],
        &["accept", &case, "--reason", EVIL],
        &["accept", &format!("no{EVIL}"), "--reason", "none"],
        &["verify", &case],
        &["verify", "--json"],
        &["verify", "--report", EVIL, "--junit", &file(".xml")],
        &["verify", "--junit", &format!("{EVIL}/none/x.xml")],
        &["render", &scene, "-o", &image],
        &["render", &format!("no{EVIL}.toml"), "-o", &image],
        &["render", &scene, "-o", &format!("no{EVIL}/x.exr")],
        &["render", &scene, "-o", &file(".jpg")],
        &["compare", &image, &image],
        &["compare", &image, &image, "--json"],
        &["compare", &bad, &image],
        &["compare", &image, &bad],
        &["compare", &image, &image, "--heatmap", EVIL],
        &["compare", &image, &image, "--gate", EVIL],
        &["validate", "--outputs", "."],
        &["validate", "--outputs", EVIL],
        &["validate", "--outputs", &format!("no{EVIL}")],
        &["validate", "--run", "sh printer.sh {output}"],
        &["validate", "--run", "sh printer.sh {output}", "--json"],
        &["validate", "--run", &format!("'{EVIL}' {{output}}")],
        &["validate", "--run", &format!("r {{{EVIL}}} {{output}}")],
        &["validate", "--run", &format!("r '{EVIL} {{output}}")],
        &["plan", &in_suite],
        &["plan", &in_suite, "--json"],
        &["plan", "key.toml"],
        &["plan", "raw.toml"],
        &["plan", "value.toml"],
        &["plan", "file.toml"],
        &["plan", &scene, "--force", EVIL],
        &["plan", &format!("no{EVIL}.toml")],
        &["cost", &format!("no{EVIL}.toml")],
        &["cost", "raw.toml"],
        &[
            "export",
            &scene,
            "--to",
            "bundle",
            "-o",
            &format!("out{EVIL}"),
        ],
        &["export", &scene, "--to", EVIL, "-o", "out"],
        &["export", &scene, "--to", "pbrt", "-o", EVIL],
        &["selftest", &format!("no{EVIL}")],
        &["info", &cloud],
        &["info", &cloud, "--json"],
        &["info", "bad.nrrd"],
        &["info", &format!("no{EVIL}.nii")],
        &["schema", EVIL],
        &[EVIL],
        &["list", &format!("--{EVIL}")],
    ];
    let mut seen = 0;
    for arguments in commands {
        let run = Run::of(folder.command(*arguments).output().unwrap());
        for said in [&run.stdout, &run.stderr] {
            assert_eq!(obeyed(said), Vec::<char>::new(), "{arguments:?}: {said:?}");
        }
        let said = run.stdout + &run.stderr;
        // JSON and quotes of Rust have escapes of their own, and excerpts a sign of as many bytes.
        seen += usize::from(
            ["␛", "e?[31m", "\\u001b", "\\u{1b}"]
                .iter()
                .any(|sign| said.contains(sign)),
        );
    }
    // Some say nothing of what is hostile in them, such as a plan.
    assert!(seen + 10 > commands.len(), "{seen} of {}", commands.len());
}

/// Threads that no machine has are refused before they are started.
#[test]
fn threads_beyond_all_cores() {
    let folder = Folder::with_scenes();
    let render = ["render", "scene.toml", "-o", "image.exr"];
    let with = |variable: &str, value: &str| {
        let mut command = folder.command(&render);
        Run::of(command.env(variable, value).output().unwrap())
    };
    for variable in ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"] {
        let words = format!("{variable} asks for 100000 threads: at most 1024");
        with(variable, "100000").expect(2, &[&words]);
        assert!(!folder.path("image.exr").exists());
    }
    for value in ["0", "3", "none", "99999999999999999999999999"] {
        with("RAYON_NUM_THREADS", value).expect(0, "");
    }
    let run = folder.volref(&[&render[..], &["--threads", "100000"]].concat());
    run.expect(2, "--threads … 1024");
}

/// On stdout, too, JSON holds names as they are.
#[test]
fn json_holds_hostile_names_as_they_are() {
    let folder = hostile();
    let name = format!("{EVIL}.obj");
    let run = folder.volref(&["info", &name, "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(run.json()["file"], name);
}

/// The place that is underlined stays the right one.
#[test]
fn excerpts_show_the_right_place() {
    let folder = Folder::new();
    let excerpt = |text: &str, shown: &str, place: &str| {
        folder.write("scene.toml", text);
        let run = folder.volref("plan scene.toml");
        assert_eq!(run.code, 2);
        // In the message, and above the excerpt.
        assert_eq!(run.stderr.matches(place).count(), 2, "{}", run.stderr);
        let lines: Vec<&str> = run.stderr.lines().collect();
        let at = lines.iter().position(|line| line.contains(shown));
        let at = at.unwrap_or_else(|| panic!("{}", run.stderr));
        let column = |line: &str, part: &[char]| line.chars().position(|c| part.contains(&c));
        let wrong = column(lines[at], &['?', '=']);
        assert!(wrong.is_some(), "{}", run.stderr);
        assert_eq!(column(lines[at + 1], &['▲', '─']), wrong, "{}", run.stderr);
    };
    // Of two bytes, and of one, which no TOML may hold.
    excerpt("# \u{9b}\u{7f}\r\n", "# ¿?", "scene.toml:1:4");
    excerpt(
        "# \u{9b}\u{202e}\r\n[film]\r\n# \u{9b}\n= true\n",
        "= true",
        "scene.toml:4:1",
    );
}
