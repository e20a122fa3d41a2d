//! Numbers of classified volumes.

use super::{Number, Quantity, of_axes};
use crate::geometry::{InvalidParameter, Transform};
use crate::optics::Phong;
use crate::scene::{Classified, Mode, Model, Panel, Projected};
use glam::DVec3;

static OPACITY: Quantity = Quantity::share("density", "extinction of the volume", "volume");
static ATTENUATION: Quantity =
    Quantity::share("attenuation", "attenuation by the values before", "volume");
static STEP: Quantity = Quantity::share("step", "distance between samples", "volume");
static GRID: [Quantity; 3] = of_axes!("grid", "of the grid", "volume", "voxels");
static AMBIENT: Quantity = Quantity::share("ambient", "ambient reflection", "volume").linear();
static DIFFUSE: Quantity = Quantity::share("diffuse", "diffuse reflection", "volume").linear();
static SPECULAR: Quantity =
    Quantity::share("specular", "strength of highlights", "volume").linear();
static SHADOW: Quantity = Quantity::share("shadow", "extinction towards the light", "volume");
static BACKGROUND: Quantity =
    Quantity::share("background", "radiance of the background", "volume").linear();
static LIGHT: [Quantity; 3] = of_axes!("light", "of the light", "volume", "world units");

static TURN: [Quantity; 3] = [
    Quantity::absolute("turn.x", "turn of the volume about x", "volume", "degrees"),
    Quantity::absolute("turn.y", "turn of the volume about y", "volume", "degrees"),
    Quantity::absolute("turn.z", "turn of the volume about z", "volume", "degrees"),
];
static SIZE: [Quantity; 3] = [
    Quantity::share("size.x", "size of the volume along its own x", "volume"),
    Quantity::share("size.y", "size of the volume along its own y", "volume"),
    Quantity::share("size.z", "size of the volume along its own z", "volume"),
];

/// Strength of a part of the Phong reflection.
type Strength = fn(&mut Phong) -> &mut f64;

/// Parts of the Phong reflection, with their strengths.
const REFLECTIONS: [(&Quantity, Strength); 3] = [
    (&AMBIENT, |phong| &mut phong.ambient),
    (&DIFFUSE, |phong| &mut phong.diffuse),
    (&SPECULAR, |phong| &mut phong.specular),
];

/// Numbers of a volume; `scene` is that of the first panel.
pub(super) fn numbers(scene: &Classified) -> Vec<Number> {
    let mut numbers = Vec::new();
    // Only composited samples have an opacity over a length.
    if scene.mode == Mode::Composited {
        numbers.push(Number::volume(&OPACITY, 0.02, |scene, change| {
            scene.transfer_function.reference_length /= 1.0 + change;
        }));
    }
    for (quantity, strength) in REFLECTIONS {
        // Nothing is larger or smaller by a share of 0.
        let mut phong = scene.phong;
        if phong.as_mut().is_some_and(|phong| *strength(phong) != 0.0) {
            numbers.push(Number::volume(quantity, 0.5, move |scene, change| {
                let phong = scene.phong.iter_mut();
                phong.for_each(|phong| *strength(phong) *= 1.0 + change);
            }));
        }
    }
    let mut add = |quantity, step, edit: fn(&mut Classified, f64)| {
        numbers.push(Number::volume(quantity, step, edit));
    };
    if scene.shadow.is_some() {
        add(&SHADOW, 0.02, |scene, change| {
            let shadow = scene.shadow.iter_mut();
            shadow.for_each(|it| it.reference_step /= 1.0 + change);
        });
    }
    if scene.background != DVec3::ZERO {
        add(&BACKGROUND, 0.5, |scene, change| {
            scene.background *= 1.0 + change;
        });
    }
    if attenuation(&mut scene.mode.clone()).is_some_and(|it| *it != 0.0) {
        add(&ATTENUATION, 0.02, |scene, change| {
            let of = attenuation(&mut scene.mode).into_iter();
            of.for_each(|attenuation| *attenuation *= 1.0 + change);
        });
    }
    // Samples of another step lie elsewhere: only what is an integral has no step.
    if !scene.is_continuous() {
        add(&STEP, 0.01, |scene, change| scene.step *= 1.0 + change);
    }
    numbers.extend(place(scene));
    if scene.to_world.is_some() {
        numbers.extend(turn_and_size());
    }
    if scene.phong.is_some() || scene.shadow.is_some() {
        let step = 0.01 * (scene.light - scene.extent().world_bounds().centre()).length();
        numbers.extend(LIGHT.iter().enumerate().map(|(axis, quantity)| {
            Number::volume(quantity, step, move |volume, change| {
                volume.light += DVec3::AXES[axis] * change;
            })
        }));
    }
    numbers
}

