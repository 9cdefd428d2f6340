//! What does a result say?

use crate::commands::score::engine::CompanionValues;
use foveal_core::units::{counted, one_line};
use foveal_eval::score::companion::Companion;
use foveal_eval::score::constants as fit;
use foveal_eval::score::display::Transfer;
use foveal_eval::score::named_displays::NamedDisplay;
use foveal_eval::score::pooling::{BandEnergies, Zones};
use foveal_eval::score::{Mode, Score, Viewing, Zone};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Under which conditions a number was found; every result carries them.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ScoreConditions {
    display: String,
    ppd: f64,
    peak_cd_m2: f64,
    black_cd_m2: f64,
    foveated: bool,
    /// Where the gaze came from; null without one.
    gaze: Option<String>,
    size_px: [u32; 2],
    /// Null for a still.
    fps: Option<f64>,
}

impl ScoreConditions {
    pub(crate) fn new(viewing: &Viewing, gaze: Option<String>) -> Self {
        let display = &viewing.display;
        Self {
            display: display.name.clone(),
            ppd: display.ppd(),
            peak_cd_m2: display.peak_cd_m2,
            black_cd_m2: display.black_cd_m2,
            foveated: viewing.foveated,
            gaze,
            size_px: viewing.size,
            fps: viewing.fps,
        }
    }

    pub(crate) fn text(&self) -> String {
        let [w, h] = self.size_px;
        let rate = self
            .fps
            .map_or(String::new(), |fps| format!(" at {fps} Hz"));
        format!(
            "{w}x{h}{rate} on {} ({:.2} pixels/°, {} to {:.4} cd/m²), {}",
            one_line(&self.display),
            self.ppd,
            self.peak_cd_m2,
            self.black_cd_m2,
            self.gaze
                .as_ref()
                .map_or("not foveated".to_owned(), |gaze| format!("gaze: {gaze}"))
        )
    }
}

/// The result of the foveated metric.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ScoreReport {
    pub(crate) jod: f64,
    metric: &'static str,
    version: &'static str,
    mode: Mode,
    #[serde(flatten)]
    conditions: ScoreConditions,
    frames: usize,
    device: String,
    bands: Vec<BandEnergies>,
    /// Null without a gaze.
    zones: Option<Zones>,
    companions: CompanionValues,
    heat_file: Option<PathBuf>,
    per_frame: Vec<f64>,
}

impl ScoreReport {
    /// Of a gaze by the name of its source.
    pub(crate) fn judged(
        viewing: &Viewing,
        mode: Mode,
        gaze: Option<String>,
        score: Score,
    ) -> Self {
        Self {
            jod: score.jod,
            metric: fit::METRIC,
            version: fit::VERSION,
            mode,
            conditions: ScoreConditions::new(viewing, gaze),
            frames: score.frames,
            device: "cpu".to_owned(),
            bands: score.bands,
            zones: score.zones,
            companions: CompanionValues::default(),
            heat_file: None,
            per_frame: score.per_frame,
        }
    }

    /// With what else is known.
    pub(crate) fn with(
        self,
        companions: CompanionValues,
        device: String,
        heat_file: Option<PathBuf>,
    ) -> Self {
        Self {
            companions,
            device,
            heat_file,
            ..self
        }
    }

    /// The score of every frame.
    pub(crate) fn per_frame(&self) -> &[f64] {
        &self.per_frame
    }

    pub(crate) fn text(&self) -> String {
        let mode = mode_name(self.mode);
        let mut text = format!(
            "{:.4} JOD ({} {}, {mode}, {}; 10 is no visible difference; at 9, three of \
             four people pick the better picture)\n{}, {}\n",
            self.jod,
            self.metric,
            self.version,
            self.device,
            counted(self.frames, "frame"),
            self.conditions.text()
        );
        if let Some(zones) = &self.zones {
            text += "by eccentricity:";
            for (name, zone) in [
                ("under 5°", zones.under_5_deg),
                ("5° to 20°", zones.from_5_to_20_deg),
                ("over 20°", zones.over_20_deg),
            ] {
                text += &zone_text(name, zone);
            }
            text += "\n";
        }
        text += "band, cycles/°   sustained   transient\n";
        for band in &self.bands {
            let [cpd, s, t] = [band.cpd, band.sustained, band.transient];
            let _ = writeln!(text, "{cpd:14.3} {s:11.3} {t:11.3}");
        }
        let decibels = |value: Option<f64>| value.map(|value| format!("{value:.2} dB"));
        let companions = [
            ("PSNR", decibels(self.companions.psnr_db)),
            (
                "foveation-weighted PSNR",
                decibels(self.companions.fw_psnr_db),
            ),
            (
                "SSIM in the fovea",
                self.companions
                    .foveal_ssim
                    .map(|value| format!("{value:.4}")),
            ),
        ];
        let known = companions.into_iter();
        let known: Vec<String> = known
            .filter_map(|(name, value)| Some(format!("{name} {}", value?)))
            .collect();
        if !known.is_empty() {
            let _ = writeln!(text, "other metrics: {}", known.join(", "));
        }
        if let Some(file) = &self.heat_file {
            let _ = writeln!(text, "{}", file.display());
        }
        text
    }
}

fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Compat => "compat",
        Mode::Strict => "strict",
    }
}

fn zone_text(name: &str, zone: Option<Zone>) -> String {
    match zone {
        Some(zone) => format!(
            "  {name} {:.3} ({:.1} % of the view)",
            zone.jod,
            zone.pixels_share * 100.0
        ),
        None => format!("  {name} -"),
    }
}

