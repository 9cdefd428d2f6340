//! How do policies that were compared read as tables?

use crate::commands::evaluate::policies::report::{PoliciesReport, PolicyRow};
use foveal_core::units::counted;
use foveal_eval::score::Zone;
use foveal_eval::score::pooling::Zones;
use std::fmt::Write as _;

impl PolicyRow {
    fn csv(&self) -> String {
        let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        let zones = self.jod_zones;
        let zone = |of: fn(Zones) -> Option<Zone>| number(zones.and_then(of).map(|zone| zone.jod));
        [
            quoted(&self.content),
            quoted(&self.display),
            self.policy.to_owned(),
            self.curve.clone(),
            number(self.target),
            number(self.slope),
            number(self.rate_mbit),
            self.pixels_share_mean.to_string(),
            self.bytes.to_string(),
            self.bytes_over_original.to_string(),
            self.decode_ms_mean.to_string(),
            self.decode_over_full.to_string(),
            self.jod.to_string(),
            number(self.jod_source),
            zone(|zones| zones.under_5_deg),
            zone(|zones| zones.from_5_to_20_deg),
            zone(|zones| zones.over_20_deg),
            number(self.fw_psnr),
            self.start.pixels_share_mean.to_string(),
            self.start.bytes.to_string(),
            self.start.jod.to_string(),
        ]
        .join(",")
    }
}

/// A field of CSV, whatever is in it.
fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

/// The head of the table that [`PoliciesReport::csv`] writes.
const COLUMNS: &str = "content,display,policy,curve,target,slope,rate_mbit,pixels_share_mean,\
                       bytes,bytes_over_original,decode_ms_mean,decode_over_full,jod,jod_source,\
                       jod_under_5_deg,jod_from_5_to_20_deg,jod_over_20_deg,fw_psnr,\
                       start_pixels_share_mean,start_bytes,start_jod\n";

impl PoliciesReport {
    /// One line a row.
    pub(super) fn csv(&self) -> String {
        let mut text = COLUMNS.to_owned();
        for row in &self.rows {
            text += &row.csv();
            text.push('\n');
        }
        text
    }

    /// Both tables for people.
    pub(super) fn text(&self) -> String {
        let played = counted(self.played_frames, "frame");
        let after = match self.played_frames > self.frames {
            true => format!(
                ", figures of {} after a start of {}",
                self.frames, self.start_frames
            ),
            false => String::new(),
        };
        let text = format!(
            "{}\n{}: {played}{after}\n{}\n\n",
            self.machine.text(),
            self.pack.display(),
            self.conditions.text(),
        );
        text + &self.rows_text() + &self.equal_text()
    }

    fn rows_text(&self) -> String {
        let mut text = format!(
            "{:<32} {:>8} {:>9} {:>9} {:>7} {:>7} {:>6} {:>7} {:>6} {:>6} {:>6} {:>8} | \
             {:>8} {:>9} {:>6}\n",
            "policy",
            "pixels",
            "kB",
            "of video",
            "ms",
            "of full",
            "JOD",
            "source",
            "<5°",
            "5-20°",
            ">20°",
            "fw-PSNR",
            "start",
            "kB",
            "JOD",
        );
        let number = |value: Option<f64>, digits: usize| {
            value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
        };
        for row in &self.rows {
            let zones = row.jod_zones.map_or([None; 3], |zones| {
                [zones.under_5_deg, zones.from_5_to_20_deg, zones.over_20_deg]
            });
            let [near, around, far] = zones.map(|zone| number(zone.map(|zone| zone.jod), 2));
            let _ = writeln!(
                text,
                "{:<32} {:>6.2} % {:>9.1} {:>7.1} % {:>7.1} {:>7.2} {:>6.2} {:>7} {near:>6} \
                 {around:>6} {far:>6} {:>8} | {:>6.2} % {:>9.1} {:>6.2}",
                row.name(),
                row.pixels_share_mean * 100.0,
                row.bytes as f64 / 1e3,
                row.bytes_over_original * 100.0,
                row.decode_ms_mean,
                row.decode_over_full,
                row.jod,
                number(row.jod_source, 2),
                number(row.fw_psnr, 1),
                row.start.pixels_share_mean * 100.0,
                row.start.bytes as f64 / 1e3,
                row.start.jod,
            );
        }
        text
    }

    fn equal_text(&self) -> String {
        let mut text = format!(
            "\nat equal score, and over acuity by slope and viewport\n\
             {:>5} {:<24} {:>9} {:>8} {:>9} {:>9} {:>9} {:>9}\n",
            "JOD", "policy", "kB", "pixels", "B/acuity", "B/view", "px/acuity", "px/view"
        );
        for row in &self.at_equal_score {
            let number = |value: Option<f64>, by: f64, digits: usize| {
                value.map_or("-".to_owned(), |value| format!("{:.digits$}", value * by))
            };
            let _ = writeln!(
                text,
                "{:>5} {:<24} {:>9} {:>8} {:>9} {:>9} {:>9} {:>9}",
                row.jod,
                row.curve,
                number(row.bytes, 1e-3, 1),
                number(row.pixels_share, 100.0, 2),
                number(row.bytes_over_acuity, 1.0, 2),
                number(row.bytes_over_viewport, 1.0, 2),
                number(row.pixels_over_acuity, 1.0, 2),
                number(row.pixels_over_viewport, 1.0, 2),
            );
        }
        text
    }
}
