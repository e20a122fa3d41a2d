//! Images of 8 bits: declared with `--bits` or in a profile, and recognised.

use crate::folder::{Folder, Run};
use crate::validate::scaled;
use serde_json::Value;
use volref::film::{Encoding, Film, Origin, Quantisation};

const CASE: &str = "smoke/plain";

fn golden(folder: &Folder) -> Film {
    folder.film("golden/smoke/plain.exr")
}

fn linear() -> Quantisation {
    Quantisation {
        encoding: Encoding::Linear,
        exposure: 0.0,
        origin: Origin::Declared,
        blended: false,
    }
}

/// The PNG of a renderer that writes n/255 of what it computes.
fn linear_png(film: &Film) -> Vec<u8> {
    let code = |x: f32| (255.0 * x).round() as u8;
    let codes: Vec<[u8; 3]> = film
        .radiance()
        .iter()
        .map(|pixel| pixel.map(code))
        .collect();
    Film::codes_to_png(&codes, film.width(), film.height())
}

fn validate(folder: &Folder, more: &[&str]) -> Run {
    let command = [
        "validate",
        CASE,
        "--outputs",
        "out",
        "--explain",
        "0",
        "--json",
    ];
    folder.volref(&[&command[..], more].concat())
}

fn result(run: &Run) -> Value {
    run.json()["cases"][0].clone()
}

/// The first note.
fn note(run: &Run) -> String {
    let notes = result(run)["notes"].as_array().cloned().unwrap_or_default();
    let mut notes = notes.iter().filter_map(|note| note.as_str());
    notes.next().unwrap_or_default().to_owned()
}

#[test]
fn codes_of_a_png_are_radiance_where_bits_are_declared() {
    let folder = Folder::with_goldens();
    let golden = golden(&folder);
    folder.write("out/smoke/plain.png", linear_png(&golden));
    // By how it looks, a linear PNG is too dark.
    let run = validate(&folder, &[]);
    assert_eq!(run.code, 1);
    let said = "agrees if its codes are declared with --bits 8-linear";
    let reason = result(&run)["reason"].to_string();
    assert!(reason.contains(said), "{reason}");
    let run = validate(&folder, &["--bits", "8-linear"]);
    run.expect(0, "");
    assert_eq!(result(&run)["gate"], "deterministic");
    let said = "8 bits, linear: differences below half a code + 0.001 + 1 % are not seen";
    assert_eq!(note(&run), said);
    // Decoded as sRGB it is another image.
    for bits in ["8", "8-srgb"] {
        assert_eq!(validate(&folder, &["--bits", bits]).code, 1, "{bits}");
    }
    folder.write("out/smoke/plain.png", golden.to_png(0.0));
    for bits in ["8", "8-srgb"] {
        let run = validate(&folder, &["--bits", bits]);
        run.expect(0, "");
        assert!(note(&run).starts_with("8 bits, sRGB: "), "{}", note(&run));
    }
    // Beyond half a code and the tolerance.
    folder.write("out/smoke/plain.png", linear_png(&scaled(&golden, 0.9)));
    let run = validate(&folder, &["--bits", "8-linear", "--report", "page"]);
    assert_eq!(run.code, 1);
    let reason = result(&run)["reason"].to_string();
    assert!(reason.contains("another exposure (-0."), "{reason}");
    let page = folder.text("page/index.html");
    assert!(
        page.contains("--bits 8-linear"),
        "the command that repeats it"
    );
    let run = folder.volref(&["validate", CASE, "--outputs", "out", "--bits", "16"]);
    run.expect(2, "8, 8-linear or 8-srgb");
}

