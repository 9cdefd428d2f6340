//! How does a decoded frame become the picture that is delivered?

use av::format::Pixel;
use av::frame::Video;
use av::util::chroma::Location;
use av::{color, ffi};
use ffmpeg_next as av;
use foveal_core::asset::picture::{Colour, Matrix, Picture};

use crate::convert::{Converter, Layout};
use crate::frame::{is_420, new_frame, picture_from_frame, rows_run_down};
use crate::orientation::Orientation;

/// Pixels of the largest picture of standard definition (PAL, with room for wide pixels). A larger
/// one without a named matrix is taken as BT.709, by its width too: panoramas are low.
const STANDARD_DEFINITION: [u32; 2] = [1279, 576];

/// Turns frames of one stream into upright pictures of one size and one colour.
pub(crate) struct Delivery {
    orientation: Orientation,
    is_jpeg: bool,
    colour: Colour,
    /// Conversions before and after the turn, for frames of one layout.
    steps: Option<(Vec<Converter>, Vec<Converter>)>,
}

impl Delivery {
    /// Decides on the colour of the pictures from the stream's first frame; the error is the name
    /// of a colour matrix that a picture cannot hold.
    pub(crate) fn new(
        first: &Video,
        orientation: Orientation,
        is_jpeg: bool,
    ) -> Result<Self, String> {
        let layout = layout_of(first, is_jpeg)?;
        let full_range = layout.full_range && !is_rgb(first.format());
        let chroma_left = layout.chroma_left || !orientation.is_upright();
        let colour = Colour {
            matrix: layout.matrix,
            full_range,
            chroma_left,
        };
        Ok(Self {
            orientation,
            is_jpeg,
            colour,
            steps: None,
        })
    }

    /// How frames are turned.
    pub(crate) fn orientation(&self) -> Orientation {
        self.orientation
    }

    /// The colour of every picture that comes out.
    pub(crate) fn colour(&self) -> Colour {
        self.colour
    }

    /// The frame as an upright 8-bit 4:2:0 picture.
    pub(crate) fn picture(&mut self, frame: &Video) -> Result<Picture, String> {
        let from = layout_of(frame, self.is_jpeg)?;
        let as_it_is = from.full_range == self.colour.full_range
            && from.matrix == self.colour.matrix
            && self.orientation.is_upright();
        if as_it_is && is_420(from.format) && rows_run_down(frame) {
            return picture_from_frame(frame);
        }
        let mut steps = match self.steps.take() {
            Some(steps) if steps.0.first().is_some_and(|step| step.from() == from) => steps,
            _ => self.build_steps(from)?,
        };
        let mut current = run_all(&mut steps.0, frame)?;
        if !self.orientation.is_upright() {
            current = turn(&current, self.orientation)?;
            current = run_all(&mut steps.1, &current)?;
        }
        self.steps = Some(steps);
        picture_from_frame(&current)
    }

    /// Palettes go through RGB, whose matrix swscale lets us choose; turned pictures through 4:4:4,
    /// where chroma sits on luma and turns with it.
    fn build_steps(&self, from: Layout) -> Result<(Vec<Converter>, Vec<Converter>), String> {
        let Colour {
            matrix,
            full_range,
            chroma_left,
        } = self.colour;
        let to = |format, size| Layout {
            format,
            size,
            matrix,
            full_range,
            chroma_left,
        };
        let mut before = Vec::new();
        let mut start = from;
        if has_palette(from.format) {
            let rgb = Layout {
                format: Pixel::RGB24,
                ..from
            };
            before.push(Converter::new(from, rgb)?);
            start = rgb;
        }
        if self.orientation.is_upright() {
            before.push(Converter::new(start, to(Pixel::YUV420P, from.size))?);
            return Ok((before, Vec::new()));
        }
        before.push(Converter::new(start, to(Pixel::YUV444P, from.size))?);
        let turned = self.orientation.turned_size(from.size);
        let full = to(Pixel::YUV444P, turned);
        Ok((
            before,
            vec![Converter::new(full, to(Pixel::YUV420P, turned))?],
        ))
    }
}

