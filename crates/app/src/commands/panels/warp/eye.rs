//! Whose eye do panels show the source to?

use crate::commands::panels::filter_name::FilterName;
use crate::report::output::{WrongUsage, out_of_range};
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::view::panel::eye_blur::{EyeBlur, PUPIL_MM};
use serde::Serialize;

/// Dioptres and millimetres that eyes have.
const MOST_DIOPTRES: f64 = 12.0;
const PUPILS_MM: [f64; 2] = [1.0, 9.0];

#[derive(Clone, Debug, Args)]
pub(super) struct EyeArgs {
    /// Show what an eye with astigmatism sees: the cylinder that corrects it, in dioptres, and its
    /// axis, in degrees counter-clockwise as an observer facing the eye sees it; as -1.5@180. A
    /// point becomes a line across the axis. Drawn by --filter auto, anisotropic, feline and ewa.
    #[arg(long, value_name = "CYLINDER@AXIS", value_parser = parse_cylinder)]
    #[arg(allow_hyphen_values = true)]
    eye_blur: Option<Cylinder>,
    /// Diameter of its pupil, 1 to 9 (default: 3.5).
    #[arg(long, value_name = "MILLIMETRES", requires = "eye_blur")]
    #[arg(allow_negative_numbers = true)]
    pupil: Option<f64>,
}

/// What a prescription says of astigmatism.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cylinder {
    dioptres: f64,
    axis_deg: f64,
}

/// The eye, as results describe it.
#[derive(Debug, Serialize)]
pub(super) struct EyeReport {
    cylinder_dioptres: f64,
    axis_deg: f64,
    pupil_mm: f64,
    /// Of the line that a point becomes.
    blur_deg: f64,
}

/// Reads `CYLINDER@AXIS`.
fn parse_cylinder(text: &str) -> anyhow::Result<Cylinder> {
    let expected = "expected dioptres and degrees, as -1.5@180";
    let (dioptres, axis) = text.split_once('@').context(expected)?;
    let number = |word: &str| word.trim().parse::<f64>().context(expected);
    let (dioptres, axis_deg) = (number(dioptres)?, number(axis)?);
    if !(-MOST_DIOPTRES..=MOST_DIOPTRES).contains(&dioptres) {
        bail!("{dioptres} is no cylinder of -{MOST_DIOPTRES} to {MOST_DIOPTRES} dioptres");
    }
    if !(0.0..=360.0).contains(&axis_deg) {
        bail!("{axis_deg} is no axis of 0 to 360 degrees");
    }
    Ok(Cylinder { dioptres, axis_deg })
}

impl EyeArgs {
    /// Refuses eyes that there are not, and what shows none.
    pub(super) fn check(
        &self,
        filter: FilterName,
        others: [(&str, bool); 3],
    ) -> anyhow::Result<()> {
        let [least, most] = PUPILS_MM;
        if let Some(pupil) = self.pupil.filter(|it| !(least..=most).contains(it)) {
            let range = format!("{least} to {most} millimetres");
            bail!(out_of_range("--pupil", pupil, &range));
        }
        if self.eye_blur.is_none() {
            return Ok(());
        }
        if let Some((other, _)) = others.iter().find(|it| it.1) {
            bail!(WrongUsage(format!(
                "--eye-blur: is not drawn with {other}; leave one"
            )));
        }
        let is_ewa = filter == FilterName::Ewa;
        if !is_ewa && filter.of_pass().is_none_or(|it| it.moment().is_none()) {
            bail!(WrongUsage(format!(
                "--eye-blur: {} takes no samples along a line; give --filter auto, anisotropic, \
                 feline or ewa",
                filter.name()
            )));
        }
        Ok(())
    }

    fn pupil_mm(&self) -> f64 {
        self.pupil.unwrap_or(PUPIL_MM)
    }

    /// The eye, where it is asked for.
    pub(super) fn blur(&self) -> Option<EyeBlur> {
        let eye = self.eye_blur?;
        Some(EyeBlur::new(eye.dioptres, eye.axis_deg, self.pupil_mm()))
    }

    pub(super) fn report(&self) -> Option<EyeReport> {
        let (eye, blur) = (self.eye_blur?, self.blur()?);
        let [x, y] = blur.spread();
        Some(EyeReport {
            cylinder_dioptres: eye.dioptres,
            axis_deg: eye.axis_deg,
            pupil_mm: self.pupil_mm(),
            blur_deg: (4.0 * x.hypot(y)).to_degrees(),
        })
    }
}

impl EyeReport {
    pub(super) fn text(&self) -> String {
        let Self {
            cylinder_dioptres,
            axis_deg,
            pupil_mm,
            blur_deg,
        } = self;
        format!(
            "an eye of {cylinder_dioptres} dioptres at {axis_deg}° and a pupil of {pupil_mm} mm: \
             a point is a line of {blur_deg:.3}°\n"
        )
    }
}
