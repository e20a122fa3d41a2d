//! Steps along the ray that would explain an image.
//!
//! Samples lie elsewhere at each distance, so that none is near another and a distance cannot be
//! approached: a list of factors is tried.

use super::clock::SearchClock;
use super::compared_case::ComparedCase;
use super::fit::{Candidate, Fitted, LEFT};
use crate::scene::Model;

/// Factors that are tried: ratios of small numbers, and those of a wrong unit.
const FACTORS: [f64; 14] = [
    0.1,
    0.2,
    1.0 / 3.0,
    0.4,
    2.0 / 3.0,
    0.75,
    0.8,
    1.25,
    4.0 / 3.0,
    1.5,
    2.5,
    3.0,
    5.0,
    10.0,
];

impl ComparedCase {
    /// The best factor, if it explains most of the difference.
    pub fn fitted_step(&self, clock: &SearchClock<'_>) -> Fitted {
        let nearest = self.nearest_step(clock);
        self.report(nearest.into_iter().collect())
    }

    fn nearest_step(&self, clock: &SearchClock<'_>) -> Option<Candidate> {
        let edited = |factor: f64| {
            let mut edited = self.scene().clone();
            let mut occurs = false;
            for panel in &mut edited.panels {
                if let Model::Classified(scene) = &mut panel.model
                    && !scene.is_continuous()
                {
                    occurs |= scene.edit_volumes(|volume| {
                        volume.step *= factor;
                        true
                    });
                }
            }
            occurs.then_some(edited)
        };
        let label = |factor: f64| format!("step {factor}");
        let predicted = |factor: f64| {
            if clock.is_late() {
                return None;
            }
            self.predicted_with(&edited(factor)?, &label(factor), clock)
        };
        let tried = FACTORS.into_iter().filter_map(|factor| {
            let predicted = predicted(factor)?;
            Some((factor, self.share_left(&predicted)?, predicted))
        });
        let (factor, left, predicted) = tried.min_by(|(_, a, _), (_, b, _)| a.total_cmp(b))?;
        let worth_saying = self.is_explained_but_for(&predicted, LEFT)?;
        let whole = || self.whole_of_scene(&edited(factor)?, &label(factor), clock);
        worth_saying.then_some(Candidate {
            words: format!("steps {factor:.2} times as long"),
            left: left.max(0.0),
            agrees: self.agrees_in_all(&predicted, whole),
            in_noise: self.in_noise(&predicted),
            is_explained: self.is_explained_but_for(&predicted, self.may_leave())?,
            predicted,
        })
    }
}
