//! Do units come back, and are broken ones refused?

use super::*;
use proptest::prelude::*;

fn all_attributes() -> [Attributes; 8] {
    core::array::from_fn(|flags| Attributes {
        normals: flags & 1 > 0,
        colours: flags & 2 > 0,
        textured: flags & 4 > 0,
    })
}

/// A unit whose second cluster shares vertices with the first.
fn unit(attributes: Attributes) -> MeshUnit {
    let vertex = |number: u16| MeshVertex {
        place: [40_000 + 3 * number, 7 * number % 50, 900 - number],
        normal: if attributes.normals {
            [number as i8, -3]
        } else {
            [0; 2]
        },
        colour: if attributes.colours {
            [number as u8, 2, 3, 255]
        } else {
            [0; 4]
        },
        uv: match attributes.textured {
            true => [number, 60_000 - 5 * number],
            false => [0; 2],
        },
        texture: u8::from(attributes.textured) * (number / 7) as u8,
    };
    let strip = |count: u8| (2..count).map(|it| [it - 2, it - 1, it]).collect();
    MeshUnit {
        replaces: vec![PartRef { need: 0, part: 3 }, PartRef { need: 1, part: 0 }],
        staying: 10,
        vertices: (0..20).map(vertex).collect(),
        clusters: vec![
            Cluster {
                vertices: (0..20).collect(),
                triangles: strip(20),
            },
            Cluster {
                vertices: vec![19, 3, 18, 20, 9, 21, 22, 12, 25, 23, 24, 26, 29, 28, 27],
                triangles: strip(15),
            },
        ],
    }
}

#[test]
fn a_unit_comes_back() {
    for attributes in all_attributes() {
        let unit = unit(attributes);
        let bytes = unit.write(attributes).unwrap();
        assert_eq!(
            MeshUnit::parse(&bytes, attributes, &unit.replaces).unwrap(),
            unit
        );
    }
}

#[test]
fn the_largest_and_the_emptiest_unit_come_back() {
    let cluster = Cluster {
        vertices: (0..128).map(|it| it * 500).collect(),
        triangles: (0..126).map(|it| [it, it + 1, it + 2]).collect(),
    };
    let large = MeshUnit {
        replaces: vec![PartRef { need: 15, part: 15 }; MOST_CLUSTERS],
        staying: 1,
        vertices: (0..u16::MAX)
            .map(|it| MeshVertex::at([it, 0, u16::MAX - it]))
            .collect(),
        clusters: vec![cluster; MOST_CLUSTERS],
    };
    for unit in [large, MeshUnit::default()] {
        let bytes = unit.write(Attributes::default()).unwrap();
        assert_eq!(
            MeshUnit::parse(&bytes, Attributes::default(), &unit.replaces).unwrap(),
            unit
        );
    }
}

/// The codec turns triangles, and a turned one predicts other places where a corner is doubled.
#[test]
fn places_come_back_where_a_cluster_names_a_vertex_twice() {
    let places = [[0; 3], [0; 3], [0, 0, 1], [0; 3], [0; 3]];
    for corners in (0..216_u8).map(|it| [it / 36, it / 6 % 6, it % 6]) {
        let unit = MeshUnit {
            vertices: places.map(MeshVertex::at).to_vec(),
            clusters: vec![Cluster {
                vertices: vec![0, 3, 0, 3, 0, 2],
                triangles: vec![corners, [1, 2, 2]],
            }],
            ..MeshUnit::default()
        };
        let bytes = unit.write(Attributes::default()).unwrap();
        let back = MeshUnit::parse(&bytes, Attributes::default(), &unit.replaces).unwrap();
        assert_eq!(turned(back), turned(unit));
    }
}

