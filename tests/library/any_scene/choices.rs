//! Decisions read off a list of numbers.
//!
//! A scene is written by many small decisions. Read off a list, they need no generator of their
//! own: proptest makes lists and shrinks them, a fuzzer mutates their bytes. Where a list has
//! ended, and where its numbers are 0, every decision is the first and plainest there is; so a
//! shorter list of smaller numbers is a simpler scene.

/// The smallest number above 0.
const SMALLEST: f64 = f64::from_bits(1);

/// The numbers that a key may take, both ends included.
#[derive(Clone, Copy, Debug)]
pub struct Legal(pub f64, pub f64);

/// Any finite number.
pub const FINITE: Legal = Legal(f64::MIN, f64::MAX);
/// Finite and not negative.
pub const NOT_NEGATIVE: Legal = Legal(0.0, f64::MAX);
/// Finite and above 0.
pub const POSITIVE: Legal = Legal(SMALLEST, f64::MAX);
/// From 0 to 1.
pub const SHARE: Legal = Legal(0.0, 1.0);

/// Decisions, in the order of the list.
pub struct Choices<'l> {
    list: std::slice::Iter<'l, u32>,
    /// In so many of 64 cases a number is any legal one, else a usual one.
    wild: usize,
    /// What usual lengths are multiplied by.
    unit: f64,
    /// What usual radiances are multiplied by.
    light: f64,
}

impl<'l> Choices<'l> {
    /// Decisions by `list`.
    pub fn new(list: &'l [u32]) -> Choices<'l> {
        let mut choices = Choices {
            list: list.iter(),
            wild: 0,
            unit: 1.0,
            light: 1.0,
        };
        choices.wild = choices.pick(&[0, 1, 2, 4, 16, 64]);
        choices.unit = choices.scale();
        choices.light = choices.scale();
        choices
    }

    /// The size of a scene: most are of an ordinary one.
    fn scale(&mut self) -> f64 {
        if self.one_in(4) {
            return self.pick(&[
                1e-3, 1e3, 1e-12, 1e12, 1e-30, 1e30, 1e-99, 1e99, 1e-160, 1e160,
            ]);
        }
        1.0
    }

    fn word(&mut self) -> u32 {
        self.list.next().copied().unwrap_or(0)
    }

    /// A whole number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        ((u64::from(self.word()) * end as u64) >> 32) as usize
    }

    /// One of `all`.
    pub fn pick<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// Yes in one of `cases` cases.
    pub fn one_in(&mut self, cases: usize) -> bool {
        self.below(cases) == cases - 1
    }

    /// A whole number from `low` to `high`, usually at most `usual`.
    pub fn count(&mut self, low: u64, usual: u64, high: u64) -> u64 {
        if !self.is_wild() {
            return low + self.below((usual - low) as usize + 1) as u64;
        }
        match self.below(4) {
            0 => high,
            1 => high - 1,
            // Of every magnitude.
            2 => (high >> self.below(64)).max(low),
            _ => {
                let word = u64::from(self.word()) << 32 | u64::from(self.word());
                low + word % (high - low + 1)
            }
        }
    }

    fn is_wild(&mut self) -> bool {
        let wild = self.wild;
        self.below(64) >= 64 - wild
    }

    /// A number between two usual ones, or any legal one.
    pub fn number(&mut self, legal: Legal, usual: [f64; 2]) -> f64 {
        let number = if self.is_wild() {
            self.any_number(legal)
        } else {
            self.between(usual)
        };
        number.clamp(legal.0, legal.1)
    }

    /// A length, or coordinate, whose usual size is that of the scene.
    pub fn length(&mut self, legal: Legal, [low, high]: [f64; 2]) -> f64 {
        let unit = self.unit;
        self.number(legal, [low * unit, high * unit])
    }

    /// Something per length, whose usual size follows from that of the scene.
    pub fn per_length(&mut self, legal: Legal, [low, high]: [f64; 2]) -> f64 {
        let unit = self.unit;
        self.number(legal, [low / unit, high / unit])
    }

