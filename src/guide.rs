//! The guide to the commands. This module contains no code.
//!
//! | chapter | about |
//! | --- | --- |
//! | [`scenes`] | your own point cloud, camera, transfer functions, error messages |
//! | [`volume_files`] | formats, spacing, centring |
//! | [`fog_and_smoke`] | media, surfaces, lights, and the estimators behind them |
//! | [`suite`] | the cases, their goldens, a new golden, a new case |
//! | [`comparing`] | checking a renderer, failures, comparing two images, gates, samples and noise |
//! | [`staying`] | renderers that are started once: the protocol, loops in Python, JavaScript and C++ |
//! | [`gallery`] | one page of many renderers, judged |
//! | [`adapters`] | another renderer, judged: its adapter in Python, from a bundle |
//! | [`sensitivities`] | derivatives of images; which number of a scene is off, and by how much |
//! | [`several_machines`] | parts of a suite, units of a golden, Slurm, Kubernetes |
//! | [`in_your_tests`] | Python, pytest, CMake, GitHub |
//! | [`accuracy_and_cost`] | error against lookups and time |
//! | [`effects`] | the effects that a scene needs |
//! | [`speed`] | what scenes cost, measured |
//! | [`hard_cases`] | inputs that make renderers wrong; the same bits on every architecture |
//! | [`peers`] | exports to Mitsuba, pbrt and bundles |
//! | [`findings`] | faults of renderers, with a check without volref |
//! | [`reported`] | public reports of wrong images, and what is said of each |
//! | [`working_on_volref`] | checks, self-test, fuzzing |
//!
//! The chapters are the files `src/guide/*.md`, readable in the repository as well. A test runs every
//! command block and compares the output with the one shown.

// In the repository the links of a chapter lead to other files. `links.md` defines the same links
// as paths of this crate; it stands first because the first definition of a link counts.
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/scenes.md")]
pub mod scenes {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/volume_files.md")]
pub mod volume_files {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/fog_and_smoke.md")]
pub mod fog_and_smoke {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/suite.md")]
pub mod suite {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/comparing.md")]
pub mod comparing {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/staying.md")]
pub mod staying {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/gallery.md")]
pub mod gallery {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/adapters.md")]
pub mod adapters {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/sensitivities.md")]
pub mod sensitivities {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/several_machines.md")]
pub mod several_machines {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/in_your_tests.md")]
pub mod in_your_tests {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/accuracy_and_cost.md")]
pub mod accuracy_and_cost {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/effects.md")]
pub mod effects {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/speed.md")]
pub mod speed {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/hard_cases.md")]
pub mod hard_cases {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/peers.md")]
pub mod peers {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/findings.md")]
pub mod findings {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/reported.md")]
pub mod reported {}
#[doc = include_str!("guide/links.md")]
#[doc = include_str!("guide/working_on_volref.md")]
pub mod working_on_volref {}
