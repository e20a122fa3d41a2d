//! The search for the mistakes behind one image: cheap hypotheses first, each with as few pixels as
//! rule it out.

use super::clock::SearchClock;
use super::compared_case::ComparedCase;
use super::hypothesis::{Explaining, Hypothesis, mistake};
use crate::compare::cells::Misfit;
use crate::compare::unexplained::UNEXPLAINED;
use crate::film::Film;
use crate::variations::mistakes;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Largest number of hypotheses with a mistake of the scene that get a second look. One takes up to
/// 16 times the work of a first look, so that eight take as much as first looks at the whole
/// catalogue.
const MOST_SECOND_LOOKS: usize = 8;

/// More candidates for noisy images: a coarse render is too noisy to rank them reliably. The work is half again
/// that of the second looks, and of the third looks at eight of them.
const MOST_NOISY_LOOKS: usize = 24;

/// Pairs that one slip makes, tried with the single mistakes: the nearest node by rounding down is that
/// of a volume half a voxel off.
const USUAL_PAIRS: [[&str; 2]; 4] = [
    ["nearest-for-trilinear", "volume-half-voxel-off"],
    ["nearest-for-trilinear", "volume-half-voxel-back"],
    ["interpolation-nearest", "grid-half-voxel-off"],
    ["interpolation-nearest", "grid-half-voxel-back"],
];

/// Largest share of the squared difference that one mistake leaves which a second beside it may leave: one that
/// takes less is a stray.
const WORTH_A_SECOND: f64 = 0.5;

/// Share of the squared difference that a pair may leave, where there is no noise: a quarter of what one mistake may,
/// for two come nearer by chance.
const LEFT_BY_PAIRS: f64 = 0.25 * UNEXPLAINED;

/// Largest share of the work for mistakes of the image in its pixels: the others need the rest.
const OF_PIXELS: f64 = 0.1;

/// Events of kernels that take as long as an edit and a comparison of one pixel.
const EVENTS_OF_AN_EDIT: usize = 8;

/// First looks at mistakes of the scene, by place in the catalogue.
type FirstLooks = BTreeMap<usize, Film>;

/// Order of misfits: the one that leaves less first.
fn nearer(a: &Misfit, b: &Misfit) -> Ordering {
    a.remoteness().total_cmp(&b.remoteness())
}

/// Sorts hypotheses on a noisy image, by turns the one that explains most of it in large tiles and the one that is least
/// different from it in its cells: the one is sure of what is small in all of them, the other of what is large in few.
fn likeliest_first(promising: &mut Explaining) {
    let ranks = |of: &dyn Fn(&Misfit) -> f64| {
        let mut order: Vec<usize> = (0..promising.len()).collect();
        order.sort_by(|&a, &b| of(&promising[a].1).total_cmp(&of(&promising[b].1)));
        let mut ranks = vec![0; order.len()];
        (order.into_iter().enumerate()).for_each(|(rank, index)| ranks[index] = rank);
        ranks
    };
    let [in_cells, in_tiles] = [ranks(&|it| it.in_noise), ranks(&|it| -it.gain)];
    let mut order: Vec<usize> = (0..promising.len()).collect();
    order.sort_by_key(|&index| (in_cells[index].min(in_tiles[index]), in_tiles[index]));
    *promising = order.into_iter().map(|index| promising[index]).collect();
}

/// Places in the catalogue of the mistakes that may explain colours.
fn of_colours() -> impl Iterator<Item = usize> {
    let mistakes = mistakes::catalogue().enumerate();
    mistakes
        .filter(|(_, mistake)| !mistake.is_of_opacity())
        .map(|(index, _)| index)
}

/// Number of mistakes that may explain colours.
pub(super) fn singles() -> usize {
    of_colours().count()
}

/// Work of an edit of `film` and of its comparison, as much as that many [events](crate::render::Event) take.
fn work_on(film: &Film) -> u64 {
    (EVENTS_OF_AN_EDIT * film.width() * film.height()) as u64
}

impl ComparedCase {
    /// The mistakes that explain the image, nearest first. Mistakes of the image, which take no rendering, are tried
    /// first; the usual pairs, where no single mistake does.
    pub fn search(&self, clock: &SearchClock<'_>) -> Explaining {
        let mut looks = FirstLooks::new();
        let mut found = Explaining::new();
        let mut promising = Explaining::new();
        let (of_the_image, of_the_scene): (Vec<usize>, Vec<usize>) =
            of_colours().partition(|&index| mistake(index).is_of_the_image());
        for index in of_the_image {
            if !clock.spend_early(work_on(&self.golden)) {
                break;
            }
            if !(self.is_gain() && mistake(index).is_curve())
                && let Some(film) = mistake(index).in_image(&self.golden)
                && let Some(misfit) = self.misfit(&film)
                && self.is_explanation(&Hypothesis::One(index), &film, &misfit)
            {
                found.push((Hypothesis::One(index), misfit));
            }
            clock.decided();
        }
        self.render_unchanged(clock);
        for index in of_the_scene {
            let look = self.look(&Hypothesis::One(index), clock);
            if clock.is_late() {
                break;
            }
            if let Some(film) = look {
                let promise = self.promise(&film, clock);
                promising.extend(promise.map(|misfit| (Hypothesis::One(index), misfit)));
                looks.insert(index, film);
            }
            clock.decided();
        }
        found.extend(self.look_closer(promising, clock));
        if found.is_empty() {
            found = self.look_closer(self.usual_pairs(&looks, clock), clock);
        }
        found.sort_by(|(_, a), (_, b)| nearer(a, b));
        found
    }

