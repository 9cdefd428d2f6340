//! What becomes of names that a person gives, whatever lies there and however they are spelled?

use crate::bounded::within;
use crate::scene::torus;
use crate::scenes::{waves, write_clip};
use crate::support::{Folder, Ran, assert_refused, command, done, finish, json, refused, skipped};
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_media::pack::name_claim::{IfTaken, NameClaim};
use foveal_media::pack::scene_file::{SceneFile, write_scene};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Longest time that a refusal may take: a hang is a failure.
const PATIENCE: Duration = Duration::from_secs(30);

/// What is there to be named: a pipe without a writer, a device without an end, a folder.
struct Hostile {
    folder: Folder,
    clip: String,
    pack: String,
    scene: String,
    picture: String,
}

impl Hostile {
    /// None where the system has no pipes with names.
    fn new() -> Option<Self> {
        let folder = Folder::new();
        let made = Command::new("mkfifo").arg(folder.name("pipe")).status();
        if !made.is_ok_and(|it| it.success()) || !Path::new("/dev/zero").exists() {
            skipped("this system has no mkfifo or no /dev/zero, so neither was read");
            return None;
        }
        let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
        let [pack, scene, picture] = ["a.foveal", "s.foveal", "a.png"].map(|it| folder.name(it));
        done(&[
            "prepare",
            "video",
            &clip,
            "--out",
            &pack,
            "--fast",
            "--no-loss",
        ]);
        let mesh = folder.holding("a.obj", torus(8, 8).as_bytes());
        done(&["prepare", "scene", &mesh, "--out", &scene]);
        done(&[
            "panels", "pattern", "grid", "--size", "64x48", "--out", &picture,
        ]);
        Some(Self {
            folder,
            clip,
            pack,
            scene,
            picture,
        })
    }

    /// Command lines in which `NAME` is to be read.
    fn lines(&self) -> Vec<String> {
        let (clip, pack, picture) = (&self.clip, &self.pack, &self.picture);
        let scene = &self.scene;
        let out = self.folder.name("out");
        let rig = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../examples/panels/three.toml"
        );
        let play = format!("simulate {pack} --out {out} --renderer none");
        [
            "info NAME".to_owned(),
            "verify NAME".to_owned(),
            "replay NAME".to_owned(),
            format!("prepare video NAME --out {out}.foveal"),
            format!("prepare scene NAME --out {out}.foveal"),
            format!("simulate NAME --out {out}"),
            format!("{play} --gaze trace:NAME"),
            format!("{play} --gaze head:NAME"),
            format!("{play} --preset NAME"),
            format!("{play} --panels NAME"),
            format!("simulate {scene} --out {out} --renderer none --route NAME"),
            format!("score NAME {picture}"),
            format!("score {picture} NAME"),
            format!("score {picture} {picture} --gaze-trace NAME"),
            format!("score {picture} {picture} --display NAME"),
            format!("score --pairs NAME --out {out}.csv"),
            format!("evaluate policies {pack} --source NAME --out {out}"),
            "evaluate targets --input NAME".to_owned(),
            "evaluate goldens --photo NAME".to_owned(),
            "gaze classify NAME".to_owned(),
            "gaze eval head --data NAME".to_owned(),
            "gaze eval saccade --data NAME".to_owned(),
            format!("perception bands NAME --out {out} --gaze 5,5 --fov 40"),
            format!("panels fit {rig} --source NAME"),
            format!("panels warp {rig} NAME --out {out}"),
            format!("panels warp {rig} v4l2:NAME --out {out}"),
            format!("view {pack} --script NAME"),
            "serve NAME --listen 127.0.0.1:0".to_owned(),
            format!("export site {pack} --about NAME --out {out}"),
            format!("bench video {pack} --original NAME"),
            format!("demo --input {clip} --input NAME --out {out}"),
        ]
        .to_vec()
    }
}

#[test]
fn nothing_that_is_named_is_read_without_an_end() {
    let Some(hostile) = Hostile::new() else {
        return;
    };
    let pipe = hostile.folder.name("pipe");
    for line in hostile.lines() {
        for name in [&pipe, "/dev/zero"] {
            let arguments: Vec<String> = line
                .split(' ')
                .map(|word| word.replace("NAME", name))
                .collect();
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            let ran = in_time(&arguments);
            assert!(matches!(ran.code, Some(1 | 2)), "{line}: {ran:?}");
            assert!(ran.stderr.contains(name), "{line}: {ran:?}");
        }
    }
}

