//! A file of known failures with other entries: whatever else stands in it, such as comments, stays as it is.

use super::known_failure::Keys;
use toml_edit::{DocumentMut, Item, Table, TableLike, value};

/// A file under change.
pub(super) struct Rewriting {
    document: DocumentMut,
    /// Comments above entries that were removed: the first stands above all.
    head: String,
    /// Position of the tables that come last.
    last: isize,
}

impl Rewriting {
    /// The file of this text, which has been read as known failures.
    pub fn of(text: &str) -> Rewriting {
        let document: DocumentMut = text.parse().expect("text that was read as TOML");
        let tables = document.iter().filter_map(|(_, item)| item.as_table());
        let last = tables.filter_map(Table::position).max();
        Rewriting {
            document,
            head: String::new(),
            last: last.unwrap_or(0) + 1,
        }
    }

    /// Replaces the entry `name`, in its place, by copies under new names, each with its changed keys.
    pub fn replace(&mut self, name: &str, entries: Vec<(String, Keys)>) {
        let Some(entry) = self.document.remove(name) else {
            return;
        };
        let prefix = entry.as_table().and_then(|table| table.decor().prefix());
        let prefix = prefix.and_then(|prefix| prefix.as_str());
        self.head += prefix
            .filter(|it| entries.is_empty() && it.contains('#'))
            .unwrap_or("");
        for (index, (name, keys)) in entries.into_iter().enumerate() {
            let mut entry = entry.clone();
            // A comment stands once.
            if let Some(table) = entry.as_table_mut().filter(|_| index > 0) {
                table.decor_mut().set_prefix("\n");
            }
            if let Some(table) = entry.as_table_like_mut() {
                write(table, keys);
            }
            self.document.insert(&name, entry);
        }
    }

    /// A new entry for `case`, whose reason is left to a person.
    pub fn add(&mut self, case: &str, keys: Keys) {
        let mut table = Table::new();
        table.set_position(Some(self.last));
        write(&mut table, keys);
        table.insert("reason", value(""));
        self.document.insert(case, Item::Table(table));
    }

    pub fn text(self) -> String {
        (self.head + &self.document.to_string())
            .trim_start()
            .to_owned()
    }
}

/// Sets or removes `keys` of an entry. Keeps its other keys, and the comments beside keys that keep a value.
fn write(entry: &mut dyn TableLike, keys: Keys) {
    for (key, new) in keys {
        let Some(mut new) = new else {
            entry.remove(key);
            continue;
        };
        if let Some(old) = entry.get(key).and_then(Item::as_value) {
            *new.decor_mut() = old.decor().clone();
        }
        entry.insert(key, Item::Value(new));
    }
}
