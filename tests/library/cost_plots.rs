//! The plots that the guide describes are those the program draws today.

use std::path::Path;
use volref::cost::image;
use volref::cost::timing::Clock;
use volref::report::work_precision_svg;
use volref::scene::{Model, Scene};

#[test]
fn error_against_work_in_figure_3() {
    let scene = Scene::load(Path::new("fixtures/scenes/figures/figure-3.toml")).unwrap();
    let panel = &scene.panels[0];
    let Model::Classified(classified) = &panel.model else {
        panic!("figure 3 is a classified volume");
    };
    let study = image::steps(classified, [panel.width, panel.height], &Clock::NONE);
    let committed = std::fs::read_to_string("golden/cost/figure-3-image.svg").unwrap();
    assert!(
        work_precision_svg(&study) == committed,
        "the plot has changed: look at it, and run scripts/cost-plots.sh"
    );
}
