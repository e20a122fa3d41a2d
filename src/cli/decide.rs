//! `volref validate --decide`: more samples where noise leaves a verdict open.

use super::made::{Ask, Made};
use super::output::number_of;
use super::{interrupt, progress};
use crate::compare::{Picture, are_comparable};
use crate::film::Film;
use crate::judging::{CaseResult, Cause, Judged, Looks, Output, Verdict};
use crate::renderers::stop_all;
use crate::suite::Case;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Renderings of a look at images that do not state their noise: the error of a variance that is taken
/// from the spread of so many is a third of it.
const RENDERINGS: u32 = 16;

/// Samples per pixel of a call, at most, and calls of a look.
const MOST_SAMPLES: f64 = (1 << 24) as f64;
const MOST_CALLS: f64 = 64.0;

/// The reason of a decision that the user ended.
const INTERRUPTED: &str = "interrupted";

/// Between two looks at whether it was.
const PAUSE: Duration = Duration::from_millis(50);

/// Names of the biases that a pass would have shown.
const SMALLEST_BIAS: &str = "smallest_visible_bias";
const SMALLEST_BLOCK_BIAS: &str = "smallest_visible_block_bias";

/// The part of the time limit of a call that a call is to take: estimates may be off by so much.
const SAFE: f64 = 1.0 / 3.0;

/// A renderer that can be called again, and what judges its images.
pub(super) trait LookAgain {
    /// Parameters of the first call.
    fn first(&self) -> Ask;
    /// Of a call, in seconds.
    fn time_limit(&self) -> f64;
    fn rendered(&self, case: &Case, ask: Ask) -> Made;
    /// At the look of this number, from 1.
    fn judged(&self, case: &Case, made: Made, look: u32) -> Judged;
    /// Keeps these images in place of that of the last call, if images are kept; else the reason, in
    /// words. One is that of all looks, several are renderings.
    fn keep(&self, case: &Case, films: &[Film]) -> Result<(), String>;
}

/// A case that noise leaves open.
struct OpenCase<'c> {
    case: &'c Case,
    /// Among the judged.
    index: usize,
    looks: Looks,
    calls: u64,
    /// Seconds of all calls, and samples per pixel that they took.
    spent: [f64; 2],
    /// Reason why it stays open.
    given_up: Option<String>,
    /// The image of all looks, or the renderings of the last one.
    to_keep: Vec<Film>,
}

impl OpenCase<'_> {
    /// Samples per pixel of the next look, in all, and seconds that they will take, about.
    fn next(&self, judged: &[Judged]) -> Option<(f64, f64)> {
        let judged = &judged[self.index];
        let target = self.looks.samples_of_next(&judged.result)?;
        let film = radiance(judged)?;
        let new = if states_noise(film) {
            target - self.looks.samples()
        } else {
            target
        };
        let [seconds, samples] = self.spent;
        Some((target, new * seconds / samples))
    }

    /// Looks, samples, calls and time, as a note; of a pass, what it would have shown.
    fn in_words(&self, result: &CaseResult) -> String {
        let [seconds, _] = self.spent;
        let (looks, calls) = (self.looks.count(), self.calls);
        let done = format!(
            "{}, {} samples per pixel, {}, {seconds:.1} s",
            number_of(looks.into(), "look"),
            self.looks.samples(),
            number_of(calls, "call"),
        );
        if let Some(reason) = &self.given_up {
            return format!("{done}; {reason}");
        }
        let bias = |name| Some(100.0 * result.metrics.get(name)?);
        let biases = [SMALLEST_BIAS, SMALLEST_BLOCK_BIAS].map(bias);
        match (result.verdict, biases) {
            (Verdict::Pass, [Some(mean), Some(block)]) => format!(
                "{done}; a bias of {mean:.2} % of the mean, or of {block:.2} % of a block, would have been seen"
            ),
            _ => done,
        }
    }
}

fn radiance(judged: &Judged) -> Option<&Film> {
    judged.evidence.test.as_ref().and_then(Picture::radiance)
}

/// One image of these.
fn together(films: &[Film]) -> Option<Film> {
    match films {
        [one] => Some(one.clone()),
        several => Film::from_replicates(several).ok(),
    }
}

/// The image has the size of the golden, and finite values.
fn can_be_added(picture: &Picture, judged: &Judged) -> bool {
    let golden = judged.evidence.golden.as_ref();
    let both = golden.zip(picture.radiance());
    both.is_some_and(|(golden, film)| are_comparable(golden, film))
}

/// The image states the noise of its samples; else it takes several.
fn states_noise(film: &Film) -> bool {
    let noise = film.noise();
    noise.is_some_and(|noise| !noise.is_of_renderings() && !noise.is_known())
}

/// The first look at an image, if more samples may decide it.
fn first_look(judged: &Judged) -> Option<Looks> {
    let mut looks = Looks::default();
    looks.add(radiance(judged)?, None);
    let is_open = looks.samples_of_next(&judged.result).is_some();
    is_open.then_some(looks)
}

