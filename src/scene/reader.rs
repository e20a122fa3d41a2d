//! Reads a TOML table by its [declaration](super::format), with the position of every error.

mod rules;
mod values;

pub use super::error::Document;
pub use values::{Field, Value};

use super::format::{Key, Kind, Table};
use super::{SceneError, SceneResult};
use crate::files::misspelling::{escape_remedy, nearest};
use crate::geometry::InvalidParameter;
use std::cell::RefCell;
use std::fmt::Display;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A key with the value read.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Dotted path from the root of the file, such as `classified.phong.ambient`.
    pub key: String,
    /// The value, as TOML.
    pub value: String,
    /// Origin of the value.
    pub origin: Origin,
}

/// Origin of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The file gives it.
    Given,
    /// The file leaves it out, and this is the default.
    Default,
    /// The file leaves it out, and it follows from other values by this rule.
    Derived(&'static str),
}

impl<'s> Document<'s> {
    /// The root table of the file.
    pub fn parse(&self) -> SceneResult<Spanned<DeTable<'s>>> {
        DeTable::parse(self.text).map_err(|error| {
            let help = escape_remedy(error.message())
                .unwrap_or("the file is not valid TOML; see https://toml.io for its rules");
            self.error(error.span(), error.message(), Some(help.into()))
        })
    }
}

/// A table of a document, read key by key.
pub struct Reader<'d, 's> {
    document: &'d Document<'s>,
    declaration: &'static Table,
    table: &'d DeTable<'s>,
    span: Range<usize>,
    path: String,
    log: &'d RefCell<Vec<Reading>>,
}

impl<'d, 's> Reader<'d, 's> {
    /// Reads `table`, the root of `document`, by `declaration`; everything read is noted in
    /// `log`. Fails on a key that the declaration does not know.
    pub fn new(
        document: &'d Document<'s>,
        declaration: &'static Table,
        table: &'d Spanned<DeTable<'s>>,
        log: &'d RefCell<Vec<Reading>>,
    ) -> SceneResult<Self> {
        let reader = Reader {
            document,
            declaration,
            table: table.get_ref(),
            span: table.span(),
            path: String::new(),
            log,
        };
        reader.checked()
    }

    /// Reads `value`, a table of `document` that messages call `path`, by `declaration`; `None` if it is none.
    pub(crate) fn of_value(
        document: &'d Document<'s>,
        declaration: &'static Table,
        value: &'d Spanned<DeValue<'s>>,
        path: String,
        log: &'d RefCell<Vec<Reading>>,
    ) -> SceneResult<Option<Self>> {
        let reader = value.get_ref().as_table().map(|table| Reader {
            document,
            declaration,
            table,
            span: value.span(),
            path,
            log,
        });
        reader.map(Reader::checked).transpose()
    }

    /// The reader of a table within this one, at the key `name`.
    fn inner(
        &self,
        name: &str,
        table: &'d DeTable<'s>,
        span: Range<usize>,
        path: String,
    ) -> SceneResult<Self> {
        let (Kind::Table(declaration) | Kind::Tables(declaration) | Kind::OneOrMore(declaration)) =
            self.declared(name).kind
        else {
            panic!("{name} is not a table")
        };
        let reader = Reader {
            declaration,
            table,
            span,
            path,
            ..*self
        };
        reader.checked()
    }

    /// Refuses keys that are not declared, and those that break a rule.
    fn checked(self) -> SceneResult<Self> {
        let known = |name: &str| self.declaration.all().any(|key| key.name == name);
        if let Some(key) = self.table.keys().find(|key| !known(key.get_ref())) {
            return Err(self.unknown(key));
        }
        for rule in self.declaration.rules {
            self.check(rule)?;
        }
        Ok(self)
    }

    /// The table as messages call it.
    fn table_name(&self) -> String {
        if self.path.is_empty() {
            "the file".to_owned()
        } else {
            format!("[{}]", self.path)
        }
    }

