//! Does a cloud come back from its units?

use super::super::{BuildOptions, Built, build};
use crate::generate::{cloud_of_torus, noisy_plane};
use crate::source::{SourceCloud, SourceScene};
use foveal_core::content::points::cloud::Cloud;
use foveal_core::content::points::cut::PointCut;
use foveal_core::content::points::payload::{CloudPoint, MOST_POINTS, PointUnit};
use foveal_core::pack::unit::UnitId;
use glam::DAffine3;

fn scene(clouds: Vec<SourceCloud>) -> SourceScene {
    SourceScene {
        clouds,
        ..SourceScene::default()
    }
}

fn built_with(source: &SourceScene, jobs: usize) -> Built {
    let options = BuildOptions {
        jobs,
        ..BuildOptions::default()
    };
    build(source, &options, &|_, _| ()).unwrap()
}

fn built(cloud: &SourceCloud) -> Built {
    built_with(&scene(vec![cloud.clone()]), 2)
}

fn parsed(built: &Built, unit: usize) -> (PointUnit, Cloud) {
    let unit = &built.units[unit];
    let cloud = *built.objects[usize::from(unit.row.object)]
        .shape
        .cloud()
        .unwrap();
    (
        PointUnit::parse(&unit.payload, cloud.attributes).unwrap(),
        cloud,
    )
}

/// What the file would hold of a point: coordinates, colour, intensity and class.
type FoundPoint = ([i32; 3], [u16; 3], u16, u8);

/// All points of the units of one object, in the colours that they have in the end.
fn points_of(built: &Built, object: u16) -> Vec<FoundPoint> {
    let units: Vec<_> = (0..built.units.len()).map(|it| parsed(built, it)).collect();
    let mut all = Vec::new();
    for (number, (unit, cloud)) in units.iter().enumerate() {
        if built.units[number].row.object != object {
            continue;
        }
        let mut points = unit.points.clone();
        for (child, (says, _)) in units.iter().enumerate() {
            if built.units[child].row.needs != [UnitId(number as u32)] {
                continue;
            }
            let inside = points.iter_mut().filter(|it| says.has_inside(it.place));
            let mut corrected = 0;
            for (point, by) in inside.zip(&says.corrections) {
                point.colour = [0, 1, 2].map(|k| (i32::from(point.colour[k]) + by[k]) as u16);
                corrected += 1;
            }
            assert_eq!(corrected, says.corrections.len());
        }
        all.extend(points.iter().map(|it| told(it, cloud)));
    }
    all.sort_unstable();
    all
}

fn told(point: &CloudPoint, cloud: &Cloud) -> FoundPoint {
    (
        [0, 1, 2].map(|k| (cloud.least[k] + i64::from(point.place[k])) as i32),
        point.colour.map(|it| it * cloud.colour_times),
        point.intensity,
        point.class,
    )
}

fn points_of_file(cloud: &SourceCloud) -> Vec<FoundPoint> {
    let point = |k: usize| {
        (
            cloud.places[k],
            cloud.colours.get(k).copied().unwrap_or_default(),
            cloud.intensities.get(k).copied().unwrap_or_default(),
            cloud.classes.get(k).copied().unwrap_or_default(),
        )
    };
    let mut all: Vec<FoundPoint> = (0..cloud.places.len()).map(point).collect();
    all.sort_unstable();
    all
}

/// Much in one corner, next to nothing elsewhere, and many points at one place.
fn lopsided() -> SourceCloud {
    let mut cloud = noisy_plane(30_000);
    cloud.places.truncate(20_000);
    cloud.places.extend([[7, 7, 7]; 9_990]);
    cloud
        .places
        .extend((0..10).map(|k| [i32::MAX - k, i32::MIN + k, k * 1000]));
    cloud
}

#[test]
fn all_units_together_are_the_file_bit_for_bit() {
    for cloud in [
        cloud_of_torus(50_000),
        noisy_plane(3),
        noisy_plane(40_000),
        lopsided(),
    ] {
        let built = built(&cloud);
        assert!(points_of(&built, 0) == points_of_file(&cloud));
        assert_eq!(built.objects[0].shape.samples(), cloud.places.len() as u64);
    }
}

