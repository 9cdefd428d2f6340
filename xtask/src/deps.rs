//! Which compiled dependencies has another clone on this machine left for this one?
//!
//! They lie under `${XDG_CACHE_HOME:-~/.cache}/foveal/deps`, laid out as cargo lays out a target
//! folder. What was compiled in one clone fits together, what was compiled in two may not: so a set
//! comes from one clone whole and never changes, and a clone takes from it what is for profiles
//! for which it has compiled nothing yet. What is missing of a set costs time and nothing else, as
//! cargo looks at everything itself. Our own crates never go there. `FOVEAL_DEPS_CACHE=off` turns
//! it off.

use std::collections::hash_map::DefaultHasher;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::env;
use std::ffi::OsStr;
use std::fs::{self, File, FileTimes};
use std::hash::{Hash, Hasher};
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, SystemTime};

use crate::steps::{Outcome, cargo, output_of, repository_root, workspace_metadata};

const SWITCH: &str = "FOVEAL_DEPS_CACHE";
/// Most sets of dependencies that are kept, each of one lock file and compiler.
const MOST_SETS: usize = 3;
/// Most bytes of all sets together; a set takes 1 to 2 GB.
const MOST_BYTES: u64 = 8 << 30;
/// A file of each set whose time is that of the set's last use.
const USED: &str = "used";
/// What the name of a set begins with while it grows.
const GROWING: &str = "growing-";
/// How long a set may grow before it counts as left behind by a stopped run.
const GROWS: Duration = Duration::from_secs(3600);
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
    /// Where sets lie.
    store: PathBuf,
    /// What the names of the sets of this lock file and compiler begin with.
    key: String,
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
            store: store()?,
            key: key().ok()?,
            target: metadata["target_directory"].as_str()?.into(),
            own: names
                .filter_map(|p| Some(p["name"].as_str()?.to_owned()))
                .collect(),
        })
    }

    /// Fetches dependencies for profiles that the clone has none for, and says how many.
    pub(crate) fn restore(&self) -> Outcome {
        let mut count = 0;
        if let Some(set) = self.sets().first() {
            let profile = |(lane, _): &Unit| lane.file_name().map(OsStr::to_owned);
            let ours: HashSet<_> = self.units(&self.target).iter().map(profile).collect();
            let mut theirs = self.units(set);
            theirs.retain(|unit| !ours.contains(&profile(unit)));
            let _ = fs::write(set.join(USED), "");
            count = copy_units(set, &self.target, theirs);
        }
        println!("deps: {count} compiled before on this machine");
        Ok(())
    }

    /// Leaves all of this clone for others, where the set that is there lacks some of it.
    pub(crate) fn keep(&self) {
        let ours = self.units(&self.target);
        let kept = |set: &PathBuf| ours.is_subset(&self.units(set));
        if !ours.is_empty() && !self.sets().first().is_some_and(kept) {
            let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
            let number = now.unwrap_or_default().as_nanos();
            let name = format!("{}-{number:024}", self.key);
            let growing = self.store.join(format!("{GROWING}{name}"));
            let count = copy_units(&self.target, &growing, ours);
            let used = fs::write(growing.join(USED), "");
            if used.is_ok() && fs::rename(&growing, self.store.join(&name)).is_ok() {
                println!(
                    "deps: {count} kept for other clones in {}",
                    self.store.display()
                );
            } else {
                let _ = fs::remove_dir_all(&growing);
            }
        }
        make_room(&self.store, &self.key, MOST_SETS, MOST_BYTES);
    }

    /// What is compiled to its end below a target folder, but for the workspace's own packages.
    fn units(&self, target: &Path) -> BTreeSet<Unit> {
        let is_dependency = |unit: &String| {
            unit.rsplit_once('-')
                .is_some_and(|(package, _)| !self.own.contains(package))
        };
        let mut found = BTreeSet::new();
        for lane in lanes(target) {
            let fingerprints = target.join(&lane).join(FINGERPRINTS);
            // Cargo writes it when the unit is finished.
            let is_finished = |unit: &String| {
                let written = names(&fingerprints.join(unit));
                written.iter().any(|name| name.ends_with(".json"))
            };
            let units = names(&fingerprints).into_iter().filter(is_dependency);
            found.extend(units.filter(is_finished).map(|unit| (lane.clone(), unit)));
        }
        found
    }

    /// Sets of this lock file and compiler, the newest first.
    fn sets(&self) -> Vec<PathBuf> {
        sets_of(&self.store, &self.key)
    }
}

