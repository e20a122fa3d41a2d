//! An effect fades in: a coefficient of 1e-300 or 1e-12 in place of 0 is simulated, by whatever other
//! code that takes, and changes a picture by no more than its size. Random numbers that shift when an
//! effect comes in would be seen here, and so would a formula that loses its digits next to 0.

use crate::effects::scenes::{parsed, plan, rendered};
use volref::render::{Effect, State};

/// Coefficients that are all but 0.
const SMALL: [f64; 2] = [1e-300, 1e-12];

/// A picture must change by no more than `slope` per unit of the coefficient. Slopes are bounds on
/// the derivative, made of lengths below 4 and radiances below 8 of the scenes here.
///
/// Both pictures are rounded to 32 bits: that is half a unit in the last place each, `2^-24` of the
/// brighter, and what comes before has 53 bits and at most some thousand roundings.
#[track_caller]
fn fades_in(what: &str, slope: f64, scene: impl Fn(f64) -> String) {
    let film = |coefficient: f64| {
        let scene = parsed(&scene(coefficient));
        rendered(&plan(&scene)).0
    };
    let without = film(0.0);
    for small in SMALL {
        let with = film(small);
        assert_eq!(with.radiance().len(), without.radiance().len());
        let channels = with.radiance().iter().flatten();
        for (with, without) in channels.zip(without.radiance().iter().flatten()) {
            let (with, without) = (f64::from(*with), f64::from(*without));
            let rounding = 2.0 * with.max(without) / f64::from(1 << 24);
            let change = (with - without).abs();
            assert!(
                change <= slope * small + rounding,
                "{what} {small:e}: {without} becomes {with}"
            );
        }
    }
}

const HEAD: &str = "\
film = { width = 6, height = 5 }
camera = { eye = [0.35, 0.4, -2.2], target = [0.12, 0.1, 0.1], vertical_fov = 34 }
[sampling]
samples = 16
seed = 3
";

const BOX: &str = "box = { min = [-0.5, -0.5, -0.5], max = [0.75, 0.75, 0.75] }";

const LAMP: &str = "\
[[radiative.light]]
point = { position = [0.9, 1.4, -0.8], intensity = 3 }
";

const FLOOR: &str = "\
[[radiative.surface]]
rectangle = { corner = [-2, -0.6, -1], edge_u = [0, 0, 3], edge_v = [4, 0, 0] }
diffuse = { reflectance = 0.6 }
";

/// A scene of one medium, with `radiative` keys before it and tables `after` it.
fn medium(radiative: &str, keys: &str, after: &str) -> String {
    format!("{HEAD}[radiative]\n{radiative}\n[[radiative.medium]]\n{BOX}\n{keys}\n{after}")
}

/// Nothing but 0 is nothing.
#[test]
fn the_least_of_coefficients_is_simulated() {
    use Effect::*;
    let media = |keys: &str| medium("environment = 1", keys, LAMP);
    for least in ["5e-324", "1e-300"] {
        for (effect, keys) in [
            (Absorption, "sigma_a = C"),
            (Absorption, "sigma_s = 1\nsigma_a = C"),
            (Emission, "sigma_a = 1\nemission = C"),
            (Emission, "emission = [0, 0, C]"),
            (SingleScattering, "sigma_a = 1\nsigma_s = C"),
            (MultipleScattering, "sigma_s = [0, C, 0]"),
            (MediumShadow, "sigma_s = C"),
            (AnisotropicPhase, "sigma_s = 1\ng = C"),
            (ChromaticCoefficients, "sigma_a = [0, C, 0]"),
            (ChromaticCoefficients, "sigma_s = 1\nsigma_a = [0, 0, C]"),
            (
                Heterogeneity,
                "sigma_a = 1\nblob = { centre = [0, 0, 0], width = 1, peak = C }",
            ),
        ] {
            let state = |coefficient: &str| {
                let scene = parsed(&media(&keys.replace('C', coefficient)));
                plan(&scene).state(effect)
            };
            assert_eq!(state("0"), State::Elided, "{effect}: {keys}");
            assert_eq!(state(least), State::On, "{effect}: {keys}, {least}");
        }
        let shaded = |specular: &str| {
            let scene = parsed(&format!(
                "[classified]\n[classified.volume]\nfile = '../../volumes/hard/hill.nrrd'\n\
                 [classified.phong]\nambient = 1\ndiffuse = 0\nspecular = {specular}\n\
                 [transfer_function]\nreference_length = '1 voxel'\n"
            ));
            plan(&scene).state(GradientShading)
        };
        assert_eq!(shaded("0"), State::Elided);
        assert_eq!(shaded(least), State::On);
    }
}

