//! How does a decoded frame become the picture that is delivered?

use av::format::Pixel;
use av::frame::Video;
use av::util::chroma::Location;
use av::{color, ffi};
use ffmpeg_next as av;
use foveal_core::view::picture::{Colour, Matrix, Picture};

use crate::read::convert::{Converter, Layout};
use crate::read::frame::has_alpha;
use crate::read::frame::{is_420, new_frame, picture_from_frame, rows_run_down};
use crate::read::light::Lighting;
use crate::read::orientation::Orientation;

/// Pixels of the largest picture of standard definition (PAL, with room for wide pixels). A larger
/// one without a named matrix is taken as BT.709, by its width too: panoramas are low.
const STANDARD_DEFINITION: [u32; 2] = [1279, 576];

/// Turns frames of one stream into upright pictures of one size and one colour.
pub(crate) struct FrameConversion {
    orientation: Orientation,
    is_jpeg: bool,
    colour: Colour,
    /// For frames of one layout, and whether they have alpha.
    steps: Option<(Steps, bool)>,
    /// For frames whose samples follow another curve than displays do.
    lighting: Option<Lighting>,
    /// Whether a pixel so far could be seen through.
    has_seen_through: bool,
}

/// Conversions before and after the turn.
type Steps = (Vec<Converter>, Vec<Converter>);

impl FrameConversion {
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
            lighting: None,
            has_seen_through: false,
        })
    }

    /// Has frames like the first one brought to the curve of displays, where they follow another;
    /// then what a person should know of it. `power` is what the file says besides.
    pub(crate) fn light_as(&mut self, first: &Video, power: Option<f64>) -> Option<String> {
        let (lighting, note) = Lighting::of(first, power)?;
        self.lighting = Some(lighting);
        Some(note)
    }

    /// How frames are turned.
    pub(crate) fn orientation(&self) -> Orientation {
        self.orientation
    }

    /// Whether a pixel of the frames so far could be seen through.
    pub(crate) fn has_seen_through(&self) -> bool {
        self.has_seen_through
    }

    /// The colour of every picture that comes out.
    pub(crate) fn colour(&self) -> Colour {
        self.colour
    }

    /// The frame as an upright 8-bit 4:2:0 picture.
    pub(crate) fn picture(&mut self, frame: &Video) -> Result<Picture, String> {
        let from = layout_of(frame, self.is_jpeg)?;
        match &mut self.lighting {
            None => self.picture_of(frame, from),
            Some(lighting) => {
                let lit = lighting.frame(frame, from)?;
                let from = layout_of(&lit, self.is_jpeg)?;
                self.picture_of(&lit, from)
            }
        }
    }

    fn picture_of(&mut self, frame: &Video, from: Layout) -> Result<Picture, String> {
        let as_it_is = from.full_range == self.colour.full_range
            && from.matrix == self.colour.matrix
            && self.orientation.is_upright();
        if as_it_is && is_420(from.format) && rows_run_down(frame) {
            return picture_from_frame(frame);
        }
        let reads = |steps: &Steps| steps.0.first().is_some_and(|step| step.from() == from);
        let is_clear = has_alpha(frame);
        let mut steps = match self.steps.take() {
            Some((steps, of_clear)) if reads(&steps) && of_clear == is_clear => steps,
            _ => self.build_steps(from, is_clear)?,
        };
        let mut current = run_all(&mut steps.0, frame)?;
        if current.format() == Pixel::YUVA444P {
            self.has_seen_through |= put_over_black(&mut current, self.colour.full_range);
        }
        if !self.orientation.is_upright() {
            current = turn(&current, self.orientation)?;
        }
        if !steps.1.is_empty() {
            current = run_all(&mut steps.1, &current)?;
        }
        self.steps = Some((steps, is_clear));
        picture_from_frame(&current)
    }

    /// Palettes go through RGB, whose matrix swscale lets us choose; turned and transparent
    /// pictures through 4:4:4, where chroma sits on luma, turns with it and darkens with it.
    fn build_steps(&self, from: Layout, is_clear: bool) -> Result<Steps, String> {
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
        let (rgb, full) = match is_clear {
            true => (Pixel::RGBA, Pixel::YUVA444P),
            false => (Pixel::RGB24, Pixel::YUV444P),
        };
        if has_palette(from.format) {
            let rgb = Layout {
                format: rgb,
                ..from
            };
            before.push(Converter::new(from, rgb)?);
            start = rgb;
        }
        let is_upright = self.orientation.is_upright();
        if is_upright && full == Pixel::YUV444P {
            before.push(Converter::new(start, to(Pixel::YUV420P, from.size))?);
            return Ok((before, Vec::new()));
        }
        before.push(Converter::new(start, to(full, from.size))?);
        let turned = self.orientation.turned_size(from.size);
        let full = if is_upright { full } else { Pixel::YUV444P };
        let last = Converter::new(to(full, turned), to(Pixel::YUV420P, turned))?;
        Ok((before, vec![last]))
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

/// Makes a frame of YUVA 4:4:4 what is seen of it before black; whether any of it is seen through.
fn put_over_black(frame: &mut Video, full_range: bool) -> bool {
    let [w, h] = [frame.width() as usize, frame.height() as usize];
    let black = [if full_range { 0 } else { 16 }, 128, 128];
    let stride = frame.stride(3);
    let alpha: Vec<u8> = frame.data(3).to_vec();
    let mut rows = alpha.chunks(stride).take(h);
    if rows.all(|row| row[..w].iter().all(|alpha| *alpha == 255)) {
        return false;
    }
    for (p, black) in black.into_iter().enumerate() {
        let step = frame.stride(p);
        let rows = frame.data_mut(p).chunks_mut(step).take(h);
        for (row, alpha) in rows.zip(alpha.chunks(stride)) {
            for (code, alpha) in row[..w].iter_mut().zip(alpha) {
                *code = over(*code, black, *alpha);
            }
        }
    }
    true
}

/// A code value seen through `alpha` before another, to the nearest whole one.
pub(crate) fn over(code: u8, behind: u8, alpha: u8) -> u8 {
    let [code, behind, alpha] = [code, behind, alpha].map(u32::from);
    ((code * alpha + behind * (255 - alpha) + 127) / 255) as u8
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

pub(crate) fn layout_of(frame: &Video, is_jpeg: bool) -> Result<Layout, String> {
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

#[allow(unsafe_code)] // The descriptor's flags have no safe call.
fn descriptor_flags(format: Pixel) -> u64 {
    // SAFETY: descriptors are static constants of libavutil.
    format
        .descriptor()
        .map_or(0, |descriptor| unsafe { (*descriptor.as_ptr()).flags })
}
