//! Does the budget of a link hold, and does the eye get more from it where units are weighed?

use crate::scenes::{picture, write_clip};
use crate::support::{Folder, column, done, json, refused};
use foveal_core::content::demand::Content;
use foveal_core::content::video::bytes::build::{begin_pack, finish_pack, push_tile};
use foveal_core::content::video::bytes::chunk::split_chunk;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::pack::SideTable;
use foveal_core::selection::scheduler::Scheduler;
use foveal_core::session::log::{SessionFrame, SessionLogPart};
use foveal_core::view::axes::angle_between;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::Screen;
use foveal_media::pack::pack_file::PackFile;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, Weak};

/// Frames of the clip, at 25 a second: four groups of the finest level.
const FRAMES: u32 = 32;
/// What half a second of the busiest view would take about ten times over.
const LINK: &str = "2mbit";
const LINK_BYTES_PER_S: f64 = 250_000.0;

/// A noise that is the same at the same place: 0 to 255.
fn roll(x: u32, y: u32) -> u8 {
    let mut state = u64::from(x) << 32 | u64::from(y);
    for _ in 0..3 {
        state = (state ^ state >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    (state >> 56) as u8
}

/// A world around the viewer of plain, soft, busy and striped patches, some of which move.
pub(crate) fn patches(size: [u32; 2], frame: u32) -> Picture {
    picture(size, |plane, x, y| {
        let patch = roll(x / 64 + 1000, y / 64) % 5;
        if plane > 0 {
            return 118 + roll(x / 32, 77 + y / 32) % 21;
        }
        let contrast = match patch {
            0 => 0,
            1 => i32::from(roll(x / 8, y / 8)) / 4 - 32,
            2 => i32::from(roll(x, y)) / 3 - 42,
            3 => [-50, 50][usize::from((x + frame) % 6 < 3)],
            _ => i32::from(roll(x / 2, y / 2)) / 2 - 64,
        };
        (128 + contrast) as u8
    })
}

/// A pack of that world.
struct World {
    folder: Folder,
    pack: String,
}

impl World {
    /// Prepared once for all tests that run at the same time.
    fn prepared() -> Arc<Self> {
        static KEPT: Mutex<Weak<World>> = Mutex::new(Weak::new());
        let mut kept = KEPT.lock().unwrap();
        if let Some(world) = kept.upgrade() {
            return world;
        }
        let folder = Folder::new();
        let frames: Vec<Picture> = (0..FRAMES).map(|f| patches([768, 384], f)).collect();
        let clip = write_clip(&folder, "a.mkv", &frames);
        let pack = folder.name("a.foveal");
        let cut = ["--projection", "equirect", "--tile", "32", "--levels", "4"];
        let prepare = ["prepare", "video", &clip, "--out", &pack, "--fast"];
        done(&[&prepare[..], &cut].concat());
        let world = Arc::new(Self { folder, pack });
        *kept = Arc::downgrade(&world);
        world
    }

    /// Plays it without drawing; returns the folder and the figures of the run.
    fn play(&self, name: &str, options: &[&str]) -> (String, Value) {
        let out = self.folder.name(name);
        let quiet = ["--pictures", "none", "--renderer", "none", "--out", &out];
        let figures = json(&[&["simulate", &self.pack], &quiet[..], options].concat());
        (out, figures)
    }
}

fn session_of(folder: &str) -> SessionLogPart {
    let log = std::fs::read_to_string(format!("{folder}/session.jsonl")).unwrap();
    SessionLogPart::parse(&log).unwrap()
}

/// What a run chose and paid, frame by frame, chosen again from its log.
fn chosen(file: &PackFile, session: &SessionLogPart) -> Vec<(SessionFrame, Vec<Tile>, u64)> {
    let video = file.video(Screen::default()).unwrap();
    let (head, policy) = (&session.head.content, &session.head.policy);
    let mut scheduler = Scheduler::new(policy, vec![video.demand(head, policy)]);
    let again = |frame: &SessionFrame| {
        let moment = frame.moment(&session.head);
        let chosen = scheduler.choose(&[frame.frame], &moment, frame.budget);
        let tiles = chosen[0]
            .units
            .iter()
            .map(|unit| file.pack().tile_of(*unit));
        (frame.clone(), tiles.collect(), scheduler.spent())
    };
    session.frames.iter().map(again).collect()
}

const BUDGETED: [&str; 3] = ["uniform", "eccentricity", "perceptual"];

#[test]
fn no_policy_spends_more_than_the_link_has_brought() {
    let world = World::prepared();
    let file = PackFile::open(Path::new(&world.pack)).unwrap();
    let pack = file.pack();
    for policy in BUDGETED {
        let (out, figures) = world.play(policy, &["--policy", policy, "--link", LINK]);
        assert_eq!(figures["frames"], json!(FRAMES));
        let session = session_of(&out);
        let new_bytes = column(&out, "new_bytes");
        let (mut paid, mut shown) = (0, 0);
        for ((frame, _, spent), new) in chosen(&file, &session).into_iter().zip(new_bytes) {
            let budget = frame.budget.unwrap();
            assert!(spent <= budget, "{policy} {frame:?}: {spent}");
            assert!(
                budget as f64 <= LINK_BYTES_PER_S * 0.25,
                "{policy} {budget}"
            );
            paid += spent;
            let brought = LINK_BYTES_PER_S * f64::from(frame.frame + 1) / 25.0;
            assert!(
                paid as f64 <= brought + 1.0,
                "{policy}: {paid} of {brought}"
            );
            // The coarsest level lies at hand; everything else that is shown was paid for.
            let coarsest = pack.units().filter(|unit| {
                let begins = pack.frames_of(*unit).start == frame.frame;
                pack.tile_of(*unit).level == pack.grid().coarsest() && begins
            });
            let at_hand: u64 = coarsest.map(|unit| u64::from(pack.entry(unit).bytes)).sum();
            shown += new as u64 - at_hand;
            assert!(shown <= paid, "{policy}: {shown} shown, {paid} paid");
        }
        // A limit that nothing comes near would prove nothing.
        let all = LINK_BYTES_PER_S * f64::from(FRAMES) / 25.0;
        assert!(paid as f64 > 0.4 * all, "{policy}: {paid} of {all}");
    }
}

#[test]
fn weighed_units_show_the_eye_the_most_of_what_it_could_see() {
    let world = World::prepared();
    let mut won = [0.0; 3];
    for link in ["500kbit", "1mbit", LINK] {
        let share = |policy| {
            let how = ["--policy", policy, "--link", link, "--gaze", "scan"];
            let figures = world.play(&format!("{policy}-{link}"), &how).1;
            figures["detail_share_mean"].as_f64().unwrap()
        };
        let shares = BUDGETED.map(share);
        eprintln!("{link}: {BUDGETED:?} show {shares:.3?} of the visible detail");
        let [uniform, eccentricity, perceptual] = shares;
        assert!(perceptual >= eccentricity, "{link}: {shares:?}");
        assert!(perceptual >= uniform, "{link}: {shares:?}");
        won.iter_mut()
            .zip(shares)
            .for_each(|(sum, share)| *sum += share);
    }
    assert!(won[2] > won[0].max(won[1]), "{won:?}");
}

#[test]
fn a_weighed_run_replays_bit_for_bit_with_its_pack_and_not_without() {
    let world = World::prepared();
    let how = [
        "--policy",
        "perceptual",
        "--link",
        LINK,
        "--late",
        "30",
        "--model",
        "paper",
    ];
    let how = [&how[..], &["--set", "lambda=2.5", "--saliency", "on"]].concat();
    let (out, figures) = world.play("replayed", &how);
    let log = format!("{out}/session.jsonl");
    let replayed = json(&["replay", &log, "--pack", &world.pack]);
    assert_eq!(replayed["same"], json!(true));
    assert_eq!(replayed["replay_sha256"], figures["log_sha256"]);
    assert_eq!(
        json(&["replay", &log]),
        replayed,
        "the pack lies above the log"
    );
    let gone = world.folder.elsewhere(&log);
    refused(2, &["replay", &gone], &["--pack", "weighed", ".foveal"]);
    let text = std::fs::read_to_string(&log).unwrap();
    for (from, to, words) in [
        ("\"lambda\":2.5", "\"lambda\":0.5", "the replay differs"),
        (
            "\"saliency\":true",
            "\"saliency\":false",
            "the replay differs",
        ),
        ("\"levels\":4", "\"levels\":3", "other tiles"),
        (
            "\"projection\":\"cube\"",
            "\"projection\":\"flat\"",
            "other tiles",
        ),
        ("{\"frame\":31,", "{\"frame\":32,", "32 frames"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{from}");
        let path = world.folder.holding("changed.jsonl", changed.as_bytes());
        refused(1, &["replay", &path, "--pack", &world.pack], &[words]);
    }
}

#[test]
fn what_a_rule_chooses_takes_no_link() {
    let world = World::prepared();
    let out = world.folder.name("none");
    for policy in ["acuity", "full", "coarsest", "viewport", "grid"] {
        let run = ["simulate", &world.pack, "--out", &out, "--link", "4g"];
        refused(
            2,
            &[&run[..], &["--policy", policy]].concat(),
            &["--link", policy],
        );
    }
    for (option, value) in [
        ("--link", "4"),
        ("--link", "6g"),
        ("--late", "-1"),
        ("--late", "nan"),
        ("--saliency", "maybe"),
        ("--set", "lamda=3"),
        ("--set", "omega=0"),
    ] {
        let run = [
            "simulate",
            &world.pack,
            "--out",
            &out,
            "--policy",
            "perceptual",
        ];
        let said = format!("{option}={value}");
        refused(2, &[&run[..], &[&said]].concat(), &[option]);
    }
    let run = [
        "simulate",
        &world.pack,
        "--out",
        &out,
        "--preset",
        "reading",
    ];
    refused(2, &run, &["--preset", "reading"]);
    assert!(!Path::new(&out).exists());
}

#[test]
fn a_nodding_head_under_a_steady_gaze_changes_no_level() {
    let world = World::prepared();
    // A gaze that stays while the head nods by 9° and turns a little, or stays as well.
    let trace = |nods: bool| {
        let mut text = "t_s,yaw_deg,pitch_deg,head_yaw_deg,head_pitch_deg\n".to_owned();
        for frame in 0..FRAMES {
            let nod = if nods { 9.0 } else { 0.0 } * (f64::from(frame) * 0.5).sin();
            writeln!(text, "{},8,-5,{},{nod}", f64::from(frame) / 25.0, 0.4 * nod).unwrap();
        }
        let name = format!("nods-{nods}.csv");
        format!("trace:{}", world.folder.holding(&name, text.as_bytes()))
    };
    for policy in ["acuity", "perceptual"] {
        let run = |nods: bool| {
            let gaze = trace(nods);
            let how = ["--policy", policy, "--gaze", &gaze, "--view", "640x400"];
            world.play(&format!("{policy}-nods-{nods}"), &how)
        };
        let [(nodding, figures), (still, _)] = [true, false].map(run);
        let heads = column(&nodding, "head_pitch_deg");
        assert!(heads.iter().any(|pitch| *pitch > 8.5), "{heads:?}");
        for name in ["pixels", "tiles", "level_changes"] {
            assert_eq!(
                column(&nodding, name),
                column(&still, name),
                "{policy}: {name}"
            );
        }
        // What changes, changes with the groups of the content.
        let changes = column(&nodding, "level_changes");
        let changed = (0..).zip(&changes).filter(|(_, changes)| **changes > 0.0);
        assert!(
            changed.clone().all(|(frame, _)| frame % 8 == 0),
            "{changes:?}"
        );
        if policy == "acuity" {
            let slopes = changed.count();
            assert!(slopes < 4, "{figures}");
        }
    }
}

#[test]
fn a_gaze_that_is_known_late_is_expected_less_surely() {
    let world = World::prepared();
    let play = |name: &str, late: &str| {
        let how = ["--policy", "perceptual", "--link", LINK, "--late", late];
        let (out, figures) = world.play(name, &how);
        let spreads = session_of(&out).frames.into_iter().map(|f| f.spread_rad.0);
        (figures, spreads.sum::<f64>() / f64::from(FRAMES))
    };
    let error = |figures: &Value| figures["gaze_error_deg_mean"].as_f64().unwrap();
    let share = |figures: &Value| figures["detail_share_mean"].as_f64().unwrap();
    let [(now, narrow), (late, wide), (later, wider)] =
        [("now", "0"), ("late", "100"), ("later", "400ms")].map(|(name, late)| play(name, late));
    assert_eq!((error(&now), narrow), (0.0, 0.0));
    assert!(error(&late) > 0.5 && wide > 0.005, "{late} {wide}");
    assert!(
        wider > wide && error(&later) > error(&late),
        "{later} {wider} {wide}"
    );
    assert!(share(&now) > share(&later), "{now} {later}");
}

#[test]
fn a_head_alone_is_a_gaze_that_is_weighed() {
    let world = World::prepared();
    let mut trace = "t_s,yaw_deg,pitch_deg,head_yaw_deg,head_pitch_deg,head_roll_deg\n".to_owned();
    for k in 0..160 {
        let time = f64::from(k) * 0.01;
        let yaw = 60.0 * time;
        trace += &format!("{time},0,0,{yaw},0,0\n");
    }
    let path = world.folder.holding("turning.csv", trace.as_bytes());
    let gaze = format!("head:{path}");
    let how = ["--policy", "perceptual", "--link", LINK, "--gaze", &gaze];
    let (out, figures) = world.play("head", &how);
    assert!(
        figures["detail_share_mean"].as_f64().unwrap() > 0.1,
        "{figures}"
    );
    let session = session_of(&out);
    let last = session.frames.last().unwrap();
    assert!(!last.valid && last.spread_rad.0 > 0.05, "{last:?}");
    let ahead = last.gaze[0].atan2(-last.gaze[2]).to_degrees() - 60.0 * last.time_s.0;
    assert!(
        (1.0..20.0).contains(&ahead),
        "eyes lead a turning head: {ahead}"
    );
    let log = format!("{out}/session.jsonl");
    assert_eq!(
        json(&["replay", &log, "--pack", &world.pack])["same"],
        json!(true)
    );
    let preset = ["--preset", "search"];
    let (search, _) = world.play("search", &[&how[..], &preset].concat());
    assert_ne!(session_of(&search).frames, session.frames);
}

#[test]
fn saliency_fetches_what_lies_beside_the_view() {
    let world = World::prepared();
    let file = PackFile::open(Path::new(&world.pack)).unwrap();
    let grid = *file.pack().grid();
    let beside = |saliency: &str| {
        let how = [
            "--policy",
            "perceptual",
            "--gaze",
            "0,0",
            "--target",
            "none",
            "--saliency",
            saliency,
        ];
        let (out, figures) = world.play(&format!("saliency-{saliency}"), &how);
        let session = session_of(&out);
        let (frame, tiles, _) = chosen(&file, &session).swap_remove(9);
        let forward = frame.head.axes().forward;
        let apart = |tile: &Tile| angle_between(forward, grid.centre(*tile)).to_degrees();
        let finer = tiles.iter().filter(|tile| tile.level < grid.coarsest());
        let count = finer.filter(|tile| apart(tile) > 110.0).count();
        (count, figures["bytes"].as_u64().unwrap())
    };
    let ((off, few), (on, many)) = (beside("off"), beside("on"));
    assert_eq!(off, 0, "a view of 100 degrees ends before");
    assert!(on > 0 && many > few, "{on} tiles, {many} and {few} bytes");
}

/// The same chunks in a pack with other side tables.
fn with_tables(pack: &str, tables: &[SideTable]) -> Vec<u8> {
    let file = PackFile::open(Path::new(pack)).unwrap();
    let pack = file.pack();
    let mut units: Vec<_> = pack.units().collect();
    units.sort_by_key(|unit| pack.entry(*unit).offset);
    let mut builder = begin_pack(pack.description());
    let mut chunks = Vec::new();
    for unit in units {
        let (chunk, frames) = (file.read_chunk(unit).unwrap(), pack.frames_of(unit));
        let parts = split_chunk(&chunk, frames.len()).unwrap();
        let parts: Vec<Vec<u8>> = parts.into_iter().map(<[u8]>::to_vec).collect();
        chunks.extend(push_tile(
            &mut builder,
            pack.tile_of(unit),
            frames.start,
            &parts,
        ));
    }
    let parts = finish_pack(builder, pack.description().clone(), tables).unwrap();
    [parts.head, chunks, parts.tail].concat()
}

#[test]
fn a_pack_without_signatures_is_to_be_prepared_again() {
    let world = World::prepared();
    let bare = world
        .folder
        .holding("bare.foveal", &with_tables(&world.pack, &[]));
    assert_eq!(json(&["verify", &bare])["ok"], json!(true));
    let out = world.folder.name("bare");
    let run = [
        "simulate",
        &bare,
        "--out",
        &out,
        "--pictures",
        "none",
        "--renderer",
        "none",
    ];
    for policy in BUDGETED {
        let how = [&run[..], &["--policy", policy, "--link", LINK]].concat();
        refused(
            1,
            &how,
            &["bare.foveal", "has no signatures", "prepare it again"],
        );
    }
    // Without a link acuity stands in, which is said, and nothing is known of what the eye could
    // have seen.
    let by_acuity = done(&[&run[..], &["--target", "9", "--json"]].concat());
    assert!(
        by_acuity.stderr.contains("has no signatures"),
        "{by_acuity:?}"
    );
    let by_acuity: Value = serde_json::from_str(&by_acuity.stdout).unwrap();
    assert_eq!(by_acuity["policy"], json!("acuity"));
    assert_eq!(by_acuity["target"], Value::Null);
    assert_eq!(by_acuity["detail_share_mean"], Value::Null);
    let (weighed, _) = world.play("weighed", &["--policy", "eccentricity", "--link", LINK]);
    let log = format!("{weighed}/session.jsonl");
    let words = ["bare.foveal", "has no signatures"];
    refused(1, &["replay", &log, "--pack", &bare], &words);
    let short = SideTable {
        name: "signatures".to_owned(),
        version: 1,
        bytes: vec![0; 90],
    };
    let short = with_tables(&world.pack, &[short]);
    let short = world.folder.holding("short.foveal", &short);
    let words = [
        "short.foveal",
        "side table signatures",
        "version 1, 90 bytes",
    ];
    let how = ["simulate", &short, "--out", &out, "--policy", "perceptual"];
    refused(1, &how, &words);
    refused(1, &["verify", &short], &words);
}
