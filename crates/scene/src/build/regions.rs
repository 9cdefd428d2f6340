//! Which part of a surface shows each page of a texture, and how large are texels there?

use super::mesh::grid_mesh::GridMesh;
use super::sphere::LocalSphere;
use super::textures::ShownImage;
use foveal_core::content::images::shape::{PAGE_SIDE, PagePlace, TextureShape};
use foveal_core::content::images::wrap::Wrap;
use foveal_core::content::mesh::payload::MeshVertex;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// How far outside a page a surface may lie that still shows it, in texels.
const BESIDE: f64 = 1.0;
/// What rounding moves an edge by at most, in texels.
const ROUNDING: f64 = 1e-2;
/// Pages, counted as often as a triangle repeats them, from which on it counts for each whole.
const MOST_PIECES: f64 = 4096.0;
/// How much larger than on average a texel may be before slivers of triangles are not believed.
const LARGEST: f64 = 4.0;

/// A part of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ShownRegion {
    /// A sphere round it, in the object's space, from the origin of its grid.
    pub sphere: LocalSphere,
    /// Largest side of a texel of level 0 there, in the object's space.
    pub texel: f64,
}

/// What is known of a page while triangles come.
#[derive(Clone, Copy, Debug)]
struct Gathered {
    low: DVec3,
    high: DVec3,
    centre: DVec3,
    reach: f64,
    area: f64,
    texels: f64,
    largest: f64,
}

/// A corner of a triangle on a texture, in texels of level 0, and in the object's space.
#[derive(Clone, Copy, Debug)]
struct At {
    texel: DVec2,
    place: DVec3,
}

/// The regions of a mesh that show pages of level 0 of one of its textures, given its place among
/// them.
pub(super) fn regions(
    mesh: &GridMesh,
    slot: u8,
    image: &ShownImage,
) -> BTreeMap<PagePlace, ShownRegion> {
    let mut gathered: BTreeMap<[u16; 2], Gathered> = BTreeMap::new();
    for_every_piece(mesh, slot, image, |page, piece, [area, texels]| {
        let it = gathered.entry(page).or_insert(Gathered {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
            centre: DVec3::ZERO,
            reach: 0.0,
            area: 0.0,
            texels: 0.0,
            largest: 0.0,
        });
        for corner in piece {
            it.low = it.low.min(corner.place);
            it.high = it.high.max(corner.place);
        }
        if texels > 0.0 {
            it.area += area;
            it.texels += texels;
            it.largest = it.largest.max((area / texels).sqrt());
        }
    });
    for it in gathered.values_mut() {
        // As it is written, so that it encloses what it should.
        it.centre = ((it.low + it.high) / 2.0).as_vec3().as_dvec3();
    }
    for_every_piece(mesh, slot, image, |page, piece, _| {
        if let Some(it) = gathered.get_mut(&page) {
            let reach = piece.iter().map(|at| (at.place - it.centre).length());
            it.reach = reach.fold(it.reach, f64::max);
        }
    });
    let region = |(place, it): ([u16; 2], Gathered)| {
        let mean = (it.area / it.texels.max(f64::MIN_POSITIVE)).sqrt();
        let sphere = LocalSphere {
            centre: it.centre.as_vec3().to_array(),
            radius: (it.reach as f32).next_up(),
        };
        let texel = it.largest.min(LARGEST * mean);
        (PagePlace { level: 0, place }, ShownRegion { sphere, texel })
    };
    gathered.into_iter().map(region).collect()
}

/// Calls `each` with every page of level 0 and the part of a triangle that shows it, with the area
/// of the triangle in space and in texels.
fn for_every_piece(
    mesh: &GridMesh,
    slot: u8,
    image: &ShownImage,
    mut each: impl FnMut([u16; 2], &[At], [f64; 2]),
) {
    let Some(texturing) = &mesh.object.texturing else {
        return;
    };
    let (origin, step) = (
        DVec2::from_array(texturing.origin),
        DVec2::from_array(texturing.step),
    );
    let size = DVec2::from_array(image.size.map(f64::from));
    let at = |vertex: &MeshVertex| At {
        texel: (origin + step * DVec2::from_array(vertex.uv.map(f64::from))) * size,
        place: mesh.object.grid.step * DVec3::from_array(vertex.place.map(f64::from)),
    };
    let pages = Pages::new(image);
    let mut pieces = [Vec::new(), Vec::new()];
    for corners in &mesh.triangles {
        let vertices = corners.map(|it| &mesh.vertices[it as usize]);
        if vertices[0].texture != slot {
            continue;
        }
        let triangle = vertices.map(at);
        let [a, b, c] = triangle;
        let areas = [
            (b.place - a.place).cross(c.place - a.place).length() / 2.0,
            (b.texel - a.texel).perp_dot(c.texel - a.texel).abs() / 2.0,
        ];
        if pages.pieces_of(&triangle) > MOST_PIECES {
            pages.all().for_each(|page| each(page, &triangle, areas));
            continue;
        }
        for tile in pages.tiles(&triangle) {
            let turned = triangle.map(|it| pages.in_tile(it, tile));
            for page in pages.met_by(&turned) {
                pieces[0].clear();
                pieces[0].extend(turned);
                pages.clip(page, &mut pieces);
                if !pieces[0].is_empty() {
                    each(page, &pieces[0], areas);
                }
            }
        }
    }
}

