//! Single scattering of a positioned light along a ray: equiangular sampling.
//!
//! Near the light the irradiance grows with the inverse squared distance, and a path that collides
//! near it by chance carries that factor: its variance is unbounded. So a point of the ray is
//! sampled for the light instead: by equal angles seen from it, which cancels the factor, or by
//! free flight, which suits dense media, with equal probability; the sample is weighted by the mean
//! of both densities.
//!
//! Source: Kulla & Fajardo 2012, "Importance sampling techniques for path tracing in
//! participating media", Computer Graphics Forum 31, 1519–1528.

use super::media::Set;
use super::scene_context::{PositionedLight, SceneContext};
use super::segments::{MediumSegment, MediumSegments, OpticalDepths};
use super::tracker::Tracker;
use super::transmittance::Transmittance;
use super::vertex::Vertex;
use crate::geometry::{Direction, Ray, Span};
use crate::math::sampling::{
    Equiangular, LightOnRay, truncated_free_flight_pdf, truncated_optical_distance,
};
use crate::optics::{Light, Spot, opacity};
use glam::DVec3;

/// The span of `ray` on which `light` shines on media that scatter, if there is one.
pub fn lit_span(segments: &MediumSegments, ray: &Ray, light: &Light) -> Option<Span> {
    let scattering = segments.scattering_span()?;
    let lit = match light {
        Light::Spot(spot) => within_cone(spot, ray, scattering)?,
        Light::Point(_) | Light::Directional(_) => scattering,
    };
    (lit.near < lit.far).then_some(lit)
}

/// Bound on the error of a root of the cone, relative to the lengths that it is made of.
///
/// The discriminant `B² − AC` is off by 8 roundings of its terms, the root by that over `2√(B² − AC)`:
/// by less than 1e-9 where the discriminant is more than 2e-13 of its terms. Where it is less, the
/// ray touches the cone, and less than 1e-6 of the lengths is lit.
const MARGIN: f64 = 1e-9;

/// The part of `span` in the cone of a spotlight, or a little more than it.
///
/// The cone is convex up to a half-angle of 90°, so the part is one piece. Its ends are roots of
/// `(v·a)² = c² v²`, with `v` from the light to the ray, `a` the axis and `c` the cosine; it is
/// whatever lies between those roots and is lit.
fn within_cone(spot: &Spot, ray: &Ray, span: Span) -> Option<Span> {
    if spot.cos_outer <= 0.0 {
        return Some(span);
    }
    let cone = ConeRoots::new(spot, ray);
    // A root that is no number lies beyond every end.
    let within_span = |root: f64| match root.is_nan() {
        true => span.far,
        false => root.clamp(span.near, span.far),
    };
    let [a, b] = cone.roots.unwrap_or([span.near; 2]).map(within_span);
    let mut ends = [span.near, a, b, span.far];
    ends.sort_unstable_by(f64::total_cmp);
    let is_lit = |&[near, far]: &[f64; 2]| {
        let middle = if far.is_finite() {
            near + 0.5 * (far - near)
        } else {
            2.0 * near.abs() + cone.foot.abs() + cone.distance
        };
        near < far && shines_on(spot, ray, middle)
    };
    let pieces = ends.windows(2).map(|ends| [ends[0], ends[1]]);
    let mut inside = pieces.filter(is_lit);
    let first = inside.next()?;
    let last = inside.next_back().unwrap_or(first);
    // A little wider than the roots: what is not lit in there counts as dark.
    let margin = cone.margin(first[0]);
    Some(Span::new(
        (first[0] - margin).max(span.near),
        (last[1] + margin).min(span.far),
    ))
}

/// Distances at which the light on `ray` begins or ends at the edge of the cone of `light`, to the
/// last place.
///
/// An integral has to be split there. A quadrature rule over light and a sliver of dark beside it
/// misses the dark: its outermost point lies half a hundredth of the way inside.
pub fn edges(light: &Light, ray: &Ray) -> Vec<f64> {
    let Light::Spot(spot) = light else {
        return vec![];
    };
    let cone = ConeRoots::new(spot, ray);
    let Some([a, b]) = cone.roots else {
        return vec![];
    };
    let [first, last] = [a.min(b), a.max(b)];
    // A root that is no number leaves the other alone.
    let middle = if first.is_finite() && last.is_finite() {
        first + 0.5 * (last - first)
    } else {
        f64::NAN
    };
    // Each stays on its side of the other.
    let [to_first, to_last] = [first, last].map(|root| cone.margin(root));
    let brackets = [
        [first - to_first, (first + to_first).min(middle)],
        [(last - to_last).max(middle), last + to_last],
    ];
    let edges = brackets.into_iter().filter_map(|[mut from, mut to]| {
        let before = shines_on(spot, ray, from);
        let is_bracket = from < to;
        // If light does not change in between, the ray only touches the cone.
        if !is_bracket || before == shines_on(spot, ray, to) {
            return None;
        }
        loop {
            let middle = from + 0.5 * (to - from);
            if !(from < middle && middle < to) {
                return Some(to);
            }
            if shines_on(spot, ray, middle) == before {
                from = middle;
            } else {
                to = middle;
            }
        }
    });
    edges.collect()
}

