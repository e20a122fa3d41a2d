//! Records: tables of a file that are declared, documented and read by one row a key.

use super::SceneResult;
use super::format::Table;
use super::reader::Reader;

/// A table that is read as a whole, key by key in the order of its declaration.
pub(super) trait Record: Sized {
    /// Its declaration.
    const TABLE: Table;

    /// Reads it.
    fn read(reader: &Reader) -> SceneResult<Self>;
}

/// Declares a [`Record`], for a type of its own (`struct`) or one that is there (`impl`). A row has the field, whose name
/// is also the key, and its type. Then come the meaning of its absence, as a constructor of
/// [`Key`](super::format::Key), the kind of its value, and its description in the schema, which also documents the field.
macro_rules! record {
    ($(#[$meta:meta])* $vis:vis struct $name:ident in $about:literal {$(
        $field:ident: $type:ty = $absent:ident $(($or:literal))? $kind:ident $(($($limit:expr),+))?, $doc:literal;
    )+}) => {
        $(#[$meta])* $vis struct $name { $(#[doc = $doc] pub $field: $type,)+ }
        record! { impl $name in $about { $($field = $absent $(($or))? $kind $(($($limit),+))?, $doc;)+ } }
    };
    (impl $name:ident in $about:literal {$(
        $field:ident = $absent:ident $(($or:literal))? $kind:ident $(($($limit:expr),+))?, $doc:literal;
    )+}) => {
        impl $crate::scene::record::Record for $name {
            const TABLE: $crate::scene::format::Table = $crate::scene::format::Table::new($about).keys(&[$(
                $crate::scene::format::Key::$absent(
                    stringify!($field),
                    $crate::scene::format::Kind::$kind $(($($limit),+))?
                    $(, $or)?
                ).doc($doc),
            )+]);

            fn read(reader: &$crate::scene::reader::Reader) -> $crate::scene::SceneResult<$name> {
                Ok($name { $($field: reader.get(stringify!($field))?,)+ })
            }
        }
    };
}

/// Refuses the first key of a table that is given and wrong. A row has the key, a condition unless the key is always wrong,
/// the message, and the remedy. Without a remedy the description of the key is shown.
macro_rules! refuse {
    ($reader:ident: $($key:literal $(if $is_wrong:expr)?, $message:expr $(, $help:expr)?;)+) => {
        $(if $reader.has($key) $(&& $is_wrong)? {
            return Err(refuse!(@ $reader $key, $message $(, $help)?));
        })+
    };
    (@ $reader:ident $key:literal, $message:expr) => { $reader.error($key, $message) };
    (@ $reader:ident $key:literal, $message:expr, $help:expr) => { $reader.mistake($key, $message, $help) };
}

/// A value that is one of several words.
pub(super) trait Choice: Sized {
    /// The words, in the order of their choices.
    const WORDS: &[&str];

    /// The choice that has a declared word.
    fn named(word: &str) -> Self;
}

/// Makes an enumeration, declared here or elsewhere (`impl`), a [`Choice`].
macro_rules! choice {
    ($(#[$meta:meta])* pub enum $name:ident { $($(#[$doc:meta])* $variant:ident = $word:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name { $($(#[$doc])* $variant,)+ }

        choice! { impl $name { $($variant = $word,)+ } }
    };
    (impl $name:ident { $($variant:ident = $word:literal,)+ }) => {
        impl $crate::scene::record::Choice for $name {
            const WORDS: &[&str] = &[$($word),+];

            fn named(word: &str) -> $name {
                match word {
                    $($word => $name::$variant,)+
                    _ => unreachable!("one of the declared words"),
                }
            }
        }

        impl $crate::scene::reader::Value for $name {
            fn read(
                reader: &$crate::scene::reader::Reader,
                name: &str,
                value: &toml::Spanned<toml::de::DeValue>,
            ) -> $crate::scene::SceneResult<$name> {
                String::read(reader, name, value).map(|word| $crate::scene::record::Choice::named(&word))
            }

            fn shown(&self) -> String {
                let word = match self { $($name::$variant => $word,)+ };
                format!("{word:?}")
            }
        }
    };
}
