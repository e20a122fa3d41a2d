//! Numbers of classified volumes.

use super::{Number, Quantity, in_classified};
use crate::geometry::{Transform, TransformError};
use crate::optics::Phong;
use crate::scene::{Classified, Mode, Projected, Scene};
use crate::sensitivity::number::Dependence::{self, Linear, Smooth};
use glam::DVec3;

static OPACITY: Quantity = Quantity::share("density", "extinction of the volume", "volume");
static ATTENUATION: Quantity =
    Quantity::share("attenuation", "attenuation by the values before", "volume");
static STEP: Quantity = Quantity::share("step", "distance between samples", "volume");
static GRID: [Quantity; 3] = Quantity::place(
    ["grid.x", "grid.y", "grid.z"],
    ["x of the grid", "y of the grid", "z of the grid"],
    "volume",
    "voxels",
);
static AMBIENT: Quantity = Quantity::share("ambient", "ambient reflection", "volume");
static DIFFUSE: Quantity = Quantity::share("diffuse", "diffuse reflection", "volume");
static SPECULAR: Quantity = Quantity::share("specular", "strength of highlights", "volume");
static SHADOW: Quantity = Quantity::share("shadow", "extinction towards the light", "volume");
static BACKGROUND: Quantity = Quantity::share("background", "radiance of the background", "volume");
static LIGHT: [Quantity; 3] = Quantity::place(
    ["light.x", "light.y", "light.z"],
    ["x of the light", "y of the light", "z of the light"],
    "volume",
    "world units",
);

static TURN: [Quantity; 3] = Quantity::place(
    ["turn.x", "turn.y", "turn.z"],
    [
        "turn of the volume about x",
        "turn of the volume about y",
        "turn of the volume about z",
    ],
    "volume",
    "degrees",
);
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
        numbers.push(Number::new(
            &OPACITY,
            0.02,
            Smooth,
            volumes(|scene, change| scene.transfer_function.reference_length /= 1.0 + change),
        ));
    }
    for (quantity, strength) in REFLECTIONS {
        // Nothing is larger or smaller by a share of 0.
        let mut phong = scene.phong;
        if phong.as_mut().is_some_and(|phong| *strength(phong) != 0.0) {
            let edit = volumes(move |scene, change| {
                let phong = scene.phong.iter_mut();
                phong.for_each(|phong| *strength(phong) *= 1.0 + change);
            });
            numbers.push(Number::new(quantity, 0.5, Linear, edit));
        }
    }
    let mut add = |quantity, step, dependence: Dependence, edit: fn(&mut Classified, f64)| {
        numbers.push(Number::new(quantity, step, dependence, volumes(edit)));
    };
    if scene.shadow.is_some() {
        add(&SHADOW, 0.02, Smooth, |scene, change| {
            scene
                .shadow
                .iter_mut()
                .for_each(|it| it.reference_step /= 1.0 + change);
        });
    }
    if scene.background != DVec3::ZERO {
        add(&BACKGROUND, 0.5, Linear, |scene, change| {
            scene.background *= 1.0 + change;
        });
    }
    if attenuation(&mut scene.mode.clone()).is_some_and(|it| *it != 0.0) {
        add(&ATTENUATION, 0.02, Smooth, |scene, change| {
            let of = attenuation(&mut scene.mode).into_iter();
            of.for_each(|attenuation| *attenuation *= 1.0 + change);
        });
    }
    // Samples of another step lie elsewhere: only what is an integral has no step.
    if !scene.is_continuous() {
        add(&STEP, 0.01, Smooth, |scene, change| {
            scene.step *= 1.0 + change
        });
    }
    numbers.extend(place(scene));
    if scene.to_world.is_some() {
        numbers.extend(turn_and_size());
    }
    if scene.phong.is_some() || scene.shadow.is_some() {
        let step = 0.01 * (scene.light - scene.extent().world_bounds().centre()).length();
        for (axis, quantity) in LIGHT.iter().enumerate() {
            let edit = move |scene: &mut Scene, change: f64| {
                in_classified(scene, |volume| volume.light += DVec3::AXES[axis] * change);
                Some(())
            };
            numbers.push(Number::new(quantity, step, Smooth, edit));
        }
    }
    numbers
}

/// Coordinates of the volume along its own axes.
pub(super) fn place(scene: &Classified) -> impl Iterator<Item = Number> {
    let edges = scene.cell_edges();
    GRID.iter().enumerate().map(move |(axis, quantity)| {
        // The grid moves one way where eye and light move the other.
        let edit = move |scene: &mut Scene, change: f64| {
            let offset = edges[axis] * -change;
            in_classified(scene, |volume| {
                volume.light += offset;
                volume.camera = volume.camera.with_eye_moved(offset);
            });
            Some(())
        };
        Number::new(quantity, 0.05, Smooth, edit)
    })
}

/// Turns of the volume about axes of the world, one after the other, and sizes along its own.
pub(super) fn turn_and_size() -> impl Iterator<Item = Number> {
    let axes = TURN.iter().zip(&SIZE).enumerate();
    axes.flat_map(|(axis, (turn, size))| {
        let turned = move |change| Transform::rotation(DVec3::AXES[axis], change);
        let scaled = move |change| Transform::scale(DVec3::ONE + DVec3::AXES[axis] * change);
        [
            Number::new(turn, 0.2, Smooth, placed(turned, false)),
            Number::new(size, 0.01, Smooth, placed(scaled, true)),
        ]
    })
}

/// A map about the centre of the volume by `change`: before the one that places it, or after.
fn placed(
    map: impl Fn(f64) -> Result<Transform, TransformError> + Send + Sync,
    before: bool,
) -> impl Fn(&mut Scene, f64) -> Option<()> + Send + Sync {
    move |scene, change| {
        let map = map(change).ok()?;
        in_classified(scene, |volume| {
            let extent = volume.extent();
            let to_world = volume.to_world.unwrap_or(Transform::IDENTITY);
            let centre = extent.bounds.centre();
            let about = |centre: DVec3| map.about(centre).ok();
            volume.to_world = if before {
                about(centre).map(|map| map.then(&to_world))
            } else {
                about(extent.in_world(centre)).map(|map| to_world.then(&map))
            };
        });
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

fn volumes(
    edit: impl Fn(&mut Classified, f64) + Send + Sync,
) -> impl Fn(&mut Scene, f64) -> Option<()> + Send + Sync {
    move |scene, change| {
        in_classified(scene, |volume| edit(volume, change));
        Some(())
    }
}
