//! Tracking: estimators of free flights and transmittances through heterogeneous media.
//!
//! If the extinction along a ray has no known integral, it is compared with a majorant that has
//! one: tentative collisions have the density of the majorant `σ̄`, and the extinction `σ ≤ σ̄` at
//! each of them decides its outcome. The walk from one to the next is written once; estimators
//! differ in their response. None has a bias or a step size.
//!
//! | estimator | variance | mean lookups |
//! |---|---|---|
//! | delta tracking | `T (1 − T)` | `∫ σ̄ e^(−τ) dt` |
//! | ratio tracking | `T² (exp ∫ σ²/σ̄ dt − 1)` | `∫ σ̄ dt` |
//! | residual ratio tracking, control `c` | the same with `σ − c` and `σ̄ − c` | `∫ (σ̄ − c) dt` |
//!
//! An extinction above its majorant is a fault of the majorant. It is counted, and the caller must
//! refuse the result: ratio tracking keeps its mean even then, delta tracking does not.
//!
//! Sources: Woodcock et al. 1965, ANL-7050, 557–579 (delta tracking); Novák, Selle & Jarosz 2014,
//! "Residual ratio tracking for estimating attenuation in participating media", ACM TOG 33(6).

use crate::geometry::Span;
use crate::optics::{optical_depth, transmittance};
use glam::DVec3;
use std::ops::ControlFlow::{self, Break, Continue};

/// Bounds on the extinction, by channel, over a segment of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MajorantSegment {
    /// The segment.
    pub span: Span,
    /// Lower bound on the extinction.
    pub minorant: DVec3,
    /// Upper bound on the extinction.
    pub majorant: DVec3,
    /// Upper bound on the emission.
    pub emission: DVec3,
}

/// Extinction along a ray, known by lookups and majorants. Segments follow one another without
/// gaps.
pub trait Majorants: Iterator<Item = MajorantSegment> {
    /// Extinction at distance `t`, which lies on the segment last returned, by channel.
    fn extinction(&mut self, t: f64) -> DVec3;
}

/// The random numbers of one tentative collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tentative {
    /// Optical distance of the majorant from the one before: exponentially distributed, of mean 1.
    pub optical_distance: f64,
    /// Uniform in [0, 1): decides between a real and a null collision.
    pub u: f64,
}

/// A source of random numbers for tentative collisions.
pub trait TentativeNumbers {
    /// The numbers of the next tentative collision.
    fn next(&mut self) -> Tentative;
}

/// Lookups that a tracker has made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Lookups of the extinction.
    pub lookups: u64,
    /// Lookups above the majorant.
    pub violations: u64,
}

/// Visits tentative collisions along `majorants`, in order: a Poisson process of density
/// `rate(segment)` per length, beginning with `first`. Ends where `visit` breaks, or with the
/// last segment: then with the rest of the optical distance to the next of them.
pub(crate) fn tentative_collisions<M: Majorants, B>(
    majorants: &mut M,
    rate: impl Fn(&MajorantSegment) -> f64,
    first: Tentative,
    numbers: &mut impl TentativeNumbers,
    effort: &mut Effort,
    mut visit: impl FnMut(&M, &MajorantSegment, RealCollision, f64) -> ControlFlow<B>,
) -> ControlFlow<B, Tentative> {
    let Tentative {
        mut optical_distance,
        mut u,
    } = first;
    while let Some(segment) = majorants.next() {
        let rate = rate(&segment);
        if rate == 0.0 {
            // No collision here, and nothing is looked up.
            continue;
        }
        let Span { mut near, far } = segment.span;
        loop {
            let whole = rate * (far - near);
            if optical_distance >= whole {
                optical_distance -= whole;
                break;
            }
            near = (near + optical_distance / rate).min(far);
            let extinction = majorants.extinction(near);
            effort.lookups += 1;
            effort.violations += u64::from(!extinction.cmple(segment.majorant).all());
            let t = near;
            visit(majorants, &segment, RealCollision { t, extinction }, u)?;
            Tentative {
                optical_distance,
                u,
            } = numbers.next();
        }
    }
    Continue(Tentative {
        optical_distance,
        u,
    })
}

/// A real collision of delta tracking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RealCollision {
    /// Distance along the ray.
    pub t: f64,
    /// Extinction there, by channel.
    pub extinction: DVec3,
}

