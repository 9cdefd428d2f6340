//! Groups of tiles and sound, coded and decoded.

pub mod decode;
pub mod decode_pool;
pub(crate) mod decode_queue;
pub(crate) mod decode_streams;
pub mod decoders;
pub mod encode;
pub mod encode_settings;
pub(crate) mod encoder;
pub(crate) mod hardware;
pub(crate) mod ijg_jpeg;
pub(crate) mod rate_search;
pub mod sound;
pub(crate) mod stacked_png;