/// Numbers of what all volumes of a scene share.
pub(super) fn shared(scene: &Classified) -> Vec<Number> {
    let numbers = numbers(scene).into_iter();
    numbers.filter(is_of_all).collect()
}

/// Numbers of a volume that others do not share; its place is that of its map.
pub(super) fn own(scene: &Classified) -> Vec<Number> {
    let is_of_place = |number: &Number| {
        [&GRID, &TURN, &SIZE]
            .iter()
            .any(|it| it.contains(number.quantity))
    };
    let numbers = numbers(scene).into_iter();
    let of_look = numbers.filter(|number| !is_of_all(number) && !is_of_place(number));
    let edges = scene.cell_edges();
    let moved = GRID.iter().zip(edges).map(|(quantity, edge)| {
        let map = move |change: f64| Transform::translation(edge * change);
        Number::new(quantity, 0.05, placed(map, false))
    });
    of_look.chain(moved).chain(turn_and_size()).collect()
}

fn is_of_all(number: &Number) -> bool {
    *number.quantity == BACKGROUND || LIGHT.contains(number.quantity)
}

/// Coordinates of the volume along its own axes.
pub(super) fn place(scene: &Classified) -> impl Iterator<Item = Number> {
    let edges = scene.cell_edges();
    GRID.iter().enumerate().map(move |(axis, quantity)| {
        // The grid moves one way where eye and light move the other.
        Number::volume(quantity, 0.05, move |volume, change| {
            let offset = edges[axis] * -change;
            volume.light += offset;
            volume.camera = volume.camera.with_eye_moved(offset);
        })
    })
}

/// Turns of the volume about axes of the world, one after the other, and sizes along its own.
pub(super) fn turn_and_size() -> impl Iterator<Item = Number> {
    let axes = TURN.iter().zip(&SIZE).enumerate();
    axes.flat_map(|(axis, (turn, size))| {
        let turned = move |change| Transform::rotation(DVec3::AXES[axis], change);
        let scaled = move |change| Transform::scale(DVec3::ONE + DVec3::AXES[axis] * change);
        [
            Number::new(turn, 0.2, placed(turned, false)),
            Number::new(size, 0.01, placed(scaled, true)),
        ]
    })
}

/// A map about the centre of the volume by `change`: before the one that places it, or after.
fn placed(
    map: impl Fn(f64) -> Result<Transform, InvalidParameter> + Send + Sync,
    before: bool,
) -> impl Fn(&mut Panel, f64) -> Option<()> + Send + Sync {
    move |panel, change| {
        let map = map(change).ok()?;
        if let Model::Classified(volume) = &mut panel.model {
            let extent = volume.extent();
            let to_world = volume.to_world.unwrap_or(Transform::IDENTITY);
            let centre = extent.bounds.centre();
            let about = |centre: DVec3| map.about(centre).ok();
            volume.to_world = if before {
                about(centre).map(|map| map.then(&to_world))
            } else {
                about(extent.in_world(centre)).map(|map| to_world.then(&map))
            };
        }
        Some(())
    }
}

/// The attenuation of a projection that has one.
fn attenuation(mode: &mut Mode) -> Option<&mut f64> {
    match mode {
        Mode::Projection(projection) => match &mut projection.of {
            Projected::AttenuatedMaximum(attenuation) => Some(attenuation),
            _ => None,
        },
        _ => None,
    }
}