/// A run under limits that must end soon.
fn in_time(arguments: &[&str]) -> Ran {
    let begun = Instant::now();
    let ran = within([20, 4_000_000], arguments);
    assert!(begun.elapsed() < PATIENCE, "{arguments:?}");
    ran
}

#[test]
fn a_pipe_that_nobody_reads_is_not_waited_for() {
    let Some(hostile) = Hostile::new() else {
        return;
    };
    let pipe = hostile.folder.name("pipe");
    let table = format!("reference,test\n{0},{0}\n", hostile.picture);
    let pairs = hostile.folder.holding("pairs.csv", table.as_bytes());
    let trace = b"t_s,yaw_deg,pitch_deg\n0,1,2\n0.01,1,2\n0.02,1,2\n";
    let trace = hostile.folder.holding("trace.csv", trace);
    for arguments in [
        &[
            "score",
            "--pairs",
            &pairs,
            "--display",
            "sdr_fhd_24",
            "--out",
            &pipe,
        ][..],
        &["gaze", "classify", &trace, "--out", &pipe],
        &[
            "panels", "pattern", "grid", "--size", "64x48", "--out", &pipe,
        ],
    ] {
        assert_refused(&in_time(arguments), 1, &["pipe", "has no reader"]);
    }
}

#[test]
fn more_than_an_hour_of_a_route_is_only_played_where_it_is_asked_for() {
    let folder = Folder::new();
    let mesh = folder.holding("a.obj", torus(8, 8).as_bytes());
    let scene = folder.name("a.foveal");
    done(&["prepare", "scene", &mesh, "--out", &scene]);
    let out = folder.name("out");
    let play = |last: &str, more: &[&str]| {
        let text = format!("t_s,x,y,z,yaw_deg,pitch_deg\n0,0,0,3,0,0\n{last},0,0,3,0,0\n");
        let route = folder.holding("route.csv", text.as_bytes());
        let how = [
            "simulate",
            &scene,
            "--out",
            &out,
            "--renderer",
            "none",
            "--route",
            &route,
        ];
        in_time(&[&how[..], more].concat())
    };
    for last in ["1e12", "3601"] {
        assert_refused(
            &play(last, &[]),
            2,
            &["route.csv", last_of(last), "--frames"],
        );
    }
    let few = play("1e12", &["--frames", "3", "--json"]);
    assert_eq!(few.code, Some(0), "{few:?}");
    let hour = play("3600", &["--interval", "10000ms", "--json"]);
    assert_eq!(hour.code, Some(0), "{hour:?}");
    assert!(hour.stdout.contains("\"frames\":360,"), "{hour:?}");
}

/// A time as it is printed.
fn last_of(time: &str) -> &'static str {
    if time == "1e12" {
        "1000000000000 s"
    } else {
        "3601 s"
    }
}

#[test]
fn two_preparations_of_a_scene_to_one_name_lose_no_pack() {
    let folder = Folder::new();
    let out = folder.name("scene.foveal");
    let meshes = [(16, 16), (32, 16)].map(|(around, across)| {
        let name = format!("{around}.obj");
        folder.holding(&name, torus(around, across).as_bytes())
    });
    let prepare = |mesh: &str| {
        let mut prepare = command(&["prepare", "scene", mesh, "--out", &out]);
        prepare.stdout(Stdio::null()).stderr(Stdio::piped());
        prepare.spawn().unwrap()
    };
    for _ in 0..3 {
        let both = meshes.each_ref().map(|mesh| prepare(mesh));
        let both = both.map(|it| it.wait_with_output().unwrap());
        let ended = both.each_ref().map(|it| it.status.success());
        let said = both.map(|it| String::from_utf8(it.stderr).unwrap());
        assert_ne!(ended[0], ended[1], "{said:?}");
        let winner = if ended[0] { "16.obj" } else { "32.obj" };
        assert_eq!(json(&["info", &out])["source"][0], winner, "{said:?}");
        assert_eq!(folder.names(), ["16.obj", "32.obj", "scene.foveal"]);
        std::fs::remove_file(&out).unwrap();
    }
    // A second one is refused before the work, and a name that is given up is free.
    let claim = NameClaim::of(Path::new(&out), IfTaken::Refuse).unwrap();
    let words = ["scene.foveal", "another prepare is writing it"];
    let second = ["prepare", "scene", &meshes[0], "--out", &out];
    refused(1, &second, &words);
    refused(1, &[&second[..], &["--force"]].concat(), &words);
    drop(claim);
    done(&second);
    let named = Path::new(&out);
    assert!(NameClaim::of(named, IfTaken::Refuse).is_err());
    assert!(NameClaim::of(named, IfTaken::Replace).is_ok());
    assert_eq!(json(&["verify", &out])["ok"], true);
}

