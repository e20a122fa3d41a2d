//! XML of Mitsuba 3, found right by experiment with version 3.9.
//!
//! - The same in both: `g > 0` scatters forward; a point or spot light of intensity `I` gives
//!   `I/r²`; a spotlight falls linearly in the angle from `beam_width` to `cutoff_angle`;
//!   `irradiance` of a directional light; looking along +z, +x is to the left.
//! - Light turned n times is `max_depth` n + 1; boundaries of media do not count in either.
//! - Emitters send light out of their front only. The back of a two-sided one is a second one,
//!   just behind the first.
//! - One medium is at a place. Where a medium lies within another, its boundary has the sum of
//!   both inside and the outer one outside; `blendphase` scatters by either's phase function in
//!   proportion to their scattering. It weighs all channels alike: where the shares differ from
//!   channel to channel, the media are said for each channel in a file of its own, and a picture
//!   is put together from three.
//! - A grid is a `gridvolume`, put so that the middles of its voxels are volref's nodes; the
//!   medium ends with its shape, and beyond the outermost values both are constant.

use super::files::{ply, vol};
use super::forms::Form;
use super::refusal::Faults;
use super::stage::{Stage, turns};
use super::vessels::{GAP, Placed, Vessel, place_of};
use super::view::degrees;
use super::{Export, Format, Refusal};
use crate::geometry::{Aabb, Transform};
use crate::optics::{Light, Material, Sides};
use crate::scene::{Panel, Radiative};
use crate::volume::Interpolation;
use glam::DVec3;
use std::fmt::{Display, Write};

/// How far the back of a two-sided emitter lies behind its front, times the largest coordinate.
const BEHIND: f64 = 1e-5;

/// The smallest extent of a scene that Mitsuba sees well: rays start 9e-5 · (1 + coordinate) off
/// a surface, so below this that is more than a thousandth of the scene.
const SMALLEST: f64 = 0.1;

/// The names of the channels in files and in `-Dchannel=`.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// The scene as XML, with its grids and meshes beside it.
pub(super) fn scene(panel: &Panel, scene: &Radiative, name: &str) -> Result<Export, Refusal> {
    let mut faults = Faults::default();
    let stage = Stage::of(panel, scene, &mut faults);
    if stage.reach < SMALLEST {
        let what = format!(
            "coordinates of at most {}: Mitsuba's rays start 9e-5 off a surface; choose a smaller \
             unit of length",
            stage.reach
        );
        faults.add("radiative", what);
    }
    let mut writer = Writer {
        name,
        body: String::new(),
        files: Vec::new(),
        notes: Vec::new(),
        faults,
    };
    writer.integrator(panel, scene, &stage);
    let by_channel = writer.media(&stage);
    for light in &scene.lights {
        writer.light(light);
    }
    if scene.environment != DVec3::ZERO {
        let radiance = rgb("radiance", scene.environment);
        writer.element("emitter", "constant", "", &[radiance]);
    }
    writer.surfaces(&stage);
    writer.finish(panel, by_channel)
}

struct Writer<'n> {
    name: &'n str,
    body: String,
    files: Vec<(String, Vec<u8>)>,
    /// What was changed, for a comment.
    notes: Vec<String>,
    faults: Faults,
}

