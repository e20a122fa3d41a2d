//! Faults that are in no catalogue, as data: the case, an edit of its scene or image, and the truth
//! that a verdict is judged by.

use super::images;
use super::tables;
use glam::DVec3;
use std::sync::Arc;
use volref::film::Film;
use volref::geometry::{Aabb, Boundary, Camera, Luminous, Rectangle};
use volref::math;
use volref::optics::{Appearance, Coefficients, Colormap, Field, Light, Material, Spot};
use volref::scene::{Classified, Radiative, Scattering};
use volref::volume::{FractalDensity, FractalParameters, Grid, GridDensity, Lattice};

/// A fault.
pub struct Fault {
    pub kind: Kind,
    pub name: String,
    /// The case it is made in.
    pub case: &'static str,
    /// Samples per pixel, where there are any.
    pub samples: u32,
    /// Made one after the other, those of the scene first.
    pub edits: Vec<Edit>,
    pub truth: Truth,
}

/// What may be said of an image with a fault.
#[derive(Clone, Default)]
pub struct Truth {
    /// Mistakes of the catalogue, or pairs of them.
    pub names: Vec<String>,
    /// Conventions, in words.
    pub conventions: Vec<&'static str>,
    /// Numbers that are off, with their changes.
    pub numbers: Vec<(String, f64)>,
    /// Labels of sentences: [`super::verdict::CLAIMS`].
    pub words: Vec<&'static str>,
}

/// Kinds of faults: rows of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    RayCaster,
    PathTracer,
    Number,
    Geometry,
    Field,
    Values,
    Places,
    Catalogue,
    Convention,
    Together,
}

