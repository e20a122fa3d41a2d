//! The parameters of a scene that a mistake can touch.

mod classified;
mod lights;
mod media;
mod objects;
mod surfaces;
mod view;

use super::number::Number;
use crate::files::misspelling::nearest;
use crate::scene::{Model, Scene};

/// All parameters of `scene` that have a name: none of a plot.
pub fn numbers(scene: &Scene) -> Vec<Number> {
    let Some(panel) = scene.panels.first() else {
        return Vec::new();
    };
    let mut numbers = match &panel.model {
        Model::Classified(volume) if volume.has_objects() => objects::numbers(volume),
        Model::Classified(volume) => {
            let mut numbers = classified::numbers(volume);
            numbers.extend(objects::clips(volume));
            numbers
        }
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

/// The parameter of that name.
///
/// # Errors
///
/// If the scene has no such parameter: a message with the nearest name, or all names.
pub fn number(scene: &Scene, name: &str) -> Result<Number, String> {
    let numbers = numbers(scene);
    if let Some(number) = numbers.iter().find(|number| number.name() == name) {
        return Ok(number.clone());
    }
    let names: Vec<String> = numbers.iter().map(Number::name).collect();
    let near = nearest(name, names.iter().map(String::as_str));
    let near = near.map_or(String::new(), |near| format!("; did you mean {near:?}?"));
    let all = match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    };
    Err(format!(
        "this scene has no parameter {name:?}{near}; it has {all}"
    ))
}

/// The parameters of each of `count` items, with its index where there are several.
fn of_each(count: usize, of_one: impl Fn(usize) -> Vec<Number>) -> impl Iterator<Item = Number> {
    (0..count).flat_map(move |at| {
        let index = (count > 1).then_some(at + 1);
        let numbers = of_one(at).into_iter();
        numbers.map(move |number| number.numbered(index))
    })
}

/// Names of axes in names of parameters.
const AXES: [&str; 3] = ["x", "y", "z"];

/// The names `KIND.x`, "x WORDS" of a place along an axis.
fn along([kind, words, of]: [&str; 3], axis: usize) -> [String; 3] {
    let axis = AXES[axis];
    [
        format!("{kind}.{axis}"),
        format!("{axis} {words}"),
        of.to_owned(),
    ]
}
