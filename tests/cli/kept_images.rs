//! Images that `validate --keep` keeps: never judged, and replaced case by case.

use crate::folder::{Folder, Run};

/// Validates `smoke/plain` by a renderer that calls `script` for each image, with `$case` and `$output`, either
/// called or asked, and keeps its images.
fn validate(folder: &Folder, is_asked: bool, script: &str) -> Run {
    let (mode, command) = match is_asked {
        false => {
            folder.write("renderer.sh", format!("case=$1; output=$2\n{script}\n"));
            ("--run", "sh renderer.sh {case} {output}")
        }
        true => {
            let field = |name| {
                format!(
                    "{name}=$(printf %s \"$line\" | sed 's/.*\"{name}\":\"\\([^\"]*\\)\".*/\\1/')\n"
                )
            };
            let read = format!(
                "while IFS= read -r line; do\n{}{}",
                field("case"),
                field("output")
            );
            let answer = "echo \"{\\\"image\\\":\\\"$output\\\"}\"\ndone\n";
            folder.write("renderer.sh", format!("{read}{script}\n{answer}"));
            ("--serve", "sh renderer.sh")
        }
    };
    let arguments = [
        "validate",
        "smoke/plain",
        "--keep",
        "kept",
        "--explain",
        "0",
        mode,
        command,
    ];
    folder.volref(&arguments)
}

/// Names of the files in the folder of kept images.
fn kept(folder: &Folder) -> Vec<String> {
    let all = folder.files().into_keys();
    let names = all.filter_map(|path| Some(path.strip_prefix("kept/")?.to_owned()));
    names.collect()
}

#[test]
fn an_image_of_an_earlier_run_is_not_judged() {
    let folder = Folder::with_goldens();
    let right = folder.read("golden/smoke/plain.exr");
    let npy = folder.film("golden/smoke/plain.exr").to_npy();
    for is_asked in [false, true] {
        for (stale, bytes) in [
            ("smoke/plain.exr", &right),
            ("smoke/plain.npy", &npy),
            ("plain.exr", &right),
            ("smoke/plain.0.exr", &right),
            ("smoke/plain@0.5.exr", &right),
        ] {
            folder.write(&format!("kept/{stale}"), bytes);
            let run = validate(&folder, is_asked, "true");
            run.prints(4, "missing … did not write smoke/plain.exr");
            // Whoever judges the folder later does not find it either.
            assert!(kept(&folder).is_empty(), "{stale}: {:?}", kept(&folder));
        }
        // What would be read beside an image is none of this run.
        for stale in ["smoke/plain.variance.exr", "smoke/plain.depth.npy"] {
            folder.write(&format!("kept/{stale}"), "no image");
            validate(&folder, is_asked, "cp golden/$case.exr $output").expect(0, "");
            assert_eq!(kept(&folder), ["smoke/plain.exr"], "{stale}");
        }
        std::fs::remove_dir_all(folder.path("kept")).unwrap();
    }
}

#[test]
fn kept_images_are_replaced_case_by_case() {
    let folder = Folder::with_goldens();
    for other in [
        "smoke/nearest.exr",
        "smoke/notes.txt",
        "notes.txt",
        "plain.txt",
    ] {
        folder.write(&format!("kept/{other}"), "mine");
    }
    folder.write("kept/smoke/plain.npy", "of an earlier run");
    let script = "cp golden/$case.exr $output; echo said > $(dirname $output)/plain.log; touch $(dirname $output)/.hidden";
    validate(&folder, false, script).expect(0, "");
    let all = [
        "notes.txt",
        "plain.txt",
        "smoke/nearest.exr",
        "smoke/notes.txt",
        "smoke/plain.exr",
        "smoke/plain.log",
    ];
    assert_eq!(kept(&folder), all);
    assert!(folder.read("kept/smoke/plain.exr") == folder.read("golden/smoke/plain.exr"));
    assert_eq!(folder.text("kept/smoke/nearest.exr"), "mine");
    folder
        .volref("validate smoke/plain --outputs kept")
        .expect(0, "");
    // What cannot be kept is said, and the verdict holds.
    folder.remove("kept/smoke/plain.exr");
    folder.write("kept/smoke/plain.exr/within", "mine");
    let run = validate(&folder, false, "cp golden/$case.exr $output");
    run.prints(0, "its images cannot be kept");
    assert_eq!(folder.text("kept/smoke/plain.exr/within"), "mine");
}