/// `spot` shines on the point at distance `t`, without occlusion.
fn shines_on(spot: &Spot, ray: &Ray, t: f64) -> bool {
    // At the light itself the ray leaves it along its direction.
    let towards = Direction::of(ray.at(t) - spot.position).unwrap_or(ray.direction);
    spot.falloff(towards) > 0.0
}

/// Intersections of a line with the cone of a spotlight, or its mirror image on the other side.
struct ConeRoots {
    /// Distances from the origin of the ray, in no order; numbers only where there are two. `None`
    /// where the line misses.
    roots: Option<[f64; 2]>,
    /// Distance of the foot of the perpendicular from the light.
    foot: f64,
    /// Length of that perpendicular.
    distance: f64,
}

impl ConeRoots {
    fn new(spot: &Spot, ray: &Ray) -> ConeRoots {
        let c = spot.cos_outer;
        // Both measured from the foot of the perpendicular from the light, where v² is smallest.
        let foot = (spot.position - ray.origin).dot(*ray.direction);
        let v = ray.at(foot) - spot.position;
        let (along, aside) = (ray.direction.cosine_to(spot.axis()), v.dot(*spot.axis()));
        // A s² + 2 B s + C = 0 at distance s from the foot.
        let a = along * along - c * c;
        let b = along * aside;
        let constant = aside * aside - c * c * v.length_squared();
        let discriminant = b * b - a * constant;
        let roots = (discriminant >= 0.0).then(|| {
            // The larger root of the two in magnitude first, the other from their product.
            let sum = -(b + discriminant.sqrt().copysign(b));
            [foot + sum / a, foot + constant / sum]
        });
        ConeRoots {
            roots,
            foot,
            distance: v.length(),
        }
    }

    /// Bound on the error of the root at the distance `t`.
    fn margin(&self, t: f64) -> f64 {
        MARGIN * (self.foot.abs() + self.distance + t.abs())
    }
}

/// Samples points on a ray for single scattering of a positioned light.
pub struct ScatteringPointSampler<'p> {
    segments: &'p MediumSegments,
    lit: Span,
    foot: f64,
    equiangular: Equiangular,
    flight: TruncatedFlight,
}

/// A point on a ray, in media that scatter.
#[derive(Clone, Copy, Debug)]
pub struct ScatteringPoint {
    /// Distance from the origin of the ray.
    pub t: f64,
    /// Density with which it is sampled, per length.
    pub pdf: f64,
    /// Optical depths of the homogeneous media up to there.
    pub depths: OpticalDepths,
    /// Scattering of the homogeneous media there.
    pub sigma_s: DVec3,
    /// Extinction of those that scatter.
    pub sigma_t: DVec3,
    /// The media there.
    pub set: Set,
}

impl ScatteringPoint {
    /// The point at distance `t` in `segment`.
    pub fn new(t: f64, pdf: f64, depths: OpticalDepths, segment: &MediumSegment) -> Self {
        ScatteringPoint {
            t,
            pdf,
            depths,
            sigma_s: segment.properties.sigma_s,
            sigma_t: segment.properties.sigma_t,
            set: segment.set,
        }
    }

    /// Density with which a free flight from the origin of the ray collides there, per length: the
    /// mean of the channels.
    pub fn flight_pdf(&self, chromatic: bool) -> f64 {
        let density =
            |c: usize| truncated_free_flight_pdf(self.sigma_t[c], self.depths.scattering[c], 1.0);
        if chromatic {
            (density(0) + density(1) + density(2)) / 3.0
        } else {
            density(0)
        }
    }
}

impl<'p> ScatteringPointSampler<'p> {
    /// A sampler for `light` on `ray`, along which the media are `segments`. `None` where it shines
    /// on no media that scatter.
    ///
    /// # Errors
    ///
    /// [`LightOnRay`] where the light lies on the ray.
    pub fn new(
        segments: &'p MediumSegments,
        ray: &Ray,
        light: &PositionedLight<'_>,
        chromatic: bool,
    ) -> Result<Option<Self>, LightOnRay> {
        lit_span(segments, ray, light.light)
            .map(|lit| {
                ScatteringPointSampler::within(lit, segments, ray, (light.position, 0.0), chromatic)
            })
            .transpose()
    }

    /// A sampler within `lit` of a `ray` along which the media are `segments`, for light from around
    /// `position`, whose mean squared distance from there is `spread`.
    ///
    /// # Errors
    ///
    /// [`LightOnRay`] where all light comes from a point that lies on the ray.
    pub fn within(
        lit: Span,
        segments: &'p MediumSegments,
        ray: &Ray,
        (position, spread): (DVec3, f64),
        chromatic: bool,
    ) -> Result<Self, LightOnRay> {
        let foot = (position - ray.origin).dot(*ray.direction);
        let distance = ((ray.at(foot) - position).length_squared() + spread).sqrt();
        Ok(ScatteringPointSampler {
            segments,
            lit,
            foot,
            equiangular: Equiangular::new(distance, lit.near - foot, lit.far - foot)?,
            flight: TruncatedFlight::new(segments, lit, chromatic),
        })
    }

