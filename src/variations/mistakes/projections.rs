//! Mistakes in projections and isosurfaces of a classified volume.

use super::{Edit, Mistake, any, replaced, set};
use crate::optics::{Appearance, TransferPoint, TransferPoints};
use crate::scene::{
    Classified, Isosurface, IsosurfaceFault, Isosurfaces, Mode, Projected, Projection,
    ProjectionFault, Window,
};

pub(super) const MISTAKES: &[Mistake] = mistakes! {
    "mode-maximum" => Classified(|scene| shown_as(scene, Projected::Maximum)),
        "each pixel shows the largest value of its ray: the scene asks for another number";
    "mode-minimum" => Classified(|scene| shown_as(scene, Projected::Minimum)),
        "each pixel shows the smallest value of its ray: the scene asks for another number";
    "mode-mean" => Classified(|scene| shown_as(scene, Projected::Mean)),
        "each pixel shows the mean of its ray: the scene asks for another number";
    "mode-sum" => Classified(|scene| shown_as(scene, Projected::Sum)),
        "each pixel shows the integral along its ray: the scene asks for another number";
    "extremum-from-zero" => Classified(|scene| {
        // Where all values are on the side of 0 from which it is approached, nothing changes.
        let (least, most) = scene.grid.range();
        faulty(scene, ProjectionFault::BeginsAtZero, |of| match of {
            Projected::Maximum => least < 0.0,
            Projected::Minimum => most > 0.0,
            _ => false,
        })
    }),
        "the largest or smallest value begins at 0, and is never on the other side of it: begin with the first value of the ray";
    "maximum-of-the-front" => Classified(|scene| {
        faulty(scene, ProjectionFault::RefinedAtTheFront, |of| of == Projected::Maximum)
    }),
        "the front of the volume is shown: the maximum is looked for again about the place where it was found, but that place is still its start";
    "projection-sampled-too-coarsely" => Classified(|scene| {
        scene.step *= 8.0;
        scene.sample();
        matches!(scene.mode, Mode::Projection(_))
    }),
        "thin and small things are missing from the projection, or broken into stripes: samples are several voxels apart";
    "mean-not-divided" => Classified(|scene| {
        projected(scene, |projection| projection.of == Projected::Mean && set(&mut projection.of, Projected::Sum))
    }),
        "the mean is a sum: divide the integral by the length of the ray's way in the volume";
    "mean-over-a-constant" => Classified(mean_over_the_diagonal),
        "short ways through the volume are too dark: the integral is divided by one length for all rays, where each has its own";
    "mean-without-zeros" => Classified(|scene| {
        faulty(scene, ProjectionFault::WithoutZeros, |of| of == Projected::Mean)
    }),
        "the mean is over the samples that are not 0: empty parts of the way count, too";
    "sum-divided" => Classified(|scene| {
        projected(scene, |projection| projection.of == Projected::Sum && set(&mut projection.of, Projected::Mean))
    }),
        "the sum is a mean: it is not divided by the length of the ray's way in the volume";
    "attenuation-by-distance" => Classified(|scene| {
        faulty(scene, ProjectionFault::AttenuatedByDistance, |of| matches!(of, Projected::AttenuatedMaximum(_)))
    }),
        "values fade with the way from the entry into the box, whatever lies on it: what attenuates are the values passed";
    "attenuation-left-out" => Classified(|scene| attenuated(scene, |_, _| 0.0)),
        "nothing is attenuated: each value is multiplied by exp(-attenuation * integral of the values before it)";
    "attenuation-per-sample" => Classified(|scene| attenuated(scene, |attenuation, step| attenuation / step)),
        "attenuation depends on the step: the sum of the values before counts each times the length of its step";
    "window-of-the-data" => Classified(|scene| {
        let (low, high) = scene.grid.range();
        projected(scene, |projection| {
            low < high && projection.window.is_some() && set(&mut projection.window, Some(Window { low, high }))
        })
    }),
        "the window is that of the data, from the smallest value to the largest: the scene gives one";
    "isosurface-first-alone" => Classified(|scene| {
        let is_seen_through = |surface: &Isosurface| surface.opacity < 1.0;
        surfaced(scene, |surfaces| {
            surfaces.surfaces.iter().any(is_seen_through) && makes(surfaces, IsosurfaceFault::FirstAlone)
        })
    }),
        "a ray ends at its first isosurface: what lies behind it is seen through it, as far as it is not opaque";
    "isosurface-opaque" => Classified(|scene| {
        surfaced(scene, |surfaces| {
            any(&mut surfaces.surfaces, |surface| set(&mut surface.opacity, 1.0))
        })
    }),
        "isosurfaces are opaque: each has the opacity that the scene gives";
    "isosurface-at-samples" => Classified(|scene| {
        surfaced(scene, |surfaces| makes(surfaces, IsosurfaceFault::AtSamples))
    }),
        "isosurfaces are stairs: they lie between the two samples on either side, where the line between them has the value";
    "isosurface-normals-not-turned" => Classified(|scene| shaded_by(scene, IsosurfaceFault::NotTurned)),
        "isosurfaces are dark where their inside is seen: turn the normal to the side of the eye";
    "isosurface-normals-inwards" => Classified(|scene| shaded_by(scene, IsosurfaceFault::TurnedAway)),
        "isosurfaces are lit from behind: the normal points away from the eye; turn it to the eye's side";
};

