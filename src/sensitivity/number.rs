//! A number of a scene, and the scene with that number changed.

use crate::scene::{Classified, Model, Panel, Radiative, Scene};
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
    /// Dependence of an image on it.
    pub dependence: Dependence,
}

impl Quantity {
    /// One whose changes are shares of itself, and on which images depend smoothly.
    pub(super) const fn share(
        name: &'static str,
        words: &'static str,
        of: &'static str,
    ) -> Quantity {
        Quantity {
            name,
            words,
            of,
            unit: Unit::Share,
            dependence: Dependence::Smooth,
        }
    }

    /// One whose changes are in `unit`, in words.
    pub(super) const fn absolute(
        name: &'static str,
        words: &'static str,
        of: &'static str,
        unit: &'static str,
    ) -> Quantity {
        Quantity {
            unit: Unit::Absolute(unit),
            ..Quantity::share(name, words, of)
        }
    }

    pub(super) const fn linear(self) -> Quantity {
        Quantity {
            dependence: Dependence::Linear,
            ..self
        }
    }
}

/// The quantities `NAME.x`, `NAME.y` and `NAME.z` of what is at a place, moved in `$unit`.
macro_rules! of_axes {
    ($name:literal, $words:literal, $of:literal, $unit:literal) => {
        [
            Quantity::absolute(concat!($name, ".x"), concat!("x ", $words), $of, $unit),
            Quantity::absolute(concat!($name, ".y"), concat!("y ", $words), $of, $unit),
            Quantity::absolute(concat!($name, ".z"), concat!("z ", $words), $of, $unit),
        ]
    };
}
pub(super) use of_axes;

/// Dependence of an image on a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dependence {
    /// In proportion to it, and something else: any step gives the derivative.
    Linear,
    /// Smoothly.
    Smooth,
}

type Edit = Arc<dyn Fn(&mut Panel, f64) -> Option<()> + Send + Sync>;

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
    edit: Edit,
}

impl Number {
    /// The number that `edit` changes in each panel; it returns nothing where the changed number has
    /// no meaning.
    pub(super) fn new(
        quantity: &'static Quantity,
        step: f64,
        edit: impl Fn(&mut Panel, f64) -> Option<()> + Send + Sync + 'static,
    ) -> Number {
        Number {
            quantity,
            index: None,
            step,
            edit: Arc::new(edit),
        }
    }

    /// A number of panels with surfaces, media and lights.
    pub(super) fn radiative(
        quantity: &'static Quantity,
        step: f64,
        edit: impl Fn(&mut Radiative, f64) -> Option<()> + Send + Sync + 'static,
    ) -> Number {
        Number::new(quantity, step, move |panel, change| {
            match &mut panel.model {
                Model::Radiative(scene) => edit(scene, change),
                _ => Some(()),
            }
        })
    }

    /// A number of panels with a classified volume.
    pub(super) fn volume(
        quantity: &'static Quantity,
        step: f64,
        edit: impl Fn(&mut Classified, f64) + Send + Sync + 'static,
    ) -> Number {
        Number::new(quantity, step, move |panel, change| {
            if let Model::Classified(volume) = &mut panel.model {
                edit(volume, change);
            }
            Some(())
        })
    }

    /// This number of a volume alone as that of the volume of this index, from 0, among others.
    pub(super) fn of_volume(self, index: usize) -> Number {
        let edit = self.edit;
        Number {
            edit: Arc::new(move |panel, change| {
                let Model::Classified(scene) = &panel.model else {
                    return Some(());
                };
                let mut alone = Panel {
                    model: scene.alone(index).into(),
                    ..panel.clone()
                };
                edit(&mut alone, change)?;
                if let (Model::Classified(scene), Model::Classified(alone)) =
                    (&mut panel.model, alone.model)
                {
                    scene.put(index, *alone);
                }
                Some(())
            }),
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
    /// changed number has no meaning, as of an index of 0, or rays would have too many samples.
    pub fn changed(&self, scene: &Scene, change: f64) -> Option<Scene> {
        // Nothing is left of a number that is smaller by all of itself; of light that is a scene too.
        let is_none_left = match self.quantity.dependence {
            Dependence::Linear => change < -1.0,
            Dependence::Smooth => change <= -1.0,
        };
        if self.quantity.unit == Unit::Share && is_none_left {
            return None;
        }
        let mut scene = scene.clone();
        for panel in &mut scene.panels {
            (self.edit)(panel, change)?;
            if let Model::Classified(volume) = &panel.model {
                volume.check_samples().ok()?;
            }
        }
        Some(scene)
    }
}

impl fmt::Debug for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name())
    }
}
