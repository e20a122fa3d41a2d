//! The kinds of files that are read, and who reads them.

use super::mutation::Mutator;
use super::{exr_header, kept};
use crate::folder::{Folder, root};
use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::path::PathBuf;
use volref::compare::Picture;
use volref::exchange::{Format, export};
use volref::film::{Film, LayeredFilm};
use volref::geometry::{ClosedMesh, Mesh};
use volref::render::Plan;
use volref::scene::{Scene, read_procedural};
use volref::suite::{Golden, Store, Suite};
use volref::volume::{LoadOptions, load};

/// A kind of file.
pub struct Kind {
    pub name: &'static str,
    /// Files to begin with.
    pub seeds: fn(&Workshop) -> Vec<Vec<u8>>,
    /// Breaks one of them. Checksums are made right again, or not: most damage would end there.
    pub mutant: fn(&[Vec<u8>], &mut Mutator) -> Vec<u8>,
    /// Reads it as the library does; what is said if it is refused.
    pub read: fn(&Workshop, &[u8]) -> Result<(), String>,
    /// Where the command finds it, in the folder of the workshop.
    pub place: fn(&Workshop) -> String,
    /// Commands that read it there.
    pub commands: &'static [&'static str],
    /// One in so many is given to a command as well.
    pub share: u64,
}

/// Share of the commands of most kinds: one takes as long as many in the library.
const SHARE: u64 = 40;

/// Of kinds that only commands read to the end.
const LARGE_SHARE: u64 = 8;

/// A suite with goldens, and files of all kinds.
pub struct Workshop {
    pub folder: Folder,
    /// What stands in the place of each kind otherwise.
    whole: BTreeMap<String, Option<Vec<u8>>>,
}

/// The files with this ending in some folders of the repository, small ones only.
fn files(folders: &[&str], ending: &str) -> Vec<Vec<u8>> {
    let mut paths: Vec<PathBuf> = Vec::new();
    for folder in folders {
        let entries = std::fs::read_dir(root().join(folder)).unwrap();
        let found = entries.map(|entry| entry.unwrap().path());
        paths.extend(found.filter(|path| path.to_str().unwrap().ends_with(ending)));
    }
    paths.sort();
    let contents = paths.iter().map(|path| std::fs::read(path).unwrap());
    contents.filter(|bytes| bytes.len() <= 40_000).collect()
}

const IMAGES: [&str; 3] = ["fixtures/images", "fuzz/corpus/exr", "fuzz/corpus/png"];
const VOLUMES: [&str; 2] = ["fixtures/volumes/formats", "fixtures/volumes/hard"];

/// Files of the suite's families, in `fixtures/scenes` or `fixtures/cases`.
fn of_families(folder: &str) -> Vec<Vec<u8>> {
    let families = ["figures", "fog", "hard", "procedural", "smoke"];
    let folders = families.map(|family| format!("{folder}/{family}"));
    files(&folders.each_ref().map(String::as_str), ".toml")
}

fn scenes() -> Vec<Vec<u8>> {
    let scenes = of_families("fixtures/scenes");
    // Small things in the place of large ones, which take most of the time.
    let small = |scene: Vec<u8>| {
        let text = String::from_utf8(scene).unwrap();
        let text = text.replace("volumes/smoke.obj", "../fuzz/corpus/obj/cloud.obj");
        text.replace("meshes/knot.obj", "meshes/gem.obj")
            .into_bytes()
    };
    let mut scenes: Vec<Vec<u8>> = scenes.into_iter().map(small).collect();
    let tiny = Folder::with_scenes();
    scenes.push(tiny.read("scene.toml"));
    scenes.push(tiny.read("curve.toml"));
    scenes
}

/// The golden of `smoke/plain`, by its ending.
fn golden(ending: &str) -> Vec<Vec<u8>> {
    let suite = Folder::with_suite();
    let run = suite.volref("accept smoke/plain --reason first");
    assert_eq!(run.code, 0, "{}", run.stderr);
    vec![suite.read(&format!("golden/smoke/plain{ending}"))]
}

