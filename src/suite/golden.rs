//! Goldens: an image and its provenance.

use super::{Case, Store, StoreError};
use crate::compare::stochastic;
use crate::film::{Film, FilmError};
use crate::render::Plan;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Version of the pinned `libm`, whose last bits every image depends on. `Cargo.toml` pins it;
/// a test compares the two.
pub const LIBM_VERSION: &str = "0.2.16";

/// Provenance of a golden: the `.toml` beside the image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// `volref/golden/1`.
    pub schema: String,
    /// `family/name`.
    pub case: String,
    /// Reason for the last change of the image, given at its acceptance.
    pub reason: String,
    /// Reason for rewriting this record with the image unchanged; empty if it is as old as the
    /// image.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub record_reason: String,
    /// Hash of the image it replaced; empty for a first golden.
    pub replaces: String,
    /// Pixels that differ in any bit of colour or opacity from the image it replaced; left out for a first golden, and
    /// where the sizes differ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub changed_pixels: Option<u64>,
    /// Hash of the pixels of the EXR image.
    pub pixels: String,
    /// Hash of the preview file.
    pub preview: String,
    /// Hash of the file of sensitivities, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivities: Option<String>,
    /// Exposure of the preview, in stops.
    pub exposure: f64,
    /// Hash of the canonical scene: every key with its value.
    pub scene: String,
    /// Hash of the plan: the effects simulated and omitted.
    pub plan: String,
    /// Effects that the scene could have requested and did not, by panel.
    pub omitted: Vec<Vec<String>>,
    /// Columns of pixels.
    pub width: usize,
    /// Rows of pixels.
    pub height: usize,
    /// Samples per pixel; 0 of a known answer.
    pub samples: u64,
    /// Seed of the scene's random numbers; 0 for an image without any. The quick rendering uses
    /// it as it is, this image 2⁶³ more, so that they have no random number in common.
    pub seed: u64,
    /// Relative error of the image. Deterministic: of a pixel against the sum that the scene
    /// defines, by rounding to 32 bits. Limit: of a pixel against the integral, by its bound, relative
    /// to the brightest pixel, and by that rounding. Stochastic: the standard error of a block of 8 × 8 pixels,
    /// relative to its mean plus [`DARK`](crate::compare::stochastic::DARK), that nine tenths of the
    /// blocks and channels do not exceed. Known answer: a bound for any pixel.
    pub error_estimate: f64,
    /// Version of volref.
    pub volref: String,
    /// Version of `libm`.
    pub libm: String,
    /// Platform of the rendering; the bits are the same on all platforms.
    pub target: String,
    /// Hash of this file without this line, to detect other changes.
    pub seal: String,
    /// Hashes of the files the scene names, by path.
    pub inputs: BTreeMap<String, String>,
    /// Keys of the manifest that change how images are judged, with their values.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub judged_by: BTreeMap<String, String>,
    /// Formula of the image, if that is a known answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<String>,
    /// For a stochastic case or a known answer: the rendering, of few samples, that `verify` repeats.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quick: Option<Quick>,
}

/// The quick rendering of a stochastic case, or the one rendering of a deterministic case with a known
/// answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quick {
    /// Samples per pixel.
    pub samples: u32,
    /// Hash of its pixels, noise included.
    pub pixels: String,
}

impl Provenance {
    /// The value of [`Provenance::schema`].
    pub const SCHEMA: &str = "volref/golden/1";

    fn to_toml(&self) -> String {
        toml::to_string(self).expect("plain data becomes TOML")
    }

    /// The correct value of [`Provenance::seal`].
    fn seal(&self) -> String {
        let unsealed = Provenance {
            seal: String::new(),
            ..self.clone()
        };
        hash(unsealed.to_toml().as_bytes())
    }
}

/// The reasons of a golden: [`Provenance::reason`] and [`Provenance::record_reason`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reasons<'a> {
    pub picture: &'a str,
    pub record: &'a str,
}

/// The image of a new golden.
pub(crate) struct GoldenImage {
    pub film: Film,
    /// Bound on its error, if it is a known answer or a limit.
    pub error: Option<f64>,
    /// The rendering that `verify` repeats.
    pub quick: Option<Quick>,
    /// Its file of sensitivities, if there is one.
    pub sensitivities: Option<Vec<u8>>,
}

impl GoldenImage {
    /// The value of [`Provenance::sensitivities`].
    pub fn sensitivities_hash(&self) -> Option<String> {
        self.sensitivities.as_deref().map(hash)
    }
}

/// A golden with its image and provenance.
#[derive(Clone, Debug, PartialEq)]
pub struct Golden {
    /// Provenance of the image.
    pub provenance: Provenance,
    /// The image.
    pub film: Film,
    /// Its file of sensitivities, if there is one.
    pub(crate) sensitivities: Option<Vec<u8>>,
}