    fn unknown(&self, key: &Spanned<std::borrow::Cow<'s, str>>) -> Box<SceneError> {
        let name = key.get_ref();
        let known: Vec<_> = self.declaration.all().map(|key| key.name).collect();
        let table = self.table_name();
        let help = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("allowed keys in {table}: {}", known.join(", ")),
        };
        let message = format!("unknown key `{name}` in {table}");
        self.document.error(Some(key.span()), message, Some(help))
    }

    /// The declaration of a key. Asking for one that is not declared is our own mistake.
    fn declared(&self, name: &str) -> &'static Key {
        let key = self.declaration.all().find(|key| key.name == name);
        key.unwrap_or_else(|| panic!("{}.{name} is not declared", self.path))
    }

    fn value(&self, name: &str) -> Option<&'d Spanned<DeValue<'s>>> {
        self.table.get(name)
    }

    fn key_path(&self, name: &str) -> String {
        if self.path.is_empty() {
            name.to_owned()
        } else {
            format!("{}.{name}", self.path)
        }
    }

    fn note(&self, name: &str, value: String, origin: Origin) {
        let key = self.key_path(name);
        self.log.borrow_mut().push(Reading { key, value, origin });
    }

    /// Records the value of a key that the file leaves out.
    pub(crate) fn resolved(&self, name: &str, value: impl Display) {
        let key = self.key_path(name);
        let mut log = self.log.borrow_mut();
        let reading = log.iter_mut().rev().find(|reading| reading.key == key);
        if let Some(reading) = reading.filter(|reading| reading.origin != Origin::Given) {
            reading.value = value.to_string();
        }
    }

    /// Notes a value that the file leaves out, and that follows by `rule`.
    pub(crate) fn derived(&self, name: &str, value: String, rule: &'static str) {
        self.note(name, value, Origin::Derived(rule));
    }

    /// True if the file says `word` at `name`; nothing is noted.
    pub(crate) fn says(&self, name: &str, word: &str) -> bool {
        let text = self.value(name).map(Spanned::get_ref);
        text.and_then(DeValue::as_str) == Some(word)
    }

    /// Notes something that was read for this table in a text of another kind.
    pub fn also(&self, name: &str, reading: &Reading) {
        let inside = format!("{name}.{}", reading.key);
        self.note(&inside, reading.value.clone(), reading.origin);
    }

    /// The text at `name` for a reader of another kind, and what to call it in messages.
    pub(crate) fn text_in_place(&self, name: &str) -> SceneResult<Option<(String, String)>> {
        let source = format!("{}, {}", self.document.path, self.key_path(name));
        let text = self.optional::<String>(name)?;
        Ok(text.map(|text| (source, text)))
    }

    /// An error in the value of `name`, or in its absence.
    pub fn error(&self, name: &str, message: impl Into<String>) -> Box<SceneError> {
        let help = format!("`{}`: {}", self.key_path(name), self.declared(name).doc);
        self.mistake(name, message, help)
    }

    /// The value made of `name`, or the mistake in it.
    pub(crate) fn accepted_at<T>(
        &self,
        name: &str,
        made: Result<T, impl Display>,
    ) -> SceneResult<T> {
        made.map_err(|error| self.error(name, error.to_string()))
    }

    /// What was made of the values of keys, or the mistake in the one that is refused.
    pub fn accepted<T>(&self, made: Result<T, InvalidParameter>) -> SceneResult<T> {
        made.map_err(|error| self.error(error.name, error.message))
    }

    /// As [`Reader::error`], with its own remedy.
    pub fn mistake(
        &self,
        name: &str,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<SceneError> {
        let span = self
            .value(name)
            .map_or(self.span.clone(), |value| value.span());
        self.document.error(Some(span), message, Some(help.into()))
    }

    /// An error of the table as a whole, with its remedy.
    pub(crate) fn mistake_here(
        &self,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<SceneError> {
        let span = Some(self.span.clone());
        self.document.error(span, message, Some(help.into()))
    }

    /// An error where the value of `name` has not the declared form.
    fn wrong_form(&self, name: &str) -> Box<SceneError> {
        let expected = self.declared(name).kind.expected();
        self.error(name, format!("`{name}` must be {expected}"))
    }

    fn wrong_type(&self, name: &str, value: &Spanned<DeValue>) -> Box<SceneError> {
        let expected = self.declared(name).kind.expected();
        let got = value.get_ref().type_str();
        let article = ["a", "an"][usize::from(got.starts_with(['i', 'a']))];
        let message = format!("`{name}` must be {expected}, not {article} {got}");
        self.error(name, message)
    }
}

/// `base` with every key of `over` in place of its own, table by table; a list is one value, so
/// that of `over` replaces that of `base` as a whole.
pub(crate) fn overridden<'s>(base: &DeTable<'s>, over: &DeTable<'s>) -> DeTable<'s> {
    let mut merged = base.clone();
    for (key, value) in over {
        let mut value = value.clone();
        if let (Some(old), DeValue::Table(over)) = (merged.remove(key), value.get_ref())
            && let DeValue::Table(base) = old.get_ref()
        {
            value = Spanned::new(value.span(), DeValue::Table(overridden(base, over)));
        }
        merged.insert(key.clone(), value);
    }
    merged
}
