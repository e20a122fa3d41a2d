//! An accept is stopped at every moment, or killed: readers see the old files or the new ones.

use crate::suite::store::*;
use std::collections::BTreeMap;
use tempfile::TempDir;

const ROOT: &str = "golden";

type FileContents = Vec<(PathBuf, Vec<u8>)>;

/// Two cases in two directories and a file in the root.
fn files(version: &str) -> FileContents {
    let paths = [
        "box/one.exr",
        "box/one.toml",
        "deep/er/two.exr",
        "index.toml",
    ];
    // Different lengths, and one file which does not change between versions.
    let contents = |path| match path {
        "box/one.toml" => "unchanged".to_owned(),
        _ => format!("{version} contents of {path}"),
    };
    paths
        .iter()
        .map(|path| (path.into(), contents(*path).into()))
        .collect()
}

/// A temporary directory whose golden root holds the given version of all files.
fn world(version: Option<&str>) -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let root = directory.path().join(ROOT);
    if let Some(version) = version {
        write_plainly(&root, &files(version));
    }
    (directory, root)
}

fn write_plainly(root: &Path, files: &FileContents) {
    for (path, bytes) in files {
        let path = root.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

/// The version that a fresh reader sees; `None` if it sees no file. Panics on a mixture, and
/// if reading changes anything.
fn seen(root: &Path) -> Option<String> {
    let before = tree(root);
    let version = seen_meanwhile(root);
    assert_eq!(tree(root), before, "reading changed something");
    version
}

/// The same while others write.
fn seen_meanwhile(root: &Path) -> Option<String> {
    let paths: Vec<PathBuf> = files("").into_iter().map(|(path, _)| path).collect();
    let contents = Store::open(root).read_all(&paths).unwrap();
    if contents.iter().all(Option::is_none) {
        return None;
    }
    for version in ["old", "new", "newer"] {
        let expected = files(version).into_iter().map(|(_, bytes)| Some(bytes));
        if contents.iter().cloned().eq(expected) {
            return Some(version.to_owned());
        }
    }
    let contents = contents
        .iter()
        .map(|bytes| bytes.as_deref().map(String::from_utf8_lossy));
    panic!(
        "a mixture: {:#?}\nof {:#?}",
        contents.collect::<Vec<_>>(),
        tree(root)
    );
}

/// All files under the directory, with their contents.
fn tree(directory: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut open = vec![directory.to_path_buf()];
    while let Some(directory) = open.pop() {
        let Ok(entries) = fs::read_dir(&directory) else {
            continue;
        };
        for path in entries.map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                open.push(path);
            } else {
                files.insert(path.clone(), fs::read(&path).unwrap());
            }
        }
    }
    files
}

/// Panics if the root holds anything but the files of this version, the lock, and what hides it.
fn assert_only(root: &Path, version: Option<&str>) {
    let expected = version.map(files).unwrap_or_default();
    let mut expected: BTreeMap<PathBuf, Vec<u8>> = expected
        .into_iter()
        .map(|(path, bytes)| (root.join(path), bytes))
        .collect();
    expected.insert(root.join(LOCK), Vec::new());
    let mut found = tree(root);
    found.entry(root.join(LOCK)).or_default();
    // It hides the lock from version control.
    found.remove(&root.join(".gitignore"));
    assert_eq!(found, expected);
}

/// What an accept of "new" may leave in `folder` when it is stopped: its last files, as many as `count`, the last one
/// cut off if it `is_cut`.
fn leave(root: &Path, folder: &str, count: usize, is_cut: bool) {
    let mut files = files("new");
    files.drain(..files.len() - count);
    if let Some((_, bytes)) = files.last_mut().filter(|_| is_cut) {
        bytes.truncate(3);
    }
    fs::create_dir_all(root.join(folder)).unwrap();
    write_plainly(&root.join(folder), &files);
}

/// The next accept leaves what readers saw before it, and nothing else.
fn assert_mended(root: &Path, version: Option<&str>) {
    assert_eq!(seen(root).as_deref(), version);
    Store::open(root).publish::<PathBuf>(&[]).unwrap();
    assert_only(root, version);
    Store::open(root).publish(&files("newer")).unwrap();
    assert_only(root, Some("newer"));
}

#[test]
fn an_accept_that_is_not_decided_is_undone() {
    for before in [None, Some("old")] {
        for count in 0..=files("").len() {
            for is_cut in [false, true] {
                let (_directory, root) = world(before);
                leave(&root, NEW, count, is_cut);
                assert_mended(&root, before);
            }
        }
    }
}

#[test]
fn an_accept_that_is_decided_is_completed() {
    let new = files("new");
    for before in [None, Some("old")] {
        for count in 0..=new.len() {
            let (_directory, root) = world(before);
            leave(&root, DECIDED, count, false);
            write_plainly(&root, &new[..new.len() - count].to_vec());
            assert_mended(&root, Some("new"));
        }
    }
}

