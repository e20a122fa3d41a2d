//! Profiles: the conventions of another renderer, under which its images are judged.

use crate::files::misspelling::nearest;
use crate::files::regular_file;
use crate::film::{Alpha, Bits, Encoding};
use crate::scene::format::{Key, Kind, Range, Table};
use crate::scene::reader::{Document, Reader};
use crate::scene::{CONVENTIONS, Classified, Conventions, Mode, Model, Scene, SceneResult};
use std::cell::RefCell;
use std::path::Path;

/// The declaration of a profile.
pub(crate) const PROFILE: Table = Table::new("Conventions of another renderer of classified volumes.")
    .keys(&[
    Key::required("name", Kind::Text).doc("Renderer, with its version."),
    Key::optional("source", Kind::Text).doc("Document or code that states the conventions."),
    Key::optional("early_termination", Kind::Number(Range::open(0.0, 1.0))).doc(
        "Ends a ray where its transmittance falls below this value. If left out, as in the scene.",
    ),
    Key::optional("bits", Kind::Count(8, 8))
        .doc("Bits of a channel in its images, as --bits declares them: differences up to half a code agree."),
    Key::optional("encoding", Kind::Choice(&["linear", "srgb"]))
        .doc("Curve of those codes. If left out, it is found: that of a PNG is sRGB."),
    Key::or("blended", Kind::Flag, "false").doc(
        "Colours, not multiplied by opacity, and opacities are rounded to these bits before they are blended with the background: differences up to one and a half codes agree.",
    ),
    Key::optional("alpha", Kind::Choice(&["premultiplied", "straight"]))
        .doc("Colours of its images with opacity leave out the background of the scene, as --alpha declares them: multiplied by opacity, or not. If left out, they contain it."),
    Key::optional("conventions", Kind::Table(&CONVENTIONS)).doc("Conventions, as in a scene."),
]);

/// The profiles that volref brings, by name.
const SHIPPED: [(&str, &str); 9] = [
    ("anari", include_str!("profiles/anari.toml")),
    ("vtk", include_str!("profiles/vtk.toml")),
    ("vtk-cpu", include_str!("profiles/vtk-cpu.toml")),
    ("vtkjs", include_str!("profiles/vtkjs.toml")),
    ("niivue", include_str!("profiles/niivue.toml")),
    ("pyvista-cpu", include_str!("profiles/pyvista-cpu.toml")),
    ("pyvista-gpu", include_str!("profiles/pyvista-gpu.toml")),
    ("tutorial", include_str!("profiles/tutorial.toml")),
    ("vispy", include_str!("profiles/vispy.toml")),
];

/// Longest profile read: 64 KiB, a hundred times what one needs.
const MOST_BYTES: u64 = 1 << 16;

/// Conventions of a renderer of classified volumes.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Renderer, with its version.
    pub name: String,
    /// Its file.
    pub text: String,
    /// Bits of its images, where they are few.
    pub bits: Option<Bits>,
    /// Colours of its images leave out the background.
    pub alpha: Option<Alpha>,
    early_termination: Option<f64>,
    conventions: Conventions,
}

