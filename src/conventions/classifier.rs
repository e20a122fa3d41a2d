//! Classification: opacity and colour of a value of the field.

use crate::optics::{Appearance, TransferFunction};
use crate::scene::Classified;
use crate::volume::{Cell, Grid, Lerp as _, Reconstruction as _};
use glam::DVec3;

/// Opacity and colour of a sample.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Opacity over the reference length.
    pub opacity: f64,
    /// Colour before shading.
    pub colour: DVec3,
    /// Factor on the shaded colour.
    pub emission: f64,
}

/// Classifies the samples of a scene, by its conventions.
pub enum Classifier<'s> {
    /// By the transfer function at the value of the sample.
    TransferFunction(&'s TransferFunction),
    /// By a table of the transfer function.
    Table(LookTable),
    /// By the nodes, classified before interpolation.
    Nodes(Box<ClassifiedNodes>),
}

impl<'s> Classifier<'s> {
    /// The classifier of `scene`.
    pub fn of(scene: &'s Classified) -> Classifier<'s> {
        let conventions = &scene.conventions;
        match conventions.table_size {
            _ if conventions.preclassified => {
                Classifier::Nodes(Box::new(ClassifiedNodes::of(scene)))
            }
            Some(size) => Classifier::Table(LookTable::of(scene, size)),
            None => Classifier::TransferFunction(&scene.transfer_function),
        }
    }

    /// Opacity and colour of a sample with the value `density` in `cell`.
    pub fn look(&self, scene: &Classified, cell: &Cell, density: f64) -> Look {
        match self {
            Classifier::TransferFunction(function) => exact(function, density),
            Classifier::Table(table) => table.look(density),
            Classifier::Nodes(nodes) => nodes.look(scene, cell),
        }
    }
}

/// The look of `density` by the transfer function itself.
fn exact(function: &TransferFunction, density: f64) -> Look {
    Look {
        opacity: function.reference_opacity(density),
        colour: function.colour(density),
        emission: function.emission(density),
    }
}

/// Looks at equal distances of value.
pub struct LookTable {
    least: f64,
    most: f64,
    entries: Vec<Look>,
    nearest: bool,
}

impl LookTable {
    /// The table of `scene` with `size` entries, at least two.
    fn of(scene: &Classified, size: u32) -> LookTable {
        let function = &scene.transfer_function;
        let (least, most) = match &function.appearance {
            Appearance::Points(points) => {
                let points = points.points();
                (points[0].value, points[points.len() - 1].value)
            }
            Appearance::Formula { .. } => (0.0, scene.grid.range().1),
        };
        let last = f64::from(size - 1);
        let value = |index: u32| f64::lerp_between(least, most, f64::from(index) / last);
        LookTable {
            least,
            most,
            entries: (0..size)
                .map(|index| exact(function, value(index)))
                .collect(),
            nearest: scene.conventions.nearest_entry,
        }
    }

    fn look(&self, value: f64) -> Look {
        let last = self.entries.len() - 1;
        let share = (value - self.least) / (self.most - self.least);
        // A table of one value has no share: its only entry then.
        let place = if share.is_finite() {
            share.clamp(0.0, 1.0) * last as f64
        } else {
            0.0
        };
        if self.nearest {
            return self.entries[place.round() as usize];
        }
        let before = (place as usize).min(last - 1);
        let (a, b, t) = (
            self.entries[before],
            self.entries[before + 1],
            place - before as f64,
        );
        Look {
            opacity: f64::lerp_between(a.opacity, b.opacity, t),
            colour: DVec3::lerp_between(a.colour, b.colour, t),
            emission: f64::lerp_between(a.emission, b.emission, t),
        }
    }
}

/// Nodes with opacity and associated colour.
///
/// Colours are interpolated associated, multiplied by opacity: otherwise the colour of transparent
/// nodes bleeds into their neighbours (Wittenbrink, Malzbender & Goss 1998).
pub struct ClassifiedNodes {
    opacities: Grid<f32>,
    colours: Grid<[f32; 3]>,
}

impl ClassifiedNodes {
    fn of(scene: &Classified) -> ClassifiedNodes {
        let grid = &*scene.grid;
        let looks = grid
            .values()
            .iter()
            .map(|&value| exact(&scene.transfer_function, value.into()));
        let (opacities, colours) = looks
            .map(|look| {
                let associated = look.colour * (look.emission * look.opacity);
                (look.opacity as f32, associated.as_vec3().to_array())
            })
            .unzip();
        ClassifiedNodes {
            opacities: Grid::new(*grid.lattice(), opacities).expect("one opacity per node"),
            colours: Grid::new(*grid.lattice(), colours).expect("one colour per node"),
        }
    }

    fn look(&self, scene: &Classified, cell: &Cell) -> Look {
        let opacity = scene.interpolation.read(&self.opacities, cell);
        let associated = scene.interpolation.read(&self.colours, cell);
        Look {
            opacity,
            colour: if opacity > 0.0 {
                associated / opacity
            } else {
                DVec3::ZERO
            },
            emission: 1.0,
        }
    }
}
