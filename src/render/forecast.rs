//! Forecast of the rendering time of an image, from a few of its pixels.

use super::progress::Forecast;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Pixels that are measured, at most. For ray costs with a standard deviation equal to their mean,
/// the mean of 256 is known to 1/√256 = 6 %.
const MOST_PROBES: usize = 256;

/// At most this fraction of the rays of an image is cast twice, 1/16.
const SHARE: u64 = 16;

/// Forecast for a panel of `pixels` with `samples` each, `probes` rays of which took `seconds` on
/// one thread.
fn extrapolated(
    pixels: u64,
    samples: u32,
    threads: usize,
    (seconds, probes): (f64, usize),
) -> Forecast {
    let rays = pixels as f64 * f64::from(samples);
    Forecast {
        seconds: seconds / probes.max(1) as f64 * rays / threads.max(1) as f64,
        threads,
        pixels,
        samples,
    }
}

/// The forecast for an image of `size`, from the times that `probe` takes for one ray through each
/// of some pixels, measured for `most` and to the end of the current ray. `None` for an image of a
/// few rays.
pub(super) fn forecast(
    size: [usize; 2],
    samples: u32,
    most: Duration,
    probe: &(dyn Fn([usize; 2]) + Sync),
) -> Option<Forecast> {
    let pixels = size.iter().product::<usize>() as u64;
    let rays = pixels.saturating_mul(samples.into());
    let probes = usize::try_from(rays / SHARE).map_or(MOST_PROBES, |share| share.min(MOST_PROBES));
    if probes == 0 {
        return None;
    }
    let (start, next) = (Instant::now(), AtomicUsize::new(0));
    let measured = rayon::broadcast(|_| {
        let (mut seconds, mut done) = (0.0, 0);
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= probes || start.elapsed() >= most && index > 0 {
                return (seconds, done);
            }
            let begun = Instant::now();
            probe(place(index, size));
            seconds += begun.elapsed().as_secs_f64();
            done += 1;
        }
    });
    let threads = measured.len();
    let sum = |(a, b): (f64, usize), (c, d): (f64, usize)| (a + c, b + d);
    let measured = measured.into_iter().fold((0.0, 0), sum);
    Some(extrapolated(pixels, samples, threads, measured))
}

/// Pixel number `index` to be measured: any number of the first are spread evenly over the image.
///
/// Source: the R2 sequence of Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences",
/// 2018: multiples of the powers of 1/ρ, ρ³ = ρ + 1.
fn place(index: usize, size: [usize; 2]) -> [usize; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    std::array::from_fn(|axis| {
        let share = (0.5 + STEPS[axis] * index as f64).fract();
        ((share * size[axis] as f64) as usize).min(size[axis] - 1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn seconds_are_those_of_a_ray_times_rays_over_threads() {
        // 10⁹ samples of 256² pixels, 2 µs each, on two threads.
        let forecast = extrapolated(1 << 16, 1_000_000_000, 2, (512e-6, 256));
        assert!((forecast.seconds - 65_536.0e3).abs() < 1.0, "{forecast:?}");
        assert_eq!(
            (forecast.pixels, forecast.samples),
            (1 << 16, 1_000_000_000)
        );
    }

    #[test]
    fn probes_are_spread_over_the_image_and_few() {
        let seen = Mutex::new(Vec::new());
        let probe = |pixel: [usize; 2]| seen.lock().unwrap().push(pixel);
        let most = Duration::from_secs(600);
        let forecast = forecast([64, 48], 4, most, &probe).unwrap();
        assert_eq!((forecast.pixels, forecast.samples), (64 * 48, 4));
        let seen = seen.into_inner().unwrap();
        assert_eq!(seen.len(), MOST_PROBES);
        // In each of 4 × 4 parts there are 16 on average.
        for part in 0..16 {
            let inside = |[x, y]: &&[usize; 2]| x / 16 == part % 4 && y / 12 == part / 4;
            let count = seen.iter().filter(inside).count();
            assert!((10..=22).contains(&count), "{part}: {count}");
        }
    }

    #[test]
    fn an_image_of_a_few_rays_is_not_measured_and_the_limit_is_kept() {
        let never = |_: [usize; 2]| panic!("a probe");
        assert_eq!(forecast([3, 5], 1, Duration::MAX, &never), None);
        // Without time, one ray.
        let count = AtomicUsize::new(0);
        let probe = |_: [usize; 2]| {
            count.fetch_add(1, Ordering::Relaxed);
        };
        assert!(forecast([300, 500], 1, Duration::ZERO, &probe).is_some());
        assert_eq!(count.into_inner(), 1);
    }
}
