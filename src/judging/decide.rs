//! Decisions on images whose noise leaves them open, by more samples, look after look.
//!
//! # False alarms
//!
//! Whoever looks again and again at the same false alarm rate will see one. So look j has the share
//! 1/⌈π²j²/6⌉ of the rate of its case. These add up to at most Σ 6/(π²j²) = 1: the probability that any of
//! the looks, however many there are and whatever ends them, raises a false alarm is at most that of a
//! single look with the whole rate (a union bound; spending of alpha, Lan & DeMets 1983, Biometrika 70,
//! 659–663). The samples of one look may be among those of the next, and the number of samples may
//! depend on what was seen. The tenth look has a 165th of the rate: its limits are 7.1 standard errors
//! where those of a single look are 6.4.
//!
//! # Noise that does not fall
//!
//! A mean of numbers without a finite variance, such as those of a path tracer that scatters next to a point
//! light in fog, converges slower than 1/√n, and the variance that is estimated for it is that of the few
//! rare numbers that came: the next rendering has it in other pixels. So the pixels that have most
//! variance in one of two independent renderings are looked up in the other. Where the variance is known they
//! have about as much there; of Mitsuba's pictures of a spotlight in fog they have 0.01 to 0.3 of it, of volref's of the
//! same scenes 0.55 or more, and of Mitsuba's without a light in the fog 0.74 or more (64 to 1024 samples a pixel). In a
//! furnace of many scatterings, where Mitsuba ends one path in twenty at each, they have 0.0002 of it, and its means of 64, 1024
//! and 8192 samples are 0.86, 0.88 and 0.89 where 1 is right. No verdict on an image whose variance is not known can be
//! trusted, and none that fails is final at the first look: [`Looks::is_heavy_tailed`].

use super::finding::MOST_CASES;
use super::{CaseResult, Cause};
use crate::film::Film;
use std::f64::consts::PI;

/// Factors on the samples from one look to the next: an estimate of what is needed may be wrong by
/// some, and a look costs as much as the noise of its limits is worth.
const GROWTH: [f64; 2] = [2.0, 16.0];

/// The part of the pixels in which variance is looked up: those that have most.
const MOST_NOISY: usize = 1000;

/// The variance is not known where these pixels have at least the first share of all variance, and in another rendering
/// at most the second share of what they have in the one.
const CONCENTRATED: f64 = 0.3;
const AGREEMENT: f64 = 0.4;

/// The share of the false alarms of a case that look `look`, from 1, has.
pub fn share_of_look(look: u32) -> f64 {
    1.0 / parts(look)
}

/// Cases among which the false alarms are to be divided for one case at look `look`, from 1.
pub(crate) fn cases_at(look: u32) -> usize {
    MOST_CASES * parts(look) as usize
}

/// ⌈π²j²/6⌉
fn parts(look: u32) -> f64 {
    let look = f64::from(look.max(1));
    (PI * PI * look * look / 6.0).ceil()
}

/// Looks at the images of one case.
#[derive(Clone, Debug, Default)]
pub struct Looks(Vec<Look>);

#[derive(Clone, Copy, Debug)]
struct Look {
    /// Per pixel, in all.
    samples: f64,
    /// Noise is stated, or taken from the spread of several renderings.
    has_noise: bool,
    /// Concentration of the variance in few pixels, where there were two renderings.
    concentration: Option<Concentration>,
}

/// The pixels with most variance.
#[derive(Clone, Copy, Debug)]
struct Concentration {
    /// Share of the variance of all pixels.
    share: f64,
    /// Their variance in another rendering over that in the one.
    agreement: f64,
}

impl Concentration {
    /// The concentration of `one` by the same pixels of `other`. Both state their noise.
    fn new(one: &Film, other: &Film) -> Option<Concentration> {
        let of_sample = |film: &Film| -> Option<Vec<f64>> {
            let samples = film.samples()? as f64;
            let variances = film.noise()?.variance().iter();
            let sums = variances.map(|pixel| pixel.map(f64::from).iter().sum::<f64>());
            Some(sums.map(|sum| samples * sum).collect())
        };
        let (one, other) = (of_sample(one)?, of_sample(other)?);
        if one.len() != other.len() {
            return None;
        }
        let mut order: Vec<usize> = (0..one.len()).collect();
        order.sort_by(|&a, &b| one[b].total_cmp(&one[a]));
        order.truncate(one.len().div_ceil(MOST_NOISY));
        let sum = |of: &[f64]| order.iter().map(|&at| of[at]).sum::<f64>();
        let all: f64 = one.iter().sum();
        (all > 0.0).then(|| Concentration {
            share: sum(&one) / all,
            agreement: sum(&other) / sum(&one),
        })
    }

