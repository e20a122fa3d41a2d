//! Error against work: SVG that needs neither fonts nor network.

use super::words;
use crate::cost::{Cost, Level, Sweep};
use crate::math::log10;
use crate::report::template::xml;
use minijinja::{Value, context};

/// Width of the drawing, height of the panel, and what is above, below and beside the axes.
const WIDTH: f64 = 800.0;
const HEIGHT: f64 = 340.0;
const ABOVE: f64 = 26.0;
const BELOW: f64 = 44.0;
const LEFT: f64 = 66.0;
const RIGHT: f64 = 14.0;
/// Height of a line of the legend.
const LINE: f64 = 17.0;

/// Colours on white, dark enough to be read as text (at least 4.5 to 1); one for each sweep that there can be.
const COLOURS: [&str; 3] = ["#0b5cad", "#b3400a", "#00705a"];
/// Place of the labels of a curve, right of its marks and below; and the side that they end at.
const LABELS: [(f64, f64, &str); 3] = [
    (6.0, -7.0, "start"),
    (-6.0, 9.0, "end"),
    (7.0, 9.0, "start"),
];

/// Logarithms at the ends of the axes.
struct Axes {
    x: [f64; 2],
    y: [f64; 2],
}

/// The place of a setting along the axis of work; none of no work.
fn across(level: &Level) -> Option<f64> {
    let value = level.work.price();
    (value > 0.0 && level.error.l2 > 0.0 && level.error.l2.is_finite()).then(|| log10(value))
}

/// Ends of an axis around `places`, with free space; at least half a decade.
fn ends(places: impl Iterator<Item = f64> + Clone) -> Option<[f64; 2]> {
    let low = places.clone().reduce(f64::min)?;
    let high = places.reduce(f64::max)?;
    let space = 0.25 + (0.5 - (high - low)).max(0.0) / 2.0;
    Some([low - space, high + space])
}

/// The diagram of the sweeps of a scene: relative RMS error against work. A curve for each sweep, hollow marks where the error may be that of the reference, a dotted line of the expected order.
pub fn plot(cost: &Cost) -> String {
    let lookups = cost.sweeps.iter().flat_map(|sweep| &sweep.levels);
    let work = match lookups.clone().any(|level| level.work.lookups() > 0.0) {
        true => "lookups per pixel",
        false => "random numbers per pixel",
    };
    let places = lookups.clone().filter_map(across);
    let drawn = lookups.filter(|level| across(level).is_some());
    let errors = drawn.map(|level| log10(level.error.l2));
    let axes = ends(places).zip(ends(errors)).map(|(x, y)| Axes { x, y });
    let panel = axes.map(|axes| context! { title => work, ..axes.drawn(&cost.sweeps) });
    let line = |number: usize| ABOVE + HEIGHT + BELOW + LINE * (number as f64 + 0.5);
    let legend = cost.sweeps.iter().enumerate().map(|(at, sweep)| {
        let (y, unit) = (line(at), sweep.parameter.unit());
        context! {
            y => decimal(y),
            points => points(&[[LEFT, y], [LEFT + 30.0, y]]),
            colour => COLOURS[at % COLOURS.len()],
            text => format!("{} [{unit}s]: {}", sweep.name, words::fitted(&sweep.order)),
        }
    });
    let context = context! {
        width => WIDTH.to_string(),
        height => (line(cost.sweeps.len()) + 0.5 * LINE).to_string(),
        name => words::scene(cost),
        panels => Vec::from_iter(panel),
        legend => legend.collect::<Vec<_>>(),
        lowest => decimal(line(cost.sweeps.len())),
    };
    xml(include_str!("plot.svg"), context)
}

fn decimal(number: f64) -> String {
    format!("{number:.1}")
}

fn points(points: &[[f64; 2]]) -> String {
    let points = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}"));
    points.collect::<Vec<_>>().join(" ")
}

