//! Turning or mirroring scene, camera and light together turns or mirrors the image.

use super::{U, config, scenes};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::{Aabb, Camera, Ray};
use volref::optics::{Appearance, Phong};
use volref::render::classified::compositing::Layers;
use volref::scene::{Classified, Shadow};
use volref::volume::{Grid, Lattice, relative_gradients};

/// A symmetry of the cube: axis `i` of an image is axis `from[i]` of what it is the image of,
/// turned round where `sign[i]` is −1.
#[derive(Clone, Copy, Debug)]
struct Symmetry {
    from: [usize; 3],
    sign: [f64; 3],
}

impl Symmetry {
    /// A quarter turn about `axis`.
    fn turn(axis: usize) -> Symmetry {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut turn = Symmetry {
            from: [0, 1, 2],
            sign: [1.0; 3],
        };
        (turn.from[b], turn.sign[b]) = (c, -1.0);
        turn.from[c] = b;
        turn
    }

    fn mirrors(self) -> bool {
        let [a, b, c] = self.from;
        let even = (b + 3 - a) % 3 == 1 && (c + 3 - b) % 3 == 1;
        let sign: f64 = self.sign.iter().product();
        (sign > 0.0) != even
    }

    fn of_vector(self, v: DVec3) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|i| self.sign[i] * v[self.from[i]]))
    }

    fn of_grid(self, grid: &Grid<f32>) -> std::sync::Arc<Grid<f32>> {
        let old = *grid.lattice();
        let last = old.position(old.nodes().map(|n| n - 1));
        let corner = |i: usize| {
            let axis = self.from[i];
            if self.sign[i] > 0.0 {
                old.first()[axis]
            } else {
                -last[axis]
            }
        };
        let lattice = Lattice::new(
            self.from.map(|axis| old.nodes()[axis]),
            DVec3::from_array(self.from.map(|axis| old.spacing()[axis])),
            DVec3::from_array(std::array::from_fn(corner)),
        );
        scenes::sampled(lattice.unwrap(), |node| {
            let mut original = [0; 3];
            for (i, &axis) in self.from.iter().enumerate() {
                let end = old.nodes()[axis] - 1;
                original[axis] = if self.sign[i] > 0.0 {
                    node[i]
                } else {
                    end - node[i]
                };
            }
            grid.values()[old.index(original)]
        })
    }
}

fn symmetry() -> impl Strategy<Value = Symmetry> {
    let sign = prop_oneof![Just(1.0), Just(-1.0)];
    (Just([0, 1, 2]).prop_shuffle(), prop::array::uniform3(sign))
        .prop_map(|(from, sign)| Symmetry { from, sign })
}

/// What lights the samples.
#[derive(Clone, Copy, Debug)]
pub enum Lighting {
    None,
    /// By a light outside, without highlights: these begin with a jump where light comes from
    /// the side.
    Shading,
    /// Of a light inside, where every shadow ray ends at the light. Rays that graze a face on
    /// their way out end anywhere, and have no bound.
    Shadow,
}

/// A scene whose image depends smoothly on where things are: densities in [0.02, 0.6] that rise
/// along every axis, so that gradients keep away from 0. Places are multiples of 1/64.
#[derive(Clone, Debug)]
pub struct Setup {
    grid: std::sync::Arc<Grid<f32>>,
    step: f64,
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    light_outside: DVec3,
    light_inside: DVec3,
    vertical_fov: f64,
    pub size: usize,
}

/// Largest difference between two images of a [`Setup`].
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    pub colour: f64,
    pub opacity: f64,
}

fn in_64ths(v: DVec3) -> DVec3 {
    (v * 64.0).round() / 64.0
}

