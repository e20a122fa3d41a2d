//! Results of many renderers as one offline page: cases down, renderers across.

use super::html::{pixels::thumbnail, words};
use super::template::{blue_to_red, image_address, rendered};
use crate::compare::flip::SrgbImage;
use crate::compare::{Picture, recognised};
use crate::film::{CHANNELS, Film};
use crate::judging::{CaseResult, Summary, Verdict};
use crate::naming::NOTHING_STANDS_OUT;
use crate::suite::NOT_RENDERED;
use minijinja::{Value, context};
use std::collections::BTreeMap;

/// Longest side of a picture: that of forty cases and ten renderers fit in some 20 MB.
const SIDE: usize = 128;

/// Differences of this share of the pixels may lie beyond the scale of a case.
const BEYOND: f64 = 1e-3;

/// Standard errors of a 95 % interval.
const INTERVAL: f64 = 1.96;

/// A renderer and its results.
#[derive(Clone, Debug, Default)]
pub(crate) struct GalleryRenderer {
    /// Name.
    pub name: String,
    /// Version.
    pub version: Option<String>,
    /// Day of the run.
    pub date: Option<String>,
    /// Command that repeats the run.
    pub command: Option<String>,
    /// Profile under whose conventions its images were judged.
    pub profile: Option<String>,
    /// Results of its cases.
    pub results: Vec<CaseResult>,
    /// Wall time of its images, by case, where it was measured.
    pub seconds: BTreeMap<String, f64>,
}

/// Row of a case.
pub(crate) struct GalleryRow(Value);

/// Golden of a case, and its name.
pub(crate) struct GalleryCase<'c> {
    /// `family/name`.
    pub name: &'c str,
    /// Exposure of the images, in stops.
    pub exposure: f64,
    /// The golden, or the reason why there is none.
    pub golden: Result<Film, String>,
}

/// Result of one renderer for a case.
pub(crate) struct GalleryCell<'c> {
    /// The result.
    pub result: &'c CaseResult,
    /// The image, if it is readable.
    pub picture: Option<Picture>,
    /// Wall time of the image.
    pub seconds: Option<f64>,
}

