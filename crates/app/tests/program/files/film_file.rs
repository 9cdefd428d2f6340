//! How are films written as other programs write them?

use ffmpeg_next as av;

use av::codec::{self, Flags};
use av::format::Pixel;
use av::frame::Video;
use av::{Dictionary, Packet, encoder, ffi, format};
use std::path::Path;

/// A film that is written for a test.
#[derive(Clone)]
pub(super) struct Film<'a> {
    pub(super) encoder: &'a str,
    pub(super) size: [u32; 2],
    pub(super) format: Pixel,
    pub(super) frames: u32,
    /// Options of the encoder.
    pub(super) options: &'a [(&'a str, &'a str)],
    /// Frames from a key frame to the next, and frames in between that lean on later ones.
    pub(super) gop: u32,
    pub(super) b_frames: usize,
    /// Whether the upper field comes first, of interlaced film.
    pub(super) top_first: Option<bool>,
    /// Width and height of a pixel in the stream, and in the container alone.
    pub(super) aspect: [i32; 2],
    pub(super) container_aspect: [i32; 2],
    /// Ticks of a hundredth of a second that a frame lasts, by its number.
    pub(super) ticks: &'a dyn Fn(u32) -> i64,
}

impl Default for Film<'_> {
    fn default() -> Self {
        Self {
            encoder: "libx264",
            size: [64, 48],
            format: Pixel::YUV420P,
            frames: 10,
            options: &[],
            gop: 50,
            b_frames: 0,
            top_first: None,
            aspect: [0, 1],
            container_aspect: [0, 1],
            ticks: &|_| 4,
        }
    }
}

impl Film<'_> {
    /// Writes it; `code` gives the sample of frame, plane, column and row.
    #[allow(unsafe_code)] // Fields and shapes of pixels have no safe name.
    pub(super) fn write(&self, path: &str, code: impl Fn(u32, usize, u32, u32) -> u8) {
        av::init().unwrap();
        let coder = encoder::find_by_name(self.encoder).unwrap();
        let mut video = codec::Context::new_with_codec(coder)
            .encoder()
            .video()
            .unwrap();
        video.set_width(self.size[0]);
        video.set_height(self.size[1]);
        video.set_format(self.format);
        let is_mpeg2 = self.encoder == "mpeg2video";
        let base = if is_mpeg2 { (1, 25) } else { (1, 100) };
        video.set_time_base(base);
        video.set_frame_rate(Some((25, 1)));
        video.set_gop(self.gop);
        video.set_max_b_frames(self.b_frames);
        video.set_bit_rate(500_000);
        let mut flags = Flags::BITEXACT;
        if self.top_first.is_some() {
            flags |= Flags::INTERLACED_DCT | Flags::INTERLACED_ME;
        }
        let mut output = format::output(path).unwrap();
        if output
            .format()
            .flags()
            .contains(format::Flags::GLOBAL_HEADER)
        {
            flags |= Flags::GLOBAL_HEADER;
        }
        video.set_flags(flags);
        let [num, den] = self.aspect;
        // SAFETY: the context is alive, and not open yet.
        unsafe { (*video.as_mut_ptr()).sample_aspect_ratio = ffi::AVRational { num, den } };
        let options: Dictionary = self.options.iter().copied().collect();
        let mut video = video.open_as_with(coder, options).unwrap();
        let mut stream = output.add_stream_with(&video).unwrap();
        stream.set_time_base(base);
        stream.set_avg_frame_rate((25, 1));
        let [num, den] = self.container_aspect;
        // SAFETY: the stream is alive.
        unsafe { (*stream.as_mut_ptr()).sample_aspect_ratio = ffi::AVRational { num, den } };
        output.write_header().unwrap();
        let mut at = 0;
        for number in 0..self.frames {
            let mut frame = self.frame(number, &code);
            frame.set_pts(Some(at));
            at += if is_mpeg2 { 1 } else { (self.ticks)(number) };
            video.send_frame(&frame).unwrap();
            drain(&mut video, &mut output, base);
        }
        video.send_eof().unwrap();
        drain(&mut video, &mut output, base);
        output.write_trailer().unwrap();
    }

    #[allow(unsafe_code)] // The same.
    fn frame(&self, number: u32, code: &impl Fn(u32, usize, u32, u32) -> u8) -> Video {
        let mut frame = Video::new(self.format, self.size[0], self.size[1]);
        for p in 0..frame.planes() {
            let stride = frame.stride(p);
            for (at, sample) in frame.data_mut(p).iter_mut().enumerate() {
                *sample = code(number, p, (at % stride) as u32, (at / stride) as u32);
            }
        }
        if let Some(top_first) = self.top_first {
            // SAFETY: the frame is alive; the fields are plain numbers.
            unsafe {
                (*frame.as_mut_ptr()).interlaced_frame = 1;
                (*frame.as_mut_ptr()).top_field_first = i32::from(top_first);
            }
        }
        frame
    }
}

