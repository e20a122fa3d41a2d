//! Depth of a pixel: the distance of what it shows.
//!
//! A volume is seen over a range of distances. With `α(t)` the opacity up to the distance `t` from the eye, the
//! *mean* depth is `∫ t dα / α(∞)`, and the *half* depth the first `t` with `α(t) ≥ ½`. A distance is measured along
//! the ray, or along the view, which is its part in the direction in which the camera looks (as in a depth buffer).
//! Where there is none, depth is infinite.

use std::fmt;
use std::str::FromStr;

/// A definition of depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Depth {
    /// The depth at which half of the light from behind is held back, in place of the mean.
    pub half: bool,
    /// The part of the distance along the view, in place of that along the ray.
    pub along_view: bool,
}

impl Depth {
    /// All definitions, by name.
    pub const ALL: [(&'static str, Depth); 4] = [
        ("mean", Depth::of(false, false)),
        ("half", Depth::of(true, false)),
        ("mean-along-view", Depth::of(false, true)),
        ("half-along-view", Depth::of(true, true)),
    ];

    /// Their names.
    pub const NAMES: [&'static str; 4] = {
        let [a, b, c, d] = Depth::ALL;
        [a.0, b.0, c.0, d.0]
    };

    const fn of(half: bool, along_view: bool) -> Depth {
        Depth { half, along_view }
    }
}

impl fmt::Display for Depth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = Depth::ALL.into_iter().find(|(_, depth)| depth == self);
        f.write_str(named.map_or("", |(name, _)| name))
    }
}

impl FromStr for Depth {
    type Err = String;

    fn from_str(text: &str) -> Result<Depth, String> {
        let named = Depth::ALL.into_iter().find(|(name, _)| *name == text);
        let depth = named.map(|(_, depth)| depth);
        depth.ok_or_else(|| format!("a depth is one of {}", Depth::NAMES.join(", ")))
    }
}
