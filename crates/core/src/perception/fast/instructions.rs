//! Which vector instructions may this machine's rows be worked on with?
//!
//! The same statements are compiled once for the least machine and, for x86-64, once more for AVX2.
//! Nothing is contracted or reordered, so both give the same bits.

#[cfg(target_arch = "x86_64")]
use fearless_simd::{Level, Simd, x86::Avx2};

/// The vector instructions that rows of pictures are worked on with, in core and in what judges it.
///
/// ```
/// use foveal_core::perception::fast::instructions::Instructions;
///
/// let mut row = [1.0_f32, 2.0, 3.0];
/// Instructions::widest().run(|| row.iter_mut().for_each(|sample| *sample *= 2.0));
/// assert_eq!(row, [2.0, 4.0, 6.0]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Instructions {
    #[cfg(target_arch = "x86_64")]
    avx2: Option<Avx2>,
}

impl Instructions {
    /// The widest of the machine that this runs on, which is asked.
    #[must_use]
    pub fn widest() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            avx2: Level::new().as_avx2(),
        }
    }

    /// Those that every machine of its kind has: what tests hold the widest against.
    #[must_use]
    pub fn least() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            avx2: None,
        }
    }

    /// Runs `work` once; what is to use these instructions must be marked to be inlined into it.
    /// Its results are the same bits whatever the instructions.
    #[inline(always)]
    pub fn run(self, work: impl FnOnce()) {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.avx2 {
            return avx2.vectorize(work);
        }
        work();
    }
}
