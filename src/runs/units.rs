//! Work units: rows of the renderings of sampled cases, each computed by itself, anywhere.
//!
//! A pixel has random numbers of its own, so that rows rendered apart have the bits that they have in
//! the whole image. A unit is known by a hash of everything it is computed from: scene, plan, input
//! files, samples and seed, rows, the versions of volref and `libm`, and the program itself, so that no
//! unit ever comes from other code. Whoever computes it, and however often, it is the same file.

use crate::files::kept_file;
use crate::files::kept_file::KeepError;
use crate::files::own_file;
use crate::files::partial_file;
use crate::files::program_hash::{hash, program_hash};
use crate::film::kept_film;
use crate::film::{Film, Noise};
use crate::render::{self, Detail, Plan, plans};
use crate::scene::Scene;
use crate::suite::Case;
use crate::suite::golden::{LIBM_VERSION, input_hashes, plan_hash, scene_hash, short};
use crate::suite::rendering::{
    CaseRendering, ReferenceRenderer, Renderer, check_class, render_case,
};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Paths of a unit, about 10 to 250 s of one core.
const PATHS_OF_UNIT: u64 = 1 << 22;

/// Rows of a rendering of a sampled case, with everything that they are computed from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unit {
    /// Hash of everything that it is computed from.
    pub id: String,
    /// `family/name`.
    pub case: String,
    /// `quick` or `converged`.
    pub rendering: String,
    /// Samples per pixel.
    pub samples: u32,
    /// The first row, from the top, and the one beyond the last.
    pub rows: [usize; 2],
    /// Pixels times samples.
    pub paths: u64,
    /// Seed of the scene.
    pub seed: u64,
    /// Hash of the scene.
    pub scene: String,
    /// Version of volref.
    pub volref: String,
    /// Hash of the program.
    pub program: String,
}

impl Unit {
    /// The file of the unit below a [folder of units](UnitFolder).
    pub fn file(&self) -> PathBuf {
        Path::new(&self.case).join(format!("{}.{EXTENSION}", self.id))
    }

    /// The beginning of the identifier, for people.
    pub(crate) fn short_id(&self) -> String {
        short(&self.id)
    }

    /// The first row and the last, for people.
    pub(crate) fn rows_in_words(&self) -> String {
        format!(
            "rows {:>4} to {:>4}",
            self.rows[0],
            self.rows[1].saturating_sub(1)
        )
    }

    /// The rows in `exr`, if they have the size and samples of the unit; else the reason, a
    /// sentence without its subject.
    fn rows_from(&self, exr: &[u8]) -> Result<Film, String> {
        let rows = (self.rows[0]..self.rows[1]).len();
        let pixels = self.paths / u64::from(self.samples).max(1);
        let width = pixels as usize / rows.max(1);
        let film = kept_film::film_of(exr, [width, rows])?;
        let samples = film.noise().map(Noise::samples);
        if samples != Some(self.samples) || film.opacity().is_some() {
            let has = samples.map_or("no variance".to_owned(), |of| format!("{of} samples"));
            let has = film.opacity().map_or(has, |_| "an opacity".to_owned());
            return Err(format!(
                "its image has {has}, and the unit has {} samples",
                self.samples
            ));
        }
        if let Some(([x, y], _)) = film.first_without_radiance() {
            return Err(format!(
                "a value or variance of its image, at column {x} of row {y}, is negative or not finite"
            ));
        }
        Ok(film)
    }

    /// Difference of the inputs of `other`, if any: the end of a sentence.
    fn otherwise(&self, other: &Unit) -> String {
        match () {
            () if self.volref != other.volref => {
                format!(
                    "of volref {}, and this is volref {}",
                    other.volref, self.volref
                )
            }
            () if self.seed != other.seed => {
                format!("of seed {}, and the scene has {}", other.seed, self.seed)
            }
            () if self.scene != other.scene => "of another scene".to_owned(),
            () if self.program != other.program => {
                let [theirs, ours] = [&other.program, &self.program].map(|program| short(program));
                format!("of another build of volref ({theirs}, this is {ours})")
            }
            () if self.samples != other.samples => {
                format!(
                    "of {} samples, and the case has {}",
                    other.samples, self.samples
                )
            }
            () if self.id == other.id => "of other rows than its identifier says".to_owned(),
            () => "of other input files, or of another plan".to_owned(),
        }
    }
}

/// A case whose units cannot be computed.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("{case}: {reason}")]
pub(crate) struct UnitError {
    /// `family/name`.
    pub case: String,
    /// The error.
    pub reason: String,
}

