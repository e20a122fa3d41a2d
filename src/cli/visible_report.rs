//! Messages with control characters made visible before they are drawn: afterwards the escape codes
//! in the name of a file cannot be told from those that colour the message.

use crate::report::{visible, visible_char};
use miette::{
    Diagnostic, LabeledSpan, MietteDiagnostic, MietteError, MietteSpanContents, Report, SourceCode,
    SourceSpan, SpanContents,
};

/// `diagnostic` for drawing: the same text, with symbols in place of control characters.
pub fn visible_report(diagnostic: &dyn Diagnostic) -> Report {
    let mut shown = MietteDiagnostic::new(visible(&diagnostic.to_string()));
    shown.help = diagnostic.help().map(|help| visible(&help.to_string()));
    let labels: Vec<LabeledSpan> = diagnostic.labels().into_iter().flatten().collect();
    let excerpt = (diagnostic.source_code()).and_then(|code| VisibleExcerpt::of(code, &labels));
    let Some(excerpt) = excerpt else {
        return shown.into();
    };
    shown.labels = Some(labels.iter().map(|label| excerpt.shifted(label)).collect());
    Report::new(shown).with_source_code(excerpt)
}

/// Excerpt of a text: the part that labels point into, with some lines around it.
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

    /// `label` moved to its place in the excerpt, whose characters may have more bytes.
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

/// The first `length` bytes of `text` as they are shown. Line ends of Windows stay, as they are
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
