//! Counters of work.

use serde::{Serialize, Serializer};
use std::ops::{Index, IndexMut};

/// Defines [`Event`] from one list: of each event the meaning, the name and the JSON key.
macro_rules! events {
    ($($(#[$meaning:meta])* $event:ident, $key:literal;)+) => {
        /// A unit of work that kernels count.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Event {
            $($(#[$meaning])* $event,)+
        }

        impl Event {
            /// All events, in the order in which reports list them.
            pub const ALL: [Event; [$($key),+].len()] = [$(Event::$event),+];

            /// The JSON key of the event's counter.
            pub fn key(self) -> &'static str {
                match self {
                    $(Event::$event => $key,)+
                }
            }
        }
    };
}

events! {
    /// Density read from a grid or evaluated, shadow rays included.
    DensityLookup, "density_lookups";

    /// Stored gradient interpolated at a point.
    GradientLookup, "gradient_lookups";

    /// Gradient of a node, computed to be stored.
    GradientComputed, "gradients_computed";

    /// Cell or block of a grid that a ray enters: its emptiness or majorant is read.
    CellWalked, "cells_walked";

    /// Ray towards a light, for the transmittance or the shadow on it.
    ShadowRay, "shadow_rays";

    /// Value of an anisotropic phase function.
    PhaseEvaluation, "phase_evaluations";

    /// Null collision of a tracking method.
    NullCollision, "null_collisions";

    /// Intersection test of a ray with a surface.
    SurfaceTest, "surface_tests";

    /// Random number. (A density without an integral is tracked even if it only absorbs.)
    RandomDraw, "random_draws";

    /// Transmittance of a medium segment or opacity of a sample: an exponential or a power.
    /// (Extinction is absorption and scattering together.)
    Attenuation, "attenuations";

    /// The same for the second and third colour channels.
    ChannelAttenuation, "channel_attenuations";

    /// Emission of a sample or of a medium segment.
    EmissionTerm, "emission_terms";

    /// First scattering or reflection on a path from the eye.
    FirstScattering, "first_scatterings";

    /// Scattering or reflection of second or higher order.
    FurtherScattering, "further_scatterings";
}

/// A number for each event.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PerEvent<T>([T; Event::ALL.len()]);

/// Units of work done, by event. The same on every run, for any number of threads.
pub type Counters = PerEvent<u64>;

impl<T: Copy> PerEvent<T> {
    /// These numbers, each converted by `convert`.
    pub fn map<U>(self, convert: impl Fn(T) -> U) -> PerEvent<U> {
        PerEvent(self.0.map(convert))
    }
}

impl<T> Index<Event> for PerEvent<T> {
    type Output = T;

    fn index(&self, event: Event) -> &T {
        &self.0[event as usize]
    }
}

impl<T> IndexMut<Event> for PerEvent<T> {
    fn index_mut(&mut self, event: Event) -> &mut T {
        &mut self.0[event as usize]
    }
}

/// The given numbers, and 0 for all other events.
impl<T: Copy + Default, const N: usize> From<[(Event, T); N]> for PerEvent<T> {
    fn from(numbers: [(Event, T); N]) -> PerEvent<T> {
        let mut all = PerEvent::default();
        for (event, number) in numbers {
            all[event] = number;
        }
        all
    }
}

impl Counters {
    /// Counts one unit of work.
    pub fn count(&mut self, event: Event) {
        self.count_times(event, 1);
    }

    /// Counts `times` units of work.
    pub fn count_times(&mut self, event: Event, times: u64) {
        self[event] += times;
    }

    /// Adds the counts of another row of pixels.
    pub fn add(&mut self, other: &Counters) {
        for (count, more) in self.0.iter_mut().zip(other.0) {
            *count += more;
        }
    }
}

/// A map from the [keys](Event::key) of the events to their numbers.
impl<T: Serialize> Serialize for PerEvent<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(Event::ALL.map(|event| (event.key(), &self[event])))
    }
}
