//! How does an equirectangular picture become a cube, and a cube an equirectangular picture?
//!
//! Faces lie as in [`foveal_core::view::surface::CUBE_FACES`]. Column `u` in [0, 1) of a full
//! sphere is yaw `(u - 0.5) * 2 pi`, row `v` is pitch `(0.5 - v) * pi`, and samples lie at half
//! integers.

mod block;
mod cap;
mod coverage;
mod fast;
mod kernel;
mod padding;
mod plane;
mod poles;
mod sides;
mod unfold;

#[cfg(test)]
mod tests;

use crate::parallel::in_parallel;
use block::{Block, STRIP};
use cap::Cap;
pub use coverage::{Coverage, face_size_for};
pub(crate) use fast::catmull_rom;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::{CUBE_FACES, Mapping};
use kernel::Kernel;
use plane::Plane;
use std::sync::{Mutex, PoisonError};
pub use unfold::equirect_from_cube;

/// Resamples equirectangular pictures of one size onto cubes of one size.
///
/// The filter is a sinc under a Kaiser window, six samples of the coarser grid to either side. It
/// widens where the source is denser than the face: to 4/pi at a face's centre, and along longitude
/// to one over the distance from the pole, which ends at the rim of a cap of 24 face samples around
/// each pole. Within the cap every sample counts by its place on the face, across the pole too.
///
/// ```
/// use foveal_core::view::picture::Picture;
/// use foveal_media::sphere::{Coverage, CubeSampler, face_size_for};
/// let sphere = Picture::filled(256, 128, [90, 128, 128]);
/// let face = face_size_for(256, Coverage::Full);
/// let sampler = CubeSampler::new([256, 128], face, Coverage::Full, true);
/// let faces = sampler.cube_from_equirect(&sphere, 2);
/// assert_eq!(faces[4], Picture::filled(64, 64, [90, 128, 128]));
/// ```
pub struct CubeSampler {
    size: [u32; 2],
    face: u32,
    coverage: Coverage,
    chroma_left: bool,
    mapping: Mapping,
    kernel: Kernel,
    /// For the fast way where it can be gone.
    fast: Option<Box<fast::Fast>>,
}

/// Which samples one part of the work makes: those like columns `start..` of the front face, or
/// like rows `start..` of the top face.
#[derive(Clone, Copy)]
struct Part {
    plane: usize,
    poles: bool,
    start: usize,
}

impl CubeSampler {
    /// From pictures of `size` pixels to faces of `face` pixels on a side.
    ///
    /// `chroma_left` says that the source's chroma lies on the left luma sample of each pair; the
    /// cube's always lies between the two.
    ///
    /// # Panics
    /// When a size is zero or `face` is odd.
    #[must_use]
    pub fn new(size: [u32; 2], face: u32, coverage: Coverage, chroma_left: bool) -> Self {
        assert!(size[0] > 0 && size[1] > 0, "a picture of {size:?} pixels");
        assert!(
            face > 0 && face.is_multiple_of(2),
            "a face of {face} pixels halves its chroma unevenly"
        );
        Self {
            size,
            face,
            coverage,
            chroma_left,
            mapping: Mapping::Gnomonic,
            kernel: Kernel::new(),
            fast: None,
        }
    }

    /// The same onto faces of another mapping than the gnomonic one.
    #[must_use]
    pub fn mapped(self, mapping: Mapping) -> Self {
        Self {
            mapping,
            fast: None,
            ..self
        }
    }

    /// A sampler that takes a cubic kernel, widened only where it must be, and remembers where
    /// samples look: many times as fast, a little softer and with a little more aliasing of the
    /// finest detail. Takes about 15 bytes a pixel of one face, and about 11 MB for the caps; sizes
    /// that it cannot do are sampled as before.
    #[must_use]
    pub fn fast(mut self) -> Self {
        let empty = Picture::filled(self.size[0], self.size[1], [0; 3]);
        let [luma, chroma] = [0, 1].map(|p| self.plane(&empty, p));
        self.fast = fast::Fast::new(&luma, &chroma, &self.kernel).map(Box::new);
        self
    }