fn any(seeds: &[Vec<u8>], mutator: &mut Mutator) -> Vec<u8> {
    mutator.mutant(seeds)
}

/// Lengths and checksums of the chunks of a PNG made right, in one of two.
fn png(seeds: &[Vec<u8>], mutator: &mut Mutator) -> Vec<u8> {
    let mut bytes = mutator.mutant(seeds);
    if mutator.chance() {
        return bytes;
    }
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = u32::from_be_bytes(length.try_into().unwrap()) as usize;
        let Some(end) = at
            .checked_add(8)
            .and_then(|start| start.checked_add(length))
        else {
            break;
        };
        if bytes.len() < end + 4 {
            break;
        }
        let mut sum = flate2::Crc::new();
        sum.update(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&sum.sum().to_be_bytes());
        at = end + 4;
    }
    bytes
}

/// What is compressed is broken before it is, in one of two.
fn gzip(seeds: &[Vec<u8>], mutator: &mut Mutator) -> Vec<u8> {
    if mutator.chance() {
        return mutator.mutant(seeds);
    }
    let mut unpacked = Vec::new();
    flate2::read::GzDecoder::new(&seeds[0][..])
        .read_to_end(&mut unpacked)
        .unwrap();
    let broken = mutator.mutant(&[unpacked]);
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(&broken).unwrap();
    packed.finish().unwrap()
}

/// Two derivatives of blocks, one with its noise.
fn sensitivities() -> Vec<Vec<u8>> {
    let film = |value: f32| {
        let values = vec![[value; 3]; 4];
        Film::with_noise(2, 2, values.clone(), values, 128)
    };
    let layers = ["density", "surface[0].diffuse.reflectance"];
    let layers = layers.map(|name| (name.to_owned(), film(0.5)));
    let layered = LayeredFilm {
        comment: "scene 0 files 0".to_owned(),
        layers: layers.to_vec(),
    };
    vec![layered.to_exr().unwrap()]
}

fn read_scene(workshop: &Workshop, bytes: &[u8]) -> Result<(), String> {
    let text = String::from_utf8_lossy(bytes);
    // Files are named as from `fixtures/scenes/family`.
    let path = root().join("fixtures/scenes/smoke/mutant.toml");
    let _ = workshop;
    let scene = Scene::parse(&text, &path).map_err(|error| error.to_string())?;
    for panel in &scene.panels {
        let plan = Plan::new(panel);
        let _ = plan.canonical_text();
    }
    for format in ["mitsuba", "pbrt"] {
        let format: Format = format.parse().unwrap();
        let _ = export(&scene, format, "mutant", None).map_err(|refusal| refusal.to_string());
    }
    Ok(())
}

fn read_procedural_text(_: &Workshop, bytes: &[u8]) -> Result<(), String> {
    let text = String::from_utf8_lossy(bytes);
    let read = read_procedural("block.xml", &text);
    read.map(drop).map_err(|error| error.to_string())
}

fn read_manifest(workshop: &Workshop, bytes: &[u8]) -> Result<(), String> {
    let name = "manifests/fixtures/cases/smoke/plain.toml";
    workshop.folder.write(name, bytes);
    let suite = Suite::open(&workshop.folder.path("manifests")).unwrap();
    let selected = suite.select(&[]).map(drop);
    workshop.folder.remove(name);
    selected.map_err(|error| error.to_string())
}

fn read_golden(workshop: &Workshop, place: &str, bytes: &[u8]) -> Result<(), String> {
    let folder = &workshop.folder;
    folder.write(place, bytes);
    let suite = Suite::open(&folder.path("")).unwrap();
    let filter = ["smoke/plain".to_owned()];
    let case = suite.select(&filter).unwrap()[0];
    let golden = Golden::read(&Store::open(suite.golden_folder()), case);
    workshop.restore(place);
    golden.map(drop).map_err(|error| error.to_string())
}

