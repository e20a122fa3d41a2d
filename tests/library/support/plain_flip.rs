//! FLIP a second time, for any float type: plain weighted sums, no symmetry, no shared work,
//! one plain step after the other, along rows and then along columns.
//!
//! In double precision it checks the crate's; in single precision it shows what rounding to
//! float32 alone does to FLIP. Formulas: see `volref::compare::flip`.

use std::ops::{Add, Div, Mul, Sub};

use volref::compare::flip::SrgbImage;

/// A float type to compute FLIP in.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    fn of(value: f64) -> Self;
    fn to_f64(self) -> f64;
    fn sqrt(self) -> Self;
    fn exp(self) -> Self;
    fn pow(self, exponent: Self) -> Self;

    fn abs(self) -> Self {
        if self < Self::of(0.0) {
            Self::of(0.0) - self
        } else {
            self
        }
    }

    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    fn min(self, other: Self) -> Self {
        if self > other { other } else { self }
    }
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn to_f64(self) -> f64 {
        self
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn exp(self) -> Self {
        libm::exp(self)
    }
    fn pow(self, exponent: Self) -> Self {
        libm::pow(self, exponent)
    }
}

impl Real for f32 {
    fn of(value: f64) -> Self {
        value as f32
    }
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    fn exp(self) -> Self {
        libm::expf(self)
    }
    fn pow(self, exponent: Self) -> Self {
        libm::powf(self, exponent)
    }
}

/// FLIP of one pixel and the two quantities it was made of.
#[derive(Clone, Copy)]
pub struct Pixel {
    pub error: f64,
    /// HyAB distance of the blurred colours, before compression.
    pub colour_distance: f64,
    /// Larger of the differences in edge and point strength, before the square root.
    pub feature_distance: f64,
}

type Triple<T> = [T; 3];

/// BT.709 primaries and D65 white at (0.31271, 0.32902), times 73 733 382.
const XYZ_OF_RGB: [[f64; 3]; 3] = [
    [30_406_656.0, 26_366_430.0, 13_305_225.0],
    [15_678_432.0, 52_732_860.0, 5_322_090.0],
    [1_425_312.0, 8_788_810.0, 70_074_185.0],
];

fn matrix<T: Real>() -> [[T; 3]; 3] {
    XYZ_OF_RGB.map(|row| row.map(|v| T::of(v / 73_733_382.0)))
}

fn inverse<T: Real>() -> [[T; 3]; 3] {
    let m = XYZ_OF_RGB.map(|row| row.map(|v| v / 73_733_382.0));
    let minor = |i: usize, j: usize| {
        let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| T::of(minor(j, i) / determinant)))
}

fn white<T: Real>() -> Triple<T> {
    XYZ_OF_RGB.map(|row| T::of(row.iter().sum::<f64>() / 73_733_382.0))
}

/// One over white, rounded once from the exact number.
fn inverse_white<T: Real>() -> Triple<T> {
    XYZ_OF_RGB.map(|row| T::of(73_733_382.0 / row.iter().sum::<f64>()))
}

