//! Loops written by hand, each for the picture of one kind of scene and for nothing else: no
//! plan, no traits, no counters, no threads, no memory but the image.
//!
//! They are what a kernel compiled for its scene is measured against, in instructions
//! (`scripts/instructions.rs`). Like the kernels they call the camera, the grid, the transfer
//! function and the random numbers of the library; unlike them they are another crate, into which the
//! compiler inlines less. Each returns the bits that [`render`](volref::render::render) does.

use glam::DVec3;
use std::f64::consts::PI;
use volref::film::Film;
use volref::geometry::{Aabb, Boundary, Camera, Ray, Span, length_of};
use volref::math::rng::{Purpose, Stream};
use volref::math::{Frame, Moments, exp, ln_1p};
use volref::optics::{Deflection, Density, Field, Light, optical_depth, source_factor};
use volref::render::classified::empty_space::EmptySpace;
use volref::render::classified::steps::Steps;
use volref::scene::{Classified, Radiative, Scattering};
use volref::volume::{Cell, NodeLine, relative_gradients};

/// Columns and rows of an image.
pub type Size = [usize; 2];

/// A classified volume that is nowhere transparent: trilinear, front to back, unshaded, without
/// shadow.
pub fn unshaded(scene: &Classified, size: Size) -> Film {
    let grid = &*scene.grid;
    let (lattice, bounds) = (grid.lattice(), grid.lattice().bounds());
    let looks = &scene.transfer_function;
    with_opacity(&scene.camera, size, |ray| {
        let (mut colour, mut opacity, mut through) = (DVec3::ZERO, 0.0, 1.0);
        if let Some(span) = bounds.span(&ray) {
            let steps = Steps::over(span, scene.step);
            let path = NodeLine::new(&ray, lattice);
            for index in 0..steps.count() {
                let (t, length) = steps.sample(index);
                let density = Cell::around(lattice, path.at(t)).trilinear(grid);
                let own = looks.opacity(density, length);
                let radiance = looks.colour(density) * looks.emission(density);
                colour += radiance * own * through;
                let left = through * (1.0 - own);
                opacity = match left < 0.5 {
                    true => 1.0 - left,
                    false => opacity + own * through,
                };
                through = left;
            }
        }
        (colour + scene.background * through, opacity)
    })
}

/// A classified volume with transparent places, by the formula of the assignment: trilinear,
/// front to back, with Phong shading and volume shadow.
pub fn shaded_with_shadow(scene: &Classified, size: Size) -> Film {
    let grid = &*scene.grid;
    let (lattice, bounds) = (grid.lattice(), grid.lattice().bounds());
    let looks = &scene.transfer_function;
    let phong = scene.phong.expect("a shaded scene");
    let shadow = scene.shadow.expect("a scene with shadow");
    let gradients = relative_gradients(grid);
    let space = EmptySpace::of(grid, looks);
    let leap = |nodes, reach| space.transparent_samples(nodes, reach);
    with_opacity(&scene.camera, size, |ray| {
        let (mut colour, mut opacity, mut through) = (DVec3::ZERO, 0.0, 1.0);
        let span = bounds.span(&ray).unwrap_or(NOTHING);
        let steps = Steps::over(span, scene.step);
        let path = NodeLine::new(&ray, lattice);
        let reach = path.reach(scene.step);
        let mut index = 0;
        while index < steps.count() {
            let (t, length) = steps.sample(index);
            let nodes = path.at(t);
            let transparent = leap(nodes, reach);
            index += transparent.max(1);
            if transparent > 0 {
                continue;
            }
            let cell = Cell::around(lattice, nodes);
            let density = cell.trilinear(grid);
            let own = looks.opacity(density, length);
            if own == 0.0 {
                continue;
            }
            // No light stands inside the volume, nor does its shadow end before it.
            let world = ray.at(t);
            let to_light = scene.light - world;
            let towards = Ray::new(world, to_light).expect("a light outside");
            let gradient = cell.trilinear(&gradients);
            let colour_here = looks.colour(density);
            let shaded = phong.shade(
                colour_here,
                gradient,
                Some(towards.direction),
                -ray.direction,
            );

            let inside = bounds.span(&towards).map_or(0.0, |span| span.far);
            let span = Span {
                near: 0.0,
                far: inside.min(length_of(to_light)),
            };
            let shadow_steps = Steps::over(span, shadow.step);
            let shadow_path = NodeLine::from(nodes, *towards.direction, lattice);
            let shadow_reach = shadow_path.reach(shadow.step);
            let (mut sum, mut done) = (0.0, 0);
            while done < shadow_steps.count() {
                let (t, length) = shadow_steps.sample(done);
                let nodes = shadow_path.at(t);
                let transparent = leap(nodes, shadow_reach);
                if transparent == 0 {
                    sum += Cell::around(lattice, nodes).trilinear(grid) * length;
                }
                done += transparent.max(1);
            }
            let visibility = exp(-(sum / shadow.reference_step) / 100.0).min(1.0);

            let radiance = shaded * (looks.emission(density) * visibility);
            colour += radiance * own * through;
            let left = through * (1.0 - own);
            opacity = match left < 0.5 {
                true => 1.0 - left,
                false => opacity + own * through,
            };
            through = left;
        }
        (colour + scene.background * through, opacity)
    })
}

/// No stretch of any ray.
const NOTHING: Span = Span {
    near: 0.0,
    far: 0.0,
};

