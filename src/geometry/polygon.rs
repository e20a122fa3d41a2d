//! Polygons as fans of triangles.

use super::mesh::perpendicular;
use glam::{DVec2, DVec3};

/// Corners of all fans tried for one polygon: those of a polygon of a million corners take as long as reading it.
const MOST_TRIED: usize = 1 << 22;

/// The first corner of a polygon whose fan covers it, without flat triangles, as seen along the axis nearest to
/// its normal. The first corner of a convex polygon does.
///
/// # Errors
///
/// If it has no area, crosses itself, or no fan covers it: the message.
pub(super) fn first_of_fan(corners: &[DVec3]) -> Result<usize, &'static str> {
    let count = corners.len();
    if count <= 3 {
        return Ok(0);
    }
    let flat = seen_along_normal(corners)?;
    let is_flat = |[a, b, c]: [usize; 3]| {
        perpendicular(corners[b] - corners[a], corners[c] - corners[a]).is_none()
    };
    let is_covered_from = |first: &usize| {
        let mut turned = (1..count - 1).map(|at| [0, at, at + 1].map(|it| (first + it) % count));
        covers(&flat, *first) && !turned.any(is_flat)
    };
    let mut tried = 0..count.min(MOST_TRIED / count + 1);
    tried.find(is_covered_from).ok_or(NOT_A_FAN)
}

const NOT_A_FAN: &str = "no fan of triangles from one corner covers this polygon, or it has no area or crosses itself: triangulate faces when you \
     export the mesh (in Blender: \"Triangulated Mesh\"), or split it";

/// The corners without the coordinate of the axis nearest to the normal, anticlockwise.
fn seen_along_normal(corners: &[DVec3]) -> Result<Vec<DVec2>, &'static str> {
    let from_first = || corners.iter().map(|&it| it - corners[0]);
    let sides = from_first().zip(from_first().skip(1));
    // Newell's: twice the area seen along each axis.
    let normal: DVec3 = sides.map(|(a, b)| a.cross(b)).sum();
    let axis = normal.abs().max_position();
    let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
    let (x, y) = match normal[axis] {
        area if area > 0.0 => (x, y),
        area if area < 0.0 => (y, x),
        _ => return Err(NOT_A_FAN),
    };
    Ok(corners.iter().map(|it| DVec2::new(it[x], it[y])).collect())
}

/// True if the fan from the corner `first` goes around it in one sense, and less than once.
fn covers(flat: &[DVec2], first: usize) -> bool {
    let count = flat.len();
    let arm = |at: usize| flat[(first + at) % count] - flat[first];
    let mut past_half = false;
    (1..count - 1).all(|at| {
        let from_first = arm(1).perp_dot(arm(at + 1));
        let once_around = past_half && from_first >= 0.0;
        past_half |= from_first < 0.0;
        arm(at).perp_dot(arm(at + 1)) > 0.0 && !once_around
    })
}
