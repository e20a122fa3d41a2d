//! Faults as tables: numbers, images, mistakes and conventions, alone and two together.

use super::faults::{
    ABSORPTION, COLOURED, COLUMN, Edit, FOG, Fault, GLOW, GREY, HEAD, Kind, NEAREST, NOISE, PLUME,
    ROOM, SHADOWED, SPOT, STAIN,
};
use super::images::{self, by_place, by_value, channels, from_elsewhere, is_one_of_twenty, times};
use std::f64::consts::{FRAC_1_PI, LN_2, LN_10};
use volref::film::Film;
use volref::math;

/// Numbers that are off, near and far.
const NUMBERS: &[(&str, &[(&str, f64)])] = &[
    (
        PLUME,
        &[
            ("density", -0.02),
            ("density", 1.5),
            ("diffuse", -0.05),
            ("ambient", -0.5),
            ("specular", -0.5),
            ("grid.z", -1.5),
            ("light.y", -1.5),
            ("light.z", 1.0),
            ("camera.view", -0.05),
            ("camera.y", 0.01),
            ("camera.down", 2.0),
            ("camera.right", 0.2),
        ],
    ),
    (
        SHADOWED,
        &[
            ("density", 0.05),
            ("light.x", 1.0),
            ("diffuse", -0.1),
            ("density", -0.5),
        ],
    ),
    (
        COLUMN,
        &[("background", -0.1), ("density", 0.1), ("density", -0.5)],
    ),
    (
        HEAD,
        &[
            ("background", -0.02),
            ("camera.view", 0.02),
            ("density", -0.1),
            ("grid.x", 0.3),
        ],
    ),
    (
        "sampled/two-point-ramp",
        &[("density", 0.03), ("grid.z", -0.2)],
    ),
    (
        "limit/plume",
        &[("density", 0.05), ("density", -0.3), ("camera.view", 0.01)],
    ),
    ("limit/thin-haze", &[("density", 0.1), ("grid.y", 0.3)]),
    ("limit/eye-inside", &[("density", -0.1)]),
    (
        STAIN,
        &[
            ("density", -0.2),
            ("environment", 0.3),
            ("camera.view", 0.02),
            ("camera.right", 0.4),
        ],
    ),
    (
        GLOW,
        &[
            ("emission", 0.1),
            ("density", -0.1),
            ("emission", -0.5),
            ("camera.down", 0.6),
        ],
    ),
    (
        ROOM,
        &[
            ("density.1", 0.2),
            ("density.2", -0.2),
            ("lamp", -0.05),
            ("lamp", 0.03),
            ("lamp.size", 0.05),
            ("lamp.x", 20.0),
            ("reflectance", 0.03),
            ("reflectance.1", -0.2),
            ("reflectance.3", -0.05),
            ("reflectance.5", -0.3),
            ("camera.view", 0.02724),
            ("camera.y", 3.0),
            ("medium.x.1", 10.0),
            ("medium.turn.2", 6.0),
            ("camera.right", 1.0),
            ("albedo.2", -0.3),
        ],
    ),
    (
        FOG,
        &[
            ("density", 0.05),
            ("density", -0.1),
            ("density", 0.5),
            ("g", 0.1),
            ("light", -0.05),
            ("light", 0.3),
            ("light.cone", 1.0),
            ("light.tilt", 1.0),
            ("light.x", 0.3),
            ("albedo", -0.05),
            ("reflectance", -0.2),
            ("camera.view", -0.02),
            ("camera.down", 1.0),
        ],
    ),
    (
        GREY,
        &[
            ("density", 0.05),
            ("density", 0.3),
            ("lamp", 0.03),
            ("index", 0.02),
            ("reflectance.3", -0.1),
            ("mirror", -0.1),
            ("g", 0.1),
            ("reflectance", -0.02),
        ],
    ),
    (
        SPOT,
        &[
            ("density", -0.1),
            ("light", 0.05),
            ("light.cone", -1.0),
            ("albedo", -0.1),
        ],
    ),
    (
        ABSORPTION,
        &[
            ("density", -0.05),
            ("lamp", 0.02),
            ("index", -0.05),
            ("lamp.z", 0.3),
        ],
    ),
    (
        "fog/dense-body",
        &[("density.1", 0.2), ("g.1", -0.2), ("light", 0.1)],
    ),
    ("fog/heterogeneous", &[("density", 0.1), ("light", -0.05)]),
    ("fog/rate-0.3", &[("density", -0.05), ("albedo", -0.03)]),
    (
        COLOURED,
        &[
            ("density", -0.1),
            ("sigma_a", 0.3),
            ("sigma_s", 0.05),
            ("g", -0.1),
            ("light", 0.05),
            ("environment", -0.1),
            ("light.tilt", 3.0),
            ("density", 0.3),
        ],
    ),
    (
        NOISE,
        &[("density", 0.1), ("light", -0.05), ("environment", 0.2)],
    ),
];

