//! Point clouds in Wavefront OBJ: the `v` lines, and nothing else.

use super::error::{VolumeFault, refused};
use super::load_options::LoadOptions;
use super::samples::{Stored, VolumeRead};
use super::source::VolumeSource;
use super::splat::{CloudPoint, splat};
use crate::geometry::{Aabb, ObjFault, Statements, Word};
use glam::DVec3;

/// Largest point cloud read, in bytes: 4 GiB, some hundred million points.
const MOST_BYTES: u64 = 1 << 32;

/// Reads a point cloud as a volume, splatted to a grid.
pub(super) fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let points = read_obj_points(&source.all(MOST_BYTES, "thin the cloud out")?)?;
    let grid = splat(&points, options.splatting)?;
    let extent = Aabb::around(points.iter().map(|point| point.position));
    let stored = Stored::Cloud {
        points: points.len(),
        extent: extent.expect("a point"),
    };
    Ok((grid, stored))
}

/// Reads the points of a Wavefront OBJ file, in file order.
///
/// `v x y z` has weight 1, `v x y z d` weight `d`, `v x y z r g b` weight 1: colours must be
/// numbers but are not used. Every other keyword of the format is skipped; an unknown one is an
/// error. At least one point is returned, and at least one weight is positive.
pub fn read_obj_points(bytes: &[u8]) -> Result<Vec<CloudPoint>, VolumeFault> {
    let mut points = Vec::new();
    let mut statements = Statements::of(bytes)?;
    let mut words = Vec::new();
    while statements.read_next(&mut words) {
        let Some((keyword, numbers)) = words.split_first() else {
            continue;
        };
        if keyword.keyword()? == "v" {
            points.push(point(keyword, numbers)?);
        }
    }
    if points.is_empty() {
        return refused("no point: a point cloud has a line `v x y z` for every point");
    }
    Ok(points)
}

