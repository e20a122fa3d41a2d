//! Several volumes, surfaces and clips in one classified scene.
//!
//! Closed forms are worked out from extinctions, lengths and weights, never by the code they judge. On
//! generated scenes the fast caster, which streams a merge of steps and adds optical depths, is compared
//! with the plain one, which lists all pieces and multiplies transparencies.

use crate::common::suite::film_of as fast;
use glam::{DMat3, DVec3};
use std::path::Path;
use volref::film::Film;
use volref::math::rng::philox4x32_10;
use volref::math::{exp, exp_m1, ln_1p};
use volref::reference;
use volref::render::{Sampling, plans, render};
use volref::scene::{Fault, Scene};
use volref::variations::mistakes;

const SIDE: usize = 8;

/// A number of 32 bits is rounded by up to half of this, relative to it.
const ULP: f64 = f32::EPSILON as f64;

/// Writes a grid of `values`, x fastest, whose outermost nodes are corners of a box.
fn write_grid(folder: &Path, name: &str, nodes: [usize; 3], bounds: [DVec3; 2], values: &[f32]) {
    let [nx, ny, nz] = nodes;
    let steps = DVec3::from_array(nodes.map(|nodes| (nodes - 1) as f64));
    let (first, spacing) = (bounds[0], (bounds[1] - bounds[0]) / steps);
    let mut bytes = format!(
        "NRRD0004\ntype: float\ndimension: 3\nsizes: {nx} {ny} {nz}\nencoding: raw\nendian: little\n\
         space dimension: 3\nspace directions: ({},0,0) (0,{},0) (0,0,{})\nspace origin: ({},{},{})\n\n",
        spacing.x, spacing.y, spacing.z, first.x, first.y, first.z
    )
    .into_bytes();
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    std::fs::write(folder.join(name), bytes).unwrap();
}

/// A constant volume from `near` to `far` along z, beyond the picture in x and y.
fn slab(folder: &Path, name: &str, near: f64, far: f64) {
    let bounds = [DVec3::new(-2.0, -2.0, near), DVec3::new(2.0, 2.0, far)];
    write_grid(folder, name, [2, 2, 2], bounds, &[1.0; 8]);
}

/// A transfer function of one colour, and the extinction of its opacity.
fn look(colour: [f64; 3], opacity: f64) -> (String, f64) {
    const REFERENCE: f64 = 0.5;
    let text = format!(
        "transfer_function = {{ reference_length = {REFERENCE}, point = [{{ value = 0, colour = {colour:?}, opacity = {opacity} }}] }}"
    );
    (text, -ln_1p(-opacity) / REFERENCE)
}

const BACKGROUND: DVec3 = DVec3::new(0.25, 0.5, 0.125);

/// Parallel rays along z, from z = −4 on.
const VIEW: &str = "[camera]\neye = [0, 0, -4]\ntarget = [0, 0, 0]\northographic_height = 2\n";

fn scene_of(folder: &Path, classified: &str) -> Scene {
    let text = format!(
        "film = {{ width = {SIDE}, height = {SIDE} }}\n{VIEW}[classified]\nstep = 0.3\n\
         background = [0.25, 0.5, 0.125]\n{classified}"
    );
    parsed(folder, &text)
}

fn parsed(folder: &Path, text: &str) -> Scene {
    Scene::parse(text, &folder.join("scene.toml")).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn plain(scene: &Scene) -> Film {
    reference::render(scene, Sampling::default(), &[true]).unwrap()
}

/// The fast image, which is the plain one up to rounding.
///
/// Both evaluate the same samples and the same lengths of pieces; sums of a few numbers of each piece, and
/// of up to some hundred pieces, round to 53 bits, which is below a thousandth of the rounding to 32 bits.
/// On a number that lies between two of those, the two may fall to either side: by an ulp of the brightest.
fn by_both(scene: &Scene) -> Film {
    let (fast, plain) = (fast(scene), plain(scene));
    let worst = difference(&fast, &plain);
    assert!(worst <= ULP * 1.01, "{worst:e}");
    fast
}

/// The largest difference of a channel, opacity included, relative to the brightest of both, or to 1.
fn difference(a: &Film, b: &Film) -> f64 {
    let brightest = a.brightest().max(b.brightest()).max(1.0);
    let opacities = a.opacity().unwrap().iter().zip(b.opacity().unwrap());
    let opacities = opacities.map(|(a, b)| f64::from((a - b).abs()));
    let channels = a
        .radiance()
        .as_flattened()
        .iter()
        .zip(b.radiance().as_flattened());
    let channels = channels.map(|(a, b)| f64::from((a - b).abs()));
    opacities.chain(channels).fold(0.0, f64::max) / brightest
}

fn pixels(film: &Film) -> impl Iterator<Item = (DVec3, f64)> + '_ {
    let opacities = film.opacity().unwrap().iter();
    let pixels = film.radiance().iter().zip(opacities);
    pixels.map(|(pixel, opacity)| {
        let radiance = DVec3::from_array(pixel.map(f64::from));
        (radiance, f64::from(*opacity))
    })
}

