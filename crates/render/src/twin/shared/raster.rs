//! Which pixels does a triangle cover, with which corner weights?
//!
//! What a GPU does between the steps of a drawing pass: it cuts triangles off at the least depth,
//! rounds corners to 1/256 of a pixel, and gives a pixel on a common edge to one of two triangles.

use glam::{DVec2, Vec2, Vec3, Vec4};

/// Parts of a pixel that corners are rounded to.
const PARTS: f64 = 256.0;
/// Farthest place of a corner that is distinguished from others, in parts of a pixel.
const FARTHEST: f64 = (1_u64 << 29) as f64;

/// What the corners of a triangle have, and what is between them.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Corner {
    pub(crate) position: Vec4,
    pub(crate) place: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) colour: Vec3,
    pub(crate) uv: Vec2,
}

/// A pixel that a triangle covers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fragment {
    pub(crate) pixel: [u32; 2],
    pub(crate) corner: Corner,
    /// Normal of the triangle, of any length and to either side.
    pub(crate) face: Vec3,
    /// How far the place on the texture moves from one pixel to the next, to the right and down.
    pub(crate) uv_steps: [Vec2; 2],
}

/// Which triangles are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sides {
    /// Those whose corners go counter-clockwise.
    Front,
    /// All.
    Both,
}

/// A pixel that a triangle covers. Only its depth is known yet, because a GPU tests depths first
/// too.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Covered<'a> {
    pub(crate) pixel: [u32; 2],
    /// Larger is nearer.
    pub(crate) depth: f32,
    face: Vec3,
    corners: &'a [Corner; 3],
    places: &'a [[i64; 2]; 3],
    area: i64,
    middle: [i64; 2],
    shares: [f32; 3],
}

impl Covered<'_> {
    /// What the triangle has there.
    pub(crate) fn fragment(&self) -> Fragment {
        let of_triangle = (self.corners, self.places, self.area);
        Fragment {
            pixel: self.pixel,
            corner: weighted(self.corners, weights(self.corners, self.shares)),
            face: self.face,
            uv_steps: [0, 1].map(|k| uv_step(of_triangle, self.middle, k)),
        }
    }
}

