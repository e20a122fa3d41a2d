//! Nesting of media, and the placement of their boundaries.
//!
//! In volref media overlap and add up. Mitsuba and pbrt know one medium at a point, named inside
//! from outside by the boundary that a ray crosses. So media must be apart or one wholly within
//! another, and a boundary may not lie in a surface: a ray that starts on the surface would start
//! beyond the boundary, or not, by rounding.

use super::forms::{self, Base, Form, Placing, normal_of};
use super::mixture::Mixture;
use super::refusal::Faults;
use super::view::is_parallel;
use crate::geometry::{Aabb, Boundary, Ray, Solid, Surface, Transform};
use crate::optics::{Field, Homogeneous, Material};
use crate::scene::{AreaLight, Body, Radiative};
use crate::volume::GridDensity;
use glam::DVec3;

/// Coordinates nearer to each other than this, times the largest coordinate, are one.
const SAME: f64 = 1e-6;

/// A medium and where it ends.
pub(super) struct NestedMedium<'s> {
    /// Index of the medium in the scene.
    pub index: usize,
    /// Its boundary.
    pub form: Form,
    /// Whether faces of the boundary were moved behind the surfaces that they lay in.
    pub moved: bool,
    /// The surface that has the same shape, by its place in the list: the boundary is that surface.
    pub interface: Option<usize>,
    /// The medium at density 1.
    pub medium: Homogeneous,
    /// Its density, if that varies.
    pub grid: Option<PlacedGrid<'s>>,
    /// The nested medium directly around it, by its place in the list.
    pub parent: Option<usize>,
}

/// A grid of densities somewhere.
pub(super) struct PlacedGrid<'s> {
    /// Densities.
    pub density: &'s GridDensity,
    /// From the coordinates of the grid to the world.
    pub to_world: Transform,
}

/// A surface with its name in the scene.
pub(super) struct ExportSurface<'s> {
    pub key: String,
    pub form: Form,
    pub kind: SurfaceKind<'s>,
}

/// What a surface does to light.
pub(super) enum SurfaceKind<'s> {
    Material(Material),
    Light(&'s AreaLight),
}

impl ExportSurface<'_> {
    /// Whether nobody can look behind it.
    pub(super) fn is_opaque(&self) -> bool {
        let is_clear = matches!(self.kind, SurfaceKind::Material(Material::Glass(_)));
        !is_clear && !matches!(self.form, Form::Mesh { .. })
    }
}

/// All media of a scene.
pub(super) struct NestedMedia<'s> {
    /// Media that attenuate or emit, in the scene's order.
    pub list: Vec<NestedMedium<'s>>,
    /// The innermost that the eye is in.
    pub eye: Option<usize>,
}

impl<'s> NestedMedia<'s> {
    /// The media of `scene`, whose surfaces are `surfaces`; `sight` are the rays through the corners
    /// and the middle of the image, `reach` is the largest coordinate of anything. Boundaries keep
    /// the distance `gap` from each other and from surfaces. What cannot be said goes to `faults`.
    pub(super) fn of(
        scene: &'s Radiative,
        surfaces: &[ExportSurface],
        sight: &[Ray],
        reach: f64,
        gap: f64,
        faults: &mut Faults,
    ) -> NestedMedia<'s> {
        let contacts = Contacts {
            surfaces,
            gap,
            same: SAME * reach,
        };
        let mut list = Vec::new();
        for (index, body) in scene.media.iter().enumerate() {
            match nested_medium(index, body, &contacts) {
                Ok(nested) => list.extend(nested),
                Err(what) => faults.add(key_of(index), what),
            }
        }
        nest(&mut list, contacts.gap, faults);
        let plane = Aabb::around(sight.iter().map(|ray| ray.origin));
        let mut around_eye = Vec::new();
        for (at, nested) in list.iter().enumerate() {
            let Some(boundary) = &scene.media[nested.index].boundary else {
                continue;
            };
            let starts_in = |ray: &&Ray| starts_in(&nested.form, boundary, ray, contacts.same);
            let inside = sight.iter().filter(starts_in).count();
            if inside == sight.len() {
                around_eye.push(at);
            } else if inside > 0
                || is_parallel(sight)
                    && plane.is_some_and(|plane| plane.touches(&boundary.bounds()))
            {
                let what = "the eye lies in its boundary, or rays of the image may begin on either side of it; move one \
                            of them";
                faults.add(key_of(nested.index), what);
            }
        }
        let depth = |at: usize| ancestors(&list, at).count();
        let eye = around_eye.into_iter().max_by_key(|&at| depth(at));
        NestedMedia { list, eye }
    }

    /// Mixture of the nested medium `at`: itself and all around it, from the inside out.
    pub(super) fn mixture(&self, at: usize) -> Mixture {
        let layers = std::iter::once(at).chain(ancestors(&self.list, at));
        Mixture::of(layers.map(|at| &self.list[at].medium))
    }

    /// The nested medium whose boundary is the surface of this place in the list.
    pub(super) fn with_interface(&self, surface: usize) -> Option<usize> {
        let mut list = self.list.iter();
        list.position(|nested| nested.interface == Some(surface))
    }

    /// A note on the faces of boundaries that were moved by `offset`, if any were.
    pub(super) fn note_on_moved_faces(&self, offset: f64) -> Option<String> {
        let moved = self.list.iter().filter(|nested| nested.moved);
        let moved: Vec<String> = moved.map(|nested| key_of(nested.index)).collect();
        (!moved.is_empty()).then(|| {
            format!(
                "Faces of {} that lie in surfaces stand {offset:.3e} behind them, where no ray sees it.",
                moved.join(", ")
            )
        })
    }
}

