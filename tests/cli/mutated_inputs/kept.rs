//! Files that one process leaves for another: units of goldens, and results of cases. A hash stands before
//! them, which is made right again: most damage would end there.

use super::kinds::Workshop;
use super::mutation::Mutator;
use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use std::io::{Read, Write};
use volref::film::Film;
use volref::runs::{KeptResult, ResultFolder, UnitFile};

/// Folder of the workshop with results of `verify`.
pub const RESULTS: &str = "parts";
/// Folder of the workshop with results of `selftest`.
pub const TRIALS: &str = "trials";

/// `hash`, a line of JSON, and the rest.
fn parts(bytes: &[u8]) -> Option<[&[u8]; 2]> {
    let mut lines = bytes.splitn(3, |&byte| byte == b'\n').skip(1);
    Some([lines.next()?, lines.next()?])
}

fn with_hash(head: &[u8], body: &[u8]) -> Vec<u8> {
    let rest = [head, b"\n", body].concat();
    let hash = blake3::hash(&rest).to_hex();
    [hash.as_bytes(), b"\n", &rest].concat()
}

/// Damage behind the hash; the hash itself in one of sixteen.
pub fn unit(seeds: &[Vec<u8>], mutator: &mut Mutator) -> Vec<u8> {
    if mutator.below(16) == 0 {
        return mutator.mutant(seeds);
    }
    // The head of one and the film of another, or damage in either.
    let [one, other] = [mutator.one_of(seeds), mutator.one_of(seeds)];
    let [head, film] = [parts(one).unwrap()[0], parts(other).unwrap()[1]];
    match mutator.below(4) {
        0 => with_hash(head, film),
        1 => with_hash(&mutator.mutant(&[head.to_vec()]), film),
        2 => with_hash(head, &mutator.speckled(film)),
        _ => with_hash(head, &mutator.mutant(&[film.to_vec()])),
    }
}

/// Damage in what is compressed, mostly.
pub fn result(seeds: &[Vec<u8>], mutator: &mut Mutator) -> Vec<u8> {
    let seed = mutator.one_of(seeds);
    let [head, body] = parts(seed).unwrap();
    match mutator.below(16) {
        0 => mutator.mutant(seeds),
        1 => with_hash(&mutator.mutant(&[head.to_vec()]), body),
        2 => with_hash(head, &mutator.mutant(&[body.to_vec()])),
        _ => {
            let mut packed = Vec::new();
            DeflateDecoder::new(body).read_to_end(&mut packed).unwrap();
            let broken = if mutator.chance() {
                mutator.speckled(&packed)
            } else {
                mutator.mutant(&[packed])
            };
            let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(&broken).unwrap();
            // The head states the bytes that it unpacks to.
            let mut head: serde_json::Value = serde_json::from_slice(head).unwrap();
            head["unpacked"] = broken.len().into();
            with_hash(head.to_string().as_bytes(), &encoder.finish().unwrap())
        }
    }
}

/// Files below `folder` of the workshop with this extension.
fn files(workshop: &Workshop, folder: &str, extension: &str) -> Vec<String> {
    let ending = format!(".{extension}");
    let files = workshop.folder.files().into_keys();
    let files = files.filter(|name| name.starts_with(folder) && name.ends_with(&ending));
    files.collect()
}

/// The one of them that mutants take the place of.
pub fn place(workshop: &Workshop, folder: &str, extension: &str) -> String {
    files(workshop, folder, extension).swap_remove(0)
}

pub fn seeds(workshop: &Workshop, folder: &str, extension: &str) -> Vec<Vec<u8>> {
    let files = files(workshop, folder, extension).into_iter();
    files.map(|name| workshop.folder.read(&name)).collect()
}

/// The unit of the converged rendering, which is the picture of a golden.
pub fn unit_place(workshop: &Workshop) -> String {
    let mut files = files(workshop, ".volref/units", "unit").into_iter();
    let is_converged = |name: &String| {
        let bytes = workshop.folder.read(name);
        let head = parts(&bytes).unwrap()[0];
        String::from_utf8_lossy(head).contains("converged")
    };
    files.find(is_converged).unwrap()
}

/// Units as they are, and films that they are not of: of other sizes, without noise, with other samples.
pub fn units(workshop: &Workshop) -> Vec<Vec<u8>> {
    let mut units = seeds(workshop, ".volref/units", "unit");
    let converged = workshop.folder.read(&unit_place(workshop));
    let [head, _] = parts(&converged).unwrap();
    for (width, height) in [(16, 16), (16, 8), (8, 16), (17, 16), (1, 1), (16, 64)] {
        let values = vec![[0.5; 3]; width * height];
        for samples in [2, 4, 128] {
            let film = Film::with_noise(width, height, values.clone(), values.clone(), samples);
            units.push(with_hash(head, &film.to_exr().unwrap()));
        }
        let film = Film::new(width, height, values);
        units.push(with_hash(head, &film.to_exr().unwrap()));
    }
    units
}

pub fn read_unit_of(workshop: &Workshop, bytes: &[u8]) -> Result<(), String> {
    workshop.folder.write("read.unit", bytes);
    let read = UnitFile::read(&workshop.folder.path("read.unit")).and_then(|file| file.film());
    workshop.folder.remove("read.unit");
    read.map(drop)
}

/// The results of `folder` while `bytes` stand in place of those with this extension.
pub fn read_results(
    workshop: &Workshop,
    folder: &str,
    extension: &str,
    bytes: &[u8],
) -> Result<(), String> {
    let place = workshop.place(folder, extension);
    workshop.folder.write(place, bytes);
    let results = ResultFolder::open(workshop.folder.path(folder));
    let read = || {
        for run in results.runs()?.into_keys() {
            results.trials(&run, "smoke/plain")?;
            match results.get(&run, "smoke/plain", |_| true) {
                KeptResult::Damaged(reason) => return Err(reason),
                KeptResult::Judged(judged) => match judged.result.notes.last() {
                    Some(note) if note.contains("are missing") => return Err(note.clone()),
                    _ => {}
                },
                KeptResult::PassedOver | KeptResult::Missing => {}
            }
        }
        Ok(())
    };
    let read = read();
    workshop.restore(place);
    read
}
