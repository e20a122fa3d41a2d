//! Other renderers as programs: called for a case, or asked for one after the other, watched, ended, and the images
//! that they write.

pub(crate) mod call;
pub(crate) mod command_template;
pub(crate) mod image_source;
pub(crate) mod jobs;
mod kept_images;
pub(crate) mod other_renderer;
mod printed;
pub(crate) mod process;
pub(crate) mod staying;

pub(crate) use call::CallSettings;
pub(crate) use command_template::CommandTemplate;
pub use command_template::hashes_of_files;
pub use image_source::ImageSource;
pub use jobs::in_order;
pub(crate) use kept_images::KeptImages;
pub(crate) use other_renderer::{OtherRenderer, Rendered, RendererOptions};
pub use process::stop_all;
pub(crate) use staying::StayingRenderers;
