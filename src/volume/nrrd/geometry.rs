//! Geometry of a file of NRRD: its axes of space, and the positions of the samples along them.

use crate::volume::Centring;
use crate::volume::error::VolumeFault;
use crate::volume::header_field::{HeaderField, HeaderFields};
use crate::volume::orientation::Axes;
use crate::volume::samples::check_sizes;
use glam::DVec3;

/// Coordinate systems of the format, and their short names; each may be followed by time.
const SPACES: [(&str, &str); 6] = [
    ("right-anterior-superior", "RAS"),
    ("left-anterior-superior", "LAS"),
    ("left-posterior-superior", "LPS"),
    ("scanner-xyz", ""),
    ("3D-right-handed", ""),
    ("3D-left-handed", ""),
];

/// The coordinate system, if it is one of the format.
pub(super) fn space(fields: &HeaderFields) -> Option<&'static str> {
    let written = fields.get("space")?.value.to_ascii_lowercase();
    let space = match written.strip_suffix("-time") {
        Some(space) => space,
        // RAST, LAST and LPST.
        None if written.len() == 4 => written.strip_suffix('t')?,
        None => &written,
    };
    let found = SPACES.iter().find(|(name, short)| {
        [name, short]
            .into_iter()
            .any(|name| name.eq_ignore_ascii_case(space))
    });
    found.map(|(name, _)| *name)
}

/// The role of each axis; an error if one that is not of space has several samples.
fn roles(fields: &HeaderFields, sizes: &[u64]) -> Result<Vec<Role>, VolumeFault> {
    let Some(field) = fields.get("kinds") else {
        return Ok(vec![Role::Space; sizes.len()]);
    };
    let kinds = field.each(sizes.len(), |kind| Ok(kind.to_owned()))?;
    let role = |(axis, kind): (usize, &String)| match kind.to_ascii_lowercase().as_str() {
        "domain" | "space" | "???" | "none" => Ok(Role::Space),
        "stub" | "scalar" if sizes[axis] == 1 => Ok(Role::Placeholder),
        _ if sizes[axis] == 1 => Ok(Role::Other),
        _ => Err(field.no_space(axis)),
    };
    kinds.iter().enumerate().map(role).collect()
}

/// The directions of the axes; `None` if they are all unknown.
fn directions(
    fields: &HeaderFields,
    sizes: &[u64],
) -> Result<Option<Vec<Option<DVec3>>>, VolumeFault> {
    let Some(field) = fields.get("space directions") else {
        return Ok(None);
    };
    let mut directions = field.vectors(sizes.len())?;
    if directions.iter().all(Option::is_none) {
        return Ok(None);
    }
    for (axis, direction) in directions.iter_mut().enumerate() {
        // Zero leads nowhere.
        *direction = direction.filter(|&direction| direction != DVec3::ZERO);
        if direction.is_none() && sizes[axis] > 1 {
            return Err(field.no_space(axis));
        }
    }
    Ok(Some(directions))
}

/// Positions of the samples.
pub(super) fn axes(fields: &HeaderFields, sizes: &[u64]) -> Result<Axes, VolumeFault> {
    let dimension = sizes.len();
    let mut roles = roles(fields, sizes)?;
    let directions = directions(fields, sizes)?;
    for (role, direction) in roles.iter_mut().zip(directions.iter().flatten()) {
        if direction.is_none() {
            *role = Role::Other;
        }
    }
    let kept = kept_axes(sizes, &roles)?;
    let mut axes = Axes {
        sizes: check_sizes(kept.map(|axis| sizes[axis]))?,
        steps: DVec3::AXES,
        first: DVec3::ZERO,
        centring: centring(fields, dimension, kept)?,
    };
    let numbers = |name, expected, accepts: fn(f64) -> bool| match fields.get(name) {
        Some(field) => numbers(field, expected, accepts, dimension, kept),
        None => Ok([None; 3]),
    };
    let spacings = numbers("spacings", "finite, non-zero", f64::is_normal)?;
    let mins = numbers("axis mins", "finite", f64::is_finite)?;
    let maxs = numbers("axis maxs", "finite", f64::is_finite)?;
    let origin = match fields.get("space origin") {
        Some(field) => field.vector_in(&field.value)?,
        None => None,
    };
    axes.first = origin.unwrap_or_default();
    if let Some(directions) = directions {
        axes.steps = kept.map(|axis| directions[axis].expect("the axes of space have one"));
        return Ok(axes);
    }
    for axis in 0..3 {
        let stated = [spacings[axis], mins[axis], maxs[axis]];
        let (spacing, first) = resolved(axes.sizes[axis], axes.centring, stated);
        axes.steps[axis] *= spacing;
        axes.first[axis] = first.unwrap_or(axes.first[axis]);
    }
    Ok(axes)
}

