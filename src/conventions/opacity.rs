//! Opacity over a step, from what a transfer function states.

use crate::optics::over_length;
use crate::scene::{Classified, Conventions};

/// Correction of opacities for the length of steps.
pub struct Correction {
    conventions: Conventions,
    /// Length of a step of the scene.
    step: f64,
    /// Length over which opacities are stated.
    reference: f64,
}

impl Correction {
    /// The correction of `scene`.
    pub fn of(scene: &Classified) -> Correction {
        Correction {
            conventions: scene.conventions,
            step: scene.step,
            reference: scene.transfer_function.reference_length,
        }
    }

    /// The opacity that an entry holds, where `stated` is stated for it.
    pub fn of_entry(&self, stated: f64) -> f64 {
        if self.conventions.corrected_entries {
            self.stated_over(stated, self.step)
        } else {
            stated
        }
    }

    /// Opacity of a sample over `length`, where `looked_up` is what the transfer function, a table or
    /// nodes say.
    pub fn over(&self, looked_up: f64, length: f64) -> f64 {
        let over = |length| {
            if self.conventions.corrected_entries {
                self.scaled(looked_up, length / self.step)
            } else {
                self.stated_over(looked_up, length)
            }
        };
        let least = self.conventions.least_opacity;
        if least > 0.0 && over(self.step) < least {
            0.0
        } else {
            over(length)
        }
    }

    fn stated_over(&self, stated: f64, length: f64) -> f64 {
        if stated < self.conventions.least_stated_opacity {
            return 0.0;
        }
        let stated = stated.min(self.conventions.most_opacity);
        let is_of_step = stated <= self.conventions.uncorrected_opacity;
        let unit = if is_of_step {
            self.step
        } else {
            self.reference
        };
        self.scaled(stated, length / unit)
    }

    fn scaled(&self, opacity: f64, lengths: f64) -> f64 {
        if self.conventions.linear_opacity {
            (opacity * lengths).min(1.0)
        } else if lengths == 1.0 && self.conventions.corrected_entries {
            opacity
        } else {
            over_length(opacity, lengths)
        }
    }
}
