//! Effects of single changes of conventions, and the changes that together would leave least if
//! effects added up.

/// Number of sets of changes of each size that are kept while larger ones are built from them.
const BEAM: usize = 16;

/// Number of sets of each size that are proposed.
const PROPOSED: usize = 3;

/// Effects of changes on the deviations of an image: differences of pixels in tolerances.
pub struct Effects {
    /// The choice that each change is about: no two of one choice go together.
    choices: Vec<&'static str>,
    /// Scalar products of the effects.
    products: Vec<Vec<f64>>,
    /// Scalar products of each effect and the deviations before any change.
    on_deviations: Vec<f64>,
    /// Squared norm of the deviations before any change.
    squares: f64,
}

/// A set of changes with the squared norm of the deviations that it would leave.
#[derive(Clone)]
struct Combined {
    changes: Vec<usize>,
    left: f64,
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Effects {
    /// Effects of changes, each with its choice and the deviations after it, on the deviations
    /// `before`.
    pub fn new<'d>(
        before: &[f64],
        after: impl Iterator<Item = (&'static str, &'d [f64])>,
    ) -> Effects {
        let (choices, effects): (Vec<_>, Vec<Vec<f64>>) = after
            .map(|(choice, after)| {
                let effect = after
                    .iter()
                    .zip(before)
                    .map(|(after, before)| after - before);
                (choice, effect.collect())
            })
            .unzip();
        let of = |effect: &Vec<f64>| effects.iter().map(|other| product(effect, other)).collect();
        Effects {
            choices,
            products: effects.iter().map(of).collect(),
            on_deviations: effects.iter().map(|it| product(it, before)).collect(),
            squares: product(before, before),
        }
    }

    /// Sets of two to `most` changes that would leave least, smaller ones first. Each change takes a
    /// share of `least_gain` or more from what is left without it.
    pub fn proposals(&self, most: usize, least_gain: f64) -> Vec<Vec<usize>> {
        let mut beam = vec![Combined {
            changes: Vec::new(),
            left: self.squares,
        }];
        let mut proposals = Vec::new();
        for size in 1..=most {
            let mut longer: Vec<Combined> = Vec::new();
            for shorter in &beam {
                for change in 0..self.choices.len() {
                    let left = self.left_with(shorter, change);
                    if left > (1.0 - least_gain) * shorter.left || !self.is_free(shorter, change) {
                        continue;
                    }
                    let mut changes = shorter.changes.clone();
                    changes.push(change);
                    changes.sort_unstable();
                    if longer.iter().all(|other| other.changes != changes) {
                        longer.push(Combined { changes, left });
                    }
                }
            }
            longer.sort_by(|a, b| a.left.total_cmp(&b.left));
            longer.truncate(BEAM);
            if size > 1 {
                let best = longer.iter().take(PROPOSED);
                proposals.extend(best.map(|combined| combined.changes.clone()));
            }
            beam = longer;
        }
        proposals
    }

    /// True if no change of `set` is about the choice of `change`.
    fn is_free(&self, set: &Combined, change: usize) -> bool {
        let is_same = |&other: &usize| self.choices[other] == self.choices[change];
        !set.changes.iter().any(is_same)
    }

    /// Squared norm of the deviations with `change` besides `set`.
    fn left_with(&self, set: &Combined, change: usize) -> f64 {
        let others = set.changes.iter();
        let others = others.map(|&other| self.products[change][other]);
        let along = self.on_deviations[change] + others.sum::<f64>();
        (set.left + 2.0 * along + self.products[change][change]).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three effects on four values, two of one choice: those that add up to the difference are found.
    #[test]
    fn changes_that_explain_a_difference_together_are_proposed() {
        let before = [1.0, 2.0, 0.0, -3.0];
        let after = [
            ("a", [0.0, 2.0, 0.0, -3.0]),
            ("a", [1.0, 1.5, 0.0, -3.0]),
            ("b", [1.0, 0.0, 0.0, -3.0]),
            ("c", [1.0, 2.0, 0.0, 0.5]),
            ("d", [1.0, 2.0, 5.0, -3.0]),
        ];
        let after = after.iter().map(|(choice, after)| (*choice, &after[..]));
        let effects = Effects::new(&before, after);
        let proposals = effects.proposals(5, 0.03);
        let of_three = proposals.iter().find(|together| together.len() == 3);
        assert_eq!(of_three, Some(&vec![0, 2, 3]));
        assert!(effects.proposals(1, 0.03).is_empty());
    }
}
