//! What of a mesh, as a file gives it, is left out or repaired?

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use super::mends::{COLOUR_MADE, Mends, NO_PLACE, OUT_OF_RANGE, UV_MADE};
use crate::source::{Repairs, SourceCloud, SourceMesh, keep};

/// Names in `repairs` of what is counted as a possible mistake, and was not mended.
pub const KEPT: [&str; 9] = [
    "black_surfaces",
    "drawn_opaque",
    "duplicate_vertices",
    "mixed_winding_edges",
    "non_manifold_edges",
    "permissive_groups",
    "two_sided_faces",
    "unused_vertices",
    "zero_area_triangles",
];

/// Counts what was repaired under a name.
pub(super) fn count(repairs: &mut Repairs, name: &str, times: usize) {
    if times > 0 {
        *repairs.entry(name.to_owned()).or_default() += times as u64;
    }
}

/// Leaves out triangles that name vertices that are not there or are nowhere, and colours and
/// places on textures that are no numbers. Mends are reported as those of the object `name`.
///
/// All lists of the mesh are as long as [`SourceMesh`] says, but any number may be anything.
pub(super) fn make_finite(mesh: &mut SourceMesh, name: &str, mends: &mut Mends) {
    let count = mesh.positions.len();
    let is_finite = mesh.positions.iter().all(|it| it.is_finite());
    let lost = |triangle: &[u32; 3]| {
        let at = triangle.map(|it| it as usize);
        if at.iter().any(|it| *it >= count) {
            return Some(OUT_OF_RANGE);
        }
        let is_there = is_finite || at.iter().all(|it| mesh.positions[*it].is_finite());
        (!is_there).then_some(NO_PLACE)
    };
    if !mesh.triangles.iter().all(|it| lost(it).is_none()) {
        let all = mesh.triangles.iter().map(lost).collect::<Vec<_>>();
        for (number, mend) in all.iter().enumerate() {
            let place = || format!("is triangle {number} of {name:?}");
            mend.iter().for_each(|mend| mends.add(*mend, 1, place));
        }
        let stays: Vec<bool> = all.iter().map(Option::is_none).collect();
        keep(&mut mesh.triangles, &stays);
        keep(&mut mesh.materials, &stays);
    }
    let place = |vertex: usize| format!("at vertex {vertex} of {name:?}");
    for (vertex, colour) in mesh.colours.iter_mut().enumerate() {
        if colour.iter().any(|part| part.is_nan()) {
            *colour = [1.0; 4];
            mends.add(COLOUR_MADE, 1, || place(vertex));
        }
    }
    let is_finite = |uv: &[f32; 2]| uv.iter().all(|along| along.is_finite());
    if let Some(first) = mesh.uvs.iter().position(|uv| !is_finite(uv)) {
        let made = make_uvs(mesh);
        mends.add(UV_MADE, made, || place(first));
    }
}

/// Gives vertices whose places on textures are no numbers the mean of those that triangles join
/// them to; returns how many there are in triangles.
fn make_uvs(mesh: &mut SourceMesh) -> usize {
    let is_finite = |uv: &[f32; 2]| uv.iter().all(|along| along.is_finite());
    let mut sums: HashMap<u32, ([f64; 2], f64)> = HashMap::new();
    for triangle in &mesh.triangles {
        for lost in triangle
            .iter()
            .filter(|it| !is_finite(&mesh.uvs[**it as usize]))
        {
            let (sum, weight) = sums.entry(*lost).or_default();
            let others = triangle.iter().map(|it| &mesh.uvs[*it as usize]);
            for uv in others.filter(|it| is_finite(it)) {
                *sum = [0, 1].map(|k| sum[k] + f64::from(uv[k]));
                *weight += 1.0;
            }
        }
    }
    for uv in mesh.uvs.iter_mut().filter(|uv| !is_finite(uv)) {
        *uv = [0.0; 2];
    }
    for (vertex, (sum, weight)) in &sums {
        mesh.uvs[*vertex as usize] = sum.map(|along| (along / weight.max(1.0)) as f32);
    }
    sums.len()
}