/// The pages of level 0 of a texture, and how it repeats.
struct Pages {
    size: DVec2,
    count: [u32; 2],
    wrap: [Wrap; 2],
}

impl Pages {
    fn new(image: &ShownImage) -> Self {
        Self {
            size: DVec2::from_array(image.size.map(f64::from)),
            count: TextureShape { size: image.size }.pages(0),
            wrap: image.wrap,
        }
    }

    fn all(&self) -> impl Iterator<Item = [u16; 2]> + use<> {
        let [columns, rows] = self.count.map(|it| it as u16);
        (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row]))
    }

    /// About how many pages the box of a triangle meets, counted as often as they repeat.
    fn pieces_of(&self, triangle: &[At; 3]) -> f64 {
        let [low, high] = extent(triangle);
        let along = |k: usize| match self.wrap[k] {
            Wrap::Clamp => f64::from(self.count[k]),
            _ => (high[k] - low[k]) / self.size[k].min(f64::from(PAGE_SIDE)) + 1.0,
        };
        along(0) * along(1)
    }

    /// Which repetitions of the texture a triangle meets.
    fn tiles(&self, triangle: &[At; 3]) -> impl Iterator<Item = [i64; 2]> + use<> {
        let [low, high] = extent(triangle);
        let [columns, rows] = [0, 1].map(|k| match self.wrap[k] {
            Wrap::Clamp => 0..=0,
            _ => {
                let tile = |texel: f64| (texel / self.size[k]).floor() as i64;
                // What ends at an edge does not lie beyond it.
                tile((low[k] + ROUNDING).min(high[k]))..=tile((high[k] - ROUNDING).max(low[k]))
            }
        });
        rows.flat_map(move |row| columns.clone().map(move |column| [column, row]))
    }

    /// Where something lies in a repetition.
    fn in_tile(&self, at: At, tile: [i64; 2]) -> At {
        let along = |k: usize| {
            let inside = at.texel[k] - tile[k] as f64 * self.size[k];
            match self.wrap[k] {
                Wrap::Mirror if tile[k].rem_euclid(2) == 1 => self.size[k] - inside,
                _ => inside,
            }
        };
        At {
            texel: DVec2::new(along(0), along(1)),
            ..at
        }
    }

    /// The pages that the box of a triangle meets.
    fn met_by(&self, triangle: &[At; 3]) -> impl Iterator<Item = [u16; 2]> + use<> {
        let [low, high] = extent(triangle);
        let [columns, rows] = [0, 1].map(|k| {
            let page = |texel: f64| {
                let page = (texel / f64::from(PAGE_SIDE)).floor();
                page.clamp(0.0, f64::from(self.count[k] - 1)) as u16
            };
            page(low[k] - BESIDE)..=page(high[k] + BESIDE)
        });
        rows.flat_map(move |row| columns.clone().map(move |column| [column, row]))
    }

    /// Leaves of the first polygon what lies on a page or just outside it (Sutherland and Hodgman
    /// 1974); the second is room to work in.
    fn clip(&self, page: [u16; 2], [polygon, spare]: &mut [Vec<At>; 2]) {
        for (k, number) in page.into_iter().enumerate() {
            let first = u32::from(number) * PAGE_SIDE;
            let last = f64::from(first + PAGE_SIDE).min(self.size[k]);
            let clamps = self.wrap[k] == Wrap::Clamp;
            let is_open = [number == 0, u32::from(number) + 1 == self.count[k]];
            for (side, edge) in [f64::from(first) - BESIDE, last + BESIDE]
                .into_iter()
                .enumerate()
            {
                if clamps && is_open[side] {
                    continue;
                }
                let sign = if side == 0 { 1.0 } else { -1.0 };
                spare.clear();
                for (number, to) in polygon.iter().enumerate() {
                    let from = &polygon[(number + polygon.len() - 1) % polygon.len()];
                    let [at_from, at_to] = [from, to].map(|it| sign * (it.texel[k] - edge));
                    if (at_from >= 0.0) != (at_to >= 0.0) {
                        let share = at_from / (at_from - at_to);
                        spare.push(At {
                            texel: from.texel.lerp(to.texel, share),
                            place: from.place.lerp(to.place, share),
                        });
                    }
                    if at_to >= 0.0 {
                        spare.push(*to);
                    }
                }
                std::mem::swap(polygon, spare);
            }
        }
    }
}

fn extent(triangle: &[At; 3]) -> [DVec2; 2] {
    let [a, b, c] = triangle.map(|it| it.texel);
    [a.min(b).min(c), a.max(b).max(c)]
}
