//! Classification: opacity and colour of a value of the field.

use super::opacity::of_entry;
use crate::optics::TransferFunction;
use crate::scene::Classified;
use crate::volume::{Cell, Grid, Lerp as _};
use glam::DVec3;

/// Opacity and colour of a sample.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Opacity over the reference length; that of an entry over a step, if entries are corrected.
    pub opacity: f64,
    /// Colour before shading.
    pub colour: DVec3,
    /// Factor on the shaded colour.
    pub emission: f64,
}

/// Classifies the samples of a scene, by its conventions.
pub enum Classifier {
    /// By the transfer function at the value of the sample.
    TransferFunction,
    /// By a table of the transfer function.
    Table(LookTable),
    /// By the nodes, classified before interpolation.
    Nodes(Box<ClassifiedNodes>),
}

impl Classifier {
    /// The classifier of `scene`.
    pub fn of(scene: &Classified) -> Classifier {
        let conventions = &scene.conventions;
        let size = conventions.table_size;
        let table = size.map(|size| LookTable::of(scene, size));
        let table = match conventions.texture_size {
            Some(size) => table.map(|table| table.texture(scene, size)),
            None => table,
        };
        match table {
            table if conventions.preclassified => {
                Classifier::Nodes(Box::new(ClassifiedNodes::of(scene, table)))
            }
            Some(table) => Classifier::Table(table),
            None => Classifier::TransferFunction,
        }
    }

