//! The volumes of a classified scene, one by one, and what does not go with several.

use super::classified::checked_step;
use super::clip::Clip;
use super::conventions::{Conventions, Fault};
use super::modulation::Modulation;
use super::objects::{Objects, Volume};
use super::reader::Reader;
use super::{Classified, Compositing, Length, Mode, SceneResult};
use crate::geometry::{Aabb, length_of};

impl Classified {
    /// True if it composites volumes after the first, surfaces, clips or modulated opacities. Clips of projections
    /// and isosurfaces shorten rays, and there is nothing to merge.
    pub fn has_objects(&self) -> bool {
        !self.objects.is_empty() && self.mode == Mode::Composited
    }

    /// True if a renderer has its conventions: of several objects, none; of one volume among surfaces and clips, or of
    /// several that are sampled by common steps, all.
    pub(crate) fn has_conventions_that_are_rendered(&self) -> bool {
        let fault = self.conventions.fault;
        let is_of_merged = fault.is_some_and(Fault::is_of_merged_objects);
        !self.has_objects() || self.is_merged() || self.is_sampled_by_conventions() && !is_of_merged
    }

    /// True if it follows no conventions, and makes no mistakes but those about several objects, and no ray ends early:
    /// these are merged.
    pub(crate) fn is_merged(&self) -> bool {
        let ends_early = matches!(self.compositing, Compositing::EarlyTermination(_));
        let fault = self.conventions.fault;
        let own = Conventions {
            fault: fault.filter(|it| it.is_of_merged_objects()),
            ..Conventions::default()
        };
        self.conventions == own && !ends_early
    }

    /// True if the samples of its volumes follow conventions: those of one, or of all by common steps, with
    /// opacities as they are, and nothing in shadow.
    fn is_sampled_by_conventions(&self) -> bool {
        (self.volume_count() == 1 || self.conventions.common_steps)
            && (0..self.volume_count()).all(|index| self.modulation_of(index).is_none())
            && self.shadow.is_none()
    }

    /// The box along the axes of the world around all volumes, and the shortest of their steps.
    pub(crate) fn common_box_and_step(&self) -> (Aabb, f64) {
        let first = (self.extent().world_bounds(), self.step);
        let each = self.each_alone().skip(1);
        each.fold(first, |(bounds, step), alone| {
            let more = alone.extent().world_bounds();
            (bounds.union(more), step.min(alone.step))
        })
    }

    /// Fails if rays would have too many common steps.
    pub(crate) fn check_common_steps(&self) -> Result<(), String> {
        if !self.conventions.common_steps {
            return Ok(());
        }
        let (bounds, step) = self.common_box_and_step();
        checked_step(Length::World(step), [1.0, length_of(bounds.size())]).map(|_| ())
    }

    /// Number of volumes, at least 1.
    pub(crate) fn volume_count(&self) -> usize {
        1 + self.objects.volumes.len()
    }

    /// Numbers of volumes, surfaces and clips, in words.
    pub(crate) fn counted_objects(&self) -> String {
        let counts = [
            (self.volume_count(), "volume"),
            (self.objects.surfaces.len(), "surface"),
            (self.objects.clips.len(), "clip"),
        ];
        let words = counts.map(|(count, what)| {
            let plural = if count == 1 { "" } else { "s" };
            format!("{count} {what}{plural}")
        });
        words.join(", ")
    }

    /// The scene of one of its volumes, without the others, surfaces, clips and modulation.
    pub fn alone(&self, index: usize) -> Classified {
        let mut alone = Classified {
            objects: Objects::default(),
            ..self.clone()
        };
        if index > 0 {
            alone.swap(&mut self.objects.volumes[index - 1].clone());
        }
        alone
    }

