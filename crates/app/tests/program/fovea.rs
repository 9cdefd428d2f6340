//! Is the fovea of a foveated picture exactly what the whole picture shows there?

use crate::scenes::{noisy_clip, seen, turned, write_clip};
use crate::support::{Folder, done, frame_picture, json};
use foveal_core::units::Radians;
use foveal_core::view::axes::{
    Axes, angle_between, direction_from_yaw_pitch, yaw_pitch_from_direction,
};
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::surface::{Projection, Screen, Surface};

const DISC_DEG: f64 = 2.5;

/// Where the eye looks and where the head points: yaw and pitch in degrees.
type Look = ([f64; 2], [f64; 2]);

/// A trace that looks along one direction a frame, at 25 frames a second.
fn trace(folder: &Folder, looks: &[Look]) -> String {
    let mut text = "t_s,yaw_deg,pitch_deg,head_yaw_deg,head_pitch_deg,head_roll_deg\n".to_owned();
    for (frame, ([yaw, pitch], [head_yaw, head_pitch])) in looks.iter().enumerate() {
        let time = frame as f64 / 25.0 - 1e-3;
        text += &format!("{time},{yaw},{pitch},{head_yaw},{head_pitch},0\n");
    }
    format!("trace:{}", folder.holding("gaze.csv", text.as_bytes()))
}

/// Plays the looks under `full` and under `acuity` with the disc, and compares every pixel within
/// the disc; outside, some pixel must differ, or nothing was shown.
fn assert_same_in_the_fovea(
    folder: &Folder,
    pack: &str,
    (surface, screen): (&Surface, &str),
    view: &EyeView,
    looks: &[Look],
) {
    let gaze = trace(folder, looks);
    let [w, h] = view.size;
    let size = format!("{w}x{h}");
    let play = |name: &str, policy: &[&str]| {
        let out = folder.name(name);
        let how = [
            "simulate", pack, "--gaze", &gaze, "--out", &out, "--view", &size, "--screen", screen,
        ];
        let frames = looks.len().to_string();
        let run = json(&[&how[..], &["--frames", &frames], policy].concat());
        assert_eq!(run["frames"], looks.len());
        (out, run["decoded_megapixels"].as_f64().unwrap())
    };
    let (full, all) = play("full", &["--policy", "full"]);
    let (foveated, some) = play("acuity", &["--slope", "0.022", "--safety-disc", "2.5"]);
    assert!(some < 0.8 * all, "{some} of {all} megapixels");
    for (frame, (gaze, head)) in looks.iter().enumerate() {
        let [yaw, pitch] = gaze.map(Radians::from_degrees);
        let gaze_direction = direction_from_yaw_pitch(yaw, pitch);
        let view = match surface.projection {
            Projection::Flat => *view,
            Projection::Cube | Projection::Equirect => turned(view, head[0], head[1]),
        };
        let pictures = [&full, &foveated].map(|out| frame_picture(out, frame));
        let (locate, mut inside, mut outside) = (seen(surface, &view), 0, 0);
        for place in pictures[0].places() {
            let Some((face, at)) = locate(place) else {
                continue;
            };
            let direction = surface.direction(face, at);
            let same = pictures[0].at(place) == pictures[1].at(place);
            if angle_between(gaze_direction, direction).to_degrees() <= DISC_DEG {
                inside += 1;
                assert!(
                    same,
                    "frame {frame}, gaze {gaze:?}, pixel {place:?} on face {face}"
                );
            } else {
                outside += u32::from(!same);
            }
        }
        assert!(
            inside > 10,
            "frame {frame}: the fovea has {inside} pixels in view"
        );
        assert!(
            outside > 1000,
            "frame {frame}: only {outside} pixels differ outside"
        );
    }
}

