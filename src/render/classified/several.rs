//! Several volumes, surfaces and clips in one picture.
//!
//! Along a ray each volume is a [`Cursor`] that stands at the end of one of its steps; the nearest of
//! them ends a piece, over which the optical depths of all add up:
//!
//! ```text
//! τ = l Σ σᵢ,     a = 1 − exp(−τ),     c = Σ cᵢ σᵢ / Σ σᵢ
//! ```
//!
//! Steps are looked up one by one, as the ray comes to them. `src/reference/several_volumes.rs` states the
//! definition, and makes a list of all pieces instead.
//!
//! Other renderers compose otherwise: [`Composition`], [`SurfaceDepth`] and [`ObjectShadows`] say how.
//!
//! Source: Max 1995, "Optical models for direct volume rendering".

use super::steps::Steps;
use crate::geometry::{Direction, Hit, Ray, Span, Surface as _, length_of};
use crate::math::{exp, exp_m1, ln_1p};
use crate::optics::{Appearance, Layer};
use crate::render::counters::{Counters, Event};
use crate::render::pixels::{Pixels, each};
use crate::scene::{Classified, Fault, Kept, Modulation, OpaqueSurface};
use crate::volume::{Cell, Grid, NodeLine, PlacedBox};
use glam::DVec3;
use std::borrow::Cow;

/// The pixels of `scene`.
pub(in crate::render) fn cast(
    scene: &Classified,
    pixels: &Pixels<'_>,
) -> (Vec<[f32; 4]>, Counters) {
    let caster = Caster::new(Cow::Borrowed(scene));
    let size = [pixels.width, pixels.height];
    let (image, mut work) = each(pixels, |pixel, work| {
        caster
            .layers(&scene.camera.ray(pixel, size), work)
            .pixel(scene.background)
    });
    let shaded = caster.parts.iter().filter(|it| it.gradients.is_some());
    let nodes = shaded.map(|part| part.scene.grid.lattice().node_count() as u64);
    work.count_times(Event::GradientComputed, nodes.sum());
    (image, work)
}

/// A volume with what is made of it once.
pub(super) struct Part {
    /// The scene of it alone.
    pub scene: Classified,
    pub extent: PlacedBox,
    gradients: Option<Grid<[f32; 3]>>,
    modulation: Option<Modulation>,
    kept: Vec<Kept>,
}

pub(super) struct Caster<'s> {
    scene: Cow<'s, Classified>,
    parts: Vec<Part>,
}

/// What a ray passes: a piece of merged volumes, or a surface.
pub(super) struct PassedLayer {
    /// Distance of its middle from the eye.
    pub t: f64,
    /// Length along the ray; 0 for a surface.
    pub length: f64,
    pub opacity: f64,
}

/// A volume along a ray.
struct Cursor<'c> {
    part: &'c Part,
    line: NodeLine,
    span: Span,
    steps: Steps,
    /// Number of steps begun.
    begun: usize,
    /// Distance at which the next step begins; infinite behind the last.
    next: f64,
    /// Extinction in the current step; 0 outside of all.
    extinction: f64,
    /// Colour towards the eye in the current step.
    colour: DVec3,
}

impl Part {
    pub fn new(scene: &Classified, index: usize) -> Part {
        let alone = scene.alone(index);
        Part {
            extent: alone.extent(),
            gradients: alone.phong.map(|_| alone.gradients()),
            scene: alone,
            modulation: scene.modulation_of(index).cloned(),
            kept: scene.clips_of(index).map(|clip| clip.kept).collect(),
        }
    }

    /// The span of `ray` in what the clips keep, up to `end`.
    pub fn span(&self, ray: &Ray, end: f64, is_clipped: bool) -> Option<Span> {
        let mut span = self.extent.span(ray)?;
        span.far = span.far.min(end);
        for kept in self.kept.iter().filter(|_| is_clipped) {
            span = span.within(kept.span(ray)?);
        }
        (span.near < span.far).then_some(span)
    }

    fn density(&self, cell: &Cell, work: &mut Counters) -> f64 {
        work.count(Event::DensityLookup);
        self.scene.interpolation.read(&*self.scene.grid, cell)
    }

    fn node_line(&self, ray: &Ray) -> NodeLine {
        NodeLine::new(self.extent.line(ray), self.scene.grid.lattice())
    }

    /// Logarithm of the visibility through the volume along the `span` of a shadow ray, not above 0.
    fn shadow(&self, ray: &Ray, span: Span, work: &mut Counters) -> f64 {
        let Some(shadow) = self.scene.shadow else {
            return 0.0;
        };
        let (line, steps) = (self.node_line(ray), Steps::over(span, shadow.step));
        let mut sum = 0.0;
        for index in 0..steps.count() {
            let (t, length) = steps.sample(index);
            let cell = Cell::around(self.scene.grid.lattice(), line.at(t));
            let value = self.density(&cell, work);
            let references = length / shadow.reference_step;
            let look = &self.scene.transfer_function;
            sum += match &look.appearance {
                Appearance::Formula { .. } => -0.01 * look.density(value) * references,
                Appearance::Points(points) => {
                    let opacity = points.opacity(value);
                    if opacity == 0.0 || references == 0.0 {
                        continue;
                    }
                    work.count(Event::Attenuation);
                    references * ln_1p(-opacity)
                }
            };
        }
        sum
    }
}

