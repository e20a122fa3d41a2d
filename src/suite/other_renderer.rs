//! Another renderer, called once for each case, without a shell.
//!
//! The command is split into words as a shell would, then placeholders are filled in, so that no
//! path needs quoting.

mod keeper;
mod printed;
mod process;

pub use keeper::{Keeper, Kept, keep};
pub use process::{Ran, run, stop_all};

use std::collections::BTreeMap;
use thiserror::Error;

/// A command with placeholders such as `{output}`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommandTemplate {
    words: Vec<String>,
}

/// Why a text is no command.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum TemplateError {
    /// Quotes that do not end.
    #[error("a quote is opened and not closed in: {0}")]
    Quotes(String),
    /// Nothing to run.
    #[error("there is no command to run")]
    Empty,
    /// A placeholder without which no image can be found.
    #[error("the command does not say where the image goes: it has no {{output}}")]
    NoOutput,
    /// A name in braces that stands for nothing.
    #[error("{{{name}}} stands for nothing; known are: {known}")]
    Unknown {
        /// What stands in the braces.
        name: String,
        /// Every placeholder.
        known: String,
    },
}

impl CommandTemplate {
    /// Every placeholder, without its braces.
    pub const PLACEHOLDERS: [&str; 10] = [
        "scene",
        "output",
        "width",
        "height",
        "spp",
        "seed",
        "case",
        "export:mitsuba",
        "export:pbrt",
        "export:bundle",
    ];

    /// Splits `text` into words as a POSIX shell would, quotes and backslashes included, and
    /// nothing else a shell does.
    pub fn parse(text: &str) -> Result<CommandTemplate, TemplateError> {
        let words = shell_words::split(text).map_err(|_| TemplateError::Quotes(text.to_owned()))?;
        if words.is_empty() {
            return Err(TemplateError::Empty);
        }
        let template = CommandTemplate { words };
        let used = template.placeholders();
        if let Some(name) = used
            .iter()
            .find(|name| !Self::PLACEHOLDERS.contains(&name.as_str()))
        {
            let known = Self::PLACEHOLDERS
                .map(|name| format!("{{{name}}}"))
                .join(" ");
            return Err(TemplateError::Unknown {
                name: name.clone(),
                known,
            });
        }
        if !used.iter().any(|name| name == "output") {
            return Err(TemplateError::NoOutput);
        }
        Ok(template)
    }

    /// The names in braces, in order.
    pub fn placeholders(&self) -> Vec<String> {
        let mut names = Vec::new();
        for word in &self.words {
            replace(word, |name| names.push(name.to_owned()));
        }
        names
    }

    /// The words of the command with the placeholders filled in.
    pub fn fill(&self, values: &BTreeMap<&str, String>) -> Vec<String> {
        let fill = |word: &String| {
            let mut filled = String::new();
            let rest = replace_with(word, &mut filled, |name| {
                values.get(name).cloned().unwrap_or_default()
            });
            filled.push_str(rest);
            filled
        };
        self.words.iter().map(fill).collect()
    }
}

/// Names `{like-this}` in `word`. Braces around anything else stand for themselves.
fn replace(word: &str, mut each: impl FnMut(&str)) {
    let mut nothing = String::new();
    replace_with(word, &mut nothing, |name| {
        each(name);
        String::new()
    });
}

/// Copies `word` to `filled` up to its last placeholder, values put in; returns what is left.
fn replace_with<'w>(
    word: &'w str,
    filled: &mut String,
    mut value: impl FnMut(&str) -> String,
) -> &'w str {
    let mut rest = word;
    let mut from = 0;
    while let Some(open) = rest[from..].find('{').map(|at| from + at) {
        let Some(close) = rest[open..].find('}').map(|at| open + at) else {
            break;
        };
        let name = &rest[open + 1..close];
        let is_name = |c: char| c.is_ascii_alphanumeric() || matches!(c, ':' | '-' | '_');
        if name.is_empty() || !name.chars().all(is_name) {
            from = open + 1;
            continue;
        }
        filled.push_str(&rest[..open]);
        filled.push_str(&value(name));
        rest = &rest[close + 1..];
        from = 0;
    }
    rest
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
    fn what_is_no_command() {
        let error = |text: &str| CommandTemplate::parse(text).unwrap_err().to_string();
        assert_eq!(error("  "), "there is no command to run");
        assert!(error("render 'x").starts_with("a quote is opened"));
        assert!(error("render {scene}").contains("{output}"));
        assert!(
            error("render {otput}").starts_with("{otput} stands for nothing; known are: {scene}")
        );
    }
}
