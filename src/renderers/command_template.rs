//! Command of another renderer, with placeholders; called without a shell.
//!
//! It is split into words as a shell would, then placeholders are filled in, so that no path needs quoting. The
//! placeholders of a renderer that stays are no words of its command line: they name what its requests hold.

use crate::files::regular_file;
use std::collections::BTreeMap;
use std::path::Path;

/// A command with placeholders such as `{output}`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct CommandTemplate {
    words: Vec<String>,
}

impl CommandTemplate {
    /// Every placeholder, without its braces.
    pub const PLACEHOLDERS: [&str; 13] = [
        "scene",
        "output",
        "width",
        "height",
        "spp",
        "seed",
        "case",
        "step",
        "rate",
        "exposure",
        "export:mitsuba",
        "export:pbrt",
        "export:bundle",
    ];

    /// Splits `text` into words as a POSIX shell would, quotes and backslashes included, and
    /// nothing else a shell does.
    pub fn parse(text: &str) -> Result<CommandTemplate, String> {
        let template = Self::split(text)?;
        if !template.uses("output") {
            return Err("the command must contain {output}, the image file to write".to_owned());
        }
        Ok(template)
    }

    /// The command of a renderer that stays, split likewise.
    pub fn parse_serving(text: &str) -> Result<CommandTemplate, String> {
        let template = Self::split(text)?;
        let is_part = |word: &&String| !placeholders(word).is_empty() && !is_placeholder(word);
        if let Some(word) = template.words.iter().find(is_part) {
            return Err(format!(
                "{word:?}: the placeholders of --serve are words of their own, for requests hold what they stand for"
            ));
        }
        if template.words_alone().is_empty() {
            return Err("there is no command to run".to_owned());
        }
        Ok(template)
    }

    fn split(text: &str) -> Result<CommandTemplate, String> {
        let words = shell_words::split(text).map_err(|_| format!("unclosed quote in: {text}"))?;
        if words.is_empty() {
            return Err("there is no command to run".to_owned());
        }
        let mut names = words.iter().flat_map(|word| placeholders(word));
        if let Some(name) = names.find(|name| !Self::PLACEHOLDERS.contains(&name.as_str())) {
            let known = Self::PLACEHOLDERS.map(|name| format!("{{{name}}}"));
            let known = known.join(" ");
            return Err(format!(
                "unknown placeholder {{{name}}}; the placeholders are: {known}"
            ));
        }
        Ok(CommandTemplate { words })
    }

    /// The words that are no placeholders.
    pub fn words_alone(&self) -> Vec<String> {
        let words = self.words.iter().filter(|word| !is_placeholder(word));
        words.cloned().collect()
    }

    /// True if the placeholder `name` is in the command.
    pub fn uses(&self, name: &str) -> bool {
        let mut names = self.words.iter().flat_map(|word| placeholders(word));
        names.any(|used| used == name)
    }

    /// Use of `{step}` or `{rate}`, the distance between samples.
    pub fn takes_step(&self) -> bool {
        self.uses("step") || self.uses("rate")
    }

    /// The words of the command with the placeholders filled in.
    pub fn fill(&self, values: &BTreeMap<&str, String>) -> Vec<String> {
        let value = |name: &str| values.get(name).cloned().unwrap_or_default();
        let words = self.words.iter();
        words.map(|word| filled(word, value)).collect()
    }
}

/// `word` with the `value` of each placeholder. Braces around anything but a name stand for themselves.
fn filled(word: &str, mut value: impl FnMut(&str) -> String) -> String {
    let is_of_name = |c: char| c.is_ascii_alphanumeric() || matches!(c, ':' | '-' | '_');
    let mut filled = String::new();
    let mut rest = word;
    while let Some((before, after)) = rest.split_once('{') {
        filled.push_str(before);
        rest = match after.split_once('}') {
            Some((name, behind)) if !name.is_empty() && name.chars().all(is_of_name) => {
                filled.push_str(&value(name));
                behind
            }
            _ => {
                filled.push('{');
                after
            }
        };
    }
    filled + rest
}

/// The names in braces, in order.
fn placeholders(word: &str) -> Vec<String> {
    let mut names = Vec::new();
    filled(word, |name| {
        names.push(name.to_owned());
        String::new()
    });
    names
}

/// True of a word that is one placeholder.
fn is_placeholder(word: &str) -> bool {
    matches!(&placeholders(word)[..], [name] if word.len() == name.len() + 2)
}

/// Longest file of a renderer that is hashed: 1 GiB.
const MOST_HASHED_BYTES: u64 = 1 << 30;

/// Hashes of the files that the words of `command` name: another build of a renderer is another renderer.
pub fn hashes_of_files(command: &str) -> String {
    let words = shell_words::split(command).unwrap_or_default();
    let files = words
        .iter()
        .filter_map(|word| regular_file::read_any(Path::new(word), MOST_HASHED_BYTES).ok());
    let hashes = files.map(|bytes| blake3::hash(&bytes).to_hex().to_string());
    hashes.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn template(text: &str) -> Vec<String> {
        let values = [("scene", "a b.toml"), ("output", "o.exr"), ("spp", "4")];
        let values = values.map(|(name, value)| (name, value.to_owned()));
        CommandTemplate::parse(text)
            .unwrap()
            .fill(&BTreeMap::from(values))
    }

    #[test]
    fn words_are_split_before_values_are_put_in() {
        assert_eq!(
            template("render --to={output} {scene} 'x y' \"{spp}{spp}\""),
            ["render", "--to=o.exr", "a b.toml", "x y", "44"]
        );
    }

    #[test]
    fn other_braces_stand_for_themselves() {
        assert_eq!(
            template("r {output} '{' '}{' '{\"a b\": {spp}}'"),
            ["r", "o.exr", "{", "}{", "{\"a b\": 4}"]
        );
    }

    #[test]
    fn placeholders_of_a_renderer_that_stays_are_no_words_of_it() {
        let template = CommandTemplate::parse_serving("r -x {step} 'a b' {output}").unwrap();
        assert_eq!(template.words_alone(), ["r", "-x", "a b"]);
        assert!(template.takes_step() && !template.uses("spp"));
        let error = |text: &str| CommandTemplate::parse_serving(text).unwrap_err();
        assert_eq!(error("{output}"), "there is no command to run");
        assert!(error("r --step={step}x").starts_with("\"--step={step}x\": the placeholders"));
    }

    #[test]
    fn what_is_no_command() {
        let error = |text: &str| CommandTemplate::parse(text).unwrap_err().to_string();
        assert_eq!(error("  "), "there is no command to run");
        assert!(error("render 'x").starts_with("unclosed quote"));
        assert!(error("render {scene}").contains("{output}"));
        assert!(
            error("render {otput}")
                .starts_with("unknown placeholder {otput}; the placeholders are: {scene}")
        );
    }
}
