//! Faults that are in no catalogue, as data: a name, the case, and an edit of its scene or image.

use glam::DVec3;
use volref::film::Film;
use volref::geometry::{Camera, Luminous, Rectangle};
use volref::math;
use volref::optics::{
    Appearance, Asymmetry, Coefficients, Colormap, Field, Homogeneous, Light, Material, Spot,
};
use volref::scene::{Classified, Radiative, Scattering};
use volref::volume::{FractalDensity, Grid, GridDensity, Lattice};

/// A fault.
pub struct Fault {
    pub name: &'static str,
    /// The case it is made in.
    pub case: &'static str,
    pub edit: Edit,
    /// Mistakes of the catalogue, or pairs of them, that describe it truly; none for most.
    pub described_by: &'static [&'static str],
}

pub enum Edit {
    Classified(fn(&mut Classified)),
    Radiative(fn(&mut Radiative)),
    Film(fn(&Film) -> Film),
    /// The image plane moved by parts of a pixel, to the right and down.
    ImagePlane([f64; 2]),
}

use Edit::{Classified as Ray, Film as Image, ImagePlane, Radiative as Path};

const fn fault(name: &'static str, case: &'static str, edit: Edit) -> Fault {
    Fault {
        name,
        case,
        edit,
        described_by: &[],
    }
}

const fn near(
    name: &'static str,
    case: &'static str,
    edit: Edit,
    described_by: &'static [&'static str],
) -> Fault {
    Fault {
        name,
        case,
        edit,
        described_by,
    }
}

const PLUME: &str = "figures/figure-3";
const SHADOWED: &str = "figures/figure-5";
const ROOM: &str = "smoke/cornell";
const FOG: &str = "fog/forward";
const STAIN: &str = "procedural/absorbing-grid";
const COLOURED: &str = "procedural/coloured";
const NOISE: &str = "procedural/threshold-1.25";

