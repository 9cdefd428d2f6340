//! Does a pack that cannot be written, or is not finished, leave nothing behind?

use crate::scenes::{noisy_clip, waves, write_clip};
use crate::support::{
    Folder, assert_refused, command, done, finish, foveal, json, refused, skipped,
};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

#[test]
fn a_pack_cannot_go_where_nothing_can_be_written() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let prepare = |code: i32, out: &str, words: &[&str]| {
        refused(code, &["prepare", "video", &clip, "--out", out], words);
    };
    let missing = folder.name("no such folder/a.foveal");
    prepare(1, &missing, &["make the folder", "no such folder first"]);
    std::fs::create_dir(folder.name("folder.foveal")).unwrap();
    prepare(
        2,
        &folder.name("folder.foveal"),
        &["folder.foveal", "choose another --out"],
    );
    prepare(2, &folder.name("."), &["choose another --out"]);
    prepare(
        2,
        "/dev/null",
        &["/dev/null", "not a plain file", "choose another --out"],
    );
    prepare(
        1,
        "/proc/a.foveal",
        &["/proc/a.foveal", "choose another --out"],
    );
    assert_eq!(folder.names(), ["a.mkv", "folder.foveal"]);
    let file = folder.holding("file", b"");
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack]);
    let play = ["simulate", &pack, "--renderer", "none", "--out", &file];
    refused(1, &play, &["--out", "file", "cannot be made"]);
}

#[test]
fn a_pack_never_replaces_its_own_source() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let before = std::fs::read(&clip).unwrap();
    let link = folder.name("link.mkv");
    std::os::unix::fs::symlink(&clip, &link).unwrap();
    let roundabout = folder.name("./a.mkv");
    for out in [&clip, &link, &roundabout] {
        let prepare = ["prepare", "video", &clip, "--out", out];
        refused(2, &prepare, &["is the input itself", "choose another name"]);
    }
    // The name under which the pack grows is taken by the source.
    let growing = folder.name("b.foveal.partial");
    std::fs::copy(&clip, &growing).unwrap();
    let prepare = [
        "prepare",
        "video",
        &growing,
        "--out",
        &folder.name("b.foveal"),
    ];
    refused(2, &prepare, &["choose another name"]);
    assert_eq!(std::fs::read(&clip).unwrap(), before);
    assert_eq!(std::fs::read(&growing).unwrap(), before);
}

/// A file system that goes away with the value.
struct SmallDisk<'a>(&'a Path);

impl<'a> SmallDisk<'a> {
    /// `None` where this user or this machine may not mount one.
    fn mount(folder: &'a Path, options: &str) -> Option<Self> {
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", options, "foveal-test"])
            .arg(folder)
            .output();
        match mounted {
            Ok(output) if output.status.success() => Some(Self(folder)),
            _ => {
                skipped(
                    "no small file system can be mounted here, so a full disk was not tried; \
                     run the tests as root to try it",
                );
                None
            }
        }
    }
}

impl Drop for SmallDisk<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0).status();
    }
}

#[test]
fn a_full_disk_is_told_and_nothing_is_left_on_it() {
    let (folder, small) = (Folder::new(), Folder::new());
    let Some(_disk) = SmallDisk::mount(&small, "size=128k") else {
        return;
    };
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([256, 192], 24));
    let out = small.name("a.foveal");
    let how = ["--codec", "png", "--tile", "64"];
    let prepare = [&["prepare", "video", &clip, "--out", &out], &how[..]].concat();
    let words = ["a.foveal", "after", "bytes", "free space", "No space left"];
    refused(1, &prepare, &words);
    assert_eq!(small.names(), [""; 0]);
    // A pack that was there before stays.
    let other = write_clip(&folder, "b.mkv", &waves([64, 48], 2));
    done(&["prepare", "video", &other, "--out", &out]);
    let before = std::fs::read(&out).unwrap();
    refused(1, &[&prepare[..], &["--force"]].concat(), &words);
    assert_eq!(small.names(), ["a.foveal"]);
    assert_eq!(std::fs::read(&out).unwrap(), before);
    let pack = folder.name("a.foveal");
    done(&[&["prepare", "video", &clip, "--out", &pack], &how[..]].concat());
    let run = small.name("run");
    for what in ["png", "video"] {
        let play = ["simulate", &pack, "--renderer", "cpu", "--pictures", what];
        refused(
            1,
            &[&play[..], &["--out", &run]].concat(),
            &["frame", "cannot be written"],
        );
    }
}

#[test]
fn an_export_onto_a_full_disk_leaves_no_folder_and_an_earlier_site_as_it_was() {
    let (folder, small) = (Folder::new(), Folder::new());
    let Some(_disk) = SmallDisk::mount(&small, "size=128k") else {
        return;
    };
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack]);
    let out = small.name("site");
    let ran = foveal(&["export", "site", &pack, "--out", &out]);
    if ran.stderr.contains("built without its pages") {
        return skipped("the program was built without its pages, so no site was exported");
    }
    assert_refused(
        &ran,
        1,
        &["cannot be written", "No space left", "make room"],
    );
    assert_eq!(small.names(), [""; 0]);
    // A folder that was there stays, and one that an export left is completed.
    std::fs::create_dir(&out).unwrap();
    assert_refused(
        &foveal(&["export", "site", &pack, "--out", &out]),
        1,
        &["make room"],
    );
    assert_eq!(small.names(), ["site"]);
    let begun = folder.name("begun");
    std::fs::create_dir(&begun).unwrap();
    let mark = b"{\"version\":1,\"generator\":\"foveal 0\",\"packs\":[]}";
    std::fs::write(format!("{begun}/packs.json.partial"), mark).unwrap();
    std::fs::write(format!("{begun}/index.html"), b"half").unwrap();
    done(&["export", "site", &pack, "--out", &begun]);
    assert!(!Path::new(&format!("{begun}/packs.json.partial")).exists());
    assert!(std::fs::read(format!("{begun}/index.html")).unwrap() != b"half");
}

