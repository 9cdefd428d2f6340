//! Which codec are tiles coded with, and how fine or of how many bits?

use crate::options::link::parse_rate;
use crate::report::output::{WrongUsage, out_of_range};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_media::prepare::Quality;

/// Bits per second that a tile may be coded for.
const BIT_RATES: std::ops::RangeInclusive<f64> = 1e3..=2e9;

#[derive(Clone, Debug, Args)]
pub(crate) struct CodecOptions {
    /// Codec of the tiles.
    #[arg(long, default_value = "vp9", value_parser = codec_names())]
    pub(crate) codec: Codec,
    /// auto (the default), one for all levels, or one a level from the finest on, as 22,24,26,28.
    /// Quantisers, lower is finer: vp9, vp8, av1 0-63, h264, hevc 0-51, jpeg 1-31; for jpeg also
    /// q1-q100, the quality of other programs. png is lossless.
    ///
    /// auto looks for the coarsest quantisers of a video in vp9 that the eye hardly sees, finer
    /// where it is dark and flat. Of other video it takes vp8 16, av1 28, h264 26, hevc 27, jpeg 3;
    /// of a picture, which is looked at for long: vp9 4, vp8 0, av1 3, h264 15, hevc 16, jpeg 1.
    #[arg(long, value_name = "Q[,Q..]", conflicts_with = "bitrate")]
    quality: Option<String>,
    /// The finest quantiser at which no group of a tile takes more, as 10mbit or one a level as
    /// 4mbit,2mbit,1mbit,500kbit,200kbit; not for jpeg and png. Takes about five times as long.
    #[arg(long, value_name = "R[,R..]")]
    bitrate: Option<String>,
}

fn codec_names() -> impl TypedValueParser<Value = Codec> {
    PossibleValuesParser::new(Codec::ALL.map(Codec::name)).map(|name| {
        let named = Codec::ALL.into_iter().find(|codec| codec.name() == name);
        named.unwrap_or(Codec::Vp9)
    })
}

impl CodecOptions {
    /// What was asked for.
    pub(crate) fn quality(&self) -> Result<Quality, WrongUsage> {
        match (&self.quality, &self.bitrate) {
            (Some(text), _) if text.trim() == "auto" => Ok(Quality::Auto),
            (Some(text), _) => self.qualities(text),
            (None, Some(text)) => self.bit_rates(text),
            (None, None) => Ok(Quality::Auto),
        }
    }

    fn qualities(&self, text: &str) -> Result<Quality, WrongUsage> {
        if self.codec == Codec::Png {
            return Err(WrongUsage(
                "--quality: png is lossless and has none; leave it out, or give another --codec"
                    .to_owned(),
            ));
        }
        let ijg: Option<Vec<&str>> = text
            .split(',')
            .map(|q| q.trim().strip_prefix('q'))
            .collect();
        match ijg {
            Some(all) if self.codec == Codec::Jpeg => {
                let read = |q: &&str| q.parse().ok().filter(|q| (1..=100).contains(q));
                let all: Option<Vec<u8>> = all.iter().map(read).collect();
                all.map(Quality::Ijg)
                    .ok_or_else(|| out_of_range("--quality", format!("{text:?}"), "q1 to q100"))
            }
            _ => {
                let least = u8::from(self.codec == Codec::Jpeg);
                let range = least..=self.codec.highest_quantiser();
                let read = |q: &str| q.trim().parse().ok().filter(|q| range.contains(q));
                let all: Option<Vec<u8>> = text.split(',').map(read).collect();
                let named = format!("{least} to {} for {}", range.end(), self.codec.name());
                all.map(Quality::Quantiser)
                    .ok_or_else(|| out_of_range("--quality", format!("{text:?}"), &named))
            }
        }
    }

    fn bit_rates(&self, text: &str) -> Result<Quality, WrongUsage> {
        if self.codec.is_intra() {
            return Err(WrongUsage(format!(
                "--bitrate: {} has none; give --quality, or another --codec",
                self.codec.name()
            )));
        }
        let read = |rate: &str| parse_rate(rate.trim()).filter(|rate| BIT_RATES.contains(rate));
        let all: Option<Vec<f64>> = text.split(',').map(read).collect();
        let all = all.ok_or_else(|| {
            out_of_range(
                "--bitrate",
                text,
                "rates of 1kbit to 2gbit, as 10mbit,5mbit",
            )
        })?;
        Ok(Quality::BitRate(
            all.into_iter().map(|rate| rate as u32).collect(),
        ))
    }
}
