//! What does a file say about its projection and its two eyes?

use av::codec::packet::side_data::Type;
use av::format::stream::Stream;
use ffmpeg_next as av;

/// How far a bound may lie from a quarter for the picture to be the front half of the sphere.
const HALF_TOLERANCE: f64 = 0.01;

/// How the flat picture lies on the sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SphericalProjection {
    /// The whole sphere, longitude across and latitude down.
    Equirect,
    /// A part of an equirectangular picture.
    EquirectPart {
        /// What is cut off at the left, top, right and bottom, as parts of the whole, 0 to 1.
        cut: [f64; 4],
    },
    /// Six cube faces, three columns by two rows.
    Cube {
        /// Pixels added around each face.
        padding: u32,
    },
}

/// Spherical metadata of a video stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spherical {
    /// Where the picture lies on the sphere.
    pub projection: SphericalProjection,
    /// Turn of the sphere about the up axis in degrees, the front moving to the right.
    pub yaw_deg: f64,
    /// Then about the right axis in degrees, the front moving up.
    pub pitch_deg: f64,
    /// Then about the forward axis in degrees, the front tilting to the right.
    pub roll_deg: f64,
}

impl Spherical {
    /// Whether the picture shows the front half of the sphere (180-degree video).
    #[must_use]
    pub fn is_half(&self) -> bool {
        let SphericalProjection::EquirectPart {
            cut: [left, top, right, bottom],
        } = self.projection
        else {
            return false;
        };
        let near = |value: f64, wanted: f64| (value - wanted).abs() < HALF_TOLERANCE;
        near(left, 0.25) && near(right, 0.25) && near(top, 0.0) && near(bottom, 0.0)
    }

    /// From the bytes of FFmpeg's `AVSphericalMapping`; None where they are too few or name a
    /// projection that this version does not know.
    fn from_side_data(bytes: &[u8]) -> Option<Self> {
        let word = |i: usize| words_at(bytes, i);
        // Angles are 16.16 fixed point, bounds are 0.32.
        let angle = |i: usize| Some(f64::from(word(i)?.cast_signed()) / 65536.0);
        let part = |i: usize| Some(f64::from(word(i)?) / 4_294_967_296.0);
        let projection = match word(0)? {
            0 => SphericalProjection::Equirect,
            1 => SphericalProjection::Cube { padding: word(8)? },
            2 => SphericalProjection::EquirectPart {
                cut: [part(4)?, part(5)?, part(6)?, part(7)?],
            },
            _ => return None,
        };
        Some(Self {
            projection,
            yaw_deg: angle(1)?,
            pitch_deg: angle(2)?,
            roll_deg: angle(3)?,
        })
    }
}

/// How the pictures of the two eyes share a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StereoLayout {
    /// Next to each other.
    SideBySide,
    /// One above the other.
    TopBottom,
    /// In a way that Foveal does not read: alternating frames, lines, columns or a checkerboard.
    Other,
}

/// Stereo metadata of a video stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stereo {
    /// Where the two pictures are.
    pub layout: StereoLayout,
    /// True when the right eye's picture comes first (left or top).
    pub right_first: bool,
}

impl Stereo {
    /// From the bytes of FFmpeg's `AVStereo3D`; None for a single view.
    fn from_side_data(bytes: &[u8]) -> Option<Self> {
        let layout = match words_at(bytes, 0)? {
            0 => return None,
            1 => StereoLayout::SideBySide,
            2 => StereoLayout::TopBottom,
            _ => StereoLayout::Other,
        };
        Some(Self {
            layout,
            right_first: words_at(bytes, 1)? & 1 == 1,
        })
    }
}

fn words_at(bytes: &[u8], i: usize) -> Option<u32> {
    Some(u32::from_ne_bytes(
        bytes.get(4 * i..4 * i + 4)?.try_into().ok()?,
    ))
}

/// The projection that the stream names, if it does.
pub(crate) fn spherical_of(stream: &Stream) -> Option<Spherical> {
    side_data_of(stream, Type::DataSpherical).and_then(|bytes| Spherical::from_side_data(&bytes))
}

/// The stereo layout that the stream names, if it does.
pub(crate) fn stereo_of(stream: &Stream) -> Option<Stereo> {
    side_data_of(stream, Type::Stereo3d).and_then(|bytes| Stereo::from_side_data(&bytes))
}

/// A copy of the stream's side data of one kind.
pub(crate) fn side_data_of(stream: &Stream, kind: Type) -> Option<Vec<u8>> {
    stream
        .side_data()
        .find(|data| data.kind() == kind)
        .map(|data| data.data().to_vec())
}
