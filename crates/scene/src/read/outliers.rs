//! Which parts of a mesh or cloud lie so far from the others that they would take their detail?
//!
//! A grid spans all of an object. One stray triangle 30 km away leaves a model of 100 m some fifty
//! steps of it, and one point that stands for no echo (-9999, 1e10) leaves a cloud one. So what
//! lies far becomes an object with a grid of its own; what stands for nothing is left out.

use glam::DVec3;

use super::colour::unless_black;
use super::sound::count;
use super::text::shortened;
use crate::source::{SourceCloud, SourceMesh, SourceObject, SourceScene};

/// So many places show where most of them lie.
const MOST_SAMPLES: usize = 4096;
/// What may lie far on each side of an axis, as a share of these.
const TAIL: f64 = 0.05;
/// Most parts of a mesh or cloud.
const MOST_PARTS: usize = 8;
/// Parts that lie more than so many times as far as the others reach are reported.
const TOLD: f64 = 16.0;
/// A surface is cut between what lies far and all else only where its grid would have a few dozen
/// steps for that, and where no more than half is far.
const CUT: f64 = 256.0;
const MOST_CUT: f64 = 0.5;
/// Few points so many times as far away are no part of what was scanned.
const NO_ECHO: f64 = 4.0;
const FEW_POINTS: f64 = 0.01;
/// Farther away nothing is placed.
const FARTHEST: f64 = 1e14;

/// Where most of some places lie.
#[derive(Clone, Copy, Debug)]
struct Bulk {
    low: DVec3,
    high: DVec3,
    /// How far beyond that box others lie without a gap as long as it.
    reach: f64,
}

impl Bulk {
    /// Of so many places in a box; none where all of them lie together.
    fn of(places: usize, [least, most]: [DVec3; 2], at: &dyn Fn(usize) -> DVec3) -> Option<Self> {
        let every = places.div_ceil(MOST_SAMPLES).max(1);
        let sample = (0..places).step_by(every).map(at).collect();
        let [low, high] = middle(sample)?;
        let bulk = Self {
            low,
            high,
            reach: 0.0,
        };
        let length = (high - low).max_element();
        if bulk.beyond(least).max(bulk.beyond(most)) <= length {
            return None;
        }
        let mut beyond: Vec<f64> = (0..places)
            .map(|number| bulk.beyond(at(number)))
            .filter(|it| *it > length)
            .collect();
        if beyond.is_empty() {
            return None;
        }
        beyond.sort_by(f64::total_cmp);
        let mut reach = length;
        for next in beyond.iter().copied() {
            if next - reach > length {
                return Some(Self { reach, ..bulk });
            }
            reach = next;
        }
        None
    }

    /// How far beyond its box a place lies, along the axis where that is most.
    fn beyond(&self, place: DVec3) -> f64 {
        (self.low - place).max(place - self.high).max_element()
    }

    fn holds(&self, place: DVec3) -> bool {
        self.beyond(place) <= self.reach
    }
}

/// The box in which most of a sample lies; none of a sample at one place.
fn middle(mut sample: Vec<DVec3>) -> Option<[DVec3; 2]> {
    // Where a gap is longer than what lies on either side of it, one side counts alone.
    while let Some(side) = larger_side(&sample) {
        sample = side;
    }
    let [mut low, mut high] = [DVec3::ZERO; 2];
    for axis in 0..3 {
        let along = sorted(&sample, axis);
        let tail = (along.len() as f64 * TAIL) as usize;
        low[axis] = *along.get(tail)?;
        high[axis] = *along.get(along.len() - 1 - tail)?;
    }
    ((high - low).max_element() > 0.0).then_some([low, high])
}

fn sorted(sample: &[DVec3], axis: usize) -> Vec<f64> {
    let mut along: Vec<f64> = sample.iter().map(|it| it[axis]).collect();
    along.sort_by(f64::total_cmp);
    along
}

