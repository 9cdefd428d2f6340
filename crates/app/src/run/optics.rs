//! What does an eye see of a panel through its optics, by a flat picture of all that they show?

use foveal_core::view::eye_view::EyeView;
use foveal_core::view::panel::distortion::GREEN;
use foveal_core::view::panel::rig::Panel;
use foveal_render::RgbaImage;

/// Pixels of the pictures that lie between what is drawn and what these panels show: of bent ones
/// the flat view in which everything lies that they show.
pub(crate) fn intermediate_pixels(panels: &[Panel]) -> u64 {
    let bent = panels.iter().filter(|panel| !panel.distortion.is_none());
    let pixels = |panel: &Panel| panel.reach().size.map(u64::from).iter().product::<u64>();
    bent.map(pixels).sum()
}

/// The picture on a panel, of what its flat view shows: itself where nothing is bent.
pub(crate) fn on_panel(panel: &Panel, flat: RgbaImage) -> RgbaImage {
    if panel.distortion.is_none() {
        return flat;
    }
    let reach = panel.reach();
    let mut seen = RgbaImage::black(panel.view.size);
    let channels = match panel.distortion.parts_colours() {
        true => [0, 1, 2],
        false => [GREEN; 3],
    };
    for y in 0..seen.size[1] {
        for x in 0..seen.size[0] {
            let place = [x, y].map(|at| f64::from(at) + 0.5);
            let mut pixel = seen.pixel([x, y]);
            for (k, channel) in channels.into_iter().enumerate() {
                let bent = panel.distortion.ideal(&panel.view, place, channel);
                // What is unlit stays black.
                if let Some(bent) = bent {
                    pixel[k] = sampled(&flat, in_view(&panel.view, &reach, bent.place), k);
                }
            }
            seen.set_pixel([x, y], pixel);
        }
    }
    seen
}

/// The place of one view, in pixels, that shows what a place of another shows, where both look
/// along the same axes.
fn in_view(own: &EyeView, other: &EyeView, place: [f64; 2]) -> [f64; 2] {
    let pitch = |view: &EyeView| {
        let f = view.field;
        let across = [f.left + f.right, f.up + f.down];
        [0, 1].map(|k| across[k] / f64::from(view.size[k]))
    };
    let edge = |view: &EyeView| [view.field.left, view.field.up];
    let [own_pitch, other_pitch] = [own, other].map(pitch);
    let [own_edge, other_edge] = [own, other].map(edge);
    [0, 1].map(|k| (place[k] * own_pitch[k] - own_edge[k] + other_edge[k]) / other_pitch[k])
}

/// One channel of a picture at a place, linear between pixels.
fn sampled(image: &RgbaImage, place: [f64; 2], channel: usize) -> u8 {
    let [x, y] = [0, 1].map(|k| {
        let last = f64::from(image.size[k] - 1);
        let at = (place[k] - 0.5).clamp(0.0, last);
        let first = (at as u32).min(image.size[k].saturating_sub(2));
        (first, at - f64::from(first))
    });
    let code = |dx: u32, dy: u32| {
        let at = [x.0 + dx, y.0 + dy];
        let inside = [0, 1].map(|k| at[k].min(image.size[k] - 1));
        f64::from(image.pixel(inside)[channel])
    };
    let row = |dy| code(0, dy) + (code(1, dy) - code(0, dy)) * x.1;
    (row(0) + (row(1) - row(0)) * y.1).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::axes::Axes;
    use foveal_core::view::eye_view::Field;
    use foveal_core::view::panel::distortion::Distortion;
    use foveal_core::view::panel::lens::Bulge;
    use foveal_core::view::surface::Eye;
    use glam::DVec3;

    /// A picture whose codes tell the tangents of its places.
    fn told(view: &EyeView) -> RgbaImage {
        let mut image = RgbaImage::black(view.size);
        for y in 0..view.size[1] {
            for x in 0..view.size[0] {
                let ray = view.ray([x, y].map(|at| f64::from(at) + 0.5));
                let code = |tangent: f64| (128.0 + 100.0 * tangent).round() as u8;
                let [r, d] = [ray.x, -ray.y].map(|t| code(t / -ray.z));
                image.set_pixel([x, y], [r, d, 7, 255]);
            }
        }
        image
    }

    #[test]
    fn a_bent_panel_shows_in_every_pixel_what_lies_along_its_ray() {
        let view = EyeView {
            position: DVec3::ZERO,
            axes: Axes::FRONT,
            field: Field::symmetric([0.5, 0.4]),
            size: [100, 80],
            eye: Eye::Left,
        };
        let mut panel = Panel::flat("bent", view);
        let flat = told(&view);
        assert_eq!(on_panel(&panel, flat.clone()).pixels, flat.pixels);
        assert_eq!(intermediate_pixels(std::slice::from_ref(&panel)), 0);
        for height in [0.3, -0.2] {
            panel.distortion = Distortion::Bulge(Bulge { height });
            let reach = panel.reach();
            assert!(intermediate_pixels(std::slice::from_ref(&panel)) >= 8000);
            let seen = on_panel(&panel, told(&reach));
            for (x, y) in [(50, 40), (20, 10), (0, 79), (70, 33)] {
                let ray = panel.ray_at([x, y].map(|at| f64::from(at) + 0.5), GREEN);
                let ray = ray.unwrap().ray;
                let expected = [ray.x, -ray.y].map(|t| 128.0 + 100.0 * t / -ray.z);
                let found = seen.pixel([x, y]);
                for k in 0..2 {
                    let off = (f64::from(found[k]) - expected[k]).abs();
                    assert!(off <= 1.5, "{height} {x},{y}: {found:?} {expected:?}");
                }
            }
        }
    }
}
