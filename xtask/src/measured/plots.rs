//! How do figures become a plot, as an SVG file for light and dark pages?

use std::fmt::Write as _;

use super::list::{List, Plot};

/// Units of the drawing: width, height.
const SIZE: [f64; 2] = [720.0, 400.0];
/// Margins: left for scores, top for the title, right for the key, bottom for costs.
const LEFT: f64 = 52.0;
const TOP: f64 = 44.0;
const RIGHT: f64 = 176.0;
const BOTTOM: f64 = 54.0;
/// The score of no difference, at the top.
const BEST: f64 = 10.0;
/// Room above it for marks, in JOD.
const ABOVE: f64 = 0.1;
/// Distances between numbers of an axis, of which the first that gives few enough is taken.
const STEPS: [f64; 9] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0];
const MOST_STEPS: f64 = 8.0;
/// Height of a line of the key.
const KEY_LINE: f64 = 24.0;

/// A pen for each series in turn: colours in light and in dark that most colour-blind eyes
/// distinguish (after Okabe and Ito), and dashes.
const PENS: [[&str; 3]; 6] = [
    ["#d55e00", "#ff8a3d", "none"],
    ["#0072b2", "#5ab4f0", "7 3"],
    ["#007a5a", "#2fc79a", "2 3"],
    ["#8a6d00", "#e8c35a", "9 3 2 3"],
    ["#22262b", "#e8eaed", "none"],
    ["#a0458b", "#e39bd0", "4 4"],
];
const LIGHT: &str = "text{font:13px system-ui,sans-serif;fill:#4a5058}\
    .title{font-size:15px;font-weight:600;fill:#22262b}.page{fill:#ffffff}.grid{stroke:#e3e5e8}\
    .series{fill:none;stroke-width:2;stroke-linejoin:round}";
const DARK: &str = "text{fill:#b6bcc4}.title{fill:#e8eaed}.page{fill:#14171b}.grid{stroke:#2c3138}";

/// The plot as a file. Each series is a line with a mark at every point, or a single mark, and has
/// its name in the key.
pub(super) fn drawn(list: &List, plot: &Plot) -> Result<String, String> {
    if plot.series.len() > PENS.len() {
        return Err(format!("a plot has at most {} series", PENS.len()));
    }
    let mut series = Vec::new();
    for one in &plot.series {
        let mut points = Vec::new();
        for row in &one.rows {
            points.push([
                value(list, &format!("{row}-{}", plot.x))? * plot.factor,
                value(list, &format!("{row}-{}", plot.y))?,
            ]);
        }
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        series.push((one.name.as_str(), points));
    }
    let plane = Plane::over(series.iter().flat_map(|(_, points)| points));
    let [width, height] = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\" role=\"img\" aria-label=\"{title}\">\n\
         <style>{}</style>\n<rect class=\"page\" width=\"{width}\" height=\"{height}\"/>\n\
         <text class=\"title\" x=\"{LEFT}\" y=\"24\">{title}</text>\n",
        style(series.len()),
        title = plot.title
    );
    plane.numbers(&mut svg, &plot.axis);
    for (at, (name, points)) in series.iter().enumerate() {
        line(&mut svg, at, name, points.iter().map(|p| plane.place(*p)));
        let [x, y] = [SIZE[0] - RIGHT + 18.0, TOP + 12.0 + at as f64 * KEY_LINE];
        let _ = writeln!(
            svg,
            "<path class=\"series s{at}\" d=\"M{x} {y}h26\"/>\
             <circle class=\"mark s{at}\" cx=\"{:.1}\" cy=\"{y:.1}\" r=\"4\"/>\
             <text class=\"label\" x=\"{:.1}\" y=\"{:.1}\">{name}</text>",
            x + 13.0,
            x + 34.0,
            y + 4.5
        );
    }
    Ok(svg + "</svg>\n")
}

fn value(list: &List, id: &str) -> Result<f64, String> {
    let figure = list.figure(id);
    figure
        .map(|figure| figure.value)
        .ok_or_else(|| format!("no figure is called {id}"))
}

/// The style of a page in light, and what differs in dark.
fn style(series: usize) -> String {
    let colours = |which: usize| {
        let pens = PENS.iter().take(series).enumerate();
        let rules = pens.map(|(at, pen)| {
            let colour = pen[which];
            format!(".series.s{at}{{stroke:{colour}}}.mark.s{at}{{fill:{colour}}}")
        });
        rules.collect::<String>()
    };
    let pens = PENS.iter().take(series).enumerate();
    let dashes = pens.map(|(at, pen)| format!(".series.s{at}{{stroke-dasharray:{}}}", pen[2]));
    format!(
        "{LIGHT}{}{}@media(prefers-color-scheme:dark){{{DARK}{}}}",
        colours(0),
        dashes.collect::<String>(),
        colours(1)
    )
}

