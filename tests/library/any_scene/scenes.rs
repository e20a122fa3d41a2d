//! Scenes as a user could write them, with any legal number at any key.
//!
//! Every key of the format is here, and each may hold its limits, zeros of both signs, the
//! smallest and the largest numbers. Kept small is only what a scene must be small in to be
//! rendered at all within a test: how many things it holds, and the grids and meshes beside it.

use super::choices::{Choices, FINITE, Legal, NOT_NEGATIVE, POSITIVE, SHARE};

/// A scene file, and the files it names.
pub struct Written {
    /// The scene, TOML.
    pub text: String,
    /// Names and contents of files beside it.
    pub files: Vec<(&'static str, Vec<u8>)>,
}

/// As whoever is to mend it wants to see it.
impl std::fmt::Debug for Written {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "\n{}", self.text)?;
        for (name, bytes) in &self.files {
            writeln!(f, "{name}: {:?}", String::from_utf8_lossy(bytes))?;
        }
        Ok(())
    }
}

/// The scene that the decisions of `list` make.
pub fn written(list: &[u32]) -> Written {
    let mut choices = Choices::new(list);
    let mut scene = Written {
        text: String::new(),
        files: Vec::new(),
    };
    scene.film(&mut choices);
    match choices.below(8) {
        0..=2 => scene.classified(&mut choices),
        3 => scene.curve(&mut choices),
        _ => scene.radiative(&mut choices),
    }
    scene
}

/// The keys of a table, one by one.
#[derive(Default)]
struct Keys(Vec<String>);

impl Keys {
    fn give(&mut self, key: &str, value: impl std::fmt::Display) {
        self.0.push(format!("{key} = {value}"));
    }

    /// The keys as a table in one line.
    fn inline(&self) -> String {
        format!("{{ {} }}", self.0.join(", "))
    }
}

/// A word in quotes.
fn quoted(word: &str) -> String {
    format!("{word:?}")
}

impl Written {
    fn table(&mut self, heading: &str, keys: &Keys) {
        self.text.push_str(&format!("[{heading}]\n"));
        for key in &keys.0 {
            self.text.push_str(key);
            self.text.push('\n');
        }
    }

    fn add_file(&mut self, name: &'static str, bytes: Vec<u8>) {
        // A second of that name would be another file.
        if self.files.iter().all(|(other, _)| *other != name) {
            self.files.push((name, bytes));
        }
    }

    fn film(&mut self, choices: &mut Choices<'_>) {
        let mut keys = Keys::default();
        for key in ["width", "height"] {
            keys.give(key, choices.count(8, 8, 16384));
        }
        self.table("film", &keys);
    }

    fn camera(&mut self, choices: &mut Choices<'_>, required: bool) {
        if !required && !choices.one_in(2) {
            return;
        }
        let mut keys = Keys::default();
        if required || choices.one_in(2) {
            // Before most of what there is, in the middle of it, or behind.
            let eye =
                [[-1.0, 1.0], [0.0, 2.0], [-4.0, 4.0]].map(|usual| choices.length(FINITE, usual));
            keys.give("eye", format!("{eye:?}"));
        }
        if required || choices.one_in(2) {
            keys.give("target", choices.place([-1.0, 1.0]));
        }
        if choices.one_in(2) {
            keys.give("up", choices.vector([-1.0, 1.0]));
        }
        if choices.one_in(2) {
            let below_180 = Legal(POSITIVE.0, 180.0_f64.next_down());
            keys.give(
                "vertical_fov",
                format!("{:?}", choices.number(below_180, [1.0, 170.0])),
            );
        }
        self.table("camera", &keys);
    }

