//! `volref validate`: finished images, and renderers that are run.

use crate::folder::{Folder, MANIFEST, Run, assert_holds, assert_shown, scene};
use serde_json::Value;
use volref::film::Film;

/// A suite with goldens, and in `out/` a right image of every case.
fn with_images() -> Folder {
    let folder = Folder::with_goldens();
    for case in [
        "plots/curve",
        "smoke/nearest",
        "smoke/plain",
        "smoke/shadow",
    ] {
        folder.write(
            &format!("out/{case}.exr"),
            folder.read(&format!("golden/{case}.exr")),
        );
    }
    folder
}

/// The result of the case of that name.
fn case(run: &Run, name: &str) -> Value {
    let json = run.json();
    let cases = json["cases"].as_array().unwrap();
    let found = cases.iter().find(|case| case["name"] == name);
    found
        .unwrap_or_else(|| panic!("{name} is not among the results"))
        .clone()
}

#[test]
fn right_images_pass() {
    let folder = with_images();
    let before = folder.files();
    let run = folder.volref("validate --outputs out");
    assert_shown!(run.shown(), @r"
    exit code 0
    --- stdout
    pass          plots/curve [seconds]
    pass          smoke/nearest [seconds]
    pass          smoke/plain [seconds]
    pass          smoke/shadow [seconds]

    4 cases: 4 passed
    ");
    assert_eq!(folder.files(), before, "validate writes nothing unasked");
}

/// `film` with every value multiplied.
pub fn scaled(film: &Film, factor: f32) -> Film {
    let pixels = film
        .radiance()
        .iter()
        .map(|pixel| pixel.map(|x| factor * x));
    Film::new(film.width(), film.height(), pixels.collect())
}

/// What is there is judged, what is missing is counted; a difference weighs more.
#[test]
fn missing_images() {
    let folder = with_images();
    folder.remove("out/smoke/plain.exr");
    let run = folder.volref("validate --outputs out --json");
    assert_eq!(run.code, 4);
    let golden = folder.film("golden/smoke/nearest.exr");
    folder.write_film("out/smoke/nearest.exr", &scaled(&golden, 0.5));
    let run = folder.volref("validate --outputs out --json");
    assert_eq!(run.code, 1);
    assert_eq!(case(&run, "smoke/plain")["verdict"], "missing");
    assert_eq!(case(&run, "smoke/nearest")["verdict"], "fail");
    assert_eq!(case(&run, "smoke/shadow")["verdict"], "pass");
    assert_eq!(run.json()["schema"], "volref/validate/1");
    assert_eq!(run.json()["summary"]["missing"], 1);

    let run = folder.volref("validate --outputs out --only-present --json");
    assert_eq!(run.code, 1);
    assert_eq!(run.json()["cases"].as_array().unwrap().len(), 3);
    let run = folder.volref("validate smoke/plain --outputs out --only-present");
    run.expect(5, "nothing was compared");
}

/// A line for all cases without an image, and one for each only if asked; other programs get all.
#[test]
fn missing_images_are_counted_once() {
    let folder = with_images();
    folder.remove("out/smoke/plain.exr");
    let run = folder.volref("validate --outputs out");
    assert_shown!(run.shown(), @r"
    exit code 4
    --- stdout
    pass          plots/curve [seconds]
    pass          smoke/nearest [seconds]
    pass          smoke/shadow [seconds]
    1 case without an image; --verbose lists them

    4 cases: 3 passed, 1 missing
    ");
    for case in ["plots/curve", "smoke/nearest", "smoke/shadow"] {
        folder.remove(&format!("out/{case}.exr"));
    }
    let run = folder.volref("validate --outputs out --json=r.json --junit r.xml");
    assert_shown!(run.shown(), @r"
    exit code 4
    --- stdout
    4 cases without an image; --verbose lists them

    4 cases: 0 passed, 4 missing
    ");
    let json = folder.json("r.json");
    assert_eq!(json["cases"].as_array().unwrap().len(), 4);
    assert_eq!(folder.text("r.xml").matches("<testcase").count(), 4);
    let run = folder.volref("validate --outputs out --verbose");
    assert_eq!(run.stdout.matches("no image of this case").count(), 4);
    assert!(!run.stdout.contains("without an image"), "{}", run.stdout);
}

/// With 1 beside every other cause of failure, and two of those: the first of 2, 3, 6, 1, 4, 5.
#[test]
fn causes_that_meet() {
    let folder = with_images();
    folder.remove("out/smoke/plain.exr");
    let golden = folder.film("golden/smoke/nearest.exr");
    folder.write_film("out/smoke/nearest.exr", &scaled(&golden, 0.5));
    let run = folder.volref("validate --outputs out --explain 0");
    assert_eq!(run.code, 1, "a difference outranks a missing image");
    folder.edit(
        "golden/smoke/shadow.toml",
        "first goldens",
        "second thoughts",
    );
    let run = folder.volref("validate --outputs out --explain 0");
    assert_eq!(run.code, 3, "a golden that cannot be trusted outranks both");
    folder.write("fixtures/scenes/plots/curve.toml", "[film]\n");
    let run = folder.volref("validate --outputs out --explain 0");
    assert_eq!(run.code, 2, "bad input outranks all");
    for command in ["validate", "verify"] {
        let help = folder.volref(&[command, "--help"]).stdout;
        let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(help.contains("in the order 2, 3, 6, 1, 4, 5."), "{help}");
    }
}

/// Verdicts are printed before those that come after them are known.
#[cfg(unix)]
#[test]
fn verdicts_come_as_they_are_known() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::Stdio;
    let folder = with_images();
    let script = "case $1 in smoke/plain) while ! test -e go; do sleep 0.02; done;; esac; \
                  cp out/$1.exr $0";
    let command = format!("sh -c '{script}' {{output}} {{case}}");
    let mut child = folder
        .command(&[
            "validate",
            "--run",
            &command,
            "--timeout",
            "60",
            "--jobs",
            "2",
        ])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    let mut verdicts = String::new();
    for _ in 0..2 {
        stdout.read_line(&mut verdicts).unwrap();
    }
    // The third renderer waits for this.
    folder.write("go", "");
    assert!(
        verdicts.contains("plots/curve") && verdicts.contains("smoke/nearest"),
        "{verdicts}"
    );
    let mut rest = String::new();
    stdout.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0), "{rest}");
    let [plain, shadow] = ["smoke/plain", "smoke/shadow"].map(|case| rest.find(case).unwrap());
    assert!(plain < shadow, "{rest}");
}