fn line(svg: &mut String, at: usize, name: &str, places: impl Iterator<Item = [f64; 2]>) {
    let places: Vec<[f64; 2]> = places.collect();
    if places.len() > 1 {
        let points = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}"));
        let points = points.collect::<Vec<_>>().join(" ");
        let _ = writeln!(
            svg,
            "<polyline class=\"series s{at}\" points=\"{points}\"><title>{name}</title></polyline>"
        );
    }
    for [x, y] in places {
        let _ = writeln!(
            svg,
            "<circle class=\"mark s{at}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>"
        );
    }
}

/// The plane that points are drawn on: costs from 0 to the right, scores up.
struct Plane {
    most: f64,
    lowest: f64,
    /// Between numbers, of costs and of scores.
    steps: [f64; 2],
}

impl Plane {
    fn over<'a>(points: impl Iterator<Item = &'a [f64; 2]> + Clone) -> Self {
        let most = points.clone().map(|p| p[0]).fold(0.0, f64::max);
        let worst = points.map(|p| p[1]).fold(BEST, f64::min);
        let steps = [most, BEST - worst].map(|span| {
            let few = |step: &f64| span / step <= MOST_STEPS;
            STEPS
                .into_iter()
                .find(few)
                .unwrap_or(STEPS[STEPS.len() - 1])
        });
        Self {
            most: most.max(steps[0]) * 1.04,
            lowest: ((worst / steps[1]).floor() * steps[1]).min(BEST - steps[1]),
            steps,
        }
    }

    fn place(&self, [cost, jod]: [f64; 2]) -> [f64; 2] {
        let top = BEST + ABOVE;
        let up = (jod - self.lowest) / (top - self.lowest);
        [
            LEFT + cost / self.most * (SIZE[0] - LEFT - RIGHT),
            SIZE[1] - BOTTOM - up * (SIZE[1] - TOP - BOTTOM),
        ]
    }

    fn numbers(&self, svg: &mut String, axis: &str) {
        let [right, bottom] = [SIZE[0] - RIGHT, SIZE[1] - BOTTOM];
        let count = |span: f64, step: f64| (span / step + 1e-9).floor() as u32;
        for n in 0..=count(BEST - self.lowest, self.steps[1]) {
            let jod = BEST - f64::from(n) * self.steps[1];
            let [_, y] = self.place([0.0, jod]);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{LEFT} {y:.1}H{right}\"/>\
                 <text text-anchor=\"end\" x=\"{:.1}\" y=\"{:.1}\">{jod:.1}</text>",
                LEFT - 8.0,
                y + 4.5
            );
        }
        for n in 0..=count(self.most, self.steps[0]) {
            let cost = f64::from(n) * self.steps[0];
            let [x, _] = self.place([cost, BEST]);
            let digits = usize::from(self.steps[0] < 1.0);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{x:.1} {TOP}V{bottom}\"/>\
                 <text text-anchor=\"middle\" x=\"{x:.1}\" y=\"{:.1}\">{cost:.digits$}</text>",
                bottom + 19.0
            );
        }
        let _ = writeln!(
            svg,
            "<text text-anchor=\"middle\" x=\"{:.1}\" y=\"{:.1}\">{axis}</text>\
             <text x=\"12\" y=\"{:.1}\">JOD</text>",
            (LEFT + right) / 2.0,
            SIZE[1] - 12.0,
            TOP - 6.0
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_series_of_the_list_has_a_visible_stroke_and_a_label_in_light_and_dark() {
        let list = List::of_repository().unwrap();
        assert!(list.plots.len() >= 2);
        for plot in &list.plots {
            let svg = drawn(&list, plot).unwrap();
            let (light, dark) = svg.split_once("@media").unwrap();
            for (at, series) in plot.series.iter().enumerate() {
                let label = format!(">{}</text>", series.name);
                assert!(svg.contains(&label), "{}: {label}", plot.file);
                for (style, page) in [(light, "#ffffff"), (dark, "#14171b")] {
                    let rule = format!(".series.s{at}{{stroke:#");
                    let colour = style.split(&rule).nth(1).unwrap().get(..6).unwrap();
                    let contrast = contrast(colour, &page[1..]);
                    assert!(contrast > 3.0, "{}: {colour} on {page}", series.name);
                }
                let marks = svg.matches(&format!("class=\"mark s{at}\"")).count();
                assert_eq!(marks, series.rows.len() + 1, "{}", series.name);
            }
            assert!(
                !svg.contains("NaN") && !svg.contains("inf"),
                "{}",
                plot.file
            );
        }
    }

    /// Ratio of the luminances of two colours, as WCAG 2 has it: 1 to 21.
    fn contrast(a: &str, b: &str) -> f64 {
        let luminance = |colour: &str| {
            let channel = |at: usize, weight: f64| {
                let code = u8::from_str_radix(&colour[at..at + 2], 16).unwrap();
                weight * (f64::from(code) / 255.0).powf(2.2)
            };
            channel(0, 0.2126) + channel(2, 0.7152) + channel(4, 0.0722) + 0.05
        };
        let (a, b) = (luminance(a), luminance(b));
        a.max(b) / a.min(b)
    }
}