    /// The six faces of `picture`, the same for any number of threads `jobs`.
    ///
    /// # Panics
    /// When `picture` has another size than the sampler was made for, or lacks samples.
    #[must_use]
    pub fn cube_from_equirect(&self, picture: &Picture, jobs: usize) -> [Picture; 6] {
        assert_eq!(
            [picture.width, picture.height],
            self.size,
            "a picture of another size"
        );
        assert!(picture.is_consistent(), "a picture lacks samples");
        let planes = [0, 1, 2].map(|p| self.plane(picture, p));
        let faces = CUBE_FACES.map(|_| {
            let face = Picture::filled(self.face, self.face, [16, 128, 128]);
            Mutex::new(face)
        });
        // Written at once by the thread that made it: a block's memory serves for the next one.
        let write = |p: usize, block: Block| {
            let face = faces[block.face].lock();
            let mut face = face.unwrap_or_else(PoisonError::into_inner);
            block.write_to(&mut face.planes[p], planes[p].face);
        };
        match &self.fast {
            Some(fast) => fast.make(&planes, jobs, write),
            None => self.make(&planes, jobs, write),
        }
        let mut faces = faces.map(|face| face.into_inner().unwrap_or_else(PoisonError::into_inner));
        if self.coverage == Coverage::FrontHalf {
            blacken_back(&mut faces);
        }
        faces
    }

    /// Makes all samples of the six faces, and hands them over with the plane that they are of.
    fn make(&self, planes: &[Plane; 3], jobs: usize, done: impl Fn(usize, Block) + Sync) {
        let caps =
            [0, 1, 2].map(|p: usize| [0, 1].map(|pole| Cap::new(&planes[p], &self.kernel, pole)));
        let parts = self.parts();
        in_parallel(jobs, parts.len(), |part| {
            let Part {
                plane: p,
                poles,
                start,
            } = parts[part];
            let (plane, kernel) = (&planes[p], &self.kernel);
            let range = start..(start + STRIP).min(plane.face.div_ceil(2));
            let blocks = if poles {
                poles::pole_blocks(plane, kernel, &caps[p], range)
            } else {
                sides::side_blocks(plane, kernel, range)
            };
            blocks.into_iter().for_each(|block| done(p, block));
        });
    }

    /// Plane `p` of the source, ready to be read across its borders.
    fn plane(&self, picture: &Picture, p: usize) -> Plane {
        // A sample on the left luma sample of its pair lies a quarter of a column left of its
        // place.
        let shift = if p > 0 && self.chroma_left { 0.25 } else { 0.0 };
        let face = self.face as usize >> usize::from(p > 0);
        Plane::new(
            &picture.planes[p],
            picture.plane_size(p),
            self.coverage,
            shift,
            face,
            self.mapping,
        )
    }

    /// All parts of the work, the largest first.
    fn parts(&self) -> Vec<Part> {
        let mut parts = Vec::new();
        for plane in 0..3 {
            let half = (self.face as usize >> usize::from(plane > 0)).div_ceil(2);
            for poles in [true, false] {
                parts.extend((0..half).step_by(STRIP).map(|start| Part {
                    plane,
                    poles,
                    start,
                }));
            }
        }
        parts
    }
}

/// Makes black whatever looks behind the viewer.
fn blacken_back(faces: &mut [Picture; 6]) {
    for (face, axes) in faces.iter_mut().zip(CUBE_FACES) {
        for p in 0..3 {
            let black = if p == 0 { 16 } else { 128 };
            let [w, _] = face.plane_size(p);
            let tangent = |index: usize| (index as f64 + 0.5) * 2.0 / f64::from(w) - 1.0;
            for (y, row) in face.planes[p].chunks_exact_mut(w as usize).enumerate() {
                for (x, sample) in row.iter_mut().enumerate() {
                    if axes.at([tangent(x), tangent(y)]).z > 0.0 {
                        *sample = black;
                    }
                }
            }
        }
    }
}
