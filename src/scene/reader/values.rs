//! Values of keys, by their kind.

use super::{Origin, Reader};
use crate::files::misspelling::nearest;
use crate::math::srgb_to_linear;
use crate::scene::SceneResult;
use crate::scene::format::{Absent, Kind, Range, Table, whole_number};
use crate::scene::length::Length;
use glam::DVec3;
use std::sync::LazyLock;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

impl<'d, 's> Reader<'d, 's> {
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

    /// A declared [`Kind::Matrix`] that may be left out, row by row.
    pub(crate) fn optional_matrix<const ROWS: usize>(
        &self,
        name: &str,
    ) -> SceneResult<Option<[[f64; 4]; ROWS]>> {
        let read = |value: &Spanned<DeValue>| {
            let expected = self.declared(name).kind.expected();
            let wrong = || self.error(name, format!("`{name}` must be {expected}"));
            let mut rows = [[0.0; 4]; ROWS];
            let items = array(value).filter(|items| items.len() == ROWS);
            for (row, item) in rows.iter_mut().zip(items.ok_or_else(wrong)?) {
                let numbers = array(item).filter(|numbers| numbers.len() == 4);
                for (number, item) in row.iter_mut().zip(numbers.ok_or_else(wrong)?) {
                    *number = self.float(name, item)?;
                }
            }
            Ok(rows)
        };
        self.present(name, read, |rows| format!("{rows:?}"))
    }

    /// A declared [`Kind::Interval`] that may be left out.
    pub(crate) fn optional_interval(&self, name: &str) -> SceneResult<Option<[f64; 2]>> {
        let Kind::Interval(range) = self.declared(name).kind else {
            panic!("{name} is not an interval")
        };
        let read = |value: &Spanned<DeValue>| {
            let Some([low, high]) = array(value) else {
                let expected = self.declared(name).kind.expected();
                return Err(self.error(name, format!("`{name}` must be {expected}")));
            };
            let ends = [self.float(name, low)?, self.float(name, high)?];
            if let Some(end) = ends.iter().find(|&&end| !range.contains(end)) {
                return Err(self.error(name, format!("`{name}` must {range}, got {end}")));
            }
            self.accepted_at(name, checked_interval(ends))
                .map(|()| ends)
        };
        self.present(name, read, |ends| format!("{ends:?}"))
    }

