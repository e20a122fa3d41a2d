//! Mitsuba 3 XML, tested with version 3.9.
//!
//! - The same in both: `g > 0` scatters forward; a point or spot light of intensity `I` gives
//!   `I/r²`; a spotlight falls linearly in the angle from `beam_width` to `cutoff_angle`;
//!   `irradiance` of a directional light; looking along +z, +x is to the left.
//! - Light scattered n times is `max_depth` n + 1; boundaries of media do not count in either.
//! - Emitters send light out of their front only. The back of a two-sided one is a second one,
//!   just behind the first.
//! - One medium is at a place. Where a medium lies within another, its boundary has the sum of
//!   both inside and the outer one outside; `blendphase` scatters by either's phase function in
//!   proportion to their scattering.
//! - Some media are said for each channel in a file of its own, and a picture is put together from
//!   three. These are media whose shares differ from channel to channel, for `blendphase` weighs
//!   all alike, and media of coloured extinction: `volpath` draws distances by a channel chosen at
//!   random, so that the weights of the others grow without bound, and what it misses is dark.
//!   (`volpathmis` is made for such media, and does not end in time: scripts/peers/README.md.)
//! - A grid is a `gridvolume`, put so that the middles of its voxels are volref's nodes; the
//!   medium ends with its shape, and beyond the outermost values both are constant.

use super::export_scene::ExportScene;
use super::files::SharedFiles;
use super::forms::Form;
use super::mixture::Mixture;
use super::nested_media::{ExportSurface, NestedMedium, PlacedGrid, SurfaceKind, key_of};
use super::refusal::Faults;
use super::view::{ahead, degrees};
use super::{Export, Format, Refusal};
use crate::film::CHANNELS;
use crate::geometry::{Aabb, Intrinsics, Transform};
use crate::optics::{Light, Material, Phase, Sides};
use crate::scene::{Panel, Radiative};
use crate::volume::{Interpolation, vol_bytes};
use glam::DVec3;
use std::fmt::{Display, Write};
use std::ops::Range;

/// Distance of the back of a two-sided emitter behind its front, in units of the largest
/// coordinate.
const BEHIND: f64 = 1e-5;

/// The largest coordinates of scenes that Mitsuba sees well: rays start 9e-5 · (1 + coordinate) off a surface, of smaller
/// scenes more than a thousandth. Beyond, squares of distances leave the numbers that it calculates with.
const REACHES: Range<f64> = 0.1..1e15;

/// The distance of boundaries in a scene of this reach: five times that of the starts of rays off a
/// surface, 1500 roundings (2⁻²⁴) of 1 + the largest coordinate.
fn gap(reach: f64) -> f64 {
    5e-4 * (1.0 + reach)
}

/// The scene as XML, with its grids and meshes beside it.
pub(super) fn scene(panel: &Panel, scene: &Radiative, name: &str) -> Result<Export, Refusal> {
    let mut faults = Faults::default();
    let export = ExportScene::of(panel, scene, gap, REACHES, &mut faults);
    let focal_lengths = export.view.intrinsics.map(|it| it.focal_lengths);
    if focal_lengths.is_some_and(|[x, y]| (x - y).abs() > 1e-6 * y) {
        let what = "pixels that are not square: give `fl_x` and `fl_y` one value";
        faults.add("camera", what);
    }
    for nested in &export.nested_media.list {
        if nested.medium.emission != DVec3::ZERO {
            faults.add(key_of(nested.index), "an emissive medium");
        }
        if nested.scatters() && phase(0, &nested.medium.phase).is_none() {
            let what = format!(
                "the phase function {}: Mitsuba has those of Henyey and Greenstein and of Rayleigh",
                nested.medium.phase
            );
            faults.add(key_of(nested.index), what);
        }
    }
    let mut writer = MitsubaWriter {
        body: String::new(),
        files: SharedFiles::new(name),
        notes: Vec::new(),
        faults,
    };
    writer.integrator(panel, scene, &export);
    let by_channel = writer.media(&export);
    for light in &scene.lights {
        writer.light(light);
    }
    if scene.environment != DVec3::ZERO {
        let radiance = rgb("radiance", scene.environment);
        writer.element("emitter", "constant", "", &[radiance]);
    }
    writer.surfaces(&export);
    writer.finish(panel, by_channel)
}

struct MitsubaWriter<'n> {
    body: String,
    files: SharedFiles<'n>,
    /// What was changed, for a comment.
    notes: Vec<String>,
    faults: Faults,
}

