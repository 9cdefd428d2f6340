//! Which samples does a file's sound hold, in step with its pictures?

use std::path::Path;

use av::format::context::Input;
use av::format::{Sample, sample};
use av::software::resampling;
use av::{ChannelLayout, Packet, decoder, frame, media};
use ffmpeg_next as av;
use foveal_core::content::video::bytes::sound::SOUND_RATE;

use crate::ffmpeg::{path_for_ffmpeg, start, wants_more};
use crate::read::film::corrected::file::CorrectedFile;
use crate::read::film::ends::joints::Joints;
use crate::read::film::opening::{open_input, read_packet};

/// What comes out: floating point, interleaved.
const OUT: Sample = Sample::F32(sample::Type::Packed);
/// Time stamps are followed where they leave the samples counted so far by more than this: 5 ms.
const JITTER: i64 = SOUND_RATE as i64 / 200;
/// Moments of silence that are handed out at once.
const SILENCE: i64 = SOUND_RATE as i64;
/// Room for what a resampler held back, in moments.
const HELD_BACK: usize = 4096;

/// What a resampler was made for.
#[derive(Clone, Copy, PartialEq)]
struct Kind {
    format: Sample,
    rate: u32,
    channels: i32,
}

/// The best sound stream of a file, at 48 kHz with one or two channels. Sample 0 is heard when the
/// first picture is shown: what comes earlier is left out, what comes later begins with silence.
pub(crate) struct SoundReader {
    input: Input,
    /// Read by the input, which is gone before it.
    _corrected: Option<CorrectedFile>,
    stream: usize,
    decoder: decoder::Audio,
    tick: av::Rational,
    joints: Joints,
    /// Stamp of the first picture in nanoseconds.
    origin_ns: i64,
    layout: ChannelLayout,
    resampler: Option<(Kind, resampling::Context)>,
    /// Where the samples taken in so far end, in moments at 48 kHz; none before the first.
    taken_until: Option<f64>,
    /// Moments to leave out, and moments of silence to hand out first.
    skip: i64,
    silence: i64,
    /// Samples that follow the silence.
    waiting: Vec<f32>,
    is_at_end: bool,
    /// Packets that did not decode.
    pub(crate) damaged: u32,
}

impl SoundReader {
    /// Opens the sound of a file; `None` where it has none. The error says why it cannot be read.
    pub(crate) fn open(path: &Path, origin_ns: i64) -> Result<Option<Self>, String> {
        start();
        let file = open_input(&path_for_ffmpeg(path)?, None)?;
        let input = file.input;
        let Some(stream) = input.streams().best(media::Type::Audio) else {
            return Ok(None);
        };
        let (index, tick) = (stream.index(), stream.time_base());
        let context = av::codec::Context::from_parameters(stream.parameters());
        let mut decoder = context.map_err(|e| e.to_string())?.decoder();
        decoder.set_packet_time_base(tick);
        let decoder = decoder.audio().map_err(|e| e.to_string())?;
        let channels = if decoder.channels() == 1 { 1 } else { 2 };
        let joints = Joints::of(input.format().name(), tick);
        Ok(Some(Self {
            input,
            _corrected: file.corrected,
            stream: index,
            decoder,
            tick,
            joints,
            origin_ns,
            layout: ChannelLayout::default(channels),
            resampler: None,
            taken_until: None,
            skip: 0,
            silence: 0,
            waiting: Vec::new(),
            is_at_end: false,
            damaged: 0,
        }))
    }

    /// 1 or 2.
    pub(crate) fn channels(&self) -> usize {
        self.layout.channels() as usize
    }

    /// The samples that follow, interleaved, perhaps none yet; `None` after the last.
    pub(crate) fn next(&mut self) -> Result<Option<Vec<f32>>, String> {
        if self.silence > 0 {
            let moments = self.silence.min(SILENCE);
            self.silence -= moments;
            return Ok(Some(vec![0.0; moments as usize * self.channels()]));
        }
        if !self.waiting.is_empty() {
            return Ok(Some(std::mem::take(&mut self.waiting)));
        }
        let mut decoded = frame::Audio::empty();
        match self.decoder.receive_frame(&mut decoded) {
            Ok(()) => self.take(decoded).map(Some),
            Err(av::Error::Eof) if self.resampler.is_some() => {
                let last = self.drain()?;
                Ok(Some(self.after_skip(last)))
            }
            Err(av::Error::Eof) => Ok(None),
            Err(e) if wants_more(e) => self.feed().map(|()| Some(Vec::new())),
            Err(_) => {
                self.damaged += 1;
                Ok(Some(Vec::new()))
            }
        }
    }

    fn feed(&mut self) -> Result<(), String> {
        loop {
            let mut packet = Packet::empty();
            match read_packet(&mut packet, &mut self.input) {
                Ok(true) if packet.stream() != self.stream || packet.size() == 0 => {}
                Ok(true) => {
                    self.joints.follow(&mut packet);
                    self.damaged += u32::from(self.decoder.send_packet(&packet).is_err());
                    return Ok(());
                }
                // How the file ends is reported by the reader of its pictures.
                Ok(false) | Err(_) if !self.is_at_end => {
                    self.is_at_end = true;
                    return self.decoder.send_eof().map_err(|e| e.to_string());
                }
                Ok(false) => return Err(av::Error::Eof.to_string()),
                Err(why) => return Err(why),
            }
        }
    }