    fn transfer_function(&mut self, choices: &mut Choices<'_>, points: bool, curve: bool) {
        let mut keys = Keys::default();
        if !curve && choices.one_in(2) {
            keys.give("reference_length", length(choices, [0.5, 2.0]));
        }
        if !points {
            if choices.one_in(2) {
                let below_1 = Legal(0.0, 1.0_f64.next_down());
                keys.give(
                    "floor",
                    format!("{:?}", choices.number(below_1, [0.0, 0.9])),
                );
            }
            if !curve && choices.one_in(2) {
                let names = [
                    "heat",
                    "grey",
                    "display-grey",
                    "bone",
                    "white",
                    "viridis",
                    "magma",
                    "inferno",
                    "plasma",
                    "turbo",
                ];
                keys.give("colormap", quoted(choices.pick(&names)));
            }
        }
        self.table("transfer_function", &keys);
        if !points {
            return;
        }
        let mut values: Vec<f32> = (0..1 + choices.below(4))
            .map(|_| choices.sample(true))
            .collect();
        values.sort_by(f32::total_cmp);
        for value in values {
            let mut keys = Keys::default();
            keys.give("value", format!("{:?}", f64::from(value)));
            keys.give("colour", choices.radiance());
            keys.give(
                "opacity",
                format!("{:?}", choices.number(SHARE, [0.0, 1.0])),
            );
            self.table("[transfer_function.point]", &keys);
        }
    }

    fn curve(&mut self, choices: &mut Choices<'_>) {
        let points = choices.one_in(2);
        self.transfer_function(choices, points, true);
        let mut keys = Keys::default();
        if !points && choices.one_in(2) {
            keys.give(
                "densities",
                format!("{:?}", choices.number(POSITIVE, [0.5, 2.0])),
            );
        }
        self.table("curve", &keys);
    }

    fn classified(&mut self, choices: &mut Choices<'_>) {
        let points = choices.one_in(3);
        self.transfer_function(choices, points, false);
        self.camera(choices, false);
        let mut keys = Keys::default();
        if choices.one_in(2) {
            keys.give(
                "interpolation",
                quoted(choices.pick(&["trilinear", "nearest"])),
            );
        }
        let mode = choices.one_in(4).then(|| mode(choices, &mut keys));
        let orders: &[&str] = match mode {
            None => &["front-to-back", "back-to-front"],
            Some(_) => &["front-to-back", "continuous"],
        };
        if choices.one_in(2) {
            keys.give("compositing", quoted(choices.pick(orders)));
        }
        if choices.one_in(2) {
            keys.give("step", length(choices, [0.25, 2.0]));
        }
        if choices.one_in(2) {
            keys.give("background", choices.radiance());
        }
        let map = place_of_volume(choices);
        let volume = match choices.one_in(4) {
            true => formula(choices, map),
            false => self.volume(choices, points, map),
        };
        keys.give("volume", volume);
        if choices.one_in(2) {
            keys.give(
                "light",
                format!("{{ position = {} }}", choices.place([-4.0, 4.0])),
            );
        }
        if choices.one_in(2) {
            let mut phong = Keys::default();
            for key in ["ambient", "diffuse", "specular"] {
                if choices.one_in(2) {
                    phong.give(
                        key,
                        format!("{:?}", choices.number(NOT_NEGATIVE, [0.0, 1.0])),
                    );
                }
            }
            if choices.one_in(2) {
                phong.give("shininess", choices.count(1, 64, 1 << 20));
            }
            if mode != Some(Shown::Numbers) {
                keys.give("phong", phong.inline());
            }
        }
        if choices.one_in(2) && mode.is_none() {
            let mut shadow = Keys::default();
            if choices.one_in(2) {
                shadow.give("step", length(choices, [0.25, 2.0]));
            }
            if !points || choices.one_in(2) {
                shadow.give("reference_step", length(choices, [0.01, 2.0]));
            }
            keys.give("shadow", shadow.inline());
        }
        self.table("classified", &keys);
    }

