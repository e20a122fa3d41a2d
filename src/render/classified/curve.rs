//! The plot of the transfer function: figure 2, or the same for a table of points.
//!
//! Drawn by arithmetic alone, without fonts of the system: the same bits everywhere.

use crate::math;
use crate::optics::TransferPoints;
use crate::render::progress::Progress;
use crate::scene::Curve;
use embedded_graphics::mono_font::{MonoTextStyle, ascii::FONT_6X12};
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::prelude::*;
use embedded_graphics::text::{Alignment, Baseline, Text, TextStyleBuilder};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::convert::Infallible;

/// sRGB colours of the plot.
const PAPER: [u8; 3] = [255, 255, 255];
const GRID: [u8; 3] = [222, 222, 226];
/// sRGB colour of axes, labels, and the line of a table of points.
pub(crate) const INK: [u8; 3] = [60, 60, 66];
/// sRGB colour of the curve of transparency.
pub(crate) const TRANSPARENCY: [u8; 3] = [31, 90, 170];
/// sRGB colour of the curve of opacity.
pub(crate) const OPACITY: [u8; 3] = [200, 80, 20];

/// Distance between lines of the grid, on both axes; with a table of points, upwards only.
const TICK: f64 = 0.2;
/// Half the width of a curve, pixels.
pub(crate) const HALF_WIDTH: f64 = 1.1;

/// The plot of `curve` in an image of `width` × `height` pixels, opacity 1.
pub(in crate::render) fn draw(
    curve: &Curve,
    [width, height]: [usize; 2],
    progress: Progress<'_>,
) -> Vec<[f32; 4]> {
    let plot = PlotLayout::new(curve, width, height);
    let mut pixels = plot.without_curves();
    pixels
        .par_iter_mut()
        .enumerate()
        .for_each(|(index, pixel)| {
            *pixel = plot.with_curves(*pixel, centre(index, width));
            progress.step();
        });
    pixels
        .iter()
        .map(|&[r, g, b]| [r as f32, g as f32, b as f32, 1.0])
        .collect()
}

/// Image coordinates of the centre of a pixel.
fn centre(index: usize, width: usize) -> [f64; 2] {
    [index % width, index / width].map(|place| place as f64 + 0.5)
}

/// The axes of the plot: densities and values to pixels from the top left corner of the image.
pub(crate) struct PlotLayout<'c> {
    width: usize,
    height: usize,
    /// Left end of the axis of densities, pixels from the left edge of the image.
    pub left: f64,
    /// Its right end, pixels from the left edge.
    pub right: f64,
    /// Position of value 1, pixels from the top edge of the image.
    pub top: f64,
    /// Position of value 0, pixels from the top edge.
    pub bottom: f64,
    /// Density at the left end.
    pub from: f64,
    /// Density at the right end.
    pub to: f64,
    /// Lines of the grid on the axis of densities, with their labels.
    ticks: Vec<(f64, String)>,
    curve: &'c Curve,
}

