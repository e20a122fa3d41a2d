//! Memory that only an effect needs is not taken where it is off.

use crate::effects::scenes::{parsed, plan, rendered};
use volref::render::{Event, Plan};
use volref::scene::{Model, Scene};

/// Memory of an image beside the scene and itself, by the plan.
fn reported(scene: &Scene) -> Vec<&'static str> {
    let memory = plan(scene).memory();
    memory.iter().map(|memory| memory.what).collect()
}

fn medium(keys: &str) -> String {
    format!(
        "[film]\nwidth = 4\nheight = 4\n\
         [camera]\neye = [0.1, 0.2, -3]\ntarget = [0.1, 0.1, 0.1]\nvertical_fov = 20\n\
         [sampling]\nsamples = 4\n[radiative]\nenvironment = 1\n\
         [[radiative.medium]]\ngrid = {{ file = '../../volumes/hard/hill.nrrd' }}\n{keys}\n"
    )
}

/// Bytes of the bounds that tracking needs, after the image has been made.
fn bytes_of_bounds(scene: &Scene) -> usize {
    rendered(&plan(scene));
    let Model::Radiative(scene) = &scene.panels[0].model else {
        panic!("a scene of media");
    };
    let densities = scene.media.iter().filter_map(|body| body.density.as_ref());
    densities.map(|density| density.bytes_of_blocks()).sum()
}

#[test]
fn no_bounds_on_densities_without_tracking() {
    for quiet in ["sigma_a = 1", "emission = 1", "sigma_a = 2\nemission = 1"] {
        let scene = parsed(&medium(quiet));
        assert_eq!(bytes_of_bounds(&scene), 0, "{quiet}");
        assert_eq!(reported(&scene), [""; 0], "{quiet}");
    }
    // Among paths, too, what only absorbs is an integral along a line.
    let floor = "sigma_a = 1\n[[radiative.surface]]\n\
                 sphere = { centre = [0, 0, 3], radius = 2 }\ndiffuse = { reflectance = 0.5 }";
    let scene = parsed(&medium(floor));
    assert!(plan(&scene).is_sampled());
    assert_eq!(bytes_of_bounds(&scene), 0);
    assert_eq!(reported(&scene), ["moments of the samples"]);
    let scene = parsed(&medium("sigma_s = 1"));
    // A block of eight cells a side.
    assert_eq!(bytes_of_bounds(&scene), 16);
    assert_eq!(
        reported(&scene),
        ["majorants of densities", "moments of the samples"]
    );
}

#[test]
fn no_moments_without_random_numbers() {
    for (keys, sampled) in [("sigma_a = 1", false), ("sigma_s = 1", true)] {
        let scene = parsed(&medium(keys));
        let (film, _) = rendered(&plan(&scene));
        assert_eq!(film.noise().is_some(), sampled, "{keys}");
        assert_eq!(
            reported(&scene).contains(&"moments of the samples"),
            sampled
        );
    }
}

#[test]
fn no_gradients_without_shading() {
    let text = |phong: &str| {
        format!(
            "[film]\nwidth = 4\nheight = 4\n\
             [transfer_function]\nreference_length = '1 voxel'\n\
             [classified]\n[classified.volume]\nfile = '../../volumes/hard/hill.nrrd'\n{phong}"
        )
    };
    for (phong, computed) in [
        ("", 0),
        (
            "[classified.phong]\nambient = 1\ndiffuse = 0\nspecular = 0\n",
            0,
        ),
        ("[classified.phong]\n", 6 * 6 * 6),
    ] {
        let scene = parsed(&text(phong));
        let (_, work) = rendered(&Plan::new(&scene.panels[0]));
        assert_eq!(work[Event::GradientComputed], computed);
        assert_eq!(
            reported(&scene).contains(&"gradients of the nodes"),
            computed > 0
        );
    }
}
