//! Which faces of a mesh stand there again, reversed?
//!
//! Programs without two-sided surfaces write sheets in this way: leaves, cloth, paper. Front and
//! back that look the same are one surface with two sides; where they differ, each is a surface
//! of its own.

use std::collections::HashMap;

use crate::read::sound::{count, places};
use crate::read::text::shortened;
use crate::source::{Material, SourceMesh, SourceObject, SourceScene};

/// The corners of a face by numbers of vertices, and which triangles it is, from the first.
type Face = ([u32; 4], usize);

/// What a triangle is of a sheet whose other side is there too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    /// Its other side is not there.
    Lone,
    /// Front and back that look the same.
    Front,
    Back,
    /// Those of sides that differ.
    OtherFront,
    OtherBack,
}

/// Joins the sides of sheets of the mesh that an object called `name` shows first, and counts that.
/// A sheet whose sides differ becomes two, each seen from its own side. What hangs together with
/// faces that have one side is no sheet.
pub(super) fn join_sides(scene: &mut SourceScene, mesh: usize, name: &str) {
    let sheet = &scene.meshes[mesh];
    let place = places(&sheet.positions);
    let mut sides = vec![Side::Lone; sheet.triangles.len()];
    mark(scene, sheet, &place, &triangles(sheet), &mut sides);
    mark(scene, sheet, &place, &quads(sheet, &place), &mut sides);
    forget_parts_of_bodies(sheet, &place, &mut sides);
    let is_of = |wanted: Side| sides.iter().filter(|it| **it == wanted).count();
    let [joined, apart] = [Side::Back, Side::OtherBack].map(is_of);
    if joined + apart == 0 {
        return;
    }
    let rest = is_of(Side::Lone);
    let only = |wanted: Side| -> Vec<bool> { sides.iter().map(|it| *it == wanted).collect() };
    let numbers = &scene.meshes[mesh].materials;
    let mut fronts = (0..sides.len()).filter(|at| sides[*at] == Side::Front);
    let is_two_sided = fronts.all(|at| {
        let material = numbers.get(at).copied().unwrap_or(0);
        scene
            .materials
            .get(material as usize)
            .is_some_and(|it| it.two_sided)
    });
    let leaves = |side: Side| match side {
        Side::Front => !is_two_sided && rest + apart > 0,
        Side::Back | Side::OtherBack => true,
        Side::OtherFront => rest + joined > 0,
        Side::Lone => false,
    };
    for (side, is_two_sided) in [
        (Side::Front, true),
        (Side::OtherFront, false),
        (Side::OtherBack, false),
    ] {
        if leaves(side) && is_of(side) > 0 {
            let part = split(scene, mesh, &only(side));
            set_two_sided(scene, part, is_two_sided);
        }
    }
    let stays: Vec<bool> = sides.iter().map(|it| !leaves(*it)).collect();
    scene.meshes[mesh].keep_triangles(&stays);
    if rest == 0 && (joined == 0 || apart == 0 && !is_two_sided) {
        set_two_sided(scene, mesh, joined > 0);
    }
    count(&mut scene.repairs, "two_sided_faces", joined + apart);
    let name = shortened(name);
    if joined > 0 {
        scene.remark(format!(
            "{joined} triangles of {name:?} stand there again, reversed: they are drawn as one \
             surface with two sides"
        ));
    }
    if apart > 0 {
        scene.remark(format!(
            "{apart} triangles of {name:?} stand there again, reversed and with another look: each \
             is seen from its own side"
        ));
    }
}

/// Makes triangles of a mesh another one, which the same objects show, and returns its number.
fn split(scene: &mut SourceScene, mesh: usize, taken: &[bool]) -> usize {
    let part = scene.meshes.len();
    let mut other = scene.meshes[mesh].clone();
    other.keep_triangles(taken);
    scene.meshes.push(other);
    let shown = scene.objects.iter().filter(|it| it.mesh == mesh);
    let shown: Vec<_> = shown.cloned().collect();
    scene.objects.extend(
        shown
            .into_iter()
            .map(|it| SourceObject { mesh: part, ..it }),
    );
    part
}

/// Gives a mesh materials of its own that are seen from both sides, or from one.
fn set_two_sided(scene: &mut SourceScene, mesh: usize, two_sided: bool) {
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
            two_sided,
            ..material.unwrap_or_default()
        });
    }
}

