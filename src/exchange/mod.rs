//! Scenes for other renderers.
//!
//! [`export`] writes a scene in the format of another renderer: participating media for [Mitsuba 3]
//! and [pbrt-v4], all scenes as a plain bundle of numbers, classified volumes as their grids alone. A scene that a format cannot
//! express is a [`Refusal`] that names each reason; nothing is approximated. If a scene must be
//! changed slightly, because other renderers move rays off surfaces by more than rounding, a
//! comment in the file states it.
//!
//! `bundle` says all that a scene holds, in panels of `volume`, `volumes`, `radiance` and `plot`, whose keys the guide lists
//! ([`peers`](crate::guide::peers)). `forms` are shapes by their coordinates, `nested_media` which media lie in which, `limits` what
//! 32-bit numbers lose; `mitsuba` and `pbrt` write.
//!
//! [Mitsuba 3]: https://www.mitsuba-renderer.org
//! [pbrt-v4]: https://pbrt.org

mod bundle;
mod export_files;
mod export_scene;
mod files;
mod forms;
mod grid_files;
mod limits;
mod mitsuba;
mod mixture;
mod nested_media;
mod pbrt;
mod refusal;
mod view;

pub use export_files::Export;
pub use refusal::Refusal;

use crate::scene::{Model, Scene};
use std::fmt;
use std::str::FromStr;

/// Format of an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// XML of Mitsuba 3, with grids (`.vol`) and meshes (`.ply`) beside it.
    Mitsuba,
    /// A scene of pbrt-v4, with meshes (`.ply`) beside it.
    Pbrt,
    /// Any scene, as numbers, formulas and raw arrays.
    Bundle,
    /// The grid of a classified volume: bare samples, described in TOML.
    Raw,
    /// The grid of a classified volume, as NRRD.
    Nrrd,
    /// The grid of a classified volume, as NPY, described in TOML.
    Npy,
}

impl Format {
    const ALL: [Format; 6] = {
        use Format::*;
        [Mitsuba, Pbrt, Bundle, Raw, Nrrd, Npy]
    };
}

/// The name on the command line: that of the variant, in small letters.
impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format!("{self:?}").to_lowercase())
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Format, String> {
        let named = Format::ALL.into_iter().find(|it| it.to_string() == text);
        named.ok_or_else(|| {
            let names = Format::ALL.map(|it| it.to_string()).join(", ");
            format!("there is no format `{text}`: choose one of {names}")
        })
    }
}

/// `scene` in the given `format`, in files whose names begin with `name`: letters, digits, `.`, `-`
/// and `_` are kept, other characters become `-`. Where the `exposure` of 8-bit images of the scene is known, in stops, a
/// bundle states it.
///
/// # Errors
///
/// [`Refusal`] names everything that the format cannot express.
pub fn export(
    scene: &Scene,
    format: Format,
    name: &str,
    exposure: Option<f64>,
) -> Result<Export, Refusal> {
    let name = &plain(name);
    let write = match format {
        Format::Mitsuba => mitsuba::scene,
        Format::Pbrt => pbrt::scene,
        Format::Bundle => return bundle::bundle(scene, name, exposure),
        Format::Raw | Format::Nrrd | Format::Npy => {
            return grid_files::grid_files(scene, format, name);
        }
    };
    let [panel] = &scene.panels[..] else {
        let what = "several pictures side by side; write a scene of each panel";
        return Err(Refusal::of(format, "panel", what));
    };
    let radiative = match &panel.model {
        Model::Radiative(radiative) => radiative,
        Model::Classified(_) => {
            let what = "a classified volume: media have coefficients, and no transfer function; export the scene to \
                        `bundle`, or its grid alone to `raw`, `nrrd` or `npy`";
            return Err(Refusal::of(format, "classified", what));
        }
        Model::Curve(_) => {
            let what = "a plot of a curve; export it to `bundle`";
            return Err(Refusal::of(format, "curve", what));
        }
    };
    write(panel, radiative, name)
}

/// A name that is safe in any file system, shell, XML attribute and pbrt string.
fn plain(name: &str) -> String {
    let plain = |letter: char| match letter {
        'a'..='z' | 'A'..='Z' | '0'..='9' | '.' | '_' => letter,
        _ => '-',
    };
    let name: String = name.chars().map(plain).collect();
    match name.trim_start_matches(['.', '-']) {
        "" => "scene".to_owned(),
        name => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_have_names() {
        for format in Format::ALL {
            assert_eq!(format.to_string().parse(), Ok(format));
        }
        let error = "Mitsuba".parse::<Format>().unwrap_err();
        assert!(
            error.contains("mitsuba, pbrt, bundle, raw, nrrd, npy"),
            "{error}"
        );
    }

    #[test]
    fn names_stay_in_their_folder() {
        assert_eq!(plain("../../etc/x"), "etc-x");
        assert_eq!(plain("rate-0.1"), "rate-0.1");
        assert_eq!(plain("a\"b<c>"), "a-b-c-");
        assert_eq!(plain(".."), "scene");
        assert_eq!(plain(""), "scene");
    }
}
