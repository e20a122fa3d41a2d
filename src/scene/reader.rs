//! Reads a TOML table by its [declaration](super::format), with the position of every error.

use super::format::{Absent, Key, Kind, Rule, Table, whole_number};
use super::{SceneError, SceneResult};
use crate::files::misspelling::nearest;
use crate::volume::InvalidParameter;
use glam::DVec3;
use std::cell::RefCell;
use std::fmt::Display;
use std::ops::Range;
use std::sync::LazyLock;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A length in a scene: absolute, or relative to the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// World units.
    World(f64),
    /// Multiples of the smallest node spacing of the grid.
    Voxels(f64),
}

impl Length {
    /// The length in world units, for a voxel of `voxel` world units. Fails if the product leaves
    /// the range of positive finite numbers.
    pub fn in_world_units(self, voxel: f64) -> Result<f64, String> {
        let length = match self {
            Length::World(length) => length,
            Length::Voxels(count) => count * voxel,
        };
        if length.is_finite() && length > 0.0 {
            Ok(length)
        } else {
            Err(format!(
                "{self} of {voxel:e} world units each is not a positive finite length"
            ))
        }
    }
}

impl std::str::FromStr for Length {
    type Err = String;

    /// `"0.01"` (world units), `"0.5 voxels"`, `"1 voxel"`; positive and finite.
    fn from_str(text: &str) -> Result<Length, String> {
        let trimmed = text.trim();
        let in_voxels = trimmed
            .strip_suffix("voxels")
            .or_else(|| trimmed.strip_suffix("voxel"));
        let number = in_voxels.unwrap_or(trimmed).trim();
        let value: f64 = number.parse().map_err(|_| {
            format!("expected a length such as 0.01 (world units) or \"0.5 voxels\", got {text:?}")
        })?;
        if !(value.is_finite() && value > 0.0) {
            let got = match in_voxels {
                Some(_) => format!("{trimmed:?}"),
                None => trimmed.to_owned(),
            };
            return Err(format!("a length must be positive and finite, got {got}"));
        }
        Ok(if in_voxels.is_some() {
            Length::Voxels(value)
        } else {
            Length::World(value)
        })
    }
}

impl Display for Length {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Length::World(length) => write!(f, "{length}"),
            Length::Voxels(1.0) => write!(f, "\"1 voxel\""),
            Length::Voxels(count) => write!(f, "\"{count} voxels\""),
        }
    }
}

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

/// A TOML file: its name, for messages, and its text.
pub struct Document<'s> {
    /// The name shown in messages.
    pub path: &'s str,
    /// The whole text.
    pub text: &'s str,
}

