//! Changes of pixel values as numbers to test for: exposure, gains, offset, exponent.

use super::blocks::{Block, Channel};
use super::comparison::Comparison;
use crate::compare::sensitivity::Sensitivity;
use crate::film::Film;
use crate::math;

/// A number of the values of an image.
struct ValueNumber {
    name: &'static str,
    words: &'static str,
    unit: Option<&'static str>,
    /// Change up to which the values change in proportion.
    step: f64,
    /// Share of each channel that changes, 0 or 1.
    channels: [f64; 3],
    /// Derivative of a radiance by the number.
    derivative: fn(f64) -> f64,
}

const ALL: [f64; 3] = [1.0; 3];

const NUMBERS: [ValueNumber; 6] = [
    ValueNumber::gain("exposure", "exposure", ALL),
    ValueNumber::gain("gain.red", "gain of red", [1.0, 0.0, 0.0]),
    ValueNumber::gain("gain.green", "gain of green", [0.0, 1.0, 0.0]),
    ValueNumber::gain("gain.blue", "gain of blue", [0.0, 0.0, 1.0]),
    ValueNumber {
        unit: Some(""),
        derivative: |_| 1.0,
        ..ValueNumber::gain("offset", "offset of all values", ALL)
    },
    // An exponent of 1 + x multiplies a value v by v^x, which a tenth changes in proportion.
    ValueNumber {
        step: 0.1,
        derivative: |v| if v > 0.0 { v * math::ln(v) } else { 0.0 },
        ..ValueNumber::gain("gamma", "exponent of all values", ALL)
    },
];

impl ValueNumber {
    /// A factor on these channels.
    const fn gain(name: &'static str, words: &'static str, channels: [f64; 3]) -> ValueNumber {
        ValueNumber {
            name,
            words,
            unit: None,
            step: f64::INFINITY,
            channels,
            derivative: |v| v,
        }
    }
}

/// Sensitivities of the images of a comparison to numbers of their values, in its blocks.
pub(super) fn value_sensitivities(comparison: &Comparison<'_>) -> Vec<Sensitivity> {
    let columns = comparison.columns();
    let rows = comparison.blocks.len() / columns;
    let of = |number: ValueNumber| {
        let (channels, derivative) = (number.channels, number.derivative);
        let (mut means, mut variances) = (Vec::new(), Vec::new());
        for block in &comparison.blocks {
            let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
            for c in 0..3 {
                let [radiance, square] = radiance(block, &block.channels[c]);
                mean[c] = (channels[c] * derivative(radiance)) as f32;
                // By the slope of the derivative; an offset has none.
                let slope =
                    (derivative(1.001 * radiance) - derivative(radiance)) / (1e-3 * radiance);
                let error = channels[c] * slope * square.sqrt();
                variance[c] = if error.is_finite() {
                    (error * error) as f32
                } else {
                    0.0
                };
            }
            means.push(mean);
            variances.push(variance);
        }
        Sensitivity {
            name: number.name.to_owned(),
            words: number.words.to_owned(),
            unit: number.unit.map(str::to_owned),
            step: number.step,
            can_be: [true; 2],
            derivative: Film::with_noise(columns, rows, means, variances, 2),
        }
    };
    NUMBERS.into_iter().map(of).collect()
}

/// Mean radiance of a block in both images, each weighed by the variance of the other, and its variance:
/// of all weights these alone make it independent of the difference.
fn radiance(block: &Block, channel: &Channel) -> [f64; 2] {
    let pixels = block.pixels() as f64;
    let reference = channel.radiance / pixels;
    let test = reference + channel.difference.value / pixels;
    let [of_reference, of_test] = channel.variance.own.map(|v| v / (pixels * pixels));
    let both = of_reference + of_test;
    if both > 0.0 {
        let mean = (of_test * reference + of_reference * test) / both;
        [mean, of_reference * of_test / both]
    } else {
        [reference, 0.0]
    }
}
