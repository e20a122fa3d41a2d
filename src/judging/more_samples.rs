//! More samples for cases that noise leaves open: a renderer is called again until each is decided.

use super::{Cause, Judged, Looks, Verdict};
use crate::compare::{Picture, are_comparable};
use crate::film::Film;
use crate::renderers::{CallSettings, OtherRenderer, Rendered, stop_all};
use crate::suite::{Case, Output};
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

/// Pause between two looks at whether the user ended it.
const PAUSE: Duration = Duration::from_millis(50);

/// The part of the time limit of a call that a call is to take: estimates may be off by so much.
const SAFE: f64 = 1.0 / 3.0;

/// Further calls of a renderer, and what judges its images.
pub(crate) struct MoreSamples<'m> {
    /// The renderer that is called.
    pub renderer: &'m OtherRenderer,
    /// Judges an output at the look of this number, from 1.
    pub judge: &'m dyn Fn(&Case, Rendered, u32) -> Judged,
    /// Time for the calls of all cases.
    pub budget: Duration,
    /// True once the user ends the work; a call that is running is ended, too.
    pub interrupted: &'m (dyn Fn() -> bool + Sync),
    /// Takes a line on each look before it begins.
    pub note: &'m dyn Fn(&str),
}

/// A case that noise leaves open.
struct OpenCase<'c> {
    more: &'c MoreSamples<'c>,
    case: &'c Case,
    /// The judgement of the last look.
    judged: &'c mut Judged,
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
    fn next(&self) -> Option<(f64, f64)> {
        let target = self.looks.samples_of_next(&self.judged.result)?;
        let film = radiance(self.judged)?;
        let kept = states_noise(film).then(|| self.looks.samples());
        let new = target - kept.unwrap_or_default();
        let [seconds, samples] = self.spent;
        Some((target, new * seconds / samples))
    }

    /// Looks, samples, calls and time, as a note.
    fn in_words(&self) -> String {
        let reason = self.given_up.as_ref();
        let reason = reason.map_or(String::new(), |reason| format!("; {reason}"));
        format!(
            "looks: {}; samples per pixel: {}; calls: {}; {:.1} s{reason}",
            self.looks.count(),
            self.looks.samples(),
            self.calls,
            self.spent[0],
        )
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

/// The radiance of `output`, if it has the size of the golden, and finite values.
fn addable<'o>(output: &'o Output, judged: &Judged) -> Option<&'o Film> {
    let (Output::Picture(picture), Some(golden)) = (output, &judged.evidence.golden) else {
        return None;
    };
    let film = picture.radiance();
    film.filter(|film| are_comparable(golden, film))
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

/// True of a verdict that more samples may decide.
pub fn is_open(judged: &Judged) -> bool {
    first_look(judged).is_some()
}

impl MoreSamples<'_> {
    /// Renders the cases that noise leaves open with more and more samples, those first that take least, until
    /// each is decided or the time is over. Each was looked at once.
    pub fn decide(&self, cases: &[&Case], judged: &mut [Judged]) {
        let end = Instant::now() + self.budget;
        let is_done = AtomicBool::new(false);
        let interrupted = self.interrupted;
        std::thread::scope(|scope| {
            // A renderer that is running when the user ends the decision is ended, too.
            scope.spawn(|| {
                while !is_done.load(Ordering::SeqCst) {
                    if interrupted() {
                        return stop_all();
                    }
                    std::thread::sleep(PAUSE);
                }
            });
            let open = judged.iter_mut().filter_map(|it| self.open(cases, it));
            let mut open: Vec<OpenCase<'_>> = open.collect();
            self.look_until(end, &mut open);
            open.into_iter().for_each(OpenCase::close);
            is_done.store(true, Ordering::SeqCst);
        });
    }

    fn open<'c>(&'c self, cases: &[&'c Case], judged: &'c mut Judged) -> Option<OpenCase<'c>> {
        let looks = first_look(judged)?;
        Some(OpenCase {
            more: self,
            case: cases.iter().find(|case| case.name == judged.result.name)?,
            calls: 1,
            spent: [judged.result.seconds, looks.samples().max(1.0)],
            looks,
            judged,
            given_up: None,
            to_keep: Vec::new(),
        })
    }

    fn look_until(&self, end: Instant, open: &mut [OpenCase<'_>]) {
        loop {
            let is_cut_short = (self.interrupted)();
            let waiting = open.iter_mut().filter(|it| it.given_up.is_none());
            let next = waiting.filter_map(|it| Some((it.next()?, it)));
            if is_cut_short {
                next.for_each(|(_, it)| it.given_up = Some(INTERRUPTED.to_owned()));
                return;
            }
            let next = next.min_by(|((_, a), _), ((_, b), _)| a.total_cmp(b));
            let Some(((target, seconds), it)) = next else {
                return;
            };
            let left = end.saturating_duration_since(Instant::now()).as_secs_f64();
            if seconds > left {
                it.given_up = Some(format!(
                    "rendering {target} samples per pixel would take about {seconds:.1} s, but only {left:.1} s of \
                     the budget are left"
                ));
                continue;
            }
            (self.note)(&format!(
                "{}: look {}: rendering about {target} samples per pixel, {seconds:.0} s; {left:.0} s of the \
                 budget left",
                it.case.name,
                it.looks.count() + 1,
            ));
            it.given_up = it.look(target, seconds).err();
        }
    }
}

