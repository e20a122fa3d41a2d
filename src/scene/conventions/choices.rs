//! Conventions with several choices, and mistakes beside them.

choice! {
    /// Numbers in which values are stored.
    pub enum StoredValues {
        /// Floating point of 32 bits, those of the grid.
        F32 = "f32",
        /// Floating point of 16 bits.
        F16 = "f16",
        /// Whole numbers of 16 bits over the range of the values.
        U16 = "u16",
        /// Whole numbers of 8 bits over the range of the values.
        U8 = "u8",
    }
}

choice! {
    /// Treatment of the step that is cut off by the back face.
    pub enum LastStep {
        /// Counted over its true length.
        Exact = "exact",
        /// Every sample inside the volume counts as a whole step.
        Whole = "whole",
        /// Dropped.
        Dropped = "dropped",
    }
}

choice! {
    /// Length of the steps of a ray.
    pub enum StepLength {
        /// As stated, in the world.
        World = "world",
        /// In spacings along the ray, in node coordinates.
        Voxels = "voxels",
        /// In spacings along the axis on which the ray passes nodes fastest.
        MainAxis = "main-axis",
        /// In texture coordinates, [0, 1] along each side of the volume.
        Texture = "texture",
        /// As stated, in the coordinates of the volume, before a map places it in the world.
        Volume = "volume",
    }
}

choice! {
    /// Steps stretched to fill a ray.
    pub enum FittedSteps {
        /// Not stretched.
        None = "none",
        /// The nearest whole number.
        Rounded = "rounded",
        /// A whole number, rounded up.
        Up = "up",
        /// A whole number, rounded down.
        Down = "down",
    }
}

choice! {
    /// Space in which the gradient is normalised.
    pub enum NormalSpace {
        /// The world.
        World = "world",
        /// The world, after a stretch by the size of the volume along each of its axes.
        Box = "box",
        /// The axes of the eye, then the map of the volume, transposed, then that stretch: the reverse order.
        EyeBox = "eye-box",
    }
}

choice! {
    /// Gradient for shading.
    pub enum Gradient {
        /// Central differences at the nodes.
        Central = "central",
        /// Forward differences at the nodes.
        Forward = "forward",
        /// Backward differences at the nodes.
        Backward = "backward",
        /// The 3 × 3 × 3 Sobel filter at the nodes.
        Sobel = "sobel",
        /// Derivative of the trilinear interpolant at the sample.
        Interpolant = "interpolant",
        /// Central differences at the sample over `2n/(n − 1)` spacings, `n` the nodes of an axis, divided
        /// as if over two.
        Texture = "texture",
        /// Differences at the sample over twice the component of the ray's step along each axis,
        /// undivided.
        RayStep = "ray-step",
    }
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

choice! {
    /// Colour that the weight of a term of the shading applies to.
    pub enum LightColour {
        /// The colour of the sample.
        Material = "material",
        /// White.
        White = "white",
        /// Black: the term is absent.
        Black = "black",
    }
}

choice! {
    /// Numbers that hold the composited colour and opacity.
    pub enum Precision {
        /// 64 bits.
        F64 = "f64",
        /// 32 bits.
        F32 = "f32",
        /// 16 bits, IEEE half precision.
        F16 = "f16",
        /// 15 bits for [0, 1], rounded up; values outside are clamped.
        U15 = "u15",
        /// 8 bits for [0, 1]; values outside are clamped.
        U8 = "u8",
    }
}

/// A mistake of ray casters that no edit of a scene amounts to, or a choice that no file states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The first step of a ray has this length, in steps: one of those that `first_step_jitter` draws.
    FirstStep(f64),
    /// Values are looked up half a spacing on along each axis.
    LookedUpOn,
    /// Values are looked up half a spacing back along each axis.
    LookedUpBack,
    /// The volume is stored in bricks with so many nodes to an edge, without layers of their neighbours.
    BricksWithoutNeighbours(u32),
    /// Steps are counted anew at the faces of bricks with so many cells to an edge.
    StepsFromBricks(u32),
    /// A ray has so many steps at most.
    MostSteps(u32),
    /// A ray begins where its line enters the volume behind the eye.
    BeginsBehindEye,
    /// Colours are added, not composited.
    ColoursAdded,
    /// Gradients are mapped into the world as vectors are.
    GradientsAsVectors,
    /// Gradients stay in the coordinates of the volume.
    GradientsUnmapped,
    /// A volume lies as a whole in front of the next, in the order in which a ray enters their boxes.
    NearestBoxInFront,
    /// A volume lies as a whole in front of those before it in the scene.
    LastInFront,
    /// Opacities of volumes add, up to 1, in place of extinctions.
    OpacitiesAdded,
    /// Colours of volumes are their mean without weights.
    ColoursUnweighted,
    /// Surfaces lie behind all volumes.
    SurfacesBehind,
    /// Surfaces lie in front of all volumes.
    SurfacesInFront,
    /// Surfaces are cut where a ray has entered the box of a volume.
    SurfacesCutByBoxes,
    /// Volumes cast shadows as if they were not clipped.
    ShadowsUnclipped,
    /// Surfaces cast no shadow.
    NoShadowOfSurfaces,
    /// Volumes cast no shadow on surfaces.
    NoShadowOnSurfaces,
}

impl Fault {
    /// It is about several objects, which are merged.
    pub(crate) fn is_of_merged_objects(self) -> bool {
        use Fault::*;
        matches!(
            self,
            NearestBoxInFront
                | LastInFront
                | OpacitiesAdded
                | ColoursUnweighted
                | SurfacesBehind
                | SurfacesInFront
                | SurfacesCutByBoxes
                | ShadowsUnclipped
                | NoShadowOfSurfaces
                | NoShadowOnSurfaces
        )
    }
}