pub fn setup() -> impl Strategy<Value = Setup> {
    let eighths = |range: std::ops::Range<i32>| {
        prop::array::uniform3(range).prop_map(|n| DVec3::from_array(n.map(|n| f64::from(n) / 8.0)))
    };
    let lattice = (
        prop::array::uniform3(3..8_usize),
        eighths(2..16),
        eighths(-40..40),
    )
        .prop_map(|(nodes, spacing, first)| Lattice::new(nodes, spacing, first).unwrap());
    let inside = || prop::array::uniform3(0.2..0.8_f64).prop_map(DVec3::from_array);
    let directions = (
        scenes::vector(-1.0..1.0),
        scenes::vector(-1.0..1.0),
        0.2..1.0_f64,
    );
    (
        lattice,
        any::<u64>(),
        0.2..3.0_f64,
        (inside(), inside()),
        directions,
    )
        .prop_filter("the eye is outside, up points up", |(.., (back, up, _))| {
            back.length() > 0.1 && up.length() > 0.1 && back.angle_between(*up).sin_at_least_half()
        })
        .prop_map(
            |(lattice, seed, step, (target, light), (back, up, vertical_fov))| {
                let bounds = lattice.bounds();
                let (size, diagonal) = (bounds.size(), bounds.size().length());
                let last = DVec3::from_array(lattice.nodes().map(|n| (n - 1) as f64));
                let grid = scenes::sampled(lattice, |node| {
                    let place = DVec3::from_array(node.map(|n| n as f64)) / last;
                    // Along the longest axis 0.18 / 7 from node to node, and noise of 0.01.
                    let noise = 0.01 * scenes::hash(seed, lattice.index(node));
                    (0.02 + 0.18 * place.dot(DVec3::ONE) + noise) as f32
                });
                Setup {
                    grid,
                    step: step * lattice.voxel(),
                    eye: in_64ths(bounds.centre() + back.normalize() * (1.5 * diagonal)),
                    target: in_64ths(bounds.min + target * size),
                    up: in_64ths(up),
                    light_outside: in_64ths(bounds.centre() + up.normalize() * (2.0 * diagonal)),
                    light_inside: in_64ths(bounds.min + light * size),
                    vertical_fov,
                    size: 4,
                }
            },
        )
}

/// Whether two directions enclose neither a small angle nor nearly a half turn.
trait Apart {
    fn sin_at_least_half(self) -> bool;
}

impl Apart for f64 {
    fn sin_at_least_half(self) -> bool {
        // sin 0.6 = 0.564; the rounding to 64ths turns vectors by less than what is left.
        (0.6..std::f64::consts::PI - 0.6).contains(&self)
    }
}

impl Setup {
    /// The scene, moved by `offset`.
    pub fn scene(&self, lighting: Lighting, offset: DVec3) -> Classified {
        let lattice = *self.grid.lattice();
        let moved = Lattice::new(lattice.nodes(), lattice.spacing(), lattice.first() + offset);
        let grid = Grid::new(moved.unwrap(), self.grid.values().to_vec()).unwrap();
        let mut scene = scenes::plain(grid.into());
        scene.step = self.step;
        scene.light = offset + self.light_outside;
        match lighting {
            Lighting::None => {}
            Lighting::Shading => {
                scene.phong = Some(Phong {
                    specular: 0.0,
                    ..scenes::PHONG
                })
            }
            Lighting::Shadow => {
                scene.light = offset + self.light_inside;
                let voxel = lattice.voxel();
                scene.shadow = Some(Shadow {
                    step: voxel,
                    reference_step: 0.02 * voxel,
                });
            }
        }
        let (eye, target) = (offset + self.eye, offset + self.target);
        scene.camera = Camera::new(eye, target, self.up, self.vertical_fov).unwrap();
        scene
    }

    /// What its pixels see.
    pub fn layers(&self, lighting: Lighting, offset: DVec3) -> Vec<Layers> {
        let scene = self.scene(lighting, offset);
        scenes::layers(&scene, &scenes::rays(&scene, self.size))
    }