/// An image that no mistake of the catalogue makes: each row is of another picture.
fn unknown_mistake(folder: &Folder, case: &str) -> Vec<u8> {
    let golden = folder.film(&format!("golden/{case}.exr"));
    let pixels = golden.radiance().iter().enumerate().map(|(index, pixel)| {
        let row = index / golden.width();
        pixel.map(|x| x * (1.0 + (row % 5) as f32) + (row % 3) as f32)
    });
    let film = Film::new(golden.width(), golden.height(), pixels.collect());
    film.to_exr().unwrap()
}

/// The search for a mistake ends when its time is over, says how far it came and how it goes on, and
/// names nothing; without time there is none.
#[test]
fn the_search_for_a_mistake_has_a_budget() {
    let folder = with_images();
    folder.write(
        "out/smoke/shadow.exr",
        unknown_mistake(&folder, "smoke/shadow"),
    );
    let validate = |more: &[&str]| {
        let arguments = [&["validate", "shadow", "--outputs", "out"][..], more].concat();
        let run = folder.volref(&arguments);
        assert_eq!(run.code, 1, "{}", run.stderr);
        run
    };
    let run = validate(&["--explain", "0.000001", "--json=r.json"]);
    let (_, search) = run
        .stdout
        .split_once("1 case: 0 passed, 1 failed\n")
        .unwrap();
    let words: Vec<_> = search.split_whitespace().collect();
    let words = words.join(" ");
    assert!(
        words.ends_with(
            "the search ended early in smoke/shadow; run again with --explain 0.000006 to continue"
        ),
        "{words}"
    );
    // A sign of life, which other tests do not see.
    let mut command = folder.command("validate shadow --outputs out --explain 1e-6");
    let stderr = String::from_utf8(command.output().unwrap().stderr).unwrap();
    let said =
        "volref: looking for the mistake in failing cases (1), at most 0.000001 s of work for each";
    assert!(stderr.starts_with(said), "{stderr}");
    let json = folder.json("r.json");
    assert_eq!(json["looks_like"], serde_json::json!([]));
    assert_eq!(json["cases"][0]["looks_like"], serde_json::json!([]));

    let run = validate(&["--explain", "0"]);
    assert!(
        run.stdout.ends_with("1 case: 0 passed, 1 failed\n"),
        "{}",
        run.stdout
    );
    assert_eq!(run.stderr, "");
    for wrong in ["-1", "nan", "much"] {
        let run = folder.volref(&["validate", "--outputs", "out", "--explain", wrong]);
        assert_eq!(run.code, 2, "{wrong}");
    }
}