/// The row of a case: a cell for each renderer, in their order.
pub(crate) fn gallery_row(case: &GalleryCase<'_>, cells: &[Option<GalleryCell<'_>>]) -> GalleryRow {
    let golden = case.golden.as_ref().ok();
    let codes = golden.and_then(|film| shown(&Picture::Radiance(film.clone()), case.exposure));
    let shown: Vec<Option<SrgbImage>> = cells
        .iter()
        .map(|cell| shown(cell.as_ref()?.picture.as_ref()?, case.exposure))
        .collect();
    let differences: Vec<Option<Differences>> = shown
        .iter()
        .map(|image| Differences::of(codes.as_ref()?, image.as_ref()?))
        .collect();
    let scales = differences.iter().flatten().map(Differences::scale);
    let scale = scales.fold(1.0, f64::max);
    let means = golden.map(means);
    let cell =
        |((cell, image), difference): ((&Option<GalleryCell<'_>>, &_), &Option<Differences>)| {
            let image: &Option<SrgbImage> = image;
            let GalleryCell {
                result,
                picture,
                seconds,
            } = cell.as_ref()?;
            let film = picture.as_ref().and_then(Picture::radiance);
            let hidden = golden
                .zip(film)
                .and_then(|(golden, film)| hidden(golden, film, case.exposure));
            Some(context! {
                verdict => result.verdict.name(),
                symbol => words::symbol(result.verdict),
                said => said(result),
                fault => fault(result),
                bias => means.and_then(|means| bias(result, means, hidden)),
                seconds => seconds.map(in_words),
                reason => result.reason,
                notes => result.notes,
                conventions => result.conventions,
                profile => result.profile,
                differences => result.difference,
                changes => result.changes.iter().map(|change| &change.words).collect::<Vec<_>>(),
                picture => image.as_ref().map(small),
                difference => difference.as_ref().map(|of| of.picture(scale)),
            })
        };
    let all = cells.iter().zip(&shown).zip(&differences);
    GalleryRow(context! {
        name => case.name,
        parts => case.name.split('/').collect::<Vec<_>>(),
        trouble => case.golden.as_ref().err(),
        golden => codes.as_ref().map(small),
        scale => differences.iter().any(Option::is_some).then(|| format!("{scale:.0}")),
        cells => all.map(cell).collect::<Vec<_>>(),
    })
}

/// The page as a complete HTML file. It loads nothing else and works from `file://`.
pub(crate) fn gallery_html(renderers: &[GalleryRenderer], rows: &[GalleryRow]) -> String {
    let renderer = |of: &GalleryRenderer| {
        let counts = Summary::of(&of.results).in_words();
        let counts = counts.into_iter().filter(|(count, _)| *count > 0);
        let counts = counts.map(|(count, word)| format!("{count} {word}"));
        context! {
            name => of.name,
            version => of.version,
            date => of.date,
            command => of.command,
            profile => of.profile,
            counts => counts.collect::<Vec<_>>().join(", "),
            seconds => median(of.seconds.values().copied()).map(in_words),
        }
    };
    let colours = (0..=16).map(|step| {
        let [red, green, blue] = blue_to_red(f64::from(step) / 8.0 - 1.0);
        format!("rgb({red} {green} {blue})")
    });
    let verdicts = [
        Verdict::Pass,
        Verdict::Convention,
        Verdict::Fail,
        Verdict::Inconclusive,
        Verdict::Missing,
        Verdict::Error,
    ];
    rendered(
        include_str!("gallery/template.html"),
        context! {
            version => env!("CARGO_PKG_VERSION"),
            renderers => renderers.iter().map(renderer).collect::<Vec<_>>(),
            rows => rows.iter().map(|row| &row.0).collect::<Vec<_>>(),
            verdicts => verdicts.map(Verdict::name),
            colours => colours.collect::<Vec<_>>().join(", "),
            style => include_str!("gallery/page.css"),
            script => include_str!("gallery/page.js"),
        },
    )
}

/// The image as it is displayed, if it has pixels.
fn shown(picture: &Picture, exposure: f64) -> Option<SrgbImage> {
    picture.srgb(exposure).ok()
}

fn small(image: &SrgbImage) -> String {
    thumbnail(image.pixels(), image.width(), SIDE)
}

/// Verdict in a word or two.
fn said(result: &CaseResult) -> &'static str {
    match result.verdict {
        Verdict::Missing if result.reason.starts_with(NOT_RENDERED) => "cannot say",
        Verdict::Missing => "no image",
        verdict => verdict.name(),
    }
}

/// Cause in words: conventions, the likely mistake, or measurements.
fn fault(result: &CaseResult) -> String {
    let best = result.changes.iter().filter(|change| change.fits_best);
    let best: Vec<&str> = best.map(|change| change.words.as_str()).collect();
    let measured = result.difference.first();
    let measured = measured.filter(|sentence| *sentence != NOTHING_STANDS_OUT);
    match result.verdict {
        Verdict::Pass => String::new(),
        Verdict::Convention => result.conventions.join("; "),
        _ if !result.looks_like.is_empty() => format!("looks like {}", result.looks_like[0]),
        Verdict::Fail if !best.is_empty() => best.join("; "),
        verdict => {
            let reason = &result.reason;
            let reason = reason.strip_prefix(NOT_RENDERED).unwrap_or(reason);
            let measured = measured.filter(|_| verdict == Verdict::Fail);
            measured.map_or(reason, String::as_str).to_owned()
        }
    }
}

fn means(golden: &Film) -> [f64; 3] {
    let count = golden.radiance().len().max(1) as f64;
    [0, 1, 2].map(|c| {
        let channel = golden.radiance().iter().map(|pixel| f64::from(pixel[c]));
        channel.sum::<f64>() / count
    })
}

/// Bias of the mean that the rounding of `film` to 8 bits hides at most, in percent: gates compare the nearest of all
/// images that round to it, so that any within half a code shows none.
fn hidden(golden: &Film, film: &Film, exposure: f64) -> Option<f64> {
    let known = film.quantisation();
    let known = known.or_else(|| recognised(golden, film.clone(), exposure).quantisation())?;
    let share = |c: usize| {
        let values = || golden.radiance().iter().map(|pixel| f64::from(pixel[c]));
        values().map(|value| known.half_code(value)).sum::<f64>() / values().sum::<f64>()
    };
    let shares = [0, 1, 2].map(share).into_iter();
    shares
        .filter(|share| share.is_finite())
        .max_by(f64::total_cmp)
        .map(|share| 100.0 * share)
}

