//! What is heard from any moment of a pack on?

use crate::ffmpeg::start;
use crate::pack::pack_file::{PackFile, PackFileError};
use av::codec::Context;
use av::format::Sample;
use av::format::sample::Type;
use av::{Packet, Rational, decoder, frame};
use ffmpeg_next as av;
use foveal_core::content::video::bytes::sound::{SOUND_RATE, SoundTable};
use foveal_core::units::Seconds;
use thiserror::Error;

/// Why a pack's sound cannot be played.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SoundError {
    /// The side table cannot be read.
    #[error(transparent)]
    Pack(#[from] PackFileError),
    /// This FFmpeg decodes no Opus.
    #[error("the Opus decoder does not open: {0}; check `ffmpeg -decoders`, or play without sound")]
    Decoder(String),
}

/// Samples by which a read may miss the end of the last one and still go on from there: half a
/// millisecond.
const SLACK: i64 = SOUND_RATE as i64 / 2000;
/// Samples that are decoded ahead of a jump, unheard: Opus needs 80 ms to converge (RFC 7845,
/// section 4.6).
const PREROLL: i64 = SOUND_RATE as i64 * 80 / 1000;
/// Samples beyond which a time is no time of a track.
const FARTHEST: f64 = (1u64 << 52) as f64;

/// The sound of a pack, decoded as it is asked for. In memory as it was coded, about 16 kB a
/// second; [`Self::read`] may be called from another thread than the one that opened it.
pub struct SoundTrack {
    table: SoundTable,
    decoder: decoder::Audio,
    /// The packet that is decoded next.
    packet: usize,
    /// Decoded samples, interleaved, and the sample of the track that they begin with.
    ready: Vec<f32>,
    ready_from: i64,
    /// The sample of the track after the last one that was read.
    next: i64,
}

impl SoundTrack {
    /// The sound of a pack; `None` where it has none.
    ///
    /// # Errors
    /// The side table is damaged, or this FFmpeg has no Opus decoder.
    pub fn open(file: &PackFile) -> Result<Option<Self>, SoundError> {
        file.sound()?.map(Self::of_table).transpose()
    }

    fn of_table(table: SoundTable) -> Result<Self, SoundError> {
        let decoder = open_decoder(table.channels).map_err(SoundError::Decoder)?;
        Ok(Self {
            table,
            decoder,
            packet: 0,
            ready: Vec::new(),
            ready_from: 0,
            next: i64::MIN,
        })
    }

    /// Samples a second: 48,000.
    #[must_use]
    pub fn rate(&self) -> u32 {
        SOUND_RATE
    }

    /// Samples of one moment: 1, or 2 with the left one first.
    #[must_use]
    pub fn channels(&self) -> usize {
        usize::from(self.table.channels)
    }

    /// Length of the track from the first frame on.
    #[must_use]
    pub fn length(&self) -> Seconds {
        Seconds(self.table.samples as f64 / f64::from(SOUND_RATE))
    }

    /// Fills `out` with what is heard from `from` on, a time after the first frame is shown:
    /// interleaved, -1 to 1. Silent before 0, after the end and where a packet is damaged.
    ///
    /// A read that goes on within half a millisecond of where the last one ended continues it
    /// without a seam; any other is a jump, which decodes four packets more.
    ///
    /// # Panics
    /// When `out` holds no whole number of moments.
    pub fn read(&mut self, from: Seconds, out: &mut [f32]) {
        let channels = self.channels();
        assert!(out.len().is_multiple_of(channels), "{} samples", out.len());
        let wanted = (from.0 * f64::from(SOUND_RATE)).round();
        if wanted.is_nan() {
            out.fill(0.0);
            return;
        }
        let wanted = wanted.clamp(-FARTHEST, FARTHEST) as i64;
        if wanted.abs_diff(self.next) > SLACK as u64 {
            self.jump(wanted);
        }
        let mut rest = out;
        while !rest.is_empty() {
            let moments = self.fill(rest);
            self.next += moments as i64;
            rest = &mut rest[moments * channels..];
        }
    }

    fn jump(&mut self, to: i64) {
        self.next = to;
        let first = (to - PREROLL + i64::from(self.table.pre_skip)).max(0);
        self.packet = (first / i64::from(self.table.packet_samples)) as usize;
        self.decoder.flush();
        self.ready.clear();
    }

