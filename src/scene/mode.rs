//! Modes of a classified volume: composited samples, a projection, or isosurfaces.

use super::SceneResult;
use super::format::{Key, Kind, Range};
use super::reader::Reader;
use super::record::Record;
use crate::optics::TransferFunction;
use glam::DVec3;

/// Projections without a number of their own, by name.
const PLAIN: [(&str, Projected); 4] = [
    ("maximum", Projected::Maximum),
    ("minimum", Projected::Minimum),
    ("mean", Projected::Mean),
    ("sum", Projected::Sum),
];
const ATTENUATED: &str = "attenuated-maximum";
const ISOSURFACE: &str = "isosurface";

/// Isosurfaces at most: each is looked for in every cell or step.
const MOST_SURFACES: usize = 64;

/// The keys of `[classified]` that say what a pixel shows, in place of composited samples.
pub(super) const MODE: [Key; 4] = [
    Key::optional("mode", Kind::Choice(&[PLAIN[0].0, PLAIN[1].0, PLAIN[2].0, PLAIN[3].0, ATTENUATED, ISOSURFACE]))
        .doc("Content of a pixel, of the field along its ray: its largest value, its smallest one, its mean or its integral over the way inside the volume (world units), the largest value as the values before it attenuate it, or surfaces of equal value. Sampled every `step`, or exact with `compositing = \"continuous\"`. If left out, samples are composited."),
    Key::optional("attenuation", Kind::Number(Range::NOT_NEGATIVE))
        .doc("Attenuation of `attenuated-maximum`, per world unit of the way through a value at the top of the window."),
    Key::optional("window", Kind::Table(&Window::TABLE))
        .doc("Greys of a projection, from black to white, in place of the colours of the transfer function."),
    Key::optional("isosurface", Kind::Tables(&Isosurface::TABLE))
        .doc("The surfaces of `mode = \"isosurface\"`, at most 64."),
];

/// Content of a pixel, from the field along its ray.
#[derive(Clone, Debug, PartialEq)]
pub enum Mode {
    /// Its samples, or the integral, composited.
    Composited,
    /// One number, as a colour.
    Projection(Projection),
    /// Surfaces of equal value, composited front to back.
    Isosurfaces(Isosurfaces),
}

/// A number for each ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    /// The number.
    pub of: Projected,
    /// Its greys; without them it has the colours of the transfer function.
    pub window: Option<Window>,
    /// A mistake that is made: no file states one.
    pub fault: Option<ProjectionFault>,
}

/// Number that a projection takes of the field over the span of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projected {
    /// Largest value.
    Maximum,
    /// Smallest value.
    Minimum,
    /// Integral, divided by the length of the span.
    Mean,
    /// Integral, value times world units.
    Sum,
    /// Largest value in the window, attenuated by those before it, per world unit.
    AttenuatedMaximum(f64),
}

record! {
    /// Values shown as greys.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Window in "A window of values, shown as greys; constant beyond its ends." {
        low: f64 = required Number(Range::STORED), "Value shown black.";
        high: f64 = required Number(Range::STORED), "Value shown white; above `low`.";
    }
}

/// Surfaces of equal value.
#[derive(Clone, Debug, PartialEq)]
pub struct Isosurfaces {
    /// The surfaces, at least one, no two of one value.
    pub surfaces: Vec<Isosurface>,
    /// Mistakes that are made: no file states one.
    pub faults: Vec<IsosurfaceFault>,
}

record! {
    /// The surface on which the field has one value.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Isosurface in "A surface on which the field has one value." {
        value: f64 = required Number(Range::STORED), "Value of the volume, in the unit of its file.";
        colour: DVec3 = required Colour(Range::NOT_NEGATIVE), "Linear radiance of the surface before shading.";
        opacity: f64 = or("1.0") Number(Range::UNIT), "Fraction of the light behind that is absorbed.";
    }
}

/// A mistake in projections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProjectionFault {
    /// An extremum begins at 0, not at the first value.
    BeginsAtZero,
    /// The maximum is looked for again about the front of the volume.
    RefinedAtTheFront,
    /// The mean is over samples that are not 0.
    WithoutZeros,
    /// Values are attenuated by the way from the entry into the volume, whatever lies on it.
    AttenuatedByDistance,
}

/// A mistake in isosurfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IsosurfaceFault {
    /// A ray ends at its first surface, however transparent.
    FirstAlone,
    /// A surface is at the sample behind it, not between the two.
    AtSamples,
    /// Normals point against the gradient, even away from the eye.
    NotTurned,
    /// Normals are turned away from the eye.
    TurnedAway,
}

impl Window {
    /// Position of `value` in the window, in [0, 1].
    pub fn position(self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }
}

impl Projection {
    /// The window that attenuated values are positions in.
    pub fn unit(&self) -> Window {
        let whole = Window {
            low: 0.0,
            high: 1.0,
        };
        self.window.unwrap_or(whole)
    }

    /// The colour of the number of a ray.
    pub fn colour(&self, number: f64, transfer_function: &TransferFunction) -> DVec3 {
        match (self.of, self.window) {
            (Projected::AttenuatedMaximum(_), _) => DVec3::splat(number),
            (_, Some(window)) => DVec3::splat(window.position(number)),
            (_, None) => transfer_function.colour(number),
        }
    }
}

impl Isosurfaces {
    /// True if no ray passes a surface that is seen in a field with values from `least` to `most`: a
    /// surface parts what is below its value from what is not.
    pub(crate) fn are_unseen_between(&self, least: f64, most: f64) -> bool {
        let is_unseen = |surface: &Isosurface| {
            surface.opacity == 0.0 || surface.value <= least || surface.value > most
        };
        self.surfaces.iter().all(is_unseen)
    }
}

