//! Imports between the files of `src/`.
//!
//! A file imports another where its code names an item that the other defines: by a path from
//! `crate::`, `super::` or `self::`, by a module that the file declares (`child::Item`), or by a
//! name that an import brings in. Four rules make that a map of who depends on whom:
//!
//! - **A re-export is a signpost, not a dependency.** `pub use field::DensityField` in
//!   `volume/mod.rs` makes no arrow to `volume/field.rs`, unless `mod.rs` itself uses the name; and
//!   whoever names `crate::volume::DensityField` imports `volume/field.rs`, where it is defined.
//!   The same goes for `mod field;`.
//! - **A path ends where the files end.** Of `crate::a::b::Item` that is the file of `b`, or the file
//!   to which `b` re-exports `Item` from; of `crate::a::b` as a module, it is `b` only where an item
//!   of it is named behind it (`b::item`).
//! - **A module contains its children.** What `plan.rs` takes from `plan/effect.rs` makes no arrow; what
//!   a child takes from the file of its parent does, and what it takes from its siblings.
//! - **Tests do not count**, for a unit test may run the whole program to see a part of it: neither
//!   files that only tests are in, nor what follows `#[cfg(test)]` before a module `tests`.
//!
//! What the text does not say goes unseen: a method called on a value whose type is not named.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module as its path from the root of the crate: `["volume", "field"]`.
type Module = Vec<String>;

/// The files of a source tree and what each of them imports. Files are called by their path below
/// `src/`, with slashes.
pub struct Files {
    modules: BTreeMap<Module, Source>,
}

struct Source {
    file: String,
    /// Code without comments, strings and tests.
    code: String,
    /// Names in scope by `use`, and the paths that they stand for; of globs, the name is `*`.
    uses: Vec<Use>,
}

struct Use {
    name: String,
    path: Module,
    is_public: bool,
}

impl Files {
    /// Of files given by their path below `src/` and their text.
    pub fn of<'t>(texts: impl IntoIterator<Item = (&'t str, &'t str)>) -> Files {
        let sources = texts
            .into_iter()
            .filter(|(file, _)| !is_test(file) && !["lib.rs", "main.rs"].contains(file));
        let modules = sources.map(|(file, text)| {
            let module = module_of(file);
            let code = code_of(text);
            let (uses, code) = uses(&code, &module);
            let file = file.to_owned();
            (module, Source { file, code, uses })
        });
        Files {
            modules: modules.collect(),
        }
    }

    /// Of a folder on disk.
    pub fn read(source: &Path, files: &[std::path::PathBuf]) -> Files {
        let texts: Vec<(String, String)> = files
            .iter()
            .map(|path| {
                let relative = path.strip_prefix(source).unwrap().display().to_string();
                (
                    relative.replace('\\', "/"),
                    std::fs::read_to_string(path).unwrap(),
                )
            })
            .collect();
        Files::of(texts.iter().map(|(file, text)| (&**file, &**text)))
    }

    /// For each file, those that it imports.
    pub fn imports(&self) -> BTreeMap<&str, BTreeSet<&str>> {
        let all = self.modules.iter();
        all.map(|(module, source)| (&*source.file, self.imports_of(module, source)))
            .collect()
    }

    fn imports_of(&self, module: &Module, source: &Source) -> BTreeSet<&str> {
        let mut found = BTreeSet::new();
        for import in &source.uses {
            // A re-export counts where the file uses the name itself.
            let is_used = import.name == "*" || has_word(&source.code, &import.name);
            if is_used && !(import.is_public && import.name == "*") {
                self.resolve(&import.path, &mut found);
            }
        }
        for path in paths(&source.code) {
            if let Some(path) = self.absolute(module, source, path) {
                self.resolve(&path, &mut found);
            }
        }
        found.retain(|file| !module_of(file).starts_with(module));
        found
    }

    /// `path`, as it stands in the code of `module`, from the root of the crate; none where it
    /// begins with another crate, or a name that is no module.
    fn absolute(&self, module: &Module, source: &Source, path: Module) -> Option<Module> {
        let first = path.first()?;
        if ["crate", "super", "self"].contains(&&**first) {
            return Some(from_root(module, &path));
        }
        let child: Module = module.iter().chain([first]).cloned().collect();
        let rest = path.iter().skip(1).cloned();
        if self.modules.contains_key(&child) {
            return Some(child.into_iter().chain(rest).collect());
        }
        let import = source.uses.iter().find(|import| import.name == *first)?;
        Some(import.path.iter().cloned().chain(rest).collect())
    }

    /// Adds the file that defines what `path` names.
    fn resolve<'f>(&'f self, path: &[String], found: &mut BTreeSet<&'f str>) {
        let longest = (1..=path.len()).rev();
        let mut those = longest.filter_map(|end| Some((end, self.modules.get(&path[..end])?)));
        let Some((end, source)) = those.next() else {
            return;
        };
        let Some(name) = path.get(end) else {
            // A module, not an item of it: the items are named where they are used.
            return;
        };
        if name == "*" {
            found.insert(&source.file);
            return;
        }
        let public = |import: &&Use| import.is_public && import.name == *name;
        let mut globs = source
            .uses
            .iter()
            .filter(|import| import.is_public && import.name == "*");
        match source.uses.iter().find(public) {
            // A macro of this file is handed on by its own name.
            Some(import) if import.path != path[..=end] => {
                let rest = path[end + 1..].iter().cloned();
                let target: Module = import.path.iter().cloned().chain(rest).collect();
                self.resolve(&target, found);
            }
            // A glob hands on what this file does not define itself.
            _ if !defines(&source.code, name) && globs.clone().next().is_some() => {
                if let Some(import) = globs.find(|import| self.has(&import.path, name)) {
                    self.resolve(&import.path, found);
                }
            }
            _ => {
                found.insert(&source.file);
            }
        }
    }

    /// Whether the module of a glob (`a::b::*`) defines `name`.
    fn has(&self, glob: &[String], name: &str) -> bool {
        let module = &glob[..glob.len() - 1];
        self.modules
            .get(module)
            .is_some_and(|source| defines(&source.code, name))
    }
}

