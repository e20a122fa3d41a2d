//! Colours, dashes and marks.
//!
//! `plotters` knows colours as three bytes only, and no dashes. So each stroke is drawn as a number,
//! and put right in the finished text: in a page as one of its CSS variables, which follow light
//! and dark, and in a file of its own as the colour itself.

use plotters::style::RGBColor;

/// For what a drawing is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Theme {
    /// A page that defines the variables.
    Page,
    /// A file of its own, on white.
    Standalone,
}

/// Line styles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stroke {
    Text,
    Soft,
    Grid,
    Back,
    Front,
    Guide,
    Shade,
    /// Marks and text of a curve.
    Curve(usize),
    /// The line of a curve, with its dashes.
    Line(usize),
    /// A thin, dotted line that belongs to a curve.
    Dots(usize),
}

/// Curves that can be told apart by colour; dashes and marks tell apart more.
const COLOURS: usize = 8;
/// Curves that differ in anything.
const STYLES: usize = 16;

/// Dark enough on white to be read as text: at least 4.5 to 1.
const ON_WHITE: [&str; COLOURS] = [
    "#0b5cad", "#b3400a", "#00705a", "#8d3a94", "#7d6100", "#a8123e", "#4b5560", "#00718c",
];

/// Dashes, in tenths.
const DASHES: [&str; 4] = ["", "60 30", "20 25", "90 30 20 30"];

/// Shapes of marks, as corners about their middle, for marks of radius 1; without corners, a
/// circle. All can be filled or not.
const SHAPES: [&[[f64; 2]]; 8] = [
    &[],
    &[[-0.85, -0.85], [0.85, -0.85], [0.85, 0.85], [-0.85, 0.85]],
    &[[0.0, -1.1], [1.1, 0.85], [-1.1, 0.85]],
    &[[0.0, -1.25], [1.1, 0.0], [0.0, 1.25], [-1.1, 0.0]],
    &[[0.0, 1.1], [1.1, -0.85], [-1.1, -0.85]],
    &[[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]],
    &[[-1.1, -0.5], [1.1, -0.5], [1.1, 0.5], [-1.1, 0.5]],
    &[[-0.85, -1.1], [1.1, 0.0], [-0.85, 1.1]],
];

/// The corners of a curve's marks.
pub(super) fn shape(style: usize) -> &'static [[f64; 2]] {
    SHAPES[(style + 3 * (style / COLOURS)) % SHAPES.len()]
}

fn dashes(style: usize) -> &'static str {
    DASHES[(style + style / COLOURS) % DASHES.len()]
}

impl Stroke {
    /// As a number.
    pub(super) fn code(self) -> RGBColor {
        let (kind, which) = match self {
            Stroke::Text => (0, 0),
            Stroke::Soft => (0, 1),
            Stroke::Grid => (0, 2),
            Stroke::Back => (0, 3),
            Stroke::Front => (0, 4),
            Stroke::Guide => (0, 5),
            Stroke::Shade => (0, 6),
            Stroke::Curve(style) => (1, style % STYLES),
            Stroke::Line(style) => (2, style % STYLES),
            Stroke::Dots(style) => (3, style % STYLES),
        };
        RGBColor(kind, which as u8, 0xA5)
    }

    /// As a colour.
    pub(super) fn colour(self, theme: Theme) -> String {
        let (variable, on_white) = match self {
            Stroke::Text => ("text", "#1c1c1a"),
            Stroke::Soft => ("soft", "#55554f"),
            Stroke::Grid => ("grid", "#e3e3de"),
            Stroke::Back => ("back", "#ffffff"),
            Stroke::Front => ("front", "#d9cfa8"),
            Stroke::Guide => ("guide", "#8a8a82"),
            Stroke::Shade => ("shade", "#efefeb"),
            Stroke::Curve(style) | Stroke::Line(style) | Stroke::Dots(style) => {
                let colour = style % COLOURS;
                return match theme {
                    Theme::Page => format!("var(--curve-{colour})"),
                    Theme::Standalone => ON_WHITE[colour].to_owned(),
                };
            }
        };
        match theme {
            Theme::Page => format!("var(--{variable})"),
            Theme::Standalone => on_white.to_owned(),
        }
    }

    fn all() -> impl Iterator<Item = Stroke> {
        let single = [
            Stroke::Text,
            Stroke::Soft,
            Stroke::Grid,
            Stroke::Back,
            Stroke::Front,
            Stroke::Guide,
            Stroke::Shade,
        ];
        let styled = |style| {
            [
                Stroke::Curve(style),
                Stroke::Line(style),
                Stroke::Dots(style),
            ]
        };
        single.into_iter().chain((0..STYLES).flat_map(styled))
    }

    fn dashes(self) -> &'static str {
        match self {
            Stroke::Line(style) => dashes(style),
            Stroke::Guide | Stroke::Dots(_) => "10 20",
            _ => "",
        }
    }
}

/// The drawing with colours for numbers. No text of a user can be taken for one: quotes in texts
/// are escaped.
pub(super) fn themed(mut svg: String, theme: Theme) -> String {
    for stroke in Stroke::all() {
        let RGBColor(r, g, b) = stroke.code();
        let code = format!("=\"#{r:02X}{g:02X}{b:02X}\"");
        let colour = stroke.colour(theme);
        let dashes = stroke.dashes();
        if !dashes.is_empty() {
            let dashed = format!("stroke=\"{colour}\" stroke-dasharray=\"{dashes}\"");
            svg = svg.replace(&format!("stroke{code}"), &dashed);
        }
        svg = svg.replace(&code, &format!("=\"{colour}\""));
    }
    svg
}