/// Where `CI` is set, a cause is looked for only if somebody asks; the verdict is the same.
#[test]
fn no_cause_is_looked_for_in_ci_unless_asked() {
    let folder = with_images();
    let golden = folder.film("golden/smoke/plain.exr");
    let doubled = [0, 1].map(|flip| {
        let pixels = golden.radiance().iter().enumerate();
        let pixels = pixels.map(|(index, pixel)| match (index + flip) % 2 {
            0 => pixel.map(|value| 2.0 * value),
            _ => *pixel,
        });
        Film::new(golden.width(), golden.height(), pixels.collect())
    });
    folder.write_film("out/smoke/plain.exr", &doubled[0]);
    let validate = |more: &str, ci: &str| {
        let mut command = folder.command(&*format!(
            "validate plain --outputs out --json=r.json {more}"
        ));
        let run = Run::of(command.env("CI", ci).output().unwrap());
        run.expect(1, "");
        assert!(run.stdout.starts_with("fail "), "{}", run.stdout);
        let ended = folder.json("r.json")["cases"][0]["search_ended"].clone();
        (run, ended)
    };
    const HINT: &str = "no cause was looked for, since the environment variable CI is set; --explain 10 looks for it\n";
    let (run, ended) = validate("", "true");
    assert!(run.stdout.ends_with(HINT), "{}", run.stdout);
    assert_eq!((&*run.stderr, ended), ("", false.into()));
    for (more, ci) in [
        ("--explain 600", "true"),
        ("--accept-conventions --explain 600", "1"),
        ("--explain 600", ""),
    ] {
        let (run, ended) = validate(more, ci);
        assert!(!run.stdout.contains(HINT), "{}", run.stdout);
        assert_eq!(ended, true, "{more}: {}", run.stdout);
    }
    let (run, ended) = validate("--explain 0", "true");
    assert!(!run.stdout.contains(HINT), "{}", run.stdout);
    assert_eq!(ended, false);
}

/// Nothing is looked for where the verdict says the cause: another size, values that are no numbers, nothing drawn.
#[test]
fn no_cause_is_looked_for_that_is_known() {
    let folder = with_images();
    let golden = folder.film("golden/smoke/plain.exr");
    let (width, height) = (golden.width(), golden.height());
    let mut not_finite = golden.radiance().to_vec();
    not_finite[3] = [f32::NAN; 3];
    let background = golden.radiance()[0];
    for (what, image) in [
        ("size", Film::new(width, 1, vec![[0.5; 3]; width])),
        ("not finite", Film::new(width, height, not_finite)),
        (
            "nothing was drawn",
            Film::new(width, height, vec![background; width * height]),
        ),
    ] {
        folder.write_film("out/smoke/plain.exr", &image);
        let mut command = folder.command("validate plain --outputs out --json=r.json");
        let output = command.output().unwrap();
        let [stdout, stderr] =
            [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        assert!(stdout.contains(what), "{stdout}");
        assert!(!stderr.contains("looking for"), "{what}: {stderr}");
        let json = folder.json("r.json");
        assert!(
            json["cases"][0].get("search_ended").is_none(),
            "{what}: {json}"
        );
    }
}

/// Ctrl-C in the search: verdicts, summary and files are there, as the exit code of the verdicts is.
#[cfg(unix)]
#[test]
fn the_search_can_be_interrupted() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};
    let folder = Folder::with_suite();
    // Enough pixels and steps for a search of many seconds.
    folder.edit(
        "fixtures/scenes/smoke/shadow.toml",
        "width = 12\nheight = 10",
        "width = 64\nheight = 60",
    );
    folder.edit(
        "fixtures/scenes/smoke/shadow.toml",
        "resolution = 8",
        "resolution = 32",
    );
    folder.accept_all();
    folder.write(
        "out/smoke/shadow.exr",
        unknown_mistake(&folder, "smoke/shadow"),
    );
    let mut child = folder
        .command("validate shadow --outputs out --explain 600 --json=r.json --junit r.xml --report report")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    // On a slow machine a line of progress comes before it.
    let mut lines = stderr.by_ref().lines().map(Result::unwrap);
    assert!(lines.any(|line| line.contains("looking for the mistake")));
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(killed.unwrap().success());
    let mut stdout = String::new();
    child
        .stdout
        .take()
        .unwrap()
        .read_to_string(&mut stdout)
        .unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{stdout}");
    assert!(stdout.contains("1 case: 0 passed, 1 failed"), "{stdout}");
    assert_holds(
        &stdout,
        &["the search ended early in smoke/shadow; run again"],
    );
    let json = folder.json("r.json");
    assert_eq!(json["cases"][0]["verdict"], "fail");
    assert_eq!(json["looks_like"], serde_json::json!([]));
    assert!(folder.text("r.xml").contains("smoke/shadow"));
    assert!(folder.text("report/index.html").contains("smoke"));
}

