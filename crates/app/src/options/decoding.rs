//! Who decodes, and on how many threads?

use crate::report::output;
use clap::{Args, ValueEnum};
use foveal_core::units::counted;
use foveal_media::tiles::decoders::{DecoderChoice, DeviceUse};
use foveal_play::Decoding;
use serde::Serialize;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum DecoderName {
    /// The graphics device for tiles of a megapixel and more, where there is one.
    Auto,
    /// The processor.
    Software,
    /// The graphics device, for up to 16 tiles at once; refused where there is none.
    Hardware,
}

/// How tiles are decoded.
#[derive(Clone, Debug, Args)]
pub(crate) struct DecodingOptions {
    /// Decoding threads (default: all cores).
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// What decodes.
    #[arg(long, value_enum, default_value = "auto")]
    decoder: DecoderName,
}

impl DecodingOptions {
    /// These options, checked.
    pub(crate) fn decoding(&self) -> anyhow::Result<Decoding> {
        Ok(Decoding {
            jobs: output::jobs(self.jobs)?,
            choice: match self.decoder {
                DecoderName::Auto => DecoderChoice::Auto,
                DecoderName::Software => DecoderChoice::Software,
                DecoderName::Hardware => DecoderChoice::Hardware,
            },
        })
    }
}

/// What a graphics device decoded.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct DeviceReport {
    /// FFmpeg's name of the device; null where the processor decoded all.
    device: Option<String>,
    /// Decoders that were opened on it.
    decoders: usize,
    /// Those of them that failed, so that the processor took over.
    failed: usize,
}

impl DeviceReport {
    pub(crate) fn new(
        DeviceUse {
            device,
            decoders,
            failed,
        }: DeviceUse,
    ) -> Self {
        Self {
            device,
            decoders,
            failed,
        }
    }

    /// A line for people; empty where the processor decoded all.
    pub(crate) fn text(&self) -> String {
        let Some(device) = &self.device else {
            return String::new();
        };
        format!(
            "{} on {device}, {} of which failed and were replaced\n",
            counted(self.decoders, "decoder"),
            self.failed
        )
    }
}
