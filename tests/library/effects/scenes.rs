//! Scenes made of effects, as text, and what comes of them.

use crate::common::suite::root;
use crate::effects::effects_of;
use volref::film::Film;
use volref::render::plan::Kernel;
use volref::render::{Counters, Event, Plan, Sampling, render};
use volref::scene::Scene;

/// A scene by the text of its file, which stands in a folder of the fixtures.
#[track_caller]
pub fn parsed(text: &str) -> Scene {
    match Scene::parse(text, &root().join("fixtures/scenes/hard/scene.toml")) {
        Ok(scene) => scene,
        Err(error) => panic!("{error:?}\n{text}"),
    }
}

/// The plan of the only picture of a scene.
pub fn plan(scene: &Scene) -> Plan<'_> {
    Plan::new(&scene.panels[0])
}

/// The image by a plan, and its work.
#[track_caller]
pub fn rendered(plan: &Plan<'_>) -> (Film, Counters) {
    let plans = std::slice::from_ref(plan);
    let rendering = render(plans, Sampling::default(), &|| ());
    let rendering = rendering.unwrap_or_else(|error| panic!("{error}"));
    (rendering.film, rendering.work[0])
}

/// No work is done but that of effects that are on.
#[track_caller]
pub fn off_is_off(what: &str, plan: &Plan<'_>, work: &Counters) {
    for event in Event::ALL.into_iter().filter(|&event| !may_do(plan, event)) {
        assert_eq!(work[event], 0, "{what}: {}, though off", event.key());
    }
}

/// Whether any work of this kind is done: some effect that does it is simulated, or is omitted
/// in part only. Up to a limit, light is scattered more than once; and a scattering medium
/// attenuates light from behind even where in-scattering is omitted.
fn may_do(plan: &Plan<'_>, event: Event) -> bool {
    let in_part = match (event, plan.kernel) {
        (Event::FurtherScattering, Kernel::PathTracer { max_order, .. }) => max_order >= Some(2),
        (
            Event::Attenuation,
            Kernel::LineOfSight { features, .. } | Kernel::PathTracer { features, .. },
        ) => features.media,
        // Where heterogeneity was forced: the code for heterogeneous media, along the line of
        // sight, evaluates every phase function.
        (
            Event::PhaseEvaluation,
            Kernel::LineOfSight {
                features, scatters, ..
            },
        ) => scatters && features.heterogeneous,
        // Where nothing scatters light, and multiple scattering was forced.
        (Event::FirstScattering, Kernel::LineOfSight { scatters, .. }) => scatters,
        // Where the volume is transparent, and an effect was forced.
        (Event::DensityLookup, Kernel::RayCaster { features, .. }) => !features.constant,
        (Event::Attenuation | Event::EmissionTerm, Kernel::RayCaster { .. }) => true,
        (Event::DensityLookup | Event::CellWalked, Kernel::Integral(scene)) => {
            (0..=scene.objects.volumes.len()).any(|index| {
                let (least, most) = scene.alone(index).grid.range();
                least != most
            })
        }
        (Event::Attenuation | Event::EmissionTerm, Kernel::Integral(_)) => true,
        _ => false,
    };
    in_part || effects_of(event).iter().any(|&effect| plan.is_on(effect))
}

/// What a scene of surfaces, media and lights is made of.
#[derive(Clone, Copy, Debug, Default)]
pub struct Radiative {
    pub surfaces: bool,
    pub absorption: bool,
    pub scattering: bool,
    pub emission: bool,
    pub density: Density,
    pub chromatic: bool,
    pub anisotropic: bool,
    pub turns: Turns,
    pub light: Light,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Light {
    /// From nowhere, if nothing emits.
    None,
    /// From nowhere either: lights of strength 0, one of them a surface.
    Dark,
    #[default]
    Point,
    /// From a rectangle, which is a surface.
    Area,
    Environment,
}

impl Light {
    pub const ALL: [Light; 5] = [
        Light::None,
        Light::Dark,
        Light::Point,
        Light::Area,
        Light::Environment,
    ];
}

/// How the density of the medium differs from place to place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Density {
    /// Not at all; there is none.
    #[default]
    None,
    /// Not at all, though there is a grid.
    ConstantGrid,
    /// By a grid.
    Grid,
    /// By noise.
    Noise,
}

