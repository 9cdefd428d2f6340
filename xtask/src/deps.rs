//! Which compiled dependencies has another clone on this machine left for this one?
//!
//! They lie under `${XDG_CACHE_HOME:-~/.cache}/foveal/deps`, laid out as cargo lays out a target
//! folder. Cargo judges what comes from there by its own fingerprints, so a file that does not fit
//! costs time and nothing else. Our own crates never go there, and `FOVEAL_DEPS_CACHE=off` turns it
//! off.

use std::collections::hash_map::DefaultHasher;
use std::collections::{HashMap, HashSet};
use std::env;
use std::fs::{self, File, FileTimes};
use std::hash::{Hash, Hasher};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{self, Command};
use std::time::SystemTime;

use crate::steps::{Outcome, cargo, output_of, repository_root};
use crate::tidy::workspace_metadata;

const SWITCH: &str = "FOVEAL_DEPS_CACHE";
/// Most sets of dependencies that are kept, each of one lock file and compiler.
const MOST_SETS: usize = 3;
/// Most bytes of all sets together; a set takes 1 to 2 GB.
const MOST_BYTES: u64 = 8 << 30;
/// A file of each set whose time is that of the set's last use.
const USED: &str = "used";
/// Libraries of the system that build scripts look at.
const LIBRARIES: [&str; 6] = [
    "libavcodec",
    "libavformat",
    "libavutil",
    "libswscale",
    "libswresample",
    "alsa",
];
/// What changes how everything is compiled.
const VARIABLES: [&str; 6] = [
    "CARGO_HOME",
    "RUSTFLAGS",
    "CARGO_ENCODED_RUSTFLAGS",
    "CARGO_BUILD_RUSTFLAGS",
    "CC",
    "CFLAGS",
];

/// Two places of this tree's dependencies.
pub(crate) struct Deps {
    /// In the store, those of this lock file and compiler.
    set: PathBuf,
    /// Where cargo builds in this clone.
    target: PathBuf,
    /// Packages of the workspace, which stay in the clone.
    own: HashSet<String>,
}

impl Deps {
    /// Why [`Self::of_this_tree`] gives none.
    pub(crate) const WHY_NOT: &str = "FOVEAL_DEPS_CACHE is off, or there is no home for a cache";

    /// `None` where the store is turned off or has no place.
    pub(crate) fn of_this_tree() -> Option<Self> {
        if env::var_os(SWITCH).is_some_and(|value| value == "off") {
            return None;
        }
        let metadata = workspace_metadata().ok()?;
        let names = metadata["packages"].as_array()?.iter();
        Some(Self {
            set: store()?.join(key().ok()?),
            target: metadata["target_directory"].as_str()?.into(),
            own: names
                .filter_map(|p| Some(p["name"].as_str()?.to_owned()))
                .collect(),
        })
    }

    /// Fetches what the clone lacks, and says how much that was.
    pub(crate) fn restore(&self) -> Outcome {
        let count = copy_units(&self.set, &self.target, &self.own);
        println!("deps: {count} compiled before on this machine");
        let _ = fs::create_dir_all(&self.set).and_then(|()| fs::write(self.set.join(USED), ""));
        Ok(())
    }

    /// Leaves what the store lacks for other clones, and makes room for it.
    pub(crate) fn keep(&self) {
        let count = copy_units(&self.target, &self.set, &self.own);
        println!(
            "deps: {count} kept for other clones in {}",
            self.set.display()
        );
        if let Some(store) = self.set.parent() {
            make_room(store, &self.set, MOST_SETS, MOST_BYTES);
        }
    }
}

fn store() -> Option<PathBuf> {
    let named = env::var_os("XDG_CACHE_HOME").map(PathBuf::from);
    let usual = || Some(Path::new(&env::var_os("HOME")?).join(".cache"));
    let cache = named.filter(|path| path.is_absolute()).or_else(usual)?;
    Some(cache.join("foveal").join("deps"))
}

/// The name of the dependencies that this tree is built with, by this compiler. Features and
/// profiles need no part in it: cargo names what it compiles after them.
fn key() -> Result<String, String> {
    let mut hasher = DefaultHasher::new();
    output_of(Command::new("rustc").arg("-vV"))?.hash(&mut hasher);
    output_of(&mut cargo(&["-V"]))?.hash(&mut hasher);
    for file in ["Cargo.lock", ".cargo/config.toml"] {
        let bytes = fs::read(repository_root().join(file));
        bytes.unwrap_or_default().hash(&mut hasher);
    }
    for name in VARIABLES {
        env::var_os(name).hash(&mut hasher);
    }
    let mut versions = Command::new("pkg-config");
    let versions = versions.arg("--modversion").args(LIBRARIES).output();
    versions
        .map_or(Vec::new(), |said| said.stdout)
        .hash(&mut hasher);
    Ok(format!("{:016x}", hasher.finish()))
}

