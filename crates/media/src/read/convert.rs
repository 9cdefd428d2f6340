//! How does a frame change its pixel format without changing its colours?

use std::ffi::CStr;

use av::ffi;
use av::format::Pixel;
use av::frame::Video;
use ffmpeg_next as av;
use foveal_core::units::counted;
use foveal_core::view::picture::Matrix;

use crate::read::frame::new_frame;

/// Chroma in the middle between two luma samples or lines, in 1/256 of a luma sample.
const CHROMA_BETWEEN: i64 = 128;
/// 1.0 in the 16.16 fixed point of swscale's contrast and saturation.
const UNCHANGED: i32 = 1 << 16;

/// What a frame's samples mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) format: Pixel,
    pub(crate) size: [u32; 2],
    pub(crate) matrix: Matrix,
    pub(crate) full_range: bool,
    pub(crate) chroma_left: bool,
}

/// A prepared conversion between two layouts.
pub(crate) struct Converter {
    context: *mut ffi::SwsContext,
    from: Layout,
    to: Layout,
}

// SAFETY: an SwsContext has no tie to the thread that made it, and `&mut self` keeps it to one
// thread at a time.
#[allow(unsafe_code)]
unsafe impl Send for Converter {}

impl Converter {
    /// Refuses formats that swscale cannot read or write, and sizes that it cannot hold.
    #[allow(unsafe_code)] // ffmpeg-next can set neither chroma positions nor colour matrices.
    pub(crate) fn new(from: Layout, to: Layout) -> Result<Self, String> {
        // SAFETY: allocates or returns null, which is checked.
        let context = unsafe { ffi::sws_alloc_context() };
        if context.is_null() {
            return Err("no memory for a conversion".to_owned());
        }
        let this = Self { context, from, to };
        let flags = ffi::SWS_BICUBIC
            | ffi::SWS_ACCURATE_RND
            | ffi::SWS_BITEXACT
            | ffi::SWS_FULL_CHR_H_INT
            | ffi::SWS_FULL_CHR_H_INP;
        let [width, height] = from.size.map(i64::from);
        let [to_width, to_height] = to.size.map(i64::from);
        this.set(c"srcw", width)?;
        this.set(c"srch", height)?;
        this.set(c"src_format", format_number(from.format))?;
        this.set(
            c"src_h_chr_pos",
            if from.chroma_left { 0 } else { CHROMA_BETWEEN },
        )?;
        this.set(c"src_v_chr_pos", CHROMA_BETWEEN)?;
        this.set(c"dstw", to_width)?;
        this.set(c"dsth", to_height)?;
        this.set(c"dst_format", format_number(to.format))?;
        this.set(
            c"dst_h_chr_pos",
            if to.chroma_left { 0 } else { CHROMA_BETWEEN },
        )?;
        this.set(c"dst_v_chr_pos", CHROMA_BETWEEN)?;
        this.set(c"sws_flags", i64::from(flags))?;
        // SAFETY: the context is alive and has its sizes and formats; the tables are static.
        unsafe {
            let status = ffi::sws_init_context(context, std::ptr::null_mut(), std::ptr::null_mut());
            if status < 0 {
                return Err(format!(
                    "no conversion {:?} to {:?}",
                    from.format, to.format
                ));
            }
            // It answers -1 where there is nothing to set (a conversion within RGB).
            ffi::sws_setColorspaceDetails(
                context,
                ffi::sws_getCoefficients(table(from.matrix)),
                i32::from(from.full_range),
                ffi::sws_getCoefficients(table(to.matrix)),
                i32::from(to.full_range),
                0,
                UNCHANGED,
                UNCHANGED,
            );
        }
        Ok(this)
    }

    /// What this conversion reads.
    pub(crate) fn from(&self) -> Layout {
        self.from
    }

    /// The frame in the other layout.
    #[allow(unsafe_code)] // `Context::run` of ffmpeg-next drops swscale's status.
    pub(crate) fn run(&mut self, input: &Video) -> Result<Video, String> {
        if input.format() != self.from.format || [input.width(), input.height()] != self.from.size {
            return Err("the frame is not of the layout that the conversion reads".to_owned());
        }
        let mut output = new_frame(self.to.format, self.to.size)?;
        // SAFETY: both frames are allocated with the formats and sizes of the context, checked
        // above; swscale reads the input's planes and writes the output's only.
        let lines = unsafe {
            let [from, to] = [input.as_ptr(), output.as_mut_ptr().cast_const()];
            ffi::sws_scale(
                self.context,
                (*from).data.as_ptr().cast(),
                (*from).linesize.as_ptr(),
                0,
                (*from).height,
                (*to).data.as_ptr(),
                (*to).linesize.as_ptr(),
            )
        };
        if i64::from(lines) != i64::from(self.to.size[1]) {
            return Err(format!(
                "the conversion wrote {lines} of {}",
                counted(self.to.size[1], "line")
            ));
        }
        Ok(output)
    }

    #[allow(unsafe_code)] // Options of swscale have no safe call.
    fn set(&self, name: &CStr, value: i64) -> Result<(), String> {
        // SAFETY: the context is alive and begins with its AVClass, as av_opt_set_int asks.
        let status = unsafe { ffi::av_opt_set_int(self.context.cast(), name.as_ptr(), value, 0) };
        if status < 0 {
            Err(format!("swscale refuses {name:?} = {value}"))
        } else {
            Ok(())
        }
    }
}

impl Drop for Converter {
    #[allow(unsafe_code)] // The context is ours to free.
    fn drop(&mut self) {
        // SAFETY: allocated in `new`, freed once.
        unsafe { ffi::sws_freeContext(self.context) }
    }
}

fn format_number(format: Pixel) -> i64 {
    i64::from(ffi::AVPixelFormat::from(format) as i32)
}

/// swscale's number of the matrix (SWS_CS_ITU601, SWS_CS_ITU709, SWS_CS_BT2020).
fn table(matrix: Matrix) -> i32 {
    match matrix {
        Matrix::Bt601 => ffi::SWS_CS_ITU601,
        Matrix::Bt709 => ffi::SWS_CS_ITU709,
        Matrix::Bt2020 => ffi::SWS_CS_BT2020,
    }
}
