//! Errors of rendering.

use thiserror::Error;

/// Reason why an image cannot be rendered.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RenderError {
    /// A path without an end.
    #[error(
        "a path of pixel ({column}, {row}) was scattered 2^26 times and still carried light: \
         nothing in the scene absorbs enough of it. Let a medium or surface absorb some, \
         leave a way out, or set max_bounces"
    )]
    Endless {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
    },
    /// A density lookup exceeded its majorant.
    #[error(
        "the density of a medium exceeded its majorant {violations} times, first in pixel \
         ({column}, {row}): the image would be biased and not look it. This is a bug in volref; \
         please report it with the scene"
    )]
    Majorant {
        /// Number of such lookups, in all pixels; each pixel stops at its first such path.
        violations: u64,
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
    },
    /// Unbounded radiance: a ray hits a point or spot light.
    #[error(
        "pixel ({column}, {row}) is infinitely bright: a point, spot or directional light lies on its \
         line of sight, in a scattering medium, or nearer to what it lights than numbers can tell. \
         Move the light or the camera a little, or make it a small emitting sphere"
    )]
    Divergent {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
    },
    /// Radiance, or the square of its noise, beyond the numbers of an image.
    #[error(
        "pixel ({column}, {row}) is brighter than an image of 32-bit numbers can hold: its \
         radiance, or the square of its noise, is above 3.4e38. Choose another unit of radiance: \
         divide every radiance, irradiance, intensity and emission by the same number"
    )]
    TooBright {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
    },
    /// Too little memory for the image.
    #[error(
        "no memory for an image of {width} × {height} pixels: {:.2} GiB are held while it is \
         rendered and written; make film.width and film.height smaller",
        *bytes as f64 / f64::from(1 << 30)
    )]
    Memory {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Peak memory, bytes.
        bytes: u64,
    },
    /// A pixel that is not finite, or negative.
    #[error(
        "pixel ({column}, {row}) is {value:?}: radiance must be finite and not negative. \
         This is a bug in volref; please report it with the scene"
    )]
    NoRadiance {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
        /// Red, green, blue, opacity.
        value: [f32; 4],
    },
    /// The rendering was cancelled.
    #[error("the rendering was cancelled")]
    Stopped,
}
