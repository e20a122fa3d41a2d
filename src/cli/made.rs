//! An image that another renderer made, and what it was asked for.

use crate::judging::Output;

/// Parameters of a call of a renderer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ask {
    /// Samples per pixel.
    pub spp: u32,
    pub seed: u64,
}

/// The output for a case, and its origin.
pub(super) struct Made {
    pub output: Output,
    /// Output of the renderer, if one was run.
    pub printed: Option<String>,
    /// Notes beside the verdict.
    pub notes: Vec<String>,
    /// Command line of the renderer, if one was run.
    pub call: Option<String>,
}

impl Made {
    pub fn of(output: Output) -> Made {
        Made {
            output,
            printed: None,
            notes: Vec::new(),
            call: None,
        }
    }
}
