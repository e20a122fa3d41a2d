//! A classified volume in words and numbers.

use super::BundlePoint;
use crate::geometry::Camera;
use crate::media::{Appearance, Phong, TransferFunction};
use crate::scene::{Classified, Compositing, Shadow};
use crate::volume::{Centring, Interpolation, Lattice};
use glam::DVec3;
use serde::Serialize;

type Vector = [f64; 3];

/// All that is computed for a picture of a volume.
#[derive(Serialize)]
pub(super) struct BundleVolume {
    ray: BundleRay,
    grid: BundleGrid,
    interpolation: BundleMethod,
    sampling: BundleSampling,
    transfer_function: Transfer,
    gradient: Option<&'static str>,
    phong: Option<BundleShading>,
    shadow: Option<ShadowRay>,
    light: Option<BundleLight>,
    radiance: String,
    compositing: BundleMethod,
    #[serde(skip_serializing_if = "Option::is_none")]
    early_termination: Option<String>,
    background: Vector,
}

impl BundleVolume {
    /// The description of `scene`, whose values stand in `file`.
    pub(super) fn new(scene: &Classified, file: String) -> BundleVolume {
        let lit = scene.phong.is_some() || scene.shadow.is_some();
        BundleVolume {
            ray: BundleRay::new(&scene.camera),
            grid: BundleGrid::new(scene.grid.lattice(), file),
            interpolation: interpolation(scene.interpolation),
            sampling: BundleSampling {
                step: scene.step,
                formula: SAMPLING,
            },
            transfer_function: Transfer::new(&scene.transfer_function),
            gradient: scene.phong.map(|_| GRADIENT),
            phong: scene.phong.map(BundleShading::new),
            shadow: scene
                .shadow
                .map(|shadow| ShadowRay::new(shadow, &scene.transfer_function)),
            light: lit.then(|| BundleLight {
                position: scene.light.to_array(),
                kind: "a white point light of strength 1, without fall-off",
            }),
            radiance: radiance(scene),
            compositing: compositing(scene.compositing),
            early_termination: early_termination(scene.compositing),
            background: scene.background.to_array(),
        }
    }
}

/// A choice, and what it means.
#[derive(Serialize)]
struct BundleMethod {
    method: &'static str,
    formula: &'static str,
}

#[derive(Serialize)]
struct BundleRay {
    eye: Vector,
    forward: Vector,
    half_right: Vector,
    half_up: Vector,
    formula: &'static str,
}

impl BundleRay {
    fn new(camera: &Camera) -> BundleRay {
        BundleRay {
            eye: camera.eye().to_array(),
            forward: camera.forward().to_array(),
            half_right: camera.half_right().to_array(),
            half_up: camera.half_up().to_array(),
            formula: "one ray through the centre of each pixel: with x the column and y the row \
                      within this panel, both from 0, and row 0 at the top, it leaves eye along \
                      direction = normalise(forward + half_right*(2*x + 1 - width)/height \
                      - half_up*(2*y + 1 - height)/height), and p(t) = eye + t*direction. \
                      forward has length 1, half_right and half_up the tangent of half the \
                      vertical field of view. Coordinates are right-handed: half_right points \
                      along forward x half_up, so that with +y up and looking along +z, +x is to \
                      the left of the image",
        }
    }
}

#[derive(Serialize)]
struct BundleGrid {
    file: String,
    format: &'static str,
    nodes: [usize; 3],
    spacing: Vector,
    first_node: Vector,
    positions: &'static str,
    box_min: Vector,
    box_max: Vector,
    faces: &'static str,
}

impl BundleGrid {
    fn new(lattice: &Lattice, file: String) -> BundleGrid {
        let bounds = lattice.bounds();
        BundleGrid {
            file,
            format: "bare float32, little endian, x fastest: with [nx, ny, nz] = nodes, the \
                     value of node (i, j, k) is number (k*ny + j)*nx + i, from 0",
            nodes: lattice.nodes(),
            spacing: lattice.spacing().to_array(),
            first_node: lattice.first().to_array(),
            positions: "node (i, j, k) lies at first_node + (i, j, k)*spacing; a point p has the \
                        node coordinates u = (p - first_node)/spacing",
            box_min: bounds.min.to_array(),
            box_max: bounds.max.to_array(),
            faces: match lattice.centring() {
                Centring::Nodes => {
                    "the volume fills the box, whose faces lie on the outermost nodes; along an \
                     axis of a single node they lie half a spacing to either side"
                }
                Centring::Cells => {
                    "the volume fills the box, whose faces lie half a spacing beyond the \
                     outermost nodes"
                }
            },
        }
    }
}

fn interpolation(interpolation: Interpolation) -> BundleMethod {
    match interpolation {
        Interpolation::Nearest => BundleMethod {
            method: "nearest",
            formula: "the value of node floor(u + 1/2), on each axis clamped to 0 ... nodes - 1. \
                      The sample keeps its own position: only values come from the node",
        },
        Interpolation::Trilinear => BundleMethod {
            method: "trilinear",
            formula: "with i = floor(u) and f = u - i on each axis, a + (b - a)*f between the \
                      values a of node i and b of node i + 1, along x, then y, then z; node \
                      indices are clamped to 0 ... nodes - 1",
        },
    }
}

#[derive(Serialize)]
struct BundleSampling {
    step: f64,
    formula: &'static str,
}