/// A flat clip on a screen of fewer pixels by `shrink`, looked at in these places of its picture.
fn assert_same_on_a_screen(
    size: [u32; 2],
    (screen, shrink): (Screen, u32),
    cut: &[&str],
    places: &[[f64; 2]],
) {
    let folder = Folder::new();
    let surface = Surface::flat(size, screen);
    let look = |place: &[f64; 2]| {
        let (yaw, pitch) = yaw_pitch_from_direction(surface.direction(0, *place));
        ([yaw.to_degrees(), pitch.to_degrees()], [0.0; 2])
    };
    let looks: Vec<Look> = places.iter().map(look).collect();
    let clip = write_clip(&folder, "a.mkv", &noisy_clip(size, looks.len() as u32));
    let pack = folder.name("a.foveal");
    let prepare = ["prepare", "video", &clip, "--out", &pack, "--codec", "png"];
    done(&[&prepare[..], &["--fast"], cut].concat());
    let view = EyeView::filling(&surface, size.map(|side| side / shrink));
    let inches = format!("{},{}", screen.diagonal_inches, screen.distance_m);
    assert_same_in_the_fovea(&folder, &pack, (&surface, &inches), &view, &looks);
}

#[test]
fn the_fovea_of_a_flat_picture_is_that_of_the_whole_picture() {
    for (size, cut) in [
        ([640, 360], &["--tile", "64"][..]),
        ([501, 333], &["--tile", "32", "--levels", "4"]),
        (
            [640, 360],
            &["--grid", "8x5", "--levels", "3", "--level-ratio", "4"],
        ),
    ] {
        let [w, h] = size.map(f64::from);
        // The middle, tile borders and corners, near a border of the picture, its corner.
        let places = [
            [w / 2.0, h / 2.0],
            [128.0, 128.0],
            [128.0, 150.0],
            [192.3, 64.1],
            [w - 20.0, 33.0],
            [0.5, h - 0.5],
        ];
        assert_same_on_a_screen(size, (Screen::default(), 1), cut, &places);
    }
}

#[test]
fn the_fovea_of_a_picture_denser_than_any_eye_is_that_of_the_whole_picture() {
    // 10 degrees across, 160 pixels a degree: acuity alone would show no place at level 0.
    let screen = Screen {
        diagonal_inches: 7.0,
        distance_m: 1.0,
        ..Screen::default()
    };
    let places = [[800.0, 160.0], [64.0 * 7.0, 64.0], [3.0, 300.0]];
    for (tile, shrink) in [("32", 1), ("64", 2)] {
        let cut = ["--tile", tile];
        assert_same_on_a_screen([1600, 320], (screen, shrink), &cut, &places);
    }
}

#[test]
fn the_fovea_of_a_picture_around_the_viewer_is_that_of_the_whole_picture() {
    let folder = Folder::new();
    // Forward is a corner of four tiles; then edges and corners of the cube, the back and a pole.
    let looks: [Look; 8] = [
        ([0.0, 0.0], [30.0, 10.0]),
        ([45.0, 0.0], [10.0, 10.0]),
        ([45.0, 35.264_39], [70.0, 20.0]),
        ([-45.0, -35.264_39], [-20.0, -20.0]),
        ([180.0, 1.0], [-160.0, 20.0]),
        ([20.0, 45.0], [0.0, 20.0]),
        ([70.0, 89.0], [70.0, 60.0]),
        ([-135.2, 0.3], [-100.0, 0.0]),
    ];
    let clip = write_clip(
        &folder,
        "a.mkv",
        &noisy_clip([1536, 768], looks.len() as u32),
    );
    let pack = folder.name("a.foveal");
    let how = [
        "--projection",
        "equirect",
        "--codec",
        "png",
        "--fast",
        "--tile",
        "64",
    ];
    done(&[&["prepare", "video", &clip, "--out", &pack], &how[..]].concat());
    let surface = Surface::cube(384);
    let size = [480, 320];
    let view = EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field::across(Radians::from_degrees(100.0), size),
        size,
        eye: Default::default(),
    };
    assert_same_in_the_fovea(&folder, &pack, (&surface, "24,0.6"), &view, &looks);
}
