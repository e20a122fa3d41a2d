//! The guide to the commands. This module contains no code.
//!
//! | question | chapter |
//! | --- | --- |
//! | Are my renderer's images right? | [`comparing`]; one that stays: [`staying`]; in Python: [`adapters`] |
//! | What do the cases show, and how do goldens change? | [`suite`] |
//! | How do I write a scene? | [`scenes`], [`volume_files`], [`fog_and_smoke`] |
//! | Which parameter is off? | [`sensitivities`] |
//! | How do I check in pytest, CMake, JavaScript or on GitHub? | [`in_your_tests`], [`several_machines`] |
//! | How accurate is my step, and what does it cost? | [`accuracy_and_cost`], [`effects`], [`speed`] |
//! | What did volref find in other renderers? | [`peers`], [`gallery`], [`findings`], [`reported`] |
//! | Which inputs make renderers wrong? | [`hard_cases`] |
//! | How do I work on volref? | [`working_on_volref`] |
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
