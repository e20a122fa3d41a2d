//! A classified volume: a scalar grid, its transfer function and the camera.

use super::SceneResult;
use super::camera;
use super::conventions::{CONVENTIONS, Conventions};
use super::files::Files;
use super::format::{Key, Kind, Range, Table};
use super::length::Length;
use super::mode::{MODE, Mode};
use super::modulation::MODULATION;
use super::objects::{CLIPS, Objects, SURFACES, Volume};
use super::reader::Reader;
use super::record::{Choice, Record};
use super::shadow::Shadow;
use super::transfer_function::TRANSFER_FUNCTION;
use super::volume::{PLACED, PLACED_RULES};
use crate::geometry::{Aabb, Camera, Surface as _, Transform, length_of};
use crate::optics::{Appearance, Phong, TransferFunction};
use crate::volume::{
    Grid, Interpolation, PlacedBox, cell_edges, placed_gradients, relative_gradients, voxel,
};
use glam::DVec3;
use std::sync::Arc;

/// The declaration of `[classified]`.
pub(super) const CLASSIFIED: Table = Table::new("A scalar volume whose densities are mapped to colour and opacity and composited along the ray.").with(&[&MODE]).keys(&[
    Key::required("volume", Kind::OneOrMore(&VOLUME))
        .doc("The densities; in double brackets those of several volumes, at most 64, each with a look of its own."),
    Key::or("interpolation", Kind::Choice(Interpolation::WORDS), "'trilinear'")
        .doc("Interpolation of densities and gradients between nodes."),
    Key::or("compositing", Kind::Choice(&["front-to-back", "back-to-front", CONTINUOUS]), "'front-to-back'")
        .doc("Order in which the samples of a ray are composited; both give the same image up to rounding. Or `continuous`: the integral that they approximate, to a bound, without samples; `step` is then the one that other renderers begin with."),
    Key::optional("early_termination", Kind::Number(Range::open(0.0, 1.0)))
        .doc("Ends a ray where its transmittance falls below this value: less work, and pixels that are off by less than this fraction of the brightest radiance. With `compositing = \"front-to-back\"` only. If left out, no ray is ended early."),
    Key::or("step", Kind::Length, "'0.5 voxels'")
        .doc("Distance between samples along a ray, world units or voxels."),
    Key::or("background", Kind::Colour(Range::NOT_NEGATIVE), "[0.0, 0.0, 0.0]")
        .doc("Linear radiance behind the volume."),
    Key::optional("light", Kind::Table(&LIGHT))
        .doc("The white point light, without fall-off; used by shading and shadow."),
    Key::optional("phong", Kind::Table(&Phong::TABLE))
        .doc("Shades samples by their gradient. If left out, colours stay unshaded and no gradient is computed."),
    Key::optional("shadow", Kind::Table(&SHADOW))
        .doc("Darkens each sample by the densities between it and the light. If left out, no shadow ray is traced."),
    SURFACES,
    CLIPS,
    Key::optional("conventions", Kind::Table(&CONVENTIONS))
        .doc("Conventions of another renderer, in place of volref's."),
]);

/// A volume, its place, and what is its own where there are several.
const VOLUME: Table =
    Table::new("The file a grid of densities comes from, or the formula of its values.")
        .with(&PLACED)
        .keys(&[
        Key::optional("name", Kind::Text).doc("Name of the volume, for clips."),
        Key::optional("transfer_function", Kind::Table(&TRANSFER_FUNCTION))
            .doc("Colour and opacity by density of this volume, in place of the scene's."),
        Key::optional("step", Kind::Length)
            .doc("Distance between samples of this volume, in place of the scene's: world units or voxels of its own."),
        Key::optional("phong", Kind::Table(&Phong::TABLE))
            .doc("Shading of this volume, in place of the scene's."),
        Key::optional("modulation", Kind::Table(&MODULATION))
            .doc("Factors of opacities by a second number at each place."),
    ])
        .rules(&PLACED_RULES);

/// The choice of `compositing` without samples.
const CONTINUOUS: &str = "continuous";