impl Writer<'_> {
    fn finish(self, panel: &Panel, by_channel: bool) -> Result<Export, Refusal> {
        let mut text = String::from("<scene version=\"3.0.0\">\n");
        let title = panel.title.as_deref().unwrap_or("A scene");
        // Two hyphens would end the comment.
        let title: String = title.replace('-', "‐");
        let _ = writeln!(text, "    <!-- {title}. Written by volref.");
        for note in &self.notes {
            let _ = writeln!(text, "         {note}");
        }
        text.push_str("    -->\n");
        if by_channel {
            text.push_str("    <default name=\"channel\" value=\"red\"/>\n");
        }
        text.push_str(&self.body);
        text.push_str("</scene>\n");
        let main = format!("{}.xml", self.name);
        let mut files = self.files;
        files.insert(0, (main.clone(), text.into_bytes()));
        self.faults.none(Format::Mitsuba, Export { main, files })
    }

    /// An element with a type and children, one to a line; `more` are further attributes.
    fn element(&mut self, tag: &str, kind: &str, more: &str, children: &[String]) {
        self.body.push_str(&element(1, tag, kind, more, children));
    }

    fn integrator(&mut self, panel: &Panel, scene: &Radiative, stage: &Stage) {
        let depth = match turns(scene.scattering) {
            None => "-1".to_owned(),
            Some(turns) => (turns + 1).to_string(),
        };
        // Mitsuba's seeds have 32 bits.
        let seed = (scene.seed & 0xffff_ffff).to_string();
        for (parameter, value) in [
            ("integrator", "volpath"),
            ("max_depth", &depth),
            ("rr_depth", "5"),
            ("spp", &scene.samples.to_string()),
            ("seed", &seed),
            ("width", &panel.width.to_string()),
            ("height", &panel.height.to_string()),
        ] {
            let _ = writeln!(
                self.body,
                "    <default name=\"{parameter}\" value=\"{value}\"/>"
            );
        }
        let limits = [
            typed("integer", "max_depth", "$max_depth"),
            typed("integer", "rr_depth", "$rr_depth"),
        ];
        self.element("integrator", "$integrator", "", &limits);
        let view = &stage.view;
        let film = [
            typed("integer", "width", "$width"),
            typed("integer", "height", "$height"),
            typed("string", "pixel_format", "rgb"),
            typed("string", "component_format", "float32"),
            "<rfilter type=\"box\"/>".to_owned(),
        ];
        let sampler = [
            typed("integer", "sample_count", "$spp"),
            typed("integer", "seed", "$seed"),
        ];
        let mut sensor = vec![
            typed("float", "fov", view.vertical_fov),
            typed("string", "fov_axis", "y"),
            // Whatever is nearer or farther is not seen.
            typed("float", "near_clip", 1e-5 * stage.reach),
            typed("float", "far_clip", 1e5 * stage.reach),
            look_at(view.eye, view.target, view.up),
        ];
        if let Some(at) = stage.vessels.eye {
            sensor.push(reference("medium", &medium_id(&stage.vessels.list[at])));
        }
        sensor.push(element(2, "sampler", "independent", "", &sampler));
        sensor.push(element(2, "film", "hdrfilm", "", &film));
        self.element("sensor", "perspective", "", &sensor);
    }

    /// Every medium, and the boundaries of those that have one of their own. Whether they are
    /// said channel by channel.
    fn media(&mut self, stage: &Stage) -> bool {
        let vessels = &stage.vessels;
        let mut by_channel = [String::new(), String::new(), String::new()];
        for (at, vessel) in vessels.list.iter().enumerate() {
            let layers: Vec<&Vessel> = vessels.layers(at).collect();
            let id = format!(" id=\"{}\"", medium_id(vessel));
            if let Some(grid) = &vessel.grid {
                let medium = self.grid(vessel, grid);
                self.element("medium", "heterogeneous", &id, &medium);
                continue;
            }
            let mixture = Mixture::of(&layers);
            match mixture.weights() {
                Some(weights) => {
                    let medium = mixture.medium(&weights);
                    self.element("medium", "homogeneous", &id, &medium);
                }
                None => {
                    for (channel, text) in by_channel.iter_mut().enumerate() {
                        let medium = mixture.medium(&mixture.weights_of(channel));
                        text.push_str(&element(1, "medium", "homogeneous", &id, &medium));
                    }
                }
            }
        }
        let moved: Vec<String> = (vessels.list.iter())
            .filter(|vessel| vessel.moved)
            .map(|vessel| place_of(vessel.index))
            .collect();
        if !moved.is_empty() {
            let way = GAP * (1.0 + stage.reach);
            self.notes.push(format!(
                "Faces of {} that lie in surfaces stand {way:.3e} behind them, where no ray sees \
                 it.",
                moved.join(", ")
            ));
        }
        let split = !by_channel[0].is_empty();
        if split {
            self.notes.push(format!(
                "Render it with -Dchannel=red, green and blue, and of each picture take that \
                 channel: {}.xml holds what differs.",
                format_args!("{}.CHANNEL", self.name)
            ));
            for (channel, text) in CHANNELS.iter().zip(by_channel) {
                let text = format!("<scene version=\"3.0.0\">\n{text}</scene>\n");
                let file = format!("{}.{channel}.xml", self.name);
                self.files.push((file, text.into_bytes()));
            }
            let _ = writeln!(
                self.body,
                "    <include filename=\"{}.$channel.xml\"/>",
                self.name
            );
        }
        for (at, vessel) in vessels.list.iter().enumerate() {
            if vessel.skin.is_none() {
                let mut parts = vec!["<bsdf type=\"null\"/>".to_owned()];
                parts.extend(sides(stage, at));
                self.form(&place_of(vessel.index), &vessel.form, parts);
            }
        }
        split
    }

    /// A medium whose density is a grid.
    fn grid(&mut self, vessel: &Vessel, grid: &Placed) -> Vec<String> {
        let sigma_t = vessel.medium.coefficients.sigma_t();
        let most = sigma_t.max_element();
        let file = format!("{}.medium{}.vol", self.name, vessel.index);
        let shares = (sigma_t / most).to_array();
        let density = grid.density.grid();
        self.files.push((file.clone(), vol(density, shares)));
        if shares != [1.0; 3] {
            self.notes.push(format!(
                "Densities of {} are multiplied by the shares of the channels and rounded to \
                 32 bits.",
                place_of(vessel.index)
            ));
        }
        // The unit cube is divided into voxels; their middles are the nodes.
        let lattice = density.lattice();
        let low = lattice.first() - 0.5 * lattice.spacing();
        let nodes = lattice.nodes().map(|count| count as f64);
        let cube = Aabb {
            min: low,
            max: low + lattice.spacing() * DVec3::from_array(nodes),
        };
        let filter = match grid.density.interpolation() {
            Interpolation::Nearest => "nearest",
            Interpolation::Trilinear => "trilinear",
        };
        let volume = [
            typed("string", "filename", &file),
            typed("boolean", "raw", true),
            typed("string", "filter_type", filter),
            typed("string", "wrap_mode", "clamp"),
            unit_cube_to(&cube, &grid.to_world),
        ];
        let g = vessel.medium.phase.0.g();
        vec![
            element(2, "volume", "gridvolume", " name=\"sigma_t\"", &volume),
            typed("float", "scale", most),
            rgb("albedo", vessel.medium.coefficients.albedo()),
            typed("boolean", "has_spectral_extinction", is_coloured(sigma_t)),
            phase(2, g),
        ]
    }

    fn light(&mut self, light: &Light) {
        match light {
            Light::Point(light) => {
                let parts = [
                    point("position", light.position),
                    rgb("intensity", light.intensity),
                ];
                self.element("emitter", "point", "", &parts);
            }
            Light::Spot(light) => {
                let (inner, outer) = (degrees(light.inner()), degrees(light.outer()));
                // Mitsuba divides by the difference of the angles.
                let beam = inner.min(outer * (1.0 - 1e-5));
                if beam < inner {
                    let note = "The edges of spotlights have a width of 1e-5 of their angle.";
                    if !self.notes.iter().any(|other| other == note) {
                        self.notes.push(note.to_owned());
                    }
                }
                let target = light.position + light.axis();
                let parts = [
                    look_at(light.position, target, across(light.axis())),
                    rgb("intensity", light.intensity),
                    typed("float", "beam_width", beam),
                    typed("float", "cutoff_angle", outer),
                ];
                self.element("emitter", "spot", "", &parts);
            }
            Light::Directional(light) => {
                let parts = [
                    vector("direction", light.direction),
                    rgb("irradiance", light.irradiance),
                ];
                self.element("emitter", "directional", "", &parts);
            }
        }
    }

    fn surfaces(&mut self, stage: &Stage) {
        for (index, (place, form, material)) in stage.objects.iter().enumerate() {
            let mut parts = vec![bsdf(material)];
            let mut vessels = stage.vessels.list.iter();
            if let Some(at) = vessels.position(|vessel| vessel.skin == Some(index)) {
                parts.extend(sides(stage, at));
            }
            self.form(place, form, parts);
        }
        for (place, form, light) in &stage.area_lights {
            let black = bsdf(&Material::Diffuse(DVec3::ZERO));
            let radiance = rgb("radiance", light.radiance);
            let shine = element(2, "emitter", "area", "", &[radiance]);
            self.form(place, form, vec![black.clone(), shine.clone()]);
            if light.sides == Sides::Front {
                continue;
            }
            let way = BEHIND * form.reach();
            let (back, more) = match form {
                Form::Rectangle {
                    corner,
                    edges: [u, v],
                } => {
                    let corner = corner - u.cross(*v).normalize() * way;
                    let edges = [*v, *u];
                    (Form::Rectangle { corner, edges }, None)
                }
                Form::Sphere { centre, radius } => {
                    let (centre, radius) = (*centre, radius - way);
                    let inward = typed("boolean", "flip_normals", true);
                    (Form::Sphere { centre, radius }, Some(inward))
                }
                _ => {
                    let what = "a box or mesh that sends out light on both sides; of a box or \
                                closed mesh, say `sides = \"front\"`";
                    self.faults.add(place, what);
                    continue;
                }
            };
            self.notes.push(format!(
                "{place} shines to both sides: its back is a second emitter, {way:.3e} behind."
            ));
            let parts = more.into_iter().chain([black, shine]).collect();
            self.form(place, &back, parts);
        }
    }

    /// A shape with what belongs to it.
    fn form(&mut self, place: &str, form: &Form, parts: Vec<String>) {
        let _ = writeln!(self.body, "    <!-- {place} -->");
        let (kind, mut children) = match form {
            Form::Sphere { centre, radius } => {
                let children = vec![point("center", *centre), typed("float", "radius", radius)];
                ("sphere", children)
            }
            Form::Ellipsoid { .. } => {
                self.faults.add(place, "an ellipsoid; give a mesh of it");
                return;
            }
            Form::Box { corner, edges } => {
                let [u, v, w] = *edges;
                // Mitsuba's cube reaches from -1 to 1.
                let centre = corner + 0.5 * (u + v + w);
                ("cube", vec![matrix([0.5 * u, 0.5 * v, 0.5 * w, centre])])
            }
            Form::Rectangle { corner, edges } if is_right_angled(edges) => {
                let [u, v] = *edges;
                let normal = u.cross(v).normalize();
                let centre = corner + 0.5 * (u + v);
                (
                    "rectangle",
                    vec![matrix([0.5 * u, 0.5 * v, normal, centre])],
                )
            }
            Form::Rectangle { .. } => {
                let corners = form.corners();
                ("ply", self.mesh(&corners, &[[0, 1, 2], [0, 2, 3]]))
            }
            Form::Mesh { vertices, faces } => ("ply", self.mesh(vertices, faces)),
        };
        children.extend(parts);
        self.element("shape", kind, "", &children);
    }

    fn mesh(&mut self, vertices: &[DVec3], faces: &[[usize; 3]]) -> Vec<String> {
        let bytes = ply(vertices, faces);
        let file = match self.files.iter().find(|(_, other)| *other == bytes) {
            Some((file, _)) => file.clone(),
            None => {
                let meshes = self.files.iter().filter(|(file, _)| file.ends_with(".ply"));
                let file = format!("{}.mesh{}.ply", self.name, meshes.count());
                self.files.push((file.clone(), bytes));
                file
            }
        };
        vec![
            typed("string", "filename", file),
            typed("boolean", "face_normals", true),
        ]
    }
}

