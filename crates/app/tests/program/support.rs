//! How does a test run the program, and read what it wrote?

use serde_json::Value;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};

/// A folder that goes away with the value.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("foveal-program-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir(&path).unwrap();
        Self(path)
    }

    /// A name in it, as an argument.
    pub(crate) fn name(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    /// A new file in it.
    pub(crate) fn holding(&self, name: &str, bytes: &[u8]) -> String {
        let path = self.name(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// A copy of a file of it, with nothing next to or above it.
    pub(crate) fn elsewhere(&self, file: &str) -> String {
        let folder = self.name("else/where");
        std::fs::create_dir_all(&folder).unwrap();
        let copy = format!("{folder}/session.jsonl");
        std::fs::copy(file, &copy).unwrap();
        copy
    }

    /// The names of everything in it, in order.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let name = |entry: std::fs::DirEntry| entry.file_name().to_str().unwrap().to_owned();
        let mut names: Vec<String> = entries.map(|entry| name(entry.unwrap())).collect();
        names.sort();
        names
    }
}

impl std::ops::Deref for Folder {
    type Target = Path;
    fn deref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The program with these arguments, ready to run. Videos are prepared without calibration, which
/// takes most of a minute, unless the arguments ask for it.
pub(crate) fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_foveal"));
    command.args(arguments).args(fixed_quality(arguments));
    if arguments.starts_with(&["prepare", "video"]) && !arguments.contains(&"--calibrate") {
        command.args(["--calibrate", "off"]);
    }
    command
}

/// What fixes the quantiser of film whose preparation does not: looking for one takes as
/// long as all the rest of a small clip. `--quality auto` is left as it is.
fn fixed_quality(arguments: &[&str]) -> &'static [&'static str] {
    const SAID: [&str; 4] = ["--quality", "--bitrate", "--codec", "--help"];
    const STILLS: [&str; 9] = [
        "png", "jpg", "jpeg", "webp", "tif", "tiff", "heic", "avif", "bmp",
    ];
    let is_still = |argument: &&str| STILLS.iter().any(|ending| argument.ends_with(ending));
    match arguments {
        ["prepare", "video", input, rest @ ..]
            if !is_still(input) && !rest.iter().any(|it| SAID.contains(it) || is_still(it)) =>
        {
            &["--quality", "24"]
        }
        _ => &[],
    }
}

/// Says what this machine does not let a test try, also in a run of all of them.
pub(crate) fn skipped(why: &str) {
    eprintln!("SKIPPED: {why}");
    if let Some(list) = std::env::var_os("FOVEAL_SKIPPED_TESTS") {
        let mut list = File::options()
            .append(true)
            .create(true)
            .open(list)
            .unwrap();
        writeln!(list, "{why}").unwrap();
    }
}

/// Whether this system has a file that refuses every byte.
pub(crate) fn has_dev_full() -> bool {
    let there = Path::new("/dev/full").exists();
    if !there {
        skipped("this system has no /dev/full, so writing to it was not tried");
    }
    there
}

/// What came of a run.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// Runs a command to its end; a panic of the program is a failure of the test.
pub(crate) fn finish(mut command: Command) -> Ran {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().unwrap();
    let ran = Ran {
        code: status.code(),
        stdout: String::from_utf8(stdout).unwrap(),
        stderr: String::from_utf8(stderr).unwrap(),
    };
    assert!(!ran.stderr.contains("panicked"), "{command:?}: {ran:?}");
    assert!(
        matches!(ran.code, Some(0..=2)),
        "{command:?} ended with neither 0, 1 nor 2: {ran:?}"
    );
    ran
}

/// Runs the program.
pub(crate) fn foveal(arguments: &[&str]) -> Ran {
    finish(command(arguments))
}

/// Runs the program, which must succeed.
pub(crate) fn done(arguments: &[&str]) -> Ran {
    let ran = foveal(arguments);
    assert_eq!(ran.code, Some(0), "{arguments:?}: {ran:?}");
    ran
}

/// Runs the program with `--json`, which must succeed, and reads the one object on stdout.
pub(crate) fn json(arguments: &[&str]) -> Value {
    json_of(&done(&[arguments, &["--json"]].concat()))
}

/// The one object on stdout.
pub(crate) fn json_of(ran: &Ran) -> Value {
    let value: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert!(value.is_object(), "{}", ran.stdout);
    value
}

/// Runs the program, which must fail with this exit code and name all of `words` on stderr.
pub(crate) fn refused(code: i32, arguments: &[&str], words: &[&str]) -> Ran {
    let ran = foveal(arguments);
    assert_refused(&ran, code, words);
    ran
}

/// Whether a run failed with this exit code and named all of `words` on stderr.
pub(crate) fn assert_refused(ran: &Ran, code: i32, words: &[&str]) {
    assert_eq!(ran.code, Some(code), "{ran:?}");
    for word in words {
        assert!(ran.stderr.contains(word), "no {word:?} in {}", ran.stderr);
    }
}

/// Whether every key is there.
pub(crate) fn assert_keys(value: &Value, keys: &[&str]) {
    for key in keys {
        assert!(value.get(key).is_some(), "no {key} in {value}");
    }
}

/// An RGB picture read back from a file.
pub(crate) struct Rgb {
    pub(crate) size: [u32; 2],
    pub(crate) pixels: Vec<u8>,
}

impl Rgb {
    pub(crate) fn read(path: &str) -> Self {
        let file = std::io::BufReader::new(File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut pixels).unwrap();
        assert_eq!(frame.color_type, png::ColorType::Rgb);
        assert_eq!(frame.bit_depth, png::BitDepth::Eight);
        Self {
            size: [frame.width, frame.height],
            pixels,
        }
    }

    pub(crate) fn write(&self, path: &str) {
        let file = File::create(path).unwrap();
        let mut encoder = png::Encoder::new(file, self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&self.pixels).unwrap();
    }

    pub(crate) fn at(&self, [x, y]: [u32; 2]) -> [u8; 3] {
        let place = (y as usize * self.size[0] as usize + x as usize) * 3;
        [0, 1, 2].map(|k| self.pixels[place + k])
    }

    /// Every column and row.
    pub(crate) fn places(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let [w, h] = self.size;
        (0..h).flat_map(move |y| (0..w).map(move |x| [x, y]))
    }

    /// The largest difference of a channel anywhere.
    pub(crate) fn difference(&self, other: &Self) -> u8 {
        assert_eq!(self.size, other.size);
        let pairs = self.pixels.iter().zip(&other.pixels);
        pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
    }
}

/// The picture of a frame in the folder of a run.
pub(crate) fn frame_picture(folder: &str, frame: usize) -> Rgb {
    Rgb::read(&format!("{folder}/frame_{frame:05}.png"))
}

/// A column of the table of a run.
pub(crate) fn column(folder: &str, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(format!("{folder}/frames.csv")).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    let place = header.split(',').position(|found| found == name);
    let place = place.unwrap_or_else(|| panic!("no {name} in {header}"));
    let value = |line: &str| line.split(',').nth(place).unwrap().parse().unwrap();
    lines.map(value).collect()
}

/// A `.glb` of a document and its binary part.
pub(crate) fn glb(document: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let length = 12 + 8 + text.len() + 8 + binary.len();
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((length as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}
