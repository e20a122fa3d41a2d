//! The matter along a ray: stretches within which nothing changes.
//!
//! Boundaries of media do not turn light here (their refractive index is that of what surrounds
//! them), so a straight path crosses them all. It is cut where any medium begins or ends; in
//! between, coefficients and emissions of the media that overlap add up. Nothing is remembered
//! from one ray to the next: where a ray begins decides what it begins in, so no count of
//! crossings can go wrong.

use super::effects::Effects;
use crate::geometry::{Aabb, Boundary, Ray, Solid, Span, Surface};
use crate::math::{exp, ln_1p};
use crate::media::{self, HenyeyGreenstein, emission, optical_depth};
use crate::scene::Body;
use glam::DVec3;

/// What a stretch is made of, per world length and channel.
///
/// A medium that only absorbs dims light in closed form and is never sampled: its extinction is
/// kept apart from that of the media that scatter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Matter {
    /// Extinction of the media that scatter.
    pub sigma_t: DVec3,
    /// Scattering.
    pub sigma_s: DVec3,
    /// Extinction of the media that do not scatter.
    pub dimming: DVec3,
    /// Emitted radiance per length.
    pub emission: DVec3,
}

impl Matter {
    fn of(body: &Body) -> Matter {
        let coefficients = body.medium.coefficients;
        let (sigma_t, sigma_s) = (coefficients.sigma_t(), coefficients.sigma_s());
        let scatters = sigma_s != DVec3::ZERO;
        Matter {
            sigma_t: if scatters { sigma_t } else { DVec3::ZERO },
            sigma_s,
            dimming: if scatters { DVec3::ZERO } else { sigma_t },
            emission: body.medium.emission,
        }
    }

    fn add(&mut self, other: &Matter) {
        self.sigma_t += other.sigma_t;
        self.sigma_s += other.sigma_s;
        self.dimming += other.dimming;
        self.emission += other.emission;
    }

    /// Whether light is turned here.
    pub fn scatters(&self) -> bool {
        self.sigma_s != DVec3::ZERO
    }
}

/// The media of a scene, ready to be laid along rays.
#[derive(Debug)]
pub struct Media<'s> {
    bodies: Vec<Medium<'s>>,
    /// Where light is scattered at all.
    scattering: Reach,
}

/// How far something reaches.
#[derive(Debug)]
enum Reach {
    Nowhere,
    Within(Aabb),
    Everywhere,
}

#[derive(Debug)]
struct Medium<'s> {
    boundary: Option<&'s Boundary>,
    matter: Matter,
    phase: HenyeyGreenstein,
}

/// A set of media: a bit for each.
pub type Set = u64;

impl<'s> Media<'s> {
    /// The media of `bodies`. With `all`, also those of no matter, which change nothing.
    pub fn new(bodies: &'s [Body], all: bool) -> Media<'s> {
        let medium = |body: &'s Body| Medium {
            boundary: body.boundary.as_ref(),
            matter: Matter::of(body),
            phase: body.medium.phase,
        };
        let mut bodies: Vec<_> = bodies.iter().map(medium).collect();
        bodies.retain(|body| all || body.matter != Matter::default());
        let mut scattering = Reach::Nowhere;
        for body in bodies.iter().filter(|body| body.matter.scatters()) {
            let bounds = body.boundary.map(Surface::bounds);
            scattering = match (scattering, bounds) {
                (Reach::Nowhere, Some(bounds)) => Reach::Within(bounds),
                (Reach::Within(others), Some(bounds)) => Reach::Within(others.union(bounds)),
                (Reach::Everywhere, _) | (_, None) => Reach::Everywhere,
            };
        }
        Media { bodies, scattering }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.bodies.len()
    }

    /// A stretch of `ray` that holds all places where light is scattered, if there are any.
    pub fn scattering_span(&self, ray: &Ray) -> Option<Span> {
        match &self.scattering {
            Reach::Nowhere => None,
            Reach::Within(bounds) => bounds.span(ray).filter(|span| span.near < span.far),
            Reach::Everywhere => Some(Span {
                near: 0.0,
                far: f64::INFINITY,
            }),
        }
    }

    /// What the media in `set` are together.
    fn matter(&self, set: Set) -> Matter {
        let mut matter = Matter::default();
        for index in members(set) {
            matter.add(&self.bodies[index].matter);
        }
        matter
    }

