//! Path guiding: part of the directions at collisions is sampled towards area lights.
//!
//! Direct light is connected to. By its direction a path has to find light that was scattered before,
//! and fog is brightest around a lamp: few paths go there, and each of them returns much. So a direction
//! is sampled by the phase function or by a [`Lobe`] towards a lamp, and its density is that of both
//! together, so that no weight is larger than one over the share of the phase function.
//!
//! Sources: Veach 1997, thesis, ch. 9, for one sample of several densities; Herholz et al. 2019, "Volume
//! path guiding based on zero-variance random walk theory", ACM TOG 38(3).

use crate::geometry::{Direction, Emitter, Surface};
use crate::math::sampling::Lobe;
use crate::optics::{Light, Sides};
use crate::scene::{AreaLight, Radiative};
use glam::DVec3;
use std::f64::consts::PI;

/// Share of the directions at an isotropic collision that is sampled towards area lights, where there
/// are no others. Error squared times time in rooms of fog with a lamp, over that of 0: of 0.3 it is
/// 0.66 to 0.88, of 0.5 it is 0.62 to 0.88, of 0.65 it is 0.64 to 0.93.
const MOST: f64 = 0.5;

/// The lights of a scene, as far as paths are guided by them.
#[derive(Debug)]
pub struct Guiding {
    /// Area lights in media that scatter: around others there is no light to be found.
    targets: Vec<Target>,
    /// Other lights at a point, and their mean intensity over all directions.
    others: Vec<(DVec3, f64)>,
    /// Fluence of the lights that are the same everywhere.
    everywhere: f64,
}

/// An area light.
#[derive(Debug)]
struct Target {
    centre: DVec3,
    /// Root of the mean squared distance of its surface from the centre.
    size: f64,
    /// Fluence times squared distance, its mean over all directions.
    intensity: f64,
}

impl Target {
    fn lobe(&self, point: DVec3) -> Option<Lobe> {
        Lobe::new(self.centre - point, self.size)
    }

    /// Fluence at `point`, as if nothing stood between.
    fn fluence(&self, point: DVec3) -> f64 {
        self.intensity / ((self.centre - point).length_squared() + self.size * self.size)
    }
}

impl Guiding {
    /// The lights of `scene`.
    pub fn new(scene: &Radiative) -> Guiding {
        let in_fog = scene.area_lights.iter().filter(|it| is_in_fog(it, scene));
        let targets = in_fog.map(|light| {
            let extent = light.shape.extent();
            let sides = match light.sides {
                Sides::Front => 1.0,
                Sides::Both => 2.0,
            };
            Target {
                centre: extent.centre,
                size: extent.spread.sqrt(),
                // A surface shows a quarter of its area, or two, in the mean over all directions.
                intensity: mean(light.radiance) * light.shape.area() * (sides / 4.0),
            }
        });
        let usable = |it: &Target| it.size > 0.0 && it.intensity > 0.0 && it.intensity.is_finite();
        let mut everywhere = 4.0 * PI * mean(scene.environment);
        let mut others = vec![];
        for light in &scene.lights {
            let strength = mean(light.strength());
            match light {
                Light::Point(point) => others.push((point.position, strength)),
                Light::Spot(spot) => {
                    let solid_angle = 2.0 * PI * (1.0 - spot.cos_outer);
                    others.push((spot.position, strength * solid_angle / (4.0 * PI)));
                }
                Light::Directional(_) => everywhere += strength,
            }
        }
        Guiding {
            targets: targets.filter(usable).collect(),
            others,
            everywhere,
        }
    }

