//! Conventions without effect beside others, which are refused.

use super::{Conventions, FittedSteps, LastStep};
use crate::scene::SceneResult;
use crate::scene::reader::Reader;

/// A key, whether it has no effect beside others, and the reason with a remedy.
type Contradiction = (&'static str, bool, &'static str);

const NO_TABLE: &str = "there is no table to look up: give `table_size`, its number of entries";
const NO_ENTRIES: &str = "neither a table nor nodes hold opacities and colours: give \
     `table_size`, or `classification = \"pre\"`";
const NO_BITS: &str = "nothing is rounded: give `colour_bits` or `opacity_bits`";
const FITTED: &str =
    "with `fitted_steps` all steps of a ray are of one length: leave one of them out";
const BOX_OF_NODES: &str =
    "with `centring = \"cells\"` values fill the box of the nodes: leave one of them out";

impl Conventions {
    /// Refuses keys without effect beside others.
    pub(super) fn check(&self, reader: &Reader) -> SceneResult<()> {
        let states_first_sample = reader.has("first_sample");
        let contradictions = [
            self.of_steps(states_first_sample),
            self.of_boxes(),
            self.of_entries(),
            self.of_normals(),
        ]
        .concat();
        let mut stated = contradictions
            .into_iter()
            .filter(|(key, is_wrong, _)| *is_wrong && reader.has(key));
        match stated.next() {
            Some((key, _, message)) => Err(reader.error(key, message)),
            None => Ok(()),
        }
    }

    fn of_steps(&self, states_first_sample: bool) -> Vec<Contradiction> {
        let fitted = self.fitted_steps != FittedSteps::None;
        vec![
            (
                "first_sample",
                self.jitter,
                "with `jitter` the place of the first sample is random: leave one of them out",
            ),
            (
                "unstated_first_sample",
                self.unstated_first_sample && (self.is_jittered() || states_first_sample),
                "`first_sample`, `jitter` and `first_step_jitter` state it: leave one of them out",
            ),
            (
                "first_step",
                self.first_step_jitter,
                "with `first_step_jitter` the length of the first step is random: leave one of them out",
            ),
            (
                "first_step_jitter",
                self.first_step_jitter && self.jitter,
                "`jitter` makes the samples of a ray random already: leave one of them out",
            ),
            ("first_step", fitted && self.first_step != 1.0, FITTED),
            (
                "first_step_jitter",
                fitted && self.first_step_jitter,
                FITTED,
            ),
            (
                "last_step",
                fitted && self.last_step != LastStep::Exact,
                FITTED,
            ),
            (
                "last_sample",
                self.last_sample_on_face && self.last_step != LastStep::Exact,
                "the last step does not end with the ray: leave `last_step` out",
            ),
            (
                "step_opacity",
                self.nominal_opacity && self.has_stated_steps(),
                "steps are of the length stated: give `step_length` or `fitted_steps`",
            ),
            (
                "ray_start",
                self.starts_behind_eye && self.near_plane > 0.0,
                "rays begin at the near plane: leave `near_plane` or `ray_start` out",
            ),
        ]
    }

    fn of_boxes(&self) -> Vec<Contradiction> {
        vec![
            ("box", self.voxel_box && self.cell_centred, BOX_OF_NODES),
            (
                "volume_steps",
                self.common_steps && self.is_of_merged_objects(),
                "`composition`, `surface_depth` and `object_shadows` are of volumes with steps of their own: leave \
                 them or `volume_steps` out",
            ),
            (
                "volume_boxes",
                self.voxel_boxes && !self.common_steps,
                "only several volumes, sampled by common steps, have other faces: give `volume_steps = \"common\"`, or \
                 leave it out",
            ),
            (
                "volume_boxes",
                self.voxel_boxes && self.cell_centred,
                BOX_OF_NODES,
            ),
        ]
    }

    /// Of stored opacities and colours.
    fn of_entries(&self) -> Vec<Contradiction> {
        vec![
            (
                "table_lookup",
                self.nearest_entry && self.table_size.is_none(),
                NO_TABLE,
            ),
            (
                "table_place",
                self.texture_place && self.table_size.is_none(),
                NO_TABLE,
            ),
            ("texture_size", self.table_size.is_none(), NO_TABLE),
            ("lookup_bits", self.table_size.is_none(), NO_TABLE),
            ("lookup_bits", !self.has_bits(), NO_BITS),
            ("table_fraction_bits", self.table_size.is_none(), NO_TABLE),
            (
                "table_fraction_bits",
                self.nearest_entry,
                "the nearest entry is taken, nothing is interpolated: leave one of them out",
            ),
            (
                "opacity_correction",
                self.corrected_entries && !self.has_entries(),
                NO_ENTRIES,
            ),
            ("colour_bits", !self.has_entries(), NO_ENTRIES),
            ("opacity_bits", !self.has_entries(), NO_ENTRIES),
            (
                "bit_rounding",
                self.rounded_down && !self.has_bits(),
                NO_BITS,
            ),
            (
                "node_colours",
                self.separate_colours && !self.preclassified,
                "nodes have no colours: give `classification = \"pre\"`",
            ),
        ]
    }

    fn of_normals(&self) -> Vec<Contradiction> {
        let stored = self.gradient.is_stored();
        vec![
            (
                "normals",
                self.normalised_at_nodes && !stored,
                "this gradient is not stored at the nodes: leave `normals` out",
            ),
            (
                "normal_bits",
                !stored,
                "this gradient is not stored at the nodes: leave `normal_bits` out",
            ),
        ]
    }
}