/// What is measured of an image is said with the verdict, and is not a mistake of the catalogue.
#[test]
fn factors_and_levels_are_said() {
    let folder = with_images();
    let golden = folder.film("golden/smoke/shadow.exr");
    folder.write_film("out/smoke/shadow.exr", &scaled(&golden, 1.3));
    let run = folder.volref("validate shadow --outputs out");
    run.prints(1, "  the image is the golden × 1.3000; ");
    // The factor explains it, though it is no mistake of the catalogue.
    assert!(!run.stdout.contains("explains it"), "{}", run.stdout);
}

/// The mistake is named in the result of the case and for all together, with what to do.
#[test]
fn mistakes_are_named() {
    let folder = with_images();
    let run = folder.volref("render fixtures/scenes/smoke/plain.toml -o right.exr");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let right = folder.film("right.exr");
    let bright = right.radiance().iter().map(|p| p.map(|x| 2.0 * x));
    let wrong = Film::new(right.width(), right.height(), bright.collect());
    folder.write_film("out/smoke/plain.exr", &wrong);
    let run = folder.volref("validate --outputs out --json");
    assert_eq!(run.code, 1);
    assert_eq!(case(&run, "smoke/plain")["looks_like"][0], "bright-doubled");
    assert_eq!(
        case(&run, "smoke/shadow")["looks_like"],
        serde_json::json!([])
    );
    let likely = &run.json()["looks_like"][0];
    assert_eq!(likely["mistake"], "bright-doubled");
    assert_eq!(
        (likely["explains"].clone(), likely["of"].clone()),
        (1.into(), 1.into())
    );

    // A mistake of the scene: as though the volume had no opacity correction.
    folder.write(
        "wrong.toml",
        folder
            .text("fixtures/scenes/smoke/shadow.toml")
            .replace(
                "reference_length = \"0.2 voxels\"",
                "reference_length = \"0.5 voxels\"",
            )
            .replace("../../", "fixtures/"),
    );
    let run = folder.volref("render wrong.toml -o out/smoke/shadow.exr");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let run = folder.volref("validate shadow --outputs out");
    run.prints(1, "looks like  opacity-uncorrected (1 of 1 case)");
}

/// No convention and no mistake is looked for in an image of another size, narrower ones included.
#[test]
fn images_of_another_size() {
    let folder = with_images();
    let golden = folder.film("golden/smoke/plain.exr");
    let (width, height) = (golden.width(), golden.height());
    for [width, height] in [
        [width / 2, height],
        [width - 1, height],
        [width / 2, 2 * height],
        [2 * width, height],
        [width, height - 1],
        [1, 1],
    ] {
        let pixels = vec![[0.25; 3]; width * height];
        let other = Film::new(width, height, pixels);
        folder.write_film("out/smoke/plain.exr", &other);
        let run = folder.volref("validate --outputs out --json");
        assert_eq!(run.code, 1, "{width} × {height}: {}", run.stderr);
        let reason = case(&run, "smoke/plain")["reason"].clone();
        assert!(
            reason.as_str().unwrap().starts_with("size differs"),
            "{width} × {height}: {reason}"
        );
    }
    // There is nothing to look for, and nothing is said to have been looked for.
    let run = folder.volref("validate --outputs out --report report");
    let advice = format!("render it at {width} × {height}");
    assert!(run.stdout.contains(&advice), "{}", run.stdout);
    assert!(!run.stdout.contains("no known mistake"), "{}", run.stdout);
    let page = folder.text("report/index.html");
    assert!(!page.contains("no known mistake"), "{page}");
}

