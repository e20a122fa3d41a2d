//! Every file operation of an accept is made to fail, and the machine to stop before it.

use crate::suite::store::*;
use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, HashMap};
use std::fs;
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

#[derive(Clone, Copy, Debug, PartialEq)]
enum DiskFault {
    /// The operation reports a full disk, having written half of the bytes; later ones work.
    Full,
    /// The operation takes place, and yet reports an error; later ones work.
    FalseAlarm,
    /// The process stops before the operation.
    Crash,
    /// The process stops in the middle of a write.
    CrashHalfway,
}

const FAULTS: [DiskFault; 4] = [
    DiskFault::Full,
    DiskFault::FalseAlarm,
    DiskFault::Crash,
    DiskFault::CrashHalfway,
];

/// The real disk until the operation number `at`. Nothing is synced, to be quick: the page
/// cache survives the faults simulated here. For power cuts see `Traced`.
struct Faulty {
    at: usize,
    fault: DiskFault,
    count: Cell<usize>,
}

impl Faulty {
    fn new(at: usize, fault: DiskFault) -> Faulty {
        Faulty {
            at,
            fault,
            count: Cell::new(0),
        }
    }

    fn run(
        &self,
        whole: impl FnOnce() -> io::Result<()>,
        half: impl FnOnce() -> io::Result<()>,
    ) -> io::Result<()> {
        let count = self.count.replace(self.count.get() + 1);
        match self.fault {
            DiskFault::Full if count == self.at => {
                half()?;
                Err(ErrorKind::StorageFull.into())
            }
            DiskFault::FalseAlarm if count == self.at => {
                whole()?;
                Err(io::Error::other("false alarm"))
            }
            DiskFault::CrashHalfway if count == self.at => {
                half()?;
                Err(io::Error::other("stopped"))
            }
            DiskFault::Crash | DiskFault::CrashHalfway if count >= self.at => {
                Err(io::Error::other("stopped"))
            }
            _ => whole(),
        }
    }
}

/// A disk without faults, and without syncs.
fn healthy() -> Faulty {
    Faulty::new(usize::MAX, DiskFault::Crash)
}

impl Disk for &Faulty {
    fn create_synced(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        assert!(!path.exists(), "{path:?} would be overwritten");
        self.run(
            || fs::write(path, bytes),
            || fs::write(path, &bytes[..bytes.len() / 2]),
        )
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.run(|| fs::rename(from, to), || Ok(()))
    }
    fn remove(&self, path: &Path) -> io::Result<()> {
        self.run(|| fs::remove_file(path), || Ok(()))
    }
    fn sync_dir(&self, directory: &Path) -> io::Result<()> {
        self.run(|| fs::read_dir(directory).map(drop), || Ok(()))
    }
    fn create_dir(&self, directory: &Path) -> io::Result<()> {
        self.run(|| fs::create_dir(directory), || Ok(()))
    }
}

/// Publishes `after` over `before` with a fault at each operation in turn, in a world made by
/// `prepare`, and checks what readers see, what the error says and that the next accept mends.
fn every_fault(
    faults: &[DiskFault],
    prepare: &dyn Fn() -> (TempDir, PathBuf),
    before: Option<&str>,
    after: &str,
) {
    for &fault in faults {
        let mut seen_old = 0;
        let mut seen_new = 0;
        for at in 0.. {
            let (_directory, root) = prepare();
            assert_eq!(seen(&root).as_deref(), before);
            let disk = Faulty::new(at, fault);
            let result = Store::on_disk(&root, &disk).publish(&files(after));
            let now = seen(&root);
            let context = format!("{fault:?} at {at}: {result:?}");
            match &result {
                Ok(()) => assert_eq!(now.as_deref(), Some(after), "{context}"),
                Err(StoreError::Untouched(_)) => assert_eq!(now.as_deref(), before, "{context}"),
                Err(StoreError::Unfinished(_)) => {
                    assert_eq!(now.as_deref(), Some(after), "{context}");
                }
                Err(_) => panic!("{context}"),
            }
            if fault == DiskFault::Full
                && let Err(error) = &result
            {
                let message = error.to_string();
                assert!(
                    message.contains("free some space and run the same command"),
                    "{message}"
                );
            }
            if now.as_deref() == before {
                seen_old += 1
            } else {
                seen_new += 1
            }

            // Recovery alone changes nothing that is seen, and leaves nothing behind.
            Store::on_disk(&root, &healthy())
                .publish::<PathBuf>(&[])
                .unwrap();
            assert_only(&root, now.as_deref());
            Store::on_disk(&root, &healthy())
                .publish(&files("newer"))
                .unwrap();
            assert_only(&root, Some("newer"));

            if disk.count.get() <= at {
                assert!(result.is_ok(), "{context}");
                break;
            }
        }
        // The test itself: faults came before as well as after the decision.
        assert!(
            seen_old > 5 && seen_new > 5,
            "{seen_old} old, {seen_new} new"
        );
    }
}

