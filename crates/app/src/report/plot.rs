//! How does a series of figures become a line plot, as SVG?
//!
//! Colours come from a style sheet by class: the page's, so that a plot follows light and dark, or
//! one of its own where the plot is a file ([`file`]).

use std::fmt::Write as _;

/// Units of the drawing, which the page scales: width, height.
const SIZE: [f64; 2] = [420.0, 224.0];
/// Height of the title of a file.
const TITLE: f64 = 26.0;
/// Margins: left for numbers, top, right for labels, bottom for time.
const LEFT: f64 = 46.0;
const TOP: f64 = 10.0;
const RIGHT: f64 = 80.0;
const BOTTOM: f64 = 34.0;
/// Steps between numbers of an axis, at least this many.
const STEPS: f64 = 4.0;
/// Steps by which the highest figure may pass the last number of its axis.
const OVERSHOOT: f64 = 0.2;
/// Least distance between the labels of two lines.
const LABEL_HEIGHT: f64 = 14.0;
/// A run of one frame is drawn this long.
const SHORTEST: f64 = 0.04;

/// What all plots of one run share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlottedRun<'a> {
    /// Time of every figure, from 0 on: display time of a frame, or a delay.
    pub(crate) times: &'a [f64],
    /// Its unit.
    pub(crate) unit: &'a str,
    /// Whether the eye was moving, of every frame; empty where that is not known.
    pub(crate) moving: &'a [bool],
    /// Index of the frame that the pictures show, where there are any.
    pub(crate) pictured: Option<usize>,
}

/// One line; `class` is its colour in the style sheet.
pub(crate) struct PlotLine<'a> {
    pub(crate) class: &'a str,
    pub(crate) values: Vec<f64>,
}

/// Lines over time, each labelled at its end with its class; `title` is for those who cannot see.
pub(crate) fn lines(title: &str, run: &PlottedRun<'_>, lines: &[PlotLine<'_>]) -> String {
    let highest = lines.iter().flat_map(|line| &line.values);
    let plane = Plane::new(run, highest.copied().fold(0.0, f64::max));
    let mut svg = plane.begin(title, run);
    let mut labels: Vec<(f64, &str)> = Vec::new();
    for line in lines {
        let points = plane.points(&line.values);
        let class = line.class;
        let _ = write!(svg, r#"<polyline class="line {class}" points="{points}"/>"#);
        let last = line.values.last().copied().unwrap_or(0.0);
        labels.push((plane.y(last), class));
    }
    let x = SIZE[0] - RIGHT + 6.0;
    for (y, class) in spread(labels) {
        let y = y + 4.0;
        let _ = write!(
            svg,
            r#"<text class="label {class}" x="{x:.1}" y="{y:.1}">{class}</text>"#
        );
    }
    svg + "</svg>"
}

/// Style of a plot that is a file: dark on white, colours that most colour-blind eyes distinguish.
const FILE_STYLE: &str = "text{font:11.5px system-ui,sans-serif;fill:#4a5058}\
    .label{font-weight:600}.grid{stroke:#dddfe2}\
    .line{fill:none;stroke-width:2;stroke-linejoin:round}";
/// Colours of the lines of a file, in their order.
const FILE_COLOURS: [&str; 3] = ["#b86e00", "#7d848d", "#0a63b0"];

/// Lines as an SVG file, at most three, with `title` above them; their classes are letters only.
pub(crate) fn file(title: &str, run: &PlottedRun<'_>, all: &[PlotLine<'_>]) -> String {
    let mut style = FILE_STYLE.to_owned();
    for (line, colour) in all.iter().zip(FILE_COLOURS) {
        let class = line.class;
        let _ = write!(
            style,
            ".line.{class}{{stroke:{colour}}}.label.{class}{{fill:{colour}}}"
        );
    }
    let [width, height] = SIZE;
    let (whole, text_y) = (height + TITLE, TITLE - 8.0);
    let plot = lines(title, run, all);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {whole}\" \
         width=\"{width}\" height=\"{whole}\"><style>{style}</style>\
         <rect width=\"{width}\" height=\"{whole}\" fill=\"#ffffff\"/>\
         <text x=\"{LEFT}\" y=\"{text_y}\">{title}</text>\
         <svg y=\"{TITLE}\" height=\"{height}\"{}</svg>\n",
        plot.trim_start_matches("<svg")
    )
}

/// The plane that figures are drawn on.
struct Plane {
    times: Vec<f64>,
    longest: f64,
    most: f64,
    step: f64,
}

impl Plane {
    /// A plane up to `highest` or a little more.
    fn new(run: &PlottedRun<'_>, highest: f64) -> Self {
        let last = run.times.last().copied().unwrap_or(0.0);
        let longest = last.max(SHORTEST);
        let mut times = run.times.to_vec();
        // One frame is a level line, not a point.
        if times.len() == 1 {
            times.push(longest);
        }
        let step = nice_step(highest / STEPS);
        Self {
            times,
            longest,
            // What passes the last number by a little needs no other number above it.
            most: ((highest / step - OVERSHOOT).ceil().max(1.0) * step).max(highest),
            step,
        }
    }

    fn x(&self, time: f64) -> f64 {
        LEFT + time / self.longest * (SIZE[0] - LEFT - RIGHT)
    }

    fn y(&self, value: f64) -> f64 {
        SIZE[1] - BOTTOM - value / self.most * (SIZE[1] - TOP - BOTTOM)
    }

    fn points(&self, values: &[f64]) -> String {
        let last = values.last().copied().unwrap_or(0.0);
        let held = values.iter().copied().chain(std::iter::repeat(last));
        let point =
            |(time, value): (&f64, f64)| format!("{:.1},{:.1}", self.x(*time), self.y(value));
        let points: Vec<String> = self.times.iter().zip(held).map(point).collect();
        points.join(" ")
    }

