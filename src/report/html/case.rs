//! What the page shows of one case.

use super::{pixels, words};
use crate::compare::flip::{DEFAULT_PIXELS_PER_DEGREE, flip};
use crate::compare::{Gate, Picture, deterministic, stochastic};
use crate::film::Film;
use crate::suite::{CaseResult, Evidence, Likeness};
use serde::Serialize;

/// Images of more pixels are left out of the page: a browser could not open it.
const MOST_PIXELS: usize = 1 << 22;

/// One case, as the template asks for it.
#[derive(Serialize)]
pub(super) struct CaseView<'a> {
    /// Place on the page, from 0.
    place: usize,
    pub(super) result: &'a CaseResult,
    symbol: &'static str,
    /// Name of the gate, and how it judges.
    gate: String,
    gate_words: &'static str,
    /// Mistakes that the image looks like, with what to do.
    mistakes: Vec<Mistake<'a>>,
    numbers: Vec<Number<'a>>,
    /// Red, green and blue over the image, where there are both images.
    means: Vec<Mean>,
    /// Where the difference is, in words.
    place_words: Option<String>,
    /// What is odd about the images, in words.
    notes: Vec<String>,
    source: &'a str,
    shows: &'a str,
    computes: &'a str,
    provenance: &'a [(String, String)],
    reproduce: String,
    output: Option<String>,
    /// Thumbnails, of golden and test image.
    small_golden: Option<String>,
    small_test: Option<String>,
    /// For the script; nothing where there is no image at all.
    pictures: Option<Pictures>,
}

#[derive(Serialize)]
struct Mistake<'a> {
    name: &'a str,
    advice: Option<&'a str>,
}

#[derive(Serialize)]
struct Number<'a> {
    name: &'a str,
    value: String,
    words: &'static str,
}

#[derive(Serialize)]
struct Mean {
    channel: &'static str,
    golden: String,
    test: String,
    difference: String,
    ratio: String,
}

/// Images and maps, packed by [`pixels`].
#[derive(Default, Serialize)]
struct Pictures {
    /// Stops at which they are shown first.
    exposure: f64,
    gate: String,
    golden: Option<Image>,
    test: Option<Image>,
    /// Test minus golden where they are of one size: of radiance, or of 8-bit codes at the
    /// exposure.
    difference: Option<String>,
    flip: Option<String>,
    z: Option<Blocks>,
    /// Absolute and relative part of a tolerance, under the deterministic gate.
    tolerance: Option<[f64; 2]>,
}

#[derive(Default, Serialize)]
struct Image {
    width: usize,
    height: usize,
    /// Radiance. The test image has none where it is golden plus difference.
    floats: Option<String>,
    /// 8-bit codes.
    codes: Option<String>,
}

#[derive(Serialize)]
struct Blocks {
    columns: usize,
    rows: usize,
    side: usize,
    floats: String,
}

