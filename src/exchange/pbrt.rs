//! Scenes for pbrt-v4, checked against its sources at commit 5f7a606 and rendered with it
//! (scripts/peers/README.md). Files and functions below are those under its `src/pbrt/`.
//!
//! - pbrt multiplies spectra, not channels. Only grey values mean the same to both: `rgb` of
//!   three equal numbers is a constant spectrum for reflectances and coefficients, and the white
//!   of sRGB for lights. So a scene with colours is said channel by channel, in three files; the
//!   picture of each is grey, and is that channel.
//! - `LookAt` is left-handed: `Scale -1 1 1` before it puts +x to the left for who looks along +z.
//! - `fov` goes across the shorter side of the image.
//! - Light scattered n times is `maxdepth` n; interfaces do not count. What media emit is added
//!   only before the last bounce (`cpu/integrators.cpp`, `VolPathIntegrator::Li`), so that for
//!   emission scattered n times it is n + 1.
//! - `Le` times `sigma_a` is the emission (there): `Le` is `emission / sigma_a`.
//! - A spotlight with a hard edge is never chosen by the default light sampler, for its
//!   `LightBounds` hold no direction (`lights.cpp`, `SpotLight::Bounds`, `LightBounds::Importance`
//!   with `cosTheta_e` 1): the sampler `power` chooses by power alone.
//! - A `seed` in the file wins over `--seed` (`samplers.cpp`, `IndependentSampler::Create`), and
//!   replicates would all be the same picture: none is written.
//! - The parser ends the program at a number of 63 characters or more, and cuts whole numbers off
//!   at 2⁶³ (`parser.cpp`, `parseFloat`): the very large and small have exponents.
//! - Media are named before `WorldBegin`, for the eye may be in one, and after `Camera`, for the
//!   coordinates of a grid.
//! - A `uniformgrid` has its values in the middles of voxels and fades to 0 beyond them: around
//!   the grid another layer of its outermost values is laid.
//! - `Lescale` of such a grid, left out, is one voxel of 1 (`media.cpp`, `GridMedium::Create`), which
//!   fades likewise (`util/containers.h`, `SampledGrid::Lookup`), and emission with it to an eighth in
//!   the corners: it is written as a grid of ones.
//! - A conductor reflects the less the flatter it is met, unless it is infinitely conductive: a
//!   mirror is one with k = 10⁶, mixed with black. Where it is met at an angle of cosine c it
//!   takes away 4·10⁻¹²/c, no more than is lost by 32-bit numbers.
//!
//! Refused, beside what both formats lack words for: spotlights with a soft edge, whose falloff
//! is another one (`lights.cpp`, `SpotLight::I`); nearest-neighbour grids; media with different
//! phase functions in one place; emission where nothing absorbs; and what `limits` names.

use super::export_scene::ExportScene;
use super::files::SharedFiles;
use super::forms::Form;
use super::limits;
use super::mixture::Mixture;
use super::nested_media::{ExportSurface, NestedMedium, PlacedGrid, SurfaceKind, key_of};
use super::refusal::Faults;
use super::view::{ahead, degrees};
use super::{Export, Format, Refusal};
use crate::film::CHANNELS;
use crate::geometry::Transform;
use crate::optics::{Light, Material, Phase, Sides};
use crate::scene::{Panel, Radiative, Scattering};
use glam::DVec3;
use std::fmt::{Display, LowerExp};

/// The distance of boundaries in a scene of this reach. pbrt starts rays off a surface by the error
/// bound of the place, at most 7 roundings (2⁻²⁴) of its coordinates from the eye, 2√3 times the reach
/// (`shapes.h`, `ray.h`, `OffsetRayOrigin`): 1.5e-6 of the reach, in every unit of length. The rest keeps the
/// boundaries of large scenes where Mitsuba has them.
fn gap(reach: f64) -> f64 {
    5e-4 * reach
}