    /// Three channels, one number for all of them, or sRGB.
    fn colour(&self, name: &str, value: &Spanned<DeValue>, range: &Range) -> SceneResult<DVec3> {
        let colour = match value.get_ref() {
            DeValue::Float(_) | DeValue::Integer(_) => DVec3::splat(self.float(name, value)?),
            DeValue::String(text) => srgb(text).ok_or_else(|| {
                let message = format!("`{name}` is {text:?}, which is no colour");
                let help = "give sRGB as six hexadecimal digits, such as \"#3b528b\", or linear \
                            numbers, such as [1, 0.5, 0]";
                self.mistake(name, message, help)
            })?,
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
    pub(crate) fn optional_count(&self, name: &str) -> SceneResult<Option<u64>> {
        let Kind::Count(low, high) = self.declared(name).kind else {
            panic!("{name} is not a count")
        };
        let read = |value: &Spanned<DeValue>| {
            let DeValue::Integer(integer) = value.get_ref() else {
                return Err(self.wrong_type(name, value));
            };
            let number = whole_number(name, integer.as_str(), integer.radix(), [low, high]);
            self.accepted_at(name, number)
        };
        self.present(name, read, u64::to_string)
    }

    /// A declared [`Kind::Counts`] that is required.
    pub fn counts(&self, name: &str) -> SceneResult<[u64; 3]> {
        let value = self.optional_counts(name)?;
        Ok(value.expect("required"))
    }

    /// A declared [`Kind::Counts`] that may be left out.
    pub(crate) fn optional_counts(&self, name: &str) -> SceneResult<Option<[u64; 3]>> {
        let Kind::Counts(low, high) = self.declared(name).kind else {
            panic!("{name} is not three counts")
        };
        let read = |value: &Spanned<DeValue>| {
            let expected = self.declared(name).kind.expected();
            let wrong = || self.error(name, format!("`{name}` must be {expected}"));
            let items = array(value).filter(|items| items.len() == 3);
            let mut counts = [0; 3];
            for (count, item) in counts.iter_mut().zip(items.ok_or_else(wrong)?) {
                let DeValue::Integer(integer) = item.get_ref() else {
                    return Err(wrong());
                };
                let number = whole_number(name, integer.as_str(), integer.radix(), [low, high]);
                *count = self.accepted_at(name, number)?;
            }
            Ok(counts)
        };
        self.present(name, read, |counts| format!("{counts:?}"))
    }

    /// A declared [`Kind::Number`] that is required or has a default.
    pub fn number(&self, name: &str) -> SceneResult<f64> {
        let value = self.optional_number(name)?;
        Ok(value.expect("required or has a default"))
    }

    /// A declared [`Kind::Number`] that may be left out.
    pub(crate) fn optional_number(&self, name: &str) -> SceneResult<Option<f64>> {
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
    pub(crate) fn optional_vector(&self, name: &str) -> SceneResult<Option<DVec3>> {
        let read = |value: &Spanned<DeValue>| match self.declared(name).kind {
            Kind::Colour(range) => self.colour(name, value, &range),
            _ => self.three(name, value),
        };
        self.present(name, read, DVec3::to_string)
    }

    /// A declared [`Kind::Vector`] that, left out, follows from other things.
    pub(crate) fn vector_or(
        &self,
        name: &str,
        derived: impl FnOnce() -> DVec3,
    ) -> SceneResult<DVec3> {
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
    pub(crate) fn optional_length(&self, name: &str) -> SceneResult<Option<Length>> {
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
    pub(crate) fn optional_text(&self, name: &str) -> SceneResult<Option<String>> {
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

    /// True if the file holds the key.
    pub fn has(&self, name: &str) -> bool {
        self.value(name).is_some()
    }

    /// A declared [`Kind::Table`], if the file has it. One that may be left out but has
    /// defaults for all its keys is `Reader::table_or_default`.
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

    /// The table `name`, by `read`, if it is there.
    pub(crate) fn table_as<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Reader<'d, 's>) -> SceneResult<T>,
    ) -> SceneResult<Option<T>> {
        self.table(name)?.as_ref().map(read).transpose()
    }

    /// The tables `name`, each by `read`.
    pub(crate) fn tables_as<T>(
        &self,
        name: &str,
        read: impl FnMut(&Reader<'d, 's>) -> SceneResult<T>,
    ) -> SceneResult<Vec<T>> {
        self.tables(name)?.iter().map(read).collect()
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

    /// A declared [`Kind::OneOrMore`], which is there: one table, or each of several.
    pub(crate) fn one_or_more(&self, name: &str) -> SceneResult<Vec<Reader<'d, 's>>> {
        let Kind::OneOrMore(declaration) = self.declared(name).kind else {
            panic!("{name} is not a table or several")
        };
        let path = self.key_path(name);
        let Some(value) = self.value(name) else {
            return Err(self.error(name, format!("missing table [{path}]")));
        };
        let items = match value.get_ref() {
            DeValue::Array(items) if items.is_empty() => {
                return Err(self.error(name, format!("`{name}` is empty")));
            }
            DeValue::Array(items) => items,
            DeValue::Table(_) => {
                return Ok(vec![self.table_in(name, declaration, value, path)?]);
            }
            _ => return Err(self.wrong_type(name, value)),
        };
        let table =
            |(index, item)| self.table_in(name, declaration, item, format!("{path}[{index}]"));
        items.iter().enumerate().map(table).collect()
    }

    /// A declared [`Kind::Table`]; an empty one if the file leaves it out.
    pub(crate) fn table_or_default(&self, name: &str) -> SceneResult<Reader<'d, 's>> {
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

/// Fails where an interval holds no more than a number.
pub(crate) fn checked_interval([low, high]: [f64; 2]) -> Result<(), String> {
    if low < high {
        return Ok(());
    }
    Err(format!(
        "the range from {low} to {high} is empty: its second number must be above its first"
    ))
}

/// The colour `#rrggbb` of sRGB, in linear light.
fn srgb(text: &str) -> Option<DVec3> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6)?;
    let is_hexadecimal = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    let code = u32::from_str_radix(digits, 16).ok();
    let [_, codes @ ..] = code.filter(|_| is_hexadecimal)?.to_be_bytes();
    let linear = codes.map(|code| srgb_to_linear(f64::from(code) / 255.0));
    Some(DVec3::from_array(linear))
}

/// The items of a list.
fn array<'v, 's>(value: &'v Spanned<DeValue<'s>>) -> Option<&'v [Spanned<DeValue<'s>>]> {
    match value.get_ref() {
        DeValue::Array(items) => Some(items),
        _ => None,
    }
}
