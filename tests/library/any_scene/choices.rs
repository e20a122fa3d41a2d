//! Decisions read off a list of numbers.
//!
//! A scene is written by many small decisions. Read off a list, they need no generator of their
//! own: proptest makes lists and shrinks them, a fuzzer mutates their bytes. Where a list has
//! ended, and where its numbers are 0, every decision is the first and plainest there is; so a
//! shorter list of smaller numbers is a simpler scene.

/// The smallest number above 0.
const SMALLEST: f64 = f64::from_bits(1);

/// The numbers that a key may take, both ends included, by the letter that the grammar has for them.
fn legal(letter: &str) -> [f64; 2] {
    match letter {
        "f" => [f64::MIN, f64::MAX],
        "z" => [0.0, f64::MAX],
        "+" => [SMALLEST, f64::MAX],
        "s" => [0.0, 1.0],
        // Below 1, and below 180.
        "u" => [0.0, 1.0_f64.next_down()],
        "v" => [SMALLEST, 180.0_f64.next_down()],
        // Angles, mean cosines, diameters of droplets.
        "d" => [0.0, 180.0],
        "a" => [(-1.0_f64).next_up(), 1.0_f64.next_down()],
        "m" => [5.0, 50.0],
        // 32-bit numbers, of both signs and not.
        "h" => [f64::from(f32::MIN), f64::from(f32::MAX)],
        "t" => [0.0, f64::from(f32::MAX)],
        _ => panic!("{letter}"),
    }
}

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

    /// A number between two usual ones, or any legal one: of no length (`n`), a length or coordinate, whose usual
    /// size is that of the scene (`l`), or something per length (`g`).
    pub fn of_kind(&mut self, kind: &str, letter: &str, usual: [f64; 2]) -> f64 {
        let factor = match kind {
            "l" => self.unit,
            "g" => 1.0 / self.unit,
            _ => 1.0,
        };
        self.number(legal(letter), usual.map(|number| number * factor))
    }

    fn number(&mut self, legal: [f64; 2], usual: [f64; 2]) -> f64 {
        let number = if self.is_wild() {
            self.any_number(legal)
        } else {
            self.between(usual)
        };
        number.clamp(legal[0], legal[1])
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

    fn any_number(&mut self, [low, high]: [f64; 2]) -> f64 {
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

    /// A colour, as TOML, of one number or three: radiance; intensity, such that the irradiance is usual at
    /// usual distances; emission per length; coefficients of a medium; a share of light.
    pub fn colour(&mut self, what: &str) -> String {
        let (light, unit) = (self.light, self.unit);
        let (letter, most) = match what {
            "radiance" => ("z", 2.0 * light),
            "intensity" => ("z", (2.0 * light * unit * unit).min(f64::MAX)),
            "emission" => ("z", (light / unit).min(f64::MAX)),
            "coefficient" => ("z", 4.0 / unit),
            _ => ("s", 1.0),
        };
        let mut channel = || self.number(legal(letter), [0.0, most]);
        let colour = [channel(), channel(), channel()];
        match self.one_in(2) {
            true => format!("{colour:?}"),
            false => format!("{:?}", colour[0]),
        }
    }

    /// A 32-bit number that is finite, of both signs if asked for.
    pub fn sample(&mut self, signed: bool) -> f32 {
        let (letter, usual) = if signed {
            ("h", [-1.0, 1.0])
        } else {
            ("t", [0.0, 1.5])
        };
        self.of_kind("n", letter, usual) as f32
    }
}

fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().expect("a number")
}
