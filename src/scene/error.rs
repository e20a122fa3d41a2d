//! Errors in scenes, with their position and remedy.

use super::excerpt::{Excerpt, shortened};
use crate::files::visible::visible_in_place;
use miette::{Diagnostic, SourceSpan};
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
    #[source_code]
    source_code: Excerpt,
    #[label]
    span: Option<SourceSpan>,
}

impl SceneError {
    /// A mistake at `span`, a range of bytes of `text`, the contents of the file `path`.
    /// Without a span the file as a whole is meant.
    pub(super) fn new(
        path: &str,
        text: &str,
        span: Option<Range<usize>>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Box<SceneError> {
        let source_code = Excerpt {
            name: path.to_owned(),
            text: visible_in_place(text),
        };
        Box::new(SceneError {
            message: shortened(message.into()),
            help: help.map(shortened),
            span: span.map(|span| source_code.underlined(span).into()),
            source_code,
        })
    }

    /// The message, without the position.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The remedy.
    pub fn help_text(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Line and column of the error, from 1; columns count characters.
    pub fn position(&self) -> Option<(usize, usize)> {
        let before = &self.source_code.text[..self.span?.offset()];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Some((
            before.matches('\n').count() + 1,
            before[line_start..].chars().count() + 1,
        ))
    }

    fn location(&self) -> String {
        let path = &self.source_code.name;
        match self.position() {
            Some((line, column)) => format!("{path}:{line}:{column}: "),
            None => format!("{path}: "),
        }
    }
}
