//! Densities of heterogeneous media, as scenes give them.

use super::shapes::FARTHEST;
use crate::optics::Field;
use crate::scene::SceneResult;
use crate::scene::files::Files;
use crate::scene::format::{Key, Kind, Range, Rule, Table};
use crate::scene::reader::Reader;
use crate::scene::volume::VOLUME;
use crate::scene::{ProceduralMedium, read_procedural};
use crate::volume::{
    Blob, ExponentialLayer, FractalDensity, FractalParameters, GridDensity, Interpolation,
    LinearRamp, MOST_OCTAVES,
};

/// The keys that give a density.
pub(super) const KEYS: [&str; 6] = [
    "grid",
    "noise",
    "exponential",
    "linear",
    "blob",
    "procedural",
];

/// A grid.
pub(super) const GRID: Key = Key::optional("grid", Kind::Table(&VOLUME)).doc(
    "Density: that of a grid or point cloud, in the box of its own unless the medium has a shape.",
);

/// Between the nodes of a grid.
pub(super) const INTERPOLATION: Key = Key::optional("interpolation", Kind::Choice(&["trilinear", "nearest"]))
    .doc("With `grid`: how densities between the nodes follow from those at the nodes; trilinear if left out.");

const POSITIVE: Range = Range::open(0.0, f64::INFINITY);

/// Fractal noise.
pub(super) const NOISE: Key =
    Key::optional("noise", Kind::Table(&NOISE_TABLE)).doc("Density: fractal noise.");

const NOISE_TABLE: Table = Table::new("Noise at many scales: octaves of Perlin's improved noise at p·scale + offset, the sum of amplitudes scaled to 1, mapped from [-1, 1] to [0, max_density]; 0 up to the threshold.").keys(&[
    Key::or("octaves", Kind::Count(1, MOST_OCTAVES as u64), "4")
        .doc("Layers of noise."),
    Key::or("lacunarity", Kind::Number(POSITIVE), "2.0")
        .doc("Factor on the frequency from one octave to the next."),
    Key::or("gain", Kind::Number(POSITIVE), "0.5")
        .doc("Factor on the amplitude from one octave to the next."),
    Key::or("scale", Kind::Vector, "[1.0, 1.0, 1.0]")
        .doc("Cells of the first octave per world unit, along x, y, z."),
    Key::or("offset", Kind::Vector, "[0.0, 0.0, 0.0]")
        .doc("Position of the origin in the first octave, in cells."),
    Key::or("max_density", Kind::Number(Range::at_least(0.0)), "1.0")
        .doc("The largest density."),
    Key::or("threshold", Kind::Number(Range::at_least(f64::MIN)), "0.0")
        .doc("Densities up to this one count as 0; nothing is subtracted from the others."),
]);

/// An exponential layer.
pub(super) const EXPONENTIAL: Key = Key::optional("exponential", Kind::Table(&EXPONENTIAL_TABLE))
    .doc("Density: a layer that thins with height, as air does.");

const EXPONENTIAL_TABLE: Table =
    Table::new("A density that falls with height above a base, by the factor e per scale height.")
        .keys(&[
            Key::or("density", Kind::Number(Range::at_least(0.0)), "1.0")
                .doc("Density at the base."),
            Key::or("base", Kind::Vector, "[0.0, 0.0, 0.0]")
                .doc("A point at height 0, world units."),
            Key::or("up", Kind::Vector, "[0.0, 1.0, 0.0]")
                .doc("The direction of rising height, any length but 0."),
            Key::required("scale_height", Kind::Number(POSITIVE))
                .doc("Height over which the density falls by a factor of e, world units."),
        ]);

/// A linear density.
pub(super) const LINEAR: Key =
    Key::optional("linear", Kind::Table(&LINEAR_TABLE)).doc("Density: a linear ramp.");

const LINEAR_TABLE: Table =
    Table::new("A density that is linear in space where that is positive, else 0.").keys(&[
        Key::or("density", Kind::Number(Range::at_least(f64::MIN)), "1.0")
            .doc("Density at the origin given; it may be negative there."),
        Key::or("origin", Kind::Vector, "[0.0, 0.0, 0.0]")
            .doc("Point that has this density, world units."),
        Key::required("gradient", Kind::Vector)
            .doc("Change of the density per world unit along x, y, z."),
    ]);

/// A Gaussian ball.
pub(super) const BLOB: Key =
    Key::optional("blob", Kind::Table(&BLOB_TABLE)).doc("Density: a Gaussian ball.");

