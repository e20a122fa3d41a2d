//! What one scene must fulfil.

use super::bounds::too_long;
use super::scenes::Written;
use rayon::ThreadPool;
use std::path::Path;
use volref::film::Film;
use volref::render::{RenderError, Sampling, plans, render};
use volref::scene::{Scene, SceneError};

/// Pixels along each side, at most: a scene that asks for more is rendered as small as that.
pub const SIDE: usize = 8;

/// Samples per pixel, where there is chance: two have a variance.
pub const SAMPLES: u32 = 2;

/// What became of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Refused as it was read.
    Refused,
    /// Not rendered: a test has no time for it.
    TooLong,
    /// Refused as it was rendered.
    NotShown,
    /// Shown.
    Shown,
}

/// Threads to render with: one, and three.
pub fn pools() -> [ThreadPool; 2] {
    [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be started")
    })
}

/// Writes a scene into `folder`, reads it and renders it as `volref render` does; what became of
/// it, or what it does not fulfil.
pub fn check(
    written: &Written,
    folder: &Path,
    [one, three]: &[ThreadPool; 2],
) -> Result<Outcome, String> {
    for (name, bytes) in &written.files {
        std::fs::write(folder.join(name), bytes).map_err(|error| error.to_string())?;
    }
    let path = folder.join("scene.toml");
    std::fs::write(&path, &written.text).map_err(|error| error.to_string())?;
    let mut scene = match Scene::load(&path) {
        Ok(scene) => scene,
        Err(error) => return explains_itself(&error).map(|()| Outcome::Refused),
    };
    for panel in &mut scene.panels {
        panel.width = panel.width.min(SIDE);
        panel.height = panel.height.min(SIDE);
    }
    let (plans, sampling) = (plans(&scene), Sampling::of_samples(SAMPLES));
    let [panel] = &*scene.panels else {
        return Err("a scene of one panel has others".into());
    };
    if too_long(panel) {
        return Ok(Outcome::TooLong);
    }
    let film = match one.install(|| render(&plans, sampling, &|| {})) {
        Ok(rendering) => rendering.film,
        Err(error) => return is_the_scenes_fault(&error).map(|()| Outcome::NotShown),
    };
    is_radiance(&film)?;
    // Other threads cost as much again: a share of the scenes, the same in every run, is enough.
    if written.text.len().is_multiple_of(4) {
        let again = three.install(|| render(&plans, sampling, &|| {}));
        let again = again.map_err(|error| format!("by three threads it is refused: {error}"))?;
        if again.film.pixel_hash() != film.pixel_hash() {
            return Err("three threads give another image".into());
        }
    }
    Ok(Outcome::Shown)
}

/// A mistake in a scene has a place, and words on how to mend it.
fn explains_itself(error: &SceneError) -> Result<(), String> {
    if error.message().is_empty() || error.help_text().is_none() || error.position().is_none() {
        return Err(format!("refused without place or help: {error}"));
    }
    Ok(())
}

/// What a valid scene may be refused for while it is rendered: light without end or bound.
fn is_the_scenes_fault(error: &RenderError) -> Result<(), String> {
    match error {
        RenderError::Endless(_) | RenderError::Divergent(_) | RenderError::TooBright(_) => Ok(()),
        RenderError::Majorant(_)
        | RenderError::Memory { .. }
        | RenderError::Stopped
        | RenderError::NoRadiance(..) => Err(error.to_string()),
    }
}

fn is_radiance(film: &Film) -> Result<(), String> {
    let of_pixel = |pixel: &[f32; 3]| pixel.iter().all(|value| value.is_finite() && *value >= 0.0);
    if let Some(index) = film.radiance().iter().position(|pixel| !of_pixel(pixel)) {
        return Err(format!("pixel {index} is {:?}", film.radiance()[index]));
    }
    Ok(())
}