pub const FAULTS: &[Fault] = &[
    // A ray caster.
    fault("step × 1.5", PLUME, Ray(|s| s.step *= 1.5)),
    fault("step × 3", PLUME, Ray(|s| s.step *= 3.0)),
    fault(
        "opacity + 10 %",
        PLUME,
        Ray(|s| s.transfer_function.reference_length /= 1.1),
    ),
    fault(
        "opacity − 30 %",
        PLUME,
        Ray(|s| s.transfer_function.reference_length /= 0.7),
    ),
    fault(
        "ambient 0.3",
        PLUME,
        Ray(|s| s.phong.as_mut().unwrap().ambient = 0.3),
    ),
    fault(
        "diffuse 0.7",
        PLUME,
        Ray(|s| s.phong.as_mut().unwrap().diffuse = 0.7),
    ),
    fault(
        "diffuse 0.7, opacity + 10 %",
        PLUME,
        Ray(|s| {
            s.phong.as_mut().unwrap().diffuse = 0.7;
            s.transfer_function.reference_length /= 1.1;
        }),
    ),
    fault(
        "highlight × 2",
        PLUME,
        Ray(|s| s.phong.as_mut().unwrap().specular = 2.0),
    ),
    fault(
        "shininess 20",
        PLUME,
        Ray(|s| s.phong.as_mut().unwrap().shininess = 20),
    ),
    fault("light to the side", PLUME, Ray(|s| s.light.x += 2.0)),
    fault(
        "field of view 46°",
        PLUME,
        Ray(|s| s.camera = s.camera.with_vertical_fov(46_f64.to_radians())),
    ),
    fault(
        "eye 1 % nearer",
        PLUME,
        Ray(|s| s.camera = moved(&s.camera, *s.camera.forward() * 0.02)),
    ),
    fault(
        "eye to the side",
        PLUME,
        Ray(|s| s.camera = moved(&s.camera, DVec3::new(0.02, 0.0, 0.0))),
    ),
    fault(
        "background 0.05",
        PLUME,
        Ray(|s| s.background = DVec3::splat(0.05)),
    ),
    fault(
        "another map of colours",
        PLUME,
        Ray(|s| {
            if let Appearance::Formula { colormap, .. } = &mut s.transfer_function.appearance {
                *colormap = Colormap::named("turbo").unwrap();
            }
        }),
    ),
    fault("early end at 0.3", PLUME, Ray(|s| s.end_rays_at(0.3))),
    fault(
        "quarter of a voxel along y",
        PLUME,
        Ray(|s| s.grid = along(&s.grid, DVec3::new(0.0, 0.25, 0.0))),
    ),
    near(
        "half a voxel along x",
        PLUME,
        Ray(|s| s.grid = along(&s.grid, DVec3::new(0.5, 0.0, 0.0))),
        &["volume-half-voxel-along-x"],
    ),
    near(
        "half a voxel back along z",
        PLUME,
        Ray(|s| s.grid = along(&s.grid, DVec3::new(0.0, 0.0, -0.5))),
        &["volume-half-voxel-back-along-z"],
    ),
    near(
        "half a pixel down",
        PLUME,
        ImagePlane([0.0, 0.5]),
        &["half-a-pixel-down"],
    ),
    near(
        "half a pixel left",
        PLUME,
        ImagePlane([-0.5, 0.0]),
        &["half-a-pixel-left"],
    ),
    fault("a third of a pixel right", PLUME, ImagePlane([0.3, 0.0])),
    near(
        "a pixel and a half up",
        PLUME,
        ImagePlane([0.0, -1.5]),
        &["half-a-pixel-up + one-pixel-up"],
    ),
    fault(
        "gamma 1.8",
        PLUME,
        Image(|f| by_value(f, |x, _| math::exp(math::ln(x.max(1e-30)) / 1.8))),
    ),
    fault(
        "clamped at 0.5",
        PLUME,
        Image(|f| by_value(f, |x, _| x.min(0.5))),
    ),
    fault(
        "green + 5 %",
        PLUME,
        Image(|f| by_value(f, |x, c| if c == 1 { 1.05 * x } else { x })),
    ),
    fault(
        "every sixteenth row black",
        PLUME,
        Image(|f| by_place(f, |x, [_, y]| if y % 16 == 0 { 0.0 } else { x })),
    ),
    fault(
        "darker towards the corners",
        PLUME,
        Image(|f| by_place(f, |x, at| x * vignette(at))),
    ),
    fault(
        "upper half at half brightness",
        PLUME,
        Image(|f| by_place(f, |x, [_, y]| if y < 128 { 0.5 * x } else { x })),
    ),
    fault(
        "shadow rays of double step",
        SHADOWED,
        Ray(|s| {
            if let Some(s) = &mut s.shadow {
                s.step *= 4.0;
                s.reference_step *= 1.3
            }
        }),
    ),
    fault(
        "shadow too dark by half",
        SHADOWED,
        Ray(|s| {
            if let Some(s) = &mut s.shadow {
                s.reference_step /= 1.5
            }
        }),
    ),
    // Paths in a room.
    fault(
        "samples clamped at 3",
        ROOM,
        Image(|f| by_value(f, |x, _| x.min(3.0))),
    ),
    near(
        "8-bit values, saturated at the exposure",
        ROOM,
        Image(|f| by_value(f, |x, c| eight_bits(x * 0.7, c) / 0.7)),
        &["clamped"],
    ),
    fault(
        "field of view 39.8°",
        ROOM,
        Path(|s| s.camera = s.camera.with_vertical_fov(39.8_f64.to_radians())),
    ),
    fault(
        "field of view 41°",
        ROOM,
        Path(|s| s.camera = s.camera.with_vertical_fov(41_f64.to_radians())),
    ),
    fault(
        "lamp 20 % too bright",
        ROOM,
        Path(|s| s.area_lights[0].radiance *= 1.2),
    ),
    fault(
        "lamp moved by 40",
        ROOM,
        Path(|s| s.area_lights[0].shape = lamp(DVec3::new(153.0, 554.0, 127.0), 330.0, 305.0)),
    ),
    fault(
        "lamp 10 % smaller",
        ROOM,
        Path(|s| s.area_lights[0].shape = lamp(DVec3::new(113.0, 554.0, 127.0), 297.0, 305.0)),
    ),
    fault(
        "lamp below the ceiling",
        ROOM,
        Path(|s| s.area_lights[0].shape = lamp(DVec3::new(113.0, 530.0, 127.0), 330.0, 305.0)),
    ),
    fault(
        "white walls too dark",
        ROOM,
        Path(|s| {
            materials(s, |m| {
                if *m == Material::Diffuse(DVec3::splat(0.73)) {
                    *m = Material::Diffuse(DVec3::splat(0.65))
                }
            })
        }),
    ),
    fault(
        "red and green walls exchanged",
        ROOM,
        Path(|s| {
            materials(s, |m| {
                let [red, green] = [DVec3::new(0.65, 0.05, 0.05), DVec3::new(0.12, 0.45, 0.15)];
                match m {
                    Material::Diffuse(colour) if *colour == red => *colour = green,
                    Material::Diffuse(colour) if *colour == green => *colour = red,
                    _ => {}
                }
            })
        }),
    ),
    fault(
        "white smoke absorbs a tenth",
        ROOM,
        Path(|s| {
            media(s, |a, s| {
                if s == DVec3::ZERO {
                    (a, s)
                } else {
                    (0.1 * s, 0.9 * s)
                }
            })
        }),
    ),
    fault(
        "smoke denser by a third",
        ROOM,
        Path(|s| media(s, |a, s| (1.33 * a, 1.33 * s))),
    ),
    // It only scatters, and nothing else does.
    near(
        "white smoke missing",
        ROOM,
        Path(|s| {
            s.media.pop();
        }),
        &["scattering-left-out"],
    ),
    fault(
        "black smoke missing",
        ROOM,
        Path(|s| {
            s.media.remove(0);
        }),
    ),
    fault(
        "back wall missing",
        ROOM,
        Path(|s| {
            s.objects.pop();
        }),
    ),
    fault(
        "grey sky",
        ROOM,
        Path(|s| s.environment = DVec3::splat(0.03)),
    ),
    fault(
        "ten bounces",
        ROOM,
        Path(|s| s.scattering = Scattering::Multiple(Some(2))),
    ),
    fault(
        "offset of 0.02",
        ROOM,
        Image(|f| by_value(f, |x, _| x + 0.02)),
    ),
    fault(
        "lower half darker by a tenth",
        ROOM,
        Image(|f| by_place(f, |x, [_, y]| if y >= 128 { 0.9 * x } else { x })),
    ),
    fault(
        "green + 8 %, noisy",
        ROOM,
        Image(|f| by_value(f, |x, c| if c == 1 { 1.08 * x } else { x })),
    ),
    fault(
        "eye to the side in the room",
        ROOM,
        Path(|s| s.camera = moved(&s.camera, DVec3::new(4.0, 0.0, 0.0))),
    ),
    near(
        "half a pixel down in the room",
        ROOM,
        ImagePlane([0.0, 0.5]),
        &["half-a-pixel-down"],
    ),
    fault("saturation of colours", ROOM, Image(|f| mixed(f, 1.2))),
    // Fog.
    fault("g = 0.5", FOG, Path(|s| asymmetry(s, 0.5))),
    fault("g = 0.75", FOG, Path(|s| asymmetry(s, 0.75))),
    fault(
        "fog denser by 15 %",
        FOG,
        Path(|s| media(s, |a, s| (1.15 * a, 1.15 * s))),
    ),
    fault(
        "fog absorbs a fifth",
        FOG,
        Path(|s| media(s, |a, s| (a + 0.2 * s, 0.8 * s))),
    ),
    fault("cone wider by 2°", FOG, Path(|s| cone(s, [16.0, 20.0]))),
    fault(
        "spotlight 10 % too dark",
        FOG,
        Path(|s| {
            if let Light::Spot(spot) = &mut s.lights[0] {
                spot.intensity *= 0.9
            }
        }),
    ),
    fault(
        "spotlight lower",
        FOG,
        Path(|s| {
            if let Light::Spot(spot) = &mut s.lights[0] {
                spot.position.y -= 0.5
            }
        }),
    ),
    fault(
        "ball too dark",
        FOG,
        Path(|s| {
            materials(s, |m| {
                if *m == Material::Diffuse(DVec3::splat(0.75)) {
                    *m = Material::Diffuse(DVec3::splat(0.4))
                }
            })
        }),
    ),
    fault(
        "fog of falling brightness",
        FOG,
        Image(|f| by_place(f, |x, [_, y]| x * (1.0 - 0.3 * y as f32 / 192.0))),
    ),
    // Grids and noise.
    fault(
        "extinction + 10 %",
        STAIN,
        Path(|s| media(s, |a, s| (1.1 * a, 1.1 * s))),
    ),
    near(
        "grid half a voxel along y",
        STAIN,
        Path(|s| grids(s, DVec3::new(0.0, 0.5, 0.0))),
        &["grid-half-voxel-along-y"],
    ),
    fault(
        "grid a voxel along x",
        STAIN,
        Path(|s| grids(s, DVec3::new(1.0, 0.0, 0.0))),
    ),
    fault("grid 2 % too large", STAIN, Path(|s| scaled(s, 1.02))),
    fault("sky of 0.9", STAIN, Path(|s| s.environment *= 0.9)),
    fault(
        "sun tilted",
        COLOURED,
        Path(|s| sun(s, DVec3::new(-0.9, -0.5, 0.5))),
    ),
    fault("sky × 1.5", COLOURED, Path(|s| s.environment *= 1.5)),
    fault("g = 0.2", COLOURED, Path(|s| asymmetry(s, 0.2))),
    fault(
        "albedo of red lower",
        COLOURED,
        Path(|s| {
            media(s, |a, s| {
                (a + DVec3::new(6.0, 0.0, 0.0), s - DVec3::new(6.0, 0.0, 0.0))
            })
        }),
    ),
    fault(
        "threshold 1.3",
        NOISE,
        Path(|s| noises(s, |p| p.threshold = 1.3)),
    ),
    fault("gain 0.4", NOISE, Path(|s| noises(s, |p| p.gain = 0.4))),
    fault(
        "noise shifted",
        NOISE,
        Path(|s| noises(s, |p| p.offset.x += 0.2)),
    ),
];

