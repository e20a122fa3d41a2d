//! Renderers that stay, `validate --serve`: the protocol, and what they do wrong.

use crate::folder::{Folder, Run};
use serde_json::Value;
use std::path::Path;

/// The loop of a renderer whose images are the goldens: it writes its number to `started`, and says `bye` at the
/// end. `$case`, `$output` and `$line` are there for what is done with a request, and `right` answers it well.
fn renderer(begin: &str, request: &str) -> String {
    format!(
        "right() {{ cp golden/$case.exr $output; echo \"{{\\\"image\\\":\\\"$output\\\"}}\"; }}\n\
         echo $$ >> started\n\
         {begin}\n\
         while IFS= read -r line; do\n\
         case=$(printf %s \"$line\" | sed 's/.*\"case\":\"\\([^\"]*\\)\".*/\\1/')\n\
         output=$(printf %s \"$line\" | sed 's/.*\"output\":\"\\([^\"]*\\)\".*/\\1/')\n\
         {request}\n\
         done\n\
         echo bye >> left\n"
    )
}

/// A suite with goldens, and such a renderer.
fn with_renderer(begin: &str, request: &str) -> Folder {
    let folder = Folder::with_goldens();
    folder.write("renderer.sh", renderer(begin, request));
    folder
}

const SERVE: [&str; 3] = ["validate", "--serve", "sh renderer.sh"];

fn validate(folder: &Folder, arguments: &[&str]) -> Run {
    let run = folder.volref(&[&SERVE[..], &["--explain=0"], arguments].concat());
    assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
    run
}

/// How many programs were started.
fn started(folder: &Folder) -> usize {
    folder.text("started").lines().count()
}

