//! Counts the instructions of kernels, under callgrind. `instructions.sh` runs this.
//!
//! The program does two things. Started without arguments it renders everything once, checks that
//! what must have the same bits has them, and prints the tables. For the counts it starts itself
//! again under valgrind, with the argument `--tasks`: then it runs the same tasks in the same
//! order, and callgrind writes down what each of them took. To look into one of them, say the second:
//!
//! ```sh
//! valgrind --tool=callgrind --toggle-collect=instructions::counted \
//!     target/release/instructions --tasks 2
//! callgrind_annotate callgrind.out.*
//! ```

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::{env, fs};

use volref::cost::effects::variants;
use volref::cost::thumbnail;
use volref::film::Film;
use volref::render::plan::Effect;
use volref::render::{Counters, Event, Plan, Sampling, render};
use volref::scene::{Model, Panel, Scene};

type Failure = Box<dyn std::error::Error>;

/// Scenes whose plans elide effects: name and panel.
const ELIDING: [(&str, usize); 8] = [
    ("fog/isotropic", 0),
    ("fog/absorption", 0),
    ("smoke/cornell", 0),
    ("procedural/absorbing-grid", 0),
    ("procedural/coloured", 0),
    ("hard/a6-null-effects", 0),
    ("hard/a6-null-shading", 0),
    ("hard/d1-constant-grid", 0),
];
/// Scenes whose effects are counted one by one: name and panel.
const PRICED: [(&str, usize); 4] = [
    ("figures/figure-5", 1),
    ("fog/isotropic", 0),
    ("smoke/cornell", 0),
    ("procedural/coloured", 0),
];
/// Larger side of an image, and samples per pixel where it is sampled.
const SIDE: usize = 32;
const SAMPLES: u32 = 4;

// ---- What is counted ---------------------------------------------------------------------

/// Work to be counted.
type Task<'t> = Box<dyn Fn() + 't>;

/// Callgrind counts what happens in here, and writes the count down at the end of each call.
#[inline(never)]
fn counted(task: &dyn Fn()) {
    task();
    // The call above must not be the last thing done here, or it would be a jump out of here.
    std::hint::black_box(());
}

/// A number of the list of tasks.
type Index = usize;

/// The instructions of each task, by callgrind.
fn instructions(tasks: usize) -> Result<Vec<u64>, Failure> {
    let folder = env::temp_dir().join(format!("volref-instructions-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let out = folder.join("out");
    let status = Command::new("valgrind")
        .args(["--quiet", "--tool=callgrind"])
        .arg("--toggle-collect=instructions::counted")
        .arg("--dump-after=instructions::counted")
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(env::current_exe()?)
        .arg("--tasks")
        .stdout(Stdio::null())
        .status()?;
    if !status.success() {
        return Err(format!("valgrind: {status}").into());
    }
    let counts = (1..=tasks).map(|number| total(&folder.join(format!("out.{number}"))));
    let counts = counts.collect::<Result<Vec<_>, Failure>>()?;
    fs::remove_dir_all(&folder)?;
    Ok(counts)
}

/// The instructions in a file of callgrind.
fn total(path: &Path) -> Result<u64, Failure> {
    let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut totals = text.lines().filter_map(|line| line.strip_prefix("totals:"));
    let total = totals.next().ok_or("callgrind wrote no total")?;
    Ok(total.trim().parse()?)
}

/// A scene of one panel, and effects that are simulated although the plan elides them.
struct Picture {
    scene: Scene,
    forced: Vec<Effect>,
}

impl Picture {
    fn panel(&self) -> &Panel {
        &self.scene.panels[0]
    }

    fn plan(&self) -> Plan<'_> {
        let plan = Plan::forcing(self.panel(), &self.forced);
        plan.expect("null effects can be forced")
    }

    fn pixels(&self) -> usize {
        self.panel().width * self.panel().height
    }

    fn film(&self) -> Film {
        // What is refused is refused natively first, before anything is counted.
        let made = render(&[self.plan()], Sampling::default(), &|| ());
        made.expect("a scene of the suite renders").film
    }

    fn counters(&self) -> Result<Counters, Failure> {
        Ok(render(&[self.plan()], Sampling::default(), &|| ())?.work[0])
    }

    /// One pixel of it: what is done once for an image, and hardly anything else.
    fn pixel(&self) -> Picture {
        let mut scene = self.scene.clone();
        (scene.panels[0].width, scene.panels[0].height) = (1, 1);
        Picture {
            scene,
            forced: self.forced.clone(),
        }
    }
}

/// The picture of a small image of `panel` by its own plan.
fn picture(panel: &Panel, side: usize, samples: u32) -> Picture {
    let small = thumbnail(panel, panel.model.clone(), side);
    picture_of(Scene::of(small), samples)
}

/// The picture of `scene` by its own plan.
fn picture_of(mut scene: Scene, samples: u32) -> Picture {
    if let Model::Radiative(radiative) = &mut scene.panels[0].model {
        radiative.samples = samples;
    }
    Picture {
        scene,
        forced: vec![],
    }
}

/// All tasks, in order.
#[derive(Default)]
struct Tasks<'t>(Vec<Task<'t>>);

