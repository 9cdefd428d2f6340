//! What does a generated world look like through any pixel, panel or source?
//!
//! Every picture here is drawn from the world itself, never from a picture of it.

use super::gratings::Gratings;
use super::ray::Ray;
use super::world::World;
use super::{GeneratedScene, SEGMENT, objects, seconds_of};
use crate::parallel::in_parallel;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::panel::placement::Placement;
use foveal_core::view::panel::rig::Panel;
use glam::DVec3;

/// Pixels of the panorama whose finest rings the valley has: those of a source of 8 pixels a
/// degree, so that one of few megapixels can hold them.
const VALLEY: [u32; 2] = [2880, 1440];

/// Cycles of every wave a second.
const WAVE_SPEED: f64 = 0.5;

/// A world that is redrawn for each look at it.
#[derive(Clone, Debug)]
pub struct GeneratedWorld(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Valley,
    Gratings(Gratings),
}

/// 8-bit red, green and blue, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawnRgb {
    /// Columns and rows.
    pub size: [u32; 2],
    /// A triple a pixel.
    pub rgb: Vec<[u8; 3]>,
}

/// Where a place of a picture looks in the light of a channel; `None` where it is unlit.
type TowardsPixel<'a> = dyn Fn([f64; 2], usize) -> Option<DVec3> + Sync + 'a;

impl GeneratedWorld {
    /// The world of [`GeneratedScene`].
    #[must_use]
    pub fn valley() -> Self {
        Self(Kind::Valley)
    }

    /// The seed whose finest waves run away from who looks straight ahead, so that a source of few
    /// pixels still holds them there.
    pub const FRONTAL: u32 = 1891;

    /// 24 plane waves over direction, of 5 to 240 cycles a radian and of power 1/f.
    #[must_use]
    pub fn gratings(seed: u32) -> Self {
        Self(Kind::Gratings(Gratings::new(seed)))
    }

    /// What a view shows in frame `number`.
    ///
    /// ```
    /// use foveal_core::view::axes::Axes;
    /// use foveal_core::view::eye_view::{EyeView, Field};
    /// use foveal_media::generate::placed::GeneratedWorld;
    ///
    /// let view = EyeView {
    ///     position: Default::default(),
    ///     axes: Axes::FRONT,
    ///     field: Field::symmetric([0.5, 0.5]),
    ///     size: [16, 8],
    ///     eye: Default::default(),
    /// };
    /// assert_eq!(GeneratedWorld::gratings(0).seen_by(0, &view).rgb.len(), 128);
    /// ```
    #[must_use]
    pub fn seen_by(&self, number: u64, view: &EyeView) -> DrawnRgb {
        self.drawn(number, view.size, false, &|place, _| Some(view.ray(place)))
    }

    /// What a panel shows of it through its optics, as the eye sees it, where the world is painted
    /// on what `placement` describes: infinitely far, or near an eye that is off the middle.
    #[must_use]
    pub fn on_panel(&self, number: u64, panel: &Panel, placement: &Placement) -> DrawnRgb {
        let parts = panel.distortion.parts_colours();
        self.drawn(number, panel.view.size, parts, &|place, channel| {
            let ray = panel.ray_at(place, channel)?.ray;
            match placement.eye == DVec3::ZERO {
                true => Some(ray),
                false => placement.met(ray).map(|(met, _)| met),
            }
        })
    }

    /// A source of `size` pixels that shows it before the eyes, without seam where panels look.
    #[must_use]
    pub fn placed(&self, number: u64, placement: &Placement, size: [u32; 2]) -> DrawnRgb {
        self.drawn(number, size, false, &|place, _| {
            placement.ray_from_source(place, size)
        })
    }

    fn drawn(
        &self,
        number: u64,
        size: [u32; 2],
        parts_colours: bool,
        looking: &TowardsPixel<'_>,
    ) -> DrawnRgb {
        let seconds = seconds_of(number);
        let valley = matches!(self.0, Kind::Valley)
            .then(|| World::new(seconds, GeneratedScene::panorama(VALLEY).pixel(), 0));
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let channels: &[usize] = if parts_colours { &[0, 1, 2] } else { &[1] };
        let rows = in_parallel(cores, size[1] as usize, |y| {
            let mut line = vec![[0; 3]; size[0] as usize];
            for channel in channels {
                for (start, pixels) in line.chunks_mut(SEGMENT).enumerate() {
                    let place = |k: usize| [(start * SEGMENT + k) as f64 + 0.5, y as f64 + 0.5];
                    let rays: Vec<_> = (0..pixels.len())
                        .map(|k| looked(looking, place(k), *channel))
                        .collect();
                    let codes = match (&self.0, &valley) {
                        (Kind::Gratings(waves), _) => {
                            let moved = WAVE_SPEED * f64::from(seconds);
                            by_waves(waves, &rays, moved)
                        }
                        (Kind::Valley, Some(world)) => by_world(world, &rays),
                        (Kind::Valley, None) => Vec::new(),
                    };
                    for (pixel, code) in pixels.iter_mut().zip(codes) {
                        match parts_colours {
                            true => pixel[*channel] = code[*channel],
                            false => *pixel = code,
                        }
                    }
                }
            }
            line
        });
        DrawnRgb {
            size,
            rgb: rows.concat(),
        }
    }
}

