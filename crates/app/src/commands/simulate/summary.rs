//! What did a run of a video take?

use crate::commands::score::ScoreReport;
use crate::commands::simulate::expected::expected_of;
use crate::options::decoding::DeviceReport;
use crate::options::panels::PlayedPanel;
use crate::report::output;
use foveal_core::content::policy::Policy;
use foveal_core::perception::visible_loss::{BEST_JOD, jod_lost};
use foveal_core::session::log::sha256_hex;
use foveal_core::units::{Seconds, counted};
use foveal_core::view::axes::yaw_pitch_from_direction;
use foveal_play::{FramePlayer, FrameReport};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// How far below its target a score may be and still count as reached, in JOD.
const TARGET_WITHIN: f64 = 0.2;
/// A pixel as three 32-bit floats, which is what Kastner 2016 (table 5.4) counts shares of.
const FLOATS_BYTES: u64 = 12;
/// What a run took.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RunSummary {
    pub(crate) policy: String,
    /// The same where it was left to the content; null where it was named.
    pub(crate) policy_chosen: Option<&'static str>,
    pub(crate) frames: usize,
    pub(crate) pixels_share_mean: f64,
    pub(crate) pixels_share_max: f64,
    pub(crate) bytes: u64,
    /// Bytes of units that were fetched again.
    pub(crate) refetched_bytes: u64,
    pub(crate) decoded_megapixels: f64,
    pub(crate) decode_ms_mean: f64,
    pub(crate) decode_ms_p95: f64,
    pub(crate) late_frames: usize,
    /// Frames shown with a coarser tile in the place of one that was chosen.
    pub(crate) incomplete_frames: usize,
    pub(crate) wrong_frame_tiles: usize,
    pub(crate) damaged_tiles: usize,
    pub(crate) level_changes: u64,
    /// Null where it is not known where the eye looked.
    pub(crate) gaze_error_deg_mean: Option<f64>,
    /// Share of the detail that the eye could see that was shown; null for packs without
    /// signatures.
    pub(crate) detail_share_mean: Option<f64>,
    /// The score that levels were chosen for, in JOD; null without one.
    pub(crate) target: Option<f64>,
    /// The score against every finest tile that signatures predict, in JOD; null for packs
    /// without, and under a link.
    pub(crate) expected_jod: Option<f64>,
    /// Whether buying stopped because the target was reached; null without a link or a target.
    pub(crate) stopped_at_target: Option<bool>,
    /// Bytes that the link could have brought besides; null without one.
    pub(crate) unspent_bytes: Option<u64>,
    pub(crate) gpu_bytes: u64,
    /// The same over the finest level whole, as 8-bit 4:2:0, and as three 32-bit floats a pixel.
    pub(crate) gpu_share: f64,
    pub(crate) gpu_share_of_floats: f64,
    pub(crate) decoded_on: DeviceReport,
    pub(crate) log_sha256: String,
    /// How good it looked compared with the full picture, where asked for; on panels that of the
    /// lowest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) score: Option<ScoreReport>,
    /// The panels that it was shown on, where there is a rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) panels: Option<Vec<PlayedPanel>>,
    /// Pixels of pictures between the tiles and the panels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) intermediate_pixels: Option<u64>,
}

/// Sums up a run.
pub(crate) fn summarise(
    policy: String,
    reports: &[FrameReport],
    player: &mut FramePlayer,
    session: &str,
) -> RunSummary {
    let count = reports.len().max(1) as f64;
    let mut decode_ms: Vec<f64> = reports
        .iter()
        .map(|r| r.decode.as_secs_f64() * 1e3)
        .collect();
    decode_ms.sort_by(f64::total_cmp);
    let p95 = (decode_ms.len() * 95).div_ceil(100).max(1) - 1;
    let (surface, gpu_bytes) = (player.grid().surface, player.drawer().gpu_bytes());
    let gpu_share_of = |bytes: u64| gpu_bytes as f64 / bytes as f64;
    let detail = reports.iter().map(|r| r.detail_share).sum::<Option<f64>>();
    let quality = expected_of(reports);
    RunSummary {
        policy,
        policy_chosen: None,
        frames: reports.len(),
        pixels_share_mean: reports.iter().map(|r| r.share).sum::<f64>() / count,
        pixels_share_max: reports.iter().map(|r| r.share).fold(0.0, f64::max),
        bytes: reports.iter().map(|r| r.new_bytes).sum(),
        refetched_bytes: player.refetched_bytes(),
        decoded_megapixels: reports.iter().map(|r| r.decoded_pixels).sum::<u64>() as f64 / 1e6,
        decode_ms_mean: decode_ms.iter().sum::<f64>() / count,
        decode_ms_p95: decode_ms.get(p95).copied().unwrap_or_default(),
        late_frames: reports.iter().filter(|r| r.late).count(),
        incomplete_frames: reports.iter().filter(|r| !r.missing.is_empty()).count(),
        wrong_frame_tiles: reports.iter().map(|r| r.wrong_frame_tiles).sum(),
        damaged_tiles: reports.iter().map(|r| r.failed_tiles).sum(),
        level_changes: reports.iter().map(|r| r.level_changes).sum(),
        gaze_error_deg_mean: mean_of_known(reports.iter().map(|r| r.gaze_error_deg)),
        detail_share_mean: detail.map(|sum| sum / count),
        target: player.config().target,
        expected_jod: quality
            .filter(|_| player.knows_score())
            .map(|sum| BEST_JOD - jod_lost(sum / count)),
        stopped_at_target: player.stopped_at_target(),
        unspent_bytes: unspent(reports, player),
        gpu_bytes,
        gpu_share: gpu_share_of(surface.bytes_of_planes()),
        gpu_share_of_floats: gpu_share_of(surface.pixels() * FLOATS_BYTES),
        decoded_on: DeviceReport::new(player.device_use()),
        log_sha256: sha256_hex(session.as_bytes()),
        score: None,
        panels: None,
        intermediate_pixels: None,
    }
}