fn assert_near(value: DVec3, expected: DVec3) {
    let off = (value - expected).abs().max_element();
    assert!(
        off <= ULP * expected.abs().max_element().max(1.0),
        "{value} is not {expected}"
    );
}

const RED: [f64; 3] = [1.0, 0.25, 0.0];
const BLUE: [f64; 3] = [0.0, 0.5, 2.0];

#[test]
fn two_constant_volumes_overlap() {
    let folder = tempfile::tempdir().unwrap();
    slab(folder.path(), "a.nrrd", -2.0, 0.5);
    slab(folder.path(), "b.nrrd", -0.75, 1.5);
    let ((red, thin), (blue, dense)) = (look(RED, 0.3), look(BLUE, 0.6));
    let volume =
        |file: &str, look: &str| format!("[[classified.volume]]\nfile = '{file}.nrrd'\n{look}\n");
    let (a, b) = (volume("a", &red), volume("b", &blue));
    let image = by_both(&scene_of(folder.path(), &format!("{a}{b}")));
    // Alone, together, alone.
    let both = (DVec3::from(RED) * thin + DVec3::from(BLUE) * dense) / (thin + dense);
    let (mut expected, mut passed) = (DVec3::ZERO, 1.0);
    for (colour, extinction, length) in [
        (RED.into(), thin, 1.25),
        (both, thin + dense, 1.25),
        (BLUE.into(), dense, 1.0),
    ] {
        expected += colour * passed * -exp_m1(-extinction * length);
        passed *= exp(-extinction * length);
    }
    for (radiance, opacity) in pixels(&image) {
        assert_near(radiance, expected + BACKGROUND * passed);
        assert!((opacity - (1.0 - passed)).abs() <= ULP);
    }
    // The order of declaration means nothing.
    let exchanged = by_both(&scene_of(folder.path(), &format!("{b}{a}")));
    assert!(difference(&image, &exchanged) <= ULP);
    // Nor does a volume that is empty, whatever its step.
    let (clear, _) = look([9.0; 3], 0.0);
    let empty = volume(
        "a",
        &format!("{clear}\nstep = 0.17\ntranslate = [0, 0, 0.3]"),
    );
    let with_empty = by_both(&scene_of(folder.path(), &format!("{empty}{a}{b}")));
    assert!(difference(&image, &with_empty) <= ULP);
    // Opaque ones share equally, and hide the others.
    let (black, white) = (look([0.0; 3], 1.0).0, look([1.0; 3], 1.0).0);
    let opaque = [("b", &black), ("b", &white), ("b", &blue)];
    let opaque = opaque.map(|(file, look)| volume(file, look)).concat();
    let grey = by_both(&scene_of(folder.path(), &opaque));
    assert!(pixels(&grey).all(|pixel| pixel == (DVec3::splat(0.5), 1.0)));
}

/// A constant volume whose opacity is halved where the second number is 1: −ln(1 − a/2)/h0 per unit.
#[test]
fn a_second_number_modulates_opacity() {
    let folder = tempfile::tempdir().unwrap();
    let bounds = [DVec3::new(-2.0, -2.0, -1.0), DVec3::new(2.0, 2.0, 1.0)];
    let write = |name, nodes, values: &[f32]| {
        write_grid(folder.path(), name, nodes, bounds, values);
    };
    write("a.nrrd", [2, 2, 2], &[1.0; 8]);
    write("ones.nrrd", [2, 2, 2], &[1.0; 8]);
    write("other.nrrd", [3, 2, 2], &[1.0; 12]);
    let (red, _) = look(RED, 0.6);
    let scene = |file: &str, modulation: &str| {
        let volume = format!("[classified.volume]\nfile = '{file}.nrrd'\n{red}\n");
        format!("{volume}[classified.volume.modulation]\n{modulation}\n")
    };
    let half = "point = [{ value = 0, factor = 0 }, { value = 2, factor = 1 }]";
    let text = scene("a", &format!("file = 'ones.nrrd'\n{half}"));
    let opacity = -exp_m1(ln_1p(-0.3) / 0.5 * 2.0);
    let expected = DVec3::from(RED) * opacity + BACKGROUND * (1.0 - opacity);
    for (radiance, seen) in pixels(&by_both(&scene_of(folder.path(), &text))) {
        assert_near(radiance, expected);
        assert!((seen - opacity).abs() <= ULP);
    }
    // The gradient of values 1 + 3 z on three nodes of z, turned and stretched: 3 in the volume, 2 in the world.
    let slope: Vec<f32> = (0..12)
        .map(|index| -2.0 + 3.0 * (index / 4) as f32)
        .collect();
    write("slope.nrrd", [2, 2, 3], &slope);
    let placed = "scale = [1, 1, 1.5]\nrotate = { axis = [1, 0, 0], angle = 90 }\n";
    let text = scene("slope", &format!("of = 'gradient'\n{half}"));
    let text = text.replace("slope.nrrd'\n", &format!("slope.nrrd'\n{placed}"));
    let seen_along_y = text.replace("factor = 1", "factor = 0.5");
    let image = by_both(&scene_of(folder.path(), &seen_along_y));
    // Twice the half-width of the volume, which its turn puts along z.
    let opacity = -exp_m1(ln_1p(-0.3) / 0.5 * 4.0);
    assert!(pixels(&image).all(|(_, seen)| (seen - opacity).abs() <= ULP));
    let refused = |text: &str| {
        let text = format!("film = {{ width = 4, height = 4 }}\n[classified]\n{text}");
        let error = Scene::parse(&text, &folder.path().join("scene.toml")).unwrap_err();
        error.to_string()
    };
    for (modulation, words) in [
        (half.to_owned(), "has no source"),
        (
            format!("of = 'gradient'\nfile = 'a.nrrd'\n{half}"),
            "more than one source",
        ),
        (
            format!("file = 'other.nrrd'\n{half}"),
            "the volume has [2, 2, 2] nodes, and this file [3, 2, 2]",
        ),
        (
            format!("of = 'gradient'\n{half}\n[classified.shadow]"),
            "shadows of modulated opacities are not rendered",
        ),
        (
            format!("of = 'gradient'\n{half}\n[classified.conventions]\njitter = true"),
            "by common steps, without shadow and modulation",
        ),
        (
            "of = 'gradient'\npoint = [{ value = 1, factor = 0 }, { value = 0, factor = 1 }]"
                .to_owned(),
            "must be sorted by value",
        ),
    ] {
        let said = refused(&scene("a", &modulation));
        assert!(said.contains(words), "{modulation}: {said}");
    }
    let modulated = scene("a", &format!("of = 'gradient'\n{half}"));
    let said = refused(&format!("compositing = 'continuous'\n{modulated}"));
    assert!(said.contains("modulated opacities are sampled"), "{said}");
}