impl NestedMedium<'_> {
    /// Its name in an exported scene.
    pub(super) fn name(&self) -> String {
        format!("medium{}", self.index)
    }

    /// Whether it scatters light.
    pub(super) fn scatters(&self) -> bool {
        self.medium.coefficients.sigma_s() != DVec3::ZERO
    }
}

/// The name of a medium in messages.
pub(super) fn key_of(index: usize) -> String {
    format!("radiative.medium[{index}]")
}

fn ancestors<'v>(list: &'v [NestedMedium], at: usize) -> impl Iterator<Item = usize> + 'v {
    std::iter::successors(list[at].parent, |&at| list[at].parent)
}

/// The medium `body`, if it does anything to light; or what cannot be said of it.
fn nested_medium<'s>(
    index: usize,
    body: &'s Body,
    contacts: &Contacts,
) -> Result<Option<NestedMedium<'s>>, String> {
    let medium = body.medium;
    let mut grid = None;
    if let Some(density) = &body.density {
        match density.field() {
            Field::Grid(field) => grid = Some(field),
            Field::Noise(_) => return Err("fractal noise".to_owned()),
            Field::Exponential(_) => return Err("an exponential layer".to_owned()),
            Field::Linear(_) => return Err("a linear ramp of densities".to_owned()),
            Field::Blob(_) => return Err("a Gaussian ball".to_owned()),
        }
        if density.is_nothing() {
            return Ok(None);
        }
    }
    if medium.coefficients.sigma_t() == DVec3::ZERO && medium.emission == DVec3::ZERO {
        return Ok(None);
    }
    let Some(boundary) = &body.boundary else {
        let what = "a medium that fills all space; give it a box, sphere or mesh";
        return Err(what.to_owned());
    };
    let placing = forms::boundary(boundary);
    let (mut form, mut placed) = (Form::of(placing), None);
    if let Some(density) = grid {
        form = within_grid(placing, density)?;
        let to_world = placing.1.copied().unwrap_or(Transform::IDENTITY);
        placed = Some(PlacedGrid { density, to_world });
    }
    let mut surfaces = contacts.surfaces.iter();
    let interface = surfaces.position(|surface| surface.form == form);
    if let Some(at) = interface
        && let SurfaceKind::Light(_) = contacts.surfaces[at].kind
    {
        let key = &contacts.surfaces[at].key;
        return Err(format!("its boundary is the surface of a light, {key}"));
    }
    let mut moved = false;
    if interface.is_none() {
        let touched = contacts.touched(&form)?;
        moved = touched.contains(&true);
        behind(&mut form, &touched, contacts.gap);
    }
    Ok(Some(NestedMedium {
        index,
        form,
        moved,
        interface,
        medium,
        grid: placed,
        parent: None,
    }))
}

