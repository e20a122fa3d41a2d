//! Hypotheses: one mistake, or two, behind an image.

use crate::compare::unexplained::SquaredDistance;
use crate::variations::mistakes::{self, Mistake};
use std::sync::LazyLock;

/// One mistake, or two, the first made before the second; by their places in the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Hypothesis {
    first: usize,
    second: Option<usize>,
}

/// Hypotheses that explain an image, with what they leave of the difference.
pub(super) type Explaining = Vec<(Hypothesis, SquaredDistance)>;

/// Pairs that one slip makes: the nearest node by rounding down is that of a volume half a voxel off.
const USUAL_PAIRS: [[&str; 2]; 4] = [
    ["nearest-for-trilinear", "volume-half-voxel-off"],
    ["nearest-for-trilinear", "volume-half-voxel-back"],
    ["interpolation-nearest", "grid-half-voxel-off"],
    ["interpolation-nearest", "grid-half-voxel-back"],
];

static CATALOGUE: LazyLock<Vec<&'static Mistake>> =
    LazyLock::new(|| mistakes::catalogue().collect());

impl Hypothesis {
    /// Each mistake for which `is` holds, by itself.
    pub fn singles(is: impl Fn(&Mistake) -> bool) -> Vec<Hypothesis> {
        let all = CATALOGUE.iter().enumerate();
        let wanted = all.filter(|(_, mistake)| is(mistake));
        let single = |(first, _)| Hypothesis {
            first,
            second: None,
        };
        wanted.map(single).collect()
    }

    /// The [usual pairs](USUAL_PAIRS) of mistakes.
    pub fn pairs() -> Vec<Hypothesis> {
        let place = |name: &str| CATALOGUE.iter().position(|mistake| mistake.name == name);
        let pairs = USUAL_PAIRS.iter().filter_map(|[first, second]| {
            Some(Hypothesis {
                first: place(first)?,
                second: Some(place(second)?),
            })
        });
        pairs.collect()
    }

    pub fn mistakes(&self) -> impl Iterator<Item = &'static Mistake> + Clone {
        let places = std::iter::once(self.first).chain(self.second);
        places.map(|place| CATALOGUE[place])
    }

    /// True if nothing has to be rendered.
    pub fn is_of_the_image(&self) -> bool {
        self.mistakes().all(|mistake| mistake.is_of_the_image())
    }

    pub fn name(&self) -> String {
        let names: Vec<_> = self.mistakes().map(|mistake| mistake.name).collect();
        names.join(" + ")
    }
}
