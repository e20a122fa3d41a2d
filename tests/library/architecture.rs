//! The rooms of `src/` and the arrows between them: imports only point down, and between files they
//! make no circles.

#[path = "architecture/files.rs"]
mod files;

use files::{Files, circles};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A room of the table in `ARCHITECTURE.md`.
struct Room {
    name: &'static str,
    /// Lines of code, at most.
    most_lines: usize,
    /// Files to read first, within its folder.
    first: Vec<&'static str>,
    /// Rooms below it that it imports none the less.
    never: Vec<&'static str>,
}

/// The rooms of the table, from the top down. `main.rs` and `lib.rs` are in none.
fn rooms() -> Vec<Room> {
    let table = include_str!("../../ARCHITECTURE.md")
        .split_once("## Rooms")
        .unwrap()
        .1;
    let table = table.split_once("\n## ").unwrap().0;
    let rows = table.lines().filter(|line| line.starts_with("| `"));
    let quoted = |cell: &'static str| cell.split('`').skip(1).step_by(2).collect::<Vec<_>>();
    rows.map(|row| {
        let cells: Vec<&str> = row.trim_matches('|').split('|').collect();
        assert_eq!(cells.len(), 6, "{row}");
        Room {
            name: quoted(cells[0])[0],
            most_lines: cells[1].trim().parse().expect(row),
            first: quoted(cells[3]),
            never: quoted(cells[5]),
        }
    })
    .collect()
}

/// What is wrong with the imports of `text`, a source file of the room `room`.
fn wrong_arrows(room: &str, text: &str) -> Vec<String> {
    let rooms = rooms();
    let place = |name: &str| rooms.iter().position(|room| room.name == name);
    let Some(from) = place(room) else {
        return vec![format!("{room} is no room of ARCHITECTURE.md")];
    };
    let mut wrong = Vec::new();
    for target in imports(text).iter().filter(|target| *target != room) {
        match place(target) {
            None => wrong.push(format!(
                "{room} imports {target}, which is no room of ARCHITECTURE.md"
            )),
            Some(to) if to < from || rooms[from].never.contains(&target.as_str()) => {
                wrong.push(format!("{room} must not import {target}"));
            }
            Some(_) => {}
        }
    }
    wrong
}

/// The first name of every `crate::…` path outside comments: code and tests alike, for a test
/// that reaches up makes its room as hard to move as code does.
fn imports(text: &str) -> BTreeSet<String> {
    let code = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or(""))
        .collect::<Vec<_>>()
        .join("\n");
    let mut found = BTreeSet::new();
    for (at, path) in code.match_indices("crate::") {
        // `$crate::` and `some_crate::` are other things.
        let before = code[..at].chars().next_back();
        if before.is_some_and(|letter| letter.is_alphanumeric() || letter == '_' || letter == '$') {
            continue;
        }
        let after = code[at + path.len()..].trim_start();
        match after.strip_prefix('{') {
            Some(list) => found.extend(first_names(list)),
            None => found.extend(name_at_start(after)),
        }
    }
    found
}

/// The first name of each entry of `a::b, c::{d, e}, f}`, up to the closing brace.
fn first_names(list: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut depth = 0;
    let mut entry_begins = true;
    for (at, letter) in list.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => entry_begins = true,
            _ if letter.is_whitespace() => {}
            _ if entry_begins => {
                names.extend(name_at_start(&list[at..]));
                entry_begins = false;
            }
            _ => {}
        }
    }
    names
}

fn name_at_start(text: &str) -> Option<String> {
    let name: String = text
        .chars()
        .take_while(|letter| letter.is_alphanumeric() || *letter == '_')
        .collect();
    (!name.is_empty()).then_some(name)
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// The room a file of `src/` is in: `film/png_file.rs` and `film.rs` are in `film`.
fn room_of(relative: &Path) -> String {
    let first = relative.iter().next().unwrap().to_str().unwrap();
    first.trim_end_matches(".rs").to_owned()
}

#[test]
fn arrows_only_point_down() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut wrong = Vec::new();
    let mut seen = BTreeSet::new();
    for path in rust_files(&source) {
        let relative = path.strip_prefix(&source).unwrap();
        let room = room_of(relative);
        if room == "main" || room == "lib" {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let faults = wrong_arrows(&room, &text);
        wrong.extend(
            faults
                .into_iter()
                .map(|fault| format!("src/{}: {fault}", relative.display())),
        );
        seen.insert(room);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // A walk that finds nothing finds no fault either.
    for room in ["cli", "suite", "render", "scene", "film", "math"] {
        assert!(seen.contains(room), "no file of {room} was read");
    }
}

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

#[test]
fn files_import_each_other_in_no_circles() {
    let files = Files::read(&source(), &rust_files(&source()));
    let imports = files.imports();
    let found = circles(&imports);
    assert!(found.is_empty(), "files that import each other: {found:?}");
    // A graph without arrows has no circles either.
    for (file, target) in [
        ("render/image.rs", "render/classified/ray_caster.rs"),
        ("render/classified/ray_caster.rs", "render/pixels.rs"),
        ("render/classified/ray_caster.rs", "volume/grid.rs"),
        ("scene/load.rs", "scene/radiative.rs"),
    ] {
        assert!(imports[file].contains(target), "{file} imports {target}");
    }
}

/// Whoever reads one model of light need not know the other. What is shared stands above their
/// folders, or below in other rooms.
#[test]
fn each_model_of_light_is_read_by_itself() {
    const MODELS: [&str; 4] = [
        "render/classified/",
        "render/radiative/",
        "render/plan/classified.rs",
        "render/plan/radiative",
    ];
    let of = |file: &str| {
        let place = MODELS.iter().position(|model| file.starts_with(model));
        place.map(|place| place % 2)
    };
    let files = Files::read(&source(), &rust_files(&source()));
    let mut seen = [0; 2];
    for (file, targets) in files.imports() {
        let Some(model) = of(file) else { continue };
        seen[model] += 1;
        for target in targets {
            assert!(
                of(target).is_none_or(|other| other == model),
                "{file} names {target}"
            );
        }
    }
    assert!(seen[0] > 8 && seen[1] > 15, "{seen:?}");
}

/// Ways to open a file that ask neither what it is nor how long.
const UNASKED: [&str; 6] = [
    "File::open(",
    "File::options(",
    "OpenOptions",
    "fs::read(",
    "fs::read)",
    "fs::read_to_string",
];

/// Lines that open what is no input: a folder to be synced, a stream or a lock to be written.
const ASKED: [(&str, &str); 3] = [
    (
        "files/atomic_file.rs",
        "let mut stream = File::options().append(true).open(path)?;",
    ),
    (
        "files/atomic_file.rs",
        "match File::open(directory)?.sync_all() {",
    ),
    ("suite/store.rs", "let mut options = File::options();"),
];

/// The lines of `text` that open a file unasked, up to its tests.
fn unasked_lines(text: &str) -> Vec<&str> {
    let code = text.split("\nmod tests {").next().unwrap_or("");
    let lines = code.lines().map(str::trim);
    let lines = lines.filter(|line| !line.starts_with("//"));
    lines
        .filter(|line| UNASKED.iter().any(|way| line.contains(way)))
        .collect()
}

/// Whoever opens a file by himself waits for ever at a pipe, reads a device until memory is gone,
/// and lets an output be written over it.
#[test]
fn files_are_read_through_one_door() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    for path in rust_files(&source) {
        let relative = path.strip_prefix(&source).unwrap();
        let relative = relative.display().to_string().replace('\\', "/");
        let only_tests = relative.contains("/tests/") || relative.ends_with("tests.rs");
        if relative == "files/regular_file.rs" || only_tests {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        for line in unasked_lines(&text) {
            found.push((relative.clone(), line.to_owned()));
        }
    }
    let asked: Vec<_> = ASKED
        .iter()
        .map(|(file, line)| ((*file).to_owned(), (*line).to_owned()))
        .collect();
    assert_eq!(found, asked, "open files by crate::files::regular_file");
    let text =
        "// File::open(path)\nlet a = std::fs::read(path);\n#[cfg(test)]\nmod tests {\nfs::read(x)";
    assert_eq!(unasked_lines(text), ["let a = std::fs::read(path);"]);
}

/// The plan is the only way to a kernel: no other room names one. Rows of hard cases ask kernels alone.
#[test]
fn no_other_room_names_a_kernel() {
    let named = |code: &str| {
        let lists = || {
            code.split("render::{")
                .skip(1)
                .filter_map(|rest| rest.split(';').next())
        };
        ["classified::", "radiative::"].iter().any(|kernels| {
            let direct = code.contains(&format!("render::{kernels}"));
            direct || lists().any(|list| list.contains(kernels))
        })
    };
    let mut found = Vec::new();
    for path in rust_files(&source()) {
        let relative = path.strip_prefix(source()).unwrap();
        let may = ["render"].contains(&room_of(relative).as_str());
        if !may && named(&rendering_code(&std::fs::read_to_string(&path).unwrap())) {
            found.push(relative.display().to_string());
        }
    }
    assert_eq!(found, [""; 0]);
    assert!(named("use crate::render::classified::steps::Steps;"));
    assert!(named(
        "use crate::render::{Plan, radiative::tracker::Tracker};"
    ));
    assert!(!named(
        "use crate::render::{Plan, render}; use crate::scene::classified::A;"
    ));
}

/// Code of a file without comments, tests and re-exports.
fn rendering_code(text: &str) -> String {
    let code = text.split("#[cfg(test)]").next().unwrap_or("");
    let lines = code
        .lines()
        .map(|line| line.split("//").next().unwrap_or(""));
    let mut code = lines.collect::<Vec<_>>().join("\n");
    while let Some(start) = code.find("pub use ") {
        let end = code[start..]
            .find(';')
            .map_or(code.len(), |end| start + end + 1);
        code.replace_range(start..end, "");
    }
    code
}

/// A number drawn beside the sampler would be missing in the counters.
#[test]
fn the_sampler_alone_draws_random_numbers() {
    let room = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/render/radiative");
    let mut found = Vec::new();
    for path in rust_files(&room) {
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or("");
        if code.contains("Stream") {
            found.push(path.file_name().unwrap().display().to_string());
        }
    }
    found.sort();
    // The kernels name the stream of a path, and give it to its sampler.
    assert_eq!(found, ["kernels.rs", "sampler.rs"]);
}

/// Lines of code of a file, as `scripts/code-lines.sh` counts them: without comments, blank lines and, at its end, tests.
fn code_lines(text: &str) -> usize {
    let tests = ["\n#[cfg(test)]\nmod ", "\n#[cfg(all(test, unix))]\nmod "];
    let ends = tests.iter().filter_map(|tests| {
        let begins = text.match_indices(tests);
        let with_body = begins.filter(|(at, _)| {
            text[at + tests.len()..]
                .lines()
                .next()
                .unwrap()
                .ends_with('{')
        });
        with_body.map(|(at, _)| at).next()
    });
    let code = &text[..ends.min().unwrap_or(text.len())];
    let is_code = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
    code.lines().filter(is_code).count()
}

fn code_lines_of(path: &Path) -> usize {
    code_lines(&std::fs::read_to_string(path).unwrap())
}

/// The plain renderers are there to be read.
#[test]
fn the_reference_is_short() {
    for (file, most) in [("ray_caster.rs", 149), ("path_tracer.rs", 300)] {
        let lines = code_lines_of(&source().join("reference").join(file));
        assert!(
            lines <= most,
            "{file}: {lines} lines of code, at most {most}"
        );
    }
}

/// A room grows only where a commit raises its number, and says what a user gets for it.
#[test]
fn no_room_is_larger_than_the_table_says() {
    let mut found = std::collections::BTreeMap::<String, usize>::new();
    for path in rust_files(&source()) {
        let is_tests = path.ends_with("tests.rs") || path.iter().any(|part| part == "tests");
        let name = room_of(path.strip_prefix(source()).unwrap());
        *found.entry(name).or_default() += if is_tests { 0 } else { code_lines_of(&path) };
    }
    for Room {
        name, most_lines, ..
    } in rooms()
    {
        let lines = found[name];
        assert!(
            lines <= most_lines,
            "{name}: {lines} lines of code, at most {most_lines}"
        );
    }
    let tests = rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests"));
    let tests: usize = tests.iter().map(|path| code_lines_of(path)).sum();
    let said = include_str!("../../ARCHITECTURE.md")
        .split_once("The tests have at most ")
        .unwrap()
        .1;
    let most: usize = said.split(' ').next().unwrap().parse().unwrap();
    assert!(
        tests <= most,
        "tests: {tests} lines of code, at most {most}"
    );
}

#[test]
fn lines_of_code_are_counted_without_tests_and_comments() {
    let text = "// comment\nuse a;\n\n    /// doc\n    fn b() {}\n#[cfg(test)]\nfn c() {}\n#[cfg(test)]\nmod tests {\n}\n";
    assert_eq!(code_lines(text), 4);
    assert_eq!(code_lines(&text.replace("mod tests {", "mod tests;")), 7);
}

#[test]
fn main_only_calls_the_command_line() {
    let main = include_str!("../../src/main.rs");
    let calls: Vec<_> = main
        .lines()
        .filter(|line| line.contains("volref::"))
        .collect();
    assert_eq!(calls, ["    volref::cli::main(suite_files)"]);
}

#[test]
fn the_table_names_what_there_is() {
    let rooms = rooms();
    let place = |name: &str| rooms.iter().position(|room| room.name == name);
    for (index, room) in rooms.iter().enumerate() {
        let folder = source().join(room.name);
        for file in &room.first {
            let beside = source().join(file);
            assert!(
                folder.join(file).exists() || beside.exists(),
                "{}: {file}",
                room.name
            );
        }
        for never in &room.never {
            assert!(
                place(never) > Some(index),
                "{} never imports {never} anyway",
                room.name
            );
        }
    }
    // The files of the tables below.
    let page = include_str!("../../ARCHITECTURE.md");
    let below = page.split_once("\n## The way").unwrap().1;
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let paths = below.split('`').skip(1).step_by(2);
    let paths = paths.filter(|path| path.contains('/') && !path.contains([' ', '*']));
    let mut checked = 0;
    for path in paths {
        assert!(
            root.join(path).exists() || source().join(path).exists(),
            "{path}"
        );
        checked += 1;
    }
    assert!(checked > 20);
}

#[test]
fn the_checker_can_fail() {
    let faults = |room: &str, text: &str| wrong_arrows(room, text).join("; ");
    let upward = "use crate::scene::Scene;";
    assert_eq!(faults("film", upward), "film must not import scene");
    assert_eq!(faults("render", upward), "");
    assert_eq!(
        faults("volume", "fn f() { crate::suite::open() }"),
        "volume must not import suite"
    );
    assert_eq!(
        faults(
            "math",
            "use crate::{\n    math::Sum,\n    film::{Film, render},\n    suite,\n};"
        ),
        "math must not import film; math must not import suite"
    );
    assert_eq!(
        faults("cli", "use crate::kitchen::Sink;"),
        "cli imports kitchen, which is no room of ARCHITECTURE.md"
    );
    assert_eq!(faults("attic", ""), "attic is no room of ARCHITECTURE.md");
    assert_eq!(
        faults("math", "//! See [`crate::film`].\nuse other_crate::film;"),
        ""
    );
    assert_eq!(
        faults("geometry", "#[cfg(test)]\nmod tests { use crate::render; }"),
        "geometry must not import render"
    );
}
