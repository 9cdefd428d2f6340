//! What did the benchmark of video find?

use crate::commands::demo::machine::Machine;
use crate::options::decoding::DeviceReport;
use crate::run::timed::{Parts, Run};
use foveal_core::units::counted;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Frames a second: the median of all turns, the slowest and the fastest.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Rate {
    pub(super) median: f64,
    range: [f64; 2],
}

#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub(super) machine: Machine,
    pub(super) pack: String,
    pub(super) size_px: [u32; 2],
    pub(super) frames: u32,
    pub(super) turns: u32,
    pub(super) jobs: usize,
    /// The foveated frames; of several policies of the first.
    #[serde(flatten)]
    pub(super) first: Foveated,
    /// Choosing and decoding, frames a second.
    pub(super) viewport_fps: f64,
    pub(super) full_fps: f64,
    pub(super) coarsest_fps: f64,
    pub(super) original_fps: Option<f64>,
    /// `foveated_fps` over that.
    pub(super) ratio_original: Option<f64>,
    pub(super) viewport: Rates,
    pub(super) full: Rates,
    pub(super) coarsest: Rates,
    /// The foveated frames under every policy that was played.
    pub(super) policies: BTreeMap<&'static str, Foveated>,
    /// As versions chose that knew no score: acuity at a slope of 0.022, in the same run.
    pub(super) before: Before,
    /// The rule of a published system, in the same run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) published: Option<PublishedReport>,
    /// The foveated frames, decoded on other numbers of threads.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) workers: Vec<WorkersReport>,
}

/// What foveated frames reached.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Foveated {
    pub(super) policy: &'static str,
    pub(super) target: Option<f64>,
    pub(super) slope: Option<f64>,
    /// Of the first frames against every finest tile, in JOD; null where nothing draws.
    pub(super) score: Option<f64>,
    /// Where they were decoded.
    pub(super) decoded_on: DeviceReport,
    /// Choosing and decoding, frames a second.
    pub(super) foveated_fps: f64,
    /// `foveated_fps` over the others.
    pub(super) ratio: f64,
    pub(super) ratio_viewport: f64,
    pub(super) foveated: Rates,
    pub(super) parts: Parts,
    /// Pictures of tiles, those to catch up included.
    pub(super) decodes_per_frame: f64,
    /// Frames whose time was over before they could be shown.
    pub(super) late_frames: u32,
    /// Frames shown with a coarser tile in the place of one that was chosen.
    pub(super) incomplete_frames: u32,
    pub(super) frames_to_fovea_p95: u32,
    pub(super) pixels_share_mean: f64,
    pub(super) gpu_bytes: u64,
    /// Of the whole finest level as 8-bit 4:2:0.
    pub(super) gpu_share: f64,
}

/// What decoding takes on so many threads.
#[derive(Debug, Serialize)]
pub(super) struct WorkersReport {
    pub(super) workers: usize,
    pub(super) decode_ms_mean: Option<f64>,
    /// Choosing and decoding.
    pub(super) foveated_fps: f64,
}

/// Figures of another setting next to the foveated ones.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Before {
    pub(super) slope: f64,
    pub(super) foveated_fps: f64,
    pub(super) ratio: f64,
    pub(super) pixels_share_mean: f64,
    pub(super) gpu_bytes: u64,
    pub(super) score: Option<f64>,
}

/// Figures of the rule of a published system.
#[derive(Debug, Serialize)]
pub(super) struct PublishedReport {
    pub(super) name: &'static str,
    /// The pack that it played.
    pub(super) pack: String,
    pub(super) policy: &'static str,
    /// Of its first frames against every finest tile of its pack, in JOD.
    pub(super) score: Option<f64>,
    #[serde(flatten)]
    pub(super) rates: Rates,
    /// Of its pack.
    pub(super) full: Rates,
    pub(super) coarsest: Rates,
    /// Its frames decoded in a second over those of `full` of its pack, and ours over it.
    pub(super) ratio: f64,
    pub(super) foveated_over_it: f64,
    pub(super) late_frames: u32,
    pub(super) incomplete_frames: u32,
    pub(super) frames_to_fovea_p95: u32,
    pub(super) pixels_share_mean: f64,
    pub(super) gpu_bytes: u64,
    pub(super) gpu_share: f64,
}

/// What one policy reached.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Rates {
    decode_fps: Rate,
    /// Choosing, decoding, uploading and drawing.
    end_to_end_fps: Rate,
    /// Choosing alone, the median of all frames.
    choose_ms: f64,
}

