//! Conventions with several choices.

use crate::scene::SceneResult;
use crate::scene::reader::{Reader, Value};
use crate::scene::record::Choice;
use toml::Spanned;
use toml::de::DeValue;

choice! {
    /// Composition of several volumes.
    pub enum Composition {
        /// Extinctions add; colours are their mean weighted by extinction.
        Merged = "merged",
        /// One volume as a whole in front of the next, in the order in which a ray enters their boxes.
        NearestBox = "nearest-box",
        /// Each volume as a whole in front of those before it in the scene.
        LastInFront = "last-in-front",
        /// Opacities add, up to 1, in place of extinctions.
        AddedOpacities = "added-opacities",
        /// Colours are their mean without weights.
        MeanColours = "mean-colours",
    }
}

choice! {
    /// Depth of surfaces among volumes.
    pub enum SurfaceDepth {
        /// Where they stand.
        True = "true",
        /// Behind all volumes.
        Behind = "behind",
        /// In front of all volumes.
        InFront = "in-front",
        /// Cut where a ray has entered the box of a volume.
        Box = "box",
    }
}

choice! {
    /// Shadows among several volumes and surfaces.
    pub enum ObjectShadows {
        /// All volumes and surfaces shadow all.
        All = "all",
        /// Volumes cast shadows as if they were not clipped.
        Unclipped = "unclipped",
        /// None of surfaces.
        NoneOfSurfaces = "none-of-surfaces",
        /// None of volumes on surfaces.
        NoneOnSurfaces = "none-on-surfaces",
    }
}

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
    /// Place at which values are looked up.
    pub enum Lookup {
        /// The place of the sample.
        Exact = "exact",
        /// Half a spacing on along each axis.
        HalfOn = "half-on",
        /// Half a spacing back along each axis.
        HalfBack = "half-back",
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
    /// Map of the gradients of a volume that a map places in the world.
    pub enum NormalTransform {
        /// The inverse transpose, as gradients are mapped.
        Gradient = "gradient",
        /// The map itself, as vectors are mapped.
        Vector = "vector",
        /// None: gradients stay in the coordinates of the volume.
        None = "none",
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
