//! A number of a scene, and the scene with that number changed.

use crate::scene::Scene;
use std::fmt;
use std::sync::Arc;

/// Unit of the changes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// The number itself: a change of 0.1 makes it a tenth larger.
    Share,
    /// The unit of the number, in words; empty for a number without one.
    Absolute(&'static str),
}

impl Unit {
    /// Name of the unit; `None` for shares.
    pub fn name(self) -> Option<&'static str> {
        match self {
            Unit::Share => None,
            Unit::Absolute(name) => Some(name),
        }
    }
}

/// A kind of number: every density is one.
#[derive(Debug, PartialEq, Eq)]
pub struct Quantity {
    /// The first part of the name.
    pub name: &'static str,
    /// In a sentence, without an article.
    pub words: &'static str,
    /// Item that has it, where there are several of these.
    pub of: &'static str,
    /// Unit of its changes.
    pub unit: Unit,
}

impl Quantity {
    /// One whose changes are shares of itself.
    pub(super) const fn share(
        name: &'static str,
        words: &'static str,
        of: &'static str,
    ) -> Quantity {
        let unit = Unit::Share;
        Quantity {
            name,
            words,
            of,
            unit,
        }
    }

    /// One whose changes are in `unit`, in words.
    pub(super) const fn absolute(
        name: &'static str,
        words: &'static str,
        of: &'static str,
        unit: &'static str,
    ) -> Quantity {
        let unit = Unit::Absolute(unit);
        Quantity {
            name,
            words,
            of,
            unit,
        }
    }

    /// Coordinates x, y and z with these names and words.
    pub(super) const fn place(
        names: [&'static str; 3],
        words: [&'static str; 3],
        of: &'static str,
        unit: &'static str,
    ) -> [Quantity; 3] {
        let [x, y, z] = names;
        let [of_x, of_y, of_z] = words;
        [
            Quantity::absolute(x, of_x, of, unit),
            Quantity::absolute(y, of_y, of, unit),
            Quantity::absolute(z, of_z, of, unit),
        ]
    }
}

/// Dependence of an image on a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dependence {
    /// In proportion to it, and something else: any step gives the derivative.
    Linear,
    /// Smoothly.
    Smooth,
}

type Edit = Arc<dyn Fn(&mut Scene, f64) -> Option<()> + Send + Sync>;

/// A number of a scene.
#[derive(Clone)]
pub struct Number {
    /// Kind of the number.
    pub quantity: &'static Quantity,
    /// Index among several, from 1, in the order of the scene file; `None` for all, or the only one.
    pub index: Option<usize>,
    /// Change by which derivatives are taken, in [units](Quantity::unit): small beside what changes
    /// an image altogether, large beside the noise of a few samples.
    pub step: f64,
    /// Dependence of an image on it.
    pub dependence: Dependence,
    /// Shows in details that are smaller than a block of 8 × 8 pixels, as what glass refracts.
    pub is_fine: bool,
    edit: Edit,
}

impl Number {
    /// The number that `edit` changes; it returns nothing where the changed number has no meaning.
    pub(super) fn new(
        quantity: &'static Quantity,
        step: f64,
        dependence: Dependence,
        edit: impl Fn(&mut Scene, f64) -> Option<()> + Send + Sync + 'static,
    ) -> Number {
        Number {
            quantity,
            index: None,
            step,
            dependence,
            is_fine: false,
            edit: Arc::new(edit),
        }
    }

    pub(super) fn fine(self) -> Number {
        Number {
            is_fine: true,
            ..self
        }
    }

    pub(super) fn numbered(self, index: Option<usize>) -> Number {
        Number { index, ..self }
    }

    /// The name for the command line and for files: `density`, `reflectance.2`.
    pub fn name(&self) -> String {
        match self.index {
            None => self.quantity.name.to_owned(),
            Some(index) => format!("{}.{index}", self.quantity.name),
        }
    }

    /// Description for a sentence, without an article: `density of medium 2`.
    pub fn words(&self) -> String {
        let quantity = self.quantity;
        match self.index {
            None => quantity.words.to_owned(),
            Some(index) => {
                let the = format!(" of the {}", quantity.of);
                let words = quantity.words.strip_suffix(&the).unwrap_or(quantity.words);
                format!("{words} of {} {index}", quantity.of)
            }
        }
    }

    /// `scene` with this number changed by `change`, in [units](Quantity::unit); `None` where the
    /// changed number has no meaning, as of an index of 0.
    pub fn changed(&self, scene: &Scene, change: f64) -> Option<Scene> {
        // Nothing is left of a number that is smaller by all of itself; of light that is a scene too.
        let is_none_left = match self.dependence {
            Dependence::Linear => change < -1.0,
            Dependence::Smooth => change <= -1.0,
        };
        if self.quantity.unit == Unit::Share && is_none_left {
            return None;
        }
        let mut scene = scene.clone();
        (self.edit)(&mut scene, change)?;
        Some(scene)
    }
}

impl fmt::Debug for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name())
    }
}
