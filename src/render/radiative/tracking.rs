//! Light through matter that differs from place to place, by random numbers and bounds.
//!
//! Where the extinction along a ray has no integral at hand, it is compared with a bound that
//! has: tentative collisions come as often as the bound `σ̄` says, and the extinction `σ ≤ σ̄` at
//! each of them tells what it was. The walk from one to the next is written once; estimators
//! differ in what they make of it. None has a bias, none has a step.
//!
//! | estimator | variance | mean look-ups |
//! |---|---|---|
//! | delta tracking | `T (1 − T)` | `∫ σ̄ e^(−τ) dt` |
//! | ratio tracking | `T² (exp ∫ σ²/σ̄ dt − 1)` | `∫ σ̄ dt` |
//! | residual ratio tracking, control `c` | the same with `σ − c` and `σ̄ − c` | `∫ (σ̄ − c) dt` |
//!
//! An extinction above its bound is a fault of the bound. It is counted, and whoever asked must
//! refuse the result: ratio tracking keeps its mean even then, delta tracking does not.
//!
//! Sources: Woodcock et al. 1965, ANL-7050, 557–579 (delta tracking); Novák, Selle & Jarosz 2014,
//! "Residual ratio tracking for estimating attenuation in participating media", ACM TOG 33(6).

use crate::geometry::Span;
use crate::math::exp;
use crate::media::optical_depth;
use glam::DVec3;
use std::ops::ControlFlow::{self, Break, Continue};

/// A stretch of a ray, and bounds on the extinction over it, by channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The stretch.
    pub span: Span,
    /// No extinction is below.
    pub low: DVec3,
    /// None is above.
    pub high: DVec3,
    /// No emission is above.
    pub glow: DVec3,
}

/// Extinction along a ray that is known by look-ups and bounds.
pub trait Bounded {
    /// The next stretch and bounds over it; stretches follow one another without gaps.
    fn next_stretch(&mut self) -> Option<Bounds>;

    /// Extinction at distance `t`, which lies on the stretch last returned, by channel.
    fn extinction(&mut self, t: f64) -> DVec3;
}

/// The random numbers of one tentative collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tentative {
    /// How much of the bound, added up along the ray, lies before it: exponentially distributed,
    /// of mean 1.
    pub way: f64,
    /// What becomes of it: uniform in [0, 1).
    pub u: f64,
}

/// A source of random numbers for tentative collisions.
pub trait Chance {
    /// Those of the next.
    fn tentative(&mut self) -> Tentative;
}

/// What a tracker had to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Look-ups of the extinction.
    pub lookups: u64,
    /// Look-ups that found more than the bound.
    pub violations: u64,
}

impl Effort {
    /// Notes a look-up on a stretch with these bounds.
    pub fn note(&mut self, bounds: &Bounds, extinction: DVec3) {
        self.lookups += 1;
        self.violations += u64::from(!extinction.cmple(bounds.high).all());
    }
}

/// Visits tentative collisions along `matter`, in order: a Poisson process of density
/// `rate(bounds)` per length, beginning with `first`. Ends where `visit` breaks, or with the
/// matter: then with what is left of the way to the next of them.
pub fn tentative_collisions<M: Bounded, B>(
    matter: &mut M,
    rate: impl Fn(&Bounds) -> f64,
    first: Tentative,
    chance: &mut impl Chance,
    mut visit: impl FnMut(&mut M, &Bounds, f64, f64) -> ControlFlow<B>,
) -> ControlFlow<B, Tentative> {
    let Tentative { mut way, mut u } = first;
    while let Some(bounds) = matter.next_stretch() {
        let rate = rate(&bounds);
        if rate == 0.0 {
            // Nothing to be found here, and nothing is looked up.
            continue;
        }
        let Span { mut near, far } = bounds.span;
        loop {
            let whole = rate * (far - near);
            if way >= whole {
                way -= whole;
                break;
            }
            near = (near + way / rate).min(far);
            visit(matter, &bounds, near, u)?;
            Tentative { way, u } = chance.tentative();
        }
    }
    Continue(Tentative { way, u })
}

/// Where a flight collided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collided {
    /// Distance along the ray.
    pub t: f64,
    /// Extinction there.
    pub extinction: DVec3,
}

