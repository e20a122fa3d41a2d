//! The `volref` command.

fn main() {}
