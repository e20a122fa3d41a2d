//! Mistakes in ray casters of classified volumes.

use super::{Edit, Mistake, set};
use crate::geometry::length_of;
use crate::optics::{Appearance, Colormap, Phong, TransferPoint, TransferPoints};
use crate::scene::{Classified, Gradient, Lookup, Mode, NormalTransform, Shadow, StepLength};
use crate::volume::Interpolation;
use glam::DVec3;

pub(super) const MISTAKES: &[Mistake] = &[
    Mistake {
        name: "opacity-uncorrected",
        advice: "the opacity of a sample does not depend on the step: opacity is stated over a reference length h0, so over a step h it is 1 - (1 - a)^(h / h0)",
        edit: Edit::Classified(|scene| referred(scene, |_, step| step)),
    },
    Mistake {
        name: "opacity-exponent-inverted",
        advice: "the exponent of the opacity correction is inverted: it is step / reference length",
        edit: Edit::Classified(|scene| referred(scene, |reference, step| step * step / reference)),
    },
    Mistake {
        name: "opacity-halved",
        advice: "the volume is too thin, as though opacities were stated over twice their reference length: how long is a voxel?",
        edit: Edit::Classified(|scene| referred(scene, |reference, _| 2.0 * reference)),
    },
    Mistake {
        name: "opacity-doubled",
        advice: "the volume is too dense, as though opacities were stated over half their reference length: how long is a voxel?",
        edit: Edit::Classified(|scene| referred(scene, |reference, _| 0.5 * reference)),
    },
    Mistake {
        name: "opacity-corrected-twice",
        advice: "opacities are corrected for the step once more after they were: the exponent is step / reference length, once",
        edit: Edit::Classified(|scene| {
            referred(scene, |reference, step| reference * reference / step)
        }),
    },
    Mistake {
        name: "unit-distance-of-zero",
        advice: "all that is not transparent is opaque, as though opacities were stated over no length: the unit distance is not 0",
        edit: Edit::Classified(|scene| {
            referred(scene, |reference, _| {
                reference * f64::EPSILON * f64::EPSILON
            })
        }),
    },
    Mistake {
        name: "colours-added",
        advice: "the colours of samples are added, whatever lies before them: each is multiplied by the transmittance of the samples in front of it",
        edit: Edit::Classified(|scene| {
            !scene.is_continuous() && set(&mut scene.conventions.added_colours, true)
        }),
    },
    Mistake {
        name: "rays-end-too-soon",
        advice: "rays end after as many steps as the longest edge of the volume takes: a diagonal takes up to 1.7 times as many",
        edit: Edit::Classified(|scene| {
            let longest = scene
                .extent()
                .edges()
                .map(length_of)
                .into_iter()
                .fold(0.0, f64::max);
            let steps = longest / scene.step;
            let most = (0.5..1e7).contains(&steps).then(|| steps.round() as u32);
            !scene.is_continuous() && most.is_some() && set(&mut scene.conventions.most_steps, most)
        }),
    },
    Mistake {
        name: "samples-behind-the-eye",
        advice: "with the eye inside the volume rays begin behind it, where their line enters the box: they begin at the eye, at t = 0",
        edit: Edit::Classified(|scene| {
            !scene.is_continuous()
                && eye_is_inside(scene)
                && set(&mut scene.conventions.starts_behind_eye, true)
        }),
    },
    Mistake {
        name: "transparency-not-normalised",
        advice: "transparency is exp(-d^2) as it stands: subtract the floor and divide by what is left, so that it falls from 1 to 0",
        edit: Edit::Opacity(|opacity| set(&mut opacity.floor, 0.0)),
    },
    Mistake {
        name: "transparency-floor-too-high",
        advice: "the volume turns opaque too early: the floor of the transparency is not the one that the scene gives",
        edit: Edit::Opacity(|opacity| set(&mut opacity.floor, 0.5)),
    },
    Mistake {
        name: "nearest-for-trilinear",
        advice: "samples take the value of the nearest node: interpolate between the eight nodes around them",
        edit: Edit::Classified(|scene| set(&mut scene.interpolation, Interpolation::Nearest)),
    },
    Mistake {
        name: "trilinear-for-nearest",
        advice: "samples are interpolated where the nearest node is asked for",
        edit: Edit::Classified(|scene| set(&mut scene.interpolation, Interpolation::Trilinear)),
    },
    Mistake {
        name: "step-doubled",
        advice: "samples are twice as far apart as the scene says",
        edit: Edit::Classified(|scene| {
            scene.step *= 2.0;
            !scene.is_continuous()
        }),
    },
    Mistake {
        name: "shading-left-out",
        advice: "samples are not shaded: Phong's model with the gradient of the density as normal is missing",
        edit: Edit::Classified(|scene| scene.phong.take().is_some()),
    },
    Mistake {
        name: "ambient-left-out",
        advice: "sides that face away from the light are black: the ambient term is missing",
        edit: Edit::Classified(|scene| shaded(scene, |phong| set(&mut phong.ambient, 0.0))),
    },
    Mistake {
        name: "diffuse-left-out",
        advice: "the diffuse term is missing or has the wrong sign: the normal is minus the gradient, so that it points out of the dense region",
        edit: Edit::Classified(|scene| shaded(scene, |phong| set(&mut phong.diffuse, 0.0))),
    },
    Mistake {
        name: "specular-left-out",
        advice: "highlights are missing: the specular term of Phong's model",
        edit: Edit::Classified(|scene| shaded(scene, |phong| set(&mut phong.specular, 0.0))),
    },
    Mistake {
        name: "highlight-too-wide",
        advice: "highlights are too wide: the exponent is that of Phong's model, of the reflected ray; with the halfway vector of Blinn's it must be about four times as large",
        edit: Edit::Classified(|scene| {
            shaded(scene, |phong| {
                let is_seen = phong.shininess >= 4 && phong.specular != 0.0;
                let quarter = phong.shininess / 4;
                is_seen && set(&mut phong.shininess, quarter)
            })
        }),
    },
    Mistake {
        name: "gradient-by-the-ray-step",
        advice: "the normal follows the view: differences for the gradient are taken along each axis over a spacing of the grid, not over the components of the ray's step",
        edit: Edit::Classified(|scene| {
            scene.phong.is_some() && set(&mut scene.conventions.gradient, Gradient::RayStep)
        }),
    },
    Mistake {
        name: "transmittance-before-the-sum",
        advice: "the transmittance is updated before the colour of a sample is added: a sample is seen through those before it, not through itself",
        edit: Edit::Classified(|scene| {
            !scene.is_continuous() && set(&mut scene.conventions.own_transmittance, true)
        }),
    },
    Mistake {
        name: "samples-premultiplied-twice",
        advice: "the colour of each sample is multiplied by its opacity twice: do so in the table or in the loop, not in both",
        edit: Edit::Classified(|scene| {
            !scene.is_continuous() && set(&mut scene.conventions.own_opacity, true)
        }),
    },
    Mistake {
        name: "light-at-the-eye",
        advice: "the light is at the eye: its position is given by the scene",
        edit: Edit::Classified(|scene| {
            let occurs = scene.phong.is_some() || scene.shadow.is_some();
            scene.light = scene.camera.eye();
            occurs
        }),
    },
    Mistake {
        name: "shadow-left-out",
        advice: "the volume casts no shadow on itself: each sample is darkened by what lies between it and the light",
        edit: Edit::Classified(|scene| scene.shadow.take().is_some()),
    },
    Mistake {
        name: "shadow-hundredfold",
        advice: "shadows are far too dark: the sum of densities is divided by 100 before exp(-S)",
        edit: Edit::Classified(|scene| {
            shadowed(scene, |shadow| {
                let hundredth = 0.01 * shadow.reference_step;
                set(&mut shadow.reference_step, hundredth)
            })
        }),
    },
    Mistake {
        name: "shadow-step-not-counted",
        advice: "shadows depend on the step: the sum towards the light counts densities times step over reference step",
        edit: Edit::Classified(|scene| {
            shadowed(scene, |shadow| set(&mut shadow.reference_step, shadow.step))
        }),
    },
    Mistake {
        name: "lookups-half-voxel-on",
        advice: "values are looked up half a voxel beside the sample, towards larger coordinates, in a box that is in its place: texture coordinates are (u + 1/2)/n for node coordinates u, once",
        edit: Edit::Classified(|scene| looked_up(scene, Lookup::HalfOn)),
    },
    Mistake {
        name: "lookups-half-voxel-back",
        advice: "values are looked up half a voxel beside the sample, towards smaller coordinates, in a box that is in its place: texture coordinates are (u + 1/2)/n for node coordinates u, not u/n",
        edit: Edit::Classified(|scene| looked_up(scene, Lookup::HalfBack)),
    },
    Mistake {
        name: "transform-ignored",
        advice: "the volume stands where its grid would be without a map: apply the transform of the scene, after that of the file",
        edit: Edit::Classified(|scene| scene.to_world.take().is_some()),
    },
    Mistake {
        name: "transform-inverted",
        advice: "the volume is placed by the inverse of its map: points go to the world by the matrix, rays into the volume by its inverse; is it stored by rows or by columns?",
        edit: Edit::Classified(|scene| {
            let inverse = scene.to_world.map(|map| map.inverse());
            inverse.is_some() && set(&mut scene.to_world, inverse)
        }),
    },
    Mistake {
        name: "normals-not-inverse-transposed",
        advice: "normals are mapped as vectors are: gradients go to the world by the transpose of the inverse matrix",
        edit: Edit::Classified(|scene| {
            scene.to_world.is_some()
                && scene.phong.is_some()
                && set(
                    &mut scene.conventions.normal_transform,
                    NormalTransform::Vector,
                )
        }),
    },
    Mistake {
        name: "normals-not-turned",
        advice: "normals stay as they are in the volume while it turns: gradients go to the world by the transpose of the inverse matrix",
        edit: Edit::Classified(|scene| {
            scene.to_world.is_some()
                && scene.phong.is_some()
                && set(
                    &mut scene.conventions.normal_transform,
                    NormalTransform::None,
                )
        }),
    },
    Mistake {
        name: "step-in-volume-space",
        advice: "steps are measured in the volume's own coordinates: distances along a ray, and with them opacities, are those of the world, whatever the map does to them",
        edit: Edit::Classified(|scene| {
            scene.conventions.nominal_opacity = true;
            scene.to_world.is_some()
                && !scene.is_continuous()
                && set(&mut scene.conventions.step_length, StepLength::Volume)
        }),
    },
    Mistake {
        name: "colours-reversed",
        advice: "colours are those of the other end of the map: density 0 has its first colour",
        edit: Edit::Classified(|scene| coloured(scene, Colormap::reversed)),
    },
    Mistake {
        name: "colours-left-out",
        advice: "the volume has no colour: map densities to colours by the scene's colour map",
        edit: Edit::Classified(|scene| {
            coloured(scene, |_| Colormap::named("white").expect("a map of ours"))
        }),
    },
    Mistake {
        name: "one-colour",
        advice: "all samples have one colour, that of the first point of the transfer function: look colours up as opacities are",
        edit: Edit::Classified(|scene| {
            let Appearance::Points(points) = &scene.transfer_function.appearance else {
                return false;
            };
            let mut all = points.points().to_vec();
            let first = all[0].colour;
            all.iter_mut().for_each(|point| point.colour = first);
            let one = TransferPoints::new(all).map(Appearance::Points);
            let is_seen = scene.mode == Mode::Composited;
            is_seen && one.is_ok_and(|one| set(&mut scene.transfer_function.appearance, one))
        }),
    },
    Mistake {
        name: "strength-left-out",
        advice: "the light of a sample is not multiplied by the square of its density",
        edit: Edit::Classified(|scene| strengthened(scene, |_| 1.0)),
    },
    Mistake {
        name: "strength-linear",
        advice: "the light of a sample is multiplied by its density instead of its square",
        edit: Edit::Classified(|scene| strengthened(scene, |density| density)),
    },
    Mistake {
        name: "background-white",
        advice: "the background behind the volume is white: the scene gives its colour",
        edit: Edit::Classified(|scene| set(&mut scene.background, DVec3::ONE)),
    },
    Mistake {
        name: "background-black",
        advice: "the background behind the volume is black, or was left out: the scene gives its colour; colours that leave it out are declared with --alpha",
        edit: Edit::Classified(|scene| set(&mut scene.background, DVec3::ZERO)),
    },
    Mistake {
        name: "viewed-too-wide",
        advice: "the field of view is about twice as wide as it should be: vertical_fov is the full angle from the top to the bottom edge, so the image plane ends at tan(fov / 2)",
        edit: Edit::Classified(|scene| {
            // Wider than that there is no image.
            let angle = (2.0 * scene.camera.vertical_fov()).min(3.0);
            scene.camera = scene.camera.with_vertical_fov(angle);
            !scene.camera.is_orthographic()
        }),
    },
];

