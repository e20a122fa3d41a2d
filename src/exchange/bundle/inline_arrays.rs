//! JSON to be read by people: keys in the order they are given, objects over several lines, arrays
//! of numbers in one.

use glam::DVec3;
use serde::ser::{Serialize, SerializeMap, Serializer};
use serde_json::Value;
use serde_json::ser::{Formatter, PrettyFormatter};
use std::io::{Result, Write};

/// A JSON value whose objects keep the order of their keys.
pub(super) enum Json {
    /// Anything but an object with an order.
    Value(Value),
    /// Keys and values.
    Object(Entries),
    /// Values.
    List(Vec<Json>),
}

/// The keys of an object and their values, in order.
pub(super) type Entries = Vec<(&'static str, Json)>;

/// Keys and values in this order; a value is a number, a text, a vector, null, or entries again.
macro_rules! entries {
    ($($key:literal: $value:expr),* $(,)?) => {
        vec![$(($key, $crate::exchange::bundle::inline_arrays::Json::from($value))),*]
    };
}
pub(super) use entries;

macro_rules! from_values {
    ($($plain:ty),*) => {$(
        impl From<$plain> for Json {
            fn from(value: $plain) -> Json {
                Json::Value(value.into())
            }
        }
    )*};
}

from_values! { (), bool, f64, u32, u64, usize, &str, String, Option<&str>, Option<String>, Option<u32> }
from_values! { [usize; 3], [f64; 2], [f64; 3], Vec<u8>, Vec<f64>, Vec<usize>, Vec<String>, Vec<[f64; 3]> }

impl From<DVec3> for Json {
    fn from(vector: DVec3) -> Json {
        vector.to_array().into()
    }
}

impl From<Entries> for Json {
    fn from(entries: Entries) -> Json {
        Json::Object(entries)
    }
}

impl From<Vec<Json>> for Json {
    fn from(values: Vec<Json>) -> Json {
        Json::List(values)
    }
}

impl From<Option<Entries>> for Json {
    fn from(entries: Option<Entries>) -> Json {
        entries.map_or(().into(), Json::Object)
    }
}

impl Serialize for Json {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Json::Value(value) => value.serialize(serializer),
            Json::List(values) => values.serialize(serializer),
            Json::Object(entries) => {
                let mut map = serializer.serialize_map(Some(entries.len()))?;
                for (key, value) in entries {
                    map.serialize_entry(key, value)?;
                }
                map.end()
            }
        }
    }
}

/// `value` as JSON, with a newline at the end.
pub(super) fn to_json(value: &impl Serialize) -> Vec<u8> {
    let mut text = Vec::new();
    let formatter = InlineArrays(PrettyFormatter::new());
    value
        .serialize(&mut serde_json::Serializer::with_formatter(
            &mut text, formatter,
        ))
        .expect("texts and numbers are JSON, and memory takes all bytes");
    text.push(b'\n');
    text
}

/// The usual pretty form, but for arrays.
struct InlineArrays(PrettyFormatter<'static>);

impl Formatter for InlineArrays {
    fn begin_array_value<W: Write + ?Sized>(&mut self, writer: &mut W, first: bool) -> Result<()> {
        writer.write_all(if first { b"" } else { b", " })
    }

    fn begin_object<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        self.0.begin_object(writer)
    }

    fn end_object<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        self.0.end_object(writer)
    }

    fn begin_object_key<W: Write + ?Sized>(&mut self, writer: &mut W, first: bool) -> Result<()> {
        self.0.begin_object_key(writer, first)
    }

    fn begin_object_value<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        self.0.begin_object_value(writer)
    }

    fn end_object_value<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        self.0.end_object_value(writer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn arrays_stay_in_one_line() {
        let value = json!({ "a": [1.5, [2, 3]], "b": [{ "c": [] }, { "d": null }] });
        let expected = "{\n  \"a\": [1.5, [2, 3]],\n  \"b\": [{\n    \"c\": []\n  }, {\n    \
                        \"d\": null\n  }]\n}\n";
        assert_eq!(String::from_utf8(to_json(&value)).unwrap(), expected);
    }
}
