//! Mistakes in projections and isosurfaces of a classified volume.

use super::{Edit, Mistake, set};
use crate::optics::{Appearance, TransferPoint, TransferPoints};
use crate::scene::{
    Classified, Isosurface, IsosurfaceFault, Isosurfaces, Mode, Projected, Projection,
    ProjectionFault, Window,
};

pub(super) const MISTAKES: &[Mistake] = &[
    Mistake {
        name: "mode-maximum",
        advice: "each pixel shows the largest value of its ray: the scene asks for another number",
        edit: Edit::Classified(|scene| shown_as(scene, Projected::Maximum)),
    },
    Mistake {
        name: "mode-minimum",
        advice: "each pixel shows the smallest value of its ray: the scene asks for another number",
        edit: Edit::Classified(|scene| shown_as(scene, Projected::Minimum)),
    },
    Mistake {
        name: "mode-mean",
        advice: "each pixel shows the mean of its ray: the scene asks for another number",
        edit: Edit::Classified(|scene| shown_as(scene, Projected::Mean)),
    },
    Mistake {
        name: "mode-sum",
        advice: "each pixel shows the integral along its ray: the scene asks for another number",
        edit: Edit::Classified(|scene| shown_as(scene, Projected::Sum)),
    },
    Mistake {
        name: "extremum-from-zero",
        advice: "the largest or smallest value begins at 0, and is never on the other side of it: begin with the first value of the ray",
        edit: Edit::Classified(|scene| {
            // Where all values are on the side of 0 from which it is approached, nothing changes.
            let (least, most) = scene.grid.range();
            faulty(scene, ProjectionFault::BeginsAtZero, |of| match of {
                Projected::Maximum => least < 0.0,
                Projected::Minimum => most > 0.0,
                _ => false,
            })
        }),
    },
    Mistake {
        name: "maximum-of-the-front",
        advice: "the front of the volume is shown: the maximum is looked for again about the place where it was found, but that place is still its start",
        edit: Edit::Classified(|scene| {
            faulty(scene, ProjectionFault::RefinedAtTheFront, |of| {
                of == Projected::Maximum
            })
        }),
    },
    Mistake {
        name: "projection-sampled-too-coarsely",
        advice: "thin and small things are missing from the projection, or broken into stripes: samples are several voxels apart",
        edit: Edit::Classified(|scene| {
            scene.step *= 8.0;
            scene.sample();
            matches!(scene.mode, Mode::Projection(_))
        }),
    },
    Mistake {
        name: "mean-not-divided",
        advice: "the mean is a sum: divide the integral by the length of the ray's way in the volume",
        edit: Edit::Classified(|scene| {
            projected(scene, |projection| {
                projection.of == Projected::Mean && set(&mut projection.of, Projected::Sum)
            })
        }),
    },
    Mistake {
        name: "mean-over-a-constant",
        advice: "short ways through the volume are too dark: the integral is divided by one length for all rays, where each has its own",
        edit: Edit::Classified(mean_over_the_diagonal),
    },
    Mistake {
        name: "mean-without-zeros",
        advice: "the mean is over the samples that are not 0: empty parts of the way count, too",
        edit: Edit::Classified(|scene| {
            faulty(scene, ProjectionFault::WithoutZeros, |of| {
                of == Projected::Mean
            })
        }),
    },
    Mistake {
        name: "sum-divided",
        advice: "the sum is a mean: it is not divided by the length of the ray's way in the volume",
        edit: Edit::Classified(|scene| {
            projected(scene, |projection| {
                projection.of == Projected::Sum && set(&mut projection.of, Projected::Mean)
            })
        }),
    },
    Mistake {
        name: "attenuation-by-distance",
        advice: "values fade with the way from the entry into the box, whatever lies on it: what attenuates are the values passed",
        edit: Edit::Classified(|scene| {
            faulty(scene, ProjectionFault::AttenuatedByDistance, |of| {
                matches!(of, Projected::AttenuatedMaximum(_))
            })
        }),
    },
    Mistake {
        name: "attenuation-left-out",
        advice: "nothing is attenuated: each value is multiplied by exp(-attenuation * integral of the values before it)",
        edit: Edit::Classified(|scene| attenuated(scene, |_, _| 0.0)),
    },
    Mistake {
        name: "attenuation-per-sample",
        advice: "attenuation depends on the step: the sum of the values before counts each times the length of its step",
        edit: Edit::Classified(|scene| attenuated(scene, |attenuation, step| attenuation / step)),
    },
    Mistake {
        name: "window-of-the-data",
        advice: "the window is that of the data, from the smallest value to the largest: the scene gives one",
        edit: Edit::Classified(|scene| {
            let (low, high) = scene.grid.range();
            projected(scene, |projection| {
                low < high
                    && projection.window.is_some()
                    && set(&mut projection.window, Some(Window { low, high }))
            })
        }),
    },
    Mistake {
        name: "isosurface-first-alone",
        advice: "a ray ends at its first isosurface: what lies behind it is seen through it, as far as it is not opaque",
        edit: Edit::Classified(|scene| {
            let is_seen_through = |surface: &Isosurface| surface.opacity < 1.0;
            surfaced(scene, |surfaces| {
                surfaces.surfaces.iter().any(is_seen_through)
                    && makes(surfaces, IsosurfaceFault::FirstAlone)
            })
        }),
    },
    Mistake {
        name: "isosurface-opaque",
        advice: "isosurfaces are opaque: each has the opacity that the scene gives",
        edit: Edit::Classified(|scene| {
            surfaced(scene, |surfaces| {
                let surfaces = surfaces.surfaces.iter_mut();
                surfaces.fold(false, |occurs, surface| {
                    set(&mut surface.opacity, 1.0) | occurs
                })
            })
        }),
    },
    Mistake {
        name: "isosurface-at-samples",
        advice: "isosurfaces are stairs: they lie between the two samples on either side, where the line between them has the value",
        edit: Edit::Classified(|scene| {
            surfaced(scene, |surfaces| {
                makes(surfaces, IsosurfaceFault::AtSamples)
            })
        }),
    },
    Mistake {
        name: "isosurface-normals-not-turned",
        advice: "isosurfaces are dark where their inside is seen: turn the normal to the side of the eye",
        edit: Edit::Classified(|scene| shaded_by(scene, IsosurfaceFault::NotTurned)),
    },
    Mistake {
        name: "isosurface-normals-inwards",
        advice: "isosurfaces are lit from behind: the normal points away from the eye; turn it to the eye's side",
        edit: Edit::Classified(|scene| shaded_by(scene, IsosurfaceFault::TurnedAway)),
    },
];

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
    let Ok(points) = TransferPoints::new(larger.collect()) else {
        return false;
    };
    scene.transfer_function.appearance = Appearance::Points(points);
    true
}