/// Mistakes of the catalogue that are a change of a number.
const SAME: [(&str, f64, &str); 4] = [
    ("density", -0.5, "opacity-halved"),
    ("emission", -0.5, "bright-halved"),
    ("camera.right", 1.0, "one-pixel-right"),
    ("camera.down", 1.0, "one-pixel-down"),
];

/// Changes of a number that mistakes of [`MISTAKES`] are, where there is one medium, or one light.
pub const NUMBERS_OF_MISTAKES: [(&str, &str, f64); 8] = [
    ("emitter-over-pi", "lamp", FRAC_1_PI - 1.0),
    ("environment-doubled", "environment", 1.0),
    ("extinction-base-ten", "density", LN_10 - 1.0),
    ("extinction-base-two", "density", LN_2 - 1.0),
    ("extinction-doubled", "density", 1.0),
    ("one-pixel-up", "camera.down", -1.0),
    ("one-pixel-right", "camera.right", 1.0),
    ("diffuse-over-pi", "reflectance", FRAC_1_PI - 1.0),
];

/// Names of mistakes that say what these edits do, beside their own.
const OTHER_NAMES: [(&str, &str); 2] = [
    ("emitter-over-pi", "bright-over-pi"),
    (
        "places values at the centres of cells, as in textures",
        "volume-cells-for-nodes",
    ),
];

/// Names of mistakes that say what `edit` does.
pub fn names_of(edit: &Edit) -> Vec<&'static str> {
    let (words, own) = match edit {
        Edit::Mistake(name) => (*name, Some(*name)),
        Edit::Convention(words) => (*words, None),
        _ => return Vec::new(),
    };
    let others = OTHER_NAMES.iter().filter(|it| it.0 == words);
    own.into_iter().chain(others.map(|it| it.1)).collect()
}

/// A fault of an image, with its label if it has one, and the number that is off.
struct OfImage {
    name: &'static str,
    kind: Kind,
    edit: fn(&Film) -> Film,
    labels: &'static [&'static str],
    number: Option<(&'static str, f64)>,
    cases: &'static [&'static str],
}

/// A fault of values that amounts to a number.
const fn values(
    name: &'static str,
    number: &'static str,
    change: f64,
    edit: fn(&Film) -> Film,
    cases: &'static [&'static str],
) -> OfImage {
    OfImage {
        name,
        kind: Kind::Values,
        edit,
        labels: &["gain", "channel"],
        number: Some((number, change)),
        cases,
    }
}

/// A fault in some pixels.
const fn places(
    name: &'static str,
    labels: &'static [&'static str],
    edit: fn(&Film) -> Film,
    cases: &'static [&'static str],
) -> OfImage {
    OfImage {
        name,
        kind: Kind::Places,
        edit,
        labels,
        number: None,
        cases,
    }
}