/// By a link in its place an accept would move files of others.
#[cfg(unix)]
#[test]
fn a_link_in_the_place_of_a_decided_accept_is_refused() {
    let (directory, root) = world(Some("old"));
    let mine = directory.path().join("mine");
    write_plainly(&mine, &files("mine"));
    std::os::unix::fs::symlink(&mine, root.join(DECIDED)).unwrap();
    let before = tree(&mine);
    let error = Store::open(&root).publish(&files("new")).unwrap_err();
    assert!(error.to_string().contains("a symbolic link"), "{error}");
    assert_eq!(tree(&mine), before);
}

/// Two accepts at once write one after the other.
#[test]
fn a_second_accept_waits_for_the_first() {
    let (_directory, root) = world(Some("old"));
    let held = Store::open(&root).lock().unwrap();
    std::thread::scope(|scope| {
        let second = scope.spawn(|| Store::open(&root).publish(&files("new")).unwrap());
        std::thread::sleep(std::time::Duration::from_millis(50));
        assert!(!second.is_finished());
        assert_only(&root, Some("old"));
        drop(held);
    });
    assert_only(&root, Some("new"));
}

#[test]
fn reads_absent_files_as_none() {
    let (_directory, root) = world(None);
    assert_eq!(
        Store::open(&root).read(Path::new("box/one.exr")).unwrap(),
        None
    );
    assert!(!root.exists());
}

#[test]
fn a_file_in_the_place_of_a_directory_is_refused_before_anything_is_replaced() {
    let (_directory, root) = world(Some("old"));
    let mut files = files("new");
    files.push(("index.toml/three.exr".into(), b"three".into()));
    let error = Store::open(&root).publish(&files).unwrap_err();
    assert!(matches!(error, StoreError::Untouched(_)), "{error}");
    assert!(error.to_string().contains("index.toml"), "{error}");
    assert_only(&root, Some("old"));
}

#[test]
fn a_directory_in_the_place_of_a_file_is_refused_before_anything_is_replaced() {
    let (_directory, root) = world(Some("old"));
    let mut files = files("new");
    files.push(("box".into(), b"three".into()));
    let error = Store::open(&root).publish(&files).unwrap_err();
    assert!(matches!(error, StoreError::Untouched(_)), "{error}");
    assert_only(&root, Some("old"));
}

#[test]
fn a_file_in_the_place_of_the_root_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let root = directory.path().join(ROOT);
    fs::write(&root, b"a file").unwrap();
    let error = Store::open(&root).publish(&files("new")).unwrap_err();
    assert!(matches!(error, StoreError::Untouched(_)), "{error}");
    assert_eq!(fs::read(&root).unwrap(), b"a file");
}

#[test]
fn readers_see_no_mixture_while_accepts_run() {
    let (_directory, root) = world(Some("old"));
    std::thread::scope(|scope| {
        let writer = scope.spawn(|| {
            for version in ["new", "newer", "old"].iter().cycle().take(60) {
                Store::open(&root).publish(&files(version)).unwrap();
            }
        });
        while !writer.is_finished() {
            assert!(seen_meanwhile(&root).is_some());
        }
    });
}

/// Set for the process that the next test starts, to the root it is to write to.
const CHILD: &str = "VOLREF_TEST_STORE_CHILD";

/// Not a test of its own, and over at once unless started by the next one: accepts for longer
/// than it is going to live.
#[test]
fn accept_until_killed() {
    let Some(root) = std::env::var_os(CHILD) else {
        return;
    };
    // It ends by itself if the test that started it failed.
    let start = std::time::Instant::now();
    for version in ["new", "newer"].iter().cycle() {
        if start.elapsed().as_secs() >= 20 {
            return;
        }
        Store::open(&root).publish(&files(version)).unwrap();
    }
}

#[test]
fn a_killed_process_leaves_old_or_new_and_no_lock() {
    let (_directory, root) = world(Some("old"));
    for round in 0..8 {
        let mut child = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "suite::store::tests::accept_until_killed"])
            .env(CHILD, &root)
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        // Not before it has begun, and each time at another moment of an accept.
        while seen_meanwhile(&root).as_deref() == Some("old") {
            assert!(child.try_wait().unwrap().is_none(), "ended by itself");
            std::thread::yield_now();
        }
        std::thread::sleep(std::time::Duration::from_micros(1733 * round));
        child.kill().unwrap();
        child.wait().unwrap();

        let now = seen(&root);
        Store::open(&root).publish::<PathBuf>(&[]).unwrap();
        assert_only(&root, now.as_deref());
        Store::open(&root).publish(&files("old")).unwrap();
        assert_only(&root, Some("old"));
    }
}
