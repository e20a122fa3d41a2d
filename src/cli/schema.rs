//! `volref schema`

use super::Outcome;
use super::output::pretty;
use crate::conventions::PROFILE;
use crate::scene::{SCENE, format::json_schema};
use crate::suite::MANIFEST;

/// Print the JSON Schema of scenes, cases or profiles, for editors
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Kind of file
    #[arg(value_enum, default_value = "scene")]
    kind: SchemaKind,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum SchemaKind {
    /// fixtures/scenes/<family>/<name>.toml
    Scene,
    /// fixtures/cases/<family>/<name>.toml
    Case,
    /// File of validate --as
    Profile,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Outcome {
    let schema = match arguments.kind {
        SchemaKind::Scene => json_schema("volref scene", &SCENE),
        SchemaKind::Case => json_schema("volref case", &MANIFEST),
        SchemaKind::Profile => json_schema("volref profile", &PROFILE),
    };
    Outcome::from(pretty(&schema))
}
