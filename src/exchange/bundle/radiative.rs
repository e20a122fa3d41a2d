//! Surfaces, media and lights in words and numbers.

use super::inline_arrays::{Entries, Json, entries};
use super::shapes::of_shape;
use super::volume::{grid, interpolation, ray};
use crate::exchange::files::SharedFiles;
use crate::exchange::forms;
use crate::optics::{Density, Field, Light, Material, Phase, Sides};
use crate::render::Plan;
use crate::scene::{AreaLight, Body, Object, Panel, Radiative};
use crate::volume::{NOISE_GRADIENTS, NOISE_PERMUTATION};

/// All that is computed for a picture of `scene`, the model of `panel`; grids and meshes go to `raw`.
pub(super) fn described(panel: &Panel, scene: &Radiative, raw: &mut SharedFiles) -> Entries {
    let plan = Plan::new(panel);
    let pixel = match plan.is_sampled() {
        true => ("box", MEAN),
        false => ("centre", "the radiance along the ray of `ray`"),
    };
    let mut parts = Parts {
        raw,
        formulas: entries! { "radiance": RADIANCE, "shape": SHAPE },
    };
    let surfaces: Vec<_> = scene.objects.iter().map(|it| parts.surface(it)).collect();
    let area_lights = scene.area_lights.iter();
    let area_lights: Vec<_> = area_lights.map(|it| parts.area_light(it)).collect();
    let lights: Vec<_> = scene.lights.iter().map(|it| parts.light(it)).collect();
    let media: Vec<_> = scene.media.iter().map(|it| parts.medium(it)).collect();
    let samples = entries! { "per_pixel": scene.samples, "seed": scene.seed, "rule": SAMPLES };
    entries! {
        "shows": "radiance", "ray": ray(&scene.camera),
        "pixel": entries! { "filter": pixel.0, "formula": pixel.1 },
        "samples": plan.is_sampled().then_some(samples),
        "scattering": entries! {
            "most": scene.scattering.max_bounces(), "rule": ORDER, "left_out": plan.omitted(),
        },
        "surfaces": surfaces, "area_lights": area_lights, "lights": lights,
        "environment": scene.environment, "media": media, "formulas": parts.formulas,
    }
}

/// The parts of a scene, and the formulas of the kinds that it has.
struct Parts<'p, 'n> {
    raw: &'p mut SharedFiles<'n>,
    formulas: Entries,
}

impl Parts<'_, '_> {
    fn surface(&mut self, Object { shape, material }: &Object) -> Entries {
        let (shape, matrix) = of_shape(forms::shape(shape), |mesh| self.raw.mesh(mesh));
        let (kind, key, value, formula) = match material {
            Material::Diffuse(share) => ("diffuse", "reflectance", (*share).into(), DIFFUSE),
            Material::Mirror(share) => ("mirror", "reflectance", (*share).into(), MIRROR),
            Material::Glass(index) => ("glass", "index", (*index).into(), GLASS),
        };
        self.define(kind, formula);
        let mut surface = entries! { "shape": shape, "matrix": matrix, "material": kind };
        surface.push((key, value));
        surface
    }

    fn area_light(&mut self, light: &AreaLight) -> Entries {
        self.define("area_light", AREA_LIGHT);
        let shape = forms::luminous(&light.shape);
        let (shape, matrix) = of_shape(shape, |mesh| self.raw.mesh(mesh));
        let sides = match light.sides {
            Sides::Front => "front",
            Sides::Both => "both",
        };
        entries! {
            "shape": shape, "matrix": matrix, "radiance": light.radiance, "sides": sides,
        }
    }

    fn light(&mut self, light: &Light) -> Entries {
        match light {
            Light::Point(light) => self.named(
                ("point", POINT),
                entries! { "position": light.position, "intensity": light.intensity },
            ),
            Light::Spot(light) => self.named(
                ("spot", SPOT),
                entries! {
                    "position": light.position, "intensity": light.intensity, "axis": *light.axis(),
                    "inner": light.inner(), "outer": light.outer(),
                },
            ),
            Light::Directional(light) => self.named(
                ("directional", DIRECTIONAL),
                entries! { "direction": *light.direction, "irradiance": light.irradiance },
            ),
        }
    }

    fn medium(&mut self, body: &Body) -> Entries {
        self.define("medium", MEDIUM);
        let placing = body.boundary.as_ref().map(forms::boundary);
        let shape = placing.map(|it| of_shape(it, |mesh| self.raw.mesh(mesh)));
        let (shape, matrix) = shape.unzip();
        let density = body.density.as_ref().map(|it| self.density(it));
        let (coefficients, phase) = (&body.medium.coefficients, self.phase(&body.medium.phase));
        entries! {
            "shape": shape, "matrix": matrix, "sigma_a": coefficients.sigma_a(),
            "sigma_s": coefficients.sigma_s(), "emission": body.medium.emission, "phase": phase,
            "density": density,
        }
    }