impl<'a> CaseView<'a> {
    pub(super) fn new(
        place: usize,
        result: &'a CaseResult,
        evidence: &'a Evidence,
        likely: &'a [Likeness],
    ) -> CaseView<'a> {
        let gate = result.gate.to_string();
        let advice = |name: &str| {
            let known = likely.iter().find(|likeness| likeness.mistake == name);
            known.map(|likeness| likeness.advice.as_str())
        };
        let mut notes = Vec::new();
        let golden = evidence.golden.as_ref();
        let golden =
            golden.and_then(|film| shown(film, film.radiance().len(), "golden", &mut notes));
        let test = evidence.test.as_ref();
        let test = test.and_then(|picture| {
            let (width, height) = picture.size();
            shown(picture, width * height, "test image", &mut notes)
        });
        if evidence.golden.is_none() {
            notes.push("There is no golden that can be trusted to compare with.".to_owned());
        }
        if evidence.test.is_none() {
            notes.push("There is no test image, or none that can be read.".to_owned());
        }
        let exposure = match evidence.exposure {
            stops if stops.is_finite() => stops,
            _ => 0.0,
        };
        let pair = golden
            .zip(test)
            .filter(|(golden, test)| test.size() == (golden.width(), golden.height()));
        if let (Some(golden), Some(test), None) = (golden, test, pair) {
            let (width, height) = test.size();
            notes.push(format!(
                "The images differ in size: the golden has {} × {} pixels, the test image \
                 {width} × {height}. They can be looked at, but not subtracted.",
                golden.width(),
                golden.height()
            ));
        }
        if let Some(Picture::Codes(_)) = test {
            notes.push(format!(
                "The test image has 8 bits: it is compared with the golden as a display shows it \
                 at exposure {exposure:+}, and differences are in codes from 0 to 255."
            ));
        }
        for (name, film) in [("golden", golden), ("test image", test.and_then(radiance))] {
            notes.extend(film.and_then(|film| not_finite(name, film)));
        }
        let films = pair.and_then(|(golden, test)| Some((golden, radiance(test)?)));
        let blocks = films
            .filter(|_| result.gate == Gate::Stochastic)
            .and_then(|(golden, test)| stochastic::block_map(golden, test));
        CaseView {
            place,
            result,
            symbol: words::symbol(result.verdict),
            gate_words: words::gate(&gate),
            mistakes: result
                .looks_like
                .iter()
                .map(|name| Mistake {
                    name,
                    advice: advice(name),
                })
                .collect(),
            numbers: result
                .metrics
                .iter()
                .map(|(name, &value)| Number {
                    name,
                    value: words::digits(value),
                    words: words::number(name),
                })
                .collect(),
            means: films.map_or_else(Vec::new, |(golden, test)| means(golden, test)),
            place_words: match &blocks {
                Some(map) => Some(odd_blocks(map)),
                None => films.and_then(|(golden, test)| spread(golden, test)),
            },
            notes,
            source: &evidence.source,
            shows: &evidence.shows,
            computes: &evidence.computes,
            provenance: &evidence.provenance,
            reproduce: evidence.reproduce.join("\n"),
            output: evidence.output.as_deref().map(words::shortened),
            small_golden: golden
                .map(|film| pixels::thumbnail(&film.srgb_codes(exposure), film.width())),
            small_test: test.and_then(|picture| {
                let srgb = picture.srgb(exposure).ok()?;
                Some(pixels::thumbnail(srgb.pixels(), srgb.width()))
            }),
            pictures: pictures(golden, test, pair, exposure).map(|pictures| Pictures {
                z: blocks.as_ref().map(packed_blocks),
                tolerance: (result.gate == Gate::Deterministic)
                    .then_some([deterministic::ABSOLUTE, deterministic::RELATIVE]),
                gate: gate.clone(),
                ..pictures
            }),
            gate,
        }
    }
}

/// `image` if it has pixels and not too many; says so in `notes` otherwise.
fn shown<'a, T>(image: &'a T, pixels: usize, name: &str, notes: &mut Vec<String>) -> Option<&'a T> {
    if pixels == 0 {
        notes.push(format!("The {name} has no pixels."));
    } else if pixels > MOST_PIXELS {
        notes.push(format!(
            "The {name} is left out of this page: it has {pixels} pixels, and at most \
             {MOST_PIXELS} are shown."
        ));
    } else {
        return Some(image);
    }
    None
}

fn radiance(picture: &Picture) -> Option<&Film> {
    match picture {
        Picture::Radiance(film) => Some(film),
        Picture::Codes(_) => None,
    }
}

fn not_finite(name: &str, film: &Film) -> Option<String> {
    let broken = |pixel: &[f32; 3]| pixel.iter().any(|value| !value.is_finite());
    let pixels = film.radiance();
    let first = pixels.iter().position(broken)?;
    let count = pixels.iter().filter(|pixel| broken(pixel)).count();
    Some(format!(
        "{count} of {} pixels of the {name} hold NaN or infinity; the first is at ({}, {}). They are \
         shown chequered.",
        pixels.len(),
        first % film.width(),
        first / film.width()
    ))
}

