//! Layers between two planes: a wide box stands for one.

use super::requirements::{any_order, only_homogeneous, require, without_lights};
use crate::geometry::{Aabb, Boundary, Emitter, Luminous, Ray, Rectangle, Shape, Surface};
use crate::math::quadrature::Integral;
use crate::optics::{Coefficients, Material, Sides};
use crate::scene::Radiative;
use glam::DVec3;

/// Mean free paths, at least, from where a ray enters to the sides of the box. Light from there is
/// fainter than e^(−30) = 1e-13.
const SIDES: f64 = 30.0;

/// A homogeneous layer that scatters isotropically any number of times, below or above the eye.
#[derive(Clone, Debug)]
pub struct PlaneLayer {
    min: DVec3,
    max: DVec3,
    /// Perpendicular to its faces: that in which the box is thinnest.
    axis: usize,
    /// The coordinate of the face on the eye's side, and that of the other end: the other face, or
    /// what stands in the box.
    face: f64,
    end: f64,
    /// The coefficients.
    pub coefficients: Coefficients,
    /// Emission, per unit of length.
    pub emission: DVec3,
    /// Radiance of the plane at the back of the layer, which reflects none; `None` where the environment is there.
    pub back: Option<DVec3>,
}

impl PlaneLayer {
    /// The layer of a scene.
    pub fn of(scene: &Radiative) -> Result<PlaneLayer, String> {
        any_order(scene)?;
        without_lights(scene)?;
        let (body, medium) = only_homogeneous(scene)?;
        require(
            medium.phase.is_isotropic(),
            "the formula is for isotropic scattering",
        )?;
        let Some(Boundary::Box(bounds)) = &body.boundary else {
            return Err("its medium is not a `box`".to_owned());
        };
        let size = bounds.size();
        let axis = (0..3)
            .min_by(|&a, &b| size[a].total_cmp(&size[b]))
            .expect("three axes");
        let (min, max) = (bounds.min, bounds.max);
        let eye = scene.camera.eye[axis];
        let (face, far_face) = if eye >= max[axis] {
            (max[axis], min[axis])
        } else if eye <= min[axis] {
            (min[axis], max[axis])
        } else {
            return Err("the eye is in the layer".to_owned());
        };
        let (end, back) = match (&scene.objects[..], &scene.area_lights[..]) {
            ([], []) => (far_face, None),
            ([object], []) => {
                require(
                    object.material == Material::Diffuse(DVec3::ZERO),
                    "its surface is not black",
                )?;
                let Shape::Rectangle(plane) = &object.shape else {
                    return Err("its surface is not a `rectangle`".to_owned());
                };
                (height_of(plane, axis, min, max)?, Some(DVec3::ZERO))
            }
            ([], [lamp]) => {
                let Luminous::Rectangle(plane) = &lamp.shape else {
                    return Err("its lamp is not a `rectangle`".to_owned());
                };
                let towards_eye = plane.normal()[axis] * (face - far_face);
                require(
                    lamp.sides == Sides::Both || towards_eye > 0.0,
                    "its lamp shines away from the eye",
                )?;
                let height = height_of(plane, axis, min, max)?;
                (height, Some(lamp.radiance))
            }
            _ => return Err("it has more than one surface or lamp".to_owned()),
        };
        Ok(PlaneLayer {
            min,
            max,
            axis,
            face,
            end,
            coefficients: medium.coefficients,
            emission: medium.emission,
            back,
        })
    }

    /// Its thickness.
    pub fn thickness(&self) -> f64 {
        (self.face - self.end).abs()
    }

    /// The cosine at which `ray` enters through the face, far from the sides.
    pub fn cosine(&self, ray: &Ray) -> Result<f64, String> {
        let (origin, direction) = (ray.origin, *ray.direction);
        let inward = (self.end - self.face).signum();
        let cosine = direction[self.axis] * inward;
        require(cosine > 0.0, "the ray does not go into the layer")?;
        let entry = origin + direction * ((self.face - origin[self.axis]) / direction[self.axis]);
        let free_paths = self.coefficients.sigma_t().min_element();
        let far = (0..3).filter(|&axis| axis != self.axis).all(|axis| {
            let near_side = (entry[axis] - self.min[axis]).min(self.max[axis] - entry[axis]);
            near_side * free_paths >= SIDES
        });
        require(
            far,
            "the ray enters within 30 mean free paths of a side of the layer",
        )?;
        Ok(cosine)
    }

    /// The formula `radiance` of cosines from `least` on, as one of rays.
    pub fn along<'s>(
        self,
        least: f64,
        radiance: impl Fn(f64) -> Integral + 's,
    ) -> super::formula::AlongRay<'s> {
        Box::new(move |ray| {
            let cosine = self.cosine(ray)?;
            require(cosine >= least, "the ray is too nearly level")?;
            Ok(radiance(cosine))
        })
    }
}

/// The coordinate of `plane`, which has to cut the box from `min` to `max` all across.
fn height_of(plane: &Rectangle, axis: usize, min: DVec3, max: DVec3) -> Result<f64, String> {
    let Aabb {
        min: low,
        max: high,
    } = plane.bounds();
    let height = low[axis];
    let is_level = low[axis] == high[axis];
    // A parallelogram, or a rectangle that is turned, is smaller than the box around it.
    let sides = (0..3).filter(|&other| other != axis);
    let around: f64 = sides.map(|other| high[other] - low[other]).product();
    let is_upright = (plane.area() / around - 1.0).abs() < 1e-12;
    let covers = (0..3)
        .filter(|&other| other != axis)
        .all(|other| low[other] <= min[other] && high[other] >= max[other]);
    require(
        is_level && is_upright && covers && min[axis] < height && height < max[axis],
        "its surface does not cut the layer all across",
    )?;
    Ok(height)
}
