//! A set of conventions as the text of a profile.

use crate::conventions::{CATALOGUE, ConventionSet, STEP, under};
use crate::scene::{Compositing, Panel, Scene};

/// The profile, as TOML, of the conventions of `set` in `scene`, each with the `alternatives` that the
/// image does not tell from it as a comment; `None` with another step.
pub fn profile_text(scene: &Scene, set: &[usize], alternatives: &[usize]) -> Option<String> {
    let is_step = |&index: &usize| CATALOGUE[index].choice == STEP;
    if set.iter().any(is_step) {
        return None;
    }
    let mut lines = profile_lines(scene, set)?;
    for &other in alternatives {
        let is_other = |&index: &usize| CATALOGUE[index].choice != CATALOGUE[other].choice;
        let mut changed: ConventionSet = set.iter().copied().filter(is_other).collect();
        changed.push(other);
        for line in profile_lines(scene, &changed)? {
            if lines.iter().any(|stated| stated.starts_with(&line)) {
                continue;
            }
            let key = |line: &str| line.split(' ').next().unwrap_or_default().to_owned();
            match lines.iter_mut().find(|stated| key(stated) == key(&line)) {
                Some(stated) if stated.contains('#') => stated.push_str(&format!(", or {line}")),
                Some(stated) => stated.push_str(&format!("   # or, just as well, {line}")),
                None => lines.push(format!("# or, just as well, {line}")),
            }
        }
    }
    Some(lines.join("\n") + "\n")
}

fn profile_lines(scene: &Scene, set: &[usize]) -> Option<Vec<String>> {
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
    Some(lines)
}