/// So many bounces are as good as any number: of the light that a white half-space returns, of the
/// order of n^-1/2 is scattered more than n times, here a thousandth; of light that is absorbed or
/// leaves by another side, less. And a path that has lost a boundary to rounding, which one in
/// about 1e5 does, ends within seconds.
const ENDLESS: u32 = 1_000_000;

/// The two materials that a mirror is mixed of: a name is given once in a file.
const MIRROR: &str = "\
MakeNamedMaterial \"black\" \"string type\" [ \"diffuse\" ] \"rgb reflectance\" [ 0 0 0 ]
MakeNamedMaterial \"mirror\" \"string type\" [ \"conductor\" ] \"float roughness\" [ 0 ]
    \"spectrum eta\" [ 200 1 900 1 ] \"spectrum k\" [ 200 1000000 900 1000000 ]
";

/// The scene in one file, or one for each channel, with its meshes beside it.
pub(super) fn scene(panel: &Panel, scene: &Radiative, name: &str) -> Result<Export, Refusal> {
    let mut faults = Faults::default();
    let export = ExportScene::of(panel, scene, gap, limits::LENGTHS, &mut faults);
    limits::check(scene, &export, &mut faults);
    let orders = ScatteringOrders::of(scene, &export, &mut faults);
    orders.check_emission(&export, &mut faults);
    let is_grey = colours(scene, &export).all(|colour| colour == DVec3::splat(colour.x));
    let texts: Vec<(Option<usize>, String)> = if is_grey {
        vec![(None, format!("{name}.pbrt"))]
    } else {
        (0..3)
            .map(|channel| (Some(channel), format!("{name}.{}.pbrt", CHANNELS[channel])))
            .collect()
    };
    let main = texts[0].1.clone();
    let mut files = Vec::new();
    let mut meshes = SharedFiles::new(name);
    for (channel, file) in texts {
        let mut writer = PbrtWriter {
            text: String::new(),
            channel: channel.unwrap_or(0),
            orders: &orders,
            meshes: &mut meshes,
        };
        writer.opening(panel, &export, channel);
        writer.options(panel, scene, &export, &file);
        writer.media(&export);
        writer.line("\nWorldBegin\nMediumInterface \"\" \"\"\n");
        let mut objects = scene.objects.iter();
        if objects.any(|object| matches!(object.material, Material::Mirror(_))) {
            writer.line(MIRROR);
        }
        for light in &scene.lights {
            writer.light(light);
        }
        if scene.environment != DVec3::ZERO {
            let radiance = writer.rgb("L", scene.environment);
            writer.line(&format!("LightSource \"infinite\" {radiance}"));
        }
        writer.surfaces(&export);
        files.push((file, writer.text.into_bytes()));
    }
    files.extend(meshes.files);
    faults.none(Format::Pbrt, Export { main, files })
}

/// Scattering orders that pbrt counts, and the emission of media.
struct ScatteringOrders {
    /// `maxdepth`.
    depth: u32,
    /// Whether nothing scatters light, so that what would only absorbs it.
    never: bool,
}

impl ScatteringOrders {
    fn of(scene: &Radiative, export: &ExportScene, faults: &mut Faults) -> ScatteringOrders {
        let list = &export.nested_media.list;
        let limit = scene.scattering.max_bounces();
        let limit = limit.unwrap_or(ENDLESS).min(ENDLESS);
        let is_emissive = |nested: &NestedMedium| nested.medium.emission != DVec3::ZERO;
        if limit == ENDLESS || !list.iter().any(is_emissive) {
            let (depth, never) = (limit, false);
            return ScatteringOrders { depth, never };
        }
        let orders = ScatteringOrders {
            depth: limit + 1,
            never: limit == 0,
        };
        let scatters_at_all = !scene.objects.is_empty() || list.iter().any(NestedMedium::scatters);
        let others = !scene.lights.is_empty()
            || !scene.area_lights.is_empty()
            || scene.environment != DVec3::ZERO;
        if scatters_at_all && others && !orders.never {
            let key = match scene.scattering {
                Scattering::Multiple(_) => "radiative.max_bounces",
                _ => "radiative.scattering",
            };
            let what = "light that media emit beside other light, scattered so often at most: pbrt counts the \
                        bounces of the two differently; remove the limit, the emission or the other lights";
            faults.add(key, what);
        }
        orders
    }