/// How to accept the image of a case.
pub(crate) fn accept_advice(case: &Case) -> String {
    let (scene, name, suite) = (quoted_scene(case), &case.name, &case.suite_option);
    format!(
        "look at the image (volref render {scene} -o now.exr), then accept it (volref accept {name}{suite} --reason ...)"
    )
}

fn quoted_scene(case: &Case) -> String {
    shell_words::quote(&case.scene.display().to_string()).into_owned()
}

/// Reason why a case has no trustworthy golden.
#[derive(Debug, Error)]
pub enum GoldenError {
    /// All its files are missing.
    #[error("there is no golden yet; {0}")]
    Missing(String),
    /// A file is missing, or is not what was accepted.
    #[error("{0}")]
    Untrusted(String),
    /// The files below the goldens are in disorder.
    #[error(transparent)]
    Store(#[from] StoreError),
}

impl GoldenError {
    /// Sensitivities of `case` that are not those of its golden.
    pub(crate) fn sensitivities(case: &Case, fault: impl Display) -> GoldenError {
        let (file, scene) = (shown(&sensitivities_file(case)), quoted_scene(case));
        let (name, suite) = (&case.name, &case.suite_option);
        GoldenError::Untrusted(format!(
            "{file} {fault}; restore the golden from version control, or make this file anew (volref sensitivity \
             {scene} --all -o FILE) and record it (volref accept {name}{suite} --keep-images --reason ...)"
        ))
    }
}

/// First twelve digits of a hash: enough to tell two apart by eye.
pub(crate) fn short(hash: &str) -> String {
    hash.chars().take(12).collect()
}

pub(super) fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// Hash of the canonical scene.
pub(crate) fn scene_hash(scene: &Scene) -> String {
    hash(scene.canonical_text().as_bytes())
}

/// Hash of the plans of all panels.
pub(crate) fn plan_hash(plans: &[Plan<'_>]) -> String {
    let text: Vec<_> = plans.iter().map(Plan::canonical_text).collect();
    hash(text.join("\n").as_bytes())
}

/// Hashes of the files a scene names, by the path it gives.
pub(crate) fn input_hashes(scene: &Scene) -> BTreeMap<String, String> {
    let files = scene.panels.iter().flat_map(|panel| &panel.inputs);
    files
        .map(|file| (file.name.clone(), file.hash.clone()))
        .collect()
}

/// Pixels of two images of one size that differ in any bit of colour or opacity.
fn changed_pixels(old: &Film, new: &Film) -> Option<u64> {
    if (old.width(), old.height()) != (new.width(), new.height()) {
        return None;
    }
    let bits = |film: &Film, index: usize| {
        let opacity = film.opacity().map(|opacity| opacity[index].to_bits());
        (film.radiance()[index].map(f32::to_bits), opacity)
    };
    let differs = |index: &usize| bits(old, *index) != bits(new, *index);
    Some((0..old.radiance().len()).filter(differs).count() as u64)
}

/// A path below the goldens, for people.
fn shown(file: &Path) -> String {
    format!("golden/{}", file.display())
}

/// The three files of the golden of `case`: image, preview, provenance; relative to the folder
/// of goldens.
pub(crate) fn files(case: &Case) -> [PathBuf; 3] {
    [".exr", ".png", ".toml"].map(|extension| PathBuf::from(format!("{}{extension}", case.name)))
}

/// Folder of sensitivities among the goldens.
pub(crate) const SENSITIVITIES: &str = "sensitivities";

/// The file of sensitivities of `case`, relative to the folder of goldens.
pub(crate) fn sensitivities_file(case: &Case) -> PathBuf {
    PathBuf::from(SENSITIVITIES).join(format!("{}.exr", case.name))
}

impl Golden {
    /// Reads and checks the golden of `case`. Never writes.
    pub fn read(store: &Store, case: &Case) -> Result<Golden, GoldenError> {
        let golden = Golden::read_with_any_sensitivities(store, case)?;
        let found = golden.sensitivities.as_deref().map(hash);
        let fault = match (found, &golden.provenance.sensitivities) {
            (found, recorded) if found == *recorded => return Ok(golden),
            (None, _) => "is missing".to_owned(),
            (Some(found), Some(recorded)) => format!(
                "has changed since it was accepted: its hash is {}, the golden records {}",
                short(&found),
                short(recorded)
            ),
            (Some(_), None) => "is not recorded by the golden".to_owned(),
        };
        Err(GoldenError::sensitivities(case, fault))
    }

    /// [`Golden::read`], whatever sensitivities are there: an accept records them anew.
    pub(crate) fn read_with_any_sensitivities(
        store: &Store,
        case: &Case,
    ) -> Result<Golden, GoldenError> {
        let [image, preview, record] = files(case);
        let paths = [image, preview, record, sensitivities_file(case)];
        let mut contents = store.read_all(&paths)?;
        let sensitivities = contents.pop().flatten();
        if contents.iter().all(Option::is_none) {
            return Err(GoldenError::Missing(accept_advice(case)));
        }
        let shown = |index: usize| shown(&paths[index]);
        let restore = |fault: String| {
            GoldenError::Untrusted(format!("{fault}; restore it from version control"))
        };
        let incomplete = |index| {
            restore(format!(
                "the golden is incomplete: {} is missing",
                shown(index)
            ))
        };
        let mut bytes = Vec::new();
        for (index, content) in contents.into_iter().enumerate() {
            bytes.push(content.ok_or_else(|| incomplete(index))?);
        }
        let unreadable =
            |index: usize, reason: String| restore(format!("{}: {reason}", shown(index)));
        let text = std::str::from_utf8(&bytes[2])
            .map_err(|_| unreadable(2, "not UTF-8 text".to_owned()))?;
        let provenance: Provenance =
            toml::from_str(text).map_err(|error| unreadable(2, error.message().to_owned()))?;
        if provenance.schema != Provenance::SCHEMA {
            let reason = format!("its schema is {:?}, not known here", provenance.schema);
            return Err(unreadable(2, reason));
        }
        let film = Film::from_exr(&bytes[0]).map_err(|error| unreadable(0, error.to_string()))?;
        let (width, height) = (provenance.width, provenance.height);
        if (film.width(), film.height()) != (width, height) {
            let reason = format!(
                "the image has {} × {} pixels, but {} says {width} × {height}",
                film.width(),
                film.height(),
                shown(2)
            );
            return Err(unreadable(0, reason));
        }
        for (index, found, expected) in [
            (2, provenance.seal(), &provenance.seal),
            (0, film.pixel_hash(), &provenance.pixels),
            (1, hash(&bytes[1]), &provenance.preview),
        ] {
            if found != *expected {
                return Err(restore(format!(
                    "{} has changed since it was accepted: its hash is {}, the golden records {}",
                    shown(index),
                    short(&found),
                    short(expected)
                )));
            }
        }
        Ok(Golden {
            provenance,
            film,
            sensitivities,
        })
    }

    /// The golden of `case` made from an image, of which the error is known if it is a known answer,
    /// and the contents of its three files.
    pub(crate) fn encode(
        case: &Case,
        scene: &Scene,
        plans: &[Plan<'_>],
        image: GoldenImage,
        reasons: Reasons<'_>,
        old: Option<&Golden>,
    ) -> Result<Vec<(PathBuf, Vec<u8>)>, FilmError> {
        let sensitivities = image.sensitivities_hash();
        let GoldenImage {
            film, error, quick, ..
        } = image;
        let exr = film.to_exr()?;
        let png = film.to_png(case.exposure);
        let provenance = Provenance {
            schema: Provenance::SCHEMA.to_owned(),
            case: case.name.clone(),
            reason: reasons.picture.to_owned(),
            record_reason: reasons.record.to_owned(),
            replaces: old.map_or(String::new(), |old| old.provenance.pixels.clone()),
            changed_pixels: old.and_then(|old| changed_pixels(&old.film, &film)),
            pixels: film.pixel_hash(),
            preview: hash(&png),
            sensitivities,
            exposure: case.exposure,
            scene: scene_hash(scene),
            plan: plan_hash(plans),
            omitted: plans.iter().map(Plan::omitted).collect(),
            width: film.width(),
            height: film.height(),
            samples: match case.truth {
                Some(_) => 0,
                None => film.noise().map_or(1, |noise| noise.samples().into()),
            },
            seed: quick.as_ref().and(scene.seed()).unwrap_or(0),
            error_estimate: error
                .or_else(|| stochastic::block_error(&film))
                .unwrap_or(f64::from(f32::EPSILON) / 2.0),
            volref: env!("CARGO_PKG_VERSION").to_owned(),
            libm: LIBM_VERSION.to_owned(),
            target: format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
            seal: String::new(),
            inputs: input_hashes(scene),
            judged_by: case.judged_by.clone(),
            truth: case.truth.map(|formula| formula.name.to_owned()),
            quick,
        };
        let provenance = Provenance {
            seal: provenance.seal(),
            ..provenance
        };
        let header = "# Written by `volref accept`; not to be edited by hand.\n";
        let text = format!("{header}{}", provenance.to_toml());
        let contents = [exr, png, text.into_bytes()];
        Ok(files(case).into_iter().zip(contents).collect())
    }
}
