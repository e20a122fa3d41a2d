//! Loading grids from a warm disk: what it costs in time and memory as they grow.
//!
//! `cargo bench --bench volume_files`. First a table: each grid is loaded by a process of its own,
//! which reports its peak of memory (Linux only) beside the time; then the usual measurements.
//! Read ratios between rows of one run, not absolute times: machines differ. Needs 1.5 GB of
//! memory and as much room for temporary files.

use divan::Bencher;
use divan::counter::BytesCount;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::time::Instant;
use tempfile::TempDir;
use volref::volume::{LoadOptions, load, vol_bytes};

const SIZES: [usize; 4] = [64, 128, 256, 512];

/// Set for the child that loads one file and reports.
const ONE_FILE: &str = "VOLREF_BENCH_FILE";

fn main() {
    if let Ok(path) = std::env::var(ONE_FILE) {
        return report(Path::new(&path));
    }
    // cargo test --benches runs this without timing anything.
    if std::env::args().any(|argument| argument == "--bench") {
        table();
    }
    divan::main();
    // What is static is never dropped.
    let _ = std::fs::remove_dir_all(FOLDER.path());
}

static FOLDER: LazyLock<TempDir> =
    LazyLock::new(|| tempfile::tempdir().expect("a folder for the grids"));

/// A Mitsuba volume of `size`³ nodes, just written and hence warm.
fn file(size: usize) -> PathBuf {
    let path = FOLDER.path().join(format!("{size}.vol"));
    if !path.exists() {
        let values: Vec<f32> = (0..size.pow(3)).map(|i| (i % 97) as f32).collect();
        let corners = [[0.0; 3], [(size - 1) as f32; 3]];
        let bytes = vol_bytes([size as i32; 3], corners, &values);
        std::fs::write(&path, bytes).expect("room for it");
    }
    path
}

fn bytes_of(size: usize) -> usize {
    4 * size * size * size
}

fn table() {
    println!("nodes    MiB   seconds   GiB/s   memory/size");
    for size in SIZES {
        let program = std::env::current_exe().expect("this program");
        let child = Command::new(program).env(ONE_FILE, file(size)).output();
        let child = child.expect("a process of our own");
        let said = String::from_utf8_lossy(&child.stdout);
        let mut numbers = said.split_whitespace().map(str::parse::<f64>);
        let mut next = || numbers.next().and_then(Result::ok);
        let (Some(seconds), Some(before), Some(peak)) = (next(), next(), next()) else {
            panic!("the process said {said:?}")
        };
        let bytes = bytes_of(size) as f64;
        println!(
            "{size:>4}³  {:>5}   {seconds:>7.4}   {:>5.2}   {:>11.3}",
            bytes / f64::from(1 << 20),
            bytes / f64::from(1 << 30) / seconds,
            (peak - before) / bytes
        );
    }
}

/// Loads a file; prints seconds, and the peak of memory before and after in bytes.
fn report(path: &Path) {
    let before = peak_of_memory();
    let start = Instant::now();
    let grid = load(path, &LoadOptions::default()).expect("a grid");
    let seconds = start.elapsed().as_secs_f64();
    divan::black_box(&grid);
    println!("{seconds} {before} {}", peak_of_memory());
}

/// The most memory this process ever held, in bytes; NaN where the system does not tell.
fn peak_of_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes = line.and_then(|line| line.trim().split(' ').next()?.parse().ok());
    kibibytes.map_or(f64::NAN, |kibibytes: f64| 1024.0 * kibibytes)
}

#[divan::bench(args = SIZES, sample_count = 5)]
fn load_vol(bencher: Bencher, size: usize) {
    let path = file(size);
    bencher
        .counter(BytesCount::new(bytes_of(size)))
        .bench_local(|| load(&path, &LoadOptions::default()));
}