    /// Absorption and scattering of a mixture.
    fn coefficients(&self, mixture: &Mixture) -> [DVec3; 2] {
        if self.never {
            [mixture.sigma_t(), DVec3::ZERO]
        } else {
            [mixture.sigma_a, mixture.sigma_s]
        }
    }

    /// `Le` of a mixture, infinite where there is emission without absorption.
    fn emission_per_absorption(&self, mixture: &Mixture) -> DVec3 {
        let [sigma_a, _] = self.coefficients(mixture);
        let ratio = |channel: usize| match mixture.emission[channel] {
            0.0 => 0.0,
            emission => emission / sigma_a[channel],
        };
        DVec3::new(ratio(0), ratio(1), ratio(2))
    }

    /// Names the media that cannot shine as they should.
    fn check_emission(&self, export: &ExportScene, faults: &mut Faults) {
        for (at, nested) in export.nested_media.list.iter().enumerate() {
            let mixture = export.nested_media.mixture(at);
            if self.emission_per_absorption(&mixture).max_element() > f64::from(f32::MAX) {
                let what = "emission where nothing, or next to nothing, is absorbed: pbrt says it \
                            as a factor of sigma_a; give sigma_a in every channel of emission";
                faults.add(key_of(nested.index), what);
            }
        }
    }
}

/// Every colour of a scene.
fn colours<'s>(scene: &'s Radiative, export: &'s ExportScene) -> impl Iterator<Item = DVec3> + 's {
    let materials = scene.objects.iter().filter_map(|it| match it.material {
        Material::Diffuse(reflectance) | Material::Mirror(reflectance) => Some(reflectance),
        Material::Glass(_) => None,
    });
    let media = export.nested_media.list.iter().flat_map(|nested| {
        let coefficients = &nested.medium.coefficients;
        let emission = nested.medium.emission;
        [coefficients.sigma_a(), coefficients.sigma_s(), emission]
    });
    let lights = scene.lights.iter().map(Light::strength);
    let lamps = scene.area_lights.iter().map(|light| light.radiance);
    materials
        .chain(media)
        .chain(lights)
        .chain(lamps)
        .chain([scene.environment])
}

/// One file.
struct PbrtWriter<'m, 'n> {
    text: String,
    channel: usize,
    orders: &'m ScatteringOrders,
    meshes: &'m mut SharedFiles<'n>,
}

impl PbrtWriter<'_, '_> {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// A colour: three times the value of the channel.
    fn rgb(&self, name: &str, value: DVec3) -> String {
        let grey = number(value[self.channel]);
        format!("\"rgb {name}\" [ {grey} {grey} {grey} ]")
    }

    fn opening(&mut self, panel: &Panel, export: &ExportScene, channel: Option<usize>) {
        let title = panel.title.as_deref().unwrap_or("A scene");
        let title = title.replace(char::is_control, " ");
        self.line(&format!("# {title}. Written by volref for pbrt-v4."));
        if let Some(channel) = channel {
            let channel = CHANNELS[channel];
            self.line(&format!(
                "# The picture is grey, and is the channel {channel} of the scene's; the other two \
                 have files of their own."
            ));
        }
        if let Some(note) = export.nested_media.note_on_moved_faces(export.gap) {
            self.line(&format!("# {note}"));
        }
        if self.orders.depth == ENDLESS {
            let note = format!("# Light scattered more than {ENDLESS} times is left out.");
            self.line(&note);
        }
        self.line("");
    }

