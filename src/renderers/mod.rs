//! Other renderers as programs: started, watched, ended.

pub(crate) mod other_renderer;

pub use other_renderer::{CommandTemplate, Keeper, Kept, Ran, TemplateError, keep, run, stop_all};