    /// A volume file, and the table that names it.
    fn volume(&mut self, choices: &mut Choices<'_>, signed: bool, mut keys: Keys) -> String {
        let kind = choices.below(4);
        if kind == 0 {
            keys.give("file", quoted("cloud.obj"));
            let flat = choices.one_in(8);
            self.add_file("cloud.obj", cloud(choices, flat));
            // Three paddings and a wild one: between them lie grids of gigabytes.
            let padding = choices.pick(&[2, 0, 1, 1024]);
            if choices.one_in(2) {
                keys.give("padding", padding);
            }
            if choices.one_in(2) {
                // A grid of a cloud that is no line has up to the cube of the resolution nodes:
                // 4096 of them fill a memory.
                let most = if flat { 4096 } else { 16 };
                keys.give("resolution", choices.count(2, 12, most));
            }
            return keys.inline();
        }
        let nodes = std::array::from_fn(|_| choices.pick(&[2, 1, 3, 5, 9]));
        let mut samples: Vec<f32> = (0..nodes.iter().product())
            .map(|_| choices.sample(signed))
            .collect();
        if choices.one_in(8) {
            let place = choices.below(samples.len());
            samples[place] = choices.pick(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
            let value = choices.number(Legal(f64::from(f32::MIN), f64::from(f32::MAX)), [0.0, 1.0]);
            keys.give("replace_non_finite", format!("{value:?}"));
        }
        if choices.one_in(2) {
            keys.give("centring", quoted(choices.pick(&["nodes", "cells"])));
        }
        if choices.one_in(4) {
            keys.give("orientation", quoted(choices.pick(&["world", "as-stored"])));
        }
        let data: Vec<u8> = samples
            .iter()
            .flat_map(|sample| sample.to_le_bytes())
            .collect();
        match kind {
            1 => {
                keys.give("file", quoted("grid.bin"));
                self.add_file("grid.bin", course_grid(choices, nodes, &data));
            }
            2 => {
                keys.give("file", quoted("bare.toml"));
                self.add_file("bare.toml", description(choices, nodes).into_bytes());
                self.add_file("bare.raw", data);
            }
            _ => {
                keys.give("file", quoted("grid.nrrd"));
                self.add_file("grid.nrrd", nrrd(choices, nodes, data));
            }
        }
        keys.inline()
    }

    fn radiative(&mut self, choices: &mut Choices<'_>) {
        self.camera(choices, true);
        let mut keys = Keys::default();
        if choices.one_in(2) {
            keys.give("samples", choices.count(1, 4, 1 << 31));
        }
        if choices.one_in(2) {
            keys.give("seed", choices.count(0, 9, i64::MAX as u64));
        }
        self.table("sampling", &keys);

        let mut keys = Keys::default();
        let scattering = choices.pick(&["multiple", "single", "none"]);
        keys.give("scattering", quoted(scattering));
        // Left out, or many, in few: light that nothing takes away is turned 2^26 times, which
        // takes seconds for each of its paths and ends in an error that says so.
        if scattering == "multiple" && !choices.one_in(4) {
            keys.give("max_bounces", choices.count(2, 8, (1 << 26) - 1));
        }
        if choices.one_in(2) {
            keys.give("environment", choices.radiance());
        }
        self.table("radiative", &keys);
        for _ in 0..choices.pick(&[1, 0, 2, 4]) {
            self.medium(choices);
        }
        for _ in 0..choices.pick(&[1, 0, 2, 3]) {
            self.light(choices);
        }
        for _ in 0..choices.pick(&[1, 0, 2, 4]) {
            self.surface(choices);
        }
    }

    fn medium(&mut self, choices: &mut Choices<'_>) {
        let mut keys = Keys::default();
        if !choices.one_in(6) {
            let shape = choices.pick(&["box", "sphere", "mesh"]);
            self.shape(choices, &mut keys, shape, true);
            place(choices, &mut keys);
        }
        let kinds = [
            "none",
            "grid",
            "noise",
            "exponential",
            "linear",
            "blob",
            "procedural",
        ];
        let density = choices.pick(&kinds);
        match density {
            "grid" => {
                keys.give("grid", self.volume(choices, false, Keys::default()));
                if choices.one_in(2) {
                    keys.give(
                        "interpolation",
                        quoted(choices.pick(&["trilinear", "nearest"])),
                    );
                }
            }
            "noise" => keys.give("noise", noise(choices)),
            "exponential" => keys.give("exponential", layer(choices)),
            "linear" => keys.give("linear", ramp(choices)),
            "blob" => keys.give("blob", blob(choices)),
            "procedural" => {
                keys.give(
                    "procedural",
                    format!("{{ text = '''{}''' }}", block(choices)),
                );
            }
            _ => {}
        }
        if density != "procedural" {
            match choices.below(3) {
                0 => {
                    keys.give("sigma_t", choices.coefficient());
                    keys.give("albedo", choices.share());
                }
                1 => {
                    keys.give("sigma_a", choices.coefficient());
                    keys.give("sigma_s", choices.coefficient());
                }
                _ => keys.give("sigma_a", choices.coefficient()),
            }
        }
        if choices.one_in(2) {
            keys.give(
                "g",
                format!("{:?}", choices.number(asymmetry(), [-0.9, 0.9])),
            );
        }
        if choices.one_in(3) {
            keys.give("emission", choices.emission());
        }
        self.table("[radiative.medium]", &keys);
    }

    fn light(&mut self, choices: &mut Choices<'_>) {
        let mut keys = Keys::default();
        let kind = choices.pick(&["directional", "point", "spot"]);
        if kind == "directional" {
            keys.give("direction", choices.vector([-1.0, 1.0]));
            keys.give("irradiance", choices.radiance());
        } else {
            keys.give("position", choices.place([-3.0, 3.0]));
            keys.give("intensity", choices.intensity());
        }
        if kind == "spot" {
            keys.give("target", choices.place([-1.0, 1.0]));
            let angle = Legal(0.0, 180.0);
            keys.give(
                "inner_angle",
                format!("{:?}", choices.number(angle, [0.0, 30.0])),
            );
            keys.give(
                "outer_angle",
                format!("{:?}", choices.number(angle, [30.0, 120.0])),
            );
        }
        let mut light = Keys::default();
        light.give(kind, keys.inline());
        self.table("[radiative.light]", &light);
    }

    fn surface(&mut self, choices: &mut Choices<'_>) {
        let mut keys = Keys::default();
        let shape = choices.pick(&["rectangle", "sphere", "box", "mesh"]);
        self.shape(choices, &mut keys, shape, false);
        place(choices, &mut keys);
        match choices.below(8) {
            0..=2 => keys.give(
                "diffuse",
                format!("{{ reflectance = {} }}", choices.share()),
            ),
            3..=5 => {
                let mut emitter = Keys::default();
                emitter.give("radiance", choices.radiance());
                if choices.one_in(2) {
                    emitter.give("sides", quoted(choices.pick(&["front", "both"])));
                }
                keys.give("emitter", emitter.inline());
            }
            6 => keys.give("mirror", format!("{{ reflectance = {} }}", choices.share())),
            _ => {
                let index = choices.number(POSITIVE, [0.5, 2.5]);
                keys.give("glass", format!("{{ index = {index:?} }}"));
            }
        }
        self.table("[radiative.surface]", &keys);
    }

    fn shape(&mut self, choices: &mut Choices<'_>, keys: &mut Keys, shape: &str, closed: bool) {
        let mut of = Keys::default();
        match shape {
            "sphere" => {
                of.give("centre", choices.place([-1.0, 1.0]));
                of.give(
                    "radius",
                    format!("{:?}", choices.length(POSITIVE, [0.25, 2.0])),
                );
            }
            "box" => {
                let corners: [[f64; 2]; 3] = std::array::from_fn(|_| {
                    let ends = [
                        choices.length(FINITE, [-2.0, 0.0]),
                        choices.length(FINITE, [0.25, 2.0]),
                    ];
                    [ends[0].min(ends[1]), ends[0].max(ends[1])]
                });
                of.give("min", format!("{:?}", corners.map(|[min, _]| min)));
                of.give("max", format!("{:?}", corners.map(|[_, max]| max)));
            }
            "rectangle" => {
                of.give("corner", choices.place([-2.0, 2.0]));
                // One along x and one along y or z, more or less: most have an area.
                for (key, along) in [("edge_u", 0), ("edge_v", 1 + choices.below(2))] {
                    let edge: [f64; 3] = std::array::from_fn(|axis| {
                        let usual = if axis == along {
                            [4.0, 0.5]
                        } else {
                            [0.0, 0.25]
                        };
                        choices.length(FINITE, usual)
                    });
                    of.give(key, format!("{edge:?}"));
                }
            }
            _ => {
                let name = if closed { "closed.obj" } else { "open.obj" };
                of.give("file", quoted(name));
                self.add_file(name, mesh(choices, closed));
            }
        }
        keys.give(shape, of.inline());
    }
}

/// A positive length: in voxels or world units.
fn length(choices: &mut Choices<'_>, usual: [f64; 2]) -> String {
    if choices.one_in(3) {
        format!("{:?}", choices.length(POSITIVE, usual))
    } else {
        quoted(&format!("{:?} voxels", choices.number(POSITIVE, usual)))
    }
}

fn place(choices: &mut Choices<'_>, keys: &mut Keys) {
    if choices.one_in(6) {
        keys.give("scale", choices.vector([-2.0, 2.0]));
    }
    if choices.one_in(6) {
        let axis = choices.vector([-1.0, 1.0]);
        let angle = choices.number(FINITE, [-180.0, 180.0]);
        keys.give("rotate", format!("{{ axis = {axis}, angle = {angle:?} }}"));
    }
    if choices.one_in(6) {
        keys.give("translate", choices.place([-2.0, 2.0]));
    }
}

/// The keys of a map that places a volume: none, a matrix, or steps.
fn place_of_volume(choices: &mut Choices<'_>) -> Keys {
    let mut keys = Keys::default();
    match choices.below(4) {
        0 => {}
        1 => {
            let rows: Vec<Vec<f64>> = (0..3)
                .map(|row| {
                    let mut numbers = vec![0.0; 4];
                    for (column, number) in numbers.iter_mut().enumerate().take(3) {
                        let usual = if row == column {
                            [2.0, 0.5]
                        } else {
                            [0.0, 0.5]
                        };
                        *number = choices.number(FINITE, usual);
                    }
                    numbers[3] = choices.length(FINITE, [-1.0, 1.0]);
                    numbers
                })
                .collect();
            keys.give("transform", format!("{rows:?}"));
        }
        _ => place(choices, &mut keys),
    }
    keys
}

/// A formula in place of a file: mostly of numbers that are exact in 32 bits.
fn formula(choices: &mut Choices<'_>, mut keys: Keys) -> String {
    let nodes: [usize; 3] = std::array::from_fn(|_| choices.pick(&[2, 1, 3, 5, 9]));
    keys.give("nodes", format!("{nodes:?}"));
    let value = |choices: &mut Choices<'_>| match choices.one_in(8) {
        true => choices.number(FINITE, [0.0, 1.0]),
        false => choices.pick(&[0.125, 0.0, 0.5, 1.0, -0.25]),
    };
    if choices.one_in(2) {
        let spacing = [0; 3].map(|_| choices.length(POSITIVE, [0.1, 1.0]));
        keys.give("spacing", format!("{spacing:?}"));
    }
    if choices.one_in(4) {
        keys.give("origin", choices.place([-2.0, 2.0]));
    }
    if choices.one_in(2) {
        keys.give("value", format!("{:?}", value(choices)));
    }
    if choices.one_in(4) {
        keys.give("centring", quoted(choices.pick(&["nodes", "cells"])));
    }
    if choices.one_in(2) {
        keys.give("field", quoted("ramp"));
        let slope = [0; 3].map(|_| value(choices));
        keys.give("slope", format!("{slope:?}"));
        return keys.inline();
    }
    keys.give("field", quoted("spots"));
    let few = choices.one_in(2);
    if few {
        keys.give("every", choices.count(2, 4, 1 << 27));
        if choices.one_in(2) {
            keys.give("bright", format!("{:?}", value(choices)));
        }
    }
    if !few || choices.one_in(2) {
        let spots: Vec<String> = (0..1 + choices.below(3))
            .map(|_| {
                let node = nodes.map(|count| choices.below(count + 1).min(count - 1));
                format!("{{ node = {node:?}, value = {:?} }}", value(choices))
            })
            .collect();
        keys.give("spot", format!("[{}]", spots.join(", ")));
    }
    keys.inline()
}