impl Kind {
    pub const ALL: [(Kind, &'static str); 10] = [
        (Kind::RayCaster, "ray caster"),
        (Kind::PathTracer, "path tracer"),
        (Kind::Number, "a number"),
        (Kind::Geometry, "geometry moved or missing"),
        (Kind::Field, "grid or noise"),
        (Kind::Values, "values of the image"),
        (Kind::Places, "pixels of the image"),
        (Kind::Catalogue, "mistake of the catalogue"),
        (Kind::Convention, "convention"),
        (Kind::Together, "two together"),
    ];
}

#[derive(Clone)]
pub enum Edit {
    Classified(fn(&mut Classified)),
    Radiative(fn(&mut Radiative)),
    /// A number of the scene, by its name.
    Number(&'static str, f64),
    /// A mistake of the catalogue.
    Mistake(&'static str),
    /// A convention, in words.
    Convention(&'static str),
    /// The image plane moved by parts of a pixel, to the right and down.
    ImagePlane([f64; 2]),
    Film(fn(&Film) -> Film),
}

use Edit::{Classified as Ray, Film as Image, ImagePlane, Radiative as Path};

impl Fault {
    pub fn new(kind: Kind, name: impl Into<String>, case: &'static str, edits: &[Edit]) -> Fault {
        let mut truth = Truth::default();
        for edit in edits {
            match *edit {
                Edit::Number(number, change) => truth.numbers.push((number.to_owned(), change)),
                Edit::Convention(words) => truth.conventions.push(words),
                Edit::Mistake(name) => {
                    let of_mistake = tables::NUMBERS_OF_MISTAKES.iter();
                    let numbers = of_mistake.filter(|it| it.0 == name);
                    let numbers = numbers.map(|it| (it.1.to_owned(), it.2));
                    truth.numbers.extend(numbers);
                }
                _ => {}
            }
        }
        let names: Vec<Vec<&str>> = edits.iter().map(tables::names_of).collect();
        match &names[..] {
            [alone] => truth
                .names
                .extend(alone.iter().map(|&name| name.to_owned())),
            [first, second] => {
                for one in first {
                    for other in second {
                        truth.names.push(format!("{one} + {other}"));
                        truth.names.push(format!("{other} + {one}"));
                    }
                }
            }
            _ => {}
        }
        Fault {
            kind,
            name: name.into(),
            case,
            samples: 16,
            edits: edits.to_vec(),
            truth,
        }
    }

    pub fn named(mut self, names: &[&str]) -> Fault {
        self.truth
            .names
            .extend(names.iter().map(|&name| name.to_owned()));
        self
    }

    pub fn by_conventions(mut self, words: &[&'static str]) -> Fault {
        self.truth.conventions.extend(words);
        self
    }

    pub fn number(mut self, name: &str, change: f64) -> Fault {
        self.truth.numbers.push((name.to_owned(), change));
        self
    }

    pub fn said(mut self, words: &[&'static str]) -> Fault {
        self.truth.words.extend(words);
        self
    }

    pub fn at(mut self, samples: u32) -> Fault {
        self.samples = samples;
        self
    }
}

pub const NEAREST: &str = "figures/figure-1";
pub const PLUME: &str = "figures/figure-3";
pub const SHADOWED: &str = "figures/figure-5";
pub const COLUMN: &str = "sampled/column";
pub const HEAD: &str = "sampled/perspective-z-up";
pub const ROOM: &str = "smoke/cornell";
pub const FOG: &str = "fog/forward";
pub const GREY: &str = "fog/rate-0.1";
pub const SPOT: &str = "fog/spotlight";
pub const ABSORPTION: &str = "fog/absorption";
pub const STAIN: &str = "procedural/absorbing-grid";
pub const GLOW: &str = "procedural/emissive-grid";
pub const COLOURED: &str = "procedural/coloured";
pub const NOISE: &str = "procedural/threshold-1.25";

/// All faults. Of those in one table and case every other one is made at 64 samples.
pub fn faults() -> Vec<Fault> {
    let mut all = by_hand();
    all.extend(tables::faults());
    all
}

fn by_hand() -> Vec<Fault> {
    let of = |kind| move |name: &'static str, case, edit| Fault::new(kind, name, case, &[edit]);
    let ray_caster = of(Kind::RayCaster);
    let number = of(Kind::Number);
    let geometry = of(Kind::Geometry);
    let field = of(Kind::Field);
    let values = of(Kind::Values);
    let places = of(Kind::Places);
    let paths = of(Kind::PathTracer);
    vec![
        // A ray caster.
        ray_caster("step × 1.5", PLUME, Ray(|s| s.step *= 1.5))
            .number("step", 0.5)
            .said(&["step"]),
        ray_caster("step × 3", PLUME, Ray(|s| s.step *= 3.0))
            .number("step", 2.0)
            .said(&["step"]),
        number("opacity + 10 %", PLUME, Edit::Number("density", 0.1)),
        number("opacity − 30 %", PLUME, Edit::Number("density", -0.3)),
        number("ambient 0.3", PLUME, Edit::Number("ambient", 2.0)),
        number("diffuse 0.7", PLUME, Edit::Number("diffuse", -0.3)),
        Fault::new(
            Kind::Together,
            "diffuse 0.7, opacity + 10 %",
            PLUME,
            &[Edit::Number("diffuse", -0.3), Edit::Number("density", 0.1)],
        ),
        number("highlight × 2", PLUME, Edit::Number("specular", 1.0)),
        ray_caster(
            "shininess 20",
            PLUME,
            Ray(|s| s.phong.as_mut().unwrap().shininess = 20),
        ),
        number("light to the side", PLUME, Edit::Number("light.x", 2.0)),
        geometry(
            "field of view 46°",
            PLUME,
            Ray(|s| s.camera = s.camera.with_vertical_fov(46_f64.to_radians())),
        )
        .number("camera.view", view(45.0, 46.0)),
        geometry(
            "eye 1 % nearer",
            PLUME,
            Ray(|s| s.camera = moved(&s.camera, *s.camera.forward() * 0.02)),
        )
        .number("camera.z", 0.02),
        geometry(
            "eye to the side",
            PLUME,
            Ray(|s| s.camera = moved(&s.camera, DVec3::new(0.02, 0.0, 0.0))),
        )
        .number("camera.x", 0.02)
        .said(&["moved"]),
        ray_caster(
            "background 0.05",
            PLUME,
            Ray(|s| s.background = DVec3::splat(0.05)),
        ),
        ray_caster(
            "another map of colours",
            PLUME,
            Ray(|s| {
                if let Appearance::Formula { colormap, .. } = &mut s.transfer_function.appearance {
                    *colormap = Colormap::named("turbo").unwrap();
                }
            }),
        ),
        ray_caster("early end at 0.3", PLUME, Ray(|s| s.end_rays_at(0.3))),
        field(
            "quarter of a voxel along y",
            PLUME,
            Ray(|s| s.grid = along(&s.grid, DVec3::new(0.0, 0.25, 0.0))),
        )
        .number("grid.y", 0.25)
        .said(&["moved"]),
        field(
            "half a voxel along x",
            PLUME,
            Ray(|s| s.grid = along(&s.grid, DVec3::new(0.5, 0.0, 0.0))),
        )
        .named(&["volume-half-voxel-along-x"])
        .number("grid.x", 0.5),
        field(
            "half a voxel back along z",
            PLUME,
            Ray(|s| s.grid = along(&s.grid, DVec3::new(0.0, 0.0, -0.5))),
        )
        .named(&["volume-half-voxel-back-along-z"])
        .number("grid.z", -0.5),
        places("half a pixel down", PLUME, ImagePlane([0.0, 0.5]))
            .named(&["half-a-pixel-down"])
            .number("camera.down", 0.5)
            .said(&["moved"]),
        places("half a pixel left", PLUME, ImagePlane([-0.5, 0.0]))
            .named(&["half-a-pixel-left"])
            .number("camera.right", -0.5)
            .said(&["moved"]),
        places("a third of a pixel right", PLUME, ImagePlane([0.3, 0.0]))
            .number("camera.right", 0.3)
            .said(&["moved"]),
        places("a pixel and a half up", PLUME, ImagePlane([0.0, -1.5]))
            .named(&[
                "half-a-pixel-up + one-pixel-up",
                "one-pixel-up + half-a-pixel-up",
            ])
            .number("camera.down", -1.5)
            .said(&["moved"]),
        values(
            "gamma 1.8",
            PLUME,
            Image(|f| images::by_value(f, |x, _| math::exp(math::ln(x.max(1e-30)) / 1.8))),
        ),
        values(
            "clamped at 0.5",
            PLUME,
            Image(|f| images::by_value(f, |x, _| x.min(0.5))),
        )
        .said(&["cut off"]),
        values(
            "green + 5 %",
            PLUME,
            Image(|f| images::by_value(f, |x, c| if c == 1 { 1.05 * x } else { x })),
        )
        .number("gain.green", 0.05)
        .said(&["gain", "channel"]),
        places(
            "every sixteenth row black",
            PLUME,
            Image(|f| images::by_place(f, |x, [_, y]| if y % 16 == 0 { 0.0 } else { x })),
        )
        .said(&["black"]),
        values(
            "darker towards the corners",
            PLUME,
            Image(|f| images::by_place(f, |x, at| x * vignette(at))),
        ),
        values(
            "upper half at half brightness",
            PLUME,
            Image(|f| images::by_place(f, |x, [_, y]| if y < 128 { 0.5 * x } else { x })),
        )
        .said(&["place"]),
        ray_caster(
            "shadow rays of double step",
            SHADOWED,
            Ray(|s| {
                if let Some(s) = &mut s.shadow {
                    s.step *= 4.0;
                    s.reference_step *= 1.3
                }
            }),
        ),
        ray_caster("shadow too dark by half", SHADOWED, Ray(|s| shadow(s, 1.5))),
        ray_caster(
            "shadow too light by 30 %",
            SHADOWED,
            Ray(|s| shadow(s, 0.7)),
        ),
        ray_caster("shadow twice as dense", SHADOWED, Ray(|s| shadow(s, 2.0))),
        // Paths in a room.
        values(
            "samples clamped at 3",
            ROOM,
            Image(|f| images::by_value(f, |x, _| x.min(3.0))),
        )
        .said(&["cut off"]),
        values(
            "8-bit values, saturated at the exposure",
            ROOM,
            Image(|f| images::by_value(f, |x, c| eight_bits(x * 0.7, c) / 0.7)),
        )
        .named(&["clamped"])
        .said(&["cut off"]),
        geometry(
            "field of view 39.8°",
            ROOM,
            Path(|s| s.camera = s.camera.with_vertical_fov(39.8_f64.to_radians())),
        )
        .number("camera.view", view(40.0, 39.8))
        .said(&["moved"]),
        geometry(
            "field of view 41°",
            ROOM,
            Path(|s| s.camera = s.camera.with_vertical_fov(41_f64.to_radians())),
        )
        .number("camera.view", view(40.0, 41.0))
        .said(&["moved"]),
        number("lamp 20 % too bright", ROOM, Edit::Number("lamp", 0.2)).said(&["gain"]),
        geometry(
            "lamp moved by 40",
            ROOM,
            Path(|s| s.area_lights[0].shape = lamp(DVec3::new(153.0, 554.0, 127.0), 330.0, 305.0)),
        )
        .number("lamp.x", 40.0),
        geometry(
            "lamp 10 % smaller",
            ROOM,
            Path(|s| s.area_lights[0].shape = lamp(DVec3::new(113.0, 554.0, 127.0), 297.0, 305.0)),
        ),
        geometry(
            "lamp below the ceiling",
            ROOM,
            Path(|s| s.area_lights[0].shape = lamp(DVec3::new(113.0, 530.0, 127.0), 330.0, 305.0)),
        ),
        number(
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
        geometry(
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
        number(
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
        )
        .number("albedo.2", -0.1),
        number(
            "smoke denser by a third",
            ROOM,
            Edit::Number("density", 0.33),
        ),
        // It only scatters, and nothing else does.
        geometry("white smoke missing", ROOM, Path(|s| _ = s.media.pop()))
            .named(&["scattering-left-out"]),
        geometry("black smoke missing", ROOM, Path(|s| _ = s.media.remove(0)))
            .named(&["absorption-left-out"]),
        geometry("back wall missing", ROOM, Path(|s| _ = s.objects.pop())),
        geometry(
            "grey sky",
            ROOM,
            Path(|s| s.environment = DVec3::splat(0.03)),
        ),
        paths(
            "two bounces",
            ROOM,
            Path(|s| s.scattering = Scattering::Multiple(Some(2))),
        ),
        values(
            "offset of 0.02",
            ROOM,
            Image(|f| images::by_value(f, |x, _| x + 0.02)),
        )
        .number("offset", 0.02),
        values(
            "lower half darker by a tenth",
            ROOM,
            Image(|f| images::by_place(f, |x, [_, y]| if y >= 128 { 0.9 * x } else { x })),
        )
        .said(&["place"]),
        values(
            "green + 8 %, noisy",
            ROOM,
            Image(|f| images::by_value(f, |x, c| if c == 1 { 1.08 * x } else { x })),
        )
        .number("gain.green", 0.08)
        .said(&["gain", "channel"]),
        geometry(
            "eye to the side in the room",
            ROOM,
            Path(|s| s.camera = moved(&s.camera, DVec3::new(4.0, 0.0, 0.0))),
        )
        .number("camera.x", 4.0)
        .said(&["moved"]),
        places(
            "half a pixel down in the room",
            ROOM,
            ImagePlane([0.0, 0.5]),
        )
        .named(&["half-a-pixel-down"])
        .number("camera.down", 0.5)
        .said(&["moved"]),
        values("saturation of colours", ROOM, Image(|f| mixed(f, 1.2))),
        // Fog.
        number("g = 0.5", FOG, Edit::Number("g", -0.1)),
        number("g = 0.75", FOG, Edit::Number("g", 0.15)),
        number("fog denser by 15 %", FOG, Edit::Number("density", 0.15)),
        number("fog absorbs a fifth", FOG, Edit::Number("albedo", -0.2)),
        number("cone wider by 2°", FOG, Path(|s| cone(s, [16.0, 20.0]))).number("light.cone", 2.0),
        number("spotlight 10 % too dark", FOG, Edit::Number("light", -0.1)).said(&["gain"]),
        number(
            "spotlight lower",
            FOG,
            Path(|s| {
                if let Light::Spot(spot) = &mut s.lights[0] {
                    spot.position.y -= 0.5
                }
            }),
        )
        .number("light.y", -0.5),
        geometry(
            "ball too dark",
            FOG,
            Path(|s| {
                materials(s, |m| {
                    if *m == Material::Diffuse(DVec3::splat(0.75)) {
                        *m = Material::Diffuse(DVec3::splat(0.4))
                    }
                })
            }),
        )
        .number("reflectance.6", 0.4 / 0.75 - 1.0),
        values(
            "fog of falling brightness",
            FOG,
            Image(|f| images::by_place(f, |x, [_, y]| x * (1.0 - 0.3 * y as f32 / 192.0))),
        ),
        // Grids and noise.
        number("extinction + 10 %", STAIN, Edit::Number("density", 0.1)),
        field(
            "grid half a voxel along y",
            STAIN,
            Path(|s| grids(s, DVec3::new(0.0, 0.5, 0.0))),
        )
        .named(&["grid-half-voxel-along-y"]),
        field(
            "grid a voxel along x",
            STAIN,
            Path(|s| grids(s, DVec3::new(1.0, 0.0, 0.0))),
        )
        // Under a plain sky the same as an eye that is moved.
        .number("camera.x", -0.01)
        .said(&["moved"]),
        field("grid 2 % too large", STAIN, Path(|s| scaled(s, 1.02))).said(&["moved"]),
        number("sky of 0.9", STAIN, Edit::Number("environment", -0.1)).said(&["gain"]),
        number(
            "sun tilted",
            COLOURED,
            Path(|s| sun(s, DVec3::new(-0.9, -0.5, 0.5))),
        ),
        number("sky × 1.5", COLOURED, Edit::Number("environment", 0.5)),
        number("g = 0.2", COLOURED, Edit::Number("g", -0.2)),
        number(
            "albedo of red lower",
            COLOURED,
            Path(|s| {
                media(s, |a, s| {
                    (a + DVec3::new(6.0, 0.0, 0.0), s - DVec3::new(6.0, 0.0, 0.0))
                })
            }),
        )
        .said(&["channel"]),
        field(
            "threshold 1.3",
            NOISE,
            Path(|s| noises(s, |p| p.threshold = 1.3)),
        ),
        field("gain 0.4", NOISE, Path(|s| noises(s, |p| p.gain = 0.4))),
        field(
            "noise shifted",
            NOISE,
            Path(|s| noises(s, |p| p.offset.x += 0.2)),
        ),
        // Other faults of ray casters, as reported in public.
        ray_caster(
            "opacity in proportion to the step, of double step",
            PLUME,
            Ray(|s| {
                s.step *= 2.0;
                s.conventions.linear_opacity = true;
            }),
        )
        .by_conventions(&[
            "takes steps of twice the length",
            "takes opacity in proportion to the step",
        ]),
        ray_caster(
            "linear opacity, 90 % at most",
            SHADOWED,
            Ray(|s| {
                s.conventions.linear_opacity = true;
                s.conventions.most_opacity = 0.9;
            }),
        ),
        ray_caster(
            "colours of a table of 16 entries",
            COLUMN,
            Ray(|s| {
                s.conventions.table_size = Some(16);
                s.conventions.nearest_entry = true;
            }),
        ),
        ray_caster(
            "opacity correction below 0.3 left out",
            HEAD,
            Ray(|s| s.conventions.uncorrected_opacity = 0.3),
        ),
        ray_caster(
            "opacities of at most 0.5",
            HEAD,
            Ray(|s| s.conventions.most_opacity = 0.5),
        ),
        ray_caster(
            "samples below 0.1 dropped",
            HEAD,
            Ray(|s| s.conventions.least_stated_opacity = 0.1),
        ),
        ray_caster(
            "ends of rays opaque at 0.2",
            PLUME,
            Ray(|s| {
                s.end_rays_at(0.2);
                s.conventions.ended_rays_opaque = true;
            }),
        ),
        ray_caster(
            "highlights without their part of the emission, doubled",
            PLUME,
            Ray(|s| {
                s.conventions.highlight_emission = false;
                s.phong.as_mut().unwrap().specular = 2.0;
            }),
        ),
        field(
            "voxels a third longer along y",
            PLUME,
            Ray(|s| s.grid = stretched(&s.grid, DVec3::new(1.0, 4.0 / 3.0, 1.0))),
        ),
        field(
            "voxels 5 % longer along x",
            HEAD,
            Ray(|s| s.grid = stretched(&s.grid, DVec3::new(1.05, 1.0, 1.0))),
        ),
        field(
            "last slice along x missing",
            PLUME,
            Ray(|s| {
                s.grid = with_values(
                    &s.grid,
                    |[i, _, _], last, v| if i == last[0] { 0.0 } else { v },
                )
            }),
        ),
        field(
            "last slice along z missing",
            HEAD,
            Ray(|s| {
                s.grid = with_values(
                    &s.grid,
                    |[_, _, k], last, v| if k == last[2] { 0.0 } else { v },
                )
            }),
        ),
        field(
            "every eighth slice missing",
            PLUME,
            Ray(|s| {
                s.grid = with_values(&s.grid, |[_, j, _], _, v| if j % 8 == 0 { 0.0 } else { v })
            }),
        ),
        field(
            "densities of 4 bits",
            PLUME,
            Ray(|s| s.grid = with_values(&s.grid, |_, _, v| (v * 16.0).round() / 16.0)),
        ),
        field(
            "one octant empty",
            PLUME,
            Ray(|s| {
                s.grid = with_values(&s.grid, |at, last, v| {
                    if (0..3).all(|k| at[k] <= last[k] / 2) {
                        0.0
                    } else {
                        v
                    }
                })
            }),
        ),
        field(
            "densities + 0.02",
            COLUMN,
            Ray(|s| s.grid = with_values(&s.grid, |_, _, v| v + 5.0)),
        ),
        field(
            "grid of media: last slice missing",
            STAIN,
            Path(|s| {
                with_grids(s, |grid| {
                    with_values(
                        grid,
                        |[i, _, _], last, v| if i == last[0] { 0.0 } else { v },
                    )
                })
            }),
        ),
        field(
            "grid of media: every eighth slice missing",
            COLOURED,
            Path(|s| {
                with_grids(s, |grid| {
                    with_values(grid, |[_, j, _], _, v| if j % 8 == 0 { 0.0 } else { v })
                })
            }),
        ),
        field(
            "grid of media: densities of 3 bits",
            STAIN,
            Path(|s| {
                with_grids(s, |grid| {
                    with_values(grid, |_, _, v| (v * 8.0).round() / 8.0)
                })
            }),
        ),
        field(
            "grid of media 5 % too small",
            COLOURED,
            Path(|s| scaled(s, 0.95)),
        ),
        field(
            "grid of media a voxel along z",
            COLOURED,
            Path(|s| grids(s, DVec3::new(0.0, 0.0, 1.0))),
        )
        // Under a sky and a sun the same as an eye that is moved.
        .number("camera.z", -0.01),
        field(
            "noise with one octave more",
            NOISE,
            Path(|s| noises(s, |p| p.octaves += 1)),
        ),
        field(
            "noise of half the scale along y",
            NOISE,
            Path(|s| noises(s, |p| p.scale.y *= 0.5)),
        ),
        // The first panel is the one without a shadow.
        places(
            "first panel twice",
            SHADOWED,
            Image(|f| images::from_elsewhere(f, |[x, y], [w, _]| Some([x % (w / 2), y]))),
        )
        .named(&["shadow-left-out"]),
        // Other faults of rooms.
        geometry(
            "mirror ball missing",
            GREY,
            Path(|s| {
                s.objects
                    .retain(|it| !matches!(it.material, Material::Mirror(_)))
            }),
        ),
        geometry(
            "glass ball black",
            GREY,
            Path(|s| {
                materials(s, |m| {
                    if matches!(m, Material::Glass(_)) {
                        *m = Material::Diffuse(DVec3::ZERO)
                    }
                })
            }),
        )
        .at(64),
        geometry(
            "mirror diffuse",
            ABSORPTION,
            Path(|s| {
                materials(s, |m| {
                    if let Material::Mirror(colour) = *m {
                        *m = Material::Diffuse(colour)
                    }
                })
            }),
        ),
        geometry(
            "lamp at both sides",
            ABSORPTION,
            Path(|s| s.area_lights[0].sides = volref::optics::Sides::Both),
        )
        .named(&["emitter-sides-exchanged"]),
        geometry(
            "lamp a unit lower",
            ABSORPTION,
            Path(|s| s.area_lights[0].shape = lamp(DVec3::new(-1.5, 6.9, 3.5), 3.0, 3.0)),
        )
        .at(64),
        geometry(
            "fog without its left half",
            FOG,
            Path(|s| half_filled(s, DVec3::new(0.0, 0.0, 0.0), DVec3::new(5.0, 8.0, 10.0))),
        ),
        geometry(
            "fog only up to the ball",
            SPOT,
            Path(|s| half_filled(s, DVec3::new(-5.0, 0.0, 0.0), DVec3::new(5.0, 3.0, 10.0))),
        )
        .at(64),
        geometry("ball missing", SPOT, Path(|s| _ = s.objects.remove(5))),
        paths(
            "one bounce of two allowed",
            SPOT,
            Path(|s| s.scattering = Scattering::Multiple(Some(2))),
        )
        .at(64),
        paths(
            "five bounces",
            GREY,
            Path(|s| s.scattering = Scattering::Multiple(Some(5))),
        ),
        paths(
            "twelve bounces",
            GREY,
            Path(|s| s.scattering = Scattering::Multiple(Some(12))),
        )
        .at(64),
        paths(
            "ten bounces",
            COLOURED,
            Path(|s| s.scattering = Scattering::Multiple(Some(10))),
        ),
        paths(
            "twenty bounces",
            COLOURED,
            Path(|s| s.scattering = Scattering::Multiple(Some(20))),
        )
        .at(64),
    ]
}

/// Change of the height of the image plane between two fields of view, in degrees.
fn view(from: f64, to: f64) -> f64 {
    let [from, to] = [from, to].map(|angle| math::tan(0.5 * angle.to_radians()));
    to / from - 1.0
}

/// Density towards the light times a factor.
fn shadow(scene: &mut Classified, factor: f64) {
    if let Some(shadow) = &mut scene.shadow {
        shadow.reference_step /= factor
    }
}

fn moved(camera: &Camera, by: DVec3) -> Camera {
    camera.with_eye_moved(by)
}

fn along(grid: &Grid<f32>, voxels: DVec3) -> Arc<Grid<f32>> {
    let old = grid.lattice();
    let first = old.first() + old.spacing() * voxels;
    on(
        Lattice::new(old.nodes(), old.spacing(), first).unwrap(),
        grid,
    )
}

/// With voxels of another size, from the same first node.
fn stretched(grid: &Grid<f32>, factors: DVec3) -> Arc<Grid<f32>> {
    let old = grid.lattice();
    on(
        Lattice::new(old.nodes(), old.spacing() * factors, old.first()).unwrap(),
        grid,
    )
}

/// With values by node, last node and value.
fn with_values(
    grid: &Grid<f32>,
    edit: impl Fn([usize; 3], [usize; 3], f32) -> f32,
) -> Arc<Grid<f32>> {
    let lattice = *grid.lattice();
    let last = lattice.nodes().map(|count| count - 1);
    let values = grid.values().iter().enumerate();
    let values = values.map(|(index, &value)| edit(lattice.node(index), last, value));
    Arc::new(Grid::new(lattice, values.collect()).unwrap())
}

fn on(lattice: Lattice, grid: &Grid<f32>) -> Arc<Grid<f32>> {
    let lattice = lattice.with_centring(grid.lattice().centring()).unwrap();
    Arc::new(Grid::new(lattice, grid.values().to_vec()).unwrap())
}

fn with_grids(scene: &mut Radiative, edit: impl Fn(&Grid<f32>) -> Arc<Grid<f32>>) {
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

fn noises(scene: &mut Radiative, edit: fn(&mut FractalParameters)) {
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

/// The last medium within another box.
fn half_filled(scene: &mut Radiative, min: DVec3, max: DVec3) {
    if let Some(body) = scene.media.last_mut() {
        body.boundary = Some(Boundary::Box(Aabb::new(min, max).unwrap()));
    }
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

fn eight_bits(x: f64, _: usize) -> f64 {
    (255.0 * x).round().clamp(0.0, 255.0) / 255.0
}

fn vignette([x, y]: [usize; 2]) -> f32 {
    let [x, y] = [x, y].map(|i| (i as f32 - 127.5) / 128.0);
    1.0 - 0.25 * (x * x + y * y)
}

/// Colours away from their grey by this factor.
fn mixed(film: &Film, factor: f32) -> Film {
    images::by_pixel(film, |pixel, _| {
        let grey = (pixel[0] + pixel[1] + pixel[2]) / 3.0;
        pixel.map(|x| (grey + factor * (x - grey)).max(0.0))
    })
}
