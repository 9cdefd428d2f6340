//! Which colour of a fire stands for a share?

/// Black, violet, red, orange, light yellow.
const FIRE: [[f32; 3]; 5] = [
    [0.0, 0.0, 0.02],
    [0.32, 0.07, 0.48],
    [0.75, 0.21, 0.38],
    [0.98, 0.55, 0.23],
    [0.99, 0.98, 0.75],
];

/// Red, green and blue of a share from 0, black, to 1, light yellow.
pub(crate) fn fire(share: f32) -> [u8; 3] {
    let place = share.clamp(0.0, 1.0) * 4.0;
    let low = (place as usize).min(3);
    let part = place - low as f32;
    let mixed = [0, 1, 2].map(|k| FIRE[low][k] * (1.0 - part) + FIRE[low + 1][k] * part);
    mixed.map(|part| (part * 255.0).round() as u8)
}