#[test]
fn images_that_are_none() {
    let folder = with_images();
    folder.write("out/smoke/plain.exr", "no image");
    let run = folder.volref("validate --outputs out --json");
    assert_eq!(run.code, 4);
    assert_eq!(case(&run, "smoke/plain")["verdict"], "error");

    folder.write("out/smoke/plain.exr", folder.read("golden/plots/curve.exr"));
    let run = folder.volref("validate --outputs out --json");
    assert_eq!(run.code, 1);
    let reason = case(&run, "smoke/plain")["reason"].clone();
    assert!(
        reason.as_str().unwrap().starts_with("size differs"),
        "{reason}"
    );

    let golden = folder.film("golden/smoke/plain.exr");
    let mut pixels = golden.radiance().to_vec();
    pixels[14][1] = f32::NAN;
    let broken = Film::new(golden.width(), golden.height(), pixels);
    folder.write_film("out/smoke/plain.exr", &broken);
    let run = folder.volref("validate --outputs out --json");
    assert_eq!(run.code, 1);
    let found = case(&run, "smoke/plain");
    assert_eq!(found["metrics"]["non_finite_pixels"], 1.0);
    assert!(
        found["reason"].as_str().unwrap().contains("(2, 1)"),
        "{found}"
    );
}

/// A golden that cannot be trusted judges nothing, and weighs more than a missing image.
#[test]
fn goldens_are_not_trusted_blindly() {
    let folder = with_images();
    folder.edit(
        "golden/smoke/plain.toml",
        "first goldens",
        "second thoughts",
    );
    let run = folder.volref("validate --outputs out");
    assert_eq!(run.code, 3);
    folder.remove("out/smoke/plain.exr");
    let run = folder.volref("validate --outputs out");
    run.prints(3, "no image of this case");
    let run = folder.volref("validate --outputs out --only-present");
    assert_eq!(run.code, 0, "{}", run.stdout);
}

#[test]
fn usage() {
    let folder = with_images();
    for (arguments, said) in [
        (&["validate"][..], "--outputs <DIR>|--run <CMD>"),
        (
            &["validate", "--outputs", "nowhere"],
            "there is no folder nowhere",
        ),
        (&["validate", "--run", "render {scene}"], "{output}"),
        (
            &["validate", "--run", "r {output} {sceen}"],
            "unknown placeholder {sceen}",
        ),
        (&["validate", "--run", "r '{output}"], "unclosed quote"),
        (
            &["validate", "--run", "r {output}", "--timeout", "-1"],
            "positive number of seconds",
        ),
    ] {
        let run = folder.volref(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stdout);
        let message = run.stderr.replace('\n', " ");
        assert!(message.contains(said), "{arguments:?}: {message}");
    }
    assert_eq!(folder.volref("validate fog --outputs out").code, 5);
}