#[test]
fn a_plane_cuts_a_constant_volume() {
    let folder = tempfile::tempdir().unwrap();
    slab(folder.path(), "a.nrrd", -2.0, 2.0);
    let (red, extinction) = look(RED, 0.3);
    let volume = format!("[[classified.volume]]\nfile = 'a.nrrd'\nname = 'fog'\n{red}\n");
    for (clip, kept) in [
        // Of the rays at x, what lies behind z = 0.5 − x/2; or before.
        ("point = [1, 0, 0]\nnormal = [1, 0, 2]", [0.5, 2.0]),
        ("point = [1, 0, 0]\nnormal = [-1, 0, -2]", [-2.0, 0.5]),
    ] {
        let scene = scene_of(
            folder.path(),
            &format!("{volume}[[classified.clip]]\n{clip}\nvolumes = ['fog']\n"),
        );
        for (index, (radiance, opacity)) in pixels(&by_both(&scene)).enumerate() {
            // Looking along +z with y up, x grows to the left.
            let x = 1.0 - 2.0 * ((index % SIDE) as f64 + 0.5) / SIDE as f64;
            let at = |z: f64| if z.abs() == 2.0 { z } else { 0.5 - 0.5 * x };
            let depth = extinction * (at(kept[1]) - at(kept[0]));
            let expected = DVec3::from(RED) * -exp_m1(-depth) + BACKGROUND * exp(-depth);
            assert_near(radiance, expected);
            assert!((opacity + exp_m1(-depth)).abs() <= ULP);
        }
    }
    // Of a box in the middle the rays at its sides see nothing.
    let clip = "[[classified.clip]]\nbox = { min = [-0.5, -9, -1], max = [0.5, 9, 0.5] }\n";
    let scene = scene_of(folder.path(), &format!("{volume}{clip}"));
    for (index, (_, opacity)) in pixels(&by_both(&scene)).enumerate() {
        let is_inside = (2..6).contains(&(index % SIDE));
        let expected = if is_inside {
            -exp_m1(-extinction * 1.5)
        } else {
            0.0
        };
        assert!((opacity - expected).abs() <= ULP, "{index}");
    }
}

