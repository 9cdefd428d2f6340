//! Where does the seed put its source, what are its derivatives, and what do its maps hold?
//!
//! Strege 2009, the study of tiled displays; see docs/papers.md, rows "tiled displays".

use super::pixel_map::{MappedPixel, PixelMap};
use super::placement::{Placement, SourceProjection};
use crate::view::axes::Axes;
use glam::DVec3;

/// A rectangle before the head, square to it and centred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeedPlane {
    /// Where it is cut: z of the farthest corner. It cancels out of every place.
    pub depth: f64,
    /// Half its width and height at that depth, before and after one grows to the aspect.
    pub tight: [f64; 2],
    /// After.
    pub half: [f64; 2],
}

impl SeedPlane {
    /// Round corners of panels at unit distance, with an aspect; `None` where one lies at 90° or
    /// more from the head's forward.
    #[must_use]
    pub fn round(corners: &[DVec3], aspect: Option<f64>) -> Option<Self> {
        if corners.is_empty() || corners.iter().any(|it| it.z >= -1e-9) {
            return None;
        }
        let depth = corners.iter().map(|it| it.z).fold(0.0, f64::min);
        let most = |part: fn(&DVec3) -> f64| {
            let all = corners.iter().map(|it| (part(it) * depth / it.z).abs());
            all.fold(0.0, f64::max)
        };
        let tight = [most(|it| it.x), most(|it| it.y)];
        let [x, y] = tight;
        let half = match aspect {
            Some(aspect) if x / y < aspect => [aspect * y, y],
            Some(aspect) => [x, x / aspect],
            None => tight,
        };
        Some(Self { depth, tight, half })
    }

    /// Tangents of its half fields of view.
    #[must_use]
    pub fn tangents(&self) -> [f64; 2] {
        self.half.map(|half| half / -self.depth)
    }

    /// Where it lies.
    #[must_use]
    pub fn placement(&self) -> Placement {
        let [x, y] = self.tangents();
        Placement::new(SourceProjection::Plane, Axes::FRONT, [x, x, y, y])
    }
}

/// A pixel's place, with the means over opposite edges of the differences between the source places
/// of its corners in place of derivatives: Strege 2009, section 3.2.6.
#[must_use]
pub fn edge_means(map: &PixelMap<'_>, pixel: [u32; 2]) -> Option<MappedPixel> {
    let [x, y] = pixel.map(f64::from);
    let corner = |dx: f64, dy: f64| Some(map.at([x + dx, y + dy])?.place);
    let (tl, tr) = (corner(0.0, 0.0)?, corner(1.0, 0.0)?);
    let (bl, br) = (corner(0.0, 1.0)?, corner(1.0, 1.0)?);
    Some(MappedPixel {
        place: map.of_pixel(pixel)?.place,
        jacobian: [0, 1].map(|k| {
            [
                ((tr[k] - tl[k]) + (br[k] - bl[k])) / 2.0,
                ((bl[k] - tl[k]) + (br[k] - tr[k])) / 2.0,
            ]
        }),
    })
}

/// What the seed's maps hold of a pixel: Strege 2009, section 3.2.5.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeedTexel {
    /// Whole source pixels of column and row.
    pub whole: [u16; 2],
    /// Their 65,536ths.
    pub fraction: [u16; 2],
    /// du/dx, du/dy, dv/dx, dv/dy in steps of [`CHANGE_STEP`].
    pub change: [i8; 4],
}

/// Source pixels of a step of an 8-bit derivative: up to 4 either way, where the seed names no
/// range.
pub const CHANGE_STEP: f64 = 4.0 / 127.0;

impl SeedTexel {
    /// A pixel's texel; 0 of a pixel that shows nothing, the nearest of what lies outside.
    #[must_use]
    pub fn of(map: &PixelMap<'_>, pixel: [u32; 2]) -> Self {
        let Some(found) = edge_means(map, pixel) else {
            return Self::default();
        };
        let fixed = found
            .place
            .map(|it| libm::round((it * 65536.0).clamp(0.0, 4_294_967_295.0)) as u32);
        let [[ux, uy], [vx, vy]] = found.jacobian;
        Self {
            whole: fixed.map(|it| (it >> 16) as u16),
            fraction: fixed.map(|it| (it & 0xffff) as u16),
            change: [ux, uy, vx, vy]
                .map(|it| libm::round(it / CHANGE_STEP).clamp(-127.0, 127.0) as i8),
        }
    }

    /// The place that it holds, in source pixels.
    #[must_use]
    pub fn place(&self) -> [f64; 2] {
        [0, 1].map(|k| f64::from(self.whole[k]) + f64::from(self.fraction[k]) / 65536.0)
    }
}

/// Panels that a device of `texels` a second warps at 60 frames a second, as the seed counts: 8
/// texels a fetch, so many fetches a pixel; Strege 2009, section 4.3.
#[must_use]
pub fn panels_by_fill_rate(texels: f64, panel_pixels: f64, fetches: f64) -> f64 {
    texels / (panel_pixels * 8.0 * fetches * 60.0)
}
