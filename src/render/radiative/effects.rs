//! Effects that a kernel is compiled for.

/// Effects as constants: the compiled code does not contain effects that are off.
pub trait Effects: Copy + Sync {
    /// Media that scatter, absorb or emit light.
    const MEDIA: bool;
    /// Surfaces.
    const SURFACES: bool;
    /// Media that emit.
    const EMISSION: bool;
    /// Coefficients that differ between channels.
    const CHROMATIC: bool;
    /// Anisotropic phase functions.
    const ANISOTROPIC: bool;
    /// Heterogeneous media.
    const HETEROGENEOUS: bool;
    /// One medium, homogeneous and convex, and nothing else: the only media that kernels without
    /// surfaces are compiled for.
    const SINGLE_MEDIUM: bool = Self::MEDIA && !Self::SURFACES && !Self::HETEROGENEOUS;
}

/// The effects given as parameters.
#[derive(Clone, Copy, Debug)]
pub struct Only<
    const MEDIA: bool,
    const SURFACES: bool,
    const EMISSION: bool,
    const CHROMATIC: bool,
    const ANISOTROPIC: bool,
    const HETEROGENEOUS: bool,
>;

impl<
    const MEDIA: bool,
    const SURFACES: bool,
    const EMISSION: bool,
    const CHROMATIC: bool,
    const ANISOTROPIC: bool,
    const HETEROGENEOUS: bool,
> Effects for Only<MEDIA, SURFACES, EMISSION, CHROMATIC, ANISOTROPIC, HETEROGENEOUS>
{
    const MEDIA: bool = MEDIA;
    const SURFACES: bool = SURFACES;
    const EMISSION: bool = EMISSION;
    const CHROMATIC: bool = CHROMATIC;
    const ANISOTROPIC: bool = ANISOTROPIC;
    const HETEROGENEOUS: bool = HETEROGENEOUS;
}

/// Everything on: the general kernel.
pub type Everything = Only<true, true, true, true, true, true>;