/// The part of a boundary that its grid fills: there the medium ends.
fn within_grid(placing: Placing<'_>, density: &GridDensity) -> Result<Form, String> {
    let own = density.bounds();
    let bounds = match placing.0 {
        Base::Box(bounds) => {
            let (min, max) = (bounds.min.max(own.min), bounds.max.min(own.max));
            if min.cmpge(max).any() {
                return Err("a grid that lies outside the box of its medium".to_owned());
            }
            return Ok(Form::of((Base::Box(&Aabb { min, max }), placing.1)));
        }
        Base::Sphere(sphere) => sphere.bounds(),
        Base::Rectangle(rectangle) => rectangle.bounds(),
        Base::Mesh(mesh) => mesh.bounds(),
    };
    // Only a box can be cut off at the end of its grid.
    if bounds.min.cmplt(own.min).any() || bounds.max.cmpgt(own.max).any() {
        return Err("a sphere or mesh of medium that reaches beyond its grid".to_owned());
    }
    Ok(Form::of(placing))
}

/// Moves the touched faces of a box outward by `offset`.
fn behind(form: &mut Form, touched: &[bool], offset: f64) {
    let Form::Box { corner, edges } = form else {
        return;
    };
    for axis in 0..3 {
        let step = edges[axis].normalize() * offset;
        if touched[2 * axis] {
            *corner -= step;
            edges[axis] += step;
        }
        if touched[2 * axis + 1] {
            edges[axis] += step;
        }
    }
}

/// Contacts of boundaries and surfaces.
struct Contacts<'w> {
    surfaces: &'w [ExportSurface<'w>],
    gap: f64,
    same: f64,
}

impl Contacts<'_> {
    /// For each face of a boundary, whether it lies wholly in an opaque surface, behind which it
    /// can be moved. An error for contacts of any other kind.
    fn touched(&self, form: &Form) -> Result<Vec<bool>, String> {
        let is_box = matches!(form, Form::Box { .. });
        let mut touched = Vec::new();
        for face in form.faces() {
            let mut partly = None;
            let mut covered = false;
            for surface in self.surfaces {
                // A mesh of medium beside a mesh of surface: too many pairs, and no plane of
                // their own that they would share on purpose.
                if !is_box && matches!(surface.form, Form::Mesh { .. }) {
                    continue;
                }
                for piece in surface.form.faces() {
                    match self.meet(&face, &piece) {
                        Meeting::No => {}
                        Meeting::Covered if is_box && surface.is_opaque() => covered = true,
                        Meeting::Covered | Meeting::Partly => partly = Some(surface),
                    }
                }
            }
            if let (Some(surface), false) = (partly, covered) {
                return Err(format!(
                    "a face that lies in {}, or so near that rays from there start beyond it; \
                     move it into the surface or away from it",
                    surface.key
                ));
            }
            touched.push(covered);
        }
        Ok(touched)
    }

    /// The meeting of a boundary's face with a flat piece of surface.
    fn meet(&self, face: &[DVec3], piece: &[DVec3]) -> Meeting {
        let normal = normal_of(face);
        let heights = piece.iter().map(|point| (point - face[0]).dot(normal));
        let [low, high] = extremes(heights);
        // Not parallel, inside the medium, or far enough outside.
        if high - low > self.same || low < -self.same || high > self.gap {
            return Meeting::No;
        }
        if !may_overlap(face, piece, self.same) {
            return Meeting::No;
        }
        let in_plane = high <= self.same;
        let covered = face.iter().all(|&point| within(piece, point, self.same));
        if in_plane && covered {
            Meeting::Covered
        } else {
            Meeting::Partly
        }
    }
}

enum Meeting {
    No,
    Partly,
    Covered,
}

/// Whether a polygon in the plane of `face` overlaps it by more than `tolerance`, as far as two edges of the face tell.
fn may_overlap(face: &[DVec3], other: &[DVec3], tolerance: f64) -> bool {
    [face[1], face[face.len() - 1]].iter().all(|corner| {
        let axis = (corner - face[0]).normalize();
        let ([low, high], [other_low, other_high]) = (extent(face, axis), extent(other, axis));
        low + tolerance < other_high && other_low + tolerance < high
    })
}

