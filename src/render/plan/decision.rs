//! The decision about each effect, and the key of the scene behind it.

use super::{Effect, State};
use crate::scene::KeyLines;
use serde::Serialize;
use std::fmt;

/// The decision about one effect.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Decision {
    /// The effect.
    pub effect: Effect,
    /// Whether it is simulated.
    pub state: State,
    /// Whether it is simulated only because it was forced: it is provably null.
    pub forced: bool,
    /// The reason.
    #[serde(flatten)]
    pub why: Reason,
}

/// A reason, with the key of the scene behind it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Reason {
    /// In words.
    pub reason: String,
    /// The key of the scene behind it, if any, such as `radiative.medium[0].g`.
    pub field: Option<String>,
    /// The line of that key in the scene file; `None` if the file leaves it out.
    pub line: Option<usize>,
}

impl Reason {
    /// `reason`, because of the key `field`.
    pub(super) fn of(
        field: impl Into<String>,
        reason: impl Into<String>,
        key_lines: &KeyLines,
    ) -> Reason {
        let field = field.into();
        Reason {
            reason: reason.into(),
            line: key_lines.line(&field),
            field: Some(field),
        }
    }

    /// `reason`, independent of any key.
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

/// The finding on one effect in a scene.
pub(super) enum EffectFinding {
    /// The model does not have it.
    Absent(&'static str),
    /// Possible under this key, but not asked for.
    NotAsked(&'static str),
    /// Present, but left out by this key, for this reason.
    LeftOut(String, String),
    /// Asked for under this key, and it matters.
    Matters(String, String),
    /// Asked for under this key, but provably null.
    Null(String, String),
}

impl EffectFinding {
    pub fn left_out(key: impl Into<String>, reason: impl Into<String>) -> EffectFinding {
        EffectFinding::LeftOut(key.into(), reason.into())
    }

    pub fn matters(key: impl Into<String>, reason: impl Into<String>) -> EffectFinding {
        EffectFinding::Matters(key.into(), reason.into())
    }

    pub fn null(key: impl Into<String>, reason: impl Into<String>) -> EffectFinding {
        EffectFinding::Null(key.into(), reason.into())
    }
}

/// The finding on an effect, by the first row of a table that names it and holds.
macro_rules! findings {
    ($effect:expr; $($($of:ident)|+ $(if $holds:expr)? => $finding:ident($($words:expr),+);)+) => {
        match $effect { $($(Effect::$of)|+ $(if $holds)? => EffectFinding::$finding($($words),+),)+ }
    };
}
pub(super) use findings;

/// Reasons of those warnings whose keys the file states.
pub(super) fn stated(
    warnings: impl IntoIterator<Item = (String, String)>,
    key_lines: &KeyLines,
) -> impl Iterator<Item = Reason> {
    let stated = warnings.into_iter().filter(|(key, _)| key_lines.has(key));
    stated.map(|(key, message)| Reason::of(key, message, key_lines))
}

/// A decision for each effect.
pub(super) struct Decisions(pub Vec<Decision>);

impl Decisions {
    /// The decisions that follow from `finding`; effects in `forced` are simulated although they
    /// are null.
    pub fn new(
        finding: impl Fn(Effect) -> EffectFinding,
        forced: &[Effect],
        key_lines: &KeyLines,
    ) -> Decisions {
        let decide = |effect| {
            let finding = finding(effect);
            let forced = forced.contains(&effect) && matches!(finding, EffectFinding::Null(..));
            let (state, why) = decide(finding, forced, key_lines);
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

fn decide(finding: EffectFinding, forced: bool, key_lines: &KeyLines) -> (State, Reason) {
    match finding {
        EffectFinding::Absent(reason) => (State::Elided, Reason::always(reason)),
        EffectFinding::NotAsked(field) => {
            let reason = format!("not requested: the scene has no [{field}]");
            (State::Omitted, Reason::of(field, reason, key_lines))
        }
        EffectFinding::LeftOut(field, reason) => {
            (State::Omitted, Reason::of(field, reason, key_lines))
        }
        EffectFinding::Matters(field, reason) => (State::On, Reason::of(field, reason, key_lines)),
        EffectFinding::Null(field, reason) if forced => {
            let reason = format!("forced, although it makes no difference: {reason}");
            (State::On, Reason::of(field, reason, key_lines))
        }
        EffectFinding::Null(field, reason) => (State::Elided, Reason::of(field, reason, key_lines)),
    }
}
