//! The test vectors, `vectors/*.json`: volref's own functions against numbers that
//! `scripts/generate-vectors.py` computed with 60 digits.

use crate::common::entries::numbers;
use glam::DVec3;
use serde_json::Value;
use std::path::{Path, PathBuf};
use volref::compare::flip::{DEFAULT_PIXELS_PER_DEGREE, SrgbImage, flip};
use volref::film::Film;
use volref::geometry::{Aabb, Camera, Ray};
use volref::optics::{
    Asymmetry, Deflection, HenyeyGreenstein, TransferPoint, TransferPoints, over_length,
    transmittance,
};
use volref::volume::{Cell, Grid, Lattice, NodePoint};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("vectors")
}

/// The files of vectors, by name.
fn topics() -> Vec<(String, Value)> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "json")
        })
        .filter(|path| !path.ends_with("schema.json"))
        .collect();
    files.sort();
    let read = |path: PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        (
            name,
            serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap(),
        )
    };
    files.into_iter().map(read).collect()
}

fn vector(x: &[f64]) -> DVec3 {
    DVec3::new(x[0], x[1], x[2])
}

fn grid(x: &[f64]) -> (Grid<f32>, NodePoint) {
    let nodes: [usize; 3] = std::array::from_fn(|axis| x[axis] as usize);
    let spacing = vector(&x[3..]);
    let lattice = Lattice::new(nodes, spacing, DVec3::ZERO).unwrap();
    let count = nodes.iter().product::<usize>();
    // Multiples of 1/256: as floats they are what they were.
    let values = x[6..6 + count].iter().map(|&value| value as f32);
    let point = NodePoint(vector(&x[6 + count..]) / spacing);
    (Grid::new(lattice, values.collect()).unwrap(), point)
}

/// What volref makes of the inputs; nothing where it has no such function by itself.
fn of_volref(function: &str, x: &[f64]) -> Option<Vec<f64>> {
    Some(match function {
        "opacity_over_step" => vec![over_length(x[0], x[1] / x[2])],
        "transfer_function" => {
            let points = x[1..x.len() - 1].chunks(2).map(|point| TransferPoint {
                value: point[0],
                opacity: point[1],
                colour: DVec3::ONE,
            });
            let points = TransferPoints::new(points.collect()).unwrap();
            vec![points.opacity(x[x.len() - 1])]
        }
        "trilinear" => {
            let (grid, point) = grid(x);
            vec![Cell::around(grid.lattice(), point).trilinear(&grid)]
        }
        "box_span" => {
            let ray = Ray::new(vector(x), vector(&x[3..])).unwrap();
            let unit = vector(&x[3..]).length();
            let bounds = Aabb::new(vector(&x[6..]), vector(&x[9..])).unwrap();
            let span = bounds.span(&ray);
            span.map_or(Vec::new(), |span| vec![span.near / unit, span.far / unit])
        }
        "value" => {
            let phase = HenyeyGreenstein(Asymmetry::new(x[0]).unwrap());
            vec![phase.per_steradian(&Deflection::from_cos(x[1]))]
        }
        "transmittance" => vec![transmittance(x[0] * x[1])],
        "camera_ray" => {
            let fov = x[9].to_radians();
            let camera = Camera::new(vector(x), vector(&x[3..]), vector(&x[6..]), fov).unwrap();
            let [width, height, column, row] = [10, 11, 12, 13].map(|index| x[index] as usize);
            let ray = camera.ray([column, row], [width, height]);
            (*ray.direction).to_array().to_vec()
        }
        "srgb_code" => {
            let film = Film::new(1, 1, vec![[x[0] as f32; 3]]);
            vec![f64::from(film.srgb_codes(0.0)[0][0])]
        }
        "flip_mean" => {
            let (width, height) = (x[0] as usize, x[1] as usize);
            let image = |codes: &[f64]| {
                let pixels = codes.chunks(3).map(|code| [0, 1, 2].map(|c| code[c] as u8));
                SrgbImage::new(width, height, pixels.collect()).unwrap()
            };
            let (reference, test) = x[2..].split_at(3 * width * height);
            let errors = flip(&image(reference), &image(test), DEFAULT_PIXELS_PER_DEGREE);
            vec![errors.unwrap().mean()]
        }
        "half" => {
            let bits = half::f16::from_f32(f32::from_bits(x[0] as u32)).to_bits();
            vec![f64::from(bits)]
        }
        _ => return None,
    })
}

#[test]
fn volref_agrees_with_the_vectors() {
    let (mut checked, mut others) = (0, 0);
    for (file, topic) in topics() {
        for entry in topic["entries"].as_array().unwrap() {
            let function = entry["function"].as_str().unwrap();
            let inputs = numbers(&entry["inputs"]);
            let Some(found) = of_volref(function, &inputs) else {
                others += 1;
                continue;
            };
            let expected = numbers(&entry["expected"]);
            let [absolute, relative] =
                ["absolute", "relative"].map(|name| entry[name].as_f64().unwrap());
            let close = |(found, expected): (&f64, &f64)| {
                (found - expected).abs() <= absolute + relative * expected.abs()
            };
            assert!(
                found.len() == expected.len() && found.iter().zip(&expected).all(close),
                "{file}: {function}({inputs:?}) is {expected:?}, not {found:?}"
            );
            checked += 1;
        }
    }
    assert!(checked > 150 && others > 0, "{checked} {others}");
}

/// Every entry is of a declared function, whose tolerance and reason it has.
#[test]
fn the_vectors_are_as_their_schema_says() {
    let text = std::fs::read(folder().join("schema.json")).unwrap();
    let schema = jsonschema::validator_for(&serde_json::from_slice(&text).unwrap()).unwrap();
    for (file, topic) in topics() {
        if let Err(error) = schema.validate(&topic) {
            panic!("{file}: {error} at {}", error.instance_path());
        }
        assert_eq!(format!("{}.json", topic["topic"].as_str().unwrap()), file);
        for entry in topic["entries"].as_array().unwrap() {
            let of = &topic["functions"][entry["function"].as_str().unwrap()];
            assert!(of.is_object(), "{file}: {entry}");
            assert_eq!(
                (&of["absolute"], &of["relative"]),
                (&entry["absolute"], &entry["relative"])
            );
        }
    }
}