impl OpenCase<'_> {
    /// Renders more of the image and judges it; the error is the reason to give up.
    fn look(&mut self, target: f64, seconds: f64) -> Result<(), String> {
        let before = radiance(self.judged).filter(|film| states_noise(film));
        let mut films = Vec::from_iter(before.cloned());
        let adds_up = !films.is_empty();
        let (calls, samples) = if adds_up {
            let limit = self.more.renderer.options.timeout.as_secs_f64();
            let calls = (seconds / (SAFE * limit)).ceil().clamp(1.0, MOST_CALLS);
            (calls as u32, (target - self.looks.samples()) / calls)
        } else {
            (RENDERINGS, target / f64::from(RENDERINGS))
        };
        let spp = samples.ceil().clamp(1.0, MOST_SAMPLES) as u32;
        let mut last = None;
        for _ in 0..calls {
            let (rendered, film) = self.call(spp)?;
            films.push(film);
            last = Some(rendered);
        }
        let pooled = self.put_together(films, adds_up)?;
        let Some(mut rendered) = last else {
            return Ok(());
        };
        rendered.output = Output::Picture(Box::new(Picture::Radiance(pooled)));
        self.judge(rendered)
    }

    /// One more rendering, and its image, which can be added to the others.
    fn call(&mut self, spp: u32) -> Result<(Rendered, Film), String> {
        let renderer = self.more.renderer;
        let seed = renderer.options.first.seed.wrapping_add(self.calls);
        let start = Instant::now();
        let rendered = renderer.output(self.case, CallSettings { spp, seed });
        self.calls += 1;
        self.spent[0] += start.elapsed().as_secs_f64();
        self.spent[1] += f64::from(spp);
        if let Some(film) = addable(&rendered.output, self.judged).cloned() {
            return Ok((rendered, film));
        }
        let calls = self.calls;
        match rendered.output {
            Output::Unusable(_) | Output::Missing(_) if (self.more.interrupted)() => {
                Err(INTERRUPTED.to_owned())
            }
            Output::Unusable(reason) | Output::Missing(reason) => {
                let result = &mut self.judged.result;
                (result.verdict, result.cause) = (Verdict::Error, Cause::OtherRenderer);
                result.reason = reason;
                Err(format!("call {calls} failed"))
            }
            // No statistics: the verdict is that on this image alone.
            Output::Picture(_) | Output::Refined(_) => {
                self.to_keep.clear();
                *self.judged = (self.more.judge)(self.case, rendered, self.looks.count() + 1);
                let fault = format!("the image of call {calls} cannot be added to the others");
                Err(fault)
            }
        }
    }

    /// The image of these renderings, as a look. If they add up, the first is the image before.
    fn put_together(&mut self, films: Vec<Film>, adds_up: bool) -> Result<Film, String> {
        let pooled = Film::from_replicates(&films)
            .map_err(|error| format!("the renderings cannot be put together: {error}"))?;
        // The image before and the new one; or both halves.
        let middle = if adds_up { 1 } else { films.len() / 2 };
        let (one, other) = films.split_at(middle);
        let parts = together(one).zip(together(other));
        let parts = parts.as_ref().map(|(one, other)| [one, other]);
        self.looks.add(&pooled, parts);
        if parts.is_some_and(|[one, other]| shares_random_numbers(one, other)) {
            let fault = "renderings with different seeds share random numbers: does the renderer take {seed}?";
            return Err(fault.to_owned());
        }
        self.to_keep = if adds_up { vec![pooled.clone()] } else { films };
        Ok(pooled)
    }

    /// Judges the image of all samples; a failure before is final. The error is the reason to give up.
    fn judge(&mut self, rendered: Rendered) -> Result<(), String> {
        let mut now = (self.more.judge)(self.case, rendered, self.looks.count());
        let had_failed = self.judged.result.cause == Cause::Mismatch;
        if self.looks.is_heavy_tailed() {
            let result = &mut now.result;
            (result.verdict, result.cause) = (Verdict::Inconclusive, Cause::Undecided);
            result.reason = self.looks.in_words();
            *self.judged = now;
            Err("no number of samples decides".to_owned())
        } else if had_failed && now.result.cause != Cause::Mismatch {
            // All looks together have one false alarm rate.
            Err("it failed at an earlier look".to_owned())
        } else {
            *self.judged = now;
            Ok(())
        }
    }

    /// States in the result what the looks took, and keeps the images.
    fn close(self) {
        let note = self.in_words();
        let result = &mut self.judged.result;
        result.notes.push(note);
        if !self.to_keep.is_empty()
            && let Err(reason) = self.more.renderer.keep(self.case, &self.to_keep)
        {
            let note = format!("its images cannot be kept: {reason}");
            result.notes.push(note);
        }
        result.seconds = self.spent[0];
        self.judged.evidence.rendering_seconds = Some(self.spent[0]);
    }
}

/// True of two images that state their noise and are too much alike to be independent. An image of n samples and
/// one of 2n that begin with these have a third of the variance that their difference should have. Independent ones
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
