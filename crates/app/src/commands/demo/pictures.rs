//! What does one moment look like: full, foveated, by level, in the atlas, and their difference?

use crate::commands::demo::atlas_sheet;
use crate::commands::demo::setup::PlaySetup;
use crate::commands::simulate_pictures::marks;
use crate::report::picture_file::png_bytes;
use anyhow::{Context, bail};
use foveal_core::content::policy::Policy;
use foveal_core::view::eye_view::EyeView;
use foveal_play::{FrameReport, Player};
use foveal_render::RgbaImage;

/// Widths that are tried until the pictures of one content fit into the report; pixels.
const WIDTHS: [u32; 5] = [1280, 1024, 800, 640, 480];
/// How many times the difference is amplified.
pub(super) const AMPLIFIED: u8 = 4;

/// A picture as a PNG file.
pub(super) struct Png {
    pub(super) bytes: Vec<u8>,
    pub(super) size: [u32; 2],
}

/// The pictures of one moment.
pub(super) struct Pictures {
    pub(super) full: Png,
    pub(super) foveated: Png,
    pub(super) heat_map: Png,
    pub(super) atlas: Png,
    pub(super) difference: Png,
    /// Mean error of a colour channel, 0 to 255, within the ring round the gaze and beyond it.
    pub(super) error: [f64; 2],
    /// How many times smaller than stored the atlas shows its tiles, on a side.
    pub(super) atlas_shrunk: u32,
}

/// A player that shows one frame.
pub(super) struct ShownFrame {
    player: Player,
    pub(super) report: FrameReport,
}

impl Pictures {
    /// Plays to the frame of `timed` again and draws it, outside what is timed; the PNG files
    /// together take about `budget` bytes at most.
    pub(super) fn take(
        setup: &PlaySetup<'_>,
        timed: &FrameReport,
        budget: usize,
    ) -> anyhow::Result<Self> {
        let mut foveated = ShownFrame::at(setup, Policy::Perceptual, timed.session.frame)?;
        if foveated.report.session != timed.session {
            bail!("a second run over the same gaze chose other tiles; please report this");
        }
        let mut full = ShownFrame::at(setup, Policy::Full, timed.session.frame)?;
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
        let view = narrowed(&foveated.report.view, width);
        let report = FrameReport {
            view,
            ..foveated.report.clone()
        };
        let marks = marks(&view, &report.gaze);
        let nothing = "nothing draws";
        let canvas = &mut foveated.player.drawer();
        let seen = canvas.picture(&view, None)?.context(nothing)?;
        let heat_map = canvas.picture(&view, Some(&marks))?.context(nothing)?;
        let whole = full
            .player
            .drawer()
            .picture(&view, None)?
            .context(nothing)?;
        let sheet = atlas_sheet::of(&mut foveated.player, &report.tiles, width)?;
        let ring = [marks.gaze[0], marks.gaze[1], marks.gaze_radius];
        Ok(Self {
            error: error(&whole, &seen, ring),
            difference: png(&difference(&whole, &seen))?,
            full: png(&whole)?,
            foveated: png(&seen)?,
            heat_map: png(&heat_map)?,
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
    pub(super) fn at(setup: &PlaySetup<'_>, policy: Policy, frame: u32) -> anyhow::Result<Self> {
        let (mut player, mut gaze) = setup.player(policy)?;
        // The head follows the gaze and levels stay while that trembles: both need all of the way.
        for before in 0..frame {
            let look = gaze.look(player.time(before));
            player.pass(before, &look);
        }
        let report = {
            let look = gaze.look(player.time(frame));
            player.show(frame, &look)?
        };
        Ok(Self { player, report })
    }
}

fn png(image: &RgbaImage) -> anyhow::Result<Png> {
    Ok(Png {
        bytes: png_bytes(image)?,
        size: image.size,
    })
}

/// The same view at fewer pixels, where it is wider than `width`.
fn narrowed(view: &EyeView, width: u32) -> EyeView {
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

/// Mean error of a channel within a ring (centre and radius in pixels), and beyond it.
fn error(a: &RgbaImage, b: &RgbaImage, [x, y, radius]: [f32; 3]) -> [f64; 2] {
    let (mut sums, mut counts) = ([0u64; 2], [0u64; 2]);
    let width = a.size[0] as usize;
    let pixels = a.pixels.chunks_exact(4).zip(b.pixels.chunks_exact(4));
    for (at, (a, b)) in pixels.enumerate() {
        let [column, row] = [at % width, at / width];
        let away = (column as f32 + 0.5 - x).hypot(row as f32 + 0.5 - y);
        let side = usize::from(away > radius);
        sums[side] += (0..3).map(|k| u64::from(a[k].abs_diff(b[k]))).sum::<u64>();
        counts[side] += 3;
    }
    [0, 1].map(|side| sums[side] as f64 / counts[side].max(1) as f64)
}