#[test]
fn a_surface_in_fog_and_its_shadow() {
    let folder = tempfile::tempdir().unwrap();
    slab(folder.path(), "a.nrrd", -2.0, 2.0);
    slab(folder.path(), "b.nrrd", 1.0, 2.0);
    let ((black, thin), (bright, _)) = (look([0.0; 3], 0.2), look([5.0; 3], 0.9));
    let text = |shadow: &str, more: &str| {
        format!(
            "[classified.light]\nposition = [0, 0, -5]\n{shadow}\n\
             [[classified.volume]]\nfile = 'a.nrrd'\n{black}\n\
             [[classified.surface]]\ncolour = [0.5, 1, 0.25]\n\
             rectangle = {{ corner = [-3, -3, 0.5], edge_u = [0, 6, 0], edge_v = [6, 0, 0] }}\n{more}"
        )
    };
    let colour = DVec3::new(0.5, 1.0, 0.25);
    let lit = by_both(&scene_of(folder.path(), &text("", "")));
    let passed = exp(-2.5 * thin);
    for pixel in pixels(&lit) {
        assert_near(pixel.0, colour * passed);
        assert_eq!(pixel.1, 1.0);
    }
    // What lies behind the surface is hidden: to the last bit, for no step ends behind it.
    let more = format!("[[classified.volume]]\nfile = 'b.nrrd'\n{bright}\n");
    assert_eq!(by_both(&scene_of(folder.path(), &text("", &more))), lit);
    // In the shadow of the fog, which is crossed at a slant.
    let shadow = "[classified.shadow]\nstep = 0.2\n";
    let shadowed = by_both(&scene_of(folder.path(), &text(shadow, "")));
    for (index, (radiance, _)) in pixels(&shadowed).enumerate() {
        let [x, y] =
            [index % SIDE, index / SIDE].map(|at| 1.0 - 2.0 * (at as f64 + 0.5) / SIDE as f64);
        let way = DVec3::new(x, y, 5.5).length() * 2.5 / 5.5;
        assert_near(radiance, colour * passed * exp(-thin * way));
    }
    // Behind another surface it is dark, and so is the fog.
    let other = "[[classified.surface]]\ncolour = 1\n\
                 rectangle = { corner = [-3, -3, -4.5], edge_u = [0, 6, 0], edge_v = [6, 0, 0] }\n";
    let dark = by_both(&scene_of(folder.path(), &text(shadow, other)));
    assert!(pixels(&dark).all(|pixel| pixel == (DVec3::ZERO, 1.0)));
    // Phong's model: the cosine at each point.
    let phong = "[classified.phong]\nambient = 0.25\ndiffuse = 0.5\nspecular = 0\n";
    let shaded = by_both(&scene_of(folder.path(), &text(phong, "")));
    for (index, (radiance, _)) in pixels(&shaded).enumerate() {
        let [x, y] =
            [index % SIDE, index / SIDE].map(|at| 1.0 - 2.0 * (at as f64 + 0.5) / SIDE as f64);
        let cosine = 5.5 / DVec3::new(x, y, 5.5).length();
        assert_near(radiance, colour * (0.25 + 0.5 * cosine) * passed);
    }
}

/// What is clipped away casts no shadow, on surfaces and on volumes; what is left does.
#[test]
fn clipped_parts_cast_no_shadow() {
    let folder = tempfile::tempdir().unwrap();
    slab(folder.path(), "a.nrrd", -2.0, 0.0);
    let (black, _) = look([0.0; 3], 0.9);
    let text = |clip: &str| {
        format!(
            "[classified.light]\nposition = [0, 0, -50]\n[classified.shadow]\nstep = 0.1\n{clip}\
             [[classified.volume]]\nfile = 'a.nrrd'\n{black}\n\
             [[classified.surface]]\ncolour = 1\n\
             rectangle = {{ corner = [-3, -3, 0.5], edge_u = [0, 6, 0], edge_v = [6, 0, 0] }}\n"
        )
    };
    let clip = "[[classified.clip]]\npoint = [0, 0, 0]\nnormal = [1, 0, 0]\n";
    let image = by_both(&scene_of(folder.path(), &text(clip)));
    for (index, (radiance, _)) in pixels(&image).enumerate() {
        let is_free = index % SIDE >= SIDE / 2;
        assert_eq!(is_free, radiance == DVec3::ONE, "{index}");
        assert!(is_free || radiance.x < 0.01);
    }
    let mut mistaken = scene_of(folder.path(), &text(clip));
    mistaken = mistakes::named("clipped-parts-cast-shadows")
        .unwrap()
        .in_scene(&mistaken)
        .unwrap();
    assert!(pixels(&fast(&mistaken)).all(|(radiance, _)| radiance.x < 0.01));
}

/// Numbers in [0, 1) for a generated scene.
struct Numbers(u32, u32);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.1 += 1;
        f64::from(philox4x32_10([self.1, self.0, 0, 0], [57, 0])[0]) / (1_u64 << 32) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }

    fn vector(&mut self, size: f64) -> DVec3 {
        (DVec3::from_array([(); 3].map(|()| self.next())) * 2.0 - 1.0) * size
    }
}

