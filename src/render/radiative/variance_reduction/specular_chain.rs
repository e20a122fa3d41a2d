//! Chains of bounces on mirrors and glass, and the sampler that follows them beside the path.

/// Bounces, one or several, on mirrors and glass, since the eye or a vertex that scatters into a range of
/// directions.
#[derive(Clone, Copy, Debug)]
pub struct SpecularChain {
    /// The other sampler that follows it.
    pub follower: Follower,
    /// Number of bounces.
    pub bounces: usize,
    /// Weight of an area light found at the end, against that sampler.
    pub weight: f64,
}

/// A sampler of area lights that follows a chain of specular bounces, beside the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follower {
    /// None.
    Nobody,
    /// [`lights_through_glass`](super::lights_through_glass), from the eye.
    Eye,
    /// [`caustics`](super::caustics), from a vertex, as long as all bounces are on this object.
    Vertex(usize),
}

impl Follower {
    /// Bounces that are followed from the eye: into a body of glass, twice reflected in there, and out.
    pub const FROM_EYE: usize = 4;

    /// Bounces that are followed from a vertex. A ray enters and leaves a convex body of glass by two;
    /// each further reflection inside keeps a few per cent of the light.
    pub const FROM_VERTEX: usize = 8;
}

impl SpecularChain {
    /// A chain that nobody follows.
    pub const ALONE: SpecularChain = SpecularChain {
        follower: Follower::Nobody,
        bounces: 0,
        weight: 1.0,
    };

    /// The first bounce of a chain.
    pub fn begun(follower: Follower, weight: f64) -> SpecularChain {
        SpecularChain {
            follower,
            bounces: 1,
            weight,
        }
    }

    /// The chain with one more bounce, on `object`.
    pub fn continued(self, object: usize) -> SpecularChain {
        let bounces = self.bounces + 1;
        let is_followed = match self.follower {
            Follower::Nobody => false,
            Follower::Eye => bounces <= Follower::FROM_EYE,
            Follower::Vertex(followed) => followed == object && bounces <= Follower::FROM_VERTEX,
        };
        if is_followed {
            SpecularChain { bounces, ..self }
        } else {
            SpecularChain::ALONE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nobody follows a chain beyond its limit, nor from a vertex to another object, nor from there back.
    #[test]
    fn a_chain_is_followed_up_to_its_limit() {
        let weight = |chain: SpecularChain, objects: &[usize]| {
            let end = objects.iter().fold(chain, |chain, &it| chain.continued(it));
            end.weight
        };
        let eye = SpecularChain::begun(Follower::Eye, 0.0);
        assert_eq!(weight(eye, &[1, 2, 1]), 0.0);
        assert_eq!(weight(eye, &[1, 2, 1, 1]), 1.0);
        let vertex = SpecularChain::begun(Follower::Vertex(3), 0.25);
        assert_eq!(weight(vertex, &[3; 7]), 0.25);
        assert_eq!(weight(vertex, &[3; 8]), 1.0);
        assert_eq!(weight(vertex, &[3, 1, 3]), 1.0);
    }
}
