//! The plot that the guide shows is the one the program draws today.

use std::path::Path;
use volref::cost::timing::Clock;
use volref::cost::{Options, cost};
use volref::report::cost_plot;
use volref::scene::Scene;

#[test]
fn error_against_work_in_figure_3() {
    let scene = Scene::load(Path::new("fixtures/scenes/figures/figure-3.toml")).unwrap();
    let options = Options {
        clock: Clock::default(),
        seed: 0,
    };
    let costs = cost(&scene, "figures/figure-3", &options, &|_| ()).unwrap();
    let committed = std::fs::read_to_string("golden/cost/figure-3.svg").unwrap();
    assert!(
        cost_plot(&costs[0]) == committed,
        "the plot has changed: look at it, and run scripts/cost-plots.sh"
    );
}