/// Leaves out triangles without area, later copies of triangles, and vertices that no triangle
/// names; makes normals unit vectors, invalid ones from the triangles around them. Counts
/// what stays but may be a mistake: equal vertices, edges of many triangles, mixed winding. Returns
/// whether some edges have many triangles.
///
/// The mesh is as [`make_finite`] leaves it.
pub(super) fn make_sound(mesh: &mut SourceMesh, repairs: &mut Repairs) -> bool {
    leave_out_triangles(mesh, repairs);
    let unused = mesh.leave_out_unused_vertices();
    count(repairs, "unused_vertices", unused);
    count(repairs, "normals_made", make_normals(mesh));
    count(repairs, "duplicate_vertices", duplicate_vertices(mesh));
    count_edges(mesh, repairs)
}

/// How many vertices say what an earlier one says: on the grid they become one.
fn duplicate_vertices(mesh: &SourceMesh) -> usize {
    let bits = |at: usize| {
        let normal = mesh.normals.get(at).map(|it| it.map(f32::to_bits));
        let colour = mesh.colours.get(at).map(|it| it.map(f32::to_bits));
        let uv = mesh.uvs.get(at).map(|it| it.map(f32::to_bits));
        (place_bits(mesh.positions[at]), normal, colour, uv)
    };
    let mut met = HashSet::with_capacity(mesh.positions.len());
    let vertices = 0..mesh.positions.len();
    vertices.filter(|at| !met.insert(bits(*at))).count()
}

/// Counts edges of more than two triangles, and edges that two triangles walk the same way, so
/// that one of them shows its back. Such triangles stay as they are. Returns whether there are
/// edges of more than two.
fn count_edges(mesh: &SourceMesh, repairs: &mut Repairs) -> bool {
    let place = places(&mesh.positions);
    // How often an edge is walked up and down, by the numbers of its places.
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::with_capacity(mesh.triangles.len() * 2);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| place[vertex as usize]);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let walked = edges.entry([from.min(to), from.max(to)]).or_default();
            walked[usize::from(from > to)] += 1;
        }
    }
    let is_shared = |it: &&[u32; 2]| it[0] + it[1] > 2;
    let is_mixed = |it: &&[u32; 2]| **it == [2, 0] || **it == [0, 2];
    let many = edges.values().filter(is_shared).count();
    count(repairs, "non_manifold_edges", many);
    count(
        repairs,
        "mixed_winding_edges",
        edges.values().filter(is_mixed).count(),
    );
    many > 0
}

/// A number for each vertex, the same for those at the same place.
pub(super) fn places(positions: &[DVec3]) -> Vec<u32> {
    let mut of: HashMap<[u64; 3], u32> = HashMap::with_capacity(positions.len());
    positions
        .iter()
        .map(|position| {
            let next = of.len() as u32;
            *of.entry(place_bits(*position)).or_insert(next)
        })
        .collect()
}

/// The bits of a position, the same for both zeros.
pub(super) fn place_bits(position: DVec3) -> [u64; 3] {
    // -0 + 0 is 0.
    position.to_array().map(|along| (along + 0.0).to_bits())
}

fn leave_out_triangles(mesh: &mut SourceMesh, repairs: &mut Repairs) {
    let place = places(&mesh.positions);
    let mut met = HashSet::with_capacity(mesh.triangles.len());
    let (mut flat, mut copies) = (0, 0);
    let stays: Vec<bool> = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let mut corners = triangle.map(|vertex| place[vertex as usize]);
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                flat += 1;
                return false;
            }
            let least = corners[0].min(corners[1]).min(corners[2]);
            while corners[0] != least {
                corners.rotate_left(1);
            }
            let new = met.insert(corners);
            copies += usize::from(!new);
            new
        })
        .collect();
    if flat + copies > 0 {
        keep(&mut mesh.triangles, &stays);
        keep(&mut mesh.materials, &stays);
    }
    count(repairs, "zero_area_triangles", flat);
    count(repairs, "duplicate_triangles", copies);
}

