//! Do places, derivatives and corners have the numbers that an independent script computed?

use super::sets::{panel, six, three, twelve};
use crate::view::panel::distortion::Distortion;
use crate::view::panel::fit::{PlacementRule, SourceSize, covered, fit, place};
use crate::view::panel::footprint::Probes;
use crate::view::panel::lens::Bulge;
use crate::view::panel::pixel_map::{MappedPixel, PixelMap, homography};
use crate::view::panel::placement::Placement;
use crate::view::panel::rig::{Panel, axes_from_seed_angles};
use crate::view::panel::seed::{SeedPlane, edge_means};
use crate::view::panel::share::multi_probe_share;
use glam::DVec3;

const SOURCE: [u32; 2] = [1600, 1200];

fn refs(panels: &[Panel]) -> Vec<&Panel> {
    panels.iter().collect()
}

fn seed_of(panels: &[Panel]) -> SeedPlane {
    let corners: Vec<DVec3> = panels.iter().flat_map(Panel::corners).collect();
    SeedPlane::round(&corners, Some(4.0 / 3.0)).unwrap()
}

fn near(found: f64, wanted: f64, tolerance: f64) {
    assert!((found - wanted).abs() <= tolerance, "{found}, not {wanted}");
}

fn map<'a>(panel: &'a Panel, placement: &'a Placement) -> PixelMap<'a> {
    PixelMap {
        panel,
        placement,
        size: SOURCE,
    }
}

#[test]
fn corners_of_three_panels_lie_where_they_should() {
    let all = three();
    let [tl, tr, bl, br] = all[0].corners();
    let wanted = [
        (tl, [-0.942194856, 0.3375, -0.561042648]),
        (tr, [-0.204958016, 0.3375, -1.077261441]),
        (bl, [-0.942194856, -0.3375, -0.561042648]),
        (br, [-0.204958016, -0.3375, -1.077261441]),
        (all[1].corners()[0], [-0.45, 0.3375, -1.0]),
        (all[2].corners()[1], [0.942194856, 0.3375, -0.561042648]),
    ];
    for (found, wanted) in wanted {
        assert!(found.distance(DVec3::from_array(wanted)) < 1e-9, "{found}");
    }
}

#[test]
fn the_seed_plane_has_its_golden_sides() {
    let seed = seed_of(&three());
    near(seed.depth, -1.0772614406469625, 1e-12);
    near(seed.tight[0], 1.809114141305561, 1e-12);
    near(seed.tight[1], 0.6480358267934218, 1e-12);
    near(seed.half[1], 1.3568356059791709, 1e-12);
    near(seed.tangents()[0], 1.6793640550422704, 1e-12);
    near(seed.tangents()[1], 1.259523041281703, 1e-12);
    let corners: Vec<DVec3> = three().iter().flat_map(Panel::corners).collect();
    let wide = SeedPlane::round(&corners, Some(16.0 / 9.0)).unwrap();
    near(wide.half[1], 1.017626704484378, 1e-12);
    for (panels, depth, tangents) in [
        (
            six(),
            -1.1025889280738699,
            [1.9247719141535755, 1.4435789356151818],
        ),
        (
            twelve(),
            -1.0902770981900327,
            [5.9970384260596346, 4.497778819544726],
        ),
    ] {
        let seed = seed_of(&panels);
        // The angles of these sets are given to a millionth of a degree.
        near(seed.depth, depth, 1e-7);
        near(seed.tangents()[0], tangents[0], 2e-6);
        near(seed.tangents()[1], tangents[1], 2e-6);
    }
}

/// Panel, column, row; u, v; the four changes; the singular values.
type GoldenPixel = (usize, [u32; 2], [f64; 2], [f64; 4], [f64; 2]);

