//! What is wrong with a scene, where, and how to mend it.

use super::excerpt::{Excerpt, shortened};
use miette::{Diagnostic, SourceSpan};
use std::ops::Range;
use thiserror::Error;

/// What a file of volref's holds, or the mistake in it.
pub type SceneResult<T> = Result<T, Box<SceneError>>;

/// A mistake in a TOML file of volref's, with its place.
///
/// As a [`miette::Diagnostic`] it shows the line with the place underlined; its plain
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
            text: text.to_owned(),
        };
        Box::new(SceneError {
            message: shortened(message.into()),
            help: help.map(shortened),
            span: span.map(|span| source_code.underlined(span).into()),
            source_code,
        })
    }

    /// What is wrong, without the place.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// How to mend it.
    pub fn help_text(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Line and column of the mistake, from 1; columns count characters.
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
