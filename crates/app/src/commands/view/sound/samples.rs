//! Which samples does a sound track have at a time?
//!
//! The one place that knows where sound comes from.

use foveal_core::units::Seconds;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::tiles::sound::SoundTrack;

/// Reads interleaved samples, all channels of a frame together, from a time on; what lies beyond
/// the end stays as it is.
type Read = Box<dyn FnMut(Seconds, &mut [f32]) + Send>;

/// Sound that can be read from any time.
pub(crate) struct Samples {
    rate: u32,
    channels: u16,
    /// Channels that are handed out.
    mixed: u16,
    read: Read,
    own: Vec<f32>,
}

impl Samples {
    /// The sound of a pack; `None` where it has none.
    pub(crate) fn of_pack(file: &PackFile) -> anyhow::Result<Option<Self>> {
        let track = SoundTrack::open(file)?;
        Ok(track.map(|mut track| {
            let (rate, channels) = (track.rate(), track.channels() as u16);
            Self::new(
                rate,
                channels,
                Box::new(move |from: Seconds, out: &mut [f32]| track.read(from, out)),
            )
        }))
    }

    fn new(rate: u32, channels: u16, read: Read) -> Self {
        Self {
            rate,
            channels,
            mixed: channels,
            read,
            own: Vec::new(),
        }
    }

    /// Frames a second.
    pub(crate) fn rate(&self) -> u32 {
        self.rate
    }

    /// From now on hands out this many channels: more repeat the last, one is the mean of all.
    pub(crate) fn mix_to(&mut self, channels: u16) {
        self.mixed = channels.max(1);
    }

    /// Samples at `rate` from a time of the content on, whose rounds of length `round` all begin
    /// with the sound's beginning.
    pub(crate) fn fill(&mut self, from: Seconds, round: Seconds, rate: u32, out: &mut [f32]) {
        let mixed = usize::from(self.mixed);
        let mut time = from.0;
        let mut rest = out;
        while rest.len() >= mixed {
            let within = time.rem_euclid(round.0);
            // Half a sample before the end of a round belongs to the next.
            let left = ((round.0 - within) * f64::from(rate)).round().max(1.0) as usize;
            let frames = (rest.len() / mixed).min(left);
            let (now, later) = rest.split_at_mut(frames * mixed);
            self.fill_within(Seconds(within), rate, now);
            time += frames as f64 / f64::from(rate);
            rest = later;
        }
    }

    fn fill_within(&mut self, from: Seconds, rate: u32, out: &mut [f32]) {
        let (channels, mixed) = (usize::from(self.channels), usize::from(self.mixed));
        let step = f64::from(self.rate) / f64::from(rate);
        let begin = from.0 * f64::from(self.rate);
        let first = if rate == self.rate {
            begin.round()
        } else {
            begin.floor()
        };
        let frames = out.len() / mixed;
        let needed = (begin - first + frames as f64 * step).ceil() as usize + 2;
        self.own.clear();
        self.own.resize(needed * channels, 0.0);
        (self.read)(Seconds(first / f64::from(self.rate)), &mut self.own);
        for (k, frame) in out.chunks_exact_mut(mixed).enumerate() {
            let place = (begin - first).max(0.0) + k as f64 * step;
            let (at, share) = (place.floor() as usize, place.fract() as f32);
            let share = if rate == self.rate { 0.0 } else { share };
            let sample = |channel: usize| {
                let [a, b] = [at, at + 1].map(|at| self.own[at * channels + channel]);
                a + (b - a) * share
            };
            let mean = || (0..channels).map(sample).sum::<f32>() / channels as f32;
            for (channel, out) in frame.iter_mut().enumerate() {
                *out = match mixed {
                    1 => mean(),
                    _ => sample(channel.min(channels - 1)),
                };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two channels at 1000 Hz: the number of the frame, and its negative.
    fn counting(frames: usize) -> Samples {
        let read = move |from: Seconds, out: &mut [f32]| {
            let first = (from.0 * 1000.0).round() as usize;
            for (k, frame) in out.chunks_exact_mut(2).enumerate() {
                if first + k < frames {
                    frame.copy_from_slice(&[(first + k) as f32, -((first + k) as f32)]);
                }
            }
        };
        Samples::new(1000, 2, Box::new(read))
    }

    fn filled(samples: &mut Samples, from: f64, round: f64, rate: u32, len: usize) -> Vec<f32> {
        let mut out = vec![9.0; len];
        samples.fill(Seconds(from), Seconds(round), rate, &mut out);
        out
    }

    #[test]
    fn chunks_join_without_a_gap_and_rounds_begin_anew() {
        let mut samples = counting(100);
        samples.mix_to(2);
        let mut heard = Vec::new();
        for chunk in 0..30 {
            let from = f64::from(chunk) * 0.007;
            heard.extend(filled(&mut samples, from, 0.1, 1000, 14));
        }
        for (k, frame) in heard.chunks_exact(2).enumerate() {
            assert_eq!(frame, [(k % 100) as f32, -((k % 100) as f32)], "{k}");
        }
    }

    #[test]
    fn beyond_its_end_a_track_is_silent() {
        let mut samples = counting(5);
        let heard = filled(&mut samples, 0.003, 1.0, 1000, 8);
        assert_eq!(heard, [3.0, -3.0, 4.0, -4.0, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn another_rate_and_other_channels_keep_the_time() {
        let mut samples = counting(1000);
        samples.mix_to(3);
        let heard = filled(&mut samples, 0.1, 1.0, 4000, 12);
        for (k, frame) in heard.chunks_exact(3).enumerate() {
            let expected = 100.0 + k as f32 * 0.25;
            assert!((frame[0] - expected).abs() < 1e-3, "{k}: {frame:?}");
            assert_eq!(frame[1], frame[2]);
        }
        samples.mix_to(1);
        assert!(
            filled(&mut samples, 0.1, 1.0, 1000, 4)
                .iter()
                .all(|s| *s == 0.0)
        );
    }
}