const PIXELS: [GoldenPixel; 10] = [
    (
        0,
        [0, 0],
        [0.850798, 314.077106],
        [1.700618, 0.0, 0.328660, 0.954668],
        [1.745346, 0.930202],
    ),
    (
        0,
        [799, 0],
        [709.135493, 450.959789],
        [0.462078, 0.0, 0.089301, 0.497630],
        [0.529986, 0.433868],
    ),
    (
        0,
        [0, 599],
        [0.850798, 885.922894],
        [1.700618, 0.0, -0.328660, 0.954668],
        [1.745346, 0.930202],
    ),
    (
        0,
        [100, 200],
        [153.379742, 514.803668],
        [1.368038, 0.0, 0.087834, 0.856245],
        [1.372646, 0.853370],
    ),
    (
        0,
        [400, 300],
        [466.840753, 600.326988],
        [0.798044, 0.0, -0.000257, 0.653977],
        [0.798044, 0.653976],
    ),
    (
        1,
        [0, 0],
        [585.901098, 439.492813],
        [0.535917, 0.0, 0.0, 0.535917],
        [0.535917, 0.535917],
    ),
    (
        1,
        [100, 200],
        [639.492813, 546.676243],
        [0.535917, 0.0, 0.0, 0.535917],
        [0.535917, 0.535917],
    ),
    (
        1,
        [799, 599],
        [1014.098902, 760.507187],
        [0.535917, 0.0, 0.0, 0.535917],
        [0.535917, 0.535917],
    ),
    (
        2,
        [100, 200],
        [940.017456, 547.329955],
        [0.522858, 0.0, -0.033570, 0.529347],
        [0.543466, 0.509275],
    ),
    (
        2,
        [799, 0],
        [1599.149202, 314.077106],
        [1.700618, 0.0, -0.328660, 0.954668],
        [1.745346, 0.930202],
    ),
];

#[test]
fn pixels_of_three_panels_map_to_their_golden_places_with_their_derivatives() {
    let all = three();
    let placement = seed_of(&all).placement();
    for (index, pixel, place, change, sigma) in PIXELS {
        let map = map(&all[index], &placement);
        let (analytic, means) = (
            map.of_pixel(pixel).unwrap(),
            edge_means(&map, pixel).unwrap(),
        );
        for found in [analytic, means] {
            // Six digits are printed.
            near(found.place[0], place[0], 1e-6);
            near(found.place[1], place[1], 1e-6);
            let [[ux, uy], [vx, vy]] = found.jacobian;
            for (found, wanted) in [ux, uy, vx, vy].into_iter().zip(change) {
                near(found, wanted, 2e-6);
            }
            for (found, wanted) in found.sigma().into_iter().zip(sigma) {
                near(found, wanted, 2e-6);
            }
        }
    }
}

#[test]
fn homographies_of_three_panels_are_golden_and_map_as_rays_do() {
    let all = three();
    let placement = seed_of(&all).placement();
    let wanted = [
        [
            [1.702573639, 0.0, 0.0],
            [0.6900796151, 0.9552164226, 313.4350732],
            [0.001150132692, 0.0, 1.0],
        ],
        [
            [0.5359171511, 0.0, 585.6331396],
            [0.0, 0.5359171511, 439.2248547],
            [0.0, 0.0, 1.0],
        ],
        [
            [-0.07168284311, 0.0, 890.6335368],
            [-0.3593965958, 0.4974810486, 450.7556854],
            [-0.0005989943263, 0.0, 1.0],
        ],
    ];
    for (panel, wanted) in all.iter().zip(wanted) {
        let found = homography(panel, &placement, SOURCE).unwrap();
        let scaled = found.transpose() * (1.0 / found.z_axis.z);
        for (row, wanted) in scaled.to_cols_array_2d().iter().zip(wanted) {
            for (found, wanted) in row.iter().zip(wanted) {
                near(*found, wanted, 1e-9 + 2e-10 * wanted.abs());
            }
        }
        for pixel in [[0, 0], [799, 599], [123, 456]] {
            let at = pixel.map(|it| f64::from(it) + 0.5);
            let place = found * DVec3::new(at[0], at[1], 1.0);
            let ray = map(panel, &placement).of_pixel(pixel).unwrap();
            near(place.x / place.z, ray.place[0], 1e-9);
            near(place.y / place.z, ray.place[1], 1e-9);
        }
    }
}

#[test]
fn panels_cover_their_golden_areas() {
    let all = three();
    let placement = seed_of(&all).placement();
    for (panel, area) in all.iter().zip([309_148.0, 137_859.0, 309_148.0]) {
        near(covered(&map(panel, &placement)), area, 0.5);
    }
    let all = twelve();
    let placement = seed_of(&all).placement();
    let [upper, middle] = [0, 6].map(|k| map(&all[k], &placement));
    near(covered(&upper), 141_830.0, 1.0);
    near(covered(&middle), 7_107.0, 0.5);
    let corner = |place| middle.at(place).unwrap().place;
    let (left, right) = (corner([0.0, 300.0])[0], corner([800.0, 300.0])[0]);
    near(left, 743.38, 0.01);
    near(right, 840.78, 0.01);
    let edges = [corner([0.0, 0.0])[1], corner([0.0, 600.0])[1]];
    near(edges[0], 562.8, 0.05);
    near(edges[1], 637.2, 0.05);
    let all = six();
    let placement = seed_of(&all).placement();
    let first = map(&all[0], &placement);
    for (at, wanted) in [
        ([0.0, 0.0], [0.00, 170.05]),
        ([800.0, 0.0], [669.32, 392.21]),
        ([800.0, 600.0], [651.29, 634.84]),
        ([0.0, 600.0], [70.91, 666.24]),
    ] {
        let found = first.at(at).unwrap().place;
        near(found[0], wanted[0], 0.006);
        near(found[1], wanted[1], 0.006);
    }
}