impl UnitError {
    fn new(case: &Case, reason: impl ToString) -> UnitError {
        UnitError {
            case: case.name.clone(),
            reason: reason.to_string(),
        }
    }
}

/// A case, loaded, and the renderings of its golden.
pub(crate) struct CaseUnits<'c> {
    /// The case.
    pub case: &'c Case,
    pub(crate) scene: Scene,
    /// Renderings: for a stochastic case the quick one first, then the image of the golden, unless
    /// that is a known answer.
    pub(crate) renderings: Vec<RenderingUnits>,
}

/// A rendering, and its units from the top; deterministic renderings take seconds, and have none.
pub(crate) struct RenderingUnits {
    pub rendering: CaseRendering,
    pub units: Vec<Unit>,
}

impl<'c> CaseUnits<'c> {
    /// The units of `case`; of a deterministic case none.
    ///
    /// # Errors
    ///
    /// If the scene cannot be loaded, or is of another class than the case.
    pub fn of(case: &'c Case) -> Result<CaseUnits<'c>, UnitError> {
        CaseUnits::rendered_by(&ReferenceRenderer, case)
    }

    pub(crate) fn rendered_by(
        renderer: &dyn Renderer,
        case: &'c Case,
    ) -> Result<CaseUnits<'c>, UnitError> {
        let incomplete = |reason: String| UnitError::new(case, reason);
        let scene = case
            .load_scene()
            .map_err(|error| incomplete(error.to_string()))?;
        let plans = plans(&scene);
        check_class(renderer, case, &plans).map_err(incomplete)?;
        let renderings = match case.sampling {
            None => vec![CaseRendering::Only],
            Some(sampling) => {
                let quick = CaseRendering::Quick(sampling.quick);
                let converged = sampling.converged;
                let converged = converged.map(|of| CaseRendering::Converged(of.samples));
                [quick].into_iter().chain(converged).collect()
            }
        };
        let renderings = renderings.into_iter().map(|rendering| RenderingUnits {
            rendering,
            units: units(case, &scene, &plans, rendering),
        });
        Ok(CaseUnits {
            case,
            renderings: renderings.collect(),
            scene,
        })
    }

    /// The units of all renderings.
    pub fn units(&self) -> impl Iterator<Item = &Unit> {
        self.renderings.iter().flat_map(|of| &of.units)
    }

    /// Pixels times samples of a rendering.
    pub(crate) fn paths(&self, rendering: CaseRendering) -> u64 {
        let pixels = (self.scene.width() * self.scene.height()) as u64;
        pixels * u64::from(rendering.samples())
    }

    /// Computes a unit of this case, and keeps it in `folder`.
    ///
    /// # Errors
    ///
    /// If it cannot be rendered or written. Before it is rendered, if there is no place for it.
    pub fn compute(
        &self,
        unit: &Unit,
        folder: &UnitFolder,
        progress: render::Progress<'_>,
    ) -> Result<(), UnitError> {
        let of_unit = |of: &&RenderingUnits| of.units.contains(unit);
        let of = self.renderings.iter().find(of_unit);
        let of = of.ok_or_else(|| UnitError::new(self.case, "this unit does not belong to it"))?;
        let place = folder.check(&self.case.name);
        place.map_err(|error| UnitError::new(self.case, error))?;
        let film = self.rendered(&ReferenceRenderer, of.rendering, unit, progress)?;
        folder
            .put(unit, &film)
            .map_err(|error| UnitError::new(self.case, error))
    }

    /// The rows of `unit`.
    pub(crate) fn rendered(
        &self,
        renderer: &dyn Renderer,
        rendering: CaseRendering,
        unit: &Unit,
        progress: render::Progress<'_>,
    ) -> Result<Film, UnitError> {
        let [first, end] = unit.rows;
        let detail = Detail::Rows { first, end };
        let rendered = render_case(renderer, &plans(&self.scene), rendering, detail, progress);
        let rendered = rendered.map_err(|reason| UnitError::new(self.case, reason))?;
        Ok(rendered.film)
    }

    /// The unit of this case that `other`, of another process, is meant to be.
    ///
    /// # Errors
    ///
    /// The difference: the end of a sentence.
    pub(crate) fn matching(&self, other: &Unit) -> Result<&Unit, String> {
        if let Some(unit) = self.units().find(|unit| *unit == other) {
            return Ok(unit);
        }
        let of_rendering = |unit: &&Unit| unit.rendering == other.rendering;
        let same_id = self.units().find(|unit| unit.id == other.id);
        let near = same_id.or_else(|| self.units().find(of_rendering));
        Err(near.map_or_else(
            || format!("of a {} rendering, which the case has not", other.rendering),
            |unit| unit.otherwise(other),
        ))
    }
}