/// Media at one place, which add up.
struct Mixture {
    sigma_t: DVec3,
    albedo: DVec3,
    /// Scattering by phase function, that is by g.
    parts: Vec<(f64, DVec3)>,
}

impl Mixture {
    fn of(layers: &[&Vessel]) -> Mixture {
        let (mut sigma_t, mut sigma_s) = (DVec3::ZERO, DVec3::ZERO);
        let mut parts: Vec<(f64, DVec3)> = Vec::new();
        for layer in layers {
            let coefficients = &layer.medium.coefficients;
            let scattering = coefficients.sigma_s();
            sigma_t += coefficients.sigma_t();
            sigma_s += scattering;
            if scattering == DVec3::ZERO {
                continue;
            }
            let g = layer.medium.phase.0.g();
            match parts.iter_mut().find(|(other, _)| *other == g) {
                Some((_, sum)) => *sum += scattering,
                None => parts.push((g, scattering)),
            }
        }
        let part = |channel: usize| match sigma_t[channel] {
            0.0 => 0.0,
            all => sigma_s[channel] / all,
        };
        Mixture {
            sigma_t,
            albedo: DVec3::new(part(0), part(1), part(2)),
            parts,
        }
    }

    /// The share of scattering of every part in a channel; of one without any, 0.
    fn weights_of(&self, channel: usize) -> Vec<f64> {
        let all: f64 = self.parts.iter().map(|(_, part)| part[channel]).sum();
        let share = |part: &DVec3| if all > 0.0 { part[channel] / all } else { 0.0 };
        self.parts.iter().map(|(_, part)| share(part)).collect()
    }