fn moved(camera: &Camera, by: DVec3) -> Camera {
    let eye = camera.eye() + by;
    let up = *camera.upright();
    let target = eye + *camera.forward();
    Camera::new(eye, target, up, camera.vertical_fov()).unwrap()
}

fn along(grid: &Grid<f32>, voxels: DVec3) -> std::sync::Arc<Grid<f32>> {
    let old = grid.lattice();
    let first = old.first() + old.spacing() * voxels;
    on(
        Lattice::new(old.nodes(), old.spacing(), first).unwrap(),
        grid,
    )
}

fn on(lattice: Lattice, grid: &Grid<f32>) -> std::sync::Arc<Grid<f32>> {
    let lattice = lattice.with_centring(grid.lattice().centring()).unwrap();
    std::sync::Arc::new(Grid::new(lattice, grid.values().to_vec()).unwrap())
}

fn with_grids(scene: &mut Radiative, edit: impl Fn(&Grid<f32>) -> std::sync::Arc<Grid<f32>>) {
    for density in scene.media.iter_mut().flat_map(|body| &mut body.density) {
        if let Field::Grid(field) = density.field() {
            let grid = GridDensity::new(edit(field.grid()), field.interpolation());
            *density = density.with_field(Field::Grid(grid));
        }
    }
}

