//! The volumes of a classified scene, one by one, and what does not go with several.

use super::clip::{Clip, keeps_all, leave_something};
use super::conventions::Conventions;
use super::modulation::Modulation;
use super::objects::{Objects, Volume};
use super::reader::Reader;
use super::{Classified, Mode, SceneResult};
use crate::volume::PlacedBox;

impl Classified {
    /// True if it has volumes after the first, surfaces, clips or modulated opacities.
    pub fn has_objects(&self) -> bool {
        !self.objects.is_empty()
    }

    /// True if a renderer has its conventions: of several objects, only those about them; of one volume among
    /// surfaces and clips, without shadow, all others.
    pub fn has_conventions_that_are_rendered(&self) -> bool {
        !self.has_objects()
            || self.conventions.is_of_objects_alone()
            || self.is_one_volume_without_shadow() && !self.conventions.is_of_merged_objects()
    }

    /// True of a volume alone or among surfaces and clips, its opacity as it is, and nothing in shadow.
    pub fn is_one_volume_without_shadow(&self) -> bool {
        let objects = &self.objects;
        objects.volumes.is_empty() && objects.modulation.is_none() && self.shadow.is_none()
    }

    /// Number of volumes.
    pub fn volume_count(&self) -> usize {
        1 + self.objects.volumes.len()
    }

    /// Numbers of volumes, surfaces and clips, in words.
    pub fn counted_objects(&self) -> String {
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
        if let Some(volume) = index
            .checked_sub(1)
            .map(|index| &self.objects.volumes[index])
        {
            alone.swap(&mut volume.clone());
        }
        alone
    }

    /// The scenes of its volumes.
    pub fn each_alone(&self) -> impl Iterator<Item = Classified> + '_ {
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
    pub fn edit_volumes(&mut self, edit: impl Fn(&mut Classified) -> bool) -> bool {
        let before = self.alone(0);
        let mut edited = edit(self);
        for index in 0..self.objects.volumes.len() {
            let mut alone = self.alone(index + 1);
            edited |= edit(&mut alone);
            // Of all volumes, even if the first gives no occasion to change them.
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
    pub fn modulation_of(&self, volume: usize) -> Option<&Modulation> {
        match volume.checked_sub(1) {
            None => self.objects.modulation.as_ref(),
            Some(index) => self.objects.volumes[index].modulation.as_ref(),
        }
    }

    /// Clips of a volume.
    pub fn clips_of(&self, volume: usize) -> impl Iterator<Item = &Clip> {
        let clips = self.objects.clips.iter();
        clips.filter(move |clip| clip.cuts(volume))
    }

    /// Numbers of the clips, from 0, that keep all of each volume that they are for.
    pub fn clips_that_cut_nothing(&self) -> impl Iterator<Item = usize> + '_ {
        let extents: Vec<_> = self.each_alone().map(|alone| alone.extent()).collect();
        let clips = self.objects.clips.iter().enumerate();
        let idle = clips.filter(move |(_, clip)| {
            let mut cut = extents
                .iter()
                .enumerate()
                .filter(|(index, _)| clip.cuts(*index));
            cut.all(|(_, extent)| keeps_all(clip, extent))
        });
        idle.map(|(number, _)| number)
    }

    /// Refuses what has no meaning, or no renderer, beside several volumes, surfaces or clips.
    pub(super) fn check_objects(
        &self,
        reader: &Reader,
        names: &[Option<String>],
    ) -> SceneResult<()> {
        if !self.has_objects() {
            if !self.conventions.is_of_merged_objects() && !self.conventions.sample_behind_ends {
                return Ok(());
            }
            let message = "`composition`, `surface_depth`, `object_shadows` and `sample_behind_ends` are about \
                           several volumes, surfaces or clips: the scene has none";
            return Err(reader.mistake("conventions", message, "leave these keys out"));
        }
        for (key, is_refused, what, help) in [
            (
                "mode",
                self.mode != Mode::Composited,
                "samples are composited",
                "leave `mode` out, or keep one volume alone",
            ),
            (
                "compositing",
                reader.has("compositing") && !self.continuous,
                "samples are composited front to back",
                "leave `compositing` out: the order changes no more than rounding",
            ),
            (
                "early_termination",
                reader.has("early_termination"),
                "no ray is ended early",
                "leave the key out",
            ),
            (
                "conventions",
                !self.has_conventions_that_are_rendered(),
                "only `composition`, `surface_depth` and `object_shadows` are known, or without them those of one \
                 volume without shadow",
                "leave the other keys out",
            ),
        ] {
            if is_refused {
                let with = if self.objects.are_modulation_alone() {
                    "modulated opacities"
                } else {
                    "several volumes, surfaces or clips"
                };
                let message = format!("with {with} {what}");
                return Err(reader.mistake(key, message, help));
            }
        }
        let is_modulated =
            (0..self.volume_count()).any(|index| self.modulation_of(index).is_some());
        if self.continuous && is_modulated {
            let message = "modulated opacities are sampled: their integral is not known";
            let help = "leave `compositing` out, and give a `step`";
            return Err(reader.mistake("compositing", message, help));
        }
        if self.shadow.is_some() && is_modulated {
            let message = "shadows of modulated opacities are not rendered";
            return Err(reader.mistake("shadow", message, "leave `shadow` or `modulation` out"));
        }
        for (index, (alone, name)) in self.each_alone().zip(names).enumerate() {
            self.check_clips_of(index, &alone.extent(), name.as_deref(), reader)?;
        }
        Ok(())
    }

    /// Refuses clips that leave nothing of a volume: the first that does so alone, or with those before it.
    fn check_clips_of(
        &self,
        index: usize,
        extent: &PlacedBox,
        name: Option<&str>,
        reader: &Reader,
    ) -> SceneResult<()> {
        let clips = self.objects.clips.iter().enumerate();
        let clips: Vec<_> = clips.filter(|(_, clip)| clip.cuts(index)).collect();
        let leave_nothing = |clips: &[(usize, &Clip)]| {
            !leave_something(extent, clips.iter().map(|(_, clip)| *clip))
        };
        let alone = clips.iter().find(|clip| leave_nothing(&[**clip]));
        let count = (1..=clips.len()).find(|&count| leave_nothing(&clips[..count]));
        let (number, which) = match (alone, count) {
            (Some((number, _)), _) => (*number, "this clip leaves"),
            (None, Some(count)) => (clips[count - 1].0, "this clip and those before it leave"),
            (None, None) => return Ok(()),
        };
        let name = name.map_or(String::new(), |name| format!(", {name:?}"));
        let message = format!("{which} nothing of volume {}{name}", index + 1);
        let help = "remove the volume, or turn a normal around: a clip keeps the side to which its \
                    normal points, or the inside of its box";
        let tables = reader.tables("clip")?;
        Err(tables[number].mistake_here(message, help))
    }
}

impl Conventions {
    /// True if a convention about several objects is not volref's own.
    fn is_of_merged_objects(&self) -> bool {
        let own = Conventions::default();
        self.composition != own.composition
            || self.surface_depth != own.surface_depth
            || self.object_shadows != own.object_shadows
    }

    /// True if all conventions but those about several objects are volref's own.
    pub fn is_of_objects_alone(&self) -> bool {
        let own = Conventions::default();
        let others = Conventions {
            composition: own.composition,
            surface_depth: own.surface_depth,
            object_shadows: own.object_shadows,
            ..*self
        };
        others == own
    }
}
