//! Conventions without effect beside others, which are refused.

use super::{Conventions, FittedSteps, LastStep};
use crate::scene::SceneResult;
use crate::scene::reader::Reader;

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
        let fitted = self.fitted_steps != FittedSteps::None;
        let stored = self.gradient.is_stored();
        refuse! { reader:
            "first_sample" if self.jitter,
                "with `jitter` the place of the first sample is random: leave one of them out";
            "unstated_first_sample" if self.unstated_first_sample && (self.is_jittered() || reader.has("first_sample")),
                "`first_sample`, `jitter` and `first_step_jitter` state it: leave one of them out";
            "first_step_jitter" if self.first_step_jitter && self.jitter,
                "`jitter` makes the samples of a ray random already: leave one of them out";
            "first_step_jitter" if fitted && self.first_step_jitter, FITTED;
            "last_step" if fitted && self.last_step != LastStep::Exact, FITTED;
            "last_sample" if self.last_sample_on_face && self.last_step != LastStep::Exact,
                "the last step does not end with the ray: leave `last_step` out";
            "step_opacity" if self.nominal_opacity && self.has_stated_steps(),
                "steps are of the length stated: give `step_length` or `fitted_steps`";
            "box" if self.voxel_box && self.cell_centred, BOX_OF_NODES;
            "volume_boxes" if self.voxel_boxes && !self.common_steps,
                "only several volumes, sampled by common steps, have other faces: give `volume_steps = \"common\"`, or leave it out";
            "volume_boxes" if self.voxel_boxes && self.cell_centred, BOX_OF_NODES;
            "table_lookup" if self.nearest_entry && self.table_size.is_none(), NO_TABLE;
            "table_place" if self.texture_place && self.table_size.is_none(), NO_TABLE;
            "texture_size" if self.table_size.is_none(), NO_TABLE;
            "lookup_bits" if self.table_size.is_none(), NO_TABLE;
            "lookup_bits" if !self.has_bits(), NO_BITS;
            "table_fraction_bits" if self.table_size.is_none(), NO_TABLE;
            "table_fraction_bits" if self.nearest_entry,
                "the nearest entry is taken, nothing is interpolated: leave one of them out";
            "opacity_correction" if self.corrected_entries && !self.has_entries(), NO_ENTRIES;
            "colour_bits" if !self.has_entries(), NO_ENTRIES;
            "opacity_bits" if !self.has_entries(), NO_ENTRIES;
            "bit_rounding" if self.rounded_down && !self.has_bits(), NO_BITS;
            "node_colours" if self.separate_colours && !self.preclassified,
                "nodes have no colours: give `classification = \"pre\"`";
            "normals" if self.normalised_at_nodes && !stored,
                "this gradient is not stored at the nodes: leave `normals` out";
            "normal_bits" if !stored, "this gradient is not stored at the nodes: leave `normal_bits` out";
        }
        Ok(())
    }
}