fn run_all(steps: &mut [Converter], frame: &Video) -> Result<Video, String> {
    let (first, others) = steps
        .split_first_mut()
        .ok_or("a conversion without steps")?;
    others
        .iter_mut()
        .try_fold(first.run(frame)?, |current, step| step.run(&current))
}

fn turn(frame: &Video, orientation: Orientation) -> Result<Video, String> {
    let size = [frame.width(), frame.height()];
    let mut turned = new_frame(Pixel::YUV444P, orientation.turned_size(size))?;
    for p in 0..3 {
        let stride = turned.stride(p);
        orientation.turn(
            (frame.data(p), frame.stride(p)),
            size,
            (turned.data_mut(p), stride),
        );
    }
    Ok(turned)
}

fn layout_of(frame: &Video, is_jpeg: bool) -> Result<Layout, String> {
    let format = frame.format();
    let rgb = is_rgb(format);
    let is_full_by_format = matches!(
        format,
        Pixel::YUVJ420P | Pixel::YUVJ422P | Pixel::YUVJ444P | Pixel::YUVJ440P
    );
    let full_range = match frame.color_range() {
        color::Range::JPEG => true,
        color::Range::MPEG => rgb || is_full_by_format,
        color::Range::Unspecified => rgb || is_full_by_format || is_grey(format),
    };
    let chroma_left = match frame.chroma_location() {
        Location::Left | Location::TopLeft | Location::BottomLeft => true,
        Location::Center | Location::Top | Location::Bottom => false,
        Location::Unspecified => !is_jpeg,
    };
    let size = [frame.width(), frame.height()];
    let matrix = matrix_of(frame.color_space(), rgb, size)?;
    Ok(Layout {
        format,
        size,
        matrix,
        full_range,
        chroma_left,
    })
}

/// The matrix of the delivered planes; RGB and video that names none follow the size.
fn matrix_of(space: color::Space, rgb: bool, size: [u32; 2]) -> Result<Matrix, String> {
    use color::Space;
    let by_size = if (0..2).any(|k| size[k] > STANDARD_DEFINITION[k]) {
        Matrix::Bt709
    } else {
        Matrix::Bt601
    };
    match space {
        _ if rgb => Ok(by_size),
        Space::Unspecified | Space::Reserved | Space::RGB => Ok(by_size),
        // SMPTE 240M's weights (0.212, 0.087) are BT.709's but for 0.015 of blue.
        Space::BT709 | Space::SMPTE240M => Ok(Matrix::Bt709),
        // FCC's weights (0.30, 0.11) are BT.601's rounded.
        Space::BT470BG | Space::SMPTE170M | Space::FCC => Ok(Matrix::Bt601),
        Space::BT2020NCL | Space::BT2020CL => Ok(Matrix::Bt2020),
        other => Err(other.name().unwrap_or("unknown").to_owned()),
    }
}

/// Whether swscale takes the samples as red, green and blue, so that the matrix is ours to choose.
fn is_rgb(format: Pixel) -> bool {
    let mono = matches!(format, Pixel::MonoBlack | Pixel::MonoWhite);
    mono || has_palette(format) || descriptor_flags(format) & ffi::AV_PIX_FMT_FLAG_RGB as u64 != 0
}

/// Formats that swscale reads through a palette, whose matrix is fixed.
fn has_palette(format: Pixel) -> bool {
    use Pixel::{BGR4_BYTE, BGR8, PAL8, RGB4_BYTE, RGB8};
    matches!(format, PAL8 | RGB8 | BGR8 | RGB4_BYTE | BGR4_BYTE)
}

fn is_grey(format: Pixel) -> bool {
    format.descriptor().is_some_and(|d| d.nb_components() <= 2) && !is_rgb(format)
}

/// Whether the format has an alpha plane or channel: grey or colour plus one.
pub(crate) fn has_alpha(format: Pixel) -> bool {
    format
        .descriptor()
        .is_some_and(|d| matches!(d.nb_components(), 2 | 4))
}

#[allow(unsafe_code)] // The descriptor's flags have no safe call.
fn descriptor_flags(format: Pixel) -> u64 {
    // SAFETY: descriptors are static constants of libavutil.
    format
        .descriptor()
        .map_or(0, |descriptor| unsafe { (*descriptor.as_ptr()).flags })
}