fn apply<T: Real>(m: &[[T; 3]; 3], v: Triple<T>) -> Triple<T> {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn times<T: Real>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

fn ycxcz<T: Real>(pixel: [u8; 3]) -> Triple<T> {
    let linear = pixel.map(|code| {
        let encoded = T::of(f64::from(code)) / T::of(255.0);
        if encoded <= T::of(0.04045) {
            encoded / T::of(12.92)
        } else {
            ((encoded + T::of(0.055)) / T::of(1.055)).pow(T::of(2.4))
        }
    });
    let [x, y, z] = times(apply(&matrix(), linear), inverse_white());
    [
        T::of(116.0) * y - T::of(16.0),
        T::of(500.0) * (x - y),
        T::of(200.0) * (y - z),
    ]
}

fn clamped_rgb<T: Real>([y, cx, cz]: Triple<T>) -> Triple<T> {
    let y = (y + T::of(16.0)) / T::of(116.0);
    let x = y + cx / T::of(500.0);
    let z = y - cz / T::of(200.0);
    apply(&inverse(), times([x, y, z], white())).map(|c| c.max(T::of(0.0)).min(T::of(1.0)))
}

fn hunt_lab<T: Real>(rgb: Triple<T>) -> Triple<T> {
    let knee = T::of(6.0) / T::of(29.0);
    let [x, y, z] = times(apply(&matrix(), rgb), inverse_white()).map(|t| {
        if t > knee * (knee * knee) {
            t.pow(T::of(1.0) / T::of(3.0))
        } else {
            T::of(1.0) / (T::of(3.0) * (knee * knee)) * t + T::of(4.0) / T::of(29.0)
        }
    });
    let l = T::of(116.0) * y - T::of(16.0);
    let (a, b) = (T::of(500.0) * (x - y), T::of(200.0) * (y - z));
    [l, T::of(0.01) * l * a, T::of(0.01) * l * b]
}

fn hyab<T: Real>(p: Triple<T>, q: Triple<T>) -> T {
    let [l, a, b] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    l.abs() + (a * a + b * b).sqrt()
}

/// The compressed and redistributed colour difference.
pub fn colour_difference<T: Real>(distance: T) -> T {
    let [green, blue] =
        [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb: [f64; 3]| hunt_lab(rgb.map(T::of)));
    let largest = hyab(green, blue).pow(T::of(0.7));
    let knee = T::of(0.4) * largest;
    let compressed = distance.pow(T::of(0.7));
    if compressed < knee {
        compressed * (T::of(0.95) / knee)
    } else {
        T::of(0.95) + (compressed - knee) / (largest - knee) * (T::of(1.0) - T::of(0.95))
    }
}

pub fn feature_difference<T: Real>(distance: T) -> T {
    (T::of(1.0) / T::of(2.0).sqrt() * distance).pow(T::of(0.5))
}

pub fn join<T: Real>(colour: T, feature: T) -> T {
    colour.pow(T::of(1.0) - feature)
}

struct Grid<T> {
    width: usize,
    height: usize,
    values: Vec<T>,
}

impl<T: Real> Grid<T> {
    /// A weighted sum along rows (`across`) or columns.
    fn filtered(&self, weights: &[T], across: bool) -> Self {
        let radius = weights.len() / 2;
        let values = (0..self.values.len())
            .map(|i| {
                let (x, y) = (i % self.width, i / self.width);
                let mut sum = T::of(0.0);
                for (k, &weight) in weights.iter().enumerate() {
                    let near =
                        |at: usize, size: usize| (at + k).saturating_sub(radius).min(size - 1);
                    let (x, y) = if across {
                        (near(x, self.width), y)
                    } else {
                        (x, near(y, self.height))
                    };
                    sum = sum + weight * self.values[y * self.width + x];
                }
                sum
            })
            .collect();
        Self { values, ..*self }
    }

    fn separable(&self, across: &[T], down: &[T]) -> Vec<T> {
        self.filtered(across, true).filtered(down, false).values
    }
}

fn sampled<T: Real>(radius: usize, value: impl Fn(T) -> T) -> Vec<T> {
    (0..=2 * radius)
        .map(|i| value(T::of(i as f64 - radius as f64)))
        .collect()
}

fn sum<T: Real>(values: impl IntoIterator<Item = T>) -> T {
    values
        .into_iter()
        .fold(T::of(0.0), |sum, value| sum + value)
}

/// The four kernels of the contrast filters: achromatic, red–green and the two blue–yellow.
fn contrast_kernels<T: Real>(ppd: T) -> [Vec<T>; 4] {
    let pi = std::f64::consts::PI;
    let radius = (3.0 * (0.04 / (2.0 * pi * pi)).sqrt() * ppd.to_f64()).ceil() as usize;
    let step = T::of(1.0) / ppd;
    let gaussian = |height: f64, b: f64| {
        sampled(radius, move |x: T| {
            let x = x * step;
            T::of(height) * ((T::of(0.0) - T::of(pi * pi)) * (x * x) / T::of(b)).exp()
        })
    };
    let to_one = |kernel: Vec<T>| {
        let scale = T::of(1.0) / sum(kernel.iter().copied());
        kernel.into_iter().map(|w| w * scale).collect()
    };
    // The square root of the height goes into each of the two passes.
    let root = |a: f64, b: f64| (a * (pi / b).sqrt()).sqrt();
    let first = gaussian(root(34.1, 0.04), 0.04);
    let second = gaussian(root(13.5, 0.025), 0.025);
    let (s1, s2) = (sum(first.iter().copied()), sum(second.iter().copied()));
    let scale = T::of(1.0) / (s1 * s1 + s2 * s2).sqrt();
    let scaled = |kernel: Vec<T>| kernel.into_iter().map(|w| w * scale).collect();
    [
        to_one(gaussian((pi / 0.0047).sqrt(), 0.0047)),
        to_one(gaussian((pi / 0.0053).sqrt(), 0.0053)),
        scaled(first),
        scaled(second),
    ]
}

/// Gaussian, first and second derivative.
fn feature_kernels<T: Real>(ppd: T) -> [Vec<T>; 3] {
    let sigma = T::of(0.5) * T::of(0.082) * ppd;
    let radius = (3.0 * sigma.to_f64()).ceil() as usize;
    let zero = T::of(0.0);
    let gaussian = |x: T| (zero - (x * x) / (T::of(2.0) * sigma * sigma)).exp();
    let signed = |kernel: Vec<T>| -> Vec<T> {
        let positive = sum(kernel.iter().copied().filter(|&w| w > zero));
        let negative = sum(kernel.iter().map(|&w| zero - w).filter(|&w| w > zero));
        kernel
            .into_iter()
            .map(|w| w / if w > zero { positive } else { negative })
            .collect()
    };
    let blur = sampled(radius, gaussian);
    let total = sum(blur.iter().copied());
    [
        blur.into_iter().map(|w| w / total).collect(),
        signed(sampled(radius, |x| (zero - x) * gaussian(x))),
        signed(sampled(radius, |x| {
            ((x * x) / (sigma * sigma) - T::of(1.0)) * gaussian(x)
        })),
    ]
}

/// Blurred, clamped, Hunt-adjusted colours, and strengths of edge and point.
fn side<T: Real>(image: &SrgbImage, ppd: T) -> (Vec<Triple<T>>, Vec<[T; 2]>) {
    let colours: Vec<Triple<T>> = image.pixels().iter().map(|&p| ycxcz(p)).collect();
    let grid = |values: Vec<T>| Grid {
        width: image.width(),
        height: image.height(),
        values,
    };
    let channel = |i: usize| grid(colours.iter().map(|c| c[i]).collect());

    let [y_kernel, cx_kernel, cz1_kernel, cz2_kernel] = contrast_kernels(ppd);
    let y = channel(0).separable(&y_kernel, &y_kernel);
    let cx = channel(1).separable(&cx_kernel, &cx_kernel);
    let cz1 = channel(2).separable(&cz1_kernel, &cz1_kernel);
    let cz2 = channel(2).separable(&cz2_kernel, &cz2_kernel);
    let blurred = (0..y.len())
        .map(|i| hunt_lab(clamped_rgb([y[i], cx[i], cz1[i] + cz2[i]])))
        .collect();

    let [along, edge, point] = feature_kernels(ppd);
    let luminance = colours
        .iter()
        .map(|c| c[0] * (T::of(1.0) / T::of(116.0)) + T::of(16.0) / T::of(116.0));
    let luminance = grid(luminance.collect());
    let length = |across: Vec<T>, down: Vec<T>| -> Vec<T> {
        let pairs = across.into_iter().zip(down);
        pairs.map(|(a, d)| (a * a + d * d).sqrt()).collect()
    };
    let edges = length(
        luminance.separable(&edge, &along),
        luminance.separable(&along, &edge),
    );
    let points = length(
        luminance.separable(&point, &along),
        luminance.separable(&along, &point),
    );
    (
        blurred,
        edges.into_iter().zip(points).map(|(e, p)| [e, p]).collect(),
    )
}

/// FLIP of every pixel, computed in `T`.
pub fn plain_flip<T: Real>(reference: &SrgbImage, test: &SrgbImage, ppd: f64) -> Vec<Pixel> {
    let ppd = T::of(ppd);
    let (colours, features) = side(reference, ppd);
    let (test_colours, test_features) = side(test, ppd);
    (0..colours.len())
        .map(|i| {
            let colour_distance = hyab(colours[i], test_colours[i]);
            let [edge, point] = [0, 1].map(|j| (features[i][j] - test_features[i][j]).abs());
            let feature_distance = edge.max(point);
            let error: T = join(
                colour_difference(colour_distance),
                feature_difference(feature_distance),
            );
            Pixel {
                error: error.to_f64(),
                colour_distance: colour_distance.to_f64(),
                feature_distance: feature_distance.to_f64(),
            }
        })
        .collect()
}
