//! A classified volume in words and numbers.

use super::clips::{CLIP, clips};
use super::inline_arrays::{Entries, entries};
use super::shapes::matrix;
use super::{modes, points};
use crate::geometry::{Camera, Transform};
use crate::optics::{Appearance, Phong, TransferFunction};
use crate::scene::{Classified, Compositing, Shadow};
use crate::volume::{Centring, Interpolation, Lattice};
use glam::DVec3;

/// All that is computed for a picture of `scene`, whose values stand in `file`.
pub(super) fn described(scene: &Classified, file: String) -> Entries {
    let is_lit = scene.phong.is_some() || scene.shadow.is_some();
    let mode = modes::described(scene);
    let formula = if mode.is_some() && scene.is_exact() {
        modes::EXACT
    } else if scene.continuous {
        CONTINUOUS
    } else {
        SAMPLING
    };
    let mut entries = entries! {
        "shows": "volume", "ray": ray(&scene.camera), "grid": grid_of(scene, file),
    };
    entries.extend(look(scene, formula));
    entries.push(("light", is_lit.then(|| light(scene.light)).into()));
    if !scene.objects.clips.is_empty() {
        entries.extend(entries! { "clips": clips(&scene.objects.clips), "clip": CLIP });
    }
    match mode {
        Some(mode) => entries.push(("mode", mode.into())),
        None => entries.extend(entries! {
            "radiance": radiance(scene), "compositing": compositing(scene),
        }),
    }
    if let Compositing::EarlyTermination(below) = scene.compositing {
        let rule = format!(
            "after each sample: if 1 - A is below {below}, leave out the samples that follow"
        );
        entries.push(("early_termination", rule.into()));
    }
    entries.push(("background", scene.background.into()));
    entries
}

/// Reading, sampling (by this formula) and look of the values of a volume.
pub(super) fn look(scene: &Classified, formula: &str) -> Entries {
    let sampling = entries! { "step": scene.step, "formula": formula };
    let look = &scene.transfer_function;
    let transfer = scene.mode.uses_transfer_function().then(|| transfer(look));
    let shadow = scene.shadow.map(|shadow| shadow_ray(shadow, look));
    entries! {
        "interpolation": interpolation(scene.interpolation), "sampling": sampling,
        "transfer_function": transfer, "gradient": scene.phong.map(|_| GRADIENT),
        "phong": scene.phong.map(shading), "shadow": shadow,
    }
}

/// A choice, and its meaning.
fn method(name: &str, formula: &str) -> Entries {
    entries! { "method": name, "formula": formula }
}

pub(super) fn ray(camera: &Camera) -> Entries {
    let start = "one ray through the centre of each pixel: with x the column and y the row within this panel, both \
                 from 0, and row 0 at the top, it leaves";
    let perspective = "eye along direction = normalise(forward + half_right*(2*x + 1 - width)/height \
                       - half_up*(2*y + 1 - height)/height), and p(t) = eye + t*direction. forward has length 1";
    let hands = "Coordinates are right-handed: half_right points along forward x half_up, so that with +y up and \
                 looking along +z, +x points left in the image";
    let parallel = format!(
        "{start} origin = eye + half_right*(2*x + 1 - width)/height - half_up*(2*y + 1 - height)/height along forward, \
         and p(t) = origin + t*forward. forward has length 1, half_right and half_up half the height of the image: \
         rays are parallel. {hands}"
    );
    let formula = format!(
        "{start} {perspective}, half_right and half_up the tangent of half the vertical field of view. {hands}"
    );
    let beside = format!(
        "{start} {perspective} and leads to the centre of the image, which may lie beside the axis, the \
         perpendicular of the image; half_right and half_up are half the height of the image in widths and in heights \
         of its pixels, where forward meets it. Coordinates are right-handed: half_right points along axis x half_up"
    );
    let mut entries = entries! {
        "eye": camera.eye, "forward": *camera.forward, "half_right": camera.half_right,
        "half_up": camera.half_up,
    };
    entries.extend(if !camera.is_centred() {
        entries! { "axis": *camera.axis, "formula": beside }
    } else if let Some(height) = camera.orthographic_height() {
        entries! { "orthographic_height": height, "formula": parallel }
    } else {
        entries! { "formula": formula }
    });
    entries
}

