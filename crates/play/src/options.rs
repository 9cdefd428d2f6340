//! How is a pack played?

use foveal_core::content::policy::PolicyConfig;
use foveal_core::session::bounds::Bounds;
use foveal_core::session::session::SessionSettings;
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Screen;
use foveal_media::MediaError;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::tiles::decode_pool::DecodePool;
use foveal_media::tiles::decoders::DecoderChoice;
use foveal_render::{DrawDevice, TileStyle};

/// How a pack is played.
#[derive(Clone)]
pub struct PlayerOptions {
    /// The policy with its parameters.
    pub config: PolicyConfig,
    /// What draws.
    pub drawing: DrawDevice,
    /// What a link brings, for policies that spend a budget; infinite for content at hand.
    pub bytes_per_s: f64,
    /// Bytes that units of a scene may take on the GPU.
    pub gpu_bytes: u64,
    /// Receives what a person should know but is not an error.
    pub tell: fn(&str),
}

impl PlayerOptions {
    /// Chooses by `config` from content at hand, without limits.
    #[must_use]
    pub fn new(config: PolicyConfig, drawing: &DrawDevice, tell: fn(&str)) -> Self {
        Self {
            config,
            drawing: drawing.clone(),
            bytes_per_s: f64::INFINITY,
            gpu_bytes: u64::MAX / 4,
            tell,
        }
    }

    /// What a session begins with that makes pictures one by one.
    pub(crate) fn settings(&self, measures: bool, bounds: Bounds) -> SessionSettings {
        let spends = self.config.policy.spends_a_budget();
        SessionSettings {
            policy: self.config.clone(),
            bytes_per_s: spends.then_some(self.bytes_per_s),
            since: Some(Seconds(0.0)),
            zooms: false,
            measures,
            bounds,
        }
    }
}

/// How a video is played frame by frame.
#[derive(Clone)]
pub struct FrameOptions {
    /// What it has in common with other content.
    pub player: PlayerOptions,
    /// What shows the picture, while the head looks ahead.
    pub view: EyeView,
    /// The screen that flat content fills.
    pub screen: Screen,
    /// How tiles become a picture; whether samples do follows from the policy.
    pub style: TileStyle,
    /// Show a frame when its time is over, complete or not.
    pub paced: bool,
    /// Judge every frame; takes some milliseconds each.
    pub judged: bool,
    /// Who decodes.
    pub decoding: Decoding,
}

impl FrameOptions {
    /// Shows whole frames in `view` on the usual screen, decoded on all cores.
    #[must_use]
    pub fn new(player: PlayerOptions, view: EyeView) -> Self {
        Self {
            player,
            view,
            screen: Screen::default(),
            style: TileStyle::default(),
            paced: false,
            judged: false,
            decoding: Decoding::software(),
        }
    }
}

/// Who decodes, and on how many threads.
#[derive(Clone, Copy, Debug)]
pub struct Decoding {
    /// Decoding threads.
    pub jobs: usize,
    /// The processor or a graphics device.
    pub choice: DecoderChoice,
}

impl Decoding {
    /// By the processor, on all cores.
    #[must_use]
    pub fn software() -> Self {
        let cores = std::thread::available_parallelism();
        Self::on(cores.map_or(1, usize::from))
    }

    /// By the processor, on so many threads.
    #[must_use]
    pub fn on(jobs: usize) -> Self {
        Self {
            jobs,
            choice: DecoderChoice::Software,
        }
    }

    /// The decoders of a video.
    pub(crate) fn pool(self, file: &PackFile) -> Result<DecodePool, MediaError> {
        DecodePool::choosing(file, self.jobs, self.choice)
    }
}
