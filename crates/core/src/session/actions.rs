//! What goes into a session, and what comes out of it?

use crate::content::policy::PolicyConfig;
use crate::content::unit::{AssetId, UnitRef};
use crate::perception::footprints::Measured;
use crate::perception::moment::Moment;
use crate::session::log::SessionFrame;
use crate::session::unit_states::Piece;
use crate::units::Seconds;
use crate::view::mounted::MountedPanel;
use std::collections::HashMap;

/// The moment that a step is made for.
#[derive(Clone, Debug)]
pub struct Now {
    /// By the clock of the side that shows.
    pub wall: Seconds,
    /// In the content, counted on.
    pub media: Seconds,
    /// What the content's time does.
    pub pace: Pace,
    /// How long the next picture is expected to take to draw, where that is longer than a frame is
    /// shown; else 0. [`Figures::slow_draw`](crate::session::figures::Figures::slow_draw) says it,
    /// from what [`SessionEvent::Drawn`] reported.
    pub drawing: Seconds,
    /// Until when what is brought can be spent on what is chosen now, by the clock of gazes.
    pub until: Seconds,
    /// Where the viewer looks, and through what.
    pub moment: Moment,
}

/// What the content's time does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// It runs: frames are shown as they fall due.
    Playing,
    /// It stands: the picture is refined until nothing is missing.
    Standing,
    /// Frames come one by one, as fast as they can be made, each begun by
    /// [`Session::begin_frame`](crate::session::session::Session::begin_frame): it is chosen for
    /// once, and shown when it is whole.
    FrameByFrame,
    /// As before, and the time of the frame is over: it is shown with what is there.
    FrameIsOver,
}

/// What happened outside.
#[derive(Clone, Debug, PartialEq)]
pub enum SessionEvent {
    /// A piece was decoded, and frames of its unit with it; the side that decoded it keeps it
    /// until it is to be uploaded or dropped.
    Decoded {
        /// What came.
        piece: Piece,
        /// Frames that were decoded for it, those to catch up included.
        frames: u32,
    },
    /// A piece cannot be decoded.
    Damaged {
        /// What does not come.
        piece: Piece,
        /// Frames that were decoded in vain.
        frames: u32,
    },
    /// More is known of the scene: a side table was loaded, which may give the frames' times. Pages
    /// of an index count without being reported.
    TableLoaded,
    /// The device that drew is gone, and what was on it.
    DeviceLost,
    /// Another policy is asked for.
    PolicyChosen(Box<PolicyConfig>),
    /// What the link brings from now on.
    LinkRate {
        /// In bytes a second.
        bytes_per_s: f64,
    },
    /// The link brought bytes besides what was bought, as index pages of it: so much less is bought
    /// from now on.
    Charged {
        /// How many.
        bytes: u64,
    },
    /// What is spent counts from here, by the clock of gazes.
    BeganAt(Seconds),
    /// Every moment is seen through these panels, turned with its head: as
    /// [`MountedPanel::views`] gives them.
    Mounted(Vec<MountedPanel>),
    /// What units may take on the GPU from now on: the pictures of what draws take the rest.
    GpuRoom {
        /// In bytes.
        bytes: u64,
    },
    /// What stayed on the GPU without being shown gave way to something else there.
    Evicted(Vec<Piece>),
    /// The viewer went elsewhere in time.
    Jumped,
    /// Whether what was drawn is being measured, and [`Self::Measured`] follows.
    Measuring {
        /// Whether it is.
        is_under_way: bool,
    },
    /// What is known from now on of the units of an asset by what was drawn.
    Measured {
        /// Whose units.
        asset: AssetId,
        /// What of the view they would refine, or are worth: whichever the policy asks for.
        measured: Measured,
    },
    /// What was to be shown was drawn.
    Drawn {
        /// How long after it was chosen.
        took: Seconds,
    },
    /// What [`SessionAction::Count`] asked for.
    Counted {
        /// Bytes of GPU memory in use.
        gpu_bytes: u64,
        /// Units on screen with another frame than their own.
        wrong_frame_units: u64,
    },
    /// The GPU's driver complained.
    GpuErrors {
        /// How often, since it was last asked.
        count: u64,
    },
}

/// What is to be done outside, in this order.
#[derive(Clone, Debug, PartialEq)]
pub enum SessionAction {
    /// From now on these are to be fetched and decoded, first what matters most, and nothing else.
    Want(Vec<Piece>),
    /// From now on this frame is shown.
    BeginFrame(u32),
    /// This piece, which was decoded, goes to where it is drawn from, and is shown.
    Upload(Piece),
    /// This piece, which stayed there, is shown again.
    Show(Piece),
    /// What is there is shown, may stay there, or is to be evicted.
    Keep {
        /// These and the coarsest level are shown, and nothing else.
        shown: Vec<UnitRef>,
        /// These stay as long as nothing takes their places, first what is to stay longest; each
        /// after those that it needs.
        staying: Vec<UnitRef>,
    },
    /// This piece, which was decoded, is not needed.
    Drop(Piece),
    /// Lines of the session log.
    Log(String),
    /// What was chosen, as the log records it.
    Chosen(Box<SessionFrame>),
    /// Something was shown, evicted or refined: how much memory is in use, and whether pieces of
    /// other frames are on screen, is to be reported: by [`SessionEvent::Counted`].
    Count,
}

/// What was decoded and waits to be uploaded.
#[derive(Debug)]
pub struct Cache<P> {
    payloads: HashMap<Piece, P>,
}

impl<P> Default for Cache<P> {
    fn default() -> Self {
        Self {
            payloads: HashMap::new(),
        }
    }
}

impl<P> Cache<P> {
    /// Keeps what was decoded.
    pub fn insert(&mut self, piece: Piece, payload: P) {
        self.payloads.insert(piece, payload);
    }

    /// Gives what was kept away, to be uploaded or dropped.
    pub fn take(&mut self, piece: Piece) -> Option<P> {
        self.payloads.remove(&piece)
    }
}