/// Makes normals unit vectors; gives how many had no direction and were made of triangles.
fn make_normals(mesh: &mut SourceMesh) -> usize {
    let mut without = vec![false; mesh.normals.len()];
    for (normal, without) in mesh.normals.iter_mut().zip(&mut without) {
        match unit(DVec3::from_array(normal.map(f64::from))) {
            Some(of_file) => *normal = of_file,
            None => *without = true,
        }
    }
    let made = without.iter().filter(|without| **without).count();
    if made == 0 {
        return 0;
    }
    let mut sums = vec![DVec3::ZERO; mesh.normals.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        let doubled_area = (b - a).cross(c - a);
        for vertex in triangle {
            sums[*vertex as usize] += doubled_area;
        }
    }
    let all = mesh.normals.iter_mut().zip(&sums).zip(&without);
    for ((normal, sum), _) in all.filter(|(_, without)| **without) {
        *normal = unit(*sum).unwrap_or([0.0, 1.0, 0.0]);
    }
    made
}

fn unit(direction: DVec3) -> Option<[f32; 3]> {
    let [x, y, z] = direction.try_normalize()?.to_array();
    Some([x as f32, y as f32, z as f32])
}

/// Panics unless a mesh keeps what [`SourceMesh`] promises: for tests and fuzzing.
pub(super) fn assert_sound(mesh: &SourceMesh, materials: usize) {
    let vertices = mesh.positions.len();
    assert!(mesh.positions.iter().all(|position| position.is_finite()));
    assert!(mesh.normals.is_empty() || mesh.normals.len() == vertices);
    assert!(mesh.colours.is_empty() || mesh.colours.len() == vertices);
    assert!(mesh.uvs.is_empty() || mesh.uvs.len() == vertices);
    assert!(mesh.uvs.iter().flatten().all(|it| it.is_finite()));
    assert!(mesh.materials.is_empty() || mesh.materials.len() == mesh.triangles.len());
    assert!(!mesh.triangles.is_empty());
    let mut named = mesh.triangles.iter().flatten();
    assert!(named.all(|vertex| (*vertex as usize) < vertices));
    let mut named = mesh.materials.iter();
    assert!(named.all(|material| (*material as usize) < materials));
    let length = |normal: &[f32; 3]| normal.iter().map(|along| along * along).sum::<f32>();
    let mut lengths = mesh.normals.iter().map(length);
    assert!(lengths.all(|length| (length - 1.0).abs() < 1e-4));
    let mut parts = mesh.colours.iter().flatten();
    assert!(parts.all(|part| (0.0..=1.0).contains(part)));
}

