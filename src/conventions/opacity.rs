//! Opacity over a step, from what a transfer function states, corrected for the length of steps.

use crate::optics::over_length;
use crate::scene::Classified;

/// The opacity that an entry holds, where `stated` is stated for it.
pub fn of_entry(scene: &Classified, stated: f64) -> f64 {
    match scene.conventions.corrected_entries {
        true => stated_over(scene, stated, scene.step),
        false => stated,
    }
}

/// Opacity of a sample over `length`, where `looked_up` is what the transfer function, a table or
/// nodes say.
pub fn over(scene: &Classified, looked_up: f64, length: f64) -> f64 {
    let over = |length| match scene.conventions.corrected_entries {
        true => scaled(scene, looked_up, length / scene.step),
        false => stated_over(scene, looked_up, length),
    };
    let least = scene.conventions.least_opacity;
    if least > 0.0 && over(scene.step) < least {
        0.0
    } else {
        over(length)
    }
}

fn stated_over(scene: &Classified, stated: f64, length: f64) -> f64 {
    if stated < scene.conventions.least_stated_opacity {
        return 0.0;
    }
    let stated = stated.min(scene.conventions.most_opacity);
    let is_of_step = stated <= scene.conventions.uncorrected_opacity;
    let unit = match is_of_step {
        true => scene.step,
        false => scene.transfer_function.reference_length,
    };
    scaled(scene, stated, length / unit)
}

fn scaled(scene: &Classified, opacity: f64, lengths: f64) -> f64 {
    if scene.conventions.linear_opacity {
        (opacity * lengths).min(1.0)
    } else if lengths == 1.0 && scene.conventions.corrected_entries {
        opacity
    } else {
        over_length(opacity, lengths)
    }
}