pub(super) fn grid_of(scene: &Classified, file: String) -> Entries {
    grid(scene.grid.lattice(), scene.to_world.as_ref(), file)
}

/// A grid whose values stand in `file`, where the map puts it.
pub(super) fn grid(lattice: &Lattice, to_world: Option<&Transform>, file: String) -> Entries {
    let bounds = lattice.bounds();
    let format = "bare float32, little endian, x fastest: with [nx, ny, nz] = nodes, the value of \
                  node (i, j, k) is number (k*ny + j)*nx + i, from 0";
    let positions = "node (i, j, k) lies at first_node + (i, j, k)*spacing; a point p has the node \
                     coordinates u = (p - first_node)/spacing";
    let faces = match lattice.centring() {
        Centring::Nodes => {
            "the volume fills the box, whose faces lie on the outermost nodes; along an axis of a \
             single node they lie half a spacing to either side"
        }
        Centring::Cells => {
            "the volume fills the box, whose faces lie half a spacing beyond the outermost nodes"
        }
    };
    let mut entries = entries! {
        "file": file, "format": format, "nodes": lattice.nodes(), "spacing": lattice.spacing(),
        "first_node": lattice.first(), "positions": positions, "box_min": bounds.min,
        "box_max": bounds.max, "faces": faces,
    };
    if let Some(to_world) = to_world {
        entries.extend(entries! { "matrix": matrix(to_world), "placement": PLACEMENT });
    }
    entries
}

const PLACEMENT: &str = "the matrix has three rows of four numbers: with M its first three columns and o the \
    last, the point q of the grid stands at p = M*q + o in the world. Nodes, box and values are in \
    coordinates q. A ray is q(t) = M^-1*(p(t) - o) in them: it enters and leaves the box at the t of that line, \
    and is not made a line of unit direction: t, steps and lengths are of the world. Gradients of the \
    world are the transpose of M^-1, times those of the grid; eye, light and shading are of the world";

pub(super) fn interpolation(interpolation: Interpolation) -> Entries {
    match interpolation {
        Interpolation::Nearest => method(
            "nearest",
            "the value of node floor(u + 1/2), on each axis clamped to 0 ... nodes - 1. The sample \
             keeps its own position: only values come from the node",
        ),
        Interpolation::Trilinear => method(
            "trilinear",
            "with i = floor(u) and f = u - i on each axis, a + (b - a)*f between the values a of node i and b of \
             node i + 1, along x, then y, then z; node indices are clamped to 0 ... nodes - 1",
        ),
    }
}

const CONTINUOUS: &str = "t0 and t1 are where the ray enters and leaves the box, t0 = 0 if the eye is \
    inside; a ray that misses the box sees the background. The image is an integral, see compositing; \
    a renderer that samples it begins with this step, and shortens it";

pub(super) const SAMPLING: &str = "t0 and t1 are where the ray enters and leaves the box, t0 = 0 if the eye is \
    inside; a ray that misses the box sees the background. n = ceil((t1 - t0)/step); sample i = 0 ... n - 1 lies at \
    t = t0 + (i + 1/2)*step and stands for the length h = step. The last step is as long as what is left: h = (t1 - \
    t0) - (n - 1)*step, its sample in its middle at t = t0 + (n - 1)*step + h/2";

fn transfer(transfer_function: &TransferFunction) -> Entries {
    let mut entries = entries! { "reference_length": transfer_function.reference_length };
    match &transfer_function.appearance {
        Appearance::Formula {
            opacity,
            colormap,
            range,
        } => {
            if let Some(range) = range {
                entries.extend(entries! { "range": *range, "density": DENSITY });
            }
            let formula = "at density d a step of length h has the opacity a = 1 - T(d)^(h/reference_length), where \
                           T(d) = min(1, max(0, (exp(-d^2) - floor)/(1 - floor))) is the transparency of one \
                           reference_length";
            let colour = "linear RGB, in straight lines between the m colours, which are evenly spaced from d = 0 to \
                          d = 1: with s = min(d, 1)*(m - 1) and k = floor(s), colour(d) = colours[k] + (colours[k+1] \
                          - colours[k])*(s - k); from d = 1 on, and for m = 1, the last";
            entries.extend(entries! {
                "kind": "formula", "floor": opacity.floor, "opacity": formula, "colours": colormap.stops().to_vec(),
                "colour": colour,
            });
        }
        Appearance::Points(table) => {
            let opacity = "at value d a step of length h has the opacity a = 1 - (1 - a0(d))^(h/reference_length); \
                           a0(d) goes in straight lines between the opacities of the points and is constant beyond \
                           the outermost. If two points have one value, the later holds at the value itself";
            let colour = "linear RGB, colour(d), in straight lines between the colours of the \
                          points, in the same way";
            entries.extend(entries! {
                "kind": "table", "points": points(table), "opacity": opacity, "colour": colour,
            });
        }
    }
    entries
}

