//! Conventions of ray casters: choices in which renderers of classified volumes differ without
//! being wrong.
//!
//! The defaults are those of volref. Other conventions are rendered by a ray caster of their own
//! ([`crate::conventions::ray_caster`]), so that another renderer can be compared with the right
//! image *under its own conventions*.
//!
//! Each convention is one row below, and one place of `conventions/`.

mod alternative;
mod choices;

pub use alternative::Alternative;
pub use choices::*;

use super::SceneResult;
use super::format::{Key, Kind, Range, Table};
use super::mode::{Mode, Projected};
use super::reader::{Reader, Value};
use super::record::Choice;
use alternative::other;

/// Modes that follow a convention: composited samples, projections, among them that of the mean, and isosurfaces.
const COMPOSITED: u8 = 1;
const PROJECTED: u8 = 2;
const MEAN: u8 = 4;
const SURFACES: u8 = 8;

/// Modes that follow a convention about the places of samples, or about shading.
const ALL: u8 = COMPOSITED | PROJECTED | MEAN | SURFACES;
const SHADED: u8 = COMPOSITED | SURFACES;

/// Composited samples that follow a convention about several objects, which means nothing for one volume.
const OBJECTS: u8 = COMPOSITED | 16;

/// Declares [`Conventions`], [`CONVENTIONS`] and [`ALTERNATIVES`]. A row has the key in files, the field with its type,
/// the kind of its values with the default, the modes that follow it, and the description in the schema. Alternatives
/// follow: what other renderers do, as far as a search for conventions tries it.
macro_rules! conventions {
    ($(
        $key:literal = $field:ident: $type:ty = $kind:ident($($values:tt)+) of $modes:ident,
        $doc:literal $(, $alternative:expr)*;
    )+) => {
        /// Conventions of a ray caster; by default those of volref.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Conventions {
            $(#[doc = $doc] pub $field: $type,)+
            /// A mistake that is made: no file states one.
            pub fault: Option<Fault>,
        }

        impl Default for Conventions {
            fn default() -> Conventions {
                Conventions { $($field: value!(default $kind $($values)+),)+ fault: None }
            }
        }

        /// The declaration of `[classified.conventions]`.
        pub const CONVENTIONS: Table = Table::new(
            "Choices in which ray casters differ without being wrong. Omitted keys keep volref's own convention.",
        )
        .keys(&[$(value!(key $kind $key, $type, $($values)+).doc($doc),)+]);

        /// Choices with what other renderers do, by the key of each convention.
        pub const ALTERNATIVES: &[(&str, &[Alternative])] = &[$(($key, &[$($alternative),*]),)+];

        impl Conventions {
            /// Reads the table, in the order of its declaration.
            pub fn read(reader: &Reader) -> SceneResult<Conventions> {
                Ok(Conventions { $($field: value!(read $kind reader.get($key)?, $($values)+),)+ fault: None })
            }

            /// The keys that differ from the defaults, with their values, as lines of a table.
            pub fn lines(&self) -> Vec<String> {
                let (default, mut changed) = (Conventions::default(), Vec::new());
                $(if self.$field != default.$field {
                    changed.push(format!("{} = {}", $key, value!(text $kind self.$field, $($values)+)));
                })+
                changed
            }

            /// Conventions that a mode follows; the others as volref has them.
            pub(crate) fn of_mode(&self, mode: &Mode) -> Conventions {
                let own = Conventions::default();
                let mode = match mode {
                    Mode::Composited => COMPOSITED,
                    Mode::Projection(projection) if projection.of == Projected::Mean => MEAN,
                    Mode::Projection(_) => PROJECTED,
                    Mode::Isosurfaces(_) => SURFACES,
                };
                Conventions { $($field: if $modes & mode == 0 { own.$field } else { self.$field },)+ fault: self.fault }
            }
        }
    };
}

