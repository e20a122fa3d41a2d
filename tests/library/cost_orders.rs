//! Orders of convergence, against theory: `volref cost` on small scenes.
//!
//! A fitted order may be off by 0.1, by 0.2 in the largest error: what is left of the next term of an expansion in the
//! settings that are fitted.

use crate::effects::scenes::parsed;
use volref::cost::order::OrderVerdict;
use volref::cost::timing::Clock;
use volref::cost::{Cost, Options, Parameter, Sweep, cost};

/// What accuracy costs in the scene of `text`, without times.
fn measured(text: &str) -> Cost {
    let options = Options {
        clock: Clock::default(),
        seed: 0,
    };
    let costs = cost(&parsed(text), "scene", &options, &|_| ());
    costs.unwrap().swap_remove(0)
}

/// A hill in a grid, seen from aside.
fn hill(keys: &str) -> String {
    format!(
        "[film]\nwidth = 12\nheight = 12\n\
         [camera]\neye = [0.35, 0.4, -2.2]\ntarget = [0.12, 0.1, 0.1]\nvertical_fov = 34\n\
         [transfer_function]\nreference_length = '1 voxel'\n\
         [classified]\n{keys}\n[classified.volume]\nfile = '../../volumes/hard/hill.nrrd'\n"
    )
}

fn names(cost: &Cost) -> Vec<&str> {
    cost.sweeps.iter().map(|sweep| sweep.name).collect()
}

#[track_caller]
fn is_as_expected(sweep: &Sweep, expected: f64) {
    println!("{}: {:?}", sweep.name, sweep.order);
    assert_eq!(sweep.order.expected, Some(expected));
    assert_eq!(sweep.order.verdict, OrderVerdict::AsExpected, "{sweep:?}");
}

/// Emission and absorption by the midpoint rule: order 2 in what is continuous, against the integral itself; order 1
/// across the jumps between nearest nodes, against much finer steps.
#[test]
fn steps_along_a_ray() {
    let smooth = measured(&hill(""));
    assert_eq!(names(&smooth), ["step"]);
    let sweep = &smooth.sweeps[0];
    is_as_expected(sweep, 2.0);
    assert!(sweep.reference.method.starts_with("the integral"));
    // Half the step takes twice the lookups, but for whole blocks without opacity, which rays leap over.
    let [coarser, finest] = [7, 8].map(|level: usize| sweep.levels[level].work.lookups());
    assert!(
        (1.8..2.05).contains(&(finest / coarser)),
        "{coarser} {finest}"
    );
    let nearest = hill("interpolation = 'nearest'").replace("= 12", "= 48");
    let nearest = measured(&nearest).sweeps.swap_remove(0);
    assert_eq!(nearest.order.expected, Some(1.0));
    // Over the last three halvings: the reference, 32 times finer, is off by at most a 31st of the last error, which adds
    // log2(32/31)/3 = 0.015 to their mean order.
    let local = nearest.order.local[5..].iter().flatten();
    let mean = local.sum::<f64>() / 3.0;
    assert!((mean - 1.0).abs() < 0.1, "{mean}");
    assert!(
        nearest
            .reference
            .method
            .starts_with("the same image with steps of")
    );
}

/// With light there is a sweep without it beside, and one of the shadow's step; every setting of the finer half is better
/// than the one before.
#[test]
fn steps_with_shading_and_shadow() {
    let lit = measured(&hill(
        "step = '0.5 voxels'\n[classified.phong]\n[classified.shadow]\nreference_step = '1 voxel'",
    ));
    assert_eq!(names(&lit), ["step", "step without light", "shadow step"]);
    is_as_expected(&lit.sweeps[1], 2.0);
    let shadow = &lit.sweeps[2];
    assert_eq!(shadow.parameter, Parameter::ShadowStep);
    for sweep in &lit.sweeps {
        let errors: Vec<f64> = sweep.levels.iter().map(|level| level.error.l2).collect();
        assert!(
            errors.windows(2).skip(3).all(|pair| pair[1] < pair[0]),
            "{errors:?}"
        );
    }
    let effects: Vec<&str> = lit.effects.iter().map(|effect| &*effect.effect).collect();
    let alone = [
        "absorption and emission",
        "with gradient shading",
        "with volume shadow",
        "with both",
    ];
    assert_eq!(effects, alone);
    assert!(lit.recommendations[0].text.contains("steps of 0."));
}

/// What else is sampled has a price, too, though no order that is known: projections, several volumes among clips.
#[test]
fn modes_and_objects_have_errors_without_an_expected_order() {
    let clip = "[[classified.clip]]\npoint = [0.1, 0.1, 0.1]\nnormal = [1, 0.5, 0]\n";
    for text in [hill("mode = 'mean'"), format!("{}{clip}", hill(""))] {
        let cost = measured(&text);
        let sweep = &cost.sweeps[0];
        assert_eq!(sweep.order.verdict, OrderVerdict::NothingExpected);
        assert!(
            sweep.levels[8].error.l2 < 0.02 * sweep.levels[0].error.l2,
            "{sweep:?}"
        );
    }
}

/// Noise falls as the root of the samples.
#[test]
fn samples_per_pixel() {
    let cost = measured(
        "[film]\nwidth = 4\nheight = 4\n[camera]\neye = [0, 0, -3]\ntarget = [0, 0, 0]\n\
         [radiative]\nenvironment = 1\n[[radiative.medium]]\n\
         sphere = { centre = [0, 0, 0], radius = 1.5 }\nsigma_s = 1\nsigma_a = 0.5\n",
    );
    assert_eq!(names(&cost), ["samples"]);
    let found = &cost.sweeps[0].order;
    println!("{found:?}");
    assert_eq!(found.expected, Some(-0.5));
    assert_eq!(found.verdict, OrderVerdict::AsExpected, "{found:?}");
}
