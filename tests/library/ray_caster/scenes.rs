//! Scenes without files: random grids, cameras and settings.

use crate::common::vector;
use glam::DVec3;
use proptest::prelude::*;
use std::sync::Arc;
use volref::film::Film;
use volref::geometry::{Camera, Ray};
use volref::math;
use volref::optics::Layer;
use volref::optics::{Appearance, Colormap, Phong, TransferFunction, TransferOpacity};
use volref::render::classified::ray_caster::RayCaster;
use volref::render::{Counters, Plan, Sampling, render};
use volref::scene::{Classified, Compositing, Conventions, Mode, Objects, Panel, Shadow};
use volref::volume::{Grid, Interpolation, Lattice};

/// `2^exponent`, exactly.
pub fn power_of_two(exponent: i32) -> f64 {
    let power = math::powu(2.0, exponent.unsigned_abs());
    if exponent < 0 { 1.0 / power } else { power }
}

/// A grid of the values of `field`, which is given node indices.
pub fn sampled(lattice: Lattice, field: impl Fn([usize; 3]) -> f32) -> Arc<Grid<f32>> {
    let nodes = (0..lattice.node_count()).map(|index| lattice.node(index));
    Arc::new(Grid::new(lattice, nodes.map(field).collect()).unwrap())
}

/// A number in [0, 1) that depends on every bit of its arguments.
/// Source: the finaliser of SplitMix64 (Steele, Lea & Flood 2014).
pub fn hash(seed: u64, index: usize) -> f64 {
    let mut bits = seed ^ (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0
}

/// A lattice with axes of one node and of many, and different spacings.
pub fn lattice(most_nodes: usize) -> impl Strategy<Value = Lattice> {
    let nodes = prop::array::uniform3(prop_oneof![1 => 1..=2_usize, 4 => 3..=most_nodes]);
    (nodes, vector(0.1..3.0), vector(-10.0..10.0))
        .prop_map(|(nodes, spacing, first)| Lattice::new(nodes, spacing, first).unwrap())
}

/// A grid in which the given share of nodes, more or less, holds anything.
pub fn sparse_grid(lattice: Lattice, seed: u64, share: f64) -> Arc<Grid<f32>> {
    sampled(lattice, |node| {
        let index = lattice.index(node);
        let filled = hash(seed, 2 * index) < share;
        if filled {
            (1.3 * hash(seed, 2 * index + 1)) as f32
        } else {
            0.0
        }
    })
}

fn share() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.002), Just(0.05), Just(0.6), Just(1.0)]
}

/// The formula of the ray-casting assignment.
pub fn formula(floor: f64, colormap: &str) -> Appearance {
    Appearance::Formula {
        opacity: TransferOpacity { floor },
        colormap: Colormap::named(colormap).unwrap(),
        range: None,
    }
}

/// A scene of `grid` with every effect off, seen from the front.
pub fn plain(grid: Arc<Grid<f32>>) -> Classified {
    let lattice = *grid.lattice();
    let (size, centre) = (lattice.bounds().size(), lattice.bounds().centre());
    let eye = centre - DVec3::Z * (2.5 * size.max_element());
    Classified {
        grid,
        to_world: None,
        mode: Mode::Composited,
        interpolation: Interpolation::Trilinear,
        continuous: false,
        compositing: Compositing::FrontToBack,
        step: 0.5 * lattice.voxel(),
        transfer_function: TransferFunction {
            appearance: formula(0.36, "heat"),
            reference_length: lattice.voxel(),
        },
        phong: None,
        shadow: None,
        light: eye + DVec3::Y * size.max_element(),
        background: DVec3::ZERO,
        camera: Camera::new(eye, centre, DVec3::Y, 0.8).unwrap(),
        conventions: Conventions::default(),
        objects: Objects::default(),
    }
}

pub const PHONG: Phong = Phong {
    ambient: 0.1,
    diffuse: 1.0,
    specular: 1.0,
    shininess: 32,
};

/// Shading off, ordinary, or of weights among which are those that leave colours as they are.
fn phong() -> impl Strategy<Value = Option<Phong>> {
    let weight = prop_oneof![Just(0.0), Just(1.0)];
    let weights = prop::array::uniform3(weight).prop_map(|[ambient, diffuse, specular]| Phong {
        ambient,
        diffuse,
        specular,
        shininess: 3,
    });
    let identity = Phong {
        ambient: 1.0,
        diffuse: 0.0,
        specular: 0.0,
        shininess: 32,
    };
    prop_oneof![
        2 => Just(None),
        2 => Just(Some(PHONG)),
        2 => weights.prop_map(Some),
        1 => Just(Some(identity)),
    ]
}

