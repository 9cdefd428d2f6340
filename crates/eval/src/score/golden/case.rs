//! What is one case whose score is known?

/// A case and what the published package gives for it.
#[derive(Clone, Copy, Debug)]
pub struct Golden {
    /// Its name.
    pub id: &'static str,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Frames; 1 is a still.
    pub frames: u32,
    /// Frames a second of a video.
    pub fps: Option<f64>,
    /// Name of the display.
    pub display: &'static str,
    /// Pixels that the scene moves a frame.
    pub speed: f64,
    /// What is done to the reference.
    pub test: TestPicture,
    /// Where the eye looks.
    pub gaze: GoldenGaze,
    /// First half of the SHA-256 of the reference's and of the test's bytes, in hexadecimal.
    pub sha256: [&'static str; 2],
    /// PSNR over all samples, decibels; infinite for the same.
    pub psnr_db: f64,
    /// Score of the published package.
    pub jod: f64,
    /// The same without its table of sensitivities.
    pub jod_fine_table: f64,
    /// The same with the right border.
    pub jod_right_border: f64,
    /// Energies of the published package, finest band first; none where it finds no difference.
    pub sustained: &'static [f64],
    /// Of a video.
    pub transient: &'static [f64],
}

/// What is done to a frame to get its test.
#[derive(Clone, Copy, Debug)]
pub enum TestPicture {
    /// Nothing.
    Same,
    /// Tiles of `tile` pixels become coarser beyond `radius` pixels round a place.
    Foveated {
        /// Where.
        round: GoldenGaze,
        /// Radius of what stays, pixels.
        radius: f64,
        /// Side of a tile, pixels.
        tile: usize,
        /// The path is this many frames late.
        late: u32,
    },
    /// From this frame on all is two levels coarser.
    Pop(u32),
}

/// A place in pixels.
#[derive(Clone, Copy, Debug)]
pub enum GoldenGaze {
    /// There is no gaze.
    Everywhere,
    /// One place.
    At([f64; 2]),
    /// Evenly from the first to the second place in the frames of the case.
    Along([f64; 2], [f64; 2]),
}

impl GoldenGaze {
    /// The place at a frame of `frames`.
    #[must_use]
    pub fn at(&self, frame: u32, frames: u32) -> Option<[f64; 2]> {
        match *self {
            Self::Everywhere => None,
            Self::At(place) => Some(place),
            Self::Along(from, to) => {
                let share = f64::from(frame) / f64::from(frames - 1);
                Some([0, 1].map(|k: usize| from[k] + (to[k] - from[k]) * share))
            }
        }
    }
}