#[test]
fn a_bulge_has_its_height_and_moves_places_towards_the_eye_or_away() {
    let bulge = Bulge { height: 0.15 };
    for (at, wanted) in [
        ([400.0, 300.0], 0.15),
        ([100.0, 300.0], 0.065625),
        ([200.0, 150.0], 0.075),
        ([100.0, 75.0], 0.0),
        ([0.0, 0.0], 0.0),
        ([0.0, 300.0], 0.0),
        ([400.0, 0.0], 0.0),
    ] {
        near(bulge.height_at([800, 600], at), wanted, 1e-12);
    }
    let all = three();
    let placement = seed_of(&all).placement();
    for (index, pixel, wanted) in [
        (
            1,
            [200, 150],
            [
                [693.0845, 519.8804],
                [684.3611, 513.3433],
                [700.5841, 525.5004],
            ],
        ),
        (
            2,
            [600, 450],
            [
                [1323.7277, 716.9303],
                [1342.2025, 728.2899],
                [1308.2585, 707.4187],
            ],
        ),
    ] {
        for (height, wanted) in [0.0, 0.15, -0.15].into_iter().zip(wanted) {
            let panel = Panel {
                distortion: Distortion::Bulge(Bulge { height }),
                ..all[index].clone()
            };
            let found = map(&panel, &placement).of_pixel(pixel).unwrap();
            near(found.place[0], wanted[0], 6e-5);
            near(found.place[1], wanted[1], 6e-5);
        }
    }
}

#[test]
fn turns_of_the_seed_have_their_golden_matrix() {
    let radians = |degrees: f64| degrees.to_radians();
    let axes = axes_from_seed_angles(radians(7.0), radians(12.0), radians(40.0));
    let rows = [
        [0.776621456, 0.119206206, -0.618586287],
        [0.039289570, 0.970856637, 0.236418528],
        [0.628741158, -0.207911691, 0.749304534],
    ];
    for (k, row) in rows.iter().enumerate() {
        near(axes.right[k], row[0], 1e-9);
        near(-axes.down[k], row[1], 1e-9);
        near(-axes.forward[k], row[2], 1e-9);
    }
    let corner = panel("a", axes, [0.8, 0.6], [8, 6]).corners()[0];
    let wanted = DVec3::new(0.343699567, 0.039122635, -1.063174505);
    assert!(corner.distance(wanted) < 1e-9, "{corner}");
    // One angle at a time: right, down, clockwise.
    let ten = radians(10.0);
    let looks = |roll, pitch, yaw| axes_from_seed_angles(roll, pitch, yaw);
    assert!(looks(0.0, 0.0, ten).forward.x > 0.17);
    assert!(looks(0.0, ten, 0.0).forward.y < -0.17);
    assert!(looks(ten, 0.0, 0.0).right.y < -0.17);
}

/// The Jacobian and most probes; radii and angle; wanted, count and level; step; weights up to the
/// middle.
type GoldenProbes<'a> = (
    ([[f64; 2]; 2], u32),
    [f64; 3],
    (f64, u32, f64),
    [f64; 2],
    &'a [f64],
);

const OF_SEVEN: [f64; 4] = [0.070159, 0.131075, 0.190713, 0.216106];
const OF_FIVE: [f64; 3] = [0.120078, 0.233881, 0.292082];
/// Square roots of 27 and 3.
const TURNED: [[f64; 2]; 2] = [[5.196152422706632, -1.0], [3.0, 1.7320508075688772]];

const PROBES: [GoldenProbes<'_>; 6] = [
    (
        ([[4.0, 0.0], [0.0, 1.0]], 16),
        [4.0, 1.0, 0.0],
        (7.0, 7, 0.0),
        [1.0, 0.0],
        &OF_SEVEN,
    ),
    (
        ([[1.0, 0.0], [0.0, 4.0]], 16),
        [4.0, 1.0, core::f64::consts::FRAC_PI_2],
        (7.0, 7, 0.0),
        [0.0, 1.0],
        &OF_SEVEN,
    ),
    (
        ([[8.0, 0.0], [0.0, 1.0]], 4),
        [8.0, 3.2, 0.0],
        (15.0, 4, 1.678072),
        [3.2, 0.0],
        &[0.172623, 0.327377],
    ),
    (
        (TURNED, 16),
        [6.0, 2.0, core::f64::consts::FRAC_PI_6],
        (5.0, 5, 1.0),
        [1.732051, 1.0],
        &OF_FIVE,
    ),
    (
        ([[3.2, 0.4], [0.3, 1.1]], 16),
        [3.257378, 1.085793, 0.149249],
        (5.241479, 5, 0.118749),
        [1.073722, 0.161453],
        &OF_FIVE,
    ),
    (
        ([[3.401235, 0.0], [0.657321, 1.909335]], 16),
        [3.490692, 1.860405, 0.269077],
        (2.752616, 3, 0.895616),
        [1.571624, 0.433398],
        &[0.281937, 0.436127],
    ),
];