/// More samples may decide this.
pub(super) fn is_open(judged: &Judged) -> bool {
    first_look(judged).is_some()
}

/// Renders the cases that noise leaves open with more and more samples, those first that take least, until
/// each is decided or the time is over. Each was looked at once.
pub(super) fn decide(
    again: &dyn LookAgain,
    cases: &[&Case],
    judged: &mut [Judged],
    budget: Duration,
) {
    let end = Instant::now() + budget;
    let is_done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        // A renderer that is running when the user ends the decision is ended, too.
        scope.spawn(|| {
            while !is_done.load(Ordering::SeqCst) {
                if interrupt::is_cut_short() {
                    return stop_all();
                }
                std::thread::sleep(PAUSE);
            }
        });
        decide_until(end, again, cases, judged);
        is_done.store(true, Ordering::SeqCst);
    });
}

fn decide_until(end: Instant, again: &dyn LookAgain, cases: &[&Case], judged: &mut [Judged]) {
    let mut open: Vec<OpenCase<'_>> = Vec::new();
    for (index, one) in judged.iter().enumerate() {
        let case = cases.iter().find(|case| case.name == one.result.name);
        if let Some(case) = case
            && let Some(looks) = first_look(one)
        {
            let spent = [one.result.seconds, looks.samples().max(1.0)];
            open.push(OpenCase {
                case,
                index,
                looks,
                calls: 1,
                spent,
                given_up: None,
                to_keep: Vec::new(),
            });
        }
    }
    loop {
        if interrupt::is_cut_short() {
            let waiting = open.iter_mut().filter(|it| it.given_up.is_none());
            let still_open = waiting.filter(|it| it.next(judged).is_some());
            still_open.for_each(|it| it.given_up = Some(INTERRUPTED.to_owned()));
            break;
        }
        let waiting = open.iter_mut().filter(|it| it.given_up.is_none());
        let next = waiting.filter_map(|it| {
            let (target, seconds) = it.next(judged)?;
            Some((it, target, seconds))
        });
        let Some((it, target, seconds)) = next.min_by(|a, b| a.2.total_cmp(&b.2)) else {
            break;
        };
        let left = end.saturating_duration_since(Instant::now()).as_secs_f64();
        if seconds > left {
            it.given_up = Some(format!(
                "a next look, at {target} samples per pixel, would take about {seconds:.1} s, and {left:.1} s of \
                 the budget are left"
            ));
            continue;
        }
        progress::note(&format!(
            "{}: look {}, about {target} samples per pixel may decide, {seconds:.0} s; {left:.0} s of the \
             budget left",
            it.case.name,
            it.looks.count() + 1,
        ));
        it.look(again, judged, (target, seconds));
    }
    for it in &open {
        let kept = match &it.to_keep[..] {
            [] => Ok(()),
            films => again.keep(it.case, films),
        };
        let result = &mut judged[it.index].result;
        result.notes.push(it.in_words(result));
        if let Err(reason) = kept {
            result
                .notes
                .push(format!("its images cannot be kept: {reason}"));
        }
        let [seconds, _] = it.spent;
        result.seconds = seconds;
        judged[it.index].evidence.noise_by_samples = it.looks.noise();
    }
}