    /// The mistakes of the image that explain an image with noise pixel by pixel, nearest first: what moves light within
    /// a block shows in no block.
    pub fn search_in_pixels(&self, clock: &SearchClock<'_>) -> Explaining {
        let of_the_image = of_colours().filter(|&index| mistake(index).is_of_the_image());
        let of_the_image: Vec<usize> = of_the_image.collect();
        let work = work_on(&self.golden) * of_the_image.len() as u64;
        let pixels = self.noisy_pixels();
        let Some(pixels) = pixels.filter(|_| clock.spend_share(work, OF_PIXELS)) else {
            return Explaining::new();
        };
        let found = of_the_image.into_iter().filter_map(|index| {
            let film = mistake(index).in_image(&self.golden)?;
            let misfit = pixels.explained_by(&film, self.may_leave());
            misfit.map(|misfit| (Hypothesis::One(index), misfit))
        });
        let mut found: Explaining = found.collect();
        found.sort_by(|(_, a), (_, b)| nearer(a, b));
        found
    }

    /// The pairs of one cause that may explain the image.
    fn usual_pairs(&self, looks: &FirstLooks, clock: &SearchClock<'_>) -> Explaining {
        let pairs = USUAL_PAIRS.iter().filter_map(|names| {
            let [first, second] =
                names.map(|name| of_colours().find(|&at| mistake(at).name == name));
            let (first, second) = (first?, second?);
            let both_occur = looks.contains_key(&first) && looks.contains_key(&second);
            let pair = both_occur.then_some(Hypothesis::Two(first, second))?;
            let look = self.look(&pair, clock)?;
            self.promise(&look, clock).map(|misfit| (pair, misfit))
        });
        pairs.collect()
    }

    /// Hypotheses among the nearest that explain the image on a second look, nearest first.
    fn look_closer(&self, mut promising: Explaining, clock: &SearchClock<'_>) -> Explaining {
        if self.is_sampled() {
            promising = self.second_looks(promising, clock);
        } else {
            promising.sort_by(|(_, a), (_, b)| a.distance().value.total_cmp(&b.distance().value));
        }
        promising.truncate(MOST_SECOND_LOOKS);
        if !self.sees_all_at_once() {
            promising.retain_mut(|(hypothesis, misfit)| {
                let second = self.is_sampled().then_some(*misfit);
                let closer = self.explanation(hypothesis, second, clock);
                *misfit = closer.unwrap_or(*misfit);
                closer.is_some()
            });
        }
        promising.retain(|(hypothesis, misfit)| self.needs_both(hypothesis, misfit, clock));
        promising.sort_by(|(_, a), (_, b)| nearer(a, b));
        promising
    }

    /// Hypotheses that may explain a noisy image on a second look, the likeliest first.
    fn second_looks(&self, mut promising: Explaining, clock: &SearchClock<'_>) -> Explaining {
        likeliest_first(&mut promising);
        promising.truncate(MOST_NOISY_LOOKS);
        let closer = promising.into_iter().filter_map(|(hypothesis, _)| {
            Some((hypothesis, self.second_look(&hypothesis, clock)?))
        });
        let mut promising: Explaining = closer.collect();
        likeliest_first(&mut promising);
        promising
    }

    /// True of one mistake, and of a pair that leaves less than [`WORTH_A_SECOND`] of what either of the
    /// two leaves alone, and without noise no more than [`LEFT_BY_PAIRS`].
    fn needs_both(
        &self,
        hypothesis: &Hypothesis,
        misfit: &Misfit,
        clock: &SearchClock<'_>,
    ) -> bool {
        let Hypothesis::Two(first, second) = *hypothesis else {
            return true;
        };
        let left = misfit.distance().value;
        if !self.is_sampled() && !self.leaves(misfit, LEFT_BY_PAIRS) {
            return false;
        }
        [first, second].into_iter().all(|one| {
            let alone = self.test(&Hypothesis::One(one), clock);
            alone.is_none_or(|alone| left <= WORTH_A_SECOND * alone.distance().value)
        })
    }
}
