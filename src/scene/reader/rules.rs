//! Rules on which keys of a table go together.

use super::Reader;
use crate::scene::SceneResult;
use crate::scene::format::{Kind, Rule};

impl Reader<'_, '_> {
    /// Refuses a table that breaks `rule`.
    pub(super) fn check(&self, rule: &Rule) -> SceneResult<()> {
        let given = |keys: &[&'static str]| -> Vec<&'static str> {
            keys.iter().copied().filter(|key| self.has(key)).collect()
        };
        let table = self.table_name();
        match *rule {
            Rule::ExactlyOne(what, keys) | Rule::AtMostOne(what, keys) => {
                let found = given(keys);
                let needed = matches!(rule, Rule::ExactlyOne(..));
                if found.is_empty() && needed {
                    let help = format!("give one of {}", self.named(keys));
                    // In a whole file no place is more wrong than another.
                    let span = (!self.path.is_empty()).then(|| self.span.clone());
                    let message = format!("{table} has no {what}");
                    return Err(self.document.error(span, message, Some(help)));
                }
                let Some(last) = self.last(&found).filter(|_| found.len() > 1) else {
                    return Ok(());
                };
                let found = self.named(&found);
                let amount = if needed { "exactly" } else { "at most" };
                let message = format!("{table} has more than one {what}: {found}");
                Err(self.mistake(last, message, format!("keep {amount} one of {found}")))
            }
            Rule::Apart([lefts, rights]) => {
                let (left, right) = (given(lefts), given(rights));
                if left.is_empty() || right.is_empty() {
                    return Ok(());
                }
                let last = self.last(&[left.as_slice(), &right].concat());
                let (left, right) = (self.named(&left), self.named(&right));
                let [lefts, rights] = [lefts, rights].map(|keys| self.named(keys));
                let message = format!("{table} mixes {left} with {right}");
                let help = format!("give either {lefts}, or {rights}");
                Err(self.mistake(last.expect("two are given"), message, help))
            }
            Rule::Together(keys) => {
                let missing = keys.iter().copied().find(|key| !self.has(key));
                let (Some(here), Some(missing)) = (self.first_of(keys), missing) else {
                    return Ok(());
                };
                let message = format!("{table} gives `{here}` without `{missing}`");
                let help = format!("give `{missing}` too: {}", self.declared(missing).doc);
                Err(self.mistake(here, message, help))
            }
        }
    }

    /// The one of some keys that stands last in the file.
    fn last(&self, names: &[&'static str]) -> Option<&'static str> {
        let start = |name: &str| self.value(name).map(|value| value.span().start);
        names.iter().copied().max_by_key(|name| start(name))
    }

    /// Keys as a list in words; those that are headings of the file as such.
    fn named(&self, keys: &[&str]) -> String {
        let named = keys.iter().map(|key| match self.declared(key).kind {
            Kind::Table(_) if self.path.is_empty() => format!("[{key}]"),
            _ => format!("`{key}`"),
        });
        named.collect::<Vec<_>>().join(", ")
    }
}
