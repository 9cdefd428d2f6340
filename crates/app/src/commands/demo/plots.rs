//! Which figures are plotted over time?

use crate::commands::demo::colours;
use crate::commands::demo::run::{FOVEATED, Played};
use crate::report::plot::{Layer, PlotLine, PlottedRun, lines, stack};
use foveal_play::FrameReport;

/// All plots of one content.
pub(super) fn all(played: &Played) -> String {
    let figure = |title: &str, text: &str, plot: String| {
        format!("<figure><figcaption><b>{title}.</b> {text}</figcaption>\n{plot}</figure>\n")
    };
    let pixels = of_all(played, "Pixels", |reports| {
        reports.iter().map(|report| report.share * 100.0).collect()
    });
    let bytes = of_all(played, "Bytes fetched", |reports| {
        let sum = |sum: &mut u64, report: &FrameReport| {
            *sum += report.new_bytes;
            Some(*sum as f64 / 1e6)
        };
        reports.iter().scan(0, sum).collect()
    });
    let decode = of_all(played, "Decoding time", |reports| {
        let ms = |report: &FrameReport| report.decode.as_secs_f64() * 1e3;
        reports.iter().map(ms).collect()
    });
    format!(
        "<h3>Over time</h3>\n<p class=\"soft\">Grey bands are saccades; the dotted line is the \
         frame in the pictures.</p>\n<div class=\"plots\">\n{}{}{}{}</div>\n",
        figure("Pixels a frame", "% of the finest level", pixels),
        figure("Bytes fetched so far", "MB", bytes),
        figure(
            "Decoding time a frame",
            "ms; after a saccade new tiles are decoded from their key frame on",
            decode
        ),
        figure(
            "Tiles on the GPU",
            "under perceptual, finest level at the bottom",
            levels(played) + &colours::level_key(played.content.file.pack().description())
        ),
    )
}

fn run(played: &Played) -> PlottedRun<'_> {
    PlottedRun {
        times: &played.times,
        unit: "seconds",
        moving: &played.moment.moving,
        pictured: Some(played.moment.frame as usize),
    }
}

fn of_all(played: &Played, title: &str, values: fn(&[FrameReport]) -> Vec<f64>) -> String {
    let line = |index: usize| PlotLine {
        class: &played.runs[index].summary.policy,
        values: values(&played.runs[index].reports),
    };
    let all: Vec<PlotLine<'_>> = (0..played.runs.len()).map(line).collect();
    lines(title, &run(played), &all)
}

fn levels(played: &Played) -> String {
    let coarsest = played.content.file.pack().description().levels - 1;
    let reports = &played.runs[FOVEATED].reports;
    let layer = |level: u8| {
        let count = |report: &FrameReport| f64::from(report.histogram[usize::from(level)]);
        Layer {
            colour: colours::css_of_level(level, coarsest),
            values: reports.iter().map(count).collect(),
        }
    };
    let layers: Vec<Layer> = (0..=coarsest).map(layer).collect();
    stack("Tiles by level under perceptual", &run(played), &layers)
}