/// A generated scene, its parts moved by the rotation about `AXIS` by `angle` degrees.
fn generated(folder: &Path, number: u32, angle: f64) -> String {
    const AXIS: DVec3 = DVec3::new(1.0, 2.0, 0.5);
    let mut numbers = Numbers(number, 0);
    let turn = DMat3::from_axis_angle(AXIS.normalize(), angle.to_radians());
    let turned = |v: DVec3| format!("{:?}", (turn * v).to_array());
    let by_turn = format!(
        "rotate = {{ axis = {:?}, angle = {angle} }}\n",
        AXIS.to_array()
    );
    let eye = numbers.vector(1.0).normalize() * 4.0;
    let mut text = format!(
        "film = {{ width = {SIDE}, height = {SIDE} }}\n\
         [camera]\neye = {}\ntarget = {}\nup = {}\nvertical_fov = 45\n",
        turned(eye),
        turned(numbers.vector(0.2)),
        turned(DVec3::new(0.1, 1.0, -0.3)),
    );
    let shared = numbers.below(2) == 0;
    if shared {
        text += "[transfer_function]\nfloor = 0.3\nreference_length = 0.3\ncolormap = 'heat'\n";
    }
    text += &format!(
        "[classified]\nstep = 0.21\nbackground = {:?}\n",
        numbers.vector(0.5).abs().to_array()
    );
    text += &format!("light = {{ position = {} }}\n", turned(numbers.vector(3.0)));
    if numbers.below(3) > 0 {
        text += "phong = { ambient = 0.2, diffuse = 0.7, specular = 0.4, shininess = 9 }\n";
    }
    if numbers.below(3) > 0 {
        text += "shadow = { step = 0.33, reference_step = 0.4 }\n";
    }
    let count = 1 + numbers.below(4);
    for volume in 0..count {
        let nodes = [(); 3].map(|()| 2 + numbers.below(3));
        let (centre, size) = (numbers.vector(0.7), numbers.vector(0.5).abs() + 0.3);
        let values: Vec<f32> = (0..nodes.iter().product())
            .map(|_| numbers.next() as f32)
            .collect();
        let file = format!("{number}-{volume}.nrrd");
        write_grid(
            folder,
            &file,
            nodes,
            [centre - size, centre + size],
            &values,
        );
        text += &format!("[[classified.volume]]\nfile = '{file}'\nname = 'v{volume}'\n");
        // A map of its own before that of all would need a matrix.
        text += &by_turn;
        if !shared || numbers.below(2) == 0 {
            let opacities = [0.0, numbers.next(), [1.0, 0.5][numbers.below(2)]];
            let [c0, c1, c2] = [(); 3].map(|()| numbers.vector(1.0).abs().to_array());
            let [o0, o1, o2] = opacities;
            text += &format!(
                "transfer_function = {{ reference_length = 0.35, point = [\
                 {{ value = 0.2, colour = {c0:?}, opacity = {o0} }}, {{ value = 0.5, colour = {c1:?}, opacity = {o1} }}, \
                 {{ value = 0.9, colour = {c2:?}, opacity = {o2} }}] }}\n"
            );
        }
        if numbers.below(3) == 0 {
            text += &format!("step = {}\n", 0.05 + 0.3 * numbers.next());
        }
    }
    for _ in 0..numbers.below(3) {
        let (at, colour) = (numbers.vector(0.8), numbers.vector(1.0).abs().to_array());
        let shape = match numbers.below(3) {
            0 => format!("sphere = {{ centre = {:?}, radius = 0.3 }}", at.to_array()),
            1 => format!(
                "box = {{ min = {:?}, max = {:?} }}",
                (at - 0.2).to_array(),
                (at + 0.3).to_array()
            ),
            _ => format!(
                "rectangle = {{ corner = {:?}, edge_u = [0.9, 0, 0.2], edge_v = [0.1, 0.8, 0] }}",
                at.to_array()
            ),
        };
        text += &format!("[[classified.surface]]\ncolour = {colour:?}\n{shape}\n{by_turn}");
    }
    for _ in 0..numbers.below(3) {
        let (point, normal) = (numbers.vector(0.3), numbers.vector(1.0));
        text += &format!(
            "[[classified.clip]]\npoint = {}\nnormal = {}\n",
            turned(point),
            turned(normal)
        );
        if numbers.below(2) == 0 {
            text += &format!("volumes = ['v{}']\n", numbers.below(count));
        }
    }
    text
}

#[test]
fn generated_scenes_agree_and_turn_with_their_camera() {
    let folder = tempfile::tempdir().unwrap();
    let (mut compared, mut worst, mut farthest) = (0, 0.0_f64, 0.0_f64);
    for number in 0..250 {
        let text = generated(folder.path(), number, 0.0);
        let Ok(scene) = Scene::parse(&text, &folder.path().join("scene.toml")) else {
            continue; // clips that leave nothing
        };
        if !scene.panels[0].classified().unwrap().has_objects() {
            continue;
        }
        compared += 1;
        let (fast, plain) = (fast(&scene), plain(&scene));
        let off = difference(&fast, &plain);
        assert!(off <= 1.01 * ULP, "{off:e}\n{text}");
        worst = worst.max(off);
        // Points turn with some roundings, 1e-15; samples, which jump nowhere but at borders, with them.
        let turned = parsed(folder.path(), &generated(folder.path(), number, 37.0));
        let off = difference(&fast, &by_both(&turned));
        assert!(off <= 1e-6, "{off:e}\n{text}");
        farthest = farthest.max(off);
    }
    println!("{compared} scenes: fast against plain {worst:e}, turned {farthest:e}");
    assert!(compared > 150, "{compared}");
}

