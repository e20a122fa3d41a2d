//! A file of known failures with other entries: whatever else stands in it, such as comments, stays as it is.

use super::known_failure::Keys;
use toml_edit::{DocumentMut, Item, Table, TableLike, value};

/// What stands above the entries of a new file.
const HEAD: &str = "\
# Known failures of a renderer, for `volref validate --known`.
# Each has a reason, written by a person.

";

/// A file under change.
pub(super) struct Rewriting {
    document: DocumentMut,
    is_new: bool,
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
            is_new: text.trim().is_empty(),
            last: last.unwrap_or(0) + 1,
        }
    }

    /// The entry `name` replaced, in its place, by `entries` with these names, with what changes in them.
    pub fn replace(&mut self, name: &str, entries: Vec<(String, Keys)>) {
        let next = self.after(name);
        let Some(entry) = self.document.remove(name) else {
            return;
        };
        if entries.is_empty() {
            self.keep_head(&entry, next.as_deref());
        }
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
        let text = self.document.to_string();
        match self.is_new {
            true if !text.is_empty() => HEAD.to_owned() + text.trim_start(),
            _ => text,
        }
    }

    /// The name of the table that follows `name` in the file.
    fn after(&self, name: &str) -> Option<String> {
        let position = self.document.get(name)?.as_table()?.position();
        let tables = self.document.iter();
        let others = tables.filter_map(|(name, item)| Some((item.as_table()?.position(), name)));
        let next = others.filter(|(other, _)| *other > position).min();
        next.map(|(_, name)| name.to_owned())
    }

    /// Moves what stands above a removed entry to the `next`, up to the last empty line: below that it is a comment on
    /// the entry itself.
    fn keep_head(&mut self, removed: &Item, next: Option<&str>) {
        let prefix = removed.as_table().and_then(|table| table.decor().prefix());
        let prefix = prefix.and_then(|prefix| prefix.as_str()).unwrap_or("");
        let Some((head, _)) = prefix
            .rsplit_once("\n\n")
            .filter(|(head, _)| head.contains('#'))
        else {
            return;
        };
        let next = next.and_then(|name| self.document.get_mut(name));
        if let Some(table) = next.and_then(Item::as_table_mut) {
            let own = table.decor().prefix().and_then(|prefix| prefix.as_str());
            let own = own.unwrap_or("\n").to_owned();
            let between = if own.starts_with('\n') { "\n" } else { "\n\n" };
            table
                .decor_mut()
                .set_prefix(format!("{head}{between}{own}"));
        } else {
            let own = self.document.trailing().as_str().unwrap_or("").to_owned();
            self.document.set_trailing(format!("{head}\n{own}"));
        }
    }
}

/// Writes `keys` into an entry, whose reason and link stay, and comments beside keys that have a value.
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