#[test]
fn replaces_all_or_nothing_whatever_fails() {
    every_fault(&FAULTS, &|| world(Some("old")), Some("old"), "new");
}

#[test]
fn creates_all_or_nothing_whatever_fails() {
    every_fault(&FAULTS, &|| world(None), None, "new");
}

/// A crash of the first accept at every operation, then one of the second at every operation.
#[test]
fn recovers_all_or_nothing_whatever_fails() {
    for at in 0.. {
        let crashed = || {
            let (directory, root) = world(Some("old"));
            let disk = Faulty::new(at, DiskFault::CrashHalfway);
            let result = Store::on_disk(&root, &disk).publish(&files("new"));
            (directory, root, result)
        };
        let (_directory, root, result) = crashed();
        if result.is_ok() {
            break;
        }
        let before = seen(&root);
        let prepare = || {
            let (directory, root, _) = crashed();
            (directory, root)
        };
        every_fault(
            &[DiskFault::CrashHalfway],
            &prepare,
            before.as_deref(),
            "newer",
        );
    }
}

/// An error before the decision removes by itself what it left aside.
#[test]
fn a_full_disk_leaves_no_stray_file() {
    for at in 0.. {
        let (_directory, root) = world(Some("old"));
        let disk = Faulty::new(at, DiskFault::Full);
        match Store::on_disk(&root, &disk).publish(&files("new")) {
            Err(StoreError::Untouched(_)) => assert_only(&root, Some("old")),
            _ => break,
        }
    }
}

/// One change of a name in a directory, atomic as such, lost by a power cut until synced.
#[derive(Clone, Debug)]
enum StoredChange {
    Put(PathBuf, Vec<u8>),
    Rename(PathBuf, PathBuf, Vec<u8>),
    Remove(PathBuf),
    Sync(PathBuf),
}

impl StoredChange {
    /// The directory whose sync makes the change durable.
    fn directory(&self) -> Option<&Path> {
        match self {
            StoredChange::Put(path, _)
            | StoredChange::Rename(_, path, _)
            | StoredChange::Remove(path) => path.parent(),
            StoredChange::Sync(_) => None,
        }
    }

    fn replay(&self) {
        match self {
            StoredChange::Put(path, bytes) => fs::write(path, bytes).unwrap(),
            StoredChange::Rename(from, to, bytes) => {
                let _ = fs::remove_file(from);
                fs::write(to, bytes).unwrap();
            }
            StoredChange::Remove(path) => drop(fs::remove_file(path)),
            StoredChange::Sync(_) => {}
        }
    }
}

/// The real disk, noting what is done.
#[derive(Default)]
struct Traced {
    trace: RefCell<Vec<StoredChange>>,
}

