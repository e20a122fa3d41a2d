//! The numbers of a scene that a mistake can touch.

mod classified;
mod lights;
mod media;
mod surfaces;
mod view;

use super::number::{Number, Quantity};
use crate::files::misspelling::nearest;
use crate::scene::{Classified, Model, Panel, Radiative, Scene};

/// All numbers of `scene` that have a name: none of a plot.
pub fn numbers(scene: &Scene) -> Vec<Number> {
    let Some(panel) = scene.panels.first() else {
        return Vec::new();
    };
    let mut numbers = match &panel.model {
        // Of several volumes, each number would need the name of its own.
        Model::Classified(volume) if volume.has_objects() => Vec::new(),
        Model::Classified(volume) => classified::numbers(volume),
        Model::Radiative(radiative) => {
            let mut numbers = media::numbers(radiative);
            numbers.extend(surfaces::numbers(radiative));
            numbers.extend(lights::numbers(radiative));
            numbers
        }
        Model::Curve(_) => Vec::new(),
    };
    numbers.extend(view::numbers(scene));
    numbers
}

/// Place, turn and size of the volume of `scene`, whether a map places it or not; none of several.
pub fn numbers_of_place(scene: &Scene) -> Vec<Number> {
    match scene.panels.first().map(|panel| &panel.model) {
        Some(Model::Classified(volume)) if !volume.has_objects() => {
            let place = classified::place(volume);
            place.chain(classified::turn_and_size()).collect()
        }
        _ => Vec::new(),
    }
}

/// The number of that name.
///
/// # Errors
///
/// If the scene has no such number: a message with the nearest name, or all names.
pub fn number(scene: &Scene, name: &str) -> Result<Number, String> {
    let numbers = numbers(scene);
    if let Some(number) = numbers.iter().find(|number| number.name() == name) {
        return Ok(number.clone());
    }
    let names: Vec<String> = numbers.iter().map(Number::name).collect();
    if names.is_empty() {
        return Err(format!(
            "this scene has no number {name:?}: a plot has none"
        ));
    }
    let mut panels = scene.panels.iter().filter_map(Panel::classified);
    let why = match panels.any(Classified::has_objects) {
        true => ": several volumes, surfaces and clips have none of their own",
        false => "",
    };
    Err(match nearest(name, names.iter().map(String::as_str)) {
        Some(near) => format!("this scene has no number {name:?}; did you mean {near:?}?"),
        None => format!(
            "this scene has no number {name:?}; it has {}{why}",
            names.join(", ")
        ),
    })
}

/// Edits the panels with surfaces, media and lights; nothing if `edit` returns nothing for one.
fn in_radiative(
    scene: &mut Scene,
    mut edit: impl FnMut(&mut Radiative) -> Option<()>,
) -> Option<()> {
    for panel in &mut scene.panels {
        if let Model::Radiative(radiative) = &mut panel.model {
            edit(radiative)?;
        }
    }
    Some(())
}

/// Edits the panels with a classified volume.
fn in_classified(scene: &mut Scene, mut edit: impl FnMut(&mut Classified)) {
    for panel in &mut scene.panels {
        if let Model::Classified(volume) = &mut panel.model {
            edit(volume);
        }
    }
}
