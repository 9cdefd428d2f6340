//! Does the device give what the processor gives?

use super::*;
use crate::score::golden::Golden;
use crate::score::{Display, Judge, Mode};
use foveal_render::RenderError;

/// How far a golden may be off, JOD.
const TOLERANCE: f64 = 0.005;

/// A device as the program opens one; `None` where this machine has no adapter at all.
fn device() -> Option<Gpu> {
    match Gpu::open_blocking() {
        Err(RenderError::NoAdapter(_)) => {
            eprintln!(
                "SKIPPED: no adapter, not even a software one, so no score was computed on it"
            );
            None
        }
        opened => Some(opened.unwrap()),
    }
}

fn viewing(golden: &Golden, mode: Mode) -> Viewing {
    let display = Display::named(golden.display).unwrap();
    let foveated = golden.gaze_at(0).is_some();
    Viewing::new(display, golden.size, golden.fps, foveated, mode).unwrap()
}

fn score(gpu: &Gpu, golden: &Golden, mode: Mode) -> Score {
    let mut judge = GpuJudge::new(&gpu.device, &gpu.queue, &viewing(golden, mode)).unwrap();
    for frame in 0..golden.frames {
        let [reference, test] = golden.pictures(frame).unwrap();
        let gaze = golden.gaze_at(frame).unwrap_or_default();
        judge.frame(&reference, &test, gaze).unwrap();
    }
    judge.score().unwrap()
}

#[test]
fn every_golden_has_its_published_score_on_the_device() {
    let Some(gpu) = device() else { return };
    // The widest take minutes where software stands in for a device; `evaluate goldens` has all.
    let affordable = |golden: &&Golden| {
        let [w, h] = golden.size;
        w * h * golden.frames < 2_200_000
    };
    for golden in Golden::all().iter().filter(affordable) {
        let found = score(&gpu, golden, Mode::Compat).jod;
        let off = (found - golden.jod).abs();
        assert!(
            off <= TOLERANCE,
            "{}: {found}, published {}",
            golden.id,
            golden.jod
        );
    }
}

#[test]
fn the_device_is_the_twin_of_the_processor_in_both_modes() {
    let Some(gpu) = device() else { return };
    for id in ["G2", "G4", "G9", "G12", "G13"] {
        let golden = Golden::named(id).unwrap();
        for mode in [Mode::Compat, Mode::Strict] {
            let found = score(&gpu, golden, mode);
            let mut judge = Judge::new(&viewing(golden, mode), 2).unwrap();
            for frame in 0..golden.frames {
                let [reference, test] = golden.pictures(frame).unwrap();
                let gaze = golden.gaze_at(frame).unwrap_or_default();
                judge.frame(&reference, &test, gaze).unwrap();
            }
            let wanted = judge.score().unwrap();
            for (band, (found, wanted)) in found.bands.iter().zip(&wanted.bands).enumerate() {
                for (found, wanted) in [
                    (found.sustained, wanted.sustained),
                    (found.transient, wanted.transient),
                ] {
                    let off = (found - wanted).abs();
                    assert!(
                        off <= 1e-3 * wanted,
                        "{id} {mode:?} {band}: {found} {wanted}"
                    );
                }
            }
            assert!(
                (found.jod - wanted.jod).abs() < 5e-4,
                "{id}: {} {}",
                found.jod,
                wanted.jod
            );
        }
    }
}

#[test]
fn a_gaze_outside_has_the_score_of_the_processor() {
    let Some(gpu) = device() else { return };
    let size = [64; 2];
    let grey = |byte: usize| vec![byte as u8; 64 * 64 * 3];
    let noise = (0..64 * 64 * 3).map(|n: usize| (n * n * 7919 % 251) as u8);
    let [reference, test] = [grey(128), noise.collect()]
        .map(|bytes| ScorePicture::new(size, Samples::Bits8(bytes)).unwrap());
    for mode in [Mode::Compat, Mode::Strict] {
        let display = Display::named("standard_hmd").unwrap();
        let viewing = Viewing::new(display, size, None, true, mode).unwrap();
        for gaze in [[-90.0, 300.0], [9e3, -4e3], [1e300, 30.0]] {
            let mut here = Judge::new(&viewing, 1).unwrap();
            let mut there = GpuJudge::new(&gpu.device, &gpu.queue, &viewing).unwrap();
            let wanted = here.frame(&reference, &test, gaze).unwrap().jod;
            let found = there.frame(&reference, &test, gaze).unwrap().jod;
            let off = (found - wanted).abs();
            assert!(off < 5e-4, "{mode:?} {gaze:?}: {found} {wanted}");
        }
    }
}

#[test]
fn every_kind_of_sample_has_its_score_on_the_device() {
    let Some(gpu) = device() else { return };
    let golden = Golden::named("G4").unwrap();
    let bytes = golden.bytes(0);
    let viewing = viewing(golden, Mode::Compat);
    let gaze = golden.gaze_at(0).unwrap();
    for samples in [
        bytes
            .clone()
            .map(|b| Samples::Bits16(b.iter().map(|b| u16::from(*b) * 257).collect())),
        bytes.map(|b| Samples::Float(b.iter().map(|b| f32::from(*b) / 255.0).collect())),
    ] {
        let [reference, test] = samples.map(|s| ScorePicture::new(golden.size, s).unwrap());
        let mut judge = GpuJudge::new(&gpu.device, &gpu.queue, &viewing).unwrap();
        let found = judge.frame(&reference, &test, gaze).unwrap().jod;
        assert!((found - golden.jod).abs() <= TOLERANCE, "{found}");
    }
}

#[test]
fn the_heat_map_is_that_of_the_processor() {
    let Some(gpu) = device() else { return };
    let golden = Golden::named("G9").unwrap();
    let viewing = viewing(golden, Mode::Compat);
    let mut here = Judge::new(&viewing, 2).unwrap();
    let mut there = GpuJudge::new(&gpu.device, &gpu.queue, &viewing).unwrap();
    here.keep_heat();
    there.keep_heat().unwrap();
    for frame in 0..4 {
        let [reference, test] = golden.pictures(frame).unwrap();
        let gaze = golden.gaze_at(frame).unwrap();
        here.frame(&reference, &test, gaze).unwrap();
        there.frame(&reference, &test, gaze).unwrap();
    }
    let [here, there] = [here.heat().unwrap(), there.heat().unwrap().unwrap()];
    let most = here.jod_lost.iter().copied().fold(0.0, f32::max);
    assert!(most > 0.5 && here.size == there.size, "{most}");
    for (here, there) in here.jod_lost.iter().zip(&there.jod_lost) {
        assert!((here - there).abs() < 1e-3 * most, "{here} {there}");
    }
}

#[test]
fn pictures_that_no_buffer_holds_are_refused() {
    let Some(gpu) = device() else { return };
    let display = Display::named("standard_4k").unwrap();
    let viewing = Viewing::new(display, [16_000, 9000], None, true, Mode::Compat).unwrap();
    let error = GpuJudge::new(&gpu.device, &gpu.queue, &viewing)
        .err()
        .unwrap()
        .to_string();
    assert!(error.contains("--device cpu"), "{error}");
}
