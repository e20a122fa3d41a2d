//! A number of a scene, and the scene with that number changed.

use crate::scene::Scene;
use std::fmt;
use std::sync::Arc;

/// What changes of a number are measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// The number itself: a change of 0.1 makes it a tenth larger.
    Share,
    /// What the number is measured in, in words; empty for a number without a unit.
    Absolute(&'static str),
}

/// A kind of number: every density is one.
#[derive(Debug, PartialEq, Eq)]
pub struct Quantity {
    /// The first part of the name.
    pub name: &'static str,
    /// In a sentence, without an article.
    pub words: &'static str,
    /// What it is of, where there are several of these.
    pub of: &'static str,
    /// Of its changes.
    pub unit: Unit,
}

/// How an image depends on a number.
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
    /// What it is.
    pub quantity: &'static Quantity,
    /// Which of several, from 1, in the order of the scene file; `None` for all, or the only one.
    pub index: Option<usize>,
    /// Change by which derivatives are taken, in [units](Quantity::unit): small beside what changes
    /// an image altogether, large beside the noise of a few samples.
    pub step: f64,
    /// How an image depends on it.
    pub dependence: Dependence,
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
            edit: Arc::new(edit),
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

    /// What it is, in a sentence, without an article: `density of medium 2`.
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
