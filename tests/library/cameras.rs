//! Cameras by a matrix and intrinsics: their rays are those of the formula, and every renderer and export takes them.

use crate::common::suite::film_of;
use crate::ray_caster::scenes::hash;
use glam::{DMat3, DVec3};
use std::path::Path;
use volref::film::{Depth, Film};
use volref::geometry::{Camera, Intrinsics};
use volref::render::Sampling;
use volref::scene::{Model, Scene};
use volref::{conventions, reference};

const SIZE: [usize; 2] = [16, 12];

const INTRINSICS: Intrinsics = Intrinsics {
    focal_lengths: [17.0, 14.0],
    centre: [5.0, 7.5],
};

/// A turn about some axis, and an eye.
fn rows(seed: usize) -> [[f64; 4]; 4] {
    let number = |at: usize| 2.0 * hash(11, 8 * seed + at) - 1.0;
    let axis = DVec3::new(number(0), number(1), number(2)).normalize();
    let turn = DMat3::from_axis_angle(axis, 3.0 * number(3));
    let row = |k: usize| {
        [
            turn.col(0)[k],
            turn.col(1)[k],
            turn.col(2)[k],
            5.0 * number(4 + k),
        ]
    };
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

/// The ray of a pixel by the formula, of length 1 along -z.
fn along(rows: [[f64; 4]; 4], intrinsics: Intrinsics, [x, y]: [f64; 2]) -> DVec3 {
    let Intrinsics {
        focal_lengths: [across, down],
        centre: [cx, cy],
    } = intrinsics;
    let inside = [(x - cx) / across, -(y - cy) / down, -1.0];
    let row = |k: usize| (0..3).map(|at| rows[k][at] * inside[at]).sum();
    DVec3::new(row(0), row(1), row(2))
}

#[test]
fn rays_are_those_of_the_formula() {
    for seed in 0..20 {
        let rows = rows(seed);
        let camera = Camera::of_matrix(rows, INTRINSICS, SIZE).unwrap();
        assert!(!camera.is_centred());
        assert_eq!(camera.eye, DVec3::new(rows[0][3], rows[1][3], rows[2][3]));
        for [column, row] in [[0, 0], [15, 0], [4, 7], [9, 11]] {
            let ray = camera.ray([column, row], SIZE);
            let right = along(rows, INTRINSICS, [column as f64 + 0.5, row as f64 + 0.5]);
            assert!(
                (*ray.direction - right.normalize()).length() < 1e-14,
                "{seed}"
            );
            // The depth of a point is its distance along the axis, as of -z in the camera.
            let depth = camera.axis.dot(*ray.direction) * right.length();
            assert!((depth - 1.0).abs() < 1e-14);
        }
        let found = camera.intrinsics(SIZE).unwrap();
        let pairs = [
            (found.focal_lengths, INTRINSICS.focal_lengths),
            (found.centre, INTRINSICS.centre),
        ];
        for ([a, b], [c, d]) in pairs {
            assert!((a - c).abs() < 1e-12 && (b - d).abs() < 1e-12, "{found:?}");
        }
        // Seen through the same pixel: what lies further right, and what a longer lens shows.
        let moved = camera.with_image_moved([1.0 / 12.0, 0.0]).ray([5, 3], SIZE);
        let before = camera.ray([4, 3], SIZE);
        assert!((*moved.direction - *before.direction).length() < 1e-14);
        let wider = camera.with_vertical_fov(2.0 * volref::math::atan2(0.75, 1.0));
        let lengths = wider.intrinsics(SIZE).unwrap();
        let ratio = lengths
            .focal_lengths
            .map(|length| length / lengths.focal_lengths[1]);
        assert!((ratio[0] - 17.0 / 14.0).abs() < 1e-12);
        assert!((lengths.centre[0] - 5.0).abs() < 1e-12 && (lengths.centre[1] - 7.5).abs() < 1e-12);
    }
}

/// A camera in the middle, of square pixels, is the one that looks at a target.
#[test]
fn a_matrix_says_what_eye_and_target_say() {
    let (eye, target, up) = (
        DVec3::new(2.0, 1.0, 4.0),
        DVec3::new(0.5, 0.0, 0.0),
        DVec3::Y,
    );
    let looking = Camera::new(eye, target, up, 0.7).unwrap();
    let [back, up] = [-*looking.axis, *looking.upright];
    let right = up.cross(back);
    let row = |k: usize| [right[k], up[k], back[k], eye[k]];
    let focal_length = 6.0 / volref::math::tan(0.35);
    let intrinsics = Intrinsics {
        focal_lengths: [focal_length; 2],
        centre: [8.0, 6.0],
    };
    let matrix = [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]];
    let camera = Camera::of_matrix(matrix, intrinsics, SIZE).unwrap();
    assert!(camera.is_centred() && looking.is_centred());
    assert!((camera.vertical_fov() - 0.7).abs() < 1e-12);
    for pixel in [[0, 0], [15, 11], [3, 8]] {
        let [a, b] = [&camera, &looking].map(|camera| camera.ray(pixel, SIZE));
        assert!((*a.direction - *b.direction).length() < 1e-14);
    }
}