/// Calls `draw` for every pixel of a picture of `size` that a triangle covers.
pub(crate) fn rasterise(
    triangle: [Corner; 3],
    size: [u32; 2],
    sides: Sides,
    mut draw: impl FnMut(&Covered<'_>),
) {
    let [a, b, c] = triangle.map(|corner| corner.place);
    // Of unit edges: products of metres beyond 10^9 or below 10^-9 have no squares.
    let [one, other] = [b - a, c - a].map(Vec3::normalize_or_zero);
    let face = one.cross(other);
    let near = clipped(&triangle);
    for k in 2..near.len() {
        let part = [near[0], near[k - 1], near[k]];
        fill(part, face, (size, sides), &mut draw);
    }
}

/// The part of a triangle that is at least at the least depth, as a polygon.
fn clipped(triangle: &[Corner; 3]) -> Vec<Corner> {
    let inside = |corner: &Corner| corner.position.w - corner.position.z;
    let mut polygon = Vec::with_capacity(4);
    for k in 0..3 {
        let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
        let [at_from, at_to] = [inside(&from), inside(&to)];
        if at_from >= 0.0 {
            polygon.push(from);
        }
        if (at_from >= 0.0) != (at_to >= 0.0) {
            polygon.push(between(&from, &to, at_from / (at_from - at_to)));
        }
    }
    polygon
}

fn between(a: &Corner, b: &Corner, t: f32) -> Corner {
    weighted(&[*a, *b, *b], Vec3::new(1.0 - t, t, 0.0))
}

fn weighted(corners: &[Corner; 3], weights: Vec3) -> Corner {
    let [a, b, c] = corners;
    let of3 = |it: fn(&Corner) -> Vec3| it(a) * weights.x + it(b) * weights.y + it(c) * weights.z;
    let of4 = |it: fn(&Corner) -> Vec4| it(a) * weights.x + it(b) * weights.y + it(c) * weights.z;
    Corner {
        position: of4(|it| it.position),
        place: of3(|it| it.place),
        normal: of3(|it| it.normal),
        colour: of3(|it| it.colour),
        uv: a.uv * weights.x + b.uv * weights.y + c.uv * weights.z,
    }
}

/// Place in the picture in parts of a pixel.
fn rounded(position: Vec4, size: [u32; 2]) -> [i64; 2] {
    let across = Vec2::new(position.x, position.y) / position.w;
    let half = DVec2::new(f64::from(size[0]), f64::from(size[1])) / 2.0;
    let place = (across.as_dvec2() * DVec2::new(1.0, -1.0) + 1.0) * half * PARTS;
    let place = place
        .round()
        .clamp(DVec2::splat(-FARTHEST), DVec2::splat(FARTHEST));
    place.to_array().map(|it| it as i64)
}

/// Twice the area on the right of the way from `a` to `b` up to `p`, where rows grow downwards.
fn edge(a: [i64; 2], b: [i64; 2], p: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// Whether the inside lies right of, or below, the way from `a` to `b`.
fn is_top_left(a: [i64; 2], b: [i64; 2]) -> bool {
    (a[1] == b[1] && b[0] > a[0]) || b[1] < a[1]
}

fn fill(
    corners: [Corner; 3],
    face: Vec3,
    (size, sides): ([u32; 2], Sides),
    draw: &mut impl FnMut(&Covered<'_>),
) {
    let mut corners = corners;
    let mut places = corners.map(|corner| rounded(corner.position, size));
    let mut area = edge(places[0], places[1], places[2]);
    if area < 0 {
        // Counter-clockwise in the picture: from here on clockwise, as rows grow downwards.
        corners.swap(1, 2);
        places.swap(1, 2);
        area = -area;
    } else if area == 0 || sides == Sides::Front {
        return;
    }
    let [columns, rows] = [0, 1].map(|k| {
        let along = places.map(|place| place[k]);
        let [low, high] = [along.iter().min(), along.iter().max()];
        let pixel = |part: i64| part.div_euclid(PARTS as i64).clamp(0, i64::from(size[k]));
        let [low, high] = [low, high].map(|it| pixel(it.copied().unwrap_or(0)));
        low as u32..(high as u32 + 1).min(size[k])
    });
    let depths = corners.map(|corner| corner.position.z / corner.position.w);
    for y in rows {
        for x in columns.clone() {
            let middle = [x, y].map(|it| i64::from(it) * PARTS as i64 + PARTS as i64 / 2);
            let Some(shares) = shares(&places, middle) else {
                continue;
            };
            let shares = shares.map(|share| share as f32 / area as f32);
            draw(&Covered {
                pixel: [x, y],
                depth: Vec3::from(shares).dot(Vec3::from(depths)),
                face,
                corners: &corners,
                places: &places,
                area,
                middle,
                shares,
            });
        }
    }
}

/// How much of each corner there is, seen in perspective.
fn weights(corners: &[Corner; 3], shares: [f32; 3]) -> Vec3 {
    let over_depth = Vec3::from([0, 1, 2].map(|k| shares[k] / corners[k].position.w));
    over_depth / (over_depth.x + over_depth.y + over_depth.z)
}

/// How far the place on the texture moves across the two pixels of a quad in a row, or a column:
/// also where the triangle covers one of them alone.
fn uv_step(
    (corners, places, area): (&[Corner; 3], &[[i64; 2]; 3], i64),
    middle: [i64; 2],
    axis: usize,
) -> Vec2 {
    let pixel = PARTS as i64;
    let mut first = middle;
    first[axis] -= middle[axis].div_euclid(pixel).rem_euclid(2) * pixel;
    let mut second = first;
    second[axis] += pixel;
    let [first, second] = [first, second].map(|place| {
        let shares = [0, 1, 2].map(|k| edge(places[(k + 1) % 3], places[(k + 2) % 3], place));
        let weights = weights(corners, shares.map(|share| share as f32 / area as f32));
        weighted(corners, weights).uv
    });
    second - first
}

/// The areas opposite to each corner as seen from a place inside; `None` outside.
fn shares(places: &[[i64; 2]; 3], place: [i64; 2]) -> Option<[i64; 3]> {
    let mut shares = [0; 3];
    for (k, share) in shares.iter_mut().enumerate() {
        let (a, b) = (places[(k + 1) % 3], places[(k + 2) % 3]);
        *share = edge(a, b, place);
        if *share < 0 || (*share == 0 && !is_top_left(a, b)) {
            return None;
        }
    }
    Some(shares)
}