/// Values of g: between −1 and 1.
fn asymmetry() -> Legal {
    Legal((-1.0_f64).next_up(), 1.0_f64.next_down())
}

fn noise(choices: &mut Choices<'_>) -> String {
    let mut keys = Keys::default();
    if choices.one_in(2) {
        keys.give("octaves", choices.count(1, 4, 32));
    }
    for key in ["lacunarity", "gain"] {
        if choices.one_in(2) {
            keys.give(key, format!("{:?}", choices.number(POSITIVE, [0.25, 4.0])));
        }
    }
    if choices.one_in(2) {
        keys.give("scale", choices.gradient([-2.0, 2.0]));
    }
    if choices.one_in(2) {
        keys.give("offset", choices.vector([-2.0, 2.0]));
    }
    if choices.one_in(2) {
        keys.give(
            "max_density",
            format!("{:?}", choices.number(NOT_NEGATIVE, [0.0, 2.0])),
        );
    }
    if choices.one_in(2) {
        keys.give(
            "threshold",
            format!("{:?}", choices.number(FINITE, [-1.0, 1.0])),
        );
    }
    keys.inline()
}

fn layer(choices: &mut Choices<'_>) -> String {
    let mut keys = Keys::default();
    if choices.one_in(2) {
        keys.give(
            "density",
            format!("{:?}", choices.number(NOT_NEGATIVE, [0.0, 2.0])),
        );
    }
    if choices.one_in(2) {
        keys.give("base", choices.place([-2.0, 2.0]));
    }
    if choices.one_in(2) {
        keys.give("up", choices.vector([-1.0, 1.0]));
    }
    keys.give(
        "scale_height",
        format!("{:?}", choices.length(POSITIVE, [0.25, 2.0])),
    );
    keys.inline()
}

