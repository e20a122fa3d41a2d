//! Convolution with one-dimensional kernels of the three symmetries FLIP needs.
//!
//! A kernel meets its samples through `tap`: `tap(k)` is the row of samples `k` places away
//! from the row of results, to the right or below. So one routine serves rows and columns.
//!
//! Mirrored taps are joined before they are weighted. That halves the products, and makes a
//! derivative of equal samples exactly zero, where a plain weighted sum leaves a rounding error
//! that the square root of the feature difference would blow up.

/// A kernel equal on both sides, with weights that sum to one: a blur.
#[derive(Clone, Debug)]
pub struct Blur {
    centre: f64,
    /// Weights at distance 1, 2, …
    sides: Vec<f64>,
}

/// A kernel of opposite signs on either side: a first derivative. The weights of one side sum
/// to one.
#[derive(Clone, Debug)]
pub struct Slope {
    /// Weights at distance 1, 2, …
    sides: Vec<f64>,
}

/// A kernel equal on both sides, with weights that sum to zero: a second derivative. Its centre
/// weight is minus the sum of the others.
#[derive(Clone, Debug)]
pub struct Bend {
    /// Weights at distance 1, 2, …
    sides: Vec<f64>,
}

impl Blur {
    /// From `weight(distance)` up to and including `radius`, scaled to sum to one. The second
    /// value is the sum before.
    pub fn new(radius: usize, weight: impl Fn(f64) -> f64) -> (Self, f64) {
        let centre = weight(0.0);
        let sides = sides(radius, weight);
        let total = centre + 2.0 * sides.iter().sum::<f64>();
        let sides = sides.iter().map(|w| w / total).collect();
        let centre = centre / total;
        (Self { centre, sides }, total)
    }

    /// The kernel times a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            centre: self.centre * factor,
            sides: self.sides.iter().map(|w| w * factor).collect(),
        }
    }

    pub fn radius(&self) -> usize {
        self.sides.len()
    }

    /// Adds the blurred samples to `sum`.
    pub fn add<'a>(&self, tap: impl Fn(isize) -> &'a [f64], sum: &mut [f64]) {
        for (sum, &here) in sum.iter_mut().zip(tap(0)) {
            *sum += self.centre * here;
        }
        for (k, &weight) in (1..).zip(&self.sides) {
            for ((sum, &before), &after) in sum.iter_mut().zip(tap(-k)).zip(tap(k)) {
                *sum += weight * (before + after);
            }
        }
    }
}

impl Slope {
    /// From `weight(distance)` up to and including `radius`, scaled to sum to one on a side.
    pub fn new(radius: usize, weight: impl Fn(f64) -> f64) -> Self {
        let sides = sides(radius, weight);
        let total: f64 = sides.iter().sum();
        Self {
            sides: sides.iter().map(|w| w / total).collect(),
        }
    }

    /// Adds the derivative of the samples to `sum`.
    pub fn add<'a>(&self, tap: impl Fn(isize) -> &'a [f64], sum: &mut [f64]) {
        for (k, &weight) in (1..).zip(&self.sides) {
            for ((sum, &before), &after) in sum.iter_mut().zip(tap(-k)).zip(tap(k)) {
                *sum += weight * (after - before);
            }
        }
    }
}

impl Bend {
    /// From `weight(distance)` up to and including `radius`: the positive weights are scaled to
    /// sum to one and the negative ones, the centre among them, to sum to minus one.
    pub fn new(radius: usize, weight: impl Fn(f64) -> f64) -> Self {
        let centre = weight(0.0);
        let sides = sides(radius, weight);
        let of_sign = |sign: f64| -> f64 {
            let both_sides: f64 = sides.iter().filter(|&&w| w * sign > 0.0).sum();
            let centre = if centre * sign > 0.0 { centre } else { 0.0 };
            (centre + 2.0 * both_sides).abs()
        };
        let (positive, negative) = (of_sign(1.0), of_sign(-1.0));
        let scaled = |w: &f64| w / if *w > 0.0 { positive } else { negative };
        Self {
            sides: sides.iter().map(scaled).collect(),
        }
    }

    /// Adds the second derivative of the samples to `sum`.
    pub fn add<'a>(&self, tap: impl Fn(isize) -> &'a [f64], sum: &mut [f64]) {
        let centre = tap(0);
        for (k, &weight) in (1..).zip(&self.sides) {
            for (((sum, &before), &after), &here) in
                sum.iter_mut().zip(tap(-k)).zip(tap(k)).zip(centre)
            {
                *sum += weight * ((before - here) + (after - here));
            }
        }
    }
}

/// Weights at distance 1 to `radius`.
fn sides(radius: usize, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (1..=radius).map(|k| weight(k as f64)).collect()
}