fn centring(
    fields: &HeaderFields,
    dimension: usize,
    kept: [usize; 3],
) -> Result<Centring, VolumeFault> {
    let Some(field) = fields.get("centers") else {
        return Ok(Centring::Nodes);
    };
    let expected = "cell, node, ??? or none for each axis";
    let all = field.each(dimension, |word| match word.to_ascii_lowercase().as_str() {
        "cell" => Ok(Some(Centring::Cells)),
        "node" => Ok(Some(Centring::Nodes)),
        "???" | "none" => Ok(None),
        _ => Err(field.wrong(expected)),
    })?;
    let mut known = kept.iter().filter_map(|&axis| all[axis]);
    let first = known.next().unwrap_or_default();
    if known.any(|other| other != first) {
        return Err(field.wrong("the same for all axes"));
    }
    Ok(first)
}

/// Numbers of the axes that are kept; `None` where they are unknown.
fn numbers(
    field: &HeaderField,
    expected: &str,
    accepts: fn(f64) -> bool,
    dimension: usize,
    kept: [usize; 3],
) -> Result<[Option<f64>; 3], VolumeFault> {
    let wrong = || {
        field.wrong(&format!(
            "a {expected} number for each axis, or NaN if unknown"
        ))
    };
    let all: Vec<f64> = field.each(dimension, |word| word.parse().map_err(|_| wrong()))?;
    let numbers = kept.map(|axis| Some(all[axis]).filter(|number| !number.is_nan()));
    if numbers.into_iter().flatten().all(accepts) {
        return Ok(numbers);
    }
    Err(wrong())
}

/// The spacing along an axis of space, and the position of the first of its `samples` where it is stated: by what the
/// header says of both, and of the ends of the axis.
fn resolved(
    samples: usize,
    centring: Centring,
    [spacing, min, max]: [Option<f64>; 3],
) -> (f64, Option<f64>) {
    let (beyond, intervals) = match centring {
        Centring::Nodes if samples > 1 => (0.0, samples - 1),
        // A single sample stands in the middle, whatever the centring.
        Centring::Nodes | Centring::Cells => (0.5, samples),
    };
    let intervals = intervals as f64;
    let between = min.zip(max).map(|(min, max)| (max - min) / intervals);
    let spacing = between.or(spacing).unwrap_or(1.0);
    let by_min = min.map(|min| min + beyond * spacing);
    let by_max = max.map(|max| max - (intervals - beyond) * spacing);
    (spacing, by_min.or(by_max))
}

/// Role of an axis.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Space,
    /// Keeps the place of one, with a single sample.
    Placeholder,
    /// Time, colour, a vector and the like.
    Other,
}

/// The three axes of space that are left when those of a single sample that are too many are
/// dropped: first placeholders, then the slowest.
fn kept_axes(sizes: &[u64], roles: &[Role]) -> Result<[usize; 3], VolumeFault> {
    let axes = (0..sizes.len()).filter(|&axis| roles[axis] != Role::Other);
    let mut kept: Vec<usize> = axes.collect();
    while kept.len() > 3 {
        let placeholder = kept
            .iter()
            .rposition(|&axis| roles[axis] == Role::Placeholder);
        let single = || kept.iter().rposition(|&axis| sizes[axis] == 1);
        let Some(index) = placeholder.or_else(single) else {
            break;
        };
        kept.remove(index);
    }
    kept.try_into().map_err(|kept: Vec<usize>| {
        let samples: Vec<String> = sizes.iter().map(u64::to_string).collect();
        format!(
            "the file has {} axes, of {} samples, of which {} may be axes of space: {ONE_VOLUME}",
            sizes.len(),
            samples.join(" × "),
            kept.len()
        )
        .into()
    })
}

/// The remedy for axes that are too many or too few.
const ONE_VOLUME: &str = "a volume has three axes, and one value per sample; write one index of any other axis to a file of \
    its own, as by `unu slice -a 3 -p 0 -i all.nrrd -o one.nrrd`, and a plane with a third axis of a single sample";

impl HeaderField {
    /// The error of an axis that is not of space, and has several samples.
    fn no_space(&self, axis: usize) -> VolumeFault {
        let ordinal = axis + 1;
        self.fault(&format!(
            "axis {ordinal} is not an axis of space: {ONE_VOLUME}"
        ))
    }
}
