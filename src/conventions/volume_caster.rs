//! Samples of one volume under conventions of other renderers: where its steps are, what a sample reads, and how it is
//! lit.

use super::classifier::Classifier;
use super::normals::{Gradients, NodeGradients};
use super::opacity;
use super::shading::ShadedSample;
use super::steps::{StepRule, Steps, StepsInParts, brick_faces, step_in_world};
use super::work::RayWork;
use crate::geometry::{Direction, Line, Ray, Span, length_of};
use crate::math::exp;
use crate::optics::{Appearance, Layer, Phong, over_length};
use crate::scene::{Classified, Fault, NormalSpace};
use crate::volume::{Cell, Centring, NodeLine, NodePoint, PlacedBox};
use glam::DVec3;
use std::borrow::Cow;

/// Samples one volume.
pub(super) struct VolumeCaster<'s> {
    /// The scene of the volume, with the values that its conventions store.
    scene: Cow<'s, Classified>,
    classifier: Classifier,
    /// The box that the volume fills.
    extent: PlacedBox,
    /// Depth along the view nearer than which nothing is seen.
    near_depth: f64,
    pub shading: Option<(Phong, Gradients)>,
}

/// A ray in the coordinates of the volume.
pub(super) struct Lines {
    /// In units of length.
    pub inside: Line,
    /// In nodes.
    pub nodes: NodeLine,
}

