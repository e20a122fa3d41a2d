//! The images of a case: which can be shown, and packed for the page.

use super::pixels;
use crate::compare::flip::{DEFAULT_PIXELS_PER_DEGREE, flip};
use crate::compare::stochastic::BLOCK;
use crate::compare::{BlockMap, DifferenceScale, Gate, Picture};
use crate::film::Film;
use crate::judging::Evidence;
use minijinja::{Value, context};

/// Images of more pixels are left out of the page: a browser could not open it.
const MOST_PIXELS: usize = 1 << 22;
/// Browsers draw no larger ones.
const MOST_SIDE: usize = 1 << 14;

/// The images of a case that the page can show.
pub(super) struct Views<'a> {
    pub(super) golden: Option<&'a Film>,
    pub(super) test: Option<&'a Picture>,
    /// Both, where they are of one size.
    pair: Option<(&'a Film, &'a Picture)>,
    /// Initial exposure, in stops.
    pub(super) exposure: f64,
    /// Remarks on the images, in words.
    pub(super) notes: Vec<String>,
}

impl<'a> Views<'a> {
    pub(super) fn of(evidence: &'a Evidence) -> Views<'a> {
        let mut notes = Vec::new();
        let golden = evidence.golden.as_ref();
        let golden = golden
            .and_then(|film| shown(film, [film.width(), film.height()], "golden", &mut notes));
        let test = evidence.test.as_ref();
        let test =
            test.and_then(|image| shown(image, image.size().into(), "test image", &mut notes));
        if evidence.golden.is_none() {
            notes.push("There is no valid golden to compare with.".to_owned());
        }
        if evidence.test.is_none() {
            notes.push("There is no readable test image.".to_owned());
        }
        let exposure = match evidence.exposure {
            stops if stops.is_finite() => stops,
            _ => 0.0,
        };
        let pair = golden
            .zip(test)
            .filter(|(golden, test)| test.size() == (golden.width(), golden.height()));
        if golden.is_some() && test.is_some() && pair.is_none() {
            let words =
                "The images differ in size: they can be viewed, but not compared pixel by pixel.";
            notes.push(words.to_owned());
        }
        Views {
            golden,
            test,
            pair,
            exposure,
            notes,
        }
    }

    /// The unit in which the gate shows the difference.
    pub(super) fn difference_scale(&self, gate: Gate) -> DifferenceScale {
        match self.pair {
            Some((golden, Picture::Radiance(test))) => DifferenceScale::of(gate, golden, test),
            _ => DifferenceScale::Radiance,
        }
    }

    /// Everything that the script needs, packed by [`pixels`]; nothing where there is no image.
    pub(super) fn packed(&self, scale: &DifferenceScale) -> Option<Value> {
        if self.golden.is_none() && self.test.is_none() {
            return None;
        }
        let golden = self.golden.map(|film| {
            context! {
                width => film.width(),
                height => film.height(),
                floats => pixels::smooth_floats(film.radiance(), film.width()),
            }
        });
        // Test minus golden: of radiance, or of 8-bit codes at the exposure.
        let difference = self.pair.map(|(golden, test)| {
            pixels::floats(&differences(golden, test, self.exposure), golden.width())
        });
        let z = match scale {
            DifferenceScale::StandardErrors(map) => Some(packed_blocks(map)),
            _ => None,
        };
        let tolerance = match *scale {
            DifferenceScale::Tolerance { absolute, relative } => Some([absolute, relative]),
            _ => None,
        };
        Some(context! {
            exposure => self.exposure,
            golden,
            test => self.test.map(|picture| self.packed_test(picture)),
            difference,
            flip => self.packed_flip(),
            z,
            tolerance,
        })
    }

    /// The test image. It has no floats where it is golden plus difference.
    fn packed_test(&self, picture: &Picture) -> Value {
        let (width, height) = picture.size();
        let (floats, codes) = match picture {
            Picture::Codes(image) => (None, Some(pixels::codes(image.pixels(), width))),
            Picture::Radiance(_) if self.pair.is_some() => (None, None),
            Picture::Radiance(film) => (Some(pixels::smooth_floats(film.radiance(), width)), None),
        };
        context! { width, height, floats, codes }
    }

    fn packed_flip(&self) -> Option<String> {
        let (golden, test) = self.pair?;
        let golden = Picture::Radiance(golden.clone()).srgb(self.exposure).ok()?;
        let test = test.srgb(self.exposure).ok()?;
        let errors = flip(&golden, &test, DEFAULT_PIXELS_PER_DEGREE).ok()?;
        Some(pixels::fractions(errors.values()))
    }
}

/// `image` if it has pixels and not too many; says so in `notes` otherwise.
fn shown<'a, T>(
    image: &'a T,
    [width, height]: [usize; 2],
    name: &str,
    notes: &mut Vec<String>,
) -> Option<&'a T> {
    if width * height == 0 {
        notes.push(format!("The {name} has no pixels."));
    } else if width * height > MOST_PIXELS || width.max(height) > MOST_SIDE {
        notes.push(format!(
            "The {name} is left out of this page: it has {width} × {height} pixels; shown are at \
             most {MOST_PIXELS} altogether and {MOST_SIDE} on a side."
        ));
    } else {
        return Some(image);
    }
    None
}

/// Test minus golden, of radiance or of codes.
fn differences(golden: &Film, test: &Picture, exposure: f64) -> Vec<[f32; 3]> {
    fn of<T: Copy + Into<f64>>(golden: &[[T; 3]], test: &[[T; 3]]) -> Vec<[f32; 3]> {
        let difference =
            |(a, b): (&[T; 3], &[T; 3])| [0, 1, 2].map(|c| (b[c].into() - a[c].into()) as f32);
        golden.iter().zip(test).map(difference).collect()
    }
    match test {
        Picture::Radiance(test) => of(golden.radiance(), test.radiance()),
        Picture::Codes(test) => of(&golden.srgb_codes(exposure), test.pixels()),
    }
}

fn packed_blocks(map: &BlockMap) -> Value {
    let deviations = map.deviations.iter();
    let deviations: Vec<_> = deviations.map(|block| block.map(|z| z as f32)).collect();
    context! {
        columns => map.columns,
        rows => map.rows,
        side => BLOCK,
        floats => pixels::floats(&deviations, map.columns),
    }
}
