//! How do scores over costs become a picture?
//!
//! Cost runs to the right by its logarithm, as policies differ by factors; the score runs up. A
//! colour and a mark are a policy, a dashed line is its ladder of targets.

use crate::commands::evaluate::policies::report::{PoliciesReport, PolicyRow, by_curve};
use crate::report::html::escape;
use std::fmt::Write as _;

/// Units of the drawing: width, height.
const SIZE: [f64; 2] = [760.0, 430.0];
/// Margins: left for scores, top for the title, right for names, bottom for costs.
const LEFT: f64 = 58.0;
const TOP: f64 = 40.0;
const RIGHT: f64 = 190.0;
const BOTTOM: f64 = 52.0;
/// What is left free round the points, as a factor of costs and as a share of the scores.
const MARGIN: f64 = 1.25;
/// The score of no difference.
const BEST: f64 = 10.0;
/// Distances between the numbers of scores, of which the first that gives few enough is taken.
const STEPS: [f64; 6] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0];
const MOST_STEPS: f64 = 8.0;
/// Height of a line of the key.
const KEY_LINE: f64 = 22.0;

const STYLE: &str = "text{font:12px system-ui,sans-serif;fill:#4a5058}.title{font-size:14px;\
    font-weight:600;fill:#22262b}.grid{stroke:#e3e5e8}.curve{fill:none;stroke-width:2;\
    stroke-linejoin:round}.step{font-size:10px;paint-order:stroke;stroke:#fff;stroke-width:3px}";

/// Colours that most colour-blind eyes distinguish (Okabe and Ito), by how the name of a curve
/// begins; the first that fits.
const COLOURS: [(&str, &str); 8] = [
    ("full", "#22262b"),
    ("viewport", "#7d848d"),
    ("grid", "#cc79a7"),
    ("acuity watson", "#56b4e9"),
    ("acuity", "#0072b2"),
    ("uniform", "#e69f00"),
    ("eccentricity", "#009e73"),
    ("perceptual", "#d55e00"),
];

/// What runs to the right.
struct Cost {
    title: &'static str,
    axis: &'static str,
    of: fn(&PolicyRow) -> f64,
}

const BYTES: Cost = Cost {
    title: "Score over bytes",
    axis: "bytes, % of the original file's",
    of: |row| row.bytes_over_original * 100.0,
};
const PIXELS: Cost = Cost {
    title: "Score over pixels",
    axis: "pixels, % of the finest level's",
    of: |row| row.point().pixels_share * 100.0,
};

/// The score over bytes, and over pixels, as SVG files.
pub(super) fn charts(report: &PoliciesReport) -> [String; 2] {
    [BYTES, PIXELS].map(|cost| chart(&report.rows, &cost))
}

fn chart(rows: &[PolicyRow], cost: &Cost) -> String {
    let plane = Plane::over(rows, cost);
    let [width, height] = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\"><style>{STYLE}</style>\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\
         <text class=\"title\" x=\"{LEFT}\" y=\"22\">{}</text>",
        cost.title
    );
    plane.numbers(&mut svg, cost.axis);
    let curves = by_curve(rows);
    for (at, (name, rows)) in curves.iter().enumerate() {
        let mut rows = rows.clone();
        rows.sort_by(|a, b| (cost.of)(a).total_cmp(&(cost.of)(b)));
        let places: Vec<[f64; 2]> = rows.iter().map(|row| plane.place(row, cost)).collect();
        let pen = Pen::of(name, rows.len());
        if places.len() > 1 {
            pen.line(&mut svg, &places);
        }
        for (row, place) in rows.iter().zip(&places) {
            let told = format!("{}: {:.2} JOD", row.name(), row.point().jod);
            pen.mark(&mut svg, *place, &told);
        }
        pen.key(&mut svg, name, at);
    }
    svg + "</svg>\n"
}

/// The plane that points are drawn on.
struct Plane {
    /// Costs at its left and right.
    costs: [f64; 2],
    lowest: f64,
    step: f64,
}

impl Plane {
    fn over(rows: &[PolicyRow], cost: &Cost) -> Self {
        let costs = rows.iter().map(cost.of).filter(|cost| *cost > 0.0);
        let least = costs.clone().fold(f64::INFINITY, f64::min);
        let most = costs.fold(0.0, f64::max);
        let worst = rows.iter().map(|row| row.point().jod).fold(BEST, f64::min);
        let few = |step: &f64| (BEST - worst) / step <= MOST_STEPS;
        let step = STEPS.into_iter().find(few).unwrap_or(STEPS[5]);
        Self {
            costs: match least <= most {
                true => [least / MARGIN, most * MARGIN],
                false => [1.0, 100.0],
            },
            lowest: ((worst / step).floor() * step).min(BEST - step),
            step,
        }
    }

    fn x(&self, cost: f64) -> f64 {
        let [least, most] = self.costs;
        let share = (cost.max(least) / least).ln() / (most / least).ln();
        LEFT + share * (SIZE[0] - LEFT - RIGHT)
    }

    fn y(&self, jod: f64) -> f64 {
        // Marks at the best score keep off the edge.
        let top = BEST + 0.2 * self.step;
        let share = (jod - self.lowest) / (top - self.lowest);
        SIZE[1] - BOTTOM - share * (SIZE[1] - TOP - BOTTOM)
    }

    fn place(&self, row: &PolicyRow, cost: &Cost) -> [f64; 2] {
        [self.x((cost.of)(row)), self.y(row.point().jod)]
    }