/// Every mistake about several objects makes a picture of its own, and the right one is without.
#[test]
fn mistakes_of_several_objects_are_seen() {
    let folder = tempfile::tempdir().unwrap();
    slab(folder.path(), "a.nrrd", -2.0, 0.5);
    slab(folder.path(), "b.nrrd", -1.0, 1.5);
    let ((red, _), (blue, _)) = (look(RED, 0.3), look(BLUE, 0.15));
    let text = format!(
        "[classified.shadow]\n[classified.light]\nposition = [3, 0, -4]\n\
         [[classified.volume]]\nfile = 'a.nrrd'\nname = 'a'\n{red}\n\
         [[classified.volume]]\nfile = 'b.nrrd'\n{blue}\n\
         [[classified.clip]]\npoint = [0.5, 0, 0]\nnormal = [-1, 0, 0.2]\nvolumes = ['a']\n\
         [[classified.surface]]\ncolour = 1\nsphere = {{ centre = [0.2, 0, -0.4], radius = 0.7 }}\n"
    );
    let scene = scene_of(folder.path(), &text);
    let mut known = vec![("volref's own".to_owned(), fast(&scene))];
    for fault in [
        Fault::NearestBoxInFront,
        Fault::LastInFront,
        Fault::OpacitiesAdded,
        Fault::ColoursUnweighted,
        Fault::SurfacesBehind,
        Fault::SurfacesInFront,
        Fault::SurfacesCutByBoxes,
        Fault::ShadowsUnclipped,
        Fault::NoShadowOfSurfaces,
        Fault::NoShadowOnSurfaces,
    ] {
        let new = fast(&scene.with_volumes(|volume| volume.conventions.fault = Some(fault)));
        for (other, old) in &known {
            assert!(difference(&new, old) > 1e-3, "{fault:?} looks like {other}");
        }
        known.push((format!("{fault:?}"), new));
    }
}

/// Two fogs in one box, by common steps: each step shows the first, and the second as far as the first lets it through.
/// The larger box of a clear volume, from −3 on, is where steps are counted from, and of a box of two nodes half a voxel
/// is half of it, more on each side.
#[test]
fn common_steps_show_one_volume_over_the_next() {
    let folder = tempfile::tempdir().unwrap();
    slab(folder.path(), "fog.nrrd", -1.0, 1.0);
    slab(folder.path(), "clear.nrrd", -3.0, 3.0);
    let ((red, thin), (blue, thick), (clear, _)) =
        (look(RED, 0.3), look(BLUE, 0.6), look(RED, 0.0));
    let volume = |file: &str, look: &str, more: &str| {
        format!("[[classified.volume]]\nfile = '{file}.nrrd'\n{look}\n{more}\n")
    };
    let image = |volumes: &[String], conventions: &str| {
        let text = format!(
            "{}[classified.conventions]\nvolume_steps = 'common'\n{conventions}\n",
            volumes.concat()
        );
        fast(&scene_of(folder.path(), &text))
    };
    // What steps of these lengths show, of both fogs.
    let seen = |lengths: &[f64]| {
        let (mut radiance, mut passed) = (DVec3::ZERO, 1.0);
        for length in lengths {
            let [first, second] = [thin, thick].map(|extinction| -exp_m1(-extinction * length));
            let shown = DVec3::from(RED) * first + DVec3::from(BLUE) * ((1.0 - first) * second);
            radiance += shown * passed;
            passed *= (1.0 - first) * (1.0 - second);
        }
        (radiance + BACKGROUND * passed, 1.0 - passed)
    };
    let check = |film: &Film, (radiance, opacity): (DVec3, f64)| {
        for pixel in pixels(film) {
            assert_near(pixel.0, radiance);
            assert!((pixel.1 - opacity).abs() <= ULP, "{pixel:?} {opacity}");
        }
    };
    let both = [volume("fog", &red, ""), volume("fog", &blue, "")];
    let six_and_a_rest = [0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.2];
    check(&image(&both, ""), seen(&six_and_a_rest));
    // The shortest step of all.
    let shorter = [both[0].clone(), volume("fog", &blue, "step = 0.25")];
    check(&image(&shorter, ""), seen(&[0.25; 8]));
    // A surface ends the ray within the second step.
    let wall = "[[classified.surface]]\ncolour = [0.25, 0.5, 0.125]\n\
                rectangle = { corner = [-3, -3, -0.5], edge_u = [0, 6, 0], edge_v = [6, 0, 0] }\n";
    let walled = [both[0].clone(), both[1].clone(), wall.to_owned()];
    let before_wall = seen(&[0.3, 0.2]);
    check(&image(&walled, ""), (before_wall.0, 1.0));
    // In the order of the scene, whichever is nearer.
    let [first, second] = [
        image(&both, ""),
        image(&[both[1].clone(), both[0].clone()], ""),
    ];
    assert!(difference(&first, &second) > 1e-2);
    // Steps from −3 on: six of them have their middle, −2.85 + 0.3 n, within −1 and 1, and 14 within −2 and 2.
    let [red_fog, blue_fog] = &both;
    let among = [
        volume("clear", &clear, ""),
        red_fog.clone(),
        blue_fog.clone(),
    ];
    check(&image(&among, ""), seen(&[0.3; 6]));
    check(&image(&among, "volume_boxes = 'voxels'"), seen(&[0.3; 14]));
    // The near plane, at -0.45, as a share of the depth of the farthest corner of all, 10 from the eye at -4.
    check(&image(&among, "near_plane = 0.355"), seen(&[0.3; 5]));
    // Where the boxes of volumes are larger by themselves, so is the one that steps are counted from: from −2 on.
    let larger = image(&both, "box = 'voxels'");
    check(&larger, seen(&[[0.3; 13].as_slice(), &[0.1]].concat()));
    // A clip of one volume takes its samples alone; one of all ends the ray.
    let clip = "[[classified.clip]]\npoint = [0, 0, 0.1]\nnormal = [0, 0, -1]\n";
    let clipped = |clip: String| {
        image(
            &[
                red_fog.clone(),
                blue_fog.replace("]]\n", "]]\nname = 'blue'\n"),
                clip,
            ],
            "",
        )
    };
    check(&clipped(clip.to_owned()), seen(&[0.3, 0.3, 0.3, 0.2]));
    let of_both = image(
        &[
            red_fog.replace("]]\n", "]]\nname = 'red'\n"),
            blue_fog.replace("]]\n", "]]\nname = 'blue'\n"),
            format!("{clip}volumes = ['red', 'blue']\n"),
        ],
        "",
    );
    check(&of_both, seen(&[0.3, 0.3, 0.3, 0.2]));
    let of_blue = clipped(format!("{clip}volumes = ['blue']\n"));
    let whole = 1.0 - exp(-2.0 * thin - 4.0 * 0.3 * thick);
    for pixel in pixels(&of_blue) {
        assert!((pixel.1 - whole).abs() <= ULP);
    }
}