const SAMPLING: &str = "t0 and t1 are where the ray enters and leaves the box, t0 = 0 if the eye \
    is inside; a ray that misses the box sees the background. n = ceil((t1 - t0)/step); sample i \
    = 0 ... n - 1 lies at t = t0 + (i + 1/2)*step and stands for the length h = step. The last \
    step is as long as what is left: h = (t1 - t0) - (n - 1)*step, its sample in its middle at \
    t = t0 + (n - 1)*step + h/2";

#[derive(Serialize)]
struct Transfer {
    reference_length: f64,
    #[serde(flatten)]
    kind: TransferKind,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum TransferKind {
    Formula {
        floor: f64,
        opacity: &'static str,
        colours: Vec<Vector>,
        colour: &'static str,
    },
    Table {
        points: Vec<BundlePoint>,
        opacity: &'static str,
        colour: &'static str,
    },
}

impl Transfer {
    fn new(transfer_function: &TransferFunction) -> Transfer {
        let kind = match &transfer_function.appearance {
            Appearance::Formula { opacity, colormap } => TransferKind::Formula {
                floor: opacity.floor,
                opacity: "at density d a step of length h has the opacity \
                          a = 1 - T(d)^(h/reference_length), where \
                          T(d) = min(1, max(0, (exp(-d^2) - floor)/(1 - floor))) is the \
                          transparency of one reference_length",
                colours: colormap.stops().iter().map(DVec3::to_array).collect(),
                colour: "linear RGB, in straight lines between the m colours, which are evenly \
                         spaced from d = 0 to d = 1: with s = min(d, 1)*(m - 1) and k = floor(s), \
                         colour(d) = colours[k] + (colours[k+1] - colours[k])*(s - k); from d = 1 \
                         on, and for m = 1, the last",
            },
            Appearance::Points(points) => TransferKind::Table {
                points: BundlePoint::list(points),
                opacity: "at value d a step of length h has the opacity \
                          a = 1 - (1 - a0(d))^(h/reference_length); a0(d) goes in straight lines \
                          between the opacities of the points and is constant beyond the \
                          outermost. Of two points at one value, the later holds at the value \
                          itself",
                colour: "linear RGB, colour(d), in straight lines between the colours of the \
                         points, likewise",
            },
        };
        Transfer {
            reference_length: transfer_function.reference_length,
            kind,
        }
    }
}

const GRADIENT: &str = "stored at the nodes, by central differences: along each axis \
    (value(i+1) - value(i-1))/(2*spacing). A border node takes the gradient of the nearest inner \
    node: on each axis the index is clamped to 1 ... nodes - 2. An axis of fewer than 3 nodes has \
    the component 0. Between the nodes the three components are interpolated like the values";

#[derive(Serialize)]
struct BundleShading {
    ambient: f64,
    diffuse: f64,
    specular: f64,
    shininess: u32,
    formula: &'static str,
}

impl BundleShading {
    fn new(phong: Phong) -> BundleShading {
        BundleShading {
            ambient: phong.ambient,
            diffuse: phong.diffuse,
            specular: phong.specular,
            shininess: phong.shininess,
            formula: "with n = -gradient/|gradient|, l = normalise(light.position - p), \
                      v = -direction and r = 2*(n.l)*n - l: where n.l > 0, \
                      shade(c) = c*(ambient + diffuse*(n.l)) \
                      + (1, 1, 1)*specular*max(r.v, 0)^shininess; elsewhere \
                      shade(c) = c*ambient. Where the gradient is exactly zero there is no \
                      normal, and shade(c) = c",
        }
    }
}

#[derive(Serialize)]
struct ShadowRay {
    step: f64,
    reference_step: f64,
    formula: &'static str,
}

impl ShadowRay {
    fn new(shadow: Shadow, transfer_function: &TransferFunction) -> ShadowRay {
        ShadowRay {
            step: shadow.step,
            reference_step: shadow.reference_step,
            formula: match transfer_function.appearance {
                Appearance::Formula { .. } => {
                    "from each sample a ray goes towards the light, to where it leaves the box \
                     or reaches the light, whichever comes first. It is sampled like the ray of \
                     the eye, with t0 = 0 and its own step: the share of the light that arrives \
                     is v = min(1, exp(-S/100)), S = sum of density*h/reference_step"
                }
                Appearance::Points(_) => {
                    "from each sample a ray goes towards the light, to where it leaves the box \
                     or reaches the light, whichever comes first. It is sampled like the ray of \
                     the eye, with t0 = 0 and its own step: the share of the light that arrives \
                     is v = product of (1 - a0(d))^(h/reference_step)"
                }
            },
        }
    }
}

#[derive(Serialize)]
struct BundleLight {
    position: Vector,
    kind: &'static str,
}

/// What a sample sends to the eye: only the factors that there are.
fn radiance(scene: &Classified) -> String {
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

fn early_termination(order: Compositing) -> Option<String> {
    match order {
        Compositing::EarlyTermination(below) => Some(format!(
            "after each sample: if 1 - A is below {below}, leave out the samples that follow"
        )),
        Compositing::FrontToBack | Compositing::BackToFront => None,
    }
}

fn compositing(order: Compositing) -> BundleMethod {
    match order {
        Compositing::FrontToBack | Compositing::EarlyTermination(_) => BundleMethod {
            method: "front-to-back",
            formula: "C = 0, A = 0; for each sample from the eye on, C = C + (1 - A)*a*L and \
                      A = A + (1 - A)*a; the pixel is C + (1 - A)*background",
        },
        Compositing::BackToFront => BundleMethod {
            method: "back-to-front",
            formula: "C = 0, A = 0; for each sample from the far end on, C = a*L + (1 - a)*C and \
                      A = a + (1 - a)*A; the pixel is C + (1 - A)*background",
        },
    }
}
