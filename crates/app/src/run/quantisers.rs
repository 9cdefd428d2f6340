//! How coarse may a film be coded before an eye sees it?
//!
//! Small windows of a few groups are coded at several quantisers and judged against themselves, as
//! stills and as moving pictures; the coarsest quantiser that keeps both scores is taken. What is
//! found depends on the input and on what is asked for alone, not on machine and threads.

use crate::commands::score::display_of_view;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::{Projection, Screen};
use foveal_eval::score::display::Photometry;
use foveal_eval::score::pooling::Pool;
use foveal_eval::score::{Display, Judge, Mode, ScorePicture, Viewing};
use foveal_media::prepare::{PreparationPlan as Plan, SampleWindow, sample_windows};
use std::f64::consts::TAU;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What stills may lose where they lose most, in JOD.
const STILL_LOSS: f64 = 0.3;
/// What moving pictures may lose over all windows.
const MOVING_LOSS: f64 = 0.42;
/// Quantisers that are looked at.
const FINEST: u8 = 3;
const COARSEST: u8 = 36;
/// The first guess.
const USUAL: u8 = 20;
/// How often windows are coded at most.
const MOST_TRIES: usize = 5;
/// The frames of a group that are judged as stills: as a share of its length.
const STILLS: [usize; 2] = [0, 5];
/// Smallest side that is judged, in pixels.
const LEAST_SIDE: u32 = 16;

/// The plan with quantisers that follow the input, where it asks for such.
pub(crate) fn with_quantisers(input: &Path, plan: Plan, jobs: usize) -> anyhow::Result<Plan> {
    if !plan.looks_for_quantisers() {
        return Ok(plan);
    }
    let judged = judged_windows(&plan, sample_windows(input, &plan));
    let finest = match judged.is_empty() {
        true => None,
        false => Some(coarsest_that_keeps(|quantiser| {
            loss_at(&judged, &plan, quantiser, jobs)
        })?),
    };
    Ok(match finest {
        Some(finest) => plan.with_finest(finest),
        None => plan,
    })
}

/// The coarsest quantiser whose loss, as a share of what may be lost, is at most 1.
///
/// A loss is nearly in proportion to its quantiser, so a few tries do.
fn coarsest_that_keeps(mut loss_at: impl FnMut(u8) -> anyhow::Result<f64>) -> anyhow::Result<u8> {
    // All up to `low` keep it, none from `high` on.
    let (mut low, mut high) = (FINEST, COARSEST + 1);
    let mut next = USUAL;
    for _ in 0..MOST_TRIES {
        let loss = loss_at(next)?;
        match loss <= 1.0 {
            true => low = next,
            false => high = next,
        }
        if high - low <= 1 {
            break;
        }
        let aimed = f64::from(next) / loss.max(0.05);
        next = (aimed as u8).clamp(low + 1, high - 1);
    }
    Ok(low)
}

/// A window with what is judged of it.
struct Judged {
    window: SampleWindow,
    pictures: Vec<ScorePicture>,
    display: Display,
    /// Where the judge takes no such rate nothing is judged as moving.
    fps: f64,
    gazes_px: Vec<[f64; 2]>,
}

/// All that can be judged; a window that holds several gazes of a group is coded once.
fn judged_windows(plan: &Plan, windows: Vec<SampleWindow>) -> Vec<Judged> {
    let mut judged: Vec<Judged> = Vec::new();
    // The first of the group that is gone through.
    let mut first = 0;
    for window in windows {
        let gaze = gaze_in(&window);
        let place = |it: &SampleWindow| (it.face, it.corner);
        let mut group = judged[first..].iter_mut();
        match group.find(|it| place(&it.window) == place(&window)) {
            Some(same) if !same.gazes_px.contains(&gaze) => same.gazes_px.push(gaze),
            Some(_) => {
                first = judged.len();
                judged.extend(Judged::new(plan, window));
            }
            None => judged.extend(Judged::new(plan, window)),
        }
    }
    judged
}

/// The place of a window that is looked at, 0 the middle of its first pixel.
fn gaze_in(window: &SampleWindow) -> [f64; 2] {
    [0, 1].map(|k| f64::from(window.gaze[k] - window.corner[k]))
}

/// What coding takes from a window.
struct WindowLoss {
    still: f64,
    /// For each gaze; none of one picture.
    moving: Vec<f64>,
}

impl Judged {
    /// None where it is too small for a score or holds no picture.
    fn new(plan: &Plan, window: SampleWindow) -> Option<Self> {
        if window.frames() == 0 || window.size.iter().any(|side| *side < LEAST_SIDE) {
            return None;
        }
        let display = display_of(plan, &window);
        let pictures = window.pictures();
        let pictures = pictures.iter().map(|picture| score_picture(plan, picture));
        let fps = plan.description.fps();
        let this = Self {
            pictures: pictures.collect::<Option<_>>()?,
            display,
            fps,
            gazes_px: vec![gaze_in(&window)],
            window,
        };
        this.viewing(None).map(|_| this)
    }

    fn viewing(&self, fps: Option<f64>) -> Option<Viewing> {
        let display = self.display.clone();
        Viewing::new(display, self.window.size, fps, true, Mode::Compat).ok()
    }

