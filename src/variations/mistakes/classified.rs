//! Mistakes in ray casters of classified volumes.

use super::{Edit, Mistake, makes, replaced, set};
use crate::geometry::length_of;
use crate::optics::{Appearance, Colormap, Phong, TransferPoint, TransferPoints};
use crate::scene::{Classified, Fault, Gradient, Mode, Shadow, StepLength};
use crate::volume::Interpolation;
use glam::DVec3;

pub(super) const MISTAKES: &[Mistake] = mistakes! {
    "opacity-uncorrected" => Classified(|scene| referred(scene, |_, step| step)),
        "the opacity of a sample does not depend on the step: opacity is stated over a reference length h0, so over a step h it is 1 - (1 - a)^(h / h0)";
    "opacity-exponent-inverted" => Classified(|scene| referred(scene, |reference, step| step * step / reference)),
        "the exponent of the opacity correction is inverted: it is step / reference length";
    "opacity-halved" => Classified(|scene| referred(scene, |reference, _| 2.0 * reference)),
        "the volume is too thin, as though opacities were stated over twice their reference length: how long is a voxel?";
    "opacity-doubled" => Classified(|scene| referred(scene, |reference, _| 0.5 * reference)),
        "the volume is too dense, as though opacities were stated over half their reference length: how long is a voxel?";
    "opacity-corrected-twice" => Classified(|scene| referred(scene, |reference, step| reference * reference / step)),
        "opacities are corrected for the step once more after they were: the exponent is step / reference length, once";
    "unit-distance-of-zero" => Classified(|scene| {
        referred(scene, |reference, _| reference * f64::EPSILON * f64::EPSILON)
    }),
        "all that is not transparent is opaque, as though opacities were stated over no length: the unit distance is not 0";
    "colours-added" => Classified(|scene| makes(scene, !scene.continuous, Fault::ColoursAdded)),
        "the colours of samples are added, whatever lies before them: each is multiplied by the transmittance of the samples in front of it";
    "rays-end-too-soon" => Classified(|scene| {
        let edges = scene.extent().edges().map(length_of);
        let steps = edges.into_iter().fold(0.0, f64::max) / scene.step;
        let occurs = !scene.continuous && (0.5..1e7).contains(&steps);
        makes(scene, occurs, Fault::MostSteps(steps.round() as u32))
    }),
        "rays end after as many steps as the longest edge of the volume takes: a diagonal takes up to 1.7 times as many";
    "samples-behind-the-eye" => Classified(|scene| {
        makes(scene, !scene.continuous && eye_is_inside(scene), Fault::BeginsBehindEye)
    }),
        "with the eye inside the volume rays begin behind it, where their line enters the box: they begin at the eye, at t = 0";
    "transparency-not-normalised" => Opacity(|opacity| set(&mut opacity.floor, 0.0)),
        "transparency is exp(-d^2) as it stands: subtract the floor and divide by what is left, so that it falls from 1 to 0";
    "transparency-floor-too-high" => Opacity(|opacity| set(&mut opacity.floor, 0.5)),
        "the volume turns opaque too early: the floor of the transparency is not the one that the scene gives";
    "nearest-for-trilinear" => Classified(|scene| set(&mut scene.interpolation, Interpolation::Nearest)),
        "samples take the value of the nearest node: interpolate between the eight nodes around them";
    "trilinear-for-nearest" => Classified(|scene| set(&mut scene.interpolation, Interpolation::Trilinear)),
        "samples are interpolated where the nearest node is asked for";
    "step-doubled" => Classified(|scene| {
        scene.step *= 2.0;
        !scene.continuous
    }),
        "samples are twice as far apart as the scene says";
    "shading-left-out" => Classified(|scene| scene.phong.take().is_some()),
        "samples are not shaded: Phong's model with the gradient of the density as normal is missing";
    "ambient-left-out" => Classified(|scene| shaded(scene, |phong| set(&mut phong.ambient, 0.0))),
        "sides that face away from the light are black: the ambient term is missing";
    "diffuse-left-out" => Classified(|scene| shaded(scene, |phong| set(&mut phong.diffuse, 0.0))),
        "the diffuse term is missing or has the wrong sign: the normal is minus the gradient, so that it points out of the dense region";
    "specular-left-out" => Classified(|scene| shaded(scene, |phong| set(&mut phong.specular, 0.0))),
        "highlights are missing: the specular term of Phong's model";
    "highlight-too-wide" => Classified(|scene| {
        shaded(scene, |phong| {
            let is_seen = phong.shininess >= 4 && phong.specular != 0.0;
            let quarter = phong.shininess / 4;
            is_seen && set(&mut phong.shininess, quarter)
        })
    }),
        "highlights are too wide: the exponent is that of Phong's model, of the reflected ray; with the halfway vector of Blinn's it must be about four times as large";
    "gradient-by-the-ray-step" => Classified(|scene| {
        scene.phong.is_some() && set(&mut scene.conventions.gradient, Gradient::RayStep)
    }),
        "the normal follows the view: differences for the gradient are taken along each axis over a spacing of the grid, not over the components of the ray's step";
    "transmittance-before-the-sum" => Classified(|scene| {
        !scene.continuous && set(&mut scene.conventions.own_transmittance, true)
    }),
        "the transmittance is updated before the colour of a sample is added: a sample is seen through those before it, not through itself";
    "samples-premultiplied-twice" => Classified(|scene| {
        !scene.continuous && set(&mut scene.conventions.own_opacity, true)
    }),
        "the colour of each sample is multiplied by its opacity twice: do so in the table or in the loop, not in both";
    "light-at-the-eye" => Classified(|scene| {
        let occurs = scene.phong.is_some() || scene.shadow.is_some();
        scene.light = scene.camera.eye;
        occurs
    }),
        "the light is at the eye: its position is given by the scene";
    "shadow-left-out" => Classified(|scene| scene.shadow.take().is_some()),
        "the volume casts no shadow on itself: each sample is darkened by what lies between it and the light";
    "shadow-hundredfold" => Classified(|scene| {
        shadowed(scene, |shadow| {
            let hundredth = 0.01 * shadow.reference_step;
            set(&mut shadow.reference_step, hundredth)
        })
    }),
        "shadows are far too dark: the sum of densities is divided by 100 before exp(-S)";
    "shadow-step-not-counted" => Classified(|scene| {
        shadowed(scene, |shadow| set(&mut shadow.reference_step, shadow.step))
    }),
        "shadows depend on the step: the sum towards the light counts densities times step over reference step";
    "lookups-half-voxel-on" => Classified(|scene| makes(scene, !scene.continuous, Fault::LookedUpOn)),
        "values are looked up half a voxel beside the sample, towards larger coordinates, in a box that is in its place: texture coordinates are (u + 1/2)/n for node coordinates u, once";
    "lookups-half-voxel-back" => Classified(|scene| makes(scene, !scene.continuous, Fault::LookedUpBack)),
        "values are looked up half a voxel beside the sample, towards smaller coordinates, in a box that is in its place: texture coordinates are (u + 1/2)/n for node coordinates u, not u/n";
    "transform-ignored" => Classified(|scene| scene.to_world.take().is_some()),
        "the volume stands where its grid would be without a map: apply the transform of the scene, after that of the file";
    "transform-inverted" => Classified(|scene| {
        let inverse = scene.to_world.map(|map| map.inverse());
        inverse.is_some() && set(&mut scene.to_world, inverse)
    }),
        "the volume is placed by the inverse of its map: points go to the world by the matrix, rays into the volume by its inverse; is it stored by rows or by columns?";
    "normals-not-inverse-transposed" => Classified(|scene| {
        makes(scene, scene.to_world.is_some() && scene.phong.is_some(), Fault::GradientsAsVectors)
    }),
        "normals are mapped as vectors are: gradients go to the world by the transpose of the inverse matrix";
    "normals-not-turned" => Classified(|scene| {
        makes(scene, scene.to_world.is_some() && scene.phong.is_some(), Fault::GradientsUnmapped)
    }),
        "normals stay as they are in the volume while it turns: gradients go to the world by the transpose of the inverse matrix";
    "step-in-volume-space" => Classified(|scene| {
        scene.conventions.nominal_opacity = true;
        scene.to_world.is_some() && !scene.continuous
            && set(&mut scene.conventions.step_length, StepLength::Volume)
    }),
        "steps are measured in the volume's own coordinates: distances along a ray, and with them opacities, are those of the world, whatever the map does to them";
    "colours-reversed" => Classified(|scene| coloured(scene, Colormap::reversed)),
        "colours are those of the other end of the map: density 0 has its first colour";
    "colours-left-out" => Classified(|scene| coloured(scene, |_| Colormap::named("white").expect("a map of ours"))),
        "the volume has no colour: map densities to colours by the scene's colour map";
    "one-colour" => Classified(|scene| {
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
        "all samples have one colour, that of the first point of the transfer function: look colours up as opacities are";
    "strength-left-out" => Classified(|scene| strengthened(scene, |_| 1.0)),
        "the light of a sample is not multiplied by the square of its density";
    "strength-linear" => Classified(|scene| strengthened(scene, |density| density)),
        "the light of a sample is multiplied by its density instead of its square";
    "background-white" => Classified(|scene| set(&mut scene.background, DVec3::ONE)),
        "the background behind the volume is white: the scene gives its colour";
    "background-black" => Classified(|scene| set(&mut scene.background, DVec3::ZERO)),
        "the background behind the volume is black, or was left out: the scene gives its colour; colours that leave it out are declared with --alpha";
    "viewed-too-wide" => Classified(|scene| {
        // Wider than that there is no image.
        let angle = (2.0 * scene.camera.vertical_fov()).min(3.0);
        scene.camera = scene.camera.with_vertical_fov(angle);
        !scene.camera.is_orthographic
    }),
        "the field of view is about twice as wide as it should be: vertical_fov is the full angle from the top to the bottom edge, so the image plane ends at tan(fov / 2)";
    "perspective-for-parallel" => Classified(|scene| scene.camera.is_orthographic && projected_otherwise(scene)),
        "rays come together in the eye where the scene asks for parallel ones: orthographic_height is the height of the image, world units, and rays begin in the plane of the eye";
    "parallel-for-perspective" => Classified(|scene| !scene.camera.is_orthographic && projected_otherwise(scene)),
        "rays are parallel where the scene asks for rays from the eye: what is nearer is larger, by the angle vertical_fov";
};

/// The other projection, by which the plane through the centre of the volume looks the same, as in viewers that have a
/// switch for it. Not where the eye is among the volume: parallel rays would begin within it.
fn projected_otherwise(scene: &mut Classified) -> bool {
    let centre = scene.extent().world_bounds().centre();
    let depth = (centre - scene.camera.eye).dot(*scene.camera.axis);
    let is_before = depth > 0.5 * scene.diagonal();
    let other = is_before.then(|| scene.camera.with_other_projection(depth));
    other.is_some_and(|other| set(&mut scene.camera, other))
}

/// Another reference length, from the old one and the step. Only composited samples have one.
fn referred(scene: &mut Classified, edit: fn(f64, f64) -> f64) -> bool {
    if scene.mode != Mode::Composited {
        return false;
    }
    let length = &mut scene.transfer_function.reference_length;
    let new = edit(*length, scene.step);
    new.is_normal() && set(length, new)
}

fn eye_is_inside(scene: &Classified) -> bool {
    let extent = scene.extent();
    let eye = extent.to_volume(scene.camera.eye);
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
    let [least, most] = transfer_function.domain(scene.grid.range().1);
    let point = |index: usize| {
        let value = least + (most - least) * index as f64 / (POINTS - 1) as f64;
        TransferPoint {
            value,
            colour: transfer_function.colour(value) * strength(transfer_function.density(value)),
            opacity: transfer_function.reference_opacity(value),
        }
    };
    let points = TransferPoints::new((0..POINTS).map(point).collect());
    let new = points.ok().map(Appearance::Points);
    replaced(&mut scene.transfer_function.appearance, new)
}
