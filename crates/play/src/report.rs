//! What did one frame take?

use foveal_core::content::video::calibration::ZoneLosses;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::session::log::SessionFrame;
use foveal_core::view::eye_view::EyeView;
use std::time::Duration;

/// What is expected to be lost of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedLoss {
    /// As signatures predict it.
    pub losses: ZoneLosses,
    /// The quality difference that a judge is expected to find, as
    /// [`jod_lost`](foveal_core::perception::visible_loss::jod_lost) takes it.
    pub quality: f64,
    /// Whether that is known: no part loses far more than was judged of this content.
    pub is_known: bool,
}

/// What one frame took.
#[derive(Clone, Debug)]
pub struct FrameReport {
    /// The line of the log.
    pub session: SessionFrame,
    /// Where the eye looked.
    pub gaze: GazeSample,
    /// How far from there it was expected, in degrees; `None` where the true gaze is unknown.
    pub gaze_error_deg: Option<f64>,
    /// Share of the detail that this eye could see that was shown; `None` where the pack has no
    /// signatures, or judging was not asked for.
    pub detail_share: Option<f64>,
    /// The loss against every finest tile that signatures predict, in the view where it is largest.
    pub expected: Option<ExpectedLoss>,
    /// What showed it: the first of the views.
    pub view: EyeView,
    /// All of them: one, or one a panel.
    pub views: Vec<EyeView>,
    /// Tiles decoded and shown, coarsest first.
    pub tiles: Vec<Tile>,
    /// Tiles that were chosen and are not shown: late, or damaged.
    pub missing: Vec<Tile>,
    /// Tiles shown of each level, finest first.
    pub histogram: Vec<u32>,
    /// Pixels of the tiles that were asked for, the whole coarsest level included; the samples
    /// where only those are shown.
    pub pixels: u64,
    /// Those over the pixels of the finest level.
    pub share: f64,
    /// Pixels decoded, those to catch up included.
    pub decoded_pixels: u64,
    /// Pictures of tiles decoded, those to catch up included.
    pub decodes: u32,
    /// Bytes of units that were needed for the first time.
    pub new_bytes: u64,
    /// Time of choosing them.
    pub choose: Duration,
    /// From asking for the tiles until the last was there.
    pub decode: Duration,
    /// Time of making them resident.
    pub upload: Duration,
    /// Time of drawing the picture, until it is done, without reading it back; zero until it is
    /// [drawn](crate::FramePlayer::draw).
    pub draw: Duration,
    /// What all of that leaves of the frame's time where it is paced, in which nothing is to be
    /// done; zero where frames are played as fast as they come.
    pub wait: Duration,
    /// Whether the frame's time was over before it could be shown, be it with coarser tiles in the
    /// place of missing ones. The first frame cannot be: time begins with it.
    pub late: bool,
    /// Tiles shown that hold another frame.
    pub wrong_frame_tiles: usize,
    /// Tiles that could not be decoded.
    pub failed_tiles: usize,
    /// Cells whose level changed since the frame before.
    pub level_changes: u64,
}

impl FrameReport {
    /// The same without the tiles that were shown and the views, which a long run need not keep.
    #[must_use]
    pub fn without_tiles(self) -> Self {
        Self {
            tiles: Vec::new(),
            views: Vec::new(),
            ..self
        }
    }
}