/// Copies each compiled unit that `to` lacks, but those of `own` packages; returns how many.
/// A unit that cannot be copied is left out: cargo compiles it.
fn copy_units(from: &Path, to: &Path, own: &HashSet<String>) -> usize {
    // One time for all: cargo compiles what is older than something that it is made of.
    let now = SystemTime::now();
    let mut count = 0;
    for lane in lanes(from) {
        let [from, to] = [from, to].map(|folder| folder.join(&lane));
        let outputs = outputs_by_hash(&from.join("deps"));
        for unit in names(&from.join(FINGERPRINTS)) {
            let Some((package, hash)) = unit.rsplit_once('-') else {
                continue;
            };
            if own.contains(package) || to.join(FINGERPRINTS).join(&unit).exists() {
                continue;
            }
            let outputs = outputs.get(hash).map_or(&[][..], Vec::as_slice);
            count += usize::from(copy_unit(&from, &to, &unit, outputs, now).is_ok());
        }
    }
    count
}

const FINGERPRINTS: &str = ".fingerprint";

/// Where cargo builds below a target folder: `debug`, `wasm32-unknown-unknown/web` and so on.
fn lanes(target: &Path) -> Vec<PathBuf> {
    let nested = |outer: String| {
        let inner = names(&target.join(&outer)).into_iter();
        let inner: Vec<_> = inner.map(|name| Path::new(&outer).join(name)).collect();
        [vec![PathBuf::from(outer)], inner].concat()
    };
    let all = names(target).into_iter().flat_map(nested);
    all.filter(|lane| target.join(lane).join(FINGERPRINTS).is_dir())
        .collect()
}

/// The files of `deps` by the hash that ends their stem, as in `libserde-0123456789abcdef.rlib`.
fn outputs_by_hash(deps: &Path) -> HashMap<String, Vec<String>> {
    let mut outputs: HashMap<String, Vec<String>> = HashMap::new();
    for name in names(deps) {
        let stem = name.split('.').next().unwrap_or_default();
        if let Some((_, hash)) = stem.rsplit_once('-') {
            outputs.entry(hash.to_owned()).or_default().push(name);
        }
    }
    outputs
}

/// Copies a unit whole; its fingerprint, which says that it is there, comes last.
fn copy_unit(
    from: &Path,
    to: &Path,
    unit: &str,
    outputs: &[String],
    now: SystemTime,
) -> io::Result<()> {
    let fingerprint = Path::new(FINGERPRINTS).join(unit);
    // Cargo writes it when the unit is finished.
    let is_finished = |name: &String| name.ends_with(".json");
    if !names(&from.join(&fingerprint)).iter().any(is_finished) {
        return Err(io::ErrorKind::NotFound.into());
    }
    let build = Path::new("build").join(unit);
    let deps = outputs.iter().map(|name| Path::new("deps").join(name));
    for path in deps.chain([build, fingerprint]) {
        if from.join(&path).exists() {
            copy(&from.join(&path), &to.join(&path), now)?;
        }
    }
    Ok(())
}

/// Copies a file or a folder under another name first, so that what has its name is whole.
fn copy(from: &Path, to: &Path, now: SystemTime) -> io::Result<()> {
    let mut growing = to.as_os_str().to_owned();
    growing.push(format!(".{}", process::id()));
    let growing = PathBuf::from(growing);
    fs::create_dir_all(to.parent().unwrap_or(to))?;
    let copied = copy_tree(from, &growing, now).and_then(|()| fs::rename(&growing, to));
    if copied.is_err() {
        let _ = fs::remove_dir_all(&growing).or_else(|_| fs::remove_file(&growing));
    }
    // Another clone was first.
    if to.exists() { Ok(()) } else { copied }
}

fn copy_tree(from: &Path, to: &Path, now: SystemTime) -> io::Result<()> {
    if !from.is_dir() {
        fs::copy(from, to)?;
        return File::options()
            .write(true)
            .open(to)?
            .set_times(FileTimes::new().set_modified(now));
    }
    fs::create_dir_all(to)?;
    for name in names(from) {
        copy_tree(&from.join(&name), &to.join(&name), now)?;
    }
    Ok(())
}

