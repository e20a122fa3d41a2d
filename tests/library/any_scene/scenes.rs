//! Scenes as a user could write them, with any legal number at any key.
//!
//! Every key of the format is in the [grammar](GRAMMAR), and each may hold its limits, zeros of both
//! signs, the smallest and the largest numbers. Kept small is only what a scene must be small in to be
//! rendered at all within a test: how many things it holds, and the grids and meshes beside it.

use super::choices::Choices;

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
    let (mut choices, mut files) = (Choices::new(list), Vec::new());
    let text = rule("scene", &mut choices, &mut files);
    Written { text, files }
}

/// `% NAME` begins a rule, and an empty line ends one of whole lines. In it `⟦a¦b⟧` is one of its parts, the first of which is the plainest, `⟦3|a⟧` is there in
/// one of three cases, and `⟨…⟩` stands for another rule or for what [`call`] makes.
const GRAMMAR: &str = r#"
% scene
[film]
width = ⟨c 8 8 16384⟩
height = ⟨c 8 8 16384⟩
⟦⟨classified⟩¦⟨classified⟩¦⟨classified⟩¦⟨curve⟩¦⟨radiative⟩¦⟨radiative⟩¦⟨radiative⟩¦⟨radiative⟩⟧
% eye
eye = [⟨l f -1 1⟩, ⟨l f 0 2⟩, ⟨l f -4 4⟩]

% target
target = ⟨3l f -1 1⟩

% look
⟦2|up = ⟨3n f -1 1⟩
⟧⟦2|vertical_fov = ⟨n v 1 170⟩
⟧
% formula-look
[transfer_function]
⟦2|floor = ⟨n u 0 0.9⟩
⟧
% curve
⟦⟨formula-look⟩[curve]
⟦2|densities = ⟨n + 0.5 2⟩
⟧¦[transfer_function]
⟨points⟩[curve]
⟧
% classified
⟦⟨of-formula⟩¦⟨of-formula⟩¦⟨of-points⟩⟧
% of-formula
⟨formula-look⟩⟦2|reference_length = ⟨length 0.5 2⟩
⟧⟦2|colormap = "⟦heat¦grey¦display-grey¦bone¦white¦viridis¦magma¦inferno¦plasma¦turbo⟧"
⟧⟨body⟩⟦⟨of-samples⟩⟦2|shadow = { ⟦2|step = ⟨length 0.25 2⟩, ⟧reference_step = ⟨length 0.01 2⟩ }
⟧¦⟨of-samples⟩¦⟨integral⟩¦⟨numbers⟩⟧volume = { ⟨place⟩⟦⟨volume u⟩¦⟨volume u⟩¦⟨volume u⟩¦⟨formula⟩⟧ }
% of-points
[transfer_function]
⟦2|reference_length = ⟨length 0.5 2⟩
⟧⟨points⟩⟨body⟩⟦⟨of-samples⟩⟦2|shadow = { ⟦2|step = ⟨length 0.25 2⟩, ⟧⟦2|reference_step = ⟨length 0.01 2⟩⟧ }
⟧¦⟨of-samples⟩¦⟨integral⟩¦⟨numbers⟩⟧volume = { ⟨place⟩⟦⟨volume s⟩¦⟨volume s⟩¦⟨volume s⟩¦⟨formula⟩⟧ }
% body
⟦2|[camera]
⟦2|⟨eye⟩⟧⟦2|⟨target⟩⟧⟨look⟩⟧[classified]
⟦2|interpolation = "⟦trilinear¦nearest⟧"
⟧⟦2|step = ⟨length 0.25 2⟩
⟧⟦2|background = ⟨radiance⟩
⟧⟦2|light = { position = ⟨3l f -4 4⟩ }
⟧
% phong
⟦2|phong = { ⟦2|ambient = ⟨n z 0 1⟩, ⟧⟦2|diffuse = ⟨n z 0 1⟩, ⟧⟦2|specular = ⟨n z 0 1⟩, ⟧⟦2|shininess = ⟨c 1 64 1048576⟩⟧ }
⟧
% of-samples
⟦2|compositing = "⟦front-to-back¦back-to-front⟧"
⟧⟨phong⟩
% integral
compositing = "continuous"

