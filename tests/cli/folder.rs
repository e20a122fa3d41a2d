//! A throw-away folder to run the command in, and what the command says.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use volref::film::Film;

/// Five points: a diamond with a heavy middle.
pub const CLOUD: &str = "\
v 0.5 0 0.5 0.4
v 0 0.5 0.5
v 0.5 0.5 0.5 2
v 1 0.5 0.5
v 0.5 1 0.4
";

/// A scene of the cloud, `film` and `classified` with room for further keys.
pub fn scene(classified: &str) -> String {
    format!(
        "[film]\nwidth = 12\nheight = 10\n\n\
         [transfer_function]\nreference_length = \"0.2 voxels\"\n\n\
         [classified]\n{classified}\n\
         [classified.volume]\nfile = \"../../volumes/cloud.obj\"\nresolution = 8\npadding = 1\n"
    )
}

/// A scene with no volume.
pub const CURVE: &str = "[film]\nwidth = 16\nheight = 12\n\n[curve]\n";

/// A complete manifest.
pub const MANIFEST: &str = "\
source = \"a test\"
shows = \"a diamond\"
computes = \"what the scene says\"
class = \"deterministic\"
";

/// A room with two boxes of smoke.
pub const ROOM: &str = include_str!("../../fixtures/scenes/smoke/cornell.toml");

/// What lines on stderr begin with that say how far the work is.
pub const SIGN_OF_LIFE: &str = "volref: ";

/// A folder that vanishes with its last user.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// An empty one.
    pub fn new() -> Folder {
        Folder(tempfile::tempdir().unwrap())
    }

    /// One with a cloud, a scene of it and a scene of a curve, at its top.
    pub fn with_scenes() -> Folder {
        let folder = Folder::new();
        folder.write("cloud.obj", CLOUD);
        folder.write("scene.toml", scene("").replace("../../volumes/", ""));
        folder.write("curve.toml", CURVE);
        folder
    }

    /// A suite of four cases without goldens: three share the cloud, `plots/curve` has none.
    pub fn with_suite() -> Folder {
        let folder = Folder::new();
        folder.write("fixtures/volumes/cloud.obj", CLOUD);
        let shadow = "[classified.phong]\n[classified.shadow]\nreference_step = \"0.05 voxels\"\n";
        for (case, scene) in [
            ("smoke/plain", scene("")),
            ("smoke/nearest", scene("interpolation = \"nearest\"\n")),
            ("smoke/shadow", scene(shadow)),
            ("plots/curve", CURVE.to_owned()),
        ] {
            folder.write(&format!("fixtures/scenes/{case}.toml"), scene);
            folder.write(&format!("fixtures/cases/{case}.toml"), MANIFEST);
        }
        folder
    }

    /// [`Folder::with_suite`] with goldens.
    pub fn with_goldens() -> Folder {
        let folder = Folder::with_suite();
        folder.accept_all();
        folder
    }

    /// A suite of one stochastic case without a golden, `fog/room`, of 16 × 16 pixels; `sampling` are the keys
    /// of its manifest.
    pub fn with_room(sampling: &str) -> Folder {
        let folder = Folder::new();
        let scene = ROOM.replace("= 256", "= 16");
        folder.write("fixtures/scenes/fog/room.toml", scene);
        let class = format!("class = \"stochastic\"\n{sampling}");
        let manifest = MANIFEST.replace("class = \"deterministic\"", &class);
        folder.write("fixtures/cases/fog/room.toml", manifest);
        folder
    }

    /// Makes goldens of all cases.
    pub fn accept_all(&self) {
        let run = self.volref("accept '*' --reason 'first goldens'");
        assert_eq!(run.code, 0, "{}", run.stderr);
    }

    /// A path inside.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Creates or replaces a file, and the folders above it.
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, contents).unwrap();
    }

    /// The contents of a file.
    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The contents of a text file.
    pub fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).unwrap()
    }

    /// The contents of a file of JSON.
    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.read(name)).unwrap()
    }

    /// The image in an EXR file.
    pub fn film(&self, name: &str) -> Film {
        Film::from_exr(&self.read(name)).unwrap()
    }

    /// Writes an image as an EXR file.
    pub fn write_film(&self, name: &str, film: &Film) {
        self.write(name, film.to_exr().unwrap());
    }

    /// Replaces the one place where `old` stands in a text file.
    pub fn edit(&self, name: &str, old: &str, new: &str) {
        let text = self.text(name);
        assert_eq!(
            text.matches(old).count(),
            1,
            "{old:?} stands once in {name}"
        );
        self.write(name, text.replace(old, new));
    }

    /// Removes a file.
    pub fn remove(&self, name: &str) {
        std::fs::remove_file(self.path(name)).unwrap();
    }

    /// Every file inside with its contents, hidden ones too. The lock of the goldens does not
    /// count: it is there for good, and means nothing.
    pub fn files(&self) -> BTreeMap<String, Vec<u8>> {
        let mut files = BTreeMap::new();
        collect(self.0.path(), self.0.path(), &mut files);
        files.remove("golden/.lock");
        files
    }

    /// The command, to be run in the folder: nothing of the caller's surroundings reaches it.
    pub fn command(&self, arguments: impl Arguments) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_volref"));
        command
            .args(arguments.words())
            .current_dir(self.0.path())
            .stdin(Stdio::null());
        for name in [
            "CI",
            "VOLREF_SUITE",
            "NO_COLOR",
            "CLICOLOR",
            "CLICOLOR_FORCE",
            "FORCE_COLOR",
        ] {
            command.env_remove(name);
        }
        // Nothing is kept from test to test.
        command.env("VOLREF_CACHE", "");
        // Help is wrapped to the terminal; without one, to its widest.
        command.env_remove("COLUMNS");
        command
    }

    /// A run with these variables of the environment, which name files of the folder.
    pub fn run_with(&self, variables: &[(&str, &str)], arguments: &[&str]) -> Run {
        let mut command = self.command(arguments);
        for (name, value) in variables {
            command.env(name, self.path(value));
        }
        Run::of(command.output().unwrap())
    }

    /// Runs the command in the folder.
    pub fn volref(&self, arguments: impl Arguments) -> Run {
        Run::of(self.command(arguments).output().unwrap())
    }
}