    /// The lights as they guide paths from `point`, where the phase function has the mean cosine
    /// `mean_cosine`: one that is not isotropic has directions of its own.
    pub fn at(&self, point: DVec3, mean_cosine: f64) -> Option<Guide<'_>> {
        if self.targets.is_empty() {
            return None;
        }
        let fluence = self.targets.iter().map(|target| target.fluence(point));
        let fluence: f64 = fluence.sum();
        let others = self.others.iter();
        let others = others.map(|(at, intensity)| intensity / (*at - point).length_squared());
        let share = fluence / (fluence + others.sum::<f64>() + self.everywhere);
        let is_seen = fluence > 0.0 && fluence.is_finite() && share > 0.0;
        is_seen.then(|| Guide {
            targets: &self.targets,
            point,
            fluence,
            share: MOST * (1.0 - mean_cosine.abs()) * share,
        })
    }
}

/// Path guiding at a point.
#[derive(Clone, Copy, Debug)]
pub struct Guide<'g> {
    targets: &'g [Target],
    point: DVec3,
    /// Fluence of all targets.
    fluence: f64,
    share: f64,
}

/// The density that a direction is sampled from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// The phase function.
    Phase,
    /// A lobe towards an area light, by [`Guide::sample`].
    Guide,
}

impl Guide<'_> {
    /// The technique for a number in [0, 1), and what is left of the number, again in [0, 1).
    pub fn technique(&self, u: f64) -> (Technique, f64) {
        if u < self.share {
            (Technique::Guide, u / self.share)
        } else {
            // The largest number may round to 1.
            let rest = (u - self.share) / (1.0 - self.share);
            (Technique::Phase, rest.min(1.0 - f64::EPSILON / 2.0))
        }
    }

    /// A direction towards one of the lights, by two numbers in [0, 1).
    pub fn sample(&self, [u, v]: [f64; 2]) -> Option<Direction> {
        let mut left = u * self.fluence;
        let mut chosen = None;
        for target in self.targets {
            let fluence = target.fluence(self.point);
            if fluence > 0.0 {
                chosen = Some((target, (left / fluence).min(1.0)));
                if left < fluence {
                    break;
                }
                left -= fluence;
            }
        }
        let (target, u) = chosen?;
        Some(target.lobe(self.point)?.sample([u, v]))
    }

    /// Density of a direction by both techniques, per steradian; `by_phase` is that of the phase
    /// function.
    pub fn pdf(&self, direction: Direction, by_phase: f64) -> f64 {
        let lobes = self.targets.iter().filter_map(|target| {
            let lobe = target.lobe(self.point)?;
            Some(target.fluence(self.point) * lobe.pdf(direction))
        });
        let towards_lights = lobes.sum::<f64>() / self.fluence;
        (1.0 - self.share) * by_phase + self.share * towards_lights
    }
}

/// The boxes around `light` and around a medium that scatters overlap.
fn is_in_fog(light: &AreaLight, scene: &Radiative) -> bool {
    let bounds = light.shape.bounds();
    let scattering = scene.media.iter();
    let mut scattering = scattering.filter(|it| it.medium.coefficients.sigma_s() != DVec3::ZERO);
    scattering.any(|body| {
        let fog = body.boundary.as_ref().map(Surface::bounds);
        fog.is_none_or(|fog| fog.touches(&bounds))
    })
}