const LIGHT: Table = Table::new("A white point light without fall-off.").keys(&[Key::derived(
    "position",
    Kind::Vector,
    "above the eye (image-up), at a height equal to the distance from eye to target",
)
.doc("Position of the light, world units.")]);

record! {
    impl Phong in "Phong's reflection model; the normal is minus the density gradient." {
        ambient = or("0.1") Number(Range::NOT_NEGATIVE), "Weight of the ambient term, the same on every side.";
        diffuse = or("1.0") Number(Range::NOT_NEGATIVE), "Weight of the cosine between normal and light.";
        specular = or("1.0") Number(Range::NOT_NEGATIVE), "Weight of the white highlight.";
        shininess = or("32") Count(1, 1 << 20), "Exponent of the highlight, a whole number.";
    }
}

const SHADOW: Table = Table::new("Volume shadow: radiance times exp(−S/100), S the integral of density over reference steps towards the light; with a table of points, times what the opacities on the way let through.").keys(&[
    Key::or("step", Kind::Length, "'1 voxel'")
        .doc("Distance between samples along a shadow ray, world units or voxels."),
    Key::derived("reference_step", Kind::Length, "with a table of points its reference length; else required")
        .doc("Path length over which a density of 1 adds 1 to the shadow sum S (with a table of points: over which its opacities apply), world units or voxels; smaller is darker."),
]);

/// The order in which the samples of a ray are composited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compositing {
    /// From the eye into the volume.
    FrontToBack,
    /// From the eye into the volume, until the transmittance falls below this value in (0, 1).
    EarlyTermination(f64),
    /// Towards the eye.
    BackToFront,
}

/// A classified volume and the view of it, all lengths in world units.
#[derive(Clone, Debug)]
pub struct Classified {
    /// Values of the field: finite, and not negative where the formula maps them.
    pub grid: Arc<Grid<f32>>,
    /// The map of the grid into the world; none where they are the same, to the bit.
    pub to_world: Option<Transform>,
    /// Content of a pixel.
    pub mode: Mode,
    /// Reconstruction between the nodes.
    pub interpolation: Interpolation,
    /// The image is the integral itself, without samples.
    pub continuous: bool,
    /// Order of the samples, if there are any.
    pub compositing: Compositing,
    /// Distance between samples along a ray, > 0; of an integral that which other renderers begin
    /// with.
    pub step: f64,
    /// Colour and opacity by value.
    pub transfer_function: TransferFunction,
    /// Shading by gradient, if asked for.
    pub phong: Option<Phong>,
    /// Volume shadow, if asked for.
    pub shadow: Option<Shadow>,
    /// Position of the light.
    pub light: DVec3,
    /// Radiance behind the volume.
    pub background: DVec3,
    /// The eye.
    pub camera: Camera,
    /// Choices in which ray casters differ without being wrong.
    pub conventions: Conventions,
    /// Further volumes, surfaces and clips; the fields above are those of the first volume.
    pub objects: Objects,
}

/// A volume of the file: its table, its name, itself, and the box around it. Step, shading and shadow are read after
/// the tables of all volumes.
pub(super) struct VolumeTable<'r, 'd, 's> {
    pub reader: &'r Reader<'d, 's>,
    pub name: Option<String>,
    pub volume: Volume,
    pub bounds: Aabb,
}

/// More samples on one ray than this are a mistake in the scene, not a wish.
const MOST_SAMPLES_PER_RAY: f64 = 1e8;

/// With a shadow ray from each sample: more samples than this, minutes for each pixel.
const MOST_SAMPLES_WITH_SHADOW: f64 = 1e10;

