//! The renderings of a case.
//!
//! A deterministic case has one rendering. A stochastic case has two: a *quick* one of few samples,
//! whose bits pin the renderer, and a *converged* one of many, with which images are compared. They
//! share no random number: the quick one uses the seed of the scene, the converged one that seed
//! plus 2⁶³, which no scene file can give, since integers in TOML are smaller. `volref render --spp
//! N --seed S` makes either again.

use super::Case;
use crate::render::{Plan, Progress, RenderError, Rendering, Sampling, Seed};

/// Added to the seed of every panel for the converged rendering.
const CONVERGED: u64 = 1 << 63;

/// A rendering of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CaseRendering {
    /// The only one of a deterministic case.
    Only,
    /// Few samples, the seed of the scene.
    Quick(u32),
    /// Many samples, another seed.
    Converged(u32),
}

impl CaseRendering {
    /// Samples and random numbers of this rendering.
    fn sampling(self) -> Sampling {
        match self {
            CaseRendering::Only => Sampling::default(),
            CaseRendering::Quick(samples) => Sampling::of_samples(samples),
            CaseRendering::Converged(samples) => Sampling {
                samples: Some(samples),
                seed: Seed::Replicate(CONVERGED),
            },
        }
    }
}

/// Makes the picture of the panels of plans: [`render`](crate::render::render), for which tests have another.
pub(crate) type Render<'r> =
    dyn Fn(&[Plan<'_>], Sampling, Progress<'_>) -> Result<Rendering, RenderError> + 'r;

/// One rendering of a case.
pub(crate) fn render_case(
    render: &Render<'_>,
    plans: &[Plan<'_>],
    rendering: CaseRendering,
    progress: Progress<'_>,
) -> Result<Rendering, String> {
    let picture = render(plans, rendering.sampling(), progress);
    let picture = picture.map_err(|error| error.to_string())?;
    if rendering != CaseRendering::Only && picture.film.noise().is_none() {
        return Err(
            "the image states no noise: a stochastic case cannot mix panels with and without \
            random numbers"
                .to_owned(),
        );
    }
    Ok(picture)
}

/// Fails where the class of the case is not that of its scene.
pub(crate) fn check_class(case: &Case, plans: &[Plan<'_>]) -> Result<(), String> {
    let right = if plans.iter().any(Plan::is_continuous) {
        "limit"
    } else if plans.iter().any(Plan::is_sampled) {
        "stochastic"
    } else {
        "deterministic"
    };
    if case.is_limit() && !plans.iter().all(Plan::is_continuous) {
        return Err(
            "the case is a limit, but its scene composites samples, or holds none: say \
            compositing = \"continuous\" in every panel"
                .to_owned(),
        );
    }
    if case.class() != right {
        return Err(format!(
            "the case states class = {:?}, but its scene is rendered as class = {right:?}",
            case.class()
        ));
    }
    Ok(())
}