    /// How far the pixel behind `ray` can be from the same pixel of a scene that differs only
    /// by symmetry. `None` for rays almost parallel to a face or touching an edge, on which
    /// rounding decides whether and where they enter.
    ///
    /// In terms of first order; the last factor covers the products of errors.
    pub fn bound(&self, scene: &Classified, ray: &Ray) -> Option<Bound> {
        let lattice = scene.grid.lattice();
        let bounds = lattice.bounds();
        let slant = 1.0 / ray.direction.abs().min_element();
        let margin = 1e-6 * bounds.size();
        let around = Aabb {
            min: bounds.min - margin,
            max: bounds.max + margin,
        };
        let nothing = Bound {
            colour: 0.0,
            opacity: 0.0,
        };
        let span = match (bounds.span(ray), around.span(ray)) {
            (_, None) => return Some(nothing),
            (Some(span), _) if slant <= 1e4 && span.length() >= margin.length() => span,
            // Along a face, where boxes are half open and mirrored ones are not; or past an edge.
            _ => return None,
        };
        let voxel = lattice.voxel();
        let far = span.far;
        let extent = [bounds.min, bounds.max, ray.origin, scene.light]
            .into_iter()
            .fold(0.0_f64, |m, v| m.max(v.abs().max_element()));

        // The ray. Differences of places and products are turned exactly; sums of three terms
        // round in another order. Directions of length one: 4u. The cross product of two, over
        // the sine (at least ½) of their angle: 2·16u + 4u; crossed again: 43u. An image plane
        // of half height below 0.55 adds 0.55·(36 + 43)u to 4u; length one again doubles it.
        let turn = 128.0 * U;
        // Entry and exit: the quotient by a component of the direction. The middle of the last
        // step depends on both.
        let entry = far * (turn * slant + 4.0 * U);
        let along = 2.0 * entry + 4.0 * U * far;
        let place = along + far * (turn + 4.0 * U) + 4.0 * U * extent;
        // In node units: eye minus first node, over spacing, and the sum along the ray.
        let nodes = (place + 12.0 * U * extent) / voxel;

        // The density: as steep as neighbouring nodes differ, 15u of rounding each.
        let (_, most) = scene.grid.range();
        let steepness = steepness(&scene.grid, f64::from);
        let density = steepness * nodes + 30.0 * U * most;

        // The opacity over a step of r reference lengths, 1 − (1 − a0)^r.
        let transfer = &scene.transfer_function;
        let Appearance::Formula { opacity: curve, .. } = &transfer.appearance else {
            panic!("the bound is that of the formula")
        };
        let (h0, floor) = (transfer.reference_length, curve.floor);
        let clear = curve.transparency(most);
        let thickness = scene.step / h0;
        let at_reference = 2.0 * most / (1.0 - floor) * density + 12.0 * U;
        let longest = -volref::math::ln(clear) / h0 * (2.0 * entry + 4.0 * U * far);
        let opacity = thickness * at_reference / clear + longest + 12.0 * U;

        // Radiance: heat · shading · d² · visibility; heat rises by 4 per density.
        let weights = scene.phong.map_or(1.0, |p| p.ambient + p.diffuse);
        let brightest = weights * most * most;
        let mut radiance = (4.0 * most + 2.0) * most * weights * density + 20.0 * U * brightest;
        let place = 1.75 * place; // √3: a distance
        if let Some(phong) = scene.phong {
            let gradients = relative_gradients(&*scene.grid);
            let component = |axis: usize| {
                let of = move |value: [f32; 3]| f64::from(value[axis]);
                let slopes = gradients.values().iter().map(move |&value| of(value));
                let least = slopes.clone().fold(f64::INFINITY, f64::min);
                let most = slopes.fold(0.0, f64::max);
                let steepness = steepness_of(&gradients, of);
                (least, steepness * nodes + 30.0 * U * most)
            };
            let (shortest, change) = (0..3)
                .map(component)
                .fold((0.0, 0.0), |(square, sum), (least, change)| {
                    (square + least * least, sum + change)
                });
            assert!(shortest > 0.0, "the density rises along every axis");
            let normal = 2.0 * change / shortest.sqrt() + 8.0 * U;
            let nearest = scene
                .light
                .clamp(bounds.min, bounds.max)
                .distance(scene.light);
            let to_light = 2.0 * place / nearest + 8.0 * U;
            radiance += phong.diffuse * (normal + to_light + 8.0 * U) * most * most;
        }
        if let Some(shadow) = scene.shadow {
            // Towards a light at most a diagonal away, every place moves by no more than the
            // sample does, and rounding.
            let way = bounds.size().length() / shadow.reference_step;
            let samples = bounds.size().length() / shadow.step + 1.0;
            let nodes = (4.0 * place + 12.0 * U * extent) / voxel + nodes;
            let sum = way * (steepness * nodes + (samples + 30.0) * U * most)
                + most / shadow.reference_step * (4.0 * place + 8.0 * U * extent);
            radiance += brightest * (sum / 100.0 + 4.0 * U);
        }

        // Each opacity moves the pixel by at most the brightest radiance times its own change,
        // radiances are averaged, and the sum rounds as in `order.rs`.
        let samples = span.length() / scene.step + 2.0;
        let opacities = samples * (opacity + 9.0 * U);
        Some(Bound {
            colour: 1.1 * (radiance + brightest * opacities),
            opacity: 1.1 * opacities,
        })
    }
}

fn steepness(grid: &Grid<f32>, of: impl Fn(f32) -> f64) -> f64 {
    steepness_of(grid, of)
}