const IMAGES: &[OfImage] = &[
    values(
        "exposure + 1.4 %",
        "exposure",
        0.014,
        |f| times(f, [1.014; 3]),
        &[FOG, ROOM, SPOT],
    ),
    values(
        "exposure − 5 %",
        "exposure",
        -0.05,
        |f| times(f, [0.95; 3]),
        &[FOG, COLOURED, PLUME, COLUMN],
    ),
    values(
        "3 % of the brightness",
        "exposure",
        -0.97,
        |f| times(f, [0.03; 3]),
        &[ROOM, PLUME, FOG, COLOURED],
    ),
    values(
        "brightness × 2.5",
        "exposure",
        1.5,
        |f| times(f, [2.5; 3]),
        &[GREY, HEAD],
    ),
    values(
        "blue − 3 %",
        "gain.blue",
        -0.03,
        |f| times(f, [1.0, 1.0, 0.97]),
        &[ROOM, COLOURED, PLUME],
    ),
    values(
        "red + 20 %",
        "gain.red",
        0.2,
        |f| times(f, [1.2, 1.0, 1.0]),
        &[GREY, HEAD],
    ),
    values(
        "all values + 0.005",
        "offset",
        0.005,
        |f| by_value(f, |x, _| x + 0.005),
        &[ROOM, FOG, PLUME],
    ),
    values(
        "exponent 1.05",
        "gamma",
        0.05,
        |f| by_value(f, |x, _| power(x, 1.05)),
        &[ROOM, PLUME, COLOURED],
    ),
    OfImage {
        kind: Kind::Values,
        ..places(
            "values of 6 bits",
            &[],
            |f| by_value(f, |x, _| (63.0 * x).round() / 63.0),
            &[PLUME, STAIN, HEAD],
        )
    },
    OfImage {
        kind: Kind::Values,
        ..places(
            "stated variance halved",
            &["noise"],
            |f| images::noise_times(f, 0.5),
            &[ROOM, FOG, COLOURED],
        )
    },
    OfImage {
        kind: Kind::Values,
        ..places(
            "a curve of film",
            &[],
            |f| by_value(f, |x, _| x * (1.2 + 0.1 * x) / (1.0 + 0.4 * x)),
            &[ROOM, HEAD],
        )
    },
    places(
        "green in all channels",
        &[],
        |f| channels(f, [1, 1, 1]),
        &[ROOM, COLUMN],
    ),
    places(
        "first row black",
        &["black"],
        |f| from_elsewhere(f, |[x, y], _| (y > 0).then_some([x, y])),
        &[ROOM, FOG, GREY, COLOURED],
    ),
    places(
        "last column black",
        &["black"],
        |f| from_elsewhere(f, |[x, y], [w, _]| (x + 1 < w).then_some([x, y])),
        &[FOG, ROOM],
    ),
    places(
        "20 black pixels",
        &["black"],
        |f| from_elsewhere(f, |at, size| (!is_one_of_twenty(at, size)).then_some(at)),
        &[ROOM, FOG, SPOT, PLUME],
    ),
    places(
        "a black pixel",
        &["black"],
        |f| from_elsewhere(f, |at, [w, h]| (at != [w / 2, h / 2]).then_some(at)),
        &[ROOM, FOG, PLUME],
    ),
    places(
        "a tile of 16 × 16 black",
        &["black", "place"],
        |f| {
            from_elsewhere(f, |[x, y], _| {
                (x / 16 != 4 || y / 16 != 4).then_some([x, y])
            })
        },
        &[ROOM, GREY, PLUME],
    ),
    places(
        "20 pixels ten times as bright",
        &[],
        |f| {
            let size = [f.width(), f.height()];
            by_place(f, move |x, at| {
                if is_one_of_twenty(at, size) {
                    10.0 * x
                } else {
                    x
                }
            })
        },
        &[ROOM, FOG, PLUME],
    ),
    places(
        "eight columns copied from their neighbours",
        &["place"],
        |f| {
            from_elsewhere(f, |[x, y], _| {
                Some([if (96..104).contains(&x) { x - 8 } else { x }, y])
            })
        },
        &[ROOM, FOG, PLUME],
    ),
    places(
        "odd rows copied from even ones",
        &[],
        |f| from_elsewhere(f, |[x, y], _| Some([x, y / 2 * 2])),
        &[ROOM, PLUME, STAIN],
    ),
    places(
        "right half a row lower",
        &["moved", "place"],
        |f| {
            from_elsewhere(f, |[x, y], [w, _]| {
                Some([x, if x >= w / 2 { y.saturating_sub(1) } else { y }])
            })
        },
        &[ROOM, PLUME],
    ),
    OfImage {
        number: Some(("camera.down", 2.0)),
        ..places(
            "two rows lower",
            &["moved"],
            |f| from_elsewhere(f, |[x, y], _| Some([x, y.saturating_sub(2)])),
            &[PLUME, ROOM, HEAD],
        )
    },
    places(
        "left half mirrored to the right",
        &["place"],
        |f| from_elsewhere(f, |[x, y], [w, _]| Some([x.min(w - 1 - x), y])),
        &[ROOM, PLUME, FOG],
    ),
    places(
        "two tiles exchanged",
        &[],
        |f| {
            from_elsewhere(f, |[x, y], _| {
                Some([
                    match x / 32 {
                        1 => x + 64,
                        3 => x - 64,
                        _ => x,
                    },
                    y,
                ])
            })
        },
        &[ROOM, FOG, PLUME],
    ),
    places(
        "panels exchanged",
        &[],
        |f| from_elsewhere(f, |[x, y], [w, _]| Some([(x + w / 2) % w, y])),
        &[SHADOWED],
    ),
    places(
        "green a pixel to the right",
        &["channel", "moved"],
        |f| {
            let moved = from_elsewhere(f, |[x, y], _| Some([x.saturating_sub(1), y]));
            images::by_pixel(f, |[r, _, b], [x, y]| {
                [r, moved.radiance()[x + y * moved.width()][1], b]
            })
        },
        &[ROOM, PLUME],
    ),
    places(
        "scaled to nine tenths",
        &[],
        |f| {
            from_elsewhere(f, |[x, y], [w, h]| {
                Some([(x * 10 / 9).min(w - 1), (y * 10 / 9).min(h - 1)])
            })
        },
        &[ROOM, HEAD],
    ),
];

