//! Inputs stay what they are: no output is written over one, under whatever name, and none that is
//! no file is waited for.

use crate::folder::{Folder, assert_holds};

/// A suite with goldens, and scenes, volumes and images beside it.
fn folder() -> Folder {
    let folder = Folder::with_suite();
    let accepted = folder.volref("accept smoke/plain --reason first");
    assert_eq!(accepted.code, 0, "{}", accepted.stderr);
    let scenes = Folder::with_scenes();
    for name in ["cloud.obj", "scene.toml", "curve.toml"] {
        folder.write(name, scenes.read(name));
    }
    // A volume with its data in another file.
    let header =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: data.raw\n";
    folder.write("apart.nhdr", header);
    folder.write("data.raw", [1, 2, 3, 4, 5, 6, 7, 8]);
    let volume = "file = \"cloud.obj\"\nresolution = 8\npadding = 1";
    let apart = scenes
        .text("scene.toml")
        .replace(volume, "file = \"apart.nhdr\"");
    assert!(apart.contains("apart.nhdr"), "{apart}");
    folder.write("apart.toml", apart);
    // A body in a mesh.
    folder.write("gem.obj", include_bytes!("../../fixtures/meshes/gem.obj"));
    folder.write(
        "mesh.toml",
        "[film]\nwidth = 4\nheight = 4\n[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\n[radiative]\nenvironment = [1, 1, 1]\n\
         [[radiative.surface]]\nmesh = { file = \"gem.obj\" }\ndiffuse = { reflectance = 0.5 }\n",
    );
    for name in ["a", "b"] {
        for extension in ["exr", "png"] {
            let image = format!("{name}.{extension}");
            let run = folder.volref(&["render", "curve.toml", "-o", &image]);
            assert_eq!(run.code, 0, "{}", run.stderr);
        }
    }
    folder.write(
        "images/smoke/plain.exr",
        folder.read("golden/smoke/plain.exr"),
    );
    folder
}

/// Every command that writes, with each of its outputs over each kind of its inputs.
#[test]
fn no_output_is_written_over_an_input() {
    const OVER_INPUTS: &[(&str, &str)] = &[
        ("plan scene.toml --json=scene.toml", "scene.toml"),
        ("plan scene.toml --json=cloud.obj", "cloud.obj"),
        ("plan apart.toml --json=apart.nhdr", "apart.nhdr"),
        ("plan apart.toml --json=data.raw", "data.raw"),
        ("plan mesh.toml --json=gem.obj", "gem.obj"),
        ("info cloud.obj --json=cloud.obj", "cloud.obj"),
        ("info apart.nhdr --json=data.raw", "data.raw"),
        ("compare a.png b.png --heatmap a.png", "a.png"),
        ("compare a.png b.png --heatmap b.png", "b.png"),
        ("compare a.exr b.exr --json=b.exr", "b.exr"),
        ("compare a.exr a.exr --json=a.exr", "a.exr"),
        ("render curve.toml -o a.png --json=curve.toml", "curve.toml"),
        ("render scene.toml -o a.exr --json=cloud.obj", "cloud.obj"),
        (
            "export scene.toml --to bundle -o out --json=cloud.obj",
            "cloud.obj",
        ),
        (
            "export mesh.toml --to mitsuba -o . --json=mesh.toml",
            "mesh.toml",
        ),
        ("cost scene.toml --runs 0 --json=scene.toml", "scene.toml"),
        ("cost scene.toml --runs 0 --json=cloud.obj", "cloud.obj"),
        (
            "verify smoke/plain --json=fixtures/cases/smoke/plain.toml",
            "plain.toml",
        ),
        (
            "verify smoke/plain --junit=fixtures/scenes/smoke/plain.toml",
            "plain.toml",
        ),
        (
            "verify smoke/plain --json=fixtures/volumes/cloud.obj",
            "cloud.obj",
        ),
        (
            "verify smoke/plain --junit=golden/smoke/plain.exr",
            "plain.exr",
        ),
        ("list --json=fixtures/cases/smoke/plain.toml", "plain.toml"),
        ("list --json=golden/smoke/plain.png", "plain.png"),
        (
            "selftest plots --quick --json=fixtures/scenes/plots/curve.toml",
            "curve.toml",
        ),
        (
            "accept plots --reason r --json=fixtures/cases/plots/curve.toml",
            "curve.toml",
        ),
        (
            "accept plots --reason r --json=golden/smoke/plain.toml",
            "plain.toml",
        ),
        (
            "validate smoke/plain --outputs images --json=images/smoke/plain.exr",
            "plain.exr",
        ),
        (
            "validate smoke/plain --outputs images --junit=images/smoke/plain.exr",
            "plain.exr",
        ),
        (
            "validate smoke/plain --outputs images --junit=golden/smoke/plain.png",
            "plain.png",
        ),
    ];
    let folder = folder();
    let before = folder.files();
    for (command, input) in OVER_INPUTS {
        let run = folder.volref(*command);
        let said = run.message();
        assert_eq!(run.code, 2, "{command}: {said}{}", run.stdout);
        let as_input = format!("{input}: it is an input");
        assert!(said.contains(&as_input), "{command}: {said}");
        assert!(folder.files() == before, "{command} changed a file");
    }
}