    fn density(&mut self, density: &Density) -> Entries {
        match density.field() {
            Field::Grid(field) => {
                let file = self.raw.grid(field.grid());
                let mut numbers = grid(field.grid().lattice(), None, file);
                numbers.extend(entries! { "interpolation": interpolation(field.interpolation()) });
                self.named(("grid", GRID), numbers)
            }
            Field::Noise(noise) => {
                self.define("permutation", NOISE_PERMUTATION);
                self.define("gradients", NOISE_GRADIENTS);
                let it = noise.parameters();
                let numbers = entries! {
                    "octaves": it.octaves, "lacunarity": it.lacunarity, "gain": it.gain, "scale": it.scale,
                    "offset": it.offset, "max_density": it.max_density, "threshold": it.threshold,
                };
                self.named(("noise", NOISE), numbers)
            }
            Field::Exponential(it) => self.named(
                ("exponential", EXPONENTIAL),
                entries! {
                    "density": it.density, "base": it.base, "up": *it.up, "scale_height": it.scale_height,
                },
            ),
            Field::Linear(it) => self.named(
                ("linear", LINEAR),
                entries! { "density": it.density, "origin": it.origin, "gradient": it.gradient },
            ),
            Field::Blob(it) => self.named(
                ("blob", BLOB),
                entries! { "centre": it.centre, "width": it.width, "peak": it.peak },
            ),
        }
    }

    fn phase(&mut self, phase: &Phase) -> Entries {
        match phase {
            Phase::HenyeyGreenstein(phase) => self.named(
                ("henyey-greenstein", HENYEY_GREENSTEIN),
                entries! { "g": phase.0.g() },
            ),
            Phase::Draine(phase) => self.named(
                ("draine", DRAINE),
                entries! { "g": phase.asymmetry().g(), "alpha": phase.alpha() },
            ),
            Phase::Droplets(phase) => {
                let (narrow, wide, weight) = phase.lobes();
                let numbers = entries! {
                    "narrow_g": narrow.0.g(), "g": wide.asymmetry().g(), "alpha": wide.alpha(),
                    "weight": weight,
                };
                self.named(("droplets", DROPLETS), numbers)
            }
        }
    }

    /// A kind of something with its numbers; `formula` tells what they mean.
    fn named(
        &mut self,
        (kind, formula): (&'static str, &'static str),
        numbers: Entries,
    ) -> Entries {
        self.define(kind, formula);
        let mut entries = entries! { "kind": kind };
        entries.extend(numbers);
        entries
    }

    /// States what `name` means, once.
    fn define(&mut self, name: &'static str, meaning: impl Into<Json>) {
        if !self.formulas.iter().any(|(known, _)| *known == name) {
            self.formulas.push((name, meaning.into()));
        }
    }
}

const MEAN: &str = "the mean of the radiance over the square of the pixel (box filter): along the ray of `ray` \
    with x and y no whole numbers, but spread evenly from half a pixel before them to half a pixel beyond";

const SAMPLES: &str = "what volref takes, for orientation: any number will do, and any way to take them. State \
    the noise: in an EXR the variances of the means of the pixels, channels variance.R, variance.G and \
    variance.B, and the samples behind each, channel samples.Y";

const ORDER: &str = "light is turned at most `most` times (null: any number of times) on its way from a light to \
    the eye, by media and surfaces together, mirrors and glass included: what is turned more often is left out. \
    The boundary of a medium turns nothing, and a light that is seen directly is turned 0 times. `left_out` \
    names what the scene leaves out";

const RADIANCE: &str = "L(x, w), the radiance seen from x along w, is for each channel the integral over t from \
    0 to D of T(t)*(J + the sum over the media of sigma_s * the integral over all directions v of p(w.v)*L(x + \
    t*w, v)), plus T(D)*S. All is taken at x + t*w; J is the sum of the emissions of the media there, and T(t) = \
    exp(-integral of the sum of their sigma_a + sigma_s from 0 to t). D is the distance of the nearest surface \
    or area light, and S what it sends towards x; where there is none, D is infinite and S is `environment`, \
    linear RGB from every direction. Each of `lights` adds p(w.v)*E*T to the inner integral, v the direction \
    towards it, E its irradiance at x + t*w and T that of the straight way to it, 0 where a surface, glass and \
    mirrors too, lies in between; and E*T*cosine to the irradiance on diffuse surfaces. Neither the eye nor \
    mirrors and glass see `lights`. w and v point away from the eye, against the light, and w.v is the cosine of \
    the angle of deflection. Coordinates are right-handed";

