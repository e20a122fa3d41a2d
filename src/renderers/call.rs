//! Call of another renderer for a case: placeholders with their values, and exports of the scene.

use super::CommandTemplate;
use crate::exchange::{self, Format};
use crate::math::exp2;
use crate::scene::{Panel, Scene};
use crate::suite::{Case, NOT_RENDERED, Output};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf, absolute};

/// Version of the protocol of renderers that stay: `volref` in a request.
const PROTOCOL: u32 = 1;

/// Placeholders that stand for numbers.
const NUMBERS: [&str; 7] = ["width", "height", "spp", "seed", "step", "rate", "exposure"];

/// Samples and seed of a call.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CallSettings {
    /// Samples per pixel.
    pub spp: u32,
    /// Seed of its random numbers.
    pub seed: u64,
}

/// Call of a renderer for a case.
pub(super) struct Call<'t> {
    template: &'t CommandTemplate,
    /// Placeholders with what stands for them.
    values: BTreeMap<&'static str, String>,
    /// Distance between samples, and the length of a voxel, world units; of a scene with a classified volume.
    step: Option<[f64; 2]>,
}

impl<'t> Call<'t> {
    /// The call of `template` for `case`, but for its output and step, after writing exports into the folder
    /// `exports`.
    pub fn new(
        template: &'t CommandTemplate,
        case: &Case,
        settings: CallSettings,
        exports: &Path,
    ) -> Result<Call<'t>, Output> {
        // Read again: a scene that cannot be read is said by whoever judges.
        let scene = case
            .load_scene()
            .map_err(|error| Output::Unusable(error.to_string()))?;
        let mut values = BTreeMap::from([
            ("scene", shown(&absolute(&case.scene).map_err(not_run)?)),
            ("width", scene.width().to_string()),
            ("height", scene.height().to_string()),
            ("spp", settings.spp.to_string()),
            ("seed", settings.seed.to_string()),
            ("case", case.name.clone()),
            ("exposure", case.exposure.to_string()),
        ]);
        let volume = scene.panels.iter().find_map(Panel::classified);
        let step = volume.map(|volume| [volume.step, volume.voxel()]);
        if template.takes_step() && step.is_none() {
            let fault = "the command takes a step, and the scene has no classified volume";
            return Err(Output::Missing(format!("{NOT_RENDERED}{fault}")));
        }
        for name in CommandTemplate::PLACEHOLDERS {
            let format = name.strip_prefix("export:");
            if let Some(format) = format.filter(|_| template.uses(name)) {
                let path = exported(&scene, case, format, exports)?;
                values.insert(name, shown(&path));
            }
        }
        Ok(Call {
            template,
            values,
            step,
        })
    }

    /// The words of the call that writes `output`, with the step of the scene halved `halvings` times.
    pub fn words(&mut self, output: &Path, halvings: u32) -> Vec<String> {
        self.set(output, halvings);
        self.template.fill(&self.values)
    }

    /// The request for the same image to a renderer that stays, one line of JSON: the protocol, the case, the image to
    /// write, and what the command names.
    pub fn request(&mut self, output: &Path, halvings: u32) -> String {
        self.set(output, halvings);
        let is_asked = |name: &str| matches!(name, "case" | "output") || self.template.uses(name);
        let mut request = format!("{{\"volref\":{PROTOCOL}");
        for (name, value) in self.values.iter().filter(|(name, _)| is_asked(name)) {
            // Numbers keep their digits.
            let value = match NUMBERS.contains(name) {
                true => value.clone(),
                false => serde_json::Value::from(value.as_str()).to_string(),
            };
            request.push_str(&format!(",\"{name}\":{value}"));
        }
        request + "}"
    }

    fn set(&mut self, output: &Path, halvings: u32) {
        self.values.insert("output", shown(output));
        if let Some([step, voxel]) = self.step {
            let step = step * exp2(-f64::from(halvings));
            self.values.insert("step", step.to_string());
            self.values.insert("rate", (voxel / step).to_string());
        }
    }
}

/// A copy of the scene in another format, below `exports`; a scene that cannot be exported counts as a missing
/// image.
fn exported(scene: &Scene, case: &Case, format: &str, exports: &Path) -> Result<PathBuf, Output> {
    let format: Format = format.parse().expect("placeholders name formats");
    let folder = exports.join(format.to_string()).join(&case.name);
    let name = case.name.rsplit('/').next().unwrap_or(&case.name);
    let export = exchange::export(scene, format, name, Some(case.exposure))
        .map_err(|refusal| Output::Missing(format!("{NOT_RENDERED}{refusal}")))?;
    let failed = |error| Output::Unusable(format!("the export failed: {error}"));
    export.write_into(&folder).map_err(failed)?;
    Ok(folder.join(&export.main))
}

/// `path` as text, as a command or a request holds it.
pub(super) fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// The output of a renderer that could not be run.
pub(super) fn not_run(error: impl Display) -> Output {
    Output::Unusable(format!("the renderer could not be run: {error}"))
}