impl Classified {
    /// Reads `[classified]` and `[camera]`; `size` is that of the image.
    pub(super) fn read(
        reader: &Reader,
        camera_reader: &Reader,
        mut volumes: Vec<VolumeTable>,
        files: &mut Files,
        size: [usize; 2],
    ) -> SceneResult<Classified> {
        let interpolation = reader.get("interpolation")?;
        let order: String = reader.get("compositing")?;
        let mode = Mode::read(reader, &order)?;
        let continuous = order == CONTINUOUS;
        if continuous {
            without_samples(reader, &mode, interpolation)?;
        }
        let compositing = read_compositing(reader, &order)?;
        let step = reader.get("step")?;
        for it in &mut volumes {
            let own: Option<Length> = it.reader.get("step")?;
            let place = own.map_or(reader, |_| it.reader);
            let step = checked_step(own.unwrap_or(step), it.lengths());
            it.volume.step = place.accepted_at("step", step)?;
        }
        let background = reader.get("background")?;

        let names: Vec<Option<String>> = volumes.iter().map(|it| it.name.clone()).collect();
        let mut objects = Objects::read(reader, files, &names)?;
        let surfaces = objects.surfaces.iter().map(|it| it.shape.bounds());
        let boxes = volumes.iter().map(|it| it.bounds);
        let bounds = boxes.chain(surfaces).reduce(Aabb::union).expect("a volume");
        let (camera, target) = camera::framing(camera_reader, &bounds, size)?;
        let light = reader.table_or_default("light")?;
        let light = light.vector_or("position", || above(&camera, target))?;

        let phong = reader.table_as("phong", Phong::read)?;
        for surface in &mut objects.surfaces {
            surface.phong = phong;
        }
        for it in &mut volumes {
            it.volume.phong = it.reader.table_as("phong", Phong::read)?.or(phong);
        }
        reader.table_as("shadow", |reader| read_shadows(reader, &mut volumes))?;
        let conventions = reader.table_as("conventions", Conventions::read)?;
        let conventions = conventions.unwrap_or_default().of_mode(&mode);
        let mut volumes = volumes.into_iter().map(|it| it.volume);
        let first = volumes.next().expect("a volume");
        objects.modulation = first.modulation;
        objects.volumes = volumes.collect();
        let scene = Classified {
            grid: first.grid,
            to_world: first.to_world,
            mode,
            interpolation,
            continuous,
            compositing,
            step: first.step,
            transfer_function: first.transfer_function,
            phong: first.phong,
            shadow: first.shadow,
            light,
            background,
            camera,
            conventions,
            objects,
        };
        let checked = scene.check_eye();
        checked.map_err(|message| camera_reader.error("eye", message))?;
        let checked = scene.check_shadow_samples();
        checked.map_err(|message| reader.error("shadow", message))?;
        scene.check_objects(reader)?;
        Ok(scene)
    }

    /// Ends rays where the transmittance falls below `threshold`, in (0, 1), and so goes front to
    /// back; back to front is the same image.
    pub fn end_rays_at(&mut self, threshold: f64) {
        self.sample();
        self.compositing = Compositing::EarlyTermination(threshold);
    }

    /// An upper bound on the radiance of all samples, surfaces and the background.
    ///
    /// A pixel is an average of what its samples emit and of the background. A sample sends
    /// out at most the brightest colour as shading makes it, times the strength of the densest
    /// voxel; one that is transparent emits nothing.
    pub fn brightest(&self) -> f64 {
        if self.has_objects() {
            let surfaces = self.objects.surfaces.iter();
            let surfaces = surfaces.map(|it| brightest_shaded(it.colour.max_element(), it.phong));
            let volumes = self.each_alone().map(|alone| alone.brightest());
            return volumes.chain(surfaces).fold(0.0, f64::max);
        }
        let (least, most) = self.grid.range();
        let colour = self.mode.brightest_colour(&self.transfer_function);
        let shaded = brightest_shaded(colour, self.phong);
        let sent = if self.mode != Mode::Composited {
            shaded
        } else if self.transfer_function.is_transparent_between(least, most) {
            0.0
        } else {
            self.transfer_function.emission(most) * shaded
        };
        sent.max(self.background.max_element())
    }

    /// True if projections and isosurfaces are exact, not sampled. Mistakes in them are made by samples.
    pub(crate) fn is_exact(&self) -> bool {
        self.continuous && !self.mode.has_fault()
    }

    /// The box of the volume, wherever it is in the world.
    pub fn extent(&self) -> PlacedBox {
        PlacedBox {
            bounds: self.grid.lattice().bounds(),
            to_world: self.to_world,
        }
    }

