//! Every decision of Foveal, as pure functions: no file, socket, clock, thread or GPU.

#![forbid(unsafe_code)]

pub mod content;
pub mod gaze;
pub mod pack;
pub mod perception;
pub mod selection;
pub mod session;
pub mod units;
pub mod view;
