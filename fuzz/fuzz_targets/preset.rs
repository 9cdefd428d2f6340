//! Does any text, read as a preset, panic or pass for one that predicts what no eye does?

#![no_main]

use foveal_core::gaze::head_prediction::HeadMotion;
use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = core::str::from_utf8(data) else {
        return;
    };
    let Ok(preset) = toml::from_str::<HeadGazePreset>(text) else {
        return;
    };
    let Ok(preset) = preset.checked() else { return };
    for velocity in [-1e5, -1.0, 0.0, 300.0] {
        let motion = HeadMotion {
            velocity_deg_s: [velocity; 2],
            ..HeadMotion::default()
        };
        let gaze = preset.predict(&motion).degrees();
        assert!(
            gaze.iter().all(|degrees| degrees.abs() <= 90.0),
            "{preset:?}: {gaze:?}"
        );
    }
    let again = toml::to_string(&preset).expect("a preset is plain text");
    assert_eq!(toml::from_str::<HeadGazePreset>(&again).ok(), Some(preset));
});
