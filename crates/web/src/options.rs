//! What does a page ask for when it opens a pack?

use foveal_core::content::policy::Policy;
use foveal_core::content::policy::asked::{Detail, SLOPES, Target};
use foveal_core::view::surface::Screen;
use serde::Deserialize;

/// The options of `web/src/engine/api.ts` that matter here.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Options {
    /// Name of the pack, for the session log.
    pub name: String,
    /// How levels are chosen.
    pub policy: Policy,
    /// The score that levels are chosen for.
    #[serde(default)]
    pub target: Option<Target>,
    /// Of `acuity`: degrees by which the smallest pixel that an eye resolves grows with each
    /// degree of eccentricity.
    #[serde(default)]
    pub slope: Option<f64>,
    /// Whether neighbours of what is looked at are fetched with it.
    #[serde(default)]
    pub coarse: bool,
    /// Columns and rows of device pixels.
    pub size: [u32; 2],
    /// Device pixels of the whole screen.
    pub screen_size: [u32; 2],
    /// The screen as a person can measure it.
    #[serde(default)]
    pub screen: Screen,
    /// Larger side of a sphere's view before zooming, in degrees.
    #[serde(default = "usual_field")]
    pub field_deg: f64,
    /// Begin paused.
    #[serde(default)]
    pub paused: bool,
    /// Stay at the end.
    #[serde(default)]
    pub once: bool,
    /// Keep a session log.
    #[serde(default)]
    pub log: bool,
    /// Only show what comes first: no side table is fetched for it.
    #[serde(default)]
    pub poster: bool,
}

/// As `foveal view --fov`.
fn usual_field() -> f64 {
    100.0
}

impl Options {
    /// Reads the JSON of a page; says what is wrong with it.
    pub fn parse(json: &str) -> Result<Self, String> {
        let options: Self = serde_json::from_str(json).map_err(|error| error.to_string())?;
        if !(1.0..=170.0).contains(&options.field_deg) {
            return Err(format!(
                "fieldDeg: found {}, expected 1 to 170",
                options.field_deg
            ));
        }
        let Screen {
            diagonal_inches,
            distance_m,
            ..
        } = options.screen;
        let measured = diagonal_inches > 0.0 && distance_m > 0.0;
        if !measured || !(diagonal_inches / distance_m).is_finite() {
            return Err("screen: expected inches and metres above 0".to_owned());
        }
        options.detail()?;
        Ok(options)
    }

    /// How much detail is asked for; says what is wrong with it.
    pub fn detail(&self) -> Result<Detail, String> {
        match (self.target, self.slope) {
            (Some(_), Some(_)) => {
                Err("target and slope choose the same; give one of them".to_owned())
            }
            (Some(target), None) => Ok(Detail::Target(target.checked()?)),
            (None, Some(slope)) if SLOPES.contains(&slope) => Ok(Detail::Slope(slope)),
            (None, Some(slope)) => Err(format!("slope: found {slope}, expected 0 to 1")),
            (None, None) => Ok(Detail::Usual),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_is_as_in_the_window() {
        let text = r#"{"name":"a","policy":"viewport","size":[9,8],"screenSize":[90,80]}"#;
        let options = Options::parse(text).unwrap();
        assert_eq!(options.screen, Screen::default());
        assert_eq!((options.field_deg, options.paused), (100.0, false));
        let narrow = text.replace("\"size\"", "\"fieldDeg\":0,\"size\"");
        assert!(Options::parse(&narrow).is_err());
    }

    #[test]
    fn a_score_or_a_slope_is_asked_for_and_never_both() {
        let detail = |more: &str| {
            let text = r#"{"name":"a","policy":"acuity","size":[9,8],"screenSize":[90,80]MORE}"#;
            Options::parse(&text.replace("MORE", more))?.detail()
        };
        assert_eq!(detail(""), Ok(Detail::Usual));
        assert_eq!(detail(r#","target":9"#), Ok(Detail::Target(Some(9.0))));
        assert_eq!(detail(r#","target":"none""#), Ok(Detail::Target(None)));
        assert_eq!(detail(r#","slope":0.011"#), Ok(Detail::Slope(0.011)));
        for wrong in [
            r#","target":9,"slope":0.01"#,
            r#","target":10"#,
            r#","target":"high""#,
            r#","slope":-0.1"#,
        ] {
            assert!(detail(wrong).is_err(), "{wrong}");
        }
    }
}