/// Nothing where there is no image.
fn pictures(
    golden: Option<&Film>,
    test: Option<&Picture>,
    pair: Option<(&Film, &Picture)>,
    exposure: f64,
) -> Option<Pictures> {
    if golden.is_none() && test.is_none() {
        return None;
    }
    let in_golden = golden.map(|film| Image {
        width: film.width(),
        height: film.height(),
        floats: Some(pixels::smooth_floats(film.radiance(), film.width())),
        codes: None,
    });
    let in_test = test.map(|picture| {
        let (width, height) = picture.size();
        let (floats, codes) = match picture {
            Picture::Codes(image) => (None, Some(pixels::codes(image.pixels(), width))),
            Picture::Radiance(_) if pair.is_some() => (None, None),
            Picture::Radiance(film) => (Some(pixels::smooth_floats(film.radiance(), width)), None),
        };
        Image {
            width,
            height,
            floats,
            codes,
        }
    });
    Some(Pictures {
        exposure,
        golden: in_golden,
        test: in_test,
        difference: pair.map(|(golden, test)| {
            pixels::floats(&differences(golden, test, exposure), golden.width())
        }),
        flip: pair.and_then(|(golden, test)| {
            let golden = Picture::Radiance(golden.clone()).srgb(exposure).ok()?;
            let errors = flip(
                &golden,
                &test.srgb(exposure).ok()?,
                DEFAULT_PIXELS_PER_DEGREE,
            );
            Some(pixels::fractions(errors.ok()?.values()))
        }),
        ..Pictures::default()
    })
}

/// Test minus golden, of radiance or of codes.
fn differences(golden: &Film, test: &Picture, exposure: f64) -> Vec<[f32; 3]> {
    match test {
        Picture::Radiance(test) => golden
            .radiance()
            .iter()
            .zip(test.radiance())
            .map(|(a, b)| [0, 1, 2].map(|c| (f64::from(b[c]) - f64::from(a[c])) as f32))
            .collect(),
        Picture::Codes(test) => golden
            .srgb_codes(exposure)
            .iter()
            .zip(test.pixels())
            .map(|(a, b)| [0, 1, 2].map(|c| f32::from(b[c]) - f32::from(a[c])))
            .collect(),
    }
}

/// Of each channel, over the pixels that are finite in both images.
fn means(golden: &Film, test: &Film) -> Vec<Mean> {
    let mut means = Vec::new();
    for (c, channel) in ["red", "green", "blue"].into_iter().enumerate() {
        let mut sums = [0.0_f64; 2];
        let mut count = 0.0_f64;
        for (a, b) in golden.radiance().iter().zip(test.radiance()) {
            if a[c].is_finite() && b[c].is_finite() {
                sums[0] += f64::from(a[c]);
                sums[1] += f64::from(b[c]);
                count += 1.0;
            }
        }
        let [a, b] = sums.map(|sum| sum / count.max(1.0));
        let ratio = match a > 0.0 && b > 0.0 {
            true => format!("× {:.4}", b / a),
            false => "–".to_owned(),
        };
        means.push(Mean {
            channel,
            golden: words::digits(a),
            test: words::digits(b),
            difference: words::digits(b - a),
            ratio,
        });
    }
    means
}

/// Over how many pixels the difference is spread.
fn spread(golden: &Film, test: &Film) -> Option<String> {
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
        _ if share < 0.05 => "in a few places, which the difference shows",
        _ if share < 0.2 => "in a part of the picture, which the difference shows",
        _ => "spread over the picture: rather a factor or an offset than a place",
    };
    Some(format!(
        "Half of all difference lies in {:.1} % of the pixels, {advice}.",
        (100.0 * share).max(0.1)
    ))
}

/// In how many blocks there is more than noise.
fn odd_blocks(map: &stochastic::BlockMap) -> String {
    let is_odd = |block: &&[f64; 3]| block.iter().any(|z| z.abs() > 5.0);
    let odd = map.deviations.iter().filter(is_odd).count();
    let side = stochastic::BLOCK;
    format!(
        "{odd} of {} blocks of {side} × {side} pixels are off by more than 5 standard errors; the z \
         map shows them.",
        map.deviations.len()
    )
}

fn packed_blocks(map: &stochastic::BlockMap) -> Blocks {
    let deviations: Vec<_> = map
        .deviations
        .iter()
        .map(|block| block.map(|z| z as f32))
        .collect();
    Blocks {
        columns: map.columns,
        rows: map.rows,
        side: stochastic::BLOCK,
        floats: pixels::floats(&deviations, map.columns),
    }
}