% numbers
⟦2|compositing = "⟦front-to-back¦continuous⟧"
⟧⟦mode = "⟦maximum¦minimum¦mean¦sum⟧"
⟦2|⟨window⟩⟧¦mode = "attenuated-maximum"
attenuation = ⟨n z 0 4⟩
⟨window⟩¦mode = "isosurface"
isosurface = [⟨isosurface⟩⟦2|, ⟨isosurface⟩⟧⟦4|, ⟨isosurface⟩⟧]
⟨phong⟩⟧
% window
window = { low = ⟨n h -0.5 0.5⟩, high = ⟨n h 0.5 1.5⟩ }

% isosurface
{ value = ⟨n h -0.5 1⟩, colour = ⟨radiance⟩, opacity = ⟨n s 0.1 1⟩ }
% place
⟦¦transform = [⟨row 0⟩, ⟨row 1⟩, ⟨row 2⟩], ¦⟨steps⟩¦⟨steps⟩⟧
% steps
⟦6|scale = ⟨3n f -2 2⟩, ⟧⟦6|rotate = { axis = ⟨3n f -1 1⟩, angle = ⟨n f -180 180⟩ }, ⟧⟦6|translate = ⟨3l f -2 2⟩, ⟧
% formula
⟦2|spacing = ⟨3l + 0.1 1⟩, ⟧⟦4|origin = ⟨3l f -2 2⟩, ⟧⟦2|value = ⟨exact⟩, ⟧⟦4|centring = "⟦nodes¦cells⟧", ⟧⟦field = "ramp", nodes = ⟨nodes⟩, slope = [⟨exact⟩, ⟨exact⟩, ⟨exact⟩]¦field = "spots", nodes = ⟨nodes⟩, every = ⟨c 2 4 134217728⟩⟦2|, bright = ⟨exact⟩⟧¦field = "spots", nodes = [3, 5, 2], spot = [{ node = [⟦0¦1¦2⟧, ⟦0¦4⟧, 1], value = ⟨exact⟩ }⟦2|, { node = [0, 3, 0], value = ⟨exact⟩ }⟧]⟧
% exact
⟦0.125¦0.0¦0.5¦1.0¦-0.25¦1.0¦0.5¦⟨n f 0 1⟩⟧
% radiative
[camera]
⟨eye⟩⟨target⟩⟨look⟩[sampling]
⟦2|samples = ⟨c 1 4 2147483648⟩
⟧⟦2|seed = ⟨c 0 9 9223372036854775807⟩
⟧[radiative]
⟦⟨bounces⟩¦⟨bounces⟩¦⟨bounces⟩¦scattering = "multiple"
¦scattering = "single"
¦scattering = "single"
¦scattering = "none"
⟧⟦2|environment = ⟨radiance⟩
⟧⟦⟨medium⟩¦¦⟨medium⟩⟨medium⟩¦⟨medium⟩⟨medium⟩⟨medium⟩⟨medium⟩⟧⟦⟨light⟩¦¦⟨light⟩⟨light⟩¦⟨light⟩⟨light⟩⟨light⟩⟧⟦⟨surface⟩¦¦⟨surface⟩⟨surface⟩¦⟨surface⟩⟨surface⟩⟨surface⟩⟨surface⟩⟧
% bounces
max_bounces = ⟨c 2 8 67108863⟩

% medium
[[radiative.medium]]
⟦⟨enclosed⟩¦⟨enclosed⟩¦⟨enclosed⟩¦⟨enclosed⟩¦⟨enclosed⟩¦⟧⟦⟨coefficients⟩¦grid = { ⟨volume u⟩ }
⟦2|interpolation = "⟦trilinear¦nearest⟧"
⟧⟨coefficients⟩¦⟨noise⟩⟨coefficients⟩¦exponential = { ⟦2|density = ⟨n z 0 2⟩, ⟧⟦2|base = ⟨3l f -2 2⟩, ⟧⟦2|up = ⟨3n f -1 1⟩, ⟧scale_height = ⟨l + 0.25 2⟩ }
⟨coefficients⟩¦linear = { ⟦2|density = ⟨n f -1 2⟩, ⟧⟦2|origin = ⟨3l f -2 2⟩, ⟧gradient = ⟨3g f -1 1⟩ }
⟨coefficients⟩¦blob = { centre = ⟨3l f -1 1⟩, width = ⟨l + 0.125 2⟩⟦2|, peak = ⟨n z 0 2⟩⟧ }
⟨coefficients⟩¦⟨procedural⟩⟧⟦⟨phase⟩¦⟧⟦3|emission = ⟨emission⟩
⟧
% phase
⟦g = ⟨n a -0.9 0.9⟩
¦g = ⟨n a -0.9 0.9⟩
¦draine = { g = ⟨n a -0.9 0.9⟩, alpha = ⟨n z 0 2⟩ }
¦droplets = { diameter = ⟨n m 5 50⟩ }
⟧
% coefficients
⟦sigma_t = ⟨coefficient⟩
albedo = ⟨share⟩
¦sigma_a = ⟨coefficient⟩
sigma_s = ⟨coefficient⟩
¦sigma_a = ⟨coefficient⟩
⟧
% noise
noise = { ⟦2|octaves = ⟨c 1 4 32⟩, ⟧⟦2|lacunarity = ⟨n + 0.25 4⟩, ⟧⟦2|gain = ⟨n + 0.25 4⟩, ⟧⟦2|scale = ⟨3g f -2 2⟩, ⟧⟦2|offset = ⟨3n f -2 2⟩, ⟧⟦2|max_density = ⟨n z 0 2⟩, ⟧⟦2|threshold = ⟨n f -1 1⟩⟧ }