    /// The shares, if they are those of every channel in which anything scatters: to the
    /// accuracy of the 32-bit numbers that they become.
    fn weights(&self) -> Option<Vec<f64>> {
        let scatters = |channel: &usize| self.parts.iter().any(|(_, part)| part[*channel] > 0.0);
        let mut channels = (0..3).filter(scatters);
        let Some(first) = channels.next() else {
            return Some(Vec::new());
        };
        let weights = self.weights_of(first);
        let alike = |channel: usize| {
            let others = self.weights_of(channel);
            let mut pairs = weights.iter().zip(others);
            pairs.all(|(one, other)| (one - other).abs() <= f64::from(f32::EPSILON))
        };
        channels.all(alike).then_some(weights)
    }

    /// The medium, its parts scattering in these shares.
    fn medium(&self, weights: &[f64]) -> Vec<String> {
        let most = self.sigma_t.max_element();
        // 1 is the most that a colour of Mitsuba's may be.
        vec![
            rgb("sigma_t", self.sigma_t / most),
            typed("float", "scale", most),
            rgb("albedo", self.albedo),
            typed(
                "boolean",
                "has_spectral_extinction",
                is_coloured(self.sigma_t),
            ),
            self.phases(2, weights),
        ]
    }

    /// The phase functions, each blended with the rest of them.
    fn phases(&self, depth: usize, weights: &[f64]) -> String {
        let (Some(((g, _), others)), Some((weight, rest))) =
            (self.parts.split_first(), weights.split_first())
        else {
            return phase(depth, 0.0);
        };
        if others.is_empty() {
            return phase(depth, *g);
        }
        let left: f64 = rest.iter().sum();
        let remaining = Mixture {
            parts: others.to_vec(),
            ..*self
        };
        // A weight belongs to the second of the two.
        let parts = [
            typed(
                "float",
                "weight",
                left / (weight + left).max(f64::MIN_POSITIVE),
            ),
            phase(depth + 1, *g),
            remaining.phases(depth + 1, rest),
        ];
        element(depth, "phase", "blendphase", "", &parts)
    }
}