/// A grid that only absorbs, in its own box, before the environment.
pub fn absorbing_grid(scene: &Radiative, size: Size) -> Film {
    let body = &scene.media[0];
    let Some(Field::Grid(grid)) = body.density.as_ref().map(Density::field) else {
        panic!("no grid");
    };
    let (bounds, sigma) = (grid.bounds(), body.medium.coefficients.sigma_a());
    opaque(&scene.camera, size, |ray| {
        let Some(span) = bounds.span(&ray).filter(|span| span.near < span.far) else {
            return scene.environment;
        };
        let column = grid.integral(ray.origin, *ray.direction, span, &mut 0);
        let through = |sigma| exp(-optical_depth(sigma, column));
        DVec3::from_array(sigma.to_array().map(through)) * scene.environment
    })
}

/// A box of the same matter everywhere, grey, that absorbs and emits light, before the
/// environment.
pub fn glowing_box(scene: &Radiative, size: Size) -> Film {
    let body = &scene.media[0];
    let bounds = box_of(scene);
    let sigma = body.medium.coefficients.sigma_a().x;
    opaque(&scene.camera, size, |ray| {
        let Some(span) = bounds.span(&ray).filter(|span| span.near < span.far) else {
            return scene.environment;
        };
        let depth = optical_depth(sigma, span.length());
        body.medium.emission * (span.length() * source_factor(depth))
            + scene.environment * exp(-depth)
    })
}

/// A box of the same matter everywhere, grey, that scatters light of a sun and of the environment
/// evenly, up to a limit of turns.
pub fn scattering_box(scene: &Radiative, size: Size) -> Film {
    let body = &scene.media[0];
    let bounds = box_of(scene);
    let Light::Directional(sun) = scene.lights[0] else {
        panic!("no sun");
    };
    let Scattering::Multiple(Some(limit)) = scene.scattering else {
        panic!("no limit");
    };
    let sigma_t = body.medium.coefficients.sigma_t().x;
    let albedo = body.medium.coefficients.sigma_s().x / sigma_t;
    let towards_sun = Ray::new(DVec3::ZERO, -*sun.direction).expect("a direction");
    let scattered = DVec3::splat(1.0 / (4.0 * PI)) * sun.irradiance;

    let mut moments = Vec::with_capacity(size[0] * size[1]);
    for index in 0..size[0] * size[1] {
        let [column, row] = [index % size[0], index / size[0]].map(|side| side as f64);
        let mut pixel = [Moments::default(); 3];
        for sample in 0..scene.samples {
            let random = Stream::new(scene.seed, index as u32, sample);
            let [x, y] = random.pair(0, Purpose::Camera, 0);
            let mut ray = scene.camera.ray_through([column + x, row + y], size);
            // Grey, so light on the way is dimmed alike in all channels.
            let (mut radiance, mut carried, mut first) = (DVec3::ZERO, 1.0, 1.0);
            for bounce in 0..=limit {
                let Some(span) = bounds.span(&ray).filter(|span| span.near < span.far) else {
                    radiance += scene.environment * carried;
                    break;
                };
                let [way, _] = random.pair(bounce, Purpose::FreeFlight, 0);
                let flown = -ln_1p(-way);
                if flown >= optical_depth(sigma_t, span.length()) {
                    radiance += scene.environment * carried;
                    break;
                }
                carried *= albedo;
                if bounce == limit {
                    break;
                }
                if bounce == 0 {
                    first = carried;
                }
                let point = ray.at((span.near + flown / sigma_t).min(span.far));

                let to_sun = Ray {
                    origin: point,
                    ..towards_sun
                };
                let dark = bounds.span(&to_sun).map_or(0.0, |span| span.length());
                radiance += scattered * exp(-optical_depth(sigma_t, dark)) * carried;

                let [u, v] = random.pair(bounce, Purpose::PhaseDirection, 0);
                let turn = Deflection::from_cos(2.0 * u - 1.0);
                let direction = Frame::around(ray.direction).to_world(turn.direction(v));
                ray = Ray::new(point, *direction).expect("a direction");
                let survival: f64 = (2.0 * carried / first).min(1.0);
                if survival < 1.0 {
                    if random.uniform(bounce, Purpose::Roulette, 0) >= survival {
                        break;
                    }
                    carried /= survival;
                }
            }
            for (moments, channel) in pixel.iter_mut().zip(radiance.to_array()) {
                moments.add(channel);
            }
        }
        moments.push(pixel);
    }
    let mean = |pixel: &[Moments; 3]| pixel.map(|channel| channel.mean() as f32);
    let noise = |channel: Moments| channel.variance_of_mean().map_or(0.0, |v| v as f32);
    Film::with_noise(
        size[0],
        size[1],
        moments.iter().map(mean).collect(),
        moments.iter().map(|pixel| pixel.map(noise)).collect(),
        scene.samples,
    )
}

/// The box along the axes that the only medium fills.
fn box_of(scene: &Radiative) -> Aabb {
    match scene.media[0].boundary {
        Some(Boundary::Box(bounds)) => bounds,
        _ => panic!("no box along the axes"),
    }
}

/// The image of a radiance and an opacity for each ray.
fn with_opacity(camera: &Camera, size: Size, see: impl Fn(Ray) -> (DVec3, f64)) -> Film {
    let [width, height] = size;
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        for column in 0..width {
            let (seen, opacity) = see(camera.ray([column, row], size));
            pixels.push([seen.x, seen.y, seen.z, opacity].map(|value| value as f32));
        }
    }
    Film::with_opacity(width, height, pixels)
}

/// The image of a radiance for each ray.
fn opaque(camera: &Camera, size: Size, see: impl Fn(Ray) -> DVec3) -> Film {
    let [width, height] = size;
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        for column in 0..width {
            pixels.push(see(camera.ray([column, row], size)).as_vec3().to_array());
        }
    }
    Film::new(width, height, pixels)
}