% procedural
procedural = { text = '''<medium type="procedural"><color name="sigma_a" value="⟨n z 0 4⟩"/>⟦2|<color name="sigma_s" value="⟨n z 0 4⟩ ⟨n z 0 4⟩ ⟨n z 0 4⟩"/>⟧⟦2|<integer name="nrOctaves" value="⟨c 1 4 32⟩"/>⟧⟦3|<float name="lacunarity" value="⟨n + 0.25 4⟩"/>⟧⟦3|<float name="gain" value="⟨n + 0.25 4⟩"/>⟧⟦3|<float name="maxDensity" value="⟨n z 0 2⟩"/>⟧⟦3|<float name="threshold" value="⟨n f -1 1⟩"/>⟧⟦3|<vector name="scale" value="⟨g f -2 2⟩, ⟨g f -2 2⟩, ⟨g f -2 2⟩"/>⟧</medium>''' }

% enclosed
⟦⟨box⟩¦⟨sphere⟩¦mesh = { file = "closed.obj" }⟨mesh closed⟩
⟧⟨moved⟩
% moved
⟦6|scale = ⟨3n f -2 2⟩
⟧⟦6|rotate = { axis = ⟨3n f -1 1⟩, angle = ⟨n f -180 180⟩ }
⟧⟦6|translate = ⟨3l f -2 2⟩
⟧
% box
box = { ⟨corners⟩ }

% sphere
sphere = { centre = ⟨3l f -1 1⟩, radius = ⟨l + 0.25 2⟩ }

% light
[[radiative.light]]
⟦directional = { direction = ⟨3n f -1 1⟩, irradiance = ⟨radiance⟩ }
¦point = { position = ⟨3l f -3 3⟩, intensity = ⟨intensity⟩ }
¦spot = { position = ⟨3l f -3 3⟩, intensity = ⟨intensity⟩, target = ⟨3l f -1 1⟩, inner_angle = ⟨n d 0 30⟩, outer_angle = ⟨n d 30 120⟩ }
⟧
% surface
[[radiative.surface]]
⟦rectangle = { corner = ⟨3l f -2 2⟩, edge_u = [⟨l f 4 0.5⟩, ⟨l f 0 0.25⟩, ⟨l f 0 0.25⟩], edge_v = [⟨l f 0 0.25⟩, ⟨l f 4 0.5⟩, ⟨l f 0 4⟩] }
¦⟨sphere⟩¦⟨box⟩¦mesh = { file = "open.obj" }⟨mesh open⟩
⟧⟨moved⟩⟦diffuse = { reflectance = ⟨share⟩ }
¦diffuse = { reflectance = ⟨share⟩ }
¦emitter = { radiance = ⟨radiance⟩⟦2|, sides = "⟦front¦both⟧"⟧ }
¦emitter = { radiance = ⟨radiance⟩ }
¦mirror = { reflectance = ⟨share⟩ }
¦glass = { index = ⟨n + 0.5 2.5⟩ }
⟧
"#;