#[test]
fn a_scene_that_cannot_be_read_back_gets_no_name() {
    let folder = Folder::new();
    let mesh = folder.holding("a.obj", torus(16, 16).as_bytes());
    let [good, bad] = ["good.foveal", "bad.foveal"].map(|name| folder.name(name));
    done(&["prepare", "scene", &mesh, "--out", &good]);
    let file = SceneFile::open(Path::new(&good)).unwrap();
    let write = |row_of: &dyn Fn(&UnitRow) -> UnitRow| {
        let claim = NameClaim::of(Path::new(&bad), IfTaken::Refuse).unwrap();
        let units = file.pack().units().map(|unit| {
            let row = row_of(file.pack().row(unit));
            (row, file.read_chunk(unit).unwrap())
        });
        write_scene(claim, file.pack().description().clone(), units)
    };
    let other = write(&|row| UnitRow {
        samples: row.samples + 1,
        ..row.clone()
    });
    let told = other.unwrap_err().to_string();
    for word in ["bad.foveal", "cannot be read back", "nothing was left"] {
        assert!(told.contains(word), "{told}");
    }
    assert_eq!(folder.names(), ["a.obj", "good.foveal"]);
    write(&UnitRow::clone).unwrap();
    assert!(std::fs::read(&good).unwrap() == std::fs::read(&bad).unwrap());
}

/// Every line that a run printed.
fn lines_of(ran: &Ran) -> impl Iterator<Item = &str> {
    ran.stdout.lines().chain(ran.stderr.lines())
}

#[test]
fn a_line_end_in_a_name_forges_no_line() {
    let folder = Folder::new();
    let name = |ending: &str| folder.name(&format!("a\nfoveal: forged\tline{ending}"));
    let run = |arguments: &[&str]| {
        let ran = finish(command(arguments));
        for line in lines_of(&ran) {
            let is_forged = line.trim_start().starts_with("foveal: forged");
            assert!(!is_forged, "{arguments:?}: {ran:?}");
        }
        let told = lines_of(&ran).any(|line| line.contains("a\\u{a}foveal: forged\\u{9}line"));
        assert!(told, "{arguments:?}: {ran:?}");
        ran.code
    };
    let clip = write_clip(&folder, "plain.mkv", &waves([64, 48], 2));
    let [film, mesh, text, gone] = [".mkv", ".obj", ".csv", ".gone"].map(name);
    std::fs::copy(&clip, &film).unwrap();
    std::fs::write(&mesh, torus(8, 8)).unwrap();
    std::fs::write(&text, "reference,test\nb,c\n").unwrap();
    let [pack, scene, out] = [".foveal", "2.foveal", ".out"].map(name);
    let fast = ["--fast", "--no-loss"];
    let prepare = ["prepare", "video", &film, "--out", &pack];
    assert_eq!(run(&[&prepare[..], &fast].concat()), Some(0));
    assert_eq!(run(&[&prepare[..], &fast].concat()), Some(0));
    assert_eq!(run(&["prepare", "video", &clip, "--out", &pack]), Some(2));
    let prepare = ["prepare", "scene", &mesh, "--out", &scene];
    assert_eq!(run(&prepare), Some(0));
    assert_eq!(run(&["info", &pack]), Some(0));
    assert_eq!(run(&["verify", &pack]), Some(0));
    assert_eq!(run(&["info", &scene]), Some(0));
    let play = ["simulate", &pack, "--out", &out, "--renderer", "none"];
    assert_eq!(run(&play), Some(0));
    let trace = format!("trace:{gone}");
    let [option, value] = [format!("--{gone}"), format!("--json={gone}")];
    for arguments in [
        &["info", &gone][..],
        &["info", &text],
        &["verify", &text],
        &["replay", &text],
        &["prepare", "video", &text, "--out", &gone],
        &["prepare", "scene", &text, "--out", &gone],
        &["score", &text, &clip],
        &["gaze", "classify", &text],
        &["panels", "fit", &text],
        &["serve", &gone],
        &["simulate", &pack, "--out", &out, "--gaze", &trace],
        &["info", &option],
        &["info", &pack, &value],
    ] {
        assert!(matches!(run(arguments), Some(1 | 2)), "{arguments:?}");
    }
    // Names that stand in files and folders.
    let table = format!("reference,test\n\"{film}\",\"{film}\"\n");
    let pairs = folder.holding("pairs.csv", table.as_bytes());
    let ran = finish(command(&[
        "score",
        "--pairs",
        &pairs,
        "--out",
        &folder.name("o.csv"),
    ]));
    assert!(
        !lines_of(&ran).any(|line| line.starts_with("foveal: forged")),
        "{ran:?}"
    );
    let pictures = folder.name("pictures");
    std::fs::create_dir(&pictures).unwrap();
    std::fs::write(format!("{pictures}/a\nfoveal: forged1.png"), b"no picture").unwrap();
    let words = ["rename", "a\\nfoveal: forged1.png"];
    refused(1, &["score", &pictures, &pictures], &words);
}

