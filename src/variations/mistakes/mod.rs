//! The mistakes people make in volume renderers.
//!
//! Each is a small edit of the scene or of the image, with advice for its author. The renderer
//! itself never changes: mistakes in the transport of light are made by a [double](crate::faulty_tracer).
//! The catalogue has two uses: the self-test (`volref selftest`) proves that the suite rejects every
//! mistake, and failing images are [compared with it](crate::naming::diagnosis) to name the mistake.

/// Rows of the catalogue: the name of a mistake, its edit by kind, and its advice.
macro_rules! mistakes {
    ($($name:expr => $kind:ident($edit:expr), $advice:expr;)+) => {
        &[$(Mistake { name: $name, advice: $advice, edit: Edit::$kind($edit) }),+]
    };
}

mod bricks;
mod classified;
mod densities;
mod grids;
mod images;
mod lights;
mod media;
mod objects;
mod projections;
mod surfaces;
mod transport;

use self::grids::GridValues;
use crate::film::Film;
use crate::geometry::{Surface, length_of};
use crate::optics::{Appearance, Homogeneous, Light, Material, TransferOpacity};
use crate::scene::{Body, Classified, Curve, Fault, Mode, Model, Radiative, Scene, TransportFault};
use glam::DVec3;

/// A mistake.
#[derive(Clone, Copy, Debug)]
pub struct Mistake {
    /// Words joined by `-`; the name never changes.
    pub name: &'static str,
    /// Description and advice for the author of the image.
    pub advice: &'static str,
    edit: Edit,
}

/// The edit behind a mistake.
#[derive(Clone, Copy, Debug)]
enum Edit {
    /// Edits a classified volume.
    Classified(fn(&mut Classified) -> bool),
    /// Edits the grid of a classified volume.
    Grid(fn(&GridValues) -> Option<GridValues>),
    /// Edits the grid of every medium.
    MediumGrids(fn(&GridValues) -> Option<GridValues>),
    /// Moves the image by so many pixels, to the right and down.
    View([f64; 2]),
    /// Edits the formula for opacity, of a classified volume or of its plot.
    Opacity(fn(&mut TransferOpacity) -> bool),
    /// Edits media among surfaces and lights.
    Radiative(fn(&mut Radiative) -> bool),
    /// Edits every medium.
    Medium(fn(&mut Homogeneous)),
    /// Edits every point, spot and directional light.
    Light(fn(&mut Light)),
    /// Edits the material of every surface.
    Material(fn(&mut Material)),
    /// Edits the transport of light.
    Transport(TransportFault),
    /// Edits the finished image, in each pixel by itself.
    Pixels(fn(&Film) -> Film),
    /// Edits the opacity of the finished image, in each pixel by itself.
    Alpha(fn(f32) -> f32),
    /// Edits where the pixels of the finished image are, or how they mix.
    Image(fn(&Film) -> Film),
}

impl Mistake {
    /// Whether it is an edit of the finished image, not of the scene.
    pub fn is_of_the_image(&self) -> bool {
        matches!(self.edit, Edit::Pixels(_) | Edit::Image(_) | Edit::Alpha(_))
    }

    /// True if it edits the opacity of the finished image, and no colour.
    pub fn is_of_opacity(&self) -> bool {
        matches!(self.edit, Edit::Alpha(_))
    }

    /// Whether it edits each pixel of the image independently, so that any part of the image shows
    /// it.
    pub(crate) fn is_of_single_pixels(&self) -> bool {
        matches!(self.edit, Edit::Pixels(_))
    }

    /// `scene` with the mistake; `None` if it does not apply, or if it is one of the image.
    pub fn in_scene(&self, scene: &Scene) -> Option<Scene> {
        let mut scene = scene.clone();
        let mut occurs = false;
        for panel in &mut scene.panels {
            occurs |= match (&self.edit, &mut panel.model) {
                (Edit::Classified(edit), Model::Classified(scene)) => in_classified(scene, edit),
                (Edit::Grid(edit), Model::Classified(scene)) => in_classified(scene, |volume| {
                    let new = edit(&volume.grid);
                    replaced(&mut volume.grid, new)
                }),
                (Edit::View(pixels), _) => panel.edit_view(|camera, pixel| {
                    camera.with_image_moved(pixels.map(|count| count * pixel))
                }),
                (Edit::Opacity(edit), model) => opacity_of(model).is_some_and(edit),
                // One tracer cannot make two mistakes at once.
                (Edit::Transport(fault), Model::Radiative(radiative)) => {
                    let occurs = panel.fault.is_none() && fault.has_occasion(radiative);
                    panel.fault = panel.fault.or(occurs.then_some(*fault));
                    occurs
                }
                (edit, Model::Radiative(radiative)) => {
                    let before = scattering_depth(radiative);
                    let occurs = in_radiative(edit, radiative);
                    let depth = scattering_depth(radiative);
                    if depth > DEEPEST && depth > 16.0 * before {
                        return None;
                    }
                    occurs
                }
                _ => false,
            };
        }
        occurs.then_some(scene)
    }

    /// `film` with the mistake; `None` if it changes nothing, or if it is one of the scene. The
    /// noise of the image changes with it, to first order.
    pub fn in_image(&self, film: &Film) -> Option<Film> {
        match self.edit {
            Edit::Pixels(edit) | Edit::Image(edit) => Some(edit(film)).filter(|new| new != film),
            Edit::Alpha(edit) => Some(film.clone().map_opacity(edit)).filter(|new| new != film),
            _ => None,
        }
    }
}

