//! Errors of rendering.

use thiserror::Error;

/// Reason why an image cannot be rendered. A pixel is given by its column, from the left, and its row, from the top.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RenderError {
    /// A path without an end.
    #[error(
        "a path of pixel ({}, {}) was scattered 2^26 times and still carried light: \
         nothing in the scene absorbs enough of it. Let a medium or surface absorb some, \
         leave a way out, or set max_bounces",
        .0[0], .0[1]
    )]
    Endless([usize; 2]),
    /// A density lookup exceeded its majorant.
    #[error(
        "the density of a medium exceeded its majorant in pixel ({}, {}): the image would be biased and not look it. \
         This is a bug in volref; please report it with the scene",
        .0[0], .0[1]
    )]
    Majorant([usize; 2]),
    /// Unbounded radiance: a ray hits a point or spot light.
    #[error(
        "pixel ({}, {}) is infinitely bright: a point, spot or directional light lies on its \
         line of sight, in a scattering medium, or nearer to what it lights than numbers can tell. \
         Move the light or the camera a little, or make it a small emitting sphere",
        .0[0], .0[1]
    )]
    Divergent([usize; 2]),
    /// Radiance, or the square of its noise, beyond the numbers of an image.
    #[error(
        "pixel ({}, {}) is brighter than an image of 32-bit numbers can hold: its \
         radiance, or the square of its noise, is above 3.4e38. Choose another unit of radiance: \
         divide every radiance, irradiance, intensity and emission by the same number",
        .0[0], .0[1]
    )]
    TooBright([usize; 2]),
    /// Too little memory for the image.
    #[error(
        "no memory for an image of {width} × {height} pixels: {:.2} GiB are held while it is \
         rendered and written; make film.width and film.height smaller",
        *bytes as f64 / f64::from(1 << 30)
    )]
    Memory {
        /// Columns of the image.
        width: usize,
        /// Rows of the image.
        height: usize,
        /// Peak memory, bytes.
        bytes: u64,
    },
    /// A pixel that is not finite, or negative; with red, green, blue and opacity.
    #[error(
        "pixel ({}, {}) is {:?}: radiance must be finite and not negative. \
         This is a bug in volref; please report it with the scene",
        .0[0], .0[1], .1
    )]
    NoRadiance([usize; 2], [f32; 4]),
    /// The rendering was cancelled.
    #[error("the rendering was cancelled")]
    Stopped,
}
