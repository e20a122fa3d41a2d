//! The four properties that volref was asked to hold, each under its name: gradient symmetry,
//! trilinear agreement at grid nodes, front to back equals back to front, and
//! perceptual-diff snapshots of figures 1 to 5.
//!
//! Each is stated here in its plainest form. The laws over their whole domains, with the bounds of rounding, are in
//! `tests/library/volume_laws.rs` and `tests/library/ray_caster`.

use glam::DVec3;
use proptest::prelude::*;
use std::path::Path;
use std::sync::{Arc, LazyLock};
use volref::compare::{Conditions, Picture, gate_named, judge};
use volref::film::Film;
use volref::reference::ray_caster;
use volref::render::{Sampling, plans, render};
use volref::scene::{Classified, Compositing, Scene};
use volref::volume::{Cell, Grid, Lattice, NodePoint, gradients};

/// A grid of 2 to 6 nodes an axis, with densities in [0, 1).
fn grid() -> impl Strategy<Value = Grid<f32>> {
    let nodes = prop::array::uniform3(2..=6_usize);
    let spacing = prop::array::uniform3(0.5..2.0_f64).prop_map(DVec3::from_array);
    (nodes, spacing).prop_flat_map(|(nodes, spacing)| {
        let lattice = Lattice::new(nodes, spacing, DVec3::ZERO).unwrap();
        prop::collection::vec(0.0..1.0_f32, lattice.node_count())
            .prop_map(move |values| Grid::new(lattice, values).unwrap())
    })
}

/// The scene of figure 3 with another grid, cut into steps from front to back or from back to front.
fn figure_3_of(grid: Grid<f32>, compositing: Compositing) -> Classified {
    static FIGURE_3: LazyLock<Scene> = LazyLock::new(|| repository_scene("figure-3"));
    let mut scene = FIGURE_3.panels[0].classified().unwrap().clone();
    let bounds = grid.lattice().bounds();
    scene.step = 0.5 * grid.lattice().voxel();
    scene.transfer_function.reference_length = grid.lattice().voxel();
    let eye = bounds.centre() - DVec3::Z * (2.0 * bounds.size().max_element());
    scene.camera = volref::geometry::Camera::new(eye, bounds.centre(), DVec3::Y, 0.8).unwrap();
    scene.grid = Arc::new(grid);
    scene.compositing = compositing;
    scene
}

fn repository_scene(figure: &str) -> Scene {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    Scene::load(&root.join(format!("fixtures/scenes/figures/{figure}.toml"))).unwrap()
}

fn config() -> ProptestConfig {
    let file = "fixtures/proptest-regressions/required_properties.txt";
    ProptestConfig {
        failure_persistence: Some(Box::new(
            proptest::test_runner::FileFailurePersistence::Direct(file),
        )),
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config())]

    /// Mirroring the field along an axis mirrors its gradient: that component changes sign, the others stay.
    #[test]
    fn gradient_symmetry(grid in grid(), axis in 0..3_usize) {
        let lattice = *grid.lattice();
        let mirror = |index: usize| {
            let mut node = lattice.node(index);
            node[axis] = lattice.nodes()[axis] - 1 - node[axis];
            lattice.index(node)
        };
        let values = (0..lattice.node_count()).map(|index| grid.values()[mirror(index)]);
        let mirrored = gradients(&Grid::new(lattice, values.collect()).unwrap());
        let direct = gradients(&grid);
        for index in 0..lattice.node_count() {
            let mut expected = direct.values()[mirror(index)];
            expected[axis] = -expected[axis];
            prop_assert_eq!(mirrored.values()[index], expected);
        }
    }

    /// At a node, trilinear interpolation gives the value of the node, to the bit.
    #[test]
    fn trilinear_agreement_at_grid_nodes(grid in grid()) {
        let lattice = grid.lattice();
        for (index, &value) in grid.values().iter().enumerate() {
            let node = DVec3::from_array(lattice.node(index).map(|n| n as f64));
            let interpolated = Cell::around(lattice, NodePoint(node)).trilinear(&grid);
            prop_assert_eq!(interpolated, f64::from(value));
        }
    }

    /// Both orders of compositing give the same image.
    ///
    /// Tolerance: images are f32, and a sum of some 30 steps in f64 is exact to far less than half a unit of
    /// f32; two roundings of nearly the same number are at most one unit apart, 2⁻²³ of it. Radiance is at most
    /// 4 here (squared density times the weights of Phong shading, up to 2.1), opacity 1.
    #[test]
    fn front_to_back_equals_back_to_front(grid in grid()) {
        let [front, back] = [Compositing::FrontToBack, Compositing::BackToFront]
            .map(|order| ray_caster::render(&figure_3_of(grid.clone(), order), [4, 4]));
        for pixel in 0..16 {
            for (front, back) in front.pixel(pixel).iter().zip(back.pixel(pixel)) {
                prop_assert!((front - back).abs() <= 4.0 * f32::EPSILON, "{front} {back}");
            }
        }
    }
}

/// Figures 1 to 5, rendered and stored in 8 bits, look like their golden previews by LDR-FLIP; the same pictures
/// upside down do not.
#[test]
fn perceptual_diff_snapshots_of_figures_1_to_5() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let perceptual = gate_named("perceptual").unwrap();
    let folder = tempfile::tempdir().unwrap();
    for figure in ["figure-1", "figure-2", "figure-3", "figure-4", "figure-5"] {
        let golden = Picture::read(&root.join(format!("golden/figures/{figure}.png"))).unwrap();
        let scene = repository_scene(figure);
        let film = render(&plans(&scene), Sampling::default(), &|| {}).unwrap();
        let looks_alike = |film: &Film| {
            let file = folder.path().join("image.png");
            std::fs::write(&file, film.to_png(exposure_of(figure))).unwrap();
            let picture = Picture::read(&file).unwrap();
            let judged = judge(perceptual, &golden, &picture, &Conditions::default());
            judged.unwrap().passed
        };
        assert!(looks_alike(&film.film), "{figure}");
        assert!(
            !looks_alike(&upside_down(&film.film)),
            "{figure} upside down"
        );
    }
}

/// Exposure at which the golden preview of a figure is stored, in stops.
fn exposure_of(figure: &str) -> f64 {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let suite = volref::suite::Suite::open(root).unwrap();
    suite.select(&[format!("figures/{figure}")]).unwrap()[0].exposure
}

fn upside_down(film: &Film) -> Film {
    let rows = film.radiance().chunks(film.width()).rev();
    Film::new(
        film.width(),
        film.height(),
        rows.flatten().copied().collect(),
    )
}
