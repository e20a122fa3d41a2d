//! Where the light stands if a scene does not say it.

use glam::DVec3;
use volref::geometry::Camera;
use volref::scene::{Model, Scene};

const NODES: [usize; 3] = [5, 7, 4];

const STANDING: [usize; 3] = [0, 1, 2];

/// A scene whose light has no position: densities that rise along every axis, looked at askew.
/// Axis `i` of it is axis `axes[i]` of the scene as it stands.
fn scene(folder: &std::path::Path, axes: [usize; 3], [eye, target, up]: [DVec3; 3]) -> Scene {
    let nodes = axes.map(|axis| NODES[axis]);
    let mut bytes = Vec::new();
    for n in nodes {
        bytes.extend((n as i32).to_le_bytes());
    }
    for n in nodes {
        bytes.extend(((n - 1) as f32).to_le_bytes());
    }
    for index in 0..nodes.iter().product() {
        let node = [
            index % nodes[0],
            index / nodes[0] % nodes[1],
            index / (nodes[0] * nodes[1]),
        ];
        let mut standing = [0; 3];
        (0..3).for_each(|i| standing[axes[i]] = node[i]);
        let [x, y, z] = standing.map(|n| n as f32);
        bytes.extend((0.1 + 0.03 * x + 0.02 * y * y + 0.05 * z).to_le_bytes());
    }
    std::fs::write(folder.join("grid.bin"), bytes).unwrap();
    let [eye, target, up] = [eye, target, up].map(|v| {
        let [x, y, z] = axes.map(|axis| v[axis]);
        format!("[{x}, {y}, {z}]")
    });
    let text = format!(
        "[film]\nwidth = 16\nheight = 12\n\
         [camera]\neye = {eye}\ntarget = {target}\nup = {up}\n\
         [classified]\nstep = 0.25\n[classified.volume]\nfile = \"grid.bin\"\n[classified.phong]\n\
         [classified.shadow]\nstep = 0.25\nreference_step = 0.0625\n"
    );
    Scene::parse(&text, &folder.join("scene.toml")).unwrap()
}

fn light(scene: &Scene) -> DVec3 {
    match &scene.panels[0].model {
        Model::Classified(scene) => scene.light,
        _ => unreachable!("a classified volume"),
    }
}

/// Views of the volume, whose middle is (2, 3, 1.5): eye, target and up.
fn views() -> impl Iterator<Item = [DVec3; 3]> {
    let middle = DVec3::new(2.0, 3.0, 1.5);
    let towards = [
        DVec3::new(0.0, 0.0, -12.0),
        DVec3::new(3.0, -10.0, -4.0),
        DVec3::new(-2.0, 11.0, 5.0),
        DVec3::new(9.0, 1.0, 6.0),
    ];
    // Of any length, and leaning towards the eye or away from it.
    let ups = [
        DVec3::Y,
        DVec3::new(0.5, 3.0, -0.25),
        DVec3::new(1.0, 0.125, -7.0),
    ];
    towards
        .into_iter()
        .flat_map(move |back| ups.map(|up| [middle + back, middle, up]))
        .filter(|[eye, target, up]| Camera::new(*eye, *target, *up, 1.0).is_ok())
}

/// The light stands above the eye in the image, never nearer to the target than the eye, whichever
/// way is up and however it leans.
#[test]
fn the_light_is_above_the_eye_and_outside_of_the_volume() {
    let folder = tempfile::tempdir().unwrap();
    let mut seen = 0;
    for view in views() {
        let [eye, target, up] = view;
        let scene = scene(folder.path(), STANDING, view);
        let above = light(&scene) - eye;
        let away = (target - eye).length();
        // Some roundings of numbers up to 20.
        assert!((above.length() - away).abs() < 1e-13, "{view:?}");
        assert!(above.dot(target - eye).abs() < 1e-12, "{view:?}");
        assert!(above.dot(up) > 0.0, "{view:?}");
        let Model::Classified(classified) = &scene.panels[0].model else {
            unreachable!()
        };
        let bounds = classified.grid.lattice().bounds();
        let light = light(&scene);
        let inside = light.cmpge(bounds.min) & light.cmple(bounds.max);
        assert!(!inside.all(), "{view:?}");
        seen += 1;
    }
    assert!(seen >= 11);
}
