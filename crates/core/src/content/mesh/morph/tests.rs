//! Do vertices leave the coarse surface where it is nearest, and come to their places?

use super::*;

fn at(place: [u16; 3]) -> MeshVertex {
    MeshVertex {
        place,
        ..Default::default()
    }
}

fn start(corners: [[u16; 3]; 3], new: MeshVertex) -> MeshVertex {
    let mut vertices: Vec<_> = corners.map(at).to_vec();
    vertices.push(new);
    let feet = feet(&vertices, 3, &[[0, 1, 2]]);
    let foot = feet[0].unwrap();
    let places = foot.corners.map(|it| vertices[usize::from(it)].place);
    assert_eq!(foot.at(places, &new, 1.0), new);
    foot.at(places, &new, 0.0)
}

const FLAT: [[u16; 3]; 3] = [[100, 100, 0], [1100, 100, 0], [100, 1100, 0]];

#[test]
fn a_vertex_over_a_triangle_starts_straight_below_it() {
    for place in [[300, 300, 900], [101, 102, 40], [500, 600, 65_535]] {
        let [x, y, _] = place;
        assert_eq!(start(FLAT, at(place)).place, [x, y, 0]);
    }
}

#[test]
fn a_vertex_beside_a_triangle_starts_on_its_nearest_edge_or_corner() {
    for (place, foot) in [
        ([500, 20, 0], [500, 100, 0]),
        ([20, 700, 9], [100, 700, 0]),
        ([800, 800, 0], [600, 600, 0]),
        ([0, 0, 50], [100, 100, 0]),
        ([3000, 90, 0], [1100, 100, 0]),
        ([90, 3000, 0], [100, 1100, 0]),
    ] {
        assert_eq!(start(FLAT, at(place)).place, foot, "{place:?}");
    }
}

#[test]
fn a_triangle_without_area_has_a_nearest_point_too() {
    for corners in [
        [[5, 5, 5]; 3],
        [[5, 5, 5], [9, 9, 9], [5, 5, 5]],
        [[0, 0, 0], [10, 0, 0], [4, 0, 0]],
    ] {
        let foot = start(corners, at([4, 9, 0])).place;
        let within = corners.iter().map(|it| it[0]);
        let most = within.clone().max().unwrap();
        assert!((within.min().unwrap()..=most).contains(&foot[0]));
    }
}

#[test]
fn places_grow_evenly_on_the_way() {
    let mut vertices: Vec<_> = FLAT.map(at).to_vec();
    vertices.push(at([300, 300, 1000]));
    let foot = feet(&vertices, 3, &[[0, 1, 2]])[0].unwrap();
    let height = |share| foot.at(FLAT, &vertices[3], share).place[2];
    assert_eq!([0.0, 0.25, 0.5, 1.0].map(height), [0, 250, 500, 1000]);
    assert_eq!([-1.0, f64::NAN, 7.0].map(height), [0, 0, 1000]);
}

#[test]
fn a_vertex_starts_with_the_attributes_of_its_side_of_an_edge_where_they_jump() {
    // A roof: its two sides meet in an edge, where each has its own colour.
    let coloured = |place, red| MeshVertex {
        colour: [red, 0, 0, 255],
        ..at(place)
    };
    let edge = [[100, 100, 50], [100, 900, 50]];
    let vertices = vec![
        coloured(edge[0], 10),
        coloured(edge[1], 10),
        coloured([0, 500, 0], 10),
        coloured(edge[0], 200),
        coloured(edge[1], 200),
        coloured([200, 500, 0], 200),
        coloured([100, 480, 60], 12),
        coloured([100, 480, 60], 190),
    ];
    let feet = feet(&vertices, 6, &[[0, 1, 2], [3, 5, 4]]);
    let starts = [6, 7].map(|new| {
        let foot = feet[new - 6].unwrap();
        let corners = foot.corners.map(|it| vertices[usize::from(it)].place);
        foot.at(corners, &vertices[new], 0.0)
    });
    assert_eq!(starts.map(|it| it.place), [[100, 480, 50]; 2]);
    assert_eq!(starts.map(|it| it.colour[0]), [10, 200]);
}

#[test]
fn a_vertex_at_the_place_of_one_that_stays_goes_where_that_goes() {
    let mut vertices: Vec<_> = FLAT.map(at).to_vec();
    vertices.push(MeshVertex {
        colour: [1; 4],
        ..at(FLAT[1])
    });
    let foot = feet(&vertices, 3, &[[0, 1, 2]])[0].unwrap();
    assert_eq!(foot.corners, [1; 3]);
    assert_eq!(foot.at([[7, 8, 9]; 3], &vertices[3], 0.0).place, [7, 8, 9]);
}

#[test]
fn without_a_coarse_surface_nothing_moves() {
    assert_eq!(feet(&[at([1, 2, 3])], 0, &[]), [None]);
}
