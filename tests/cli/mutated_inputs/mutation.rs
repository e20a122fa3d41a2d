//! How inputs are broken.

/// Numbers that readers stumble over, as text.
const TEXTS: [&str; 22] = [
    "0",
    "-1",
    "1",
    "2",
    "-0.0",
    "1e308",
    "-1e308",
    "1e-320",
    "1e400",
    "nan",
    "inf",
    "-inf",
    "255",
    "65536",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967296",
    "9223372036854775807",
    "99999999999999999999999",
    "0.1",
    "1000000000",
];

/// The same in four bytes.
const WORDS: [u32; 14] = [
    0,
    1,
    2,
    3,
    0xff,
    0xffff,
    0x1_0000,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7fc0_0000,
    0x7f80_0000,
    0xff7f_ffff,
    0x1000_0000,
];

/// Random numbers and what is made by them; the same for the same seed and index.
pub struct Mutator(u64);

impl Mutator {
    pub fn new(seed: u64, index: u64) -> Mutator {
        let mut mutator = Mutator(seed);
        let stream = mutator.next() ^ index;
        Mutator(stream)
    }

    /// SplitMix64 (Steele, Lea & Flood 2014).
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number below `end`, which is above 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    /// Heads or tails.
    pub fn chance(&mut self) -> bool {
        self.next() & 1 == 1
    }

    /// Any of them; there is one.
    pub fn one_of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }

    /// A range in `length` bytes, more often a short one.
    fn range(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        let most = (length - start).min(1 << self.below(12));
        start..start + self.below(most + 1)
    }

    /// One of `seeds`, broken in one to four ways.
    pub fn mutant(&mut self, seeds: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = self.one_of(seeds).clone();
        for _ in 0..=self.below(4) {
            self.mutate(&mut bytes, seeds);
        }
        bytes
    }

    fn mutate(&mut self, bytes: &mut Vec<u8>, seeds: &[Vec<u8>]) {
        let is_text = std::str::from_utf8(bytes).is_ok();
        let ways = if is_text { 14 } else { 9 };
        let length = bytes.len();
        match self.below(ways) {
            0 if length > 0 => {
                let at = self.below(length);
                bytes[at] ^= 1 << self.below(8);
            }
            1 if length > 0 => {
                let at = self.below(length);
                bytes[at] = *self.one_of(&[0, 1, 0x7f, 0x80, 0xff, b'\n', b'"', b'=']);
            }
            2 => bytes.truncate(self.below(length + 1)),
            3 => drop(bytes.drain(self.range(length))),
            4 => {
                let again = bytes[self.range(length)].to_vec();
                let at = self.below(length + 1);
                bytes.splice(at..at, again);
            }
            5 => {
                let other = self.one_of(seeds);
                let start = self.below(other.len() + 1);
                bytes.truncate(self.below(length + 1));
                bytes.extend_from_slice(&other[start..]);
            }
            6 => {
                let at = self.below(length + 1);
                let noise: Vec<u8> = (0..self.below(9)).map(|_| self.next() as u8).collect();
                bytes.splice(at..at, noise);
            }
            7 | 8 if length >= 4 => {
                let at = self.below(length - 3);
                let word = *self.one_of(&WORDS);
                let word = if self.chance() {
                    word.to_le_bytes()
                } else {
                    word.to_be_bytes()
                };
                let count = *self.one_of(&[1, 2, 4]);
                bytes[at..at + count].copy_from_slice(&word[..count]);
            }
            9..=11 => self.swap_numbers(bytes),
            12 | 13 => self.swap_lines(bytes),
            _ => {}
        }
    }

    /// Puts another number in the place of one.
    fn swap_numbers(&mut self, bytes: &mut Vec<u8>) {
        let of_number = |byte: &u8| byte.is_ascii_digit() || b"+-.".contains(byte);
        let mut places = Vec::new();
        let mut start = None;
        for (at, byte) in bytes.iter().chain([&b' ']).enumerate() {
            match (of_number(byte), start) {
                (true, None) => start = Some(at),
                (false, Some(first)) => {
                    places.push(first..at);
                    start = None;
                }
                _ => {}
            }
        }
        if places.is_empty() {
            return;
        }
        let number = if self.chance() {
            self.one_of(&TEXTS).as_bytes().to_vec()
        } else {
            bytes[self.one_of(&places).clone()].to_vec()
        };
        bytes.splice(self.one_of(&places).clone(), number);
    }

    /// Repeats a line, drops it, or puts another in its place.
    fn swap_lines(&mut self, bytes: &mut Vec<u8>) {
        let mut lines: Vec<Vec<u8>> = bytes.split(|&byte| byte == b'\n').map(Vec::from).collect();
        let (one, other) = (self.below(lines.len()), self.below(lines.len()));
        match self.below(3) {
            0 => lines.insert(other, lines[one].clone()),
            1 => drop(lines.remove(one)),
            _ => lines.swap(one, other),
        }
        *bytes = lines.join(&b'\n');
    }
}
