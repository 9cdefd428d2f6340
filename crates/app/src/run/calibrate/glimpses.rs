//! What is looked at while a pack is calibrated, from where, and for how long?

use super::measures::CalibrationExtent;
use foveal_core::content::video::bytes::description::Description;
use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::units::{Radians, Seconds, counted};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::surface::{Eye, Projection, Screen, Surface};
use foveal_media::pack::pack_file::PackFile;
use foveal_play::WatchedFrame;
use std::ops::Range;

/// Frames that are judged in a row: the judge sees motion, one frame has none.
const WINDOW: u32 = 8;
/// Widest view of flat content, in pixels: the default of a player.
const WIDEST: u32 = 1920;
/// Views of flat content are smaller than it by these.
const SMALLER: [u32; 3] = [1, 2, 3];
/// Smallest side of a view that is judged.
const LEAST_SIDE: u32 = 48;
/// Views of spheres: pixels per degree ahead, and degrees across. The first is no finer than the
/// sphere itself, as views of its own size are not.
const SPHERE_VIEWS: [[f64; 2]; 2] = [[11.0, 80.0], [22.0, 50.0]];
/// No view of a sphere is coarser than this, however few its pixels.
const LEAST_PPD: f64 = 1.0;
/// Height over width of a view of a sphere.
const SPHERE_SHAPE: f64 = 0.625;
/// Where the eye looks: on flat content in halves of its width and height from the middle, right
/// and down; all are places of no special choice.
const FLAT_GAZES: [[f64; 2]; 5] = [
    [0.16, -0.11],
    [-0.55, 0.35],
    [0.5, -0.45],
    [-0.21, -0.52],
    [0.62, 0.55],
];
/// Where the head points on spheres (yaw, pitch), and where the eye looks from there, in degrees.
const SPHERE_GAZES: [[f64; 4]; 5] = [
    [12.0, -4.0, 5.0, 3.0],
    [-52.0, 13.0, -9.0, -4.0],
    [67.0, -21.0, 8.0, 6.0],
    [-21.0, 34.0, -4.0, 7.0],
    [38.0, 5.0, 10.0, -6.0],
];
/// Gazes of [`CalibrationExtent::Usual`].
const USUAL_GAZES: usize = 3;
/// Most pixels that it draws and judges: about 40 s of a processor.
const USUAL_PIXELS: f64 = 80e6;
/// Bounds and slopes that a glimpse is drawn at, and the finest level.
const DRAWN_AT: f64 = 10.0;

/// Views of one density.
pub(super) struct Density {
    pub(super) view: EyeView,
    pub(super) glimpses: Vec<Glimpse>,
    /// Frames of the content.
    pub(super) frames: u32,
}

/// An eye that looks at one place for some frames.
#[derive(Clone, Debug)]
pub(super) struct Glimpse {
    pub(super) gaze_px: [f64; 2],
    pub(super) frames: Range<u32>,
    gaze: usize,
    head: HeadPose,
    direction: GazeSample,
}

impl Density {
    /// Pixels per degree in the middle of the view.
    pub(super) fn ppd(&self) -> f64 {
        self.view.as_seen().least_ppd().0
    }

    /// Places that are looked at.
    pub(super) fn gazes(&self) -> usize {
        let mut all: Vec<usize> = self.glimpses.iter().map(|it| it.gaze).collect();
        all.sort_unstable();
        all.dedup();
        all.len()
    }

    /// Pixels that are drawn and judged for one glimpse.
    fn cost(&self, frames: u32) -> f64 {
        let [w, h] = self.view.size.map(f64::from);
        w * h * f64::from(frames) * DRAWN_AT
    }
}

impl Glimpse {
    /// How the viewer is at a time.
    pub(super) fn look(&self, time: Seconds) -> WatchedFrame {
        let gaze = GazeSample {
            time,
            received: time,
            ..self.direction
        };
        WatchedFrame::known(gaze, self.head)
    }
}

/// What is looked at of a pack, and what is left out of it, in words.
pub(super) fn glimpses_of(
    file: &PackFile,
    extent: CalibrationExtent,
) -> anyhow::Result<(Vec<Density>, Option<String>)> {
    let about = file.pack().description();
    let surface = about.grid(Screen::default()).surface;
    let windows = windows_of(file)?;
    let frames = windows
        .iter()
        .map(|it| it.end - it.start)
        .max()
        .unwrap_or(1);
    let mut densities: Vec<Density> = views_of(&surface)
        .into_iter()
        .map(|view| Density {
            view,
            glimpses: Vec::new(),
            frames: about.frames,
        })
        .collect();
    let most_gazes = match extent {
        CalibrationExtent::Usual => USUAL_GAZES,
        CalibrationExtent::Thorough => FLAT_GAZES.len(),
    };
    let most = most_gazes * windows.len();
    let mut left = match extent {
        CalibrationExtent::Usual => USUAL_PIXELS,
        CalibrationExtent::Thorough => f64::INFINITY,
    };
    // One of each at least; then each gets another in turn, as long as there is time.
    for round in 0..most {
        for density in &mut densities {
            let cost = density.cost(frames);
            if round > 0 && cost > left {
                continue;
            }
            left -= cost;
            // Every gaze once, windows in turn, then with the other windows.
            let gaze = round % most_gazes;
            let window = (round + round / most_gazes) % windows.len();
            let glimpse = glimpse(&density.view, &surface, gaze, windows[window].clone());
            density.glimpses.push(glimpse);
        }
    }
    let short = densities.iter().filter(|it| it.glimpses.len() < most);
    let short: Vec<String> = short
        .map(|it| {
            let glimpses = it.glimpses.len();
            format!("{glimpses} of {most} samples at {:.1} pixels/°", it.ppd())
        })
        .collect();
    let left_out = (!short.is_empty()).then(|| {
        format!(
            "calibrated on {}, each of {}; a thorough calibration tests all",
            short.join(", "),
            counted(frames, "frame")
        )
    });
    Ok((densities, left_out))
}