const CAMERA: &str = "
[film]
width = 24
height = 18
[camera]
matrix = [[0.8, 0, 0.6, 2.4], [0, 1, 0, 0.1], [-0.6, 0, 0.8, 3.2], [0, 0, 0, 1]]
fl_x = 40
fl_y = 34
cx = 9
cy = 10.5
";

fn scene(rest: &str) -> Scene {
    let text = format!("{CAMERA}{rest}");
    Scene::parse(&text, Path::new("scene.toml")).unwrap_or_else(|error| panic!("{error}"))
}

fn by_both(scene: &Scene) -> [Film; 2] {
    let fast = film_of(scene);
    [
        fast,
        reference::render(scene, Sampling::default(), &[true]).unwrap(),
    ]
}

const VOLUME: &str = "
[classified.volume]
field = \"ramp\"
nodes = [5, 5, 5]
spacing = [0.5, 0.5, 0.5]
origin = [-1, -1, -1]
value = 0
slope = [1, 0.5, 0.25]
[transfer_function]
reference_length = 1
point = [{ value = -1, colour = [1, 0.2, 0.1], opacity = 0.5 }, { value = 1, colour = [0, 0.5, 1], opacity = 0.9 }]
";

/// The plain renderers, the fast ones and the caster of conventions see the same, with depth.
#[test]
fn every_renderer_takes_a_matrix() {
    for before in [
        "",
        "phong = {}\nshadow = {}\n",
        "mode = \"mean\"\nwindow = { low = -1, high = 1 }\n",
    ] {
        let scene = scene(&format!("[classified]\n{before}{VOLUME}"));
        let [fast, plain] = by_both(&scene);
        assert_eq!(fast, plain, "{before}");
        let Model::Classified(volume) = &scene.panels[0].model else {
            unreachable!()
        };
        let size = [24, 18];
        // The middle of the volume is on the axis: it is seen about (cx, cy), and the rest beside it.
        let opacity = fast.opacity().unwrap();
        assert!(opacity[10 * 24 + 9] > 0.0 && opacity[23] == 0.0);
        if volume.mode.name().is_none() {
            assert_eq!(conventions::render(volume, size), plain);
            let wanted = Depth {
                along_view: true,
                half: false,
            };
            let depth = volref::render::depth(&scene, wanted).unwrap();
            let plain = reference::depth::render(volume, size, wanted);
            let pairs = depth.iter().zip(&plain);
            assert!(pairs.clone().all(|(a, b)| a == b || (a - b).abs() < 1e-5));
            assert!(pairs.filter(|(a, _)| a.is_finite()).count() > 50);
        }
    }
    let lit = scene(
        "[radiative]\nenvironment = 0.5\n[[radiative.surface]]\nsphere = { centre = [0, 0, 0], radius = 1 }\n\
                     emitter = { radiance = [1, 2, 3] }\n",
    );
    let [fast, plain] = by_both(&lit);
    // Through the centres of pixels the plain one, the mean of each the fast one: inside of the ball they agree.
    assert_eq!(fast.radiance()[10 * 24 + 9], plain.radiance()[10 * 24 + 9]);
}