fn read_volume(workshop: &Workshop, name: &str, bytes: &[u8]) -> Result<(), String> {
    workshop.folder.write(name, bytes);
    let options = LoadOptions::default();
    let loaded = load(&workshop.folder.path(name), &options);
    workshop.folder.remove(name);
    let grid = loaded.map_err(|error| error.to_string())?;
    assert!(grid.values().iter().all(|value| value.is_finite()));
    Ok(())
}

fn read_mesh(_: &Workshop, bytes: &[u8]) -> Result<(), String> {
    let mesh = Mesh::from_obj(bytes).map_err(|error| error.to_string())?;
    let _ = ClosedMesh::new(mesh).map_err(|error| error.to_string());
    Ok(())
}

fn read_picture(workshop: &Workshop, name: &str, bytes: &[u8]) -> Result<(), String> {
    workshop.folder.write(name, bytes);
    let picture = Picture::read(&workshop.folder.path(name));
    workshop.folder.remove(name);
    picture.map(drop).map_err(|error| error.to_string())
}

fn read_exr(workshop: &Workshop, bytes: &[u8]) -> Result<(), String> {
    let _ = Film::variance_from_exr(bytes).map_err(|error| error.to_string());
    read_picture(workshop, "read.exr", bytes)
}

macro_rules! volume {
    ($name:literal, $read:literal, $place:literal, $mutant:expr) => {
        volume!($name, concat!(".", $name), $read, $place, $mutant)
    };
    ($name:literal, $ending:expr, $read:literal, $place:literal, $mutant:expr) => {
        Kind {
            name: $name,
            seeds: |_| files(&VOLUMES, $ending),
            mutant: $mutant,
            read: |workshop, bytes| read_volume(workshop, $read, bytes),
            place: |_| $place.to_owned(),
            commands: &[
                concat!("info ", $place, " --json"),
                concat!("info ", $place, " --json=", $place),
            ],
            share: SHARE,
        }
    };
}

macro_rules! image {
    ($name:literal, $seeds:expr, $mutant:expr, $read:expr) => {
        Kind {
            name: $name,
            seeds: |_| files(&$seeds, concat!(".", $name)),
            mutant: $mutant,
            read: $read,
            place: |_| concat!("images/smoke/plain.", $name).to_owned(),
            commands: &[
                concat!("compare good.", $name, " images/smoke/plain.", $name),
                concat!("compare images/smoke/plain.", $name, " good.", $name),
                concat!(
                    "compare images/smoke/plain.",
                    $name,
                    " images/smoke/plain.",
                    $name,
                    " --json=images/smoke/plain.",
                    $name
                ),
                "validate smoke/plain --outputs images --json",
            ],
            share: SHARE,
        }
    };
}

macro_rules! golden {
    ($name:literal, $place:literal, $seeds:expr, $mutant:expr) => {
        Kind {
            name: $name,
            seeds: |_| $seeds,
            mutant: $mutant,
            read: |workshop, bytes| read_golden(workshop, $place, bytes),
            place: |_| $place.to_owned(),
            commands: &[
                "verify smoke/plain",
                "list --json",
                "validate smoke/plain --outputs images --junit=golden/smoke/plain.toml",
            ],
            share: SHARE,
        }
    };
}

macro_rules! results {
    ($name:literal, $folder:expr) => {
        Kind {
            name: $name,
            seeds: |workshop| kept::seeds(workshop, $folder),
            mutant: any,
            read: |workshop, bytes| kept::read_results(workshop, $folder, bytes),
            place: |workshop| kept::place(workshop, $folder),
            commands: &[
                "merge parts --json",
                "merge parts --report page",
                "merge trials --json",
                "merge trials --report page",
            ],
            share: LARGE_SHARE,
        }
    };
}