fn phase(depth: usize, g: f64) -> String {
    if g == 0.0 {
        return "<phase type=\"isotropic\"/>".to_owned();
    }
    element(depth, "phase", "hg", "", &[typed("float", "g", g)])
}

fn is_coloured(v: DVec3) -> bool {
    v.min_element() < v.max_element()
}

fn medium_id(vessel: &Vessel) -> String {
    format!("medium{}", vessel.index)
}

/// What is inside and outside the boundary of a vessel.
fn sides(stage: &Stage, at: usize) -> Vec<String> {
    let list = &stage.vessels.list;
    let inside = reference("interior", &medium_id(&list[at]));
    let outside = list[at].parent.map(|at| medium_id(&list[at]));
    let outside = outside.map(|id| reference("exterior", &id));
    std::iter::once(inside).chain(outside).collect()
}

fn bsdf(material: &Material) -> String {
    match material {
        Material::Diffuse(reflectance) => {
            let inner = element(
                3,
                "bsdf",
                "diffuse",
                "",
                &[rgb("reflectance", *reflectance)],
            );
            element(2, "bsdf", "twosided", "", &[inner])
        }
        Material::Mirror(reflectance) => {
            let parts = [
                typed("string", "material", "none"),
                rgb("specular_reflectance", *reflectance),
            ];
            let inner = element(3, "bsdf", "conductor", "", &parts);
            element(2, "bsdf", "twosided", "", &[inner])
        }
        Material::Glass(index) => {
            let parts = [
                typed("float", "int_ior", index),
                typed("float", "ext_ior", 1.0),
            ];
            element(2, "bsdf", "dielectric", "", &parts)
        }
    }
}

