//! Scenes of every set of effects: the code compiled for what they need against the code for
//! everything.

use crate::effects::scenes::{Classified, Radiative, Shading, off_is_off, parsed, plan, rendered};
use std::collections::BTreeSet;
use volref::film::Film;
use volref::render::plan::{Kernel, RadiativeFeatures, RayCasterFeatures};
use volref::render::{Counters, Plan};

/// Everything on.
const ALL_FEATURES: RadiativeFeatures = RadiativeFeatures {
    vacuum_media: true,
    ..RadiativeFeatures::ALL
};

/// The same plan by the most general code.
fn general<'s>(plan: &Plan<'s>) -> Plan<'s> {
    let kernel = match plan.kernel {
        Kernel::LineOfSight {
            scene, scatters, ..
        } => Kernel::LineOfSight {
            scene,
            features: ALL_FEATURES,
            scatters,
        },
        Kernel::PathTracer {
            scene, max_order, ..
        } => Kernel::PathTracer {
            scene,
            features: ALL_FEATURES,
            max_order,
        },
        other => other,
    };
    Plan {
        kernel,
        ..plan.clone()
    }
}

/// The work by a plan, whose picture must be `film` to the bit.
#[track_caller]
fn same_bits(what: &str, film: &Film, plan: &Plan<'_>) -> Counters {
    let (other, work) = rendered(plan);
    assert!(
        bits(film) == bits(&other),
        "{what}: {} makes another picture",
        plan.kernel
    );
    work
}

/// All bits of a film, those of its noise too.
fn bits(film: &Film) -> Vec<u32> {
    let noise = film.noise().map_or(&[][..], |noise| noise.variance());
    let channels = film.radiance().iter().chain(noise).flatten();
    let opacity = film.opacity().unwrap_or_default();
    channels
        .chain(opacity)
        .map(|value| value.to_bits())
        .collect()
}

#[test]
fn media_surfaces_and_lights() {
    let mut kernels = BTreeSet::new();
    let mut lit = 0;
    for made_of in Radiative::all() {
        let scene = parsed(&made_of.text());
        let plan = plan(&scene);
        let what = format!("{made_of:?}");
        let (film, work) = rendered(&plan);
        same_bits(&what, &film, &general(&plan));
        off_is_off(&what, &plan, &work);
        kernels.insert(plan.canonical_text().lines().next().unwrap().to_owned());
        lit += usize::from(film.radiance().iter().any(|pixel| *pixel != [0.0; 3]));
    }
    // Where there is nothing but an absorber and a lamp, all is black; most scenes are not.
    assert!(lit > 2000, "{lit}");
    assert!(kernels.len() > 50, "{}", kernels.len());
}

#[test]
fn classified_volumes() {
    let mut kernels = BTreeSet::new();
    for made_of in Classified::all() {
        let scene = parsed(&made_of.text());
        let plan = plan(&scene);
        let what = format!("{made_of:?}");
        let Kernel::RayCaster { scene, .. } = plan.kernel else {
            panic!("{what}: {}", plan.kernel);
        };
        let features = RayCasterFeatures {
            constant: false,
            shading: made_of.shading != Shading::None,
            shadow: made_of.shadow,
            skip_empty: false,
        };
        let most = Plan {
            kernel: Kernel::RayCaster { scene, features },
            ..plan.clone()
        };
        let (film, work) = rendered(&plan);
        same_bits(&what, &film, &most);
        off_is_off(&what, &plan, &work);
        kernels.insert(plan.canonical_text().lines().next().unwrap().to_owned());
    }
    assert_eq!(kernels.len(), 54);
}