fn grids(scene: &mut Radiative, voxels: DVec3) {
    with_grids(scene, |grid| along(grid, voxels));
}

fn scaled(scene: &mut Radiative, factor: f64) {
    with_grids(scene, |grid| {
        let old = grid.lattice();
        on(
            Lattice::new(old.nodes(), old.spacing() * factor, old.first()).unwrap(),
            grid,
        )
    });
}

fn noises(scene: &mut Radiative, edit: fn(&mut volref::volume::FractalParameters)) {
    for density in scene.media.iter_mut().flat_map(|body| &mut body.density) {
        if let Field::Noise(noise) = density.field() {
            let mut parameters = *noise.parameters();
            edit(&mut parameters);
            let noise = FractalDensity::new(parameters).unwrap();
            *density = density.with_field(Field::Noise(noise));
        }
    }
}

fn lamp(corner: DVec3, width: f64, depth: f64) -> Luminous {
    let edges = [DVec3::new(width, 0.0, 0.0), DVec3::new(0.0, 0.0, depth)];
    Luminous::Rectangle(Rectangle::new(corner, edges[0], edges[1]).unwrap())
}

fn materials(scene: &mut Radiative, edit: fn(&mut Material)) {
    for object in &mut scene.objects {
        edit(&mut object.material);
    }
}