impl Disk for &Traced {
    fn create_synced(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.trace
            .borrow_mut()
            .push(StoredChange::Put(path.into(), bytes.into()));
        fs::write(path, bytes)
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        let change = StoredChange::Rename(from.into(), to.into(), fs::read(from)?);
        self.trace.borrow_mut().push(change);
        fs::rename(from, to)
    }
    fn remove(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)?;
        self.trace
            .borrow_mut()
            .push(StoredChange::Remove(path.into()));
        Ok(())
    }
    fn sync_dir(&self, directory: &Path) -> io::Result<()> {
        self.trace
            .borrow_mut()
            .push(StoredChange::Sync(directory.into()));
        Ok(())
    }
    fn create_dir(&self, directory: &Path) -> io::Result<()> {
        fs::create_dir(directory)
    }
}

/// Publishes over what the root holds, and then cuts the power after each operation, losing
/// each combination of the changes not yet synced.
fn every_power_cut(root: &Path, files: &FileContents, after: Option<&str>) {
    let start = tree(root);
    let disk = Traced::default();
    Store::on_disk(root, &disk).publish(files).unwrap();
    let trace = disk.trace.into_inner();

    for cut in 0..=trace.len() {
        let mut unsynced: HashMap<&Path, Vec<usize>> = HashMap::new();
        for (index, change) in trace[..cut].iter().enumerate() {
            match change {
                StoredChange::Sync(directory) => drop(unsynced.remove(directory.as_path())),
                change => unsynced
                    .entry(change.directory().unwrap())
                    .or_default()
                    .push(index),
            }
        }
        let unsynced: Vec<usize> = unsynced.into_values().flatten().collect();
        for lost in 0..1_usize << unsynced.len() {
            fs::remove_dir_all(root).unwrap();
            write_plainly(root, &start.clone().into_iter().collect());
            for (index, change) in trace[..cut].iter().enumerate() {
                let bit = unsynced.iter().position(|unsynced| *unsynced == index);
                if bit.is_none_or(|bit| lost >> bit & 1 == 0) {
                    change.replay();
                }
            }
            let now = seen(root);
            Store::on_disk(root, &healthy())
                .publish::<PathBuf>(&[])
                .unwrap();
            assert_only(root, now.as_deref());
        }
        if cut == trace.len() {
            assert!(
                unsynced.is_empty(),
                "success was reported before it was durable"
            );
            assert_eq!(seen(root).as_deref(), after);
        }
    }
}

#[test]
fn survives_power_cuts_that_lose_whatever_was_not_synced() {
    let (_directory, root) = world(Some("old"));
    every_power_cut(&root, &files("new"), Some("new"));
}

/// The same while an accept that crashed is completed or undone.
#[test]
fn survives_power_cuts_during_recovery() {
    for at in 0.. {
        let (_directory, root) = world(Some("old"));
        let disk = Faulty::new(at, DiskFault::CrashHalfway);
        let result = Store::on_disk(&root, &disk).publish(&files("new"));
        let now = seen(&root);
        every_power_cut(&root, &Vec::new(), now.as_deref());
        if result.is_ok() {
            break;
        }
    }
}

/// Leaves a journal and staged files, as a crash right after the decision does.
fn interrupted() -> (TempDir, PathBuf) {
    for at in 0.. {
        let (directory, root) = world(Some("old"));
        let disk = Faulty::new(at, DiskFault::Crash);
        let _ = Store::on_disk(&root, &disk).publish(&files("new"));
        if root.join(JOURNAL).exists() {
            return (directory, root);
        }
    }
    unreachable!()
}

