//! How does one source fill any number of panels at once?
//!
//! [`WarpPlan`] is what the pass reads: a record a panel. [`Warper`] draws all panels of a plan in
//! one pass into one atlas; [`crate::twin::warp`] draws the same on the CPU. [`PanelOptics`] does
//! so panel by panel, of a picture that was drawn for each.

mod batches;
mod blends;
mod optics;
pub mod params;
mod pass;
mod plan;
mod source;
mod style;

pub use optics::PanelOptics;
pub use pass::{LoadedPlan, Warper};
pub use plan::{PanelOnSource, WarpPlan};
pub use source::{SourceTexture, levels_of};
pub use style::{WarpFilter, WarpStyle};