    fn numbers(&self, svg: &mut String, axis: &str) {
        let [right, bottom] = [SIZE[0] - RIGHT, SIZE[1] - BOTTOM];
        let steps = ((BEST - self.lowest) / self.step).round() as u32;
        for n in 0..=steps {
            let jod = BEST - f64::from(n) * self.step;
            let (y, base) = (self.y(jod), self.y(jod) + 4.0);
            let _ = write!(
                svg,
                "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>\
                 <text text-anchor=\"end\" x=\"{:.1}\" y=\"{base:.1}\">{jod:.1}</text>",
                LEFT - 8.0
            );
        }
        for cost in ticks(self.costs) {
            let (x, base) = (self.x(cost), bottom + 18.0);
            let _ = write!(
                svg,
                "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{TOP}\" y2=\"{bottom}\"/>\
                 <text text-anchor=\"middle\" x=\"{x:.1}\" y=\"{base:.1}\">{cost}</text>"
            );
        }
        let (middle, base) = ((LEFT + right) / 2.0, SIZE[1] - 12.0);
        let _ = write!(
            svg,
            "<text text-anchor=\"middle\" x=\"{middle:.1}\" y=\"{base:.1}\">{axis}</text>\
             <text x=\"12\" y=\"{:.1}\">JOD</text>",
            TOP - 4.0
        );
    }
}

/// 1, 2 and 5 in every decade between two costs; more where they lie within one.
fn ticks([least, most]: [f64; 2]) -> Vec<f64> {
    let steps: &[i32] = match most / least > 10.0 {
        true => &[10, 20, 50],
        false => &[10, 15, 20, 30, 40, 50, 70],
    };
    let [from, to] = [least, most].map(|cost| cost.log10().floor() as i32);
    let decade = |exponent: i32| {
        let step = move |n: &i32| f64::from(*n) * 10f64.powi(exponent - 1);
        // As it is written, 0.15 and not 0.15000000000000002.
        steps
            .iter()
            .map(step)
            .map(|cost| (cost * 1e6).round() / 1e6)
    };
    let all = (from..=to).flat_map(decade);
    all.filter(|cost| (least..=most).contains(cost)).collect()
}

/// How a curve is drawn.
struct Pen {
    colour: &'static str,
    dashes: &'static str,
    shape: usize,
    /// Wide and hollow, so that what lies over it is seen too.
    is_hollow: bool,
}

impl Pen {
    /// The pen of a curve of so many points.
    fn of(curve: &str, points: usize) -> Self {
        let fits = |(begins, _): &(&str, &str)| curve.starts_with(begins);
        let shape = COLOURS.iter().position(fits).unwrap_or_default();
        Self {
            colour: COLOURS[shape].1,
            dashes: match curve.ends_with("by target") {
                true => " stroke-dasharray=\"6 4\"",
                false => "",
            },
            shape,
            is_hollow: points == 1,
        }
    }

    fn line(&self, svg: &mut String, places: &[[f64; 2]]) {
        let points = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}"));
        let points = points.collect::<Vec<_>>().join(" ");
        let Self { colour, dashes, .. } = self;
        let _ = write!(
            svg,
            "<polyline class=\"curve\" stroke=\"{colour}\"{dashes} points=\"{points}\"/>"
        );
    }

    /// A mark, with words for who points at it.
    fn mark(&self, svg: &mut String, [x, y]: [f64; 2], told: &str) {
        let corners: &[[f64; 2]] = match self.shape % 4 {
            0 => &[[-4.5, -4.5], [4.5, -4.5], [4.5, 4.5], [-4.5, 4.5]],
            1 => &[[0.0, -6.0], [6.0, 0.0], [0.0, 6.0], [-6.0, 0.0]],
            2 => &[[0.0, -6.0], [5.5, 4.5], [-5.5, 4.5]],
            _ => &[[0.0, 6.0], [5.5, -4.5], [-5.5, -4.5]],
        };
        let wide = if self.is_hollow { 1.7 } else { 1.0 };
        let corner = |[dx, dy]: &[f64; 2]| format!("{:.1},{:.1}", x + wide * dx, y + wide * dy);
        let points = corners.iter().map(corner).collect::<Vec<_>>().join(" ");
        let (colour, told) = (self.colour, escape(told));
        let [fill, stroke, width] = match self.is_hollow {
            true => ["none", colour, "2"],
            false => [colour, "#fff", "1"],
        };
        let _ = write!(
            svg,
            "<polygon fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"{width}\" \
             points=\"{points}\"><title>{told}</title></polygon>"
        );
    }

    /// Its line of the key.
    fn key(&self, svg: &mut String, name: &str, at: usize) {
        let x = SIZE[0] - RIGHT + 18.0;
        let y = TOP + 8.0 + at as f64 * KEY_LINE;
        if !self.is_hollow {
            self.line(svg, &[[x, y], [x + 28.0, y]]);
        }
        self.mark(svg, [x + 14.0, y], name);
        let (text_x, base, name) = (x + 36.0, y + 4.0, escape(name));
        let _ = write!(svg, "<text x=\"{text_x}\" y=\"{base}\">{name}</text>");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_counted_in_ones_twos_and_fives_of_every_decade() {
        assert_eq!(ticks([3.0, 60.0]), [5.0, 10.0, 20.0, 50.0]);
        assert_eq!(ticks([0.1, 1.1]), [0.1, 0.2, 0.5, 1.0]);
        assert_eq!(ticks([14.0, 45.0]), [15.0, 20.0, 30.0, 40.0]);
    }

    #[test]
    fn policies_have_colours_of_their_own_and_ladders_of_targets_dashes() {
        let pens =
            ["acuity by slope", "acuity watson", "perceptual by rate"].map(|name| Pen::of(name, 4));
        assert!(pens[0].colour != pens[1].colour && pens[1].colour != pens[2].colour);
        let by_target = Pen::of("acuity by target", 4);
        assert!(by_target.colour == pens[0].colour && by_target.dashes != pens[0].dashes);
    }
}
