//! Verdicts as the page marks and counts them.

use crate::judging::{CaseResult, KnownStatus, Verdict};
use crate::suite::refusal;
use minijinja::{Value, context};

/// A kind of result. The template explains them.
#[derive(Debug, PartialEq)]
pub(super) struct Mark {
    /// Class of its elements.
    pub class: &'static str,
    /// Sign that tells it apart without colour.
    symbol: &'static str,
    /// Word for it.
    word: &'static str,
}

const fn mark(class: &'static str, symbol: &'static str, word: &'static str) -> Mark {
    Mark {
        class,
        symbol,
        word,
    }
}

/// All marks, in the order of the legend.
static MARKS: [Mark; 9] = [
    mark("right", "✓", "right"),
    mark("convention", "≈", "right by convention"),
    mark("known", "✗", "wrong, cause known"),
    mark("wrong", "✗", "wrong, cause not known"),
    mark("undecided", "?", "undecided"),
    mark("error", "!", "error"),
    mark("absent", "○", "no image"),
    mark("cannot", "·", "cannot say"),
    mark("blank", "", "not asked"),
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
        ["known", "wrong", "error"].contains(&self.class)
    }

    /// True if the renderer tried: there is an image, or it failed.
    pub fn is_judged(&self) -> bool {
        !["absent", "cannot", "blank"].contains(&self.class)
    }

    /// True if an image was compared with the right one.
    pub fn is_compared(&self) -> bool {
        self.is_judged() && self.class != "error"
    }

    /// True if the image is right.
    pub fn is_right(&self) -> bool {
        ["right", "convention"].contains(&self.class)
    }

    /// The words for a template.
    pub fn shown(&self) -> Value {
        context! { class => self.class, symbol => self.symbol, word => self.word, is_judged => self.is_judged() }
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