/// Whether the edges are perpendicular, up to a few roundings.
fn is_right_angled([u, v]: &[DVec3; 2]) -> bool {
    u.dot(*v).abs() <= 16.0 * f64::EPSILON * u.length() * v.length()
}

/// A direction perpendicular to `axis`, well away from it.
fn across(axis: DVec3) -> DVec3 {
    axis.any_orthonormal_vector()
}

/// The map that puts the unit cube where `to_world` puts a box.
fn unit_cube_to(cube: &Aabb, to_world: &Transform) -> String {
    let size = cube.size();
    let edges = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| to_world.direction(axis * size));
    let [u, v, w] = edges;
    matrix([u, v, w, to_world.point(cube.min)])
}

fn element(depth: usize, tag: &str, kind: &str, more: &str, children: &[String]) -> String {
    let indent = "    ".repeat(depth);
    // Nested elements come indented, to be placed like any other child.
    let inner: String = children
        .iter()
        .map(|child| format!("{indent}    {}\n", child.trim()))
        .collect();
    let end = if depth == 1 { "\n" } else { "" };
    let text = format!("<{tag} type=\"{kind}\"{more}>\n{inner}{indent}</{tag}>{end}");
    if depth == 1 { indent + &text } else { text }
}

fn typed(tag: &str, name: &str, value: impl Display) -> String {
    format!("<{tag} name=\"{name}\" value=\"{value}\"/>")
}

fn reference(name: &str, id: &str) -> String {
    format!("<ref name=\"{name}\" id=\"{id}\"/>")
}

fn listed(v: DVec3) -> String {
    format!("{}, {}, {}", v.x, v.y, v.z)
}

fn rgb(name: &str, value: DVec3) -> String {
    typed("rgb", name, listed(value))
}

fn point(name: &str, value: DVec3) -> String {
    let DVec3 { x, y, z } = value;
    format!("<point name=\"{name}\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
}

fn vector(name: &str, value: DVec3) -> String {
    let DVec3 { x, y, z } = value;
    format!("<vector name=\"{name}\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
}

fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> String {
    let [origin, target, up] = [origin, target, up].map(listed);
    format!(
        "<transform name=\"to_world\"><lookat origin=\"{origin}\" target=\"{target}\" \
         up=\"{up}\"/></transform>"
    )
}

/// An affine map by its columns, the last of which is where the origin goes.
fn matrix(columns: [DVec3; 4]) -> String {
    let row = |axis: usize| {
        let numbers = columns.map(|column| column[axis].to_string());
        numbers.join(" ")
    };
    format!(
        "<transform name=\"to_world\"><matrix value=\"{} {} {} 0 0 0 1\"/></transform>",
        row(0),
        row(1),
        row(2)
    )
}
