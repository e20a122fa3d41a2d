//! How far light flies through media before it is turned.

use super::effects::Effects;
use super::majorants::Passage;
use super::media::{Matter, Media, Set, over, transmittance};
use super::segments::{MediaPath, Stretch};
use super::tracker::{Numbers, Tracker};
use super::tracking::{Chance, Collided, Tentative, delta_tracking};
use crate::geometry::{Ray, Span};
use crate::media::{self, optical_depth};
use crate::render::counters::{Event, Work};
use glam::DVec3;
use std::ops::ControlFlow;

/// A place on a ray where light is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// Distance from the origin of the ray.
    pub t: f64,
    /// By channel, what a unit of light coming from there is worth, divided by the density of
    /// the place: `σ_s T / p`.
    pub weight: DVec3,
    /// The media there.
    pub set: Set,
}

/// What became of a flight through media.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flight {
    /// It ended here.
    Collided(Collision),
    /// It reached the end of the ray. By channel, transmittance divided by the probability.
    Escaped(DVec3),
}

/// What lies behind a flight.
#[derive(Clone, Copy, Debug)]
struct Crossed {
    /// Optical depth, by channel, of what scatters and is the same everywhere.
    depth: DVec3,
    /// By channel, up to a common factor, the probability of the null collisions.
    survived: DVec3,
    /// Optical depth, by channel, of what only absorbs and is the same everywhere.
    dimmed: DVec3,
}

impl MediaPath {
    /// Samples where `ray`, along which `media` lie as this path, collides with matter that
    /// scatters. `chance` chooses the distance; `channel` is the channel by which it is chosen, by
    /// [`media::sampled_channel`] from `throughput`, what the path carries.
    ///
    /// In a chromatic medium the density is the mean of those of the three channels in that
    /// proportion, so that the channels of a path together never carry more than at its
    /// beginning. In a grey medium the weight of a collision is the albedo, and what escapes has
    /// the weight 1, both exactly, but for what only absorbs.
    #[allow(
        clippy::too_many_arguments,
        reason = "a step of an estimator, and memory to work in"
    )]
    pub fn flight<E: Effects, W: Work>(
        &self,
        media: &Media<'_>,
        ray: &Ray,
        (channel, throughput): (usize, DVec3),
        chance: &mut Numbers,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> Flight {
        let mut next = chance.tentative();
        // How deep in what is the same everywhere the flight ends.
        let mut goal = next.way;
        let mut crossed = Crossed {
            depth: DVec3::ZERO,
            survived: DVec3::ONE,
            dimmed: DVec3::ZERO,
        };
        for stretch in self.stretches() {
            // What rounding leaves below nothing is nothing.
            let rest = (goal - crossed.depth[channel]).max(0.0);
            if E::HETEROGENEOUS && media.varying_in(stretch.set)[0] != 0 {
                next.way = rest;
                let tracked = (stretch, next, channel);
                match track(media, ray, tracked, chance, &mut crossed, tracker, work) {
                    ControlFlow::Break((Collided { t, extinction }, sigma_s)) => {
                        let dimmed = self.dimmed::<E, W>(
                            media,
                            ray,
                            t,
                            crossed.dimmed + stretch.matter.dimming * (t - stretch.span.near),
                            tracker,
                            work,
                        );
                        let weight = crossed.collision::<E>(throughput, extinction);
                        return Flight::Collided(Collision {
                            t,
                            weight: weight * dimmed * quotient(sigma_s, extinction),
                            set: stretch.set,
                        });
                    }
                    ControlFlow::Continue(left) => {
                        next = left;
                        goal = crossed.depth[channel] + left.way;
                    }
                }
                crossed.dimmed += over(stretch.matter.dimming, stretch.span.length());
                continue;
            }
            let Matter {
                sigma_t,
                sigma_s,
                dimming,
                ..
            } = stretch.matter;
            let length = stretch.span.length();
            let whole = optical_depth(sigma_t[channel], length);
            if rest < whole {
                let into = rest / sigma_t[channel];
                let t = (stretch.span.near + into).min(stretch.span.far);
                let dimmed = crossed.dimmed + dimming * into;
                let dimmed = self.dimmed::<E, W>(media, ray, t, dimmed, tracker, work);
                crossed.depth += over(sigma_t, into);
                let weight = crossed.collision::<E>(throughput, sigma_t);
                return Flight::Collided(Collision {
                    t,
                    weight: weight * dimmed * quotient(sigma_s, sigma_t),
                    set: stretch.set,
                });
            }
            crossed.depth += over(sigma_t, length);
            crossed.dimmed += over(dimming, length);
        }
        let weight = if E::CHROMATIC {
            media::escape_weight(throughput, crossed.depth, crossed.survived)
        } else {
            DVec3::ONE
        };
        let end = f64::INFINITY;
        let dimmed = self.dimmed::<E, W>(media, ray, end, crossed.dimmed, tracker, work);
        Flight::Escaped(weight * dimmed)
    }

    /// The share of light, by channel, that media which only absorb let through up to distance
    /// `t`: those that are the same everywhere by their depth, the others along this path.
    fn dimmed<E: Effects, W: Work>(
        &self,
        media: &Media<'_>,
        ray: &Ray,
        t: f64,
        depth: DVec3,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        let mut share = transmittance::<E, W>(depth, work);
        if !E::HETEROGENEOUS || !media.vary() {
            return share;
        }
        for stretch in self.stretches() {
            let [_, absorbing] = media.varying_in(stretch.set);
            let span = Span {
                near: stretch.span.near,
                far: stretch.span.far.min(t),
            };
            if absorbing != 0 && span.near < span.far {
                share *= media.through::<E, W>(absorbing, ray, span, tracker, work);
            }
        }
        share
    }
}

impl Crossed {
    /// Weight, by channel, of a collision where the extinction is `sigma_t`, but for the albedo.
    fn collision<E: Effects>(&self, throughput: DVec3, sigma_t: DVec3) -> DVec3 {
        if E::CHROMATIC {
            media::collision_weight(throughput, sigma_t, self.depth, self.survived)
        } else {
            DVec3::ONE
        }
    }
}

/// Flies over a stretch on which the density varies: with what scatters there, and its scattering
/// coefficient where it collides.
fn track<W: Work>(
    media: &Media<'_>,
    ray: &Ray,
    (stretch, first, channel): (&Stretch, Tentative, usize),
    chance: &mut Numbers,
    crossed: &mut Crossed,
    tracker: &mut Tracker,
    work: &mut W,
) -> ControlFlow<(Collided, DVec3), Tentative> {
    let set = media.scattering_in(stretch.set);
    let (strands, _, effort) = tracker.parts();
    let mut passage = Passage::new(media, set, ray, stretch.span, strands);
    let survived = &mut crossed.survived;
    let before = effort.lookups;
    let end = delta_tracking(&mut passage, channel, first, chance, survived, effort);
    let real = u64::from(end.is_break());
    work.count_times(Event::NullCollision, effort.lookups - before - real);
    passage.count(work);
    match end {
        ControlFlow::Break(collided) => ControlFlow::Break((collided, passage.sigma_s())),
        ControlFlow::Continue(left) => ControlFlow::Continue(left),
    }
}

/// `a/b` by channel, 0 where both are 0.
fn quotient(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|c| {
        if a[c] == 0.0 { 0.0 } else { a[c] / b[c] }
    }))
}
