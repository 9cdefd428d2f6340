//! Which faces of a mesh stand there again, reversed?
//!
//! So are sheets told by programs that know no surfaces with two sides: leaves, cloth, paper. Front
//! and back that look the same are one surface with two sides; where they differ, both stay.

use std::collections::HashMap;

use super::sound::{count, places};
use super::text::shortened;
use crate::source::{Material, SourceMesh, SourceScene};

/// The corners of a face by numbers of vertices, and which triangles it is, from the first.
type Face = ([u32; 4], usize);

/// Leaves out the backs of sheets of the mesh that an object called `name` shows first, and counts
/// them.
pub(super) fn join_sides(scene: &mut SourceScene, mesh: usize, name: &str) {
    let sheet = &scene.meshes[mesh];
    let place = places(&sheet.positions);
    let mut is_back = vec![false; sheet.triangles.len()];
    let mut is_front = is_back.clone();
    let threes = triangles(sheet);
    mark(scene, sheet, &place, &threes, (&mut is_front, &mut is_back));
    let is_free = |at: usize| !is_front[at] && !is_back[at];
    let fours: Vec<Face> = quads(sheet, &place)
        .into_iter()
        .filter(|(_, at)| is_free(*at) && is_free(at + 1))
        .collect();
    mark(scene, sheet, &place, &fours, (&mut is_front, &mut is_back));
    let backs = is_back.iter().filter(|it| **it).count();
    if backs == 0 {
        return;
    }
    // A mesh is seen from both sides, or from one.
    let has_sides = |it: &Material| it.two_sided;
    let of = |at: usize| sheet.materials.get(at).copied().unwrap_or(0) as usize;
    let mut fronts = (0..is_back.len()).filter(|at| is_front[*at]);
    let is_two_sided = fronts.all(|at| scene.materials.get(of(at)).is_some_and(has_sides));
    if !is_two_sided {
        if is_front.iter().zip(&is_back).any(|(a, b)| !a && !b) {
            return;
        }
        make_two_sided(scene, mesh);
    }
    let stays: Vec<bool> = is_back.iter().map(|it| !it).collect();
    scene.meshes[mesh].keep_triangles(&stays);
    count(&mut scene.repairs, "two_sided_faces", backs);
    let name = shortened(name);
    scene.remark(format!(
        "{backs} triangles of {name:?} stand there again, reversed: they are drawn as one surface \
         with two sides"
    ));
}

/// Gives a mesh materials of its own that are seen from both sides.
fn make_two_sided(scene: &mut SourceScene, mesh: usize) {
    let first = scene.materials.len() as u32;
    let mut made: HashMap<u32, u32> = HashMap::new();
    let triangles = scene.meshes[mesh].triangles.len();
    let numbers = &mut scene.meshes[mesh].materials;
    numbers.resize(triangles, 0);
    for number in numbers {
        let next = first + made.len() as u32;
        *number = *made.entry(*number).or_insert(next);
    }
    let mut order: Vec<(u32, u32)> = made.into_iter().map(|(of, number)| (number, of)).collect();
    order.sort_unstable();
    for (_, of) in order {
        let material = scene.materials.get(of as usize).cloned();
        scene.materials.push(Material {
            two_sided: true,
            ..material.unwrap_or_default()
        });
    }
}

fn triangles(mesh: &SourceMesh) -> Vec<Face> {
    let all = mesh.triangles.iter().zip(0..);
    all.map(|([a, b, c], at)| ([*a, *b, *c, *c], at)).collect()
}

/// Pairs of triangles that follow each other and are the halves of a face of four corners, which
/// its back may have in another way.
fn quads(mesh: &SourceMesh, place: &[u32]) -> Vec<Face> {
    let at = |vertex: u32| place[vertex as usize];
    let pairs = mesh.triangles.windows(2).enumerate();
    let quad = |(number, pair): (usize, &[[u32; 3]])| {
        let turned = |of: [u32; 3]| [of, [of[1], of[2], of[0]], [of[2], of[0], of[1]]];
        let all = turned(pair[0])
            .into_iter()
            .flat_map(|one| turned(pair[1]).map(|other| (one, other)));
        // One is a, b, c, the other a, c, d.
        let mut found = all.filter(|([a, _, c], [e, f, _])| [at(*a), at(*c)] == [at(*e), at(*f)]);
        let ([a, b, c], [_, _, d]) = found.next()?;
        Some(([a, b, c, d], number))
    };
    pairs.filter_map(quad).collect()
}

