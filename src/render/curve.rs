//! The plot of the transfer function: figure 2.
//!
//! Drawn by arithmetic alone, without fonts of the system: the same bits everywhere.

use crate::math;
use crate::media::TransferOpacity;
use crate::scene::Curve;
use embedded_graphics::mono_font::{MonoTextStyle, ascii::FONT_6X12};
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::prelude::*;
use embedded_graphics::text::{Alignment, Baseline, Text, TextStyleBuilder};
use std::convert::Infallible;

/// sRGB colours of the plot.
const PAPER: [u8; 3] = [255, 255, 255];
const GRID: [u8; 3] = [222, 222, 226];
const INK: [u8; 3] = [60, 60, 66];
const TRANSPARENCY: [u8; 3] = [31, 90, 170];
const OPACITY: [u8; 3] = [200, 80, 20];

/// Distance between lines of the grid, on both axes.
const TICK: f64 = 0.2;
/// Half the width of a curve, pixels.
const HALF_WIDTH: f64 = 1.1;

/// Draws `curve` into an image of `width` × `height` pixels, opacity 1.
pub(super) fn draw(curve: &Curve, width: usize, height: usize) -> Vec<[f32; 4]> {
    let plot = Plot::new(curve, width, height);
    let mut pixels: Vec<[f64; 3]> = (0..width * height)
        .map(|index| plot.colour([index % width, index / width]))
        .collect();
    plot.label(&mut pixels, width, height);
    pixels
        .iter()
        .map(|&[r, g, b]| [r as f32, g as f32, b as f32, 1.0])
        .collect()
}

/// The axes: where density and value lie in the image, in pixels from its top left corner.
struct Plot {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    densities: f64,
    curve: TransferOpacity,
}

impl Plot {
    fn new(curve: &Curve, width: usize, height: usize) -> Plot {
        // Room for the labels; whole pixels, so that the frame falls on pixel centres.
        Plot {
            left: 26.5,
            right: (width as f64 - 10.5).max(27.5),
            top: 8.5,
            bottom: (height as f64 - 25.5).max(9.5),
            densities: curve.densities,
            curve: curve.opacity,
        }
    }

    fn x(&self, density: f64) -> f64 {
        self.left + (self.right - self.left) * (density / self.densities)
    }

    fn y(&self, value: f64) -> f64 {
        self.bottom - (self.bottom - self.top) * value
    }

    /// Density below the image coordinate `x`.
    fn density(&self, x: f64) -> f64 {
        ((x - self.left) / (self.right - self.left) * self.densities).max(0.0)
    }

    /// Linear colour of a pixel, but for the labels.
    fn colour(&self, [column, row]: [usize; 2]) -> [f64; 3] {
        let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
        let mut colour = linear(PAPER);
        let inside = x >= self.left && x <= self.right && y >= self.top && y <= self.bottom;
        if !inside {
            return colour;
        }
        let on_line = |position: f64, at: f64| (position - at.floor() - 0.5).abs() < 0.25;
        let on_grid = ticks(self.densities).any(|d| on_line(x, self.x(d)))
            || ticks(1.0).any(|v| on_line(y, self.y(v)));
        if on_grid {
            colour = linear(GRID);
        }
        if x == self.left || y == self.bottom {
            colour = linear(INK);
        }
        let opacity = self.coverage(x, y, |density| self.curve.at(density));
        let transparency = self.coverage(x, y, |density| self.curve.transparency(density));
        colour = blend(colour, linear(OPACITY), opacity);
        blend(colour, linear(TRANSPARENCY), transparency)
    }

    /// Share of the pixel around (x, y) that the line of a function covers: its distance from
    /// the tangent at x, softened over one pixel.
    fn coverage(&self, x: f64, y: f64, function: impl Fn(f64) -> f64) -> f64 {
        let height = |x: f64| self.y(function(self.density(x)));
        let slope = height(x + 0.5) - height(x - 0.5);
        let distance = (y - height(x)).abs() / (1.0 + slope * slope).sqrt();
        (HALF_WIDTH + 0.5 - distance).clamp(0.0, 1.0)
    }

    fn label(&self, pixels: &mut [[f64; 3]], width: usize, height: usize) {
        let mut ink = |text: &str, x: f64, y: f64, colour: [u8; 3], align: Alignment| {
            let mut canvas = Canvas {
                pixels,
                width,
                height,
                colour: linear(colour),
            };
            let style = MonoTextStyle::new(&FONT_6X12, BinaryColor::On);
            let layout = TextStyleBuilder::new()
                .alignment(align)
                .baseline(Baseline::Middle)
                .build();
            let place = Point::new(x.floor() as i32, y.floor() as i32);
            let Ok(_) = Text::with_text_style(text, place, style, layout).draw(&mut canvas);
        };
        for value in ticks(1.0) {
            ink(
                &format!("{value:.1}"),
                self.left - 3.0,
                self.y(value),
                INK,
                Alignment::Right,
            );
        }
        for density in ticks(self.densities) {
            let (x, y) = (self.x(density) + 1.0, self.bottom + 8.0);
            ink(&format!("{density:.1}"), x, y, INK, Alignment::Center);
        }
        let middle = 0.5 * (self.left + self.right);
        ink(
            "density d",
            middle,
            self.bottom + 18.0,
            INK,
            Alignment::Center,
        );
        // Beside the curves, a fifth and a little more from the left, where both are free.
        let x = self.x(0.24 * self.densities);
        let y = self.y(self.curve.transparency(0.24 * self.densities)) + 14.0;
        ink("T(d)", x, y, TRANSPARENCY, Alignment::Right);
        let y = self.y(self.curve.at(0.24 * self.densities)) - 14.0;
        ink("1-T(d)", x, y, OPACITY, Alignment::Right);
    }
}

/// 0, 0.2, 0.4, … up to `end`.
fn ticks(end: f64) -> impl Iterator<Item = f64> {
    let count = (end / TICK * (1.0 + 1e-12)) as usize;
    (0..=count.min(100)).map(|i| i as f64 * TICK)
}

fn linear(srgb: [u8; 3]) -> [f64; 3] {
    srgb.map(|code| math::srgb_to_linear(f64::from(code) / 255.0))
}

fn blend(below: [f64; 3], above: [f64; 3], coverage: f64) -> [f64; 3] {
    std::array::from_fn(|i| below[i] + (above[i] - below[i]) * coverage)
}

/// Where the font's pixels go.
struct Canvas<'p> {
    pixels: &'p mut [[f64; 3]],
    width: usize,
    height: usize,
    colour: [f64; 3],
}

impl OriginDimensions for Canvas<'_> {
    fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }
}

impl DrawTarget for Canvas<'_> {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> Result<(), Infallible>
    where
        I: IntoIterator<Item = Pixel<BinaryColor>>,
    {
        for Pixel(point, colour) in pixels {
            let (Ok(x), Ok(y)) = (usize::try_from(point.x), usize::try_from(point.y)) else {
                continue;
            };
            if colour.is_on() && x < self.width && y < self.height {
                self.pixels[y * self.width + x] = self.colour;
            }
        }
        Ok(())
    }
}
