//! Which triangle is in front at each pixel, seen from one side?
//!
//! Orthographic, a sample in the middle of each pixel; corners are rounded to 1/256 of a pixel, and
//! a pixel on a common edge belongs to one of two triangles. Places are whole numbers, and light is
//! reckoned by what every machine rounds alike.

use super::lit::{LitSurface, LitTriangle};
use std::ops::Range;

/// Parts of a pixel that corners are rounded to.
const PARTS: i64 = 256;
/// Most pixels from the middle of a raster to a place, so that areas are numbers of 64 bits.
pub(super) const FARTHEST: f64 = (1 << 20) as f64;

/// From where an object is seen: along an axis of its own space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Side {
    /// 0 to 2: x, y, z.
    axis: usize,
    /// Whether the eye is on the axis' positive side.
    is_positive: bool,
}

impl Side {
    /// All six.
    pub(super) const ALL: [Self; 6] = [
        Self::new(0, true),
        Self::new(0, false),
        Self::new(1, true),
        Self::new(1, false),
        Self::new(2, true),
        Self::new(2, false),
    ];

    const fn new(axis: usize, is_positive: bool) -> Self {
        Self { axis, is_positive }
    }

    /// The axes to the right and upwards.
    pub(super) fn across(self) -> [usize; 2] {
        // Right times up is towards the eye.
        let [u, v] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        if self.is_positive { [u, v] } else { [v, u] }
    }

    /// How much of a vector on the grid points to the eye.
    fn towards(self, vector: [i64; 3]) -> i64 {
        match self.is_positive {
            true => vector[self.axis],
            false => -vector[self.axis],
        }
    }

    /// Twice the area of a triangle as it is seen, on the grid; 0 where it is not seen.
    pub(super) fn area(self, surface: &LitSurface, triangle: &LitTriangle) -> i64 {
        let towards = self.towards(triangle.face);
        let is_seen = towards > 0 || surface.two_sided;
        if is_seen { towards.abs() } else { 0 }
    }
}

/// Draws what is seen of a surface.
pub(super) struct Raster<'a> {
    pub surface: &'a LitSurface,
    /// The place on the grid that is at the corner of four pixels.
    pub middle: [f64; 3],
    /// Pixels a step of the grid. No place is more than [`FARTHEST`] pixels from the middle.
    pub pixels_per_step: f64,
}

impl Raster<'_> {
    /// The pixel in which the middle of a triangle lies.
    pub(super) fn pixel(&self, side: Side, triangle: &LitTriangle) -> [i64; 2] {
        let along = |axis: usize| -> i64 {
            let places = triangle.places.iter();
            places.map(|place| self.parts(axis, place[axis])).sum()
        };
        side.across().map(|axis| along(axis).div_euclid(3 * PARTS))
    }

    /// The luminance of each pixel in cd/m², row by row; 0 where nothing is.
    pub(super) fn picture(
        &self,
        side: Side,
        window: Window,
        triangles: &[LitTriangle],
    ) -> Vec<f64> {
        let across = side.across();
        let reach = [0, 1].map(|k| self.reach(across[k], window.low[k], window.end(k)));
        let mut picture = SidePicture::new(window);
        for triangle in triangles {
            let is_near = |k: usize| {
                let (axis, [low, high]) = (across[k], reach[k]);
                triangle.low[axis] <= high && triangle.high[axis] >= low
            };
            if is_near(0) && is_near(1) && side.area(self.surface, triangle) > 0 {
                self.draw(side, triangle, &mut picture);
            }
        }
        picture.luminance
    }

    /// The least and the most place along an axis that may lie in pixels from one up to another.
    fn reach(&self, axis: usize, first: i64, end: i64) -> [i64; 2] {
        let place = |pixel: i64| pixel as f64 / self.pixels_per_step + self.middle[axis];
        // A pixel more, since places are rounded.
        [
            place(first - 1).floor() as i64,
            place(end + 1).ceil() as i64,
        ]
    }

    /// Where a place is, in parts of a pixel along an axis.
    fn parts(&self, axis: usize, place: i64) -> i64 {
        let pixels = (place as f64 - self.middle[axis]) * self.pixels_per_step;
        // Above 0 a conversion rounds down, and takes less than rounding does.
        let above = (FARTHEST + pixels) * PARTS as f64 + 0.5;
        above as i64 - FARTHEST as i64 * PARTS
    }

    fn draw(&self, side: Side, triangle: &LitTriangle, picture: &mut SidePicture) {
        let is_outside = side.towards(triangle.face) > 0;
        // Counter-clockwise in the picture, whichever side of the triangle is seen.
        let order = if is_outside { [0, 1, 2] } else { [0, 2, 1] };
        let light = |shares: [f64; 3]| {
            let shares = order.map(|it| shares[it]);
            self.surface.luminance(triangle, shares, is_outside)
        };
        let plain = self.surface.is_plain().then(|| light([1.0, 0.0, 0.0]));
        let places = order.map(|it| triangle.places[it]);
        let near = places.map(|it| side.towards(it) as f64);
        let place = |it: [i64; 3]| side.across().map(|axis| self.parts(axis, it[axis]));
        picture.cover(&Edges::new(&places.map(place)), near, |shares| {
            plain.unwrap_or_else(|| light(shares))
        });
    }
}