/// Bands of rows, as even as can be, of about [`PATHS_OF_UNIT`].
fn bands(width: usize, height: usize, samples: u32) -> impl Iterator<Item = [usize; 2]> {
    let paths = (width * height) as u64 * u64::from(samples);
    // No more than rows.
    let bands = paths.div_ceil(PATHS_OF_UNIT).clamp(1, height as u64) as usize;
    (0..bands).map(move |band| [band * height / bands, (band + 1) * height / bands])
}

fn units(case: &Case, scene: &Scene, plans: &[Plan<'_>], rendering: CaseRendering) -> Vec<Unit> {
    let Some(name) = rendering.name() else {
        return Vec::new();
    };
    let inputs: Vec<_> = input_hashes(scene).into_iter().collect();
    let samples = rendering.samples();
    let (width, height) = (scene.width(), scene.height());
    let whole = Unit {
        id: String::new(),
        case: case.name.clone(),
        rendering: name.to_owned(),
        samples,
        rows: [0, height],
        paths: 0,
        seed: scene.seed().unwrap_or(0),
        scene: scene_hash(scene),
        volref: env!("CARGO_PKG_VERSION").to_owned(),
        program: program_hash().unwrap_or_default().to_owned(),
    };
    let plan = plan_hash(plans);
    let unit = |rows: [usize; 2]| {
        let parts = [
            &whole.scene,
            &plan,
            &format!("{inputs:?}"),
            &format!("{name} {samples} {rows:?}"),
            &whole.volref,
            LIBM_VERSION,
            &whole.program,
        ];
        Unit {
            id: hash(&parts),
            rows,
            paths: ((rows[1] - rows[0]) * width) as u64 * u64::from(samples),
            ..whole.clone()
        }
    };
    bands(width, height, samples).map(unit).collect()
}

/// Name of the folder of units.
const UNITS: &str = "units";

const EXTENSION: &str = "unit";

/// True if the file name is an identifier, as in [`Unit::file`].
fn is_name_of_unit(path: &Path) -> bool {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let is_hash = stem.len() == 64 && stem.bytes().all(|byte| byte.is_ascii_hexdigit());
    is_hash && path.extension().is_some_and(|of| of == EXTENSION)
}

/// A folder of finished units, hidden from version control.
#[derive(Clone, Debug)]
pub struct UnitFolder {
    /// The folder `.volref`.
    root: PathBuf,
}

impl UnitFolder {
    /// The units within the folder `root`, which need not exist.
    pub fn open(root: impl Into<PathBuf>) -> UnitFolder {
        UnitFolder { root: root.into() }
    }

    /// Folder of the units.
    pub fn path(&self) -> PathBuf {
        self.root.join(UNITS)
    }

    /// True if there is a file of this unit; it may be damaged.
    pub fn has(&self, unit: &Unit) -> bool {
        self.path().join(unit.file()).is_file()
    }

    /// True if the rows of `unit` are kept, and undamaged.
    pub(crate) fn is_intact(&self, unit: &Unit) -> bool {
        matches!(self.get(unit), Ok(Some(_)))
    }

    /// The rows of `unit`; `None` if none were kept.
    ///
    /// # Errors
    ///
    /// A sentence about a file that is not as it was written, or of something else: as if there were none.
    pub fn get(&self, unit: &Unit) -> Result<Option<Film>, String> {
        let path = self.path().join(unit.file());
        if !path.exists() {
            return Ok(None);
        }
        let film = UnitFile::read(&path).and_then(|file| {
            if file.unit != *unit {
                return Err("it is of another unit than its name says".to_owned());
            }
            file.film()
        });
        let film = film.map_err(|reason| format!("{}: {reason}", path.display()))?;
        Ok(Some(film))
    }

    /// Fails where the units of `case` could not be kept, for a link or something else in the place of a
    /// folder.
    pub(crate) fn check(&self, case: &str) -> Result<(), KeepError> {
        let (root, name) = kept_file::in_its_folder(&self.root);
        Ok(own_file::check_folder(root, &name.join(UNITS).join(case))?)
    }

    /// Removes partial files of killed processes among the units of `case`.
    pub fn sweep(&self, case: &str) {
        if self.check(case).is_ok() {
            partial_file::sweep(&self.path().join(case));
        }
    }

    /// Keeps the rows of `unit`.
    pub(crate) fn put(&self, unit: &Unit, film: &Film) -> Result<(), KeepError> {
        let path = self.path().join(unit.file());
        // Of these it could not be told what made them.
        if unit.program.is_empty() {
            return Err(KeepError::encode(&path, "the program cannot be read"));
        }
        let (root, name) = kept_file::in_its_folder(&self.root);
        kept_film::write(root, &name.join(UNITS).join(unit.file()), unit, film)?;
        kept_file::hide(&self.root);
        Ok(())
    }

    /// Removes the kept units of `case`, and folders left empty. Other files there stay, and so does what a
    /// link leads to.
    pub(crate) fn forget(&self, case: &str) {
        if self.check(case).is_err() {
            return;
        }
        let folder = self.path().join(case);
        let Ok(entries) = std::fs::read_dir(&folder) else {
            return;
        };
        for entry in entries.flatten() {
            let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
            if is_file && is_name_of_unit(&entry.path()) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
        partial_file::sweep(&folder);
        for folder in folder.ancestors() {
            if folder == self.root || std::fs::remove_dir(folder).is_err() {
                break;
            }
        }
        partial_file::sweep(&self.root);
        kept_file::remove_if_empty(&self.root);
    }

    /// All files of units, sorted; links to folders, of which there may be rings, are not followed.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files = Vec::new();
        let mut folders = vec![self.path()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
                let path = entry.path();
                if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                    folders.push(path);
                } else if path.extension().is_some_and(|of| of == EXTENSION) {
                    files.push(path);
                }
            }
        }
        files.sort();
        files
    }

    /// Adds a unit that another process computed.
    ///
    /// # Errors
    ///
    /// If it cannot be written, or the unit that is here has other bits.
    pub fn add(&self, unit: &Unit, film: &Film) -> Result<Added, AddError> {
        self.sweep(&unit.case);
        match self.get(unit) {
            Ok(Some(here)) if here.pixel_hash() == film.pixel_hash() => Ok(Added::WasHere),
            Ok(Some(_)) => Err(AddError::OtherBits),
            Ok(None) | Err(_) => {
                self.put(unit, film)?;
                Ok(Added::New)
            }
        }
    }
}

