//! Two images to a difference.