fn media(scene: &mut Radiative, edit: fn(DVec3, DVec3) -> (DVec3, DVec3)) {
    for body in &mut scene.media {
        let old = body.medium.coefficients;
        let (sigma_a, sigma_s) = edit(old.sigma_a(), old.sigma_s());
        body.medium.coefficients = Coefficients::new(sigma_a, sigma_s).unwrap();
    }
}

fn asymmetry(scene: &mut Radiative, g: f64) {
    for body in &mut scene.media {
        let medium: &mut Homogeneous = &mut body.medium;
        medium.phase = medium.phase.with_asymmetry(|_| Asymmetry::new(g).unwrap());
    }
}

fn cone(scene: &mut Radiative, angles: [f64; 2]) {
    if let Light::Spot(spot) = &mut scene.lights[0] {
        *spot = Spot::new(spot.position, *spot.axis(), spot.intensity, angles).unwrap();
    }
}

fn sun(scene: &mut Radiative, direction: DVec3) {
    if let Light::Directional(sun) = &mut scene.lights[0] {
        sun.direction = volref::geometry::Direction::of(direction).unwrap();
    }
}

/// The image with other values; its noise stays.
fn by_pixel(film: &Film, pixel: impl Fn([f32; 3], [usize; 2]) -> [f32; 3]) -> Film {
    let (width, height) = (film.width(), film.height());
    let pixels = film.radiance().iter().enumerate();
    let pixels = pixels
        .map(|(i, &value)| pixel(value, [i % width, i / width]))
        .collect();
    match film.noise() {
        Some(noise) => Film::with_noise(
            width,
            height,
            pixels,
            noise.variance().to_vec(),
            noise.samples(),
        ),
        None => Film::new(width, height, pixels),
    }
}

fn by_value(film: &Film, map: impl Fn(f64, usize) -> f64) -> Film {
    by_pixel(film, |pixel, _| {
        std::array::from_fn(|c| map(f64::from(pixel[c]), c) as f32)
    })
}

fn by_place(film: &Film, map: impl Fn(f32, [usize; 2]) -> f32) -> Film {
    by_pixel(film, |pixel, at| pixel.map(|x| map(x, at)))
}

fn eight_bits(x: f64, _: usize) -> f64 {
    (255.0 * x).round().clamp(0.0, 255.0) / 255.0
}

fn vignette([x, y]: [usize; 2]) -> f32 {
    let [x, y] = [x, y].map(|i| (i as f32 - 127.5) / 128.0);
    1.0 - 0.25 * (x * x + y * y)
}

/// Colours away from their grey by this factor.
fn mixed(film: &Film, factor: f32) -> Film {
    by_pixel(film, |pixel, _| {
        let grey = (pixel[0] + pixel[1] + pixel[2]) / 3.0;
        pixel.map(|x| (grey + factor * (x - grey)).max(0.0))
    })
}
