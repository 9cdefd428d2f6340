//! What does one moment look like: full, foveated, by level, in the atlas, and their difference?

use crate::commands::demo::video::atlas_sheet;
use crate::commands::demo::video::setup::PlaySetup;
use crate::commands::simulate::pictures::marks;
use crate::report::picture_file::png_bytes;
use anyhow::{Context, bail};
use foveal_core::content::policy::Policy;
use foveal_core::view::eye_view::EyeView;
use foveal_play::{FramePlayer, FrameReport};
use foveal_render::{Overlay, RgbaImage};

/// Widths that are tried until the pictures of one content fit into the report; pixels.
const WIDTHS: [u32; 5] = [1280, 1024, 800, 640, 480];
/// How many times the difference is amplified.
pub(crate) const AMPLIFIED: u8 = 4;

/// Panels next to each other in a picture of all.
const COLUMNS: u32 = 4;
/// Pixels between them.
const GAP: u32 = 4;

/// A picture as a PNG file.
#[derive(Clone, Default)]
pub(crate) struct Png {
    pub(crate) bytes: Vec<u8>,
    pub(crate) size: [u32; 2],
}

/// The pictures of one moment.
pub(crate) struct Pictures {
    pub(crate) full: Png,
    pub(crate) foveated: Png,
    pub(crate) heat_map: Png,
    pub(crate) atlas: Png,
    pub(crate) difference: Png,
    /// Mean error of a colour channel, 0 to 255, within the ring round the gaze and beyond it.
    pub(crate) error: [f64; 2],
    /// How many times smaller than stored the atlas shows its tiles, on a side.
    pub(crate) atlas_shrunk: u32,
}

/// A player that shows one frame.
pub(crate) struct ShownFrame {
    player: FramePlayer,
    pub(crate) report: FrameReport,
}

impl Pictures {
    /// Plays to a picture of a run again, whose report is `timed`, and draws it, outside what is
    /// timed; the PNG files together take about `budget` bytes at most.
    pub(crate) fn take(
        setup: &PlaySetup<'_>,
        picture: u32,
        timed: &FrameReport,
        budget: usize,
    ) -> anyhow::Result<Self> {
        let mut foveated = ShownFrame::at(setup, setup.chosen, picture)?;
        if foveated.report.session != timed.session {
            bail!("a second run over the same gaze chose other tiles; please report this");
        }
        let mut full = ShownFrame::at(setup, Policy::Full, picture)?;
        let mut smallest = None;
        for width in WIDTHS {
            let pictures = Self::draw(&mut full, &mut foveated, width)?;
            let fits = pictures.bytes() <= budget;
            smallest = Some(pictures);
            if fits {
                break;
            }
        }
        smallest.context("no width to draw at")
    }

    fn draw(full: &mut ShownFrame, foveated: &mut ShownFrame, width: u32) -> anyhow::Result<Self> {
        let report = &foveated.report;
        let each = match report.views.len() {
            1 => width,
            _ => width / COLUMNS,
        };
        let views: Vec<EyeView> = report.views.iter().map(|it| narrowed(it, each)).collect();
        let all_marks: Vec<Overlay> = views.iter().map(|it| marks(it, &report.gaze)).collect();
        let seen = drawn(&mut foveated.player, &views, None)?;
        let heat_map = drawn(&mut foveated.player, &views, Some(&all_marks))?;
        let whole = drawn(&mut full.player, &views, None)?;
        let sheet = atlas_sheet::of(&mut foveated.player, &report.tiles, width)?;
        let pairs = || whole.iter().zip(&seen);
        let differences: Vec<RgbaImage> = pairs().map(|(a, b)| difference(a, b)).collect();
        let rings = all_marks
            .iter()
            .map(|it| [it.gaze[0], it.gaze[1], it.gaze_radius]);
        Ok(Self {
            error: error(pairs().zip(rings)),
            difference: png(&together(&differences))?,
            full: png(&together(&whole))?,
            foveated: png(&together(&seen))?,
            heat_map: png(&together(&heat_map))?,
            atlas: png(&sheet.image)?,
            atlas_shrunk: sheet.shrunk,
        })
    }