/// Edits the volumes of `scene`; whether that applies, and can be rendered.
fn in_classified(scene: &mut Classified, edit: impl Fn(&mut Classified) -> bool) -> bool {
    // Mistakes in conventions are about composited samples, and of several volumes no renderer has others
    // than those about them.
    let conventions = scene.conventions;
    let occurs = scene.edit_volumes(edit);
    let is_rendered = match scene.mode {
        Mode::Composited => scene.has_conventions_that_are_rendered(),
        _ => scene.conventions == conventions,
    };
    occurs && is_rendered
}

/// Optical depth beyond which nobody waits for light to be scattered all the way through: a path takes
/// about as many collisions. Media that only absorb may be deeper, until a mistake makes them scatter.
const DEEPEST: f64 = 4096.0;

/// The largest optical depth of a medium that scatters, across its bounds.
fn scattering_depth(scene: &Radiative) -> f64 {
    let depth = |body: &Body| {
        let coefficients = &body.medium.coefficients;
        let across = length_of(body.boundary.as_ref()?.bounds().size());
        let density = body.density.as_ref().map_or(1.0, |it| it.range().high);
        let scatters = coefficients.sigma_s() != DVec3::ZERO;
        scatters.then(|| coefficients.sigma_t().max_element() * density * across)
    };
    scene.media.iter().filter_map(depth).fold(0.0, f64::max)
}

/// Edits `scene`; returns whether the edit applies.
fn in_radiative(edit: &Edit, scene: &mut Radiative) -> bool {
    match edit {
        Edit::Radiative(edit) => edit(scene),
        Edit::MediumGrids(edit) => densities::grids(scene, |grid, interpolation| {
            edit(grid).map(|grid| (grid, interpolation))
        }),
        Edit::Medium(edit) => changed(scene.media.iter_mut().map(|body| &mut body.medium), *edit),
        Edit::Light(edit) => changed(&mut scene.lights, *edit),
        Edit::Material(edit) => {
            let materials = scene.objects.iter_mut().map(|object| &mut object.material);
            changed(materials, *edit)
        }
        _ => false,
    }
}

/// Edits each of the `items`; whether any changed.
fn changed<'i, T: Copy + PartialEq + 'i>(
    items: impl IntoIterator<Item = &'i mut T>,
    edit: fn(&mut T),
) -> bool {
    any(items, |item| {
        let before = *item;
        edit(item);
        *item != before
    })
}

/// Edits each of the `items` by what tells whether it applies; whether it did to any.
fn any<'i, T: 'i>(
    items: impl IntoIterator<Item = &'i mut T>,
    mut edit: impl FnMut(&mut T) -> bool,
) -> bool {
    let items = items.into_iter();
    items.fold(false, |occurs, item| edit(item) | occurs)
}

/// Sets `value` to `new`; whether it changed.
fn set<T: PartialEq>(value: &mut T, new: T) -> bool {
    let old = std::mem::replace(value, new);
    old != *value
}

/// Puts `new` in the place of `value`, if there is any; whether there is.
fn replaced<T>(value: &mut T, new: Option<T>) -> bool {
    new.map(|new| *value = new).is_some()
}

/// Makes the mistake that no file states, if it `occurs` in `scene`.
fn makes(scene: &mut Classified, occurs: bool, fault: Fault) -> bool {
    occurs && set(&mut scene.conventions.fault, Some(fault))
}

/// The formula for opacity, where the model has one.
fn opacity_of(model: &mut Model) -> Option<&mut TransferOpacity> {
    match model {
        Model::Classified(scene) if scene.has_objects() => None,
        Model::Classified(scene) => match &mut scene.transfer_function.appearance {
            Appearance::Formula { opacity, .. } if scene.mode == Mode::Composited => Some(opacity),
            _ => None,
        },
        Model::Curve(Curve::Formula { opacity, .. }) => Some(opacity),
        Model::Curve(Curve::Points(_)) | Model::Radiative(_) => None,
    }
}

/// All mistakes. If two explain an image equally well, the earlier one is named first; those of the
/// image precede those of the scene, being easier to check.
pub fn catalogue() -> impl Iterator<Item = &'static Mistake> {
    [
        images::MISTAKES,
        classified::MISTAKES,
        grids::OF_VOLUMES,
        grids::OF_VOLUMES_ALONE,
        objects::MISTAKES,
        projections::MISTAKES,
        bricks::MISTAKES,
        media::MISTAKES,
        grids::OF_MEDIA,
        densities::MISTAKES,
        lights::MISTAKES,
        surfaces::MISTAKES,
        transport::MISTAKES,
    ]
    .into_iter()
    .flatten()
}

/// The mistake of that name.
pub fn named(name: &str) -> Option<&'static Mistake> {
    catalogue().find(|mistake| mistake.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_words_and_each_is_there_once() {
        let mut names = BTreeSet::new();
        for mistake in catalogue() {
            assert!(
                names.insert(mistake.name),
                "{} is there twice",
                mistake.name
            );
            let is_word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            assert!(mistake.name.chars().all(is_word), "{}", mistake.name);
            assert!(
                mistake.advice.len() > 40,
                "{} says too little",
                mistake.name
            );
            assert_eq!(named(mistake.name).map(|m| m.name), Some(mistake.name));
        }
        assert!(names.len() >= 40);
    }
}
