//! Values of keys, by their kind.

use super::{Origin, Reader};
use crate::files::misspelling::nearest;
use crate::math::srgb_to_linear;
use crate::scene::format::{Absent, Kind, whole_number};
use crate::scene::length::Length;
use crate::scene::{SceneError, SceneResult};
use glam::DVec3;
use std::fmt::Debug;
use std::sync::LazyLock;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value of a key, in the form that its declared [`Kind`] has.
pub trait Value: Debug + Sized {
    /// Reads `value`, which stands at `name`.
    fn read(reader: &Reader, name: &str, value: &Spanned<DeValue>) -> SceneResult<Self>;

    /// As the notes of a scene have it, and with them its hash.
    fn shown(&self) -> String {
        format!("{self:?}")
    }
}

/// A value, or an option of one whose key may be left out.
pub trait Field: Sized {
    /// Reads what stands at `name`, or is declared for it.
    fn get(reader: &Reader, name: &str) -> SceneResult<Self>;
}

impl<T: Value> Field for T {
    fn get(reader: &Reader, name: &str) -> SceneResult<T> {
        let value = reader.optional(name)?;
        Ok(value.expect("required or has a default"))
    }
}

impl<T: Value> Field for Option<T> {
    fn get(reader: &Reader, name: &str) -> SceneResult<Option<T>> {
        reader.optional(name)
    }
}

impl Value for f64 {
    fn read(reader: &Reader, name: &str, value: &Spanned<DeValue>) -> SceneResult<f64> {
        let text = match value.get_ref() {
            DeValue::Float(float) => float.as_str().to_owned(),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().to_owned(),
            _ => return Err(reader.wrong_type(name, value)),
        };
        let wrong = |_| reader.wrong_type(name, value);
        let number: f64 = text.parse().map_err(wrong)?;
        if !number.is_finite() {
            return Err(reader.error(name, format!("`{name}` must be finite, got {text}")));
        }
        match reader.declared(name).kind {
            Kind::Number(range) | Kind::Interval(range) if !range.contains(number) => {
                Err(reader.error(name, format!("`{name}` must {range}, got {number}")))
            }
            _ => Ok(number),
        }
    }

    fn shown(&self) -> String {
        self.to_string()
    }
}

impl Value for u64 {
    fn read(reader: &Reader, name: &str, value: &Spanned<DeValue>) -> SceneResult<u64> {
        let (low, high, wrong) = match reader.declared(name).kind {
            Kind::Count(low, high) => (low, high, reader.wrong_type(name, value)),
            Kind::Counts(low, high) => (low, high, reader.wrong_form(name)),
            _ => panic!("{name} is not a count"),
        };
        let DeValue::Integer(integer) = value.get_ref() else {
            return Err(wrong);
        };
        let number = whole_number(name, integer.as_str(), integer.radix(), [low, high]);
        reader.accepted_at(name, number)
    }
}

impl Value for u32 {
    fn read(reader: &Reader, name: &str, value: &Spanned<DeValue>) -> SceneResult<u32> {
        let count = u64::read(reader, name, value)?;
        Ok(u32::try_from(count).expect("as few by declaration"))
    }
}

impl<T: Value + Copy + Default, const N: usize> Value for [T; N] {
    fn read(reader: &Reader, name: &str, value: &Spanned<DeValue>) -> SceneResult<[T; N]> {
        let items: Option<&[_; N]> = array(value).and_then(|items| items.try_into().ok());
        let items = items.ok_or_else(|| reader.wrong_form(name))?;
        let mut read = [T::default(); N];
        for (read, item) in read.iter_mut().zip(items) {
            *read = T::read(reader, name, item)?;
        }
        Ok(read)
    }
}

impl Value for DVec3 {
    fn read(reader: &Reader, name: &str, value: &Spanned<DeValue>) -> SceneResult<DVec3> {
        let kind = reader.declared(name).kind;
        let vector = match (value.get_ref(), kind) {
            (DeValue::Float(_) | DeValue::Integer(_), Kind::Colour(_)) => {
                DVec3::splat(f64::read(reader, name, value)?)
            }
            (DeValue::String(text), Kind::Colour(_)) => {
                srgb(text).ok_or_else(|| reader.wrong_form(name))?
            }
            (DeValue::Array(_), _) => DVec3::from_array(Value::read(reader, name, value)?),
            _ => return Err(reader.wrong_type(name, value)),
        };
        let Kind::Colour(range) = kind else {
            return Ok(vector);
        };
        if vector.to_array().iter().any(|&c| !range.contains(c)) {
            let message = format!("`{name}` must {range} in every channel, got {vector}");
            return Err(reader.error(name, message));
        }
        // −0 is black as well, but another bit: as +0 an image is the same whatever is elided.
        Ok(vector + DVec3::ZERO)
    }

    fn shown(&self) -> String {
        self.to_string()
    }
}

impl Value for Length {
    fn read(reader: &Reader, name: &str, value: &Spanned<DeValue>) -> SceneResult<Length> {
        let text = match value.get_ref() {
            DeValue::String(text) => text.to_string(),
            _ => f64::read(reader, name, value)?.to_string(),
        };
        let length = text.parse();
        length.map_err(|message: String| reader.error(name, format!("`{name}`: {message}")))
    }

    fn shown(&self) -> String {
        self.to_string()
    }
}