    /// Saccades, grid, numbers, and the mark of the pictured frame.
    fn begin(&self, title: &str, run: &PlottedRun<'_>) -> String {
        let [width, height] = SIZE;
        let mut svg =
            format!(r#"<svg viewBox="0 0 {width} {height}" role="img" aria-label="{title}">"#);
        let [top, bottom] = [TOP, height - BOTTOM];
        for (at, _) in run.moving.iter().enumerate().filter(|(_, moves)| **moves) {
            let [from, to] = [run.times[at - 1], run.times[at]].map(|time| self.x(time));
            let (w, h) = (to - from, bottom - top);
            let _ = write!(
                svg,
                r#"<rect class="saccade" x="{from:.1}" y="{top}" width="{w:.1}" height="{h}"/>"#
            );
        }
        self.numbers(&mut svg, run.unit);
        if let Some(time) = run.pictured.and_then(|frame| run.times.get(frame)) {
            let x = self.x(*time);
            let _ = write!(
                svg,
                r#"<line class="pictured" x1="{x:.1}" x2="{x:.1}" y1="{top}" y2="{bottom}"/>"#
            );
        }
        svg
    }

    fn numbers(&self, svg: &mut String, unit: &str) {
        let [left, right, bottom] = [LEFT, SIZE[0] - RIGHT, SIZE[1] - BOTTOM];
        for (value, text) in ticks(self.most, self.step) {
            let y = self.y(value);
            let (end, base) = (left - 6.0, y + 4.0);
            let _ = write!(
                svg,
                r#"<line class="grid" x1="{left}" x2="{right}" y1="{y:.1}" y2="{y:.1}"/>"#
            );
            let _ = write!(
                svg,
                r#"<text class="number" text-anchor="end" x="{end}" y="{base:.1}">{text}</text>"#
            );
        }
        let base = bottom + 17.0;
        for (time, text) in ticks(self.longest, nice_step(self.longest / STEPS)) {
            let x = self.x(time);
            let _ = write!(
                svg,
                r#"<text class="number" text-anchor="middle" x="{x:.1}" y="{base}">{text}</text>"#
            );
        }
        let x = right + 6.0;
        let _ = write!(
            svg,
            r#"<text class="number" x="{x}" y="{base}">{unit}</text>"#
        );
    }
}

/// The next of 1, 2, 5, 10, 20, .. that is not less than `least`.
fn nice_step(least: f64) -> f64 {
    let decade = 10f64.powf(least.max(1e-9).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade);
    let enough = |step: &f64| *step >= least * (1.0 - 1e-9);
    steps.into_iter().find(enough).unwrap_or(10.0 * decade)
}

/// Multiples of `step` up to `most`, and how they are written.
fn ticks(most: f64, step: f64) -> Vec<(f64, String)> {
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let count = (most / step * (1.0 + 1e-9)).floor() as usize;
    let tick = |at: usize| {
        let value = at as f64 * step;
        (value, format!("{value:.decimals$}"))
    };
    (0..=count).map(tick).collect()
}

/// Labels moved apart until none covers another: up from the lowest, then down from the top of the
/// plane where that is not enough.
fn spread(mut labels: Vec<(f64, &str)>) -> Vec<(f64, &str)> {
    labels.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut lowest = f64::INFINITY;
    for (y, _) in &mut labels {
        *y = y.min(lowest);
        lowest = *y - LABEL_HEIGHT;
    }
    let mut highest = TOP;
    for (y, _) in labels.iter_mut().rev() {
        *y = y.max(highest);
        highest = *y + LABEL_HEIGHT;
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_count_in_ones_twos_and_fives() {
        for (least, step) in [
            (0.9, 1.0),
            (1.1, 2.0),
            (25.0, 50.0),
            (0.03, 0.05),
            (6.0, 10.0),
        ] {
            let found = nice_step(least);
            assert!((found / step - 1.0).abs() < 1e-9, "{least} gave {found}");
        }
    }

    #[test]
    fn labels_never_cover_each_other() {
        let near_the_middle = vec![(100.0, "a"), (99.0, "b"), (101.0, "c"), (20.0, "d")];
        let at_the_top = vec![(TOP, "a"), (TOP, "b"), (TOP + 1.0, "c")];
        for labels in [near_the_middle, at_the_top] {
            for pair in spread(labels).windows(2) {
                assert!(pair[0].0 - pair[1].0 >= LABEL_HEIGHT && pair[1].0 >= TOP);
            }
        }
    }

    #[test]
    fn a_run_of_one_frame_is_a_level_line() {
        let run = PlottedRun {
            times: &[0.0],
            unit: "seconds",
            moving: &[false],
            pictured: Some(0),
        };
        let values = vec![3.0];
        let svg = lines(
            "one",
            &run,
            &[PlotLine {
                class: "full",
                values,
            }],
        );
        assert!(!svg.contains("NaN") && svg.contains("polyline"));
    }

    #[test]
    fn a_file_holds_its_lines_its_unit_and_its_own_style() {
        let run = PlottedRun {
            times: &[0.0, 50.0, 100.0],
            unit: "ms",
            moving: &[],
            pictured: None,
        };
        let line = |class, slope: f64| PlotLine {
            class,
            values: vec![0.0, slope, 2.0 * slope],
        };
        let svg = file("degrees", &run, &[line("last", 4.0), line("head", 1.0)]);
        assert_eq!(svg.matches("<polyline").count(), 2);
        assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
        for text in ["xmlns", ">degrees<", ">ms<", ".line.head{stroke:", ">100<"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("pictured") && !svg.contains("NaN"));
    }
}
