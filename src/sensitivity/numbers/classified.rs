//! Numbers of classified volumes.

use super::{Number, Places, Quantity, Unit};
use crate::scene::{Classified, Scene};
use crate::sensitivity::number::Dependence::{self, Linear, Smooth};
use glam::DVec3;

static OPACITY: Quantity = Quantity {
    name: "density",
    words: "extinction of the volume",
    of: "volume",
    unit: Unit::Share,
};
static STEP: Quantity = Quantity {
    name: "step",
    words: "distance between samples",
    of: "volume",
    unit: Unit::Share,
};
static GRID: Places = Places([
    Quantity {
        name: "grid.x",
        words: "x of the grid",
        of: "volume",
        unit: Unit::Absolute("voxels"),
    },
    Quantity {
        name: "grid.y",
        words: "y of the grid",
        of: "volume",
        unit: Unit::Absolute("voxels"),
    },
    Quantity {
        name: "grid.z",
        words: "z of the grid",
        of: "volume",
        unit: Unit::Absolute("voxels"),
    },
]);
static AMBIENT: Quantity = Quantity {
    name: "ambient",
    words: "ambient reflection",
    of: "volume",
    unit: Unit::Share,
};
static DIFFUSE: Quantity = Quantity {
    name: "diffuse",
    words: "diffuse reflection",
    of: "volume",
    unit: Unit::Share,
};
static SPECULAR: Quantity = Quantity {
    name: "specular",
    words: "strength of highlights",
    of: "volume",
    unit: Unit::Share,
};
static SHADOW: Quantity = Quantity {
    name: "shadow",
    words: "extinction towards the light",
    of: "volume",
    unit: Unit::Share,
};
static BACKGROUND: Quantity = Quantity {
    name: "background",
    words: "radiance of the background",
    of: "volume",
    unit: Unit::Share,
};
static LIGHT: Places = Places([
    Quantity {
        name: "light.x",
        words: "x of the light",
        of: "volume",
        unit: Unit::Absolute("world units"),
    },
    Quantity {
        name: "light.y",
        words: "y of the light",
        of: "volume",
        unit: Unit::Absolute("world units"),
    },
    Quantity {
        name: "light.z",
        words: "z of the light",
        of: "volume",
        unit: Unit::Absolute("world units"),
    },
]);

/// Of a volume of which `scene` is the first panel's.
pub(super) fn numbers(scene: &Classified) -> Vec<Number> {
    let mut numbers = Vec::new();
    let mut add = |quantity, step, dependence: Dependence, edit: fn(&mut Classified, f64)| {
        numbers.push(Number::new(quantity, step, dependence, volumes(edit)));
    };
    add(&OPACITY, 0.02, Smooth, |scene, change| {
        scene.transfer_function.reference_length /= 1.0 + change;
    });
    if let Some(phong) = &scene.phong {
        if phong.ambient != 0.0 {
            add(&AMBIENT, 0.5, Linear, |scene, change| {
                scene
                    .phong
                    .iter_mut()
                    .for_each(|it| it.ambient *= 1.0 + change);
            });
        }
        if phong.diffuse != 0.0 {
            add(&DIFFUSE, 0.5, Linear, |scene, change| {
                scene
                    .phong
                    .iter_mut()
                    .for_each(|it| it.diffuse *= 1.0 + change);
            });
        }
        if phong.specular != 0.0 {
            add(&SPECULAR, 0.5, Linear, |scene, change| {
                scene
                    .phong
                    .iter_mut()
                    .for_each(|it| it.specular *= 1.0 + change);
            });
        }
    }
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
    // Samples of another step lie elsewhere: only what is an integral has no step.
    if !scene.is_continuous() {
        add(&STEP, 0.01, Smooth, |scene, change| {
            scene.step *= 1.0 + change
        });
    }
    let voxel = scene.grid.lattice().spacing();
    for axis in 0..3 {
        // The grid moves one way where eye and light move the other.
        let edit = move |scene: &mut Scene, change: f64| {
            let offset = DVec3::AXES[axis] * (-change * voxel[axis]);
            *scene = scene.with_volumes(|volume| {
                volume.light += offset;
                volume.camera = volume.camera.with_eye_moved(offset);
            });
            Some(())
        };
        numbers.push(Number::new(&GRID.0[axis], 0.05, Smooth, edit));
    }
    if scene.phong.is_some() || scene.shadow.is_some() {
        let step = 0.01 * (scene.light - scene.grid.lattice().bounds().centre()).length();
        for axis in 0..3 {
            let edit = move |scene: &mut Scene, change: f64| {
                *scene = scene.with_volumes(|volume| volume.light += DVec3::AXES[axis] * change);
                Some(())
            };
            numbers.push(Number::new(&LIGHT.0[axis], step, Smooth, edit));
        }
    }
    numbers
}

fn volumes(edit: fn(&mut Classified, f64)) -> impl Fn(&mut Scene, f64) -> Option<()> + Send + Sync {
    move |scene, change| {
        *scene = scene.with_volumes(|volume| edit(volume, change));
        Some(())
    }
}