    /// A decoded frame at 48 kHz, where its time stamp puts it.
    fn take(&mut self, mut decoded: frame::Audio) -> Result<Vec<f32>, String> {
        let (rate, channels) = (decoded.rate(), i32::from(decoded.channels()));
        if rate == 0 || channels == 0 || decoded.samples() == 0 {
            return Ok(Vec::new());
        }
        // Layouts without positions cannot be mixed down; the usual ones for so many channels can.
        set_usual_layout(&mut decoded, channels);
        let kind = Kind {
            format: decoded.format(),
            rate,
            channels,
        };
        let mut out = Vec::new();
        let stamp = decoded.timestamp().map(|ticks| self.moment_of(ticks));
        let missing = match (stamp, self.taken_until) {
            (Some(stamp), Some(until)) => stamp - until.round() as i64,
            (Some(stamp), None) => stamp,
            (None, _) => 0,
        };
        let is_first = self.taken_until.is_none();
        let is_apart = is_first || missing.abs() > JITTER;
        if is_apart
            || self
                .resampler
                .as_ref()
                .is_none_or(|(made_for, _)| *made_for != kind)
        {
            let held = self.drain()?;
            out = self.after_skip(held);
        }
        if is_apart {
            self.skip += (-missing).max(0);
        }
        let begin = if is_apart {
            stamp.unwrap_or(0) as f64
        } else {
            self.taken_until.unwrap_or(0.0)
        };
        let length = decoded.samples() as f64 * f64::from(SOUND_RATE) / f64::from(rate);
        self.taken_until = Some(begin + length);
        let resampled = self.resample(kind, &decoded, length)?;
        if is_apart && missing > 0 {
            // Silence may be long: it is handed out piece by piece, before what follows it.
            (self.silence, self.waiting) = (missing, resampled);
            return Ok(out);
        }
        out.extend(self.after_skip(resampled));
        Ok(out)
    }

    fn moment_of(&self, ticks: i64) -> i64 {
        let [num, den] = [self.tick.0.max(1), self.tick.1.max(1)].map(i128::from);
        let ns = (i128::from(ticks) * num * 1_000_000_000).div_euclid(den);
        let moment = (ns - i128::from(self.origin_ns)) * i128::from(SOUND_RATE);
        let rounded = (moment + 500_000_000).div_euclid(1_000_000_000);
        rounded.clamp(-(1 << 52), 1 << 52) as i64
    }

    fn resample(
        &mut self,
        kind: Kind,
        decoded: &frame::Audio,
        length: f64,
    ) -> Result<Vec<f32>, String> {
        let layout = ChannelLayout::default(kind.channels);
        let fresh = || {
            resampling::Context::get(kind.format, layout, kind.rate, OUT, self.layout, SOUND_RATE)
        };
        let (_, resampler) = match &mut self.resampler {
            Some(made) => made,
            none => none.insert((kind, fresh().map_err(|e| e.to_string())?)),
        };
        let room = length.ceil() as usize + HELD_BACK;
        let mut out = frame::Audio::new(OUT, room, self.layout);
        resampler
            .run(decoded, &mut out)
            .map_err(|e| e.to_string())?;
        Ok(samples_of(&out, self.layout.channels() as usize))
    }

    /// What the resampler still holds; it is gone afterwards.
    fn drain(&mut self) -> Result<Vec<f32>, String> {
        let Some((_, mut resampler)) = self.resampler.take() else {
            return Ok(Vec::new());
        };
        let mut out = frame::Audio::new(OUT, HELD_BACK, self.layout);
        resampler.flush(&mut out).map_err(|e| e.to_string())?;
        Ok(samples_of(&out, self.channels()))
    }

    /// These samples without those that are to be left out.
    fn after_skip(&mut self, samples: Vec<f32>) -> Vec<f32> {
        let channels = self.channels();
        let skipped = self.skip.min((samples.len() / channels) as i64);
        self.skip -= skipped;
        samples[skipped as usize * channels..].to_vec()
    }
}

#[allow(unsafe_code)] // ffmpeg-next sets a field that older versions of FFmpeg read instead.
fn set_usual_layout(frame: &mut frame::Audio, channels: i32) {
    frame.set_channel_layout(ChannelLayout::default(channels));
    // SAFETY: the frame is alive and ours alone; uninit frees what the old layout owns, if it does.
    unsafe {
        let layout = &raw mut (*frame.as_mut_ptr()).ch_layout;
        av::ffi::av_channel_layout_uninit(layout);
        av::ffi::av_channel_layout_default(layout, channels);
    }
}

fn samples_of(frame: &frame::Audio, channels: usize) -> Vec<f32> {
    let bytes = frame
        .data(0)
        .chunks_exact(4)
        .take(frame.samples() * channels);
    bytes
        .map(|b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]))
        .collect()
}
