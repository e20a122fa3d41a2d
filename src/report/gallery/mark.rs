//! Verdicts as the page marks and counts them.

use crate::judging::{CaseResult, KnownStatus, Verdict};
use crate::suite::refusal;
use minijinja::{Value, context};

/// A kind of result.
#[derive(Debug, PartialEq)]
pub(super) struct Mark {
    /// Class of its elements.
    pub class: &'static str,
    /// Sign that tells it apart without colour.
    pub symbol: &'static str,
    /// Word for it.
    pub word: &'static str,
    /// Explanation, for the legend.
    meaning: &'static str,
}

const fn new([class, symbol, word, meaning]: [&'static str; 4]) -> Mark {
    Mark {
        class,
        symbol,
        word,
        meaning,
    }
}

/// All marks, in the order of the legend.
static MARKS: [Mark; 9] = [
    new([
        "right",
        "✓",
        "right",
        "The image agrees with the right one, up to rounding or noise.",
    ]),
    new([
        "convention",
        "≈",
        "right by convention",
        "The image agrees under other conventions than those of the scene, and volref says which.",
    ]),
    new([
        "known",
        "✗",
        "wrong, cause known",
        "The image differs, and a person has written down why.",
    ]),
    new([
        "wrong",
        "✗",
        "wrong, cause not known",
        "The image differs, and nobody has found out why yet.",
    ]),
    new([
        "undecided",
        "?",
        "undecided",
        "The image is too noisy, or its steps are too long, to tell.",
    ]),
    new([
        "error",
        "!",
        "error",
        "The renderer failed, or its image cannot be read.",
    ]),
    new([
        "absent",
        "○",
        "no image",
        "The renderer was asked, and there is no image.",
    ]),
    new([
        "cannot",
        "·",
        "cannot say",
        "The renderer has no way to draw the scene. That is no failure.",
    ]),
    new([
        "blank",
        "",
        "not asked",
        "The mark is blank: the run of the renderer left the scene out.",
    ]),
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

/// The legend: the marks that occur among `marks`, how often, and what they mean.
pub(super) fn legend<'m>(marks: impl Iterator<Item = &'m Mark> + Clone) -> Vec<Value> {
    let count = |mark: &Mark| marks.clone().filter(|other| *other == mark).count();
    let counted = MARKS.iter().map(|mark| (mark, count(mark)));
    let some = counted.filter(|(_, count)| *count > 0);
    some.map(|(mark, count)| {
        context! { count => count, meaning => mark.meaning, ..mark.shown() }
    })
    .collect()
}
