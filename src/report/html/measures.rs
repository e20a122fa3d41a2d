//! Size and place of the difference of two images, in numbers and words.

use super::words;
use crate::compare::BlockMap;
use crate::compare::stochastic::BLOCK;
use crate::film::{CHANNELS, Film};
use minijinja::{Value, context};

/// The mean of each channel in both images, over the pixels that are finite in both.
pub(super) fn means(golden: &Film, test: &Film) -> Vec<Value> {
    let mean = |(c, channel): (usize, &str)| {
        let pairs = golden.radiance().iter().zip(test.radiance());
        let pairs = pairs.map(|(a, b)| [a[c], b[c]]);
        let (mut sums, mut count) = ([0.0_f64; 2], 0.0_f64);
        for [a, b] in pairs.filter(|[a, b]| a.is_finite() && b.is_finite()) {
            sums[0] += f64::from(a);
            sums[1] += f64::from(b);
            count += 1.0;
        }
        let [a, b] = sums.map(|sum| sum / count.max(1.0));
        let ratio = match a > 0.0 && b > 0.0 {
            true => format!("× {:.4}", b / a),
            false => "–".to_owned(),
        };
        context! {
            channel,
            golden => words::digits(a),
            test => words::digits(b),
            difference => words::digits(b - a),
            ratio,
        }
    };
    let channels = CHANNELS.into_iter().enumerate();
    channels.map(mean).collect()
}

/// Over how many pixels the difference is spread.
pub(super) fn spread(golden: &Film, test: &Film) -> Option<String> {
    let of_pixel = |(a, b): (&[f32; 3], &[f32; 3])| {
        let parts = [0, 1, 2].map(|c| (f64::from(b[c]) - f64::from(a[c])).abs());
        parts.iter().sum::<f64>()
    };
    let mut sizes: Vec<f64> = golden
        .radiance()
        .iter()
        .zip(test.radiance())
        .map(of_pixel)
        .collect();
    sizes.retain(|size| size.is_finite());
    let all: f64 = sizes.iter().sum();
    if all == 0.0 {
        return None;
    }
    sizes.sort_by(|a, b| b.total_cmp(a));
    let mut sum = 0.0;
    let half = sizes.iter().take_while(|size| {
        let below = sum < 0.5 * all;
        sum += **size;
        below
    });
    let share = half.count() as f64 / sizes.len() as f64;
    let advice = match share {
        _ if share < 0.05 => "concentrated in a few places; see the difference view",
        _ if share < 0.2 => "in one part of the image; see the difference view",
        _ => "spread over the image: more likely a factor or an offset than a local error",
    };
    Some(format!(
        "Half of the total difference is in {:.1} % of the pixels, {advice}.",
        (100.0 * share).max(0.1)
    ))
}

/// In how many blocks there is more than noise.
pub(super) fn odd_blocks(map: &BlockMap) -> String {
    let is_odd = |block: &&[f64; 3]| block.iter().any(|z| z.abs() > 5.0);
    let odd = map.deviations.iter().filter(is_odd).count();
    let side = BLOCK;
    format!(
        "{odd} of {} blocks of {side} × {side} pixels deviate by more than 5 standard errors; see \
         the z map.",
        map.deviations.len()
    )
}