const DENSITY: &str = "with [lo, hi] = range, a value v has the density d = min(1, max(0, (v - lo)/(hi - lo))), \
    which takes the place of d wherever it stands: in opacities, colours, radiances and shadows";

const GRADIENT: &str = "stored at the nodes, by central differences: along each axis \
    (value(i+1) - value(i-1))/(2*spacing). A border node takes the gradient of the nearest inner \
    node: on each axis the index is clamped to 1 ... nodes - 2. An axis of fewer than 3 nodes has \
    the component 0. Between the nodes the three components are interpolated like the values";

pub(super) fn shading(phong: Phong) -> Entries {
    let formula = "with n = -gradient/|gradient|, l = normalise(light.position - p), v = -direction and r = \
                   2*(n.l)*n - l: where n.l > 0, shade(c) = c*(ambient + diffuse*(n.l)) + (1, 1, \
                   1)*specular*max(r.v, 0)^shininess; elsewhere shade(c) = c*ambient. Where the gradient is exactly \
                   zero there is no normal, and shade(c) = c";
    entries! {
        "ambient": phong.ambient, "diffuse": phong.diffuse, "specular": phong.specular,
        "shininess": phong.shininess, "formula": formula,
    }
}

fn shadow_ray(shadow: Shadow, transfer_function: &TransferFunction) -> Entries {
    let share = match transfer_function.appearance {
        Appearance::Formula { .. } => "min(1, exp(-S/100)), S = sum of density*h/reference_step",
        Appearance::Points(_) => "product of (1 - a0(d))^(h/reference_step)",
    };
    let formula = format!(
        "from each sample a ray goes towards the light, to where it leaves the box or reaches the \
         light, whichever comes first. It is sampled like the ray of the eye, with t0 = 0 and its \
         own step: the share of the light that arrives is v = {share}"
    );
    entries! { "step": shadow.step, "reference_step": shadow.reference_step, "formula": formula }
}

pub(super) fn light(position: DVec3) -> Entries {
    entries! {
        "position": position, "kind": "a white point light of strength 1, without fall-off",
    }
}

/// Formula of the radiance of a sample: only the factors that the scene has.
pub(super) fn radiance(scene: &Classified) -> String {
    let strength = match scene.transfer_function.appearance {
        Appearance::Formula { .. } => "d^2 * ",
        Appearance::Points(_) => "",
    };
    let colour = match scene.phong {
        Some(_) => "shade(colour(d))",
        None => "colour(d)",
    };
    let visibility = match scene.shadow {
        Some(_) => " * v, ambient light and highlight included",
        None => "",
    };
    format!("a sample of value d emits L = {strength}{colour}{visibility}")
}

fn compositing(scene: &Classified) -> Entries {
    if scene.continuous {
        return method(
            "continuous",
            "with the extinction s(d) = -ln(1 - a0(d))/reference_length, where a0 is the opacity of \
             one reference_length, and tau(t) = integral of s from t0 to t: the pixel is the integral \
             of s(d(t))*L(d(t))*exp(-tau(t)) over t from t0 to t1, plus exp(-tau(t1))*background; the \
             limit of samples composited front to back as the step becomes short",
        );
    }
    match scene.compositing {
        Compositing::FrontToBack | Compositing::EarlyTermination(_) => method(
            "front-to-back",
            "C = 0, A = 0; for each sample from the eye on, C = C + (1 - A)*a*L and \
             A = A + (1 - A)*a; the pixel is C + (1 - A)*background",
        ),
        Compositing::BackToFront => method(
            "back-to-front",
            "C = 0, A = 0; for each sample from the far end on, C = a*L + (1 - a)*C and \
             A = a + (1 - a)*A; the pixel is C + (1 - A)*background",
        ),
    }
}