impl Density {
    pub const ALL: [Density; 4] = [
        Density::None,
        Density::ConstantGrid,
        Density::Grid,
        Density::Noise,
    ];
}

/// How often light may be scattered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Turns {
    Never,
    Once,
    Twice,
    #[default]
    AnyNumber,
}

impl Turns {
    pub const ALL: [Turns; 4] = [Turns::Never, Turns::Once, Turns::Twice, Turns::AnyNumber];
}

impl Radiative {
    /// Every scene that can be made of effects.
    pub fn all() -> impl Iterator<Item = Radiative> {
        let sets = 0..1_u32 << 6;
        sets.flat_map(|set| {
            let has = move |bit: u32| set & (1 << bit) != 0;
            Density::ALL.into_iter().flat_map(move |density| {
                Turns::ALL.into_iter().flat_map(move |turns| {
                    Light::ALL.into_iter().map(move |light| Radiative {
                        surfaces: has(0),
                        absorption: has(1),
                        scattering: has(2),
                        emission: has(3),
                        chromatic: has(4),
                        anisotropic: has(5),
                        density,
                        turns,
                        light,
                    })
                })
            })
        })
        // A density without coefficients is refused where it is read.
        .filter(|scene| {
            scene.density == Density::None || scene.absorption || scene.scattering || scene.emission
        })
    }

    /// The text of its file: a picture of 3 × 2 pixels.
    pub fn text(self) -> String {
        let turns = match self.turns {
            Turns::Never => "scattering = 'none'",
            Turns::Once => "scattering = 'single'",
            Turns::Twice => "scattering = 'multiple'\nmax_bounces = 2",
            Turns::AnyNumber => "scattering = 'multiple'",
        };
        let surfaces = "\
[[radiative.surface]]
sphere = { centre = [0.2, 0.1, 0.9], radius = 0.4 }
diffuse = { reflectance = [0.7, 0.5, 0.9] }
[[radiative.surface]]
rectangle = { corner = [-2, -0.6, -1], edge_u = [0, 0, 3], edge_v = [4, 0, 0] }
diffuse = { reflectance = 0.6 }
";
        let coefficient = |on: bool, grey: &str, coloured: &str| match (on, self.chromatic) {
            (false, _) => "0".to_owned(),
            (true, false) => grey.to_owned(),
            (true, true) => coloured.to_owned(),
        };
        let density = match self.density {
            Density::None => "box = { min = [-0.5, -0.5, -0.5], max = [0.75, 0.75, 0.75] }",
            Density::ConstantGrid => "grid = { file = '../../volumes/hard/constant.nrrd' }",
            Density::Grid => "grid = { file = '../../volumes/hard/hill.nrrd' }",
            // Thin, and as dense as the others are deep: bounds on noise are found block by block,
            // of which a cube would have ten times as many, a thousand times over.
            Density::Noise => {
                "box = { min = [-0.5, -0.5, -0.05], max = [0.75, 0.75, 0.05] }\n\
                 noise = { octaves = 2, scale = [5, 5, 5], max_density = 25, threshold = 0.8 }"
            }
        };
        let point = |intensity: &str| {
            format!(
                "[[radiative.light]]\n\
                 point = {{ position = [0.9, 1.4, -0.8], intensity = {intensity} }}\n"
            )
        };
        let area = |radiance: &str| {
            format!(
                "[[radiative.surface]]\n\
                 rectangle = {{ corner = [0.4, 1.4, -0.9], edge_u = [0.5, 0, 0], edge_v = [0, 0, 0.5] }}\n\
                 emitter = {{ radiance = {radiance}, sides = 'both' }}\n"
            )
        };
        let lights = match self.light {
            Light::None | Light::Environment => String::new(),
            Light::Dark => point("0") + &area("0"),
            Light::Point => point("[3, 2.5, 2]"),
            Light::Area => area("[9, 8, 7]"),
        };
        let environment = match self.light {
            Light::Environment => "environment = [0.5, 0.6, 0.8]",
            _ => "",
        };
        format!(
            "[film]\nwidth = 3\nheight = 2\n\
             [camera]\neye = [0.35, 0.4, -2.2]\ntarget = [0.12, 0.1, 0.1]\nvertical_fov = 34\n\
             [sampling]\nsamples = 2\nseed = 5\n\
             [radiative]\n{turns}\n{environment}\n\
             {}\
             [[radiative.medium]]\n{density}\n\
             sigma_a = {}\nsigma_s = {}\nemission = {}\ng = {}\n\
             {lights}",
            if self.surfaces { surfaces } else { "" },
            coefficient(self.absorption, "0.8", "[0.8, 0.5, 1.1]"),
            coefficient(self.scattering, "2", "[2, 1.4, 2.6]"),
            if self.emission {
                "[0.4, 0.2, 0.1]"
            } else {
                "0"
            },
            if self.anisotropic { "0.6" } else { "0" },
        )
    }
}

