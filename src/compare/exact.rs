//! The exact gate: every bit of every pixel.

use super::gate::{Gate, Metric, metrics};
use super::image_gate::{Conditions, ImageGate};
use super::judgement::Judgement;
use super::picture::{Picture, PictureError};
use crate::film::Film;

/// Every bit of every pixel.
#[derive(Clone, Copy, Debug)]
pub struct Exact;

impl Gate for Exact {
    fn name(&self) -> &'static str {
        "exact"
    }

    fn rule(&self) -> &'static str {
        "Every bit of every pixel must be the same."
    }

    fn metrics(&self) -> &'static [Metric] {
        &metrics! {
            "moved_pixels" => "Pixels whose colour differs in any bit.";
            "moved_opacities" => "Pixels whose opacity differs in any bit.";
            "max_abs_error" => "Largest difference of any channel, in radiance.";
        }
    }
}

impl ImageGate for Exact {
    fn judge(
        &self,
        reference: &Picture,
        test: &Picture,
        _: &Conditions<'_>,
    ) -> Result<Judgement, PictureError> {
        let [reference, test] = [reference, test].map(|picture| picture.radiance_for(self));
        Ok(judge(reference?, test?))
    }
}

/// Judges `test` by `reference`; both of one size and finite.
fn judge(reference: &Film, test: &Film) -> Judgement {
    let test = &*test.nearest_to(reference);
    let bits = |pixel: &[f32; 3]| pixel.map(f32::to_bits);
    let pairs = || reference.radiance().iter().zip(test.radiance());
    let moved = pairs().filter(|(a, b)| bits(a) != bits(b)).count();
    let opacity_moved = match (reference.opacity(), test.opacity()) {
        // It was rounded too, if it was kept at all.
        _ if test.quantisation().is_some() => 0,
        (Some(a), Some(b)) => a
            .iter()
            .zip(b)
            .filter(|(a, b)| a.to_bits() != b.to_bits())
            .count(),
        (None, None) => 0,
        _ => {
            let reason = "only one of the images has an opacity channel".to_owned();
            return Judgement::new(&Exact, false, reason, &[("moved_pixels", moved as f64)]);
        }
    };
    let largest = pairs()
        .flat_map(|(a, b)| (0..3).map(move |c| (f64::from(a[c]) - f64::from(b[c])).abs()))
        .fold(0.0, f64::max);
    let count = reference.radiance().len();
    let reason = if moved == 0 && opacity_moved == 0 {
        format!("all {count} pixels have the same bits")
    } else {
        format!(
            "{moved} of {count} pixels differ in colour and {opacity_moved} in opacity; \
             the largest difference of a channel is {largest:.3e}"
        )
    };
    let metrics = [
        ("moved_pixels", moved as f64),
        ("moved_opacities", opacity_moved as f64),
        ("max_abs_error", largest),
    ];
    Judgement::new(&Exact, moved + opacity_moved == 0, reason, &metrics)
}
