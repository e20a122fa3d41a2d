//! Plain English in the guide, the README, the changelog, the help, the messages and the schemas: how long they may be,
//! how no sentence begins, and which words of our own do not occur.

use crate::common::suite::root;
use std::path::{Path, PathBuf};

/// Words of the guide in all, without the definitions of links for rustdoc.
const MOST_WORDS: usize = 20_000;

/// Pictures of the guide at least.
const FEWEST_PICTURES: usize = 10;

/// Lines of the changelog.
const MOST_CHANGES: usize = 120;

/// Beginnings of sentences that put the object first.
const BEGINNINGS: [&str; 5] = ["Of", "That of", "Those", "Likewise", "What is"];

/// Our own words, where the field has one: parameter, diagnosis, subsampled render, search, residual.
const OWN_WORDS: [&str; 8] = [
    "number of a scene",
    "number of the scene",
    "numbers of a scene",
    "numbers of the scene",
    "likeness",
    "glimpse",
    "hunt",
    "misfit",
];

/// Files below `folder` with the extension, in order.
fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|of| of == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// The chapters, without the definitions of links for rustdoc.
fn chapters() -> Vec<PathBuf> {
    let mut chapters = files("src/guide", "md");
    chapters.retain(|path| !path.ends_with("links.md"));
    chapters
}

/// Paragraphs, items and cells of a page in Markdown, without its blocks of code.
fn paragraphs(page: &str) -> Vec<String> {
    let mut paragraphs = vec![String::new()];
    let mut is_code = false;
    for line in page.lines().map(str::trim) {
        let numbered = line.split_once(". ");
        let numbered = numbered.filter(|(number, _)| number.parse::<u8>().is_ok());
        let item = line.strip_prefix("- ").or(numbered.map(|(_, item)| item));
        if line.starts_with("```") {
            is_code = !is_code;
        } else if is_code {
        } else if line.starts_with('|') {
            paragraphs.extend(line.split('|').map(|cell| cell.trim().to_owned()));
            paragraphs.push(String::new());
        } else if line.is_empty() || line.starts_with('#') {
            paragraphs.push(line.trim_start_matches(['#', ' ']).to_owned());
            paragraphs.push(String::new());
        } else {
            if item.is_some() {
                paragraphs.push(String::new());
            }
            let last = paragraphs.last_mut().unwrap();
            last.push_str(item.unwrap_or(line));
            last.push(' ');
        }
    }
    paragraphs
}

/// Texts of a source file that users may read.
struct Texts {
    /// Messages, descriptions of keys, and whatever else is a string.
    strings: Vec<String>,
    /// Paragraphs of documentation, of which help is made, too; without the code in them.
    docs: Vec<String>,
}

fn texts(code: &str) -> Texts {
    let mut docs = String::new();
    let mut strings = Vec::new();
    let mut rest = code;
    while let Some(at) = rest.find(['"', '\'', '/', 'r']) {
        let found = &rest[at..];
        let before = rest[..at].chars().next_back();
        if let Some(comment) = found.strip_prefix("//") {
            let (line, after) = comment.split_once('\n').unwrap_or((comment, ""));
            if let Some(doc) = line.strip_prefix(['/', '!']) {
                docs.push_str(doc);
                docs.push('\n');
                // A line of code ends a comment.
                if !after.trim_start().starts_with("//") {
                    docs.push('\n');
                }
            }
            rest = after;
        } else if let Some(hashes) = raw_string(found).filter(|_| !before.is_some_and(is_of_name)) {
            let end = format!("\"{}", "#".repeat(hashes));
            let (string, after) = found[hashes + 2..].split_once(&end).unwrap();
            strings.push(string.to_owned());
            rest = after;
        } else if let Some(string) = found.strip_prefix('"') {
            let length = length_of_string(string);
            strings.push(unescaped(&string[..length]));
            rest = &string[length + 1..];
        } else if let Some(after) = found.strip_prefix("'\"'") {
            rest = after;
        } else if found.starts_with("'\\") {
            let length = found[3..].find('\'').map_or(3, |end| end + 4);
            rest = &found[length..];
        } else {
            rest = &found[1..];
        }
    }
    let docs = paragraphs(&docs);
    Texts { strings, docs }
}

