//! What does each policy take for the same score?

use serde::Serialize;

/// What one point of a curve takes, and its score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) jod: f64,
    pub(super) bytes: f64,
    pub(super) pixels_share: f64,
}

/// Points that differ by one number.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    pub(super) name: String,
    pub(super) points: Vec<Point>,
}

/// One curve at one score, over what two others take there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct AtScore {
    pub(super) jod: f64,
    pub(super) curve: String,
    pub(super) bytes: Option<f64>,
    pub(super) pixels_share: Option<f64>,
    pub(super) bytes_over_acuity: Option<f64>,
    pub(super) pixels_over_acuity: Option<f64>,
    pub(super) bytes_over_viewport: Option<f64>,
    pub(super) pixels_over_viewport: Option<f64>,
}

impl Curve {
    /// Bytes and share of the pixels at a score: between two points along the logarithm of each;
    /// where the curve crosses it more than once, the cheapest. A curve of one point, which nothing
    /// makes cheaper, takes the same for every score that it reaches. `None` outside the curve.
    pub(super) fn at(&self, jod: f64) -> Option<[f64; 2]> {
        let mut points = self.points.clone();
        points.sort_by(|a, b| a.bytes.total_cmp(&b.bytes));
        if let [only] = &points[..] {
            return (only.jod >= jod).then_some([only.bytes, only.pixels_share]);
        }
        let crosses = |pair: &&[Point]| pair[0].jod <= jod && jod <= pair[1].jod;
        let pair = points.windows(2).find(crosses)?;
        let (low, high) = (pair[0], pair[1]);
        let rise = high.jod - low.jod;
        let part = if rise > 0.0 {
            (jod - low.jod) / rise
        } else {
            0.0
        };
        let between = |low: f64, high: f64| low * (high / low).powf(part);
        Some([
            between(low.bytes, high.bytes),
            between(low.pixels_share, high.pixels_share),
        ])
    }
}

/// Every curve at every score, over the curves of these two names.
pub(super) fn at_equal_score(
    curves: &[Curve],
    scores: &[f64],
    [acuity, viewport]: [&str; 2],
) -> Vec<AtScore> {
    let named = |name: &str| curves.iter().find(|curve| curve.name == name);
    let row = |jod: f64, curve: &Curve| {
        let own = curve.at(jod);
        let over = |name: &str| {
            let other = named(name).and_then(|other| other.at(jod));
            own.zip(other)
                .map(|(own, other)| [0, 1].map(|k| own[k] / other[k]))
        };
        let (over_acuity, over_viewport) = (over(acuity), over(viewport));
        let first = |pair: Option<[f64; 2]>| pair.map(|pair| pair[0]);
        let second = |pair: Option<[f64; 2]>| pair.map(|pair| pair[1]);
        AtScore {
            jod,
            curve: curve.name.clone(),
            bytes: first(own).map(f64::round),
            pixels_share: second(own),
            bytes_over_acuity: first(over_acuity),
            pixels_over_acuity: second(over_acuity),
            bytes_over_viewport: first(over_viewport),
            pixels_over_viewport: second(over_viewport),
        }
    };
    let of_score = |jod: &f64| curves.iter().map(|curve| row(*jod, curve)).collect();
    let rows: Vec<Vec<AtScore>> = scores.iter().map(of_score).collect();
    rows.concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(name: &str, points: &[[f64; 3]]) -> Curve {
        let point = |[jod, bytes, pixels_share]: &[f64; 3]| Point {
            jod: *jod,
            bytes: *bytes,
            pixels_share: *pixels_share,
        };
        Curve {
            name: name.to_owned(),
            points: points.iter().map(point).collect(),
        }
    }

    #[test]
    fn a_curve_is_followed_between_its_points_and_nowhere_else() {
        let ladder = curve("a", &[[9.8, 400.0, 0.4], [9.0, 100.0, 0.1]]);
        let [bytes, pixels] = ladder.at(9.4).unwrap();
        assert!((bytes - 200.0).abs() < 1e-9 && (pixels - 0.2).abs() < 1e-12);
        assert_eq!(ladder.at(9.0), Some([100.0, 0.1]));
        assert_eq!((ladder.at(8.9), ladder.at(9.9)), (None, None));
        let level = curve("b", &[[9.5, 100.0, 0.1], [9.5, 200.0, 0.2]]);
        assert_eq!(level.at(9.5), Some([100.0, 0.1]));
    }

    #[test]
    fn one_point_stands_for_every_score_that_it_reaches() {
        let only = curve("viewport", &[[9.9, 500.0, 0.5]]);
        assert_eq!(only.at(9.0), Some([500.0, 0.5]));
        assert_eq!(only.at(9.95), None);
    }

    #[test]
    fn ratios_are_told_where_both_curves_reach() {
        let curves = [
            curve("viewport", &[[9.9, 500.0, 0.5]]),
            curve("acuity", &[[9.0, 100.0, 0.1], [9.6, 300.0, 0.3]]),
        ];
        let rows = at_equal_score(&curves, &[9.6, 9.8], ["acuity", "viewport"]);
        let ratios: Vec<_> = rows
            .iter()
            .map(|row| (row.bytes_over_acuity, row.bytes_over_viewport))
            .collect();
        let expected = [
            (Some(5.0 / 3.0), Some(1.0)),
            (Some(1.0), Some(0.6)),
            (None, Some(1.0)),
            (None, None),
        ];
        assert_eq!(ratios, expected);
    }
}
