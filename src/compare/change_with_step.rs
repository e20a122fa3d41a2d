//! Changes of a difference with the step of a ray caster, in the whole image and in its parts.

use super::parts::{Part, Seen};
use super::pixels::Pixels;
use crate::film::Film;
use crate::math::Sum;

/// Share of the squared difference that a part holds, at the first step or the last, if it is named.
const WORTH_SAYING: f64 = 0.1;

/// Sentence on how the differences of `images`, with steps h, h/2, h/4 and so on, from `golden`
/// change from the last but one to the last; none for a single image, or where there is no difference.
pub fn change_with_step(golden: &Film, images: &[Film], seen: &Seen) -> Option<String> {
    let last = images.last().filter(|_| images.len() > 1)?;
    if !images.iter().all(|image| golden.is_comparable(image)) {
        return None;
    }
    let pixels = Pixels::new(golden, last)?;
    let nearest: Vec<_> = images
        .iter()
        .map(|image| image.nearest_to(golden))
        .collect();
    let sizes = nearest.iter().map(|image| squares(golden, image, |_| true));
    let sizes: Vec<f64> = sizes.collect();
    let golden_values = golden.radiance().as_flattened().iter();
    let right: f64 = golden_values.map(|&x| f64::from(x) * f64::from(x)).sum();
    let [.., before, after] = sizes[..] else {
        return None;
    };
    if !(sizes.iter().all(|size| *size > 0.0) && right > 0.0) {
        return None;
    }
    let whole = [before, after];
    let does = in_words(whole);
    let listed = sizes.iter().enumerate().map(|(halvings, size)| {
        format!(
            "{:.3} % at {}",
            100.0 * (size / right).sqrt(),
            step(halvings)
        )
    });
    let mut words = format!(
        "the difference is {} of the golden, root mean square: with the last halving it {does}",
        listed.collect::<Vec<_>>().join(", ")
    );
    for part in Part::all(&pixels, seen) {
        let of_part = [2, 1].map(|back| {
            let image = &nearest[nearest.len() - back];
            squares(golden, image, |i| part.pixels[i])
        });
        let holds = (0..2).any(|k| of_part[k] >= WORTH_SAYING * whole[k]);
        if holds && in_words(of_part) != does {
            words.push_str(&format!("; {} it {}", part.words, in_words(of_part)));
        }
    }
    Some(words)
}

fn step(halvings: usize) -> String {
    match halvings {
        0 => "the step asked for".to_owned(),
        _ => format!("1/{} of it", 1_u64 << halvings),
    }
}

/// Behaviour of a squared difference from one step to half of it.
fn in_words([before, after]: [f64; 2]) -> &'static str {
    match (after / before).sqrt() {
        ..0.35 => "shrinks faster than the step, as at second order",
        0.35..0.7 => "shrinks with the step, as at first order",
        0.7..0.9 => "shrinks less than the step",
        0.9..1.1 => "stays, whatever the step",
        _ => "grows: is something done, or left out, at each sample?",
    }
}

fn squares(golden: &Film, image: &Film, is_in: impl Fn(usize) -> bool) -> f64 {
    let mut sum = Sum::default();
    let pixels = golden.radiance().iter().zip(image.radiance()).enumerate();
    for (_, (right, test)) in pixels.filter(|(i, _)| is_in(*i)) {
        for c in 0..3 {
            let difference = f64::from(test[c]) - f64::from(right[c]);
            sum.add(difference * difference);
        }
    }
    sum.value()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box, grey below, and dark around.
    fn golden() -> Film {
        let pixel = |i: usize| match i / 64 < 24 {
            true => [0.1, 0.12, 0.1],
            false => [0.7, 0.6, 0.5],
        };
        Film::new(64, 48, (0..64 * 48).map(pixel).collect())
    }

    fn is_border(i: usize) -> bool {
        i % 64 == 20
    }

    /// Images that are off by so much at these steps, at the border and elsewhere.
    fn said(off: impl Fn(f64) -> [f64; 2]) -> String {
        let golden = golden();
        let image = |step: f64| {
            let [border, others] = off(step);
            let pixels = golden.radiance().iter().enumerate().map(|(i, pixel)| {
                let off = if is_border(i) { border } else { others };
                pixel.map(|x| (f64::from(x) + off) as f32)
            });
            Film::new(64, 48, pixels.collect())
        };
        let images = [1.0, 0.5, 0.25].map(image);
        let seen = Seen {
            border: Some((0..64 * 48).map(is_border).collect()),
            ..Seen::default()
        };
        change_with_step(&golden, &images, &seen).unwrap_or_default()
    }

    #[test]
    fn what_changes_with_the_step_is_said() {
        let halves = said(|step| [0.02 * step; 2]);
        assert!(
            halves.ends_with("it shrinks with the step, as at first order"),
            "{halves}"
        );
        let quarters = said(|step| [0.02 * step * step; 2]);
        assert!(quarters.contains("as at second order"), "{quarters}");
        let stays = said(|_| [0.02; 2]);
        assert!(stays.ends_with("it stays, whatever the step"), "{stays}");
        let grows = said(|step| [0.01 / step; 2]);
        assert!(grows.contains("with the last halving it grows"), "{grows}");
        assert!(grows.contains("at the step asked for") && grows.contains("at 1/4 of it"));
        // The border by itself: one column of 64, and nine tenths of the difference.
        let border = said(|step| [0.5 / step, 0.05 * step]);
        assert!(border.contains("it grows"), "{border}");
        let border = said(|step| [0.5, 0.05 * step]);
        assert!(border.contains("it stays"), "{border}");
        let border = said(|step| [0.2 / step, 0.2 * step]);
        let words = "at the border of the volume, the silhouette of its box (2 % of the pixels that show anything) it grows";
        assert!(border.contains(words), "{border}");
        assert_eq!(said(|_| [0.0; 2]), "");
        let golden = golden();
        let one = [golden.clone()];
        assert_eq!(change_with_step(&golden, &one, &Seen::default()), None);
    }
}
