//! How does a drawing become an SVG file?

use crate::report::html::escape;
use std::fmt::Write as _;

/// Width and height of a drawing, the height of its title, and its margin.
const SIZE: [f64; 2] = [640.0, 420.0];
const TITLE: f64 = 28.0;
const MARGIN: f64 = 16.0;
const STYLE: &str = "text{font:13px sans-serif;fill:#30343a}\
    .panel{fill:#0a63b022;stroke:#0a63b0;stroke-width:1.5}\
    .source{fill:#7d848d22;stroke:#7d848d;stroke-width:1.5}\
    .ray{fill:none;stroke:#b86e00;stroke-width:0.8;stroke-dasharray:4 3}\
    .line{fill:none;stroke:#0a63b0;stroke-width:0.7}\
    .ideal{fill:none;stroke:#7d848d;stroke-width:0.7}\
    .id{text-anchor:middle}.eye{fill:#30343a}";

/// Lines and words, in units of their own, up or down as they are given.
#[derive(Default)]
pub(super) struct Drawing {
    lines: Vec<(&'static str, bool, Vec<[f64; 2]>)>,
    words: Vec<(String, [f64; 2])>,
    dots: Vec<[f64; 2]>,
}

impl Drawing {
    /// A line through points, by its class in the style sheet.
    pub(super) fn line(&mut self, class: &'static str, points: Vec<[f64; 2]>) {
        self.lines.push((class, false, points));
    }

    /// The same, closed.
    pub(super) fn outline(&mut self, class: &'static str, points: Vec<[f64; 2]>) {
        self.lines.push((class, true, points));
    }

    /// A word, its middle at a point.
    pub(super) fn word(&mut self, word: &str, at: [f64; 2]) {
        self.words.push((word.to_owned(), at));
    }

    /// An eye.
    pub(super) fn eye(&mut self, at: [f64; 2]) {
        self.dots.push(at);
    }

    /// The file, as large as fits, rows down.
    pub(super) fn file(&self, title: &str) -> String {
        let (low, scale) = self.frame();
        let place = |at: [f64; 2]| {
            [0, 1].map(|k| {
                let before = if k == 1 { TITLE } else { 0.0 };
                before + MARGIN + (at[k] - low[k]) * scale
            })
        };
        let [width, height] = [SIZE[0], SIZE[1] + TITLE];
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             width=\"{width}\" height=\"{height}\"><style>{STYLE}</style>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n\
             <text x=\"{MARGIN}\" y=\"20\">{}</text>\n",
            escape(title)
        );
        for (class, is_closed, points) in &self.lines {
            let points: Vec<String> = points
                .iter()
                .map(|it| place(*it))
                .map(|[x, y]| format!("{x:.1},{y:.1}"))
                .collect();
            let kind = if *is_closed { "polygon" } else { "polyline" };
            let points = points.join(" ");
            let _ = writeln!(svg, "<{kind} class=\"{class}\" points=\"{points}\"/>");
        }
        for at in &self.dots {
            let [x, y] = place(*at);
            let _ = writeln!(
                svg,
                "<circle class=\"eye\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>"
            );
        }
        for (word, at) in &self.words {
            let [x, y] = place(*at);
            let word = escape(word);
            let _ = writeln!(
                svg,
                "<text class=\"id\" x=\"{x:.1}\" y=\"{y:.1}\">{word}</text>"
            );
        }
        svg + "</svg>\n"
    }

    /// The upper left corner of the drawing, and pixels by its unit.
    fn frame(&self) -> ([f64; 2], f64) {
        let points = self.lines.iter().flat_map(|it| &it.2).chain(&self.dots);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for at in points {
            for k in 0..2 {
                low[k] = low[k].min(at[k]);
                high[k] = high[k].max(at[k]);
            }
        }
        let room = SIZE.map(|side| side - 2.0 * MARGIN);
        let side = [0, 1].map(|k| (high[k] - low[k]).max(1e-9));
        let scale = (room[0] / side[0]).min(room[1] / side[1]);
        // In the middle of what is left.
        let low = [0, 1].map(|k| low[k] - (room[k] / scale - side[k]) / 2.0);
        (low, scale)
    }
}
