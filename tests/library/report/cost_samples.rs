//! What accuracy might cost, by formula: errors that fall as powers of steps, work that grows as
//! they do, and some that do not as they should.

use volref::cost::results::*;
use volref::math;

/// Numbers in [-1, 1) that look random, the same each time.
fn wobble(seed: usize) -> f64 {
    let mixed = (seed as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

pub fn times(median: f64, seed: usize) -> Times {
    let spread = 0.03 + 0.05 * (wobble(seed) + 1.0);
    Times {
        runs: 15,
        median,
        min: median * (1.0 - spread),
        max: median * (1.0 + 2.0 * spread),
        deviation: 0.3 * spread * median,
        outliers: usize::from(spread > 0.1),
        is_noisy: spread > 0.1,
    }
}

fn verdict(expected: Option<f64>, fitted: Option<f64>) -> OrderVerdict {
    match (expected, fitted) {
        (None, _) => OrderVerdict::NothingExpected,
        (_, None) => OrderVerdict::Undecided,
        (Some(expected), Some(fitted)) if (expected - fitted).abs() < 0.1 => {
            OrderVerdict::AsExpected
        }
        _ => OrderVerdict::Otherwise,
    }
}

/// The order of errors at values, as far as a sample needs it.
pub fn order(expected: Option<f64>, points: &[(f64, f64)], bound: f64) -> ConvergenceOrder {
    let local: Vec<Option<f64>> = points
        .windows(2)
        .map(|two| {
            let order = math::ln(two[1].1 / two[0].1) / math::ln(two[1].0 / two[0].0);
            order.is_finite().then_some(order)
        })
        .collect();
    let counts = |error: f64| error > 100.0 * bound && error < 0.1;
    let counting: Vec<_> = points.iter().filter(|point| counts(point.1)).collect();
    let fitted = match (counting.first(), counting.last()) {
        (Some(first), Some(last)) if counting.len() > 2 => {
            Some(math::ln(last.1 / first.1) / math::ln(last.0 / first.0))
        }
        _ => None,
    };
    ConvergenceOrder {
        expected,
        known: 100.0 * bound,
        counted: points.iter().map(|point| counts(point.1)).collect(),
        fitted,
        fitted_max: fitted.map(|order| order - 0.03),
        local,
        tolerance: 0.1,
        uncertainty: 0.0,
        verdict: verdict(expected, fitted),
    }
}

/// A sweep of halved steps from `first` on: errors `scale` h^`power`, plus rounding; lookups
/// `per_length` / h.
pub struct Marching {
    pub estimator: &'static str,
    pub parameter: Parameter,
    pub power: f64,
    pub expected: Option<f64>,
    pub scale: f64,
    pub lookups: f64,
    pub levels: i32,
    pub bound: f64,
    /// By how much errors scatter about the power, relative.
    pub scatter: f64,
}

impl Marching {
    pub fn sweep(&self) -> Sweep {
        let seed = self.estimator.len();
        let mut points = Vec::new();
        let levels: Vec<Level> = (0..self.levels)
            .map(|at| {
                let step = math::pow(2.0, f64::from(-at));
                let wobbled = 1.0 + self.scatter * wobble(seed + at as usize);
                let l2 =
                    (self.scale * math::pow(step, self.power) * wobbled).max(self.bound * 30.0);
                points.push((step, l2));
                let lookups = self.lookups / step + 1.0;
                let single = 3e-7 / step.sqrt();
                let norms = |l2: f64| Norms {
                    l1: 0.7 * l2,
                    l2,
                    max: 4.2 * l2,
                    uncertainty: 0.02,
                };
                Level {
                    setting: format!("{step} voxels"),
                    value: 0.02 * step,
                    work: MeanWork::from([(Event::DensityLookup, lookups)]),
                    error: norms(l2),
                    error_of_order: None,
                    single_precision: Some(norms(single)),
                    time: Some(times(
                        2e-8 + 7e-9 * lookups * (1.0 + 0.1 * wobble(seed)),
                        at as usize + seed,
                    )),
                }
            })
            .collect();
        Sweep {
            estimator: self.estimator.to_owned(),
            is_ours: self.estimator == "midpoint",
            parameter: self.parameter,
            levels,
            order: order(self.expected, &points, self.bound),
            cut: None,
        }
    }
}

/// Doubled numbers of samples: errors `deviation` / √N.
fn sampling(estimator: &str, deviation: f64, lookups: f64, power: f64, looks: bool) -> Sweep {
    let mut points = Vec::new();
    let seed = estimator.len();
    let levels: Vec<Level> = (0..8)
        .map(|at| {
            let samples = math::pow(4.0, f64::from(at));
            let l2 =
                deviation * math::pow(samples, power) * (1.0 + 0.04 * wobble(seed + at as usize));
            points.push((samples, l2));
            Level {
                setting: format!("{samples} {}", if at == 0 { "sample" } else { "samples" }),
                value: samples,
                work: MeanWork::from([
                    (
                        Event::DensityLookup,
                        if looks { samples * lookups } else { 0.0 },
                    ),
                    (Event::RandomDraw, samples * lookups * 2.0),
                ]),
                error: Norms {
                    l1: 0.8 * l2,
                    l2,
                    max: 4.0 * l2,
                    uncertainty: 0.03,
                },
                error_of_order: None,
                single_precision: None,
                time: Some(times(
                    1e-8 + 3e-8 * samples * lookups,
                    seed + 3 * at as usize,
                )),
            }
        })
        .collect();
    Sweep {
        estimator: estimator.to_owned(),
        is_ours: false,
        parameter: Parameter::Samples,
        levels,
        order: order(Some(-0.5), &points, 1e-14),
        cut: (estimator == "ratio tracking")
            .then(|| "65536 samples would take 3 minutes".to_owned()),
    }
}

/// The cheapest levels for errors 1e-2, 1e-3, 1e-4 and 1e-6.
fn prices(sweeps: &[Sweep]) -> Vec<Price> {
    let price = |error: f64| {
        let mut offers: Vec<Offer> = sweeps
            .iter()
            .map(|sweep| {
                let level = sweep.levels.iter().find(|level| level.error.l2 <= error);
                Offer {
                    estimator: sweep.estimator.clone(),
                    parameter: sweep.parameter,
                    setting: level.map(|level| level.setting.clone()),
                    lookups: level.map(|level| level.work.price()),
                    seconds: level.and_then(|level| Some(level.time?.median)),
                    times_cheapest: None,
                }
            })
            .collect();
        let key = |offer: &Offer| offer.lookups.unwrap_or(f64::INFINITY);
        offers.sort_by(|a, b| key(a).total_cmp(&key(b)));
        let cheapest = key(&offers[0]);
        for offer in &mut offers {
            offer.times_cheapest = offer.lookups.map(|lookups| lookups / cheapest);
        }
        Price { error, offers }
    };
    [1e-2, 1e-3, 1e-4, 1e-6].map(price).into()
}

fn transmittance() -> Study {
    let bound = 1e-14;
    let marching = |estimator, power, expected, scale, lookups| Marching {
        estimator,
        parameter: Parameter::Step,
        power,
        expected,
        scale,
        lookups,
        levels: 8,
        bound,
        scatter: 0.06,
    };
    let mut sweeps = vec![
        marching("left Riemann", 1.0, Some(1.0), 0.3, 40.0).sweep(),
        marching("midpoint", 2.0, Some(2.0), 0.04, 40.0).sweep(),
        marching("trapezoid", 2.0, Some(2.0), 0.08, 40.0).sweep(),
        marching("Simpson", 4.0, Some(4.0), 0.02, 80.0).sweep(),
        marching("midpoint, linear opacity", 1.3, Some(1.0), 0.5, 40.0).sweep(),
    ];
    let exact = |estimator: &str, error: f64, lookups: f64| Sweep {
        estimator: estimator.to_owned(),
        is_ours: false,
        parameter: Parameter::None,
        levels: vec![Level {
            setting: "2 points a cell".to_owned(),
            value: 0.0,
            work: MeanWork::from([(Event::DensityLookup, lookups)]),
            error: Norms {
                l1: error,
                l2: error,
                max: 3.0 * error,
                uncertainty: 0.0,
            },
            error_of_order: None,
            single_precision: None,
            time: Some(times(4e-6, 3)),
        }],
        order: order(None, &[], bound),
        cut: None,
    };
    sweeps.push(exact("Gauss-2 per cell", 7e-16, 192.0));
    sweeps.push(sampling("delta tracking", 0.9, 2.2, -0.5, true));
    sweeps.push(sampling("ratio tracking", 0.05, 9.6, -0.5, true));
    sweeps[4].order.verdict = OrderVerdict::NotYetAPower;
    Study {
        name: "transmittance",
        quantity: "Transmittance of the smoke along 4096 oblique rays.".to_owned(),
        reference: Reference {
            method: "two-point Gauss quadrature between the faces of cells".to_owned(),
            bound,
        },
        prices: prices(&sweeps),
        judged_on: None,
        sweeps,
        pictures: Vec::new(),
        worst_ray: None,
    }
}

/// Signed errors like those of too few steps around a cloud.
fn picture(setting: &str, size: [usize; 2], strength: f64) -> ErrorPicture {
    let [columns, rows] = size;
    let errors = (0..columns * rows).map(|at| {
        let x = 2.0 * (at % columns) as f64 / columns as f64 - 1.0;
        let y = 2.0 * (at / columns) as f64 / rows as f64 - 1.0;
        let r2 = x * x + y * y;
        strength * math::exp(-4.0 * r2) * math::sin(14.0 * r2 + 3.0 * x)
            + 0.02 * strength * wobble(at)
    });
    ErrorPicture {
        setting: setting.to_owned(),
        size,
        errors: errors.collect(),
    }
}

fn image() -> Study {
    let bound = 3e-7;
    let marching = |estimator, parameter, power, expected, scale, lookups, levels| Marching {
        estimator,
        parameter,
        power,
        expected,
        scale,
        lookups,
        levels,
        bound,
        scatter: 0.06,
    };
    let sweeps = vec![
        marching("midpoint", Parameter::Step, 2.0, Some(2.0), 0.09, 60.0, 8).sweep(),
        marching(
            "midpoint",
            Parameter::ShadowStep,
            2.0,
            Some(2.0),
            0.02,
            300.0,
            6,
        )
        .sweep(),
        marching(
            "trilinear",
            Parameter::Spacing,
            2.0,
            Some(2.0),
            0.2,
            90.0,
            6,
        )
        .sweep(),
        marching("nearest", Parameter::Spacing, 1.0, Some(1.0), 0.4, 90.0, 6).sweep(),
        marching(
            "centre sample",
            Parameter::Pixel,
            0.5,
            Some(2.0),
            0.1,
            64.0,
            6,
        )
        .sweep(),
        sampling("path tracer", 1.4, 70.0, -0.5, true),
    ];
    let extinction = |at: usize| {
        let t = at as f64 / 200.0 * 3.0;
        let d = t - 1.6;
        [
            t,
            2.0 * math::exp(-2.5 * d * d) * (1.0 + 0.3 * math::sin(9.0 * t)),
        ]
    };
    Study {
        name: "image",
        quantity: "Radiance of the whole image, all channels.".to_owned(),
        reference: Reference {
            method: "our ray caster at 1/512 voxel, extrapolated".to_owned(),
            bound,
        },
        prices: prices(&sweeps),
        judged_on: None,
        sweeps,
        pictures: vec![
            picture("1 voxel", [48, 32], 0.1),
            picture("0.5 voxels", [48, 32], 0.026),
            picture("0.25 voxels", [48, 32], 6.4e-3),
        ],
        worst_ray: Some(RayTrace {
            ray: "pixel 17, 23".to_owned(),
            setting: "1 voxel".to_owned(),
            extinction: (0..=200).map(extinction).collect(),
            samples: (0..16).map(|at| extinction(6 + 12 * at)).collect(),
            value: 0.417_231,
            reference: 0.420_118,
        }),
    }
}

fn estimators() -> EstimatorTable {
    let depth = 1.342_816_221_7;
    let t = math::exp(-depth);
    let row = |estimator: &str, variance: f64, lookups: f64, off: f64, agrees: bool| {
        let standard_error = (variance / 1e6).sqrt();
        EstimatorRow {
            estimator: estimator.to_owned(),
            mean: t + off * standard_error,
            bias: off * standard_error,
            standard_error,
            variance: variance * 1.002,
            variance_error: variance * 1.4e-3,
            predicted_variance: Some(variance),
            lookups: lookups * 1.0003,
            predicted_lookups: Some(lookups),
            variance_times_lookups: variance * lookups,
            variance_times_seconds: Some(variance * lookups * 2.1e-8),
            agrees,
        }
    };
    EstimatorTable {
        ray: "from the camera through pixel 17, 23".to_owned(),
        depth,
        transmittance: t,
        samples: 1_000_000,
        rows: vec![
            row("delta tracking", t * (1.0 - t), 2.2246, 0.3, true),
            row("ratio tracking", 9.72e-4, 9.598, -1.2, true),
            row("residual ratio tracking", 1.26e-4, 6.81, 0.8, true),
            row("delta tracking, majorant too low", 0.11, 1.91, 412.7, false),
            EstimatorRow {
                predicted_variance: None,
                predicted_lookups: None,
                ..row("unbiased ray marching", 2.2e-5, 42.2, 1.9, true)
            },
        ],
    }
}

fn thickness() -> ThicknessSweep {
    let curve = |estimator: &str, of: &dyn Fn(f64) -> f64, known: bool| ThicknessCurve {
        estimator: estimator.to_owned(),
        points: (0..9)
            .map(|at| {
                let depth = math::pow(10.0, -2.0 + 0.5 * f64::from(at));
                let theory = of(depth);
                ThicknessPoint {
                    depth,
                    measured: (depth < 50.0 || !known)
                        .then_some(theory * (1.0 + 0.1 * wobble(at as usize))),
                    predicted: known.then_some(theory),
                }
            })
            .collect(),
    };
    ThicknessSweep {
        ray: "from the camera through pixel 17, 23".to_owned(),
        curves: vec![
            curve(
                "delta tracking",
                &|d| math::exp_m1(d) * (1.0 - math::exp(-d)) * 1.6,
                true,
            ),
            curve("ratio tracking", &|d| math::exp_m1(0.6 * d) * 1.7 * d, true),
            curve(
                "residual ratio",
                &|d| math::exp_m1(0.15 * d) * 1.2 * d,
                true,
            ),
            curve("unbiased marching", &|d| 0.01 * d * d * 40.0, false),
        ],
    }
}

fn jitter() -> JitterSplit {
    let curve = |jitter: &str, deviation_order: f64, noise: f64| {
        let points: Vec<JitterPoint> = (0..7)
            .map(|at| {
                let step = 0.2 * math::pow(2.0, f64::from(-at));
                let deviation = 0.8 * math::pow(step, deviation_order);
                let bias = 0.5 * deviation * deviation * (1.0 + noise * wobble(at as usize));
                JitterPoint {
                    step,
                    bias,
                    deviation,
                    depth_deviation: deviation,
                    predicted_bias: 0.5 * deviation * deviation,
                }
            })
            .collect();
        let of = |value: fn(&JitterPoint) -> f64| -> Vec<(f64, f64)> {
            points
                .iter()
                .map(|point| (point.step, value(point)))
                .collect()
        };
        let deviations = of(|point| point.depth_deviation);
        let biases = of(|point| point.bias);
        JitterCurve {
            jitter: jitter.to_owned(),
            deviation_order: order(Some(deviation_order), &deviations, 0.0),
            bias_order: order(Some(2.0 * deviation_order), &biases, 0.0),
            points,
        }
    };
    JitterSplit {
        ray: "from the camera through pixel 17, 23".to_owned(),
        curves: vec![curve("comb", 1.0, 0.05), curve("stratified", 1.5, 0.1)],
    }
}

fn effects() -> Vec<EffectPrice> {
    [
        ("absorption", 60.0, 0.0, 0.0),
        ("emission", 60.0, 0.0, 0.0),
        ("gradient shading", 60.0, 0.0, 0.0),
        ("single scattering", 60.0, 60.0, 60.0),
        ("multiple scattering", 312.0, 12.0, 12.0),
    ]
    .into_iter()
    .enumerate()
    .map(|(at, (effect, lookups, shadow_rays, phases))| {
        let all = lookups + 40.0 * shadow_rays;
        EffectPrice {
            effect: effect.to_owned(),
            work: MeanWork::from([
                (Event::DensityLookup, all),
                (Event::GradientLookup, if at == 2 { 60.0 } else { 0.0 }),
                (Event::CellWalked, 31.0),
                (Event::ShadowRay, shadow_rays),
                (Event::PhaseEvaluation, phases),
                (Event::NullCollision, if at == 4 { 140.0 } else { 0.0 }),
                (Event::RandomDraw, if at == 4 { 700.0 } else { 0.0 }),
            ]),
            time: Some(times(1.1e-8 * all, at)),
            times_lookups: Some(all / 60.0),
        }
    })
    .collect()
}

/// Two scenes, one with everything.
pub fn costs() -> Vec<Cost> {
    let full = Cost {
        scene: "smoke/plume".to_owned(),
        panel: None,
        studies: vec![image(), transmittance()],
        estimators: Some(estimators()),
        thickness: Some(thickness()),
        jitter: Some(jitter()),
        effects: effects(),
        recommendations: vec![
            Recommendation {
                error: 1e-2,
                text: "midpoint at 0.5 voxels: 121 lookups a ray, 0.9 µs".to_owned(),
                command: Some("volref render fixtures/scenes/plume.toml --step 0.01 -o plume.exr".to_owned()),
            },
            Recommendation {
                error: 1e-4,
                text: "midpoint at 0.0625 voxels: 961 lookups a ray, 6.8 µs".to_owned(),
                command: Some("volref render fixtures/scenes/plume.toml --step 0.00125 -o plume.exr".to_owned()),
            },
        ],
        notes: vec![
            "silhouettes are masked: 212 of 4096 pixels, whose largest error does not fall with the pixel".to_owned(),
        ],
    };
    vec![full, small()]
}

/// One study of two sweeps, and nothing else: errors h², lookups 1/h.
pub fn small() -> Cost {
    let marching = |estimator, power, levels| Marching {
        estimator,
        parameter: Parameter::Step,
        power,
        expected: Some(power),
        scale: 0.0625,
        lookups: 8.0,
        levels,
        bound: 1e-12,
        scatter: 0.0,
    };
    let mut sweeps = vec![
        marching("midpoint", 2.0, 4).sweep(),
        marching("left", 1.0, 4).sweep(),
    ];
    for level in sweeps.iter_mut().flat_map(|sweep| &mut sweep.levels) {
        let lookups = level.work[Event::DensityLookup];
        level.single_precision = None;
        level.time = Some(Times {
            runs: 10,
            median: lookups / 64e6,
            min: lookups / 80e6,
            max: lookups / 50e6,
            deviation: lookups / 640e6,
            outliers: 1,
            is_noisy: lookups < 10.0,
        });
    }
    sweeps[0].levels[3].single_precision = Some(Norms {
        l1: 0.001,
        l2: 0.002,
        max: 0.004,
        uncertainty: 0.0,
    });
    sweeps[1].levels[3].error.l2 = 0.03;
    sweeps[1].order.local[2] = Some(-0.94);
    sweeps[1].order.fitted = Some(0.41);
    sweeps[1].order.verdict = OrderVerdict::Otherwise;
    Cost {
        scene: "fog".to_owned(),
        panel: Some("left half".to_owned()),
        studies: vec![Study {
            name: "transmittance",
            quantity: "Transmittance of one ray.".to_owned(),
            reference: Reference {
                method: "closed form".to_owned(),
                bound: 1e-12,
            },
            prices: prices(&sweeps).into_iter().take(2).collect(),
            judged_on: None,
            sweeps,
            pictures: Vec::new(),
            worst_ray: None,
        }],
        estimators: None,
        thickness: None,
        jitter: None,
        effects: Vec::new(),
        recommendations: Vec::new(),
        notes: Vec::new(),
    }
}

pub fn machine() -> Machine {
    Machine {
        processor: "AMD EPYC 9R14".to_owned(),
        threads: 1,
        platform: "linux x86_64".to_owned(),
        compiler: "rustc 1.89.0".to_owned(),
        profile: "release",
        target_features: "fxsr, sse, sse2".to_owned(),
    }
}

/// Values at the edge of what may come: errors that are zero or no number, work that was not
/// counted, sweeps of one setting or of none.
pub fn extremes() -> Cost {
    let level = |l2: f64, work: MeanWork| Level {
        setting: "only one".to_owned(),
        value: 1.0,
        work,
        error: Norms {
            l1: l2,
            l2,
            max: l2,
            uncertainty: f64::NAN,
        },
        error_of_order: None,
        single_precision: None,
        time: None,
    };
    let looked = |lookups: f64| MeanWork::from([(Event::DensityLookup, lookups)]);
    let drawn = |draws: f64| MeanWork::from([(Event::RandomDraw, draws)]);
    let sweep =
        |estimator: &str, parameter: Parameter, levels: Vec<Level>, verdict: OrderVerdict| Sweep {
            estimator: estimator.to_owned(),
            is_ours: false,
            parameter,
            levels,
            order: ConvergenceOrder {
                verdict,
                ..order(None, &[], 0.0)
            },
            cut: None,
        };
    let sweeps = vec![
        sweep(
            "path tracer",
            Parameter::Samples,
            vec![
                level(f64::NAN, looked(3.0)),
                level(f64::INFINITY, looked(4.0)),
                level(0.0, looked(5.0)),
            ],
            OrderVerdict::Undecided,
        ),
        sweep(
            "closed form",
            Parameter::None,
            vec![level(1e-16, looked(0.0))],
            OrderVerdict::NothingExpected,
        ),
        sweep(
            "blind guess",
            Parameter::Samples,
            vec![level(2.0, drawn(1.0))],
            OrderVerdict::NothingExpected,
        ),
        sweep(
            "no setting at all",
            Parameter::Pixel,
            Vec::new(),
            OrderVerdict::NotYetAPower,
        ),
    ];
    Cost {
        scene: "nowhere".to_owned(),
        panel: None,
        studies: vec![
            Study {
                name: "image",
                quantity: "Radiance.".to_owned(),
                reference: Reference {
                    method: "closed form".to_owned(),
                    bound: 0.0,
                },
                prices: prices(&sweeps),
                judged_on: None,
                sweeps,
                pictures: vec![picture("nothing", [0, 0], 0.0)],
                worst_ray: Some(RayTrace {
                    ray: "empty".to_owned(),
                    setting: "none".to_owned(),
                    extinction: vec![[0.0, 0.0], [1.0, 0.0]],
                    samples: Vec::new(),
                    value: 0.0,
                    reference: 0.0,
                }),
            },
            Study {
                name: "nothing",
                quantity: "Nothing was tried.".to_owned(),
                reference: Reference {
                    method: "none".to_owned(),
                    bound: 0.0,
                },
                judged_on: None,
                sweeps: Vec::new(),
                prices: Vec::new(),
                pictures: Vec::new(),
                worst_ray: None,
            },
        ],
        estimators: Some(EstimatorTable {
            rows: Vec::new(),
            ..estimators()
        }),
        thickness: Some(ThicknessSweep {
            ray: "empty".to_owned(),
            curves: vec![ThicknessCurve {
                estimator: "no noise".to_owned(),
                points: vec![ThicknessPoint {
                    depth: 1.0,
                    measured: Some(0.0),
                    predicted: Some(0.0),
                }],
            }],
        }),
        jitter: Some(JitterSplit {
            ray: "empty".to_owned(),
            curves: Vec::new(),
        }),
        effects: Vec::new(),
        recommendations: Vec::new(),
        notes: Vec::new(),
    }
}
