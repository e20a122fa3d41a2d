//! Honest images in the formats and with the statements of noise that renderers have: none is rejected.
//!
//! Each case is rendered once for each seed and number of samples, as four renderings that are then encoded in
//! every way.

use crate::common::suite::{case_of, film_with, silent, suite};
use half::f16;
use std::collections::BTreeMap;
use volref::compare::Picture;
use volref::compare::flip::SrgbImage;
use volref::film::{Bits, Encoding, Film, Origin, Quantisation};
use volref::judging::{CaseResult, Verdict, declared, validate};
use volref::suite::{Case, Golden, Output};

/// Cases without noise: of these there is one honest image.
const WITHOUT_NOISE: [&str; 3] = ["figures/figure-1", "figures/figure-3", "figures/figure-5"];

const SAMPLED: [&str; 10] = [
    "smoke/cornell",
    "fog/rate-0.1",
    "fog/spotlight",
    "fog/forward",
    "procedural/coloured",
    "procedural/gain-0.5",
    "known-answers/slab-reflection",
    "hard/s4-white-things",
    "known-answers/half-space",
    "hard/s10-coloured-furnace",
];

/// Renderings of an image.
const RENDERINGS: u32 = 4;

/// Rounding of means, and of variances that are stored beside them.
type Round = fn(f32) -> f32;

fn kept(value: f32) -> f32 {
    value
}

fn half(value: f32) -> f32 {
    f16::from_f32(value).to_f32()
}

/// Six decimals, as `printf` writes them.
fn text(value: f32) -> f32 {
    format!("{value:.6}").parse().unwrap()
}

/// Six significant digits.
fn digits(value: f32) -> f32 {
    format!("{value:.5e}").parse().unwrap()
}

/// The least that a sum of 64 samples in single precision may come to.
fn summed(value: f32) -> f32 {
    value * (1.0 - 64.0 / 33_554_432.0)
}

const ROUNDINGS: [(&str, Round, Round); 6] = [
    ("float", kept, kept),
    ("half", half, kept),
    ("half, its variance too", half, half),
    ("text of 6 decimals", text, digits),
    ("sums of single precision", summed, kept),
    ("such sums as half", |value| half(summed(value)), kept),
];

/// `film` with other values, and what it says of its noise.
fn rounded(film: &Film, [mean, variance]: [Round; 2]) -> Film {
    let each = |pixels: &[[f32; 3]], round: Round| pixels.iter().map(|it| it.map(round)).collect();
    let (width, height) = (film.width(), film.height());
    let means = each(film.radiance(), mean);
    match film.noise() {
        None => Film::new(width, height, means),
        Some(noise) => {
            let variances = each(noise.variance(), variance);
            Film::with_noise(width, height, means, variances, noise.samples())
        }
    }
}