/// volref itself is a renderer that can be run.
#[test]
fn a_renderer_is_run() {
    let folder = Folder::with_goldens();
    let renderer = env!("CARGO_BIN_EXE_volref");
    let command = format!("'{renderer}' render {{scene}} --output {{output}}");
    let run = folder.volref(&[
        "validate", "--run", &command, "--jobs", "2", "--keep", "kept",
    ]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert_eq!(
        folder.film("kept/smoke/plain.exr").pixel_hash(),
        folder.film("golden/smoke/plain.exr").pixel_hash()
    );
    let run = folder.volref(&["validate", "curve", "--run", &command, "--format", "png"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
}

#[cfg(unix)]
#[test]
fn renderers_that_fail() {
    let folder = Folder::with_goldens();
    for (script, verdict, said) in [
        ("exit 3", "error", "failed: exit status: 3"),
        ("kill -KILL $$", "error", "failed: signal: 9 (SIGKILL)"),
        ("sleep 1000", "error", "did not end within 0.5 s"),
        ("true", "missing", "did not write smoke/plain.exr"),
        ("echo x > \"$0\"", "error", "not a readable EXR"),
    ] {
        let command = format!("sh -c '{script}' {{output}}");
        let run = folder.volref(&[
            "validate",
            "smoke/plain",
            "--run",
            &command,
            "--timeout",
            "0.5",
            "--json",
        ]);
        assert_eq!(run.code, 4, "{script}: {}", run.stdout);
        let found = case(&run, "smoke/plain");
        assert_eq!(found["verdict"], verdict, "{script}");
        assert!(
            found["reason"].as_str().unwrap().contains(said),
            "{script}: {found}"
        );
        // No folder that nobody finds again.
        assert!(!found["reason"].to_string().contains("/images/"), "{found}");
    }
}

/// A scene that a format cannot represent is no image of the case, and nothing is run.
#[test]
fn scenes_that_cannot_be_exported() {
    let folder = Folder::with_goldens();
    let run = folder.volref("validate smoke/plain --run 'false {export:mitsuba} {output}' --json");
    assert_eq!(run.code, 4);
    let found = case(&run, "smoke/plain");
    assert_eq!(found["verdict"], "missing");
    assert!(
        found["reason"]
            .as_str()
            .unwrap()
            .contains("classified volume"),
        "{found}"
    );
}

/// The report's command line judges the same suite again, by the same renderer, samples and seed.
#[test]
fn a_report_says_how_it_is_reproduced() {
    let folder = Folder::with_goldens();
    let renderer = env!("CARGO_BIN_EXE_volref");
    let command = format!("'{renderer}' render {{scene}} -o {{output}}");
    let suite = folder.path("").display().to_string();
    let arguments = [
        "--suite", &suite, "--run", &command, "--spp", "8", "--seed", "3",
    ];
    let report = ["validate", "smoke/plain", "--report", "report"];
    let run = folder.volref(&[&report[..], &arguments].concat());
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let page = folder.text("report/index.html");
    let (_, after) = page.split_once("<h3>Reproduce</h3>").unwrap();
    let (_, line) = after.split_once("<pre>").unwrap();
    let (line, _) = line.split_once("</pre>").unwrap();
    let line = [
        ("&#x2f;", "/"),
        ("&#x27;", "'"),
        ("&quot;", "\""),
        ("&amp;", "&"),
    ]
    .iter()
    .fold(line.to_owned(), |line, (code, letter)| {
        line.replace(code, letter)
    });
    let words = shell_words::split(&line).unwrap();
    assert_eq!(words[..3], ["volref", "validate", "smoke/plain"], "{line}");
    for pair in arguments.chunks(2) {
        assert!(
            words.windows(2).any(|words| words == pair),
            "{pair:?} in {line}"
        );
    }
    let again: Vec<&str> = words[1..].iter().map(String::as_str).collect();
    assert_eq!(folder.volref(&again).code, 0, "{line}");
}

#[test]
fn reports_for_people_and_build_servers() {
    let folder = with_images();
    let run = folder.volref("validate --outputs out --report report --junit r.xml --json=r.json");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let page = folder.text("report/index.html");
    assert!(page.contains("smoke&#x2f;plain"), "names are escaped");
    assert!(
        !page.contains("http://") && !page.contains("https://"),
        "it needs no network"
    );
    assert!(folder.text("r.xml").contains("volref/smoke"));
    let json = folder.json("r.json");
    assert_eq!(json["summary"]["pass"], 4);
}

/// Whatever loosens a judgement is said where it is read, and the command for one case is the same judgement.
#[test]
fn what_loosens_a_judgement_is_said() {
    let folder = with_images();
    for case in ["shadow", "nearest"] {
        folder.remove(&format!("out/smoke/{case}.exr"));
    }
    folder.write("mine.toml", "name = 'mine'\n[conventions]\n");
    let loose = [
        "--as",
        "mine.toml",
        "--accept-conventions",
        "--alpha",
        "straight",
        "--resolution",
        "5",
    ];
    let files = [
        "--only-present",
        "--report",
        "page",
        "--junit",
        "r.xml",
        "--json=r.json",
    ];
    let command = ["validate", "smoke", "--outputs", "out", "--explain", "0"];
    let run = folder.volref(&[&command[..], &loose, &files].concat());
    let said = "--accept-conventions, --alpha straight, profile mine, --resolution 5; 2 skipped";
    assert!(
        run.stdout.contains(&format!("judged with: {said}\n")),
        "{}",
        run.stdout
    );
    let json = folder.json("r.json");
    let judged_with = serde_json::json!({
        "settings": { "accept_conventions": "true", "alpha": "straight", "profile": "mine", "resolution": "5" },
        "skipped": ["smoke/nearest", "smoke/shadow"],
        "cannot": [],
    });
    assert_eq!(json["judged_with"], judged_with);
    let xml = folder.text("r.xml");
    for property in [
        r#"name="volref.profile" value="mine""#,
        r#"name="volref.skipped" value="smoke/nearest smoke/shadow""#,
    ] {
        assert!(xml.contains(property), "{xml}");
    }
    let page = folder.text("page/index.html");
    assert!(page.contains(&format!("Judged with: {said}")), "{page}");
    let again = page
        .split("volref validate smoke&#x2f;plain")
        .nth(1)
        .unwrap();
    let again = again.split('<').next().unwrap();
    for words in loose {
        assert!(again.contains(words), "{words:?} in {again}");
    }
    // Where nothing is loose, nothing is said.
    let run = folder.volref("validate plots --outputs out --junit r.xml --report page");
    assert!(!run.stdout.contains("judged with"), "{}", run.stdout);
    assert!(!folder.text("r.xml").contains("<properties>"));
    assert!(!folder.text("page/index.html").contains("Judged with"));
}

/// What a renderer has no words for is counted, skipped or not.
#[cfg(unix)]
#[test]
fn cases_that_cannot_be_rendered_are_counted() {
    let folder = Folder::with_goldens();
    let answer = "while read -r line; do echo '{\"cannot\":\"smoke\"}'; done";
    folder.write("renderer.sh", answer);
    let command = ["validate", "smoke", "--serve", "sh renderer.sh"];
    let run = folder.volref(&command);
    run.prints(4, "judged with: 3 cannot be rendered\n");
}

/// An image under other conventions is no mistake: it is said which, and it passes under a profile.
#[test]
fn conventions_are_told_apart_and_accepted() {
    let folder = with_images();
    let scene = folder.text("fixtures/scenes/smoke/plain.toml");
    let conventions = "\n[classified.conventions]\nopacity = 'linear'\n";
    folder.write(
        "linear.toml",
        scene.replace("../../", "fixtures/") + conventions,
    );
    folder
        .volref("render linear.toml -o out/smoke/plain.exr")
        .expect(0, "");
    let run = folder.volref("validate --outputs out smoke/plain");
    assert_shown!(run.shown(), @r#"
    exit code 1
    --- stdout
    fail          smoke/plain [seconds]
                  16 of 120 pixels (13.333 %) differ by more than 0.001 + 1 %; at most 0.02 % may. The worst is (5, 1), 9.7 times the tolerance

    after the search for conventions:
    convention    smoke/plain [seconds]
                  differs by convention: it takes opacity in proportion to the step. volref's image under these conventions agrees with it
                  --accept-conventions accepts it; --as FILE judges by this file:
                      name = "mine"
                      [conventions]
                      opacity = "linear"

    1 case: 0 passed, 1 by convention
    "#);
    let arguments = ["validate", "--outputs", "out", "smoke/plain", "--json"];
    let found = case(&folder.volref(&arguments), "smoke/plain");
    assert_eq!(found["verdict"], "convention");
    assert_eq!(found["conventions"].as_array().unwrap().len(), 1);
    let with = |more: &[&str]| folder.volref(&[&arguments[..4], more].concat());
    let accepted = with(&["--accept-conventions"]);
    accepted.expect(0, "");
    assert!(accepted.stdout.contains("in proportion to the step"));
    assert!(accepted.stdout.contains("--accept-conventions accepted it"));
    // For build servers, too.
    with(&["--accept-conventions", "--junit", "r.xml"]).expect(0, "");
    assert!(!folder.text("r.xml").contains("<failure"));
    folder.write(
        "mine.toml",
        "name = 'mine'\n[conventions]\nopacity = 'linear'\n",
    );
    with(&["--as", "mine.toml"]).expect(0, "");
    let under = with(&["--as", "mine.toml", "--json=out/results.json"]);
    under.expect(0, "");
    // The page of renderers states it.
    folder
        .volref(&["gallery", "out", "-o", "page.html"])
        .expect(0, "");
    let page = folder.text("page.html");
    assert!(page.contains("mine.toml"), "the profile is named");
    with(&["--as", "vtk"]).expect(1, "");
    with(&["--as", "anari"]).expect(1, "");

    with(&["--as", "absent.toml"]).expect(2, "cannot read the profile … anari, vtk");
    folder.write(
        "wrong.toml",
        "name = 'wrong'\n[conventions]\nopacity = 'cubic'\n",
    );
    with(&["--as", "wrong.toml"]).expect(2, "wrong.toml:3 … opacity … linear");
    // A scene with conventions of its own.
    folder.write(
        "fixtures/scenes/smoke/plain.toml",
        scene + "\n[classified.conventions]\nopacity = 'linear'\n",
    );
    folder.accept_all();
    let contradicted = with(&["--as", "vtk"]);
    contradicted.expect(2, "");
    assert!(contradicted.stdout.contains("contradicts the scene"));
}

/// Images with the step of the scene, half of it and a quarter are judged by what they converge to,
/// from files and from a renderer that is called with a step.
#[test]
fn sequences_of_steps_are_judged_by_their_limit() {
    let folder = Folder::with_suite();
    folder.write(
        "fixtures/scenes/limit/cloud.toml",
        scene("compositing = \"continuous\"\nstep = \"0.1 voxels\"\n")
            .replace("[transfer_function]", "[transfer_function]\nfloor = 0.1"),
    );
    let manifest = MANIFEST.replace("deterministic", "limit");
    folder.write("fixtures/cases/limit/cloud.toml", &manifest);
    folder.accept_all();
    let renderer = env!("CARGO_BIN_EXE_volref");
    let command = format!("'{renderer}' render {{scene}} --step {{step}} --output {{output}}");
    let run = [
        "validate",
        "limit",
        "--explain",
        "0",
        "--json",
        "--keep",
        "kept",
        "--run",
    ];
    let judged = folder.volref(&[&run[..], &[&command]].concat());
    judged.expect(0, "");
    let found = case(&judged, "limit/cloud");
    assert_eq!(found["gate"], "refinement", "{found}");
    let reason = found["reason"].as_str().unwrap();
    assert!(reason.contains("off at the step asked for"), "{reason}");

    let names = ["cloud.exr", "cloud@0.5.exr", "cloud@0.25.exr"];
    let images = names.map(|name| folder.read(&format!("kept/limit/{name}")));
    let outputs = |files: &[(&str, &[u8])]| {
        let _ = std::fs::remove_dir_all(folder.path("out"));
        for (name, bytes) in files {
            folder.write(&format!("out/limit/{name}"), bytes);
        }
        let run = folder.volref("validate limit --explain 0 --outputs out --json");
        (case(&run, "limit/cloud"), run.code)
    };
    let sequence = [0, 1, 2].map(|n| (names[n], &images[n][..]));
    let (finished, code) = outputs(&sequence);
    assert_eq!(
        (finished["metrics"].clone(), code),
        (found["metrics"].clone(), 0)
    );
    // Of one image less is said, and that it is so.
    let (one, _) = outputs(&sequence[..1]);
    let reason = one["reason"].as_str().unwrap();
    assert!(reason.contains("one image"), "{reason}");

    // What converges to something else.
    let darker = |bytes: &[u8]| {
        scaled(&Film::from_exr(bytes).unwrap(), 0.9)
            .to_exr()
            .unwrap()
    };
    let dark = images.clone().map(|bytes| darker(&bytes));
    let (other, code) = outputs(&[0, 1, 2].map(|n| (names[n], &dark[n][..])));
    assert_eq!(
        (other["verdict"].as_str(), code),
        (Some("fail"), 1),
        "{other}"
    );
    // Images that are all the same, that get worse, and sequences with gaps.
    let same = [0, 1, 2].map(|n| (names[n], &images[0][..]));
    let reason = outputs(&same).0["reason"].clone();
    assert!(
        reason.as_str().unwrap().contains("whatever the step"),
        "{reason}"
    );
    let growing = [
        (names[0], &images[0][..]),
        (names[1], &images[1]),
        (names[2], &dark[2]),
    ];
    let (growing, code) = outputs(&growing);
    assert_eq!(code, 1, "{growing}");
    let reason = growing["reason"].as_str().unwrap();
    assert!(reason.contains("do not converge"), "{reason}");
    for (files, said) in [
        (&[sequence[0], sequence[2]][..], "but no limit/cloud@0.5"),
        (&sequence[..2], "but no limit/cloud@0.25"),
        (&sequence[1..], "but no limit/cloud:"),
    ] {
        let (gap, code) = outputs(files);
        assert_eq!((gap["verdict"].as_str(), code), (Some("error"), 4), "{gap}");
        let reason = gap["reason"].as_str().unwrap();
        assert!(reason.contains(said), "{reason}");
    }
    // Steps that do not shrink, and a case that states its step.
    for (name, said) in [
        ("limit/cloud@2.exr", "is no factor of the step"),
        ("limit/cloud@0.3.exr", "is no factor of the step"),
    ] {
        folder.write(&format!("out/{name}"), &images[0]);
        let run = folder.volref("validate limit --explain 0 --outputs out");
        assert!(run.stdout.contains(said), "{}", run.stdout);
    }
    let _ = std::fs::remove_dir_all(folder.path("out"));
    for name in ["plain.exr", "plain@0.5.exr", "plain@0.25.exr"] {
        folder.write(
            &format!("out/smoke/{name}"),
            folder.read("golden/smoke/plain.exr"),
        );
    }
    let arguments = ["validate", "smoke/plain", "--outputs", "out", "--json"];
    let stated = folder.volref(&arguments);
    assert_eq!(stated.code, 4, "{}", stated.stdout);
    let reason = case(&stated, "smoke/plain")["reason"].clone();
    assert!(
        reason.as_str().unwrap().contains("states its step"),
        "{reason}"
    );
}