fn ramp(choices: &mut Choices<'_>) -> String {
    let mut keys = Keys::default();
    if choices.one_in(2) {
        keys.give(
            "density",
            format!("{:?}", choices.number(FINITE, [-1.0, 2.0])),
        );
    }
    if choices.one_in(2) {
        keys.give("origin", choices.place([-2.0, 2.0]));
    }
    keys.give("gradient", choices.gradient([-1.0, 1.0]));
    keys.inline()
}

fn blob(choices: &mut Choices<'_>) -> String {
    let mut keys = Keys::default();
    keys.give("centre", choices.place([-1.0, 1.0]));
    keys.give(
        "width",
        format!("{:?}", choices.length(POSITIVE, [0.125, 2.0])),
    );
    if choices.one_in(2) {
        keys.give(
            "peak",
            format!("{:?}", choices.number(NOT_NEGATIVE, [0.0, 2.0])),
        );
    }
    keys.inline()
}

/// A procedural medium in XML.
fn block(choices: &mut Choices<'_>) -> String {
    let mut text = String::from("<medium type=\"procedural\">");
    let mut give = |element: &str, name: &str, value: &str| {
        // Lists of TOML, but for the brackets, are lists of the block.
        let value = value.trim_matches(['[', ']']);
        text.push_str(&format!("<{element} name=\"{name}\" value=\"{value}\"/>"));
    };
    give("color", "sigma_a", &choices.coefficient());
    if choices.one_in(2) {
        give("color", "sigma_s", &choices.coefficient());
    }
    if choices.one_in(2) {
        give("integer", "nrOctaves", &choices.count(1, 4, 32).to_string());
    }
    for (name, legal, usual) in [
        ("lacunarity", POSITIVE, [0.25, 4.0]),
        ("gain", POSITIVE, [0.25, 4.0]),
        ("maxDensity", NOT_NEGATIVE, [0.0, 2.0]),
        ("threshold", FINITE, [-1.0, 1.0]),
        ("g", asymmetry(), [-0.9, 0.9]),
    ] {
        if choices.one_in(3) {
            give(
                "float",
                name,
                &format!("{:?}", choices.number(legal, usual)),
            );
        }
    }
    if choices.one_in(3) {
        give("vector", "scale", &choices.gradient([-2.0, 2.0]));
    }
    if choices.one_in(3) {
        give("vector", "offset", &choices.vector([-2.0, 2.0]));
    }
    text.push_str("</medium>");
    text
}