/// The result of another measure.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Single {
    metric: Companion,
    /// Of this program.
    version: &'static str,
    mode: Mode,
    /// Null for equal pictures, of measures in decibels; of others where they see nothing.
    value: Option<f64>,
    unit: &'static str,
    #[serde(flatten)]
    conditions: ScoreConditions,
    frames: usize,
    per_frame: Vec<f64>,
}

impl Single {
    pub(super) fn new(
        (metric, mode): (Companion, Mode),
        viewing: &Viewing,
        gaze: Option<String>,
        value: f64,
        per_frame: Vec<f64>,
    ) -> Self {
        let is_similarity = matches!(metric, Companion::Ssim | Companion::FovealSsim);
        Self {
            metric,
            version: env!("CARGO_PKG_VERSION"),
            mode,
            value: value.is_finite().then_some(value),
            unit: if is_similarity { "" } else { "dB" },
            conditions: ScoreConditions::new(viewing, gaze),
            frames: per_frame.len(),
            per_frame,
        }
    }

    pub(super) fn text(&self) -> String {
        let none = match self.unit {
            "dB" => "no error",
            _ => "nothing of the picture is in the fovea:",
        };
        let value = self
            .value
            .map_or(none.to_owned(), |value| format!("{value:.4}"));
        let (unit, metric) = (self.unit, self.metric.name());
        let frames = counted(self.frames, "frame");
        let (version, mode) = (self.version, mode_name(self.mode));
        let conditions = self.conditions.text();
        format!("{value} {unit} ({metric} of foveal {version}, {mode})\n{frames}, {conditions}\n")
    }
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct DisplayRow {
    name: String,
    size_px: [u32; 2],
    ppd: f64,
    fov_deg: [f64; 2],
    peak_cd_m2: f64,
    black_cd_m2: f64,
    transfer: Transfer,
    /// Why nothing is scored on it, and what to give in its place; mostly null.
    refused: Option<&'static str>,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct DisplayList {
    displays: Vec<DisplayRow>,
}

/// The displays that have names, as one object and as text.
pub(super) fn displays() -> (DisplayList, String) {
    let list = DisplayList {
        displays: NamedDisplay::all().map(DisplayRow::of).collect(),
    };
    let mut text =
        "name                 panel       pixels/°   field of view    cd/m²\n".to_owned();
    for row in &list.displays {
        let [w, h] = row.size_px;
        let [across, down] = row.fov_deg;
        let transfer = match row.transfer {
            Transfer::Pq => ", PQ",
            _ => "",
        };
        let figures = format!(
            "{:20} {:11} {:8.4}   {across:.2}° x {down:.2}°  {:.4} to {}{transfer}",
            row.name,
            format!("{w}x{h}"),
            row.ppd,
            row.black_cd_m2,
            row.peak_cd_m2,
        );
        let _ = match row.refused {
            None => writeln!(text, "{figures}"),
            Some(why) => writeln!(text, "{:20} refused: {why}", row.name),
        };
    }
    (list, text)
}

impl DisplayRow {
    fn of(named: NamedDisplay) -> Self {
        let display = named.display;
        Self {
            size_px: display.size_px,
            ppd: display.ppd(),
            fov_deg: display.fov_deg(),
            peak_cd_m2: display.peak_cd_m2,
            black_cd_m2: display.black_cd_m2,
            transfer: display.transfer,
            refused: named.refused,
            name: display.name,
        }
    }
}

/// What a methods section needs.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Citation {
    metric: &'static str,
    version: &'static str,
    program: &'static str,
    program_version: &'static str,
    paper: &'static str,
    /// By the names of the published program, or what they stand for.
    parameters: BTreeMap<&'static str, Vec<f64>>,
}

/// Version, parameters and paper, as one object and as text.
pub(super) fn citation() -> (Citation, String) {
    let parameters = BTreeMap::from([
        ("mask_p", vec![fit::DIFFERENCE_EXPONENT]),
        ("k (10^mask_c)", vec![fit::MASKING]),
        (
            "mask_q sustained, transient",
            fit::MASKING_EXPONENTS.to_vec(),
        ),
        ("w sustained, transient", fit::CHANNEL_WEIGHTS.to_vec()),
        ("beta", vec![fit::SPACE_EXPONENT]),
        ("beta_tch", vec![fit::CHANNEL_EXPONENT]),
        ("sensitivity factor", vec![fit::SENSITIVITY_FACTOR]),
        ("jod_a", vec![fit::JOD_SCALE]),
        ("jod exponent", vec![fit::JOD_EXPONENT]),
    ]);
    let citation = Citation {
        metric: fit::METRIC,
        version: fit::VERSION,
        program: "foveal",
        program_version: env!("CARGO_PKG_VERSION"),
        paper: fit::CITATION,
        parameters,
    };
    let mut text = format!(
        "Scores are those of FovVideoVDP {} as foveal {} computes it (mode compat: within 0.0005 \
         JOD of pyfvvdp 1.2.2 on its golden cases; mode strict: not comparable with published \
         scores). With a score, name display, pixels per degree, peak and black, mode, and where \
         the gaze came from: `foveal score` prints them.\n\n{}\n\n",
        fit::VERSION,
        env!("CARGO_PKG_VERSION"),
        fit::CITATION
    );
    for (name, values) in &citation.parameters {
        let values: Vec<String> = values.iter().map(f64::to_string).collect();
        let _ = writeln!(text, "{name}: {}", values.join(", "));
    }
    (citation, text)
}