/// What a classified volume is made of.
#[derive(Clone, Copy, Debug)]
pub struct Classified {
    pub nearest: bool,
    pub constant: bool,
    /// Whether some values have no opacity.
    pub transparent: bool,
    pub shading: Shading,
    pub shadow: bool,
    pub compositing: &'static str,
}

/// How samples are coloured by the gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shading {
    None,
    /// By weights that leave every colour as it is.
    Identity,
    Phong,
}

impl Classified {
    /// Every volume that can be made of effects.
    pub fn all() -> impl Iterator<Item = Classified> {
        let compositing = [
            "compositing = 'front-to-back'",
            "compositing = 'back-to-front'",
            "early_termination = 0.01",
        ];
        let shadings = [Shading::None, Shading::Identity, Shading::Phong];
        (0..1_u32 << 4).flat_map(move |set| {
            let has = move |bit: u32| set & (1 << bit) != 0;
            shadings.into_iter().flat_map(move |shading| {
                compositing.into_iter().map(move |compositing| Classified {
                    nearest: has(0),
                    constant: has(1),
                    transparent: has(2),
                    shadow: has(3),
                    shading,
                    compositing,
                })
            })
        })
    }

    /// The text of its file: a picture of 5 × 4 pixels.
    pub fn text(self) -> String {
        let Classified { compositing, .. } = self;
        let interpolation = if self.nearest { "nearest" } else { "trilinear" };
        let volume = if self.constant { "constant" } else { "hill" };
        let opacity = if self.transparent { 0.0 } else { 0.02 };
        let shading = match self.shading {
            Shading::None => "",
            Shading::Identity => "[classified.phong]\nambient = 1\ndiffuse = 0\nspecular = 0\n",
            Shading::Phong => "[classified.phong]\n",
        };
        let shadow = if self.shadow {
            "[classified.shadow]\n"
        } else {
            ""
        };
        format!(
            "[film]\nwidth = 5\nheight = 4\n\
             [transfer_function]\nreference_length = '1 voxel'\npoint = [\n\
             {{ value = 0.3, colour = [0.2, 0.4, 0.9], opacity = {opacity} }},\n\
             {{ value = 1, colour = [0.9, 0.7, 0.3], opacity = 0.4 }} ]\n\
             [classified]\n{compositing}\ninterpolation = '{interpolation}'\n\
             [classified.volume]\nfile = '../../volumes/hard/{volume}.nrrd'\n{shading}{shadow}"
        )
    }
}
