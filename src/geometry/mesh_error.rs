//! Errors in meshes.

use super::ObjFault;
use glam::DVec3;
use std::fmt;
use std::path::PathBuf;
use thiserror::Error;

/// A face in a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceName {
    /// Its number, from 1.
    Number(usize),
    /// The line of the file where it begins, from 1; several triangles of a polygon have one.
    Line(usize),
}

impl fmt::Display for FaceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FaceName::Number(number) => write!(f, "face {number}"),
            FaceName::Line(line) => write!(f, "the face in line {line}"),
        }
    }
}

/// Reason for refusing a mesh.
#[derive(Debug, Error)]
pub enum MeshError {
    /// The file cannot be opened or read.
    #[error("cannot read the mesh {path}: {source}")]
    Unreadable {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The text is not a mesh in Wavefront OBJ format. The message may begin with line and column.
    #[error("{0}")]
    Format(#[from] ObjFault),
    /// The mesh has no faces.
    #[error("the mesh has no faces; a file of bare points is a point cloud, not a mesh")]
    Empty,
    /// A face refers to a vertex that does not exist.
    #[error("{face} refers to vertex {vertex}, but there are {count} (counted from 0)")]
    NoSuchVertex {
        /// The face.
        face: FaceName,
        /// The vertex it refers to, from 0.
        vertex: usize,
        /// How many there are.
        count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("{face} has the vertex {vertex}; coordinates must be finite")]
    NotFinite {
        /// The face.
        face: FaceName,
        /// The offending vertex.
        vertex: DVec3,
    },
    /// A face's corners lie on a line, up to rounding: it has no normal.
    #[error("{face} has no area: its corners {}, {} and {} lie on a line; remove it", corners[0], corners[1], corners[2])]
    Degenerate {
        /// The face.
        face: FaceName,
        /// Its corners.
        corners: [DVec3; 3],
    },
    /// The area is too large or too small for a number.
    #[error("the mesh's area is {0}: its size leaves the range of numbers; choose other units")]
    Range(f64),
    /// The surface has a border and encloses nothing.
    #[error(
        "the mesh is open: the edge from {from} to {to} belongs to {face} only; a medium or glass needs a closed boundary, so fill the hole"
    )]
    Open {
        /// One end of the edge.
        from: DVec3,
        /// The other end.
        to: DVec3,
        /// The only face there.
        face: FaceName,
    },
    /// An edge has a twin with vertices of its own, almost at the same place.
    #[error(
        "the mesh is open: the edge from {from} to {to} belongs to {face} only; another edge lies {apart:.1e} beside it, so their vertices almost coincide: merge vertices by distance, for instance in Blender or MeshLab"
    )]
    Seam {
        /// One end of the edge.
        from: DVec3,
        /// The other end.
        to: DVec3,
        /// The only face there.
        face: FaceName,
        /// Largest distance between the ends of the two edges.
        apart: f64,
    },
    /// More than two faces meet at an edge.
    #[error(
        "{count} faces meet at the edge from {from} to {to}, among them {face}; a closed boundary has exactly two at each"
    )]
    Branching {
        /// One end of the edge.
        from: DVec3,
        /// The other end.
        to: DVec3,
        /// One of the faces.
        face: FaceName,
        /// How many there are.
        count: usize,
    },
    /// Two neighbours disagree about which side is outside.
    #[error("{} and {} run along the edge from {from} to {to} in the same direction, so one of them is inside out; reverse the order of its corners", faces[0], faces[1])]
    Orientation {
        /// One end of the edge.
        from: DVec3,
        /// The other end.
        to: DVec3,
        /// The two faces.
        faces: [FaceName; 2],
    },
    /// All normals point inward.
    #[error(
        "the mesh is inside out (it encloses the volume {volume}); reverse the order of the corners of every face"
    )]
    InsideOut {
        /// Signed volume, in world units cubed: zero or negative.
        volume: f64,
    },
}
