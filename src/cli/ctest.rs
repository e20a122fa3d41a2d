//! Measurements and pictures for CTest, which collects lines of this form from the output of a test and
//! shows them on a dashboard (CMake 3.21 or newer).
//!
//! Sources: <https://cmake.org/cmake/help/latest/command/ctest_test.html#additional-test-measurements>; for the names of
//! pictures `docs/test_measurements.md` of CDash.

use super::compare::heatmap;
use super::failure::{Failure, bad_input};
use super::output;
use crate::compare::Picture;
use crate::files::visible::xml_text;
use crate::judging::{Evidence, Judged};
use std::path::{Path, PathBuf};

/// Names by which CDash lays the pictures of a test over each other, with a slider, and shows their difference.
const GOLDEN: &str = "ValidImage";
const TEST: &str = "TestImage";
const DIFFERENCE: &str = "DifferenceImage2";

/// Elements of a measurement, with the types of their values.
const WORDS: [&str; 2] = ["CTestMeasurement", "text/string"];
const NUMBER: [&str; 2] = ["CTestMeasurement", "numeric/double"];
const PICTURE: [&str; 2] = ["CTestMeasurementFile", "image/png"];

/// Writes the golden, the test image and their difference of each case into `folder` as PNG; returns the
/// lines that name them, with those of the verdict and the metrics. Names begin with the case if there are several.
pub fn measurements(judged: &[Judged], folder: &Path) -> Result<String, Failure> {
    let mut lines = String::new();
    for of_case in judged {
        let result = &of_case.result;
        let named = |name: &str| match judged {
            [_] => name.to_owned(),
            _ => format!("{} {name}", result.name),
        };
        let mut line = |[element, kind]: [&str; 2], name: &str, value: &str| {
            let (name, value) = (xml_text(&named(name)), xml_text(value));
            lines.push_str(&format!(
                "<{element} type=\"{kind}\" name=\"{name}\">{value}</{element}>\n"
            ));
        };
        line(WORDS, "verdict", result.verdict.name());
        if !result.looks_like.is_empty() {
            line(WORDS, "looks like", &result.looks_like.join(", "));
        }
        for (name, value) in &result.metrics {
            line(NUMBER, name, &value.to_string());
        }
        for (name, path) in pictures(of_case, folder)? {
            let path = std::path::absolute(&path).unwrap_or(path);
            line(PICTURE, name, &path.display().to_string());
        }
    }
    Ok(lines)
}

/// Writes the pictures of a case, as far as it has any; returns their names for CDash and their files.
fn pictures(judged: &Judged, folder: &Path) -> Result<Vec<(&'static str, PathBuf)>, Failure> {
    let Evidence {
        golden,
        test,
        exposure,
        ..
    } = &judged.evidence;
    let png = |picture: &Picture| -> Result<Vec<u8>, Failure> {
        let image = picture.srgb(*exposure).map_err(bad_input)?;
        Ok(image.to_png())
    };
    let golden = golden.clone().map(Picture::Radiance);
    let mut pictures = Vec::new();
    if let Some(golden) = &golden {
        pictures.push((GOLDEN, "golden.png", png(golden)?));
    }
    if let Some(test) = test {
        pictures.push((TEST, "test.png", png(test)?));
    }
    // There is no difference of images of other sizes, or of values that are not finite.
    if let (Some(golden), Some(test)) = (&golden, test)
        && let Ok(png) = heatmap(golden, test, *exposure)
    {
        pictures.push((DIFFERENCE, "difference.png", png));
    }
    let write = |(name, file, png): (&'static str, &str, Vec<u8>)| {
        let file = Path::new(&judged.result.name).join(file);
        Ok((name, output::write_within(folder, &file, &png)?))
    };
    pictures.into_iter().map(write).collect()
}