    /// A number between `low` and `high`: on the marks of a ruler, so that places coincide as
    /// they do in scenes that people write, or anywhere.
    fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        let share = if self.one_in(4) {
            f64::from(self.word()) / f64::from(u32::MAX)
        } else {
            self.below(9) as f64 / 8.0
        };
        low + (high - low) * share
    }

    fn any_number(&mut self, legal: Legal) -> f64 {
        let Legal(low, high) = legal;
        let magnitude = match self.below(12) {
            0 => return low,
            1 => return high,
            2 => return low.next_up(),
            3 => return high.next_down(),
            4 => 0.0,
            5 => SMALLEST,
            6 => f64::MIN_POSITIVE,
            7 => self.pick(&[1.0, f64::EPSILON, 1.0_f64.next_up(), 1.0_f64.next_down()]),
            8 => self.pick(&[1e300, 1e-300, 1e154, 1e-154, 1e38, 1e-38, 1e19, 1e-19]),
            // Of every magnitude, also within a range that ends near 0.
            9 | 10 => power_of_ten(self.below(617) as i32 - 308),
            _ => {
                let bits = u64::from(self.word()) << 32 | u64::from(self.word());
                return Some(f64::from_bits(bits))
                    .filter(|x| x.is_finite())
                    .unwrap_or(low);
            }
        };
        if self.one_in(2) {
            -magnitude
        } else {
            magnitude
        }
    }

    /// Three coordinates, as TOML.
    pub fn place(&mut self, usual: [f64; 2]) -> String {
        let place: Vec<_> = (0..3).map(|_| self.length(FINITE, usual)).collect();
        format!("{place:?}")
    }

    /// Three numbers of no length, as TOML.
    pub fn vector(&mut self, usual: [f64; 2]) -> String {
        let vector: Vec<_> = (0..3).map(|_| self.number(FINITE, usual)).collect();
        format!("{vector:?}")
    }

    /// Three numbers per length, as TOML.
    pub fn gradient(&mut self, usual: [f64; 2]) -> String {
        let vector: Vec<_> = (0..3).map(|_| self.per_length(FINITE, usual)).collect();
        format!("{vector:?}")
    }

    /// A colour, as TOML: one number or three.
    pub fn colour(&mut self, mut channel: impl FnMut(&mut Self) -> f64) -> String {
        if self.one_in(2) {
            let colour: Vec<_> = (0..3).map(|_| channel(self)).collect();
            return format!("{colour:?}");
        }
        format!("{:?}", channel(self))
    }

    /// Radiance by channel, as TOML.
    pub fn radiance(&mut self) -> String {
        let light = self.light;
        self.colour(|choices| choices.number(NOT_NEGATIVE, [0.0, 2.0 * light]))
    }

    /// Radiant intensity by channel, as TOML: such that the irradiance is usual at usual distances.
    pub fn intensity(&mut self) -> String {
        let intensity = (2.0 * self.light * self.unit * self.unit).min(f64::MAX);
        self.colour(|choices| choices.number(NOT_NEGATIVE, [0.0, intensity]))
    }

    /// Radiance per length by channel, as TOML.
    pub fn emission(&mut self) -> String {
        let emission = (self.light / self.unit).min(f64::MAX);
        self.colour(|choices| choices.number(NOT_NEGATIVE, [0.0, emission]))
    }

    /// Extinction, absorption or scattering by channel, as TOML.
    pub fn coefficient(&mut self) -> String {
        self.colour(|choices| choices.per_length(NOT_NEGATIVE, [0.0, 4.0]))
    }

    /// A share of light by channel, as TOML.
    pub fn share(&mut self) -> String {
        self.colour(|choices| choices.number(SHARE, [0.0, 1.0]))
    }

    /// Bytes of samples: 32-bit numbers that are finite, of both signs if asked for.
    pub fn sample(&mut self, signed: bool) -> f32 {
        let legal = if signed {
            Legal(f64::from(f32::MIN), f64::from(f32::MAX))
        } else {
            Legal(0.0, f64::from(f32::MAX))
        };
        let usual = if signed { [-1.0, 1.0] } else { [0.0, 1.5] };
        self.number(legal, usual) as f32
    }
}

fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().expect("a number")
}
