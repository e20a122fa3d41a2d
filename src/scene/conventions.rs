//! Conventions of ray casters: choices in which renderers of classified volumes differ without
//! being wrong.
//!
//! The defaults are those of volref. Other conventions are rendered by the plain ray caster
//! ([`crate::reference::ray_caster`]), so that another renderer can be compared with the right
//! image *under its own conventions*.

use super::SceneResult;
use super::format::{Key, Kind, Range, Table};
use super::reader::Reader;

/// The declaration of `[classified.conventions]`.
pub const CONVENTIONS: Table = Table::new("Choices in which ray casters differ without being wrong. Whatever is left out is as volref has it.").keys(&[
    Key::or("first_sample", Kind::Number(Range::closed(0.0, 1.0)), "0.5")
        .doc("Position of a sample within its step, in steps: 0 at its beginning, 0.5 in the middle, 1 at its end. So the first sample of a ray lies that far behind the front face."),
    Key::or("jitter", Kind::Flag, "false")
        .doc("Places the samples of each ray at a random `first_sample`, the same for all samples of the ray."),
    Key::or("last_step", Kind::Choice(&LAST_STEPS), "'exact'")
        .doc("Step cut off by the back face: counted over its true length, counted as a whole step, or dropped."),
    Key::or("centring", Kind::Choice(&CENTRINGS), "'nodes'")
        .doc("Place of the values: the outermost nodes lie on the faces of the volume (nodes); or the values lie at the centres of n cells that divide each side of it, n the nodes of the axis, and those of the outermost cells reach to the faces (cells), as in textures. A volume of cells stays one."),
    Key::or("opacity", Kind::Choice(&OPACITIES), "'exact'")
        .doc("Opacity over a step h, stated as a over h0: 1 - (1 - a)^(h/h0), or the linear min(1, a h/h0)."),
    Key::or("classification", Kind::Choice(&CLASSIFICATIONS), "'post'")
        .doc("Values are interpolated, then classified (post); or nodes are classified, and opacity and associated colour interpolated (pre)."),
    Key::optional("table_size", Kind::Count(2, 1 << 16))
        .doc("Entries of the table in which opacities and colours are looked up, from the first to the last point of the transfer function; from 0 to the largest density for the formula. If left out, they are evaluated at each value."),
    Key::or("table_lookup", Kind::Choice(&TABLE_LOOKUPS), "'linear'")
        .doc("Between the entries of the table: linear, or the nearest entry."),
    Key::or("gradient", Kind::Choice(&GRADIENTS), "'central'")
        .doc("Gradient for shading: central differences, forward differences or the 3 x 3 x 3 Sobel filter at the nodes, interpolated; the derivative of the trilinear interpolant; or central differences at the sample over 2 n/(n - 1) spacings, n the nodes of the axis, divided as if over two (texture): what steps of 1/(n - 1) in texture coordinates give."),
    Key::or("normals", Kind::Choice(&NORMALS), "'interpolated'")
        .doc("Gradients at the nodes are interpolated as they are, or normalised before that."),
    Key::optional("normal_bits", Kind::Count(2, 16))
        .doc("Bits of each component of a normal stored at the nodes, for [-1, 1]; normals are normalised at the nodes then. If left out, they are not rounded."),
    Key::or("normal_space", Kind::Choice(&NORMAL_SPACES), "'world'")
        .doc("Space in which the gradient is normalised: the world, or that with its components multiplied by the size of the volume along each axis (box)."),
    Key::or("shading_point", Kind::Choice(&SHADING_POINTS), "'sample'")
        .doc("Point from which light and eye are seen: the sample, or (texture) the point that divides each side of the volume as the sample's texture coordinate (u + 1/2)/n divides [0, 1], u its node coordinate and n the nodes of the axis."),
    Key::or("flat_samples", Kind::Choice(&FLAT_SAMPLES), "'unshaded'")
        .doc("Samples without a gradient: their unshaded colour, or the ambient term alone."),
    Key::or("ambient_colour", Kind::Choice(&COLOURS), "'material'")
        .doc("Colour that the weight of the ambient term applies to: that of the material, white, or black."),
    Key::or("highlight_colour", Kind::Choice(&COLOURS), "'white'")
        .doc("Colour that the weight of the highlight applies to."),
    Key::or("highlight_emission", Kind::Flag, "true")
        .doc("Multiplies the highlight by the emission of the sample, d^2 by the formula, like the rest of its colour."),
    Key::or("highlight", Kind::Choice(&HIGHLIGHTS), "'reflected'")
        .doc("Cosine of the highlight: between the reflected light and the eye (Phong), or between the normal and the half vector (Blinn)."),
    Key::or("shadow_sample", Kind::Number(Range::closed(0.0, 1.0)), "0.5")
        .doc("Position of a sample within its step on the way to the light, in steps from the point that is lit."),
    Key::or("shadowed_ambient", Kind::Flag, "true")
        .doc("Volume shadow dims the ambient term like the rest of the light."),
    Key::or("head_light", Kind::Flag, "false")
        .doc("Puts the light for shading at the eye."),
    Key::or("two_sided", Kind::Flag, "false")
        .doc("Turns normals towards the light."),
    Key::or("clamped_samples", Kind::Flag, "false")
        .doc("Clamps the radiance of each sample, shaded, to 1 before it is composited."),
    Key::or("precision", Kind::Choice(&PRECISIONS), "'f64'")
        .doc("Numbers that hold the composited colour and opacity of a ray: floating point of 64, 32 or 16 bits, or 8 bits for [0, 1]."),
    Key::or("pixel", Kind::Choice(&PIXELS), "'centre'")
        .doc("Point of a pixel that its ray passes: its centre, or its upper left corner."),
]);

