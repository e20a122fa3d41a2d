//! A message with all that is foreign in it made visible, before it is drawn: afterwards nobody can
//! tell the escape codes of a file's name from those that colour the message.

use crate::report::{visible, visible_char};
use miette::{
    Diagnostic, LabeledSpan, MietteError, MietteSpanContents, Severity, SourceCode, SourceSpan,
    SpanContents,
};
use std::error::Error;
use std::fmt::{self, Display, Formatter};

/// A diagnostic with the same words, and pictures in place of control characters.
#[derive(Debug)]
pub struct VisibleReport {
    message: String,
    code: Option<String>,
    severity: Option<Severity>,
    help: Option<String>,
    url: Option<String>,
    source_code: Option<VisibleExcerpt>,
    labels: Vec<LabeledSpan>,
    related: Vec<VisibleReport>,
    cause: Option<Box<VisibleReport>>,
}

impl VisibleReport {
    /// `diagnostic` to be drawn.
    pub fn of(diagnostic: &dyn Diagnostic) -> VisibleReport {
        let shown = |text: Box<dyn Display + '_>| visible(&text.to_string());
        let labels: Vec<LabeledSpan> = diagnostic.labels().into_iter().flatten().collect();
        let excerpt = (diagnostic.source_code()).and_then(|code| VisibleExcerpt::of(code, &labels));
        let cause = match (diagnostic.diagnostic_source(), diagnostic.source()) {
            (Some(cause), _) => Some(VisibleReport::of(cause)),
            (None, Some(cause)) => Some(VisibleReport::of_error(cause)),
            (None, None) => None,
        };
        let related = diagnostic.related().into_iter().flatten();
        VisibleReport {
            message: visible(&diagnostic.to_string()),
            code: diagnostic.code().map(shown),
            severity: diagnostic.severity(),
            help: diagnostic.help().map(shown),
            url: diagnostic.url().map(shown),
            labels: match &excerpt {
                Some(excerpt) => labels.iter().map(|label| excerpt.shifted(label)).collect(),
                None => Vec::new(),
            },
            source_code: excerpt,
            related: related.map(VisibleReport::of).collect(),
            cause: cause.map(Box::new),
        }
    }

    fn of_error(error: &dyn Error) -> VisibleReport {
        let cause = error.source().map(VisibleReport::of_error);
        VisibleReport {
            message: visible(&error.to_string()),
            code: None,
            severity: None,
            help: None,
            url: None,
            source_code: None,
            labels: Vec::new(),
            related: Vec::new(),
            cause: cause.map(Box::new),
        }
    }
}

impl Display for VisibleReport {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl Error for VisibleReport {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.cause.as_deref().map(|cause| cause as _)
    }
}

impl Diagnostic for VisibleReport {
    fn code<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        self.code.as_ref().map(|code| Box::new(code) as _)
    }

    fn severity(&self) -> Option<Severity> {
        self.severity
    }

    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as _)
    }

    fn url<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        self.url.as_ref().map(|url| Box::new(url) as _)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source_code.as_ref().map(|code| code as _)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        match self.labels[..] {
            [] => None,
            _ => Some(Box::new(self.labels.iter().cloned())),
        }
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        match self.related[..] {
            [] => None,
            _ => Some(Box::new(self.related.iter().map(|report| report as _))),
        }
    }

    fn diagnostic_source(&self) -> Option<&dyn Diagnostic> {
        self.cause.as_deref().map(|cause| cause as _)
    }
}

/// The part of a text that labels point into, with some lines around it. Its offsets are those of
/// the text, as far as its first character.
#[derive(Debug)]
struct VisibleExcerpt {
    name: String,
    text: String,
    shown: String,
    /// Bytes of the text before this part.
    offset: usize,
    /// Lines of the text before this part, and characters before it on its first line.
    line: usize,
    column: usize,
}

/// Lines before and behind a label that may be drawn with it.
const CONTEXT: usize = 3;

impl VisibleExcerpt {
    fn of(code: &dyn SourceCode, labels: &[LabeledSpan]) -> Option<VisibleExcerpt> {
        let start = labels.iter().map(LabeledSpan::offset).min()?;
        let end = labels.iter().map(|label| label.offset() + label.len());
        let span = (start, end.max()? - start).into();
        let contents = code.read_span(&span, CONTEXT, CONTEXT).ok()?;
        let text = String::from_utf8_lossy(contents.data()).into_owned();
        Some(VisibleExcerpt {
            name: visible(contents.name().unwrap_or_default()),
            shown: shown(&text, text.len()),
            text,
            offset: contents.span().offset(),
            line: contents.line(),
            column: contents.column(),
        })
    }

    /// `label` where it is in the text that is shown, whose characters may have more bytes.
    fn shifted(&self, label: &LabeledSpan) -> LabeledSpan {
        let column = |at: usize| {
            let before = shown(&self.text, at.saturating_sub(self.offset));
            self.offset + before.len()
        };
        let (from, to) = (column(label.offset()), column(label.offset() + label.len()));
        LabeledSpan::new(label.label().map(visible), from, to - from)
    }
}

impl SourceCode for VisibleExcerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let within = (span.offset().saturating_sub(self.offset), span.len()).into();
        let contents = self.shown.read_span(&within, lines_before, lines_after)?;
        let start = contents.span().offset();
        let (line, column) = match self.shown[..start].rsplit_once('\n') {
            Some((_, line)) => (line, 0),
            None => (&self.shown[..start], self.column),
        };
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            contents.data(),
            (self.offset + start, contents.span().len()).into(),
            self.line + contents.line(),
            // In characters, as every message counts; text by itself counts bytes.
            column + line.chars().count(),
            contents.line_count(),
        )))
    }
}

/// What is shown of the first `length` bytes of `text`. Line ends of Windows stay, as they are
/// never drawn.
fn shown(text: &str, length: usize) -> String {
    let mut letters = text.char_indices().peekable();
    let mut shown = String::new();
    while let Some((at, letter)) = letters.next() {
        if at >= length {
            break;
        }
        let ends_line = letter == '\r' && letters.peek().is_some_and(|(_, next)| *next == '\n');
        shown.push(if ends_line {
            letter
        } else {
            visible_char(letter)
        });
    }
    shown
}
