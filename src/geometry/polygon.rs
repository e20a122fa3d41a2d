//! Polygons as triangles.

use super::mesh::perpendicular;
use crate::files::decoder;
use crate::math::power_of_two_below;
use glam::{DVec2, DVec3};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation, mitigate_underflow};
use std::collections::HashMap;

/// The triangles of a polygon, as indices of its corners, in its own sense of rotation; none of two
/// corners or fewer.
///
/// It is triangulated as it is seen along the axis nearest to its normal: by the fan from its first
/// corner where that covers it, as of every convex polygon, else by the constrained Delaunay
/// triangulation, which keeps corners within edges and has no flat triangle where it need not.
///
/// # Errors
///
/// If it crosses itself or has no area: the message.
pub(super) fn triangles(corners: &[DVec3]) -> Result<Vec<[usize; 3]>, String> {
    let fan = || (1..corners.len().max(2) - 1).map(|at| [0, at, at + 1]);
    if corners.len() <= 3 {
        return Ok(fan().collect());
    }
    let flat = seen_along_normal(corners)?;
    let is_flat = |[a, b, c]: [usize; 3]| {
        perpendicular(corners[b] - corners[a], corners[c] - corners[a]).is_none()
    };
    if covers(&flat) && !fan().any(is_flat) {
        return Ok(fan().collect());
    }
    let triangulated = decoder::run(|| delaunay(corners, &flat));
    triangulated.map_err(|stopped| format!("this polygon cannot be triangulated: {stopped}"))?
}

/// The corners without the coordinate of the axis nearest to the normal, anticlockwise, scaled by a
/// power of two to at most 1: no digit is lost.
fn seen_along_normal(corners: &[DVec3]) -> Result<Vec<DVec2>, String> {
    let reach = |points: &mut dyn Iterator<Item = DVec3>| {
        points.fold(0.0, |most: f64, it| most.max(it.abs().max_element()))
    };
    let scale = |points: &mut dyn Iterator<Item = DVec3>| {
        0.5 / power_of_two_below(reach(points).max(f64::MIN_POSITIVE))
    };
    let whole = scale(&mut corners.iter().copied());
    let scaled: Vec<DVec3> = corners.iter().map(|&it| it * whole).collect();
    let from_first = || scaled.iter().map(|&it| it - scaled[0]);
    let size = scale(&mut from_first());
    let sides = from_first().zip(from_first().skip(1));
    // Newell's: twice the area seen along each axis.
    let normal: DVec3 = sides.map(|(a, b)| (a * size).cross(b * size)).sum();
    let axis = normal.abs().max_position();
    let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
    let (x, y) = match normal[axis] {
        area if area > 0.0 => (x, y),
        area if area < 0.0 => (y, x),
        _ => return Err(NO_AREA.to_owned()),
    };
    Ok(scaled.iter().map(|it| DVec2::new(it[x], it[y])).collect())
}

const NO_AREA: &str = "this polygon has no area, or crosses itself: remove it, or split it";

/// True if the fan from the first corner goes around it in one sense, and less than once.
fn covers(flat: &[DVec2]) -> bool {
    let arms: Vec<DVec2> = flat[1..].iter().map(|&it| it - flat[0]).collect();
    let mut past_half = false;
    arms.windows(2).all(|two| {
        let from_first = arms[0].perp_dot(two[1]);
        let once_around = past_half && from_first >= 0.0;
        past_half |= from_first < 0.0;
        two[0].perp_dot(two[1]) > 0.0 && !once_around
    })
}

fn delaunay(corners: &[DVec3], flat: &[DVec2]) -> Result<Vec<[usize; 3]>, String> {
    // A corner that is there twice, as where a slit joins a hole to the outline, is one point.
    let mut corner_of = Vec::new();
    let mut points = Vec::new();
    let mut number_of = HashMap::new();
    let mut outline = Vec::new();
    for (corner, at) in flat.iter().enumerate() {
        let point = mitigate_underflow(Point2::new(at.x + 0.0, at.y + 0.0));
        let number = *number_of
            .entry([point.x, point.y].map(f64::to_bits))
            .or_insert(points.len());
        if number == points.len() {
            points.push(point);
            corner_of.push(corner);
        } else if corners[corner_of[number]] != corners[corner] {
            return Err(
                "this polygon is bent so far that two of its corners lie behind each other: split \
                 it"
                .to_owned(),
            );
        }
        outline.push(number);
    }
    let loaded = ConstrainedDelaunayTriangulation::<Point2<f64>>::bulk_load_cdt(points, Vec::new());
    let mut plane = loaded.map_err(|error| error.to_string())?;
    let handles: Vec<FixedVertexHandle> = plane.fixed_vertices().collect();
    // Times that the outline goes along an edge, less those that it goes back.
    let mut along = HashMap::new();
    for (at, &from) in outline.iter().enumerate() {
        let to = outline[(at + 1) % outline.len()];
        let pieces = plane.try_add_constraint(handles[from], handles[to]);
        if from != to && pieces.is_empty() {
            return Err(format!(
                "this polygon crosses itself, at its edge from {} to {}: split it into polygons \
                 that do not",
                corners[corner_of[from]], corners[corner_of[to]]
            ));
        }
        for piece in pieces {
            let [from, to] = plane.directed_edge(piece).vertices();
            let [from, to] = [from.index(), to.index()];
            *along.entry([from, to]).or_insert(0) += 1;
            *along.entry([to, from]).or_insert(0) -= 1;
        }
    }
    // Times that the outline goes around each face: 1 within, 0 outside.
    let mut around = vec![None; plane.num_all_faces()];
    around[plane.outer_face().index()] = Some(0);
    let outside = plane.directed_edges().filter(|edge| edge.face().is_outer());
    let mut edges: Vec<_> = outside.collect();
    while let Some(edge) = edges.pop() {
        let across = edge.rev();
        let ends = across.vertices().map(|end| end.index());
        let Some(here) = around[edge.face().index()] else {
            continue;
        };
        if let Some(face) = across.face().as_inner()
            && around[face.index()].is_none()
        {
            around[face.index()] = Some(here + along.get(&ends).unwrap_or(&0));
            edges.extend(face.adjacent_edges());
        }
    }
    let mut triangles = Vec::new();
    for face in plane.inner_faces() {
        match around[face.index()] {
            Some(0) => {}
            Some(1) => triangles.push(face.vertices().map(|vertex| corner_of[vertex.index()])),
            _ => {
                return Err(
                    "this polygon covers a place twice, or from both sides: split it".to_owned(),
                );
            }
        }
    }
    if triangles.is_empty() {
        return Err(NO_AREA.to_owned());
    }
    Ok(triangles)
}