/// Along the line of sight: 1 − e^(−cL) is below cL, the environment 1 bright and L below 4.
#[test]
fn absorption_and_emission_in_closed_form() {
    let before = "environment = 1";
    fades_in("sigma_a", 4.0, |c| {
        medium(before, &format!("sigma_a = {c:e}"), "")
    });
    fades_in("sigma_a of one channel", 4.0, |c| {
        medium(before, &format!("sigma_a = [0.5, {}, 0.5]", 0.5 + c), "")
    });
    fades_in("emission", 4.0, |c| {
        medium(before, &format!("sigma_a = 0.5\nemission = {c:e}"), "")
    });
    fades_in("environment", 1.0, |c| {
        medium(
            &format!("environment = {c:e}"),
            "sigma_a = 0.5\nemission = 1",
            "",
        )
    });
}

/// From the closed form of a homogeneous medium to that of a density that differs from place to place:
/// the depth changes by less than L²·c times the extinction.
#[test]
fn heterogeneity_in_closed_form() {
    fades_in("gradient of a density", 16.0, |c| {
        let density = format!("linear = {{ density = 1, gradient = [{c:e}, 0, 0] }}");
        medium("environment = 1", &format!("sigma_a = 0.5\n{density}"), "")
    });
    fades_in("peak of a ball", 4.0, |c| {
        let density = format!("blob = {{ centre = [0, 0, 0], width = 0.3, peak = {c:e} }}");
        medium("environment = 1", &format!("sigma_a = 0.5\n{density}"), "")
    });
}

/// Path by path: the same random numbers, so each path changes by no more than the coefficient,
/// times what it crosses and meets. The paths here are turned some ten times at most, and a turn
/// multiplies a change by a distance over another: the slope is a bound on products of those.
#[test]
fn path_by_path() {
    let slope = 1e6;
    let fog = "sigma_s = 1\nsigma_a = 0.2";
    fades_in("sigma_s before a floor", slope, |c| {
        medium(
            "environment = 0.5",
            &format!("sigma_s = {c:e}"),
            &(FLOOR.to_owned() + LAMP),
        )
    });
    fades_in("sigma_a before a floor", slope, |c| {
        medium(
            "environment = 0.5",
            &format!("sigma_a = {c:e}"),
            &(FLOOR.to_owned() + LAMP),
        )
    });
    fades_in("emission before a floor", slope, |c| {
        medium(
            "environment = 0.5",
            &format!("emission = {c:e}"),
            &(FLOOR.to_owned() + LAMP),
        )
    });
    fades_in("g", slope, |c| {
        medium("", &format!("{fog}\ng = {c:e}"), LAMP)
    });
    fades_in("emission", slope, |c| {
        medium("", &format!("{fog}\nemission = {c:e}"), LAMP)
    });
    fades_in("sigma_a of one channel", slope, |c| {
        medium("", &format!("sigma_s = 1\nsigma_a = [0, {c:e}, 0]"), LAMP)
    });
    fades_in("environment", slope, |c| {
        medium(&format!("environment = {c:e}"), fog, LAMP)
    });
    fades_in("reflectance of a floor", slope, |c| {
        let floor = FLOOR.replace("0.6 }", &format!("{c:e} }}"));
        medium("environment = 0.5", fog, &(floor + LAMP))
    });
}

/// A volume of colours and opacities. Its radiance is below 1, its ray below 40 samples; shading is
/// linear in its weights, and a shadow takes `S/100` at most, `S` below 40 times the coefficient.
#[test]
fn classified_volumes() {
    let volume = |points: &str, keys: &str| {
        format!(
            "[film]\nwidth = 6\nheight = 5\n\
             [transfer_function]\nreference_length = '1 voxel'\n{points}\n\
             [classified]\n[classified.volume]\nfile = '../../volumes/hard/hill.nrrd'\n{keys}"
        )
    };
    let points = |opacity: f64| {
        format!(
            "point = [\n{{ value = 0, colour = [0.2, 0.4, 0.9], opacity = {opacity:e} }},\n\
             {{ value = 0.5, colour = [0.9, 0.7, 0.3], opacity = {opacity:e} }},\n\
             {{ value = 1, colour = [0.9, 0.7, 0.3], opacity = 0.4 }} ]"
        )
    };
    fades_in("opacity", 80.0, |c| volume(&points(c), ""));
    fades_in("opacity of all there is", 80.0, |c| {
        let all = points(c).replace("opacity = 0.4", &format!("opacity = {c:e}"));
        volume(&all, "[classified.phong]\n")
    });
    fades_in("specular", 2.0, |c| {
        let weights = format!("ambient = 1\ndiffuse = 0\nspecular = {c:e}\n");
        volume(&points(0.1), &format!("[classified.phong]\n{weights}"))
    });
    fades_in("diffuse", 2.0, |c| {
        let weights = format!("ambient = 1\ndiffuse = {c:e}\nspecular = 0\n");
        volume(&points(0.1), &format!("[classified.phong]\n{weights}"))
    });
    fades_in("shadow", 2.0, |c| match c {
        0.0 => volume("", ""),
        // Small enough a density over a step is a shadow of next to nothing.
        _ => volume(
            "",
            &format!("[classified.shadow]\nreference_step = {:e}\n", 1.0 / c),
        ),
    });
}
