//! A parameter of a scene, and the scene with that parameter changed.

use crate::scene::{Classified, Model, Panel, Radiative, Scene};
use std::fmt;
use std::sync::Arc;

type Edit = Arc<dyn Fn(&mut Panel, f64) -> Option<()> + Send + Sync>;

/// A parameter of a scene.
#[derive(Clone)]
pub struct Number {
    /// Name of its kind: every density is one.
    pub kind: String,
    /// Words for it in a sentence, without an article.
    words: String,
    /// Item that has it, where there are several of these.
    of: String,
    /// Unit of its changes, empty for a parameter without one; `None` for shares: a change of 0.1 makes it a tenth
    /// larger.
    pub unit: Option<&'static str>,
    /// An image is in proportion to it, and something else, so that any step gives the derivative.
    pub is_linear: bool,
    /// Index among several, from 1, in the order of the scene file; `None` for all, or the only one.
    pub index: Option<usize>,
    /// Change by which derivatives are taken, in the unit: small beside what changes
    /// an image altogether, large beside the noise of a few samples.
    pub step: f64,
    edit: Edit,
}

impl Number {
    /// The parameter that `edit` changes in each panel, with its kind, its words and the item that has it. The edit returns
    /// nothing where the changed parameter has no meaning.
    pub(super) fn new(
        names: [impl Into<String>; 3],
        step: f64,
        edit: impl Fn(&mut Panel, f64) -> Option<()> + Send + Sync + 'static,
    ) -> Number {
        let [kind, words, of] = names.map(Into::into);
        Number {
            kind,
            words,
            of,
            unit: None,
            is_linear: false,
            index: None,
            step,
            edit: Arc::new(edit),
        }
    }

    /// A parameter of panels with surfaces, media and lights.
    pub(super) fn radiative(
        names: [impl Into<String>; 3],
        step: f64,
        edit: impl Fn(&mut Radiative, f64) -> Option<()> + Send + Sync + 'static,
    ) -> Number {
        Number::new(names, step, move |panel, change| match &mut panel.model {
            Model::Radiative(scene) => edit(scene, change),
            _ => Some(()),
        })
    }

    /// A parameter of panels with a classified volume.
    pub(super) fn volume(
        names: [impl Into<String>; 3],
        step: f64,
        edit: impl Fn(&mut Classified, f64) + Send + Sync + 'static,
    ) -> Number {
        Number::new(names, step, move |panel, change| {
            if let Model::Classified(volume) = &mut panel.model {
                edit(volume, change);
            }
            Some(())
        })
    }

    /// Its changes are in `unit`, in words.
    pub(super) fn per(self, unit: &'static str) -> Number {
        Number {
            unit: Some(unit),
            ..self
        }
    }

    /// An image is in proportion to it.
    pub(super) fn linear(self) -> Number {
        Number {
            is_linear: true,
            ..self
        }
    }

    /// Makes a parameter of a single volume act on the volume `index`, from 0, of a scene with several.
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
            None => self.kind.clone(),
            Some(index) => format!("{}.{index}", self.kind),
        }
    }

    /// Description for a sentence, without an article: `density of medium 2`.
    pub fn words(&self) -> String {
        let Number { words, of, .. } = self;
        match self.index {
            None => words.clone(),
            Some(index) => {
                let the = format!(" of the {of}");
                let words = words.strip_suffix(&the).unwrap_or(words);
                format!("{words} of {of} {index}")
            }
        }
    }

    /// `scene` with this parameter changed by `change`, in its unit; `None` where the
    /// changed parameter has no meaning, as of an index of 0, or rays would have too many samples.
    pub fn changed(&self, scene: &Scene, change: f64) -> Option<Scene> {
        // Nothing is left of a number that is smaller by all of itself; of light that is a scene too.
        let is_none_left = change < -1.0 || change == -1.0 && !self.is_linear;
        if self.unit.is_none() && is_none_left {
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