#[test]
fn figures_that_cannot_be_written_are_told() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack]);
    for name in [
        "session.jsonl",
        "frames.csv",
        "frame_00001.png",
        "frames.mkv",
    ] {
        let out = folder.name(&format!("run of {name}"));
        std::fs::create_dir(&out).unwrap();
        // All but a video grow under another name and are renamed when they are whole.
        let (growing, pictures) = match name {
            "frames.mkv" => (name.to_owned(), "video"),
            _ => (format!("{name}.partial"), "png"),
        };
        // A folder is no file of an older run, so it stays, and nothing can be written there.
        std::fs::create_dir(format!("{out}/{growing}")).unwrap();
        let play = [
            "simulate",
            &pack,
            "--renderer",
            "cpu",
            "--pictures",
            pictures,
        ];
        refused(
            1,
            &[&play[..], &["--out", &out]].concat(),
            &[name, "cannot be written"],
        );
    }
}

#[test]
fn a_killed_preparation_leaves_no_pack_and_the_next_one_succeeds() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([512, 288], 32));
    let (out, partial) = (folder.name("a.foveal"), folder.name("a.foveal.partial"));
    let prepare = [
        "prepare", "video", &clip, "--out", &out, "--small", "--jobs", "1",
    ];
    let mut running = command(&prepare).stderr(Stdio::null()).spawn().unwrap();
    // It begins with the file that grows; all that follows takes thousands of times as long.
    while !Path::new(&partial).exists() {
        assert!(
            running.try_wait().unwrap().is_none(),
            "ended without a file"
        );
        std::thread::sleep(Duration::from_millis(1));
    }
    running.kill().unwrap();
    assert!(!running.wait().unwrap().success());
    assert_eq!(folder.names(), ["a.foveal.partial", "a.mkv"]);
    let again = [
        "prepare", "video", &clip, "--out", &out, "--fast", "--frames", "8",
    ];
    done(&again);
    assert_eq!(folder.names(), ["a.foveal", "a.mkv"]);
    assert_eq!(json(&["verify", &out])["ok"], true);
}

#[test]
fn a_pack_is_read_and_played_from_a_file_that_cannot_be_written() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack]);
    let mut permissions = std::fs::metadata(&pack).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&pack, permissions).unwrap();
    let out = folder.name("run");
    let ran = finish(command(&[
        "simulate",
        &pack,
        "--renderer",
        "none",
        "--out",
        &out,
    ]));
    assert_eq!(ran.code, Some(0), "{ran:?}");
}

#[test]
fn a_disk_that_fills_while_a_pack_is_calibrated_keeps_the_pack_without() {
    let (folder, small) = (Folder::new(), Folder::new());
    let Some(_disk) = SmallDisk::mount(&small, "size=2m") else {
        return;
    };
    let table = 1500;
    // The last page of the pack must have no room for the table.
    for frames in 4..12 {
        let clip = write_clip(&folder, "a.mkv", &noisy_clip([160, 96], frames));
        let out = small.name(&format!("{frames}.foveal"));
        let how = ["--tile", "32", "--levels", "2", "--no-loss"];
        let prepare = [
            "prepare",
            "video",
            &clip,
            "--out",
            &out,
            "--calibrate",
            "usual",
        ];
        let mut run = command(&[&prepare[..], &how].concat());
        let mut running = run
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(running.stderr.take().unwrap()).lines();
        let is_calibrating = |line: &String| line.contains("--calibrate off");
        let begun = lines.by_ref().map(Result::unwrap).find(is_calibrating);
        assert!(begun.is_some(), "it never began to calibrate");
        let partial = std::fs::metadata(format!("{out}.partial")).unwrap().len();
        let mut filler = std::fs::File::create(small.name("filler")).unwrap();
        while std::io::Write::write_all(&mut filler, &[0; 512]).is_ok() {}
        let rest: Vec<String> = lines.map(Result::unwrap).collect();
        assert!(running.wait().unwrap().success(), "{rest:?}");
        std::fs::remove_file(small.name("filler")).unwrap();
        done(&["verify", &out]);
        let about = json(&["info", &out]);
        if about["calibration"].is_null() {
            let said = rest.iter().any(|line| line.contains("cannot be written"));
            assert!(said, "{rest:?}");
            let whole = folder.name("whole.foveal");
            done(&["calibrate", &out, "--out", &whole]);
            return;
        }
        assert!(4096 - partial % 4096 > table, "a full disk took the table");
    }
    panic!("every pack had room for its table in its last page");
}