/// Delta tracking: where a flight through `matter` collides, sampled by the extinction in
/// `channel`; if it does not, what is left of the way to the next tentative collision.
///
/// `survived` is multiplied, by channel, with the probability of all null collisions, had they
/// been tested in that channel, relative to the channel in which it is largest; where channels do
/// not differ, it is left alone.
pub fn delta_tracking<M: Bounded>(
    matter: &mut M,
    channel: usize,
    first: Tentative,
    chance: &mut impl Chance,
    survived: &mut DVec3,
    effort: &mut Effort,
) -> ControlFlow<Collided, Tentative> {
    let rate = |bounds: &Bounds| bounds.high.max_element();
    tentative_collisions(matter, rate, first, chance, |matter, bounds, t, u| {
        let extinction = matter.extinction(t);
        effort.note(bounds, extinction);
        // Always so for u < 1 where the extinction is the whole rate: no collision is null there.
        if u * rate(bounds) < extinction[channel] {
            return Break(Collided { t, extinction });
        }
        if extinction != DVec3::splat(extinction.x) {
            *survived *= (rate(bounds) - extinction).max(DVec3::ZERO);
            *survived /= survived.max_element();
        }
        Continue(())
    })
}

/// What ratio tracking takes for known, so that only the rest is left to chance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Nothing: plain ratio tracking.
    Nothing,
    /// The lower bound of each stretch: residual ratio tracking.
    LowerBound,
}

/// What becomes of estimates that have become small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Small {
    /// They are carried to the end.
    Kept,
    /// Most are given up, and those that are not are raised for it: noisier, and far cheaper in
    /// dense matter.
    Thinned,
}

/// Ratio tracking: an estimate of the transmittance of all of `matter`, by channel.
pub fn ratio_tracking<M: Bounded>(
    matter: &mut M,
    control: Control,
    small: Small,
    chance: &mut impl Chance,
    effort: &mut Effort,
) -> DVec3 {
    let known = |bounds: &Bounds| match control {
        Control::Nothing => DVec3::ZERO,
        Control::LowerBound => bounds.low,
    };
    let rate = |bounds: &Bounds| (bounds.high - known(bounds)).max_element();
    let mut matter = Weighed {
        matter,
        known,
        depth: DVec3::ZERO,
    };
    let mut ratio = DVec3::ONE;
    let first = chance.tentative();
    let end = tentative_collisions(&mut matter, rate, first, chance, |matter, bounds, t, u| {
        let extinction = matter.extinction(t);
        effort.note(bounds, extinction);
        ratio *= DVec3::ONE - (extinction - known(bounds)) / rate(bounds);
        match small {
            Small::Kept => Continue(()),
            Small::Thinned => thin(&mut ratio, u),
        }
    });
    match end {
        Break(()) => DVec3::ZERO,
        Continue(_) => ratio * DVec3::from_array(matter.depth.to_array().map(|depth| exp(-depth))),
    }
}

/// Estimates below this are given up with a probability. What is lost by it in noise is small
/// against that of the paths which ask; what is gained is everything behind ten optical depths.
const THIN: f64 = 0.1;

/// Gives up an estimate that has become small, with a probability that `u`, uniform in [0, 1),
/// decides, or raises it for not having been given up.
pub(in crate::render) fn thin(estimate: &mut DVec3, u: f64) -> ControlFlow<()> {
    let largest = estimate.abs().max_element();
    if largest < THIN {
        if u * THIN >= largest {
            return Break(());
        }
        *estimate *= THIN / largest;
    }
    Continue(())
}

/// Adds up what is known of the stretches passed.
struct Weighed<'m, M, K> {
    matter: &'m mut M,
    known: K,
    depth: DVec3,
}

impl<M: Bounded, K: Fn(&Bounds) -> DVec3> Bounded for Weighed<'_, M, K> {
    fn next_stretch(&mut self) -> Option<Bounds> {
        let bounds = self.matter.next_stretch()?;
        let known = (self.known)(&bounds);
        if known != DVec3::ZERO {
            let length = bounds.span.length();
            let depth = known.to_array().map(|known| optical_depth(known, length));
            self.depth += DVec3::from_array(depth);
        }
        Some(bounds)
    }

    fn extinction(&mut self, t: f64) -> DVec3 {
        self.matter.extinction(t)
    }
}