impl PlotLayout<'_> {
    /// The layout of the plot of `curve` in an image of `width` × `height` pixels.
    pub fn new(curve: &Curve, width: usize, height: usize) -> PlotLayout<'_> {
        let (from, to, ticks) = match curve {
            Curve::Formula { densities, .. } => {
                let ticks = ticks(*densities).map(|d| (d, format!("{d:.1}")));
                (0.0, *densities, ticks.collect())
            }
            Curve::Points(points) => {
                let (from, to) = extent(points);
                (from, to, round_ticks(from, to))
            }
        };
        // Room for the labels; whole pixels, so that the frame falls on pixel centres.
        PlotLayout {
            width,
            height,
            left: 26.5,
            right: (width as f64 - 10.5).max(27.5),
            top: 8.5,
            bottom: (height as f64 - 25.5).max(9.5),
            from,
            to,
            ticks,
            curve,
        }
    }

    fn x(&self, density: f64) -> f64 {
        self.left + (self.right - self.left) * ((density - self.from) / (self.to - self.from))
    }

    fn y(&self, value: f64) -> f64 {
        self.bottom - (self.bottom - self.top) * value
    }

    /// Density below the image coordinate `x`.
    fn density(&self, x: f64) -> f64 {
        let share = (x - self.left) / (self.right - self.left);
        (share * (self.to - self.from) + self.from).max(self.from)
    }

    /// Everything but the curves, for readers without our font: linear RGB, row by row from the top.
    pub fn backdrop(&self) -> Vec<[f32; 3]> {
        let pixels = self.without_curves().into_iter();
        pixels.map(|pixel| pixel.map(|it| it as f32)).collect()
    }

    fn without_curves(&self) -> Vec<[f64; 3]> {
        let mut pixels: Vec<[f64; 3]> = (0..self.width * self.height)
            .map(|index| self.paper(centre(index, self.width)))
            .collect();
        self.label(&mut pixels);
        pixels
    }

    fn is_inside(&self, [x, y]: [f64; 2]) -> bool {
        x >= self.left && x <= self.right && y >= self.top && y <= self.bottom
    }

    fn is_on_axis(&self, [x, y]: [f64; 2]) -> bool {
        x == self.left || y == self.bottom
    }

    /// Linear colour of the paper, ruled.
    fn paper(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        if !self.is_inside([x, y]) {
            return linear(PAPER);
        }
        if self.is_on_axis([x, y]) {
            return linear(INK);
        }
        let on_line = |position: f64, at: f64| (position - at.floor() - 0.5).abs() < 0.25;
        let on_grid = self.ticks.iter().any(|(d, _)| on_line(x, self.x(*d)))
            || ticks(1.0).any(|v| on_line(y, self.y(v)));
        linear(if on_grid { GRID } else { PAPER })
    }

    /// Linear colour of a pixel of `colour`, once the curves are drawn.
    fn with_curves(&self, mut colour: [f64; 3], [x, y]: [f64; 2]) -> [f64; 3] {
        if !self.is_inside([x, y]) {
            return colour;
        }
        match self.curve {
            Curve::Formula { opacity: curve, .. } => {
                let opacity = self.coverage(x, y, |density| curve.at(density));
                let transparency = self.coverage(x, y, |density| curve.transparency(density));
                colour = blend(colour, linear(OPACITY), opacity);
                blend(colour, linear(TRANSPARENCY), transparency)
            }
            Curve::Points(points) => {
                let value = self.density(x);
                if !self.is_on_axis([x, y]) && y > self.y(points.opacity(value)) {
                    let shown = points.colour(value).min(DVec3::ONE);
                    colour = shown.to_array();
                }
                let line = self.line_coverage(points, x, y);
                blend(colour, linear(INK), line)
            }
        }
    }

    /// Share of the pixel around (x, y) that the line of a table covers: its distance from the
    /// nearest of the straight lines, softened over one pixel. Steps and peaks narrower than a
    /// pixel are drawn too.
    fn line_coverage(&self, points: &TransferPoints, x: f64, y: f64) -> f64 {
        let here = DVec2::new(x, y);
        let end = |value: f64| (value, points.opacity(value));
        let inner = points
            .points()
            .iter()
            .map(|point| (point.value, point.opacity));
        let corners: Vec<DVec2> = [end(self.from)]
            .into_iter()
            .chain(inner)
            .chain([end(self.to)])
            .map(|(value, opacity)| DVec2::new(self.x(value), self.y(opacity)))
            .collect();
        let to_line = |ends: &[DVec2]| {
            let along = ends[1] - ends[0];
            let share = (here - ends[0]).dot(along) / along.length_squared();
            // Two corners in one place: 0/0.
            let share = if share.is_nan() { 0.0 } else { share };
            here.distance(ends[0] + along * share.clamp(0.0, 1.0))
        };
        let distance = corners
            .windows(2)
            .map(to_line)
            .fold(f64::INFINITY, f64::min);
        (HALF_WIDTH + 0.5 - distance).clamp(0.0, 1.0)
    }

    /// Share of the pixel around (x, y) that the line of a function covers: its distance from
    /// the tangent at x, softened over one pixel.
    fn coverage(&self, x: f64, y: f64, function: impl Fn(f64) -> f64) -> f64 {
        let height = |x: f64| self.y(function(self.density(x)));
        let slope = height(x + 0.5) - height(x - 0.5);
        let distance = (y - height(x)).abs() / (1.0 + slope * slope).sqrt();
        (HALF_WIDTH + 0.5 - distance).clamp(0.0, 1.0)
    }

    /// Writes the labels of the grid, of the axis and of the curves.
    fn label(&self, pixels: &mut [[f64; 3]]) {
        let mut ink = |text: &str, x: f64, y: f64, colour: [u8; 3], align: Alignment| {
            let mut canvas = PlotCanvas {
                pixels,
                width: self.width,
                height: self.height,
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
        for (density, text) in &self.ticks {
            let (x, y) = (self.x(*density) + 1.0, self.bottom + 8.0);
            ink(text, x, y, INK, Alignment::Center);
        }
        let axis = match self.curve {
            Curve::Formula { .. } => "density d",
            Curve::Points(_) => "opacity over value",
        };
        let middle = 0.5 * (self.left + self.right);
        ink(axis, middle, self.bottom + 18.0, INK, Alignment::Center);
        let Curve::Formula { opacity, densities } = self.curve else {
            return;
        };
        // Beside the curves, a fifth and a little more from the left, where both are free.
        let density = 0.24 * densities;
        let x = self.x(density);
        let y = self.y(opacity.transparency(density)) + 14.0;
        ink("T(d)", x, y, TRANSPARENCY, Alignment::Right);
        let y = self.y(opacity.at(density)) - 14.0;
        ink("1-T(d)", x, y, OPACITY, Alignment::Right);
    }
}

/// 0, 0.2, 0.4, … up to `end`.
fn ticks(end: f64) -> impl Iterator<Item = f64> {
    let count = (end / TICK * (1.0 + 1e-12)) as usize;
    (0..=count.min(100)).map(|i| i as f64 * TICK)
}

/// The values from the first point to the last, or some around a lone point.
fn extent(points: &TransferPoints) -> (f64, f64) {
    let points = points.points();
    let (first, last) = (points[0].value, points[points.len() - 1].value);
    if first < last {
        return (first, last);
    }
    let margin = 0.5 * first.abs().max(1.0);
    (first - margin, last + margin)
}

/// Up to six round numbers from `from` to `to`, as text too.
fn round_ticks(from: f64, to: f64) -> Vec<(f64, String)> {
    // The decimal exponent of the extent, without logarithms and their rounding.
    let extent = to - from;
    let shown = format!("{extent:e}");
    let exponent: i32 = shown
        .split_once('e')
        .and_then(|(_, digits)| digits.parse().ok())
        .unwrap_or(0);
    let candidates = [(2, -1), (5, -1), (1, 0), (2, 0)].map(|(digit, shift)| {
        let power = exponent + shift;
        let step = format!("{digit}e{power}").parse().unwrap_or(extent);
        (step, usize::try_from(-power).unwrap_or(0))
    });
    let fits = |(step, _): &(f64, usize)| extent / step <= 5.0;
    let (step, decimals) = candidates.into_iter().find(fits).unwrap_or((extent, 0));
    let first = (from / step).ceil();
    let values = (0..=5).map(|index| (first + f64::from(index)) * step);
    let label = |value: f64| {
        // −0 would show its sign.
        let text = format!("{:.decimals$}", value + 0.0);
        match text.len() {
            0..=6 => text,
            _ => format!("{value:.1e}"),
        }
    };
    values
        .filter(|value| (from..=to).contains(value))
        .map(|value| (value, label(value)))
        .collect()
}

/// The linear colour of these sRGB codes.
pub(crate) fn linear(srgb: [u8; 3]) -> [f64; 3] {
    srgb.map(|code| math::srgb_to_linear(f64::from(code) / 255.0))
}

fn blend(below: [f64; 3], above: [f64; 3], coverage: f64) -> [f64; 3] {
    std::array::from_fn(|i| below[i] + (above[i] - below[i]) * coverage)
}

/// Where the font's pixels go.
struct PlotCanvas<'p> {
    pixels: &'p mut [[f64; 3]],
    width: usize,
    height: usize,
    colour: [f64; 3],
}

impl OriginDimensions for PlotCanvas<'_> {
    fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }
}

impl DrawTarget for PlotCanvas<'_> {
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
