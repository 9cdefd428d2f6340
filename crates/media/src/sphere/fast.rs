//! How does a sphere become a cube fast enough to prepare video by?
//!
//! The places that face samples look at, in 64ths of a source sample, are computed once for all
//! frames. A sample is then a widened cubic of at most eight by eight source samples out of a table
//! of weights. The slow way is the oracle of the tests.

mod cubic;
mod poles;
mod sides;

use super::block::Block;
use super::kernel::Kernel;
use super::plane::Plane;
use crate::parallel::in_parallel;
pub(crate) use cubic::catmull_rom;
use cubic::{Cubic, WIDEST_INNER};
use poles::{PolePlaces, PoleRows};
use sides::SidePlaces;
use std::ops::Range;

/// All that does not depend on the picture.
pub(super) struct Fast {
    cubic: Cubic,
    /// Of luma and of chroma.
    places: [Places; 2],
}

struct Places {
    sides: SidePlaces,
    poles: PolePlaces,
}

/// One part of the work.
enum Part {
    /// Columns of the four upright faces.
    Sides(usize, Range<usize>),
    /// Rows of the face of a pole.
    Pole(usize, usize, Range<usize>),
}

impl Fast {
    /// For planes like these, luma and chroma; `None` where this way cannot be gone.
    pub(super) fn new(luma: &Plane, chroma: &Plane, kernel: &Kernel) -> Option<Self> {
        let places = [Places::new(luma, kernel)?, Places::new(chroma, kernel)?];
        Some(Self {
            cubic: Cubic::new(),
            places,
        })
    }

    /// Makes all samples of the six faces, and hands them over with the plane that they are of.
    pub(super) fn make(
        &self,
        planes: &[Plane; 3],
        jobs: usize,
        done: impl Fn(usize, Block) + Sync,
    ) {
        let places = |p: usize| &self.places[p.min(1)];
        let rows = in_parallel(jobs, 6, |k| {
            let p = k / 2;
            PoleRows::new(&places(p).poles, &planes[p], k % 2 == 0)
        });
        let mut parts = Vec::new();
        for p in 0..3 {
            let sides = places(p).sides.strips();
            parts.extend(sides.map(|strip| Part::Sides(p, strip)));
            for pole in 0..2 {
                let strips = places(p).poles.strips();
                parts.extend(strips.map(|strip| Part::Pole(p, pole, strip)));
            }
        }
        in_parallel(jobs, parts.len(), |part| match &parts[part] {
            Part::Sides(p, strip) => {
                let (sides, strip) = (&places(*p).sides, strip.clone());
                let blocks = sides.blocks(&self.cubic, &planes[*p], strip);
                blocks.into_iter().for_each(|block| done(*p, block));
            }
            Part::Pole(p, pole, strip) => {
                let (poles, strip) = (&places(*p).poles, strip.clone());
                done(*p, poles.block(&self.cubic, &rows[2 * p + pole], strip));
            }
        });
    }
}

impl Places {
    fn new(plane: &Plane, kernel: &Kernel) -> Option<Self> {
        let across = plane.columns_per_step().max(plane.rows_per_step());
        if across * plane.slope(0.0) > WIDEST_INNER {
            return None;
        }
        Some(Self {
            poles: PolePlaces::new(plane, kernel)?,
            sides: SidePlaces::new(plane),
        })
    }
}
