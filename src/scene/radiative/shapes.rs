//! Shapes in scenes.

use super::shape_transform::{self, ShapeTransform};
use crate::geometry::{
    Aabb, Boundary, Luminous, Mesh, Placed, Rectangle, Shape, Sphere, Surface, Transform, length_of,
};
use crate::scene::SceneResult;
use crate::scene::files::Files;
use crate::scene::format::{Key, Kind, Range, Rule, Table};
use crate::scene::reader::Reader;
use crate::scene::record::Record;
use glam::DVec3;
use std::fmt::Display;
use std::sync::Arc;

record! {
    struct SphereTable in "A sphere." {
        centre: DVec3 = required Vector, "Its centre, world units.";
        radius: f64 = required Number(Range::POSITIVE), "Its radius, world units.";
    }
}

record! {
    struct BoxTable in "A box along the axes." {
        min: DVec3 = required Vector, "The corner with the smallest coordinates, world units.";
        max: DVec3 = required Vector, "The corner with the largest coordinates, world units.";
    }
}

record! {
    struct RectangleTable in "A rectangle, or a parallelogram; its front is where edge_u × edge_v points." {
        corner: DVec3 = required Vector, "The corner where both edges start, world units.";
        edge_u: DVec3 = required Vector, "From the corner to the next one, world units.";
        edge_v: DVec3 = required Vector, "From the corner to the other neighbour, world units.";
    }
}

const MESH: Table = Table::new("A triangle mesh.").keys(&[
    Key::required("file", Kind::Text)
        .doc("Wavefront OBJ file, relative to the folder of the scene; the corners of a face run anticlockwise seen from its front."),
]);

/// Keys of closed shapes.
pub(super) const CLOSED: [Key; 3] = [
    Key::optional("sphere", Kind::Table(&SphereTable::TABLE)).doc("Shape: a sphere."),
    Key::optional("box", Kind::Table(&BoxTable::TABLE)).doc("Shape: a box along the axes."),
    Key::optional("mesh", Kind::Table(&MESH)).doc("Shape: a triangle mesh."),
];

/// A box.
pub(in crate::scene) const BOX: Key = CLOSED[1];

/// Keys of a surface: one shape, moved.
pub(in crate::scene) const SURFACE_KEYS: [&[Key]; 3] = [
    &[
        Key::optional("rectangle", Kind::Table(&RectangleTable::TABLE))
            .doc("Shape: a rectangle or parallelogram."),
    ],
    &CLOSED,
    &shape_transform::STEPS,
];

/// The rule of those keys.
pub(in crate::scene) const ONE_SHAPE: Rule =
    Rule::ExactlyOne("shape", &["rectangle", "sphere", "box", "mesh"]);

/// The one shape of a table, where its own keys put it, and its key. A mesh that is `solid` must be closed.
fn base_shape(
    reader: &Reader,
    files: &mut Files,
    solid: bool,
) -> SceneResult<(&'static str, Shape)> {
    if let Some(sphere) = reader.table_as("sphere", read_sphere)? {
        return Ok(("sphere", Shape::Sphere(sphere)));
    }
    if let Some(cuboid) = reader.table_as("box", read_box)? {
        return Ok(("box", Shape::Box(cuboid)));
    }
    if let Some(rectangle) = reader.table_as("rectangle", read_rectangle)? {
        return Ok(("rectangle", Shape::Rectangle(rectangle)));
    }
    let mesh = reader.table("mesh")?.expect("one of the shapes");
    if solid {
        files.closed_mesh(&mesh)?;
    }
    Ok(("mesh", Shape::Mesh(files.mesh(&mesh)?)))
}

fn read_sphere(reader: &Reader) -> SceneResult<Sphere> {
    let SphereTable { centre, radius } = Record::read(reader)?;
    reader.accepted(Sphere::new(centre, radius))
}

pub(in crate::scene) fn read_box(reader: &Reader) -> SceneResult<Aabb> {
    let BoxTable { min, max } = Record::read(reader)?;
    reader.accepted(Aabb::new(min, max))
}

fn read_rectangle(reader: &Reader) -> SceneResult<Rectangle> {
    let table = RectangleTable::read(reader)?;
    reader.accepted(Rectangle::new(table.corner, table.edge_u, table.edge_v))
}

/// The shape of a surface that reflects or refracts. A `solid` one must have an inside, if it is
/// a box or a mesh.
pub(in crate::scene) fn shape(
    reader: &Reader,
    files: &mut Files,
    solid: bool,
) -> SceneResult<Shape> {
    let (key, form) = base_shape(reader, files, solid)?;
    let transform = ShapeTransform::read(reader)?;
    if let (Shape::Box(cuboid), true) = (&form, solid) {
        check_inside(reader, cuboid, "glass")?;
    }
    let shape = match (form, transform.to_world) {
        (form, None) => form,
        (Shape::Rectangle(rectangle), Some(map)) => {
            Shape::Rectangle(moved(reader, key, rectangle.transformed(&map))?)
        }
        (Shape::Sphere(sphere), Some(map)) => Shape::PlacedSphere(Placed::new(sphere, map)),
        (Shape::Box(cuboid), Some(map)) => Shape::PlacedBox(Placed::new(cuboid, map)),
        (Shape::Mesh(mesh), Some(map)) => Shape::PlacedMesh(Placed::new(mesh, map)),
        _ => unreachable!("not placed yet"),
    };
    check_size(reader, key, &shape.bounds())?;
    Ok(shape)
}