    /// Scattering coefficient and phase function of each medium in `set` that scatters.
    pub fn scatterers(&self, set: Set) -> impl Iterator<Item = (DVec3, HenyeyGreenstein)> {
        members(set)
            .map(|index| (self.bodies[index].matter.sigma_s, self.bodies[index].phase))
            .filter(|(sigma_s, _)| *sigma_s != DVec3::ZERO)
    }

    /// Optical depth by channel from the origin of `ray` to distance `end`.
    pub fn depth(&self, ray: &Ray, end: f64, spans: &mut Vec<Span>) -> DVec3 {
        let mut depth = DVec3::ZERO;
        for body in &self.bodies {
            let length = match body.boundary {
                None => end,
                Some(boundary) => {
                    spans.clear();
                    boundary.append_spans(ray, spans);
                    spans
                        .iter()
                        .map(|span| (span.far.min(end) - span.near).max(0.0))
                        .sum()
                }
            };
            depth += over(body.matter.sigma_t + body.matter.dimming, length);
        }
        depth
    }
}

/// `σ·t` by channel, where nothing over any length is nothing.
fn over(sigma: DVec3, length: f64) -> DVec3 {
    DVec3::from_array(sigma.to_array().map(|sigma| optical_depth(sigma, length)))
}

fn members(set: Set) -> impl Iterator<Item = usize> {
    let mut left = set;
    std::iter::from_fn(move || {
        let index = left.trailing_zeros();
        left &= left.wrapping_sub(1);
        (index < Set::BITS).then_some(index as usize)
    })
}

/// A stretch of a ray through the same matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// From where to where, in world units from the origin of the ray.
    pub span: Span,
    /// Its matter.
    pub matter: Matter,
    /// The media there.
    pub set: Set,
}

/// Optical depths by channel from the origin of a ray to a place on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Depths {
    /// Of the media that scatter.
    pub scattering: DVec3,
    /// Of those that only absorb.
    pub dimming: DVec3,
}

impl Depths {
    /// Of everything.
    pub fn all(&self) -> DVec3 {
        self.scattering + self.dimming
    }
}

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

/// The media along one ray, in order; memory is kept from ray to ray.
#[derive(Debug, Default)]
pub struct MediaPath {
    stretches: Vec<Stretch>,
    edges: Vec<Edge>,
    spans: Vec<Span>,
}

/// Where a medium begins or ends.
#[derive(Clone, Copy, Debug)]
struct Edge {
    t: f64,
    medium: usize,
}