/// Mistakes of the catalogue, made exactly.
const MISTAKES: &[(Kind, &str, &[&str])] = &[
    (
        Kind::Catalogue,
        PLUME,
        &[
            "opacity-uncorrected",
            "highlight-too-wide",
            "volume-cells-for-nodes",
            "ambient-left-out",
        ],
    ),
    (
        Kind::Catalogue,
        SHADOWED,
        &["shadow-hundredfold", "shadow-step-not-counted"],
    ),
    (
        Kind::Catalogue,
        HEAD,
        &[
            "nearest-for-trilinear",
            "volume-half-voxel-off",
            "red-and-green-exchanged",
        ],
    ),
    (
        Kind::Catalogue,
        ROOM,
        &[
            "absorption-and-scattering-exchanged",
            "absorption-and-scattering-exchanged",
            "diffuse-over-pi",
            "single-scattering",
            "paths-cut",
            "extinction-doubled",
            "one-pixel-up",
            "channels-green-blue-red",
            "red-and-green-exchanged",
        ],
    ),
    (
        Kind::Catalogue,
        FOG,
        &[
            "phase-reversed",
            "phase-isotropic",
            "extinction-base-ten",
            "spot-angles-halved",
            "paths-cut",
        ],
    ),
    (
        Kind::Catalogue,
        GREY,
        &[
            "glass-without-refraction",
            "mirror-black",
            "emitter-over-pi",
            "extinction-base-two",
        ],
    ),
    (
        Kind::Catalogue,
        COLOURED,
        &[
            "coefficients-of-red",
            "absorption-left-out",
            "sun-reversed",
            "phase-reversed",
            "channels-green-blue-red",
            "red-and-green-exchanged",
        ],
    ),
    (Kind::Catalogue, ABSORPTION, &["channels-green-blue-red"]),
    (Kind::Catalogue, COLUMN, &["channels-green-blue-red"]),
    (
        Kind::Catalogue,
        NOISE,
        &["noise-of-one-octave", "environment-doubled"],
    ),
    (Kind::Catalogue, GLOW, &["emission-times-absorption"]),
    (
        Kind::RayCaster,
        PLUME,
        &[
            "transmittance-before-the-sum",
            "gradient-by-the-ray-step",
            "volume-y-and-z-exchanged",
            "volume-rows-of-another-length",
        ],
    ),
    (Kind::RayCaster, HEAD, &["transmittance-before-the-sum"]),
    (
        Kind::PathTracer,
        ROOM,
        &[
            "media-bounds-block-light",
            "shadow-rays-unattenuated",
            "lights-counted-twice",
            "hits-of-lights-unweighted",
            "samples-of-lights-unweighted",
            "hits-of-lights-left-out",
            "reflectance-left-out-of-direct-light",
            "reflectance-squared-in-direct-light",
            "null-collisions-unweighted",
            "roulette-uncompensated",
            "paths-cut-at-three",
            "paths-cut-at-seven",
        ],
    ),
    (
        Kind::PathTracer,
        FOG,
        &[
            "phase-reversed-for-lights",
            "reflectance-squared-in-direct-light",
            "shadow-rays-unattenuated",
            "roulette-uncompensated",
            "paths-cut-at-three",
            "paths-cut-at-seven",
        ],
    ),
    (
        Kind::PathTracer,
        GREY,
        &[
            "lights-counted-twice",
            "hits-of-lights-left-out",
            "roulette-uncompensated",
            "paths-cut-at-seven",
            "samples-of-lights-unweighted",
        ],
    ),
    (
        Kind::PathTracer,
        "fog/balance",
        &[
            "albedo-left-out-of-direct-light",
            "albedo-squared-in-direct-light",
            "null-collisions-unweighted",
        ],
    ),
    (
        Kind::PathTracer,
        ABSORPTION,
        &["shadow-rays-unattenuated", "null-collisions-unweighted"],
    ),
    (
        Kind::PathTracer,
        COLOURED,
        &[
            "phase-reversed-for-lights",
            "albedo-left-out-of-direct-light",
            "null-collisions-unweighted",
        ],
    ),
];