/// Removes sets that were not used for longest, but never `current`.
fn make_room(store: &Path, current: &Path, most_sets: usize, most_bytes: u64) {
    let used = |set: &PathBuf| {
        fs::metadata(set.join(USED))
            .and_then(|file| file.modified())
            .ok()
    };
    let mut sets: Vec<PathBuf> = names(store).iter().map(|name| store.join(name)).collect();
    sets.sort_by_key(|set| (set == current, used(set)));
    let mut bytes = 0;
    for (number, set) in sets.iter().rev().enumerate() {
        bytes += bytes_in(set);
        if set != current && (number >= most_sets || bytes > most_bytes) {
            let _ = fs::remove_dir_all(set);
        }
    }
}

fn bytes_in(path: &Path) -> u64 {
    match path.is_dir() {
        true => names(path)
            .iter()
            .map(|name| bytes_in(&path.join(name)))
            .sum(),
        false => fs::metadata(path).map_or(0, |file| file.len()),
    }
}

/// What lies in a folder; nothing where there is none.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// A folder that goes away with the value.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = env::temp_dir().join(format!("foveal-deps-{}-{name}", process::id()));
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        fn write(&self, path: &str) {
            let path = self.0.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "bytes").unwrap();
        }

        fn has(&self, path: &str) -> bool {
            self.0.join(path).exists()
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn own() -> HashSet<String> {
        HashSet::from(["foveal-core".to_owned()])
    }

    /// What cargo leaves of a finished unit.
    fn compile(target: &Folder, package: &str, hash: &str) {
        target.write(&format!("debug/.fingerprint/{package}-{hash}/lib-it.json"));
        target.write(&format!(
            "debug/deps/lib{}-{hash}.rlib",
            package.replace('-', "_")
        ));
        target.write(&format!("debug/build/{package}-{hash}/out/made.rs"));
    }

    #[test]
    fn another_clone_gets_dependencies_whole_and_none_of_our_own_crates() {
        let [one, store, two] = ["one", "store", "two"].map(Folder::new);
        compile(&one, "half", "0a");
        compile(&one, "foveal-core", "0b");
        one.write("debug/deps/libother-0c.rlib");
        assert_eq!(copy_units(&one.0, &store.0, &own()), 1);
        assert_eq!(copy_units(&store.0, &two.0, &own()), 1);
        for path in [
            "debug/.fingerprint/half-0a/lib-it.json",
            "debug/deps/libhalf-0a.rlib",
            "debug/build/half-0a/out/made.rs",
        ] {
            assert!(two.has(path), "{path}");
        }
        assert_eq!(names(&two.0.join("debug/deps")).len(), 1);
        assert_eq!(
            copy_units(&store.0, &two.0, &own()),
            0,
            "nothing is copied twice"
        );
    }

    #[test]
    fn what_was_not_compiled_to_its_end_is_not_kept() {
        let [one, store] = ["unfinished", "empty"].map(Folder::new);
        one.write("debug/.fingerprint/half-0a/invoked.timestamp");
        one.write("debug/deps/libhalf-0a.rmeta");
        assert_eq!(copy_units(&one.0, &store.0, &own()), 0);
        assert!(!store.has("debug"));
    }

    #[test]
    fn all_that_is_restored_has_one_time() {
        let [one, two] = ["times", "same"].map(Folder::new);
        compile(&one, "first", "0a");
        std::thread::sleep(Duration::from_millis(20));
        compile(&one, "second", "0b");
        copy_units(&one.0, &two.0, &own());
        let time = |path: &str| fs::metadata(two.0.join(path)).unwrap().modified().unwrap();
        let first = time("debug/deps/libfirst-0a.rlib");
        assert_eq!(first, time("debug/deps/libsecond-0b.rlib"));
        assert_eq!(first, time("debug/.fingerprint/second-0b/lib-it.json"));
    }

    #[test]
    fn the_sets_used_last_stay_and_the_current_one_always_does() {
        let store = Folder::new("room");
        for set in ["old", "newer", "newest"] {
            store.write(&format!("{set}/{USED}"));
            std::thread::sleep(Duration::from_millis(20));
        }
        let current = store.0.join("old");
        make_room(&store.0, &current, 2, u64::MAX);
        assert!(store.has("old") && store.has("newest") && !store.has("newer"));
        make_room(&store.0, &current, 2, 1);
        assert_eq!(names(&store.0), ["old"]);
    }
}
