//! Which labelled recordings does a command work on?

use crate::report::output::open_file;
use anyhow::{Context, bail};
use foveal_eval::gaze::labelled::{LabelScreen, read_labelled};
use foveal_eval::gaze::recording::Recording;
use std::io::BufReader;
use std::path::Path;

/// Reads `0.38x0.30m,1024x768,0.67m`: size in metres, size in pixels, distance in metres.
pub(super) fn parse_label_screen(text: &str) -> anyhow::Result<LabelScreen> {
    let wanted = "expected size, pixels and distance as 0.38x0.30m,1024x768,0.67m";
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [size, pixels, distance] = parts[..] else {
        bail!("{wanted}");
    };
    let number = |text: &str, most: f64| {
        let number: f64 = text.trim().parse().context(wanted)?;
        if number > 0.0 && number <= most {
            Ok(number)
        } else {
            bail!("{wanted}; {number} is not in 0 to {most}")
        }
    };
    let pair = |text: &str, most: f64| {
        let (a, b) = text.split_once(['x', 'X']).context(wanted)?;
        Ok::<_, anyhow::Error>([number(a, most)?, number(b, most)?])
    };
    let metres = |text| str::strip_suffix(text, "m").context(wanted);
    Ok(LabelScreen {
        size_m: pair(metres(size)?, 1000.0)?,
        size_px: pair(pixels, 1e6)?,
        distance_m: number(metres(distance)?, 1000.0)?,
    })
}

/// Reads a labelled file.
pub(super) fn read_recording(
    path: &Path,
    screen: Option<&LabelScreen>,
) -> anyhow::Result<Recording> {
    let name = path.display().to_string();
    let file = open_file(path, "labelled recording")?;
    Ok(read_labelled(&name, &mut BufReader::new(file), screen)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_screen_has_a_size_pixels_and_a_distance() {
        let screen = parse_label_screen("0.38x0.30m,1024x768,0.67m").unwrap();
        assert_eq!(screen.size_m, [0.38, 0.30]);
        assert_eq!((screen.size_px, screen.distance_m), ([1024.0, 768.0], 0.67));
        for bad in [
            "",
            "0.38x0.30m",
            "0.38x0.30,1024x768,0.67m",
            "0x1m,2x2,1m",
            "axbm,2x2,1m",
        ] {
            let error = parse_label_screen(bad).unwrap_err().to_string();
            assert!(error.contains("as 0.38x0.30m,1024x768,0.67m"), "{error}");
        }
    }
}