fn point(keyword: &Word, numbers: &[Word]) -> Result<CloudPoint, ObjFault> {
    let names: &[&str] = match numbers.len() {
        3 => &["x", "y", "z"],
        4 => &["x", "y", "z", "the density"],
        6 => &["x", "y", "z", "red", "green", "blue"],
        count => {
            return Err(keyword.fault(format!(
                "a `v` line has 3 numbers (x y z), 4 (x y z density) or 6 (x y z red green blue), \
                 this one has {count}"
            )));
        }
    };
    let mut values = [0.0; 6];
    for ((value, word), name) in values.iter_mut().zip(numbers).zip(names) {
        *value = word.number(name)?;
    }
    let [x, y, z, density, ..] = values;
    let weight = if numbers.len() == 4 { density } else { 1.0 };
    if weight < 0.0 {
        return Err(numbers[3].fault(format!(
            "the density is {weight}, and must not be negative: correct or remove this point"
        )));
    }
    Ok(CloudPoint {
        position: DVec3::new(x, y, z),
        weight,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(text: &str) -> Vec<([f64; 3], f64)> {
        let points = read_obj_points(text.as_bytes()).unwrap();
        let pair = |point: &CloudPoint| (point.position.to_array(), point.weight);
        points.iter().map(pair).collect()
    }

    fn message(bytes: &[u8]) -> String {
        read_obj_points(bytes).unwrap_err().to_string()
    }

    #[test]
    fn the_three_forms_of_a_point() {
        assert_eq!(
            points("v 1 2 3\nv 1 2 3 0.25\nv -1 +2.5 3e-1 0.1 0.2 0.3\n"),
            [
                ([1.0, 2.0, 3.0], 1.0),
                ([1.0, 2.0, 3.0], 0.25),
                ([-1.0, 2.5, 0.3], 1.0)
            ]
        );
        // A point without density is still a point.
        assert_eq!(points("v 0 0 0 0\nv 1 1 1 2").len(), 2);
    }

    #[test]
    fn what_stands_around_points_is_skipped() {
        let text = "# cloud\nmtllib a.mtl\no Cube\n\ng a b\nusemtl x\ns off\nv 1 2 3 # one\n\
                    vn 0 0 1\nvt 0 0\nvp 0\np 1\np 1 1 1\nl 1 1\nf 1//1 1//1 1//1\nv 4 5 6#two";
        assert_eq!(
            points(text),
            [([1.0, 2.0, 3.0], 1.0), ([4.0, 5.0, 6.0], 1.0)]
        );
    }

    #[test]
    fn blanks_line_ends_and_marks() {
        let two = [([1.0, 2.0, 3.0], 1.0), ([4.0, 5.0, 6.0], 0.5)];
        for text in [
            "v 1 2 3\nv 4 5 6 0.5",
            "v 1 2 3\r\nv 4 5 6 0.5\r\n",
            "v 1 2 3\rv 4 5 6 0.5\r",
            "\u{feff}v 1 2 3\n\n\n \t v\t4  5\t6 0.5 \t\n",
            "v 1 \\\n 2 3\nv 4 5\\\r\n6 0.5\n",
            "v \\ \n\\\n1 2 3\nv 4 5 6 0.5",
            "# ends in a path C:\\\nv 1 2 3 # C:\\\nv 4 5 6 0.5\n",
        ] {
            assert_eq!(points(text), two, "{text:?}");
        }
    }

    #[test]
    fn comments_and_names_may_be_in_any_encoding() {
        let latin_1 = b"# caf\xe9\no caf\xe9\nv 1 2 3 # \xb5m\n";
        assert_eq!(read_obj_points(latin_1).unwrap().len(), 1);
        assert_eq!(
            message(b"v 1 2 3\nv 1 2\xb5 3"),
            "2:5: y is \"2\u{fffd}\", which is no finite number: write it like 0.5 or 5e-1"
        );
    }

    #[test]
    fn files_without_points_say_what_they_have() {
        assert!(message(b"").starts_with("no point"));
        assert!(message(b"vn 0 0 1\nf 1 2 3\nf 1 2 3").starts_with("no point"));
        assert!(message(b"\xef\xbb\xbf").starts_with("no point"));
    }

    #[test]
    fn other_encodings_and_binary_files() {
        let expected = "this is not plain text (a zero byte or UTF-16): save it as UTF-8 or ASCII";
        for bytes in [&b"\xff\xfev\0 \0"[..], b"\xfe\xff\0v", b"v 1 2 3\n\0"] {
            assert_eq!(message(bytes), expected);
        }
    }

    #[test]
    fn unknown_keywords_name_their_line() {
        for (text, position, shown) in [
            ("v 1 2 3\n\n  vertex 1 2 3", "3:3", "vertex"),
            ("V 1 2 3", "1:1", "V"),
            ("1 2 3", "1:1", "1"),
        ] {
            assert_eq!(
                message(text.as_bytes()),
                format!(
                    "{position}: \"{shown}\" is not a keyword of the OBJ format: points begin with \
                     `v`, faces with `f`; remove the line or put `#` before it"
                )
            );
        }
    }

    #[test]
    fn lines_with_the_wrong_count_of_numbers() {
        for (count, line) in [
            (0, "v"),
            (2, "v 1 2"),
            (5, "v 1 2 3 4 5"),
            (7, "v 1 2 3 4 5 6 7"),
        ] {
            assert_eq!(
                message(format!("v 0 0 0\n{line}\nv 0 0 0").as_bytes()),
                format!(
                    "2:1: a `v` line has 3 numbers (x y z), 4 (x y z density) or 6 (x y z red \
                     green blue), this one has {count}"
                )
            );
        }
    }

    #[test]
    fn bad_numbers_name_their_place() {
        for (text, expected) in [
            ("v 1 2,5 3", "1:5: y is \"2,5\", which is no finite number"),
            ("\nv 1 2 z", "2:7: z is \"z\", which is no finite number"),
            (
                "v 1 \\\n 0x1 3",
                "2:2: y is \"0x1\", which is no finite number",
            ),
            ("v nan 2 3", "1:3: x is \"nan\", which is no finite number"),
            (
                "v 1 2 -inf",
                "1:7: z is \"-inf\", which is no finite number",
            ),
            (
                "v 1 2 1e999",
                "1:7: z is \"1e999\", which is no finite number",
            ),
            (
                "v 1 2 3 NaN",
                "1:9: the density is \"NaN\", which is no finite number",
            ),
            (
                "v 1 2 3 -0.5",
                "1:9: the density is -0.5, and must not be negative: correct or remove this point",
            ),
            (
                "v 1 2 3 0 x 0",
                "1:11: green is \"x\", which is no finite number",
            ),
        ] {
            let message = message(text.as_bytes());
            assert!(message.starts_with(expected), "{text:?}: {message}");
        }
    }
}
