//! Convolution with one-dimensional kernels of the three symmetries FLIP needs.
//!
//! A kernel meets its samples through `tap`: `tap(k)` is the row of samples `k` places away
//! from the row of results, to the right or below. So one routine serves rows and columns.
//!
//! Mirrored taps are joined before they are weighted. That halves the products, and makes a
//! derivative of equal samples exactly zero, where a plain weighted sum leaves a rounding error
//! that the square root of the feature difference would blow up.

/// A kernel of one of three symmetries.
#[derive(Clone, Debug)]
pub struct Kernel {
    symmetry: Symmetry,
    /// Weights at distance 1, 2, …
    sides: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Symmetry {
    /// Equal on both sides, with weights that sum to one: a blur.
    Blur { centre: f64 },
    /// A first derivative: opposite signs on either side. The weights of one side sum to one.
    Slope,
    /// Equal on both sides, with weights that sum to zero: a second derivative. Its centre weight is
    /// minus the sum of the others.
    Bend,
}

impl Kernel {
    /// A blur from `weight(distance)` up to and including `radius`, scaled to sum to one. The second
    /// value is the sum before.
    pub fn blur(radius: usize, weight: impl Fn(f64) -> f64) -> (Kernel, f64) {
        let centre = weight(0.0);
        let sides = sides(radius, weight);
        let total = centre + 2.0 * sides.iter().sum::<f64>();
        let kernel = Kernel {
            symmetry: Symmetry::Blur {
                centre: centre / total,
            },
            sides: sides.iter().map(|w| w / total).collect(),
        };
        (kernel, total)
    }

    /// A first derivative from `weight(distance)` up to and including `radius`, scaled to sum to one
    /// on a side.
    pub fn slope(radius: usize, weight: impl Fn(f64) -> f64) -> Kernel {
        let sides = sides(radius, weight);
        let total: f64 = sides.iter().sum();
        Kernel {
            symmetry: Symmetry::Slope,
            sides: sides.iter().map(|w| w / total).collect(),
        }
    }

    /// A second derivative from `weight(distance)` up to and including `radius`: the positive weights
    /// are scaled to sum to one and the negative ones, the centre among them, to sum to minus one.
    pub fn bend(radius: usize, weight: impl Fn(f64) -> f64) -> Kernel {
        let centre = weight(0.0);
        let sides = sides(radius, weight);
        let of_sign = |sign: f64| -> f64 {
            let both_sides: f64 = sides.iter().filter(|&&w| w * sign > 0.0).sum();
            let centre = if centre * sign > 0.0 { centre } else { 0.0 };
            (centre + 2.0 * both_sides).abs()
        };
        let (positive, negative) = (of_sign(1.0), of_sign(-1.0));
        let scaled = |w: &f64| w / if *w > 0.0 { positive } else { negative };
        Kernel {
            symmetry: Symmetry::Bend,
            sides: sides.iter().map(scaled).collect(),
        }
    }

    /// The blur times a factor.
    pub fn scaled(mut self, factor: f64) -> Kernel {
        if let Symmetry::Blur { centre } = &mut self.symmetry {
            *centre *= factor;
        }
        self.sides.iter_mut().for_each(|w| *w *= factor);
        self
    }

    pub fn radius(&self) -> usize {
        self.sides.len()
    }

    /// Adds the samples, blurred or derived, to `sum`.
    pub fn add<'a>(&self, tap: impl Fn(isize) -> &'a [f64], sum: &mut [f64]) {
        let sides = &self.sides;
        match self.symmetry {
            Symmetry::Blur { centre } => {
                for (sum, &here) in sum.iter_mut().zip(tap(0)) {
                    *sum += centre * here;
                }
                add_mirrored(sides, tap, sum, |before, _, after| before + after);
            }
            Symmetry::Slope => add_mirrored(sides, tap, sum, |before, _, after| after - before),
            Symmetry::Bend => add_mirrored(sides, tap, sum, |before, here, after| {
                (before + after) - 2.0 * here
            }),
        }
    }
}

/// Adds to each sum, for every distance, the weight times what `join` makes of the samples that
/// far before, here and that far after.
fn add_mirrored<'a>(
    weights: &[f64],
    tap: impl Fn(isize) -> &'a [f64],
    sum: &mut [f64],
    join: impl Fn(f64, f64, f64) -> f64,
) {
    let here = tap(0);
    for (k, &weight) in (1..).zip(weights) {
        let (before, after) = (tap(-k), tap(k));
        for (x, sum) in sum.iter_mut().enumerate() {
            *sum += weight * join(before[x], here[x], after[x]);
        }
    }
}

/// Weights at distance 1 to `radius`.
fn sides(radius: usize, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (1..=radius).map(|k| weight(k as f64)).collect()
}
