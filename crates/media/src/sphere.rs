//! How does an equirectangular picture become a cube, and a cube an equirectangular picture?
//!
//! Faces lie as in [`foveal_core::view::surface::CUBE_FACES`]. Column `u` in [0, 1) of a full sphere
//! is yaw `(u - 0.5) * 2 pi`, row `v` is pitch `(0.5 - v) * pi`, and samples lie at half integers.

mod cap;
mod kernel;
mod padding;
pub(crate) mod parallel;
mod plane;
mod poles;
mod sides;
mod unfold;

#[cfg(test)]
mod tests;

use cap::Cap;
use foveal_core::asset::picture::Picture;
use foveal_core::view::surface::CUBE_FACES;
use kernel::Kernel;
use plane::Plane;
pub use unfold::equirect_from_cube;

/// How much of the sphere an equirectangular picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// All of it.
    Full,
    /// Yaw and pitch within 90° of forward, as in VR180; the rest is black.
    FrontHalf,
}

/// Face size that keeps the pixels of a turn: the next multiple of 16 that is not below a quarter of
/// a full sphere's width.
///
/// A face spans 90° in `n` pixels, `n / 2` a radian at its centre and `n` at the middle of an edge;
/// the source has `2 n / pi`. So a face's centre keeps 0.79 of the source's density and its edges
/// exceed it; keeping all of it everywhere would take 1.27 times the face and 1.6 times the pixels.
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

/// Resamples equirectangular pictures of one size onto cubes of one size.
///
/// The filter is a windowed sinc of [`kernel::REACH`] samples of the coarser grid to either side,
/// widened where the source is denser than the face: by up to 4/pi at a face's centre, and along
/// longitude by one over the distance from the pole, to at most 1/12 of a row a tap's unit at the
/// rim of a cap of 24 face samples around each pole. Within the cap each sample counts by its place
/// on the face, across the pole too.
pub struct CubeSampler {
    size: [u32; 2],
    face: u32,
    coverage: Coverage,
    chroma_left: bool,
    kernel: Kernel,
}

/// Columns of the upright faces in one part of the work.
const STRIP: usize = 32;

/// Rows of the top and bottom faces in one part of the work.
const ROWS: usize = 32;

/// A finished rectangle of one plane of one face.
struct Block {
    face: usize,
    plane: usize,
    at: [usize; 2],
    width: usize,
    samples: Vec<u8>,
}

/// What one part of the work makes.
#[derive(Clone, Copy)]
enum Part {
    Sides { plane: usize, start: usize },
    Poles { plane: usize, start: usize },
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
            face > 0 && face % 2 == 0,
            "a face of {face} pixels halves its chroma unevenly"
        );
        Self {
            size,
            face,
            coverage,
            chroma_left,
            kernel: Kernel::new(),
        }
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
        let caps =
            [0, 1, 2].map(|p: usize| [0, 1].map(|pole| Cap::new(&planes[p], &self.kernel, pole)));
        let parts = self.parts();
        let blocks = parallel::in_parallel(jobs, parts.len(), |part| match parts[part] {
            Part::Sides { plane, start } => self.side_blocks(&planes[plane], plane, start),
            Part::Poles { plane, start } => {
                self.pole_blocks(&planes[plane], &caps[plane], plane, start)
            }
        });
        let mut faces = CUBE_FACES.map(|_| Picture::filled(self.face, self.face, [16, 128, 128]));
        for block in blocks.iter().flatten() {
            let [x, y] = block.at;
            let face_width = planes[block.plane].face;
            let out = &mut faces[block.face].planes[block.plane];
            for (row, samples) in block.samples.chunks_exact(block.width).enumerate() {
                out[(y + row) * face_width + x..][..block.width].copy_from_slice(samples);
            }
        }
        if self.coverage == Coverage::FrontHalf {
            blacken_back(&mut faces);
        }
        faces
    }

    /// Plane `p` of the source, ready to be read across its borders.
    fn plane(&self, picture: &Picture, p: usize) -> Plane {
        // A sample on the left luma sample of its pair lies a quarter of a column left of its place.
        let shift = if p > 0 && self.chroma_left { 0.25 } else { 0.0 };
        let face = self.face as usize >> usize::from(p > 0);
        Plane::new(
            &picture.planes[p],
            picture.plane_size(p),
            self.coverage,
            shift,
            face,
        )
    }

    /// All parts of the work, the largest first.
    fn parts(&self) -> Vec<Part> {
        let mut parts = Vec::new();
        for plane in 0..3 {
            let face = self.face as usize >> usize::from(plane > 0);
            parts.extend(
                (0..face)
                    .step_by(ROWS)
                    .map(|start| Part::Poles { plane, start }),
            );
            parts.extend(
                (0..face)
                    .step_by(STRIP)
                    .map(|start| Part::Sides { plane, start }),
            );
        }
        parts
    }

    fn side_blocks(&self, source: &Plane, plane: usize, start: usize) -> Vec<Block> {
        let columns = start..(start + STRIP).min(source.face);
        let width = columns.len();
        let strips = sides::side_strips(source, &self.kernel, columns);
        let block = |(face, samples)| Block {
            face,
            plane,
            at: [start, 0],
            width,
            samples,
        };
        strips.into_iter().enumerate().map(block).collect()
    }

    fn pole_blocks(
        &self,
        source: &Plane,
        caps: &[Cap; 2],
        plane: usize,
        start: usize,
    ) -> Vec<Block> {
        let width = source.face;
        let rows = start..(start + ROWS).min(width);
        let below = width - rows.end;
        let [top, mirrored] = poles::pole_rows(source, &self.kernel, caps, rows);
        let bottom = mirrored
            .chunks_exact(width)
            .rev()
            .flatten()
            .copied()
            .collect();
        vec![
            Block {
                face: 4,
                plane,
                at: [0, start],
                width,
                samples: top,
            },
            Block {
                face: 5,
                plane,
                at: [0, below],
                width,
                samples: bottom,
            },
        ]
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
