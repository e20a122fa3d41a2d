//! Clips of volumes in words and numbers.

use super::inline_arrays::{Entries, entries};
use crate::geometry::Aabb;
use crate::scene::{Clip, Kept};

/// The planes and boxes of clips.
pub(super) fn clips(clips: &[Clip]) -> Vec<Entries> {
    let clip = |clip: &Clip| match clip.kept {
        Kept::Side { point, normal } => {
            entries! { "kind": "plane", "point": point, "normal": *normal }
        }
        Kept::Inside(Aabb { min, max }) => entries! { "kind": "box", "min": min, "max": max },
    };
    clips.iter().map(clip).collect()
}

/// The rule by which clips keep parts of a volume.
pub(super) const CLIP: &str = "of a volume only that is left which all its clips (numbers in the list, from 0) keep: the \
    points p with normal.(p - point) > 0 of a plane, or the inside of a box. t0 and t1 are where a ray \
    enters and leaves what is left, and steps are counted from there, on rays towards the light, too";