type Files = Vec<(&'static str, Vec<u8>)>;

fn rule(name: &str, choices: &mut Choices<'_>, files: &mut Files) -> String {
    let mut rules = GRAMMAR.split("\n% ");
    let is_it = |rule: &&str| rule.split('\n').next() == Some(name);
    let rule = rules.find(is_it).unwrap_or_else(|| panic!("{name}"));
    expanded(&rule[name.len() + 1..], choices, files)
}

fn expanded(text: &str, choices: &mut Choices<'_>, files: &mut Files) -> String {
    let Some(at) = text.find(['⟦', '⟨']) else {
        return text.to_owned();
    };
    let (before, rest) = text.split_at(at);
    if let Some(rest) = rest.strip_prefix('⟨') {
        let (inside, after) = rest.split_once('⟩').unwrap();
        let made = call(inside, choices, files);
        return before.to_owned() + &made + &expanded(after, choices, files);
    }
    let (mut depth, mut cuts) = (0, vec![0]);
    for (at, letter) in rest.char_indices() {
        match letter {
            '⟦' => depth += 1,
            '¦' if depth == 1 => cuts.push(at),
            '⟧' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            cuts.push(at);
            break;
        }
    }
    let parts = cuts.windows(2).map(|ends| &rest[ends[0]..ends[1]]);
    let parts: Vec<&str> = parts
        .map(|part| &part[part.chars().next().unwrap().len_utf8()..])
        .collect();
    let chosen = match parts[..] {
        [optional] => {
            let (cases, part) = optional.split_once('|').unwrap();
            let is_there = choices.one_in(cases.parse().unwrap());
            if is_there { part } else { "" }
        }
        _ => parts[choices.below(parts.len())],
    };
    let chosen = expanded(chosen, choices, files);
    let after = &rest[cuts[cuts.len() - 1] + '⟧'.len_utf8()..];
    before.to_owned() + &chosen + &expanded(after, choices, files)
}

/// Numbers by kind, range and usual ends, three of them behind a 3; colours; files; other rules.
fn call(inside: &str, choices: &mut Choices<'_>, files: &mut Files) -> String {
    let words: Vec<&str> = inside.split(' ').collect();
    match words[..] {
        ["c", low, usual, high] => {
            let [low, usual, high] = [low, usual, high].map(|word| word.parse().unwrap());
            choices.count(low, usual, high).to_string()
        }
        [kind, legal, low, high] => {
            let usual = [low, high].map(|word| word.parse().unwrap());
            let mut number = || choices.of_kind(kind.trim_start_matches('3'), legal, usual);
            match kind.starts_with('3') {
                true => format!("{:?}", [number(), number(), number()]),
                false => format!("{:?}", number()),
            }
        }
        ["length", low, high] => {
            let usual = [low, high].map(|word| word.parse().unwrap());
            match choices.one_in(3) {
                true => format!("{:?}", choices.of_kind("l", "+", usual)),
                false => format!("\"{:?} voxels\"", choices.of_kind("n", "+", usual)),
            }
        }
        ["radiance" | "intensity" | "emission" | "coefficient" | "share"] => choices.colour(inside),
        ["nodes"] => format!("{:?}", nodes(choices)),
        ["row", row] => {
            let row: usize = row.parse().unwrap();
            let mut numbers = [0.0; 4];
            for (column, number) in numbers.iter_mut().enumerate().take(3) {
                let usual = if row == column {
                    [2.0, 0.5]
                } else {
                    [0.0, 0.5]
                };
                *number = choices.of_kind("n", "f", usual);
            }
            numbers[3] = choices.of_kind("l", "f", [-1.0, 1.0]);
            format!("{numbers:?}")
        }
        ["corners"] => {
            let ends: [[f64; 2]; 3] = std::array::from_fn(|_| {
                let [a, b] =
                    [[-2.0, 0.0], [0.25, 2.0]].map(|usual| choices.of_kind("l", "f", usual));
                [a.min(b), a.max(b)]
            });
            format!(
                "min = {:?}, max = {:?}",
                ends.map(|end| end[0]),
                ends.map(|end| end[1])
            )
        }
        ["points"] => {
            let mut values: Vec<f32> = (0..1 + choices.below(4))
                .map(|_| choices.sample(true))
                .collect();
            values.sort_by(f32::total_cmp);
            let point = |value: f32| {
                let (colour, opacity) = (
                    choices.colour("radiance"),
                    choices.of_kind("n", "s", [0.0, 1.0]),
                );
                let value = f64::from(value);
                format!(
                    "[[transfer_function.point]]\nvalue = {value:?}\ncolour = {colour}\nopacity = {opacity:?}\n"
                )
            };
            values.into_iter().map(point).collect()
        }
        ["volume", signed] => volume(signed == "s", choices, files),
        ["mesh", kind] => {
            let faces = ["f 1 2 3\nf 2 4 3\n", "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n"];
            let [name, faces] = match kind {
                "open" => ["open.obj", faces[0]],
                _ => ["closed.obj", faces[1]],
            };
            add(files, name, (corners(choices) + faces).into_bytes());
            String::new()
        }
        _ => rule(inside, choices, files),
    }
}

fn add(files: &mut Files, name: &'static str, bytes: Vec<u8>) {
    // A second of that name would be another file.
    if files.iter().all(|(other, _)| *other != name) {
        files.push((name, bytes));
    }
}

fn nodes(choices: &mut Choices<'_>) -> [usize; 3] {
    std::array::from_fn(|_| choices.pick(&[2, 1, 3, 5, 9]))
}

/// The corners of a tetrahedron, or of a bent strip of two triangles.
fn corners(choices: &mut Choices<'_>) -> String {
    let corners = [
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, 0.5],
        [-0.5, -0.5, 1.0],
        [0.0, 1.0, 0.0],
    ];
    let corner = |corner: [f64; 3]| {
        let [x, y, z] = corner.map(|usual| choices.of_kind("l", "f", [usual, usual]));
        format!("v {x:?} {y:?} {z:?}\n")
    };
    corners.map(corner).concat()
}

