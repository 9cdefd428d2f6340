//! Which units does an eye somewhere near an object need?

use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::view::random::Random;
use glam::{DVec3, Vec3};

/// Minimum angle of resolution in the fovea, in degrees.
const FOVEAL: f64 = 1.0 / 60.0;
/// How it grows with eccentricity. Source: docs/papers.md, row "acuity".
const SLOPE: f64 = 0.022;

/// An eye in the space of an object.
struct Eye {
    at: DVec3,
    gaze: DVec3,
}

/// How many times over each unit's error could be seen, by a random eye before each object.
pub(super) fn scores(rows: &[(u8, UnitRow)], random: &mut Random) -> Vec<f64> {
    let objects = rows
        .iter()
        .map(|(_, row)| usize::from(row.object) + 1)
        .max();
    let mut eyes: Vec<Option<Eye>> = Vec::new();
    eyes.resize_with(objects.unwrap_or(0), || None);
    let score = |(_, row): &(u8, UnitRow)| {
        // The first unit of an object is a root, whose sphere encloses all of it.
        let eye = eyes[usize::from(row.object)].get_or_insert_with(|| eye(row, random));
        eye.score(row)
    };
    rows.iter().map(score).collect()
}

/// An eye that looks at some point of a sphere from up to three radii away.
fn eye(root: &UnitRow, random: &mut Random) -> Eye {
    let centre = Vec3::from_array(root.centre).as_dvec3();
    let radius = f64::from(root.radius);
    let seen = centre + 0.8 * radius * random.unit() * random.direction();
    let away = random.direction();
    let at = centre + radius * (0.6 + 2.4 * random.unit()) * away;
    Eye {
        at,
        gaze: (seen - at).normalize_or(-away),
    }
}

impl Eye {
    /// Largest angle of the error over the smallest angle that is resolved, anywhere in the sphere.
    fn score(&self, row: &UnitRow) -> f64 {
        let to = Vec3::from_array(row.centre).as_dvec3() - self.at;
        let (distance, radius) = (to.length(), f64::from(row.radius));
        let nearest = (distance - radius)
            .max(1e-3 * radius)
            .max(f64::MIN_POSITIVE);
        let spread = match radius < distance {
            true => (radius / distance).asin(),
            false => std::f64::consts::PI,
        };
        let eccentricity = (to.angle_between(self.gaze) - spread).max(0.0);
        let mar = FOVEAL + SLOPE * eccentricity.to_degrees();
        (f64::from(row.error) / nearest).to_degrees() / mar
    }
}

/// The units above some random score, with all that they need.
pub(super) fn closed_above(
    rows: &[(u8, UnitRow)],
    scores: &[f64],
    random: &mut Random,
) -> Vec<usize> {
    if scores.is_empty() {
        return Vec::new();
    }
    let threshold = scores[(random.unit() * scores.len() as f64) as usize];
    let mut chosen: Vec<bool> = scores.iter().map(|it| *it >= threshold).collect();
    for (unit, (_, row)) in rows.iter().enumerate().rev() {
        chosen[unit] |= row.needs.is_empty();
        if chosen[unit] {
            row.needs
                .iter()
                .for_each(|need| chosen[need.0 as usize] = true);
        }
    }
    (0..rows.len()).filter(|unit| chosen[*unit]).collect()
}
