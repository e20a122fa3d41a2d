//! Inputs of every kind, broken at random: each is read or refused in words, soon, with bounded
//! memory and nothing overwritten.
//!
//! Most are given to the library, a share to the command. `VOLREF_MUTANTS` is how many are tried,
//! `VOLREF_MUTANTS_SEED` which; by default always the same few. `scripts/mutated-inputs.sh` tries
//! many, with a limit on memory, and `VOLREF_MUTANTS_COMMANDS` times as few commands. What fails is kept in
//! `target/mutants`.

mod exr_header;
mod kept;
mod kinds;
mod mutation;
#[path = "../library/common/watch.rs"]
mod watch;

use kinds::{KINDS, Kind, Workshop};
use mutation::Mutator;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{Seek, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Inputs tried unless `VOLREF_MUTANTS` asks for another number.
const MUTANTS: u64 = 2_000;

/// Longer than this no command may take: a hang, not slowness.
const PATIENCE: Duration = Duration::from_secs(120);

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

/// What became of the inputs of a kind.
#[derive(Default)]
struct Tally {
    accepted: u64,
    refused: u64,
    commands: u64,
    reading: Duration,
    slowest: Duration,
    running: Duration,
}

/// Files that a command may change: most change none.
fn may_change(command: &str) -> &'static [&'static str] {
    match command.split(' ').next() {
        Some("accept") => &["golden/fog/", ".volref/"],
        Some("merge") => &["page/"],
        _ => &[],
    }
}

#[test]
fn broken_inputs_are_read_or_refused() {
    let mutants = number("VOLREF_MUTANTS").unwrap_or(MUTANTS);
    let seed = number("VOLREF_MUTANTS_SEED").unwrap_or(1);
    let fewer = number("VOLREF_MUTANTS_COMMANDS").unwrap_or(1);
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/mutants");
    std::fs::create_dir_all(&kept).unwrap();
    let workshop = Workshop::new();
    let seeds = KINDS.iter().map(|kind| (kind.seeds)(&workshop));
    let seeds: Vec<Vec<Vec<u8>>> = seeds.collect();
    for (kind, seeds) in KINDS.iter().zip(&seeds) {
        assert!(!seeds.is_empty(), "{} has nothing to begin with", kind.name);
    }
    let under_way = kept.join(format!("under-way-{seed}"));
    // Stays open: to close a file that was cut short waits for the disk.
    let mut under_way = File::create(under_way).unwrap();
    let mut tallies: BTreeMap<&str, Tally> = BTreeMap::new();
    let mut failures = Vec::new();
    for index in 0..mutants {
        let place = index as usize % KINDS.len();
        let kind = &KINDS[place];
        let mut mutator = Mutator::new(seed, index);
        let bytes = (kind.mutant)(&seeds[place], &mut mutator);
        let tally = tallies.entry(kind.name).or_default();
        let file = kept.join(format!("{}-{seed}-{index}", kind.name));
        // Before it is read: memory that runs out, or a stack, ends this process too.
        under_way.set_len(0).unwrap();
        under_way.rewind().unwrap();
        under_way.write_all(&bytes).unwrap();
        // It is in `target/mutants/under-way-SEED`. Its command has a limit of its own.
        let name = format!("{} {index} of seed {seed}", kind.name);
        let _watched = watch::during(name, 2 * PATIENCE);
        let start = Instant::now();
        let read = catch_unwind(AssertUnwindSafe(|| (kind.read)(&workshop, &bytes)));
        tally.reading += start.elapsed();
        tally.slowest = tally.slowest.max(start.elapsed());
        match read {
            Ok(Ok(())) => tally.accepted += 1,
            Ok(Err(words)) if !words.trim().is_empty() => tally.refused += 1,
            Ok(Err(_)) => failures.push(keep(&file, &bytes, "refused without a word")),
            Err(_) => failures.push(keep(&file, &bytes, "panicked")),
        }
        if (index / KINDS.len() as u64).is_multiple_of(kind.share * fewer) {
            tally.commands += 1;
            let start = Instant::now();
            if let Err(what) = by_command(&workshop, kind, &bytes, &mut mutator) {
                failures.push(keep(&file, &bytes, &what));
            }
            tally.running += start.elapsed();
        }
    }
    println!(
        "{:<13} {:>9} {:>9} {:>10} {:>10} {:>9} {:>10}",
        "kind", "accepted", "refused", "reading, s", "slowest, s", "commands", "running, s"
    );
    for (name, tally) in &tallies {
        let Tally {
            accepted,
            refused,
            commands,
            ..
        } = tally;
        let [reading, slowest, running] =
            [tally.reading, tally.slowest, tally.running].map(|it| it.as_secs_f64());
        println!(
            "{name:<13} {accepted:>9} {refused:>9} {reading:>10.1} {slowest:>10.2} {commands:>9} {running:>10.1}"
        );
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    // Were none refused, or all, that would say little of reading, or of refusing.
    if mutants >= MUTANTS {
        for (name, tally) in &tallies {
            assert!(tally.refused > 0, "no {name} was refused");
        }
        assert!(tallies.values().any(|tally| tally.accepted > 0));
    }
}

fn keep(file: &PathBuf, bytes: &[u8], what: &str) -> String {
    std::fs::write(file, bytes).unwrap();
    format!("{}: {what}", file.display())
}

/// Gives the input to a command of its kind: whatever it says, it ends by itself with a code of
/// ours, and all files are as they were.
fn by_command(
    workshop: &Workshop,
    kind: &Kind,
    bytes: &[u8],
    mutator: &mut Mutator,
) -> Result<(), String> {
    let folder = &workshop.folder;
    let place = (kind.place)(workshop);
    folder.write(&place, bytes);
    let command = kind.commands[mutator.below(kind.commands.len())];
    let words: Vec<&str> = command.split(' ').collect();
    let before = folder.files();
    let mut child = folder
        .command(&words)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Pipes are read meanwhile: a full one would be waited for.
    let pipes = [
        std::thread::spawn({
            let mut pipe = child.stdout.take().unwrap();
            move || std::io::copy(&mut pipe, &mut std::io::sink()).map(|_| String::new())
        }),
        std::thread::spawn({
            let mut pipe = child.stderr.take().unwrap();
            move || std::io::read_to_string(&mut pipe)
        }),
    ];
    let end = Instant::now() + PATIENCE;
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if Instant::now() > end {
            child.kill().unwrap();
            return Err(format!("`{command}` does not end"));
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let [_, stderr] = pipes.map(|pipe| pipe.join().unwrap());
    let after = folder.files();
    let names: BTreeSet<&String> = before.keys().chain(after.keys()).collect();
    let changed = names
        .into_iter()
        .filter(|name| before.get(*name) != after.get(*name));
    let mut wrong = None;
    for name in changed {
        if !may_change(command).iter().any(|of| name.starts_with(of)) {
            wrong = Some(name.clone());
        }
        // The next input finds all files as they should be.
        match before.get(name) {
            Some(bytes) => folder.write(name, bytes),
            None => folder.remove(name),
        }
    }
    workshop.restore(&place);
    match (status.code(), stderr) {
        (None | Some(101), _) => Err(format!("`{command}` ended with {status}")),
        (Some(7..), _) => Err(format!("`{command}` ended with {status}")),
        (_, Ok(said)) if said.contains("panicked") => Err(format!("`{command}`: {said}")),
        _ => wrong.map_or(Ok(()), |name| Err(format!("`{command}` changed {name}"))),
    }
}
