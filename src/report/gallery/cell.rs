//! One image on the page: the picture, its difference from the right one, the bias, the cause.

use super::super::html::pixels::thumbnail;
use super::super::template::{image_address, signed_colour};
use crate::compare::flip::SrgbImage;
use crate::compare::recognised;
use crate::film::{CHANNELS, Film};
use crate::judging::{CaseResult, Verdict};
use crate::suite::refusal;

/// Longest side of a picture: that of forty cases and ten renderers fit in some 20 MB.
const SIDE: usize = 128;

/// Differences of this share of the pixels may lie beyond the scale of a case.
const BEYOND: f64 = 1e-3;

/// Standard errors of a 95 % interval.
const INTERVAL: f64 = 1.96;

pub(super) fn small(image: &SrgbImage) -> String {
    thumbnail(image.pixels(), image.width(), SIDE)
}

/// Cause in words: conventions, the likely mistake, or measurements.
pub(super) fn fault(result: &CaseResult) -> String {
    let best = result.changes.iter().filter(|change| change.fits_best);
    let best: Vec<&str> = best.map(|change| change.words.as_str()).collect();
    let measured = result.difference.first();
    match result.verdict {
        Verdict::Pass => String::new(),
        Verdict::Convention => result.conventions.join("; "),
        _ if !result.looks_like.is_empty() => format!("looks like {}", result.looks_like[0]),
        Verdict::Fail if !best.is_empty() => best.join("; "),
        verdict => {
            let reason = &result.reason;
            let reason = refusal(reason).unwrap_or(reason);
            let measured = measured.filter(|_| verdict == Verdict::Fail);
            measured.map_or(reason, String::as_str).to_owned()
        }
    }
}

fn means(golden: &Film) -> [f64; 3] {
    let count = golden.radiance().len().max(1) as f64;
    [0, 1, 2].map(|c| {
        let channel = golden.radiance().iter().map(|pixel| f64::from(pixel[c]));
        channel.sum::<f64>() / count
    })
}

/// Bias of the mean of the channel that has most, in percent of the golden's, with its 95 % interval where it has
/// noise. None of an image rounded to 8 bits that shows none: gates compare the nearest image that rounds to it.
pub(super) fn bias(
    result: &CaseResult,
    golden: &Film,
    film: Option<&Film>,
    exposure: f64,
) -> Option<String> {
    let means = means(golden);
    let of = |c: usize| {
        let metric = |kind| result.metrics.get(&format!("{kind}_{}", CHANNELS[c]));
        let percent = 100.0 / means[c];
        let difference = *metric("mean_difference")?;
        let error = metric("mean_z").map_or(0.0, |z| (difference / z).abs());
        let all = [difference * percent, INTERVAL * error * percent];
        all.iter()
            .all(|number| number.is_finite())
            .then_some((CHANNELS[c], all))
    };
    let most = (0..3)
        .filter_map(of)
        .max_by(|a, b| a.1[0].abs().total_cmp(&b.1[0].abs()))?;
    let (channel, [size, interval]) = most;
    let sign = if size < 0.0 { "−" } else { "+" };
    let size = size.abs();
    let is_rounded = |film: &Film| {
        let film = recognised(golden, film.clone(), exposure);
        film.quantisation().is_some()
    };
    match interval {
        _ if interval > 0.0 => {
            // Two digits of the interval.
            let least = [10.0, 1.0, 0.1, 0.01].into_iter();
            let digits = least.take_while(|least| interval < *least).count();
            Some(format!(
                "{channel} {sign}{size:.digits$} ± {interval:.digits$} %"
            ))
        }
        _ if size >= 0.005 => Some(format!("{channel} {sign}{size:.2} %")),
        _ if film.is_some_and(is_rounded) => None,
        _ => Some("below 0.005 %".to_owned()),
    }
}

/// Differences of an image from the golden, the mean of the channels, in codes of 255.
pub(super) struct Differences {
    width: usize,
    codes: Vec<f64>,
}

impl Differences {
    /// Nothing of images of different sizes.
    pub fn of(golden: &SrgbImage, test: &SrgbImage) -> Option<Differences> {
        let is_alike = golden.width() == test.width() && golden.height() == test.height();
        let pairs = golden.pixels().iter().zip(test.pixels());
        let mean = |(a, b): (&[u8; 3], &[u8; 3])| {
            let sum: i32 = (0..3).map(|c| i32::from(b[c]) - i32::from(a[c])).sum();
            f64::from(sum) / 3.0
        };
        is_alike.then(|| Differences {
            width: golden.width(),
            codes: pairs.map(mean).collect(),
        })
    }

    /// A size that few are beyond.
    pub fn scale(&self) -> f64 {
        let mut sizes: Vec<f64> = self.codes.iter().map(|code| code.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let beyond = (sizes.len() as f64 * BEYOND).ceil() as usize;
        sizes[sizes.len().saturating_sub(1 + beyond)]
    }

    /// The address of a picture: of several pixels in one, that which differs most.
    pub fn picture(&self, scale: f64) -> String {
        let height = self.codes.len() / self.width;
        let step = self.width.max(height).div_ceil(SIDE);
        let (columns, rows) = (self.width.div_ceil(step), height.div_ceil(step));
        let mut most = vec![0.0_f64; columns * rows];
        for (at, &code) in self.codes.iter().enumerate() {
            let most = &mut most[at / self.width / step * columns + at % self.width / step];
            if code.abs() > most.abs() {
                *most = code;
            }
        }
        let colour = |code: &f64| signed_colour(code / scale);
        let colours: Vec<_> = most.iter().map(colour).collect();
        image_address(&colours, columns, rows)
    }
}
