//! Rows on several volumes, surfaces and clips whose faces lie on each other, and on maps that are nearly singular.

use super::margin::Margin;
use super::scenes::film;
use crate::math::{cos, exp_m1, ln_1p};
use crate::scene::Scene;

/// Half of the light, over a length of 1.
const HALF: &str = "transfer_function = { reference_length = 1, point = [\
                    { value = 0, colour = 0, opacity = 0 }, { value = 1, colour = 0, opacity = 0.5 }] }";

/// Rounding of an opacity or of a radiance of 1 to 32 bits.
const ROUNDING: f64 = f32::EPSILON as f64;

/// A volume of unit cells along z from `near` on, wider than the picture: at its nodes values from `first` on, each larger
/// by `slope` than the one before.
fn volume(name: &str, near: f64, nodes: usize, [first, slope]: [f64; 2]) -> String {
    format!(
        "[[classified.volume]]\nname = '{name}'\nfield = 'ramp'\nvalue = {first}\nslope = [0, 0, {slope}]\n\
         nodes = [2, 2, {nodes}]\nspacing = [8, 8, 1]\norigin = [-4, -4, {near}]\n{HALF}\n"
    )
}

/// Opacity and radiance along the middle of a picture of these `parts`, before a background of 1, sampled and without
/// samples. NaN where there is none.
fn seen(parts: &str) -> [[f64; 2]; 2] {
    ["step = 0.3", "compositing = 'continuous'"].map(|how| {
        let text = format!(
            "film = {{ width = 3, height = 3 }}\n[camera]\neye = [0, 0, -4]\ntarget = [0, 0, 0]\n\
             orthographic_height = 2\n[classified]\nbackground = 1\n{how}\n{parts}"
        );
        let scene = Scene::parse(&text, "scene.toml".as_ref()).ok();
        let film = scene.and_then(|scene| film(&scene));
        let middle = film.and_then(|film| Some([film.opacity()?[4], film.radiance()[4][0]]));
        middle.unwrap_or([f32::NAN; 2]).map(f64::from)
    })
}

/// Requires the opacity, and that as much less of the background is seen, to the rounding of 32 bits.
fn is_opaque(margin: &Margin, what: &str, parts: &str, opacity: f64) {
    for [found, behind] in seen(parts) {
        margin.within(what, found, opacity, ROUNDING);
        margin.within(what, behind, 1.0 - opacity, ROUNDING);
    }
}

/// Two volumes of the value 1, from -1 to 0 and from 0 to 1.
fn constant_neighbours() -> [String; 2] {
    [("a", -1.0), ("b", 0.0)].map(|(name, near)| volume(name, near, 2, [1.0, 0.0]))
}

fn opacity_over(length: f64) -> f64 {
    -exp_m1(length * ln_1p(-0.5))
}

#[test]
fn o1_nearly_singular_map() {
    let margin = &Margin;
    // A thousand times as wide and a thousandth as thick, tilted: the ray is longer by the cosine.
    let thin = volume("a", 0.0, 2, [1.0, 0.0])
        .replace("reference_length = 1,", "reference_length = 0.001,");
    for angle in [0.0_f64, 30.0, -60.0] {
        let map =
            format!("scale = [1000, 1, 0.001]\nrotate = {{ axis = [0, 1, 0], angle = {angle} }}\n");
        let length = 1.0 / cos(angle.to_radians());
        is_opaque(
            margin,
            "tilted",
            &format!("{thin}{map}"),
            opacity_over(length),
        );
    }
}

#[test]
fn o2_volumes_that_touch() {
    let margin = &Margin;
    let [first, second] = constant_neighbours();
    for parts in [format!("{first}{second}"), format!("{second}{first}")] {
        is_opaque(margin, "neither a gap nor twice", &parts, opacity_over(2.0));
    }
    // The face is passed where the values meet, at 1: twice the mean of the extinctions of the ramp.
    let [rising, falling] = [("a", -1.0, [0.0, 1.0]), ("b", 0.0, [1.0, -1.0])]
        .map(|(name, near, values)| volume(name, near, 2, values));
    let [_, whole] = seen(&format!("{rising}{falling}"));
    // ∫ −ln(1 − v/2) dv from 0 to 1 = 1 − ln 2.
    let right = -exp_m1(-2.0 * (1.0 + ln_1p(-0.5)));
    margin.within("values that meet", whole[0], right, ROUNDING);
}

#[test]
fn o3_surface_on_a_face() {
    let margin = &Margin;
    let [first, second] = constant_neighbours();
    let surface = |at: f64| {
        format!(
            "[[classified.surface]]\ncolour = 1\n\
             rectangle = {{ corner = [-4, -4, {at}], edge_u = [0, 8, 0], edge_v = [8, 0, 0] }}\n"
        )
    };
    for (at, passed) in [(-1.0, 0.0), (0.0, 1.0), (1.0, 2.0)] {
        for [opacity, radiance] in seen(&format!("{first}{second}{}", surface(at))) {
            margin.exact("the surface ends the ray", opacity, 1.0);
            let right = 1.0 - opacity_over(passed);
            margin.within("what lies before it", radiance, right, ROUNDING);
        }
    }
}

#[test]
fn o4_clip_through_nodes() {
    let margin = &Margin;
    let clip = |towards: i32, of: &str| {
        format!(
            "[[classified.clip]]\npoint = [0, 0, 0]\nnormal = [0, 0, {towards}]\nvolumes = ['{of}']\n"
        )
    };
    let constant = |name| volume(name, -1.0, 3, [1.0, 0.0]);
    for towards in [-1, 1] {
        let half = format!("{}{}", constant("a"), clip(towards, "a"));
        is_opaque(margin, "half of a volume", &half, opacity_over(1.0));
    }
    let halves = format!(
        "{}{}{}{}",
        constant("a"),
        constant("b"),
        clip(-1, "a"),
        clip(1, "b")
    );
    is_opaque(margin, "both halves", &halves, opacity_over(2.0));
    // Clear as far as the middle node: nothing is seen of the half before it.
    let clear = volume("a", -1.0, 3, [-1.0, 1.0]);
    for [opacity, behind] in seen(&format!("{clear}{}", clip(-1, "a"))) {
        margin.exact("clear half", [opacity, behind], [0.0, 1.0]);
    }
}