/// Arguments of the command: a line as it is typed at a shell, or word by word.
pub trait Arguments {
    fn words(self) -> Vec<String>;
}

impl Arguments for &str {
    fn words(self) -> Vec<String> {
        shell_words::split(self).expect("quotes come in pairs")
    }
}

impl Arguments for &[&str] {
    fn words(self) -> Vec<String> {
        self.iter().map(ToString::to_string).collect()
    }
}

impl Arguments for &Vec<&str> {
    fn words(self) -> Vec<String> {
        self[..].words()
    }
}

impl<const N: usize> Arguments for &[&str; N] {
    fn words(self) -> Vec<String> {
        self[..].words()
    }
}

fn collect(root: &Path, folder: &Path, files: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(root, &path, files);
        } else {
            let name = path.strip_prefix(root).unwrap().to_str().unwrap();
            let contents = std::fs::read(&path).unwrap_or_default();
            files.insert(name.replace('\\', "/"), contents);
        }
    }
}

/// What a run of the command came to.
#[derive(Debug)]
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    /// Whatever the command was asked, it must not have panicked or been killed.
    pub fn of(output: Output) -> Run {
        let text = |bytes| {
            let text = String::from_utf8(bytes).expect("the command writes UTF-8");
            // The one difference between platforms that paths make.
            if cfg!(windows) {
                text.replace('\\', "/")
            } else {
                text
            }
        };
        // How far the work is, is said only where it lasts: on a slow machine, or not at all.
        let stderr = text(output.stderr);
        let stderr = stderr.split_inclusive('\n');
        let run = Run {
            code: output.status.code().expect("no signal ended the command"),
            stdout: text(output.stdout),
            stderr: stderr
                .filter(|line| !line.starts_with(SIGN_OF_LIFE))
                .collect(),
        };
        assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
        assert_ne!(run.code, 101, "{}", run.stderr);
        run
    }

    /// All of it as one text, for a snapshot.
    pub fn shown(&self) -> String {
        let mut text = format!("exit code {}\n", self.code);
        for (name, part) in [("stdout", &self.stdout), ("stderr", &self.stderr)] {
            if !part.is_empty() {
                text.push_str(&format!("--- {name}\n{part}"));
            }
        }
        text
    }

    /// The message on stderr as one line, free of the frame it is drawn in: what is wrong and
    /// where, then the help.
    pub fn message(&self) -> String {
        let framed = |line: &str| {
            let start = line.trim_start().chars().next();
            start.is_some_and(|letter| letter.is_ascii_digit() || "╭·╰".contains(letter))
        };
        let frames = self.stderr.lines().filter(|line| !framed(line));
        let text = frames.map(|line| line.trim_start().trim_start_matches(['×', '│']));
        let words: Vec<_> = text.flat_map(str::split_whitespace).collect();
        words.join(" ")
    }

    /// Fails unless the command ended with `code` and its message holds all the `parts`.
    pub fn expect<'a>(&self, code: i32, parts: impl Parts<'a>) {
        let message = self.message();
        assert_eq!(self.code, code, "{message}\n{}", self.stdout);
        assert_holds(&message, parts);
    }

    /// Fails unless the command ended with `code` and printed all the `parts`.
    pub fn prints<'a>(&self, code: i32, parts: impl Parts<'a>) {
        assert_eq!(self.code, code, "{}{}", self.stdout, self.stderr);
        assert_holds(&self.stdout, parts);
    }

    /// stdout as JSON.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("{error}: {}{}", self.stdout, self.stderr))
    }
}