impl<'s> VolumeCaster<'s> {
    /// The caster of `scene`, shaded with gradients at nodes that are `known`; without them, which take time, unshaded.
    pub fn new(scene: Cow<'s, Classified>, known: Option<&NodeGradients>) -> VolumeCaster<'s> {
        let gradients = |phong| Some((phong, Gradients::of(&scene, known?)));
        VolumeCaster {
            shading: scene.phong.and_then(gradients),
            classifier: Classifier::of(&scene),
            extent: extent(&scene),
            near_depth: near_depth(&scene),
            scene,
        }
    }

    /// Number of gradients computed for the nodes.
    pub fn gradients_computed(&self) -> u64 {
        match &self.shading {
            Some((_, Gradients::Stored(_) | Gradients::World(_))) => {
                self.scene.grid.lattice().node_count() as u64
            }
            _ => 0,
        }
    }

    /// The steps of a ray along these lines over `span`.
    pub fn steps(&self, lines: &Lines, span: Span, rule: StepRule) -> StepsInParts {
        let (scene, lattice) = (&*self.scene, self.scene.grid.lattice());
        let measure = scene.conventions.step_length;
        let sizes = [lattice.spacing(), self.extent.bounds.size()];
        let longest = self.extent.edges().map(length_of);
        let longest = longest.into_iter().fold(0.0, f64::max);
        let lengths = [scene.voxel(), longest];
        let step = step_in_world(scene.step, measure, lines.inside.direction, sizes, lengths);
        let ends = [span.near, span.far].map(|t| lines.nodes.at(t).0);
        let cuts = match scene.conventions.fault {
            Some(Fault::StepsFromBricks(edge)) => brick_faces(span, ends, edge),
            _ => Vec::new(),
        };
        StepsInParts::new(span, step, rule, &cuts)
    }

    /// The sample at the distance `t` of `ray`, over this `length`; none where it is transparent.
    pub(super) fn sample(
        &self,
        ray: &Ray,
        lines: &Lines,
        t: f64,
        length: f64,
        work: &mut RayWork,
    ) -> Option<Layer> {
        let scene = &*self.scene;
        let (point, node_point) = (ray.at(t), lines.nodes.at(t));
        let looked_up = self.looked_up(node_point);
        let cell = Cell::around(scene.grid.lattice(), looked_up);
        let density = self.density(&cell, work);
        let look = self.classifier.look(scene, &cell, density);
        work.attenuations += u64::from(look.opacity != 0.0);
        let opacity = opacity::over(scene, look.opacity, length);
        if opacity == 0.0 {
            return None; // nothing to add, whatever its colour
        }
        work.emission_terms += 1;
        let visibility = self.visibility(point, node_point, work);
        let light = look.emission * visibility;
        let mut colour = match &self.shading {
            None => look.colour * light,
            Some((phong, gradients)) => {
                let (to_light, to_eye) = self.directions(point, node_point, ray);
                let sample = ShadedSample {
                    colour: look.colour,
                    gradient: self.gradient(gradients, lines.inside, looked_up, &cell, work),
                    to_light,
                    to_eye,
                };
                let shaded = sample.lit_by(phong, &scene.conventions);
                let lit = if scene.conventions.highlight_emission {
                    (shaded.base + shaded.highlight) * light
                } else {
                    shaded.base * light + shaded.highlight * visibility
                };
                if scene.conventions.shadowed_ambient {
                    lit
                } else {
                    lit + shaded.ambient * (look.emission - light)
                }
            }
        };
        if scene.conventions.clamped_samples {
            colour = colour.min(DVec3::ONE);
        }
        if scene.conventions.own_transmittance {
            colour *= 1.0 - opacity;
        }
        if scene.conventions.own_opacity {
            colour *= opacity;
        }
        Some(Layer::sample(colour * opacity, opacity))
    }

    /// The lines of `ray` in the coordinates of the volume.
    pub(super) fn lines(&self, ray: &Ray) -> Lines {
        let inside = self.extent.line(ray);
        Lines {
            inside,
            nodes: NodeLine::new(inside, self.scene.grid.lattice()),
        }
    }

    /// The part of `ray` within the volume.
    pub(super) fn span(&self, ray: &Ray) -> Option<Span> {
        let ahead = self.extent.span(ray)?;
        if self.scene.conventions.fault == Some(Fault::BeginsBehindEye) {
            let edges: f64 = self.extent.edges().map(length_of).into_iter().sum();
            let back = edges + length_of(ray.origin - self.centre());
            let from_behind = Ray::new(ray.origin - ray.direction * back, *ray.direction)?;
            let whole = self.extent.span(&from_behind)?;
            return Some(Span::new(whole.near - back, ahead.far));
        }
        behind(self.near_depth, ahead, ray, &self.scene)
    }

    /// The density in `cell`.
    pub(super) fn density(&self, cell: &Cell, work: &mut RayWork) -> f64 {
        work.density_lookups += 1;
        self.scene.interpolation.read(&*self.scene.grid, cell)
    }

    /// Cells to a distance between nodes, along each axis, if the scene takes nodes for the centres
    /// of cells that fill the volume.
    fn cells_per_spacing(&self) -> Option<DVec3> {
        let lattice = self.scene.grid.lattice();
        if !self.scene.conventions.cell_centred || lattice.centring() == Centring::Cells {
            return None;
        }
        let nodes = DVec3::from_array(lattice.nodes().map(|nodes| nodes as f64));
        Some(nodes / (nodes - 1.0).max(DVec3::ONE))
    }

    /// The point of the grid, in nodes, that is read at `point`.
    pub(super) fn looked_up(&self, point: NodePoint) -> NodePoint {
        let (fault, mut at) = (self.scene.conventions.fault, self.as_cells(point).0);
        match fault {
            Some(Fault::LookedUpOn) => at += 0.5,
            Some(Fault::LookedUpBack) => at -= 0.5,
            _ => {}
        }
        if let Some(bits) = self.scene.conventions.fraction_bits {
            let units = f64::from(1_u32 << bits);
            at = (at * units).round() / units;
        }
        if let Some(Fault::BricksWithoutNeighbours(edge)) = fault {
            let edge = f64::from(edge);
            // No farther than to the last node of the brick.
            let first = (at / edge).floor().max(DVec3::ZERO) * edge;
            at = at.min(first + (edge - 1.0));
        }
        NodePoint(at)
    }

    /// The point of the grid that lies at `point`, if nodes are taken for the centres of cells.
    fn as_cells(&self, point: NodePoint) -> NodePoint {
        let Some(cells) = self.cells_per_spacing() else {
            return point;
        };
        // In cells from the centre of the first; beyond the outermost centres nothing changes.
        let nodes = self.scene.grid.lattice().nodes();
        let last = nodes.map(|nodes| (nodes - 1) as f64);
        NodePoint((point.0 * cells - 0.5).clamp(DVec3::ZERO, last.into()))
    }

    /// Density gradient for shading, in any unit.
    pub(super) fn gradient(
        &self,
        gradients: &Gradients,
        line: Line,
        point: NodePoint,
        cell: &Cell,
        work: &mut RayWork,
    ) -> DVec3 {
        let step = line.direction * self.scene.step / self.scene.grid.lattice().spacing();
        let mut gradient = gradients.at(&self.scene, (point, step), cell, work);
        if let Some(cells) = self.cells_per_spacing() {
            gradient *= cells;
        }
        match self.scene.conventions.normal_space {
            NormalSpace::World => {}
            NormalSpace::Box => gradient *= self.scene.grid.lattice().bounds().size(),
            NormalSpace::EyeBox => return self.in_reverse_order(gradient),
        }
        match &self.scene.to_world {
            Some(map) if !gradients.are_of_the_world() => match self.scene.conventions.fault {
                Some(Fault::GradientsAsVectors) => map.vector(gradient),
                Some(Fault::GradientsUnmapped) => gradient,
                _ => map.gradient_map() * gradient,
            },
            _ => gradient,
        }
    }

    /// `gradient` by its components along the axes of the eye, to which the map of the volume, transposed, and its
    /// size are applied.
    fn in_reverse_order(&self, gradient: DVec3) -> DVec3 {
        let camera = &self.scene.camera;
        let axes = [
            camera.half_right.normalize(),
            camera.half_up.normalize(),
            -*camera.axis,
        ];
        let components = DVec3::from_array(axes.map(|axis| gradient.dot(axis)));
        let mapped = match &self.scene.to_world {
            Some(map) => DVec3::AXES.map(|axis| map.vector(axis).dot(components)),
            None => components.to_array(),
        };
        let size = self.scene.grid.lattice().bounds().size().to_array();
        (0..3).map(|at| axes[at] * (mapped[at] * size[at])).sum()
    }

    /// Directions to the light, `None` at the light itself, and to the eye.
    pub(super) fn directions(
        &self,
        point: DVec3,
        node_point: NodePoint,
        ray: &Ray,
    ) -> (Option<Direction>, Direction) {
        if !self.scene.conventions.texture_shading_point {
            return (Direction::of(self.to_light(point)), -ray.direction);
        }
        let lattice = self.scene.grid.lattice();
        let nodes = DVec3::from_array(lattice.nodes().map(|nodes| nodes as f64));
        let bounds = lattice.bounds();
        let point = bounds.min + (node_point.0 + 0.5) / nodes * bounds.size();
        let point = self.extent.in_world(point);
        let to_eye = Direction::of(ray.origin - point);
        (
            Direction::of(self.to_light(point)),
            to_eye.unwrap_or(-ray.direction),
        )
    }

    /// From `point`, or in parallel light from the centre of the volume, to the light for shading.
    fn to_light(&self, point: DVec3) -> DVec3 {
        let light = if self.scene.conventions.head_light {
            self.scene.camera.eye
        } else {
            self.scene.light
        };
        if self.scene.conventions.parallel_light {
            light - self.centre()
        } else {
            light - point
        }
    }

    /// The centre of the volume in the world.
    fn centre(&self) -> DVec3 {
        self.extent.in_world(self.extent.bounds.centre())
    }

    /// Visibility of the light from `point`; 1 where the scene has no shadow.
    fn visibility(&self, point: DVec3, node_point: NodePoint, work: &mut RayWork) -> f64 {
        let (scene, lattice) = (&*self.scene, self.scene.grid.lattice());
        let is_parallel = scene.conventions.parallel_light;
        let to_light = if is_parallel {
            scene.light - self.centre()
        } else {
            scene.light - point
        };
        let with_ray = |shadow| Some((shadow, Ray::new(point, to_light)?));
        let Some((shadow, ray)) = scene.shadow.and_then(with_ray) else {
            return 1.0;
        };
        let Some(inside) = self.extent.span(&ray) else {
            return 1.0;
        };
        work.shadow_rays += 1;
        let light = if is_parallel {
            f64::INFINITY
        } else {
            length_of(to_light)
        };
        let span = Span::new(0.0, inside.far.min(light));
        // Not from `point`: far from the world's origin its node coordinates have lost digits.
        let line = NodeLine::from(node_point, self.extent.line(&ray).direction, lattice);
        let rule = StepRule::at(scene.conventions.shadow_sample);
        let steps = Steps::new(span, shadow.step, rule);
        let samples = (0..steps.count).map(|index| {
            let (t, length) = steps.sample(index);
            let cell = Cell::around(lattice, self.looked_up(line.at(t)));
            (self.density(&cell, work), length)
        });
        match &scene.transfer_function.appearance {
            Appearance::Formula { .. } => {
                let sum: f64 = samples
                    .map(|(value, length)| scene.transfer_function.density(value) * length)
                    .sum();
                exp(-(sum / shadow.reference_step) / 100.0).min(1.0)
            }
            Appearance::Points(points) => samples
                .map(|(density, length)| {
                    1.0 - over_length(points.opacity(density), length / shadow.reference_step)
                })
                .product(),
        }
    }
}

/// Depth of the near plane of `scene`, by the farthest corner of its volume.
pub(super) fn near_depth(scene: &Classified) -> f64 {
    if scene.conventions.near_plane == 0.0 {
        return 0.0; // however far a corner is
    }
    let (camera, extent) = (&scene.camera, voxel_extent(scene));
    let depth = |corner| (extent.in_world(corner) - camera.eye).dot(*camera.axis);
    let depths = extent.bounds.corners().map(depth);
    scene.conventions.near_plane * depths.into_iter().fold(0.0, f64::max)
}

/// The part of `span` of `ray`, from the eye, behind a plane at this depth.
pub(super) fn behind(depth: f64, span: Span, ray: &Ray, scene: &Classified) -> Option<Span> {
    if depth == 0.0 {
        return Some(span);
    }
    let near = depth / ray.direction.dot(*scene.camera.axis);
    (near <= span.far).then_some(Span::new(span.near.max(near), span.far))
}

/// The box that the volume of `scene` fills, by its conventions.
pub(super) fn extent(scene: &Classified) -> PlacedBox {
    if scene.conventions.voxel_box {
        voxel_extent(scene)
    } else {
        scene.extent()
    }
}

/// The box half a spacing beyond the nodes of `scene`; where it would leave the range of numbers, the box of the nodes.
fn voxel_extent(scene: &Classified) -> PlacedBox {
    let lattice = scene.grid.lattice();
    let lattice = lattice.with_centring(Centring::Cells).unwrap_or(*lattice);
    PlacedBox {
        bounds: lattice.bounds(),
        to_world: scene.to_world,
    }
}