fn projected(scene: &mut Classified, edit: impl Fn(&mut Projection) -> bool) -> bool {
    match &mut scene.mode {
        Mode::Projection(projection) => edit(projection),
        _ => false,
    }
}

/// Another number in place of that of the scene, unless the mistake has a name of its own.
fn shown_as(scene: &mut Classified, other: Projected) -> bool {
    projected(scene, |projection| match (projection.of, other) {
        (Projected::Mean, Projected::Sum) | (Projected::Sum, Projected::Mean) => false,
        (Projected::AttenuatedMaximum(_), Projected::Maximum) => false,
        _ => set(&mut projection.of, other),
    })
}

/// True if the mistake was not made yet.
fn makes(surfaces: &mut Isosurfaces, fault: IsosurfaceFault) -> bool {
    let is_new = !surfaces.faults.contains(&fault);
    surfaces.faults.extend(is_new.then_some(fault));
    is_new
}

fn surfaced(scene: &mut Classified, edit: impl Fn(&mut Isosurfaces) -> bool) -> bool {
    match &mut scene.mode {
        Mode::Isosurfaces(surfaces) => edit(surfaces),
        _ => false,
    }
}

/// Makes a mistake in projections of some kind.
fn faulty(scene: &mut Classified, fault: ProjectionFault, of: impl Fn(Projected) -> bool) -> bool {
    projected(scene, |projection| {
        of(projection.of) && set(&mut projection.fault, Some(fault))
    })
}

fn shaded_by(scene: &mut Classified, fault: IsosurfaceFault) -> bool {
    scene.phong.is_some() && surfaced(scene, |surfaces| makes(surfaces, fault))
}

/// Another attenuation, from the old one and the step.
fn attenuated(scene: &mut Classified, edit: fn(f64, f64) -> f64) -> bool {
    let step = scene.step;
    projected(scene, |projection| match &mut projection.of {
        Projected::AttenuatedMaximum(attenuation) => {
            let new = edit(*attenuation, step);
            new.is_finite() && set(attenuation, new)
        }
        _ => false,
    })
}

/// The mean as a sum in colours of values that are larger by the diagonal of the volume.
fn mean_over_the_diagonal(scene: &mut Classified) -> bool {
    let diagonal = scene.diagonal();
    let is_mean = projected(scene, |projection| {
        if let Some(window) = &mut projection.window {
            (window.low, window.high) = (window.low * diagonal, window.high * diagonal);
        }
        projection.of == Projected::Mean && set(&mut projection.of, Projected::Sum)
    });
    if !is_mean || !scene.mode.uses_transfer_function() {
        return is_mean;
    }
    let Appearance::Points(points) = &scene.transfer_function.appearance else {
        return false;
    };
    let larger = points.points().iter().map(|point| TransferPoint {
        value: point.value * diagonal,
        ..*point
    });
    let new = TransferPoints::new(larger.collect()).ok();
    let new = new.map(Appearance::Points);
    replaced(&mut scene.transfer_function.appearance, new)
}
