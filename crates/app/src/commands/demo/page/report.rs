//! How does what was played read as one page?
//!
//! The page holds all it shows: style, plots and pictures; it loads nothing and runs no script.

use crate::commands::demo::machine::Machine;
use crate::commands::demo::page::part::ReportPart;
use crate::report::html::escape;

const STYLE: &str = include_str!("report.css");

/// The page.
pub(crate) fn page(parts: &[ReportPart], machine: &Machine, seed: u64) -> String {
    let anchor = |at: usize| format!("part-{}", at + 1);
    let links: String = parts
        .iter()
        .enumerate()
        .map(|(at, part)| {
            let title = escape(&part.title);
            format!("<li><a href=\"#{}\">{title}</a></li>\n", anchor(at))
        })
        .collect();
    let sections: String = parts
        .iter()
        .enumerate()
        .map(|(at, part)| part.html(&anchor(at)))
        .collect();
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Foveal: only the detail that an eye can see</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n\
         <h1>Only the detail that an eye can see</h1>\n\
         <p class=\"lead\">The same content over the same gaze: with everything in full detail, \
         with everything in view, and with only what the eye can resolve. Each part shows what \
         that saves and how good it looks, also where it saves little.</p>\n\
         <nav><ol>\n{links}</ol></nav>\n\
         <p class=\"soft\">{machine}. foveal {version}.</p>\n</header>\n<main>\n{sections}\n\
         {how}\n</main>\n</body>\n</html>\n",
        machine = escape(&machine.text()),
        version = env!("CARGO_PKG_VERSION"),
        how = how_to_read(seed),
    )
}

fn how_to_read(seed: u64) -> String {
    format!(
        "<section>\n<h2>How to read this</h2>\n\
         <p>The gaze is simulated: fixations of 300&#8239;ms joined by saccades of 5° to 15° to \
         anywhere on the content (seed {seed}); on 360° content the head follows. Before a mesh \
         it rests. <code>full</code> takes every tile at the finest level. <code>viewport</code> \
         takes what is in view and a margin of 10° as densely as the display can show it, which \
         is what is usual today. <code>auto</code> is the rule that takes fewer pixels of this \
         content for an expected score of 9.5 against <code>full</code>, by the calibration of its \
         pack. All three also hold the whole coarsest level, so that nothing is ever \
         missing: with it, <code>full</code> is a little more than 100&#8239;% of the pixels.</p>\n\
         <p>To save time the demo prepares films at one quality, and their first 64 frames alone. \
         <code>foveal prepare video</code> looks for the coarsest quality that the eye hardly \
         sees, so its packs differ in size from these.</p>\n\
         <p>Scores are those of FovVideoVDP 1.2 in just-objectionable differences (JOD), in the \
         view of the part and for the true gaze. 10 is no difference; at 9.5 about 63 of 100 \
         people guess right which of the two is which, at 9 about 75. Of a film the first frames \
         are judged, 2 to 16; of a still some pictures of the run, one by one, of which the lowest \
         counts; of panels the one with the lowest. <code>full</code> is every finest tile, and \
         the source is the file itself, seen in the same view: the distance between the two is \
         what preparing lost.</p>\n\
         <p>Pixels are those of all tiles of a frame, over the pixels of the finest level. \
         Decoding time runs from asking for the tiles of a frame until the last one is there, on \
         all cores; stills are decoded again for each picture, as a film would be. A frame is late \
         when choosing and that take longer than it is shown, and incomplete when a coarser tile \
         stands in for one that was chosen. Bytes count each tile’s group of pictures once, when \
         it is first needed. The policies take turns frame by frame in one run on the machine \
         named above, so that other work on it touches them alike.</p>\n\
         <p>Not measured: a real network (only the mesh comes through a link, one without loss or \
         delay); uploading and drawing; sound; the delay and the error of a real eye tracker; and \
         whether a person would see the difference, which the pictures on this page cannot show, \
         since you look at them with a gaze of your own.</p>\n</section>\n"
    )
}