    /// Everything but the world.
    fn options(&mut self, panel: &Panel, scene: &Radiative, export: &ExportScene, file: &str) {
        let view = &export.view;
        let [eye, target, up] = [view.eye, view.target, view.up].map(listed);
        self.line("Scale -1 1 1");
        self.line(&format!("LookAt {eye}  {target}  {up}"));
        if let Some(at) = export.nested_media.eye {
            let around = export.nested_media.list[at].name();
            self.line(&format!("MediumInterface \"\" \"{around}\""));
        }
        let camera = match (view.orthographic_height, view.intrinsics) {
            (None, Some(intrinsics)) => {
                // With a right angle a window is that at distance 1.
                let [across, along] = intrinsics.focal_lengths;
                let [x, y] = intrinsics.centre;
                let [width, height] = [panel.width, panel.height].map(|pixels| pixels as f64);
                let window = [
                    -x / across,
                    (width - x) / across,
                    (y - height) / along,
                    y / along,
                ];
                let window = window.map(number).join(" ");
                let fov = float("fov", 90.0);
                format!("Camera \"perspective\" {fov} \"float screenwindow\" [ {window} ]")
            }
            (None, None) => {
                let fov = view.shorter_fov(panel.width, panel.height);
                format!("Camera \"perspective\" {}", float("fov", fov))
            }
            (Some(height), _) => {
                let half = 0.5 * height;
                let half_width = half * panel.width as f64 / panel.height as f64;
                let window = [-half_width, half_width, -half, half].map(number).join(" ");
                format!("Camera \"orthographic\" \"float screenwindow\" [ {window} ]")
            }
        };
        self.line(&camera);
        let image = format!("{}.exr", file.trim_end_matches(".pbrt"));
        self.line(&format!(
            "Film \"rgb\" {} {} \"string filename\" [ \"{image}\" ] \"bool savefp16\" [ false ]",
            integer("xresolution", panel.width),
            integer("yresolution", panel.height)
        ));
        let (x, y) = (float("xradius", 0.5), float("yradius", 0.5));
        self.line(&format!("PixelFilter \"box\" {x} {y}"));
        // pbrt's whole numbers have 31 bits and a sign.
        let samples = integer("pixelsamples", scene.samples.min(i32::MAX as u32));
        self.line(&format!("Sampler \"independent\" {samples}"));
        let depth = integer("maxdepth", self.orders.depth);
        let mut lights = scene.lights.iter();
        let chosen = if lights.any(|light| matches!(light, Light::Spot(_))) {
            " \"string lightsampler\" [ \"power\" ]"
        } else {
            ""
        };
        self.line(&format!("Integrator \"volpath\" {depth}{chosen}"));
    }

    fn media(&mut self, export: &ExportScene) {
        for (at, nested) in export.nested_media.list.iter().enumerate() {
            let name = nested.name();
            let mixture = export.nested_media.mixture(at);
            let [sigma_a, sigma_s] = self.orders.coefficients(&mixture);
            let emission = self.orders.emission_per_absorption(&mixture);
            let phase = mixture.parts.first().map(|(phase, _)| phase);
            let g = phase.map_or(0.0, Phase::mean_cosine);
            let coefficients = format!(
                "{} {} {}",
                self.rgb("sigma_a", sigma_a),
                self.rgb("sigma_s", sigma_s),
                float("g", g)
            );
            self.line("\nIdentity");
            let kind = match &nested.grid {
                None => "homogeneous",
                Some(grid) => {
                    self.line(&format!("ConcatTransform [ {} ]", matrix(&grid.to_world)));
                    "uniformgrid"
                }
            };
            self.line(&format!(
                "MakeNamedMedium \"{name}\" \"string type\" [ \"{kind}\" ]\n    {coefficients}"
            ));
            let is_emissive = emission[self.channel] > 0.0;
            if is_emissive {
                let radiance = self.rgb("Le", emission);
                self.line(&format!("    {radiance}"));
            }
            if let Some(grid) = &nested.grid {
                self.grid(grid, is_emissive);
            }
        }
    }

