//! Mistakes in the transport of light, made by the [faulty tracer](crate::faulty_tracer).

use super::{Edit, Mistake};
use crate::scene::TransportFault;

pub(super) const MISTAKES: &[Mistake] = mistakes! {
    "media-bounds-block-light" => Transport(TransportFault::BoundsBlockLight),
        "shadow rays stop at the bounds of media, as though these were surfaces: only surfaces block light, media attenuate it";
    "shadow-rays-unattenuated" => Transport(TransportFault::ShadowRaysUnattenuated),
        "media cast no shadow: multiply the light of every shadow ray by the transmittance of all media on its way";
    "lights-counted-twice" => Transport(TransportFault::LightsCountedTwice),
        "area lights count in full where they are sampled and once more where a path hits them: weight both by multiple importance sampling, or leave one out";
    "hits-of-lights-unweighted" => Transport(TransportFault::HitsUnweighted),
        "hits of area lights are not weighted, but samples of them are: both need the weights of multiple importance sampling, which sum to 1";
    "samples-of-lights-unweighted" => Transport(TransportFault::SamplesUnweighted),
        "samples of area lights are not weighted, but hits of them are: both need the weights of multiple importance sampling, which sum to 1";
    "hits-of-lights-left-out" => Transport(TransportFault::HitsLeftOut),
        "samples of area lights are weighted for multiple importance sampling, but paths that hit a light after a bounce bring none: count hits by their weight, or samples in full";
    "phase-reversed-for-lights" => Transport(TransportFault::PhaseReversedForLights),
        "the phase function has forward and backward exchanged where lights are sampled, not where a path goes on: is the direction to the light taken for that of its light?";
    "albedo-left-out-of-direct-light" => Transport(TransportFault::AlbedoLeftOutOfDirectLight),
        "direct light in media lacks the albedo: a collision scatters sigma_s / sigma_t of the light";
    "albedo-squared-in-direct-light" => Transport(TransportFault::AlbedoSquaredInDirectLight),
        "direct light in media has the albedo twice: is it in the throughput already when lights are sampled?";
    "reflectance-left-out-of-direct-light" => Transport(TransportFault::ReflectanceLeftOutOfDirectLight),
        "direct light on diffuse surfaces lacks their reflectance, as though all were white";
    "reflectance-squared-in-direct-light" => Transport(TransportFault::ReflectanceSquaredInDirectLight),
        "direct light on diffuse surfaces has their reflectance twice: is it in the throughput already when lights are sampled?";
    "null-collisions-unweighted" => Transport(TransportFault::NullCollisionsUnweighted),
        "null collisions leave the throughput as it is: multiply it, per channel, by the rate of null collisions over the majorant and the probability of the event";
    "roulette-uncompensated" => Transport(TransportFault::RouletteUncompensated),
        "paths that survive Russian roulette keep their throughput: divide it by the probability of survival";
};
