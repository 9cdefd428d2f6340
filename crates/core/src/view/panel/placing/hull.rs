//! Which rectangle of the least area lies round points of a plane?

/// A turned rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TurnedRectangle {
    /// Radians that its right is turned towards down: clockwise.
    pub(super) roll: f64,
    /// Along its own right and down: least and largest.
    pub(super) across: [f64; 2],
    pub(super) along: [f64; 2],
}

impl TurnedRectangle {
    /// Round points, turned so.
    pub(super) fn round(points: &[[f64; 2]], roll: f64) -> Self {
        let (sin, cos) = (libm::sin(roll), libm::cos(roll));
        let span = |axis: [f64; 2]| {
            let at = points.iter().map(|p| p[0] * axis[0] + p[1] * axis[1]);
            at.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], it| {
                [low.min(it), high.max(it)]
            })
        };
        Self {
            roll,
            across: span([cos, sin]),
            along: span([-sin, cos]),
        }
    }

    /// With the shorter side grown about the middle until width over height is `aspect`.
    pub(super) fn grown(self, aspect: Option<f64>) -> Self {
        let Some(aspect) = aspect else { return self };
        let [width, height] = self.sides();
        let to = |[low, high]: [f64; 2], side: f64| {
            let middle = f64::midpoint(low, high);
            [middle - side / 2.0, middle + side / 2.0]
        };
        match width < height * aspect {
            true => Self {
                across: to(self.across, height * aspect),
                ..self
            },
            false => Self {
                along: to(self.along, width / aspect),
                ..self
            },
        }
    }

    pub(super) fn sides(&self) -> [f64; 2] {
        [self.across, self.along].map(|[low, high]| high - low)
    }

    pub(super) fn area(&self) -> f64 {
        self.sides().iter().product()
    }
}

/// The corners of the convex hull of points, counterclockwise where y grows upwards; Andrew 1979,
/// *Another efficient algorithm for convex hulls in two dimensions*.
pub(super) fn hull(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| {
        let (a, b) = (points[*a], points[*b]);
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    let turn = |a: usize, b: usize, c: usize| {
        let [a, b, c] = [a, b, c].map(|k| points[k]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let chain = |order: &mut dyn Iterator<Item = usize>| {
        let mut chain: Vec<usize> = Vec::new();
        for next in order {
            while let [.., a, b] = chain[..]
                && turn(a, b, next) <= 0.0
            {
                chain.pop();
            }
            chain.push(next);
        }
        chain.pop();
        chain
    };
    let mut all = chain(&mut order.iter().copied());
    all.extend(chain(&mut order.iter().rev().copied()));
    all
}

/// The rectangle of least area round points, grown to an aspect: one of its sides lies on an edge
/// of the hull (Freeman and Shapira 1975). At most 45° turned, and upright where that is as good.
pub(super) fn least_rectangle(points: &[[f64; 2]], aspect: Option<f64>) -> TurnedRectangle {
    let corners: Vec<[f64; 2]> = hull(points).into_iter().map(|k| points[k]).collect();
    let next = corners.iter().cycle().skip(1);
    let mut best = TurnedRectangle::round(points, 0.0).grown(aspect);
    for (a, b) in corners.iter().zip(next) {
        let quarter = core::f64::consts::FRAC_PI_2;
        let angle = libm::atan2(b[1] - a[1], b[0] - a[0]);
        let roll = angle - quarter * libm::round(angle / quarter);
        let found = TurnedRectangle::round(&corners, roll).grown(aspect);
        if found.area() < best.area() * (1.0 - 1e-6) {
            best = found;
        }
    }
    best
}