    /// Length of the diagonal of the box of the world around the volume.
    pub fn diagonal(&self) -> f64 {
        length_of(self.extent().world_bounds().size())
    }

    /// Edges of a cell in the world.
    pub fn cell_edges(&self) -> [DVec3; 3] {
        cell_edges(self.grid.lattice(), self.to_world.as_ref())
    }

    /// The length called *one voxel*: that of the shortest edge of a cell in the world.
    pub fn voxel(&self) -> f64 {
        voxel(self.grid.lattice(), self.to_world.as_ref())
    }

    /// Gradients of the world at the nodes, for shading: in any unit.
    pub fn gradients(&self) -> Grid<[f32; 3]> {
        match &self.to_world {
            None => relative_gradients(&*self.grid),
            Some(to_world) => placed_gradients(&*self.grid, to_world),
        }
    }

    /// Replaces an integral by samples, [`Classified::step`] apart, front to back.
    pub fn sample(&mut self) {
        self.continuous = false;
    }

    /// Replaces the distance between samples, of each volume; a length in voxels is by the voxels of each. Fails if
    /// rays would have too many samples.
    pub fn set_step(&mut self, step: Length) -> Result<(), String> {
        let mut changed = self.clone();
        for index in 0..self.volume_count() {
            let mut alone = self.alone(index);
            alone.step = checked_step(step, [alone.voxel(), alone.diagonal()])?;
            changed.put(index, alone);
        }
        changed.check_samples()?;
        *self = changed;
        Ok(())
    }

    /// Fails if rays would have too many samples, or none that can be told apart.
    pub(crate) fn check_samples(&self) -> Result<(), String> {
        for alone in self.each_alone().filter(|alone| !alone.continuous) {
            checked_step(Length::World(alone.step), [1.0, alone.diagonal()])?;
        }
        self.check_eye()?;
        self.check_shadow_samples()?;
        self.check_common_steps()
    }

    /// Fails if the eye is so far away that distances along a ray are rounded by more than a step. The length of the way
    /// through the volume is then all rounding: samples cannot be told apart, and their number has no bound.
    fn check_eye(&self) -> Result<(), String> {
        if self.has_objects() {
            return self.each_alone().try_for_each(|alone| alone.check_eye());
        }
        let bounds = self.extent().world_bounds();
        let to_centre = length_of(self.camera.eye - bounds.centre());
        let beside = self.camera.orthographic_height().unwrap_or(0.0);
        let farthest = to_centre + length_of(bounds.size()) + beside;
        // A distance beyond all numbers is no number times anything.
        if farthest.is_finite() && farthest * f64::EPSILON <= self.step {
            return Ok(());
        }
        let step = self.step;
        Err(format!(
            "the eye is {farthest:.3e} world units away, where distances are rounded by more than a step of {step:e}"
        ))
    }

    /// Each of the steps is accepted by itself; both together may still ask for more than anyone
    /// waits for.
    fn check_shadow_samples(&self) -> Result<(), String> {
        let Some(shadow) = self.shadow else {
            return Ok(());
        };
        let most = |length: f64, step: f64| (length / step).max(1.0);
        let (mut samples, mut of_shadow) = (0.0, 0.0);
        for alone in self.each_alone() {
            let diagonal = alone.diagonal();
            samples += most(diagonal, alone.step);
            of_shadow += most(diagonal, alone.shadow.unwrap_or(shadow).step);
        }
        let samples = samples * of_shadow;
        if samples <= MOST_SAMPLES_WITH_SHADOW {
            return Ok(());
        }
        Err(format!(
            "steps of {:e} world units, with shadow steps of {:e}, mean up to {samples:.1e} samples on a ray; at most \
             {MOST_SAMPLES_WITH_SHADOW:.0e} are accepted",
            self.step, shadow.step
        ))
    }
}

/// An upper bound on `colour` as shading makes it.
fn brightest_shaded(colour: f64, phong: Option<Phong>) -> f64 {
    // Without a gradient the colour stays as it is.
    phong.map_or(colour, |phong| {
        let lit = phong.ambient + phong.diffuse;
        // Black under a weight beyond all numbers would be NaN.
        if lit.is_finite() {
            (colour * lit + phong.specular).max(colour)
        } else {
            f64::INFINITY
        }
    })
}

