//! Is the loss of preparing reported, and is a pack judged against the file that it came from?

use crate::scenes::{noisy_clip, waves, write_clip, write_clip_at};
use crate::support::{Folder, done, json, refused};
use foveal_core::view::picture::Picture;
use serde_json::Value;

fn prepared(folder: &Folder, clip: &str, name: &str, how: &[&str]) -> (String, Value) {
    let pack = folder.name(name);
    let done = json(&[&["prepare", "video", clip, "--out", &pack], how].concat());
    (pack, done["loss"].clone())
}

fn number(value: &Value, key: &str) -> f64 {
    let found = value[key].as_f64();
    found.unwrap_or_else(|| panic!("no number {key} in {value}"))
}

#[test]
fn a_flat_pack_without_loss_has_none_and_a_coarser_one_has_more() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([96, 64], 3));
    let (lossless, loss) = prepared(&folder, &clip, "png.foveal", &["--codec", "png"]);
    assert_eq!(number(&loss, "jod"), 10.0);
    assert!(loss["psnr_db"].is_null(), "{loss}");
    let text = done(&["info", &lossless]).stdout;
    assert!(text.contains("no pixel differs, 10.00 JOD"), "{text}");
    let of = |quality: &str| {
        let name = format!("{quality}.foveal");
        prepared(&folder, &clip, &name, &["--quality", quality])
    };
    let [(_, fine), (pack, coarse)] = ["8", "50"].map(of);
    assert!(
        number(&fine, "jod") > number(&coarse, "jod"),
        "{fine} {coarse}"
    );
    assert!(number(&fine, "psnr_db") > number(&coarse, "psnr_db") + 6.0);
    assert_eq!(json(&["info", &pack])["loss"], coarse);
    let told = format!(
        "{:.2} JOD at the worst of nine gazes",
        number(&coarse, "jod")
    );
    assert!(done(&["info", &pack]).stdout.contains(&told), "{told}");
}

#[test]
fn a_pack_tells_the_same_loss_for_any_number_of_threads_or_none_where_nobody_asks() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([700, 500], 2));
    let [one, three] = ["1", "3"].map(|jobs| {
        let how = ["--fast", "--jobs", jobs];
        prepared(&folder, &clip, &format!("{jobs}.foveal"), &how)
    });
    assert!(one.1.is_object() && one.1 == three.1, "{one:?} {three:?}");
    assert!(std::fs::read(one.0).unwrap() == std::fs::read(three.0).unwrap());
    let (pack, loss) = prepared(&folder, &clip, "no.foveal", &["--fast", "--no-loss"]);
    assert!(loss.is_null());
    assert!(!done(&["info", &pack]).stdout.contains("nine gazes"));
    // How it was made is the same with and without.
    let again = ["prepare", "video", &clip, "--out", &pack, "--fast"];
    assert_eq!(json(&again)["already_there"], true);
}

#[test]
fn black_and_tiny_pictures_have_no_loss_that_is_no_number() {
    let folder = Folder::new();
    let black = Picture::filled(64, 48, [16, 128, 128]);
    let clip = write_clip(&folder, "black.mkv", &[black]);
    let (_, loss) = prepared(&folder, &clip, "black.foveal", &["--codec", "png"]);
    assert!(
        number(&loss, "jod") == 10.0 && loss["psnr_db"].is_null(),
        "{loss}"
    );
    let clip = write_clip(&folder, "tiny.mkv", &noisy_clip([12, 10], 1));
    let (_, loss) = prepared(&folder, &clip, "tiny.foveal", &[]);
    assert!(loss.is_null(), "{loss}");
}

/// Options of a small view.
const VIEW: [&str; 4] = ["--fov", "60", "--view", "160x100"];

