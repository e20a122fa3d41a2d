//! `volref gallery`: the page of several renderers.

use crate::folder::{Folder, Run};
use crate::needs::tries;
use std::fs;
use std::path::Path;

/// A suite with goldens, and the runs of three renderers: one right, one that forgets a shadow and has no words for
/// curves, and one that failed.
fn with_runs() -> Folder {
    let folder = Folder::with_goldens();
    let others = [
        ("right", "cp golden/$1.exr $2", 0),
        (
            "shadowless",
            "case $1 in plots/*) exit 3;; *) cp golden/smoke/plain.exr $2;; esac",
            1,
        ),
        ("broken", "echo '<script>alert(1)</script>' >&2; exit 7", 4),
    ];
    for (name, script, code) in others {
        folder.write("renderer.sh", script);
        let json = format!("--json={name}/results.json");
        let run = folder.volref(&[
            "validate",
            "--explain=0",
            "--run",
            "sh renderer.sh {case} {output}",
            "--keep",
            name,
            &json,
        ]);
        assert_eq!(run.code, code, "{name}: {}{}", run.stdout, run.stderr);
    }
    folder.write(
        "right/renderer.toml",
        "name = \"Right & <b>\"\nversion = \"2.1\"\ndate = \"2026-11-26\"\n",
    );
    folder
}

fn gallery(folder: &Folder, arguments: &[&str]) -> Run {
    folder.volref(&[&["gallery", "-o", "page.html"], arguments].concat())
}

/// The cells of a row, the golden's first.
fn cells(page: &str, case: &str) -> Vec<String> {
    let (_, row) = page
        .split_once(&format!(
            "<article data-name=\"{}\">",
            case.replace('/', "&#x2f;")
        ))
        .expect(case);
    let (row, _) = row.split_once("</article>").unwrap();
    row.split("<div class=\"cell\" ")
        .map(str::to_owned)
        .collect()
}

/// The image of this class within a cell, decoded.
fn image(cell: &str, class: &str) -> (usize, Vec<[u8; 3]>) {
    let (_, rest) = cell
        .split_once(class)
        .unwrap_or_else(|| panic!("{class} in {cell}"));
    let (_, rest) = rest.split_once("src=\"data:image/png;base64,").unwrap();
    let (text, _) = rest.split_once('"').unwrap();
    let bytes = data_encoding::BASE64.decode(text.as_bytes()).unwrap();
    let (width, _, codes) = volref::film::Film::codes_from_png(&bytes).unwrap();
    (width, codes)
}

