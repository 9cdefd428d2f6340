//! Do places, directions and densities of every kind of content fit together?

use super::*;
use crate::view::axes::angle_between;

#[test]
fn every_cube_face_has_the_handedness_of_the_world() {
    for axes in CUBE_FACES {
        assert_eq!(axes.right.cross(axes.down), axes.forward);
    }
}

#[test]
fn a_place_on_the_cube_survives_the_way_to_a_direction_and_back() {
    for mapping in [Mapping::Gnomonic, Mapping::EquiAngular] {
        let cube = Surface::cube(64).mapped(mapping);
        for face in 0..6 {
            for y in 0..64 {
                for x in 0..64 {
                    let place = [f64::from(x) + 0.5, f64::from(y) + 0.5];
                    let found = cube.locate(cube.direction(face, place)).unwrap();
                    assert_eq!(found.0, face);
                    assert!((found.1[0] - place[0]).abs() < 64e-12);
                    assert!((found.1[1] - place[1]).abs() < 64e-12);
                }
            }
        }
    }
}

#[test]
fn equi_angular_places_are_even_in_angle_and_have_the_density_of_the_equator() {
    let cube = Surface::cube(256).mapped(Mapping::EquiAngular);
    let at = |x: f64| cube.direction(0, [x, 128.0]);
    for x in 0..256 {
        let step = angle_between(at(f64::from(x)), at(f64::from(x) + 1.0));
        assert!((step.to_degrees() - 90.0 / 256.0).abs() < 1e-9, "{x}");
    }
    // A picture of 1024 columns round the equator.
    assert!((cube.ppd([128.0; 2]).0 - 1024.0 / 360.0).abs() < 1e-9);
    // A pixel's long side is at most 1.16 times as long anywhere.
    assert!(cube.ppd([0.0; 2]).0 > 1024.0 / 360.0 / 1.16);
}

#[test]
fn the_density_of_a_pixel_is_what_its_neighbours_are_apart() {
    for mapping in [Mapping::Gnomonic, Mapping::EquiAngular] {
        let cube = Surface::cube(512).mapped(mapping);
        for place in [[256.0, 256.0], [20.0, 300.0], [3.0, 5.0], [500.0, 256.0]] {
            let from = cube.direction(1, place);
            let widest = (0..64).map(|step| {
                let turn = f64::from(step) / 64.0 * PI;
                let to = [place[0] + 0.01 * turn.cos(), place[1] + 0.01 * turn.sin()];
                (cube.direction(1, to) - from).length() / 0.01
            });
            let widest = Radians(widest.fold(0.0, f64::max)).to_degrees();
            let told = 1.0 / cube.ppd(place).0;
            assert!((widest / told - 1.0).abs() < 0.003, "{mapping:?} {place:?}");
            // Sides of one pixel give its area.
            let [right, down] = [[0.01, 0.0], [0.0, 0.01]]
                .map(|step| cube.direction(1, [place[0] + step[0], place[1] + step[1]]) - from);
            let area = right.cross(down).length() / 1e-4;
            let cos = from.dot(cube.axes(1).forward);
            let side = Radians::from_degrees(told).0;
            let told = side * side * cos * cube.shape(place);
            assert!((area / told - 1.0).abs() < 0.003, "{mapping:?} {place:?}");
        }
    }
}

#[test]
fn a_desk_screen_fills_about_48_degrees() {
    let screen = Surface::flat([1920, 1080], Screen::default());
    let degrees = Radians(2.0 * libm::atan(screen.tangents[0])).to_degrees();
    assert!((degrees - 47.77).abs() < 0.05, "{degrees}");
}

#[test]
fn density_grows_from_the_centre_of_a_face_to_its_corner() {
    let cube = Surface::cube(4096);
    let centre = cube.ppd([2048.0, 2048.0]).0;
    assert!((centre - 35.74).abs() < 0.01, "{centre}");
    assert!(cube.ppd([0.0, 0.0]).0 > 1.7 * centre);
}

#[test]
fn a_panorama_without_poles_has_nothing_above_and_below() {
    let panorama = Surface::cube(8).without_poles();
    assert_eq!((panorama.faces(), panorama.pixels()), (4, 4 * 64));
    assert_eq!(panorama.locate(DVec3::new(0.1, 1.0, 0.1)), None);
    assert_eq!(panorama.locate(DVec3::new(0.1, -1.0, 0.1)), None);
    assert_eq!(panorama.locate(DVec3::X).map(|found| found.0), Some(1));
}

#[test]
fn the_faces_of_the_right_eye_lie_where_those_of_the_left_do() {
    for surface in [Surface::cube(8), Surface::cube(8).without_poles()] {
        let both = surface.for_two_eyes();
        let right = both.first_face(Eye::Right);
        assert_eq!(
            (both.faces(), right),
            (2 * surface.faces(), surface.faces())
        );
        assert_eq!(surface.first_face(Eye::Right), 0);
        for face in 0..surface.faces() {
            assert_eq!(both.axes(right + face), surface.axes(face));
        }
    }
}

