//! Conversions on reading a file, which its pixels do not show.

use std::fmt;

/// Changes on reading, and the origin of infinities.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Reading {
    /// Ends of a sentence about the image.
    pub changes: Vec<String>,
    pub overflow: Option<Overflow>,
    /// True if the values make sense only in the other byte order.
    pub is_swapped: bool,
}

/// Type of number whose range is smaller than the values written into it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overflow {
    /// Half floats.
    Half,
    /// 32-bit floats, where a file has 64 bits.
    Single,
    /// 32-bit floats, after a multiplication by the scale of a PFM.
    Scale,
}

impl fmt::Display for Overflow {
    /// The likely origin of infinite values, and the remedy.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Overflow::Half => {
                "the file has half floats, which end at 65504, and larger values become infinite: write \
                 32-bit floats"
            }
            Overflow::Single => {
                "finite 64-bit values of the file are beyond 3.4e38, the end of 32-bit floats: write \
                 radiance in the unit of the scene, or look for a division by nearly 0"
            }
            Overflow::Scale => {
                "finite values of the file times the magnitude of its scale are beyond 3.4e38: write the \
                 scale 1 or -1"
            }
        })
    }
}