/// Everything but the grid. Lengths are in voxels, places in sizes of the volume.
#[derive(Clone, Debug)]
pub struct Settings {
    interpolation: Interpolation,
    compositing: Compositing,
    step: f64,
    reference_length: f64,
    phong: Option<Phong>,
    shadow: Option<(f64, f64)>,
    light: DVec3,
    background: f64,
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    vertical_fov: f64,
}

/// A length in voxels, from `least` on, each octave as likely as the next.
fn voxels(least: f64, most: f64) -> impl Strategy<Value = f64> {
    (math::ln(least)..math::ln(most)).prop_map(math::exp)
}

pub fn settings() -> impl Strategy<Value = Settings> {
    let shadow = prop::option::of((voxels(0.2, 40.0), voxels(0.01, 1.0)));
    let lengths = (voxels(0.1, 100.0), voxels(0.2, 5.0), shadow);
    let camera = (
        vector(-2.0..2.0),
        vector(-0.4..0.4),
        vector(-1.0..1.0),
        0.2..2.5_f64,
    );
    let choices = (any::<bool>(), any::<bool>(), phong(), 0.0..2.0_f64);
    (choices, lengths, camera, vector(-2.0..2.0)).prop_map(|(choices, lengths, camera, light)| {
        let (nearest, back_to_front, phong, background) = choices;
        let (step, reference_length, shadow) = lengths;
        let (eye, target, up, vertical_fov) = camera;
        Settings {
            interpolation: if nearest {
                Interpolation::Nearest
            } else {
                Interpolation::Trilinear
            },
            compositing: if back_to_front {
                Compositing::BackToFront
            } else {
                Compositing::FrontToBack
            },
            step,
            reference_length,
            phong,
            shadow,
            light,
            background,
            eye,
            target,
            up,
            vertical_fov,
        }
    })
}

impl Settings {
    /// The scene of `grid` with these settings.
    pub fn scene(&self, grid: Arc<Grid<f32>>) -> Classified {
        let lattice = *grid.lattice();
        let voxel = lattice.voxel();
        let bounds = lattice.bounds();
        let place = |relative: DVec3| bounds.centre() + relative * bounds.size();
        let mut scene = plain(grid);
        scene.interpolation = self.interpolation;
        scene.compositing = self.compositing;
        scene.step = self.step * voxel;
        scene.transfer_function.reference_length = self.reference_length * voxel;
        scene.phong = self.phong;
        scene.shadow = self.shadow.map(|(step, reference)| Shadow {
            step: step * voxel,
            reference_step: reference * voxel,
        });
        scene.light = place(self.light);
        scene.background = DVec3::new(self.background, 0.5, 0.0);
        let (eye, target) = (place(self.eye), place(self.target));
        // Where these make no camera, the one from the front will do.
        if let Ok(camera) = Camera::new(eye, target, self.up, self.vertical_fov) {
            scene.camera = camera;
        }
        scene
    }
}

/// Any scene: grids from nearly empty to full, axes of one node, eye and light in- and outside.
pub fn any_scene(most_nodes: usize) -> impl Strategy<Value = Classified> {
    (lattice(most_nodes), any::<u64>(), share(), settings()).prop_map(
        |(lattice, seed, share, settings)| settings.scene(sparse_grid(lattice, seed, share)),
    )
}

pub fn panel(scene: &Classified, size: usize) -> Panel {
    Panel::of(scene.clone().into(), [size; 2])
}

/// The image by `plan`, and the work done.
pub fn render_by(plan: Plan<'_>) -> (Film, Counters) {
    let rendering = render(&[plan], Sampling::default(), &|| ()).unwrap();
    (rendering.film, rendering.work[0])
}

/// The image of `scene` by its own plan.
pub fn rendered(scene: &Classified, size: usize) -> (Film, Counters) {
    render_by(Plan::new(&panel(scene, size)))
}

/// The bits of every pixel.
pub fn bits(film: &Film) -> Vec<[u32; 4]> {
    let opacity = film.opacity().unwrap();
    let pixels = film.radiance().iter().zip(opacity);
    pixels
        .map(|(&[r, g, b], &a)| [r, g, b, a].map(f32::to_bits))
        .collect()
}

/// The rays of an image of `size` × `size` pixels.
pub fn rays(scene: &Classified, size: usize) -> Vec<Ray> {
    let pixels = (0..size * size).map(|index| [index % size, index / size]);
    pixels
        .map(|pixel| scene.camera.ray(pixel, [size, size]))
        .collect()
}

/// What `rays` see in full precision, without leaps over empty space.
pub fn layers(scene: &Classified, rays: &[Ray]) -> Vec<Layer> {
    let caster = RayCaster::plain(scene);
    let mut work = Counters::default();
    let layers = rays.iter().map(|ray| caster.layers(ray, &mut work));
    layers.collect()
}