/// A volume file, and the keys that name it.
fn volume(signed: bool, choices: &mut Choices<'_>, files: &mut Files) -> String {
    let kind = choices.below(4);
    if kind == 0 {
        // A grid of a cloud that is no line has up to the cube of the resolution nodes: 4096 of them fill a
        // memory. Three paddings and a wild one: between them lie grids of gigabytes.
        let flat = choices.one_in(8);
        add(files, "cloud.obj", cloud(choices, flat));
        let most = if flat { 4096 } else { 16 };
        let keys = format!(
            "file = \"cloud.obj\"⟦2|, padding = ⟦2¦0¦1¦1024⟧⟧⟦2|, resolution = ⟨c 2 12 {most}⟩⟧"
        );
        return expanded(&keys, choices, files);
    }
    let nodes = nodes(choices);
    let mut samples: Vec<f32> = (0..nodes.iter().product())
        .map(|_| choices.sample(signed))
        .collect();
    let mut keys =
        "⟦2|, centring = \"⟦nodes¦cells⟧\"⟧⟦4|, orientation = \"⟦world¦as-stored⟧\"⟧".to_owned();
    if choices.one_in(8) {
        let place = choices.below(samples.len());
        samples[place] = choices.pick(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
        keys += ", replace_non_finite = ⟨n h 0 1⟩";
    }
    let data: Vec<u8> = samples
        .iter()
        .flat_map(|sample| sample.to_le_bytes())
        .collect();
    let [x, y, z] = nodes;
    let name = ["", "grid.bin", "bare.toml", "grid.nrrd"][kind];
    let bytes = match kind {
        // The course's binary grid: its size is that of 32-bit numbers.
        1 => {
            let header = nodes.map(|count| (count as i32).to_le_bytes());
            let size = [0; 3].map(|_| (choices.of_kind("l", "t", [0.5, 2.0]) as f32).to_le_bytes());
            [header.concat(), size.concat(), data].concat()
        }
        2 => {
            let text = format!(
                "file = \"bare.raw\"\ntype = \"float32\"\nendian = \"little\"\nnodes = {nodes:?}\n\
                 ⟦2|spacing = ⟨3l + 0.125 1⟩\n⟧⟦2|origin = ⟨3l f -1 1⟩\n⟧"
            );
            add(files, "bare.raw", data);
            expanded(&text, choices, files).into_bytes()
        }
        _ => {
            let text = format!(
                "NRRD0004\ntype: float\ndimension: 3\nsizes: {x} {y} {z}\n\
                 spacings: ⟨l + 0.125 1⟩ ⟨l + 0.125 1⟩ ⟨l + 0.125 1⟩\nendian: little\nencoding: raw\n\n"
            );
            [expanded(&text, choices, files).into_bytes(), data].concat()
        }
    };
    add(files, name, bytes);
    format!("file = \"{name}\"{}", expanded(&keys, choices, files))
}

/// A cloud of a few points, on a line along x if it is to be `flat`.
fn cloud(choices: &mut Choices<'_>, flat: bool) -> Vec<u8> {
    let mut text = String::new();
    for point in 0..2 + choices.below(6) {
        let usual = point as f64 - 1.0;
        let [x, y, z] = [0; 3].map(|_| choices.of_kind("l", "f", [usual, usual + 1.0]));
        let [y, z] = if flat { [0.0, 0.0] } else { [y, z] };
        let weight = expanded("⟦2| ⟨n z 0.25 1⟩⟧", choices, &mut Vec::new());
        text += &format!("v {x:?} {y:?} {z:?}{weight}\n");
    }
    text.into_bytes()
}
