//! What lies beyond the edge of a cube face, on the face's own grid?
//!
//! The plane of a face is continued with what its neighbours show there. A neighbour is
//! interpolated near its own edge too, so margins are filled from margins: first with the nearest
//! sample, then three times with the kernel, after which they no longer change.

use super::kernel::{Kernel, Taps, code_value, dot, keep_six_bits};
use foveal_core::view::surface::Surface;

/// Rounds of filling the margins with the kernel.
const ROUNDS: usize = 3;

/// One plane of the six faces, each with a margin on every side.
pub(super) struct PaddedCube {
    faces: Vec<Vec<u8>>,
    surface: Surface,
    margin: usize,
}

impl PaddedCube {
    /// `planes` hold `face` samples on a side; kernels may reach `margin` samples beyond an edge.
    pub(super) fn new(planes: [&[u8]; 6], face: usize, margin: usize, kernel: &Kernel) -> Self {
        let side = face + 2 * margin;
        let copy = |plane: &[u8]| {
            let mut padded = vec![0; side * side];
            for (y, row) in plane.chunks_exact(face).enumerate() {
                padded[(y + margin) * side + margin..][..face].copy_from_slice(row);
            }
            padded
        };
        let surface = Surface::cube(face as u32);
        let mut this = Self {
            faces: planes.map(copy).to_vec(),
            surface,
            margin,
        };
        let nearest = |this: &Self, neighbour: u32, [x, y]: [f64; 2]| {
            let [x, y] = [x, y].map(|place| (place as usize).min(face - 1) + this.margin);
            this.faces[neighbour as usize][y * side + x]
        };
        this.faces = this.refill(nearest);
        for _ in 0..ROUNDS {
            let mut taps = [Taps::default(), Taps::default()];
            this.faces = this.refill(|this, neighbour, place| {
                this.at(kernel, neighbour, place, [1.0; 2], &mut taps)
            });
        }
        this
    }

    /// Samples beyond an edge that a kernel needs at `stretch`.
    pub(super) fn margin_for(stretch: f64) -> usize {
        Kernel::most_taps(stretch) + 2
    }

    /// Filtered value at a place of a face, `stretch` samples wide a unit of the kernel.
    pub(super) fn at(
        &self,
        kernel: &Kernel,
        face: u32,
        place: [f64; 2],
        stretch: [f64; 2],
        [along, down]: &mut [Taps; 2],
    ) -> u8 {
        let side = self.side();
        let margin = self.margin as f64;
        let x = kernel.weigh(place[0] - 0.5 + margin, stretch[0], along);
        let y = kernel.weigh(place[1] - 0.5 + margin, stretch[1], down);
        let last = side - along.fixed.len();
        let x = (x.max(0) as usize).min(last);
        let mut sum = 0;
        for (row, &weight) in (y..).zip(&down.fixed) {
            let row = (row.max(0) as usize).min(side - 1);
            let samples = &self.faces[face as usize][row * side + x..];
            sum += keep_six_bits(dot(samples, &along.fixed)) * i32::from(weight);
        }
        code_value(sum)
    }

    fn side(&self) -> usize {
        self.surface.size[0] as usize + 2 * self.margin
    }

    /// The faces with every margin sample computed again from its place on the neighbour.
    fn refill(&self, mut sample: impl FnMut(&Self, u32, [f64; 2]) -> u8) -> Vec<Vec<u8>> {
        let (side, margin) = (self.side(), self.margin);
        let inside = margin..side - margin;
        let mut faces = self.faces.clone();
        for (face, padded) in faces.iter_mut().enumerate() {
            for y in 0..side {
                for x in 0..side {
                    if inside.contains(&x) && inside.contains(&y) {
                        continue;
                    }
                    let place = [x, y].map(|k| k as f64 + 0.5 - margin as f64);
                    let direction = self.surface.direction(face as u32, place);
                    if let Some((neighbour, place)) = self.surface.locate(direction) {
                        padded[y * side + x] = sample(self, neighbour, place);
                    }
                }
            }
        }
        faces
    }
}