/// A cloud of a few points, on a line along x if it is to be `flat`.
fn cloud(choices: &mut Choices<'_>, flat: bool) -> Vec<u8> {
    let mut text = String::new();
    for point in 0..2 + choices.below(6) {
        let [x, y, z] = std::array::from_fn(|_| {
            let usual = f64::from(point as u32) - 1.0;
            choices.length(FINITE, [usual, usual + 1.0])
        });
        let [y, z] = if flat { [0.0, 0.0] } else { [y, z] };
        text.push_str(&format!("v {x:?} {y:?} {z:?}"));
        if choices.one_in(2) {
            text.push_str(&format!(" {:?}", choices.number(NOT_NEGATIVE, [0.25, 1.0])));
        }
        text.push('\n');
    }
    text.into_bytes()
}

/// A tetrahedron, or a bent strip of two triangles.
fn mesh(choices: &mut Choices<'_>, closed: bool) -> Vec<u8> {
    let corners = [
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, 0.5],
        [-0.5, -0.5, 1.0],
        [0.0, 1.0, 0.0],
    ];
    let mut text = String::new();
    for corner in corners {
        let [x, y, z] = corner.map(|usual| choices.length(FINITE, [usual, usual]));
        text.push_str(&format!("v {x:?} {y:?} {z:?}\n"));
    }
    text.push_str(if closed {
        "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n"
    } else {
        "f 1 2 3\nf 2 4 3\n"
    });
    text.into_bytes()
}

