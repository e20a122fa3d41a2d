//! Random numbers as a function of their purpose.
//!
//! A generator with a state returns numbers in the order of the calls: one more effect or thread
//! changes every later number. Here nothing is stored. A number is computed from its purpose, so
//! that enabling one effect changes no number of another, and pixels may be rendered in any order.

/// Purpose of a random number. Each purpose has its own numbers.
///
/// The discriminants determine every sampled golden: new purposes go to the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Purpose {
    /// Start of a path in the pixel and on the lens.
    Camera = 0,
    /// Distance to the next real or null collision, and the choice between them.
    FreeFlight = 1,
    /// Medium of a collision among overlapping media.
    Collision = 2,
    /// Transmittance estimated by tracking: towards a light, from a light, and through media that
    /// only absorb.
    Tracking = 3,
    /// Direction after scattering in the medium.
    PhaseDirection = 4,
    /// Choice of a light.
    LightChoice = 5,
    /// Point on the light, or direction to it.
    LightPoint = 6,
    /// Point on the ray to which a light is connected.
    LightDistance = 7,
    /// Direction, or lobe, after reflection or refraction at a surface.
    Surface = 8,
    /// Russian roulette.
    Roulette = 9,
    /// Colour channel by which the next distance is sampled.
    Channel = 10,
    /// Point in a medium or on a surface, sampled from a light.
    LightVertex = 11,
    /// Emission of heterogeneous media along a ray.
    Emission = 12,
    /// All random numbers of the reference path tracer, in order.
    Reference = 13,
    /// Point on an area light, and point on the ray that is connected to it.
    AreaLightAlong = 14,
    /// Direction to a mirror or to glass, and the choices of glass from there on.
    Caustic = 15,
}

/// The random numbers of one sample of one pixel.
///
/// The generator is Philox4x32-10, a keyed bijection of 128-bit counters. The key is the seed;
/// the purpose of the number is the counter, from the lowest bit:
///
/// | bits | width | field |
/// |---|---|---|
/// | 0–31 | 32 | number of the pair: `index / 2` |
/// | 32–37 | 6 | purpose |
/// | 38–63 | 26 | bounce |
/// | 64–95 | 32 | sample |
/// | 96–127 | 32 | pixel |
///
/// The fields do not overlap and a bijection maps different counters to different blocks, so no
/// block is used twice with one seed. A block of 128 bits makes a pair of 53-bit numbers.
///
/// Limits: 2^32 pixels, samples of a pixel and numbers per bounce and purpose (an index has 32
/// bits, so tracking may make 4·10⁹ steps between two bounces) and 2^26 bounces.
///
/// Source: Salmon, Moraes, Dror & Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3", SC '11.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    key: [u32; 2],
    pixel: u32,
    sample: u32,
}

impl Stream {
    /// Upper limit of bounces, exclusive.
    pub const BOUNCES: u32 = 1 << BOUNCE_BITS;

    /// The random numbers for sample `sample` of pixel index `pixel`, given `seed`.
    pub fn new(seed: u64, pixel: u32, sample: u32) -> Stream {
        Stream {
            key: [seed as u32, (seed >> 32) as u32],
            pixel,
            sample,
        }
    }

    /// Number `index` for `purpose` at `bounce`: uniform on the multiples of 2^-53 in [0, 1).
    ///
    /// # Panics
    ///
    /// If `bounce` is not below [`Stream::BOUNCES`]. No path of physical interest is as long, and
    /// reused numbers would be an unnoticed bias.
    pub fn uniform(&self, bounce: u32, purpose: Purpose, index: u32) -> f64 {
        self.pair(bounce, purpose, index / 2)[(index % 2) as usize]
    }

    /// Numbers `2·pair` and `2·pair + 1` of [`Stream::uniform`], at the cost of one.
    ///
    /// # Panics
    ///
    /// As [`Stream::uniform`].
    // One copy, with the rounds within: a copy at each caller takes 5 to 8 % more time in rooms of fog.
    #[inline(never)]
    pub fn pair(&self, bounce: u32, purpose: Purpose, pair: u32) -> [f64; 2] {
        let [a, b, c, d] = philox4x32_10(self.counter(bounce, purpose, pair), self.key);
        [unit_interval(a, b), unit_interval(c, d)]
    }

