//! Mistakes in the transport of light, made by the [faulty tracer](crate::faulty_tracer).

use super::{Edit, Mistake};
use crate::scene::TransportFault;

pub(super) const MISTAKES: &[Mistake] = &[
    Mistake {
        name: "media-bounds-block-light",
        advice: "shadow rays stop at the bounds of media, as though these were surfaces: only surfaces block light, media attenuate it",
        edit: Edit::Transport(TransportFault::BoundsBlockLight),
    },
    Mistake {
        name: "shadow-rays-unattenuated",
        advice: "media cast no shadow: multiply the light of every shadow ray by the transmittance of all media on its way",
        edit: Edit::Transport(TransportFault::ShadowRaysUnattenuated),
    },
    Mistake {
        name: "lights-counted-twice",
        advice: "area lights count in full where they are sampled and once more where a path hits them: weight both by multiple importance sampling, or leave one out",
        edit: Edit::Transport(TransportFault::LightsCountedTwice),
    },
    Mistake {
        name: "hits-of-lights-unweighted",
        advice: "hits of area lights are not weighted, but samples of them are: both need the weights of multiple importance sampling, which sum to 1",
        edit: Edit::Transport(TransportFault::HitsUnweighted),
    },
    Mistake {
        name: "samples-of-lights-unweighted",
        advice: "samples of area lights are not weighted, but hits of them are: both need the weights of multiple importance sampling, which sum to 1",
        edit: Edit::Transport(TransportFault::SamplesUnweighted),
    },
    Mistake {
        name: "hits-of-lights-left-out",
        advice: "samples of area lights are weighted for multiple importance sampling, but paths that hit a light after a bounce bring none: count hits by their weight, or samples in full",
        edit: Edit::Transport(TransportFault::HitsLeftOut),
    },
    Mistake {
        name: "phase-reversed-for-lights",
        advice: "the phase function has forward and backward exchanged where lights are sampled, not where a path goes on: is the direction to the light taken for that of its light?",
        edit: Edit::Transport(TransportFault::PhaseReversedForLights),
    },
    Mistake {
        name: "albedo-left-out-of-direct-light",
        advice: "direct light in media lacks the albedo: a collision scatters sigma_s / sigma_t of the light",
        edit: Edit::Transport(TransportFault::AlbedoLeftOutOfDirectLight),
    },
    Mistake {
        name: "albedo-squared-in-direct-light",
        advice: "direct light in media has the albedo twice: is it in the throughput already when lights are sampled?",
        edit: Edit::Transport(TransportFault::AlbedoSquaredInDirectLight),
    },
    Mistake {
        name: "reflectance-left-out-of-direct-light",
        advice: "direct light on diffuse surfaces lacks their reflectance, as though all were white",
        edit: Edit::Transport(TransportFault::ReflectanceLeftOutOfDirectLight),
    },
    Mistake {
        name: "reflectance-squared-in-direct-light",
        advice: "direct light on diffuse surfaces has their reflectance twice: is it in the throughput already when lights are sampled?",
        edit: Edit::Transport(TransportFault::ReflectanceSquaredInDirectLight),
    },
    Mistake {
        name: "null-collisions-unweighted",
        advice: "null collisions leave the throughput as it is: multiply it, per channel, by the rate of null collisions over the majorant and the probability of the event",
        edit: Edit::Transport(TransportFault::NullCollisionsUnweighted),
    },
    Mistake {
        name: "roulette-uncompensated",
        advice: "paths that survive Russian roulette keep their throughput: divide it by the probability of survival",
        edit: Edit::Transport(TransportFault::RouletteUncompensated),
    },
];
