//! Independent renderings of one image, combined into an image with noise.

use super::noise::NoiseOrigin;
use super::{Film, FilmError};

impl Film {
    /// At least two independent renderings of one image, combined into an image with noise.
    ///
    /// If all state their number of samples and their variance, the result is that of a single
    /// image of all those samples: it has the spread within and between the renderings, and its
    /// samples are the sum of theirs.
    ///
    /// Otherwise each rendering counts as one number: the variance of the mean is their sample
    /// variance divided by their number n, which is then [`Noise::samples`](super::Noise::samples)
    /// ([`Noise::is_of_renderings`](super::Noise::is_of_renderings)). For few renderings this is very rough: its relative standard
    /// error is √(2/(n − 1)), 1 for three and ½ for nine, and by chance it may be close to 0.
    /// Variances stated by the renderings are not used then. [`Film::samples`] is the sum of theirs
    /// if all have one.
    ///
    /// Fails if sizes differ, if only some have opacity, or if two renderings are equal in every
    /// bit: these are not independent, and their spread would suggest that there is no noise.
    pub fn from_replicates(films: &[Film]) -> Result<Film, FilmError> {
        check_replicates(films).map_err(|what| {
            FilmError(format!("not independent renderings of one image: {what}"))
        })?;
        let first = &films[0];
        let counts: Option<Vec<u32>> = films
            .iter()
            .map(|film| Some(film.noise()?.samples))
            .collect();
        let is_of_renderings = counts.is_none();
        let parts = counts.unwrap_or(vec![1; films.len()]);
        let numbers = parts.iter().fold(0_u32, |sum, &it| sum.saturating_add(it));
        let (radiance, variance) = (0..first.radiance.len())
            .map(|index| pooled_pixel(films, &parts, index))
            .unzip();
        let opacity = first.opacity.is_some().then(|| {
            let weights = parts.iter().map(|&count| f64::from(count));
            let total: f64 = weights.clone().sum();
            let mean = |index: usize| {
                let values = films.iter().map(|film| f64::from(film.pixel(index)[3]));
                let sum: f64 = values.zip(weights.clone()).map(|(v, w)| v * w).sum();
                (sum / total) as f32
            };
            (0..first.radiance.len()).map(mean).collect()
        });
        let mut film = Film::with_noise(first.width, first.height, radiance, variance, numbers);
        film.opacity = opacity;
        let mut changed = films.iter().map(|film| &film.changes_on_reading);
        let changed = changed.find(|changes| !changes.is_empty());
        film.changes_on_reading = changed.cloned().unwrap_or_default();
        film.samples = films.iter().map(Film::samples).sum();
        if let Some(noise) = &mut film.noise
            && is_of_renderings
        {
            noise.origin = NoiseOrigin::Renderings;
        }
        Ok(film)
    }
}

/// Mean and variance of the mean of the pixel `index`; `parts` are the numbers that each film counts for.
fn pooled_pixel(films: &[Film], parts: &[u32], index: usize) -> ([f32; 3], [f32; 3]) {
    let pooled = [0, 1, 2].map(|channel| {
        pooled(films.iter().zip(parts).map(|(film, &count)| {
            let mean = f64::from(film.radiance[index][channel]);
            (f64::from(count), mean, film.variance_at(index, channel))
        }))
    });
    (
        pooled.map(|(mean, _)| mean as f32),
        pooled.map(|(_, variance)| variance as f32),
    )
}

/// Mean, and variance of the mean, of all values of parts, as if from one rendering: each part is the number of its values,
/// their mean, and its variance, which a single number does not have. The squared deviations are those within the parts,
/// `v·n·(n − 1)` each, and those of the parts' means from the common mean, `n·(m − mean)²`.
fn pooled(parts: impl Iterator<Item = (f64, f64, f64)> + Clone) -> (f64, f64) {
    let total: f64 = parts.clone().map(|(count, ..)| count).sum();
    let mean = parts
        .clone()
        .map(|(count, mean, _)| count * mean)
        .sum::<f64>()
        / total;
    let squares = parts.map(|(count, of_part, variance)| {
        let deviation = of_part - mean;
        variance * count * (count - 1.0) + count * deviation * deviation
    });
    (mean, squares.sum::<f64>() / (total - 1.0) / total)
}

/// Refuses films that are no independent renderings of one image.
fn check_replicates(films: &[Film]) -> Result<(), String> {
    let [first, others @ ..] = films else {
        return Err("there is none".to_owned());
    };
    if others.is_empty() {
        return Err("there is only one, which has no spread".to_owned());
    }
    for (index, film) in others.iter().enumerate() {
        let index = index + 1;
        if (film.width, film.height) != (first.width, first.height) {
            return Err(format!(
                "number 0 has {} × {} pixels, number {index} {} × {}",
                first.width, first.height, film.width, film.height
            ));
        }
        if film.opacity.is_some() != first.opacity.is_some() {
            return Err(format!(
                "of number 0 and number {index} one has opacity and one has none"
            ));
        }
        let is_same = |other: &Film| bits(other).eq(bits(film));
        if let Some(same) = films[..index].iter().position(is_same) {
            return Err(format!(
                "number {same} and number {index} are the same in every bit: give each its own \
                 seed, or one image alone if it has no noise"
            ));
        }
    }
    Ok(())
}

/// The bits of every colour of an image, so that NaN equals itself.
fn bits(film: &Film) -> impl Iterator<Item = u32> {
    let values = film.radiance.as_flattened();
    values.iter().map(|value| value.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Moments;

    /// Numbers without a pattern, all of them exact in 32 bits.
    fn numbers(count: usize, seed: usize) -> Vec<f64> {
        let number = |i: usize| ((i * i * 37 + i * 11 + seed * 29) % 101) as f64 / 64.0;
        (0..count).map(number).collect()
    }

    fn part(numbers: &[f64]) -> (f64, f64, f64) {
        let moments: Moments = numbers.iter().copied().collect();
        let variance = moments.variance_of_mean().unwrap_or(0.0);
        (numbers.len() as f64, moments.mean(), variance)
    }

    /// Each operation rounds by half an epsilon of values no larger than the result times the
    /// number of samples, of which there are 13.
    #[test]
    fn parts_say_what_all_their_samples_say() {
        let series = [numbers(4, 1), numbers(7, 2), numbers(2, 3)];
        let all: Moments = series.iter().flatten().copied().collect();
        let (mean, variance) = pooled(series.iter().map(|numbers| part(numbers)));
        let close = |a: f64, b: f64| (a - b).abs() <= 13.0 * 16.0 * f64::EPSILON * b;
        assert!(close(mean, all.mean()), "{mean} {}", all.mean());
        let expected = all.variance_of_mean().unwrap();
        assert!(close(variance, expected), "{variance} {expected}");
    }

    #[test]
    fn single_numbers_have_their_spread() {
        let single = numbers(5, 4);
        let all: Moments = single.iter().copied().collect();
        let (mean, variance) = pooled(single.iter().map(|&number| part(&[number])));
        assert!((mean - all.mean()).abs() <= 16.0 * f64::EPSILON);
        let expected = all.variance_of_mean().unwrap();
        assert!((variance - expected).abs() <= 16.0 * f64::EPSILON * (1.0 + expected));
    }
}