impl<'t> Tasks<'t> {
    fn add(&mut self, task: impl Fn() + 't) -> Index {
        self.0.push(Box::new(task));
        self.0.len() - 1
    }

    /// An image of many pixels, and one of a single pixel.
    fn add_picture(&mut self, picture: &'t Picture) -> Each {
        let image = self.add(|| drop(picture.film()));
        let single = picture.pixel();
        let pixel = self.add(move || drop(single.film()));
        Each {
            image,
            pixel,
            pixels: picture.pixels(),
        }
    }
}

/// Instructions for each pixel: those of an image less those of one pixel, so that what is done
/// once for an image, such as gradients of a grid, is not laid upon few pixels.
struct Each {
    image: Index,
    pixel: Index,
    pixels: usize,
}

impl Each {
    fn of(&self, counts: &[u64]) -> f64 {
        (counts[self.image] - counts[self.pixel]) as f64 / (self.pixels - 1) as f64
    }
}

// ---- Effects that are elided, and what that saves ----------------------------------------------

/// A scene by its own plan, and with all elided effects forced.
struct Elision {
    name: &'static str,
    own: Picture,
    forced: Picture,
}

fn elision(name: &'static str, panel: &Panel) -> Elision {
    let own = picture(panel, SIDE, SAMPLES);
    let scene = own.scene.clone();
    let forced = Plan::null_effects(own.panel());
    Elision {
        name,
        own,
        forced: Picture { scene, forced },
    }
}

/// A scene with more and more of its effects.
struct Prices {
    name: &'static str,
    variants: Vec<(String, Picture)>,
}

fn prices(name: &'static str, panel: &Panel) -> Prices {
    let variants = variants(panel).into_iter();
    let variants = variants.map(|(name, scene)| (name, picture_of(scene, SAMPLES)));
    Prices {
        name,
        variants: variants.collect(),
    }
}

// ---- Tables --------------------------------------------------------------------------------

/// Three digits, in groups: 12 300, 4.56.
fn three_digits(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    // By way of text, so that 9.996 is 10.0 and not 10.00.
    let number: f64 = format!("{number:.2e}").parse().expect("a number");
    let decimals = 2 - volref::math::log10(number.abs()).floor() as i32;
    let digits = format!("{number:.*}", decimals.max(0) as usize);
    if decimals >= 0 {
        return digits;
    }
    let mut grouped = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    grouped
}

fn row(cells: &[String]) {
    println!("| {} |", cells.join(" | "));
}

fn head(title: &str, columns: &[&str]) {
    println!("\n{title}\n");
    row(&columns.iter().map(|&c| c.to_owned()).collect::<Vec<_>>());
    row(&vec!["---".to_owned(); columns.len()]);
}

