//! How is a file to be read, and what comes of it?

use foveal_core::view::picture::Picture;

use crate::read::film::deinterlace::Deinterlace;

/// How a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Whether damage ends it, in place of being concealed and counted.
    pub strict: bool,
    /// What becomes of interlaced film.
    pub deinterlace: Deinterlace,
}

/// A picture and the time at which it is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimedPicture {
    /// Upright, 8-bit 4:2:0, with the size and the colour of [`SourceInfo`].
    pub picture: Picture,
    /// Nanoseconds after the first picture; rises strictly.
    pub time_ns: i64,
}