impl Profile {
    /// Names of the profiles that volref brings.
    pub fn shipped() -> impl Iterator<Item = &'static str> {
        SHIPPED.into_iter().map(|(name, _)| name)
    }

    /// Name of the profile that volref brings with this `text`.
    pub(crate) fn shipped_name(text: &str) -> Option<&'static str> {
        let found = SHIPPED.iter().find(|(_, shipped)| *shipped == text);
        found.map(|(name, _)| *name)
    }

    /// The profile that volref brings under this name, else the one in the file of this name.
    pub fn named(name: &str) -> SceneResult<Profile> {
        if let Some((_, text)) = SHIPPED.iter().find(|(shipped, _)| *shipped == name) {
            return Profile::parse(text, name);
        }
        let nowhere = Document {
            path: name,
            text: "",
        };
        let bytes = regular_file::read(Path::new(name), MOST_BYTES).map_err(|error| {
            let shipped: Vec<&str> = Profile::shipped().collect();
            let meant = nearest(name, Profile::shipped());
            let meant = meant.map(|meant| format!("did you mean {meant:?}? "));
            let help = format!(
                "{}give a file, or one of the profiles that volref brings: {}",
                meant.unwrap_or_default(),
                shipped.join(", ")
            );
            let message = format!("cannot read the profile: {error}");
            nowhere.error(None, message, Some(help))
        })?;
        let text = String::from_utf8(bytes).map_err(|_| {
            let message = "the profile is not UTF-8 text".to_owned();
            nowhere.error(None, message, None)
        })?;
        Profile::parse(&text, name)
    }

    /// The profile in a file of this `text`, which messages call `path`.
    ///
    /// # Errors
    ///
    /// If the text is no profile.
    pub fn parse(text: &str, path: &str) -> SceneResult<Profile> {
        let document = Document { path, text };
        let root = document.parse()?;
        let log = RefCell::default();
        let reader = Reader::new(&document, &PROFILE, &root, &log)?;
        let name = reader.get("name")?;
        let early_termination = reader.optional("early_termination")?;
        let bits: Option<u32> = reader.get("bits")?;
        let encoding: Option<String> = reader.get("encoding")?;
        if bits.is_none() && encoding.is_some() {
            let message = "`encoding` is for rounded images: add `bits = 8`";
            return Err(reader.error("encoding", message));
        }
        let blended = reader.get("blended")?;
        if bits.is_none() && blended {
            let message = "`blended` has no effect without rounding: add `bits = 8`";
            return Err(reader.error("blended", message));
        }
        let alpha: Option<String> = reader.get("alpha")?;
        let encoding = encoding.map(|name| match name.as_str() {
            "srgb" => Encoding::Srgb,
            _ => Encoding::Linear,
        });
        let conventions = reader.table_as("conventions", Conventions::read)?;
        Ok(Profile {
            name,
            text: text.to_owned(),
            bits: bits.map(|_| Bits { encoding, blended }),
            alpha: alpha.and_then(|name| name.parse().ok()),
            early_termination,
            conventions: conventions.unwrap_or_default(),
        })
    }

    /// `scene` under the conventions of the profile; `None` if it has no classified volume that the profile says
    /// anything of. Fails if the scene states conventions of its own.
    pub fn applied_to(&self, scene: &Scene) -> Result<Option<Scene>, String> {
        let mut scene = scene.clone();
        let mut is_classified = false;
        for panel in &mut scene.panels {
            if let Model::Classified(classified) = &mut panel.model
                // Projections and isosurfaces by random samples have no image of all places.
                && (classified.mode == Mode::Composited || !self.conventions.is_random())
            {
                self.apply(classified)?;
                is_classified = true;
            }
        }
        Ok(is_classified.then_some(scene))
    }

    fn apply(&self, scene: &mut Classified) -> Result<(), String> {
        let (own, conventions) = (scene.conventions, self.conventions.of_mode(&scene.mode));
        if own != Conventions::default() && own != conventions {
            return Err(format!(
                "the profile {:?} contradicts the scene, which states its own \
                 [classified.conventions]; judge this case without --as",
                self.name
            ));
        }
        // Conventions are about samples.
        scene.sample();
        scene.conventions = conventions;
        if let Some(threshold) = self.early_termination
            && !matches!(scene.mode, Mode::Projection(_))
        {
            scene.end_rays_at(threshold);
        }
        if !scene.has_conventions_that_are_rendered() {
            let why = if scene.volume_count() > 1 && !conventions.common_steps {
                "several volumes follow conventions about samples only by `volume_steps = \"common\"`"
            } else {
                "shadows among surfaces and clips, and modulated opacities, follow no conventions about samples"
            };
            return Err(format!(
                "the profile {:?} cannot be followed: {why}; judge this case without --as",
                self.name
            ));
        }
        let checked = scene.check_common_steps();
        checked.map_err(|message| format!("the profile {:?}: {message}", self.name))
    }
}
