//! Parameters of classified volumes.

use super::{AXES, Number, along};
use crate::geometry::{InvalidParameter, Transform};
use crate::optics::Phong;
use crate::scene::{Classified, Mode, Model, Panel, Projected};
use glam::DVec3;

const GRID: [&str; 3] = ["grid", "of the grid", "volume"];

/// Strength of a part of the Phong reflection.
type Strength = fn(&mut Phong) -> &mut f64;

/// Parts of the Phong reflection, with their strengths.
const REFLECTIONS: [(&str, &str, Strength); 3] = [
    ("ambient", "ambient reflection", |phong| &mut phong.ambient),
    ("diffuse", "diffuse reflection", |phong| &mut phong.diffuse),
    ("specular", "strength of highlights", |phong| {
        &mut phong.specular
    }),
];

/// Parameters of a volume; `scene` is that of the first panel.
pub(super) fn numbers(scene: &Classified) -> Vec<Number> {
    let mut numbers = Vec::new();
    let of = |name, words, step, edit: fn(&mut Classified, f64)| {
        Number::volume([name, words, "volume"], step, edit)
    };
    // Only composited samples have an opacity over a length.
    if scene.mode == Mode::Composited {
        let words = "extinction of the volume";
        numbers.push(of("density", words, 0.02, |scene, change| {
            scene.transfer_function.reference_length /= 1.0 + change;
        }));
    }
    for (name, words, strength) in REFLECTIONS {
        // Nothing is larger or smaller by a share of 0.
        let mut phong = scene.phong;
        if phong.as_mut().is_some_and(|phong| *strength(phong) != 0.0) {
            let edit = move |scene: &mut Classified, change: f64| {
                let phong = scene.phong.iter_mut();
                phong.for_each(|phong| *strength(phong) *= 1.0 + change);
            };
            numbers.push(Number::volume([name, words, "volume"], 0.5, edit).linear());
        }
    }
    if scene.shadow.is_some() {
        let words = "extinction towards the light";
        numbers.push(of("shadow", words, 0.02, |scene, change| {
            let shadow = scene.shadow.iter_mut();
            shadow.for_each(|it| it.reference_step /= 1.0 + change);
        }));
    }
    if scene.background != DVec3::ZERO {
        let words = "radiance of the background";
        let number = of("background", words, 0.5, |scene, change| {
            scene.background *= 1.0 + change;
        });
        numbers.push(number.linear());
    }
    if attenuation(&mut scene.mode.clone()).is_some_and(|it| *it != 0.0) {
        let words = "attenuation by the values before";
        numbers.push(of("attenuation", words, 0.02, |scene, change| {
            let of = attenuation(&mut scene.mode).into_iter();
            of.for_each(|attenuation| *attenuation *= 1.0 + change);
        }));
    }
    // Samples of another step lie elsewhere: only what is an integral has no step.
    if !scene.continuous {
        let words = "distance between samples";
        numbers.push(of("step", words, 0.01, |scene, change| {
            scene.step *= 1.0 + change;
        }));
    }
    numbers.extend(place(scene));
    if scene.to_world.is_some() {
        numbers.extend(turn_and_size());
    }
    if scene.phong.is_some() || scene.shadow.is_some() {
        let step = 0.01 * (scene.light - scene.extent().world_bounds().centre()).length();
        numbers.extend((0..3).map(|axis| {
            let names = along(["light", "of the light", "volume"], axis);
            let edit = move |volume: &mut Classified, change: f64| {
                volume.light += DVec3::AXES[axis] * change;
            };
            Number::volume(names, step, edit).per("world units")
        }));
    }
    numbers
}

/// Parameters of what all volumes of a scene share.
pub(super) fn shared(scene: &Classified) -> Vec<Number> {
    let numbers = numbers(scene).into_iter();
    numbers.filter(is_of_all).collect()
}

/// Parameters of a volume that others do not share.
pub(super) fn own(scene: &Classified) -> Vec<Number> {
    let own = numbers(scene)
        .into_iter()
        .filter(|number| !is_of_all(number));
    let of_map = turn_and_size().filter(|_| scene.to_world.is_none());
    own.chain(of_map).collect()
}

fn is_of_all(number: &Number) -> bool {
    number.kind == "background" || number.kind.starts_with("light.")
}

/// Coordinates of the volume along its own axes.
pub(super) fn place(scene: &Classified) -> impl Iterator<Item = Number> {
    let edges = scene.cell_edges().into_iter().enumerate();
    edges.map(|(axis, edge)| {
        let map = move |change: f64| Transform::translation(edge * change);
        Number::new(along(GRID, axis), 0.05, placed(map, false)).per("voxels")
    })
}

/// Turns of the volume about axes of the world, one after the other, and sizes along its own.
pub(super) fn turn_and_size() -> impl Iterator<Item = Number> {
    (0..3).flat_map(|axis| {
        let (name, along) = (AXES[axis], DVec3::AXES[axis]);
        let names = |kind: &str, words: &str| {
            let words = format!("{words} {name}");
            [format!("{kind}.{name}"), words, "volume".to_owned()]
        };
        let turned = move |change| Transform::rotation(along, change);
        let scaled = move |change| Transform::scale(DVec3::ONE + along * change);
        let turn = names("turn", "turn of the volume about");
        let size = names("size", "size of the volume along its own");
        [
            Number::new(turn, 0.2, placed(turned, false)).per("degrees"),
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
    let Mode::Projection(projection) = mode else {
        return None;
    };
    match &mut projection.of {
        Projected::AttenuatedMaximum(attenuation) => Some(attenuation),
        _ => None,
    }
}
