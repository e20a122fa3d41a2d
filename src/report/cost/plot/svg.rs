//! Scalable vector graphics, element by element: lines, marks, text, tooltips. No fonts are needed.

use crate::report::visible::xml_text;
use std::borrow::Cow;
use std::fmt::Write;

/// Purpose of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Theme {
    /// For a page, whose variables are the colours and follow light and dark.
    Page,
    /// A file of its own, on white.
    Standalone,
}

/// Colour by purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ink {
    Text,
    Soft,
    Grid,
    Back,
    Front,
    Guide,
    Shade,
    /// Of the curve with this style.
    Curve(usize),
}

/// A point of the drawing: to the right, and down.
pub(super) type Point = [f64; 2];

const FONT: &str = "system-ui, Helvetica, Arial, sans-serif";

/// Dashes of thin lines that are no curves.
pub(super) const DOTTED: &str = "1 2";

/// Dashes of the curves; with marks and colours, sixteen styles differ.
const DASHES: [&str; 4] = ["", "6 3", "2 2.5", "9 3 2 3"];

/// Colours of the curves on white, dark enough to be read as text: at least 4.5 to 1.
const ON_WHITE: [&str; 8] = [
    "#0b5cad", "#b3400a", "#00705a", "#8d3a94", "#7d6100", "#a8123e", "#4b5560", "#00718c",
];

/// Shapes of marks, as corners about their middle, for marks of radius 1; without corners, a
/// circle. All can be filled or not.
const SHAPES: [&[Point]; 8] = [
    &[],
    &[[-0.85, -0.85], [0.85, -0.85], [0.85, 0.85], [-0.85, 0.85]],
    &[[0.0, -1.1], [1.1, 0.85], [-1.1, 0.85]],
    &[[0.0, -1.25], [1.1, 0.0], [0.0, 1.25], [-1.1, 0.0]],
    &[[0.0, 1.1], [1.1, -0.85], [-1.1, -0.85]],
    &[[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]],
    &[[-1.1, -0.5], [1.1, -0.5], [1.1, 0.5], [-1.1, 0.5]],
    &[[-0.85, -1.1], [1.1, 0.0], [-0.85, 1.1]],
];

/// Dashes of the curve with a style.
pub(super) fn dashes(style: usize) -> &'static str {
    DASHES[(style + style / ON_WHITE.len()) % DASHES.len()]
}

/// A drawing that grows.
pub(super) struct Svg {
    theme: Theme,
    out: String,
}

