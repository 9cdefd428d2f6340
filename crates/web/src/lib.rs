//! What a page in a browser calls: bytes, planes, gaze and time in; requests and pixels out.
//!
//! Decisions are core's, pictures render's; here they meet, as they do in the app natively. All
//! but the canvas compiles and is tested on every target.

#![cfg_attr(
    not(target_arch = "wasm32"),
    allow(
        dead_code,
        reason = "the calls that use it are compiled for browsers alone"
    )
)]

mod arriving;
mod facts;
mod gaze_source;
mod headset_eye;
mod needs;
mod opening;
mod options;
mod pack_in_parts;
mod page_player;
mod stretches;
mod telling;
#[cfg(test)]
mod tests;

#[cfg(target_arch = "wasm32")]
mod device_canvas;
#[cfg(target_arch = "wasm32")]
mod pixel_canvas;
#[cfg(target_arch = "wasm32")]
mod show;

pub use facts::about;
pub use opening::{OpenPack, Opening};
pub use options::Options;
pub use page_player::{PagePlayer, flag};
pub use stretches::{Arrival, Need, Part, PictureNeed};
