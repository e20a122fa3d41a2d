//! Cases, their goldens, and what `verify` and `accept` do with them.

mod store;

pub use store::{Disk, Failure, RealDisk, Store, StoreError};