/// Fog of one density before a wall, or before its own cut: samples at the ends of steps of 0.3, each for a whole one. As
/// many as lie within, and one more behind the end, as long as the fog goes on there.
#[test]
fn a_sample_more_is_taken_behind_an_end() {
    let folder = tempfile::tempdir().unwrap();
    slab(folder.path(), "a.nrrd", -2.0, 2.0);
    let (red, thin) = look(RED, 0.3);
    let wall = |z: f64| {
        format!(
            "[[classified.surface]]\ncolour = [0.5, 1, 0.25]\n\
             rectangle = {{ corner = [-3, -3, {z}], edge_u = [0, 6, 0], edge_v = [6, 0, 0] }}"
        )
    };
    let cut = |z: f64| format!("[[classified.clip]]\npoint = [0, 0, {z}]\nnormal = [0, 0, -1]");
    let image = |end: &str, more: &str| {
        let text = format!(
            "[[classified.volume]]\nfile = 'a.nrrd'\n{red}\n{end}\n[classified.conventions]\n\
             first_sample = 1.0\nlast_step = 'whole'\none_sample = true\n{more}\n"
        );
        fast(&scene_of(folder.path(), &text))
    };
    let wall_colour = DVec3::new(0.5, 1.0, 0.25);
    for (z, within, all) in [
        (-0.25, 5, 6),
        // The first sample lies behind the end, and counts.
        (-1.9, 1, 2),
        // The next sample would be behind the fog.
        (1.95, 13, 13),
        (2.5, 13, 13),
        (-2.5, 0, 0),
    ] {
        for (more, samples) in [("", within), ("sample_behind_ends = true", all)] {
            let passed = exp(-0.3 * f64::from(samples) * thin);
            let fog = DVec3::from(RED) * (1.0 - passed);
            for pixel in pixels(&image(&wall(z), more)) {
                assert_near(pixel.0, fog + wall_colour * passed);
                assert_eq!(pixel.1, 1.0);
            }
            // Planes outside of the fog cut nothing, or all, which is refused.
            if z.abs() < 2.0 {
                for pixel in pixels(&image(&cut(z), more)) {
                    assert_near(pixel.0, fog + BACKGROUND * passed);
                    assert!((pixel.1 - (1.0 - passed)).abs() <= ULP);
                }
            }
        }
    }
}

/// With other conventions there is one volume, and no shadow; by volref's own the conventional caster is none.
#[test]
fn conventions_of_one_volume_among_surfaces() {
    let folder = tempfile::tempdir().unwrap();
    slab(folder.path(), "a.nrrd", -2.0, 2.0);
    let (red, _) = look(RED, 0.3);
    let ball =
        "[[classified.surface]]\ncolour = 1\nsphere = { centre = [0.2, 0, -0.4], radius = 0.7 }";
    let volume = format!("[[classified.volume]]\nfile = 'a.nrrd'\n{red}\n");
    let text = |conventions: &str, more: &str| {
        format!("{volume}{ball}\n[classified.conventions]\n{conventions}\n{more}")
    };
    // Fog of one density looks the same by the nearest node, and wherever it is sampled.
    let own = fast(&scene_of(folder.path(), &text("", "")));
    let other = fast(&scene_of(folder.path(), &text("first_sample = 0.2", "")));
    assert!(difference(&own, &other) <= ULP);
    for (wrong, message) in [
        (
            text("first_sample = 1.0", "[classified.shadow]"),
            "by common steps, without shadow",
        ),
        (text("first_sample = 1.0", &volume), "by common steps"),
        (text("volume_boxes = 'voxels'", &volume), "by common steps"),
    ] {
        let text =
            format!("film = {{ width = 8, height = 8 }}\n{VIEW}[classified]\nstep = 0.3\n{wrong}");
        let error = Scene::parse(&text, &folder.path().join("scene.toml")).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
    }
}