/// Marks faces whose back is there too and looks the same, and these backs.
fn mark(
    scene: &SourceScene,
    mesh: &SourceMesh,
    place: &[u32],
    faces: &[Face],
    (is_front, is_back): (&mut [bool], &mut [bool]),
) {
    let mut fronts: HashMap<[u32; 4], Face> = HashMap::with_capacity(faces.len());
    for (corners, at) in faces {
        let key = |turned: [u32; 4]| {
            let mut places = turned.map(|it| place[it as usize]);
            let length = if turned[2] == turned[3] { 3 } else { 4 };
            let least = (0..length).min_by_key(|k| places[*k]).unwrap_or(0);
            places[..length].rotate_left(least);
            if length == 3 {
                places[3] = places[2];
            }
            places
        };
        let [a, b, c, d] = *corners;
        let (reversed, halves) = match c == d {
            true => ([c, b, a, a], 1),
            false => ([d, c, b, a], 2),
        };
        let is_free = |it: &(&[u32; 4], &usize)| {
            (0..halves).all(|half| !is_front[it.1 + half] && !is_back[it.1 + half])
        };
        if !is_free(&(corners, at)) {
            continue;
        }
        let front = fronts.get(&key(reversed)).copied();
        let front = front.filter(|(of, first)| is_free(&(of, first)));
        match front.filter(|front| looks_same(scene, mesh, place, [*front, (*corners, *at)])) {
            Some((_, first)) => {
                is_front[first..first + halves].fill(true);
                is_back[*at..*at + halves].fill(true);
            }
            None => {
                fronts.insert(key(*corners), (*corners, *at));
            }
        }
    }
}

/// Whether two faces with the same corners have one material, and at each place one colour and one
/// place on its picture.
fn looks_same(
    scene: &SourceScene,
    mesh: &SourceMesh,
    place: &[u32],
    [(front, at), (back, back_at)]: [Face; 2],
) -> bool {
    let material = |at: usize| {
        let number = mesh.materials.get(at).copied().unwrap_or(0);
        let material = scene.materials.get(number as usize);
        material.map(|it| (it.colour, it.unlit, it.texture, it.two_sided))
    };
    let same = |corner: &u32| {
        let at = *corner as usize;
        back.iter().any(|other| {
            let other = *other as usize;
            place[other] == place[at]
                && mesh.colours.get(other) == mesh.colours.get(at)
                && mesh.uvs.get(other) == mesh.uvs.get(at)
        })
    };
    material(at) == material(back_at) && front.iter().all(same)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::SourceObject;
    use glam::{DAffine3, DVec3};

    /// A strip of squares, in halves as given, with backs.
    fn strip(back: impl Fn([u32; 4]) -> [[u32; 3]; 2]) -> SourceScene {
        let positions = (0..10).map(|k| DVec3::new(f64::from(k / 2), f64::from(k % 2), 0.0));
        let squares = (0..4_u32).map(|k| [2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1]);
        let fronts = squares
            .clone()
            .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let mesh = SourceMesh {
            positions: positions.collect(),
            triangles: fronts.chain(squares.flat_map(back)).collect(),
            ..SourceMesh::default()
        };
        SourceScene {
            objects: vec![SourceObject {
                name: "strip".to_owned(),
                mesh: 0,
                placements: vec![DAffine3::IDENTITY],
            }],
            meshes: vec![mesh],
            materials: vec![Material::default()],
            ..SourceScene::default()
        }
    }

    #[test]
    fn the_back_of_a_sheet_goes_however_its_faces_are_cut() {
        let cuts: [fn([u32; 4]) -> [[u32; 3]; 2]; 2] = [
            |[a, b, c, d]| [[c, b, a], [d, c, a]],
            |[a, b, c, d]| [[d, c, b], [d, b, a]],
        ];
        for cut in cuts {
            let mut scene = strip(cut);
            join_sides(&mut scene, 0, "strip");
            assert_eq!(scene.meshes[0].triangles.len(), 8);
            assert_eq!(scene.repairs["two_sided_faces"], 8);
            let material = scene.meshes[0].materials[0];
            assert!(scene.materials[material as usize].two_sided);
        }
    }

    #[test]
    fn a_back_of_another_look_stays() {
        let mut scene = strip(|[a, b, c, d]| [[c, b, a], [d, c, a]]);
        scene.meshes[0].materials = [vec![0; 8], vec![1; 8]].concat();
        scene.materials.push(Material {
            colour: [1.0, 0.0, 0.0, 1.0],
            ..Material::default()
        });
        join_sides(&mut scene, 0, "strip");
        assert_eq!(scene.meshes[0].triangles.len(), 16);
        assert!(scene.repairs.is_empty());
    }
}
