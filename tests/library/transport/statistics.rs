//! What is seen along a ray, and whether a mean of samples is what it should be.

use crate::needs::tries;
use glam::DVec3;
use std::fmt::Display;
use volref::geometry::Ray;
use volref::math::Moments;
use volref::math::rng::Stream;
use volref::render::counters::Counters;
use volref::render::plan::RadiativeFeatures;
use volref::render::radiative::context::Scratch;
use volref::render::radiative::line_of_sight::LineOfSight;
use volref::render::radiative::path_tracer::PathTracer;
use volref::render::radiative::sampler::Sampler;
use volref::render::radiative::scene_context::SceneContext;
use volref::scene::Radiative;

/// How many standard errors a sampled mean may be off. Of a thousand sound comparisons one in
/// sixteen thousand is farther off; the seeds that are fixed here are not among them.
pub const MOST_ERRORS: f64 = 4.0;

/// Samples of a comparison of `nightly` samples in this build: a quarter of them, unless
/// `VOLREF_NIGHTLY` is set when the tests are compiled. Errors twice as large are allowed then,
/// since standard errors are.
pub const fn samples(nightly: u32) -> u32 {
    nightly / tries(4, 1) as u32
}

/// Light along the line of sight, turned once at most, to the last digits.
pub fn by_quadrature(scene: &Radiative, ray: &Ray) -> DVec3 {
    line_of_sight(scene, ray, true)
}

/// Light along the line of sight that is not turned.
pub fn straight(scene: &Radiative, ray: &Ray) -> DVec3 {
    line_of_sight(scene, ray, false)
}

fn line_of_sight(scene: &Radiative, ray: &Ray, turned: bool) -> DVec3 {
    let renderer = LineOfSight {
        scene: SceneContext::new(scene, RadiativeFeatures::ALL),
        scattering: turned,
        tolerance: 1e-14,
    };
    renderer.radiance(ray, &mut Scratch::default(), &mut Counters::default())
}

/// Paths through a scene, one for each sample number.
pub struct Paths<'s> {
    tracer: PathTracer<'s>,
    scratch: Scratch,
    seed: u64,
}

impl<'s> Paths<'s> {
    /// With so many turns at most.
    pub fn new(scene: &'s Radiative, limit: Option<u32>, seed: u64) -> Paths<'s> {
        Paths {
            tracer: PathTracer::new(scene, limit, RadiativeFeatures::ALL),
            scratch: Scratch::default(),
            seed,
        }
    }

    /// The path with that number, along the ray that its random numbers choose.
    pub fn radiance(&mut self, sample: u32, ray: impl Fn(&Stream) -> Ray) -> DVec3 {
        let random = Stream::new(self.seed, 0, sample);
        let ray = ray(&random);
        let radiance = self.tracer.radiance(
            ray,
            Sampler::new(random),
            &mut self.scratch,
            &mut Counters::default(),
        );
        radiance.expect("no path is endless")
    }
}

/// By channel, the moments of the radiance along `ray`.
pub fn sampled(
    scene: &Radiative,
    limit: Option<u32>,
    (seed, samples): (u64, u32),
    ray: impl Fn(&Stream) -> Ray,
) -> [Moments; 3] {
    let mut paths = Paths::new(scene, limit, seed);
    let mut moments = [Moments::default(); 3];
    for sample in 0..samples {
        let radiance = paths.radiance(sample, &ray);
        for (moments, channel) in moments.iter_mut().zip(radiance.to_array()) {
            moments.add(channel);
        }
    }
    moments
}

/// The moments of light that was turned exactly 0, 1, … `most` times, in the first channel.
///
/// A path that may be turned once more is the same path up to there, so what it brings back in
/// addition is the light of that order, path by path.
pub fn by_order(
    scene: &Radiative,
    most: u32,
    (seed, samples): (u64, u32),
    ray: impl Fn(&Stream) -> Ray,
) -> Vec<Moments> {
    let mut paths: Vec<_> = (0..=most)
        .map(|limit| Paths::new(scene, Some(limit), seed))
        .collect();
    let mut moments = vec![Moments::default(); paths.len()];
    for sample in 0..samples {
        let mut before = 0.0;
        for (moments, paths) in moments.iter_mut().zip(&mut paths) {
            let up_to_here = paths.radiance(sample, &ray).x;
            moments.add(up_to_here - before);
            before = up_to_here;
        }
    }
    moments
}

/// Requires a sampled mean to be `expected`, whose own standard error is `expected_error`.
#[track_caller]
pub fn agrees(what: impl Display, found: &Moments, expected: f64, expected_error: f64) {
    let variance = found.variance_of_mean().expect("many samples");
    judge(
        what,
        found.mean(),
        expected,
        (variance + expected_error * expected_error).sqrt(),
    );
}

/// Requires the mean of samples in [0, 1] to be `expected`.
///
/// Where less than a hundred samples are expected to bring anything back, the spread of the
/// samples says little. Then the largest variance that samples in [0, 1] can have takes its
/// place, `m(1 − m)` with `m` the mean (Bhatia & Davis 2000, Am. Math. Monthly 107, 353–357).
#[track_caller]
pub fn share_agrees(what: impl Display, found: &Moments, expected: f64) {
    let count = found.count() as f64;
    let mut variance = found.variance_of_mean().expect("many samples");
    if expected * count < 100.0 {
        variance = variance.max(expected * (1.0 - expected) / count);
    }
    judge(what, found.mean(), expected, variance.sqrt());
}

/// Requires two sampled means to be the same.
#[track_caller]
pub fn same(what: impl Display, a: &Moments, b: &Moments) {
    let error = b.variance_of_mean().expect("many samples").sqrt();
    agrees(what, a, b.mean(), error);
}

#[track_caller]
fn judge(what: impl Display, found: f64, expected: f64, error: f64) {
    let off = found - expected;
    println!("z {:6.2} {what}", off / error);
    // Written so that NaN fails.
    assert!(
        off.abs() <= MOST_ERRORS * error,
        "{what}: {found:e} is not {expected:e}, {:.2} standard errors of {error:e}",
        off / error
    );
}
