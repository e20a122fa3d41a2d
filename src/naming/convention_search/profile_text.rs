//! A set of conventions as the text of a profile.

use crate::conventions::{CATALOGUE, STEP, under};
use crate::scene::{Compositing, Panel, Scene};

/// The profile, as TOML, of the conventions of `set` in `scene`; `None` with another step.
pub fn profile_text(scene: &Scene, set: &[usize]) -> Option<String> {
    if set.iter().any(|&index| CATALOGUE[index].choice == STEP) {
        return None;
    }
    let scene = under(scene, set);
    let volume = scene.panels.iter().find_map(Panel::classified)?;
    let mut lines = vec!["name = \"mine\"".to_owned()];
    if let Compositing::EarlyTermination(threshold) = volume.compositing {
        lines.push(format!("early_termination = {threshold:?}"));
    }
    let conventions = volume.conventions.lines();
    if !conventions.is_empty() {
        lines.push("[conventions]".to_owned());
        lines.extend(conventions);
    }
    Some(lines.join("\n") + "\n")
}