/// The shape of a surface that emits.
pub(super) fn luminous(reader: &Reader, files: &mut Files) -> SceneResult<Luminous> {
    let (key, form) = base_shape(reader, files, false)?;
    let transform = ShapeTransform::read(reader)?;
    let shape = match (form, &transform.to_world) {
        (Shape::Sphere(sphere), None) => Luminous::Sphere(sphere),
        (Shape::Sphere(sphere), Some(to_world)) => {
            let factor = transform.uniform_scale().ok_or_else(|| {
                let message = "an emitting sphere cannot be stretched to an ellipsoid";
                let help =
                    "scale by the same factor along x, y and z, or give a mesh of the ellipsoid";
                reader.mistake("scale", message, help)
            })?;
            let centre = to_world.point(sphere.centre());
            let sphere = Sphere::new(centre, sphere.radius() * factor);
            Luminous::Sphere(reader.accepted_at("sphere", sphere)?)
        }
        (Shape::Rectangle(rectangle), None) => Luminous::Rectangle(rectangle),
        (Shape::Rectangle(rectangle), Some(to_world)) => {
            Luminous::Rectangle(moved(reader, key, rectangle.transformed(to_world))?)
        }
        (Shape::Box(cuboid), transform) => {
            check_inside(reader, &cuboid, "a light in the shape of a box")?;
            let mesh = Mesh::cuboid(&cuboid).and_then(|mesh| match transform {
                Some(to_world) => mesh.transformed(to_world),
                None => Ok(mesh),
            });
            Luminous::Mesh(Arc::new(moved(reader, key, mesh)?))
        }
        (Shape::Mesh(mesh), None) => Luminous::Mesh(mesh),
        (Shape::Mesh(mesh), Some(to_world)) => {
            let mesh = mesh.transformed(to_world);
            Luminous::Mesh(Arc::new(moved(reader, key, mesh)?))
        }
        _ => unreachable!("not placed yet"),
    };
    check_size(reader, key, &shape.bounds())?;
    Ok(shape)
}

/// The space that a medium fills.
pub(super) struct MediumSpace {
    /// Its boundary.
    pub boundary: Boundary,
    /// The box around it where its own keys put it.
    pub bounds: Aabb,
    /// Where it goes from there.
    pub to_world: Option<Transform>,
}

/// The space that a medium fills: its shape, or, if the table has none, the box `own`; all space
/// without either.
pub(super) fn space(
    reader: &Reader,
    files: &mut Files,
    own: Option<Aabb>,
) -> SceneResult<Option<MediumSpace>> {
    let own_place = if let Some(sphere) = reader.table_as("sphere", read_sphere)? {
        Boundary::Sphere(sphere)
    } else if let Some(cuboid) = reader.table_as("box", read_box)? {
        check_inside(reader, &cuboid, "a medium")?;
        Boundary::Box(cuboid)
    } else if let Some(mesh) = reader.table("mesh")? {
        Boundary::Mesh(files.closed_mesh(&mesh)?)
    } else if let Some(own) = own {
        Boundary::Box(own)
    } else {
        if let Some(key) = reader.first_of(&shape_transform::KEYS) {
            let message =
                format!("a medium without a shape fills all space: `{key}` has no effect");
            let help = format!("give the medium a `sphere`, `box` or `mesh`, or remove `{key}`");
            return Err(reader.mistake(key, message, help));
        }
        return Ok(None);
    };
    let bounds = own_place.bounds();
    let to_world = ShapeTransform::read(reader)?.to_world;
    let key = reader.first_of(&["sphere", "box", "mesh", "grid"]);
    let key = key.expect("its shape, or its grid");
    let boundary = match &to_world {
        None => own_place,
        Some(to_world) => own_place.moved(to_world),
    };
    check_size(reader, key, &bounds)?;
    check_size(reader, key, &boundary.bounds())?;
    Ok(Some(MediumSpace {
        boundary,
        bounds,
        to_world,
    }))
}

/// Lengths in a scene: from the diameter of the smallest shape to the distance from the origin to
/// the farthest place. The cubes of such lengths are numbers still; probabilities of choosing a
/// place on a ray, or a surface from another, are made of them.
const SMALLEST: f64 = 1e-100;
pub(super) const FARTHEST: f64 = 1e100;

fn check_size(reader: &Reader, key: &str, bounds: &Aabb) -> SceneResult<()> {
    let across = length_of(bounds.size());
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    if across >= SMALLEST && farthest <= FARTHEST {
        return Ok(());
    }
    let message = format!(
        "the {key} is {across:.3e} across and reaches to coordinates of {farthest:.3e}: light is \
        traced between shapes at least {SMALLEST:e} across, in coordinates up to {FARTHEST:e}"
    );
    Err(reader.mistake(key, message, "choose another unit of length"))
}

/// Refuses a box without an inside, which `what` needs.
fn check_inside(reader: &Reader, cuboid: &Aabb, what: &str) -> SceneResult<()> {
    if cuboid.size().cmpne(DVec3::ZERO).all() {
        return Ok(());
    }
    let message = format!("the box is flat: it has no inside, as {what} needs");
    let help =
        "give `max` larger coordinates than `min` on every axis; a flat surface is a `rectangle`";
    Err(reader.mistake("box", message, help))
}

/// What a transform made of the shape at `key`, or the mistake in it.
fn moved<T>(reader: &Reader, key: &str, made: Result<T, impl Display>) -> SceneResult<T> {
    made.map_err(|error| reader.error(key, format!("after its transform: {error}")))
}
