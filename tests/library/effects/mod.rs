//! Only the effects that a scene calls for are simulated.
//!
//! What is off does no work, in every scene of the suite ([`suite`]) and in every scene that can be put
//! together from effects ([`subsets`]); the code compiled for some effects gives the same bits as the
//! code for all. How much work is left is known beforehand ([`closed_forms`]), and an effect fades in
//! ([`continuity`]): there is no threshold below which it is taken for nothing.

mod closed_forms;
mod continuity;
pub mod scenes;
mod subsets;
mod suite;