#[test]
fn units_are_small_and_nested_and_their_errors_only_grow_towards_the_root() {
    for cloud in [cloud_of_torus(50_000), lopsided()] {
        let built = built(&cloud);
        assert!(built.units.len() > 6 && built.levels > 2);
        for (number, unit) in built.units.iter().enumerate() {
            let (says, _) = parsed(&built, number);
            assert!(says.points.len() <= MOST_POINTS);
            assert_eq!(unit.row.samples as usize, says.points.len());
            assert_eq!(unit.level == built.levels - 1, unit.row.needs.is_empty());
            for need in &unit.row.needs {
                let outer = &built.units[need.0 as usize];
                assert!(need.0 < number as u32 && outer.level > unit.level);
                assert!(unit.row.error <= outer.row.error);
                let apart = [0, 1, 2]
                    .map(|k| f64::from(outer.row.centre[k]) - f64::from(unit.row.centre[k]));
                let apart = apart.iter().map(|it| it * it).sum::<f64>().sqrt();
                assert!(apart + f64::from(unit.row.radius) <= f64::from(outer.row.radius));
            }
        }
    }
}

#[test]
fn units_fit_into_a_cut_in_their_order() {
    let built = built(&cloud_of_torus(50_000));
    let mut cut = PointCut::default();
    for (number, unit) in built.units.iter().enumerate() {
        let (says, cloud) = parsed(&built, number);
        let refines = unit
            .row
            .needs
            .first()
            .map(|it| (*it, unit.row.replaces[0].part));
        cut.insert(UnitId(number as u32), refines, &says, &cloud)
            .unwrap();
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let source = scene(vec![cloud_of_torus(50_000), noisy_plane(20_000)]);
    let one = built_with(&source, 1);
    assert_eq!(built_with(&source, 3), one);
    assert!(points_of(&one, 1) == points_of_file(&source.clouds[1]));
}

#[test]
fn a_point_of_few_stands_for_those_round_it_in_their_mean_colour() {
    let mut cloud = noisy_plane(40_000);
    cloud.colours = (0..40_000)
        .map(|k| [[0; 3], [200 * 257; 3]][k % 2])
        .collect();
    let built = built(&cloud);
    let (root, _) = parsed(&built, 0);
    let reds = root.points.iter().map(|it| f64::from(it.colour[0]));
    let mean = reds.sum::<f64>() / root.points.len() as f64;
    // The root of the mean square of 0 and 200.
    assert!((mean - 141.4).abs() < 15.0, "{mean}");
}

#[test]
fn clouds_that_contradict_themselves_are_refused() {
    let good = noisy_plane(5);
    let mut all = vec![good.clone(); 4];
    all[0].intensities.pop();
    all[1].scale[2] = f64::NAN;
    all[2].placements.clear();
    all[3].places.clear();
    for cloud in all {
        let refused = build(&scene(vec![cloud]), &BuildOptions::default(), &|_, _| ());
        assert!(refused.unwrap_err().to_string().contains("mend the file"));
    }
}

#[test]
fn of_very_many_points_at_one_place_some_are_left_out_and_that_is_told() {
    let mut places = vec![[1, 2, 3]; 400_000];
    places.extend((0..1000).map(|k| [k, i32::MAX - k, i32::MIN + k * k]));
    let many = SourceCloud {
        places,
        placements: vec![DAffine3::IDENTITY],
        scale: [1e-6; 3],
        ..SourceCloud::default()
    };
    let built = build(&scene(vec![many]), &BuildOptions::default(), &|_, _| ()).unwrap();
    let left = 400_000 - (1 << 15);
    assert_eq!(built.repairs["points_of_one_place"], left);
    let told = format!("{left} of 401000 points are left out");
    assert!(built.remarks[0].contains(&told), "{:?}", built.remarks);
    let kept: u64 = built.units.iter().map(|it| u64::from(it.row.samples)).sum();
    assert_eq!(kept, 1000 + (1 << 15));
}

#[test]
fn units_of_a_cloud_of_one_grey_add_no_contrast_and_those_of_noise_much() {
    let mut cloud = noisy_plane(40_000);
    cloud.intensities.clear();
    let contrast = |cloud: &SourceCloud| {
        let built = built(cloud);
        let finer = built.units.iter().filter(|it| !it.row.needs.is_empty());
        let added: Vec<f64> = finer
            .map(|it| it.row.signature.bands[0].difference)
            .collect();
        added.iter().sum::<f64>() / added.len() as f64
    };
    cloud.colours = vec![[120 * 257; 3]; 40_000];
    assert!(contrast(&cloud) < 1e-9, "{}", contrast(&cloud));
    cloud.colours = (0..40_000)
        .map(|k| [[60 * 257; 3], [200 * 257; 3]][k % 2])
        .collect();
    assert!(contrast(&cloud) > 0.2, "{}", contrast(&cloud));
}
