//! One table for all forms: plain text, a page, and CSV.

use super::words::Mark;
use minijinja::{Value, context};

/// Longest line of plain text.
pub(super) const WIDEST: usize = 100;
/// Blanks between two columns.
const GAP: usize = 2;
/// Least width that words are cut to.
const NARROWEST: usize = 12;

/// Rows of cells; all rows have the same columns, those of the first.
#[derive(Default)]
pub(super) struct Table {
    pub(super) title: String,
    pub(super) rows: Vec<Vec<Cell>>,
    /// Whether rows that begin alike belong together: the first of them says it for all.
    pub(super) is_grouped: bool,
    /// Sentences below it.
    pub(super) notes: Vec<String>,
}

/// A value in its column.
#[derive(Clone, Default)]
pub(super) struct Cell {
    /// Name of the column in CSV; empty if it is not there.
    key: &'static str,
    /// The value with all its digits; empty if there is none.
    datum: String,
    /// Head of the column on terminal and page; empty if it is not there.
    head: &'static str,
    /// The value for people, if there is one.
    text: Option<String>,
    mark: Mark,
    is_number: bool,
    /// Left out on a terminal, which has no room for it.
    is_page_only: bool,
    /// Left out where no row has a value.
    is_optional: bool,
}

/// A cell of CSV alone.
pub(super) fn key(key: &'static str, datum: impl Into<Datum>) -> Cell {
    Cell::default().key(key, datum)
}

/// A cell of words for people.
pub(super) fn words(head: &'static str, text: &str) -> Cell {
    Cell {
        head,
        text: Some(text.to_owned()),
        ..Cell::default()
    }
}

/// A cell of a number for people.
pub(super) fn number(head: &'static str, text: impl Into<Option<String>>) -> Cell {
    Cell {
        head,
        text: text.into(),
        is_number: true,
        ..Cell::default()
    }
}

impl Cell {
    /// The same in CSV as well.
    pub(super) fn key(self, key: &'static str, datum: impl Into<Datum>) -> Cell {
        let Datum(datum) = datum.into();
        Cell { key, datum, ..self }
    }

    pub(super) fn marked(self, mark: Mark) -> Cell {
        Cell { mark, ..self }
    }

    pub(super) fn on_page(self) -> Cell {
        Cell {
            is_page_only: true,
            ..self
        }
    }

    pub(super) fn optional(self) -> Cell {
        Cell {
            is_optional: true,
            ..self
        }
    }

    fn shown(&self) -> &str {
        self.text.as_deref().unwrap_or("–")
    }
}

/// A value as CSV has it: a number with the shortest digits that read back as the same number.
pub(super) struct Datum(String);

impl From<f64> for Datum {
    fn from(number: f64) -> Datum {
        Datum(format!("{number:?}"))
    }
}

impl From<usize> for Datum {
    fn from(count: usize) -> Datum {
        Datum(count.to_string())
    }
}

impl From<bool> for Datum {
    fn from(is: bool) -> Datum {
        Datum(is.to_string())
    }
}

impl From<&str> for Datum {
    fn from(text: &str) -> Datum {
        Datum(text.to_owned())
    }
}

impl From<String> for Datum {
    fn from(text: String) -> Datum {
        Datum(text)
    }
}

impl<T: Into<Datum>> From<Option<T>> for Datum {
    fn from(value: Option<T>) -> Datum {
        value.map_or(Datum(String::new()), T::into)
    }
}

impl Table {
    /// Numbers of the columns for a page or a terminal.
    fn columns(&self, is_page: bool) -> Vec<usize> {
        let Some(first) = self.rows.first() else {
            return Vec::new();
        };
        let is_shown = |&at: &usize| {
            let cell = &first[at];
            let is_empty = || self.rows.iter().all(|row| row[at].text.is_none());
            let is_left_out = cell.head.is_empty()
                || cell.is_page_only && !is_page
                || cell.is_optional && is_empty();
            !is_left_out
        };
        (0..first.len()).filter(is_shown).collect()
    }

    /// Text by row of `columns`. A group says its name once.
    fn texts(&self, columns: &[usize]) -> Vec<Vec<&str>> {
        let mut group = None;
        let texts = self.rows.iter().map(|row| {
            let mut texts: Vec<&str> = columns.iter().map(|&at| row[at].shown()).collect();
            if self.is_grouped && group.replace(texts[0]) == Some(texts[0]) {
                texts[0] = "";
            }
            texts
        });
        texts.collect()
    }

