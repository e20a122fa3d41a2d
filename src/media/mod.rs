//! What a volume does to light.

mod colormap;
mod opacity;
mod phong;
mod transfer_function;

pub use colormap::Colormap;
pub use opacity::{TransferOpacity, over_length};
pub use phong::Phong;
pub use transfer_function::TransferFunction;