fn sets_of(store: &Path, key: &str) -> Vec<PathBuf> {
    let mut sets = names(store);
    sets.retain(|name| name.starts_with(key));
    sets.sort_unstable();
    sets.iter().rev().map(|name| store.join(name)).collect()
}

fn store() -> Option<PathBuf> {
    let absolute = |path: PathBuf| path.is_absolute().then_some(path);
    let named = env::var_os("XDG_CACHE_HOME").map(PathBuf::from);
    let usual = || absolute(Path::new(&env::var_os("HOME")?).join(".cache"));
    let cache = named.and_then(absolute).or_else(usual)?;
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

/// A compiled unit: its lane, and the name that cargo gives it there, as `serde-0123456789abcdef`.
type Unit = (PathBuf, String);

/// Copies compiled units; returns how many. One that cannot be copied is left out: cargo compiles
/// it.
fn copy_units(from: &Path, to: &Path, units: BTreeSet<Unit>) -> usize {
    // One time for all: cargo compiles what is older than something that it is made of.
    let now = SystemTime::now();
    let mut outputs = HashMap::new();
    let mut count = 0;
    for (lane, unit) in units {
        let [from, to] = [from, to].map(|folder| folder.join(&lane));
        let outputs = outputs
            .entry(lane)
            .or_insert_with(|| outputs_by_hash(&from.join("deps")));
        let hash = unit.rsplit_once('-').map_or("", |(_, hash)| hash);
        let outputs = outputs.get(hash).map_or(&[][..], Vec::as_slice);
        count += usize::from(copy_unit(&from, &to, &unit, outputs, now).is_ok());
    }
    count
}

const FINGERPRINTS: &str = ".fingerprint";

/// Where cargo builds below a target folder: `debug`, `wasm32-unknown-unknown/web` and so on. Not
/// where this program itself was built, before it could look.
fn lanes(target: &Path) -> Vec<PathBuf> {
    let nested = |outer: String| {
        let inner = names(&target.join(&outer)).into_iter();
        let inner: Vec<_> = inner.map(|name| Path::new(&outer).join(name)).collect();
        [vec![PathBuf::from(outer)], inner].concat()
    };
    let all = names(target).into_iter().flat_map(nested);
    all.filter(|lane| target.join(lane).join(FINGERPRINTS).is_dir())
        .filter(|lane| lane != Path::new("xtask"))
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
    let build = Path::new("build").join(unit);
    let deps = outputs.iter().map(|name| Path::new("deps").join(name));
    for path in deps.chain([build, fingerprint]) {
        if from.join(&path).exists() {
            let to = to.join(&path);
            fs::create_dir_all(to.parent().unwrap_or(&to))?;
            copy_tree(&from.join(&path), &to, now)?;
        }
    }
    Ok(())
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

/// Removes sets that others of the same key have followed, those that were not used for longest,
/// and what grew and never ended; the newest of `key` stays.
fn make_room(store: &Path, key: &str, most_sets: usize, most_bytes: u64) {
    let changed = |path: &PathBuf| fs::metadata(path).and_then(|file| file.modified()).ok();
    for name in names(store).iter().filter(|name| name.starts_with(GROWING)) {
        let growing = store.join(name);
        let age = changed(&growing).and_then(|time| time.elapsed().ok());
        if age.is_some_and(|age| age > GROWS) {
            let _ = fs::remove_dir_all(growing);
        }
    }
    let current = sets_of(store, key);
    for followed in current.iter().skip(1) {
        let _ = fs::remove_dir_all(followed);
    }
    let mut sets: Vec<PathBuf> = names(store)
        .iter()
        .filter(|name| !name.starts_with(GROWING))
        .map(|name| store.join(name))
        .collect();
    sets.sort_by_key(|set| (current.contains(set), changed(&set.join(USED))));
    let mut bytes = 0;
    for (number, set) in sets.iter().rev().enumerate() {
        bytes += bytes_in(set);
        if !current.contains(set) && (number >= most_sets || bytes > most_bytes) {
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
    use std::process;

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

    fn deps(store: &Folder, target: &Folder) -> Deps {
        Deps {
            store: store.0.clone(),
            key: "key".to_owned(),
            target: target.0.clone(),
            own: own(),
        }
    }

    #[test]
    fn another_clone_gets_dependencies_whole_and_none_of_our_own_crates() {
        let [one, store, two] = ["one", "store", "two"].map(Folder::new);
        compile(&one, "half", "0a");
        compile(&one, "foveal-core", "0b");
        one.write("debug/deps/libother-0c.rlib");
        deps(&store, &one).keep();
        deps(&store, &two).restore().unwrap();
        for path in [
            "debug/.fingerprint/half-0a/lib-it.json",
            "debug/deps/libhalf-0a.rlib",
            "debug/build/half-0a/out/made.rs",
        ] {
            assert!(two.has(path), "{path}");
        }
        assert_eq!(names(&two.0.join("debug/deps")).len(), 1);
    }

    #[test]
    fn what_two_clones_compiled_is_never_mixed() {
        let [one, store, two, three] = ["mix1", "mixed", "mix2", "mix3"].map(Folder::new);
        compile(&one, "half", "0a");
        one.write("release/.fingerprint/half-0c/lib-it.json");
        deps(&store, &one).keep();
        // A clone that has compiled something for a profile takes nothing of another's for it.
        compile(&two, "wide", "0b");
        deps(&store, &two).restore().unwrap();
        assert!(!two.has("debug/deps/libhalf-0a.rlib"));
        assert!(two.has("release/.fingerprint/half-0c/lib-it.json"));
        // What it leaves is its own, in place of what was there.
        deps(&store, &two).keep();
        deps(&store, &three).restore().unwrap();
        assert!(three.has("debug/deps/libwide-0b.rlib"));
        assert!(!three.has("debug/deps/libhalf-0a.rlib"));
        assert_eq!(names(&store.0).len(), 1);
        // Nothing new, nothing written.
        let before = names(&store.0);
        deps(&store, &three).keep();
        assert_eq!(names(&store.0), before);
    }

    #[test]
    fn what_was_not_compiled_to_its_end_is_not_kept() {
        let [one, store] = ["unfinished", "empty"].map(Folder::new);
        one.write("debug/.fingerprint/half-0a/invoked.timestamp");
        one.write("debug/deps/libhalf-0a.rmeta");
        deps(&store, &one).keep();
        assert!(names(&store.0).is_empty());
    }

    #[test]
    fn all_that_is_restored_has_one_time() {
        let [one, two] = ["times", "same"].map(Folder::new);
        compile(&one, "first", "0a");
        std::thread::sleep(Duration::from_millis(20));
        compile(&one, "second", "0b");
        let all = deps(&two, &one).units(&one.0);
        copy_units(&one.0, &two.0, all);
        let time = |path: &str| fs::metadata(two.0.join(path)).unwrap().modified().unwrap();
        let first = time("debug/deps/libfirst-0a.rlib");
        assert_eq!(first, time("debug/deps/libsecond-0b.rlib"));
        assert_eq!(first, time("debug/.fingerprint/second-0b/lib-it.json"));
    }

    #[test]
    fn the_sets_used_last_stay_and_the_current_one_always_does() {
        let store = Folder::new("room");
        for set in ["old-1", "newer-1", "newest-1"] {
            store.write(&format!("{set}/{USED}"));
            std::thread::sleep(Duration::from_millis(20));
        }
        make_room(&store.0, "old", 2, u64::MAX);
        assert!(store.has("old-1") && store.has("newest-1") && !store.has("newer-1"));
        make_room(&store.0, "old", 2, 1);
        assert_eq!(names(&store.0), ["old-1"]);
    }
}