impl Svg {
    /// An empty drawing of `width` and `height`, of a CSS class for a page; `title` is for readers
    /// that do not see it.
    pub(super) fn new(theme: Theme, class: &str, [width, height]: [f64; 2], title: &str) -> Svg {
        let (kind, paper) = match theme {
            Theme::Page => (format!("class=\"{class}\""), ""),
            Theme::Standalone => (
                format!("width=\"{width}\" height=\"{height}\""),
                "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
            ),
        };
        let title = xml_text(title);
        let out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" {kind} viewBox=\"0 0 {width} {height}\" \
             role=\"img\" aria-label=\"{title}\" font-family=\"{FONT}\" \
             stroke-linejoin=\"round\" stroke-linecap=\"round\">\n{paper}"
        );
        Svg { theme, out }
    }

    /// The file.
    pub(super) fn finish(self) -> String {
        self.out + "</svg>\n"
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        writeln!(self.out, "{element}").expect("a string takes every element");
    }

    fn colour(&self, ink: Ink) -> Cow<'static, str> {
        let (variable, on_white) = match ink {
            Ink::Text => ("var(--text)", "#1c1c1a"),
            Ink::Soft => ("var(--soft)", "#55554f"),
            Ink::Grid => ("var(--grid)", "#e3e3de"),
            Ink::Back => ("var(--back)", "#ffffff"),
            Ink::Front => ("var(--front)", "#d9cfa8"),
            Ink::Guide => ("var(--guide)", "#8a8a82"),
            Ink::Shade => ("var(--shade)", "#efefeb"),
            Ink::Curve(style) => {
                let colour = style % ON_WHITE.len();
                return match self.theme {
                    Theme::Page => format!("var(--curve-{colour})").into(),
                    Theme::Standalone => ON_WHITE[colour].into(),
                };
            }
        };
        match self.theme {
            Theme::Page => variable.into(),
            Theme::Standalone => on_white.into(),
        }
    }

    /// A line through `points`; without `dashes`, in one stroke.
    pub(super) fn line(&mut self, points: &[Point], ink: Ink, width: f64, dashes: &str) {
        let (points, colour) = (joined(points), self.colour(ink));
        let dashes = match dashes {
            "" => String::new(),
            _ => format!(" stroke-dasharray=\"{dashes}\""),
        };
        self.push(format_args!(
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" \
             stroke-width=\"{width}\"{dashes}/>"
        ));
    }

    /// A rectangle without an edge, by two opposite corners.
    pub(super) fn rectangle(&mut self, [x0, y0]: Point, [x1, y1]: Point, ink: Ink) {
        let (corners, fill) = (
            joined(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]),
            self.colour(ink),
        );
        self.push(format_args!(
            "<polygon points=\"{corners}\" fill=\"{fill}\"/>"
        ));
    }

    /// The mark of the curve with this style.
    pub(super) fn mark(&mut self, [x, y]: Point, radius: f64, style: usize, is_hollow: bool) {
        let (fill, edge, width) = match is_hollow {
            true => (Ink::Back, Ink::Curve(style), 1.3),
            // An edge in the colour of the paper tells marks apart that lie on one another.
            false => (Ink::Curve(style), Ink::Back, 0.7),
        };
        let (fill, edge) = (self.colour(fill), self.colour(edge));
        let look = format!("fill=\"{fill}\" stroke=\"{edge}\" stroke-width=\"{width}\"");
        let shape = SHAPES[(style + 3 * (style / ON_WHITE.len())) % SHAPES.len()];
        if shape.is_empty() {
            self.push(format_args!(
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" {look}/>"
            ));
            return;
        }
        let around: Vec<Point> = shape
            .iter()
            .map(|[dx, dy]| [x + radius * dx, y + radius * dy])
            .collect();
        let corners = joined(&around);
        self.push(format_args!("<polygon points=\"{corners}\" {look}/>"));
    }

    /// A cross of two strokes.
    pub(super) fn cross(&mut self, [x, y]: Point, arm: f64, ink: Ink) {
        for sign in [-1.0, 1.0] {
            let ends = [[x - arm, y - sign * arm], [x + arm, y + sign * arm]];
            self.line(&ends, ink, 1.4, "");
        }
    }

    /// A text beside `at`, at its height; `anchor` is its `start`, `middle` or `end`.
    pub(super) fn text(&mut self, text: &str, at: Point, size: f64, ink: Ink, anchor: &str) {
        self.push_text(text, at, size, ink, anchor, "");
    }

    /// The same, upwards.
    pub(super) fn upwards(&mut self, text: &str, [x, y]: Point, size: f64, ink: Ink) {
        let turned = format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"");
        self.push_text(text, [x, y], size, ink, "middle", &turned);
    }

    /// The same with an edge in the colour of the paper, to be read above lines.
    pub(super) fn label(&mut self, text: &str, at: Point, size: f64, ink: Ink, anchor: &str) {
        let back = self.colour(Ink::Back);
        let edge = format!(" stroke=\"{back}\" stroke-width=\"3\" paint-order=\"stroke\"");
        self.push_text(text, at, size, ink, anchor, &edge);
    }

    fn push_text(
        &mut self,
        text: &str,
        [x, y]: Point,
        size: f64,
        ink: Ink,
        anchor: &str,
        more: &str,
    ) {
        let (text, fill) = (xml_text(text), self.colour(ink));
        self.push(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" dy=\".35em\" font-size=\"{size}\" fill=\"{fill}\" \
             text-anchor=\"{anchor}\"{more}>{text}</text>"
        ));
    }

    /// A text that browsers show where the pointer rests near `at`.
    pub(super) fn tooltip(&mut self, [x, y]: Point, text: &str) {
        if !text.is_empty() {
            let text = xml_text(text);
            self.push(format_args!(
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"7\" fill=\"#000\" fill-opacity=\"0\">\
                 <title>{text}</title></circle>"
            ));
        }
    }
}

fn joined(points: &[Point]) -> String {
    let points = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}"));
    points.collect::<Vec<_>>().join(" ")
}