/// Another reference length, from the old one and the step. Only composited samples have one.
fn referred(scene: &mut Classified, edit: fn(f64, f64) -> f64) -> bool {
    if scene.mode != Mode::Composited {
        return false;
    }
    let length = &mut scene.transfer_function.reference_length;
    let new = edit(*length, scene.step);
    new.is_normal() && set(length, new)
}

fn looked_up(scene: &mut Classified, lookup: Lookup) -> bool {
    !scene.is_continuous() && set(&mut scene.conventions.lookup, lookup)
}

fn eye_is_inside(scene: &Classified) -> bool {
    let extent = scene.extent();
    let eye = extent.to_volume(scene.camera.eye());
    eye.clamp(extent.bounds.min, extent.bounds.max) == eye
}

fn shaded(scene: &mut Classified, edit: fn(&mut Phong) -> bool) -> bool {
    scene.phong.as_mut().is_some_and(edit)
}

fn shadowed(scene: &mut Classified, edit: fn(&mut Shadow) -> bool) -> bool {
    scene.shadow.as_mut().is_some_and(edit)
}

fn coloured(scene: &mut Classified, edit: fn(&Colormap) -> Colormap) -> bool {
    match &mut scene.transfer_function.appearance {
        Appearance::Formula { colormap, .. } if scene.mode.uses_transfer_function() => {
            set(colormap, edit(colormap))
        }
        _ => false,
    }
}

/// Points of the table that stands in for the formula: between them its curves are straight to
/// 1e-7.
const POINTS: usize = 4096;

/// The formula with another factor on the light of a sample, as a table of points. A volume shadow
/// would be one of opacities then, so scenes that have one are left alone.
fn strengthened(scene: &mut Classified, strength: fn(f64) -> f64) -> bool {
    let transfer_function = &scene.transfer_function;
    let is_table = matches!(transfer_function.appearance, Appearance::Points(_));
    if scene.shadow.is_some() || is_table || scene.mode != Mode::Composited {
        return false;
    }
    let most = scene.grid.range().1;
    let point = |index: usize| {
        let value = most * index as f64 / (POINTS - 1) as f64;
        TransferPoint {
            value,
            colour: transfer_function.colour(value) * strength(value),
            opacity: transfer_function.reference_opacity(value),
        }
    };
    let Ok(points) = TransferPoints::new((0..POINTS).map(point).collect()) else {
        return false;
    };
    scene.transfer_function.appearance = Appearance::Points(points);
    true
}