impl Value for String {
    fn read(reader: &Reader, name: &str, value: &Spanned<DeValue>) -> SceneResult<String> {
        let DeValue::String(text) = value.get_ref() else {
            return Err(reader.wrong_type(name, value));
        };
        if let Kind::Choice(words) = reader.declared(name).kind
            && !words.contains(&text.as_ref())
        {
            let expected = reader.declared(name).kind.expected();
            let message = format!("`{name}` must be {expected}, but is {text:?}");
            return Err(match nearest(text, words.iter().copied()) {
                Some(near) => reader.mistake(name, message, format!("did you mean {near:?}?")),
                None => reader.error(name, message),
            });
        }
        Ok(text.to_string())
    }
}

impl Value for bool {
    fn read(reader: &Reader, name: &str, value: &Spanned<DeValue>) -> SceneResult<bool> {
        let flag = value.get_ref().as_bool();
        flag.ok_or_else(|| reader.wrong_type(name, value))
    }
}

impl Value for Vec<String> {
    fn read(reader: &Reader, name: &str, value: &Spanned<DeValue>) -> SceneResult<Vec<String>> {
        let words = array(value).ok_or_else(|| reader.wrong_type(name, value))?;
        let word = |item| String::read(reader, name, item);
        words.iter().map(word).collect()
    }
}

impl<'d, 's> Reader<'d, 's> {
    /// The value of a key, which is there or has a default unless an option is asked for.
    pub fn get<T: Field>(&self, name: &str) -> SceneResult<T> {
        T::get(self, name)
    }

    /// The value in the file or the declared default; `None` if the declaration has neither
    /// and the key may be left out.
    pub fn optional<T: Value>(&self, name: &str) -> SceneResult<Option<T>> {
        if let Some(value) = self.value(name) {
            let value = T::read(self, name, value)?;
            self.note(name, value.shown(), Origin::Given);
            return Ok(Some(value));
        }
        match self.declared(name).absent {
            Absent::Error => {
                let table = self.table_name();
                Err(self.error(name, format!("missing key `{name}` in {table}")))
            }
            Absent::Default(text) => {
                let default = DeValue::parse(text).expect("defaults are TOML");
                let value = T::read(self, name, &default)?;
                self.note(name, value.shown(), Origin::Default);
                Ok(Some(value))
            }
            Absent::Derived(rule) => {
                self.note(name, String::new(), Origin::Derived(rule));
                Ok(None)
            }
            Absent::Nothing => Ok(None),
        }
    }

    /// A declared [`Kind::Vector`] that, left out, follows from other things.
    pub(crate) fn vector_or(
        &self,
        name: &str,
        derived: impl FnOnce() -> DVec3,
    ) -> SceneResult<DVec3> {
        let vector = self.optional(name)?.unwrap_or_else(derived);
        self.resolved(name, vector);
        Ok(vector)
    }

    /// True if the file holds the key.
    pub fn has(&self, name: &str) -> bool {
        self.value(name).is_some()
    }

    /// The first of some keys that the file holds.
    pub(crate) fn first_of<'k>(&self, names: &[&'k str]) -> Option<&'k str> {
        names.iter().copied().find(|name| self.has(name))
    }

    /// A declared [`Kind::Table`], if the file has it. One that may be left out but has
    /// defaults for all its keys is `Reader::table_or_default`.
    pub fn table(&self, name: &str) -> SceneResult<Option<Reader<'d, 's>>> {
        let Some(value) = self.value(name) else {
            return match self.declared(name).absent {
                Absent::Error => Err(self.missing_table(name)),
                _ => Ok(None),
            };
        };
        self.table_in(name, value, self.key_path(name)).map(Some)
    }

    fn missing_table(&self, name: &str) -> Box<SceneError> {
        self.error(name, format!("missing table [{}]", self.key_path(name)))
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
        value: &'d Spanned<DeValue<'s>>,
        path: String,
    ) -> SceneResult<Reader<'d, 's>> {
        match value.get_ref() {
            DeValue::Table(table) => self.inner(name, table, value.span(), path),
            _ => Err(self.wrong_type(name, value)),
        }
    }

    /// A declared [`Kind::Tables`]: each of them, in the order of the file; none where the file
    /// leaves it out.
    pub fn tables(&self, name: &str) -> SceneResult<Vec<Reader<'d, 's>>> {
        let Some(value) = self.value(name) else {
            return Ok(Vec::new());
        };
        let table =
            |(index, item)| self.table_in(name, item, format!("{}[{index}]", self.key_path(name)));
        let items = array(value).ok_or_else(|| self.wrong_type(name, value))?;
        items.iter().enumerate().map(table).collect()
    }

    /// A declared [`Kind::OneOrMore`], which is there: one table, or each of several.
    pub(crate) fn one_or_more(&self, name: &str) -> SceneResult<Vec<Reader<'d, 's>>> {
        match self.value(name) {
            Some(one) if one.get_ref().is_table() => {
                Ok(vec![self.table_in(name, one, self.key_path(name))?])
            }
            Some(several) if array(several).is_some_and(<[_]>::is_empty) => {
                Err(self.error(name, format!("`{name}` is empty")))
            }
            Some(_) => self.tables(name),
            None => Err(self.missing_table(name)),
        }
    }

    /// A declared [`Kind::Table`]; an empty one if the file leaves it out.
    pub(crate) fn table_or_default(&self, name: &str) -> SceneResult<Reader<'d, 's>> {
        static EMPTY: LazyLock<DeTable<'static>> = LazyLock::new(DeTable::new);
        if let Some(reader) = self.table(name)? {
            return Ok(reader);
        }
        self.inner(name, &EMPTY, self.span.clone(), self.key_path(name))
    }
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
