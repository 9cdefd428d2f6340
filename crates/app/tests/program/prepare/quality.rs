//! Are films coded as coarse as the eye allows, finer where it is dark?

use crate::resume::stopped_at;
use crate::scenes::write_clip;
use crate::support::{Folder, command, done, finish, json};
use foveal_core::view::picture::Picture;

/// A film whose left half is a dark sky that moves, and whose right half is bright and busy.
fn halves(size: [u32; 2], frames: u32) -> Vec<Picture> {
    let frame = |frame: u32| {
        let mut picture = Picture::filled(size[0], size[1], [0, 128, 128]);
        for (k, code) in (0_u32..).zip(&mut picture.planes[0]) {
            let (x, y) = (k % size[0] + frame, k / size[0]);
            let noise = (x * size[1] + y).wrapping_mul(2_654_435_761) >> 24;
            *code = match x < size[0] / 2 + frame {
                true => 20 + 14 * y / size[1] + noise / 80,
                false => 110 + noise / 3,
            } as u8;
        }
        picture
    };
    (0..frames).map(frame).collect()
}

/// Runs the program with `--quality auto`, and with `--json` to report it.
fn auto(clip: &str, pack: &str, how: &[&str]) -> serde_json::Value {
    let start = ["prepare", "video", clip, "--out", pack, "--quality", "auto"];
    json(&[&start, how].concat())
}

#[test]
fn a_film_is_coded_as_its_content_asks_and_the_same_by_any_number_of_threads() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &halves([256, 160], 16));
    let packs = ["1", "8"].map(|jobs| {
        let pack = folder.name(&format!("{jobs}.foveal"));
        let told = auto(&clip, &pack, &["--jobs", jobs]);
        assert_eq!(told["quality_by_tile"], true);
        let jod = told["loss"]["jod"].as_f64().unwrap();
        assert!((9.6..9.98).contains(&jod), "{told}");
        std::fs::read(pack).unwrap()
    });
    assert!(packs[0] == packs[1]);
    let pack = folder.name("1.foveal");
    // Without a word of quality it is the same, and there already.
    let start = ["prepare", "video", &clip, "--out", &pack, "--json"];
    let mut again = command(&["prepare"]);
    again.args(&start[1..]);
    assert!(finish(again).stdout.contains("\"already_there\":true"));
    let text = done(&["info", &pack]).stdout;
    assert!(text.contains(", by tile"), "{text}");
    // The last line: the score, the bytes, and what they are to the source's.
    let start = [
        "prepare",
        "video",
        &clip,
        "--out",
        &pack,
        "--quality",
        "auto",
    ];
    let text = done(&[&start[..], &["--force", "--frames", "8"]].concat()).stdout;
    let last = text.lines().last().unwrap();
    assert!(
        last.contains("JOD against the source") && last.contains("times the size of the source"),
        "{text}"
    );
    // Fixed quantisers are what they were.
    let fixed = json(&[
        "prepare",
        "video",
        &clip,
        "--force",
        "--out",
        &pack,
        "--quality",
        "30",
    ]);
    assert_eq!(fixed["quality"], serde_json::json!([30, 30, 30, 30, 30]));
    assert_eq!(fixed["quality_by_tile"], false);
}

fn asked<'a>(clip: &'a str, out: &'a str) -> [&'a str; 8] {
    [
        "prepare",
        "video",
        clip,
        "--out",
        out,
        "--quality",
        "auto",
        "--no-loss",
    ]
}

#[test]
fn a_stopped_preparation_goes_on_with_the_quantisers_that_it_found() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &halves([160, 96], 300));
    let [out, undisturbed] = ["a.foveal", "b.foveal"].map(|name| folder.name(name));
    let [first, second] = [&out, &undisturbed].map(|out| asked(&clip, out));
    done(&second);
    let journal = folder.name("a.foveal.partial.journal");
    stopped_at(&first, &journal, 0, "-KILL");
    let ran = done(&first);
    assert!(ran.stderr.contains("goes on after"), "{}", ran.stderr);
    assert!(std::fs::read(&out).unwrap() == std::fs::read(&undisturbed).unwrap());
}

#[test]
fn whatever_a_film_shows_some_quantiser_is_found() {
    let folder = Folder::new();
    let grey = |size: [u32; 2], code| Picture::filled(size[0], size[1], [code, 128, 128]);
    let noise = |frame: u32| {
        let mut picture = grey([144, 80], 0);
        for (k, code) in (0_u32..).zip(&mut picture.planes[0]) {
            *code = ((k + 20_000 * frame).wrapping_mul(2_654_435_761) >> 24) as u8;
        }
        picture
    };
    let films = [
        vec![grey([160, 96], 90); 9],
        vec![grey([160, 96], 16); 3],
        (0..9).map(noise).collect(),
        vec![grey([18, 16], 90); 9],
        vec![grey([8, 6], 90); 9],
        vec![grey([2, 90], 90); 2],
        vec![noise(0)],
    ];
    for (number, film) in films.iter().enumerate() {
        let clip = write_clip(&folder, &format!("{number}.mkv"), film);
        let pack = folder.name(&format!("{number}.foveal"));
        let told = auto(&clip, &pack, &[]);
        assert_eq!(told["quality_by_tile"], true, "{number}");
        if let Some(jod) = told["loss"]["jod"].as_f64() {
            assert!(jod >= 9.6, "{number}: {told}");
        }
        for codec in ["png", "vp8"] {
            let how = ["--codec", codec, "--force", "--no-loss"];
            assert_eq!(auto(&clip, &pack, &how)["quality_by_tile"], false);
        }
    }
}
