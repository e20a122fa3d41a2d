//! Conventions with several choices.

/// Composition of several volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Composition {
    /// Extinctions add; colours are their mean weighted by extinction.
    Merged,
    /// One volume as a whole in front of the next, in the order in which a ray enters their boxes.
    NearestBox,
    /// Each volume as a whole in front of those before it in the scene.
    LastInFront,
    /// Opacities add, up to 1, in place of extinctions.
    AddedOpacities,
    /// Colours are their mean without weights.
    MeanColours,
}

/// Depth of surfaces among volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceDepth {
    /// Where they stand.
    True,
    /// Behind all volumes.
    Behind,
    /// In front of all volumes.
    InFront,
    /// Cut where a ray has entered the box of a volume.
    Box,
}

/// Shadows among several volumes and surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectShadows {
    /// All volumes and surfaces shadow all.
    All,
    /// Volumes cast shadows as if they were not clipped.
    Unclipped,
    /// None of surfaces.
    NoneOfSurfaces,
    /// None of volumes on surfaces.
    NoneOnSurfaces,
}

/// Numbers in which values are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoredValues {
    /// Floating point of 32 bits, those of the grid.
    F32,
    /// Floating point of 16 bits.
    F16,
    /// Whole numbers of 16 bits over the range of the values.
    U16,
    /// Whole numbers of 8 bits over the range of the values.
    U8,
}

/// Treatment of the step that is cut off by the back face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LastStep {
    /// Counted over its true length.
    Exact,
    /// Every sample inside the volume counts as a whole step.
    Whole,
    /// Dropped.
    Dropped,
}

/// Length of the steps of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepLength {
    /// As stated, in the world.
    World,
    /// In spacings along the ray, in node coordinates.
    Voxels,
    /// In spacings along the axis on which the ray passes nodes fastest.
    MainAxis,
    /// In texture coordinates, [0, 1] along each side of the volume.
    Texture,
    /// As stated, in the coordinates of the volume, before a map places it in the world.
    Volume,
}

/// Steps stretched to fill a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FittedSteps {
    /// Not stretched.
    None,
    /// The nearest whole number.
    Rounded,
    /// A whole number, rounded up.
    Up,
    /// A whole number, rounded down.
    Down,
}

/// Place at which values are looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lookup {
    /// The place of the sample.
    Exact,
    /// Half a spacing on along each axis.
    HalfOn,
    /// Half a spacing back along each axis.
    HalfBack,
}

/// Space in which the gradient is normalised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSpace {
    /// The world.
    World,
    /// The world, after a stretch by the size of the volume along each of its axes.
    Box,
    /// The axes of the eye, then the map of the volume, transposed, then that stretch: the reverse order.
    EyeBox,
}

/// Map of the gradients of a volume that a map places in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalTransform {
    /// The inverse transpose, as gradients are mapped.
    Gradient,
    /// The map itself, as vectors are mapped.
    Vector,
    /// None: gradients stay in the coordinates of the volume.
    None,
}

/// Gradient for shading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gradient {
    /// Central differences at the nodes.
    Central,
    /// Forward differences at the nodes.
    Forward,
    /// Backward differences at the nodes.
    Backward,
    /// The 3 × 3 × 3 Sobel filter at the nodes.
    Sobel,
    /// Derivative of the trilinear interpolant at the sample.
    Interpolant,
    /// Central differences at the sample over `2n/(n − 1)` spacings, `n` the nodes of an axis, divided
    /// as if over two.
    Texture,
    /// Differences at the sample over twice the component of the ray's step along each axis,
    /// undivided.
    RayStep,
}

impl Gradient {
    /// It is computed at the nodes, and interpolated between them.
    pub(crate) fn is_stored(self) -> bool {
        matches!(
            self,
            Gradient::Central | Gradient::Forward | Gradient::Backward | Gradient::Sobel
        )
    }
}

/// Colour that the weight of a term of the shading applies to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightColour {
    /// The colour of the sample.
    Material,
    /// White.
    White,
    /// Black: the term is absent.
    Black,
}

/// Numbers that hold the composited colour and opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 64 bits.
    F64,
    /// 32 bits.
    F32,
    /// 16 bits, IEEE half precision.
    F16,
    /// 15 bits for [0, 1], rounded up; values outside are clamped.
    U15,
    /// 8 bits for [0, 1]; values outside are clamped.
    U8,
}