/// Reports are passed on, folders are nobody's business.
pub(super) fn name_of(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

impl Rate {
    pub(super) fn of(rates: &[f64]) -> Self {
        let mut sorted = rates.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |place: usize| sorted.get(place).copied().unwrap_or_default();
        Self {
            median: at(sorted.len() / 2),
            range: [at(0), at(sorted.len().saturating_sub(1))],
        }
    }

    fn text(self) -> String {
        let [slowest, fastest] = self.range;
        format!("{:.1} ({slowest:.1} to {fastest:.1})", self.median)
    }
}

impl Rates {
    pub(super) fn of(run: &Run) -> Self {
        Self {
            decode_fps: Rate::of(&run.decoding),
            end_to_end_fps: Rate::of(&run.end_to_end),
            choose_ms: {
                let ms = run.frames.iter().map(|it| it.choose.as_secs_f64() * 1e3);
                Rate::of(&ms.collect::<Vec<f64>>()).median
            },
        }
    }

    fn line(self, name: &str) -> String {
        format!(
            "{name}: {} frames/s decoded, {} drawn, {:.2} ms to choose\n",
            self.decode_fps.text(),
            self.end_to_end_fps.text(),
            self.choose_ms
        )
    }
}

fn told(score: Option<f64>) -> String {
    score.map_or("not scored".to_owned(), |jod| format!("{jod:.2} JOD"))
}

impl Report {
    pub(super) fn text(&self) -> String {
        let mut text = self.machine.text();
        let [w, h] = self.size_px;
        text += &format!(
            "\n{}, from {w}x{h}; {}, medians of {} (slowest to fastest):\n",
            self.pack,
            counted(self.jobs, "decoding thread"),
            counted(self.turns, "turn")
        );
        for foveated in self.foveated() {
            text += &foveated
                .foveated
                .line(&format!("foveated, {}", foveated.policy));
        }
        let rows = [
            ("viewport", self.viewport),
            ("full", self.full),
            ("coarsest", self.coarsest),
        ];
        rows.iter()
            .for_each(|(name, rates)| text += &rates.line(name));
        text += "ms a foveated frame, mean (median; mean of frames in which the gaze jumped):\n";
        for foveated in self.foveated() {
            text += &format!(
                "{}: {}; {:.1} decodes a frame\n",
                foveated.policy,
                foveated.parts.text(),
                foveated.decodes_per_frame
            );
        }
        for WorkersReport {
            workers,
            decode_ms_mean,
            foveated_fps,
        } in &self.workers
        {
            text += &format!(
                "foveated, {} on {}: {:.2} ms to decode, {foveated_fps:.1} frames/s decoded\n",
                self.first.policy,
                counted(*workers, "decoding thread"),
                decode_ms_mean.unwrap_or_default(),
            );
        }
        text += &match (self.original_fps, self.ratio_original) {
            (Some(fps), Some(ratio)) => {
                format!(
                    "original file: {fps:.1} frames/s; foveated plays {ratio:.1} times as many\n"
                )
            }
            _ => "original file: not compared; give it with --original FILE\n".to_owned(),
        };
        for foveated in self.foveated() {
            text += &foveated.text();
        }
        text += &format!(
            "before, at a slope of {}: {}, {:.1} frames/s, {:.1} times full, {:.2} % of the \
             pixels\n",
            self.before.slope,
            told(self.before.score),
            self.before.foveated_fps,
            self.before.ratio,
            self.before.pixels_share_mean * 100.0,
        );
        let published = self.published.as_ref();
        text += &published.map_or(String::new(), PublishedReport::text);
        text.trim_end().to_owned()
    }

    /// Under every policy, the first first.
    fn foveated(&self) -> impl Iterator<Item = &Foveated> {
        let others = self.policies.values();
        let others = others.filter(|it| it.policy != self.first.policy);
        std::iter::once(&self.first).chain(others)
    }
}

impl Foveated {
    fn text(&self) -> String {
        format!(
            "foveated under {}: {}; {:.1} times full and {:.1} times viewport; {:.2} % of the \
             pixels; {}, {}, fovea sharp {} after a saccade (95th percentile), {:.2} MB on the \
             GPU ({:.2} % of a whole 4:2:0 frame)\n",
            self.policy,
            told(self.score),
            self.ratio,
            self.ratio_viewport,
            self.pixels_share_mean * 100.0,
            counted(self.late_frames, "late frame"),
            counted(self.incomplete_frames, "incomplete frame"),
            counted(self.frames_to_fovea_p95, "frame"),
            self.gpu_bytes as f64 / 1e6,
            self.gpu_share * 100.0
        )
    }
}

impl PublishedReport {
    fn text(&self) -> String {
        let mut text = format!(
            "{}: {} on {}, {}; {:.1} times full there, {:.2} % of the pixels, {:.2} MB on the GPU \
             ({:.2} % of a whole 4:2:0 frame), {}, {}; foveated plays {:.1} times as many frames\n",
            self.name,
            self.policy,
            self.pack,
            told(self.score),
            self.ratio,
            self.pixels_share_mean * 100.0,
            self.gpu_bytes as f64 / 1e6,
            self.gpu_share * 100.0,
            counted(self.late_frames, "late frame"),
            counted(self.incomplete_frames, "incomplete frame"),
            self.foveated_over_it,
        );
        let rows = [
            (self.policy, self.rates),
            ("full", self.full),
            ("coarsest", self.coarsest),
        ];
        for (name, rates) in rows {
            text += &rates.line(&format!("{}, {name}", self.name));
        }
        text
    }
}
