//! How much of the sphere does an equirectangular picture show?

/// How much of the sphere an equirectangular picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// All of it.
    Full,
    /// Yaw and pitch within 90° of forward, as in VR180; the rest is black.
    FrontHalf,
}

/// Face size that keeps the pixels of a turn: the next multiple of 16 that is not below a quarter
/// of a full sphere's width.
///
/// An equi-angular face spans 90° in `n` pixels evenly: the density of the source round the
/// horizon. A gnomonic one has `n / 2` pixels a radian at its centre and `n` at the middle of an
/// edge, where the source has `2 n / pi`: 0.79 of it in the middle.
///
/// ```
/// use foveal_media::sphere::{Coverage, face_size_for};
/// assert_eq!(face_size_for(4096, Coverage::Full), 1024);
/// assert_eq!(face_size_for(2900, Coverage::FrontHalf), 1456);
/// ```
#[must_use]
pub fn face_size_for(width: u32, coverage: Coverage) -> u32 {
    let quarter_turn = match coverage {
        Coverage::Full => width.div_ceil(4),
        Coverage::FrontHalf => width.div_ceil(2),
    };
    quarter_turn.max(1).next_multiple_of(16)
}