#[test]
fn wide_pixels_fill_the_screen_that_twice_as_many_square_ones_do() {
    let screen = Screen::default();
    let wide = Surface::flat_with_pixels([960, 1080], [2, 1], screen);
    let square = Surface::flat([1920, 1080], screen);
    assert_eq!(wide.tangents, square.tangents);
    assert!(wide.pitch() > 1.9 * square.pitch());
}

#[test]
fn yaw_to_the_right_lands_on_the_right_face() {
    let degrees = Radians::from_degrees;
    let cube = Surface::cube(8);
    let face = |yaw, pitch| {
        cube.locate(direction_from_yaw_pitch(degrees(yaw), degrees(pitch)))
            .unwrap()
            .0
    };
    assert_eq!(face(90.0, 0.0), 1);
    assert_eq!(face(-90.0, 0.0), 3);
    assert_eq!(face(0.0, 80.0), 4);
    assert_eq!(face(0.0, -80.0), 5);
    assert_eq!(face(180.0, 0.0), 2);
}

#[test]
fn a_place_on_a_sphere_survives_the_way_to_a_direction_and_back() {
    let sphere = Surface::equirect([64, 32]);
    for y in 0..32 {
        for x in 0..64 {
            let place = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let (face, found) = sphere.locate(sphere.direction(0, place) * 3.0).unwrap();
            assert_eq!(face, 0);
            assert!(
                (0..2).all(|k| (found[k] - place[k]).abs() < 1e-9),
                "{place:?}"
            );
        }
    }
}

#[test]
fn beyond_the_borders_of_a_sphere_lies_its_other_side() {
    let sphere = Surface::equirect([64, 32]);
    assert!((sphere.direction(0, [32.0, 16.0]) - DVec3::NEG_Z).length() < 1e-12);
    assert!((sphere.direction(0, [48.0, 16.0]) - DVec3::X).length() < 1e-12);
    for (beyond, within) in [
        ([-1.0, 9.0], [63.0, 9.0]),
        ([66.0, 9.0], [2.0, 9.0]),
        ([5.0, -2.0], [37.0, 2.0]),
        ([40.0, 35.0], [8.0, 29.0]),
    ] {
        assert_eq!(sphere.closed(beyond), within);
        let [a, b] = [beyond, within].map(|place| sphere.direction(0, place));
        assert!((a - b).length() < 1e-12, "{beyond:?}");
    }
    for pole in [DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::new(-0.0, 0.0, 1.0)] {
        let (_, [x, y]) = sphere.locate(pole).unwrap();
        assert!(
            (0.0..64.0).contains(&x) && (0.0..32.0).contains(&y),
            "{pole}"
        );
    }
}

#[test]
fn the_density_of_a_row_of_a_sphere_is_that_of_its_sparser_axis() {
    let area_of = |sphere: Surface, place: [f64; 2]| {
        let from = sphere.direction(0, place);
        let [right, down] = [[0.01, 0.0], [0.0, 0.01]]
            .map(|step| sphere.direction(0, [place[0] + step[0], place[1] + step[1]]) - from);
        let wider = right.length().max(down.length()) / 0.01;
        let told = Radians::from_degrees(1.0 / sphere.ppd(place).0).0;
        assert!((wider / told - 1.0).abs() < 0.01, "{place:?}");
        let area = right.cross(down).length() / 1e-4;
        let told = told * told * sphere.shape(place);
        assert!((area / told - 1.0).abs() < 0.01, "{place:?}");
    };
    for y in [6.0, 60.0, 128.0, 250.0] {
        area_of(Surface::equirect([512, 256]), [100.0, y]);
        // Squeezed across: from 60 degrees on rows are what is sparse.
        area_of(Surface::equirect([256, 256]), [100.0, y]);
    }
    let sphere = Surface::equirect([512, 256]);
    assert!((sphere.ppd([7.0, 128.0]).0 - 512.0 / 360.0).abs() < 1e-9);
    assert!((sphere.ppd([7.0, 3.0]).0 - 512.0 / 360.0).abs() < 1e-9);
}

#[test]
fn pixels_of_an_equirectangular_picture_look_where_the_format_says() {
    let sphere = Surface::equirect([8, 4]);
    let format = include_str!("../../../../../docs/formats/pack.md");
    for (pixel, line) in [([0, 0], "(0, 0)"), ([4, 2], "(4, 2)"), ([7, 3], "(7, 3)")] {
        let direction = sphere.direction(0, pixel.map(|k| f64::from(k) + 0.5));
        let told = format.lines().find_map(|it| it.strip_prefix(line)).unwrap();
        let told: Vec<f64> = told
            .split_whitespace()
            .map(|k| k.parse().unwrap())
            .collect();
        assert_eq!(told.len(), 3, "{line}");
        for (k, told) in told.into_iter().enumerate() {
            assert!((direction[k] - told).abs() < 1e-7, "{line}: {direction}");
        }
    }
}