// ---- The program -----------------------------------------------------------------------------

fn load(name: &str) -> Result<Scene, Failure> {
    let path = PathBuf::from(format!("fixtures/scenes/{name}.toml"));
    Ok(Scene::load(&path)?)
}

/// What `make` makes of each scene: of its name and its panel.
fn of_scenes<T>(
    scenes: &[(&'static str, usize)],
    make: fn(&'static str, &Panel) -> T,
) -> Result<Vec<T>, Failure> {
    let scenes = scenes.iter();
    scenes
        .map(|&(name, panel)| Ok(make(name, &load(name)?.panels[panel])))
        .collect()
}

fn main() -> ExitCode {
    // On the thread that callgrind watches, and on no other.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    if let Err(error) = pool.use_current_thread().build_global() {
        eprintln!("{error}");
        return ExitCode::FAILURE;
    }
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Failure> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let elisions = of_scenes(&ELIDING, elision)?;
    let prices = of_scenes(&PRICED, prices)?;

    let mut tasks = Tasks::default();
    let elision_tasks: Vec<[Each; 2]> = elisions
        .iter()
        .map(|it| [&it.own, &it.forced].map(|picture| tasks.add_picture(picture)))
        .collect();
    let price_tasks: Vec<Vec<Each>> = prices
        .iter()
        .map(|it| {
            it.variants
                .iter()
                .map(|(_, picture)| tasks.add_picture(picture))
                .collect()
        })
        .collect();
    if arguments.first().is_some_and(|first| first == "--tasks") {
        let wanted =
            |number: usize| arguments.len() == 1 || arguments[1..].contains(&number.to_string());
        let tasks = tasks.0.iter().enumerate();
        let tasks = tasks.filter(|(index, _)| wanted(index + 1));
        tasks.for_each(|(_, task)| counted(&**task));
        return Ok(());
    }

    for elision in &elisions {
        if elision.forced.film().pixel_hash() != elision.own.film().pixel_hash() {
            return Err(format!("{}: other bits with all effects", elision.name).into());
        }
    }
    let counts = instructions(tasks.0.len())?;

    head(
        "**Effects that were not simulated**, and what that saved; instructions per pixel",
        &[
            "scene",
            "simulated by",
            "elided",
            "not requested",
            "instructions",
            "with the elided effects",
            "saved",
        ],
    );
    for (elision, [own, forced]) in elisions.iter().zip(&elision_tasks) {
        let [own, forced] = [own, forced].map(|each| each.of(&counts));
        let elided = elision.forced.forced.iter().map(|effect| effect.name());
        row(&[
            elision.name.to_owned(),
            elision.own.plan().kernel.to_string(),
            elided.collect::<Vec<_>>().join(", "),
            elision.own.plan().omitted().join(", "),
            three_digits(own),
            three_digits(forced),
            format!("{:.1} %", 100.0 * (1.0 - own / forced)),
        ]);
    }

    head(
        "**What each effect costs**, per pixel",
        &[
            "scene",
            "effects",
            "lookups",
            "random numbers",
            "instructions",
            "relative to the first",
        ],
    );
    for (scene, each) in prices.iter().zip(&price_tasks) {
        let mut first = None;
        for ((name, picture), each) in scene.variants.iter().zip(each) {
            let counters = picture.counters()?;
            let lookups = counters[Event::DensityLookup] + counters[Event::GradientLookup];
            let per_pixel = |count: u64| three_digits(count as f64 / picture.pixels() as f64);
            let each = each.of(&counts);
            row(&[
                match first {
                    None => scene.name.to_owned(),
                    Some(_) => String::new(),
                },
                name.clone(),
                per_pixel(lookups),
                per_pixel(counters[Event::RandomDraw]),
                three_digits(each),
                three_digits(each / *first.get_or_insert(each)),
            ]);
        }
    }
    Ok(())
}