#[test]
fn probes_of_feline_are_golden() {
    for ((jacobian, most), [major, minor, angle], (wanted, count, level), step, half) in PROBES {
        let found = Probes::of(jacobian, most, 20.0);
        near(found.major, major, 2e-6);
        near(found.minor, minor, 2e-6);
        near(found.angle, angle, 1e-6);
        near(found.wanted, wanted, 2e-6);
        assert_eq!(found.count, count);
        near(found.level, level, 1e-6);
        near(found.step[0], step[0], 2e-6);
        near(found.step[1], step[1], 2e-6);
        let weights = found.weights();
        assert_eq!(weights.len(), count as usize);
        near(weights.iter().sum(), 1.0, 1e-12);
        for (k, wanted) in half.iter().enumerate() {
            near(weights[k], *wanted, 1e-6);
            near(weights[weights.len() - 1 - k], *wanted, 1e-6);
        }
    }
    let one = Probes::of([[0.5, 0.0], [0.0, 0.4]], 16, 20.0);
    assert_eq!((one.major, one.minor, one.count), (1.0, 1.0, 1));
    assert_eq!((one.level, one.weights()), (0.0, vec![1.0]));
    // Beyond the coarsest mip there is one probe in it.
    let coarse = Probes::of([[64.0, 0.0], [0.0, 16.0]], 16, 3.0);
    assert_eq!(
        (coarse.count, coarse.level, coarse.step),
        (1, 3.0, [0.0; 2])
    );
}

#[test]
fn needs_are_those_of_the_seed_and_less_of_better_placements() {
    let sets = [
        (three(), 10.21, 4.98, 1.78),
        (six(), 17.84, 5.95, 2.81),
        (twelve(), 184.2, 22.2, 5.05),
    ];
    for (panels, seed, plane, equirect) in sets {
        let panels = refs(&panels);
        let need = |rule, source| {
            let found = fit(&panels, rule, source).unwrap();
            found.need[0] * found.need[1] / 1e6
        };
        let found = [
            need(PlacementRule::Seed, Some(SOURCE)),
            need(PlacementRule::Plane, Some(SOURCE)),
            need(PlacementRule::Equirect, None),
        ];
        // A picture is not stretched: its window is grown.
        let picture = fit(&panels, PlacementRule::Plane, SourceSize::Picture(SOURCE)).unwrap();
        let [width, height] = picture.placement.extent();
        assert!(
            (height * 4.0 / 3.0 / width - 1.0).abs() < 1e-9,
            "{picture:?}"
        );
        assert!(picture.need[0] * picture.need[1] > found[1] * 1e6);
        assert!((found[0] / seed - 1.0).abs() < 0.02, "{found:?}");
        assert!(found[1] <= plane && found[2] <= equirect, "{found:?}");
        assert!(found[2] > 0.9 * equirect, "{found:?}");
    }
}

#[test]
fn shares_that_are_seen_and_that_take_several_probes_are_as_computed() {
    let sets = [
        (three(), 0.353, 0.126),
        (six(), 0.315, 0.043),
        (twelve(), 0.192, 0.040),
    ];
    for (panels, seen, several) in sets {
        let panels = refs(&panels);
        let found = fit(&panels, PlacementRule::Seed, Some(SOURCE)).unwrap();
        near(found.seen_share, seen, 0.003);
        let (placement, _) = place(&panels, PlacementRule::Seed, Some(SOURCE)).unwrap();
        near(
            multi_probe_share(&panels, &placement, SOURCE, 16),
            several,
            0.003,
        );
    }
}

#[test]
fn mapped_pixels_tell_singular_values() {
    let found = MappedPixel {
        place: [0.0; 2],
        jacobian: [[27.0_f64.sqrt(), -1.0], [3.0, 3.0_f64.sqrt()]],
    };
    let [large, small] = found.sigma();
    near(large, 6.0, 1e-12);
    near(small, 2.0, 1e-12);
}
