//! What is decided about each effect, and the place in the scene that decides it.

use super::{Effect, State};
use crate::scene::Places;
use serde::Serialize;
use std::fmt;

/// The decision about one effect.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Decision {
    /// Which effect.
    pub effect: Effect,
    /// Whether it is simulated.
    pub state: State,
    /// Whether it is simulated only because it was forced: it is provably null.
    pub forced: bool,
    /// Why.
    #[serde(flatten)]
    pub why: Reason,
}

/// Why something is as it is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Reason {
    /// In words.
    pub reason: String,
    /// The key of the scene behind it, where there is one, such as `radiative.medium[0].g`.
    pub field: Option<String>,
    /// The line of the scene file on which that key stands; none where the file leaves it out.
    pub line: Option<usize>,
}

impl Reason {
    /// `reason`, because of the key `field`.
    pub(super) fn of(
        field: impl Into<String>,
        reason: impl Into<String>,
        places: &Places,
    ) -> Reason {
        let field = field.into();
        Reason {
            reason: reason.into(),
            line: places.line(&field),
            field: Some(field),
        }
    }

    /// `reason`, whatever the scene says.
    pub(super) fn always(reason: impl Into<String>) -> Reason {
        Reason {
            reason: reason.into(),
            field: None,
            line: None,
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)?;
        match (&self.field, self.line) {
            (None, _) => Ok(()),
            (Some(field), Some(line)) => write!(f, "  ({field}, line {line})"),
            (Some(field), None) => write!(f, "  ({field}, left out)"),
        }
    }
}

/// What is known about one effect of a scene.
pub(super) enum Finding {
    /// The model has no such thing.
    Absent(&'static str),
    /// It could be asked for, under this key, and is not.
    NotAsked(&'static str),
    /// It is there, but this key leaves it out, for this reason.
    LeftOut(String, String),
    /// Asked for under this key, and it matters.
    Matters(String, String),
    /// Asked for under this key, but provably null.
    Null(String, String),
}

/// A decision for each effect.
pub(super) struct Decisions(pub Vec<Decision>);

impl Decisions {
    /// What follows from what is known about each effect, with those in `forced` simulated
    /// although they are null.
    pub fn new(
        finding: impl Fn(Effect) -> Finding,
        forced: &[Effect],
        places: &Places,
    ) -> Decisions {
        let decide = |effect| {
            let finding = finding(effect);
            let forced = forced.contains(&effect) && matches!(finding, Finding::Null(..));
            let (state, why) = decide(finding, forced, places);
            Decision {
                effect,
                state,
                forced,
                why,
            }
        };
        Decisions(Effect::ALL.into_iter().map(decide).collect())
    }

    /// The decision about an effect.
    pub fn of(&self, effect: Effect) -> &Decision {
        let mut decisions = self.0.iter();
        let decision = decisions.find(|decision| decision.effect == effect);
        decision.expect("a decision for each effect")
    }

    pub fn is_on(&self, effect: Effect) -> bool {
        self.of(effect).state == State::On
    }
}

fn decide(finding: Finding, forced: bool, places: &Places) -> (State, Reason) {
    match finding {
        Finding::Absent(reason) => (State::Elided, Reason::always(reason)),
        Finding::NotAsked(field) => {
            let reason = format!("not asked for: the scene has no [{field}]");
            (State::Omitted, Reason::of(field, reason, places))
        }
        Finding::LeftOut(field, reason) => (State::Omitted, Reason::of(field, reason, places)),
        Finding::Matters(field, reason) => (State::On, Reason::of(field, reason, places)),
        Finding::Null(field, reason) if forced => {
            let reason = format!("forced, although null: {reason}");
            (State::On, Reason::of(field, reason, places))
        }
        Finding::Null(field, reason) => (State::Elided, Reason::of(field, reason, places)),
    }
}