/// Parts of a text: one by one, or with an ellipsis, " … ", between them.
pub trait Parts<'a> {
    fn parts(self) -> Vec<&'a str>;
}

impl<'a> Parts<'a> for &'a str {
    fn parts(self) -> Vec<&'a str> {
        self.split(" … ").collect()
    }
}

impl<'a, S: AsRef<str>> Parts<'a> for &'a [S] {
    fn parts(self) -> Vec<&'a str> {
        self.iter().map(AsRef::as_ref).collect()
    }
}

impl<'a, S: AsRef<str>, const N: usize> Parts<'a> for &'a [S; N] {
    fn parts(self) -> Vec<&'a str> {
        self[..].parts()
    }
}

/// Fails unless `text` holds all the `parts`.
pub fn assert_holds<'a>(text: &str, parts: impl Parts<'a>) {
    for part in parts.parts() {
        assert!(text.contains(part), "{part:?} is not in: {text}");
    }
}

/// insta with everything hidden that differs from run to run: seconds and hashes.
macro_rules! assert_shown {
    ($($arguments:tt)*) => {{
        let mut settings = insta::Settings::clone_current();
        settings.add_filter(r" +\d+\.\d\d s\b", " [seconds]");
        settings.add_filter(r#""seconds": [0-9.e-]+"#, r#""seconds": "[seconds]""#);
        settings.add_filter(r#"time="[0-9.]+""#, r#"time="[seconds]""#);
        settings.add_filter(r"\b[0-9a-f]{64}\b", "[hash]");
        settings.add_filter(r"\b[0-9a-f]{12}\b", "[hash]");
        settings.bind(|| insta::assert_snapshot!($($arguments)*));
    }};
}
pub(crate) use assert_shown;

/// The repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files `fixtures/<folder>/*/*.toml` of the repository, in order.
pub fn tables_in(folder: &str) -> Vec<PathBuf> {
    let families = std::fs::read_dir(root().join("fixtures").join(folder)).unwrap();
    let files = families.flat_map(|family| std::fs::read_dir(family.unwrap().path()).unwrap());
    let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    // Scenes may have other files beside them.
    files.retain(|path| path.extension().is_some_and(|it| it == "toml"));
    files.sort();
    files
}

/// Copies a folder.
pub fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        match entry.path().is_dir() {
            true => copy(&entry.path(), &target),
            false => drop(std::fs::copy(entry.path(), target).unwrap()),
        }
    }
}