/// The larger side of a gap along an axis that is longer than either side is along any.
fn larger_side(sample: &[DVec3]) -> Option<Vec<DVec3>> {
    for axis in 0..3 {
        let along = sorted(sample, axis);
        let gaps = along.windows(2).enumerate();
        let widest = gaps.max_by(|a, b| (a.1[1] - a.1[0]).total_cmp(&(b.1[1] - b.1[0])));
        let Some((_, [end, begin])) = widest.map(|(at, pair)| (at, [pair[0], pair[1]])) else {
            continue;
        };
        let is_low = |it: &&DVec3| it[axis] <= end;
        let (low, high): (Vec<&DVec3>, Vec<&DVec3>) = sample.iter().partition(|it| is_low(it));
        let [lower, upper] = [&low, &high].map(|side| extent(side.iter().map(|it| **it)));
        if begin - end > lower.max(upper) {
            // Copies of one place stand for nothing.
            let keeps_low = match (lower > 0.0, upper > 0.0) {
                (true, false) => true,
                (false, true) => false,
                _ => low.len() >= high.len(),
            };
            let kept = if keeps_low { low } else { high };
            return Some(kept.into_iter().copied().collect());
        }
    }
    None
}

/// The longest side of the box round places; 0 of none.
fn extent(places: impl Iterator<Item = DVec3>) -> f64 {
    let [low, high] = bounds(places);
    (high - low).max_element().max(0.0)
}

fn bounds(places: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    places.fold(none, |[low, high], it| [low.min(it), high.max(it)])
}

/// How many times as far as places near reach those far lie.
fn ratio(near: [DVec3; 2], far: [DVec3; 2]) -> f64 {
    let reach = (near[1] - near[0]).max_element();
    let all = near[1].max(far[1]) - near[0].min(far[0]);
    all.max_element() / reach.max(f64::MIN_POSITIVE)
}

/// A place for people.
fn told(place: DVec3) -> String {
    let along = place.to_array().map(|it| match it.abs() {
        large if large >= 1e7 => format!("{it:e}"),
        _ => format!("{}", (it * 10.0).round() / 10.0),
    });
    along.join(", ")
}

/// Makes what lies far in meshes objects of their own, and leaves out what lies nowhere.
pub(super) fn part_meshes(scene: &mut SourceScene) {
    for number in 0..scene.meshes.len() {
        leave_out_beyond(scene, number);
        let (mut parts, mut at) = (Vec::new(), number);
        while parts.len() + 1 < MOST_PARTS
            && let Some((far, is_cut)) = part_mesh(scene, at, number)
        {
            at = scene.meshes.len();
            scene.meshes.push(far);
            parts.push((at, is_cut));
        }
        for (part, (mesh, is_cut)) in parts.into_iter().enumerate() {
            tell_part(scene, (number, mesh), is_cut);
            let shown = scene.objects.iter().filter(|it| it.mesh == number);
            let objects: Vec<SourceObject> = shown
                .map(|it| SourceObject {
                    name: format!("{}, far part {}", it.name, part + 1),
                    mesh,
                    placements: it.placements.clone(),
                })
                .collect();
            scene.objects.extend(objects);
        }
    }
}

/// The name of the first object that shows a mesh, for people.
fn name_of(scene: &SourceScene, mesh: usize) -> String {
    let mut objects = scene.objects.iter();
    let shown = objects.find(|it| it.mesh == mesh);
    shown.map_or(String::new(), |it| shortened(&it.name))
}

/// Leaves out triangles so far away that nothing is placed there, unless all are.
fn leave_out_beyond(scene: &mut SourceScene, number: usize) {
    let mesh = &scene.meshes[number];
    let is_beyond = |it: &DVec3| it.abs().max_element() > FARTHEST;
    if !mesh.positions.iter().any(is_beyond) {
        return;
    }
    let is_out = |corner: &u32| is_beyond(&mesh.positions[*corner as usize]);
    let stays: Vec<bool> = mesh
        .triangles
        .iter()
        .map(|it| !it.iter().any(is_out))
        .collect();
    let lost = stays.iter().filter(|it| !**it).count();
    if lost == stays.len() {
        return;
    }
    let name = name_of(scene, number);
    scene.meshes[number].keep_triangles(&stays);
    count(&mut scene.repairs, "outlier_triangles_left_out", lost);
    scene.remark(format!(
        "{lost} triangles of {name:?} have a corner more than {FARTHEST:e} from the origin: they \
         are left out"
    ));
}