    fn counter(&self, bounce: u32, purpose: Purpose, pair: u32) -> [u32; 4] {
        assert!(
            bounce < Stream::BOUNCES,
            "bounce {bounce} has no random numbers"
        );
        let use_and_bounce = bounce << PURPOSE_BITS | purpose as u32;
        [pair, use_and_bounce, self.sample, self.pixel]
    }
}

const PURPOSE_BITS: u32 = 6;
const BOUNCE_BITS: u32 = 32 - PURPOSE_BITS;
// The last one.
const _: () = assert!((Purpose::Caustic as u32) < 1 << PURPOSE_BITS);

/// The upper 53 of 64 bits, as a fraction. Exact: 53 bits fill a significand.
fn unit_interval(low: u32, high: u32) -> f64 {
    let bits = u64::from(high) << 32 | u64::from(low);
    (bits >> 11) as f64 * (f64::EPSILON / 2.0)
}

/// Philox4x32 with ten rounds: a bijection of `counter`, another one for each `key`.
#[inline]
pub fn philox4x32_10(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    // Multipliers chosen for avalanche by the authors; the key moves on by the golden ratio
    // and √3 − 1, times 2^32.
    const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    let ([mut x0, mut x1, mut x2, mut x3], [mut k0, mut k1]) = (counter, key);
    for _ in 0..10 {
        let first = u64::from(MULTIPLIERS[0]) * u64::from(x0);
        let second = u64::from(MULTIPLIERS[1]) * u64::from(x2);
        x0 = (second >> 32) as u32 ^ x1 ^ k0;
        x2 = (first >> 32) as u32 ^ x3 ^ k1;
        (x1, x3) = (second as u32, first as u32);
        (k0, k1) = (k0.wrapping_add(WEYL[0]), k1.wrapping_add(WEYL[1]));
    }
    [x0, x1, x2, x3]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The three `philox4x32 10` lines of `tests/kat_vectors` in Random123 1.14.0: counter, key,
    /// output.
    #[test]
    fn published_vectors() {
        let ones = u32::MAX;
        let vectors = [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [ones; 4],
                [ones; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, output) in vectors {
            assert_eq!(philox4x32_10(counter, key), output);
        }
    }

    #[test]
    fn the_interval_is_half_open_and_every_step_counts() {
        assert_eq!(unit_interval(0, 0), 0.0);
        assert_eq!(unit_interval(u32::MAX, u32::MAX), 1.0 - f64::EPSILON / 2.0);
        assert_eq!(unit_interval(1 << 11, 0), f64::EPSILON / 2.0);
    }

    /// The table above read backwards: every field comes back from the counter, so two uses
    /// with the same counter are the same use.
    #[test]
    fn every_field_can_be_read_back_from_the_counter() {
        let extremes = [0, 1, 0x5555_5555, u32::MAX - 1, u32::MAX];
        let bounces = [0, 1, (1 << 20) + 1, Stream::BOUNCES - 1];
        let purposes = [Purpose::Camera, Purpose::Channel, Purpose::Caustic];
        for pixel in extremes {
            for sample in extremes {
                let stream = Stream::new(7, pixel, sample);
                for (bounce, purpose, pair) in bounces.into_iter().flat_map(|bounce| {
                    purposes
                        .into_iter()
                        .flat_map(move |purpose| extremes.map(|pair| (bounce, purpose, pair)))
                }) {
                    let [first, second, third, fourth] = stream.counter(bounce, purpose, pair);
                    assert_eq!((first, third, fourth), (pair, sample, pixel));
                    assert_eq!(second >> PURPOSE_BITS, bounce);
                    assert_eq!(second % (1 << PURPOSE_BITS), purpose as u32);
                }
            }
        }
    }

    #[test]
    fn both_halves_of_the_seed_count() {
        let first = |seed| Stream::new(seed, 3, 5).uniform(0, Purpose::Camera, 0);
        assert_ne!(first(1), first(1 << 32));
        assert_ne!(first(0), first(1));
    }

    #[test]
    #[should_panic(expected = "has no random numbers")]
    fn a_bounce_out_of_range_is_refused() {
        Stream::new(0, 0, 0).uniform(Stream::BOUNCES, Purpose::Camera, 0);
    }
}