const LAST_STEPS: [&str; 3] = ["exact", "whole", "dropped"];
const CENTRINGS: [&str; 2] = ["nodes", "cells"];
const OPACITIES: [&str; 2] = ["exact", "linear"];
const CLASSIFICATIONS: [&str; 2] = ["post", "pre"];
const TABLE_LOOKUPS: [&str; 2] = ["linear", "nearest"];
const GRADIENTS: [&str; 5] = ["central", "forward", "sobel", "interpolant", "texture"];
const NORMALS: [&str; 2] = ["interpolated", "normalised"];
const NORMAL_SPACES: [&str; 2] = ["world", "box"];
const SHADING_POINTS: [&str; 2] = ["sample", "texture"];
const FLAT_SAMPLES: [&str; 2] = ["unshaded", "ambient"];
const COLOURS: [&str; 3] = ["material", "white", "black"];
const HIGHLIGHTS: [&str; 2] = ["reflected", "half-vector"];
const PRECISIONS: [&str; 4] = ["f64", "f32", "f16", "u8"];
const PIXELS: [&str; 2] = ["centre", "corner"];

/// Conventions of a ray caster; by default those of volref.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conventions {
    /// Position of a sample within its step, in steps, in [0, 1].
    pub first_sample: f64,
    /// A random `first_sample` for each ray.
    pub jitter: bool,
    /// Step cut off by the back face.
    pub last_step: LastStep,
    /// Values lie at the centres of cells that divide the volume.
    pub cell_centred: bool,
    /// Linear instead of exact opacity over a step.
    pub linear_opacity: bool,
    /// Nodes are classified before interpolation.
    pub preclassified: bool,
    /// Entries of the table of the transfer function, if there is one.
    pub table_size: Option<u32>,
    /// The nearest entry of the table, instead of linear interpolation.
    pub nearest_entry: bool,
    /// Gradient for shading.
    pub gradient: Gradient,
    /// Gradients are normalised at the nodes, before interpolation.
    pub normalised_at_nodes: bool,
    /// Bits of a component of a stored normal.
    pub normal_bits: Option<u32>,
    /// Gradients are normalised after their components are multiplied by the size of the volume.
    pub box_space_normals: bool,
    /// Light and eye are seen from texture coordinates, taken as fractions of the volume's sides.
    pub texture_shading_point: bool,
    /// Samples without a gradient get the ambient term alone.
    pub flat_samples_ambient: bool,
    /// Colour of the ambient term.
    pub ambient_colour: LightColour,
    /// Colour of the highlight.
    pub highlight_colour: LightColour,
    /// Whether the highlight is multiplied by the emission of the sample.
    pub highlight_emission: bool,
    /// Half vector instead of the reflected light.
    pub half_vector: bool,
    /// Position of a sample within its step on the way to the light, in steps, in [0, 1].
    pub shadow_sample: f64,
    /// Whether volume shadow dims the ambient term.
    pub shadowed_ambient: bool,
    /// The light for shading is at the eye.
    pub head_light: bool,
    /// Normals point towards the light.
    pub two_sided: bool,
    /// Radiances of samples are clamped to 1.
    pub clamped_samples: bool,
    /// Numbers that hold the composited colour and opacity.
    pub precision: Precision,
    /// Rays pass the upper left corner of their pixel.
    pub pixel_corner: bool,
}

