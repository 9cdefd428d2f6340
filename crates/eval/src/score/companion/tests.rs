//! Do the companions say what their definitions say?

use super::weight::cut_off;
use super::*;
use crate::score::golden::{Foveation, Golden, scene};
use crate::score::{Display, Judge, Mode};
use nv_flip::{FlipImageRgb8, FlipPool, flip};

fn viewing(size: [u32; 2]) -> Viewing {
    let display = Display::named("standard_hmd").unwrap();
    Viewing::new(display, size, None, true, Mode::Compat).unwrap()
}

fn picture(size: [u32; 2], rgb: Vec<u8>) -> ScorePicture {
    ScorePicture::from_rgb8(size, rgb).unwrap()
}

fn value(companion: Companion, pictures: &[ScorePicture; 2], gaze: [f64; 2]) -> f64 {
    let viewing = viewing(pictures[0].size());
    let mut judge = CompanionJudge::new(companion, &viewing).unwrap();
    let of_frame = judge.frame(&pictures[0], &pictures[1], gaze).unwrap();
    assert!(of_frame == judge.total() || of_frame.is_nan());
    of_frame
}

#[test]
fn psnr_is_that_of_every_golden() {
    for golden in Golden::all() {
        let mut judge = CompanionJudge::new(Companion::Psnr, &viewing(golden.size)).unwrap();
        for frame in 0..golden.frames {
            let [reference, test] = golden.pictures(frame).unwrap();
            judge.frame(&reference, &test, [0.0; 2]).unwrap();
        }
        let (found, wanted) = (judge.total(), golden.psnr_db);
        assert!(
            found == wanted || (found - wanted).abs() < 6e-4,
            "{}: {found}",
            golden.id
        );
    }
}

#[test]
fn an_even_error_has_the_same_decibels_by_every_measure() {
    let size = [128, 64];
    let pictures = [
        picture(size, vec![100; 128 * 64 * 3]),
        picture(size, vec![110; 128 * 64 * 3]),
    ];
    let wanted = 20.0 * (255.0_f64 / 10.0).log10();
    for companion in [
        Companion::Psnr,
        Companion::FwPsnr,
        Companion::WsPsnr,
        Companion::SPsnr,
    ] {
        let found = value(companion, &pictures, [20.0, 30.0]);
        assert!((found - wanted).abs() < 1e-6, "{companion:?}: {found}");
    }
}

#[test]
fn what_is_the_same_has_no_error() {
    let size = [128, 64];
    let same = picture(size, scene(size, 0.0));
    let pictures = [same.clone(), same];
    for companion in [
        Companion::Psnr,
        Companion::FwPsnr,
        Companion::WsPsnr,
        Companion::SPsnr,
    ] {
        assert_eq!(
            value(companion, &pictures, [60.0, 30.0]),
            f64::INFINITY,
            "{companion:?}"
        );
    }
    for companion in [Companion::Ssim, Companion::FovealSsim] {
        let found = value(companion, &pictures, [60.0, 30.0]);
        assert!((found - 1.0).abs() < 1e-9, "{companion:?}: {found}");
    }
}

/// Sharp to the left of the middle, coarse to the right.
fn half_sharp(size: [u32; 2]) -> [ScorePicture; 2] {
    let reference = scene(size, 0.0);
    let coarse = Foveation {
        round: [0.0; 2],
        radius: 1e-6,
        tile: 16,
        most: 3,
    };
    let mut test = coarse.of(size, &reference);
    for (at, byte) in test.iter_mut().enumerate() {
        if at / 3 % (size[0] as usize) < size[0] as usize / 2 {
            *byte = reference[at];
        }
    }
    [picture(size, reference), picture(size, test)]
}

#[test]
fn those_that_know_the_gaze_prefer_it_where_the_picture_is_sharp() {
    let pictures = half_sharp([256, 128]);
    for companion in [Companion::FwPsnr, Companion::FovealSsim] {
        let [sharp, coarse] = [[40.0, 64.0], [215.0, 64.0]].map(|g| value(companion, &pictures, g));
        assert!(sharp > coarse, "{companion:?}: {sharp} {coarse}");
    }
    let [a, b] = [[40.0, 64.0], [215.0, 64.0]].map(|g| value(Companion::Psnr, &pictures, g));
    assert_eq!(a, b);
}