/// Panics unless a cloud keeps what [`SourceCloud`] promises: for tests and fuzzing.
pub(super) fn assert_sound_cloud(cloud: &SourceCloud) {
    let points = cloud.places.len();
    assert!(points > 0 && !cloud.placements.is_empty());
    let lengths = [
        cloud.colours.len(),
        cloud.intensities.len(),
        cloud.classes.len(),
    ];
    assert!(lengths.iter().all(|it| *it == 0 || *it == points));
    assert!(cloud.scale.iter().all(|it| *it > 0.0 && it.is_finite()));
    assert!(cloud.placements.iter().all(glam::DAffine3::is_finite) && cloud.reach().is_finite());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> SourceMesh {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        SourceMesh {
            positions: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..SourceMesh::default()
        }
    }

    #[test]
    fn triangles_that_are_nowhere_go_and_lost_places_on_textures_come_from_neighbours() {
        let mut mesh = square();
        mesh.positions.push(DVec3::new(f64::NAN, 0.0, 0.0));
        mesh.triangles.extend([[0, 1, 4], [0, 1, u32::MAX]]);
        mesh.uvs = vec![
            [0.0; 2],
            [1.0, 0.0],
            [f32::NAN, 1.0],
            [0.0, 1.0],
            [f32::NAN; 2],
        ];
        mesh.colours = vec![[0.5; 4]; 5];
        mesh.colours[3] = [f32::NAN; 4];
        let mut mends = Mends::default();
        make_finite(&mut mesh, "square", &mut mends);
        assert_eq!(mesh.triangles, square().triangles);
        assert_eq!((mesh.uvs[2], mesh.colours[3]), ([0.25, 0.25], [1.0; 4]));
        let kinds = [NO_PLACE, OUT_OF_RANGE, UV_MADE, COLOUR_MADE];
        assert_eq!(kinds.map(|kind| mends.times(kind)), [1; 4]);
    }

    #[test]
    fn a_sound_mesh_stays_as_it_is() {
        let mut mesh = square();
        let mut repairs = Repairs::new();
        make_sound(&mut mesh, &mut repairs);
        assert_eq!(mesh.triangles, square().triangles);
        assert!(repairs.is_empty());
    }

    #[test]
    fn triangles_without_area_and_copies_are_left_out_and_counted() {
        let mut mesh = square();
        mesh.positions.push(mesh.positions[0] * -1.0);
        mesh.positions.push(DVec3::splat(9.0));
        mesh.materials = vec![0, 1, 2, 3, 4, 5];
        // A copy turned, one over a vertex at the same place, one with two corners at one place,
        // and the back of the first, which is another triangle.
        let more = [[1, 2, 0], [4, 1, 2], [0, 4, 3], [2, 1, 0]];
        mesh.triangles.extend(more);
        let mut repairs = Repairs::new();
        make_sound(&mut mesh, &mut repairs);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [2, 1, 0]]);
        assert_eq!(mesh.materials, [0, 1, 5]);
        assert_eq!(mesh.positions.len(), 4);
        let counts = [
            ("duplicate_triangles".to_owned(), 2),
            ("non_manifold_edges".to_owned(), 1),
            ("unused_vertices".to_owned(), 2),
            ("zero_area_triangles".to_owned(), 1),
        ];
        assert_eq!(repairs, Repairs::from(counts));
    }

    #[test]
    fn what_stays_as_it_is_is_counted_too() {
        let mut mesh = square();
        // A fin on the diagonal, and the square's neighbour on the right, turned over, with
        // vertices of its own.
        mesh.positions.extend(
            [
                [0.5, 0.5, 1.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, 0.0],
                [2.0, 0.5, 0.0],
            ]
            .map(DVec3::from),
        );
        mesh.triangles.extend([[0, 2, 4], [5, 6, 7]]);
        let mut repairs = Repairs::new();
        make_sound(&mut mesh, &mut repairs);
        assert_eq!(mesh.triangles.len(), 4);
        let counts = [
            ("duplicate_vertices".to_owned(), 2),
            ("mixed_winding_edges".to_owned(), 1),
            ("non_manifold_edges".to_owned(), 1),
        ];
        assert_eq!(repairs, Repairs::from(counts));
    }

    #[test]
    fn normals_without_direction_are_made_of_the_triangles_around() {
        let mut mesh = square();
        mesh.normals = vec![[0.0; 3], [0.0, 2.0, 0.0], [f32::NAN, 0.0, 0.0], [0.0; 3]];
        let mut repairs = Repairs::new();
        make_sound(&mut mesh, &mut repairs);
        assert_eq!(mesh.normals[0], [0.0, 0.0, 1.0]);
        assert_eq!(mesh.normals[1], [0.0, 1.0, 0.0]);
        assert_eq!(mesh.normals[2], [0.0, 0.0, 1.0]);
        assert_eq!(repairs["normals_made"], 3);
    }
}
