//! Inputs of every kind, broken at random: each is read or refused in words, soon, with bounded
//! memory and nothing overwritten.
//!
//! Most are given to the library, a share to the command. `VOLREF_MUTANTS` is how many are tried,
//! `VOLREF_MUTANTS_SEED` which; by default always the same few. `scripts/mutated-inputs.sh` tries
//! many, with a limit on memory. What fails is kept in `target/mutants`.

mod kinds;
mod mutation;
#[path = "../library/common/watch.rs"]
mod watch;

use kinds::{KINDS, Kind, Workshop};
use mutation::Mutator;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Inputs tried unless `VOLREF_MUTANTS` asks for another number.
const MUTANTS: u64 = 2_000;

/// One in so many is given to the command as well: that takes as long as many in the library.
const COMMANDS: u64 = 40;

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
    slowest: Duration,
}

#[test]
fn broken_inputs_are_read_or_refused() {
    let mutants = number("VOLREF_MUTANTS").unwrap_or(MUTANTS);
    let seed = number("VOLREF_MUTANTS_SEED").unwrap_or(1);
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/mutants");
    std::fs::create_dir_all(&kept).unwrap();
    let workshop = Workshop::new();
    let seeds: Vec<Vec<Vec<u8>>> = KINDS.iter().map(|kind| (kind.seeds)()).collect();
    for (kind, seeds) in KINDS.iter().zip(&seeds) {
        assert!(!seeds.is_empty(), "{} has nothing to begin with", kind.name);
    }
    let mut tallies: BTreeMap<&str, Tally> = BTreeMap::new();
    let mut failures = Vec::new();
    for index in 0..mutants {
        let place = index as usize % KINDS.len();
        let kind = &KINDS[place];
        let mut mutator = Mutator::new(seed, index);
        let bytes = (kind.repair)(mutator.mutant(&seeds[place]), &mut mutator);
        let tally = tallies.entry(kind.name).or_default();
        let file = kept.join(format!("{}-{seed}-{index}", kind.name));
        // Before it is read: memory that runs out, or a stack, ends this process too.
        std::fs::write(kept.join("under-way"), &bytes).unwrap();
        // In `target/mutants/under-way`. Its command has a limit of its own.
        let name = format!("{} {index} of seed {seed}", kind.name);
        let _watched = watch::during(name, 2 * PATIENCE);
        let start = Instant::now();
        let read = catch_unwind(AssertUnwindSafe(|| (kind.read)(&workshop, &bytes)));
        tally.slowest = tally.slowest.max(start.elapsed());
        match read {
            Ok(Ok(())) => tally.accepted += 1,
            Ok(Err(words)) if !words.trim().is_empty() => tally.refused += 1,
            Ok(Err(_)) => failures.push(keep(&file, &bytes, "refused without a word")),
            Err(_) => failures.push(keep(&file, &bytes, "panicked")),
        }
        if (index / KINDS.len() as u64).is_multiple_of(COMMANDS) {
            tally.commands += 1;
            if let Err(what) = by_command(&workshop, kind, &bytes, &mut mutator) {
                failures.push(keep(&file, &bytes, &what));
            }
        }
    }
    println!(
        "{:<12} {:>9} {:>9} {:>9} {:>11}",
        "kind", "accepted", "refused", "commands", "slowest, s"
    );
    for (name, tally) in &tallies {
        let Tally {
            accepted,
            refused,
            commands,
            slowest,
        } = tally;
        let slowest = slowest.as_secs_f64();
        println!("{name:<12} {accepted:>9} {refused:>9} {commands:>9} {slowest:>11.2}");
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
    folder.write(kind.place, bytes);
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
    let unchanged = folder.files() == before;
    // The next input of another kind finds this place as it should be.
    workshop.restore(kind);
    match (status.code(), stderr) {
        (None | Some(101), _) => Err(format!("`{command}` ended with {status}")),
        (Some(7..), _) => Err(format!("`{command}` ended with {status}")),
        (_, Ok(said)) if said.contains("panicked") => Err(format!("`{command}`: {said}")),
        _ if !unchanged => Err(format!("`{command}` changed a file")),
        _ => Ok(()),
    }
}