/// Delta tracking: the collision of a flight along `majorants`, sampled by the extinction in
/// `channel`; without one, the rest of the optical distance to the next tentative collision.
///
/// `survived` is multiplied, by channel, with the probability of all null collisions, had they
/// been tested in that channel, relative to the channel in which it is largest; where channels do
/// not differ, it is left alone.
pub fn delta_tracking<M: Majorants>(
    majorants: &mut M,
    channel: usize,
    first: Tentative,
    numbers: &mut impl TentativeNumbers,
    survived: &mut DVec3,
    effort: &mut Effort,
) -> ControlFlow<RealCollision, Tentative> {
    let rate = |segment: &MajorantSegment| segment.majorant.max_element();
    let visit = |_: &M, segment: &MajorantSegment, collision: RealCollision, u: f64| {
        let extinction = collision.extinction;
        // Always so for u < 1 where the extinction is the whole rate: no collision is null there.
        if u * rate(segment) < extinction[channel] {
            return Break(collision);
        }
        if extinction != DVec3::splat(extinction.x) {
            *survived *= (rate(segment) - extinction).max(DVec3::ZERO);
            *survived /= survived.max_element();
        }
        Continue(())
    };
    tentative_collisions(majorants, rate, first, numbers, effort, visit)
}

/// The control variate of ratio tracking: the extinction integrated in closed form, so that only
/// the residual is left to chance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// None: plain ratio tracking.
    None,
    /// The minorant of each segment: residual ratio tracking.
    Minorant,
}

/// Treatment of estimates that have become small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Small {
    /// They are carried to the end.
    Kept,
    /// Russian roulette: noisier, and far cheaper in dense media.
    Roulette,
}

/// Ratio tracking: an estimate of the transmittance along all of `majorants`, by channel.
pub fn ratio_tracking<M: Majorants>(
    majorants: &mut M,
    control: Control,
    small: Small,
    numbers: &mut impl TentativeNumbers,
    effort: &mut Effort,
) -> DVec3 {
    let known = |segment: &MajorantSegment| match control {
        Control::None => DVec3::ZERO,
        Control::Minorant => segment.minorant,
    };
    let rate = |segment: &MajorantSegment| (segment.majorant - known(segment)).max_element();
    let mut controlled = Controlled {
        majorants,
        known,
        depth: DVec3::ZERO,
    };
    let mut ratio = DVec3::ONE;
    let first = numbers.next();
    let end = tentative_collisions(
        &mut controlled,
        rate,
        first,
        numbers,
        effort,
        |_, segment, RealCollision { extinction, .. }, u| {
            ratio *= DVec3::ONE - (extinction - known(segment)) / rate(segment);
            match small {
                Small::Kept => Continue(()),
                Small::Roulette => thin(&mut ratio, u),
            }
        },
    );
    match end {
        Break(()) => DVec3::ZERO,
        Continue(_) => ratio * DVec3::from_array(controlled.depth.to_array().map(transmittance)),
    }
}

/// Threshold of the roulette on estimates. Its noise is small compared with that of the paths; it
/// saves all work beyond ten optical depths.
const THIN: f64 = 0.1;

/// Russian roulette on a small estimate: `u`, uniform in [0, 1), ends it, or raises it to the
/// threshold.
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

/// Adds up the depth of the control along the segments passed.
struct Controlled<'m, M, K> {
    majorants: &'m mut M,
    known: K,
    depth: DVec3,
}

impl<M: Majorants, K: Fn(&MajorantSegment) -> DVec3> Iterator for Controlled<'_, M, K> {
    type Item = MajorantSegment;

    fn next(&mut self) -> Option<MajorantSegment> {
        let segment = self.majorants.next()?;
        let known = (self.known)(&segment);
        if known != DVec3::ZERO {
            let length = segment.span.length();
            let depth = known.to_array().map(|known| optical_depth(known, length));
            self.depth += DVec3::from_array(depth);
        }
        Some(segment)
    }
}

impl<M: Majorants, K: Fn(&MajorantSegment) -> DVec3> Majorants for Controlled<'_, M, K> {
    fn extinction(&mut self, t: f64) -> DVec3 {
        self.majorants.extinction(t)
    }
}