    /// Opacity and colour of a sample with the value `density` in `cell`.
    pub fn look(&self, scene: &Classified, cell: &Cell, density: f64) -> Look {
        match self {
            Classifier::TransferFunction => exact(&scene.transfer_function, density),
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

/// The look of `density` as the first entry that holds it.
fn entry(scene: &Classified, density: f64) -> Look {
    let look = exact(&scene.transfer_function, density);
    let look = if scene.conventions.texture_size.is_some() {
        look
    } else {
        corrected(scene, look)
    };
    look.rounded(scene)
}

/// `look` with the opacity that an entry holds.
fn corrected(scene: &Classified, look: Look) -> Look {
    let opacity = of_entry(scene, look.opacity);
    Look { opacity, ..look }
}

impl Look {
    /// The look in as many bits as entries have.
    fn rounded(self, scene: &Classified) -> Look {
        let conventions = &scene.conventions;
        let round = |value: f64| {
            if conventions.rounded_down {
                // A whole number but for its rounding stays one.
                (value + 1e-9).floor()
            } else {
                value.round()
            }
        };
        self.in_bits([conventions.colour_bits, conventions.opacity_bits], round)
    }

    /// The look with colour and opacity in whole numbers of steps from 0 to 1.
    fn in_bits(
        mut self,
        [colour_bits, opacity_bits]: [Option<u32>; 2],
        round: impl Fn(f64) -> f64,
    ) -> Look {
        let in_bits = |value: f64, bits: u32| {
            let most = f64::from((1_u32 << bits) - 1);
            round(value.clamp(0.0, 1.0) * most) / most
        };
        if let Some(bits) = opacity_bits {
            self.opacity = in_bits(self.opacity, bits);
        }
        if let Some(bits) = colour_bits {
            // An entry holds the product.
            let colour = (self.colour * self.emission).to_array();
            self.colour = DVec3::from_array(colour.map(|value| in_bits(value, bits)));
            self.emission = 1.0;
        }
        self
    }
}

/// `size` values, at least two, at equal distances.
fn values(least: f64, most: f64, size: u32) -> impl Iterator<Item = f64> {
    let last = f64::from(size - 1);
    (0..size).map(move |index| f64::lerp_between(least, most, f64::from(index) / last))
}

/// Looks at equal distances of value.
pub struct LookTable {
    least: f64,
    most: f64,
    entries: Vec<Look>,
    nearest: bool,
    /// Values are coordinates of a texture.
    is_texture: bool,
    fraction_bits: Option<u32>,
    /// Bits of colours and of opacities between entries.
    lookup_bits: [Option<u32>; 2],
}

impl LookTable {
    /// The table of `scene` with `size` entries, at least two.
    fn of(scene: &Classified, size: u32) -> LookTable {
        let (function, conventions) = (&scene.transfer_function, &scene.conventions);
        let [least, most] = function.domain(scene.grid.range().1);
        let entries = values(least, most, size).map(|value| entry(scene, value));
        let bits = [conventions.colour_bits, conventions.opacity_bits];
        LookTable {
            least,
            most,
            entries: entries.collect(),
            nearest: conventions.nearest_entry,
            is_texture: conventions.texture_place,
            fraction_bits: conventions.table_fraction_bits,
            lookup_bits: bits.map(|bits| bits.and(conventions.lookup_bits)),
        }
    }

    /// A texture of `size` entries, at least two, that holds this table over the range of the densities.
    fn texture(&self, scene: &Classified, size: u32) -> LookTable {
        let (least, most) = scene.grid.range();
        let entries = values(least, most, size);
        LookTable {
            least,
            most,
            entries: entries.map(|it| corrected(scene, self.look(it))).collect(),
            nearest: false,
            is_texture: true,
            fraction_bits: None,
            lookup_bits: [None; 2],
        }
    }

    fn look(&self, value: f64) -> Look {
        let last = self.entries.len() - 1;
        let share = (value - self.least) / (self.most - self.least);
        // A table of one value has no share: its only entry then.
        let place = if share.is_finite() {
            self.place(share.clamp(0.0, 1.0))
        } else {
            0.0
        };
        if self.nearest {
            return self.entries[place.round() as usize];
        }
        let before = (place as usize).min(last - 1);
        let [a, b] = [self.entries[before], self.entries[before + 1]];
        let t = place - before as f64;
        Look {
            opacity: f64::lerp_between(a.opacity, b.opacity, t),
            colour: DVec3::lerp_between(a.colour, b.colour, t),
            emission: f64::lerp_between(a.emission, b.emission, t),
        }
        .in_bits(self.lookup_bits, f64::round)
    }

    /// Place of the value above a share of the range, in entries.
    fn place(&self, share: f64) -> f64 {
        let last = (self.entries.len() - 1) as f64;
        let place = if self.is_texture {
            (share * (last + 1.0) - 0.5).clamp(0.0, last)
        } else {
            share * last
        };
        match self.fraction_bits {
            Some(bits) => {
                let parts = f64::from(1_u32 << bits);
                (place * parts).round() / parts
            }
            None => place,
        }
    }
}

/// Nodes with opacity and colour.
///
/// Colours are interpolated associated, multiplied by opacity: otherwise the colour of transparent
/// nodes bleeds into their neighbours (Wittenbrink, Malzbender & Goss 1998). Some renderers interpolate them
/// separately nevertheless.
pub struct ClassifiedNodes {
    opacities: Grid<f32>,
    colours: Grid<[f32; 3]>,
}

impl ClassifiedNodes {
    fn of(scene: &Classified, table: Option<LookTable>) -> ClassifiedNodes {
        let grid = &*scene.grid;
        let looks = grid.values().iter().map(|&value| match &table {
            Some(table) => table.look(value.into()).rounded(scene),
            None => entry(scene, value.into()),
        });
        let (opacities, colours) = looks
            .map(|look| {
                let colour = if scene.conventions.separate_colours {
                    look.colour * look.emission
                } else {
                    look.colour * (look.emission * look.opacity)
                };
                (look.opacity as f32, colour.as_vec3().to_array())
            })
            .unzip();
        ClassifiedNodes {
            opacities: Grid::new(*grid.lattice(), opacities).expect("one opacity per node"),
            colours: Grid::new(*grid.lattice(), colours).expect("one colour per node"),
        }
    }

    fn look(&self, scene: &Classified, cell: &Cell) -> Look {
        let opacity = scene.interpolation.read(&self.opacities, cell);
        let colour = scene.interpolation.read(&self.colours, cell);
        Look {
            opacity,
            colour: if scene.conventions.separate_colours {
                colour
            } else if opacity > 0.0 {
                colour / opacity
            } else {
                DVec3::ZERO
            },
            emission: 1.0,
        }
    }
}
