//! Errors in scenes, with their position and remedy.

use crate::files::visible::{visible, visible_in_place};
use miette::{Diagnostic, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::ops::Range;
use thiserror::Error;

/// Contents of a file of volref's, or the mistake in it.
pub(crate) type SceneResult<T> = Result<T, Box<SceneError>>;

/// An error in a TOML file of volref, with its position.
///
/// As a [`miette::Diagnostic`] it shows the line with the position underlined; its plain
/// [`Display`](std::fmt::Display) is `path:line:column: message`.
#[derive(Clone, Debug, Diagnostic, Error)]
#[error("{}{message}", self.location())]
pub struct SceneError {
    message: String,
    #[help]
    help: Option<String>,
    path: String,
    position: Option<(usize, usize)>,
    /// The file, unless it has lines too long to be shown.
    #[source_code]
    source_code: Option<Excerpt>,
    #[label]
    span: Option<SourceSpan>,
}

/// The text of a file, of which messages show the lines around a mistake. Columns count characters, where those of miette
/// count bytes.
#[derive(Clone, Debug)]
struct Excerpt {
    name: String,
    text: String,
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let read = self.text.read_span(span, before, after)?;
        let line = self.text[..read.span().offset()].rsplit('\n').next();
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            read.data(),
            *read.span(),
            read.line(),
            line.unwrap_or_default().chars().count(),
            read.line_count(),
        )))
    }
}

/// A longer message is shortened: ten lines of a terminal say what is wrong.
const MOST_CHARACTERS: usize = 1000;

/// Characters kept at the beginning and at the end of a longer message. A quoted value stands between, and its
/// fault before or behind it.
const BEGINNING: usize = 400;
const END: usize = 300;

/// `text`, without its middle if it is too long.
pub(crate) fn shortened(text: String) -> String {
    let count = text.chars().count();
    if count <= MOST_CHARACTERS {
        return text;
    }
    let beginning: String = text.chars().take(BEGINNING).collect();
    let end: String = text.chars().skip(count - END).collect();
    let left_out = count - BEGINNING - END;
    format!("{beginning} … ({left_out} characters left out) … {end}")
}

/// Bytes of a line that is shown, at most.
const MOST_OF_A_LINE: usize = 1000;

/// Bytes that are underlined, at most.
const MOST_UNDERLINED: usize = 240;

/// A TOML file: its name, for messages, and its text.
pub struct Document<'s> {
    /// The name shown in messages.
    pub path: &'s str,
    /// The whole text.
    pub text: &'s str,
}

impl Document<'_> {
    /// An error at `span`, a range of bytes of this file. Without a span the file as a whole is meant.
    pub fn error(
        &self,
        span: Option<Range<usize>>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Box<SceneError> {
        let text = visible_in_place(self.text);
        // The largest boundary of a character that is not behind an offset.
        let boundary = |offset: usize| {
            let mut offsets = (0..=offset.min(text.len())).rev();
            offsets.find(|&at| text.is_char_boundary(at)).unwrap_or(0)
        };
        let span = span.map(|Range { start, end }| {
            let end = end.clamp(start, start.saturating_add(MOST_UNDERLINED));
            boundary(start)..boundary(end)
        });
        let position = span.as_ref().map(|span| {
            let before = &text[..span.start];
            let line = before.rsplit('\n').next().unwrap_or_default();
            (before.matches('\n').count() + 1, line.chars().count() + 1)
        });
        let is_shown = text.lines().all(|line| line.len() <= MOST_OF_A_LINE);
        Box::new(SceneError {
            message: shortened(message.into()),
            help: help.map(shortened),
            path: self.path.to_owned(),
            position,
            span: span.filter(|_| is_shown).map(SourceSpan::from),
            source_code: is_shown.then(|| Excerpt {
                name: visible(self.path),
                text,
            }),
        })
    }
}

impl SceneError {
    /// The message, without the position.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The remedy: how to mend the mistake, if the error says so.
    pub fn help_text(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Line and column of the error, from 1; columns count characters.
    pub fn position(&self) -> Option<(usize, usize)> {
        self.position
    }

    fn location(&self) -> String {
        let path = &self.path;
        match self.position {
            Some((line, column)) => format!("{path}:{line}:{column}: "),
            None => format!("{path}: "),
        }
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
}