/// All of them.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "scene",
        seeds: |_| scenes(),
        mutant: any,
        read: read_scene,
        place: |_| "fixtures/scenes/smoke/mutant.toml".to_owned(),
        commands: &[
            "plan fixtures/scenes/smoke/mutant.toml --json",
            "plan fixtures/scenes/smoke/mutant.toml --json=fixtures/scenes/smoke/mutant.toml",
        ],
        share: SHARE,
    },
    Kind {
        name: "manifest",
        seeds: |_| of_families("fixtures/cases"),
        mutant: any,
        read: read_manifest,
        place: |_| "fixtures/cases/smoke/plain.toml".to_owned(),
        commands: &[
            "list",
            "verify smoke/plain",
            "list --json=fixtures/cases/smoke/plain.toml",
        ],
        share: SHARE,
    },
    golden!("golden.exr", "golden/smoke/plain.exr", golden(".exr"), any),
    golden!("golden.png", "golden/smoke/plain.png", golden(".png"), png),
    golden!(
        "golden.toml",
        "golden/smoke/plain.toml",
        golden(".toml"),
        any
    ),
    Kind {
        name: "sensitivities",
        seeds: |_| sensitivities(),
        mutant: any,
        read: |_, bytes| {
            let read = LayeredFilm::from_exr(bytes);
            read.map(drop).map_err(|error| error.to_string())
        },
        place: |_| "golden/sensitivities/fog/room.exr".to_owned(),
        commands: &[
            "verify fog/room",
            "validate fog/room --outputs images --explain 0 --json",
        ],
        share: SHARE,
    },
    results!("results", kept::RESULTS),
    results!("trials", kept::TRIALS),
    Kind {
        name: "procedural",
        seeds: |_| files(&["fuzz/corpus/procedural_xml"], ".xml"),
        mutant: any,
        read: read_procedural_text,
        place: |_| "mutant.xml".to_owned(),
        commands: &[
            "plan procedural.toml",
            "plan procedural.toml --json=mutant.xml",
        ],
        share: SHARE,
    },
    Kind {
        name: "mesh",
        seeds: |_| files(&["fixtures/meshes", "fuzz/corpus/obj"], ".obj"),
        mutant: any,
        read: read_mesh,
        place: |_| "mesh.obj".to_owned(),
        commands: &["plan mesh.toml", "plan mesh.toml --json=mesh.obj"],
        share: SHARE,
    },
    Kind {
        name: "obj",
        seeds: |_| files(&["fuzz/corpus/obj"], ".obj"),
        mutant: any,
        read: |workshop, bytes| read_volume(workshop, "read.obj", bytes),
        place: |_| "mutant.obj".to_owned(),
        commands: &[
            "info mutant.obj",
            "info mutant.obj --resolution 8 --json=mutant.obj",
        ],
        share: SHARE,
    },
    volume!("bin", "read.bin", "mutant.bin", any),
    volume!("vol", "read.vol", "mutant.vol", any),
    volume!("nrrd", "read.nrrd", "mutant.nrrd", any),
    volume!("nhdr", "read.nhdr", "mutant.nhdr", any),
    volume!("nii", "read.nii", "mutant.nii", any),
    volume!("nii.gz", "read.nii.gz", "mutant.nii.gz", gzip),
    volume!("raw.toml", "read.raw.toml", "mutant.raw.toml", any),
    volume!("mha", "read.mha", "mutant.mha", any),
    volume!("mhd", "read.mhd", "mutant.mhd", any),
    volume!("npz", "read.npz", "mutant.npz", any),
    volume!("npy-volume", ".npy", "read.volume.npy", "mutant.npy", any),
    Kind {
        name: "exr-header",
        seeds: |_| files(&IMAGES, ".exr"),
        mutant: exr_header::mutant,
        read: read_exr,
        place: |_| "images/smoke/plain.exr".to_owned(),
        commands: &[
            "compare good.exr images/smoke/plain.exr --json",
            "compare images/smoke/plain.exr good.exr",
            "validate smoke/plain --outputs images --json",
        ],
        share: SHARE,
    },
    image!("exr", IMAGES, any, read_exr),
    image!("png", IMAGES, png, |workshop, bytes| read_picture(
        workshop, "read.png", bytes
    )),
    image!("pfm", ["fixtures/images"], any, |workshop, bytes| {
        read_picture(workshop, "read.pfm", bytes)
    }),
    image!("npy", ["fixtures/images"], any, |workshop, bytes| {
        read_picture(workshop, "read.npy", bytes)
    }),
];