impl OpenCase<'_> {
    /// Renders more of the image and judges it.
    fn look(
        &mut self,
        again: &dyn LookAgain,
        judged: &mut [Judged],
        (target, seconds): (f64, f64),
    ) {
        let before = radiance(&judged[self.index]);
        let known = before.filter(|film| states_noise(film)).cloned();
        let (calls, samples) = match &known {
            Some(_) => {
                let within = seconds / (SAFE * again.time_limit());
                let calls = within.ceil().clamp(1.0, MOST_CALLS);
                (calls as u32, (target - self.looks.samples()) / calls)
            }
            None => (RENDERINGS, target / f64::from(RENDERINGS)),
        };
        let spp = samples.ceil().clamp(1.0, MOST_SAMPLES) as u32;
        let is_added_up = known.is_some();
        let mut films = Vec::from_iter(known);
        let mut last = None;
        for _ in 0..calls {
            let ask = Ask {
                spp,
                seed: again.first().seed.wrapping_add(self.calls),
            };
            let start = Instant::now();
            let made = again.rendered(self.case, ask);
            self.calls += 1;
            self.spent[0] += start.elapsed().as_secs_f64();
            self.spent[1] += f64::from(spp);
            match &made.output {
                Output::Picture(picture) if can_be_added(picture, &judged[self.index]) => {
                    films.extend(picture.radiance().cloned());
                }
                Output::Unusable(_) | Output::Missing(_) if interrupt::is_cut_short() => {
                    self.given_up = Some(INTERRUPTED.to_owned());
                    return;
                }
                Output::Unusable(reason) | Output::Missing(reason) => {
                    self.given_up = Some(format!("call {} failed", self.calls));
                    let result = &mut judged[self.index].result;
                    result.verdict = Verdict::Error;
                    result.cause = Cause::OtherRenderer;
                    result.reason = reason.clone();
                    return;
                }
                // No statistics: the verdict is that on this image alone.
                Output::Picture(_) | Output::Refined(_) => {
                    let calls = self.calls;
                    self.given_up = Some(format!(
                        "the image of call {calls} cannot be added to the others"
                    ));
                    self.to_keep.clear();
                    let mut now = again.judged(self.case, made, self.looks.count() + 1);
                    let notes = std::mem::take(&mut judged[self.index].result.notes);
                    now.result.notes.splice(0..0, notes);
                    judged[self.index] = now;
                    return;
                }
            }
            last = Some(made);
        }
        let pooled = match Film::from_replicates(&films) {
            Ok(pooled) => pooled,
            Err(error) => {
                self.given_up = Some(format!("the renderings cannot be put together: {error}"));
                return;
            }
        };
        // The image before and the new one; or both halves.
        let middle = if is_added_up { 1 } else { films.len() / 2 };
        let (one, other) = films.split_at(middle);
        let [one, other] = [one, other].map(together);
        self.looks.add(
            &pooled,
            one.as_ref().zip(other.as_ref()).map(|(a, b)| [a, b]),
        );
        if let (Some(one), Some(other)) = (&one, &other)
            && shares_random_numbers(one, other)
        {
            self.given_up = Some(
                "renderings with different seeds share random numbers: does the renderer take {seed}?".to_owned(),
            );
            return;
        }
        self.to_keep = if is_added_up {
            vec![pooled.clone()]
        } else {
            films
        };
        let output = Output::Picture(Box::new(Picture::Radiance(pooled)));
        let Some(mut made) = last else { return };
        made.output = output;
        let mut now = again.judged(self.case, made, self.looks.count());
        let notes = std::mem::take(&mut judged[self.index].result.notes);
        now.result.notes.splice(0..0, notes);
        if self.looks.is_heavy_tailed() {
            now.result.verdict = Verdict::Inconclusive;
            now.result.cause = Cause::Undecided;
            now.result.reason = self.looks.in_words();
            self.given_up = Some("no number of samples decides".to_owned());
        } else if judged[self.index].result.cause == Cause::Mismatch
            && now.result.cause != Cause::Mismatch
        {
            // A failed look is final: all looks together have one false alarm rate.
            judged[self.index].result.notes = std::mem::take(&mut now.result.notes);
            self.given_up = Some("it failed at an earlier look".to_owned());
            return;
        }
        judged[self.index] = now;
    }
}

/// True of two images that state their noise and are too much alike to be independent. Of the variance that their
/// difference should have, an image of n samples and one of 2n that begin with these have a third; independent ones
/// have all of it, to the standard error of as many normal squares as there are pixels, or more where rare samples make
/// the stated variances too small.
fn shares_random_numbers(one: &Film, other: &Film) -> bool {
    let (Some(of_one), Some(of_other)) = (one.noise(), other.noise()) else {
        return false;
    };
    let (mut sum, mut pixels) = (0.0, 0.0);
    let variances = of_one.variance().iter().zip(of_other.variance());
    let values = one.radiance().iter().zip(other.radiance());
    for ((a, b), (of_a, of_b)) in values.zip(variances) {
        let difference = f64::from(a[1]) - f64::from(b[1]);
        let variance = f64::from(of_a[1]) + f64::from(of_b[1]);
        if variance > 0.0 {
            sum += difference * difference / variance;
            pixels += 1.0;
        }
    }
    let error = f64::sqrt(2.0 / pixels);
    pixels > 0.0 && sum / pixels < 1.0 - 8.0 * error
}

/// A time in words: `10m`, `90s`, `1h`; a number alone is seconds.
pub(super) fn budget(text: &str) -> Result<Duration, String> {
    let expected = || "a budget is a time such as 90s, 10m or 2h".to_owned();
    let (number, unit) = match text.char_indices().last() {
        Some((at, 's')) => (&text[..at], 1.0),
        Some((at, 'm')) => (&text[..at], 60.0),
        Some((at, 'h')) => (&text[..at], 3600.0),
        _ => (text, 1.0),
    };
    let seconds = unit * number.parse::<f64>().map_err(|_| expected())?;
    match seconds {
        seconds if (0.0..=1e9).contains(&seconds) => Ok(Duration::from_secs_f64(seconds)),
        _ => Err(expected()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_times() {
        for (text, seconds) in [
            ("90s", 90),
            ("10m", 600),
            ("0.5h", 1800),
            ("7", 7),
            ("0", 0),
        ] {
            assert_eq!(budget(text), Ok(Duration::from_secs(seconds)), "{text}");
        }
        for text in ["", "m", "-1s", "10 minutes", "NaN", "inf", "1d", "1e300h"] {
            assert!(budget(text).is_err(), "{text}");
        }
    }
}
