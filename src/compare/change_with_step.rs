//! Change of a difference with the step of a ray caster.

use crate::film::Film;

/// Sentence on how the differences of `images`, with steps h, h/2, h/4 and so on, from `golden`
/// change from the last but one to the last; none for a single image, or where there is no difference.
pub fn change_with_step(golden: &Film, images: &[Film]) -> Option<String> {
    if images.len() < 2 || !images.iter().all(|image| golden.is_comparable(image)) {
        return None;
    }
    let size = |image: &Film| {
        let image = image.nearest_to(golden);
        let values = golden.radiance().as_flattened().iter();
        let values = values.zip(image.radiance().as_flattened());
        let squares = values.map(|(&right, &test)| {
            let [right, test] = [right, test].map(f64::from);
            [(test - right) * (test - right), right * right]
        });
        let [off, right] = squares.fold([0.0; 2], |sum, it| [sum[0] + it[0], sum[1] + it[1]]);
        (off / right).sqrt()
    };
    let sizes: Vec<f64> = images.iter().map(size).collect();
    if !sizes.iter().all(|size| *size > 0.0 && size.is_finite()) {
        return None;
    }
    let listed = sizes.iter().enumerate().map(|(halvings, size)| {
        let step = match halvings {
            0 => "the step asked for".to_owned(),
            _ => format!("1/{} of it", 1_u64 << halvings),
        };
        format!("{:.3} % at {step}", 100.0 * size)
    });
    let does = match sizes[sizes.len() - 1] / sizes[sizes.len() - 2] {
        ..0.35 => "shrinks faster than the step, as at second order",
        0.35..0.7 => "shrinks with the step, as at first order",
        0.7..0.9 => "shrinks less than the step",
        0.9..1.1 => "stays, whatever the step",
        _ => "grows: is something done, or left out, at each sample?",
    };
    Some(format!(
        "the difference is {} of the golden, root mean square: with the last halving it {does}",
        listed.collect::<Vec<_>>().join(", ")
    ))
}