/// Outcome of adding a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Added {
    /// The unit is new here.
    New,
    /// The unit was already here.
    WasHere,
}

/// A unit could not be added.
#[derive(Debug, thiserror::Error)]
pub enum AddError {
    /// Two units of one name.
    #[error(
        "two processes computed other bits from the same things: one of the machines is broken"
    )]
    OtherBits,
    /// The unit cannot be written.
    #[error(transparent)]
    Keep(#[from] KeepError),
}

/// A file of a unit, whose rows are not yet unpacked: the unit limits their size.
pub struct UnitFile {
    /// The unit, by the header of the file.
    pub unit: Unit,
    exr: Vec<u8>,
}

impl UnitFile {
    /// The file at `path`.
    ///
    /// # Errors
    ///
    /// A sentence without its subject.
    pub fn read(path: &Path) -> Result<UnitFile, String> {
        let (unit, exr) = kept_file::read(path)?;
        Ok(UnitFile { unit, exr })
    }

    /// The rows, if they have the size and samples of the unit.
    ///
    /// # Errors
    ///
    /// A sentence without its subject.
    pub fn film(&self) -> Result<Film, String> {
        self.unit.rows_from(&self.exr)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_all_rows_once_and_almost_even() {
        for (width, height, samples) in [
            (192, 192, 1408),
            (1, 1, 2),
            (256, 256, 16384),
            (512, 7, 1 << 24),
            (160, 160, 384),
        ] {
            let bands: Vec<_> = bands(width, height, samples).collect();
            assert_eq!((bands[0][0], bands[bands.len() - 1][1]), (0, height));
            assert!(bands.windows(2).all(|two| two[0][1] == two[1][0]));
            let rows = bands.iter().map(|band| band[1] - band[0]);
            let (least, most) = (rows.clone().min(), rows.max());
            assert!(least >= Some(1) && most.unwrap() - least.unwrap() <= 1);
            let paths = (most.unwrap() * width) as u64 * u64::from(samples);
            let one_row = width as u64 * u64::from(samples);
            assert!(paths <= PATHS_OF_UNIT + one_row, "{paths}");
        }
    }
}
