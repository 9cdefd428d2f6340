//! What did a policy take over a span of frames, and how good was it?

use foveal_core::pack::unit::UnitId;
use foveal_eval::score::companion::{Companion, CompanionJudge};
use foveal_eval::score::pooling::{Pool, Zones};
use foveal_eval::score::{FrameScore, Judge, ScorePicture, Viewing};
use foveal_media::pack::pack_file::PackFile;
use foveal_play::FrameReport;
use serde::Serialize;
use std::collections::HashSet;
use std::ops::Range;

/// What a span of frames came to.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SpanFigures {
    pub(super) pixels_share_mean: f64,
    pub(super) bytes: u64,
    pub(super) decode_ms_mean: f64,
    /// Over that of the full picture that was decoded in turn with it.
    pub(super) decode_over_full: f64,
    pub(super) jod: f64,
    pub(super) jod_source: Option<f64>,
    pub(super) jod_zones: Option<Zones>,
    pub(super) fw_psnr: Option<f64>,
}

/// Sums over a span of frames.
struct Span {
    frames: Range<u32>,
    shares: f64,
    bytes: f64,
    decode_ms: f64,
    full_decode_ms: f64,
    score: Pool,
    score_of_source: Pool,
    fw_psnr: CompanionJudge,
}

/// Judges one policy frame after frame, over several spans at once.
pub(super) struct Measure {
    spans: Vec<Span>,
    fetched: HashSet<UnitId>,
    judge: Judge,
    judge_of_source: Option<Judge>,
}

/// What a frame is judged against, and by where the eye looks.
pub(super) struct Reference {
    pub(super) full: ScorePicture,
    pub(super) source: Option<ScorePicture>,
    pub(super) gaze_px: [f64; 2],
}

impl Measure {
    /// A measure of spans; `has_source` where there is more than the pack to judge against.
    pub(super) fn new(
        spans: &[Range<u32>],
        viewing: &Viewing,
        has_source: bool,
        jobs: usize,
    ) -> anyhow::Result<Self> {
        let span = |frames: &Range<u32>| {
            Ok(Span {
                frames: frames.clone(),
                shares: 0.0,
                bytes: 0.0,
                decode_ms: 0.0,
                full_decode_ms: 0.0,
                score: Pool::default(),
                score_of_source: Pool::default(),
                fw_psnr: CompanionJudge::new(Companion::FwPsnr, viewing)?,
            })
        };
        let judge = || Judge::new(viewing, jobs);
        Ok(Self {
            spans: spans.iter().map(span).collect::<anyhow::Result<_>>()?,
            fetched: HashSet::new(),
            judge: judge()?,
            judge_of_source: has_source.then(judge).transpose()?,
        })
    }

    /// Takes in what a frame took, and the same frame whole.
    pub(super) fn took(&mut self, file: &PackFile, report: &FrameReport, full: &FrameReport) {
        let (pack, frame) = (file.pack(), report.session.frame);
        for tile in report.tiles.iter().chain(&report.missing) {
            let unit = pack.unit(*tile, frame);
            if !self.fetched.insert(unit) {
                continue;
            }
            // What is fetched for a group serves the rest of it, within a span or beyond it.
            let serves = frame..pack.frames_of(unit).end;
            let bytes = f64::from(pack.entry(unit).bytes) / serves.len() as f64;
            for span in &mut self.spans {
                span.bytes += bytes * common(&serves, &span.frames);
            }
        }
        for span in self.spans_of(frame) {
            span.shares += report.share;
            span.decode_ms += report.decode.as_secs_f64() * 1e3;
            span.full_decode_ms += full.decode.as_secs_f64() * 1e3;
        }
    }

    /// Takes in what a frame looked like.
    pub(super) fn looked(
        &mut self,
        frame: u32,
        reference: &Reference,
        test: &ScorePicture,
    ) -> anyhow::Result<()> {
        let Reference {
            full,
            source,
            gaze_px,
        } = reference;
        let score = self.judge.frame(full, test, *gaze_px)?;
        let of_source: Option<FrameScore> = match (&mut self.judge_of_source, source) {
            (Some(judge), Some(source)) => Some(judge.frame(source, test, *gaze_px)?),
            _ => None,
        };
        for span in self.spans_of(frame) {
            span.score.add(&score);
            of_source
                .iter()
                .for_each(|score| span.score_of_source.add(score));
            span.fw_psnr.frame(full, test, *gaze_px)?;
        }
        Ok(())
    }

    fn spans_of(&mut self, frame: u32) -> impl Iterator<Item = &mut Span> {
        let mut spans = self.spans.iter_mut();
        std::iter::from_fn(move || spans.find(|span| span.frames.contains(&frame)))
    }

    /// What every span came to.
    pub(super) fn figures(&self) -> Option<Vec<SpanFigures>> {
        self.spans.iter().map(Span::figures).collect()
    }
}

impl Span {
    /// `None` of no frame.
    fn figures(&self) -> Option<SpanFigures> {
        let score = self.score.score(&[])?;
        let frames = score.frames as f64;
        Some(SpanFigures {
            pixels_share_mean: self.shares / frames,
            bytes: self.bytes.round() as u64,
            decode_ms_mean: self.decode_ms / frames,
            decode_over_full: self.decode_ms / self.full_decode_ms.max(f64::MIN_POSITIVE),
            jod: score.jod,
            jod_source: self.score_of_source.score(&[]).map(|score| score.jod),
            jod_zones: score.zones,
            fw_psnr: Some(self.fw_psnr.total()).filter(|value| value.is_finite()),
        })
    }
}

/// How many frames two ranges share.
fn common(a: &Range<u32>, b: &Range<u32>) -> f64 {
    let [start, end] = [a.start.max(b.start), a.end.min(b.end)];
    f64::from(end.saturating_sub(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_share_what_lies_in_both() {
        assert_eq!(common(&(24..32), &(0..25)), 1.0);
        assert_eq!(common(&(24..32), &(25..48)), 7.0);
        assert_eq!(common(&(24..32), &(32..48)), 0.0);
    }
}