#[test]
fn one_program_renders_all_cases() {
    let folder = with_renderer("echo warming up", "echo on $case; echo err >&2; right");
    let run = validate(&folder, &["--report", "report"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert!(run.stdout.contains("4 cases: 4 passed"), "{}", run.stdout);
    assert_eq!(started(&folder), 1);
    assert_eq!(
        folder.text("left"),
        "bye\n",
        "it leaves when its requests end"
    );
    // What it printed is shown, and how to ask again.
    let page = folder.text("report/index.html");
    for words in ["warming up", "on smoke", "| sh renderer.sh", "--serve"] {
        assert!(page.contains(words), "{words}");
    }

    folder.remove("started");
    let run = validate(&folder, &["--jobs", "2", "--keep", "kept"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert!((1..=2).contains(&started(&folder)));
    let again = folder.volref("validate --outputs kept");
    assert_eq!(again.code, 0, "{}", again.stdout);
}

/// Programs of some systems begin their output with a byte order mark.
#[test]
fn an_answer_behind_a_byte_order_mark_is_read() {
    let folder = with_renderer("printf '\\357\\273\\277'", "right");
    let run = validate(&folder, &["--timeout", "60"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert_eq!(started(&folder), 1);
}

#[test]
fn requests_hold_what_the_command_names() {
    let folder = with_renderer("", "printf '%s\\n' \"$line\" >> requests; right");
    let of = |placeholders: &str| {
        let _ = std::fs::remove_file(folder.path("requests"));
        let command = format!("sh renderer.sh {placeholders}");
        let arguments = [
            "smoke/plain",
            "--serve",
            &command,
            "--spp",
            "9",
            "--seed",
            "7",
        ];
        let run = folder.volref(&[&["validate"], &arguments[..]].concat());
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        let requests = folder.text("requests");
        assert_eq!(requests.lines().count(), 1);
        serde_json::from_str::<Value>(&requests).unwrap()
    };
    let keys = |request: &Value| {
        let request = request.as_object().unwrap();
        request.keys().cloned().collect::<Vec<_>>().join(" ")
    };
    assert_eq!(keys(&of("")), "case output volref");
    let request = of(
        "{scene} {width} {height} {spp} {seed} {exposure} {step} {rate} {export:bundle} {case} {output}",
    );
    assert_eq!(
        keys(&request),
        "case export:bundle exposure height output rate scene seed spp step volref width"
    );
    for (key, value) in [
        ("volref", 1),
        ("width", 12),
        ("height", 10),
        ("spp", 9),
        ("seed", 7),
    ] {
        assert_eq!(request[key], value, "{key}");
    }
    assert_eq!(request["case"], "smoke/plain");
    assert!(request["step"].as_f64().unwrap() > 0.0);
    assert!(request["rate"].as_f64().unwrap() > 0.0);
    assert_eq!(request["exposure"].as_f64(), Some(0.0));
    let name = |key: &str| Path::new(request[key].as_str().unwrap()).to_owned();
    assert!(name("scene").is_absolute() && name("scene").exists());
    assert!(name("export:bundle").ends_with("plain.json"));
    assert!(name("output").ends_with("smoke/plain.exr"));

    // Of a curve there is no step.
    let arguments = ["plots/curve", "--serve", "sh renderer.sh {step}"];
    let run = folder.volref(&[&["validate"], &arguments[..]].concat());
    run.prints(4, "no classified volume");
}

#[test]
fn a_case_of_the_limit_is_asked_for_with_three_steps() {
    let folder = Folder::new();
    let volref = env!("CARGO_BIN_EXE_volref");
    let draw = format!(
        "step=$(printf %s \"$line\" | sed 's/.*\"step\":\\([^,}}]*\\).*/\\1/')\n\
         scene=$(printf %s \"$line\" | sed 's/.*\"scene\":\"\\([^\"]*\\)\".*/\\1/')\n\
         {volref} render $scene --step $step -o $output; echo \"{{\\\"image\\\":\\\"$output\\\"}}\""
    );
    folder.write("renderer.sh", renderer("", &draw));
    let suite = env!("CARGO_MANIFEST_DIR");
    let run = folder.volref(&[
        "validate",
        "limit/plume",
        "--suite",
        suite,
        "--serve",
        "sh renderer.sh {scene} {step}",
        "--json",
    ]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let case = run.json()["cases"][0].clone();
    assert_eq!(case["gate"], "refinement", "{case}");
    assert_eq!(started(&folder), 1);
}

/// What is said of the case `smoke/plain` by the faults of a renderer, which answers the others well.
#[test]
fn faults_are_of_one_case() {
    let huge = "head -c 300000000 /dev/zero | tr '\\0' x";
    let too_long = format!("printf '{{'; {huge}; echo");
    for (fault, said, programs) in [
        ("exit 3", "the renderer failed: exit status: 3", 2),
        (
            "echo 'error: no volume' >&2; for i in 1 2 3 4; do echo retry >&2; done; kill -SEGV $$",
            "; its last output:\nerror: no volume\nretry",
            2,
        ),
        ("exit 0", "the renderer ended before it answered", 2),
        ("sleep 1000", "did not answer within 2 s and was ended", 2),
        // An answer without its newline.
        (
            "printf '{\"image\":\"%s\"}' $output; sleep 1000",
            "an answer ends with a newline",
            2,
        ),
        ("echo '{hello'", "): {hello", 2),
        ("echo '{}'", "exactly one of image, error and cannot", 2),
        ("echo '{\"image\": 7}'", "cannot be read", 2),
        ("printf '{\\000\\033[31m\\377}\\n'", "): {[31m", 2),
        (&too_long, "longer than 64 KiB", 2),
        (
            "echo '{\"image\":\"/etc/passwd\"}'",
            "wrote /etc/passwd instead of",
            2,
        ),
        (
            "echo \"{\\\"image\\\":\\\"$output\\\"}\"",
            "did not write",
            1,
        ),
        (
            "echo boom >&2; printf '%s\\n' '{\"error\":\"no\\u001b such\\nlight\"}'",
            "the renderer failed: no such light",
            1,
        ),
        (
            "echo '{\"cannot\":\"spheres\"}'",
            "not rendered: spheres",
            1,
        ),
    ] {
        let folder = with_renderer(
            "",
            &format!("case $case in smoke/plain) {fault};; *) right;; esac"),
        );
        let run = validate(&folder, &["--timeout", "2", "--json"]);
        assert_eq!(run.code, 4, "{fault}: {}{}", run.stdout, run.stderr);
        for case in run.json()["cases"].as_array().unwrap() {
            let expected = match case["name"] == "smoke/plain" {
                true if said.starts_with("not") || said.starts_with("did not write") => "missing",
                true => "error",
                false => "pass",
            };
            assert_eq!(case["verdict"], expected, "{fault}: {case}");
            let reason = case["reason"].as_str().unwrap();
            assert!(
                expected == "pass" || reason.contains(said),
                "{fault}: {reason:?}"
            );
            assert!(reason.len() < 2000, "{fault}: {}", reason.len());
        }
        assert_eq!(started(&folder), programs, "{fault}");
    }
}

/// The image of a renderer that says too much stands; if it says that later, it is no answer to the next request.
#[test]
fn answers_that_nobody_asked_for() {
    let folder = with_renderer(
        "",
        "answer=$(right); printf '%s\\n%s\\n' \"$answer\" \"$answer\"",
    );
    let run = validate(&folder, &["--json"]);
    let cases = run.json()["cases"].clone();
    assert_eq!(cases[0]["verdict"], "pass", "{cases}");
    let mut told = 0;
    for case in cases.as_array().unwrap() {
        let said = format!("{}{}", case["notes"], case["reason"]);
        // The latter where a machine is so slow that it comes after the next request.
        let words = ["answered without being asked: {", " instead of "];
        told += usize::from(words.iter().any(|words| said.contains(words)));
        assert_ne!(case["verdict"], "fail", "{case}");
    }
    assert!(told > 0, "{cases}");

    let folder = with_renderer("echo '{\"image\":\"first\"}'", "right");
    let run = validate(&folder, &["smoke/plain"]);
    run.prints(4, "wrote first");

    // An answer at the end of all counts, with or without a newline.
    let last = "cp golden/$case.exr $output; printf '{\"image\":\"%s\"}' $output; exit";
    let folder = with_renderer("", last);
    let run = validate(&folder, &["smoke/plain"]);
    assert_eq!(run.code, 0, "{}", run.stdout);
}

#[test]
fn a_case_that_cannot_be_said_can_be_skipped() {
    let folder = with_renderer(
        "",
        "case $case in plots/*) echo '{\"cannot\":\"say curves\"}';; *) right;; esac",
    );
    let run = validate(&folder, &["--only-present"]);
    run.prints(0, "3 cases: 3 passed");
}

/// 200 MB on each stream before an answer fill no memory, and answers without end neither.
#[cfg(target_os = "linux")]
#[test]
fn hostile_output_takes_no_memory() {
    let flood = "head -c 200000000 /dev/zero | tr '\\0' x";
    let peak = "sed -n 's/^VmHWM:[^0-9]*\\([0-9]*\\).*/\\1/p' /proc/$PPID/status > peak";
    let folder = with_renderer("", &format!("{flood}; echo; {flood} >&2; {peak}; right"));
    let run = validate(&folder, &["smoke/plain"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let peak: u64 = folder.text("peak").trim().parse().unwrap();
    assert!(peak < 100_000, "{peak} kB");

    let folder = with_renderer("", "right; yes '{}'");
    let run = validate(&folder, &["smoke/plain"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
}

/// A renderer that does not hear that its requests end, and what it started.
#[cfg(target_os = "linux")]
#[test]
fn nothing_outlives_the_command() {
    let folder = with_renderer(
        "trap '' TERM INT HUP",
        "right; sleep 1000 & echo $! > sleeper; wait",
    );
    let run = validate(&folder, &["smoke/plain"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    for name in ["started", "sleeper"] {
        let status = format!("/proc/{}/status", folder.text(name).trim());
        // It is gone, or waits as a zombie for whoever inherits it.
        let is_over = |status: &str| status.contains("State:\tZ");
        let gone = || std::fs::read_to_string(&status).map_or(true, |status| is_over(&status));
        let start = std::time::Instant::now();
        while !gone() {
            assert!(
                start.elapsed() < std::time::Duration::from_secs(120),
                "{name}"
            );
        }
    }
    assert!(!folder.path("left").exists());
}

#[test]
fn usage() {
    let folder = Folder::with_goldens();
    for (arguments, said) in [
        (
            &["--serve", "r --step={step}"][..],
            "\"--step={step}\": the placeholders of --serve are words of their own",
        ),
        (&["--serve", "r {otput}"], "unknown placeholder {otput}"),
        (&["--serve", " "], "there is no command"),
        (&["--serve", "{output}"], "there is no command"),
        (&["--serve", "r 'x"], "unclosed quote"),
        (
            &["--serve", "r", "--run", "r {output}"],
            "cannot be used with",
        ),
        (&["--serve", "r", "--outputs", "."], "cannot be used with"),
        (
            &["--serve", "r", "--decide", "--format", "png"],
            "--decide needs linear radiance",
        ),
        (&["--serve", "r", "--keep", "golden"], "holds goldens"),
    ] {
        let run = folder.volref(&[&["validate"], arguments].concat());
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        assert!(
            run.message().contains(said),
            "{arguments:?}: {}",
            run.stderr
        );
    }
    let run = folder.volref("validate smoke/plain --serve /no/such/renderer");
    run.prints(4, "could not be started");
}

/// What cannot be said is missing under a profile, too, that says nothing of the scene.
#[test]
fn what_cannot_be_said_needs_no_profile() {
    let folder = Folder::new();
    folder.write(
        "renderer.sh",
        "while read -r line; do echo '{\"cannot\":\"several volumes\"}'; done",
    );
    let run = folder.volref("validate scenes/two-fogs --as=vispy --serve 'sh renderer.sh {scene}'");
    run.expect(4, "");
    let said = "not rendered: several volumes";
    assert!(run.stdout.starts_with("missing"), "{}", run.stdout);
    assert!(run.stdout.contains(said), "{}", run.stdout);
}