/// Conventions of ray casters.
const CONVENTIONS: &[(&str, &[&str])] = &[
    (
        PLUME,
        &[
            "takes the first sample of a ray on the front face, not half a step behind it",
            "takes opacity in proportion to the step",
            "takes forward differences for gradients",
            "takes backward differences for gradients",
            "turns normals towards the eye",
            "takes gradients by Sobel's filter",
            "takes highlights by the half vector (Blinn)",
            "composites in 8 bits",
            "ends rays at a transmittance of 0.05",
            "takes steps of half the length",
        ],
    ),
    (
        NEAREST,
        &[
            "lights both sides of a surface",
            "counts the last step of a ray as a whole one",
        ],
    ),
    (
        HEAD,
        &[
            "classifies nodes before it interpolates",
            "places values at the centres of cells, as in textures",
            "keeps the opacities of its table in 8 bits",
        ],
    ),
    (
        COLUMN,
        &[
            "fills half a voxel beyond the outermost nodes, too",
            "looks colours and opacities up in a table of 64 entries, interpolated",
        ],
    ),
];

/// Two faults together.
const TOGETHER: &[(&str, &str, [Edit; 2])] = &[
    (
        "extinction + 10 %, light to the side",
        PLUME,
        [Edit::Number("density", 0.1), Edit::Number("light.x", 1.0)],
    ),
    (
        "diffuse − 20 %, one pixel right",
        PLUME,
        [
            Edit::Number("diffuse", -0.2),
            Edit::Mistake("one-pixel-right"),
        ],
    ),
    (
        "no highlights, half a voxel back",
        PLUME,
        [
            Edit::Mistake("specular-left-out"),
            Edit::Mistake("volume-half-voxel-back"),
        ],
    ),
    (
        "no shading, upside down",
        PLUME,
        [
            Edit::Mistake("shading-left-out"),
            Edit::Mistake("upside-down"),
        ],
    ),
    (
        "linear opacity, extinction − 10 %",
        PLUME,
        [
            Edit::Convention("takes opacity in proportion to the step"),
            Edit::Number("density", -0.1),
        ],
    ),
    (
        "half-vector highlights, mirrored",
        PLUME,
        [
            Edit::Convention("takes highlights by the half vector (Blinn)"),
            Edit::Mistake("mirrored"),
        ],
    ),
    (
        "background − 10 %, extinction + 10 %",
        COLUMN,
        [
            Edit::Number("background", -0.1),
            Edit::Number("density", 0.1),
        ],
    ),
    (
        "nearest node, sRGB",
        HEAD,
        [
            Edit::Mistake("nearest-for-trilinear"),
            Edit::Mistake("srgb-encoded"),
        ],
    ),
    (
        "lamp − 10 %, field of view + 2 %",
        ROOM,
        [
            Edit::Number("lamp", -0.1),
            Edit::Number("camera.view", 0.02),
        ],
    ),
    (
        "smoke + 20 %, walls − 5 %",
        ROOM,
        [
            Edit::Number("density", 0.2),
            Edit::Number("reflectance", -0.05),
        ],
    ),
    (
        "emitter over π, mirrored",
        ROOM,
        [Edit::Mistake("emitter-over-pi"), Edit::Mistake("mirrored")],
    ),
    (
        "media left out, lamp − 10 %",
        ROOM,
        [Edit::Number("lamp", -0.1), Edit::Mistake("media-left-out")],
    ),
    (
        "phase reversed, bright twice",
        FOG,
        [
            Edit::Mistake("phase-reversed"),
            Edit::Mistake("bright-doubled"),
        ],
    ),
    (
        "fog + 10 %, g + 0.1",
        FOG,
        [Edit::Number("density", 0.1), Edit::Number("g", 0.1)],
    ),
    (
        "fog − 10 %, light + 10 %",
        SPOT,
        [Edit::Number("density", -0.1), Edit::Number("light", 0.1)],
    ),
    (
        "base ten, half a pixel down",
        GREY,
        [
            Edit::Mistake("extinction-base-ten"),
            Edit::Mistake("half-a-pixel-down"),
        ],
    ),
    (
        "lamp + 5 %, mirror − 20 %",
        GREY,
        [Edit::Number("lamp", 0.05), Edit::Number("mirror", -0.2)],
    ),
    (
        "sky doubled, red and blue exchanged",
        COLOURED,
        [
            Edit::Mistake("environment-doubled"),
            Edit::Mistake("red-and-blue-exchanged"),
        ],
    ),
    (
        "smoke + 20 %, sun − 10 %",
        COLOURED,
        [Edit::Number("density", 0.2), Edit::Number("light", -0.1)],
    ),
    (
        "one octave, noise + 20 %",
        NOISE,
        [
            Edit::Number("density", 0.2),
            Edit::Mistake("noise-of-one-octave"),
        ],
    ),
    (
        "stain + 10 %, sky − 10 %",
        STAIN,
        [
            Edit::Number("density", 0.1),
            Edit::Number("environment", -0.1),
        ],
    ),
];

