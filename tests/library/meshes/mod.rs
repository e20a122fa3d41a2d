//! Meshes made from formulas: the fixtures, and what the laws are tried on.

use glam::DVec3;
use std::f64::consts::TAU;
use std::fmt::Write;
use volref::geometry::{Aabb, ClosedMesh, Mesh};
use volref::math::{cos, sin};

/// Vertices and faces.
pub type Parts = (Vec<DVec3>, Vec<[usize; 3]>);

pub fn closed((vertices, faces): Parts) -> ClosedMesh {
    ClosedMesh::new(Mesh::new(vertices, faces).unwrap()).unwrap()
}

/// A box of twelve triangles.
pub fn cuboid(min: DVec3, max: DVec3) -> Parts {
    let mesh = Mesh::cuboid(&Aabb::new(min, max).unwrap()).unwrap();
    (mesh.vertices().to_vec(), mesh.faces().to_vec())
}

/// A sphere of radius 1 of `20·4^levels` triangles, its vertices on the sphere.
pub fn icosphere(levels: u32) -> Parts {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut vertices = Vec::new();
    for (a, b) in [
        (1.0, golden),
        (-1.0, golden),
        (1.0, -golden),
        (-1.0, -golden),
    ] {
        vertices.extend([
            DVec3::new(a, b, 0.0),
            DVec3::new(0.0, a, b),
            DVec3::new(b, 0.0, a),
        ]);
    }
    let near = |a: usize, b: usize| (vertices[a] - vertices[b]).length() < 2.5;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let out = (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]);
                    faces.push(if out.dot(vertices[a]) > 0.0 {
                        [a, b, c]
                    } else {
                        [a, c, b]
                    });
                }
            }
        }
    }
    vertices.iter_mut().for_each(|v| *v /= v.length());
    for _ in 0..levels {
        faces = subdivided(&mut vertices, &faces);
    }
    (vertices, faces)
}

fn subdivided(vertices: &mut Vec<DVec3>, faces: &[[usize; 3]]) -> Vec<[usize; 3]> {
    let mut middles = std::collections::HashMap::new();
    let mut middle = |a: usize, b: usize| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let sum = vertices[a] + vertices[b];
            vertices.push(sum / sum.length());
            vertices.len() - 1
        })
    };
    let mut finer = Vec::new();
    for &[a, b, c] in faces {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    finer
}

/// A closed tube along a trefoil knot, about 2 across, in `along × around` quadrilaterals.
pub fn knot(along: usize, around: usize) -> Parts {
    let mut vertices = Vec::new();
    for i in 0..along {
        let turn = TAU * i as f64 / along as f64;
        let centre = trefoil(turn);
        // Frame from the curve's direction and the knot's own axis, which are never parallel.
        let direction = (trefoil(turn + 1e-4) - trefoil(turn - 1e-4)).normalize();
        let side = direction.cross(DVec3::Y).normalize();
        let up = side.cross(direction);
        for j in 0..around {
            let angle = TAU * j as f64 / around as f64;
            vertices.push(centre + (side * cos(angle) + up * sin(angle)) * 0.2);
        }
    }
    let at = |i: usize, j: usize| i % along * around + j % around;
    let mut faces = Vec::new();
    for i in 0..along {
        for j in 0..around {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    (vertices, faces)
}

fn trefoil(turn: f64) -> DVec3 {
    let radius = 0.7 + 0.28 * cos(3.0 * turn);
    DVec3::new(
        radius * cos(2.0 * turn),
        0.32 * sin(3.0 * turn),
        radius * sin(2.0 * turn),
    )
}

/// A cut stone: table, crown, girdle and pavilion with `sides` sides, about 2 across; its table
/// is up.
pub fn gem(sides: usize) -> Parts {
    let rings = [
        (0.55, 0.45, 0.5),
        (0.85, 0.25, 0.0),
        (1.0, 0.05, 0.5),
        (1.0, -0.05, 0.5),
        (0.55, -0.5, 0.0),
    ];
    let mut vertices = vec![DVec3::new(0.0, 0.45, 0.0), DVec3::new(0.0, -0.95, 0.0)];
    for (radius, height, shift) in rings {
        for i in 0..sides {
            let angle = TAU * (i as f64 + shift) / sides as f64;
            vertices.push(DVec3::new(radius * cos(angle), height, radius * sin(angle)));
        }
    }
    let at = |ring: usize, i: usize| 2 + ring * sides + i % sides;
    let mut faces = Vec::new();
    for i in 0..sides {
        faces.push([0, at(0, i + 1), at(0, i)]);
        faces.push([1, at(4, i), at(4, i + 1)]);
        for ring in 0..4 {
            let (upper, lower) = (rings[ring].2, rings[ring + 1].2);
            let [a, b, c, d] = [
                at(ring, i),
                at(ring, i + 1),
                at(ring + 1, i),
                at(ring + 1, i + 1),
            ];
            // The diagonal that leans with the shift makes even kites and triangles.
            if upper > lower {
                faces.extend([[a, d, c], [a, b, d]]);
            } else {
                faces.extend([[a, b, c], [b, d, c]]);
            }
        }
    }
    (vertices, faces)
}

/// The mesh as OBJ text, coordinates to six decimals.
pub fn obj(comment: &str, (vertices, faces): &Parts) -> String {
    let mut text = format!("# {comment}\n");
    for v in vertices {
        // Adding 0 writes −0 as 0.
        let [x, y, z] = v.to_array().map(|c| (c * 1e6).round() / 1e6 + 0.0);
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for [a, b, c] in faces {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}