fn mean(rgb: DVec3) -> f64 {
    rgb.element_sum() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Moments;
    use crate::math::rng::{Purpose, Stream};
    use crate::math::sampling::{sphere, sphere_pdf};
    use crate::scene::{Model, Scene};
    use std::path::Path;

    fn guiding(lights: &str) -> Guiding {
        let text = format!("[camera]\neye = [0, 0, -9]\ntarget = [0, 0, 0]\n[radiative]\n{lights}");
        let scene = Scene::parse(&text, Path::new("lights.toml")).unwrap();
        match &scene.panels[0].model {
            Model::Radiative(radiative) => Guiding::new(radiative),
            _ => panic!("no surfaces"),
        }
    }

    const LAMPS: &str = "
        [[radiative.medium]]
        box = { min = [-1, -2, -1], max = [4, 4, 4] }
        sigma_s = 0.1
        [[radiative.surface]]
        sphere = { centre = [0, 3, 0], radius = 0.5 }
        emitter = { radiance = 4 }
        [[radiative.surface]]
        rectangle = { corner = [2, 0, 0], edge_u = [0, 1, 0], edge_v = [0, 0, 2] }
        emitter = { radiance = [1, 2, 9], sides = \"both\" }";

    /// The density integrates to 1, and directions have the mean of their density, within four
    /// standard errors.
    #[test]
    fn directions_have_their_density() {
        let guiding = guiding(LAMPS);
        let guide = guiding.at(DVec3::new(0.5, -1.0, 1.0), 0.0).unwrap();
        let pdf = |direction| guide.pdf(direction, sphere_pdf());
        let (mut whole, mut expected, mut sampled) = Default::default();
        let add = |moments: &mut Moments, value| moments.add(value);
        for index in 0..1 << 15 {
            let numbers = Stream::new(3, 0, index);
            let any = sphere(numbers.pair(0, Purpose::Surface, 0));
            let density = pdf(any) / sphere_pdf();
            add(&mut whole, density);
            add(&mut expected, density * any.y);
            let [u, v] = numbers.pair(0, Purpose::PhaseDirection, 0);
            let direction = match guide.technique(u) {
                (Technique::Phase, u) => sphere([u, v]),
                (Technique::Guide, u) => guide.sample([u, v]).unwrap(),
            };
            add(&mut sampled, direction.y);
        }
        let error = |a: &Moments, b: &Moments| {
            let variance = |it: &Moments| it.variance_of_mean().unwrap_or(0.0);
            (a.mean() - b.mean()).abs() / (variance(a) + variance(b)).sqrt()
        };
        assert!(error(&whole, &[1.0].into_iter().collect()) < 4.0);
        assert!(error(&expected, &sampled) < 4.0);
    }

    /// Other light and an anisotropic phase function lower the share; a lamp beside the fog, or in one that
    /// only absorbs, has none.
    #[test]
    fn the_share_is_that_of_the_fluence_of_area_lights() {
        let point = DVec3::new(0.0, -1.0, 0.0);
        let share = |text: &str, g| guiding(text).at(point, g).map(|guide| guide.share);
        assert_eq!(share(LAMPS, 0.0), Some(0.5));
        assert_eq!(share(LAMPS, -0.6), Some(0.2));
        assert_eq!(share("environment = 1", 0.0), None);
        let beside = LAMPS.replace("max = [4, 4, 4]", "max = [1.5, 2.25, 4]");
        assert_eq!(share(&beside, 0.0), None);
        let clear = LAMPS.replace("sigma_s", "sigma_a");
        assert_eq!(share(&clear, 0.0), None);
        // A ball of fluence 4·π·0.25/16.25, beside an environment of 4π times its radiance.
        let ball = &LAMPS[..LAMPS
            .find("[[radiative.surface]]\n        rectangle")
            .unwrap()];
        let dim = share(&format!("environment = 0.015625\n{ball}"), 0.0).unwrap();
        let fluence = PI / 16.25;
        assert!((dim - 0.5 * fluence / (fluence + PI / 16.0)).abs() < 1e-15);
    }

    /// Both ends of the random range.
    #[test]
    fn what_is_left_of_a_number_stays_below_one() {
        let guiding = guiding(LAMPS);
        let last = 1.0 - f64::EPSILON / 2.0;
        for share in [0.5, 0.2, 1e-17] {
            let guide = Guide {
                share,
                ..guiding.at(DVec3::ZERO, 0.0).unwrap()
            };
            let (technique, rest) = guide.technique(last);
            assert!(technique == Technique::Phase && rest < 1.0);
            assert_eq!(guide.technique(0.0), (Technique::Guide, 0.0));
            assert!(guide.technique(share.next_down()).1 < 1.0);
            assert!(guide.sample([last, last]).unwrap().is_finite());
        }
    }
}