pub fn faults() -> Vec<Fault> {
    let mut all = Vec::new();
    for &(case, numbers) in NUMBERS {
        let faults = numbers.iter().map(|&(number, change)| {
            let is_seen = number.starts_with("camera")
                || number.starts_with("lamp.")
                || number.starts_with("medium.");
            let kind = if is_seen {
                Kind::Geometry
            } else {
                Kind::Number
            };
            let fault = Fault::new(
                kind,
                format!("{number} {change:+}"),
                case,
                &[Edit::Number(number, change)],
            );
            let same = SAME.iter().filter(|it| (it.0, it.1) == (number, change));
            let same: Vec<&str> = same.map(|it| it.2).collect();
            let fault = fault.named(&same);
            let is_light = ["lamp", "light", "environment", "emission"].contains(&number);
            fault.said(match number.split_once('.') {
                Some(("camera" | "grid", _)) => &["moved"],
                _ if is_light => &["gain"],
                _ => &[],
            })
        });
        all.extend(at_both_rates(faults));
    }
    for of_image in IMAGES {
        let faults = of_image.cases.iter().map(|case| {
            let fault = Fault::new(
                of_image.kind,
                of_image.name,
                case,
                &[Edit::Film(of_image.edit)],
            );
            let fault = fault.said(of_image.labels);
            match of_image.number {
                Some((number, change)) => fault.number(number, change),
                None => fault,
            }
        });
        all.extend(at_both_rates(faults));
    }
    for &(kind, case, names) in MISTAKES {
        let faults = names.iter().enumerate().map(|(i, name)| {
            let again = if names[..i].contains(name) {
                ", again"
            } else {
                ""
            };
            Fault::new(kind, format!("{name}{again}"), case, &[Edit::Mistake(name)])
        });
        all.extend(at_both_rates(faults));
    }
    for &(case, conventions) in CONVENTIONS {
        all.extend(
            conventions.iter().map(|words| {
                Fault::new(Kind::Convention, *words, case, &[Edit::Convention(words)])
            }),
        );
    }
    let together = TOGETHER
        .iter()
        .map(|(name, case, edits)| Fault::new(Kind::Together, *name, case, edits));
    all.extend(at_both_rates(together));
    all
}

/// Every other one at 64 samples.
fn at_both_rates(faults: impl Iterator<Item = Fault>) -> impl Iterator<Item = Fault> {
    let rates = [16, 64].into_iter().cycle();
    faults.zip(rates).map(|(fault, samples)| fault.at(samples))
}

fn power(x: f64, exponent: f64) -> f64 {
    if x > 0.0 {
        math::exp(exponent * math::ln(x))
    } else {
        x
    }
}
