//! JSON to be read by people: keys in the order they are given, objects over several lines, arrays
//! in one.

use glam::DVec3;
use serde_json::Value;

/// A JSON value whose objects keep the order of their keys.
pub(super) enum Json {
    /// A number, a text, true, false or null.
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

from_values! { (), bool, f64, u8, u32, u64, usize, &str, String }

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

impl<T: Into<Json>> From<Vec<T>> for Json {
    fn from(values: Vec<T>) -> Json {
        Json::List(values.into_iter().map(Into::into).collect())
    }
}

impl<T: Into<Json>, const N: usize> From<[T; N]> for Json {
    fn from(values: [T; N]) -> Json {
        Vec::from(values).into()
    }
}

impl<T: Into<Json>> From<Option<T>> for Json {
    fn from(value: Option<T>) -> Json {
        value.map_or(().into(), Into::into)
    }
}

impl Json {
    /// The text of this value, in a line with this indentation.
    pub(super) fn text(&self, indent: &str) -> String {
        match self {
            Json::Value(value) => value.to_string(),
            Json::List(values) => {
                let values: Vec<String> = values.iter().map(|value| value.text(indent)).collect();
                format!("[{}]", values.join(", "))
            }
            Json::Object(entries) if entries.is_empty() => "{}".to_owned(),
            Json::Object(entries) => {
                let inner = format!("{indent}  ");
                let entry = |(key, value): &(&str, Json)| {
                    format!("{inner}\"{key}\": {}", value.text(&inner))
                };
                let entries: Vec<String> = entries.iter().map(entry).collect();
                format!("{{\n{}\n{indent}}}", entries.join(",\n"))
            }
        }
    }
}