/// Reports a part of a mesh that was made another one, if it lies far enough to matter.
fn tell_part(scene: &mut SourceScene, (near, far): (usize, usize), is_cut: bool) {
    let of = |mesh: usize| bounds(scene.meshes[mesh].positions.iter().copied());
    let [low, high] = of(far);
    if ratio(of(near), [low, high]) < TOLD {
        return;
    }
    let triangles = scene.meshes[far].triangles.len();
    let what = match is_cut {
        true => {
            ", whose step is coarser: narrow ones vanish on it, and there is a gap of up to a step \
             where they meet"
        }
        false => "",
    };
    scene.remark(format!(
        "{triangles} triangles of {:?} lie far from its others, about {}: they are an object with \
         a grid of its own{what}",
        name_of(scene, near),
        told((low + high) / 2.0),
    ));
    count(&mut scene.repairs, "outlier_triangles", triangles);
}

/// Takes out of a mesh what lies far, and returns whether that was joined to the rest. The mesh is
/// that of objects which show mesh `shown`, or a part of it.
fn part_mesh(scene: &mut SourceScene, number: usize, shown: usize) -> Option<(SourceMesh, bool)> {
    let mesh = &scene.meshes[number];
    let all = bounds(mesh.positions.iter().copied());
    let bulk = Bulk::of(mesh.positions.len(), all, &|at| mesh.positions[at])?;
    let is_far: Vec<bool> = mesh.positions.iter().map(|it| !bulk.holds(*it)).collect();
    let corners = |triangle: &[u32; 3]| triangle.map(|it| is_far[it as usize]);
    let stays: Vec<bool> = mesh
        .triangles
        .iter()
        .map(|it| !corners(it).contains(&true))
        .collect();
    let far_triangles = stays.iter().filter(|it| !**it).count();
    let is_mixed = |it: &[u32; 3]| corners(it).contains(&true) && corners(it).contains(&false);
    let is_cut = mesh.triangles.iter().any(is_mixed);
    let of = |wanted: bool| {
        let places = mesh.positions.iter().zip(&is_far);
        bounds(places.filter(|(_, far)| **far == wanted).map(|it| *it.0))
    };
    let times = ratio(of(false), of(true));
    let is_little = far_triangles as f64 <= MOST_CUT * stays.len() as f64;
    if is_cut && (times < CUT || !is_little) {
        if times >= TOLD && number == shown {
            let name = name_of(scene, shown);
            let share = times.round();
            scene.remark(format!(
                "{name:?} reaches {share} times as far as most of its vertices lie: these have \
                 that much less detail; a larger --bits gives them more"
            ));
        }
        return None;
    }
    if far_triangles == 0 || far_triangles == stays.len() {
        return None;
    }
    let mut out = mesh.clone();
    out.keep_triangles(&stays.iter().map(|it| !it).collect::<Vec<_>>());
    scene.meshes[number].keep_triangles(&stays);
    Some((out, is_cut))
}

