//! The last test program, by its name: prints what the others did not try, as a program or package is missing.
//!
//! No harness of tests, which would keep the words to itself.

mod needs;

use std::path::Path;

fn main() {
    if std::env::args().any(|argument| argument == "--list") {
        return;
    }
    let records = std::fs::read_dir(needs::records()).into_iter().flatten();
    let mut lines: Vec<String> = records
        .flatten()
        .filter_map(|record| std::fs::read_to_string(record.path()).ok())
        .collect();
    lines.sort();
    // For scripts/check.sh, which repeats it.
    let summary = Path::new(env!("CARGO_TARGET_TMPDIR")).join("not-tried.txt");
    std::fs::write(summary, lines.concat()).unwrap();
    let _ = std::fs::remove_dir_all(needs::records());
    if lines.is_empty() {
        println!("\nno test was left out");
        return;
    }
    println!("\nnot tried, as something that is needed is missing:");
    for line in lines {
        print!("    needs {line}");
    }
}