impl<'s> Document<'s> {
    /// The root table of the file.
    pub fn parse(&self) -> SceneResult<Spanned<DeTable<'s>>> {
        DeTable::parse(self.text).map_err(|error| {
            let help = "the file is not valid TOML; see https://toml.io for its rules";
            self.error(error.span(), error.message(), Some(help.into()))
        })
    }

    /// An error at `span` of this file.
    pub fn error(
        &self,
        span: Option<Range<usize>>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Box<SceneError> {
        SceneError::new(self.path, self.text, span, message, help)
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

    /// The reader of a table within this one.
    fn inner(
        &self,
        declaration: &'static Table,
        table: &'d DeTable<'s>,
        span: Range<usize>,
        path: String,
    ) -> SceneResult<Self> {
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
        let known = |name: &str| self.declaration.keys.iter().any(|key| key.name == name);
        if let Some(key) = self.table.keys().find(|key| !known(key.get_ref())) {
            return Err(self.unknown(key));
        }
        for rule in self.declaration.rules {
            self.check(rule)?;
        }
        Ok(self)
    }

    fn check(&self, rule: &Rule) -> SceneResult<()> {
        let given = |keys: &[&'static str]| -> Vec<&'static str> {
            keys.iter().copied().filter(|key| self.has(key)).collect()
        };
        match *rule {
            Rule::ExactlyOne(what, keys) | Rule::AtMostOne(what, keys) => {
                let found = given(keys);
                let needed = matches!(rule, Rule::ExactlyOne(..));
                if found.is_empty() && needed {
                    let message = format!("{} has no {what}", self.table_name());
                    let help = format!("give one of {}", self.named(keys));
                    // Of a whole file, no place is more wrong than another.
                    let span = (!self.path.is_empty()).then(|| self.span.clone());
                    return Err(self.document.error(span, message, Some(help)));
                }
                let Some(last) = self.last(&found).filter(|_| found.len() > 1) else {
                    return Ok(());
                };
                let message = format!(
                    "{} has more than one {what}: {}",
                    self.table_name(),
                    self.named(&found)
                );
                let amount = if needed { "exactly" } else { "at most" };
                let help = format!("keep {amount} one of {}", self.named(&found));
                Err(self.mistake(last, message, help))
            }
            Rule::Apart([lefts, rights]) => {
                let (left, right) = (given(lefts), given(rights));
                if left.is_empty() || right.is_empty() {
                    return Ok(());
                }
                let last = self.last(&[left.as_slice(), &right].concat());
                let message = format!(
                    "{} mixes {} with {}",
                    self.table_name(),
                    self.named(&left),
                    self.named(&right)
                );
                let comma = if lefts.len() + rights.len() > 2 {
                    ","
                } else {
                    ""
                };
                let [lefts, rights] = [lefts, rights].map(|keys| self.joined(keys));
                let help = format!("give either {lefts}{comma} or {rights}");
                Err(self.mistake(last.expect("two are given"), message, help))
            }
            Rule::Together(keys) => {
                let found = given(keys);
                let missing = keys.iter().copied().find(|key| !self.has(key));
                match (found.first(), missing) {
                    (Some(here), Some(missing)) => {
                        let message =
                            format!("{} gives `{here}` without `{missing}`", self.table_name());
                        let doc = self.declared(missing).doc;
                        let help = format!("give `{missing}` too: {doc}");
                        Err(self.mistake(here, message, help))
                    }
                    _ => Ok(()),
                }
            }
        }
    }

    /// Of some keys in the file, the one that stands last.
    fn last(&self, names: &[&'static str]) -> Option<&'static str> {
        let start = |name: &str| self.value(name).map(|value| value.span().start);
        names.iter().copied().max_by_key(|name| start(name))
    }

    /// Keys as a list in words; those that are headings of the file as such.
    fn named(&self, keys: &[&str]) -> String {
        let named = keys.iter().map(|key| self.named_key(key));
        named.collect::<Vec<_>>().join(", ")
    }

    /// `keys` of one alternative: two belong together, of more each may be given.
    fn joined(&self, keys: &[&str]) -> String {
        match keys {
            [first, second] => format!("{} and {}", self.named_key(first), self.named_key(second)),
            _ => self.named(keys),
        }
    }

    fn named_key(&self, key: &str) -> String {
        match self.declared(key).kind {
            Kind::Table(_) if self.path.is_empty() => format!("[{key}]"),
            _ => format!("`{key}`"),
        }
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
        let known: Vec<_> = self.declaration.keys.iter().map(|key| key.name).collect();
        let table = self.table_name();
        let help = match nearest(key.get_ref(), known.iter().copied()) {
            Some(name) => format!("did you mean `{name}`?"),
            None => format!("allowed keys in {table}: {}", known.join(", ")),
        };
        let message = format!("unknown key `{}` in {table}", key.get_ref());
        self.document.error(Some(key.span()), message, Some(help))
    }

    /// The declaration of a key. Asking for one that is not declared is our own mistake.
    fn declared(&self, name: &str) -> &'static Key {
        let key = self.declaration.keys.iter().find(|key| key.name == name);
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
    pub fn resolved(&self, name: &str, value: impl Display) {
        let key = self.key_path(name);
        let mut log = self.log.borrow_mut();
        let reading = log.iter_mut().rev().find(|reading| reading.key == key);
        if let Some(reading) = reading.filter(|reading| reading.origin != Origin::Given) {
            reading.value = value.to_string();
        }
    }

    /// Notes something that was read for this table in a text of another kind.
    pub fn also(&self, name: &str, reading: &Reading) {
        let inside = format!("{name}.{}", reading.key);
        self.note(&inside, reading.value.clone(), reading.origin);
    }

    /// The text at `name` for a reader of another kind, and what to call it in messages. A text
    /// between three single quotes keeps its lines and columns: blanks stand for all before it.
    pub fn text_in_place(&self, name: &str) -> SceneResult<Option<(String, String)>> {
        let (Some(text), Some(value)) = (self.optional_text(name)?, self.value(name)) else {
            return Ok(None);
        };
        const QUOTES: &str = "'''";
        let file = self.document.text;
        let raw = &file[value.span()];
        if raw.len() < 2 * QUOTES.len() || !raw.starts_with(QUOTES) || !raw.ends_with(QUOTES) {
            let source = format!("{}, {}", self.document.path, self.key_path(name));
            return Ok(Some((source, text)));
        }
        let start = value.span().start + QUOTES.len();
        let blank = |c: char| if c.is_whitespace() { c } else { ' ' };
        let before = file[..start].chars().map(blank);
        let inside = &raw[QUOTES.len()..raw.len() - QUOTES.len()];
        let in_place = before.chain(inside.chars()).collect();
        Ok(Some((self.document.path.to_owned(), in_place)))
    }

    /// An error in the value of `name`, or in its absence.
    pub fn error(&self, name: &str, message: impl Into<String>) -> Box<SceneError> {
        let help = format!("`{}`: {}", self.key_path(name), self.declared(name).doc);
        self.mistake(name, message, help)
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
    pub fn mistake_here(
        &self,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<SceneError> {
        let span = Some(self.span.clone());
        self.document.error(span, message, Some(help.into()))
    }

    fn wrong_type(&self, name: &str, value: &Spanned<DeValue>) -> Box<SceneError> {
        let expected = self.declared(name).kind.expected();
        let got = value.get_ref().type_str();
        let article = if matches!(got, "integer" | "array") {
            "an"
        } else {
            "a"
        };
        self.error(
            name,
            format!("`{name}` must be {expected}, not {article} {got}"),
        )
    }

    /// The value in the file or the declared default; `None` if the declaration has neither
    /// and the key may be left out.
    fn present<T>(
        &self,
        name: &str,
        read: impl Fn(&Spanned<DeValue>) -> SceneResult<T>,
        show: impl Fn(&T) -> String,
    ) -> SceneResult<Option<T>> {
        if let Some(value) = self.value(name) {
            let value = read(value)?;
            self.note(name, show(&value), Origin::Given);
            return Ok(Some(value));
        }
        match self.declared(name).absent {
            Absent::Error => {
                let table = self.table_name();
                Err(self.error(name, format!("missing key `{name}` in {table}")))
            }
            Absent::Default(text) => {
                let value = read(&DeValue::parse(text).expect("defaults are TOML"))?;
                self.note(name, show(&value), Origin::Default);
                Ok(Some(value))
            }
            Absent::Derived(rule) => {
                self.note(name, String::new(), Origin::Derived(rule));
                Ok(None)
            }
            Absent::Nothing => Ok(None),
        }
    }

    fn float(&self, name: &str, value: &Spanned<DeValue>) -> SceneResult<f64> {
        let text = match value.get_ref() {
            DeValue::Float(float) => float.as_str().to_owned(),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().to_owned(),
            _ => return Err(self.wrong_type(name, value)),
        };
        let number: f64 = text.parse().map_err(|_| self.wrong_type(name, value))?;
        if !number.is_finite() {
            return Err(self.error(name, format!("`{name}` must be finite, got {text}")));
        }
        Ok(number)
    }

    fn three(&self, name: &str, value: &Spanned<DeValue>) -> SceneResult<DVec3> {
        let DeValue::Array(items) = value.get_ref() else {
            return Err(self.wrong_type(name, value));
        };
        if items.len() != 3 {
            let message = format!("`{name}` must be three numbers, not {}", items.len());
            return Err(self.error(name, message));
        }
        let mut numbers = [0.0; 3];
        for (number, item) in numbers.iter_mut().zip(items.iter()) {
            *number = self.float(name, item)?;
        }
        Ok(DVec3::from_array(numbers))
    }

    /// Three channels, or one number for all of them.
    fn colour(
        &self,
        name: &str,
        value: &Spanned<DeValue>,
        range: &super::format::Range,
    ) -> SceneResult<DVec3> {
        let colour = match value.get_ref() {
            DeValue::Float(_) | DeValue::Integer(_) => DVec3::splat(self.float(name, value)?),
            _ => self.three(name, value)?,
        };
        if let Some(channel) = colour.to_array().iter().find(|&&c| !range.contains(c)) {
            let message = if *channel < 0.0 {
                format!("`{name}` must not be negative, got {colour}")
            } else {
                format!("`{name}` must {range} in every channel, got {colour}")
            };
            return Err(self.error(name, message));
        }
        // −0 is black as well, but another bit: as +0 an image is the same whatever is elided.
        Ok(colour + DVec3::ZERO)
    }

    /// A declared [`Kind::Count`] that is required or has a default.
    pub fn count(&self, name: &str) -> SceneResult<u64> {
        let value = self.optional_count(name)?;
        Ok(value.expect("required or has a default"))
    }

    /// A declared [`Kind::Count`] that may be left out.
    pub fn optional_count(&self, name: &str) -> SceneResult<Option<u64>> {
        let Kind::Count(low, high) = self.declared(name).kind else {
            panic!("{name} is not a count")
        };
        let read = |value: &Spanned<DeValue>| {
            let DeValue::Integer(integer) = value.get_ref() else {
                return Err(self.wrong_type(name, value));
            };
            whole_number(name, integer.as_str(), integer.radix(), [low, high])
                .map_err(|message| self.error(name, message))
        };
        self.present(name, read, u64::to_string)
    }

    /// A declared [`Kind::Number`] that is required or has a default.
    pub fn number(&self, name: &str) -> SceneResult<f64> {
        let value = self.optional_number(name)?;
        Ok(value.expect("required or has a default"))
    }

    /// A declared [`Kind::Number`] that may be left out.
    pub fn optional_number(&self, name: &str) -> SceneResult<Option<f64>> {
        let Kind::Number(range) = self.declared(name).kind else {
            panic!("{name} is not a number")
        };
        let read = |value: &Spanned<DeValue>| {
            let number = self.float(name, value)?;
            if !range.contains(number) {
                return Err(self.error(name, format!("`{name}` must {range}, got {number}")));
            }
            Ok(number)
        };
        self.present(name, read, f64::to_string)
    }

    /// A declared [`Kind::Vector`] or [`Kind::Colour`] that is required or has a default.
    pub fn vector(&self, name: &str) -> SceneResult<DVec3> {
        let value = self.optional_vector(name)?;
        Ok(value.expect("required or has a default"))
    }

    /// A declared [`Kind::Vector`] or [`Kind::Colour`] that may be left out.
    pub fn optional_vector(&self, name: &str) -> SceneResult<Option<DVec3>> {
        let read = |value: &Spanned<DeValue>| match self.declared(name).kind {
            Kind::Colour(range) => self.colour(name, value, &range),
            _ => self.three(name, value),
        };
        self.present(name, read, DVec3::to_string)
    }

    /// A declared [`Kind::Vector`] that, left out, follows from other things.
    pub fn vector_or(&self, name: &str, derived: impl FnOnce() -> DVec3) -> SceneResult<DVec3> {
        if let Some(vector) = self.optional_vector(name)? {
            return Ok(vector);
        }
        let vector = derived();
        self.resolved(name, vector);
        Ok(vector)
    }

    /// A declared [`Kind::Length`] that is required or has a default.
    pub fn length(&self, name: &str) -> SceneResult<Length> {
        let value = self.optional_length(name)?;
        Ok(value.expect("required or has a default"))
    }

    /// A declared [`Kind::Length`] that may be left out.
    pub fn optional_length(&self, name: &str) -> SceneResult<Option<Length>> {
        let read = |value: &Spanned<DeValue>| {
            let text = match value.get_ref() {
                DeValue::String(text) => text.to_string(),
                DeValue::Float(_) | DeValue::Integer(_) => self.float(name, value)?.to_string(),
                _ => return Err(self.wrong_type(name, value)),
            };
            text.parse()
                .map_err(|message| self.error(name, format!("`{name}`: {message}")))
        };
        self.present(name, read, Length::to_string)
    }

    /// A declared [`Kind::Text`] or [`Kind::Choice`] that is required or has a default.
    pub fn text(&self, name: &str) -> SceneResult<String> {
        let value = self.optional_text(name)?;
        Ok(value.expect("required or has a default"))
    }

    /// A declared [`Kind::Text`] or [`Kind::Choice`] that may be left out.
    pub fn optional_text(&self, name: &str) -> SceneResult<Option<String>> {
        let read = |value: &Spanned<DeValue>| {
            let DeValue::String(text) = value.get_ref() else {
                return Err(self.wrong_type(name, value));
            };
            if let Kind::Choice(words) = self.declared(name).kind
                && !words.contains(&text.as_ref())
            {
                let expected = self.declared(name).kind.expected();
                let message = format!("`{name}` must be {expected}, but is {text:?}");
                return Err(match nearest(text, words.iter().copied()) {
                    Some(near) => self.mistake(name, message, format!("did you mean {near:?}?")),
                    None => self.error(name, message),
                });
            }
            Ok(text.to_string())
        };
        self.present(name, read, |text| format!("{text:?}"))
    }

    /// A declared [`Kind::Flag`]; left out, it is false.
    pub fn flag(&self, name: &str) -> SceneResult<bool> {
        let read = |value: &Spanned<DeValue>| match value.get_ref() {
            DeValue::Boolean(flag) => Ok(*flag),
            _ => Err(self.wrong_type(name, value)),
        };
        let flag = self.present(name, read, bool::to_string)?;
        Ok(flag.unwrap_or(false))
    }

    /// A declared [`Kind::Words`]; left out, there are none.
    pub fn words(&self, name: &str) -> SceneResult<Vec<String>> {
        let read = |value: &Spanned<DeValue>| {
            let DeValue::Array(items) = value.get_ref() else {
                return Err(self.wrong_type(name, value));
            };
            let word = |item: &Spanned<DeValue>| match item.get_ref() {
                DeValue::String(text) => Ok(text.to_string()),
                _ => Err(self.wrong_type(name, item)),
            };
            items.iter().map(word).collect()
        };
        let words: Option<Vec<String>> = self.present(name, read, |words| format!("{words:?}"))?;
        Ok(words.unwrap_or_default())
    }

    /// Whether the file holds the key.
    pub fn has(&self, name: &str) -> bool {
        self.value(name).is_some()
    }

    /// A declared [`Kind::Table`], if the file has it. One that may be left out but has
    /// defaults for all its keys is [`Reader::table_or_default`].
    pub fn table(&self, name: &str) -> SceneResult<Option<Reader<'d, 's>>> {
        match self.value(name) {
            Some(value) => {
                let path = self.key_path(name);
                self.table_in(name, self.declared_table(name), value, path)
                    .map(Some)
            }
            None if matches!(self.declared(name).absent, Absent::Error) => {
                Err(self.error(name, format!("missing table [{}]", self.key_path(name))))
            }
            None => Ok(None),
        }
    }

    fn table_in(
        &self,
        name: &str,
        declaration: &'static Table,
        value: &'d Spanned<DeValue<'s>>,
        path: String,
    ) -> SceneResult<Reader<'d, 's>> {
        match value.get_ref() {
            DeValue::Table(table) => self.inner(declaration, table, value.span(), path),
            _ => Err(self.wrong_type(name, value)),
        }
    }

    /// A declared [`Kind::Tables`]: each of them, in the order of the file; none where the file
    /// leaves it out.
    pub fn tables(&self, name: &str) -> SceneResult<Vec<Reader<'d, 's>>> {
        let Kind::Tables(declaration) = self.declared(name).kind else {
            panic!("{name} is not a list of tables")
        };
        let Some(value) = self.value(name) else {
            return Ok(Vec::new());
        };
        let DeValue::Array(items) = value.get_ref() else {
            return Err(self.wrong_type(name, value));
        };
        let table = |(index, item)| {
            let path = format!("{}[{index}]", self.key_path(name));
            self.table_in(name, declaration, item, path)
        };
        items.iter().enumerate().map(table).collect()
    }

    /// A declared [`Kind::Table`]; an empty one if the file leaves it out.
    pub fn table_or_default(&self, name: &str) -> SceneResult<Reader<'d, 's>> {
        static EMPTY: LazyLock<DeTable<'static>> = LazyLock::new(DeTable::new);
        if let Some(reader) = self.table(name)? {
            return Ok(reader);
        }
        let (declaration, path) = (self.declared_table(name), self.key_path(name));
        self.inner(declaration, &EMPTY, self.span.clone(), path)
    }

    fn declared_table(&self, name: &str) -> &'static Table {
        match self.declared(name).kind {
            Kind::Table(declaration) => declaration,
            _ => panic!("{name} is not a table"),
        }
    }
}

/// `base` with every key of `over` in place of its own, table by table; a list is one value, so
/// that of `over` replaces that of `base` as a whole.
pub fn overridden<'s>(base: &DeTable<'s>, over: &DeTable<'s>) -> DeTable<'s> {
    let mut merged = base.clone();
    for (key, value) in over {
        let both = match (merged.get(key), value.get_ref()) {
            (Some(old), DeValue::Table(over)) => match old.get_ref() {
                DeValue::Table(base) => Some(overridden(base, over)),
                _ => None,
            },
            _ => None,
        };
        let value = match both {
            Some(table) => Spanned::new(value.span(), DeValue::Table(table)),
            None => value.clone(),
        };
        merged.remove(key);
        merged.insert(key.clone(), value);
    }
    merged
}
