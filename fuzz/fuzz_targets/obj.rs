//! Any bytes are a mesh or an error, and a point cloud or an error, and any cloud is splatted or refused.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::geometry::{ClosedMesh, Mesh};
use volref::volume::{Splatting, read_obj_points, splat};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(mesh) = Mesh::from_obj(bytes) {
        assert!(mesh.vertices().iter().all(|vertex| vertex.is_finite()));
        let _ = ClosedMesh::new(mesh);
    }
    let Ok(points) = read_obj_points(bytes) else { return };
    assert!(points.iter().all(|point| point.position.is_finite() && point.weight >= 0.0));
    let splatting = Splatting {
        resolution: Some(16),
        padding: 1,
    };
    if let Ok(grid) = splat(&points, splatting) {
        assert!(grid.check_densities().is_ok());
    }
});