#[test]
fn a_line_end_in_what_a_file_says_forges_no_line() {
    let folder = Folder::new();
    let picture = folder.name("a.png");
    done(&[
        "panels", "pattern", "grid", "--size", "64x48", "--out", &picture,
    ]);
    let forged = "a\\nfoveal: forged";
    let display = "size_px = [64, 48]\ndiagonal_inches = 20\ndistance_m = 0.6\n\
                   peak_cd_m2 = 100\ncontrast = 1000\nambient_lux = 0\nreflectivity = 0.01\n";
    let display = format!("name = \"{forged}\"\n{display}");
    let display = folder.holding("display.toml", display.as_bytes());
    let key = folder.holding("key.toml", format!("\"{forged}\" = 1\n").as_bytes());
    let mesh = folder.holding("a.obj", torus(8, 8).as_bytes());
    let scene = folder.name("a.foveal");
    done(&["prepare", "scene", &mesh, "--out", &scene]);
    let out = folder.name("out");
    done(&["simulate", &scene, "--out", &out, "--renderer", "none"]);
    let log = std::fs::read_to_string(format!("{out}/session.jsonl")).unwrap();
    let policy = log.replacen("\"acuity\"", &format!("\"{forged}\""), 1);
    let name = log.replacen("\"a.foveal\"", &format!("\"{forged}\""), 1);
    assert!(policy != log && name != log, "{log:.400}");
    let [policy, name] = [("policy.jsonl", policy), ("name.jsonl", name)]
        .map(|(file, text)| folder.holding(file, text.as_bytes()));
    for arguments in [
        &[
            "score",
            &picture,
            &picture,
            "--gaze",
            "5,5",
            "--display",
            &display,
        ][..],
        &[
            "score",
            &picture,
            &picture,
            "--gaze",
            "5,5",
            "--display",
            &key,
        ],
        &["panels", "fit", &key],
        &["prepare", "scene", &key, "--out", &scene, "--force"],
        &["simulate", &scene, "--out", &out, "--preset", &key],
        &["replay", &policy],
        &["replay", &name],
    ] {
        let ran = finish(command(arguments));
        let told = format!("{}{}", ran.stdout, ran.stderr);
        assert!(told.contains("forged"), "{arguments:?}: {ran:?}");
        let is_forged = lines_of(&ran).any(|line| line.starts_with("foveal: forged"));
        assert!(!is_forged, "{arguments:?}: {ran:?}");
    }
}
