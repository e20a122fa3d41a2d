//! The pixel loop: rows in parallel, their pixels one after the other.

use super::counters::Counters;
use super::progress::Progress;
use rayon::prelude::*;
use std::iter::StepBy;
use std::ops::Range;

/// Which pixels of an image are rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// All pixels.
    Whole,
    /// In each panel every n-th column and row, the first n/2 from the edge. Each pixel has the
    /// same bits as in the whole image.
    Lattice(usize),
    /// In each panel blocks of this many columns and rows, as one pixel each; incomplete blocks at
    /// the right and the bottom are left out. Path tracing samples the whole block, so that the
    /// result is the mean of its pixels; kernels with one ray per pixel cast it through the upper
    /// left pixel.
    Blocks(usize),
}

impl Detail {
    /// The columns, or rows, out of `count` that are rendered or begin a block.
    pub fn places(self, count: usize) -> StepBy<Range<usize>> {
        let (first, end, step) = match self {
            Detail::Whole => (0, count, 1),
            Detail::Lattice(every) => ((every / 2).min(count.saturating_sub(1)), count, every),
            Detail::Blocks(edge) => (0, count - count % edge, edge),
        };
        (first..end).step_by(step)
    }

    /// Edge of the square that a pixel is the mean of, in pixels of the whole image.
    pub(super) fn edge(self) -> f64 {
        match self {
            Detail::Whole | Detail::Lattice(_) => 1.0,
            Detail::Blocks(edge) => edge as f64,
        }
    }
}

/// The pixels of one panel.
pub(super) struct Pixels<'p> {
    pub width: usize,
    pub height: usize,
    /// Samples per pixel; 1 if the image is not sampled.
    pub samples: u32,
    pub detail: Detail,
    /// Whether to skip the rows not yet begun.
    pub stopped: &'p (dyn Fn() -> bool + Sync),
    pub progress: Progress<'p>,
}

impl Pixels<'_> {
    fn columns(&self) -> StepBy<Range<usize>> {
        self.detail.places(self.width)
    }

    fn rows(&self) -> StepBy<Range<usize>> {
        self.detail.places(self.height)
    }

    /// Numbers of columns and of rows that are rendered.
    pub fn rendered_size(&self) -> [usize; 2] {
        [self.columns().len(), self.rows().len()]
    }

    /// Number of pixels that are rendered.
    pub fn count(&self) -> usize {
        self.rendered_size().iter().product()
    }

    /// The rendered pixels of an image of all pixels.
    pub fn those_rendered<P: Copy>(&self, image: &[P]) -> Vec<P> {
        self.rows()
            .flat_map(|row| {
                self.columns()
                    .map(move |column| image[row * self.width + column])
            })
            .collect()
    }
}

/// The values of `pixel` at every rendered pixel [column, row]; rows in parallel. A pixel depends only on
/// its position, and pixels are collected in order, so the image is the same for any number of threads.
/// `scratch` allocates memory that the pixels of a row share in turn.
///
/// This is compiled for every kernel, so it is the loop along a row and no more.
pub(super) fn rows<P: Send, S>(
    pixels: &Pixels<'_>,
    scratch: impl Fn() -> S + Sync,
    pixel: impl Fn([usize; 2], &mut S, &mut Counters) -> P + Sync,
) -> (Vec<P>, Counters) {
    in_parallel(pixels, &|row| {
        let mut work = Counters::default();
        let mut scratch = scratch();
        let mut values = Vec::with_capacity(pixels.columns().len());
        for column in pixels.columns() {
            values.push(pixel([column, row], &mut scratch, &mut work));
            pixels.progress.step();
        }
        (values, work)
    })
}

/// [`rows`] of pixels that are looked at once, without memory.
pub(super) fn each<P: Send>(
    pixels: &Pixels<'_>,
    pixel: impl Fn([usize; 2], &mut Counters) -> P + Sync,
) -> (Vec<P>, Counters) {
    rows(pixels, || (), |position, (), work| pixel(position, work))
}

/// All rows, evaluated in parallel and put together. The parallel loop is a good part of a kernel's
/// code and the same for all: behind `dyn`, at one call a row, it is compiled once for each type
/// of pixel.
fn in_parallel<P: Send>(
    pixels: &Pixels<'_>,
    evaluate: &(dyn Fn(usize) -> (Vec<P>, Counters) + Sync),
) -> (Vec<P>, Counters) {
    let rows: Vec<usize> = pixels.rows().collect();
    let rows: Vec<(Vec<P>, Counters)> = rows
        .into_par_iter()
        // Row by row: rows through the volume cost far more than rows beside it, and a thread
        // cannot help with a batch that another has begun.
        .with_max_len(1)
        .map(|row| {
            if (pixels.stopped)() {
                return (Vec::new(), Counters::default());
            }
            evaluate(row)
        })
        .collect();
    let mut all = Vec::with_capacity(pixels.count());
    let mut total = Counters::default();
    for (values, work) in rows {
        all.extend(values);
        total.add(&work);
    }
    (all, total)
}