const BLOB_TABLE: Table =
    Table::new("A Gaussian ball, peak·exp(-r²/(2 width²)) at distance r from its centre.").keys(&[
        Key::required("centre", Kind::Vector).doc("Its centre, world units."),
        Key::required("width", Kind::Number(POSITIVE))
            .doc("Its standard deviation along any line, world units."),
        Key::or("peak", Kind::Number(Range::at_least(0.0)), "1.0").doc("Density at the centre."),
    ]);

/// A block of another renderer.
pub(super) const PROCEDURAL: Key = Key::optional("procedural", Kind::Table(&PROCEDURAL_TABLE))
    .doc("Density and coefficients: a procedural medium in XML.");

const PROCEDURAL_TABLE: Table = Table::new(
    "A `<medium type=\"procedural\">` element, as it stands: noise, sigma_a and sigma_s.",
)
.keys(&[
    Key::optional("file", Kind::Text)
        .doc("XML file that holds the element, relative to the folder of the scene."),
    Key::optional("text", Kind::Text).doc("The element itself, best between three single quotes."),
])
.rules(&[Rule::ExactlyOne("source", &["file", "text"])]);

/// The `procedural` element of a medium, if it has one.
pub(super) fn procedural(
    reader: &Reader,
    files: &mut Files,
) -> SceneResult<Option<ProceduralMedium>> {
    let Some(source) = reader.table("procedural")? else {
        return Ok(None);
    };
    if let Some((path, text)) = source.text_in_place("text")? {
        return read_procedural(&path, &text).map(Some);
    }
    let name = source.text("file")?;
    let (path, text) = files.text(&source, &name)?;
    read_procedural(&path, &text).map(Some)
}

/// The density that a medium gives by any other of [`KEYS`]; none if it is the same everywhere.
pub(super) fn field(reader: &Reader, files: &mut Files) -> SceneResult<Option<Field>> {
    let interpolation = reader.optional_text("interpolation")?;
    if let Some(grid) = reader.table("grid")? {
        let interpolation = match interpolation.as_deref() {
            Some("nearest") => Interpolation::Nearest,
            _ => Interpolation::Trilinear,
        };
        let density = GridDensity::new(
            files.densities(
                &grid,
                "densities must not be negative: shift or scale the values",
            )?,
            interpolation,
        );
        return Ok(Some(Field::Grid(density)));
    }
    if interpolation.is_some() {
        let message = "`interpolation` belongs to a grid, and the medium has none";
        let help = "remove it, or give the medium a `grid`";
        return Err(reader.mistake("interpolation", message, help));
    }
    if let Some(noise) = reader.table("noise")? {
        return read_noise(&noise).map(|noise| Some(Field::Noise(noise)));
    }
    if let Some(layer) = reader.table("exponential")? {
        let (density, base) = (layer.number("density")?, layer.vector("base")?);
        let (up, scale_height) = (layer.vector("up")?, layer.number("scale_height")?);
        let field = ExponentialLayer::new(density, base, up, scale_height);
        return Ok(Some(Field::Exponential(layer.accepted(field)?)));
    }
    if let Some(ramp) = reader.table("linear")? {
        let (density, origin) = (ramp.number("density")?, ramp.vector("origin")?);
        let field = LinearRamp::new(density, origin, ramp.vector("gradient")?);
        return Ok(Some(Field::Linear(ramp.accepted(field)?)));
    }
    if let Some(blob) = reader.table("blob")? {
        return read_blob(&blob).map(|blob| Some(Field::Blob(blob)));
    }
    Ok(None)
}

/// A ball, no farther away and no wider than shapes may be: its distance along a line is a
/// quotient of squares.
fn read_blob(reader: &Reader) -> SceneResult<Blob> {
    let blob = Blob {
        centre: reader.vector("centre")?,
        peak: reader.number("peak")?,
        width: reader.number("width")?,
    };
    let beyond = [
        ("centre", blob.centre.abs().max_element()),
        ("width", blob.width),
    ];
    match beyond.into_iter().find(|(_, length)| *length > FARTHEST) {
        None => Ok(blob),
        Some((key, length)) => {
            let message = format!(
                "the ball's {key} of {length:.3e} is too large: lengths and coordinates up to \
                 {FARTHEST:e} are accepted"
            );
            Err(reader.mistake(key, message, "choose another unit of length"))
        }
    }
}

fn read_noise(reader: &Reader) -> SceneResult<FractalDensity> {
    let parameters = FractalParameters {
        octaves: reader.count("octaves")? as u32,
        lacunarity: reader.number("lacunarity")?,
        gain: reader.number("gain")?,
        scale: reader.vector("scale")?,
        offset: reader.vector("offset")?,
        max_density: reader.number("max_density")?,
        threshold: reader.number("threshold")?,
    };
    reader.accepted(FractalDensity::new(parameters))
}