/// Groups of files each of which imports, over others, all of its group: circles.
pub fn circles<'f>(imports: &BTreeMap<&'f str, BTreeSet<&'f str>>) -> Vec<Vec<&'f str>> {
    let reachable = |from: &'f str| {
        let mut seen = BTreeSet::new();
        let mut next = vec![from];
        while let Some(file) = next.pop() {
            let targets = imports.get(file).into_iter().flatten().copied();
            next.extend(targets.filter(|target| seen.insert(*target)));
        }
        seen
    };
    let reach: BTreeMap<&str, BTreeSet<&str>> = imports
        .keys()
        .map(|file| (*file, reachable(file)))
        .collect();
    let mut groups = BTreeSet::new();
    for (file, seen) in reach.iter().filter(|(file, seen)| seen.contains(*file)) {
        let group: Vec<&str> = seen
            .iter()
            .copied()
            .filter(|other| reach[other].contains(file))
            .collect();
        groups.insert(group);
    }
    groups.into_iter().collect()
}

fn is_test(file: &str) -> bool {
    file.ends_with("tests.rs") || file.contains("/tests/")
}

/// `volume/field.rs` is `volume::field`, `volume/mod.rs` and `volume.rs` are `volume`.
fn module_of(file: &str) -> Module {
    let path = file.trim_end_matches(".rs").trim_end_matches("/mod");
    path.split('/').map(str::to_owned).collect()
}

/// `path`, which begins with `crate`, `super` or `self` in the code of `module`, from the root.
fn from_root(module: &[String], path: &[String]) -> Module {
    let mut base = module.to_vec();
    let mut rest = path;
    while let Some((first, others)) = rest.split_first() {
        match &**first {
            "crate" => base.clear(),
            "self" => {}
            "super" => {
                base.pop();
            }
            _ => break,
        }
        rest = others;
    }
    base.extend(rest.iter().cloned());
    base
}

/// The code of `text`: without comments, the contents of strings and characters, and tests.
fn code_of(text: &str) -> String {
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or("");
    let mut found = String::new();
    let mut rest = code.chars().peekable();
    while let Some(letter) = rest.next() {
        match letter {
            '/' if rest.peek() == Some(&'/') => {
                rest.by_ref().find(|letter| *letter == '\n');
                found.push('\n');
            }
            '"' => {
                while let Some(letter) = rest.next() {
                    match letter {
                        '\\' => drop(rest.next()),
                        '"' => break,
                        _ => {}
                    }
                }
                found.push_str("\"\"");
            }
            // A character that would open a string.
            '\'' if rest.peek() == Some(&'"') => drop(rest.next()),
            '\'' if rest.peek() == Some(&'\\') => {
                rest.next();
                rest.next();
            }
            _ => found.push(letter),
        }
    }
    found
}