    /// A grid, and a layer of its outermost values around it.
    fn grid(&mut self, grid: &PlacedGrid, is_emissive: bool) {
        let density = grid.density.grid();
        let lattice = density.lattice();
        let low = lattice.first() - 1.5 * lattice.spacing();
        let [nx, ny, nz] = lattice.nodes().map(|nodes| nodes + 2);
        let high = low + lattice.spacing() * DVec3::new(nx as f64, ny as f64, nz as f64);
        self.line(&format!(
            "    \"point3 p0\" [ {} ] \"point3 p1\" [ {} ]",
            listed(low),
            listed(high)
        ));
        self.line(&format!(
            "    {} {} {}\n    \"float density\" [",
            integer("nx", nx),
            integer("ny", ny),
            integer("nz", nz)
        ));
        let nearest = |at: usize, axis: usize| at.clamp(1, lattice.nodes()[axis]) - 1;
        for k in 0..nz {
            for j in 0..ny {
                let values = (0..nx).map(|i| {
                    let node = [nearest(i, 0), nearest(j, 1), nearest(k, 2)];
                    number(density.values()[lattice.index(node)])
                });
                let row: Vec<String> = values.collect();
                self.text.push_str(&row.join(" "));
                self.text.push('\n');
            }
        }
        self.line("    ]");
        if is_emissive {
            self.line("    \"float Lescale\" [");
            let row = vec!["1"; nx].join(" ");
            for _ in 0..ny * nz {
                self.line(&row);
            }
            self.line("    ]");
        }
    }

    fn light(&mut self, light: &Light) {
        let line = match light {
            Light::Point(light) => {
                let intensity = self.rgb("I", light.intensity);
                let from = point("from", light.position);
                format!("LightSource \"point\" {from} {intensity}")
            }
            Light::Spot(light) => {
                let intensity = self.rgb("I", light.intensity);
                let from = point("from", light.position);
                let to = point("to", ahead(light.position, light.axis()));
                let angle = float("coneangle", degrees(light.outer()));
                let edge = float("conedeltaangle", 0.0);
                format!("LightSource \"spot\" {from} {to} {intensity} {angle} {edge}")
            }
            Light::Directional(light) => {
                let irradiance = self.rgb("L", light.irradiance);
                let (from, to) = (point("from", DVec3::ZERO), point("to", *light.direction));
                format!("LightSource \"distant\" {from} {to} {irradiance}")
            }
        };
        self.line(&line);
    }

    fn surfaces(&mut self, export: &ExportScene) {
        let list = &export.nested_media.list;
        for (at, nested) in list.iter().enumerate() {
            if nested.interface.is_none() {
                self.begin(&key_of(nested.index));
                self.line("    Material \"interface\"");
                self.sides(list, at);
                self.form(&nested.form);
            }
        }
        for (index, ExportSurface { key, form, kind }) in export.surfaces.iter().enumerate() {
            self.begin(key);
            match kind {
                SurfaceKind::Material(material) => self.material(material),
                SurfaceKind::Light(light) => {
                    self.material(&Material::Diffuse(DVec3::ZERO));
                    let radiance = self.rgb("L", light.radiance);
                    let both = light.sides == Sides::Both;
                    self.line(&format!(
                        "    AreaLightSource \"diffuse\" {radiance} \"bool twosided\" [ {both} ]"
                    ));
                }
            }
            if let Some(at) = export.nested_media.with_interface(index) {
                self.sides(list, at);
            }
            self.form(form);
        }
    }

    fn begin(&mut self, key: &str) {
        self.line(&format!("\n# {key}\nAttributeBegin"));
    }

