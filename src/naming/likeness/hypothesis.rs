//! Hypotheses: one mistake, or two, behind an image.

use crate::compare::cells::Misfit;
use crate::variations::mistakes;
use crate::variations::mistakes::Mistake;
use std::sync::OnceLock;

/// Hypotheses that explain an image, with their misfits.
pub(super) type Explaining = Vec<(Hypothesis, Misfit)>;

/// One mistake, or two, the first made before the second; by their places in the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Hypothesis {
    One(usize),
    Two(usize, usize),
}

/// The mistake at `place` of the catalogue.
pub(super) fn mistake(index: usize) -> &'static Mistake {
    static CATALOGUE: OnceLock<Vec<&'static Mistake>> = OnceLock::new();
    CATALOGUE.get_or_init(|| mistakes::catalogue().collect())[index]
}

impl Hypothesis {
    /// The place of the mistake in the catalogue, of one alone.
    pub fn one(&self) -> Option<usize> {
        match *self {
            Hypothesis::One(one) => Some(one),
            Hypothesis::Two(..) => None,
        }
    }

    pub fn mistakes(&self) -> Vec<&'static Mistake> {
        match *self {
            Hypothesis::One(one) => vec![mistake(one)],
            Hypothesis::Two(first, second) => vec![mistake(first), mistake(second)],
        }
    }

    pub fn name(&self) -> String {
        let names: Vec<_> = self.mistakes().iter().map(|m| m.name).collect();
        names.join(" + ")
    }

    pub fn advice(&self) -> String {
        let advice: Vec<_> = self.mistakes().iter().map(|m| m.advice).collect();
        advice.join("; and ")
    }
}
