//! A table, for a terminal and for a page.

use super::words::Mark;
use serde::Serialize;

/// No line of plain text is longer.
pub(super) const WIDEST: usize = 100;
/// What is between two columns.
const GAP: usize = 2;
/// No column is cut to less.
const NARROWEST: usize = 12;

/// Rows under named columns.
#[derive(Serialize)]
pub(super) struct ReportTable {
    pub(super) title: String,
    /// How to read it, in a sentence; for the page.
    pub(super) reading: String,
    pub(super) columns: Vec<Column>,
    pub(super) rows: Vec<Vec<TableCell>>,
    /// Whether a row whose first cell is empty belongs to the row above.
    pub(super) is_grouped: bool,
    /// What must be known besides.
    pub(super) notes: Vec<String>,
}

/// A column.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Column {
    pub(super) head: &'static str,
    pub(super) is_number: bool,
    /// Left out on a terminal, which has no room for it.
    pub(super) is_page_only: bool,
}

/// A column of words.
pub(super) const fn words(head: &'static str) -> Column {
    Column {
        head,
        is_number: false,
        is_page_only: false,
    }
}

/// A column of numbers.
pub(super) const fn number(head: &'static str) -> Column {
    Column {
        head,
        is_number: true,
        is_page_only: false,
    }
}

/// A column of numbers for which a terminal has no room.
pub(super) const fn page_number(head: &'static str) -> Column {
    Column {
        head,
        is_number: true,
        is_page_only: true,
    }
}

/// What stands in a row under a column.
#[derive(Clone, Serialize)]
pub(super) struct TableCell {
    pub(super) text: String,
    pub(super) mark: Mark,
}

impl From<String> for TableCell {
    fn from(text: String) -> TableCell {
        TableCell {
            text,
            mark: Mark::Plain,
        }
    }
}

impl From<&str> for TableCell {
    fn from(text: &str) -> TableCell {
        text.to_owned().into()
    }
}

impl From<(Mark, &str)> for TableCell {
    fn from((mark, text): (Mark, &str)) -> TableCell {
        TableCell {
            text: text.to_owned(),
            mark,
        }
    }
}

impl ReportTable {
    /// Plain text, aligned, each line after `indent` blanks and none longer than [`WIDEST`]:
    /// words are cut where they would be. Ends with a line feed; empty without rows.
    pub(super) fn text(&self, indent: usize) -> String {
        if self.rows.is_empty() {
            return String::new();
        }
        let shown: Vec<usize> = (0..self.columns.len())
            .filter(|&at| !self.columns[at].is_page_only)
            .collect();
        let heads = shown.iter().map(|&at| self.columns[at].head.to_owned());
        let mut lines: Vec<Vec<String>> = vec![heads.collect()];
        for row in &self.rows {
            lines.push(shown.iter().map(|&at| row[at].text.clone()).collect());
        }
        let mut widths: Vec<usize> = (0..shown.len())
            .map(|column| {
                let cells = lines.iter().map(|line| line[column].chars().count());
                cells.max().unwrap_or(0)
            })
            .collect();
        let room = WIDEST - indent - GAP * shown.len().saturating_sub(1);
        while widths.iter().sum::<usize>() > room {
            let wordy = (0..shown.len()).filter(|&column| !self.columns[shown[column]].is_number);
            match wordy.max_by_key(|&column| widths[column]) {
                Some(column) if widths[column] > NARROWEST => widths[column] -= 1,
                _ => break,
            }
        }
        let mut text = String::new();
        for line in &lines {
            let mut built = " ".repeat(indent);
            for (column, cell) in line.iter().enumerate() {
                let cell = cut(cell, widths[column]);
                let blanks = " ".repeat(widths[column] - cell.chars().count());
                if self.columns[shown[column]].is_number {
                    built.push_str(&blanks);
                    built.push_str(&cell);
                } else {
                    built.push_str(&cell);
                    built.push_str(&blanks);
                }
                built.push_str(&" ".repeat(GAP));
            }
            text.push_str(built.trim_end());
            text.push('\n');
        }
        text
    }
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
pub(super) fn wrapped(text: &str, indent: usize) -> String {
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

    #[test]
    fn columns_are_aligned_and_words_are_cut() {
        let table = ReportTable {
            title: String::new(),
            reading: String::new(),
            columns: vec![words("name"), page_number("left out"), number("number")],
            rows: vec![
                vec!["a".into(), "x".into(), "1.5".into()],
                vec!["b".repeat(200).into(), "x".into(), "100".into()],
            ],
            is_grouped: false,
            notes: Vec::new(),
        };
        let text = table.text(2);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|line| line.chars().count() == WIDEST));
        assert!(lines[1].starts_with("  a ") && lines[1].ends_with("   1.5"));
        assert!(lines[2].ends_with("b…     100"));
    }

    #[test]
    fn long_sentences_are_wrapped() {
        let text = wrapped(&"word ".repeat(50), 4);
        assert!(text.lines().all(|line| line.starts_with("    word")));
        assert!(text.lines().all(|line| line.chars().count() <= WIDEST));
        assert_eq!(text.split_whitespace().count(), 50);
    }
}