    /// The interior and the exterior medium of a nested medium's boundary.
    fn sides(&mut self, list: &[NestedMedium], at: usize) {
        let inside = list[at].name();
        let outside = list[at].parent.map(|at| list[at].name());
        let outside = outside.unwrap_or_default();
        self.line(&format!("    MediumInterface \"{inside}\" \"{outside}\""));
    }

    fn material(&mut self, material: &Material) {
        let black = Material::Diffuse(DVec3::ZERO);
        match if self.orders.never { &black } else { material } {
            Material::Diffuse(reflectance) => {
                let reflectance = self.rgb("reflectance", *reflectance);
                self.line(&format!("    Material \"diffuse\" {reflectance}"));
            }
            Material::Mirror(reflectance) => {
                let amount = float("amount", reflectance[self.channel]);
                self.line(&format!(
                    "    Material \"mix\" \"string materials\" [ \"black\" \"mirror\" ] {amount}"
                ));
            }
            Material::Glass(index) => {
                let eta = float("eta", *index);
                self.line(&format!("    Material \"dielectric\" {eta}"));
            }
        }
    }

    /// A shape, and the end of what belongs to it.
    fn form(&mut self, form: &Form) {
        match form {
            Form::Sphere { centre, radius } => self.ball(*centre, *radius),
            Form::Ellipsoid { sphere, to_world } => {
                self.line(&format!("    ConcatTransform [ {} ]", matrix(to_world)));
                self.ball(sphere.centre(), sphere.radius());
            }
            Form::Rectangle { corner, edges } => {
                let [u, v] = *edges;
                let corners = [*corner, corner + u, corner + v, corner + u + v].map(listed);
                let corners = corners.join("  ");
                self.line(&format!(
                    "    Shape \"bilinearmesh\" \"point3 P\" [ {corners} ]"
                ));
            }
            Form::Box { .. } => {
                let faces = form.faces();
                let corners: Vec<String> = faces.iter().flatten().map(|&p| listed(p)).collect();
                let triangles: Vec<String> = (0..faces.len())
                    .map(|face| 4 * face)
                    .map(|a| format!("{a} {} {} {a} {} {}", a + 1, a + 2, a + 2, a + 3))
                    .collect();
                self.line(&format!(
                    "    Shape \"trianglemesh\" \"point3 P\" [ {} ]\n        \
                     \"integer indices\" [ {} ]",
                    corners.join("  "),
                    triangles.join("  ")
                ));
            }
            Form::Mesh { vertices, faces } => {
                let file = self.meshes.ply(vertices, faces);
                self.line(&format!(
                    "    Shape \"plymesh\" \"string filename\" [ \"{file}\" ]"
                ));
            }
        }
        self.line("AttributeEnd");
    }

    fn ball(&mut self, centre: DVec3, radius: f64) {
        self.line(&format!("    Translate {}", listed(centre)));
        self.line(&format!("    Shape \"sphere\" {}", float("radius", radius)));
    }
}

fn float(name: &str, value: f64) -> String {
    format!("\"float {name}\" [ {} ]", number(value))
}

/// A number in at most 25 characters: with an exponent where it would be long without.
fn number<T: Copy + Display + LowerExp + Into<f64>>(value: T) -> String {
    let magnitude = value.into().abs();
    if magnitude == 0.0 || (1e-5..1e15).contains(&magnitude) {
        return value.to_string();
    }
    format!("{value:e}")
}

fn integer(name: &str, value: impl Display) -> String {
    format!("\"integer {name}\" [ {value} ]")
}

fn point(name: &str, value: DVec3) -> String {
    format!("\"point3 {name}\" [ {} ]", listed(value))
}

fn listed(v: DVec3) -> String {
    v.to_array().map(number).join(" ")
}

/// The sixteen numbers of a map, column by column, as pbrt takes them.
fn matrix(map: &Transform) -> String {
    let columns = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| map.vector(axis));
    let [x, y, z] = columns.map(listed);
    format!("{x} 0  {y} 0  {z} 0  {} 1", listed(map.point(DVec3::ZERO)))
}
