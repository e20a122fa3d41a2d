//! Errors in meshes.

use super::ObjFault;
use std::path::PathBuf;
use thiserror::Error;

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
    /// Its faces make no surface, or no closed one; with how to mend that.
    #[error("{0}")]
    Faces(String),
}

impl MeshError {
    /// A mesh without faces.
    pub(super) fn empty() -> MeshError {
        let message =
            "the mesh has no faces: export it as polygons; a file of bare points is a point cloud";
        MeshError::Faces(message.to_owned())
    }
}