#[test]
fn more_than_fits_is_not_written() {
    let cluster = Cluster {
        vertices: vec![0; MOST_OF_CLUSTER + 1],
        triangles: Vec::new(),
    };
    let broken: [fn(&mut MeshUnit, Cluster); 4] = [
        |unit, _| unit.clusters[0].triangles[0][0] = 20,
        |unit, cluster| unit.clusters.push(cluster),
        |unit, _| unit.clusters = vec![Cluster::default(); MOST_CLUSTERS + 1],
        |unit, _| unit.vertices = vec![MeshVertex::default(); 1 << 16],
    ];
    for broken in broken {
        let mut unit = unit(Attributes::default());
        broken(&mut unit, cluster.clone());
        assert!(unit.write(Attributes::default()).is_err());
    }
}

#[test]
fn no_flipped_bit_and_no_cut_panics() {
    for attributes in all_attributes() {
        let bytes = unit(attributes).write(attributes).unwrap();
        for length in 0..bytes.len() {
            // A byte too few is a byte of a stream too few: only what fills up the last is spare.
            assert!(
                MeshUnit::parse(&bytes[..length], attributes, &[]).is_err(),
                "{length}"
            );
        }
        for bit in 0..8 * bytes.len() {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            if let Ok(unit) = MeshUnit::parse(&flipped, attributes, &[]) {
                in_range(&unit);
            }
        }
    }
}

fn in_range(unit: &MeshUnit) {
    let named = usize::from(unit.staying) + unit.vertices.len();
    for cluster in &unit.clusters {
        assert!(cluster.vertices.iter().all(|it| usize::from(*it) < named));
        let corners = cluster.triangles.as_flattened();
        assert!(
            corners
                .iter()
                .all(|it| usize::from(*it) < cluster.vertices.len())
        );
    }
}

#[test]
fn other_attributes_and_bytes_after_the_end_are_refused() {
    let plain = Attributes::default();
    let mut bytes = unit(plain).write(plain).unwrap();
    let other = Attributes {
        normals: true,
        ..plain
    };
    assert!(MeshUnit::parse(&bytes, other, &[]).is_err());
    bytes.push(0);
    assert!(MeshUnit::parse(&bytes, plain, &[]).is_err());
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..200), head in 0_usize..3) {
        for attributes in all_attributes() {
            let whole = unit(attributes).write(attributes).unwrap();
            let mut mixed = whole[..head * whole.len() / 3].to_vec();
            mixed.extend(&bytes);
            if let Ok(unit) = MeshUnit::parse(&mixed, attributes, &[]) {
                in_range(&unit);
            }
        }
    }

    #[test]
    fn any_unit_comes_back(
        staying in 0_u16..300,
        places in prop::collection::vec(any::<[u16; 3]>(), 1..200),
        names in prop::collection::vec(any::<prop::sample::Index>(), 3..100),
        corners in prop::collection::vec(any::<[prop::sample::Index; 3]>(), 0..100),
    ) {
        let named = usize::from(staying) + places.len();
        let vertices: Vec<u16> = names.iter().map(|it| it.index(named) as u16).collect();
        let corner = |it: prop::sample::Index| it.index(vertices.len()) as u8;
        let triangles: Vec<_> = corners.iter().map(|it| it.map(corner)).collect();
        let unit = MeshUnit {
            replaces: Vec::new(),
            staying,
            vertices: places.into_iter().map(MeshVertex::at).collect(),
            clusters: vec![Cluster { vertices, triangles }; 2],
        };
        let bytes = unit.write(Attributes::default()).unwrap();
        let back = MeshUnit::parse(&bytes, Attributes::default(), &unit.replaces).unwrap();
        prop_assert_eq!(turned(back), turned(unit));
    }
}

/// Triangles from their least corner: the codec may turn them.
fn turned(mut unit: MeshUnit) -> MeshUnit {
    for triangle in unit.clusters.iter_mut().flat_map(|it| &mut it.triangles) {
        let [a, b, c] = *triangle;
        *triangle = [[a, b, c], [b, c, a], [c, a, b]]
            .into_iter()
            .min()
            .unwrap_or(*triangle);
    }
    unit
}