/// Whether a point of the plane of a convex polygon lies in it.
fn within(polygon: &[DVec3], point: DVec3, tolerance: f64) -> bool {
    let normal = normal_of(polygon);
    (0..polygon.len()).all(|at| {
        let (from, to) = (polygon[at], polygon[(at + 1) % polygon.len()]);
        let inward = normal.cross(to - from).normalize();
        (point - from).dot(inward) >= -tolerance
    })
}

/// Smallest and largest coordinate along an axis.
fn extent(points: &[DVec3], axis: DVec3) -> [f64; 2] {
    extremes(points.iter().map(|point| point.dot(axis)))
}

fn extremes(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], number| {
        [low.min(number), high.max(number)]
    })
}

/// Finds the nested medium directly around each; a fault where two neither are apart nor nested.
fn nest(list: &mut [NestedMedium], gap: f64, faults: &mut Faults) {
    let mut around = vec![Vec::new(); list.len()];
    for first in 0..list.len() {
        for second in first + 1..list.len() {
            let (a, b) = (&list[first].form, &list[second].form);
            if lies_in(a, b, gap) {
                around[first].push(second);
            } else if lies_in(b, a, gap) {
                around[second].push(first);
            } else if !apart(a, b, gap) {
                let (one, other) = (list[first].index, list[second].index);
                let what = format!(
                    "it and {} overlap or touch, or boxes around them do, and neither lies within \
                     the other; only one medium can be at a place",
                    key_of(one)
                );
                faults.add(key_of(other), what);
            }
        }
    }
    let depth: Vec<usize> = around.iter().map(Vec::len).collect();
    for (at, around) in around.iter().enumerate() {
        list[at].parent = around.iter().copied().max_by_key(|&other| depth[other]);
        let mut layers = around.iter().chain([&at]);
        if list[at].parent.is_some() && layers.any(|&layer| list[layer].grid.is_some()) {
            let what = "a grid in another medium, or a medium in a grid: densities add up only \
                        where both are the same everywhere";
            faults.add(key_of(list[at].index), what);
        }
    }
}

/// Whether one form lies within another, `gap` away from its boundary. Only boxes and balls are
/// asked: they are convex.
fn lies_in(inner: &Form, outer: &Form, gap: f64) -> bool {
    match outer {
        Form::Box { corner, edges } => edges.iter().all(|edge| {
            let axis = edge.normalize();
            let low = corner.dot(axis);
            let [from, to] = extent_of(inner, axis);
            from > low + gap && to < low + edge.length() - gap
        }),
        Form::Sphere { centre, radius } => {
            let farthest = match inner {
                Form::Sphere {
                    centre: other,
                    radius: less,
                } => centre.distance(*other) + less,
                _ => (inner.corners().iter())
                    .map(|corner| corner.distance(*centre))
                    .fold(0.0, f64::max),
            };
            farthest < radius - gap
        }
        _ => false,
    }
}

/// Whether a plane parts two forms, or the boxes around them, by more than `gap`: one along a face of either.
fn apart(a: &Form, b: &Form, gap: f64) -> bool {
    let axes = [a, b].into_iter().flat_map(|form| match form {
        Form::Box { edges, .. } => edges.map(DVec3::normalize),
        _ => DVec3::AXES,
    });
    axes.into_iter().any(|axis| {
        let ([low, high], [other_low, other_high]) = (extent_of(a, axis), extent_of(b, axis));
        other_low > high + gap || low > other_high + gap
    })
}

/// Smallest and largest coordinate of a form along an axis of length 1.
fn extent_of(form: &Form, axis: DVec3) -> [f64; 2] {
    match form {
        Form::Sphere { centre, radius } => {
            let middle = centre.dot(axis);
            [middle - radius, middle + radius]
        }
        _ => extent(&form.corners(), axis),
    }
}

/// Whether a ray starts in a nested medium, or within `same` before it: from a face, by the side to
/// which it leaves. A box may have been cut off or moved: its form is asked.
fn starts_in(form: &Form, boundary: &Boundary, ray: &Ray, same: f64) -> bool {
    if let Form::Box { corner, edges } = form {
        let within = ray.at(same) - corner;
        let is_between = |edge: &DVec3| {
            let along = within.dot(*edge);
            along > 0.0 && along < edge.length_squared()
        };
        return edges.iter().all(is_between);
    }
    let span = boundary.spans(ray).first().copied();
    span.is_some_and(|span| span.near <= same && span.far > same)
}
