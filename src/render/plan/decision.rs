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
    /// The reason in words.
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

/// The finding on one effect in a scene: whether it is simulated, the key behind that, and the reason.
pub(super) struct EffectFinding(State, Option<String>, String);

impl EffectFinding {
    /// The model does not have it.
    pub fn absent(reason: &str) -> EffectFinding {
        EffectFinding(State::Elided, None, reason.to_owned())
    }

    /// Possible under this key, but not asked for.
    pub fn not_asked(key: &str) -> EffectFinding {
        EffectFinding::left_out(key, format!("not requested: the scene has no [{key}]"))
    }

    /// Present, but left out by this key.
    pub fn left_out(key: impl Into<String>, reason: impl Into<String>) -> EffectFinding {
        EffectFinding(State::Omitted, Some(key.into()), reason.into())
    }

    /// Asked for under this key, and it matters.
    pub fn matters(key: impl Into<String>, reason: impl Into<String>) -> EffectFinding {
        EffectFinding(State::On, Some(key.into()), reason.into())
    }

    /// Asked for under this key, but provably null.
    pub fn null(key: impl Into<String>, reason: impl Into<String>) -> EffectFinding {
        EffectFinding(State::Elided, Some(key.into()), reason.into())
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
            let EffectFinding(mut state, field, mut reason) = finding(effect);
            let is_null = state == State::Elided && field.is_some();
            let forced = is_null && forced.contains(&effect);
            if forced {
                state = State::On;
                reason = format!("forced, although it makes no difference: {reason}");
            }
            let line = field.as_ref().and_then(|field| key_lines.line(field));
            let why = Reason {
                reason,
                field,
                line,
            };
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