/// Treatment of the step that is cut off by the back face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LastStep {
    /// Counted over its true length.
    Exact,
    /// Every sample inside the volume counts as a whole step.
    Whole,
    /// Dropped.
    Dropped,
}

/// Gradient for shading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gradient {
    /// Central differences at the nodes.
    Central,
    /// Forward differences at the nodes.
    Forward,
    /// The 3 × 3 × 3 Sobel filter at the nodes.
    Sobel,
    /// Derivative of the trilinear interpolant at the sample.
    Interpolant,
    /// Central differences at the sample over `2n/(n − 1)` spacings, `n` the nodes of an axis, divided
    /// as if over two.
    Texture,
}

/// Colour that the weight of a term of the shading applies to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightColour {
    /// That of the sample.
    Material,
    /// White.
    White,
    /// Black: the term is absent.
    Black,
}

/// Numbers that hold the composited colour and opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 64 bits.
    F64,
    /// 32 bits.
    F32,
    /// 16 bits, IEEE half precision.
    F16,
    /// 8 bits for [0, 1]; values outside are clamped.
    U8,
}

impl Default for Conventions {
    fn default() -> Conventions {
        Conventions {
            first_sample: 0.5,
            jitter: false,
            last_step: LastStep::Exact,
            cell_centred: false,
            linear_opacity: false,
            preclassified: false,
            table_size: None,
            nearest_entry: false,
            gradient: Gradient::Central,
            normalised_at_nodes: false,
            normal_bits: None,
            box_space_normals: false,
            texture_shading_point: false,
            flat_samples_ambient: false,
            ambient_colour: LightColour::Material,
            highlight_colour: LightColour::White,
            highlight_emission: true,
            half_vector: false,
            shadow_sample: 0.5,
            shadowed_ambient: true,
            head_light: false,
            two_sided: false,
            clamped_samples: false,
            precision: Precision::F64,
            pixel_corner: false,
        }
    }
}

impl Conventions {
    /// Reads the table, in the order of its declaration.
    pub fn read(reader: &Reader) -> SceneResult<Conventions> {
        use {Gradient::*, LastStep::*, LightColour::*, Precision::*};
        let word = |name: &str, words: &[&str]| -> SceneResult<usize> {
            let text = reader.text(name)?;
            let index = words.iter().position(|word| *word == text);
            Ok(index.expect("one of the declared words"))
        };
        let is_second = |name: &str, words: &[&str; 2]| word(name, words).map(|index| index == 1);
        let read = Conventions {
            first_sample: reader.number("first_sample")?,
            jitter: reader.flag("jitter")?,
            last_step: [Exact, Whole, Dropped][word("last_step", &LAST_STEPS)?],
            cell_centred: is_second("centring", &CENTRINGS)?,
            linear_opacity: is_second("opacity", &OPACITIES)?,
            preclassified: is_second("classification", &CLASSIFICATIONS)?,
            table_size: reader.optional_count("table_size")?.map(|size| size as u32),
            nearest_entry: is_second("table_lookup", &TABLE_LOOKUPS)?,
            gradient: [Central, Forward, Sobel, Interpolant, Texture]
                [word("gradient", &GRADIENTS)?],
            normalised_at_nodes: is_second("normals", &NORMALS)?,
            normal_bits: reader
                .optional_count("normal_bits")?
                .map(|bits| bits as u32),
            box_space_normals: is_second("normal_space", &NORMAL_SPACES)?,
            texture_shading_point: is_second("shading_point", &SHADING_POINTS)?,
            flat_samples_ambient: is_second("flat_samples", &FLAT_SAMPLES)?,
            ambient_colour: [Material, White, Black][word("ambient_colour", &COLOURS)?],
            highlight_colour: [Material, White, Black][word("highlight_colour", &COLOURS)?],
            highlight_emission: reader.flag("highlight_emission")?,
            half_vector: is_second("highlight", &HIGHLIGHTS)?,
            shadow_sample: reader.number("shadow_sample")?,
            shadowed_ambient: reader.flag("shadowed_ambient")?,
            head_light: reader.flag("head_light")?,
            two_sided: reader.flag("two_sided")?,
            clamped_samples: reader.flag("clamped_samples")?,
            precision: [F64, F32, F16, U8][word("precision", &PRECISIONS)?],
            pixel_corner: is_second("pixel", &PIXELS)?,
        };
        read.check(reader)?;
        Ok(read)
    }