    fn bytes(&self) -> usize {
        let all = [
            &self.full,
            &self.foveated,
            &self.heat_map,
            &self.atlas,
            &self.difference,
        ];
        all.iter().map(|png| png.bytes.len()).sum()
    }
}

impl ShownFrame {
    pub(crate) fn at(setup: &PlaySetup<'_>, policy: Policy, picture: u32) -> anyhow::Result<Self> {
        let (mut player, mut gaze) = setup.player(policy)?;
        // The head follows the gaze and levels stay while that trembles: both need all of the way.
        for before in 0..picture {
            let look = gaze.look(setup.shown.time(before, &player));
            player.pass(setup.shown.frame(before), &look);
        }
        let look = gaze.look(setup.shown.time(picture, &player));
        let report = player.show(setup.shown.frame(picture), &look)?;
        Ok(Self { player, report })
    }
}

/// What views show, each by itself, with marks where there are any.
fn drawn(
    player: &mut FramePlayer,
    views: &[EyeView],
    marks: Option<&[Overlay]>,
) -> anyhow::Result<Vec<RgbaImage>> {
    let draw = |(at, view): (usize, &EyeView)| {
        let marks = marks.map(|marks| &marks[at]);
        let picture = player.drawer().picture(view, marks)?;
        picture.context("nothing draws")
    };
    views.iter().enumerate().map(draw).collect()
}

/// Pictures side by side, row by row, as a wall of panels; one alone as it is.
fn together(images: &[RgbaImage]) -> RgbaImage {
    if let [one] = images {
        return one.clone();
    }
    let cell = [0, 1].map(|k| images.iter().map(|it| it.size[k]).max().unwrap_or(1) + GAP);
    let rows = (images.len() as u32).div_ceil(COLUMNS);
    let columns = COLUMNS.min(images.len() as u32);
    let mut wall = RgbaImage::black([cell[0] * columns - GAP, cell[1] * rows - GAP]);
    for (at, image) in (0..).zip(images) {
        let [left, top] = [at % COLUMNS * cell[0], at / COLUMNS * cell[1]];
        for y in 0..image.size[1] {
            for x in 0..image.size[0] {
                wall.set_pixel([left + x, top + y], image.pixel([x, y]));
            }
        }
    }
    wall
}

pub(crate) fn png(image: &RgbaImage) -> anyhow::Result<Png> {
    Ok(Png {
        bytes: png_bytes(image)?,
        size: image.size,
    })
}

/// The same view at fewer pixels, where it is wider than `width`.
pub(crate) fn narrowed(view: &EyeView, width: u32) -> EyeView {
    let [w, h] = view.size;
    if w <= width {
        return *view;
    }
    let height = (f64::from(h) * f64::from(width) / f64::from(w)).round() as u32;
    EyeView {
        size: [width, height.max(1)],
        ..*view
    }
}

/// What differs, amplified.
fn difference(a: &RgbaImage, b: &RgbaImage) -> RgbaImage {
    let pixels = a.pixels.chunks_exact(4).zip(b.pixels.chunks_exact(4));
    RgbaImage {
        size: a.size,
        pixels: pixels
            .flat_map(|(a, b)| {
                let away = |k: usize| a[k].abs_diff(b[k]).saturating_mul(AMPLIFIED);
                [away(0), away(1), away(2), 255]
            })
            .collect(),
    }
}

/// Mean error of a channel within a ring (centre and radius in pixels) of each pair, and beyond it.
fn error<'a>(pairs: impl Iterator<Item = ((&'a RgbaImage, &'a RgbaImage), [f32; 3])>) -> [f64; 2] {
    let (mut sums, mut counts) = ([0u64; 2], [0u64; 2]);
    for ((a, b), [x, y, radius]) in pairs {
        let width = a.size[0] as usize;
        let pixels = a.pixels.chunks_exact(4).zip(b.pixels.chunks_exact(4));
        for (at, (a, b)) in pixels.enumerate() {
            let [column, row] = [at % width, at / width];
            let away = (column as f32 + 0.5 - x).hypot(row as f32 + 0.5 - y);
            let side = usize::from(away > radius);
            sums[side] += (0..3).map(|k| u64::from(a[k].abs_diff(b[k]))).sum::<u64>();
            counts[side] += 3;
        }
    }
    [0, 1].map(|side| sums[side] as f64 / counts[side].max(1) as f64)
}
