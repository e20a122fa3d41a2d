//! A projection or isosurfaces of a volume in words and numbers.

use super::inline_arrays::{Entries, entries};
use crate::scene::{Classified, Isosurface, Isosurfaces, Mode, Projected, Projection};

/// Entries of a projection or of isosurfaces; none of composited samples.
pub(super) fn described(scene: &Classified) -> Option<Entries> {
    match &scene.mode {
        Mode::Composited => None,
        Mode::Projection(projection) => Some(of_projection(projection, scene)),
        Mode::Isosurfaces(surfaces) => Some(of_surfaces(surfaces, scene)),
    }
}

/// Formula of the field along a ray without samples.
pub(super) const EXACT: &str = "t0 and t1 are where the ray enters and leaves the box, t0 = 0 if the eye \
    is inside; a ray that misses the box sees the background. Nothing is sampled: f(t) is the interpolated value \
    at p(t), all along the ray; a renderer that samples it begins with this step, and shortens it";

fn of_projection(projection: &Projection, scene: &Classified) -> Entries {
    let [exact, sampled] = match projection.of {
        Projected::Maximum => ["x = max f(t) over t0 <= t <= t1", "x = max f_i"],
        Projected::Minimum => ["x = min f(t) over t0 <= t <= t1", "x = min f_i"],
        Projected::Mean => [
            "x = (integral of f from t0 to t1)/(t1 - t0)",
            "x = (sum of f_i*h_i)/(sum of h_i)",
        ],
        Projected::Sum => ["x = integral of f from t0 to t1", "x = sum of f_i*h_i"],
        Projected::AttenuatedMaximum(_) => [
            "with v = min(1, max(0, (f - low)/(high - low))): x = max v(t)*exp(-attenuation*D(t)) over \
             t0 <= t <= t1, where D(t) is the integral of v from t0 to t",
            "with v = min(1, max(0, (f - low)/(high - low))): x = max v_i*exp(-attenuation*D_i), where D_i is \
             the sum of v_j*h_j over the samples j < i",
        ],
    };
    let number = if scene.is_exact() { exact } else { sampled };
    let shown = match (projection.of, projection.window) {
        (Projected::AttenuatedMaximum(_), _) => "(x, x, x)",
        (_, Some(_)) => "(g, g, g) with g = min(1, max(0, (x - low)/(high - low)))",
        (_, None) => "colour(x), see transfer_function, without any opacity",
    };
    let pixel = format!(
        "the pixel is {shown}; of a ray that misses the box, or meets it in a point, the background"
    );
    let mut entries = entries! {
        "name": scene.mode.name(), "exact": scene.is_exact(), "number": number,
    };
    if let Projected::AttenuatedMaximum(attenuation) = projection.of {
        entries.push(("attenuation", attenuation.into()));
    }
    if let Some(window) = projection.window {
        entries.extend(entries! { "low": window.low, "high": window.high });
    }
    entries.push(("pixel", pixel.into()));
    entries
}

fn of_surfaces(isosurfaces: &Isosurfaces, scene: &Classified) -> Entries {
    let passed = match scene.is_exact() {
        true => {
            "a ray passes a surface at each t where f(t) goes from below its value to not below it, or back"
        }
        false => {
            "a ray passes a surface between two samples in a row of which one is below its value and the other is \
             not: at t = t_i + (t_(i+1) - t_i)*(value - f_i)/(f_(i+1) - f_i)"
        }
    };
    let pixel = "C = 0, A = 0; for each surface passed, from the eye on, C = C + (1 - A)*opacity*L and \
                 A = A + (1 - A)*opacity; the pixel is C + (1 - A)*background. Faces of the box are no surfaces";
    let light = match scene.phong {
        None => "L = colour",
        Some(_) => {
            "L = shade(colour), with the gradient interpolated at p(t), and taken with the other sign where \
             gradient.direction < 0: the normal is on the side of the eye"
        }
    };
    let surface = |surface: &Isosurface| {
        entries! { "value": surface.value, "colour": surface.colour, "opacity": surface.opacity }
    };
    let surfaces: Vec<Entries> = isosurfaces.surfaces.iter().map(surface).collect();
    entries! {
        "name": scene.mode.name(), "exact": scene.is_exact(), "surfaces": surfaces,
        "passed": passed, "light": light, "pixel": pixel,
    }
}
