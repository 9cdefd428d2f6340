//! Which colour stands for a level?

use foveal_core::content::video::bytes::description::Description;

/// Red (finest), orange, yellow, sky, blue (coarsest): the ramp of `shaders/overlay.wgsl`.
const RAMP: [[f32; 3]; 5] = [
    [0.843, 0.098, 0.110],
    [0.992, 0.682, 0.380],
    [1.0, 1.0, 0.749],
    [0.671, 0.851, 0.914],
    [0.173, 0.482, 0.714],
];

/// Red, green and blue of `level` where the coarsest is `coarsest`, as the heat map has them.
pub(crate) fn of_level(level: u8, coarsest: u8) -> [u8; 3] {
    let place = f32::from(level) / f32::from(coarsest.max(1)) * 4.0;
    let low = (place as usize).min(3);
    let part = place - low as f32;
    [0, 1, 2].map(|k| {
        let mixed = RAMP[low][k] * (1.0 - part) + RAMP[low + 1][k] * part;
        (mixed * 255.0).round() as u8
    })
}

/// The same as CSS writes it.
pub(crate) fn css_of_level(level: u8, coarsest: u8) -> String {
    let [r, g, b] = of_level(level, coarsest);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Which colour is which level of a pack, as HTML.
pub(crate) fn level_key(about: &Description) -> String {
    let coarsest = about.levels - 1;
    let item = |level: u8| {
        let scale = u64::from(about.ratio).pow(u32::from(level));
        let density = match scale {
            1 => "full density".to_owned(),
            scale => format!("1/{scale}"),
        };
        let colour = css_of_level(level, coarsest);
        format!("<li><i style=\"background:{colour}\"></i>level {level}, {density}</li>")
    };
    let items: String = (0..about.levels).map(item).collect();
    format!("<ul class=\"key\">{items}</ul>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finest_level_is_red_and_the_coarsest_blue() {
        assert_eq!(css_of_level(0, 4), "#d7191c");
        assert_eq!(css_of_level(4, 4), "#2c7bb6");
        assert_eq!(css_of_level(0, 0), "#d7191c");
    }
}