/// The imports of `code`, and the code without them.
fn uses(code: &str, module: &Module) -> (Vec<Use>, String) {
    let mut found = Vec::new();
    let mut left = String::new();
    let mut rest = code;
    while let Some(at) = find_word(rest, "use") {
        let before = &rest[..at];
        let after = &rest[at + 3..];
        let Some(end) = after.find(';').filter(|_| is_item(before)) else {
            left.push_str(&rest[..at + 3]);
            rest = after;
            continue;
        };
        let line = before.rsplit(['\n', ';', '}', '{']).next().unwrap_or("");
        let is_public = line.contains("pub");
        left.push_str(before);
        for (name, path) in tree(&[], after[..end].trim()) {
            let is_local = ["crate", "super", "self"].contains(&&*path[0]);
            // A module of this file, or another crate: which, the map of modules says.
            let path = if is_local {
                from_root(module, &path)
            } else {
                module.iter().cloned().chain(path).collect()
            };
            found.push(Use {
                name,
                path,
                is_public,
            });
        }
        rest = &after[end + 1..];
    }
    left.push_str(rest);
    (found, left)
}

/// Whether an item may begin behind `before`: `use` is a keyword nowhere else but in bounds.
fn is_item(before: &str) -> bool {
    let line = before
        .rsplit(['\n', ';', '}', '{'])
        .next()
        .unwrap_or("")
        .trim();
    line.is_empty() || line == "pub" || line.starts_with("pub(") && line.ends_with(')')
}

/// The names that `a::{b, c as d, e::*}` brings in, with their paths.
fn tree(prefix: &[String], text: &str) -> Vec<(String, Module)> {
    let text = text.trim();
    if let Some((head, list)) = text.split_once('{') {
        let inside = list.rsplit_once('}').map_or(list, |(inside, _)| inside);
        let head = head.trim().trim_end_matches("::");
        let prefix: Module = prefix.iter().cloned().chain(segments(head)).collect();
        return entries(inside)
            .into_iter()
            .flat_map(|entry| tree(&prefix, entry))
            .collect();
    }
    if text.is_empty() {
        return Vec::new();
    }
    let (path, alias) = match text.split_once(" as ") {
        Some((path, alias)) => (path, Some(alias.trim().to_owned())),
        None => (text, None),
    };
    let mut path: Module = prefix.iter().cloned().chain(segments(path)).collect();
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let name = alias.unwrap_or_else(|| path[path.len() - 1].clone());
    vec![(name, path)]
}

fn segments(path: &str) -> impl Iterator<Item = String> {
    let parts = path.split("::").map(str::trim);
    parts.filter(|part| !part.is_empty()).map(str::to_owned)
}

/// The entries of a list that are separated by commas outside of braces.
fn entries(list: &str) -> Vec<&str> {
    let (mut found, mut depth, mut begin) = (Vec::new(), 0, 0);
    for (at, letter) in list.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                found.push(&list[begin..at]);
                begin = at + 1;
            }
            _ => {}
        }
    }
    found.push(&list[begin..]);
    found
}

/// The paths of two names or more in `code`.
fn paths(code: &str) -> Vec<Module> {
    let is_name = |letter: char| letter.is_alphanumeric() || letter == '_';
    let mut found = Vec::new();
    let mut rest = code;
    while let Some(at) = rest.find("::") {
        let begin = rest[..at]
            .rfind(|letter| !is_name(letter))
            .map_or(0, |last| last + 1);
        let mut path = vec![rest[begin..at].to_owned()];
        let mut end = at;
        while rest[end..].starts_with("::") {
            let name: String = rest[end + 2..]
                .chars()
                .take_while(|l| is_name(*l))
                .collect();
            if name.is_empty() {
                break;
            }
            end += 2 + name.len();
            path.push(name);
        }
        rest = &rest[end.max(at + 2)..];
        if path.len() > 1 && !path[0].is_empty() {
            found.push(path);
        }
    }
    found
}

fn find_word(text: &str, word: &str) -> Option<usize> {
    let is_name = |letter: char| letter.is_alphanumeric() || letter == '_';
    let alone = |at: &usize| {
        let before = text[..*at].chars().next_back();
        let after = text[at + word.len()..].chars().next();
        !before.is_some_and(is_name) && !after.is_some_and(is_name)
    };
    text.match_indices(word).map(|(at, _)| at).find(alone)
}

fn has_word(text: &str, word: &str) -> bool {
    find_word(text, word).is_some()
}

/// Whether `code` defines an item called `name`.
fn defines(code: &str, name: &str) -> bool {
    const KINDS: [&str; 8] = [
        "fn",
        "struct",
        "enum",
        "trait",
        "const",
        "static",
        "type",
        "macro_rules!",
    ];
    KINDS
        .iter()
        .any(|kind| has_word(code, &format!("{kind} {name}")))
}