/// Bytes that a link brings in the time of a run and that nothing was fetched for.
fn unspent(reports: &[FrameReport], player: &FramePlayer) -> Option<u64> {
    let [first, last] = [reports.first()?, reports.last()?].map(|report| report.session.time_s.0);
    let period = player.length().0 / player.frames().max(1) as f64;
    let brought = player.bytes_in(Seconds(last - first + period))?;
    let fetched: u64 = reports.iter().map(|report| report.new_bytes).sum();
    Some((brought - fetched as f64).max(0.0) as u64)
}

/// The mean of what is known; `None` where nothing is.
fn mean_of_known(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let known: Vec<f64> = values.flatten().collect();
    (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
}

impl RunSummary {
    /// Says where the target is not reached, by the score where there is one.
    pub(super) fn tell_missed(&self) {
        let Some(target) = self.target else { return };
        let scored = self.score.as_ref().map(|it| ("score", it.jod));
        let expected = self.expected_jod.map(|jod| ("expected score", jod));
        let Some((what, jod)) = scored.or(expected) else {
            return;
        };
        if jod < target - TARGET_WITHIN {
            let more = match self.unspent_bytes {
                Some(_) => "a faster --link brings more",
                None if self.policy == Policy::Acuity.name() => "--policy perceptual can show more",
                None => "a higher --target shows more",
            };
            output::say(&format!(
                "warning: --target {target} is missed: the {what} is {jod:.2} JOD; {more}"
            ));
        }
    }

    pub(super) fn text(&self, out: &Path) -> String {
        format!(
            "{} under {}{}: {:.2} % of the pixels of the finest level (most {:.2} %), {:.2} MB \
             fetched, {:.1} MPix decoded\n\
             decoding {:.1} ms a frame (95th percentile {:.1}), {}, {}, {}, {}, \
             {:.2} MB on the GPU\n\
             {}{}{}{}{}{}{}{}{}written to {}",
            counted(self.frames, "frame"),
            self.policy,
            self.policy_chosen.map_or("", |_| " (chosen by auto)"),
            self.pixels_share_mean * 100.0,
            self.pixels_share_max * 100.0,
            self.bytes as f64 / 1e6,
            self.decoded_megapixels,
            self.decode_ms_mean,
            self.decode_ms_p95,
            counted(self.late_frames, "late frame"),
            counted(self.incomplete_frames, "incomplete frame"),
            counted(self.damaged_tiles, "damaged tile"),
            counted(self.level_changes, "level change"),
            self.gpu_bytes as f64 / 1e6,
            output::refetched(self.refetched_bytes),
            self.detail_share_mean
                .map_or(String::new(), |share| format!(
                    "{:.1} % of the detail that the eye could see\n",
                    share * 100.0,
                )),
            match self.pixels_share_max > 1.0 {
                true =>
                    "(more than 100 %: tiles of coarser levels count too, and of sampled views \
                         every sample, also where the view has more pixels than the video)\n",
                false => "",
            },
            self.gaze_error_deg_mean
                .filter(|error| *error > 0.0)
                .map_or(String::new(), |error| format!(
                    "mean error of the expected gaze: {error:.2}°\n"
                )),
            match (self.target, self.expected_jod) {
                (Some(target), Some(jod)) =>
                    format!("target {target} JOD, expected {jod:.2} JOD\n"),
                _ => String::new(),
            },
            match (self.stopped_at_target, self.unspent_bytes) {
                (Some(true), Some(bytes)) => format!(
                    "buying stopped at the target; {} of the link were not used\n",
                    output::size(bytes)
                ),
                _ => String::new(),
            },
            self.decoded_on.text(),
            self.score.as_ref().map_or(String::new(), ScoreReport::text),
            self.panels
                .as_deref()
                .map_or(String::new(), PlayedPanel::text),
            out.display(),
        )
    }
}

/// The figures of a run as CSV, one line a frame, with the score of each where there is one
/// (docs/formats/results.md).
pub(crate) fn csv(reports: &[FrameReport], jods: Option<&[f64]>) -> String {
    let mut text = "frame,time_s,gaze_yaw_deg,gaze_pitch_deg,head_yaw_deg,head_pitch_deg,tiles,\
                    pixels,share,decoded_pixels,new_bytes,decode_ms,upload_ms,late,missing_tiles,\
                    level_changes,gaze_error_deg,detail_share,jod\n"
        .to_owned();
    let known = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.6}"));
    for (number, report) in reports.iter().enumerate() {
        let (yaw, pitch) = yaw_pitch_from_direction(report.gaze.gaze_in_content);
        let head = report.session.head;
        let _ = writeln!(
            text,
            "{},{:.6},{:.4},{:.4},{:.4},{:.4},{},{},{:.6},{},{},{:.3},{:.3},{},{},{},{},{},{}",
            report.session.frame,
            report.session.time_s.0,
            yaw.to_degrees(),
            pitch.to_degrees(),
            head.yaw.to_degrees(),
            head.pitch.to_degrees(),
            report.histogram.iter().sum::<u32>(),
            report.pixels,
            report.share,
            report.decoded_pixels,
            report.new_bytes,
            report.decode.as_secs_f64() * 1e3,
            report.upload.as_secs_f64() * 1e3,
            u8::from(report.late),
            report.missing.len(),
            report.level_changes,
            known(report.gaze_error_deg),
            known(report.detail_share),
            known(jods.and_then(|jods| jods.get(number)).copied()),
        );
    }
    text
}
