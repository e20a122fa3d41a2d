//! Several volumes, surfaces and clips in words and numbers.

use super::clips::{CLIP, clips};
use super::inline_arrays::{Entries, entries};
use super::shapes::{of_mesh, of_shape};
use super::volume::{SAMPLING, grid_of, light, look, radiance, ray, shading};
use crate::exchange::files::SharedFiles;
use crate::exchange::forms;
use crate::scene::{Classified, Modulation, OpaqueSurface};

/// All that is computed for a picture of `scene`, whose grids go to `raw`.
pub(super) fn described(scene: &Classified, raw: &mut SharedFiles) -> Entries {
    let (sampling, merging) = match scene.continuous {
        true => (WITHOUT_SAMPLES, MERGING_WITHOUT_SAMPLES),
        false => (SAMPLING, MERGING),
    };
    let volumes = scene.each_alone().enumerate();
    let volumes = volumes.map(|(index, alone)| {
        let clips = scene.objects.clips.iter().enumerate();
        let clips = clips.filter(|(_, clip)| clip.cuts(index));
        let clips: Vec<usize> = clips.map(|(number, _)| number).collect();
        let mut volume = entries! {
            "grid": grid_of(&alone, raw.grid(&alone.grid)), "clips": clips,
        };
        volume.extend(look(&alone, sampling));
        volume.push(("radiance", radiance(&alone).into()));
        let modulation = scene.modulation_of(index);
        volume.extend(modulation.map(|it| ("modulation", modulated(it, raw).into())));
        volume
    });
    let volumes: Vec<Entries> = volumes.collect();
    let surfaces: Vec<Entries> = scene.objects.surfaces.iter().map(surface).collect();
    entries! {
        "shows": "volumes", "ray": ray(&scene.camera), "volumes": volumes, "surfaces": surfaces,
        "surface": SURFACE, "clips": clips(&scene.objects.clips), "clip": CLIP,
        "light": light(scene.light), "shadow": scene.shadow.map(|_| SHADOW), "merging": merging,
        "background": scene.background,
    }
}

fn modulated(Modulation { grid, factors }: &Modulation, raw: &mut SharedFiles) -> Entries {
    let points = factors.points().iter();
    let points: Vec<[f64; 2]> = points.map(|point| [point.value, point.opacity]).collect();
    entries! { "file": raw.grid(grid), "points": points, "formula": MODULATION }
}

fn surface(surface: &OpaqueSurface) -> Entries {
    let (mut entries, matrix) = of_shape(forms::shape(&surface.shape), of_mesh);
    entries.extend(entries! {
        "matrix": matrix, "colour": surface.colour, "phong": surface.phong.map(shading),
    });
    entries
}

const SURFACE: &str = "surfaces are opaque. With a matrix, the point q of a shape stands at p = M*q + o in the \
    world, M its first three columns and o the last. Triangles are numbers of vertices, from 0. The nearest surface \
    that a ray meets, at t = t_hit, ends it: every t1 is at most t_hit, and colour, shaded by phong with n the \
    normal on the side that is seen and times the share v of the light, stands in the place of the background";

const SHADOW: &str = "the share v of the light that arrives at a sample or at a surface is the product of the \
    shares of all volumes, each with t0 where the ray towards the light enters what is left of it, 0 if \
    it begins inside; and 0 if a surface is on the way to the light";

const MODULATION: &str = "a0(d) of `merging` is multiplied by the factor of w, in straight lines between the points (w, factor) and \
    constant beyond; w is interpolated in this grid as d is in that of the volume, at the same nodes";

const MERGING: &str = "each volume is constant over each of its steps, which lie one after the other from t0 \
    to t1, with the values d and L of the sample in the middle: extinction s = -ln(1 - a0(d))/reference_length, \
    a0 the opacity of one reference_length. The ends of the steps of all volumes cut the ray into pieces. Over a \
    piece of length l, with sums over the volumes whose steps cover it: a = 1 - exp(-l*sum(s)), \
    L = sum(s*L)/sum(s); if some a0 are 1, a = 1, and L is the mean of theirs. C = 0, A = 0; for each piece from \
    the eye on, C = C + (1 - A)*a*L and A = A + (1 - A)*a; the pixel is C + (1 - A)*background";

const WITHOUT_SAMPLES: &str = "t0 and t1 are where the ray enters and leaves the box, t0 = 0 if the eye is inside. The image \
    is an integral, see merging; a renderer that samples it begins with this step, and shortens it";

const MERGING_WITHOUT_SAMPLES: &str = "each volume has at each place the extinction s(d) = -ln(1 - a0(d))/reference_length, a0 \
    the opacity of one reference_length; s and s*L are summed over the volumes that a place lies in, and \
    tau(t) is the integral of the sum of s up to t: the pixel is the integral of sum(s*L)*exp(-tau) along the \
    ray, plus exp(-tau) at its end times background. Where some a0 are 1 nothing is seen behind, and L is the \
    mean of theirs. It is the limit of samples, merged piece by piece, as all steps become short";
