//! Which panels do projectors make that light a wall which is a mesh?
//!
//! Each pixel lights the nearest point of the mesh along its ray; the panel is where an eye sees
//! these points.

use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::panel::rig::Rig;
use glam::DVec3;

use super::super::checked;
use super::super::entries::{
    EyeEntry, OutputEntry, PanelEntry, RigEntries, RigFormat, ScanoutEntry,
};
use super::super::error::{RigFault, WrongKey};
use super::space_map::SpaceMap;

/// Most pixels of all projectors: 32 of 1920 x 1080.
const MOST_PIXELS: u64 = 1 << 26;
/// How often all triangles may cover a projector's picture.
const MOST_COVERED: u64 = 256;
/// Nothing is lit nearer than this share of the way to the mesh's farthest corner.
const NEAREST: f64 = 1e-6;
/// Pixels by which triangles are wider, so that none is missed on a side that two share.
const SEAM: f64 = 1e-7;
/// What to do about a projector that is wrong.
const NEXT: &str = "check --projector";

/// A projector before a wall; places in the wall's own units and axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Projector {
    /// What its panel is called, and the surface that it shows.
    pub id: String,
    /// Where its lens is: to the right, up and behind.
    pub at: [f64; 3],
    /// Degrees by which it looks to the right and up, and is turned clockwise.
    pub yaw_pitch_roll: [f64; 3],
    /// Columns and rows of its picture.
    pub pixels: [u32; 2],
    /// Tangents from its axis to the sides of its picture: left, right, up and down, outward.
    pub tangents: [f64; 4],
    /// Degrees over which it fades where others overlap it.
    pub blend: f64,
}

/// What a projector lights.
struct LitPoints<'a> {
    projector: &'a Projector,
    axes: Axes,
    lens: DVec3,
    /// One over the depth of the nearest point, row by row; 0 where there is none.
    nearness: Vec<f64>,
}

/// The rig of projectors that light triangles, before an eye at a place of the same axes.
pub(in super::super) fn rig(
    triangles: &[[DVec3; 3]],
    projectors: &[Projector],
    eye: DVec3,
) -> Result<Rig, RigFault> {
    let pixels = projectors.iter().map(|it| it.pixels.map(u64::from));
    let pixels = pixels.map(|[w, h]| w.saturating_mul(h));
    if pixels.fold(0, u64::saturating_add) > MOST_PIXELS {
        let what = format!("all projectors have more than {MOST_PIXELS} pixels");
        return Err(RigFault::new("", what, NEXT));
    }
    let (mut entries, mut maps) = (Vec::new(), Vec::new());
    for projector in projectors {
        let wrong = |what: String| RigFault::new(&place_of(projector), what, NEXT);
        let lit = LitPoints::of(projector, triangles).map_err(wrong)?;
        let space = SpaceMap::from_above(projector.pixels, eye, &|row, column| {
            lit.point(row, column).unwrap_or(DVec3::NAN)
        });
        let space = space.map_err(wrong)?;
        entries.push(entry(projector, &space));
        maps.push(space.map);
    }
    let entries = RigEntries {
        format: RigFormat::TiledView1,
        mirror: false,
        ipd_mm: 63.0,
        screen: None,
        panel: entries,
    };
    let nothing = |_: &str| Err("is not read".to_owned());
    let rig = checked::rig(&entries, &nothing);
    let mut rig = rig.map_err(|wrong| fault(&wrong, projectors))?;
    for ((panel, map), projector) in rig.panels.iter_mut().zip(maps).zip(projectors) {
        map.bend(panel, None).map_err(|what| {
            let what =
                format!("{what}: from the eye, parts of the wall hide others that it lights");
            RigFault::new(
                &place_of(projector),
                what,
                "split the wall, or move the eye",
            )
        })?;
    }
    Ok(rig)
}

fn place_of(projector: &Projector) -> String {
    format!("projector {:?}", shortened(&projector.id))
}

fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

/// What the check of a rig calls wrong, by the projector.
fn fault(wrong: &WrongKey, projectors: &[Projector]) -> RigFault {
    let number = wrong.key.strip_prefix("panel[");
    let number = number.and_then(|rest| rest.split_once(']'));
    let index = number.and_then(|(number, _)| number.parse::<usize>().ok());
    let projector = index.and_then(|number| projectors.get(number.wrapping_sub(1)));
    let key = number.map_or("", |(_, key)| key);
    let place = projector.map_or_else(|| wrong.key.clone(), place_of);
    RigFault::new(&format!("{place}{key}"), &*wrong.what, NEXT)
}

fn entry(projector: &Projector, space: &SpaceMap) -> PanelEntry {
    let (pose, tangents) = space.around();
    PanelEntry {
        id: projector.id.clone(),
        eye: EyeEntry::Both,
        pixels: projector.pixels,
        pose,
        size: None,
        tangents: Some(tangents),
        scanout: ScanoutEntry::Normal,
        output: Some(OutputEntry {
            surface: projector.id.clone(),
            monitor: String::new(),
            x: 0,
            y: 0,
        }),
        distortion: None,
        blend: projector.blend,
        alpha: None,
        gain: [1.0; 3],
        black: 0.0,
    }
}