/// Takes for lone all that hangs together with what is.
fn forget_parts_of_bodies(mesh: &SourceMesh, place: &[u32], sides: &mut [Side]) {
    let mut root: Vec<u32> = (0..place.len() as u32).collect();
    fn found(root: &mut [u32], mut at: u32) -> u32 {
        while root[at as usize] != at {
            root[at as usize] = root[root[at as usize] as usize];
            at = root[at as usize];
        }
        at
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|it| found(&mut root, place[it as usize]));
        root[b as usize] = a;
        let c = found(&mut root, c);
        root[c as usize] = a;
    }
    let mut is_body = vec![false; place.len()];
    for (triangle, side) in mesh.triangles.iter().zip(&*sides) {
        let of = found(&mut root, place[triangle[0] as usize]);
        is_body[of as usize] |= *side == Side::Lone;
    }
    for (triangle, side) in mesh.triangles.iter().zip(sides) {
        let of = found(&mut root, place[triangle[0] as usize]);
        if is_body[of as usize] {
            *side = Side::Lone;
        }
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

/// Marks faces of which nothing is marked yet and whose back is there too, and these backs.
fn mark(scene: &SourceScene, mesh: &SourceMesh, place: &[u32], faces: &[Face], sides: &mut [Side]) {
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
        let is_free = |sides: &[Side], at: usize| {
            let mut all = sides[at..at + halves].iter();
            all.all(|it| *it == Side::Lone)
        };
        if !is_free(sides, *at) {
            continue;
        }
        let front = fronts.get(&key(reversed)).copied();
        let Some(front) = front.filter(|(_, first)| is_free(sides, *first)) else {
            fronts.insert(key(*corners), (*corners, *at));
            continue;
        };
        let of = match looks_same(scene, mesh, place, [front, (*corners, *at)]) {
            true => [Side::Front, Side::Back],
            false => [Side::OtherFront, Side::OtherBack],
        };
        sides[front.1..front.1 + halves].fill(of[0]);
        sides[*at..*at + halves].fill(of[1]);
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
    let is_textured = material(at).is_some_and(|it| it.2.is_some());
    let same = |corner: &u32| {
        let at = *corner as usize;
        back.iter().any(|other| {
            let other = *other as usize;
            place[other] == place[at]
                && mesh.colours.get(other) == mesh.colours.get(at)
                && (!is_textured || mesh.uvs.get(other) == mesh.uvs.get(at))
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
        for is_cut_alike in [true, false] {
            let mut scene = strip(|[a, b, c, d]| match is_cut_alike {
                true => [[c, b, a], [d, c, a]],
                false => [[d, c, b], [d, b, a]],
            });
            join_sides(&mut scene, 0, "strip");
            assert_eq!(scene.meshes[0].triangles.len(), 8);
            assert_eq!(scene.repairs["two_sided_faces"], 8);
            let material = scene.meshes[0].materials[0];
            assert!(scene.materials[material as usize].two_sided);
        }
    }

    #[test]
    fn a_back_of_another_look_is_seen_from_its_own_side() {
        let mut scene = strip(|[a, b, c, d]| [[c, b, a], [d, c, a]]);
        scene.meshes[0].materials = [vec![0; 8], vec![1; 8]].concat();
        scene.materials[0].two_sided = true;
        scene.materials.push(Material {
            colour: [1.0, 0.0, 0.0, 1.0],
            ..Material::default()
        });
        join_sides(&mut scene, 0, "strip");
        assert_eq!(scene.objects.len(), 2);
        for (mesh, colour) in scene.meshes.iter().zip([1.0, 0.0]) {
            assert_eq!(mesh.triangles.len(), 8);
            let material = &scene.materials[mesh.materials[0] as usize];
            assert!(!material.two_sided);
            assert_eq!(material.colour[1], colour);
        }
    }

    #[test]
    fn faces_between_bodies_are_no_sheet() {
        let mut scene = strip(|[a, b, c, d]| [[c, b, a], [d, c, a]]);
        // A fin on the first edge.
        scene.meshes[0].positions.push(DVec3::new(0.0, 0.0, 1.0));
        scene.meshes[0].triangles.push([0, 1, 10]);
        join_sides(&mut scene, 0, "strip");
        assert_eq!(scene.meshes[0].triangles.len(), 17);
        assert!(scene.repairs.is_empty());
    }
}