/// Reading and accepting are both refused, changing nothing; returns the message.
fn refusal(root: &Path) -> String {
    let before = tree(root);
    let read = Store::open(root)
        .read(Path::new("box/one.exr"))
        .unwrap_err()
        .to_string();
    let publish = Store::open(root)
        .publish(&files("newer"))
        .unwrap_err()
        .to_string();
    assert_eq!(tree(root), before);
    assert_eq!(read, publish);
    read
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
fn a_file_that_an_interrupted_accept_does_not_list_is_read_from_its_place() {
    let (_directory, root) = interrupted();
    fs::write(root.join("box/three.exr"), b"three").unwrap();
    let bytes = Store::open(&root).read(Path::new("box/three.exr")).unwrap();
    assert_eq!(bytes.as_deref(), Some(&b"three"[..]));
}

#[test]
fn a_cut_off_journal_is_refused() {
    let (_directory, root) = interrupted();
    let journal = root.join(JOURNAL);
    let text = fs::read(&journal).unwrap();
    for length in [0, 1, text.len() / 2, text.len() - 1] {
        fs::write(&journal, &text[..length]).unwrap();
        let message = refusal(&root);
        assert!(message.contains("accept.journal, line"), "{message}");
        assert!(
            message.contains("restore the goldens from version control"),
            "{message}"
        );
    }
}

#[test]
fn a_journal_that_leads_out_of_the_root_is_refused() {
    for path in ["../outside.exr", "/outside.exr", "box/../../outside.exr"] {
        let (directory, root) = interrupted();
        let journal = root.join(JOURNAL);
        let text = fs::read_to_string(&journal).unwrap();
        fs::write(&journal, text.replace("index.toml", path)).unwrap();
        let message = refusal(&root);
        assert!(message.contains(path), "{message}");
        assert!(!directory.path().join("outside.exr").exists());
    }
}

/// For instance by `git checkout golden` after a crash: some files would be old, some new.
#[test]
fn goldens_restored_by_hand_under_a_journal_are_noticed() {
    let (_directory, root) = interrupted();
    for (path, _) in tree(&root) {
        if path
            .file_name()
            .unwrap()
            .to_str()
            .unwrap()
            .starts_with(".one.exr")
        {
            fs::remove_file(path).unwrap();
        }
    }
    let message = refusal(&root);
    assert!(
        message.contains("one.exr does not have the contents"),
        "{message}"
    );
}

#[test]
fn a_second_accept_at_the_same_time_is_refused() {
    let (_directory, root) = world(Some("old"));
    let held = Store::open(&root).lock().unwrap();
    let error = Store::open(&root).publish(&files("new")).unwrap_err();
    assert!(matches!(error, StoreError::Locked { .. }), "{error}");
    assert!(
        error.to_string().contains("another accept is running"),
        "{error}"
    );
    assert_only(&root, Some("old"));
    drop(held);
    Store::open(&root).publish(&files("new")).unwrap();
    assert_only(&root, Some("new"));
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
fn refuses_names_that_are_no_goldens_and_names_given_twice() {
    let (_directory, root) = world(None);
    let store = Store::open(&root);
    for path in ["../a", "/a", "", "accept.journal", ".lock"] {
        let refused = |error| matches!(error, StoreError::Name { .. });
        assert!(
            refused(store.read(Path::new(path)).unwrap_err()),
            "{path:?}"
        );
        assert!(
            refused(store.publish(&[(path, Vec::new())]).unwrap_err()),
            "{path:?}"
        );
    }
    let twice = store
        .publish(&[("a/b", vec![1]), ("a/./b", vec![2])])
        .unwrap_err();
    assert!(matches!(twice, StoreError::Twice { .. }), "{twice}");
    assert!(!root.exists());
}

/// A user's file that looks like a staged one is not the store's to remove.
#[test]
fn keeps_files_it_did_not_write() {
    let (_directory, root) = interrupted();
    let lookalike = root.join("box/.one.exr.1-2.volref-new");
    fs::write(&lookalike, b"mine").unwrap();
    Store::open(&root).publish(&files("newer")).unwrap();
    assert_eq!(fs::read(lookalike).unwrap(), b"mine");
}

#[test]
fn readers_see_no_mixture_while_accepts_run() {
    let (_directory, root) = world(Some("old"));
    std::thread::scope(|scope| {
        let writer = scope.spawn(|| {
            for version in ["new", "newer", "old"].iter().cycle().take(60) {
                Store::on_disk(&root, &healthy())
                    .publish(&files(version))
                    .unwrap();
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