/// Clouds of points that lie anywhere: one, or several where some lie far from the others. As many
/// colours as points, or none.
pub(super) fn clouds(
    name: &str,
    positions: &[DVec3],
    colours: Vec<[u16; 3]>,
    scene: &mut SourceScene,
) -> Vec<SourceCloud> {
    let colours = unless_black(name, colours, &[], scene);
    let all = bounds(positions.iter().copied());
    let at = |number: usize| positions[number];
    let Some(parts) = part_points(name, (positions.len(), all), &at, scene) else {
        let cloud = SourceCloud {
            colours,
            ..SourceCloud::on_grid(name, positions)
        };
        return vec![cloud];
    };
    let cloud = |(part, number): (Vec<u32>, usize)| {
        let these: Vec<DVec3> = part.iter().map(|it| positions[*it as usize]).collect();
        let colour = |it: &u32| colours.get(*it as usize).copied();
        SourceCloud {
            colours: part.iter().filter_map(colour).collect(),
            ..SourceCloud::on_grid(&part_name(name, number), &these)
        }
    };
    parts.into_iter().zip(0..).map(cloud).collect()
}

/// The same of a cloud that is on a grid.
pub(super) fn clouds_on_grid(mut cloud: SourceCloud, scene: &mut SourceScene) -> Vec<SourceCloud> {
    cloud.colours = unless_black(&cloud.name, cloud.colours, &cloud.intensities, scene);
    let at = |number: usize| cloud.at(number);
    let [mut least, mut most] = [[i32::MAX; 3], [i32::MIN; 3]];
    for place in &cloud.places {
        for axis in 0..3 {
            least[axis] = least[axis].min(place[axis]);
            most[axis] = most[axis].max(place[axis]);
        }
    }
    let all = [least, most].map(|it| cloud.of_place(it));
    let Some(parts) = part_points(&cloud.name, (cloud.places.len(), all), &at, scene) else {
        return vec![cloud];
    };
    let some = |(part, number): (Vec<u32>, usize)| SourceCloud {
        name: part_name(&cloud.name, number),
        placements: cloud.placements.clone(),
        scale: cloud.scale,
        offset: cloud.offset,
        places: these(&cloud.places, &part),
        colours: these(&cloud.colours, &part),
        intensities: these(&cloud.intensities, &part),
        classes: these(&cloud.classes, &part),
    };
    parts.into_iter().zip(0..).map(some).collect()
}

/// Some elements of a list that may be empty.
fn these<T: Copy>(list: &[T], numbers: &[u32]) -> Vec<T> {
    let all = numbers.iter();
    all.filter_map(|it| list.get(*it as usize).copied())
        .collect()
}

fn part_name(name: &str, number: usize) -> String {
    match number {
        0 => name.to_owned(),
        _ => format!("{name}, far part {number}"),
    }
}

/// The numbers of the points of each part, the largest first; none where all lie together.
fn part_points(
    name: &str,
    (points, all): (usize, [DVec3; 2]),
    at: &dyn Fn(usize) -> DVec3,
    scene: &mut SourceScene,
) -> Option<Vec<Vec<u32>>> {
    let bulk = Bulk::of(points, all, at)?;
    let (mut near, mut far): (Vec<u32>, Vec<u32>) =
        (0..points as u32).partition(|it| bulk.holds(at(*it as usize)));
    let mut parts = Vec::new();
    loop {
        let place = |it: &u32| at(*it as usize);
        let others = [
            bounds(near.iter().map(place)),
            bounds(far.iter().map(place)),
        ];
        let times = ratio(others[0], others[1]);
        let next = Bulk::of(far.len(), others[1], &|number| place(&far[number]));
        let next = next.filter(|_| parts.len() + 2 < MOST_PARTS);
        let (mut some, rest) = match next {
            Some(next) => far.iter().partition(|it| next.holds(place(it))),
            None => (far, Vec::new()),
        };
        let all = near.len() + parts.iter().map(Vec::len).sum::<usize>();
        if is_nothing(&some, &place, (times, all)) {
            let about = bounds(some.iter().map(place));
            scene.remark(format!(
                "{} points of {:?} lie far from its others, about {}, as what stands for no echo \
                 does: they are left out",
                some.len(),
                shortened(name),
                told((about[0] + about[1]) / 2.0)
            ));
            count(&mut scene.repairs, "outlier_points_left_out", some.len());
        } else {
            if times >= TOLD {
                let about = bounds(some.iter().map(place));
                scene.remark(format!(
                    "{} points of {:?} lie far from its others, about {}: they are a cloud of \
                     their own",
                    some.len(),
                    shortened(name),
                    told((about[0] + about[1]) / 2.0)
                ));
                count(&mut scene.repairs, "outlier_points", some.len());
            }
            parts.push(std::mem::take(&mut some));
        }
        if rest.is_empty() {
            break;
        }
        far = rest;
    }
    parts.insert(0, std::mem::take(&mut near));
    Some(parts)
}