const SHAPE: &str = "with a matrix, three rows of four numbers, the point q of a shape stands at p = M*q + o in the \
    world, M its first three columns and o the last. The front of a sphere, of a box or of a closed mesh is its \
    outside, that of a rectangle, which reaches from corner along edge_u and edge_v, the side that edge_u x edge_v \
    points to, that of a triangle the side from which its vertices run anticlockwise, before the matrix: a matrix \
    that mirrors keeps what is in front there. A box may be flat along an axis. Vertices of a mesh: bare float64, \
    little endian, x, y, z of each; its triangles: bare uint32, little endian, three numbers of vertices, from 0, of \
    each. Meshes are flat-shaded; the inside of a mesh is where it has been entered more often than left";

const DIFFUSE: &str =
    "either side sends, in every direction of that side, reflectance/pi times the irradiance on it";

const MIRROR: &str =
    "either side sends reflectance times the radiance seen along the mirrored direction";

const GLASS: &str = "smooth glass: index is that behind the surface over that in front. Seen along w, c = |cos| \
    of the angle to the normal, r = 1/index from the front, r = index from behind; s = r^2*(1 - c^2). Where s >= \
    1, F = 1; else with e = sqrt(1 - s), F = (((r*c - e)/(r*c + e))^2 + ((c - r*e)/(c + r*e))^2)/2. It sends \
    F*L(mirrored) + (1 - F)*r^2*L(refracted), where refracted = r*w + (r*c - e)*n, n the normal on the side of \
    x: L/index^2 is the same on both sides";

const AREA_LIGHT: &str = "sends `radiance` in every direction from its front, or from both sides, reflects \
    nothing, and hides what is behind it";

const POINT: &str =
    "power per steradian `intensity`: at distance r the irradiance intensity/r^2 on what faces it";

const SPOT: &str = "as a point light, times 1 up to the angle `inner` from `axis`, 0 from `outer` on, and (outer \
    - angle)/(outer - inner) in between; radians";

const DIRECTIONAL: &str = "light that travels along `direction` everywhere, with the irradiance `irradiance` on \
    what faces it";

const MEDIUM: &str = "fills its shape, or all space if that is null, and does nothing at its boundary. sigma_a \
    (absorption), sigma_s (scattering) and emission are per length of the world, by channel, and all three are \
    multiplied by the density, which is 1 where it is null. Where media overlap they add up, each with its phase \
    function, as `radiance` says: none displaces another, whichever is named first. Boundaries may lie in \
    surfaces exactly. A density is a function of q, before the matrix of the shape";

const GRID: &str =
    "node positions and the box are those of points q; beyond the box the density is 0";

const NOISE: &str = "with z = q*scale + offset, component by component, v = (sum of gain^i*n(z*lacunarity^i))/(sum \
    of gain^i) over i = 0 ... octaves - 1, and d = min(max_density, max(0, (v + 1)/2*max_density)): the density is d \
    where d > threshold, else 0. n is Perlin's improved noise of 2002: with f = z - floor(z), [i, j, k] = floor(z) \
    mod 256 and P = permutation, the corner [a, b, c] of a cell, each 0 or 1, has the gradient number P[P[P[i + a] + \
    j + b] + k + c] mod 16 of `gradients`, all indices of P mod 256, and its value is that gradient . (f - [a, b, \
    c]); between the corners values are mixed in straight lines by the weights 6*f^5 - 15*f^4 + 10*f^3 of each axis";

const EXPONENTIAL: &str = "density*exp(-h/scale_height) at height h = up.(q - base)";

const LINEAR: &str = "max(0, density + gradient.(q - origin))";

const BLOB: &str = "peak*exp(-r^2/(2*width^2)) at distance r from centre";

const HENYEY_GREENSTEIN: &str =
    "p(c) = (1 - g^2)/(4*pi*(1 + g^2 - 2*g*c)^(3/2)) per steradian: g > 0 is forward";

const DRAINE: &str = "p(c) = h(g)*(1 + alpha*c^2)/(1 + alpha*(1 + 2*g^2)/3) per steradian, h(g) = (1 - \
    g^2)/(4*pi*(1 + g^2 - 2*g*c)^(3/2))";

const DROPLETS: &str = "p(c) = (1 - weight)*h(narrow_g) + weight*h(g)*(1 + alpha*c^2)/(1 + alpha*(1 + 2*g^2)/3) \
    per steradian, h(g) = (1 - g^2)/(4*pi*(1 + g^2 - 2*g*c)^(3/2))";