    fn is_of_heavy_tails(&self) -> bool {
        self.share >= CONCENTRATED && self.agreement <= AGREEMENT
    }
}

impl Looks {
    /// Number of looks.
    pub fn count(&self) -> u32 {
        self.0.len() as u32
    }

    /// Adds a look at `film`, of all samples so far, which is made of these two independent `parts` if it is
    /// made of several.
    pub fn add(&mut self, film: &Film, parts: Option<[&Film; 2]>) {
        let both = parts.into_iter().flat_map(|[a, b]| [[a, b], [b, a]]);
        let concentrations = both.filter_map(|[one, other]| Concentration::new(one, other));
        self.0.push(Look {
            samples: film.samples().unwrap_or(1) as f64,
            has_noise: film.noise().is_some(),
            concentration: concentrations.max_by_key(Concentration::is_of_heavy_tails),
        });
    }

    /// Samples per pixel of the last look, in all.
    pub fn samples(&self) -> f64 {
        self.0.last().map_or(0.0, |look| look.samples)
    }

    /// Samples per pixel at which the next look may decide `result`, in all; `None` if it is decided, or
    /// if no number of samples would do.
    pub(crate) fn samples_of_next(&self, result: &CaseResult) -> Option<f64> {
        // Images with a step, which no number of samples decides, have no noise that could be seen.
        result.metrics.get("smallest_visible_bias")?;
        let [least, most] = GROWTH;
        let times = match self.0.last() {
            // With rare samples of infinite variance most means are too small and look certain: a second rendering
            // tells.
            _ if result.cause == Cause::Mismatch && self.count() == 1 => least,
            _ if result.cause != Cause::Undecided => return None,
            // Noise that is estimated from a single image is rough.
            Some(look) if !look.has_noise => most,
            _ => *result.metrics.get("times_the_samples_that_would_decide")?,
        };
        Some((self.samples() * times.clamp(least, most)).ceil())
    }

    /// The pixels with most variance, if those of another rendering are others.
    fn heavy_tail(&self) -> Option<Concentration> {
        let concentration = self.0.last()?.concentration?;
        concentration.is_of_heavy_tails().then_some(concentration)
    }

    /// Whether the variance is that of rare numbers, and not known.
    pub(crate) fn is_heavy_tailed(&self) -> bool {
        self.heavy_tail().is_some()
    }

    /// Meaning of heavy tails, in words.
    pub fn in_words(&self) -> String {
        let tail = self.heavy_tail();
        format!(
            "its noise does not shrink like 1/√samples: the mean of {} samples per pixel cannot be trusted. \
             0.1 % of the pixels carry {:.0} % of the variance, and only {:.2} of that in a second \
             rendering: the estimator may have an infinite variance",
            self.samples(),
            100.0 * tail.map_or(0.0, |tail| tail.share),
            tail.map_or(1.0, |tail| tail.agreement),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shares of a million looks are at most one look.
    #[test]
    fn looks_share_one_false_alarm() {
        let sum: f64 = (1..1_000_000).map(share_of_look).sum();
        assert!(sum < 1.0, "{sum}");
        // And not a small part of it: half of it is spent on the first.
        assert_eq!(cases_at(1), 2 * MOST_CASES);
    }

    fn film(samples: u32, variance: impl Fn(usize) -> f32) -> Film {
        let variances = (0..400).map(|at| [variance(at) / samples as f32; 3]);
        Film::with_noise(20, 20, vec![[1.0; 3]; 400], variances.collect(), samples)
    }

    #[test]
    fn variance_in_other_pixels_each_time_is_told() {
        let with_rare = |rare: usize| film(64, move |at| if at == rare { 400.0 } else { 1.0 });
        let looks = |a: &Film, b: &Film| {
            let mut looks = Looks::default();
            looks.add(a, None);
            assert!(!looks.is_heavy_tailed());
            looks.add(a, Some([a, b]));
            looks
        };
        let heavy = looks(&with_rare(17), &with_rare(240));
        assert!(heavy.is_heavy_tailed());
        let words = heavy.in_words();
        assert!(
            words.contains("50 % of the variance") && words.contains("0.00 of that"),
            "{words}"
        );
        // The same pixel; none that stands out; twice the samples.
        assert!(!looks(&with_rare(17), &with_rare(17)).is_heavy_tailed());
        assert!(!looks(&film(64, |_| 1.0), &film(64, |_| 1.0)).is_heavy_tailed());
        let more = film(128, |at| if at == 17 { 400.0 } else { 1.0 });
        assert!(!looks(&with_rare(17), &more).is_heavy_tailed());
    }
}
