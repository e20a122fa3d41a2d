//! Meshes as programs write them: every dialect of OBJ is the same cube, polygons cover what they
//! outline, and the rest is refused with its line.

use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::{ClosedMesh, Emitter, Mesh, ObjFault, Ray, Solid, Surface};

/// A cube as six squares.
const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n\
                    f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

fn read(text: impl AsRef<[u8]>) -> Result<Mesh, ObjFault> {
    Mesh::from_obj(text.as_ref())
}

type Corners = Vec<[DVec3; 3]>;

fn triangles(mesh: &Mesh) -> Corners {
    let at = |vertex: usize| mesh.vertices()[vertex];
    mesh.faces().iter().map(|face| face.map(at)).collect()
}

#[test]
fn a_cube_in_every_dialect() {
    let cube = triangles(&read(CUBE).unwrap());
    assert_eq!(cube.len(), 12);
    let each = |keyword: &str, change: &dyn Fn(&str) -> String| {
        let lines = CUBE.lines().map(|line| {
            if line.starts_with(keyword) {
                change(line)
            } else {
                line.to_owned()
            }
        });
        lines.collect::<Vec<_>>().join("\n") + "\n"
    };
    let corners = |change: &dyn Fn(i64) -> String| {
        each("f", &|line| {
            let words = line.split(' ').skip(1);
            let words = words.map(|word| change(word.parse().unwrap()));
            format!("f {}", words.collect::<Vec<_>>().join(" "))
        })
    };
    let texts = [
        format!("\u{feff}{CUBE}"),
        CUBE.replace('\n', "\r"),
        CUBE.replace('\n', "\r\n"),
        CUBE.trim_end().to_owned(),
        CUBE.replace(' ', "  \t"),
        each("", &|line| format!("{line} # {line}")),
        each("", &|line| format!("  {line}#7")),
        each("v", &|line| line.replacen("0", "\\\n 0", 1)),
        each("f", &|line| format!("{} \\\r\n{}", &line[..5], &line[5..])),
        // MeshLab, ZBrush: colours, which are not used.
        each("v", &|line| format!("{line} 0.25 0.5 1")),
        each("v", &|line| format!("{line} 0.25 0.5 1 1.000000")),
        each("v", &|line| format!("{line} 1.0")),
        each("v", &|line| {
            line.replace('1', "+1.").replace(" 0", " .0e-3")
        }),
        corners(&|of| format!("{of}/1")),
        corners(&|of| format!("{of}//1")),
        corners(&|of| format!("{of}/1/1")),
        corners(&|of| format!("{of}/")),
        corners(&|of| format!("{}", of - 9)),
        corners(&|of| format!("{}/-1/-1", of - 9)),
        // Blender, Maya, 3ds Max.
        format!(
            "# Blender\nmtllib cube.mtl\no Cube\n{}vn 0 0 -1\nvt 0 0\nvt 0.5 0.5 0\ng side top\n\
             usemtl Material #1\ns off\ns 1\n{}l 1 2\np 3\nvp 0.5\n",
            &CUBE[..64],
            &CUBE[64..]
        ),
        // Each face of its own object, material and vertices.
        each("f", &|line| format!("o {line}\nusemtl {line}\ng\n{line}")),
        // Vertices behind the faces.
        format!("{}{}", &CUBE[64..], &CUBE[..64]),
        // A corner twice in a row, and a face of two corners.
        each("f", &|line| format!("{line} {0} {0}\nf 1 2 2", &line[2..3])),
        // A curve, which is no surface.
        format!("{CUBE}cstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\nparm u 0 1\nend\n"),
    ];
    for text in &texts {
        let mesh = read(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(triangles(&mesh), cube, "{text}");
        assert_eq!(mesh.vertices().len(), 8, "{text}");
        ClosedMesh::new(mesh).unwrap_or_else(|error| panic!("{error}\n{text}"));
    }
    // Names in Latin-1.
    let latin = [&b"o caf\xe9\n# Zo\xeb\n"[..], CUBE.as_bytes()].concat();
    assert_eq!(triangles(&read(latin).unwrap()), cube);
}

#[test]
fn what_is_refused_says_where() {
    // △ stands for a triangle of points, and ⏎ ends a line.
    for line in r#"
△f 1 2 4 | 4:7: this face refers to vertex 4, but the file has 3
△f 1 2 9/4 3⏎f 8 1 2 | 4:7: this face refers to vertex 9, but the file has 3
△f -1 -2 -4 | 4:9: this face refers to vertex -4, and 3 stand before it
△f 0 1 2 | 4:3: this face refers to vertex 0, and 3 stand before it, counted from 1
△f 1 2 x | 4:7: "x" is not a corner of a face
△f 1 2 3.0 | 4:7: "3.0" is not a corner
△f 1 2 3/1/1/1 | 4:7: "3/1/1/1" is not a corner
△f 1 2 3/a | 4:7: "3/a" is not a corner
△f 1 2 99999999999999999999 | 4:7: "99999999999999999999" is not a corner
△f 1 2 9223372036854775807 | 4:7: this face refers to vertex 9223372036854775807
△f 1 -9223372036854775808 2 | 4:5: this face refers to vertex
△⏎f 1 2 | 5:1: a face has three corners or more, this one has 2
△f | 4:1: a face has three corners or more, this one has 0
v 0 0 0⏎v 1 1,5 0 | 2:5: y is "1,5", which is no finite number: write it like 0.5
v 0 0 \⏎ nan | 2:2: z is "nan", which is no finite number
v 1 2 | 1:1: a `v` line of a mesh has 3 numbers (x y z)
v 1 2 3 0.5 | 1:9: w is 0.5, and a vertex of a mesh has no weight
v 1 2 3 1 1 | 1:1: a `v` line of a mesh has 3 numbers
△vertex 1 | 4:1: "vertex" is not a keyword of the OBJ format
ply⏎format ascii 1.0 | this begins like a PLY file, and only OBJ is read: convert it
△f 1 2 3⏎surf 0 1 0 1 1 2 3 | 5:1: a free-form surface is not a polygon
call other.obj | 1:1: "call" is not a keyword of the OBJ format
△ | the mesh has no faces
 | the mesh has no faces
△deg 3⏎curv 0 1 1 2 3⏎end | the mesh has no faces: export it as polygons
△v 2 0 0⏎⏎f 1 2 3⏎f 1 2 4 | the face in line 7 has no area: its corners [0, 0, 0], [1, 0, 0] and [2, 0, 0]
△v 1 1 0⏎f 1 2 3 4 | 5:1: no fan of triangles from one corner covers this polygon, or it has no area
△v 2 3 0⏎f 1 2 3 4 | 5:1: no fan of triangles from one corner covers this polygon, or it has no area or crosses itself: triangulate
△v 2 0 0⏎v 3 0 0⏎f 1 2 4 5 | 6:1: no fan of triangles from one corner covers this polygon, or it has no area
"#
    .lines()
    .skip(1)
    {
        let (text, expected) = line.split_once(" | ").unwrap();
        let text = text.replace('△', "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
        let error = read(text.replace('⏎', "\n"));
        let error = error.unwrap_err().to_string();
        assert!(error.starts_with(expected), "{text:?}: {error}");
    }
    let error = read("\0").unwrap_err().to_string();
    assert!(error.starts_with("this is not plain text (a zero byte or UTF-16)"));
    // Two triangles that touch at a corner, one of them turned over; and one covered twice.
    let touching = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 1 -1 0\nv 0 -2 0\nf 1 2 3 1 4 5";
    let twice = "v 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3 1 2 3";
    for text in [touching, twice] {
        let error = read(text).unwrap_err().to_string();
        assert!(
            error.contains("no fan of triangles from one corner covers this polygon"),
            "{error}"
        );
    }
    let utf_16: Vec<u8> = "\u{feff}v 0 0 0\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let error = read(utf_16).unwrap_err().to_string();
    assert!(error.contains("UTF-16): save it as UTF-8"), "{error}");
    // Of closed meshes too.
    let open = CUBE.replace("f 2 4 8 6\n", "");
    let error = ClosedMesh::new(read(open).unwrap())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("belongs to the face in line 9, and a closed boundary"),
        "{error}"
    );
}

/// The cube with every vertex moved along x, and the numbers of its faces behind those of others.
fn moved_cube(x: f64) -> String {
    let lines = CUBE.lines().map(|line| match line.strip_prefix("v ") {
        Some(place) => {
            let place: Vec<f64> = place.split(' ').map(|word| word.parse().unwrap()).collect();
            format!("v {} {} {}\n", place[0] + x, place[1], place[2])
        }
        None => {
            let corners = line.split(' ').skip(1);
            let corners = corners.map(|word| format!(" {}", word.parse::<i64>().unwrap() - 9));
            format!("f{}\n", corners.collect::<String>())
        }
    });
    lines.collect()
}

#[test]
fn overlapping_shells_are_their_union() {
    let mesh = read(moved_cube(0.0) + &moved_cube(0.5) + &moved_cube(4.0)).unwrap();
    let closed = ClosedMesh::new(mesh).unwrap();
    for (start, expected) in [
        (-1.0, vec![[1.0, 2.5], [5.0, 6.0]]),
        (0.75, vec![[0.0, 0.75], [3.25, 4.25]]),
    ] {
        let ray = Ray::new(DVec3::new(start, 0.3, 0.6), DVec3::X).unwrap();
        let spans = closed.spans(&ray);
        let spans: Vec<_> = spans.iter().map(|span| [span.near, span.far]).collect();
        assert_eq!(spans, expected, "from {start}");
    }
}

/// Triangles with vertices of their own, rounded apart: not a hole to fill.
#[test]
fn vertices_that_almost_coincide() {
    let soup = |apart: f64| {
        let mut text = String::new();
        let mut count = 0.0;
        for corners in triangles(&read(CUBE).unwrap()) {
            for at in corners {
                count += 1.0;
                text += &format!("v {} {} {}\n", at.x + apart * count, at.y, at.z);
            }
            text += "f -3 -2 -1\n";
        }
        ClosedMesh::new(read(text).unwrap())
    };
    soup(0.0).unwrap();
    let error = soup(1e-9).unwrap_err().to_string();
    assert!(
        error.contains(", and a closed boundary has two faces at each"),
        "{error}"
    );
    assert!(error.contains("merge vertices by distance"), "{error}");
}

#[test]
fn meshes_of_other_formats() {
    // 80 bytes of anything, no triangle.
    let empty_stl = [&[b' '; 80][..], &[0; 4]].concat();
    let full_stl = [&[0; 80][..], &[1, 0, 0, 0], &[0; 50]].concat();
    for (bytes, expected) in [
        (&b"ply\nformat ascii 1.0\n"[..], "a PLY file, and only OBJ"),
        (
            b"ply\r\nformat binary_little_endian 1.0\r\n\0",
            "a PLY file",
        ),
        (
            b"solid \nfacet normal 0 0 1\n",
            "\"solid\" is not a keyword",
        ),
        (&empty_stl, "not plain text"),
        (&full_stl, "not plain text"),
        (b"OFF\n8 6 0\n", "\"OFF\" is not a keyword"),
        (b"glTF\x02\0\0\0", "a mesh of glTF, and only OBJ"),
    ] {
        let error = read(bytes).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// A polygon by its corners in a plane, and its area.
const POLYGONS: &[(&[[f64; 2]], f64)] = &[
    // A dart, an L.
    (&[[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]], 4.0),
    (
        &[
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [0.0, 2.0],
        ],
        3.0,
    ),
    // Corners within edges.
    (
        &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [0.0, 3.0]],
        4.5,
    ),
    (
        &[
            [0.0, 0.0],
            [0.1, 0.1],
            [0.3, 0.3],
            [0.7, 0.7],
            [0.0, 1.0],
            [0.0, 0.1],
        ],
        0.35,
    ),
];

/// Polygons that no fan covers.
const REFUSED: &[&[[f64; 2]]] = &[
    // A comb.
    &[
        [0.0, 0.0],
        [5.0, 0.0],
        [5.0, 3.0],
        [4.0, 3.0],
        [4.0, 1.0],
        [3.0, 1.0],
        [3.0, 3.0],
        [2.0, 3.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [0.0, 3.0],
    ],
    // A square with a square hole, by a slit along which the outline goes twice.
    &[
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [1.0, 1.0],
    ],
    // A spiral.
    &[
        [0.0, -1.0],
        [8.0, -1.0],
        [8.0, 8.0],
        [1.0, 8.0],
        [1.0, 2.0],
        [5.0, 2.0],
        [5.0, 5.0],
        [4.0, 5.0],
        [4.0, 3.0],
        [2.0, 3.0],
        [2.0, 7.0],
        [7.0, 7.0],
        [7.0, 0.0],
        [0.0, 0.0],
    ],
];

/// Twice the area of a polygon.
fn shoelace(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners
        .iter()
        .zip(next)
        .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
        .sum()
}

/// A prism: the polygon below and above, quadrilaterals around.
fn prism(corners: &[[f64; 2]], place: &dyn Fn([f64; 3]) -> [f64; 3]) -> String {
    let mut text = String::new();
    for height in [0.0, 1.0] {
        for &[x, y] in corners {
            let [x, y, z] = place([x, y, height]);
            text.push_str(&format!("v {x} {y} {z}\n"));
        }
    }
    let count = corners.len();
    let face = |corners: &mut dyn Iterator<Item = usize>| {
        let words: Vec<_> = corners.map(|corner| corner.to_string()).collect();
        format!("f {}\n", words.join(" "))
    };
    text.push_str(&face(&mut (1..=count).rev()));
    text.push_str(&face(&mut (count + 1..=2 * count)));
    for at in 1..=count {
        let next = at % count + 1;
        text.push_str(&face(&mut [at, next, next + count, at + count].into_iter()));
    }
    text
}

/// From each first corner, in each direction, moved, turned and scaled, a polygon covers its area
/// once, and a prism of it is closed.
#[test]
fn polygons_cover_what_they_outline() {
    let places: [&dyn Fn([f64; 3]) -> [f64; 3]; 5] = [
        &|at| at,
        &|[x, y, z]| [y, z, x],
        &|[x, y, z]| [z, x, y],
        &|[x, y, z]| [x + y - 50.0, 0.5 * y + 2.0 * z, z + x],
        &|[x, y, z]| [x * 1e65, y * 1e65, z * 1e65],
    ];
    for &(polygon, area) in POLYGONS {
        let twice = shoelace(polygon);
        assert!((twice - 2.0 * area).abs() < 1e-12, "{polygon:?}");
        for first in 0..polygon.len() {
            let mut turned = polygon.to_vec();
            turned.rotate_left(first);
            let lines = turned.iter().map(|[x, y]| format!("v {x} {y} 7\n"));
            let face: Vec<_> = (1..=turned.len()).map(|at| at.to_string()).collect();
            let lines: String = lines.collect();
            for (face, up) in [
                (face.join(" "), 1.0),
                (
                    face.iter().rev().cloned().collect::<Vec<_>>().join(" "),
                    -1.0,
                ),
            ] {
                let mesh = read(format!("{lines}f {face}\n")).unwrap();
                assert!(
                    (mesh.area() - 0.5 * twice).abs() < 1e-12 * twice,
                    "{polygon:?}"
                );
                for [a, b, c] in triangles(&mesh) {
                    assert!((b - a).cross(c - a).z * up > 0.0, "{polygon:?}");
                }
            }
            for (number, place) in places.iter().enumerate() {
                let text = prism(&turned, place);
                let mesh = read(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
                ClosedMesh::new(mesh).unwrap_or_else(|error| panic!("{number} {error}\n{text}"));
            }
        }
    }
    for polygon in REFUSED {
        let error = read(prism(polygon, &|at| at)).unwrap_err().to_string();
        let line = 2 * polygon.len() + 1;
        assert!(
            error.starts_with(&format!("{line}:1: no fan of triangles")),
            "{error}"
        );
        assert!(
            error.contains("triangulate faces when you export the mesh"),
            "{error}"
        );
    }
}

/// A polygon that is not flat keeps its corners, and each edge between its neighbours.
#[test]
fn polygons_that_are_not_flat_are_what_they_are_from_above() {
    let bent = "v 0 0 0.5\nv 4 0 0\nv 1 1 0.25\nv 0 4 0\nf 1 2 3 4\n";
    assert_eq!(read(bent).unwrap().faces(), [[0, 1, 2], [0, 2, 3]]);
    let bent = "v 4 0 0\nv 1 1 0.25\nv 0 4 0\nv 0 0 0.5\nf 1 2 3 4\n";
    let mesh = read(bent).unwrap();
    assert_eq!(mesh.faces(), [[1, 2, 3], [1, 3, 0]]);
}

/// The plainest reader sees the same triangles, to the bit: of the fixtures, and of convex polygons, whose fans images
/// have been made of.
#[test]
fn convex_polygons_are_fans_from_their_first_corner() {
    let fixture = |name| std::fs::read_to_string(format!("fixtures/meshes/{name}.obj")).unwrap();
    let octagon: String = (0..8)
        .map(|k| f64::from(k) * std::f64::consts::TAU / 8.0)
        .map(|at| (volref::math::cos(at), volref::math::sin(at), 0.01 * at))
        .map(|(x, y, z)| format!("v {x} {y} {z}\n"))
        .collect();
    let octagon = format!("{octagon}f 1 2 3 4 5 6 7 8\nf 8 7 6 5 4\nf 3 2 1 8\n");
    for text in [
        CUBE.to_owned(),
        octagon,
        fixture("gem"),
        fixture("knot"),
        fixture("ball"),
    ] {
        let (mut vertices, mut plainly) = (vec![], Corners::new());
        for line in text.lines() {
            let numbers = line.split(' ').skip(1);
            if line.starts_with("v ") {
                let at: Vec<f64> = numbers.map(|word| word.parse().unwrap()).collect();
                vertices.push(DVec3::from_slice(&at));
            } else if line.starts_with("f ") {
                let at: Vec<usize> = numbers.map(|word| word.parse().unwrap()).collect();
                let fan = (2..at.len()).map(|k| [at[0], at[k - 1], at[k]]);
                plainly.extend(fan.map(|face| face.map(|vertex| vertices[vertex - 1])));
            }
        }
        assert_eq!(triangles(&read(&text).unwrap()), plainly);
    }
}

/// A polygon of many corners that no fan covers is refused as soon as one of few.
#[test]
fn polygons_of_many_corners_take_no_time() {
    let count = 50_000;
    let mut text = String::new();
    for k in 0..count {
        let at = f64::from(k) * std::f64::consts::TAU / f64::from(count);
        let radius = if k % 2 == 0 { 1.0 } else { 1.01 };
        let (x, y) = (
            radius * volref::math::cos(at),
            radius * volref::math::sin(at),
        );
        text.push_str(&format!("v {x} {y} 0\n"));
    }
    let face: Vec<_> = (1..=count).map(|k| k.to_string()).collect();
    text.push_str(&format!("f {}\n", face.join(" ")));
    let start = std::time::Instant::now();
    assert!(
        read(&text)
            .unwrap_err()
            .to_string()
            .contains("no fan of triangles")
    );
    assert!(start.elapsed().as_secs() < 20);
}

proptest! {
    /// Any corners on a coarse lattice: they cross, touch, repeat, and lie on lines. What is read
    /// covers the area that the formula says, once, in one sense.
    #[test]
    fn any_polygon_is_covered_or_refused(corners in prop::collection::vec((0..6_i32, 0..6_i32), 3..12)) {
        let corners: Vec<[f64; 2]> =
            corners.iter().map(|&(x, y)| [f64::from(x), f64::from(y)]).collect();
        let lines: String = corners.iter().map(|[x, y]| format!("v {x} {y} 1\n")).collect();
        let face: Vec<_> = (1..=corners.len()).map(|at| at.to_string()).collect();
        match read(format!("{lines}f {}\n", face.join(" "))) {
            Ok(mesh) => {
                let twice = shoelace(&corners);
                prop_assert!((2.0 * mesh.area() - twice.abs()).abs() < 1e-9);
                for [a, b, c] in triangles(&mesh) {
                    prop_assert!((b - a).cross(c - a).z * twice > 0.0);
                }
                prop_assert!(mesh.bounds().size().z == 0.0);
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}