#[test]
fn a_pack_is_scored_against_its_source_in_the_same_view() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([96, 64], 4));
    let (pack, _) = prepared(&folder, &clip, "a.foveal", &["--codec", "png"]);
    let score = ["score", &clip, &pack, "--gaze", "0,0", "--policy"];
    let full = json(&[&score[..], &["full"]].concat());
    assert_eq!(
        (number(&full, "jod"), &full["frames"]),
        (10.0, &Value::from(4))
    );
    assert!(full["companions"]["psnr_db"].is_null(), "{full}");
    assert_eq!(full["gaze"], "true gaze of the run (0, 0)");
    let coarse = json(&[&score[..], &["coarsest", "--frames", "2"]].concat());
    assert!(
        number(&coarse, "jod") < 9.9 && coarse["frames"] == 2,
        "{coarse}"
    );
    let psnr = ["coarsest", "--metric", "psnr"];
    let psnr = json(&[&score[..], &psnr].concat());
    assert!(number(&psnr, "value") < 40.0, "{psnr}");
}

#[test]
fn a_sphere_is_scored_where_its_viewer_looks_over_the_seam_and_at_the_poles() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([512, 256], 2));
    let how = ["--projection", "equirect", "--codec", "png"];
    let (pack, loss) = prepared(&folder, &clip, "a.foveal", &how);
    assert!(
        number(&loss, "psnr_db") > 35.0 && number(&loss, "jod") > 9.0,
        "{loss}"
    );
    // Towards the poles the waves become finer than any pixel.
    let looks = [
        ("0,0", 40.0),
        ("178,20", 35.0),
        ("-90,-75", 30.0),
        ("30,89", 30.0),
        ("scan", 35.0),
    ];
    for (gaze, least) in looks {
        let score = ["score", &clip, &pack, "--policy", "full", "--gaze", gaze];
        let found = json(&[&score[..], &VIEW].concat());
        // Another view than the pack's has nothing in common with it.
        let psnr = number(&found["companions"], "psnr_db");
        assert!(psnr > least, "{gaze}: {psnr}");
    }
}

#[test]
fn a_source_that_is_not_the_packs_is_refused_with_both_facts() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip([96, 64], 4));
    let (pack, _) = prepared(&folder, &clip, "a.foveal", &["--fast"]);
    let other = write_clip(&folder, "other.mkv", &noisy_clip([128, 64], 4));
    let long = write_clip(&folder, "long.mkv", &noisy_clip([96, 64], 9));
    let fast = write_clip_at(
        &folder,
        "fast.mkv",
        &noisy_clip([96, 64], 4),
        [50, 1],
        &[0, 1, 2, 3],
    );
    let shifted = write_clip_at(
        &folder,
        "shifted.mkv",
        &noisy_clip([96, 64], 4),
        [25, 1],
        &[0, 1, 3, 4],
    );
    let give = "give the file that it was made from";
    for (source, words) in [
        (
            &other,
            &["other.mkv", "128x64", "a.foveal", "96x64", give][..],
        ),
        (
            &long,
            &["long.mkv", "9 frames", "a.foveal", "4 frames", give],
        ),
        (&fast, &["fast.mkv", "50.000", "a.foveal", "25.000", give]),
        (&shifted, &["shifted.mkv", "a.foveal", give]),
    ] {
        refused(2, &["score", source, &pack, "--gaze", "0,0"], words);
    }
    let gone = folder.name("gone.mkv");
    refused(1, &["score", &gone, &pack, "--gaze", "0,0"], &["gone.mkv"]);
    let score = ["score", &clip, &pack];
    for (options, words) in [
        (&[][..], &["a.foveal", "--gaze"][..]),
        (&["--gaze", "0,100"], &["--gaze", "0,100", "scan"]),
        (&["--gaze", "udp:5005"], &["--gaze", "udp:5005", "scan"]),
        (
            &["--gaze", "0,0", "--fps", "25"],
            &["--fps", "leave it out"],
        ),
    ] {
        refused(2, &[&score[..], options].concat(), words);
    }
}
