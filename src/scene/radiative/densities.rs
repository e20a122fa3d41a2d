//! Densities of heterogeneous media, as scenes give them.

use crate::optics::Field;
use crate::scene::SceneResult;
use crate::scene::files::Files;
use crate::scene::format::{Key, Kind, Range, Rule, Table};
use crate::scene::reader::Reader;
use crate::scene::record::{Choice, Record};
use crate::scene::volume::VOLUME;
use crate::scene::{ProceduralMedium, read_procedural};
use crate::volume::{
    Blob, ExponentialLayer, FractalDensity, FractalParameters, GridDensity, Interpolation,
    LinearRamp, MOST_OCTAVES,
};
use glam::DVec3;

/// The keys that give a density.
pub(super) const KEYS: [&str; 6] = [
    "grid",
    "noise",
    "exponential",
    "linear",
    "blob",
    "procedural",
];

record! {
    impl FractalParameters in "Noise at many scales: octaves of Perlin's improved noise at p·scale + offset, the sum of amplitudes scaled to 1, mapped from [-1, 1] to [0, max_density]; 0 up to the threshold." {
        octaves = or("4") Count(1, MOST_OCTAVES as u64), "Layers of noise.";
        lacunarity = or("2.0") Number(Range::POSITIVE), "Factor on the frequency from one octave to the next.";
        gain = or("0.5") Number(Range::POSITIVE), "Factor on the amplitude from one octave to the next.";
        scale = or("[1.0, 1.0, 1.0]") Vector, "Cells of the first octave per world unit, along x, y, z.";
        offset = or("[0.0, 0.0, 0.0]") Vector, "Position of the origin in the first octave, in cells.";
        max_density = or("1.0") Number(Range::NOT_NEGATIVE), "The largest density.";
        threshold = or("0.0") Number(Range::at_least(f64::MIN)),
            "Densities up to this one count as 0; nothing is subtracted from the others.";
    }
}

record! {
    struct Exponential in "A density that falls with height above a base, by the factor e per scale height." {
        density: f64 = or("1.0") Number(Range::NOT_NEGATIVE), "Density at the base.";
        base: DVec3 = or("[0.0, 0.0, 0.0]") Vector, "A point at height 0, world units.";
        up: DVec3 = or("[0.0, 1.0, 0.0]") Vector, "The direction of rising height, any length but 0.";
        scale_height: f64 = required Number(Range::POSITIVE),
            "Height over which the density falls by a factor of e, world units.";
    }
}

record! {
    impl LinearRamp in "A density that is linear in space where that is positive, else 0." {
        density = or("1.0") Number(Range::at_least(f64::MIN)),
            "Density at the origin given; it may be negative there.";
        origin = or("[0.0, 0.0, 0.0]") Vector, "Point that has this density, world units.";
        gradient = required Vector, "Change of the density per world unit along x, y, z.";
    }
}

record! {
    impl Blob in "A Gaussian ball, peak·exp(-r²/(2 width²)) at distance r from its centre." {
        centre = required Vector, "Its centre, world units.";
        peak = or("1.0") Number(Range::NOT_NEGATIVE), "Density at the centre.";
        width = required Number(Range::POSITIVE), "Its standard deviation along any line, world units.";
    }
}

/// The keys that give a density, declared.
pub(super) const DENSITIES: [Key; 7] = [
    Key::optional("grid", Kind::Table(&VOLUME))
        .doc("Density: that of a grid or point cloud, in the box of its own unless the medium has a shape."),
    Key::optional("interpolation", Kind::Choice(Interpolation::WORDS))
        .doc("With `grid`: how densities between the nodes follow from those at the nodes; trilinear if left out."),
    Key::optional("noise", Kind::Table(&FractalParameters::TABLE)).doc("Density: fractal noise."),
    Key::optional("exponential", Kind::Table(&Exponential::TABLE))
        .doc("Density: a layer that thins with height, as air does."),
    Key::optional("linear", Kind::Table(&LinearRamp::TABLE)).doc("Density: a linear ramp."),
    Key::optional("blob", Kind::Table(&Blob::TABLE)).doc("Density: a Gaussian ball."),
    Key::optional("procedural", Kind::Table(&PROCEDURAL))
        .doc("Density and coefficients: a procedural medium in XML."),
];

const PROCEDURAL: Table = Table::new(
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
    let (path, text) = match source.text_in_place("text")? {
        Some(inline) => inline,
        None => files.text(&source, &source.get::<String>("file")?)?,
    };
    read_procedural(&path, &text).map(Some)
}

/// The density that a medium gives by any other of [`KEYS`]; none if it is the same everywhere.
pub(super) fn field(reader: &Reader, files: &mut Files) -> SceneResult<Option<Field>> {
    let interpolation: Option<Interpolation> = reader.get("interpolation")?;
    if let Some(grid) = reader.table("grid")? {
        let interpolation = interpolation.unwrap_or(Interpolation::Trilinear);
        let help = "densities must not be negative: shift or scale the values";
        let density = GridDensity::new(files.densities(&grid, help)?, interpolation);
        return Ok(Some(Field::Grid(density)));
    }
    refuse! { reader:
        "interpolation", "`interpolation` belongs to a grid, and the medium has none",
            "remove it, or give the medium a `grid`";
    }
    if let Some(table) = reader.table("noise")? {
        let noise = FractalDensity::new(Record::read(&table)?);
        return Ok(Some(Field::Noise(table.accepted(noise)?)));
    }
    if let Some(table) = reader.table("exponential")? {
        let layer = Exponential::read(&table)?;
        let layer = ExponentialLayer::new(layer.density, layer.base, layer.up, layer.scale_height);
        return Ok(Some(Field::Exponential(table.accepted(layer)?)));
    }
    if let Some(ramp) = reader.table_as("linear", LinearRamp::read)? {
        return Ok(Some(Field::Linear(ramp)));
    }
    let blob = reader.table_as("blob", Blob::read)?;
    Ok(blob.map(Field::Blob))
}