/// Some pixels of a picture without borders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    /// The pixel furthest to the left and down.
    pub low: [i64; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

impl Window {
    fn end(&self, k: usize) -> i64 {
        self.low[k] + i64::from(self.size[k])
    }
}

/// What is seen through a window.
struct SidePicture {
    window: Window,
    luminance: Vec<f64>,
    /// How near to the eye that is.
    nearest: Vec<f64>,
}

impl SidePicture {
    fn new(window: Window) -> Self {
        let pixels = window.size[0] as usize * window.size[1] as usize;
        Self {
            window,
            luminance: vec![0.0; pixels],
            nearest: vec![f64::NEG_INFINITY; pixels],
        }
    }

    /// Draws a triangle, given how near to the eye its corners are, where it is in front.
    fn cover(&mut self, edges: &Edges, near: [f64; 3], light: impl Fn([f64; 3]) -> f64) {
        let [left, bottom] = self.window.low;
        let [low, high] = edges.bounds();
        let near_at = |shares: [f64; 3]| (0..3).map(|k| near[k] * shares[k]).sum::<f64>();
        let step = near_at(edges.steps.map(|it| it as f64 * edges.scale));
        for y in low[1].max(bottom)..(high[1] + 1).min(self.window.end(1)) {
            let row = edges.row(y);
            let columns = low[0].max(left)..(high[0] + 1).min(self.window.end(0));
            let columns = row.inside(columns);
            let first = (y - bottom) as usize * self.window.size[0] as usize;
            let mut depth = near_at(row.shares(columns.start));
            for x in columns {
                let pixel = first + (x - left) as usize;
                if depth > self.nearest[pixel] {
                    self.nearest[pixel] = depth;
                    self.luminance[pixel] = light(row.shares(x));
                }
                depth += step;
            }
        }
    }
}

/// The three edges of a triangle that goes counter-clockwise, each opposite to a corner.
struct Edges {
    ends: [[[i64; 2]; 2]; 3],
    /// What the doubled area beyond each edge grows by from pixel to pixel.
    steps: [i64; 3],
    /// The least area that is inside: a place on an edge belongs to the triangle that has the edge
    /// upwards, or to the right.
    least: [i64; 3],
    /// One over the doubled area of the triangle.
    scale: f64,
}

/// What the doubled areas beyond the three edges are along a row of pixels.
struct EdgesInRow<'a> {
    edges: &'a Edges,
    /// At column 0.
    areas: [i64; 3],
}

impl Edges {
    fn new(&[a, b, c]: &[[i64; 2]; 3]) -> Self {
        let ends = [[b, c], [c, a], [a, b]];
        let owns =
            |[from, to]: [[i64; 2]; 2]| to[1] > from[1] || (to[1] == from[1] && to[0] > from[0]);
        Self {
            ends,
            steps: ends.map(|[from, to]| (from[1] - to[1]) * PARTS),
            least: ends.map(|ends| i64::from(!owns(ends))),
            scale: 1.0 / area_beyond([a, b], c).max(1) as f64,
        }
    }

    /// The first and the last pixel that may be covered, to the right and upwards.
    fn bounds(&self) -> [[i64; 2]; 2] {
        let [a, b, c] = self.ends.map(|[from, _]| from);
        let low = |k: usize| a[k].min(b[k]).min(c[k]).div_euclid(PARTS);
        let high = |k: usize| a[k].max(b[k]).max(c[k]).div_euclid(PARTS);
        [[low(0), low(1)], [high(0), high(1)]]
    }

    fn row(&self, y: i64) -> EdgesInRow<'_> {
        let middle = [PARTS / 2, y * PARTS + PARTS / 2];
        EdgesInRow {
            edges: self,
            areas: self.ends.map(|ends| area_beyond(ends, middle)),
        }
    }
}

impl EdgesInRow<'_> {
    /// The part of some columns whose middles lie inside.
    fn inside(&self, columns: Range<i64>) -> Range<i64> {
        let mut inside = columns;
        for k in 0..3 {
            let (step, spare) = (self.edges.steps[k], self.areas[k] - self.edges.least[k]);
            match step {
                0 if spare < 0 => return 0..0,
                0 => (),
                1.. => inside.start = inside.start.max(-spare.div_euclid(step)),
                _ => inside.end = inside.end.min(spare.div_euclid(-step) + 1),
            }
        }
        inside
    }

    /// The shares of the corners at a column.
    fn shares(&self, x: i64) -> [f64; 3] {
        let area = |k: usize| self.areas[k] + self.edges.steps[k] * x;
        [0, 1, 2].map(|k| area(k) as f64 * self.edges.scale)
    }
}

/// Twice the area to the left of the way between two places as far as `place`.
fn area_beyond([from, to]: [[i64; 2]; 2], place: [i64; 2]) -> i64 {
    (to[0] - from[0]) * (place[1] - from[1]) - (to[1] - from[1]) * (place[0] - from[0])
}
