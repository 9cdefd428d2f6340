//! Which vector instructions may this machine's rows be worked on with?
//!
//! The same statements are compiled once for the least machine and, for x86-64, once more for AVX2.
//! Nothing is contracted or reordered, so both give the same bits.

#[cfg(target_arch = "x86_64")]
use fearless_simd::{Level, Simd, x86::Avx2};

/// Instructions that this machine is known to have.
#[derive(Clone, Copy)]
pub(super) struct Instructions {
    #[cfg(target_arch = "x86_64")]
    avx2: Option<Avx2>,
}

impl Instructions {
    /// The widest of this machine.
    pub(super) fn widest() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            avx2: Level::new().as_avx2(),
        }
    }

    /// Those that every machine of its kind has.
    #[cfg(test)]
    pub(super) fn least() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            avx2: None,
        }
    }

    /// Runs what is marked to be inlined into `work` with these instructions.
    #[inline(always)]
    pub(super) fn run(self, work: impl FnOnce()) {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.avx2 {
            return avx2.vectorize(work);
        }
        work();
    }
}