#[test]
fn codes_of_a_linear_file_are_recognised_and_its_cut_off_is_said() {
    let folder = Folder::with_goldens();
    let golden = golden(&folder);
    let brightest = golden.brightest() as f32;
    // Of enough colours.
    let ramp = (0..256).map(|i| [0.0, 0.1, 0.2].map(|x| x + (i as f32 + 0.4) / 330.0));
    let wide = Film::new(16, 16, ramp.collect());
    folder.write("wide.npy", wide.to_npy());
    folder.write("rounded.npy", linear().rounded(&wide).to_npy());
    let compare = ["compare", "wide.npy", "rounded.npy"];
    let run = folder.volref(&compare);
    run.prints(0, "note: 8 bits, linear (recognised");
    // Volref's own images are not rounded unless somebody says so.
    let exact = [&compare[..], &["--gate", "exact"]].concat();
    assert_eq!(folder.volref(&exact).code, 1);
    let run = folder.volref(&[&exact[..], &["--bits", "8"]].concat());
    run.expect(0, "");
    assert!(!run.stdout.contains("recognised"), "{}", run.stdout);
    // Not all values are codes.
    folder.write("out/smoke/plain.npy", golden.to_npy());
    assert_eq!(note(&validate(&folder, &[])), "");
    let run = validate(&folder, &["--bits", "8"]);
    assert_eq!(run.code, 4, "{}", run.stdout);
    let reason = result(&run)["reason"].to_string();
    for said in [
        "smoke/plain",
        "8 bits, but ",
        " of row ",
        " of 255; leave --bits out",
    ] {
        assert!(reason.contains(said), "{reason}");
    }
    let run = folder.volref("compare golden/smoke/plain.exr out/smoke/plain.npy --bits 8");
    run.expect(
        2,
        "out/smoke/plain.npy: --bits declares codes of 8 bits, but … of 255",
    );

    // Brighter than the largest code by half.
    let bright = scaled(&golden, 1.5 / brightest);
    folder.write("bright.npy", bright.to_npy());
    folder.write("rounded.npy", linear().rounded(&bright).to_npy());
    let run = folder.volref("compare bright.npy rounded.npy --bits 8");
    run.prints(0, "of the pixels are cut off at 1");
    let most = scaled(&golden, 100.0 / brightest);
    folder.write("bright.npy", most.to_npy());
    folder.write("rounded.npy", linear().rounded(&most).to_npy());
    let run = folder.volref("compare bright.npy rounded.npy --bits 8");
    assert!(
        run.code == 0 || run.stdout.contains("that decides nothing"),
        "{}",
        run.stdout
    );
    folder.write("codes.png", golden.to_png(0.0));
    let run = folder.volref("compare codes.png rounded.npy --bits 8");
    run.expect(2, "--bits needs a reference of linear radiance");
}

#[test]
fn profiles_declare_bits() {
    let folder = Folder::with_goldens();
    folder.write("out/smoke/plain.png", linear_png(&golden(&folder)));
    folder.write(
        "mine.toml",
        "name = \"mine\"\nbits = 8\nencoding = \"linear\"\n",
    );
    let run = validate(&folder, &["--as", "mine.toml"]);
    run.expect(0, "");
    assert!(note(&run).starts_with("8 bits, linear: "), "{}", note(&run));
    // The command line counts.
    assert_eq!(
        validate(&folder, &["--as", "mine.toml", "--bits", "8"]).code,
        1
    );
    for (text, said) in [
        ("name = \"mine\"\nencoding = \"srgb\"\n", "add `bits = 8`"),
        ("name = \"mine\"\nbits = 16\n", "bits"),
        (
            "name = \"mine\"\nbits = 8\nencoding = \"log\"\n",
            "encoding",
        ),
    ] {
        folder.write("mine.toml", text);
        validate(&folder, &["--as", "mine.toml"]).expect(2, &[said]);
    }
}

/// A renderer is told the exposure of its case, in its command and in a bundle.
#[test]
fn renderers_are_told_the_exposure() {
    let folder = Folder::with_goldens();
    let manifest = folder.text("fixtures/cases/smoke/plain.toml");
    folder.write(
        "fixtures/cases/smoke/plain.toml",
        manifest + "exposure = 1.5\n",
    );
    folder.accept_all();
    let renderer = "test \"$1\" = 1.5 && grep -q '\"exposure\": 1.5' \"$2\" && cp golden/smoke/plain.exr \"$3\"";
    folder.write("renderer.sh", renderer);
    let command = "sh renderer.sh {exposure} {export:bundle} {output}";
    let run = folder.volref(&["validate", CASE, "--run", command]);
    run.expect(0, "");
    let run = folder.volref("export smoke/plain --to bundle -o bundle");
    run.expect(0, "");
    assert!(
        folder
            .text("bundle/plain.json")
            .contains("\"exposure\": 1.5")
    );
}
