//! Verdicts as the page marks and counts them.

use crate::judging::{CaseResult, KnownStatus, Verdict};
use crate::suite::refusal;
use minijinja::{Value, context};

/// A kind of result: class of its elements, sign that tells it apart without colour, and word for it. The template
/// explains them.
#[derive(Debug, PartialEq)]
pub(super) struct Mark(pub &'static str, &'static str, &'static str);

/// All marks, in the order of the legend.
static MARKS: [Mark; 9] = [
    Mark("right", "✓", "right"),
    Mark("convention", "≈", "right by convention"),
    Mark("known", "✗", "wrong, cause known"),
    Mark("wrong", "✗", "wrong, cause not known"),
    Mark("undecided", "?", "undecided"),
    Mark("error", "!", "error"),
    Mark("absent", "○", "no image"),
    Mark("cannot", "·", "cannot say"),
    Mark("blank", "", "not asked"),
];

impl Mark {
    pub fn of(result: Option<&CaseResult>) -> &'static Mark {
        let Some(result) = result else {
            return &MARKS[8];
        };
        let known = result.known.as_ref().map(|known| known.status);
        let at = match result.verdict {
            Verdict::Pass => 0,
            _ if known == Some(KnownStatus::Known) => 2,
            Verdict::Convention => 1,
            Verdict::Fail => 3,
            Verdict::Inconclusive => 4,
            Verdict::Error => 5,
            Verdict::Missing if refusal(&result.reason).is_some() => 7,
            Verdict::Missing => 6,
        };
        &MARKS[at]
    }

    /// True of a failure, which has a cause.
    pub fn is_wrong(&self) -> bool {
        ["known", "wrong", "error"].contains(&self.0)
    }

    /// True if the renderer tried: there is an image, or it failed.
    pub fn is_judged(&self) -> bool {
        !["absent", "cannot", "blank"].contains(&self.0)
    }

    /// True if an image was compared with the right one.
    pub fn is_compared(&self) -> bool {
        self.is_judged() && self.0 != "error"
    }

    /// True if the image is right.
    pub fn is_right(&self) -> bool {
        ["right", "convention"].contains(&self.0)
    }

    /// The words for a template.
    pub fn shown(&self) -> Value {
        context! { class => self.0, symbol => self.1, word => self.2, is_judged => self.is_judged() }
    }
}

/// The legend: the marks that occur among `marks`, and how often.
pub(super) fn legend<'m>(marks: impl Iterator<Item = &'m Mark> + Clone) -> Vec<Value> {
    let count = |mark: &Mark| marks.clone().filter(|other| *other == mark).count();
    let counted = MARKS.iter().map(|mark| (mark, count(mark)));
    let some = counted.filter(|(_, count)| *count > 0);
    some.map(|(mark, count)| context! { count => count, ..mark.shown() })
        .collect()
}