/// Refuses keys that mean nothing to the integral, or that it does not cover.
fn without_samples(reader: &Reader, mode: &Mode, interpolation: Interpolation) -> SceneResult<()> {
    let key = "leave the key out";
    let composite = "leave the table out, or composite samples front to back";
    let with = |message: &str| format!("with `compositing = \"continuous\"` {message}");
    // The mode has refused its other keys.
    let composited = *mode == Mode::Composited;
    refuse! { reader:
        "early_termination" if composited, with("no ray is ended early"), key;
        "conventions", with("there are no samples that could follow conventions"), composite;
        "phong" if composited, with("light depends on the value alone: nothing is shaded"), composite;
        "shadow" if composited, with("light depends on the value alone: nothing is in shadow"), composite;
        "interpolation" if interpolation == Interpolation::Nearest, with("the field is trilinear"), key;
    }
    Ok(())
}

/// The place above the eye, upwards in the image, as high as `target` is far. Seen from the target, it lies half a right
/// angle beside the eye and is √2 times as far away: it is outside of every ball about the target that the eye is outside
/// of. `up` itself may lean along the line of sight, and would lead into the volume.
fn above(camera: &Camera, target: DVec3) -> DVec3 {
    camera.eye + camera.upright * length_of(target - camera.eye)
}

/// The step in world units, given those of a voxel and of the diagonal of the volume.
pub(super) fn checked_step(step: Length, [voxel, diagonal]: [f64; 2]) -> Result<f64, String> {
    let length = step.in_world_units(voxel)?;
    if diagonal / length > MOST_SAMPLES_PER_RAY {
        return Err(format!(
            "a step of {length:e} world units means up to {:.1e} samples on a ray; at most {MOST_SAMPLES_PER_RAY:.0e} \
             are accepted",
            diagonal / length
        ));
    }
    Ok(length)
}

/// The order of compositing named `order`, and its early termination.
fn read_compositing(reader: &Reader, order: &str) -> SceneResult<Compositing> {
    let early = reader.get("early_termination")?;
    refuse! { reader:
        "early_termination" if order == "back-to-front",
            "back to front, a ray cannot be ended early: the sample nearest to the eye comes last";
    }
    Ok(match (early, order) {
        (Some(below), _) => Compositing::EarlyTermination(below),
        (None, "back-to-front") => Compositing::BackToFront,
        (None, _) => Compositing::FrontToBack,
    })
}

impl VolumeTable<'_, '_, '_> {
    /// Edge of a voxel, and diagonal of the box of the world: the lengths that steps are measured by.
    fn lengths(&self) -> [f64; 2] {
        let Volume { grid, to_world, .. } = &self.volume;
        let voxel = voxel(grid.lattice(), to_world.as_ref());
        [voxel, length_of(self.bounds.size())]
    }
}

/// Reads the shadow of each volume, whose lengths in voxels are its own.
fn read_shadows(reader: &Reader, volumes: &mut [VolumeTable]) -> SceneResult<()> {
    let given: Option<Length> = reader.get("reference_step")?;
    let step = reader.get("step")?;
    let mut texts = Vec::new();
    for it in volumes {
        let look = &it.volume.transfer_function;
        let reference_step = match (given, &look.appearance) {
            (Some(length), _) => {
                reader.accepted_at("reference_step", length.in_world_units(it.lengths()[0]))?
            }
            (None, Appearance::Points(_)) => look.reference_length,
            (None, Appearance::Formula { .. }) => {
                let message = "missing key `reference_step` in [classified.shadow]";
                return Err(reader.error("reference_step", message));
            }
        };
        texts.push(reference_step.to_string());
        it.volume.shadow = Some(Shadow {
            step: reader.accepted_at("step", checked_step(step, it.lengths()))?,
            reference_step,
        });
    }
    if texts.iter().any(|text| *text != texts[0]) {
        texts = vec![texts.join(", ") + ", volume by volume"];
    }
    // A file that gives it keeps its own.
    reader.resolved("reference_step", &texts[0]);
    Ok(())
}