/// The direction of a place and its ray, as wide as the mean of its steps to the right and down: a
/// source before oblique panels has pixels that are much longer than wide.
fn looked(looking: &TowardsPixel<'_>, place: [f64; 2], channel: usize) -> Option<(DVec3, Ray)> {
    let at = |x: f64, y: f64| Some(looking([place[0] + x, place[1] + y], channel)?.normalize());
    let direction = at(0.0, 0.0)?;
    let step = |x: f64, y: f64| at(x, y).map_or(0.0, |to| (to - direction).length() * 2.0);
    let [x, y, z] = direction.to_array().map(|k| k as f32);
    let ray = Ray {
        direction: [x, y, z],
        yaw: libm::atan2f(x, -z),
        pitch: libm::asinf(y.clamp(-1.0, 1.0)),
        pixel: (step(0.5, 0.0) * step(0.0, 0.5)).sqrt() as f32,
    };
    Some((direction, ray))
}

fn codes([r, g, b]: [f32; 3]) -> [u8; 3] {
    [r, g, b].map(|k| (k.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
}

fn by_waves(waves: &Gratings, rays: &[Option<(DVec3, Ray)>], moved: f64) -> Vec<[u8; 3]> {
    let colour =
        |(direction, ray): &(DVec3, Ray)| codes(waves.colour(direction.to_array(), ray, moved));
    rays.iter()
        .map(|it| it.as_ref().map_or([0; 3], colour))
        .collect()
}

fn by_world(world: &World, rays: &[Option<(DVec3, Ray)>]) -> Vec<[u8; 3]> {
    let lit = || rays.iter().flatten();
    let Some(middle) = lit().nth(lit().count() / 2).map(|(_, ray)| ray.direction) else {
        return vec![[0; 3]; rays.len()];
    };
    let within = lit()
        .map(|(_, ray)| objects::dot(middle, ray.direction))
        .fold(1.0, f32::min);
    let near = world.near(middle, within);
    rays.iter()
        .map(|it| {
            it.as_ref()
                .map_or([0; 3], |(_, ray)| codes(world.colour(ray, &near)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::axes::Axes;
    use foveal_core::view::eye_view::Field;
    use foveal_core::view::panel::placement::SourceProjection;
    use foveal_core::view::surface::Eye;

    fn view(size: [u32; 2]) -> EyeView {
        EyeView {
            position: DVec3::ZERO,
            axes: Axes::FRONT,
            field: Field::symmetric([0.6, 0.45]),
            size,
            eye: Eye::Left,
        }
    }

    #[test]
    fn a_source_that_lies_where_a_view_looks_shows_what_the_view_shows() {
        let view = view([120, 90]);
        let plane = [0.6, 0.6, 0.45, 0.45];
        let plane = Placement::new(SourceProjection::Plane, Axes::FRONT, plane);
        for world in [GeneratedWorld::valley(), GeneratedWorld::gratings(3)] {
            let seen = world.seen_by(5, &view);
            assert_eq!(seen, world.placed(5, &plane, [120, 90]));
            let panel = Panel::flat("all", view);
            assert_eq!(seen, world.on_panel(5, &panel, &plane));
        }
    }

    #[test]
    fn gratings_are_of_one_mean_differ_by_seed_and_move() {
        let view = view([160, 120]);
        let of = |seed, frame| GeneratedWorld::gratings(seed).seen_by(frame, &view).rgb;
        let first = of(0, 0);
        assert_eq!(first, of(0, 0));
        assert_ne!(first, of(1, 0));
        assert_ne!(first, of(0, 1));
        let mean = first.iter().map(|it| f64::from(it[1])).sum::<f64>() / first.len() as f64;
        assert!((mean - 184.0).abs() < 16.0, "{mean}");
    }
}