impl Mode {
    /// The mode of `[classified]`, without keys that contradict it; `order` is that of compositing.
    pub(super) fn read(reader: &Reader, order: &str) -> SceneResult<Mode> {
        let Some(name) = reader.optional::<String>("mode")? else {
            let Some(key) = reader.first_of(&["attenuation", "window", "isosurface"]) else {
                return Ok(Mode::Composited);
            };
            let message = format!("`{key}` needs a `mode`: without one, samples are composited");
            let help = "choose what a pixel shows with `mode`, or leave the key out";
            return Err(reader.mistake(key, message, help));
        };
        let (key, own) = ("leave the key out", "isosurfaces have colours of their own");
        let mode = format!("`mode = {name:?}`");
        refuse! { reader:
            "early_termination", format!("{mode} ends no ray early"), key;
            "shadow", format!("nothing casts a shadow with {mode}"), "leave the table out, or `mode`";
            "compositing" if order == "back-to-front", format!("{mode} knows one order: from the eye on"),
                "leave the key out, or say \"continuous\" for exact values";
            "window" if name == ISOSURFACE, own, key;
            "attenuation" if name == ISOSURFACE, own, key;
        }
        if name == ISOSURFACE {
            return Ok(Mode::Isosurfaces(read_surfaces(reader)?));
        }
        refuse! { reader:
            "isosurface", format!("{mode} shows no surface"), "leave the tables out, or say `mode = \"isosurface\"`";
            "phong", format!("{mode} shows a value, which has no normal"), "leave the table out";
        }
        let window = reader.table_as("window", read_window)?;
        refuse! { reader:
            "attenuation" if name != ATTENUATED, format!("{mode} attenuates nothing"),
                "leave the key out, or say `mode = \"attenuated-maximum\"`";
        }
        let of = match PLAIN.iter().find(|(known, _)| *known == name) {
            Some((_, plain)) => *plain,
            None => Projected::AttenuatedMaximum(read_attenuation(reader, window)?),
        };
        Ok(Mode::Projection(Projection {
            of,
            window,
            fault: None,
        }))
    }

    /// True if a mistake is made.
    pub(super) fn has_fault(&self) -> bool {
        match self {
            Mode::Composited => false,
            Mode::Projection(projection) => projection.fault.is_some(),
            Mode::Isosurfaces(surfaces) => !surfaces.faults.is_empty(),
        }
    }

    /// True if the colours of the transfer function are used.
    pub(crate) fn uses_transfer_function(&self) -> bool {
        match self {
            Mode::Composited => true,
            Mode::Projection(projection) => projection.window.is_none(),
            Mode::Isosurfaces(_) => false,
        }
    }

    /// The largest channel of a colour before shading.
    pub(super) fn brightest_colour(&self, transfer_function: &TransferFunction) -> f64 {
        match self {
            Mode::Isosurfaces(Isosurfaces { surfaces, .. }) => {
                let channels = surfaces.iter().map(|surface| surface.colour.max_element());
                channels.fold(0.0, f64::max)
            }
            _ if self.uses_transfer_function() => transfer_function.brightest_colour(),
            _ => 1.0,
        }
    }

    /// Its name in a scene; none of composited samples.
    pub fn name(&self) -> Option<&'static str> {
        match self {
            Mode::Composited => None,
            Mode::Isosurfaces(_) => Some(ISOSURFACE),
            Mode::Projection(projection) => {
                let plain = PLAIN.iter().find(|(_, plain)| *plain == projection.of);
                Some(plain.map_or(ATTENUATED, |(name, _)| name))
            }
        }
    }
}

fn read_window(reader: &Reader) -> SceneResult<Window> {
    let Window { low, high } = Window::read(reader)?;
    refuse! { reader:
        "high" if low >= high, format!("the window ends at {high}, which is not above its begin, {low}"),
            "give a `high` above `low`; for values shown the other way round, give a table of points that falls";
    }
    Ok(Window { low, high })
}

fn read_attenuation(reader: &Reader, window: Option<Window>) -> SceneResult<f64> {
    match (reader.get("attenuation")?, window) {
        (Some(attenuation), Some(_)) => Ok(attenuation),
        _ => Err(reader.mistake(
            "mode",
            "`mode = \"attenuated-maximum\"` needs `attenuation`, per world unit, and [classified.window]",
            "give both: values attenuate by their position in the window from `low` to `high`",
        )),
    }
}

fn read_surfaces(reader: &Reader) -> SceneResult<Isosurfaces> {
    let tables = reader.tables("isosurface")?;
    let count = tables.len();
    refuse! { reader:
        "mode" if count == 0, "`mode = \"isosurface\"` needs a value",
            "give [[classified.isosurface]] with `value` and `colour`, once for each surface";
        "isosurface" if count > MOST_SURFACES,
            format!("{count} isosurfaces are too many: a scene has at most {MOST_SURFACES}");
    }
    let mut surfaces: Vec<Isosurface> = Vec::new();
    for table in &tables {
        let surface = Isosurface::read(table)?;
        refuse! { table:
            "value" if surfaces.iter().any(|other| other.value == surface.value),
                format!("two isosurfaces have the value {}", surface.value),
                "leave one of them out: they are one surface";
        }
        surfaces.push(surface);
    }
    Ok(Isosurfaces {
        surfaces,
        faults: Vec::new(),
    })
}