impl MitsubaWriter<'_> {
    fn finish(self, panel: &Panel, by_channel: bool) -> Result<Export, Refusal> {
        let mut text = String::from("<scene version=\"3.0.0\">\n");
        let title = panel.title.as_deref().unwrap_or("A scene");
        let _ = writeln!(text, "    <!-- {}. Written by volref.", commented(title));
        for note in &self.notes {
            let _ = writeln!(text, "         {}", commented(note));
        }
        text.push_str("    -->\n");
        if by_channel {
            text.push_str("    <default name=\"channel\" value=\"red\"/>\n");
        }
        text.push_str(&self.body);
        text.push_str("</scene>\n");
        let main = format!("{}.xml", self.files.name);
        let mut files = vec![(main.clone(), text.into_bytes())];
        files.extend(self.files.files);
        self.faults.none(Format::Mitsuba, Export { main, files })
    }

    /// An element with a type and children, one to a line; `more` are further attributes.
    fn element(&mut self, tag: &str, kind: &str, more: &str, children: &[String]) {
        self.body.push_str(&element(1, tag, kind, more, children));
    }

    fn integrator(&mut self, panel: &Panel, scene: &Radiative, export: &ExportScene) {
        let depth = match scene.scattering.max_bounces() {
            None => "-1".to_owned(),
            Some(bounces) => (bounces + 1).to_string(),
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
            let default = typed("default", parameter, value);
            let _ = writeln!(self.body, "    {default}");
        }
        let limits = [
            typed("integer", "max_depth", "$max_depth"),
            typed("integer", "rr_depth", "$rr_depth"),
        ];
        self.element("integrator", "$integrator", "", &limits);
        let view = &export.view;
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
        let (kind, mut sensor) = match view.orthographic_height {
            None => {
                let fov = typed("float", "fov", view.vertical_fov);
                let mut sensor = vec![fov, typed("string", "fov_axis", "y")];
                if let Some(Intrinsics { centre: [x, y], .. }) = view.intrinsics {
                    // Fractions of the film that are added to a place in it.
                    let offsets = [
                        ("principal_point_offset_x", 0.5 - x / panel.width as f64),
                        ("principal_point_offset_y", 0.5 - y / panel.height as f64),
                    ];
                    sensor.extend(offsets.map(|(name, offset)| typed("float", name, offset)));
                }
                ("perspective", sensor)
            }
            Some(_) => ("orthographic", vec![]),
        };
        // The image of parallel rays is 2 wide.
        let wide = panel.width as f64 / panel.height as f64;
        let half_width = view.orthographic_height.map(|height| 0.5 * height * wide);
        sensor.extend([
            // Whatever is nearer or farther is not seen.
            typed("float", "near_clip", 1e-5 * export.reach),
            typed("float", "far_clip", 1e5 * export.reach),
            look_at(view.eye, view.target, view.up, half_width),
        ]);
        if let Some(at) = export.nested_media.eye {
            sensor.push(reference("medium", &export.nested_media.list[at].name()));
        }
        sensor.push(element(2, "sampler", "independent", "", &sampler));
        sensor.push(element(2, "film", "hdrfilm", "", &film));
        self.element("sensor", kind, "", &sensor);
    }

    /// Every medium, and the boundaries of those that have one of their own. Whether they are
    /// said channel by channel.
    fn media(&mut self, export: &ExportScene) -> bool {
        let nested_media = &export.nested_media;
        let mut by_channel = [String::new(), String::new(), String::new()];
        for (at, nested) in nested_media.list.iter().enumerate() {
            let mixture = nested_media.mixture(at);
            let volume = nested.grid.as_ref().map(|grid| self.volume(nested, grid));
            let id = format!(" id=\"{}\"", nested.name());
            if is_grey(mixture.sigma_t()) && mixture.weights().is_some() {
                self.body.push_str(&medium(&id, &mixture, &volume, None));
                continue;
            }
            for (channel, text) in by_channel.iter_mut().enumerate() {
                text.push_str(&medium(&id, &mixture, &volume, Some(channel)));
            }
        }
        self.notes
            .extend(nested_media.note_on_moved_faces(export.gap));
        let split = !by_channel[0].is_empty();
        if split {
            let name = self.files.name;
            self.notes.push(format!(
                "Render it with -Dchannel=red, green and blue, and of each picture take that \
                 channel: {name}.CHANNEL.xml holds what differs."
            ));
            for (channel, text) in CHANNELS.iter().zip(by_channel) {
                let text = format!("<scene version=\"3.0.0\">\n{text}</scene>\n");
                let file = format!("{name}.{channel}.xml");
                self.files.files.push((file, text.into_bytes()));
            }
            let include = format!("    <include filename=\"{name}.$channel.xml\"/>\n");
            self.body.push_str(&include);
        }
        for (at, nested) in nested_media.list.iter().enumerate() {
            if nested.interface.is_none() {
                let mut parts = vec!["<bsdf type=\"null\"/>".to_owned()];
                parts.extend(sides(export, at));
                self.form(&key_of(nested.index), &nested.form, parts);
            }
        }
        split
    }

    /// The density of a grid: a texture in a file of its own.
    fn volume(&mut self, nested: &NestedMedium, grid: &PlacedGrid) -> String {
        let file = format!("{}.{}.vol", self.files.name, nested.name());
        let density = grid.density.grid();
        let lattice = density.lattice();
        // The box of the file is the unit cube: where the grid lies is the scene's to say.
        let counts = lattice.nodes().map(|nodes| nodes as i32);
        let bytes = vol_bytes(counts, [[0.0; 3], [1.0; 3]], density.values());
        self.files.files.push((file.clone(), bytes));
        // The unit cube is divided into voxels; their middles are the nodes.
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
        let parts = [
            typed("string", "filename", &file),
            typed("boolean", "raw", true),
            typed("string", "filter_type", filter),
            typed("string", "wrap_mode", "clamp"),
            unit_cube_to(&cube, &grid.to_world),
        ];
        element(2, "volume", "gridvolume", " name=\"sigma_t\"", &parts)
    }

    fn light(&mut self, light: &Light) {
        match light {
            Light::Point(light) => {
                let parts = [
                    coordinates("point", "position", light.position),
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
                let target = ahead(light.position, light.axis());
                let up = light.axis().any_orthonormal_vector();
                let parts = [
                    look_at(light.position, target, up, None),
                    rgb("intensity", light.intensity),
                    typed("float", "beam_width", beam),
                    typed("float", "cutoff_angle", outer),
                ];
                self.element("emitter", "spot", "", &parts);
            }
            Light::Directional(light) => {
                let parts = [
                    coordinates("vector", "direction", *light.direction),
                    rgb("irradiance", light.irradiance),
                ];
                self.element("emitter", "directional", "", &parts);
            }
        }
    }

    fn surfaces(&mut self, export: &ExportScene) {
        for (index, ExportSurface { key, form, kind }) in export.surfaces.iter().enumerate() {
            let light = match kind {
                SurfaceKind::Light(light) => light,
                SurfaceKind::Material(material) => {
                    let mut parts = vec![bsdf(material)];
                    if let Some(at) = export.nested_media.with_interface(index) {
                        parts.extend(sides(export, at));
                    }
                    self.form(key, form, parts);
                    continue;
                }
            };
            let black = bsdf(&Material::Diffuse(DVec3::ZERO));
            let radiance = rgb("radiance", light.radiance);
            let shine = element(2, "emitter", "area", "", &[radiance]);
            self.form(key, form, vec![black.clone(), shine.clone()]);
            if light.sides == Sides::Front {
                continue;
            }
            let offset = BEHIND * form.reach();
            let (back, more) = match form {
                Form::Rectangle {
                    corner,
                    edges: [u, v],
                } => {
                    let corner = corner - u.cross(*v).normalize() * offset;
                    let edges = [*v, *u];
                    (Form::Rectangle { corner, edges }, None)
                }
                Form::Sphere { centre, radius } => {
                    let (centre, radius) = (*centre, radius - offset);
                    let inward = typed("boolean", "flip_normals", true);
                    (Form::Sphere { centre, radius }, Some(inward))
                }
                _ => {
                    let what = "a box or mesh that emits light on both sides; for a box or closed \
                    mesh, set `sides = \"front\"`";
                    self.faults.add(key, what);
                    continue;
                }
            };
            self.notes.push(format!(
                "{key} shines to both sides: its back is a second emitter, {offset:.3e} behind."
            ));
            let parts = more.into_iter().chain([black, shine]).collect();
            self.form(key, &back, parts);
        }
    }

    /// A shape with what belongs to it.
    fn form(&mut self, key: &str, form: &Form, parts: Vec<String>) {
        let _ = writeln!(self.body, "    <!-- {key} -->");
        let (kind, mut children) = match form {
            Form::Sphere { centre, radius } => {
                let centre = coordinates("point", "center", *centre);
                let children = vec![centre, typed("float", "radius", radius)];
                ("sphere", children)
            }
            Form::Ellipsoid { .. } => {
                self.faults.add(key, "an ellipsoid; give a mesh of it");
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
                let columns = [0.5 * u, 0.5 * v, normal, corner + 0.5 * (u + v)];
                ("rectangle", vec![matrix(columns)])
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
        let file = self.files.ply(vertices, faces);
        vec![
            typed("string", "filename", file),
            typed("boolean", "face_normals", true),
        ]
    }
}

/// A medium, as it is in all channels or in one; `volume` is its density, if that varies.
fn medium(id: &str, mixture: &Mixture, volume: &Option<String>, channel: Option<usize>) -> String {
    let sigma_t = mixture.sigma_t()[channel.unwrap_or(0)];
    let albedo = mixture.albedo();
    let (albedo, weights) = match channel {
        None => (rgb("albedo", albedo), mixture.weights().unwrap_or_default()),
        Some(channel) => (
            typed("float", "albedo", albedo[channel]),
            mixture.weights_of(channel),
        ),
    };
    let (kind, mut parts) = match volume {
        None => ("homogeneous", vec![typed("float", "sigma_t", sigma_t)]),
        Some(volume) => {
            let scale = typed("float", "scale", sigma_t);
            ("heterogeneous", vec![volume.clone(), scale])
        }
    };
    parts.extend([
        albedo,
        typed("boolean", "has_spectral_extinction", false),
        phases(2, &mixture.parts, &weights),
    ]);
    element(1, "medium", kind, id, &parts)
}

/// Phase functions, the first blended with the rest of them.
fn phases(depth: usize, parts: &[(Phase, DVec3)], weights: &[f64]) -> String {
    let (Some(((first, _), others)), Some((weight, rest))) =
        (parts.split_first(), weights.split_first())
    else {
        // Nothing scatters.
        return phase(depth, &Phase::ISOTROPIC).unwrap_or_default();
    };
    if others.is_empty() {
        return phase(depth, first).unwrap_or_default();
    }
    let left: f64 = rest.iter().sum();
    let share = if left > 0.0 {
        left / (weight + left)
    } else {
        0.0
    };
    let blended = [
        // The weight is that of the second of the two.
        typed("float", "weight", share),
        phase(depth + 1, first).unwrap_or_default(),
        phases(depth + 1, others, rest),
    ];
    element(depth, "phase", "blendphase", "", &blended)
}

/// Text for a comment, which two hyphens would end and control characters would spoil.
fn commented(text: &str) -> String {
    let mut text = text.replace(char::is_control, " ");
    while text.contains("--") {
        text = text.replace("--", "- -");
    }
    text
}

/// A phase function, if Mitsuba has it.
fn phase(depth: usize, phase: &Phase) -> Option<String> {
    match phase {
        phase if phase.is_isotropic() => Some("<phase type=\"isotropic\"/>".to_owned()),
        Phase::HenyeyGreenstein(phase) => {
            let g = typed("float", "g", phase.0.g());
            Some(element(depth, "phase", "hg", "", &[g]))
        }
        Phase::Draine(phase) if phase.is_rayleigh() => {
            Some("<phase type=\"rayleigh\"/>".to_owned())
        }
        _ => None,
    }
}

fn is_grey(v: DVec3) -> bool {
    v == DVec3::splat(v.x)
}

/// The interior and the exterior medium of a nested medium's boundary.
fn sides(export: &ExportScene, at: usize) -> Vec<String> {
    let list = &export.nested_media.list;
    let inside = reference("interior", &list[at].name());
    let outside = list[at].parent.map(|at| list[at].name());
    let outside = outside.map(|id| reference("exterior", &id));
    std::iter::once(inside).chain(outside).collect()
}

fn twosided(kind: &str, parts: &[String]) -> String {
    let inner = element(3, "bsdf", kind, "", parts);
    element(2, "bsdf", "twosided", "", &[inner])
}

fn bsdf(material: &Material) -> String {
    match material {
        Material::Diffuse(reflectance) => twosided("diffuse", &[rgb("reflectance", *reflectance)]),
        Material::Mirror(reflectance) => {
            let material = typed("string", "material", "none");
            let specular = rgb("specular_reflectance", *reflectance);
            twosided("conductor", &[material, specular])
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

/// The map that puts the unit cube where `to_world` puts a box.
fn unit_cube_to(cube: &Aabb, to_world: &Transform) -> String {
    let size = cube.size();
    let edges = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| to_world.vector(axis * size));
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

fn coordinates(tag: &str, name: &str, DVec3 { x, y, z }: DVec3) -> String {
    format!("<{tag} name=\"{name}\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
}

/// A view, of an image plane whose half width is scaled to `half_width`.
fn look_at(origin: DVec3, target: DVec3, up: DVec3, half_width: Option<f64>) -> String {
    let [origin, target, up] = [origin, target, up].map(listed);
    let scale = half_width.map_or(String::new(), |half| {
        format!("<scale x=\"{half}\" y=\"{half}\"/>")
    });
    format!(
        "<transform name=\"to_world\">{scale}<lookat origin=\"{origin}\" target=\"{target}\" \
         up=\"{up}\"/></transform>"
    )
}

/// An affine map by its columns, the last of which is where the origin goes.
fn matrix(columns: [DVec3; 4]) -> String {
    let row = |axis: usize| columns.map(|column| column[axis].to_string()).join(" ");
    let rows = [0, 1, 2].map(row).join(" ");
    format!("<transform name=\"to_world\"><matrix value=\"{rows} 0 0 0 1\"/></transform>")
}