fn is_of_name(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

/// Number of the marks `#` of a raw string, if `code` begins with one.
fn raw_string(code: &str) -> Option<usize> {
    let marks = code.strip_prefix('r')?;
    let hashes = marks.len() - marks.trim_start_matches('#').len();
    marks[hashes..].starts_with('"').then_some(hashes)
}

/// Bytes of a string up to the quotation mark that ends it.
fn length_of_string(string: &str) -> usize {
    let mut is_escaped = false;
    let end = string.find(|character| {
        let ends = character == '"' && !is_escaped;
        is_escaped = character == '\\' && !is_escaped;
        ends
    });
    end.expect("a string ends")
}

/// A string with its line breaks as paragraphs, and lines that go on joined.
fn unescaped(string: &str) -> String {
    let lines = string.split("\\\n").map(str::trim_start);
    lines.collect::<String>().replace("\\n", "\n")
}

/// Sentences of a text; line breaks of strings end one, too.
fn sentences(text: &str) -> Vec<&str> {
    let parts = text.split_inclusive(['.', '!', '?', '\n']);
    let mut begin = 0;
    let mut end = 0;
    let mut sentences = Vec::new();
    for part in parts {
        end += part.len();
        if part.ends_with('\n') || text[end..].starts_with([' ', '\n']) || end == text.len() {
            sentences.push(text[begin..end].trim_matches([' ', '\n', '*', '>', '(']));
            begin = end;
        }
    }
    sentences.push(text[begin..].trim());
    sentences
}

fn begins_badly(sentence: &str) -> bool {
    let beginnings = BEGINNINGS.iter();
    let mut found = beginnings.filter_map(|beginning| sentence.strip_prefix(beginning));
    found.any(|rest| rest.starts_with([' ', ',']))
}

/// Sentences of `texts` that begin badly; `has_own_words` asks for our own words, too. A value that is printed, `{misfit}`, is no
/// word.
fn faults(texts: &[String], has_own_words: bool) -> Vec<String> {
    let mut faults = Vec::new();
    for sentence in texts.iter().flat_map(|text| sentences(text)) {
        let small = sentence.to_lowercase();
        let own = OWN_WORDS.iter().any(|own| {
            let mut found = small.match_indices(own);
            found.any(|(at, _)| !small[..at].ends_with(|c| is_of_name(c) || c == '{'))
        });
        if begins_badly(sentence) || has_own_words && own {
            faults.push(sentence.chars().take(120).collect());
        }
    }
    faults
}

#[test]
fn pages_are_in_plain_english() {
    let pages = [
        "README.md",
        "CHANGELOG.md",
        "CONTRIBUTING.md",
        "ARCHITECTURE.md",
    ];
    let mut wrong = Vec::new();
    for path in chapters()
        .into_iter()
        .chain(pages.map(|page| root().join(page)))
    {
        // That one names files.
        let has_own_words = !path.ends_with("ARCHITECTURE.md");
        let found = faults(&paragraphs(&text(&path)), has_own_words);
        wrong.extend(
            found
                .into_iter()
                .map(|it| format!("{}: {it}", path.display())),
        );
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Help and documentation are made of comments, messages of strings.
#[test]
fn help_messages_and_documentation_are_in_plain_english() {
    let source = root().join("src");
    let mut wrong = Vec::new();
    for path in files("src", "rs") {
        let name = path.strip_prefix(&source).unwrap();
        let of_users = name.starts_with("cli");
        let Texts { strings, docs } = texts(&text(&path));
        let found = [faults(&strings, true), faults(&docs, of_users)].concat();
        wrong.extend(found.iter().map(|it| format!("{}: {it}", name.display())));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_guide_is_short_and_has_pictures() {
    let pages: Vec<_> = chapters().iter().map(|path| text(path)).collect();
    let is_word = |word: &&str| word.contains(char::is_alphabetic);
    let words: usize = pages
        .iter()
        .map(|page| page.split_whitespace().filter(is_word).count())
        .sum();
    assert!(
        words <= MOST_WORDS,
        "the guide has {words} words, at most {MOST_WORDS}"
    );
    let pictures: usize = pages.iter().map(|page| page.matches("![").count()).sum();
    assert!(
        pictures >= FEWEST_PICTURES,
        "the guide has {pictures} pictures"
    );
}

#[test]
fn the_changelog_is_short() {
    let lines = text(&root().join("CHANGELOG.md")).lines().count();
    assert!(
        lines <= MOST_CHANGES,
        "the changelog has {lines} lines, at most {MOST_CHANGES}"
    );
}

#[test]
fn sentences_are_found_wherever_they_stand() {
    let page = "# Those rows\n\n- Of one\n  it is said. Likewise here.\n\n```text\nOf a block\n```\n\n| Of a cell | b |\n\n> What is it?";
    assert_eq!(
        faults(&paragraphs(page), true).len(),
        5,
        "{:?}",
        paragraphs(page)
    );
    let code = concat!(
        "//! Of a file. This too.\n\n/// Good.\n///\n/// That of x.\nfn a() { b('\"', \"Of a string\", r#\"Those \"of\" it\"#); }\n",
        "const C: &str = \"First. \\\n    What is more\";\n// Of a remark.\nlet own = \"a likeness\";\n"
    );
    let Texts { strings, docs } = texts(code);
    assert_eq!(faults(&strings, false).len(), 3, "{strings:?}");
    assert_eq!(faults(&docs, false).len(), 2, "{docs:?}");
    assert_eq!(faults(&strings, true).len(), 4, "{strings:?}");
    let good = ["Often. Offset 3 of those. It shunts.".to_owned()];
    assert!(faults(&good, true).is_empty());
}
