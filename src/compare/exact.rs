//! The exact gate: every bit of every pixel.

use super::gate::{Description, Gate, metrics};
use super::judgement::Judgement;
use crate::film::Film;

pub(super) const DESCRIPTION: Description = Description {
    name: "exact",
    rule: "Every bit of every pixel must be the same.",
    metrics: &metrics! {
        "moved_pixels" => "Pixels whose colour differs in any bit.";
        "moved_opacities" => "Pixels whose opacity differs in any bit.";
        "max_abs_error" => "Largest difference of any channel, in radiance.";
    },
    default_for: None,
};

/// Judges `test` by `reference`; both of one size and finite.
pub(super) fn judge(reference: &Film, test: &Film) -> Judgement {
    let test = &*test.nearest_to(reference);
    let bits = |pixel: &[f32; 3]| pixel.map(f32::to_bits);
    let pairs = || reference.radiance().iter().zip(test.radiance());
    let moved = pairs().filter(|(a, b)| bits(a) != bits(b)).count();
    let differs = |(a, b): &(&f32, &f32)| a.to_bits() != b.to_bits();
    let opacity_moved = match (reference.opacity(), test.opacity()) {
        // It was rounded too, if it was kept at all.
        _ if test.quantisation().is_some() => 0,
        (Some(a), Some(b)) => a.iter().zip(b).filter(differs).count(),
        (None, None) => 0,
        _ => {
            let reason = "only one of the images has an opacity channel".to_owned();
            let metrics = [("moved_pixels", moved as f64)];
            return Judgement::new(Gate::Exact, false, reason, &metrics);
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
    Judgement::new(Gate::Exact, moved + opacity_moved == 0, reason, &metrics)
}