#[test]
fn every_renderer_has_its_column_and_every_case_its_row() {
    let folder = with_runs();
    let run = gallery(&folder, &["right", "shadowless", "broken"]);
    run.prints(0, "page.html: 3 renderers, 4 cases, ");
    let page = folder.text("page.html");

    // Offline, and nobody's words are markup.
    assert!(!page.contains("http:") && !page.contains("https:"));
    assert!(!page.contains("<script>alert") && page.contains("&lt;script&gt;alert(1)"));
    for words in [
        "Right &amp; &lt;b&gt; <span class=\"soft\">2.1",
        "2026-11-26",
        "--keep shadowless",
        // The sentence, the totals and the legend.
        "3 renderers drew test scenes",
        "compared each of their 7 images with the right one",
        "<b>5</b> right</dt>",
        "<b>2</b> wrong, cause not known</dt>",
        "<b>5</b> error</dt>",
        "3 renderers × 4 scenes.",
        // What the matrix counts, and where its marks lead.
        "4 of 4</td>",
        "href=\"#shadowless&#x2f;smoke&#x2f;shadow\"",
        "id=\"shadowless&#x2f;smoke&#x2f;shadow\"",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // Times name their machine.
    let machine = folder.json("right/results.json")["origin"]["machine"].clone();
    assert!(page.contains(machine.as_str().unwrap()), "{machine}");

    let shadow = cells(&page, "smoke/shadow");
    assert_eq!(shadow.len(), 4);
    let verdicts = |case: &str| -> Vec<String> {
        let words = cells(&page, case).into_iter().skip(1);
        let verdict = |cell: String| {
            cell.split("data-mark=\"")
                .nth(1)
                .unwrap()
                .split('"')
                .next()
                .unwrap()
                .to_owned()
        };
        words.map(verdict).collect()
    };
    assert_eq!(verdicts("smoke/plain"), ["right", "right", "error"]);
    assert_eq!(verdicts("smoke/shadow"), ["right", "wrong", "error"]);
    assert_eq!(verdicts("plots/curve"), ["right", "error", "error"]);
    assert!(
        shadow[2].contains("bias ") && shadow[2].contains(" %"),
        "{}",
        shadow[2]
    );
    assert!(!shadow[3].contains("<img"));

    // The golden, the image and its difference.
    let golden = image(&shadow[0], "alt=\"golden of");
    assert_eq!(golden, image(&shadow[1], "class=\"picture\""));
    assert_ne!(golden, image(&shadow[2], "class=\"picture\""));
    let (width, none) = image(&shadow[1], "class=\"difference\"");
    assert_eq!((width, none.len()), (12, 120));
    assert!(
        none.iter().all(|colour| *colour == none[0]),
        "no difference is one colour"
    );
    // One end of the scale is reached.
    let (_, some) = image(&shadow[2], "class=\"difference\"");
    assert!(
        some.contains(&[103, 0, 31]) || some.contains(&[5, 48, 97]),
        "{some:?}"
    );
}

/// Noise gives the bias an interval, and what was read with `--bits` and `--alpha` is read so again.
#[test]
fn biases_have_intervals() {
    let keys = "converged_samples = 1024\nresolution = 0.9\nmean_resolution = 0.03";
    let folder = Folder::with_room(keys);
    folder.accept_all();
    let volref = env!("CARGO_BIN_EXE_volref");
    let command =
        format!("{volref} render {{scene}} -o {{output}} --spp {{spp}} --change reflectance=0.3");
    let run = folder.volref(&[
        "validate",
        "--explain=0",
        "--run",
        &command,
        "--spp",
        "256",
        "--keep",
        "bright",
        "--json=bright/results.json",
        "--alpha",
        "premultiplied",
    ]);
    assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
    let results = folder.json("bright/results.json");
    assert_eq!(results["origin"]["alpha"], "premultiplied");
    assert!(results["origin"]["seconds"]["fog/room"].as_f64().unwrap() > 0.0);
    assert!(
        results["origin"]["command"]
            .as_str()
            .unwrap()
            .starts_with("volref validate ")
    );
    let run = gallery(&folder, &["bright"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let cell = cells(&folder.text("page.html"), "fog/room").remove(1);
    let (_, bias) = cell.split_once("bias ").expect(&cell);
    assert!(bias.split('<').next().unwrap().contains(" ± "), "{bias}");
}

#[test]
fn what_is_no_run_is_told() {
    let folder = with_runs();
    for (name, text) in [
        ("no-json/results.json", "{"),
        (
            "other/results.json",
            "{\"schema\": \"volref/verify/1\", \"cases\": []}",
        ),
        ("unknown/renderer.toml", "vresion = \"1\"\n"),
    ] {
        folder.write(name, text);
    }
    folder.write("unknown/results.json", folder.read("right/results.json"));
    let results = folder.text("right/results.json");
    folder.write(
        "foreign/results.json",
        results.replace("smoke/plain", "smoke/pale"),
    );
    let before = folder.files();
    for (arguments, parts) in [
        (
            &["golden"][..],
            &[
                "golden/results.json: there is no such file",
                "--json=DIR/results.json",
            ][..],
        ),
        (
            &["nowhere"],
            &["nowhere/results.json: there is no such file"],
        ),
        (&["no-json"], &["no-json/results.json: EOF"]),
        (
            &["other"],
            &["its schema is \"volref/verify/1\"", "volref validate"],
        ),
        (
            &["unknown"],
            &["unknown/renderer.toml", "vresion", "version"],
        ),
        (
            &["foreign"],
            &["the suite has no case \"smoke/pale\"", "--suite DIR"],
        ),
        (
            &["right", "-o", "right/results.json"],
            &["the argument '--output <FILE>' cannot be used multiple times"],
        ),
    ] {
        let run = gallery(&folder, arguments);
        run.expect(2, parts);
    }
    for (output, part) in [
        ("right/results.json", "it is an input"),
        ("nowhere/page.html", "its folder does not exist"),
    ] {
        let run = folder.volref(&["gallery", "right", "-o", output]);
        run.expect(2, &[part]);
    }
    #[cfg(unix)]
    {
        std::fs::create_dir(folder.path("pipe")).unwrap();
        let made = std::process::Command::new("mkfifo")
            .arg(folder.path("pipe/results.json"))
            .status();
        assert!(made.unwrap().success());
        gallery(&folder, &["pipe"]).expect(2, "pipe/results.json");
        std::fs::remove_dir_all(folder.path("pipe")).unwrap();
    }
    assert_eq!(folder.files(), before);
}

/// A known failure is told with its cause and its link; what its file or the results say wrongly is printed.
#[test]
fn images_are_judged_again_and_known_failures_show_their_cause() {
    let folder = with_runs();
    folder.write(
        "shadowless/known.toml",
        "[\"smoke/shadow\"]\nreason = \"no <shadow>\"\nlink = \"https://example.org/7\"\n\
         [\"smoke/plain\"]\nreason = \"was wrong once\"\n",
    );
    let run = gallery(&folder, &["shadowless"]);
    let told = "shadowless: shadowless/known.toml:4: smoke/plain passes: remove the entry";
    run.prints(0, &[told]);
    let page = folder.text("page.html");
    let cell = cells(&page, "smoke/shadow").remove(1);
    for words in [
        "data-mark=\"known\"",
        "no &lt;shadow&gt;",
        "href=\"https:&#x2f;&#x2f;example.org&#x2f;7\"",
    ] {
        assert!(cell.contains(words), "{words} in {cell}");
    }
    assert!(page.contains("wrong, cause known</dt>"));

    // Another image than the one that was judged; and one that only looks like it.
    std::fs::copy(
        folder.path("golden/smoke/shadow.exr"),
        folder.path("shadowless/smoke/shadow.exr"),
    )
    .unwrap();
    folder.write("shadowless/known.toml", "");
    let run = gallery(&folder, &["shadowless"]);
    let told = "shadowless, smoke/shadow: pass today, and results.json says fail";
    assert!(run.stdout.contains(told), "{}", run.stdout);
    folder.write("shadowless/renderer.toml", "as_judged = false\n");
    let run = gallery(&folder, &["shadowless"]);
    assert!(!run.stdout.contains("today"), "{}", run.stdout);
    assert!(folder.text("page.html").contains("not judged again"));
    folder.write("shadowless/known.toml", "[\"smoke/shadow\"]\n");
    gallery(&folder, &["shadowless"]).expect(2, "known.toml … has no reason");
}

/// Renderers with so many images that only the nightly run judges them again.
const MANY_IMAGES: [&str; 6] = ["k3d", "vispy", "vtk", "vtk-cpu", "vtk.js", "yt"];

/// The results of renderers that are kept beside their adapters make one page. The images are judged again: where today's
/// program says something else, or a known failure is mended, the page would not be what the files say.
#[test]
fn renderers_with_adapters_stand_on_one_page_and_are_judged_again() {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/peers/results");
    let runs = fs::read_dir(results).unwrap();
    let mut runs: Vec<String> = runs
        .map(|run| run.unwrap().path().to_str().unwrap().to_owned())
        .collect();
    runs.sort();
    let slow = &MANY_IMAGES[..tries(MANY_IMAGES.len(), 0)];
    runs.retain(|run| !slow.iter().any(|name| run.ends_with(&format!("/{name}"))));
    let folder = Folder::new();
    let runs: Vec<&str> = runs.iter().map(String::as_str).collect();
    let run = gallery(&folder, &runs);
    run.expect(0, "");
    let count = format!("{} renderers", runs.len());
    assert!(run.stdout.contains(&count), "{}", run.stdout);
    assert_eq!(run.stdout.lines().count(), 1, "{}", run.stdout);
    let page = folder.text("page.html");
    for part in [
        "<h2>Ray casters</h2>",
        "<h2>Path tracers</h2>",
        "cannot say</dt>",
    ] {
        assert!(page.contains(part), "{part}");
    }
    for renderer in runs {
        let about = Path::new(renderer).join("renderer.toml");
        let name = fs::read_to_string(about).unwrap();
        let name = name.lines().next().unwrap().replace("name = ", "");
        assert!(page.contains(name.trim_matches('"')), "{name}");
    }
    assert!(page.contains("judged under the profile pyvista-gpu"));
}
