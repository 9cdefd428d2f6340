//! How does the sound of a video become the side table `sound`?

use crate::ffmpeg::{start, wants_more};
use crate::read::input::VideoInput;
use crate::read::options::ReadOptions;
use crate::read::sound_reader::SoundReader;
use av::format::{Sample, sample};
use av::{ChannelLayout, Packet, encoder, frame};
use ffmpeg_next as av;
use foveal_core::content::video::bytes::sound::{SOUND_RATE, SoundTable};
use foveal_core::units::counted;
use std::path::Path;

/// Bits a second and channel: transparent to most people.
const BIT_RATE: usize = 64_000;

/// What became of the sound.
#[derive(Default)]
pub(super) struct SoundFound {
    /// As it is coded; none where there is none, or none of it can be read.
    pub(super) table: Option<SoundTable>,
    /// What a person should know of it.
    pub(super) notes: Vec<String>,
    /// Packets that could not be read.
    pub(super) damaged: u64,
}

/// The sound of `input`, which is read like this, from its first frame on, for `seconds`. Sound
/// that is missing or broken is noted, never an error; what is lost is silent.
pub(super) fn sound_of(input: &Path, seconds: f64, reading: ReadOptions) -> SoundFound {
    let mut heard = SoundFound::default();
    match coded((input, reading), seconds, &mut heard) {
        Ok(table) => heard.table = table,
        Err(why) => heard.notes.push(format!("its sound is left out: {why}")),
    }
    heard
}

fn coded(
    (input, reading): (&Path, ReadOptions),
    seconds: f64,
    said: &mut SoundFound,
) -> Result<Option<SoundTable>, String> {
    let video = VideoInput::open_with(input, reading).map_err(|e| e.to_string())?;
    let origin_ns = video.first_stamp_ns();
    drop(video);
    let Some(mut reader) = SoundReader::open(input, origin_ns)? else {
        return Ok(None);
    };
    let mut coder = OpusCoder::open(reader.channels())?;
    let mut left = (seconds * f64::from(SOUND_RATE)).round() as usize * reader.channels();
    let mut heard = false;
    while left > 0 {
        let samples = match reader.next() {
            Ok(Some(samples)) => samples,
            Ok(None) => break,
            Err(why) => {
                said.damaged += 1;
                said.notes.push(format!(
                    "its sound breaks off and is silent from there on: {why}"
                ));
                break;
            }
        };
        let count = samples.len().min(left);
        heard |= count > 0;
        coder.push(&samples[..count])?;
        left -= count;
    }
    if reader.damaged > 0 {
        let damaged = reader.damaged;
        said.damaged += u64::from(damaged);
        said.notes.push(format!(
            "its sound is damaged and silent in {}",
            counted(damaged, "packet")
        ));
    }
    if !heard {
        return Err("none of it can be decoded".to_owned());
    }
    coder.finish().map(Some)
}

/// Codes samples as Opus packets.
struct OpusCoder {
    encoder: encoder::audio::Encoder,
    layout: ChannelLayout,
    channels: usize,
    /// Samples that do not fill a packet yet.
    waiting: Vec<f32>,
    moments: u64,
    sent: i64,
    table: SoundTable,
}

impl OpusCoder {
    #[allow(unsafe_code)] // ffmpeg-next does not say how much silence an encoder puts first.
    fn open(channels: usize) -> Result<Self, String> {
        start();
        let codec = encoder::find_by_name("libopus")
            .ok_or("this FFmpeg has no encoder libopus, see `ffmpeg -encoders`")?;
        let context = av::codec::Context::new_with_codec(codec);
        let mut audio = context.encoder().audio().map_err(|e| e.to_string())?;
        let layout = ChannelLayout::default(channels as i32);
        audio.set_rate(SOUND_RATE as i32);
        audio.set_format(Sample::F32(sample::Type::Packed));
        audio.set_channel_layout(layout);
        audio.set_bit_rate(BIT_RATE * channels);
        audio.set_time_base(av::Rational(1, SOUND_RATE as i32));
        let encoder = audio.open_as(codec).map_err(|e| e.to_string())?;
        // SAFETY: the context is open and alive; the field is a plain number.
        let pre_skip = unsafe { (*encoder.as_ptr()).initial_padding };
        let pre_skip = u16::try_from(pre_skip).map_err(|_| format!("a lead of {pre_skip}"))?;
        let table = SoundTable::new(channels as u8, pre_skip, encoder.frame_size());
        Ok(Self {
            encoder,
            layout,
            channels,
            waiting: Vec::new(),
            moments: 0,
            sent: 0,
            table,
        })
    }

    fn push(&mut self, samples: &[f32]) -> Result<(), String> {
        self.moments += (samples.len() / self.channels) as u64;
        self.waiting.extend_from_slice(samples);
        let whole = self.table.packet_samples as usize * self.channels;
        let count = self.waiting.len() / whole * whole;
        let ready: Vec<f32> = self.waiting.drain(..count).collect();
        ready
            .chunks_exact(whole)
            .try_for_each(|packet| self.send(packet))
    }

    fn send(&mut self, samples: &[f32]) -> Result<(), String> {
        let count = self.table.packet_samples as usize;
        let format = Sample::F32(sample::Type::Packed);
        let mut frame = frame::Audio::new(format, count, self.layout);
        frame.set_rate(SOUND_RATE);
        frame.set_pts(Some(self.sent));
        self.sent += count as i64;
        let bytes = samples.iter().flat_map(|sample| sample.to_ne_bytes());
        frame
            .data_mut(0)
            .iter_mut()
            .zip(bytes)
            .for_each(|(to, from)| *to = from);
        self.encoder.send_frame(&frame).map_err(|e| e.to_string())?;
        self.receive()
    }

    fn receive(&mut self) -> Result<(), String> {
        loop {
            let mut packet = Packet::empty();
            match self.encoder.receive_packet(&mut packet) {
                Ok(()) => {
                    let bytes = packet.data().filter(|bytes| !bytes.is_empty());
                    self.table
                        .push(bytes.ok_or("the encoder gave a packet of no bytes")?);
                }
                Err(av::Error::Eof) => return Ok(()),
                Err(e) if wants_more(e) => return Ok(()),
                Err(e) => return Err(e.to_string()),
            }
        }
    }

    /// Codes the rest, and silence until the last sample has come out of the coder.
    fn finish(mut self) -> Result<SoundTable, String> {
        let samples = self.moments;
        let needed = samples + u64::from(self.table.pre_skip);
        let whole = u64::from(self.table.packet_samples);
        let silent = needed.next_multiple_of(whole) - samples;
        self.push(&vec![0.0; silent as usize * self.channels])?;
        self.encoder.send_eof().map_err(|e| e.to_string())?;
        self.receive()?;
        self.table.samples = samples;
        Ok(self.table)
    }
}