    /// The point for two numbers in [0, 1).
    pub fn sample(&self, [choice, u]: [f64; 2]) -> Option<ScatteringPoint> {
        let t = if choice < 0.5 {
            self.foot + self.equiangular.sample(u)
        } else {
            // The rest of the choice chooses the channel.
            self.flight.sample(self.segments, u, 2.0 * choice - 1.0)
        };
        self.at(t.clamp(self.lit.near, self.lit.far))
    }

    /// The point at distance `t`, if it is one that can be sampled.
    pub fn at(&self, t: f64) -> Option<ScatteringPoint> {
        if !(self.lit.near <= t && t <= self.lit.far) {
            return None;
        }
        let (depths, segment) = self.segments.depths_to(t);
        let segment = segment.filter(|segment| segment.properties.scatters())?;
        let by_flight = self.flight.pdf(&depths, segment.properties.sigma_t);
        let pdf = 0.5 * (self.equiangular.pdf(t - self.foot) + by_flight);
        Some(ScatteringPoint::new(t, pdf, depths, segment))
    }
}

/// Single scattering in the media of a scene.
#[derive(Clone, Copy)]
pub struct SingleScattering<'s>(pub &'s SceneContext<'s>);

impl SingleScattering<'_> {
    /// Radiance per length that is scattered into `ray` at `point`, seen from the origin of the ray.
    /// `direct` is the radiance scattered at a vertex there.
    pub fn at(
        self,
        ray: &Ray,
        point: &ScatteringPoint,
        tracker: &mut Tracker<'_>,
        direct: impl FnOnce(&Vertex, &mut Tracker<'_>) -> DVec3,
    ) -> DVec3 {
        let vertex = Vertex::Medium {
            point: ray.at(point.t),
            direction: ray.direction,
            set: point.set,
        };
        if !self.0.is_heterogeneous() {
            let scattered = direct(&vertex, tracker);
            let transmittance = Transmittance(self.0).closed(point.depths.total(), tracker.work);
            return scattered * point.sigma_s * transmittance;
        }
        let sigma_s = self
            .0
            .media
            .sigma_s(point.set, vertex.point(), tracker.work);
        if sigma_s == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let scattered = direct(&vertex, tracker);
        scattered * sigma_s * Transmittance(self.0).along(ray, point.t, tracker)
    }
}

/// Free flight of those alone that collide on a span of the ray; in chromatic media by one of
/// the channels that can, all equally likely.
struct TruncatedFlight {
    before: DVec3,
    /// Probability, by channel, of a collision on the span.
    colliding: DVec3,
    /// Channels in which it is not 0.
    channels: f64,
    /// Number of channels that differ.
    differing: usize,
}

impl TruncatedFlight {
    fn new(segments: &MediumSegments, lit: Span, chromatic: bool) -> Self {
        let differing = if chromatic { 3 } else { 1 };
        let before = segments.depths_to(lit.near).0.scattering;
        let depth = segments.depths_to(lit.far).0.scattering - before;
        let mut colliding = DVec3::ZERO;
        let mut channels = 0.0;
        for c in 0..differing {
            colliding[c] = opacity(depth[c]);
            channels += if colliding[c] > 0.0 { 1.0 } else { 0.0 };
        }
        TruncatedFlight {
            before,
            colliding,
            channels,
            differing,
        }
    }

    fn sample(&self, segments: &MediumSegments, u: f64, choice: f64) -> f64 {
        let mut nth = (choice * self.channels) as usize;
        let mut channel = 0;
        for c in 0..self.differing {
            if self.colliding[c] > 0.0 {
                channel = c;
                if nth == 0 {
                    break;
                }
                nth -= 1;
            }
        }
        let into = truncated_optical_distance(self.colliding[channel], u);
        segments.distance_at(self.before[channel] + into, channel)
    }

    /// Density, per length, where the extinction of the media that scatter is `sigma_t` and the
    /// depths up to there are `depths`.
    fn pdf(&self, depths: &OpticalDepths, sigma_t: DVec3) -> f64 {
        let density = |c: usize| {
            let into = depths.scattering[c] - self.before[c];
            truncated_free_flight_pdf(sigma_t[c], into, self.colliding[c])
        };
        let mut colliding = (0..self.differing).filter(|&c| self.colliding[c] > 0.0);
        let Some(first) = colliding.next().map(density) else {
            return 0.0;
        };
        // The mean of the channels, from the first of them on: the density itself, to the bit,
        // where all are the same.
        let more: f64 = colliding.map(|c| density(c) - first).sum();
        first + more / self.channels
    }
}