    /// Fills the beginning of `out` and returns how many moments.
    fn fill(&mut self, out: &mut [f32]) -> usize {
        let channels = self.channels();
        let moments = (out.len() / channels) as i64;
        let (next, end) = (self.next, self.table.samples as i64);
        if next < 0 || next >= end {
            let silent = if next < 0 {
                moments.min(-next)
            } else {
                moments
            };
            out[..silent as usize * channels].fill(0.0);
            return silent as usize;
        }
        while !self.is_ready() {
            self.decode();
        }
        let skip = (next - self.ready_from) as usize;
        let there = self.ready.len() / channels - skip;
        let count = there.min(moments.min(end - next) as usize);
        let from = &self.ready[skip * channels..][..count * channels];
        out[..count * channels].copy_from_slice(from);
        count
    }

    fn is_ready(&self) -> bool {
        let until = self.ready_from + (self.ready.len() / self.channels()) as i64;
        (self.ready_from..until).contains(&self.next)
    }

    /// Decodes one packet into `ready`; what it lacks is silence.
    fn decode(&mut self) {
        let span = self.table.samples_of(self.packet);
        let (packet, channels) = (self.packet, self.channels());
        self.packet += 1;
        let length = self.table.packet_samples as usize * channels;
        self.ready.clear();
        self.ready.resize(length, 0.0);
        self.ready_from = span.start;
        let Some(bytes) = self.table.packet(packet) else {
            // Beyond the last packet: the table's check leaves no sample there.
            self.ready_from = self.next;
            return;
        };
        let mut coded = Packet::copy(bytes);
        coded.set_pts(Some(span.start));
        let mut decoded = frame::Audio::empty();
        let sent = self.decoder.send_packet(&coded);
        while sent.is_ok() && self.decoder.receive_frame(&mut decoded).is_ok() {
            // A decoder may leave samples out at its start, and says so by the time stamp.
            let late =
                (decoded.pts().unwrap_or(span.start) - span.start).max(0) as usize * channels;
            let samples = interleaved(&decoded, channels);
            let room = self.ready.iter_mut().skip(late);
            room.zip(samples).for_each(|(to, from)| *to = from);
        }
    }
}

/// The samples of a frame; none where it is of a kind that no Opus decoder gives.
fn interleaved(frame: &frame::Audio, channels: usize) -> Vec<f32> {
    let count = frame.samples() * channels;
    if usize::from(frame.channels()) != channels {
        return Vec::new();
    }
    let float = |bytes: &[u8]| f32::from_ne_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    match frame.format() {
        Sample::F32(Type::Planar) => {
            let planes = (0..channels).map(|c| frame.plane::<f32>(c));
            let planes: Vec<&[f32]> = planes.collect();
            (0..count)
                .map(|at| planes[at % channels][at / channels])
                .collect()
        }
        Sample::F32(Type::Packed) => frame
            .data(0)
            .chunks_exact(4)
            .take(count)
            .map(float)
            .collect(),
        Sample::I16(Type::Packed) => {
            let value = |bytes: &[u8]| f32::from(i16::from_ne_bytes([bytes[0], bytes[1]]));
            let samples = frame.data(0).chunks_exact(2).take(count);
            samples.map(|bytes| value(bytes) / 32768.0).collect()
        }
        _ => Vec::new(),
    }
}

#[allow(unsafe_code)] // ffmpeg-next has no way to say what raw packets hold.
fn open_decoder(channels: u8) -> Result<decoder::Audio, String> {
    start();
    let codec = decoder::find_by_name("opus")
        .or_else(|| decoder::find(av::codec::Id::OPUS))
        .ok_or("there is none")?;
    let mut context = Context::new_with_codec(codec);
    // SAFETY: the context was just allocated for this codec and is not open yet; its decoder reads
    // both fields when it opens, and the layout owns nothing before or after.
    unsafe {
        let raw = context.as_mut_ptr();
        (*raw).sample_rate = SOUND_RATE as i32;
        av::ffi::av_channel_layout_default(&raw mut (*raw).ch_layout, i32::from(channels));
    }
    let mut decoder = context.decoder();
    decoder.set_packet_time_base(Rational(1, SOUND_RATE as i32));
    let opened = decoder.open_as(codec).map_err(|e| e.to_string())?;
    opened.audio().map_err(|e| e.to_string())
}