/// Bias of the mean of the channel that has most, in percent of the golden's, with its 95 % interval where it has
/// noise, and with what 8 bits hide of it.
fn bias(result: &CaseResult, means: [f64; 3], hidden: Option<f64>) -> Option<String> {
    let of = |c: usize| {
        let metric = |kind| result.metrics.get(&format!("{kind}_{}", CHANNELS[c]));
        let percent = 100.0 / means[c];
        let difference = *metric("mean_difference")?;
        let error = metric("mean_z").map_or(0.0, |z| (difference / z).abs());
        let all = [difference * percent, INTERVAL * error * percent];
        all.iter()
            .all(|number| number.is_finite())
            .then_some((CHANNELS[c], all))
    };
    let most = (0..3)
        .filter_map(of)
        .max_by(|a, b| a.1[0].abs().total_cmp(&b.1[0].abs()))?;
    let (channel, [size, interval]) = most;
    let sign = if size < 0.0 { "−" } else { "+" };
    let size = size.abs();
    let text = match interval {
        _ if interval > 0.0 => {
            // Two digits of the interval.
            let digits = [10.0, 1.0, 0.1, 0.01]
                .iter()
                .take_while(|&&least| interval < least)
                .count();
            format!("{channel} {sign}{size:.digits$} ± {interval:.digits$} %")
        }
        _ if size < 0.005 => "below 0.005 %".to_owned(),
        _ => format!("{channel} {sign}{size:.2} %"),
    };
    Some(match hidden {
        Some(most) if size < 0.005 => format!("hidden by 8 bits: up to {most:.2} %"),
        Some(most) => format!("{text}; hidden by 8 bits: up to {most:.2} %"),
        None => text,
    })
}

/// Differences of an image from the golden, the mean of the channels, in codes of 255.
struct Differences {
    width: usize,
    codes: Vec<f64>,
}

impl Differences {
    /// Nothing of images of different sizes.
    fn of(golden: &SrgbImage, test: &SrgbImage) -> Option<Differences> {
        let is_alike = golden.width() == test.width() && golden.height() == test.height();
        let pairs = golden.pixels().iter().zip(test.pixels());
        let mean = |(a, b): (&[u8; 3], &[u8; 3])| {
            let sum: i32 = (0..3).map(|c| i32::from(b[c]) - i32::from(a[c])).sum();
            f64::from(sum) / 3.0
        };
        is_alike.then(|| Differences {
            width: golden.width(),
            codes: pairs.map(mean).collect(),
        })
    }

    /// A size that few are beyond.
    fn scale(&self) -> f64 {
        let mut sizes: Vec<f64> = self.codes.iter().map(|code| code.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let beyond = (sizes.len() as f64 * BEYOND).ceil() as usize;
        sizes[sizes.len().saturating_sub(1 + beyond)]
    }

    /// The address of a picture: of several pixels in one, that which differs most.
    fn picture(&self, scale: f64) -> String {
        let height = self.codes.len() / self.width;
        let step = self.width.max(height).div_ceil(SIDE);
        let (columns, rows) = (self.width.div_ceil(step), height.div_ceil(step));
        let mut most = vec![0.0_f64; columns * rows];
        for (at, &code) in self.codes.iter().enumerate() {
            let most = &mut most[at / self.width / step * columns + at % self.width / step];
            if code.abs() > most.abs() {
                *most = code;
            }
        }
        let colours: Vec<_> = most
            .iter()
            .map(|code| blue_to_red(root(code / scale)))
            .collect();
        image_address(&colours, columns, rows)
    }
}

/// The root of the size, with the sign: so that small differences are seen beside large ones.
fn root(share: f64) -> f64 {
    share.abs().sqrt().min(1.0).copysign(share)
}

fn in_words(seconds: f64) -> String {
    let digits = if seconds < 0.1 { 3 } else { 2 };
    format!("{seconds:.digits$}")
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
