//! Work that is known in closed form.

use crate::effects::scenes::{parsed, plan, rendered};
use glam::DVec3;
use proptest::prelude::*;
use std::sync::Arc;
use volref::geometry::{Aabb, Boundary, Camera};
use volref::optics::{Coefficients, Density, Field, Homogeneous, Phase};
use volref::render::counters::Event;
use volref::render::plan::Kernel;
use volref::render::{Counters, Plan};
use volref::scene::{Body, Model, Panel, Radiative, Scattering, Scene};
use volref::volume::{Grid, GridDensity, Interpolation, Lattice};

const SIZE: usize = 5;

/// A medium of a grid before a bright environment.
fn grid_scene(
    grid: Arc<Grid<f32>>,
    interpolation: Interpolation,
    (sigma_a, sigma_s, emission): (f64, f64, f64),
    camera: Camera,
) -> Scene {
    let bounds: Aabb = grid.lattice().bounds();
    let field = Field::Grid(GridDensity::new(grid, interpolation));
    let coefficients = Coefficients::new(DVec3::splat(sigma_a), DVec3::splat(sigma_s)).unwrap();
    let body = Body {
        boundary: Some(Boundary::Box(bounds)),
        medium: Homogeneous {
            coefficients,
            emission: DVec3::splat(emission),
            phase: Phase::ISOTROPIC,
        },
        density: Some(Density::new(field, bounds, None)),
    };
    let radiative = Radiative {
        scattering: Scattering::Multiple(None),
        objects: vec![],
        area_lights: vec![],
        media: vec![body],
        lights: vec![],
        environment: DVec3::ONE,
        camera,
        samples: 4,
        seed: 1,
    };
    let model = Model::from(radiative);
    Scene::of(Panel::of(model, [SIZE, SIZE]))
}

fn lattice() -> impl Strategy<Value = Lattice> {
    let nodes = prop::array::uniform3(2..9_usize);
    let spacing = prop::array::uniform3(0.2..2.0_f64);
    let first = prop::array::uniform3(-3.0..3.0_f64);
    (nodes, spacing, first).prop_map(|(nodes, spacing, first)| {
        Lattice::new(nodes, DVec3::from_array(spacing), DVec3::from_array(first)).unwrap()
    })
}

/// An eye around the middle of a box, near or inside, looking somewhere into it: no ray runs along
/// an axis or through an edge but by a chance of none.
fn camera(bounds: Aabb, [x, y, z]: [f64; 3], target: [f64; 3]) -> Camera {
    let (centre, size) = (bounds.centre(), bounds.size());
    let eye = centre + size * DVec3::new(x, y, z);
    let target = bounds.min + size * DVec3::from_array(target);
    let towards = (target - eye).normalize();
    let up = if towards.y.abs() > 0.9 {
        DVec3::X
    } else {
        DVec3::Y
    };
    Camera::new(eye, target, up, 0.9).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    /// However light is traced, nothing is looked up in what is the same everywhere.
    #[test]
    fn a_constant_grid_takes_none(
        lattice in lattice(),
        density in 0.1..2.0_f32,
        albedo in 0.0..1.0_f64,
        eye in prop::array::uniform3(-1.3..1.3_f64),
    ) {
        let camera = camera(lattice.bounds(), eye, [0.4, 0.5, 0.6]);
        let values = vec![density; lattice.node_count()];
        let grid = Arc::new(Grid::new(lattice, values).unwrap());
        let medium = (0.5 * (1.0 - albedo), 0.5 * albedo, 0.1);
        let scene = grid_scene(grid, Interpolation::Trilinear, medium, camera);
        let (_, work) = rendered(&plan(&scene));
        prop_assert_eq!(work[Event::DensityLookup], 0);
        prop_assert_eq!(work[Event::CellWalked], 0);
        prop_assert_eq!(work[Event::NullCollision], 0);
    }
}

/// A grid of nothing is no medium at all, whatever it is made of.
#[test]
fn an_empty_grid_takes_nothing() {
    let lattice = Lattice::new([5, 6, 7], DVec3::ONE, DVec3::ZERO).unwrap();
    let empty = || Arc::new(Grid::new(lattice, vec![0.0; lattice.node_count()]).unwrap());
    let camera = camera(lattice.bounds(), [0.2, 0.3, -2.0], [0.5, 0.4, 0.6]);
    for medium in [(0.3, 0.0, 0.0), (0.1, 0.4, 0.0), (0.1, 0.4, 1.0)] {
        let scene = grid_scene(empty(), Interpolation::Trilinear, medium, camera);
        let (film, work) = rendered(&plan(&scene));
        assert_eq!(work, Counters::default());
        assert!(film.radiance().iter().all(|pixel| *pixel == [1.0; 3]));
    }
}

/// The same for a classified volume, whose opaque corner the rays do not meet; and one without an
/// opaque corner is not there at all.
#[test]
fn the_transparent_part_of_a_volume_takes_nothing_but_cells() {
    let text = |floor: &str| {
        format!(
            "[film]\nwidth = 6\nheight = 6\n\
             [camera]\neye = [0.1, 0.1, -2]\ntarget = [0.1, 0.1, 1]\nvertical_fov = 4\n\
             [transfer_function]\nreference_length = 0.1\npoint = [\n\
             {{ value = {floor}, colour = 1, opacity = 0 }},\n\
             {{ value = 9, colour = 1, opacity = 0.5 }} ]\n\
             [classified]\nearly_termination = 0.5\n[classified.phong]\n[classified.shadow]\n\
             [classified.volume]\nfile = '../../volumes/hard/spike.nrrd'\n"
        )
    };
    let scene = parsed(&text("0"));
    let (_, work) = rendered(&plan(&scene));
    let nodes = match &scene.panels[0].model {
        Model::Classified(scene) => scene.grid.lattice().node_count(),
        _ => unreachable!(),
    };
    assert!(work[Event::CellWalked] > 0);
    let expected = Counters::from([
        (Event::CellWalked, work[Event::CellWalked]),
        (Event::GradientComputed, nodes as u64),
    ]);
    assert_eq!(work, expected);

    let scene = parsed(&text("8"));
    let plan = Plan::new(&scene.panels[0]);
    assert!(matches!(plan.kernel, Kernel::Background(_)));
    let (_, work) = rendered(&plan);
    assert_eq!(work, Counters::default());
    let said: Vec<_> = plan
        .warnings
        .iter()
        .map(|warning| warning.reason.as_str())
        .collect();
    let nothing = "every value, from 0 to 1, has opacity 0";
    assert_eq!(
        said,
        [
            format!("shading has no effect: {nothing}"),
            format!("the shadow has no effect: {nothing}"),
            format!("early termination has no effect: {nothing}"),
        ]
    );
}