impl<'s> Caster<'s> {
    fn new(scene: Cow<'s, Classified>) -> Caster<'s> {
        let parts = (0..scene.volume_count()).map(|index| Part::new(&scene, index));
        Caster {
            parts: parts.collect(),
            scene,
        }
    }

    /// A caster of `scene` without shading and shadow: for opacities.
    pub fn unlit(scene: &Classified) -> Caster<'s> {
        let mut unlit = scene.clone();
        unlit.edit_volumes(|volume| {
            (volume.phong, volume.shadow) = (None, None);
            true
        });
        Caster::new(Cow::Owned(unlit))
    }

    /// Everything along `ray`, composited.
    fn layers(&self, ray: &Ray, work: &mut Counters) -> Layer {
        let fault = self.scene.conventions.fault;
        let objects = &self.scene.objects;
        work.count_times(Event::SurfaceTest, objects.surfaces.len() as u64);
        let mut hit = objects.nearest_surface(ray);
        if fault == Some(Fault::SurfacesCutByBoxes) {
            let boxes = self.parts.iter().filter_map(|part| part.extent.span(ray));
            let entered = boxes.map(|span| span.near).fold(f64::INFINITY, f64::min);
            hit = hit.filter(|(hit, _)| hit.t <= entered);
        }
        let end = match (&hit, fault) {
            (None, _) | (_, Some(Fault::SurfacesBehind)) => f64::INFINITY,
            (_, Some(Fault::SurfacesInFront)) => 0.0,
            (Some((hit, _)), _) => hit.t,
        };
        let mut cursors = self.cursors(ray, end);
        let merged_at_once = match fault {
            Some(Fault::NearestBoxInFront) => {
                cursors.sort_by(|a, b| a.span.near.total_cmp(&b.span.near));
                1
            }
            Some(Fault::LastInFront) => {
                cursors.reverse();
                1
            }
            _ => cursors.len().max(1),
        };
        let mut layers = Layer::EMPTY;
        for cursors in cursors.chunks_mut(merged_at_once) {
            layers = layers.over(self.merged(cursors, ray, work));
        }
        match hit {
            None => layers,
            Some((hit, surface)) => {
                let radiance = self.surface(ray, &hit, surface, work);
                layers.over(Layer::sample(radiance, 1.0))
            }
        }
    }

    /// The volumes along `ray`, composited.
    fn merged(&self, cursors: &mut [Cursor<'_>], ray: &Ray, work: &mut Counters) -> Layer {
        let mut layers = Layer::EMPTY;
        self.pieces(cursors, ray, work, |_, colour, opacity| {
            layers = layers.over(Layer::sample(colour * opacity, opacity));
        });
        layers
    }

    /// What `ray` passes: pieces of merged volumes, and the surface at its end.
    pub fn passed(&self, ray: &Ray) -> Vec<PassedLayer> {
        let hit = self.scene.objects.nearest_surface(ray);
        let end = hit.as_ref().map_or(f64::INFINITY, |(hit, _)| hit.t);
        let mut cursors = self.cursors(ray, end);
        let mut passed = Vec::new();
        let work = &mut Counters::default();
        self.pieces(&mut cursors, ray, work, |[near, far], _, opacity| {
            passed.push(PassedLayer {
                t: 0.5 * (near + far),
                length: far - near,
                opacity,
            });
        });
        passed.extend(hit.map(|(hit, _)| PassedLayer {
            t: hit.t,
            length: 0.0,
            opacity: 1.0,
        }));
        passed
    }

    /// The volumes along `ray`, up to `end`.
    fn cursors(&self, ray: &Ray, end: f64) -> Vec<Cursor<'_>> {
        let cursor = |part| Cursor::new(part, ray, end);
        self.parts.iter().filter_map(cursor).collect()
    }