    /// For each volume the scene with that volume alone, in order.
    pub(crate) fn each_alone(&self) -> impl Iterator<Item = Classified> + '_ {
        (0..self.volume_count()).map(|index| self.alone(index))
    }

    /// Puts a volume, [`alone`](Self::alone) in its scene, in the place of the one of this index.
    pub fn put(&mut self, index: usize, mut alone: Classified) {
        match index.checked_sub(1) {
            None => {
                *self = Classified {
                    objects: std::mem::take(&mut self.objects),
                    ..alone
                };
            }
            Some(index) => alone.swap(&mut self.objects.volumes[index]),
        }
    }

    /// Edits the scene, then each volume after the first as though it were the only one, and the shading
    /// of surfaces; true if any edit was.
    pub(crate) fn edit_volumes(&mut self, edit: impl Fn(&mut Classified) -> bool) -> bool {
        let before = self.alone(0);
        let mut edited = edit(self);
        for index in 0..self.objects.volumes.len() {
            let mut alone = self.alone(index + 1);
            edited |= edit(&mut alone);
            // The conventions of all volumes, even if the first gives no occasion to change them.
            self.conventions = alone.conventions;
            alone.swap(&mut self.objects.volumes[index]);
        }
        for surface in &mut self.objects.surfaces {
            let mut shaded = before.clone();
            shaded.phong = surface.phong;
            edited |= surface.phong.is_some() && edit(&mut shaded);
            surface.phong = shaded.phong;
        }
        edited
    }

    fn swap(&mut self, volume: &mut Volume) {
        use std::mem::swap;
        swap(&mut self.grid, &mut volume.grid);
        swap(&mut self.to_world, &mut volume.to_world);
        swap(&mut self.transfer_function, &mut volume.transfer_function);
        swap(&mut self.step, &mut volume.step);
        swap(&mut self.phong, &mut volume.phong);
        swap(&mut self.shadow, &mut volume.shadow);
    }

    /// Modulation of the opacity of a volume.
    pub(crate) fn modulation_of(&self, volume: usize) -> Option<&Modulation> {
        match volume.checked_sub(1) {
            None => self.objects.modulation.as_ref(),
            Some(index) => self.objects.volumes[index].modulation.as_ref(),
        }
    }

    /// The clips that cut the volume of this index.
    pub(crate) fn clips_of(&self, volume: usize) -> impl Iterator<Item = &Clip> {
        let clips = self.objects.clips.iter();
        clips.filter(move |clip| clip.cuts(volume))
    }

    /// True if each clip leaves something of each volume that it cuts.
    pub(crate) fn is_something_left(&self) -> bool {
        let mut volumes = self.each_alone().enumerate();
        volumes.all(|(index, alone)| {
            let extent = alone.extent();
            self.clips_of(index).all(|clip| clip.keeps_some(&extent))
        })
    }

    /// Refuses what has no meaning, or no renderer, beside several volumes, surfaces or clips.
    pub(super) fn check_objects(&self, reader: &Reader) -> SceneResult<()> {
        let is_one_volume = self.objects.are_one_volume();
        let with = "several volumes, surfaces, clips or modulation";
        refuse! { reader:
            "mode" if self.mode != Mode::Composited && !is_one_volume, format!("with {with} samples are composited"),
                "leave `mode` out, or what stands beside the volume, or modulates it; clips may stay";
            "clip" if !self.is_something_left(), "a clip leaves nothing of a volume",
                "remove the volume, or turn a normal around: a clip keeps the side to which its normal points, or the \
                 inside of its box";
        }
        if !self.has_objects() {
            return Ok(());
        }
        let mut volumes = 0..self.volume_count();
        let is_modulated = volumes.any(|index| self.modulation_of(index).is_some());
        let is_ordinary = self.has_conventions_that_are_rendered();
        refuse! { reader:
            "compositing" if !self.continuous, format!("with {with} samples are composited front to back"),
                "leave `compositing` out: the order changes no more than rounding";
            "early_termination", format!("with {with} no ray is ended early"), "leave the key out";
            "conventions" if !is_ordinary,
                "several volumes follow conventions where they are sampled by common steps, without shadow and modulation",
                "add `volume_steps = \"common\"`, or leave the table out";
            "compositing" if self.continuous && is_modulated,
                "modulated opacities are sampled: their integral is not known",
                "leave `compositing` out, and give a `step`";
            "shadow" if is_modulated, "shadows of modulated opacities are not rendered",
                "leave `shadow` or `modulation` out";
        }
        self.check_common_steps()
            .map_err(|message| reader.error("conventions", message))
    }
}
