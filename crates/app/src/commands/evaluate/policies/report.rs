//! What is said of policies that were compared?

use crate::commands::demo::machine::Machine;
use crate::commands::evaluate::policies::contenders::{ACUITY, Contender, VIEWPORT};
use crate::commands::evaluate::policies::equal_score::{AtScore, Curve, Point, at_equal_score};
use crate::commands::evaluate::policies::measure::SpanFigures;
use crate::commands::score::ScoreConditions;
use foveal_eval::score::Mode;
use foveal_eval::score::pooling::Zones;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Debug, Serialize)]
pub(super) struct PoliciesReport {
    pub(super) machine: Machine,
    pub(super) pack: PathBuf,
    pub(super) source: Option<PathBuf>,
    /// Of the video that the pack was made from.
    pub(super) original_bytes: u64,
    pub(super) metric: &'static str,
    pub(super) version: &'static str,
    pub(super) mode: Mode,
    #[serde(flatten)]
    pub(super) conditions: ScoreConditions,
    /// Frames of the first second, those that the figures cover, and all.
    pub(super) start_frames: u32,
    pub(super) frames: u32,
    pub(super) played_frames: u32,
    pub(super) rows: Vec<PolicyRow>,
    pub(super) at_equal_score: Vec<AtScore>,
}

/// One policy.
#[derive(Debug, Serialize)]
pub(super) struct PolicyRow {
    pub(super) content: String,
    pub(super) display: String,
    pub(super) policy: &'static str,
    pub(super) curve: String,
    pub(super) target: Option<f64>,
    pub(super) slope: Option<f64>,
    pub(super) rate_mbit: Option<f64>,
    #[serde(skip)]
    pub(super) step: String,
    pub(super) pixels_share_mean: f64,
    pub(super) bytes: u64,
    pub(super) bytes_over_original: f64,
    pub(super) decode_ms_mean: f64,
    pub(super) decode_over_full: f64,
    pub(super) jod: f64,
    pub(super) jod_source: Option<f64>,
    pub(super) jod_zones: Option<Zones>,
    pub(super) fw_psnr: Option<f64>,
    pub(super) start: Start,
}

/// The first second.
#[derive(Debug, Serialize)]
pub(super) struct Start {
    pub(super) pixels_share_mean: f64,
    pub(super) bytes: u64,
    pub(super) jod: f64,
}

/// What stands in every row.
#[derive(Clone, Copy)]
pub(super) struct RowContext<'a> {
    pub(super) content: &'a str,
    pub(super) display: &'a str,
    /// Bytes of the original for as many frames as figures are of.
    pub(super) original_bytes: f64,
}

impl PolicyRow {
    /// Of the figures of the first second, and of those that stand for the policy.
    pub(super) fn new(
        contender: &Contender,
        shown: RowContext<'_>,
        start: &SpanFigures,
        figures: &SpanFigures,
    ) -> Self {
        Self {
            content: shown.content.to_owned(),
            display: shown.display.to_owned(),
            policy: contender.policy(),
            curve: contender.curve.clone(),
            target: contender.target,
            slope: contender.slope,
            rate_mbit: contender.rate_mbit,
            step: contender.step(),
            pixels_share_mean: figures.pixels_share_mean,
            bytes: figures.bytes,
            bytes_over_original: figures.bytes as f64 / shown.original_bytes,
            decode_ms_mean: figures.decode_ms_mean,
            decode_over_full: figures.decode_over_full,
            jod: figures.jod,
            jod_source: figures.jod_source,
            jod_zones: figures.jod_zones,
            fw_psnr: figures.fw_psnr,
            start: Start {
                pixels_share_mean: start.pixels_share_mean,
                bytes: start.bytes,
                jod: start.jod,
            },
        }
    }
}

/// Rows by curve, in the order of their first rows.
pub(super) fn by_curve(rows: &[PolicyRow]) -> Vec<(&str, Vec<&PolicyRow>)> {
    let mut curves: Vec<(&str, Vec<&PolicyRow>)> = Vec::new();
    for row in rows {
        match curves.iter_mut().find(|(name, _)| *name == row.curve) {
            Some((_, rows)) => rows.push(row),
            None => curves.push((&row.curve, vec![row])),
        }
    }
    curves
}

/// Every curve at these scores.
pub(super) fn compared(rows: &[PolicyRow], scores: &[f64]) -> Vec<AtScore> {
    let curve = |(name, rows): (&str, Vec<&PolicyRow>)| Curve {
        name: name.to_owned(),
        points: rows.into_iter().map(PolicyRow::point).collect(),
    };
    let curves: Vec<Curve> = by_curve(rows).into_iter().map(curve).collect();
    at_equal_score(&curves, scores, [ACUITY, VIEWPORT])
}

impl PolicyRow {
    pub(super) fn point(&self) -> Point {
        Point {
            jod: self.jod,
            bytes: self.bytes as f64,
            pixels_share: self.pixels_share_mean,
        }
    }

    /// Its policy, and what it differs by from others of its curve.
    pub(super) fn name(&self) -> String {
        format!("{} {}", self.curve, self.step)
            .trim_end()
            .to_owned()
    }
}
