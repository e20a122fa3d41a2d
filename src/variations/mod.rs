//! Edits of scenes and images: the mistakes that people make.

pub(crate) mod edited_film;
pub mod mistakes;