/// An export brings files of its own names.
#[test]
fn no_export_is_written_over_an_input() {
    let folder = folder();
    let out = Folder::new();
    let place = out.path("").display().to_string();
    let run = folder.volref(&["export", "mesh.toml", "--to", "mitsuba", "-o", &place]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let mut names = out.files().into_keys();
    let written = names.find(|name| !name.ends_with(".xml")).unwrap();
    // A scene whose mesh is called as the export would call it.
    folder.write(&written, folder.read("gem.obj"));
    folder.edit("mesh.toml", "gem.obj", &written);
    let before = folder.files();
    let run = folder.volref("export mesh.toml --to mitsuba -o .");
    if folder.files() != before || run.code == 0 {
        panic!("{} was overwritten: {}{}", written, run.stdout, run.stderr);
    }
    run.expect(2, "it is an input of this command");
}

#[test]
fn no_output_is_written_over_another() {
    let folder = folder();
    std::fs::create_dir(folder.path("out")).unwrap();
    let before = folder.files();
    for command in [
        "render curve.toml -o c.exr --json=c.exr",
        "render curve.toml -o c.exr --json=./c.exr",
        "render curve.toml -o c.exr --json=out/../c.exr",
        "compare a.png b.png --heatmap c.png --json=c.png",
        "verify smoke/plain --json=c.json --junit c.json",
        "verify smoke/plain --json=out/index.html --report out",
        "validate smoke/plain --outputs images --junit out/index.html --report out",
        "cost scene.toml --runs 0 --report out --json=out/index.html",
        "export curve.toml --to bundle -o out --json=out/curve.json",
    ] {
        let run = folder.volref(command);
        run.expect(2, "is the same file as another output");
        assert!(folder.files() == before, "{command} changed a file");
    }
}

#[cfg(unix)]
#[test]
fn an_input_is_known_by_every_name() {
    let folder = folder();
    std::fs::hard_link(folder.path("cloud.obj"), folder.path("hard.json")).unwrap();
    std::os::unix::fs::symlink("cloud.obj", folder.path("soft.json")).unwrap();
    std::os::unix::fs::symlink(".", folder.path("here")).unwrap();
    let whole = folder.path("cloud.obj").display().to_string();
    let before = folder.files();
    for name in [
        "hard.json",
        "soft.json",
        "./cloud.obj",
        "here/here/cloud.obj",
        &whole,
    ] {
        let run = folder.volref(&["info", "cloud.obj", &format!("--json={name}")]);
        run.expect(
            2,
            &[&format!(
                "cannot write {name}: it is an input of this command"
            )],
        );
        assert!(folder.files() == before, "{name} was written over");
    }
    // A link to nowhere, and the file it stands for.
    std::os::unix::fs::symlink("c.exr", folder.path("link.json")).unwrap();
    let run = folder.volref("render curve.toml -o c.exr --json=link.json");
    run.expect(2, "link.json: it is the same file as another output, c.exr");
    // What is no file can be written twice.
    let run = folder.volref("verify smoke/plain --json=/dev/null --junit=/dev/null");
    assert_eq!(run.code, 0, "{}", run.stderr);
}

/// Named pipes and endless devices in the place of files: an error in words, at once.
#[cfg(target_os = "linux")]
#[test]
fn pipes_and_devices_are_not_waited_for() {
    use std::process::Command;
    use std::time::{Duration, Instant};
    let places = [
        ("golden/smoke/plain.exr", "verify smoke/plain"),
        ("golden/smoke/plain.png", "verify smoke/plain"),
        ("golden/smoke/plain.toml", "verify smoke/plain"),
        (
            "golden/smoke/plain.toml",
            "validate smoke/plain --outputs images",
        ),
        ("golden/.lock", "accept smoke/plain --reason again"),
        ("fixtures/cases/smoke/plain.toml", "list"),
        ("fixtures/cases/smoke/plain.toml", "verify smoke/plain"),
        (
            "fixtures/cases/smoke/plain.toml",
            "accept smoke/plain --reason again",
        ),
        ("fixtures/scenes/smoke/plain.toml", "verify smoke/plain"),
        ("fixtures/volumes/cloud.obj", "verify smoke/plain"),
        ("scene.toml", "plan scene.toml"),
        ("apart.nhdr", "info apart.nhdr"),
        ("data.raw", "info apart.nhdr"),
        ("gem.obj", "plan mesh.toml"),
        ("a.exr", "compare a.exr b.exr"),
    ];
    let folder = folder();
    for (place, command) in places {
        let path = folder.path(place);
        let before = std::fs::read(&path).ok();
        for zero in [false, true] {
            let _ = std::fs::remove_file(&path);
            match zero {
                true => std::os::unix::fs::symlink("/dev/zero", &path).unwrap(),
                false => {
                    let made = Command::new("mkfifo").arg(&path).status().unwrap();
                    assert!(made.success());
                }
            }
            let mut child = folder
                .command(command)
                .stdout(std::process::Stdio::piped())
                .stderr(std::process::Stdio::piped())
                .spawn()
                .unwrap();
            // A watchdog, not a measure: without it a failure would never end.
            let patience = Instant::now() + Duration::from_secs(120);
            while child.try_wait().unwrap().is_none() {
                if Instant::now() > patience {
                    child.kill().unwrap();
                    panic!("{command} waits for {place}");
                }
                std::thread::sleep(Duration::from_millis(10));
            }
            let run = crate::folder::Run::of(child.wait_with_output().unwrap());
            let words = format!("{}{}", run.stdout, run.message());
            // A link out of the folder is refused before anybody asks where it leads.
            let name = place.rsplit('/').next().unwrap();
            let (expected, name) = match (place, zero) {
                ("data.raw", true) => ("outside its folder", "/dev/zero"),
                // A file of volref's own is no link, whatever it leads to.
                ("golden/.lock", true) => ("this is a symbolic link, ", name),
                _ => ("this is a device or pipe, ", name),
            };
            assert!(words.contains(expected), "{command}, {place}: {words}");
            assert!([2, 3, 4].contains(&run.code), "{command}, {place}: {words}");
            assert!(words.contains(name), "{command}, {place}: {words}");
        }
        std::fs::remove_file(&path).unwrap();
        if let Some(before) = before {
            folder.write(place, before);
        }
    }
}

/// Files larger than any that is meant are refused by their size, before they are read.
#[cfg(unix)]
#[test]
fn sizes_have_limits() {
    let folder = folder();
    for (place, bytes, command, words) in [
        (
            "scene.toml",
            (1 << 24) + 1,
            "plan scene.toml",
            "scene.toml: cannot read the scene: the file has 16777217 bytes; at most 16777216 are read",
        ),
        (
            "fixtures/cases/smoke/nearest.toml",
            (1 << 20) + 1,
            "list",
            "nearest.toml: cannot read the manifest: the file has 1048577 bytes; at most 1048576 are read",
        ),
        (
            "golden/smoke/plain.png",
            (1 << 30) + 1,
            "verify smoke/plain",
            "",
        ),
    ] {
        let before = folder.read(place);
        let file = std::fs::File::options()
            .write(true)
            .open(folder.path(place))
            .unwrap();
        // Holes take no room on the disk.
        file.set_len(bytes).unwrap();
        let run = folder.volref(command);
        let said = format!("{}{}", run.stdout, run.message());
        assert!([2, 3].contains(&run.code), "{command}: {said}");
        assert!(said.contains(words), "{command}: {said}");
        assert_holds(&said, &[&format!("the file has {bytes} bytes")]);
        folder.write(place, before);
    }
}

/// A decoder that panics spoils one image, and not the run.
#[test]
fn images_that_make_a_decoder_panic_are_unreadable() {
    let folder = Folder::with_goldens();
    for name in ["plain", "nearest"] {
        let golden = folder.read(&format!("golden/smoke/{name}.exr"));
        folder.write(&format!("images/smoke/{name}.exr"), golden);
    }
    for (name, bad) in [
        (
            "plots/curve.png",
            &include_bytes!("../../fixtures/images/bad-palette-length.png")[..],
        ),
        (
            "smoke/shadow.exr",
            include_bytes!("../../fixtures/images/bad-levels-swapped.exr"),
        ),
    ] {
        folder.write(&format!("images/{name}"), bad);
    }
    let run = folder.volref("validate --outputs images --json=r.json");
    assert_eq!(run.code, 4, "{}{}", run.stdout, run.stderr);
    let results = folder.json("r.json");
    let said: Vec<String> = (results["cases"].as_array().unwrap().iter())
        .map(|case| {
            let text = |key: &str| case[key].as_str().unwrap().to_owned();
            format!("{}: {}: {}", text("name"), text("verdict"), text("reason"))
        })
        .collect();
    let said = said.join("\n");
    for part in [
        "plots/curve: error: images/plots/curve.png: not a readable PNG image: it is broken",
        "smoke/shadow: error: images/smoke/shadow.exr: not a readable EXR image: it is broken",
        "smoke/plain: pass",
        "smoke/nearest: pass",
    ] {
        assert!(said.contains(part), "{part} is not in: {said}");
    }
}