/// Codes of 8 bits by both curves.
fn codes(case: &Case) -> [(&'static str, Quantisation); 2] {
    let of = |encoding, exposure| Quantisation {
        encoding,
        exposure,
        origin: Origin::Declared,
        blended: false,
    };
    [
        ("8-linear", of(Encoding::Linear, 0.0)),
        ("8-srgb", of(Encoding::Srgb, case.exposure)),
    ]
}

/// An image with its format, its statement of noise and the bits that are declared for it.
struct Honest {
    format: &'static str,
    noise: &'static str,
    bits: Option<&'static str>,
    picture: Picture,
}

/// `renderings` of one image in every format, with every statement of noise.
fn in_every_way(case: &Case, renderings: &[Film]) -> Vec<Honest> {
    let mut all = Vec::new();
    let mut add = |format, noise, bits, film| {
        let picture = Picture::Radiance(film);
        all.push(Honest {
            format,
            noise,
            bits,
            picture,
        });
    };
    let is_noisy = renderings.len() > 1;
    let whole = if is_noisy {
        Film::from_replicates(renderings).unwrap()
    } else {
        renderings[0].clone()
    };
    // Renderings that do not say how many samples they have. Those that rounding makes equal are refused.
    let pooled = |of: &dyn Fn(&Film) -> Film| {
        let films: Vec<Film> = renderings.iter().map(of).collect();
        Film::from_replicates(&films).ok()
    };
    for (format, mean, variance) in ROUNDINGS {
        let film = rounded(&whole, [mean, variance]);
        add(format, "none", None, silent(&film));
        if is_noisy {
            add(format, "variance", None, film);
            if let Some(film) = pooled(&|film| silent(&rounded(film, [mean, variance]))) {
                add(format, "renderings", None, film);
            }
        }
    }
    for (bits, curve) in codes(case) {
        let film = silent(&curve.rounded(&whole));
        add(bits, "none", Some(bits), film.clone());
        if let Some(noise) = whole.noise() {
            let variance = Film::new(film.width(), film.height(), noise.variance().to_vec());
            let film = film.with_variance_of(&variance, noise.samples()).unwrap();
            add(bits, "variance", Some(bits), film);
            if let Some(film) = pooled(&|film| silent(&curve.rounded(film))) {
                add(bits, "renderings", Some(bits), film);
            }
        }
    }
    let (width, height, codes) = Film::codes_from_png(&whole.to_png(case.exposure)).unwrap();
    let codes = SrgbImage::new(width, height, codes).unwrap();
    all.push(Honest {
        format: "PNG",
        noise: "none",
        bits: is_noisy.then_some("8-srgb"),
        picture: Picture::Codes(codes),
    });
    all
}

fn judged(case: &Case, image: &Honest) -> CaseResult {
    let output = Output::Picture(Box::new(image.picture.clone()));
    let bits = image.bits.map(|bits| bits.parse::<Bits>().unwrap());
    validate(case, &suite().store(), declared(output, bits, case), None).result
}

/// Images and alarms by case, format and statement of noise.
#[derive(Default)]
struct Table {
    rows: BTreeMap<[String; 3], [u32; 2]>,
    alarms: Vec<String>,
}

impl Table {
    fn judge(&mut self, case: &Case, what: &str, renderings: &[Film]) {
        for image in in_every_way(case, renderings) {
            let result = judged(case, &image);
            let is_alarm = !matches!(result.verdict, Verdict::Pass | Verdict::Inconclusive);
            let row = [case.name.as_str(), image.format, image.noise].map(str::to_owned);
            let [images, alarms] = self.rows.entry(row).or_default();
            *images += 1;
            *alarms += u32::from(is_alarm);
            if is_alarm {
                let what = format!(
                    "{} {what}, {}, noise: {}",
                    case.name, image.format, image.noise
                );
                println!("{what}: {}", result.reason);
                self.alarms.push(what);
            }
        }
    }

    fn judge_sampled(&mut self, name: &str, samples: u32, seed: u64) {
        let case = case_of(name);
        let scene = case.load_scene().unwrap();
        let rendering =
            |at: u32| film_with(&scene, samples / RENDERINGS, 1000 * seed + u64::from(at));
        let renderings: Vec<Film> = (0..RENDERINGS).map(rendering).collect();
        let what = format!("{samples} samples, seed {seed}");
        self.judge(case, &what, &renderings);
    }

    fn judge_without_noise(&mut self, name: &str) {
        let case = case_of(name);
        let golden = Golden::read(&suite().store(), case).unwrap().film;
        self.judge(case, "as it is", &[silent(&golden)]);
    }

    fn images(&self) -> u32 {
        self.rows.values().map(|[images, _]| images).sum()
    }

    fn print(&self) {
        println!("| case | format | noise stated by | images | alarms |\n|---|---|---|---:|---:|");
        for ([case, format, noise], [images, alarms]) in &self.rows {
            println!("| {case} | {format} | {noise} | {images} | {alarms} |");
        }
        println!("{} images, {} alarms", self.images(), self.alarms.len());
    }
}

/// A sky without noise beside smoke, wild samples that 8 bits cut off, and a figure.
#[test]
fn an_honest_image_is_accepted_in_every_format() {
    let mut table = Table::default();
    table.judge_without_noise("figures/figure-3");
    table.judge_sampled("procedural/coloured", 16, 1);
    table.judge_sampled("fog/forward", 16, 2);
    assert!(table.alarms.is_empty(), "{:#?}", table.alarms);
    assert!(table.images() >= 50, "{}", table.images());
}

#[test]
#[ignore = "minutes: scripts/nightly.sh runs it"]
fn five_hundred_honest_images_raise_no_alarm() {
    let mut table = Table::default();
    for name in WITHOUT_NOISE {
        table.judge_without_noise(name);
    }
    for name in SAMPLED {
        for samples in [16, 64] {
            for seed in 1..=2 {
                table.judge_sampled(name, samples, seed);
            }
        }
    }
    table.print();
    assert!(table.alarms.is_empty(), "{:#?}", table.alarms);
    assert!(table.images() >= 500, "{}", table.images());
}
