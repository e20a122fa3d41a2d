//! Prints how well the sampled goldens of the suite are known, case by case.
//!
//! ```sh
//! cargo run --release --example golden-errors
//! ```
//!
//! Standard errors relative to the radiance, in percent: the median of the pixels and channels, and what
//! nine tenths of the blocks of 8 × 8 pixels do not exceed. What is darker than a tenth of the mean of
//! the image counts as that tenth.

use std::path::Path;
use volref::film::Film;
use volref::suite::{Golden, Suite};

/// Pixels on a side of a block.
const BLOCK: usize = 8;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR")))?;
    println!("| case | samples | pixels, % | blocks, % |");
    println!("| --- | --- | --- | --- |");
    for case in suite.cases() {
        let is_sampled = case.sampling.is_some() && case.truth.is_none();
        if !is_sampled {
            continue;
        }
        let golden = Golden::read(&suite.store(), case)?;
        let [pixels, blocks] = [(1, 0.5), (BLOCK, 0.9)]
            .map(|(edge, share)| 100.0 * quantile(relative_errors(&golden.film, edge), share));
        let samples = golden.provenance.samples;
        println!(
            "| `{}` | {samples} | {pixels:.2} | {blocks:.2} |",
            case.name
        );
    }
    Ok(())
}

/// Of each channel of squares of `edge` pixels.
fn relative_errors(film: &Film, edge: usize) -> Vec<f64> {
    let noise = film.noise().expect("a sampled golden states its noise");
    let all = film.radiance().as_flattened();
    let mean = all.iter().map(|&value| f64::from(value)).sum::<f64>() / all.len() as f64;
    let mut errors = Vec::new();
    for top in (0..film.height()).step_by(edge) {
        for left in (0..film.width()).step_by(edge) {
            let rows = top..film.height().min(top + edge);
            let columns = left..film.width().min(left + edge);
            let pixels = rows.flat_map(|row| {
                columns
                    .clone()
                    .map(move |column| row * film.width() + column)
            });
            let pixels: Vec<usize> = pixels.collect();
            for channel in 0..3 {
                let sum = |values: &[[f32; 3]]| -> f64 {
                    pixels
                        .iter()
                        .map(|&pixel| f64::from(values[pixel][channel]))
                        .sum()
                };
                let least = 0.1 * mean * pixels.len() as f64;
                errors.push(sum(noise.variance()).sqrt() / sum(film.radiance()).max(least));
            }
        }
    }
    errors
}

fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() as f64 * share).ceil() as usize).max(1) - 1]
}