fn drain(video: &mut encoder::Video, output: &mut format::context::Output, base: (i32, i32)) {
    loop {
        let mut packet = Packet::empty();
        if video.receive_packet(&mut packet).is_err() {
            return;
        }
        if packet.duration() == 0 {
            packet.set_duration(i64::from(base.1 / 25));
        }
        let to = output.stream(0).unwrap().time_base();
        packet.rescale_ts(av::Rational(base.0, base.1), to);
        packet.set_stream(0);
        packet.write_interleaved(output).unwrap();
    }
}

/// Copies the packets of a film without the first `skipped`, and what follows them up to the next
/// key frame, as players' `-c copy` does; to any container. Their clock begins `early` ticks of a
/// hundredth of a second before 0, which MP4 turns into an edit list.
#[allow(unsafe_code)] // The tag of a codec has no safe name.
pub(super) fn trimmed(from: &str, to: &str, skipped: usize, early: i64) {
    av::init().unwrap();
    let mut input = format::input(Path::new(from)).unwrap();
    let mut output = format::output(to).unwrap();
    let stream = input.stream(0).unwrap();
    let base = stream.time_base();
    let mut copy = output.add_stream(encoder::find(codec::Id::None)).unwrap();
    copy.set_parameters(stream.parameters());
    // SAFETY: the parameters are the stream's own; another container has other tags.
    unsafe { (*(*copy.as_mut_ptr()).codecpar).codec_tag = 0 };
    copy.set_time_base(base);
    copy.set_avg_frame_rate(stream.avg_frame_rate());
    output.write_header().unwrap();
    let base_out = output.stream(0).unwrap().time_base();
    let (mut number, mut first) = (0, None);
    for (_, mut packet) in input.packets() {
        number += 1;
        if first.is_none() && number > skipped && packet.is_key() {
            let ticks = early * i64::from(base.1) / (100 * i64::from(base.0));
            first = packet.pts().map(|pts| pts + ticks);
        }
        if let Some(first) = first {
            packet.set_pts(packet.pts().map(|pts| pts - first));
            packet.set_dts(packet.dts().map(|dts| dts - first));
            packet.rescale_ts(base, base_out);
            packet.set_position(-1);
            packet.write_interleaved(&mut output).unwrap();
        }
    }
    output.write_trailer().unwrap();
}

/// The bytes of one picture as an encoder of video codes it.
pub(super) fn coded(
    encoder: &str,
    (format, size): (Pixel, [u32; 2]),
    code: impl Fn(usize, u32, u32) -> u8,
) -> Vec<u8> {
    av::init().unwrap();
    let coder = encoder::find_by_name(encoder).unwrap();
    let mut video = codec::Context::new_with_codec(coder)
        .encoder()
        .video()
        .unwrap();
    video.set_width(size[0]);
    video.set_height(size[1]);
    video.set_format(format);
    video.set_time_base((1, 25));
    video.set_color_range(av::color::Range::JPEG);
    let options: Dictionary = [("cpu-used", "8"), ("crf", "10"), ("b", "0")]
        .into_iter()
        .collect();
    let mut video = video.open_as_with(coder, options).unwrap();
    let mut frame = Video::new(format, size[0], size[1]);
    for p in 0..frame.planes() {
        let stride = frame.stride(p);
        for (at, sample) in frame.data_mut(p).iter_mut().enumerate() {
            *sample = code(p, (at % stride) as u32, (at / stride) as u32);
        }
    }
    frame.set_pts(Some(0));
    video.send_frame(&frame).unwrap();
    video.send_eof().unwrap();
    let mut bytes = Vec::new();
    let mut packet = Packet::empty();
    while video.receive_packet(&mut packet).is_ok() {
        bytes.extend_from_slice(packet.data().unwrap_or_default());
    }
    bytes
}