/// Without samples the image of constant volumes, clips and a surface is the closed form, in any order; the opaque hide
/// what is behind, and share equally.
#[test]
fn the_integral_of_constant_volumes() {
    let folder = tempfile::tempdir().unwrap();
    slab(folder.path(), "a.nrrd", -2.0, 0.5);
    slab(folder.path(), "b.nrrd", -0.75, 1.5);
    let ((red, thin), (blue, dense)) = (look(RED, 0.3), look(BLUE, 0.6));
    let volume = |file: &str, look: &str| {
        format!("[[classified.volume]]\nfile = '{file}.nrrd'\nname = '{file}'\n{look}\n")
    };
    let image = |parts: &str| {
        let scene = scene_of(
            folder.path(),
            &format!("compositing = 'continuous'\n{parts}"),
        );
        let rendered = render(&plans(&scene), Sampling::default(), &|| {}).unwrap();
        assert!(rendered.error_bound.unwrap() <= 1e-6);
        rendered.film
    };
    let (a, b) = (volume("a", &red), volume("b", &blue));
    let clip = "[[classified.clip]]\npoint = [0, 0, -1]\nnormal = [0, 0, 1]\nvolumes = ['a']\n";
    let surface = "[[classified.surface]]\ncolour = [0.5, 1, 0.25]\n\
                   rectangle = { corner = [-3, -3, 1], edge_u = [0, 6, 0], edge_v = [6, 0, 0] }\n";
    let both = (DVec3::from(RED) * thin + DVec3::from(BLUE) * dense) / (thin + dense);
    let pieces = |first: f64, last: f64, behind: DVec3| {
        let (mut light, mut passed) = (DVec3::ZERO, 1.0);
        for (colour, extinction, length) in [
            (RED.into(), thin, first),
            (both, thin + dense, 1.25),
            (BLUE.into(), dense, last),
        ] {
            light += colour * passed * -exp_m1(-extinction * length);
            passed *= exp(-extinction * length);
        }
        (light + behind * passed, passed)
    };
    let (expected, passed) = pieces(1.25, 1.0, BACKGROUND);
    for parts in [format!("{a}{b}"), format!("{b}{a}")] {
        for (radiance, opacity) in pixels(&image(&parts)) {
            assert_near(radiance, expected);
            assert!((opacity - (1.0 - passed)).abs() <= ULP);
        }
    }
    let (expected, _) = pieces(0.25, 0.5, DVec3::new(0.5, 1.0, 0.25));
    for (radiance, opacity) in pixels(&image(&format!("{a}{b}{clip}{surface}"))) {
        assert_near(radiance, expected);
        assert_eq!(opacity, 1.0);
    }
    let (black, white) = (look([0.0; 3], 1.0).0, look([1.0; 3], 1.0).0);
    let opaque = [
        volume("b", &black),
        volume("b", &white).replace("'b'", "'c'"),
        a,
    ];
    let hidden = image(&opaque.concat());
    let (passed, red) = (exp(-1.25 * thin), DVec3::from(RED));
    for (radiance, opacity) in pixels(&hidden) {
        assert_near(radiance, red * (1.0 - passed) + DVec3::splat(0.5) * passed);
        assert_eq!(opacity, 1.0);
    }
}

/// Samples converge to the integral: of steps of first order, what is left is at most the last change, twice that at
/// most where terms of higher order count; both images are in 32 bits.
#[test]
fn samples_of_generated_scenes_converge_to_their_integral() {
    let folder = tempfile::tempdir().unwrap();
    let (mut compared, mut nearest) = (0, f64::INFINITY);
    for number in 0..60 {
        let text = generated(folder.path(), number, 0.0);
        let is_shaded = |line: &&str| line.starts_with("phong") || line.starts_with("shadow");
        let lines = text.lines().filter(|line| !is_shaded(line));
        // Where a value is opaque the extinction has no bound, and no order is known.
        let text = lines
            .collect::<Vec<_>>()
            .join("\n")
            .replace("opacity = 1 ", "opacity = 0.8 ");
        let Ok(sampled) = Scene::parse(&text, &folder.path().join("scene.toml")) else {
            continue; // clips that leave nothing
        };
        if !sampled.panels[0].classified().unwrap().has_objects() {
            continue;
        }
        compared += 1;
        let whole = text.replace(
            "[classified]\n",
            "[classified]\ncompositing = 'continuous'\n",
        );
        let integral = fast(&parsed(folder.path(), &whole));
        let [coarse, fine] = [5, 6].map(|halvings| fast(&sampled.with_halved_steps(halvings)));
        let (change, left) = (difference(&coarse, &fine), difference(&fine, &integral));
        assert!(
            left <= 2.0 * change + 4.0 * ULP,
            "{left:e} {change:e}\n{text}"
        );
        nearest = nearest.min(left);
    }
    assert!(compared > 30, "{compared}");
    println!("{compared} scenes, nearest {nearest:e}");
}