impl MediaPath {
    /// Lays `media` along `ray`, from its origin to `end`, which may be infinite.
    pub fn lay(&mut self, media: &Media<'_>, ray: &Ray, end: f64) {
        self.edges.clear();
        self.stretches.clear();
        for (medium, body) in media.bodies.iter().enumerate() {
            self.spans.clear();
            match body.boundary {
                None => self.spans.push(Span {
                    near: 0.0,
                    far: end,
                }),
                Some(boundary) => boundary.append_spans(ray, &mut self.spans),
            }
            if body.matter == Matter::default() {
                // Nothing begins here: a cut would round the depths of what goes on.
                continue;
            }
            for span in &self.spans {
                let far = span.far.min(end);
                if span.near < far {
                    self.edges.push(Edge {
                        t: span.near,
                        medium,
                    });
                    self.edges.push(Edge { t: far, medium });
                }
            }
        }
        self.edges
            .sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.medium.cmp(&b.medium)));
        let (mut set, mut near) = (0, 0.0);
        for &Edge { t, medium } in &self.edges {
            if set != 0 && near < t {
                self.stretches.push(Stretch {
                    span: Span { near, far: t },
                    matter: media.matter(set),
                    set,
                });
            }
            // A medium whose stretches touch ends and begins at one place: twice is not at all.
            set ^= 1 << medium;
            near = t;
        }
    }

    /// The stretches, in order.
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// Optical depth by channel over the whole ray.
    pub fn depth(&self) -> DVec3 {
        self.stretches.iter().map(Stretch::depth).sum()
    }

    /// Optical depths by channel up to distance `t`, and the stretch there, if there is matter.
    pub fn depths_to(&self, t: f64) -> (Depths, Option<&Stretch>) {
        let mut depths = Depths::default();
        for stretch in &self.stretches {
            if t < stretch.span.near {
                break;
            }
            let inside = t < stretch.span.far;
            let length = if inside { t } else { stretch.span.far } - stretch.span.near;
            depths.scattering += over(stretch.matter.sigma_t, length);
            depths.dimming += over(stretch.matter.dimming, length);
            if inside {
                return (depths, Some(stretch));
            }
        }
        (depths, None)
    }

    /// Where the depth of the media that scatter, in one channel, reaches `goal`; the end of the
    /// last of them where it does not.
    pub fn place_at(&self, goal: f64, channel: usize) -> f64 {
        let (mut depth, mut last) = (0.0, 0.0);
        for stretch in self.stretches.iter().filter(|s| s.matter.scatters()) {
            let sigma_t = stretch.matter.sigma_t[channel];
            let Span { near, far } = stretch.span;
            let whole = optical_depth(sigma_t, far - near);
            let rest = (goal - depth).max(0.0);
            if rest < whole {
                return (near + rest / sigma_t).min(far);
            }
            depth += whole;
            last = far;
        }
        last
    }

    /// From where the first medium that scatters begins to where the last ends.
    pub fn scattering_span(&self) -> Option<Span> {
        let mut scattering = self.stretches.iter().filter(|s| s.matter.scatters());
        let first = scattering.next()?.span;
        let last = scattering.next_back().map_or(first, |stretch| stretch.span);
        Some(Span {
            near: first.near,
            far: last.far,
        })
    }

    /// Radiance that the media send back along the ray.
    pub fn emitted<E: Effects>(&self) -> DVec3 {
        let (mut radiance, mut depth) = (DVec3::ZERO, DVec3::ZERO);
        for stretch in &self.stretches {
            let (_, all) = stretch.extinctions();
            let length = stretch.span.length();
            let sent = DVec3::from_array(std::array::from_fn(|c| {
                emission::constant_emission(stretch.matter.emission[c], all[c], length)
            }));
            radiance += transmittance::<E>(depth) * sent;
            depth += stretch.depth();
        }
        radiance
    }

    /// Samples where a ray collides with matter that scatters. `u` chooses the distance, uniform
    /// in [0, 1); `channel` the channel by which it is chosen, by [`media::sampled_channel`] from
    /// `throughput`, what the path carries.
    ///
    /// In a chromatic medium the density is the mean of those of the three channels in that
    /// proportion, so that the channels of a path together never carry more than at its
    /// beginning. In a grey medium the weight of a collision is the albedo, and what escapes has
    /// the weight 1, both exactly, but for what only absorbs.
    pub fn flight<E: Effects>(&self, u: f64, channel: usize, throughput: DVec3) -> Flight {
        let goal = -ln_1p(-u);
        let (mut scattered, mut dimmed) = (DVec3::ZERO, DVec3::ZERO);
        for stretch in &self.stretches {
            let Matter {
                sigma_t,
                sigma_s,
                dimming,
                ..
            } = stretch.matter;
            // What rounding leaves below nothing is nothing.
            let rest = (goal - scattered[channel]).max(0.0);
            let length = stretch.span.length();
            let whole = optical_depth(sigma_t[channel], length);
            if rest < whole {
                let into = rest / sigma_t[channel];
                let dimmed = transmittance::<E>(dimmed + dimming * into);
                let weight = if E::CHROMATIC {
                    let depth = scattered + over(sigma_t, into);
                    media::collision_weight(throughput, sigma_t, depth)
                } else {
                    DVec3::ONE
                };
                return Flight::Collided(Collision {
                    t: (stretch.span.near + into).min(stretch.span.far),
                    weight: weight * dimmed * quotient(sigma_s, sigma_t),
                    set: stretch.set,
                });
            }
            scattered += over(sigma_t, length);
            dimmed += over(dimming, length);
        }
        let weight = if E::CHROMATIC {
            media::escape_weight(throughput, scattered)
        } else {
            DVec3::ONE
        };
        Flight::Escaped(weight * transmittance::<E>(dimmed))
    }
}

impl Stretch {
    /// Extinction of what scatters, and of everything.
    fn extinctions(&self) -> (DVec3, DVec3) {
        (
            self.matter.sigma_t,
            self.matter.sigma_t + self.matter.dimming,
        )
    }

    fn depth(&self) -> DVec3 {
        let (_, all) = self.extinctions();
        over(all, self.span.length())
    }
}

/// `e^(−τ)` by channel; one exponential where all channels are the same.
pub fn transmittance<E: Effects>(depth: DVec3) -> DVec3 {
    if E::CHROMATIC {
        DVec3::from_array(depth.to_array().map(|depth| exp(-depth)))
    } else {
        DVec3::splat(exp(-depth.x))
    }
}

/// `a/b` by channel, 0 where both are 0.
fn quotient(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|c| {
        if a[c] == 0.0 { 0.0 } else { a[c] / b[c] }
    }))
}
