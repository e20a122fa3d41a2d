//! Size and place of the difference of two images, in numbers and words.

use super::words;
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