    /// Calls `each` with the ends, the colour and the opacity of each piece along `ray` that is not transparent.
    fn pieces(
        &self,
        cursors: &mut [Cursor<'_>],
        ray: &Ray,
        work: &mut Counters,
        mut each: impl FnMut([f64; 2], DVec3, f64),
    ) {
        let nearest = |cursors: &[Cursor<'_>]| {
            let next = cursors.iter().map(|cursor| cursor.next);
            next.fold(f64::INFINITY, f64::min)
        };
        let mut at = nearest(cursors);
        while at < f64::INFINITY {
            for cursor in cursors.iter_mut() {
                while cursor.next <= at {
                    cursor.step(self, ray, work);
                }
            }
            let end = nearest(cursors);
            if let Some((colour, opacity)) = self.piece(cursors, end - at, work) {
                each([at, end], colour, opacity);
            }
            at = end;
        }
    }

    /// Colour and opacity of a piece of this length; none of a transparent one.
    fn piece(
        &self,
        cursors: &[Cursor<'_>],
        length: f64,
        work: &mut Counters,
    ) -> Option<(DVec3, f64)> {
        let seen = || cursors.iter().filter(|cursor| cursor.extinction > 0.0);
        seen().next()?;
        work.count(Event::Attenuation);
        let fault = self.scene.conventions.fault;
        let opaque = seen()
            .filter(|cursor| cursor.extinction == f64::INFINITY)
            .count();
        // Opaque ones weigh the same, beside which others have no weight.
        let weight = |cursor: &Cursor<'_>| match fault {
            Some(Fault::ColoursUnweighted) => 1.0,
            Some(Fault::OpacitiesAdded) => -exp_m1(-cursor.extinction * length),
            _ if opaque == 0 => cursor.extinction,
            _ => f64::from(u8::from(cursor.extinction == f64::INFINITY)),
        };
        let total: f64 = seen().map(weight).sum();
        let colour: DVec3 = seen()
            .map(|cursor| cursor.colour * (weight(cursor) / total))
            .sum();
        let opacity = if fault == Some(Fault::OpacitiesAdded) {
            total.min(1.0)
        } else {
            let extinction: f64 = seen().map(|cursor| cursor.extinction).sum();
            -exp_m1(-extinction * length)
        };
        Some((colour, opacity))
    }

    /// Radiance of a surface at a hit.
    fn surface(&self, ray: &Ray, hit: &Hit, surface: &OpaqueSurface, work: &mut Counters) -> DVec3 {
        let colour = surface.shaded(ray, hit, self.scene.light);
        match hit.point.towards_point(self.scene.light) {
            Some((ray, distance)) => colour * self.visibility(&ray, distance, true, work),
            None => colour,
        }
    }

    /// Visibility of the light at `distance` along `ray`, which leaves a surface or a sample.
    fn visibility(&self, ray: &Ray, distance: f64, of_surface: bool, work: &mut Counters) -> f64 {
        if self.scene.shadow.is_none() {
            return 1.0;
        }
        work.count(Event::ShadowRay);
        let fault = self.scene.conventions.fault;
        if fault != Some(Fault::NoShadowOfSurfaces) {
            for surface in &self.scene.objects.surfaces {
                work.count(Event::SurfaceTest);
                if surface.shape.blocks(ray, distance) {
                    return 0.0;
                }
            }
        }
        if of_surface && fault == Some(Fault::NoShadowOnSurfaces) {
            return 1.0;
        }
        let is_clipped = fault != Some(Fault::ShadowsUnclipped);
        let mut sum = 0.0;
        for part in &self.parts {
            if let Some(span) = part.span(ray, distance, is_clipped) {
                sum += part.shadow(ray, span, work);
            }
        }
        exp(sum)
    }
}

impl<'c> Cursor<'c> {
    fn new(part: &'c Part, ray: &Ray, end: f64) -> Option<Cursor<'c>> {
        let span = part.span(ray, end, true)?;
        Some(Cursor {
            line: part.node_line(ray),
            steps: Steps::over(span, part.scene.step),
            part,
            span,
            begun: 0,
            next: span.near,
            extinction: 0.0,
            colour: DVec3::ZERO,
        })
    }

    /// Begins the next step, or leaves the volume.
    fn step(&mut self, caster: &Caster<'_>, ray: &Ray, work: &mut Counters) {
        let (part, index) = (self.part, self.begun);
        self.extinction = 0.0;
        if index == self.steps.count() {
            self.next = f64::INFINITY;
            return;
        }
        self.begun += 1;
        self.next = if self.begun < self.steps.count() {
            (self.span.near + self.begun as f64 * part.scene.step).min(self.span.far)
        } else {
            self.span.far
        };
        let (t, _) = self.steps.sample(index);
        let cell = Cell::around(part.scene.grid.lattice(), self.line.at(t));
        let value = part.density(&cell, work);
        let look = &part.scene.transfer_function;
        let (mut opacity, colour) = look.look(value);
        if let Some(modulation) = &part.modulation {
            work.count(Event::DensityLookup);
            opacity *= modulation.factor(part.scene.interpolation, &cell);
        }
        if opacity == 0.0 {
            return;
        }
        work.count(Event::EmissionTerm);
        self.extinction = look.extinction_of(opacity);
        let point = ray.at(t);
        let to_light = caster.scene.light - point;
        let mut shaded = colour;
        if let (Some(phong), Some(gradients)) = (&part.scene.phong, &part.gradients) {
            work.count(Event::GradientLookup);
            let gradient = part.scene.interpolation.read(gradients, &cell);
            shaded = phong.shade(colour, gradient, Direction::of(to_light), -ray.direction);
        }
        let ray = caster.scene.shadow.and_then(|_| Ray::new(point, to_light));
        let visibility = ray.map_or(1.0, |ray| {
            caster.visibility(&ray, length_of(to_light), false, work)
        });
        self.colour = shaded * (look.emission(value) * visibility);
    }
}