impl Axes {
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let share = |[low, high]: [f64; 2], value: f64| (value - low) / (high - low);
        [
            LEFT + (WIDTH - RIGHT - LEFT) * share(self.x, x),
            ABOVE + HEIGHT * (1.0 - share(self.y, y)),
        ]
    }

    /// Lines at powers of ten with their labels, at 2 and 5 where there are few, and the curves.
    fn drawn(&self, sweeps: &[Sweep]) -> Value {
        let (left, right, bottom) = (LEFT, WIDTH - RIGHT, ABOVE + HEIGHT);
        let across = ticks(self.x).into_iter().map(|(tick, text)| {
            let [x, _] = self.place([tick, self.y[0]]);
            context! { text, x => decimal(x), points => points(&[[x, ABOVE], [x, bottom]]) }
        });
        let up = ticks(self.y).into_iter().map(|(tick, text)| {
            let [_, y] = self.place([self.x[0], tick]);
            let points = points(&[[left, y], [right, y]]);
            context! { text, x => decimal(left - 6.0), y => decimal(y), points }
        });
        let curves = sweeps.iter().enumerate();
        context! {
            across => across.collect::<Vec<_>>(),
            up => up.collect::<Vec<_>>(),
            axes => points(&[[left, ABOVE], [left, bottom], [right, bottom]]),
            left => decimal(left),
            middle => decimal(0.5 * (left + right)),
            below => decimal(bottom + 12.0),
            lowest => decimal(bottom + 30.0),
            curves => curves.map(|(at, sweep)| self.curve(at, sweep)).collect::<Vec<_>>(),
        }
    }

    /// The curve of a sweep, number `at` of them.
    fn curve(&self, at: usize, sweep: &Sweep) -> Value {
        let place = |level: &Level| {
            let x = across(level)?;
            Some(self.place([x, log10(level.error.l2)]))
        };
        let (right, below, anchor) = LABELS[at % LABELS.len()];
        let levels = sweep.levels.iter().filter_map(|level| {
            let [x, y] = place(level)?;
            let (setting, error) = (&level.setting, words::error(level.error.l2));
            Some(context! {
                x => decimal(x),
                y => decimal(y),
                is_own => level.value == sweep.own,
                is_hollow => level.error.l2 <= sweep.order.known,
                told => format!("{}, {setting}: error {error}", sweep.name),
                setting => short(level.value),
                right => decimal(x + right),
                below => decimal(y + below),
            })
        });
        context! {
            colour => COLOURS[at % COLOURS.len()],
            anchor,
            guide => self.guide(sweep),
            points => points(&sweep.levels.iter().filter_map(place).collect::<Vec<_>>()),
            levels => levels.collect::<Vec<_>>(),
        }
    }

    /// The expected order as a line through the finest setting whose error is surely its own.
    fn guide(&self, sweep: &Sweep) -> Option<String> {
        let levels = sweep.levels.iter().rev();
        let mut sure = levels.filter(|level| level.error.l2 > sweep.order.known);
        let finest = sure.find_map(|level| Some((across(level)?, level.error.l2)));
        let ((x, error), order) = (finest?, sweep.order.expected?);
        // The work is proportional to samples, and inversely to steps.
        let (slope, y) = (-order.abs(), log10(error));
        // Up to where the line leaves the panel.
        let run = (x - self.x[0]).min((self.y[1] - y) / -slope);
        let ends = [[x - run, y - slope * run], [x, y]];
        Some(points(&ends.map(|end| self.place(end))))
    }
}

/// A setting beside its mark: halves of a voxel as fractions, which are shorter.
fn short(value: f64) -> String {
    match value < 1.0 {
        true => format!("1/{}", 1.0 / value),
        false => value.to_string(),
    }
}

/// Logarithms along an axis with their labels.
fn ticks([low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let span = high - low;
    let every = (span / 8.0).ceil();
    let mut ticks = Vec::new();
    for decade in low.floor() as i32..=high.floor() as i32 {
        for part in [1, 2, 5] {
            let tick = f64::from(decade) + log10(f64::from(part));
            let is_wanted = match part {
                1 => (f64::from(decade) / every).fract() == 0.0,
                _ => span < 2.0,
            };
            if is_wanted && (low..=high).contains(&tick) {
                ticks.push((tick, tick_label(part, decade)));
            }
        }
    }
    ticks
}

/// `part` times ten to the power of `decade`.
fn tick_label(part: i32, decade: i32) -> String {
    match decade {
        0..5 => (part * 10_i32.pow(decade as u32)).to_string(),
        _ => format!("{part}e{decade}"),
    }
}
