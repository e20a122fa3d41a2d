//! Geometry of a file of NRRD: its axes of space, and the positions of the samples along them.

use crate::volume::Centring;
use crate::volume::error::{VolumeFault, refused};
use crate::volume::header_field::{HeaderField, HeaderFields, shortened};
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

/// Refuses lengths of axes that are not comparable.
fn check_units(fields: &HeaderFields, all: usize, kept: [usize; 3]) -> Result<(), VolumeFault> {
    for field in ["units", "space units"]
        .iter()
        .filter_map(|name| fields.get(name))
    {
        let mut units = field.units();
        if field.name == "units" && units.len() == all {
            units = kept.map(|axis| units[axis]).to_vec();
        }
        units.retain(|unit| !["", "???", "none"].contains(unit));
        if units.windows(2).any(|pair| pair[0] != pair[1]) {
            return Err(field.fault(&format!(
                "`{}` differ between the axes of space, {}: write all positions in one unit, and the field \
                 accordingly",
                field.name,
                shortened(field.value)
            )));
        }
    }
    Ok(())
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
        _ => {
            let kind = shortened(kind);
            Err(field.no_space(axis, sizes[axis], &format!("of the kind {kind:?}")))
        }
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
            return Err(field.no_space(axis, sizes[axis], "without a direction"));
        }
    }
    Ok(Some(directions))
}

/// Positions of the samples.
pub(super) fn axes(fields: &HeaderFields, sizes: &[u64]) -> Result<Axes, VolumeFault> {
    let dimension = sizes.len();
    let mut roles = roles(fields, sizes)?;
    let directions = directions(fields, sizes)?;
    if let Some(directions) = &directions {
        for (role, direction) in roles.iter_mut().zip(directions) {
            if direction.is_none() {
                *role = Role::Other;
            }
        }
    }
    let kept = kept_axes(sizes, &roles)?;
    check_units(fields, dimension, kept)?;
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
    let known = |numbers: [Option<f64>; 3]| numbers.iter().any(Option::is_some);
    let origin = match fields.get("space origin") {
        Some(field) => field.vector_in(field.value)?,
        None => None,
    };
    axes.first = origin.unwrap_or_default();
    if let Some(directions) = directions {
        for (name, given) in [
            ("spacings", spacings),
            ("axis mins", mins),
            ("axis maxs", maxs),
        ] {
            if known(given) {
                return Err(both("space directions", name));
            }
        }
        axes.steps = kept.map(|axis| directions[axis].expect("the axes of space have one"));
        return Ok(axes);
    }
    if origin.is_some() && (known(mins) || known(maxs)) {
        return Err(both("space origin", "axis mins or axis maxs"));
    }
    for axis in 0..3 {
        let stated = [spacings[axis], mins[axis], maxs[axis]];
        let (spacing, first) = resolved(kept[axis] + 1, axes.sizes[axis], axes.centring, stated)?;
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
        let message = "some axes are centred on nodes, others on cells: a grid has one \
                       centring";
        return refused(message);
    }
    Ok(first)
}

/// Numbers of the axes that are kept; `None` where they are unknown.
fn numbers(
    field: HeaderField,
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
/// header says of both, and of the ends of the axis of this `ordinal`, from 1.
fn resolved(
    ordinal: usize,
    samples: usize,
    centring: Centring,
    [spacing, min, max]: [Option<f64>; 3],
) -> Result<(f64, Option<f64>), VolumeFault> {
    let (beyond, intervals) = match centring {
        Centring::Nodes if samples > 1 => (0.0, samples - 1),
        // A single sample stands in the middle, whatever the centring.
        Centring::Nodes | Centring::Cells => (0.5, samples),
    };
    let intervals = intervals as f64;
    if let Some(min) = min.filter(|_| min == max) {
        return refused(format!(
            "along axis {ordinal} `axis mins` and `axis maxs` are both {min}, and must differ"
        ));
    }
    let between = min.zip(max).map(|(min, max)| (max - min) / intervals);
    // Headers are written with six digits, some with fewer.
    if let (Some(given), Some(length)) = (spacing, between)
        && (length - given).abs() > 1e-3 * length.abs()
    {
        return refused(format!(
            "along axis {ordinal} the header gives a spacing of {given}, and minimum and \
             maximum that make it {length}: keep one"
        ));
    }
    let spacing = between.or(spacing).unwrap_or(1.0);
    let by_min = min.map(|min| min + beyond * spacing);
    let by_max = max.map(|max| max - (intervals - beyond) * spacing);
    Ok((spacing, by_min.or(by_max)))
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
    let of_space = kept.len();
    kept.try_into().map_err(|kept: Vec<usize>| {
        let samples: Vec<String> = sizes.iter().map(u64::to_string).collect();
        let (count, samples) = (sizes.len(), samples.join(" × "));
        if of_space < 3 {
            return format!(
                "the file has {count} axes, of {samples} samples, and {of_space} of them are axes of \
                 space: a volume has three; write a plane with a third of a single sample, \
                 as `dimension: 3` and `sizes: 64 64 1`"
            )
            .into();
        }
        // Colours and times are mostly few, colours the fastest and times the slowest.
        let fewest = kept.into_iter().rev().min_by_key(|&axis| sizes[axis]);
        format!(
            "the file has {count} axes, of {samples} samples: a volume has three axes and one value \
             per sample; {}",
            write_slice("one index of the other axis", fewest.unwrap_or_default())
        )
        .into()
    })
}

/// The remedy for an axis that is too many.
fn write_slice(what: &str, axis: usize) -> String {
    format!(
        "write {what} to a file of its own, as by `unu slice -a {axis} -p 0 -i all.nrrd -o \
         one.nrrd`, or in Python from `numpy.take(data, 0, axis={axis})` of the array that pynrrd \
         reads"
    )
}

impl HeaderField<'_> {
    /// The error of an axis that is not of space, and has several samples.
    fn no_space(&self, axis: usize, samples: u64, what: &str) -> VolumeFault {
        let ordinal = axis + 1;
        self.fault(&format!(
            "axis {ordinal}, of {samples} samples, is {what}, and not an axis of space: a volume has \
             three, and one value per sample; {}",
            write_slice(&format!("one of the {samples}"), axis)
        ))
    }
}

/// The error of positions that are given twice.
fn both(one: &str, other: &str) -> VolumeFault {
    format!("the header gives `{one}` and `{other}`, which exclude each other: keep one").into()
}
