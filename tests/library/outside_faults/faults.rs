//! Faults that are in no catalogue, as data: the case, an edit of its scene or image, and the truth
//! that a verdict is judged by.

use super::images::{self, by_place, by_value, channels, from_elsewhere, is_one_of_twenty, times};
use crate::common::suite::case_of;
use glam::DVec3;
use std::f64::consts::LN_10;
use std::sync::Arc;
use volref::film::Film;
use volref::geometry::{Aabb, Boundary, Luminous, Rectangle};
use volref::math;
use volref::math::rng::philox4x32_10;
use volref::optics::{Appearance, Coefficients, Colormap, Field, Light, Material, Sides};
use volref::scene::{Classified, Radiative, Scattering, Scene};
use volref::sensitivity::numbers;
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
    /// What may be said of the image: mistakes or pairs of them, conventions, changes of numbers
    /// ("density +0.1"), labels of [`super::verdict::CLAIMS`] and of measurements.
    pub truth: Vec<String>,
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
    Together,
}

#[derive(Clone)]
pub enum Edit {
    Classified(fn(&mut Classified)),
    Radiative(fn(&mut Radiative)),
    /// A number of the scene, by its name.
    Number(String, f64),
    /// A mistake of the catalogue.
    Mistake(&'static str),
    /// A convention, in words.
    Convention(&'static str),
    /// The image plane moved by parts of a pixel, to the right and down.
    ImagePlane([f64; 2]),
    Film(fn(&Film) -> Film),
}

use Edit::{Classified as Ray, Convention, Film as Image, ImagePlane, Mistake, Radiative as Path};

fn number(name: &str, change: f64) -> Edit {
    Edit::Number(name.to_owned(), change)
}

impl Fault {
    /// Its truth is `truth`, parts of which are divided by ", ", and what its edits say of themselves.
    pub fn new(kind: Kind, name: &str, case: &'static str, edits: Vec<Edit>, truth: &str) -> Fault {
        let parts = truth.split(", ").filter(|part| !part.is_empty());
        let mut truth: Vec<String> = parts.map(str::to_owned).collect();
        for edit in &edits {
            match edit {
                Edit::Number(number, change) => truth.push(format!("{number} {change:+}")),
                Convention(words) | Mistake(words) => truth.push((*words).to_owned()),
                _ => {}
            }
        }
        if let [Mistake(one), Mistake(other)] = &edits[..] {
            truth.extend([format!("{one} + {other}"), format!("{other} + {one}")]);
        }
        Fault {
            kind,
            name: name.to_owned(),
            case,
            samples: 16,
            edits,
            truth,
        }
    }
}

const PLUME: &str = "figures/figure-3";
const SHADOWED: &str = "figures/figure-5";
const COLUMN: &str = "sampled/column";
const HEAD: &str = "sampled/perspective-z-up";
const ROOM: &str = "smoke/cornell";
const FOG: &str = "fog/forward";
const GREY: &str = "fog/rate-0.1";
const SPOT: &str = "fog/spotlight";
const ABSORPTION: &str = "fog/absorption";
const STAIN: &str = "procedural/absorbing-grid";
const COLOURED: &str = "procedural/coloured";
const NOISE: &str = "procedural/threshold-1.25";

/// Cases whose numbers are drawn, and how many of each.
const DRAWN: [(&str, usize); 15] = [
    (PLUME, 14),
    (SHADOWED, 5),
    (COLUMN, 4),
    (HEAD, 6),
    ("limit/plume", 4),
    ("limit/thin-haze", 3),
    (ROOM, 18),
    (FOG, 16),
    (GREY, 10),
    (SPOT, 6),
    (ABSORPTION, 6),
    ("fog/dense-body", 5),
    (STAIN, 6),
    (COLOURED, 12),
    (NOISE, 5),
];

/// Sizes of the drawn changes, in steps of derivatives: near and far, and none that a mistake of the catalogue makes.
const SIZES: [f64; 8] = [1.5, -2.3, 3.7, -5.3, 7.1, -9.7, 13.3, -17.9];

/// All faults. Every other one of a case is made at 64 samples.
pub fn faults() -> Vec<Fault> {
    let mut all = by_hand();
    for (case, count) in DRAWN {
        let scene = case_of(case).load_scene().unwrap();
        all.extend(drawn(case, &scene, count));
    }
    for (fault, samples) in all.iter_mut().zip([16, 64].into_iter().cycle()) {
        fault.samples = samples;
    }
    all
}

/// Numbers that are off, drawn from those of the scene; the last of four together with another.
fn drawn(case: &'static str, scene: &Scene, count: usize) -> Vec<Fault> {
    let numbers = numbers(scene);
    let draws = (0..).map(|i| philox4x32_10([i, 0, 0, 0], [0x6e75_6d62, case.len() as u32]));
    let possible = draws.filter_map(|[which, size, ..]| {
        let number = &numbers[which as usize % numbers.len()];
        let change = number.step * SIZES[size as usize % SIZES.len()];
        number.changed(scene, change)?;
        Some((number.name(), change))
    });
    let mut all: Vec<Fault> = Vec::new();
    let mut last: Option<(String, f64)> = None;
    for (name, change) in possible.take(20 * count) {
        let labels = match name.split('.').next().unwrap() {
            "camera" | "grid" => "moved",
            "lamp" | "light" | "environment" | "emission" => "gain",
            _ => "",
        };
        let mut edits = vec![Edit::Number(name.clone(), change)];
        let mut title = format!("{name} {change:+.3}");
        let mut kind = Kind::Number;
        if let Some((other, by)) = last.take_if(|last| all.len() % 4 == 3 && last.0 != name) {
            title += &format!(", {other} {by:+.3}");
            edits.push(Edit::Number(other, by));
            kind = Kind::Together;
        }
        if all.iter().all(|fault| fault.name != title) {
            all.push(Fault::new(kind, &title, case, edits, labels));
        }
        last = Some((name, change));
        if all.len() == count {
            break;
        }
    }
    all
}

/// One line a fault: kind, name, cases, edits, truth.
macro_rules! rows {
    ($($kind:ident $name:literal [$($case:ident)+] $edit:expr $(, $other:expr)?; $truth:literal)*) => {
        {
            let mut all = Vec::new();
            $(for case in [$($case),+] {
                all.push(Fault::new(Kind::$kind, $name, case, vec![$edit $(, $other)?], $truth));
            })*
            all
        }
    };
}

fn by_hand() -> Vec<Fault> {
    rows! {
        // A ray caster.
        RayCaster "step × 1.5" [PLUME] Ray(|s| s.step *= 1.5); "step +0.5, step"
        Number "opacity + 10 %" [PLUME] number("density", 0.1); ""
        Together "diffuse 0.7, opacity + 10 %" [PLUME] number("diffuse", -0.3), number("density", 0.1); ""
        RayCaster "shininess 20" [PLUME] Ray(|s| s.phong.as_mut().unwrap().shininess = 20); ""
        RayCaster "background 0.05" [PLUME] Ray(|s| s.background = DVec3::splat(0.05)); ""
        RayCaster "another map of colours" [PLUME] Ray(|s| {
            if let Appearance::Formula { colormap, .. } = &mut s.transfer_function.appearance {
                *colormap = Colormap::named("turbo").unwrap();
            }
        }); ""
        RayCaster "early end at 0.3" [PLUME] Ray(|s| s.end_rays_at(0.3)); ""
        RayCaster "shadow rays of double step" [SHADOWED] Ray(|s| {
            let shadow = s.shadow.iter_mut();
            shadow.for_each(|s| (s.step, s.reference_step) = (4.0 * s.step, 1.3 * s.reference_step));
        }); ""
        RayCaster "shadow too dark by half" [SHADOWED] Ray(|s| shadow(s, 1.5)); ""
        RayCaster "shadow too light by 30 %" [SHADOWED] Ray(|s| shadow(s, 0.7)); ""
        RayCaster "opacity in proportion to the step, of double step" [PLUME] Ray(|s| {
            s.step *= 2.0;
            s.conventions.linear_opacity = true;
        }); "takes steps of twice the length, takes opacity in proportion to the step"
        RayCaster "linear opacity, 90 % at most" [SHADOWED] Ray(|s| {
            s.conventions.linear_opacity = true;
            s.conventions.most_opacity = 0.9;
        }); ""
        RayCaster "colours of a table of 16 entries" [COLUMN] Ray(|s| {
            s.conventions.table_size = Some(16);
            s.conventions.nearest_entry = true;
        }); ""
        RayCaster "opacity correction below 0.3 left out" [HEAD] Ray(|s| s.conventions.uncorrected_opacity = 0.3); ""
        RayCaster "opacities of at most 0.5" [HEAD] Ray(|s| s.conventions.most_opacity = 0.5); ""
        RayCaster "samples below 0.1 dropped" [HEAD] Ray(|s| s.conventions.least_stated_opacity = 0.1); ""
        RayCaster "ends of rays opaque at 0.2" [PLUME] Ray(|s| {
            s.end_rays_at(0.2);
            s.conventions.ended_rays_opaque = true;
        }); ""
        RayCaster "highlights without their part of the emission, doubled" [PLUME] Ray(|s| {
            s.conventions.highlight_emission = false;
            s.phong.as_mut().unwrap().specular = 2.0;
        }); ""
        // Grids and noise.
        Field "quarter of a voxel along y" [PLUME] Ray(|s| along(s, [0.0, 0.25, 0.0])); "grid.y +0.25, moved"
        Field "half a voxel along x" [PLUME] Ray(|s| along(s, [0.5, 0.0, 0.0]));
            "volume-half-voxel-along-x, grid.x +0.5"
        Field "half a voxel back along z" [PLUME] Ray(|s| along(s, [0.0, 0.0, -0.5]));
            "volume-half-voxel-back-along-z, grid.z -0.5"
        Field "voxels a third longer along y" [PLUME] Ray(|s| stretched(s, [1.0, 4.0 / 3.0, 1.0])); ""
        Field "voxels 5 % longer along x" [HEAD] Ray(|s| stretched(s, [1.05, 1.0, 1.0])); ""
        Field "last slice along x missing" [PLUME HEAD]
            Ray(|s| with_values(s, |[i, _, _], last, v| if i == last[0] { 0.0 } else { v })); ""
        Field "every eighth slice missing" [PLUME]
            Ray(|s| with_values(s, |[_, j, _], _, v| if j % 8 == 0 { 0.0 } else { v })); ""
        Field "densities of 4 bits" [PLUME] Ray(|s| with_values(s, |_, _, v| (v * 16.0).round() / 16.0)); ""
        Field "one octant empty" [PLUME] Ray(|s| with_values(s, |at, last, v| {
            if (0..3).all(|k| at[k] <= last[k] / 2) { 0.0 } else { v }
        })); ""
        Field "densities + 0.02" [COLUMN] Ray(|s| with_values(s, |_, _, v| v + 5.0)); ""
        Field "grid half a voxel along y" [STAIN] Path(|s| grids(s, |g| shifted(g, [0.0, 0.5, 0.0])));
            "grid-half-voxel-along-y"
        // Under a plain sky, and under a sun, the same as an eye that is moved.
        Field "grid a voxel along x" [STAIN] Path(|s| grids(s, |g| shifted(g, [1.0, 0.0, 0.0]))); "camera.x -0.01, moved"
        Field "grid of media a voxel along z" [COLOURED] Path(|s| grids(s, |g| shifted(g, [0.0, 0.0, 1.0])));
            "camera.z -0.01"
        Field "grid of media 5 % too small" [COLOURED STAIN] Path(|s| grids(s, |g| scaled(g, [0.95; 3]))); "moved"
        Field "grid of media: last slice missing" [STAIN] Path(|s| grids(s, |g| {
            valued(g, |[i, _, _], last, v| if i == last[0] { 0.0 } else { v })
        })); ""
        Field "grid of media: densities of 3 bits" [STAIN]
            Path(|s| grids(s, |g| valued(g, |_, _, v| (v * 8.0).round() / 8.0))); ""
        Field "threshold 1.3" [NOISE] Path(|s| noises(s, |p| p.threshold = 1.3)); ""
        Field "gain 0.4" [NOISE] Path(|s| noises(s, |p| p.gain = 0.4)); ""
        Field "noise shifted" [NOISE] Path(|s| noises(s, |p| p.offset.x += 0.2)); ""
        Field "noise with one octave more" [NOISE] Path(|s| noises(s, |p| p.octaves += 1)); ""
        Field "noise of half the scale along y" [NOISE] Path(|s| noises(s, |p| p.scale.y *= 0.5)); ""
        // Views.
        Geometry "field of view 39.8°" [ROOM]
            Path(|s| s.camera = s.camera.with_vertical_fov(39.8_f64.to_radians())); "camera.view -0.005427, moved"
        Geometry "field of view 46°" [PLUME]
            Ray(|s| s.camera = s.camera.with_vertical_fov(46_f64.to_radians())); "camera.view +0.024773"
        Geometry "eye to the side" [PLUME]
            Ray(|s| s.camera = s.camera.with_eye_moved(DVec3::new(0.02, 0.0, 0.0))); "camera.x +0.02, moved"
        Places "half a pixel down" [PLUME ROOM] ImagePlane([0.0, 0.5]); "half-a-pixel-down, camera.down +0.5, moved"
        Places "a third of a pixel right" [PLUME] ImagePlane([0.3, 0.0]); "camera.right +0.3, moved"
        Places "a pixel and a half up" [PLUME] ImagePlane([0.0, -1.5]);
            "half-a-pixel-up + one-pixel-up, one-pixel-up + half-a-pixel-up, camera.down -1.5, moved"
        // Rooms.
        Geometry "lamp moved by 40" [ROOM] Path(|s| lamp(s, [153.0, 554.0, 127.0], [330.0, 305.0])); "lamp.x +40"
        Geometry "lamp 10 % smaller" [ROOM] Path(|s| lamp(s, [113.0, 554.0, 127.0], [297.0, 305.0])); ""
        Geometry "lamp below the ceiling" [ROOM] Path(|s| lamp(s, [113.0, 530.0, 127.0], [330.0, 305.0])); ""
        Geometry "lamp at both sides" [ABSORPTION] Path(|s| s.area_lights[0].sides = Sides::Both);
            "emitter-sides-exchanged"
        Number "white walls too dark" [ROOM] Path(|s| materials(s, |m| {
            if *m == Material::Diffuse(DVec3::splat(0.73)) { *m = Material::Diffuse(DVec3::splat(0.65)) }
        })); ""
        Geometry "red and green walls exchanged" [ROOM] Path(|s| materials(s, |m| {
            let [red, green] = [DVec3::new(0.65, 0.05, 0.05), DVec3::new(0.12, 0.45, 0.15)];
            match m {
                Material::Diffuse(colour) if *colour == red => *colour = green,
                Material::Diffuse(colour) if *colour == green => *colour = red,
                _ => {}
            }
        })); ""
        Number "white smoke absorbs a tenth" [ROOM] Path(|s| {
            media(s, |a, s| if s == DVec3::ZERO { [a, s] } else { [0.1 * s, 0.9 * s] })
        }); "albedo.2 -0.1"
        Number "albedo of red lower" [COLOURED] Path(|s| {
            media(s, |a, s| [a + DVec3::new(6.0, 0.0, 0.0), s - DVec3::new(6.0, 0.0, 0.0)])
        }); "channel"
        // The white smoke only scatters, and nothing else does.
        Geometry "white smoke missing" [ROOM] Path(|s| _ = s.media.pop()); "scattering-left-out"
        Geometry "black smoke missing" [ROOM] Path(|s| _ = s.media.remove(0)); "absorption-left-out"
        Geometry "back wall missing" [ROOM] Path(|s| _ = s.objects.pop()); ""
        Geometry "ball missing" [SPOT] Path(|s| _ = s.objects.remove(5)); ""
        Geometry "grey sky" [ROOM] Path(|s| s.environment = DVec3::splat(0.03)); ""
        Geometry "mirror ball missing" [GREY]
            Path(|s| s.objects.retain(|it| !matches!(it.material, Material::Mirror(_)))); ""
        Geometry "glass ball black" [GREY] Path(|s| materials(s, |m| {
            if matches!(m, Material::Glass(_)) { *m = Material::Diffuse(DVec3::ZERO) }
        })); ""
        Geometry "mirror diffuse" [ABSORPTION] Path(|s| materials(s, |m| {
            if let Material::Mirror(colour) = *m { *m = Material::Diffuse(colour) }
        })); ""
        Geometry "fog without its left half" [FOG] Path(|s| filled(s, [0.0, 0.0, 0.0], [5.0, 8.0, 10.0])); ""
        Geometry "fog only up to the ball" [SPOT] Path(|s| filled(s, [-5.0, 0.0, 0.0], [5.0, 3.0, 10.0])); ""
        Number "spotlight lower" [FOG] Path(|s| {
            if let Light::Spot(spot) = &mut s.lights[0] { spot.position.y -= 0.5 }
        }); "light.y -0.5"
        PathTracer "two bounces" [ROOM SPOT] Path(|s| s.scattering = Scattering::Multiple(Some(2))); ""
        PathTracer "five bounces" [GREY] Path(|s| s.scattering = Scattering::Multiple(Some(5))); ""
        PathTracer "twelve bounces" [GREY COLOURED] Path(|s| s.scattering = Scattering::Multiple(Some(12))); ""
        // Values of images.
        Values "gamma 1.8" [PLUME] Image(|f| by_value(f, |x, _| power(x, 1.0 / 1.8))); ""
        Values "clamped at 0.5" [PLUME] Image(|f| by_value(f, |x, _| x.min(0.5))); "cut off"
        Values "samples clamped at 3" [ROOM] Image(|f| by_value(f, |x, _| x.min(3.0))); "cut off"
        Values "8-bit values, saturated at the exposure" [ROOM]
            Image(|f| by_value(f, |x, _| (255.0 * 0.7 * x).round().clamp(0.0, 255.0) / 255.0 / 0.7)); "clamped, cut off"
        Values "values of 6 bits" [PLUME STAIN HEAD] Image(|f| by_value(f, |x, _| (63.0 * x).round() / 63.0)); ""
        Values "exposure + 1.4 %" [FOG ROOM SPOT] Image(|f| times(f, [1.014; 3])); "exposure +0.014, gain, channel"
        Values "exposure − 5 %" [FOG COLOURED PLUME] Image(|f| times(f, [0.95; 3])); "exposure -0.05, gain, channel"
        Values "3 % of the brightness" [ROOM PLUME FOG COLOURED] Image(|f| times(f, [0.03; 3]));
            "exposure -0.97, gain, channel"
        Values "brightness × 2.5" [GREY HEAD] Image(|f| times(f, [2.5; 3])); "exposure +1.5, gain, channel"
        Values "green + 8 %" [ROOM PLUME] Image(|f| times(f, [1.0, 1.08, 1.0])); "gain.green +0.08, gain, channel"
        Values "blue − 3 %" [ROOM COLOURED PLUME] Image(|f| times(f, [1.0, 1.0, 0.97])); "gain.blue -0.03, gain, channel"
        Values "all values + 0.005" [ROOM FOG PLUME] Image(|f| by_value(f, |x, _| x + 0.005)); "offset +0.005, gain"
        Values "exponent 1.05" [ROOM PLUME COLOURED] Image(|f| by_value(f, |x, _| power(x, 1.05))); "gamma +0.05, gain"
        Values "a curve of film" [ROOM HEAD] Image(|f| by_value(f, |x, _| x * (1.2 + 0.1 * x) / (1.0 + 0.4 * x))); ""
        Values "stated variance halved" [ROOM FOG COLOURED] Image(|f| images::noise_times(f, 0.5)); "noise"
        Values "saturation of colours" [ROOM] Image(|f| images::by_pixel(f, |pixel, _| {
            let grey = (pixel[0] + pixel[1] + pixel[2]) / 3.0;
            pixel.map(|x| (grey + 1.2 * (x - grey)).max(0.0))
        })); ""
        Values "darker towards the corners" [PLUME] Image(|f| by_place(f, |x, at| {
            let [u, v] = at.map(|i| (i as f32 - 127.5) / 128.0);
            x * (1.0 - 0.25 * (u * u + v * v))
        })); ""
        Values "upper half at half brightness" [PLUME]
            Image(|f| by_place(f, |x, [_, y]| if y < 128 { 0.5 * x } else { x })); "place"
        Values "fog of falling brightness" [FOG] Image(|f| by_place(f, |x, [_, y]| x * (1.0 - 0.3 * y as f32 / 192.0))); ""
        Places "green in all channels" [ROOM COLUMN] Image(|f| channels(f, [1, 1, 1])); ""
        // Pixels of images.
        Places "every sixteenth row black" [PLUME]
            Image(|f| by_place(f, |x, [_, y]| if y % 16 == 0 { 0.0 } else { x })); "black"
        Places "first row black" [ROOM FOG GREY COLOURED]
            Image(|f| from_elsewhere(f, |[x, y], _| (y > 0).then_some([x, y]))); "black"
        Places "last column black" [FOG ROOM]
            Image(|f| from_elsewhere(f, |[x, y], [w, _]| (x + 1 < w).then_some([x, y]))); "black"
        Places "20 black pixels" [ROOM FOG SPOT PLUME]
            Image(|f| from_elsewhere(f, |at, size| (!is_one_of_twenty(at, size)).then_some(at))); "black"
        Places "a black pixel" [ROOM FOG PLUME]
            Image(|f| from_elsewhere(f, |at, [w, h]| (at != [w / 2, h / 2]).then_some(at))); "black"
        Places "a tile of 16 × 16 black" [ROOM GREY PLUME]
            Image(|f| from_elsewhere(f, |[x, y], _| (x / 16 != 4 || y / 16 != 4).then_some([x, y]))); "black, place"
        Places "20 pixels ten times as bright" [ROOM FOG PLUME] Image(|f| {
            let size = [f.width(), f.height()];
            by_place(f, move |x, at| if is_one_of_twenty(at, size) { 10.0 * x } else { x })
        }); ""
        Places "eight columns copied from their neighbours" [ROOM FOG PLUME] Image(|f| {
            from_elsewhere(f, |[x, y], _| Some([if (96..104).contains(&x) { x - 8 } else { x }, y]))
        }); "place"
        Places "odd rows copied from even ones" [ROOM PLUME STAIN]
            Image(|f| from_elsewhere(f, |[x, y], _| Some([x, y / 2 * 2]))); ""
        Places "right half a row lower" [ROOM PLUME] Image(|f| {
            from_elsewhere(f, |[x, y], [w, _]| Some([x, if x >= w / 2 { y.saturating_sub(1) } else { y }]))
        }); "moved, place"
        Places "two rows lower" [PLUME ROOM HEAD]
            Image(|f| from_elsewhere(f, |[x, y], _| Some([x, y.saturating_sub(2)]))); "camera.down +2, moved"
        Places "left half mirrored to the right" [ROOM PLUME FOG]
            Image(|f| from_elsewhere(f, |[x, y], [w, _]| Some([x.min(w - 1 - x), y]))); "place"
        Places "two tiles exchanged" [ROOM FOG PLUME] Image(|f| from_elsewhere(f, |[x, y], _| {
            Some([match x / 32 { 1 => x + 64, 3 => x - 64, _ => x }, y])
        })); ""
        Places "panels exchanged" [SHADOWED] Image(|f| from_elsewhere(f, |[x, y], [w, _]| Some([(x + w / 2) % w, y]))); ""
        // The first panel is the one without a shadow.
        Places "first panel twice" [SHADOWED]
            Image(|f| from_elsewhere(f, |[x, y], [w, _]| Some([x % (w / 2), y]))); "shadow-left-out"
        Places "green a pixel to the right" [ROOM PLUME] Image(|f| {
            let moved = from_elsewhere(f, |[x, y], _| Some([x.saturating_sub(1), y]));
            images::by_pixel(f, |[r, _, b], [x, y]| [r, moved.radiance()[x + y * moved.width()][1], b])
        }); "channel, moved"
        Places "scaled to nine tenths" [ROOM HEAD] Image(|f| from_elsewhere(f, |[x, y], [w, h]| {
            Some([(x * 10 / 9).min(w - 1), (y * 10 / 9).min(h - 1)])
        })); ""
        // Two of different kinds together.
        Together "diffuse − 20 %, one pixel right" [PLUME] number("diffuse", -0.2), Mistake("one-pixel-right"); ""
        Together "no highlights, half a voxel back" [PLUME]
            Mistake("specular-left-out"), Mistake("volume-half-voxel-back"); ""
        Together "no shading, upside down" [PLUME] Mistake("shading-left-out"), Mistake("upside-down"); ""
        Together "linear opacity, extinction − 10 %" [PLUME]
            Convention("takes opacity in proportion to the step"), number("density", -0.1); ""
        Together "half-vector highlights, mirrored" [PLUME]
            Convention("takes highlights by the half vector (Blinn)"), Mistake("mirrored"); ""
        Together "nearest node, sRGB" [HEAD] Mistake("nearest-for-trilinear"), Mistake("srgb-encoded"); ""
        Together "emitter over π, mirrored" [ROOM] Mistake("emitter-over-pi"), Mistake("mirrored");
            "lamp -0.6817, bright-over-pi + mirrored, mirrored + bright-over-pi"
        Together "media left out, lamp − 10 %" [ROOM] number("lamp", -0.1), Mistake("media-left-out"); ""
        Together "phase reversed, bright twice" [FOG] Mistake("phase-reversed"), Mistake("bright-doubled"); ""
        Together "base ten, half a pixel down" [GREY] number("density", LN_10 - 1.0), Mistake("half-a-pixel-down");
            "extinction-base-ten + half-a-pixel-down, half-a-pixel-down + extinction-base-ten"
        Together "sky doubled, red and blue exchanged" [COLOURED]
            Mistake("environment-doubled"), Mistake("red-and-blue-exchanged"); "environment +1"
        Together "one octave, noise + 20 %" [NOISE] number("density", 0.2), Mistake("noise-of-one-octave"); ""
    }
}

/// Density towards the light times a factor.
fn shadow(scene: &mut Classified, factor: f64) {
    if let Some(shadow) = &mut scene.shadow {
        shadow.reference_step /= factor;
    }
}

/// With values by node, last node and value.
fn valued(grid: &Grid<f32>, edit: fn([usize; 3], [usize; 3], f32) -> f32) -> Grid<f32> {
    let lattice = *grid.lattice();
    let last = lattice.nodes().map(|count| count - 1);
    let values = grid.values().iter().enumerate();
    let values = values.map(|(index, &value)| edit(lattice.node(index), last, value));
    Grid::new(lattice, values.collect()).unwrap()
}

/// Moved by so many voxels.
fn shifted(grid: &Grid<f32>, voxels: [f64; 3]) -> Grid<f32> {
    let old = grid.lattice();
    let first = old.first() + old.spacing() * DVec3::from(voxels);
    on(old.nodes(), old.spacing(), first, grid)
}

/// With voxels of another size, from the same first node.
fn scaled(grid: &Grid<f32>, factors: [f64; 3]) -> Grid<f32> {
    let old = grid.lattice();
    let spacing = old.spacing() * DVec3::from(factors);
    on(old.nodes(), spacing, old.first(), grid)
}

fn on(nodes: [usize; 3], spacing: DVec3, first: DVec3, grid: &Grid<f32>) -> Grid<f32> {
    let lattice = Lattice::new(nodes, spacing, first).unwrap();
    let lattice = lattice.with_centring(grid.lattice().centring()).unwrap();
    Grid::new(lattice, grid.values().to_vec()).unwrap()
}

fn along(scene: &mut Classified, voxels: [f64; 3]) {
    scene.grid = Arc::new(shifted(&scene.grid, voxels));
}

fn stretched(scene: &mut Classified, factors: [f64; 3]) {
    scene.grid = Arc::new(scaled(&scene.grid, factors));
}

fn with_values(scene: &mut Classified, edit: fn([usize; 3], [usize; 3], f32) -> f32) {
    scene.grid = Arc::new(valued(&scene.grid, edit));
}

/// Edits the grids of media.
fn grids(scene: &mut Radiative, edit: fn(&Grid<f32>) -> Grid<f32>) {
    for density in scene.media.iter_mut().flat_map(|body| &mut body.density) {
        if let Field::Grid(field) = density.field() {
            let grid = GridDensity::new(Arc::new(edit(field.grid())), field.interpolation());
            *density = density.with_field(Field::Grid(grid));
        }
    }
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

/// The first lamp as another rectangle.
fn lamp(scene: &mut Radiative, corner: [f64; 3], [width, depth]: [f64; 2]) {
    let edges = [DVec3::new(width, 0.0, 0.0), DVec3::new(0.0, 0.0, depth)];
    let rectangle = Rectangle::new(corner.into(), edges[0], edges[1]).unwrap();
    scene.area_lights[0].shape = Luminous::Rectangle(rectangle);
}

/// The last medium within another box.
fn filled(scene: &mut Radiative, min: [f64; 3], max: [f64; 3]) {
    let body = scene.media.last_mut().unwrap();
    body.boundary = Some(Boundary::Box(Aabb::new(min.into(), max.into()).unwrap()));
}

fn materials(scene: &mut Radiative, edit: fn(&mut Material)) {
    for object in &mut scene.objects {
        edit(&mut object.material);
    }
}

fn media(scene: &mut Radiative, edit: fn(DVec3, DVec3) -> [DVec3; 2]) {
    for body in &mut scene.media {
        let old = body.medium.coefficients;
        let [sigma_a, sigma_s] = edit(old.sigma_a(), old.sigma_s());
        body.medium.coefficients = Coefficients::new(sigma_a, sigma_s).unwrap();
    }
}

fn power(x: f64, exponent: f64) -> f64 {
    if x > 0.0 {
        math::exp(exponent * math::ln(x))
    } else {
        x
    }
}