/// A value of a convention, by its kind: `number`, in [0, 1]; `flag`; `count`, optional; `either` of two words, the
/// second for true; `choice` of many. The default is the first.
macro_rules! value {
    (default count $low:literal..=$high:literal) => {
        None
    };
    (default either $no:literal, $yes:literal) => {
        false
    };
    (default choice $word:literal) => {
        Choice::named($word)
    };
    (default $kind:ident $default:literal) => {
        $default
    };

    (key number $key:literal, $type:ty, $default:literal) => {
        Key::or($key, Kind::Number(Range::UNIT), stringify!($default))
    };
    (key flag $key:literal, $type:ty, $default:literal) => {
        Key::or($key, Kind::Flag, stringify!($default))
    };
    (key count $key:literal, $type:ty, $low:literal..=$high:literal) => {
        Key::optional($key, Kind::Count($low, $high))
    };
    (key either $key:literal, $type:ty, $no:literal, $yes:literal) => {
        Key::or($key, Kind::Choice(&[$no, $yes]), concat!("'", $no, "'"))
    };
    (key choice $key:literal, $type:ty, $word:literal) => {
        Key::or($key, Kind::Choice(<$type>::WORDS), concat!("'", $word, "'"))
    };

    (read either $word:expr, $no:literal, $yes:literal) => {{
        let word: String = $word;
        word == $yes
    }};
    (read $kind:ident $read:expr, $($values:tt)+) => {
        $read
    };

    (text count $count:expr, $($values:tt)+) => {
        $count.map_or(String::new(), |n| n.to_string())
    };
    (text either $is_second:expr, $no:literal, $yes:literal) => {
        format!("{:?}", if $is_second { $yes } else { $no })
    };
    (text choice $chosen:expr, $($values:tt)+) => {
        $chosen.shown()
    };
    (text $kind:ident $value:expr, $($values:tt)+) => {
        format!("{:?}", $value)
    };
}

