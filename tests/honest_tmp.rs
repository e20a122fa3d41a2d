#[path = "library/honest_images.rs"]
mod honest_images;