/// The course's binary grid: its size is that of 32-bit numbers.
fn course_grid(choices: &mut Choices<'_>, nodes: [usize; 3], data: &[u8]) -> Vec<u8> {
    let header = nodes.map(|count| (count as i32).to_le_bytes());
    let size: [f64; 3] =
        std::array::from_fn(|_| choices.length(Legal(0.0, f64::from(f32::MAX)), [0.5, 2.0]));
    let size = size.map(|size| (size as f32).to_le_bytes());
    [header.concat(), size.concat(), data.to_vec()].concat()
}

/// A file of bare samples, described.
fn description(choices: &mut Choices<'_>, nodes: [usize; 3]) -> String {
    let mut keys = Keys::default();
    keys.give("file", quoted("bare.raw"));
    keys.give("type", quoted("float32"));
    keys.give("endian", quoted("little"));
    keys.give("nodes", format!("{nodes:?}"));
    if choices.one_in(2) {
        let spacing: [f64; 3] = std::array::from_fn(|_| choices.length(POSITIVE, [0.125, 1.0]));
        keys.give("spacing", format!("{spacing:?}"));
    }
    if choices.one_in(2) {
        keys.give("origin", choices.place([-1.0, 1.0]));
    }
    keys.0.join("\n")
}

fn nrrd(choices: &mut Choices<'_>, [x, y, z]: [usize; 3], data: Vec<u8>) -> Vec<u8> {
    let spacing: [f64; 3] = std::array::from_fn(|_| choices.length(POSITIVE, [0.125, 1.0]));
    let [a, b, c] = spacing;
    let header = format!(
        "NRRD0004\ntype: float\ndimension: 3\nsizes: {x} {y} {z}\nspacings: {a:?} {b:?} {c:?}\n\
         endian: little\nencoding: raw\n\n"
    );
    [header.into_bytes(), data].concat()
}

/// What a pixel shows in place of composited samples.
#[derive(Clone, Copy, PartialEq)]
enum Shown {
    Numbers,
    Surfaces,
}

/// Gives the keys of a projection or of isosurfaces.
fn mode(choices: &mut Choices<'_>, keys: &mut Keys) -> Shown {
    let values = Legal(f64::from(f32::MIN), f64::from(f32::MAX));
    if choices.one_in(3) {
        keys.give("mode", quoted("isosurface"));
        let surface = |choices: &mut Choices<'_>| {
            let value = choices.number(values, [-0.5, 1.0]);
            let opacity = choices.number(Legal(0.0, 1.0), [0.1, 1.0]);
            let colour = choices.radiance();
            format!("{{ value = {value:?}, colour = {colour}, opacity = {opacity:?} }}")
        };
        let surfaces: Vec<String> = (0..1 + choices.below(3))
            .map(|_| surface(choices))
            .collect();
        keys.give("isosurface", format!("[{}]", surfaces.join(", ")));
        return Shown::Surfaces;
    }
    let projections = ["maximum", "minimum", "mean", "sum", "attenuated-maximum"];
    let name = choices.pick(&projections);
    keys.give("mode", quoted(name));
    let is_attenuated = name == projections[4];
    if is_attenuated {
        let attenuation = choices.number(NOT_NEGATIVE, [0.0, 4.0]);
        keys.give("attenuation", format!("{attenuation:?}"));
    }
    if is_attenuated || choices.one_in(2) {
        let low = choices.number(values, [-0.5, 0.5]);
        let high = choices.number(values, [0.5, 1.5]);
        keys.give("window", format!("{{ low = {low:?}, high = {high:?} }}"));
    }
    Shown::Numbers
}
