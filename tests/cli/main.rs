//! The built command on throw-away suites: one file for each command, one for each kind of
//! bad input.

mod accept;
#[cfg(unix)]
mod action;
mod bad_files;
mod bad_goldens;
mod bad_scenes;
mod compare;
mod cost;
mod decide;
mod embedded;
mod explanations;
mod export;
mod folder;
mod gallery;
#[cfg(unix)]
mod guide;
mod hard;
#[cfg(unix)]
mod hostile;
mod info;
mod inputs;
#[cfg(unix)]
mod kept_images;
mod known;
mod known_answers;
#[cfg(unix)]
mod links;
mod list;
#[cfg(unix)]
mod lost_files;
mod merge;
mod mutated_inputs;
#[path = "../needs/mod.rs"]
mod needs;
mod opacity_and_depth;
mod outputs;
mod partition;
mod peers;
mod pictures;
mod plan;
mod precision;
mod render;
#[cfg(target_os = "linux")]
mod renderers;
mod schema;
mod selftest;
mod sensitivity;
#[cfg(unix)]
mod serve;
mod stochastic;
mod validate;
#[cfg(unix)]
mod vectors;
mod verify;