conventions! {
    "first_sample" = first_sample: f64 = number(0.5) of ALL,
    "Position of a sample within its step, in steps: 0 at its beginning, 0.5 in the middle, 1 at its end. So the first sample of a ray lies that far behind the front face.",
    other("takes the first sample of a ray a whole step behind the front face, not half a step",
        |it| it.first_sample = 1.0),
    other("takes the first sample of a ray on the front face, not half a step behind it",
        |it| it.first_sample = 0.0);

    "jitter" = jitter: bool = flag(false) of COMPOSITED,
    "Places the samples of each ray at a random `first_sample`, the same for all samples of the ray.";

    "unstated_first_sample" = unstated_first_sample: bool = flag(false) of COMPOSITED,
    "Places the samples of each ray at a `first_sample` that no scene states, such as by counting steps from the near plane of a camera: any is right, and here it is random.";

    "first_step_jitter" = first_step_jitter: bool = flag(false) of COMPOSITED,
    "Gives the first step of each ray a random length, a `first_step` of its own.";

    "step_length" = step_length: StepLength = choice("world") of ALL,
    "Length of a step: that of the scene in the world; as many spacings of the grid as it has voxels, along the ray in node coordinates (voxels), or along the axis on which the ray passes nodes fastest (main-axis); or the part of the cube of texture coordinates that it is of the longest side of the volume (texture); or as long in the coordinates of the volume, before a map places it, as stated in the world (volume).",
    other("takes steps of a length in voxels, not in the world", |it| it.step_length = StepLength::Voxels),
    other("takes steps of a length in voxels along the main axis of the ray",
        |it| it.step_length = StepLength::MainAxis),
    other("takes steps of a length in texture coordinates", |it| it.step_length = StepLength::Texture);

    "fitted_steps" = fitted_steps: FittedSteps = choice("none") of ALL,
    "Number of steps of a ray: what its length and that of a step give, the last one cut off (none); or a whole number, the quotient rounded, rounded up or rounded down, of steps that are stretched to fill the ray.",
    other("fits a whole number of steps to each ray, the nearest", |it| it.fitted_steps = FittedSteps::Rounded)
        .instead_of("last_step"),
    other("fits a whole number of steps to each ray, rounded up", |it| it.fitted_steps = FittedSteps::Up)
        .instead_of("last_step"),
    other("fits a whole number of steps to each ray, rounded down", |it| it.fitted_steps = FittedSteps::Down)
        .instead_of("last_step");

    "step_opacity" = nominal_opacity: bool = either("true", "nominal") of COMPOSITED,
    "Length for which the opacity of a whole step is taken: its own (true), or that stated in the scene, whatever became of it by `step_length` or `fitted_steps` (nominal).",
    other("takes opacities for the stated step, not for the true one",
        |it| it.nominal_opacity = !it.has_stated_steps());

    "last_step" = last_step: LastStep = choice("exact") of ALL,
    "Step cut off by the back face: counted over its true length, counted as a whole step if its sample lies in front of that face, or dropped.",
    other("counts the last step of a ray as a whole one", |it| it.last_step = LastStep::Whole),
    other("drops the last step of a ray where it is not a whole one", |it| it.last_step = LastStep::Dropped);

    "last_sample" = last_sample_on_face: bool = either("step", "face") of ALL,
    "Place of the last sample of a ray: as in its other steps, or on the back face, where it is not the first one (face).",
    other("takes the last sample of a ray on the back face", |it| it.last_sample_on_face = true)
        .instead_of("last_step");

    "one_sample" = one_sample: bool = flag(false) of ALL,
    "Takes the first sample of a ray even if it lies behind the back face, where the values of the outermost nodes are continued.",
    other("takes one sample of rays that leave the volume before it, too", |it| it.one_sample = true);

    "ended_rays" = ended_rays_opaque: bool = either("left", "opaque") of COMPOSITED,
    "Transmittance of a ray that ends early: as it was (left), or 0 (opaque).",
    other("takes rays that end early for opaque", |it| it.ended_rays_opaque = true);

    "box" = voxel_box: bool = either("nodes", "voxels") of ALL,
    "Faces of the volume: on the outermost nodes; or half a spacing beyond them, where the values of the outermost nodes are continued (voxels). A volume of cells has them there.",
    other("fills half a voxel beyond the outermost nodes, too", |it| it.voxel_box = !it.cell_centred)
        .instead_of("centring");

    "centring" = cell_centred: bool = either("nodes", "cells") of ALL,
    "Place of the values: the outermost nodes lie on the faces of the volume (nodes); or the values lie at the centres of n cells that divide each side of it, n the nodes of the axis, and those of the outermost cells reach to the faces (cells), as in textures. A volume of cells stays one.",
    other("places values at the centres of cells, as in textures", |it| it.cell_centred = true).beside_others();

    "stored_values" = stored_values: StoredValues = choice("f32") of COMPOSITED,
    "Numbers in which values are stored at the nodes: floating point of 32 or 16 bits; or whole numbers of 16 or 8 bits, which stand for the range from the smallest value of the volume to the largest.",
    other("stores values in half precision", |it| it.stored_values = StoredValues::F16),
    other("stores values in 16 bits, over their range", |it| it.stored_values = StoredValues::U16),
    other("stores values in 8 bits, over their range", |it| it.stored_values = StoredValues::U8);

    "fraction_bits" = fraction_bits: Option<u32> = count(2..=16) of ALL,
    "Bits of the fractions of a voxel by which values are interpolated between nodes: 8 in the units of graphics processors that filter textures. If left out, they are not rounded.",
    other("interpolates values by fractions of 8 bits", |it| it.fraction_bits = Some(8));

    "near_plane" = near_plane: f64 = number(0.0) of ALL,
    "Near plane, as a fraction of the depth of the farthest box corner (boxes extend half a voxel beyond the nodes). Rays start there if it lies inside a volume.";

    "opacity" = linear_opacity: bool = either("exact", "linear") of COMPOSITED,
    "Opacity over a step h, stated as a over h0: 1 - (1 - a)^(h/h0), or the linear min(1, a h/h0).",
    other("takes opacity in proportion to the step", |it| it.linear_opacity = true);

    "uncorrected_opacity" = uncorrected_opacity: f64 = number(0.0) of COMPOSITED,
    "Opacities stated up to this are taken for those of a step, uncorrected.",
    other("does not correct opacities up to 0.0001 for the step", |it| it.uncorrected_opacity = 1e-4);

    "most_opacity" = most_opacity: f64 = number(1.0) of COMPOSITED,
    "Opacities stated above this count as this.",
    other("takes opacities of at most 0.998", |it| it.most_opacity = 0.998);

    "least_stated_opacity" = least_stated_opacity: f64 = number(0.0) of COMPOSITED,
    "Opacities stated below this count as 0.",
    other("drops samples of a stated opacity below 0.01", |it| it.least_stated_opacity = 0.01),
    other("drops samples of a stated opacity below 0.0001", |it| it.least_stated_opacity = 1e-4);

    "least_opacity" = least_opacity: f64 = number(0.0) of COMPOSITED,
    "Samples with an opacity below this over a whole step are dropped.",
    other("drops samples of an opacity below 0.001 over a step", |it| it.least_opacity = 0.001),
    other("drops samples of an opacity below 0.01 over a step", |it| it.least_opacity = 0.01);

    "classification" = preclassified: bool = either("post", "pre") of COMPOSITED,
    "Values are interpolated, then classified (post); or nodes are classified, and opacity and colour interpolated (pre).",
    other("classifies nodes before it interpolates", |it| it.preclassified = true),
    other("classifies nodes, and interpolates their colours without their opacities",
        |it| (it.preclassified, it.separate_colours) = (true, true));

    "node_colours" = separate_colours: bool = either("associated", "separate") of COMPOSITED,
    "Colours of classified nodes are interpolated multiplied by their opacities (associated), or as they are (separate).";

    "table_size" = table_size: Option<u32> = count(2..=65_536) of COMPOSITED,
    "Entries of the table in which opacities and colours are looked up, from the first to the last point of the transfer function; from 0 to the largest density for the formula. If left out, they are evaluated at each value.",
    other("looks colours and opacities up in a table of 256 entries, the nearest one",
        |it| (it.table_size, it.nearest_entry) = (Some(256), true)).instead_of("classification"),
    other("looks colours and opacities up in a table of 256 entries, interpolated",
        |it| (it.table_size, it.nearest_entry) = (Some(256), false)).instead_of("classification"),
    other("looks colours and opacities up in a table of 1024 entries, the nearest one",
        |it| (it.table_size, it.nearest_entry) = (Some(1024), true)).instead_of("classification"),
    other("looks colours and opacities up in a table of 64 entries, interpolated",
        |it| (it.table_size, it.nearest_entry) = (Some(64), false)).instead_of("classification");

    "table_lookup" = nearest_entry: bool = either("linear", "nearest") of COMPOSITED,
    "Between the entries of the table: linear, or the nearest entry.";

    "table_place" = texture_place: bool = either("ends", "texture") of COMPOSITED,
    "Place of a value in a table of n entries, from the share s of the range of the table that lies below it: s (n - 1), so that the outermost entries lie at both ends (ends), or s n - 1/2 as in textures, within the outermost entries (texture).",
    other("looks values up in its table as coordinates of a texture",
        |it| (*it, it.texture_place) = (it.with_table(), true));

    "texture_size" = texture_size: Option<u32> = count(2..=65_536) of COMPOSITED,
    "Entries of a texture into which the table is sampled, over the range of the densities, where opacities are corrected; values are its coordinates, and entries are interpolated. If left out, the table itself is looked up.";

    "lookup_bits" = lookup_bits: Option<u32> = count(2..=16) of COMPOSITED,
    "Bits to which colours and opacities that the table holds in `colour_bits` and `opacity_bits` are rounded once more, between entries. If left out, they are not.";

    "table_fraction_bits" = table_fraction_bits: Option<u32> = count(2..=16) of COMPOSITED,
    "Bits of the fraction by which entries of the table are interpolated. If left out, it is not rounded.";

    "opacity_correction" = corrected_entries: bool = either("samples", "entries") of COMPOSITED,
    "Opacities are corrected for the length of a step at each sample; or once, for that of the scene, in the entries of the table or at classified nodes, which are interpolated then (entries).",
    other("corrects opacities for the step in its table, before interpolation",
        |it| (*it, it.corrected_entries) = (it.with_entries(), true));

    "colour_bits" = colour_bits: Option<u32> = count(2..=16) of COMPOSITED,
    "Bits of colours in the table or at classified nodes, for [0, 1]. If left out, they are not rounded.",
    other("keeps the colours of its table in 8 bits", |it| (*it, it.colour_bits) = (it.with_entries(), Some(8)));

    "opacity_bits" = opacity_bits: Option<u32> = count(2..=16) of COMPOSITED,
    "Bits of opacities in the table or at classified nodes, after what `opacity_correction` does there. If left out, they are not rounded.",
    other("keeps the opacities of its table in 8 bits", |it| (*it, it.opacity_bits) = (it.with_entries(), Some(8)));

    "bit_rounding" = rounded_down: bool = either("nearest", "down") of COMPOSITED,
    "Rounding of colours and opacities to the bits of `colour_bits` and `opacity_bits`: to the nearest number, a half upwards, or down.",
    other(
        "rounds the colours and opacities of its table down, to 8 bits",
        |it| {
            (*it, it.rounded_down) = (it.with_entries(), true);
            (it.colour_bits, it.opacity_bits) = (Some(8), Some(8));
        },
    );

    "gradient" = gradient: Gradient = choice("central") of SHADED,
    "Gradient for shading: central, forward or backward differences or the 3 x 3 x 3 Sobel filter at the nodes, interpolated; the derivative of the trilinear interpolant; or central differences at the sample over 2 n/(n - 1) spacings, n the nodes of the axis, divided as if over two (texture): what steps of 1/(n - 1) in texture coordinates give; or differences at the sample over twice the component of the ray's step along each axis, undivided (ray-step).",
    other("takes forward differences for gradients", |it| it.gradient = Gradient::Forward),
    other("takes backward differences for gradients", |it| it.gradient = Gradient::Backward),
    other("takes gradients by Sobel's filter", |it| it.gradient = Gradient::Sobel),
    other("takes the derivative of the trilinear interpolant for the gradient",
        |it| it.gradient = Gradient::Interpolant),
    other("takes differences over n/(n - 1) spacings at the sample for the gradient",
        |it| it.gradient = Gradient::Texture),
    other("takes differences over the step of the ray for the gradient", |it| it.gradient = Gradient::RayStep)
        .beside_others();

    "normals" = normalised_at_nodes: bool = either("interpolated", "normalised") of SHADED,
    "Gradients at the nodes are interpolated as they are, or normalised before that.",
    other("normalises gradients at the nodes, before it interpolates them",
        |it| it.normalised_at_nodes = it.gradient.is_stored());

    "normal_bits" = normal_bits: Option<u32> = count(2..=16) of SHADED,
    "Bits of each component of a normal stored at the nodes, for [-1, 1]; normals are normalised at the nodes then. If left out, they are not rounded.",
    other("stores normals with 8 bits to a component", |it| it.normal_bits = it.gradient.is_stored().then_some(8))
        .instead_of("normals");

    "normal_space" = normal_space: NormalSpace = choice("world") of SHADED,
    "Space in which the gradient is normalised: the world; one in which its components are multiplied by the size of the volume along each of its axes, before a map places it (box); or one of which the matrices are multiplied in reverse order: components along the axes of the eye, right, up and backwards, mapped by the transposed map of the volume, then multiplied by its size (eye-box).",
    other("stretches normals by the proportions of the volume", |it| it.normal_space = NormalSpace::Box),
    other("stretches normals by the proportions of the volume, along the axes of the eye",
        |it| it.normal_space = NormalSpace::EyeBox);

    "shading_point" = texture_shading_point: bool = either("sample", "texture") of SHADED,
    "Point from which light and eye are seen: the sample, or (texture) the point that divides each side of the volume as the sample's texture coordinate (u + 1/2)/n divides [0, 1], u its node coordinate and n the nodes of the axis.",
    other("sees light and eye from texture coordinates, as fractions of the volume",
        |it| it.texture_shading_point = true);

    "flat_samples" = flat_samples_ambient: bool = either("unshaded", "ambient") of SHADED,
    "Samples without a gradient: their unshaded colour, or the ambient term alone.",
    other("gives samples without a gradient ambient light only", |it| it.flat_samples_ambient = true);

    "ambient_colour" = ambient_colour: LightColour = choice("material") of SHADED,
    "Colour that the weight of the ambient term applies to: that of the material, white, or black.",
    other("gives ambient light a colour of its own, white", |it| it.ambient_colour = LightColour::White),
    other("gives ambient light a colour of its own, black", |it| it.ambient_colour = LightColour::Black)
        .beside_others();

    "highlight_colour" = highlight_colour: LightColour = choice("white") of SHADED,
    "Colour that the weight of the highlight applies to.",
    other("gives highlights the colour of the material", |it| it.highlight_colour = LightColour::Material),
    other("has no highlights", |it| it.highlight_colour = LightColour::Black).beside_others();

    "highlight_emission" = highlight_emission: bool = flag(true) of COMPOSITED,
    "Multiplies the highlight by the emission of the sample, d^2 by the formula, like the rest of its colour.",
    other("leaves the emission of a sample out of its highlight", |it| it.highlight_emission = false);

    "highlight" = half_vector: bool = either("reflected", "half-vector") of SHADED,
    "Cosine of the highlight: between the reflected light and the eye (Phong), or between the normal and the half vector (Blinn).",
    other("takes highlights by the half vector (Blinn)", |it| it.half_vector = true);

    "shadow_sample" = shadow_sample: f64 = number(0.5) of COMPOSITED,
    "Position of a sample within its step on the way to the light, in steps from the point that is lit.",
    other("takes the first sample of a shadow at the point that is lit", |it| it.shadow_sample = 0.0).in_shadow(),
    other("takes the first sample of a shadow a whole step on", |it| it.shadow_sample = 1.0).in_shadow();

    "shadowed_ambient" = shadowed_ambient: bool = flag(true) of COMPOSITED,
    "Volume shadow dims the ambient term like the rest of the light.",
    other("leaves ambient light out of the shadow", |it| it.shadowed_ambient = false).in_shadow().shaded();

    "head_light" = head_light: bool = flag(false) of SHADED,
    "Puts the light for shading at the eye.",
    other("has its light at the eye", |it| it.head_light = true).beside_others();

    "parallel_light" = parallel_light: bool = flag(false) of SHADED,
    "Lets light shine in parallel, from the position of the light towards the centre of the volume.",
    other("has light that shines in parallel", |it| it.parallel_light = true).shaded();

    "two_sided" = two_sided: bool = flag(false) of SHADED,
    "Turns normals towards the light.",
    other("lights both sides of a surface", |it| it.two_sided = true);

    "normals_to_eye" = normals_to_eye: bool = flag(false) of COMPOSITED,
    "Turns normals towards the eye.",
    other("turns normals towards the eye", |it| it.normals_to_eye = true).instead_of("two_sided");

    "volume_steps" = common_steps: bool = either("own", "common") of OBJECTS,
    "Steps of several volumes: of each its own (own); or the shortest of them for all, counted from where a ray enters the box along the axes of the world around all volumes, their faces where `box` has them, and at each place a sample of every volume, one over the next in the order of the scene (common).";

    "volume_boxes" = voxel_boxes: bool = either("nodes", "voxels") of OBJECTS,
    "Faces of the volumes where there are several, sampled by common steps: as `box` has them (nodes), or half a spacing beyond the outermost nodes, as far as the box around all volumes goes (voxels).";

    "sample_behind_ends" = sample_behind_ends: bool = flag(false) of OBJECTS,
    "Takes one sample more of a ray that a surface or a clip ends within the volume: the steps go on behind that end.";

    "isosurface_place" = surfaces_at_samples: bool = either("root", "sample") of SURFACES,
    "Place of an isosurface: where the field has its value between two samples (root); or the sample behind, each of which finds one surface at most, and a further one that was passed is left to the next sample (sample).";

    "isosurface_sides" = one_sided_surfaces: bool = either("both", "one") of SURFACES,
    "Sides on which isosurfaces are lit: both, the normal turned to the eye; or the one of smaller values alone (one).";

    "mean_colours" = mean_of_range: bool = either("stated", "range") of MEAN,
    "Colours of a projection of the mean: those of the scene; or greys, from black at the smallest value of the volume to white at the largest (range).";

    "own_transmittance" = own_transmittance: bool = flag(false) of COMPOSITED,
    "Dims the colour of each sample by its own transmittance, too, as where the transmittance is updated before the colour is added.",
    other("dims each sample by its own transmittance", |it| it.own_transmittance = true).beside_others();

    "own_opacity" = own_opacity: bool = flag(false) of COMPOSITED,
    "Multiplies the colour of each sample by its own opacity once more, as where a table of colours that contain their opacity is multiplied by it again.",
    other("multiplies the colour of each sample by its opacity twice", |it| it.own_opacity = true).beside_others();

    "clamped_samples" = clamped_samples: bool = flag(false) of SHADED,
    "Clamps the radiance of each sample, shaded, to 1 before it is composited.",
    other("clamps the radiance of each sample to 1", |it| it.clamped_samples = true);

    "precision" = precision: Precision = choice("f64") of ALL,
    "Numbers that hold the composited colour and opacity of a ray: floating point of 64, 32 or 16 bits, or, for [0, 1], 15 bits, rounded up, or 8.",
    other("composites in half precision", |it| it.precision = Precision::F16),
    other("composites in fixed point of 15 bits", |it| it.precision = Precision::U15),
    other("composites in 8 bits", |it| it.precision = Precision::U8);

    "pixel" = pixel_corner: bool = either("centre", "corner") of COMPOSITED,
    "Point of a pixel that its ray passes: its centre, or its upper left corner.",
    other("casts rays through the corners of pixels", |it| it.pixel_corner = true);
}

impl Conventions {
    /// Each ray has a random number.
    pub(crate) fn is_random(&self) -> bool {
        self.has_random_place() || self.first_step_jitter
    }

    /// The place of the samples of each ray is random.
    pub(crate) fn has_random_place(&self) -> bool {
        self.jitter || self.unstated_first_sample
    }

    /// Each ray has a random number of its own, so that all together are right on average.
    pub(crate) fn is_jittered(&self) -> bool {
        self.jitter || self.first_step_jitter
    }

    /// The steps of a ray have the length of the scene.
    fn has_stated_steps(&self) -> bool {
        self.step_length == StepLength::World && self.fitted_steps == FittedSteps::None
    }

    /// The same with a table of 256 entries, if there is none.
    fn with_table(mut self) -> Conventions {
        self.table_size = self.table_size.or(Some(256));
        self
    }

    /// The same with a table, if opacities and colours are not stored at nodes.
    fn with_entries(self) -> Conventions {
        if self.preclassified {
            self
        } else {
            self.with_table()
        }
    }
}