    /// The keys that differ from the defaults, with their values, as lines of a table.
    pub fn lines(&self) -> Vec<String> {
        fn text(word: &str) -> String {
            format!("{word:?}")
        }
        fn one_of<T: Copy + PartialEq>(value: T, values: &[T], words: &[&str]) -> String {
            let index = values.iter().position(|other| *other == value);
            text(words[index.expect("every value has a word")])
        }
        fn second(value: bool, words: &[&str; 2]) -> String {
            text(words[usize::from(value)])
        }
        use {Gradient::*, LastStep::*, LightColour::*, Precision::*};
        let keys = |of: &Conventions| {
            let colour = |colour| one_of(colour, &[Material, White, Black], &COLOURS);
            let optional = |count: Option<u32>| count.map_or(String::new(), |n| n.to_string());
            [
                ("first_sample", format!("{:?}", of.first_sample)),
                ("jitter", of.jitter.to_string()),
                (
                    "last_step",
                    one_of(of.last_step, &[Exact, Whole, Dropped], &LAST_STEPS),
                ),
                ("centring", second(of.cell_centred, &CENTRINGS)),
                ("opacity", second(of.linear_opacity, &OPACITIES)),
                ("classification", second(of.preclassified, &CLASSIFICATIONS)),
                ("table_size", optional(of.table_size)),
                ("table_lookup", second(of.nearest_entry, &TABLE_LOOKUPS)),
                (
                    "gradient",
                    one_of(
                        of.gradient,
                        &[Central, Forward, Sobel, Interpolant, Texture],
                        &GRADIENTS,
                    ),
                ),
                ("normals", second(of.normalised_at_nodes, &NORMALS)),
                ("normal_bits", optional(of.normal_bits)),
                ("normal_space", second(of.box_space_normals, &NORMAL_SPACES)),
                (
                    "shading_point",
                    second(of.texture_shading_point, &SHADING_POINTS),
                ),
                (
                    "flat_samples",
                    second(of.flat_samples_ambient, &FLAT_SAMPLES),
                ),
                ("ambient_colour", colour(of.ambient_colour)),
                ("highlight_colour", colour(of.highlight_colour)),
                ("highlight_emission", of.highlight_emission.to_string()),
                ("highlight", second(of.half_vector, &HIGHLIGHTS)),
                ("shadow_sample", format!("{:?}", of.shadow_sample)),
                ("shadowed_ambient", of.shadowed_ambient.to_string()),
                ("head_light", of.head_light.to_string()),
                ("two_sided", of.two_sided.to_string()),
                ("clamped_samples", of.clamped_samples.to_string()),
                (
                    "precision",
                    one_of(of.precision, &[F64, F32, F16, U8], &PRECISIONS),
                ),
                ("pixel", second(of.pixel_corner, &PIXELS)),
            ]
        };
        let differing = keys(self).into_iter().zip(keys(&Conventions::default()));
        let differing = differing.filter(|(own, default)| own != default);
        differing
            .map(|((key, value), _)| format!("{key} = {value}"))
            .collect()
    }

    /// Refuses keys without effect beside others.
    fn check(&self, reader: &Reader) -> SceneResult<()> {
        let stored = matches!(
            self.gradient,
            Gradient::Central | Gradient::Forward | Gradient::Sobel
        );
        let contradictions = [
            (
                "first_sample",
                self.jitter,
                "with `jitter` the place of the first sample is random: leave one of them out",
            ),
            (
                "table_lookup",
                self.nearest_entry && self.table_size.is_none(),
                "there is no table to look up: give `table_size`, its number of entries",
            ),
            (
                "normals",
                self.normalised_at_nodes && !stored,
                "this gradient is not stored at the nodes: leave `normals` out",
            ),
            (
                "normal_bits",
                !stored,
                "this gradient is not stored at the nodes: leave `normal_bits` out",
            ),
            (
                "table_size",
                self.preclassified,
                "with `classification = \"pre\"` nodes are classified without a table: leave \
                 `table_size` out",
            ),
        ];
        match contradictions
            .into_iter()
            .find(|(key, is_wrong, _)| *is_wrong && reader.has(key))
        {
            Some((key, _, message)) => Err(reader.error(key, message)),
            None => Ok(()),
        }
    }
}