#[test]
fn a_fovea_outside_of_the_picture_has_no_similarity() {
    let pictures = half_sharp([256, 128]);
    assert!(value(Companion::FovealSsim, &pictures, [-500.0, 64.0]).is_nan());
}

#[test]
fn an_error_at_a_pole_counts_less_than_one_at_the_equator_as_both_sphere_measures_say() {
    let size = [128, 64];
    let with_error_in = |row: usize| {
        let mut bytes = vec![100; 128 * 64 * 3];
        bytes[row * 128 * 3..][..128 * 3].fill(150);
        [picture(size, vec![100; 128 * 64 * 3]), picture(size, bytes)]
    };
    let [pole, equator] = [1, 32].map(with_error_in);
    for companion in [Companion::WsPsnr, Companion::SPsnr] {
        let [pole, equator] = [&pole, &equator].map(|p| value(companion, p, [0.0; 2]));
        assert!(pole > equator + 5.0, "{companion:?}: {pole} {equator}");
    }
    let [ws, s] = [Companion::WsPsnr, Companion::SPsnr].map(|c| value(c, &pole, [0.0; 2]));
    assert!((ws - s).abs() < 0.1, "{ws} {s}");
}

#[test]
fn the_cut_off_is_the_published_one() {
    // ln 64 / 0.106 in the fovea, half of it at 2.3°.
    assert!((cut_off(0.0) - 39.235).abs() < 1e-3);
    assert!((cut_off(2.3) - 39.235 / 2.0).abs() < 1e-3);
}

#[test]
fn what_a_measure_needs_must_be_there() {
    let flat = viewing([64, 64]);
    let refused = |companion, viewing: &Viewing| {
        CompanionJudge::new(companion, viewing)
            .err()
            .map(|e| e.to_string())
    };
    let message = refused(Companion::WsPsnr, &flat).unwrap();
    assert!(
        message.contains("64x64") && message.contains("equirectangular"),
        "{message}"
    );
    let unseen = Viewing {
        foveated: false,
        ..flat
    };
    assert!(
        refused(Companion::FwPsnr, &unseen)
            .unwrap()
            .contains("the gaze")
    );
    assert!(refused(Companion::Ssim, &unseen).is_none());
}

/// Mean of FLIP (Andersson et al. 2020), by its authors' own code: 0 is no difference.
fn mean_flip([w, h]: [u32; 2], reference: &[u8], test: &[u8], ppd: f64) -> f32 {
    let [reference, test] = [reference, test].map(|rgb| FlipImageRgb8::with_data(w, h, rgb));
    FlipPool::from_image(&flip(reference, test, ppd as f32)).mean()
}

#[test]
fn flip_and_the_score_put_a_ladder_of_blur_and_one_of_distance_in_the_same_order() {
    let size = [256, 256];
    let reference = scene(size, 0.0);
    // Neither knows a gaze here: FLIP never does.
    for name in ["standard_hmd", "standard_fhd", "standard_4k"] {
        let display = Display::named(name).unwrap();
        let viewing = Viewing::new(display, size, None, false, Mode::Compat).unwrap();
        let both = |radius: f64, most: u32| {
            let blur = Foveation {
                round: [128.0; 2],
                radius,
                tile: 16,
                most,
            };
            let test = blur.of(size, &reference);
            let mut judge = Judge::new(&viewing, 1).unwrap();
            let pictures = [reference.clone(), test.clone()].map(|rgb| picture(size, rgb));
            let score = judge.frame(&pictures[0], &pictures[1], [0.0; 2]).unwrap();
            let flip = mean_flip(size, &reference, &test, viewing.display.ppd());
            (flip, score.jod)
        };
        let coarser: Vec<(f32, f64)> = (0..=4).map(|most| both(1e-6, most)).collect();
        let wider: Vec<(f32, f64)> = (0..4).map(|n| both(96.0 / f64::from(1 << n), 4)).collect();
        assert_eq!(coarser[0], (0.0, 10.0), "{name}");
        for ladder in [coarser, wider] {
            let falls = ladder
                .windows(2)
                .all(|p| p[1].0 > p[0].0 && p[1].1 < p[0].1);
            assert!(falls, "{name}: FLIP rises and JOD falls? {ladder:?}");
        }
    }
}