impl Workshop {
    pub fn new() -> Workshop {
        let folder = Folder::with_suite();
        let room = Folder::with_room("converged_samples = 128\nresolution = 0.9");
        for (name, contents) in room.files() {
            folder.write(&name, contents);
        }
        for words in [
            &["accept", "smoke/plain", "fog/room", "--reason", "first"][..],
            &[
                "verify",
                "smoke/plain",
                "--partition",
                "slice:1/1",
                "--results",
                kept::RESULTS,
            ],
            &[
                "selftest",
                "smoke/plain",
                "--quick",
                "--partition",
                "slice:1/1",
                "--results",
                kept::TRIALS,
            ],
        ] {
            let run = folder.volref(words);
            assert!([0, 6].contains(&run.code), "{}", run.stderr);
        }
        for folder_of_all in VOLUMES.iter().chain(&IMAGES[..1]) {
            for entry in std::fs::read_dir(root().join(folder_of_all)).unwrap() {
                let path = entry.unwrap().path();
                let name = path.file_name().unwrap().to_str().unwrap();
                // Beside a header, its data.
                if name.ends_with("raw") {
                    folder.write(name, std::fs::read(&path).unwrap());
                }
            }
        }
        for extension in ["exr", "png", "pfm", "npy"] {
            let seeds = match extension {
                "exr" => "float.exr",
                "png" => "rgb-8.png",
                "pfm" => "little.pfm",
                _ => "little-f4.npy",
            };
            let seed = root().join("fixtures/images").join(seeds);
            folder.write(&format!("good.{extension}"), std::fs::read(seed).unwrap());
        }
        folder.write("images/smoke/other.txt", "nothing");
        folder.write("manifests/fixtures/cases/smoke/none.txt", "nothing");
        let radiative = "[film]\nwidth = 4\nheight = 4\n[camera]\neye = [0, 0, 9]\n\
                         target = [0, 0, 0]\n[radiative]\nscattering = \"single\"\n\
                         environment = [1, 1, 1]\n";
        folder.write(
            "procedural.toml",
            format!(
                "{radiative}[[radiative.medium]]\nbox = {{ min = [-1, -1, -1], max = [1, 1, 1] }}\n\
                 procedural = {{ file = \"mutant.xml\" }}\n"
            ),
        );
        folder.write(
            "mesh.toml",
            format!(
                "{radiative}[[radiative.surface]]\nmesh = {{ file = \"mesh.obj\" }}\n\
                 diffuse = {{ reflectance = 0.5 }}\n"
            ),
        );
        let grey = Film::new(16, 16, vec![[0.5; 3]; 256]);
        folder.write_film("images/fog/room.exr", &grey);
        let mut workshop = Workshop {
            folder,
            whole: BTreeMap::new(),
        };
        let places = KINDS.iter().map(|kind| (kind.place)(&workshop));
        let whole = places.map(|place| {
            let bytes = std::fs::read(workshop.folder.path(&place)).ok();
            (place, bytes)
        });
        workshop.whole = whole.collect();
        workshop
    }

    /// The place of the kind below `folder` with this extension.
    pub fn place(&self, folder: &str, extension: &str) -> &str {
        let mut places = self.whole.keys();
        let is_there = |of: &&String| of.starts_with(folder) && of.ends_with(extension);
        places.find(is_there).unwrap()
    }

    /// Puts what stands there otherwise back, or takes away what is there.
    pub fn restore(&self, place: &str) {
        match &self.whole[place] {
            Some(bytes) => self.folder.write(place, bytes),
            None => self.folder.remove(place),
        }
    }
}
