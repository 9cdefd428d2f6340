//! What does a page ask for when it opens a pack?

use foveal_core::selection::policy::Policy;
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
    /// Draw without a graphics device.
    #[serde(default)]
    pub software: bool,
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
        } = options.screen;
        let measured = diagonal_inches > 0.0 && distance_m > 0.0;
        if !measured || !(diagonal_inches / distance_m).is_finite() {
            return Err("screen: expected inches and metres above 0".to_owned());
        }
        Ok(options)
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
}
