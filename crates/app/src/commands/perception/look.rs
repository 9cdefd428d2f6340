//! How is a picture looked at, and by which model of the eye?

use crate::options::perception::{PerceptionOptions, read_acuity};
use crate::options::policy::parse_pair;
use crate::report::output::out_of_range;
use crate::report::picture_file::{RgbPicture, read_png};
use anyhow::bail;
use clap::Args;
use foveal_core::perception::eye::Gaze;
use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::measures::pyramid::bands_of;
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use std::path::{Path, PathBuf};

/// Who looks at a picture.
#[derive(Clone, Debug, Args)]
pub(crate) struct LookOptions {
    /// Where the eye looks: pixels of the picture, x to the right and y down.
    #[arg(long, value_name = "X,Y", value_parser = parse_pair, allow_hyphen_values = true)]
    gaze: [f64; 2],
    /// How wide the picture is before the eye, in degrees.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    fov: f64,
    /// Standard deviation of the gaze, in degrees.
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    spread: f64,
    /// What the eye resolves, in the place of the model's cells: CSV with ecc_deg and mar_deg or
    /// mar_arcmin, the smallest pixel that can be resolved.
    #[arg(long, value_name = "FILE.csv")]
    acuity: Option<PathBuf>,
    #[command(flatten)]
    perception: PerceptionOptions,
}

impl LookOptions {
    pub(crate) fn parameters(&self) -> anyhow::Result<Parameters> {
        let acuity = self.acuity.as_deref().map(read_acuity).transpose()?;
        self.perception.parameters(acuity)
    }

    /// The eye before a picture of `size`.
    pub(crate) fn onlooker(&self, size: [u32; 2], state: EyeState) -> anyhow::Result<Onlooker> {
        if !(1.0..=170.0).contains(&self.fov) {
            bail!(out_of_range("--fov", self.fov, "1 to 170 degrees"));
        }
        if !(0.0..=90.0).contains(&self.spread) {
            bail!(out_of_range("--spread", self.spread, "0 to 90 degrees"));
        }
        let inside = |at: f64, side: u32| (0.0..=f64::from(side)).contains(&at);
        if !(inside(self.gaze[0], size[0]) && inside(self.gaze[1], size[1])) {
            let found = format!("{},{}", self.gaze[0], self.gaze[1]);
            let range = format!("a place in the picture of {}x{} pixels", size[0], size[1]);
            bail!(out_of_range("--gaze", found, &range));
        }
        let view = EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field: Field::across(Radians::from_degrees(self.fov), size),
            size,
            eye: Default::default(),
        };
        Ok(Onlooker {
            view,
            gaze: Gaze {
                direction: view.ray(self.gaze).normalize(),
                spread: Radians::from_degrees(self.spread),
            },
            state,
        })
    }

    pub(crate) fn gaze(&self) -> [f64; 2] {
        self.gaze
    }

    pub(crate) fn fov(&self) -> f64 {
        self.fov
    }
}

/// A picture that is large enough to have a frequency band.
pub(crate) fn read_picture(path: &Path) -> anyhow::Result<RgbPicture> {
    let picture = read_png(path)?;
    let [w, h] = picture.size;
    if bands_of(picture.size) == 0 {
        let name = path.display();
        bail!("{name}: {w}x{h} pixels hold no frequency band; give a picture of 4x4 or more");
    }
    Ok(picture)
}