    /// Plain text, aligned, each line after `indent` blanks and none longer than [`WIDEST`]:
    /// words are cut where they would be. Ends with a line feed; empty without rows.
    pub(super) fn text(&self, indent: usize) -> String {
        let columns = self.columns(false);
        let Some(first) = self.rows.first() else {
            return String::new();
        };
        let columns_of = |at: usize| &first[columns[at]];
        let mut lines = vec![columns.iter().map(|&at| first[at].head).collect()];
        lines.extend(self.texts(&columns));
        let width = |at: usize| {
            lines
                .iter()
                .map(|line: &Vec<&str>| line[at].chars().count())
                .max()
        };
        let mut widths: Vec<usize> = (0..columns.len()).filter_map(width).collect();
        let room = WIDEST - indent - GAP * columns.len().saturating_sub(1);
        while widths.iter().sum::<usize>() > room {
            let wordy = (0..columns.len()).filter(|&at| !columns_of(at).is_number);
            match wordy.max_by_key(|&at| widths[at]) {
                Some(widest) if widths[widest] > NARROWEST => widths[widest] -= 1,
                _ => break,
            }
        }
        let mut text = String::new();
        for line in &lines {
            let mut built = " ".repeat(indent);
            for (at, (cell, &width)) in line.iter().zip(&widths).enumerate() {
                let cell = cut(cell, width);
                built.push_str(&match columns_of(at).is_number {
                    true => format!("{cell:>width$}"),
                    false => format!("{cell:<width$}"),
                });
                built.push_str(&" ".repeat(GAP));
            }
            text.push_str(built.trim_end());
            text.push('\n');
        }
        text
    }

    /// The table for the template of a page.
    pub(super) fn page(&self) -> Value {
        let columns = self.columns(true);
        let marks = |at: usize| {
            columns
                .iter()
                .map(move |&column| self.rows[at][column].mark)
        };
        let texts = self.texts(&columns).into_iter().enumerate();
        let rows = texts.map(|(at, row)| row.into_iter().zip(marks(at)).collect::<Vec<_>>());
        let first = self.rows.first();
        let heads = columns
            .iter()
            .filter_map(|&at| first.map(|row| (row[at].head, row[at].is_number)));
        context! {
            title => self.title,
            columns => heads.collect::<Vec<_>>(),
            rows => rows.collect::<Vec<_>>(),
            is_grouped => self.is_grouped,
            notes => self.notes,
        }
    }
}

/// The cells of `rows` that have a key as CSV, with a row of names on top; none of no rows.
pub(super) fn csv(rows: &[Vec<Cell>]) -> Option<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // The writer refuses a row that is longer or shorter than the first.
    let all = "rows have the same columns";
    writer
        .write_record(keyed(rows.first()?).map(|cell| cell.key))
        .expect(all);
    for row in rows {
        writer
            .write_record(keyed(row).map(|cell| &cell.datum))
            .expect(all);
    }
    let bytes = writer.into_inner().expect("a vector takes every byte");
    Some(String::from_utf8(bytes).expect("text was written"))
}

/// The cells of a row that are in CSV.
fn keyed(row: &[Cell]) -> impl Iterator<Item = &Cell> {
    row.iter().filter(|cell| !cell.key.is_empty())
}

/// The text, or its beginning and an ellipsis where it is longer than `width`.
fn cut(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    let kept: String = text.chars().take(width.saturating_sub(1)).collect();
    format!("{kept}…")
}

/// The words of `text` in lines that are at most [`WIDEST`] long, each after `indent` blanks; a
/// word that is longer has a line to itself.
pub(crate) fn wrapped(text: &str, indent: usize) -> String {
    let mut out = String::new();
    let mut length = 0;
    for word in text.split_whitespace() {
        let size = word.chars().count();
        if length > 0 && length + 1 + size > WIDEST {
            out.push('\n');
            length = 0;
        }
        if length == 0 {
            out.push_str(&" ".repeat(indent));
            length = indent;
        } else {
            out.push(' ');
            length += 1;
        }
        out.push_str(word);
        length += size;
    }
    out.push('\n');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: Vec<Vec<Cell>>) -> Table {
        Table {
            rows,
            is_grouped: true,
            ..Table::default()
        }
    }

    #[test]
    fn columns_are_aligned_and_words_are_cut() {
        let row = |name: &str, value: f64| {
            vec![
                words("name", name).key("name", name),
                number("left out", "x".to_owned()).on_page(),
                number("empty", None).optional(),
                number("number", value.to_string()).key("number", value),
            ]
        };
        let table = table(vec![
            row("a", 1.5),
            row(&"b".repeat(200), 100.0),
            row("c", 1.0),
        ]);
        let text = table.text(2);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 4);
        assert!(lines.iter().all(|line| line.chars().count() == WIDEST));
        assert!(lines[1].starts_with("  a ") && lines[1].ends_with("   1.5"));
        assert!(lines[2].ends_with("b…     100"));
        assert!(
            csv(&table.rows)
                .unwrap()
                .starts_with("name,number\na,1.5\nbbb")
        );
    }

    #[test]
    fn a_group_says_its_name_once() {
        let row = |name: &str| vec![words("name", name).key("name", name), words("x", "y")];
        let table = table(vec![row("a"), row("a"), row("b")]);
        assert_eq!(table.text(0), "name  x\na     y\n      y\nb     y\n");
        assert_eq!(csv(&table.rows).unwrap(), "name\na\na\nb\n");
        assert_eq!(csv(&[]), None);
    }

    #[test]
    fn long_sentences_are_wrapped() {
        let text = wrapped(&"word ".repeat(50), 4);
        assert!(text.lines().all(|line| line.starts_with("    word")));
        assert!(text.lines().all(|line| line.chars().count() <= WIDEST));
        assert_eq!(text.split_whitespace().count(), 50);
    }
}