impl<'a> LitPoints<'a> {
    fn of(projector: &'a Projector, triangles: &[[DVec3; 3]]) -> Result<Self, String> {
        let [yaw, pitch, roll] = projector.yaw_pitch_roll.map(Radians::from_degrees);
        let count = projector.pixels.map(|side| side as usize);
        let mut lit = Self {
            projector,
            axes: Axes::from_yaw_pitch_roll(yaw, pitch, roll),
            lens: DVec3::from(projector.at),
            nearness: vec![0.0; count[0] * count[1]],
        };
        let corners = triangles.iter().flatten();
        let far = corners.map(|it| it.distance(lit.lens)).fold(0.0, f64::max);
        let mut covered = 0;
        for triangle in triangles {
            covered += lit.draw(&triangle.map(|it| lit.seen(it)), far * NEAREST);
            if covered > MOST_COVERED * lit.nearness.len() as u64 {
                return Err(format!(
                    "the mesh lies more than {MOST_COVERED} times in its way"
                ));
            }
        }
        match lit.nearness.iter().all(|it| *it <= 0.0) {
            true => Err("it lights nothing of the mesh".to_owned()),
            false => Ok(lit),
        }
    }

    /// A point to the right of the lens, below it and before it.
    fn seen(&self, point: DVec3) -> DVec3 {
        let way = point - self.lens;
        let Axes {
            right,
            down,
            forward,
        } = self.axes;
        DVec3::new(way.dot(right), way.dot(down), way.dot(forward))
    }

    /// Tangents to the right and down of a pixel's centre.
    fn tangents(&self, [column, row]: [usize; 2]) -> [f64; 2] {
        let [left, right, up, down] = self.projector.tangents;
        let [w, h] = self.projector.pixels.map(f64::from);
        [
            (column as f64 + 0.5) / w * (left + right) - left,
            (row as f64 + 0.5) / h * (up + down) - up,
        ]
    }

    /// The point that a pixel lights.
    fn point(&self, row: usize, column: usize) -> Option<DVec3> {
        let nearness = self.nearness[row * self.projector.pixels[0] as usize + column];
        let way = self.axes.at(self.tangents([column, row]));
        (nearness > 0.0).then(|| self.lens + way / nearness)
    }

    /// Draws a triangle, as far as it lies before the lens; returns how many pixels it covers.
    fn draw(&mut self, corners: &[DVec3; 3], nearest: f64) -> u64 {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let far = normal.dot(corners[0]);
        let places: Vec<[f64; 2]> = before(corners, nearest).map(|it| self.pixel(it)).collect();
        // Seen from the side it is nothing.
        if places.len() < 3 || far == 0.0 {
            return 0;
        }
        let [w, h] = self.projector.pixels.map(|side| side as usize);
        let lows = places.iter().map(|it| it[1]).fold(f64::INFINITY, f64::min);
        let highs = places
            .iter()
            .map(|it| it[1])
            .fold(f64::NEG_INFINITY, f64::max);
        let mut covered = 0;
        for row in centres([lows, highs], h) {
            let Some(across) = crossed(&places, row as f64 + 0.5) else {
                continue;
            };
            for column in centres(across, w) {
                let [x, y] = self.tangents([column, row]);
                let nearness = normal.dot(DVec3::new(x, y, 1.0)) / far;
                let known = &mut self.nearness[row * w + column];
                *known = known.max(nearness.min(1.0 / nearest));
                covered += 1;
            }
        }
        covered
    }

    /// The place in its picture of a point before the lens.
    fn pixel(&self, point: DVec3) -> [f64; 2] {
        let [left, right, up, down] = self.projector.tangents;
        let [w, h] = self.projector.pixels.map(f64::from);
        [
            (point.x / point.z + left) / (left + right) * w,
            (point.y / point.z + up) / (up + down) * h,
        ]
    }
}

/// The corners of what of a triangle is no nearer than so much before the lens.
fn before(corners: &[DVec3; 3], nearest: f64) -> impl Iterator<Item = DVec3> {
    let sides = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (corners[a], corners[b]));
    sides.into_iter().flat_map(move |(a, b)| {
        let is_before = a.z >= nearest;
        let cut = (is_before != (b.z >= nearest)).then(|| {
            let share = (nearest - a.z) / (b.z - a.z);
            let cut = a + (b - a) * share;
            DVec3::new(cut.x, cut.y, nearest)
        });
        is_before.then_some(a).into_iter().chain(cut)
    })
}

/// The pixels of a side whose centres lie between two places.
fn centres([low, high]: [f64; 2], side: usize) -> std::ops::Range<usize> {
    let most = side as f64;
    let first = (low - SEAM - 0.5).ceil().clamp(0.0, most) as usize;
    let end = ((high + SEAM - 0.5).floor() + 1.0).clamp(0.0, most) as usize;
    first..end.max(first)
}

/// From where to where a convex outline crosses a level line.
fn crossed(places: &[[f64; 2]], level: f64) -> Option<[f64; 2]> {
    let mut across = [f64::INFINITY, f64::NEG_INFINITY];
    let mut from = places[places.len() - 1];
    for to in places {
        let (low, high) = (from[1].min(to[1]), from[1].max(to[1]));
        if (low - SEAM..=high + SEAM).contains(&level) {
            let share = match high > low {
                true => ((level - from[1]) / (to[1] - from[1])).clamp(0.0, 1.0),
                false => 0.0,
            };
            let x = from[0] + (to[0] - from[0]) * share;
            across = [across[0].min(x), across[1].max(x)];
            if high <= low {
                across = [across[0].min(to[0]), across[1].max(to[0])];
            }
        }
        from = *to;
    }
    (across[0] <= across[1]).then_some(across)
}
