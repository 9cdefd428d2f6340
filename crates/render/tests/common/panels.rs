//! Which panels, sources and placements do the tests fill?

use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::panel::eye_blur::EyeBlur;
use foveal_core::view::panel::placement::{Placement, SourceProjection};
use foveal_core::view::panel::rig::{Panel, axes_from_seed_angles};
use foveal_core::view::surface::Eye;
use foveal_render::warp::{PanelOnSource, SourceTexture, WarpFilter, WarpPlan, WarpStyle, Warper};
use foveal_render::{Gpu, RgbaImage};

/// A flat panel turned by degrees of roll, pitch (down) and yaw, of a width and height at unit
/// distance.
pub fn panel(id: &str, angles: [f64; 3], [w, h]: [f64; 2], size: [u32; 2]) -> Panel {
    let [roll, pitch, yaw] = angles.map(f64::to_radians);
    let view = EyeView {
        position: Default::default(),
        axes: axes_from_seed_angles(roll, pitch, yaw),
        field: Field::symmetric([w / 2.0, h / 2.0]),
        size,
        eye: Eye::Left,
    };
    Panel::flat(id, view)
}

/// Three panels side by side, 35 degrees apart.
pub fn three(size: [u32; 2]) -> Vec<Panel> {
    let named = [("L", -35.0), ("C", 0.0), ("R", 35.0)];
    named
        .map(|(id, yaw)| panel(id, [0.0, 0.0, yaw], [0.9, 0.675], size))
        .into()
}

/// The upper left panel of twelve.
pub fn upper_left(size: [u32; 2]) -> Panel {
    let angles = [17.845_208, -11.255_307, -58.772_647];
    panel(
        "r0c0",
        angles,
        [0.727_940_468_532_404_7, 0.545_955_351_399_305_3],
        size,
    )
}

/// The plane of seed 002 before all of `three`, whose aspect is 4:3.
pub fn seed_plane() -> Placement {
    let [x, y] = [1.679_364_055_042_270_4, 1.259_523_041_281_703];
    Placement::new(SourceProjection::Plane, Axes::FRONT, [x, x, y, y])
}

/// That before all of twelve.
pub fn seed_plane_of_twelve() -> Placement {
    let [x, y] = [5.997_038_426_059_634_6, 4.497_778_819_544_726];
    Placement::new(SourceProjection::Plane, Axes::FRONT, [x, x, y, y])
}

/// A curved source before all of `three`.
pub fn curved(projection: SourceProjection) -> Placement {
    Placement::new(projection, Axes::FRONT, [1.1, 1.1, 0.7, 0.7])
}

/// The plan of panels side by side in the atlas, before all of a source.
pub fn plan_of(panels: &[Panel], placement: &Placement, source: [u32; 2]) -> WarpPlan {
    WarpPlan::new(&side_by_side(panels, placement, source))
}

/// The same, as an eye sees them.
pub fn blurred_plan_of(
    panels: &[Panel],
    placement: &Placement,
    source: [u32; 2],
    eye: &EyeBlur,
) -> WarpPlan {
    let placed = side_by_side(panels, placement, source);
    WarpPlan::new(&placed).seen_blurred(&placed, eye)
}

fn side_by_side<'a>(
    panels: &'a [Panel],
    placement: &'a Placement,
    source: [u32; 2],
) -> Vec<PanelOnSource<'a>> {
    let mut x = 0;
    let mut placed = Vec::new();
    for panel in panels {
        placed.push(PanelOnSource {
            panel,
            placement,
            part: [0, 0, source[0], source[1]],
            origin: [x, 0],
        });
        x += panel.sent_size()[0];
    }
    placed
}

/// Waves of many lengths, in every colour its own.
pub fn wavy(size: [u32; 2]) -> RgbaImage {
    painted(size, |x, y| {
        let wave = |length: f64, turn: f64| {
            let along = x * turn.cos() + y * turn.sin();
            (along * std::f64::consts::TAU / length).sin()
        };
        [
            128.0 + 50.0 * wave(61.0, 0.3) + 30.0 * wave(11.0, 1.4) + 20.0 * wave(5.0, 2.3),
            128.0 + 60.0 * wave(47.0, 2.0) + 30.0 * wave(9.0, 0.4),
            128.0 + 60.0 * wave(83.0, 1.0) + 30.0 * wave(13.0, 2.8),
        ]
    })
}

/// Thin dark lines, every 12 texels, on white.
pub fn lines(size: [u32; 2]) -> RgbaImage {
    painted(size, |x, y| {
        let is_line = x.rem_euclid(12.0) < 1.0 || y.rem_euclid(12.0) < 1.0;
        [if is_line { 0.0 } else { 255.0 }; 3]
    })
}

/// A picture by a function of the column and row, from 0 to 255.
pub fn painted(size: [u32; 2], colour: impl Fn(f64, f64) -> [f64; 3]) -> RgbaImage {
    let mut image = RgbaImage::black(size);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let [r, g, b] = colour(f64::from(x), f64::from(y)).map(|k| (k + 0.5) as u8);
            image.set_pixel([x, y], [r, g, b, 255]);
        }
    }
    image
}

/// Peak signal-to-noise ratio of codes, in dB.
pub fn psnr(a: &RgbaImage, b: &RgbaImage) -> f64 {
    assert_eq!(a.size, b.size);
    let pairs = a.pixels.chunks(4).zip(b.pixels.chunks(4));
    let squares: f64 = pairs
        .flat_map(|(a, b)| (0..3).map(move |k| f64::from(a[k]) - f64::from(b[k])))
        .map(|apart| apart * apart)
        .sum();
    let mean = squares / (a.pixels.len() / 4 * 3) as f64;
    10.0 * (255.0 * 255.0 / mean).log10()
}

/// A filter, without painting where it takes several samples.
pub fn style(filter: WarpFilter) -> WarpStyle {
    WarpStyle {
        filter,
        paints: false,
    }
}

/// The atlas that the pass draws.
pub fn on_gpu(gpu: &Gpu, picture: &RgbaImage, plan: &WarpPlan, style: &WarpStyle) -> RgbaImage {
    let warper = Warper::new(gpu);
    let source = SourceTexture::new(gpu, picture.size, style.filter.reads_levels()).unwrap();
    source.write(gpu, picture).unwrap();
    let loaded = warper.load(plan).unwrap();
    warper.read(&loaded, &source, style).wait(gpu).unwrap()
}