/// Whether points far from others stand for nothing: few of them very far, or with a coordinate
/// that is written for none.
fn is_nothing(points: &[u32], place: &dyn Fn(&u32) -> DVec3, (times, all): (f64, usize)) -> bool {
    let [low, high] = bounds(points.iter().map(place));
    if low.abs().max(high.abs()).max_element() > FARTHEST {
        return true;
    }
    if times >= NO_ECHO && points.len() as f64 <= (FEW_POINTS * all as f64).max(1.0) {
        return true;
    }
    let is_one_place = points.len() > 1 && low == high;
    let is_written = |value: f64| {
        let size = value.abs();
        let nines = [9999.0, 99_999.0, 999_999.0, 32_767.0, 32_768.0];
        nines.iter().any(|it| (size - it).abs() < 1e-3 * it.sqrt()) || size >= 1e9
    };
    let axes = 0..3;
    is_one_place
        || axes
            .into_iter()
            .any(|k| low[k] == high[k] && is_written(low[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of so many steps along each side, 100 m wide, in a mesh.
    fn square(steps: u32) -> SourceMesh {
        let side = steps + 1;
        let all = (0..side).flat_map(|y| (0..side).map(move |x| [x, y]));
        let step = 100.0 / f64::from(steps);
        let place = |[x, y]: [u32; 2]| DVec3::new(f64::from(x) * step, f64::from(y) * step, 0.0);
        let cells = (0..steps).flat_map(|y| (0..steps).map(move |x| y * side + x));
        SourceMesh {
            positions: all.map(place).collect(),
            triangles: cells
                .flat_map(|a| [[a, a + 1, a + side + 1], [a, a + side + 1, a + side]])
                .collect(),
            ..SourceMesh::default()
        }
    }

    fn scene_of(mesh: SourceMesh) -> SourceScene {
        let mut scene = SourceScene::default();
        scene.meshes.push(mesh);
        scene.objects.push(SourceObject {
            name: "a".to_owned(),
            mesh: 0,
            placements: vec![glam::DAffine3::IDENTITY],
        });
        part_meshes(&mut scene);
        scene
    }

    fn add_triangle(mesh: &mut SourceMesh, at: DVec3) {
        let first = mesh.positions.len() as u32;
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        mesh.positions.extend(corners.map(|it| at + it));
        mesh.triangles.push([first, first + 1, first + 2]);
    }

    #[test]
    fn triangles_far_away_are_objects_of_their_own_and_what_is_near_stays() {
        let plain = scene_of(square(20));
        assert_eq!((plain.objects.len(), plain.remarks.len()), (1, 0));
        for far in [3e4, 3e5, 5.4e6] {
            let mut mesh = square(20);
            add_triangle(&mut mesh, DVec3::new(0.0, far, 10.0));
            let scene = scene_of(mesh);
            assert_eq!(scene.objects.len(), 2, "{far}");
            assert_eq!(scene.meshes[0].positions, square(20).positions);
            assert_eq!(scene.meshes[1].triangles, [[0, 1, 2]]);
            assert!(scene.remarks[0].contains("1 triangles of \"a\""));
            assert_eq!(scene.repairs["outlier_triangles"], 1);
        }
        let mut mesh = square(20);
        for far in [3e4, 3e5, 5.4e6] {
            add_triangle(&mut mesh, DVec3::splat(far));
        }
        assert_eq!(scene_of(mesh).objects.len(), 4, "each its own");
        let mut mesh = square(20);
        add_triangle(&mut mesh, DVec3::splat(1e30));
        let scene = scene_of(mesh);
        assert_eq!(scene.objects.len(), 1);
        assert_eq!(scene.repairs["outlier_triangles_left_out"], 1);
    }

    #[test]
    fn one_vertex_far_away_takes_its_triangles_with_it_where_all_else_would_be_lost() {
        let moved = |to: f64| {
            let mut mesh = square(20);
            mesh.positions[220].z = to;
            scene_of(mesh)
        };
        let scene = moved(3e6);
        assert_eq!(scene.objects.len(), 2);
        assert_eq!(scene.meshes[1].triangles.len(), 6);
        assert!(scene.remarks[0].contains("gap"), "{:?}", scene.remarks);
        let scene = moved(3e3);
        assert_eq!(scene.objects.len(), 1);
        assert!(scene.remarks[0].contains("--bits"), "{:?}", scene.remarks);
        assert_eq!(moved(150.0).remarks.len(), 0);
    }

    #[test]
    fn long_and_sparse_shapes_stay_whole() {
        // A needle, and vertices that are ever farther apart.
        let mut needle = square(1);
        needle.positions.iter_mut().for_each(|it| it.x *= 1e4);
        let scene = scene_of(needle);
        assert_eq!((scene.objects.len(), scene.remarks.len()), (1, 0));
        let mut row = square(40);
        for at in &mut row.positions {
            at.x = (at.x / 10.0).exp2();
        }
        let scene = scene_of(row);
        assert_eq!(scene.objects.len(), 1);
    }

    /// What becomes of a metre of points with others.
    fn cloud(others: &[DVec3]) -> (Vec<SourceCloud>, SourceScene) {
        let along = || (0..20).map(|it| f64::from(it) / 20.0);
        let all = along().flat_map(|x| along().map(move |y| DVec3::new(x, y, x * y)));
        let positions: Vec<DVec3> = others.iter().copied().chain(all).collect();
        let mut scene = SourceScene::default();
        let colours = vec![[7; 3]; positions.len()];
        let clouds = clouds("a", &positions, colours, &mut scene);
        (clouds, scene)
    }

    #[test]
    fn points_that_stand_for_no_echo_are_left_out_and_cost_no_detail() {
        let (plain, _) = cloud(&[]);
        let nothing = DVec3::splat(-9999.0);
        for others in [
            vec![nothing],
            vec![DVec3::new(0.5, 0.5, 1e10)],
            vec![nothing; 150],
            vec![nothing; 900],
            (0..90)
                .map(|x| DVec3::new(f64::from(x) / 90.0, 0.3, -9999.0))
                .collect(),
            vec![DVec3::splat(1e30), DVec3::splat(-9999.0)],
        ] {
            let (clouds, scene) = cloud(&others);
            assert_eq!(clouds.len(), 1, "{} others", others.len());
            assert_eq!(clouds[0].scale, plain[0].scale);
            assert_eq!(clouds[0].places.len(), 400);
            assert_eq!(clouds[0].colours.len(), 400);
            let out = scene.repairs["outlier_points_left_out"];
            assert_eq!(out, others.len() as u64);
            assert!(scene.remarks[0].contains("left out"), "{:?}", scene.remarks);
        }
    }

    #[test]
    fn another_scan_far_away_is_a_cloud_of_its_own() {
        let along = || (0..10).map(|it| f64::from(it) / 10.0);
        let far = along().flat_map(|x| along().map(move |y| DVec3::new(x + 500.0, y, x)));
        let (clouds, scene) = cloud(&far.collect::<Vec<_>>());
        assert_eq!([clouds[0].places.len(), clouds[1].places.len()], [400, 100]);
        assert_eq!(clouds[1].name, "a, far part 1");
        assert_eq!(scene.repairs["outlier_points"], 100);
        let whole = clouds_on_grid(clouds[0].clone(), &mut SourceScene::default());
        assert_eq!(whole.len(), 1);
    }
}
