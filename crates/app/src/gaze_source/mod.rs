//! Where does a command's gaze come from?

mod choice;
mod feed;
mod intake;
mod live;
mod source;
mod trace_file;
mod tracker_options;
mod viewer;

pub(crate) use choice::{GazeChoice, LiveChoice, gaze_in_two_words, parse_gaze};
pub(crate) use intake::Counts;
pub(crate) use live::{Live, interrupted};
pub(crate) use source::{FIRST_SAMPLE, GazeSource};
pub(crate) use trace_file::{GazeFile, GazeForm, read_table, read_trace};
pub(crate) use tracker_options::{TrackerOptions, parse_tracker_screen};
pub(crate) use viewer::{ViewerModel, preset_of};
