//! Excerpts of long texts in messages.

use crate::files::visible::visible;
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::ops::Range;

/// A longer message is shortened: ten lines of a terminal say what is wrong.
const MOST_CHARACTERS: usize = 1000;

/// Characters kept at the beginning and at the end of a longer message. A quoted value stands between, and its
/// fault before or behind it.
const BEGINNING: usize = 400;
const END: usize = 300;

/// `text`, without its middle if it is too long.
pub(crate) fn shortened(text: String) -> String {
    if text.len() <= MOST_CHARACTERS {
        return text;
    }
    let count = text.chars().count();
    if count <= MOST_CHARACTERS {
        return text;
    }
    let beginning: String = text.chars().take(BEGINNING).collect();
    let end: String = text.chars().skip(count - END).collect();
    let left_out = count - BEGINNING - END;
    format!("{beginning} … ({left_out} characters left out) … {end}")
}

/// A longer line is shown in part.
const MOST_OF_A_LINE: usize = 500;

/// Bytes of such a line that are shown before a place and behind it.
const AROUND: usize = 60;

/// Bytes that are underlined, at most.
const MOST_UNDERLINED: usize = 240;

/// A text, such as a scene file, of which messages show the place of a mistake.
#[derive(Clone, Debug)]
pub(super) struct Excerpt {
    pub name: String,
    pub text: String,
}

impl Excerpt {
    /// As much of a range of bytes as can be underlined.
    pub fn underlined(&self, range: Range<usize>) -> Range<usize> {
        let start = self.boundary(range.start);
        let end = range
            .end
            .clamp(start, start.saturating_add(MOST_UNDERLINED));
        start..self.boundary(end)
    }

    /// The largest boundary of a character that is not behind `offset`.
    fn boundary(&self, offset: usize) -> usize {
        let offset = offset.min(self.text.len());
        let mut boundaries = (0..=offset).rev();
        let found = boundaries.find(|&offset| self.text.is_char_boundary(offset));
        found.unwrap_or(0)
    }

    /// The part of its line, or lines, in which a place stands.
    fn around(&self, span: Range<usize>) -> Range<usize> {
        let line = self.text[..span.start].rfind('\n').map_or(0, |end| end + 1);
        let rest = &self.text[span.end..];
        let end = span.end + rest.find('\n').unwrap_or(rest.len());
        let from = self.boundary(span.start.saturating_sub(AROUND)).max(line);
        from..self.boundary((span.end + AROUND).min(end))
    }
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let whole = self.text.read_span(span, lines_before, lines_after)?;
        let is_long = |line: &[u8]| line.len() > MOST_OF_A_LINE;
        let (data, shown) = match whole.data().split(|byte| *byte == b'\n').any(is_long) {
            false => (whole.data(), *whole.span()),
            true => {
                let start = self.boundary(span.offset());
                let part = self.around(start..self.boundary(start + span.len()));
                (&self.text.as_bytes()[part.clone()], SourceSpan::from(part))
            }
        };
        let before = &self.text[..shown.offset()];
        let line = before.bytes().filter(|byte| *byte == b'\n').count();
        let column = before.rsplit('\n').next().unwrap_or_default();
        let name = visible(&self.name);
        let contents = MietteSpanContents::new_named(
            name,
            data,
            shown,
            line,
            column.chars().count(),
            whole.line_count(),
        );
        Ok(Box::new(contents))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_messages_keep_their_beginning_and_end() {
        let short = "ä".repeat(MOST_CHARACTERS);
        assert_eq!(shortened(short.clone()), short);
        let long = format!(
            "`step` takes a length, got {:?}: mend it",
            "ä".repeat(500_000)
        );
        let cut = shortened(long);
        assert!(cut.chars().count() < MOST_CHARACTERS);
        assert!(cut.starts_with("`step` takes a length, got \"ää"), "{cut}");
        assert!(cut.ends_with("ää\": mend it"), "{cut}");
        assert!(cut.contains(" … (499338 characters left out) … "), "{cut}");
    }

    /// Any place in lines of any length, with characters of several bytes, gets a part that holds the place, on its
    /// own line and column.
    #[test]
    fn places_in_long_lines() {
        let text = format!("a = 1\nb = \"{}\"\nc = 2\n", "äö".repeat(400));
        let excerpt = Excerpt {
            name: "scene.toml".to_owned(),
            text: text.clone(),
        };
        for start in (0..text.len()).step_by(7) {
            for length in [0, 1, 2, 40, 5000] {
                let span = excerpt.underlined(start..(start + length).min(text.len()));
                assert!(text.is_char_boundary(span.start) && text.is_char_boundary(span.end));
                let contents = excerpt.read_span(&span.clone().into(), 1, 1).unwrap();
                let shown = contents.span();
                assert!(shown.offset() <= span.start);
                assert!(shown.offset() + shown.len() >= span.end);
                assert!(contents.data().len() <= 2 * MOST_OF_A_LINE + 20);
                assert!(std::str::from_utf8(contents.data()).is_ok());
                let line = text[..shown.offset()].matches('\n').count();
                assert_eq!(contents.line(), line);
                let start = text[..shown.offset()].rfind('\n').map_or(0, |end| end + 1);
                let column = text[start..shown.offset()].chars().count();
                assert_eq!(contents.column(), column);
            }
        }
    }
}
