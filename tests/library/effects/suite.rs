//! Every scene of the suite, small.

use crate::common::suite::scene_files;
use crate::effects::effects_of;
use crate::effects::scenes::{off_is_off, rendered};
use std::sync::atomic::{AtomicU64, Ordering};
use volref::render::counters::Event;
use volref::render::{Effect, Plan, State};
use volref::scene::{Model, Panel, Scene};

/// Pixels of the larger side: what is asked of an image is asked of each of its rays. So many meet
/// everything that is counted.
const SIDE: usize = 8;

/// Where each null effect is forced, every image is rendered half a dozen times. Even: a ray
/// through the middle of a picture would meet a lamp that stands there.
const SIDE_IF_FORCED: usize = 4;

/// The pictures of the suite, each as a scene of its own, their larger side that of so many pixels.
fn pictures(larger_side: usize) -> impl Iterator<Item = (String, Scene)> {
    scene_files().into_iter().flat_map(move |(name, path)| {
        let scene = Scene::load(&path).unwrap_or_else(|error| panic!("{error:?}"));
        let panels = scene.panels.into_iter().enumerate();
        panels.map(move |(index, panel)| {
            let larger = panel.width.max(panel.height);
            let small = |side: usize| (side * larger_side).div_ceil(larger).max(1);
            let mut panel = Panel {
                width: small(panel.width),
                height: small(panel.height),
                ..panel
            };
            if let Model::Radiative(scene) = &mut panel.model {
                scene.samples = 2;
            }
            let scene = Scene::of(panel);
            (format!("{name}, panel {}", index + 1), scene)
        })
    })
}

#[test]
fn what_is_off_does_no_work() {
    let done: Vec<_> = Event::ALL.iter().map(|_| AtomicU64::new(0)).collect();
    let mut pictures_with_something_off = 0;
    for (name, scene) in pictures(SIDE) {
        let plan = Plan::new(&scene.panels[0]);
        let (_, work) = rendered(&plan);
        pictures_with_something_off +=
            usize::from(Effect::ALL.iter().any(|&effect| !plan.is_on(effect)));
        for event in Event::ALL {
            let counted = work[event];
            done[event as usize].fetch_add(counted, Ordering::Relaxed);
            let null = |effect: &Effect| plan.state(*effect) == State::Elided;
            if effects_of(event).iter().all(null) {
                assert_eq!(counted, 0, "{name}: {}, though null", event.key());
            }
        }
        off_is_off(&name, &plan, &work);
    }
    assert!(pictures_with_something_off > 100);
    for event in Event::ALL {
        let done = done[event as usize].load(Ordering::Relaxed);
        assert!(
            done > 0,
            "no scene of the suite shows that {} are counted",
            event.key()
        );
    }
}

/// What can be forced, forced: each null effect alone, and all of them.
#[test]
fn forced_effects_change_no_bit() {
    let mut forced_pictures = 0;
    for (name, scene) in pictures(SIDE_IF_FORCED) {
        let panel = &scene.panels[0];
        let null = Plan::null_effects(panel);
        let (film, work) = rendered(&Plan::new(panel));
        let alone = null.iter().map(|&effect| vec![effect]);
        for effects in alone.chain([null.clone()]) {
            let plan = Plan::forcing(panel, &effects).unwrap();
            let (forced, more) = rendered(&plan);
            let same = film.pixel_hash() == forced.pixel_hash();
            assert!(same, "{name}: {effects:?} forced change the picture");
            for event in Event::ALL {
                let (more, less) = (more[event], work[event]);
                let what = event.key();
                assert!(
                    more >= less,
                    "{name}: {effects:?} forced: {more} {what}, not {less}"
                );
            }
        }
        forced_pictures += usize::from(!null.is_empty());
    }
    assert!(forced_pictures > 100);
}