/// Largest change over one node along x, plus along y, plus along z: no path through the
/// interpolated field is steeper.
fn steepness_of<T: Copy>(grid: &Grid<T>, of: impl Fn(T) -> f64) -> f64 {
    let lattice = grid.lattice();
    (0..3)
        .map(|axis| {
            let neighbours = (0..lattice.node_count()).filter_map(|index| {
                let mut node = lattice.node(index);
                node[axis] += 1;
                let inside = node[axis] < lattice.nodes()[axis];
                inside.then(|| (index, lattice.index(node)))
            });
            neighbours
                .map(|(a, b)| (of(grid.values()[a]) - of(grid.values()[b])).abs())
                .fold(0.0, f64::max)
        })
        .sum()
}

fn check(
    setup: &Setup,
    lighting: Lighting,
    image: impl Fn(&Classified) -> Classified,
    pixel: impl Fn([usize; 2]) -> [usize; 2],
) -> Result<(), TestCaseError> {
    let n = setup.size;
    let scene = setup.scene(lighting, DVec3::ZERO);
    let rays = scenes::rays(&scene, n);
    let original = scenes::layers(&scene, &rays);
    let image = image(&scene);
    let found = scenes::layers(&image, &scenes::rays(&image, n));
    for (index, ray) in rays.iter().enumerate() {
        let [column, row] = pixel([index % n, index / n]);
        let (a, b) = (original[index], found[row * n + column]);
        let Some(bound) = setup.bound(&scene, ray) else {
            continue;
        };
        let apart = (a.colour - b.colour).abs().max_element();
        prop_assert!(apart <= bound.colour, "{a:?} {b:?} {bound:?}");
        prop_assert!(
            (a.opacity - b.opacity).abs() <= bound.opacity,
            "{a:?} {b:?} {bound:?}"
        );
    }
    Ok(())
}

const LIGHTINGS: [Lighting; 3] = [Lighting::None, Lighting::Shading, Lighting::Shadow];

fn turned(setup: &Setup, scene: &Classified, symmetry: Symmetry) -> Classified {
    let [eye, target, up] = [setup.eye, setup.target, setup.up].map(|v| symmetry.of_vector(v));
    Classified {
        grid: symmetry.of_grid(&scene.grid),
        light: symmetry.of_vector(scene.light),
        camera: Camera::new(eye, target, up, setup.vertical_fov).unwrap(),
        ..scene.clone()
    }
}

proptest! {
    #![proptest_config(config(128))]

    /// All 48 symmetries: quarter turns about every axis, mirrors, and what they make together.
    #[test]
    fn turning_everything_turns_nothing_and_mirroring_mirrors(
        setup in setup(), symmetry in symmetry()
    ) {
        let n = setup.size;
        for lighting in LIGHTINGS {
            check(&setup, lighting, |scene| turned(&setup, scene, symmetry), |[column, row]| {
                [if symmetry.mirrors() { n - 1 - column } else { column }, row]
            })?;
        }
    }

    /// Only the scene is turned, about the direction in which the camera looks: its image turns.
    #[test]
    fn a_quarter_turn_about_the_view_turns_the_image(setup in setup(), axis in 0..3_usize) {
        let n = setup.size;
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut setup = setup;
        // The axis of the turn goes through the origin; so does the camera's.
        setup.eye[b] = 0.0;
        setup.eye[c] = 0.0;
        setup.eye[axis] = -100.0;
        setup.target = DVec3::ZERO;
        setup.up = DVec3::AXES[c];
        setup.vertical_fov = 0.1;
        let turn = Symmetry::turn(axis);
        let image = |scene: &Classified| Classified {
            grid: turn.of_grid(&scene.grid),
            light: turn.of_vector(scene.light),
            ..scene.clone()
        };
        // Right is −b, up is c. What was right goes down, what was up goes right.
        for lighting in LIGHTINGS {
            check(&setup, lighting, image, |[column, row]| [n - 1 - row, column])?;
        }
    }
}

#[test]
fn half_the_symmetries_mirror() {
    let mirror = Symmetry {
        from: [0, 1, 2],
        sign: [-1.0, 1.0, 1.0],
    };
    let swap = Symmetry {
        from: [1, 0, 2],
        sign: [1.0; 3],
    };
    let cycle = Symmetry {
        from: [1, 2, 0],
        sign: [1.0; 3],
    };
    assert!(mirror.mirrors() && swap.mirrors() && !cycle.mirrors());
    assert!((0..3).all(|axis| !Symmetry::turn(axis).mirrors()));
}
