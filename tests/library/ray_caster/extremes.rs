//! No valid scene makes a pixel that is no radiance.

use proptest::prelude::*;

proptest! {
    #![proptest_config(config(192))]

}