    /// What this window loses at a quantiser of the finest level.
    fn loss(&self, plan: &Plan, finest: u8) -> anyhow::Result<WindowLoss> {
        let shown = self.window.shown(plan, finest)?;
        let shown = shown.iter().map(|picture| score_picture(plan, picture));
        let shown: Vec<ScorePicture> = shown.flatten().collect();
        let pairs: Vec<_> = self.pictures.iter().zip(&shown).collect();
        let lost = |fps: Option<f64>, gaze: [f64; 2], frames: &[usize]| {
            let Some(viewing) = self.viewing(fps) else {
                return Ok(0.0);
            };
            let mut judge = Judge::new(&viewing, 1)?;
            let mut pool = Pool::default();
            for (seen, shown) in frames.iter().filter_map(|frame| pairs.get(*frame)) {
                pool.add(&judge.frame(seen, shown, gaze)?);
            }
            let jod = pool.score(&[]).map_or(10.0, |score| score.jod);
            Ok::<f64, anyhow::Error>(10.0 - jod)
        };
        let (mut still, mut moving) = (0.0, Vec::new());
        let all: Vec<usize> = (0..pairs.len()).collect();
        for gaze in &self.gazes_px {
            still = f64::max(still, lost(None, *gaze, &STILLS)?);
            if pairs.len() > 1 {
                moving.push(lost(Some(self.fps), *gaze, &all)?);
            }
        }
        Ok(WindowLoss { still, moving })
    }
}

/// The loss of all windows as a share of what may be lost: 1 is just what may.
fn loss_at(windows: &[Judged], plan: &Plan, finest: u8, jobs: usize) -> anyhow::Result<f64> {
    let losses = in_parallel(jobs, windows, |window| window.loss(plan, finest))?;
    let still = losses.iter().map(|loss| loss.still).fold(0.0, f64::max);
    let moving: Vec<f64> = losses.iter().flat_map(|loss| loss.moving.clone()).collect();
    let moving = moving.iter().sum::<f64>() / moving.len().max(1) as f64;
    Ok((still / STILL_LOSS).max(moving / MOVING_LOSS))
}

/// Work on all items, in their order.
fn in_parallel<I: Sync, T: Send>(
    jobs: usize,
    items: &[I],
    work: impl Fn(&I) -> anyhow::Result<T> + Sync,
) -> anyhow::Result<Vec<T>> {
    let next = AtomicUsize::new(0);
    let take = || {
        let mut done = Vec::new();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(number) else {
                return done;
            };
            done.push((number, work(item)));
        }
    };
    let mut all = std::thread::scope(|scope| {
        // Where the system gives fewer threads, these take longer.
        let other = |_| std::thread::Builder::new().spawn_scoped(scope, take).ok();
        let others: Vec<_> = (1..jobs.clamp(1, items.len().max(1)))
            .map_while(other)
            .collect();
        let mut all = take();
        for other in others {
            all.extend(
                other
                    .join()
                    .unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            );
        }
        all
    });
    all.sort_unstable_by_key(|(number, _)| *number);
    all.into_iter().map(|(_, result)| result).collect()
}

/// What shows a window: of flat content the part of a screen, else the angles round the eye.
fn display_of(plan: &Plan, window: &SampleWindow) -> Display {
    let surface = plan.description.grid(Screen::default()).surface;
    let pixel = match surface.projection {
        Projection::Flat => {
            let view = EyeView::of_part(&surface, window.corner, window.size);
            return display_of_view(&view, surface.projection);
        }
        Projection::Cube => TAU / 4.0 / f64::from(surface.size[0]),
        Projection::Equirect => TAU / f64::from(surface.size[0]),
    };
    let extent = window
        .size
        .map(|side| 2.0 * (f64::from(side) * pixel / 2.0).tan());
    Display::of("view", window.size, extent, Photometry::HEADSET)
}

/// A picture as it is drawn, each sample of chroma for the four pixels round it.
fn score_picture(plan: &Plan, picture: &Picture) -> Option<ScorePicture> {
    let rows = plan.colour().rgb_from_yuv();
    let [width, height] = [picture.width as usize, picture.height as usize];
    let across = picture.plane_size(1)[0] as usize;
    let mut rgb = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        let luma = &picture.planes[0][y * width..][..width];
        let [u, v] = [1, 2].map(|p| &picture.planes[p][y / 2 * across..][..across]);
        for (x, luma) in luma.iter().enumerate() {
            let yuv = [*luma, u[x / 2], v[x / 2]].map(|code| f32::from(code) / 255.0);
            for row in rows {
                let value = row[0] * yuv[0] + row[1] * yuv[1] + row[2] * yuv[2] + row[3];
                rgb.push((value.clamp(0.0, 1.0) * 255.0).round() as u8);
            }
        }
    }
    ScorePicture::from_rgb8([picture.width, picture.height], rgb).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coarsest_quantiser_that_keeps_the_score_is_found_in_a_few_tries() {
        for right in FINEST..=COARSEST {
            for bend in [0.6, 1.0, 1.6] {
                let mut tries = 0;
                let found = coarsest_that_keeps(|quantiser| {
                    tries += 1;
                    Ok((f64::from(quantiser) / (f64::from(right) + 0.5)).powf(bend))
                });
                let found = found.unwrap();
                assert!(tries <= MOST_TRIES && found <= right, "{right} {found}");
                assert!(
                    f64::from(found) >= 0.8 * f64::from(right) - 1.0,
                    "{right} {found}"
                );
            }
        }
    }

    #[test]
    fn what_never_keeps_it_gets_the_finest_and_what_always_does_the_coarsest() {
        assert_eq!(coarsest_that_keeps(|_| Ok(9.0)).unwrap(), FINEST);
        assert_eq!(coarsest_that_keeps(|_| Ok(0.0)).unwrap(), COARSEST);
    }
}

#[cfg(test)]
mod experiment;
