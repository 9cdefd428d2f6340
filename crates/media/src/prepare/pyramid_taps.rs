//! How much does each fine texel count for a coarse one?

/// Weights of the six fine texels around a coarse one, in 32nds.
///
/// Symmetric about the border between the middle two, so nothing moves. Against the binomial
/// 1-3-3-1 it keeps 0.87 instead of 0.79 of the amplitude at half the coarse Nyquist limit, and
/// lets through less than 0.04 instead of 0.06 at three quarters of the fine one; its overshoot is
/// 1/32.
pub(super) const TAPS: [i32; 6] = [-1, 4, 13, 13, 4, -1];

/// Fine texels before the first texel that a coarse one covers.
pub(super) const REACH: usize = 2;