/// Views of the densities that are judged.
fn views_of(surface: &Surface) -> Vec<EyeView> {
    match surface.projection {
        Projection::Flat => {
            let shape = surface.tangents[1] / surface.tangents[0];
            let [w, h] = surface.size.map(f64::from);
            let width = w.max(h / shape).min(f64::from(WIDEST));
            let sizes = SMALLER.map(|by| {
                let width = width / f64::from(by);
                [width, width * shape].map(|side| side.round().max(1.0) as u32)
            });
            let fits = sizes
                .into_iter()
                .filter(|size| size[0].min(size[1]) >= LEAST_SIDE);
            fits.map(|size| EyeView::holding(surface, size)).collect()
        }
        Projection::Cube | Projection::Equirect => {
            let [[coarse, wide], fine] = SPHERE_VIEWS;
            let middle = surface.size.map(|side| f64::from(side) / 2.0);
            let own = surface.ppd(middle).0.max(LEAST_PPD);
            vec![sphere_view([coarse.min(own), wide]), sphere_view(fine)]
        }
    }
}

/// How wide the view of a sphere is that was judged at a density, in degrees.
pub(crate) fn sphere_width_deg(ppd: f64) -> f64 {
    let [[coarse, wide], [_, narrow]] = SPHERE_VIEWS;
    if ppd < 1.5 * coarse { wide } else { narrow }
}

fn sphere_view([ppd, across]: [f64; 2]) -> EyeView {
    let tangent = (Radians::from_degrees(across).0 / 2.0).tan();
    let width = 2.0 * tangent * Radians(1.0).to_degrees() * ppd;
    let size = [width, width * SPHERE_SHAPE].map(|side| side.round() as u32);
    EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field::symmetric(size.map(|side| tangent * f64::from(side) / f64::from(size[0]))),
        size,
        eye: Eye::Left,
    }
}

/// The eye that looks at one of the places.
fn glimpse(view: &EyeView, surface: &Surface, gaze: usize, frames: Range<u32>) -> Glimpse {
    let degrees = Radians::from_degrees;
    let (head, yaw, pitch) = match surface.projection {
        Projection::Flat => {
            let [x, y] = FLAT_GAZES[gaze];
            let across = (x * surface.tangents[0]).atan();
            let down = (y * surface.tangents[1] * across.cos()).atan();
            (HeadPose::default(), Radians(across), Radians(-down))
        }
        Projection::Cube | Projection::Equirect => {
            let [yaw, pitch, right, up] = SPHERE_GAZES[gaze];
            let head = HeadPose {
                yaw: degrees(yaw),
                pitch: degrees(pitch),
                ..HeadPose::default()
            };
            (head, degrees(yaw + right), degrees(pitch + up))
        }
    };
    let direction = GazeSample::at(Seconds(0.0), yaw, pitch);
    let turned = match surface.projection {
        Projection::Flat => *view,
        Projection::Cube | Projection::Equirect => EyeView {
            axes: head.axes(),
            ..*view
        },
    };
    let middle = view.size.map(|side| f64::from(side) / 2.0);
    let place = turned.place(direction.gaze_in_content).unwrap_or(middle);
    Glimpse {
        gaze_px: place.map(|at| at - 0.5),
        frames,
        gaze,
        head,
        direction,
    }
}

/// The frames that are judged: where most changes, and where least does.
fn windows_of(file: &PackFile) -> anyhow::Result<Vec<Range<u32>>> {
    let about = file.pack().description();
    let length = about.groups.first().copied().unwrap_or(1).max(1);
    let window = |start: u32| start..(start + WINDOW).min(about.frames);
    let starts = (0..about.frames).step_by(length as usize);
    // What is cut off at the end is not judged, unless it is all there is.
    let whole: Vec<u32> = starts
        .filter(|start| start + WINDOW <= about.frames)
        .collect();
    let changes = changes_of(file, about, &whole)?;
    let by_change = |a: &&(u32, f64), b: &&(u32, f64)| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0));
    let most = changes.iter().max_by(by_change);
    let least = changes.iter().min_by(by_change);
    let mut windows = match (most, least) {
        (Some(most), Some(least)) => vec![window(most.0), window(least.0)],
        _ => vec![window(0)],
    };
    windows.dedup();
    Ok(windows)
}

/// How much changes over the group from each of these frames on: the mean over its tiles.
fn changes_of(
    file: &PackFile,
    about: &Description,
    starts: &[u32],
) -> anyhow::Result<Vec<(u32, f64)>> {
    let cues = file.cues()?;
    let grid = about.grid(Screen::default());
    let change = |start: u32| {
        let cues = cues.as_ref()?;
        let tiles = grid
            .tiles_of(0)
            .filter_map(|tile| cues.of(file.pack().unit(tile, start)));
        Some(tiles.map(|cues| cues.change).sum::<f64>())
    };
    let all = starts
        .iter()
        .map(|start| (*start, change(*start).unwrap_or(0.0)));
    Ok(all.collect())
}
