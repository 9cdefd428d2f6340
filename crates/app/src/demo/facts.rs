//! What is known of a content before it is played?

use super::FRAMES;
use super::report::escape;
use super::run::Played;
use foveal_core::asset::tile_grid::Cut;
use foveal_core::view::surface::Projection;

/// Source, pack, licence and notes as paragraphs.
pub(super) fn paragraphs(played: &Played) -> String {
    let content = &played.content;
    let licence = content.licence.map(|licence| format!("{licence}."));
    let notes = notes(played).into_iter();
    let soft = [Some(pack(played)), licence]
        .into_iter()
        .flatten()
        .chain(notes);
    let soft: String = soft
        .map(|text| format!("<p class=\"soft\">{}</p>\n", escape(&text)))
        .collect();
    format!("<p>{}</p>\n{soft}", escape(&source(played)))
}

/// What it is, its size and its length.
fn source(played: &Played) -> String {
    let about = played.content.file.pack().description();
    let [w, h] = about.source.size;
    let kind = match about.projection {
        Projection::Flat => "flat".to_owned(),
        Projection::Cube => format!("360°, on a cube of {0}×{0} pixel faces", about.size[0]),
    };
    let origin = if played.content.generated {
        "Drawn by the program, with fine detail everywhere"
    } else {
        &about.source.name
    };
    let frames = played.times.len();
    let many = if frames == 1 { "" } else { "s" };
    let fps = about.fps();
    format!("{origin}: {w}×{h}, {kind}, {frames} frame{many} at {fps:.2} a second.")
}

/// How the pack is cut and coded, and how long that took.
fn pack(played: &Played) -> String {
    let file = &played.content.file;
    let about = file.pack().description();
    let cut = match about.cut {
        Cut::Tile(px) => format!("tiles of {px} pixels"),
        Cut::Grid([c, r]) => format!("a grid of {c}×{r} a face"),
    };
    let took = match played.content.took {
        Some(took) => format!("prepared in {:.1} s", took.as_secs_f64()),
        None => "prepared by an earlier run and used again".to_owned(),
    };
    format!(
        "Pack: {}, {} levels, {cut}, {} units, {:.1} MB from {:.1} MB; {took}.",
        about.codec.name(),
        about.levels,
        file.pack().units().count(),
        file.bytes() as f64 / 1e6,
        about.source.bytes as f64 / 1e6,
    )
}

fn notes(played: &Played) -> Vec<String> {
    let content = &played.content;
    let about = content.file.pack().description();
    let mut notes = Vec::new();
    if about.frames == FRAMES && !content.generated {
        notes.push(format!("At most the first {FRAMES} frames are played."));
    }
    if !content.generated {
        notes.extend(content.notes.iter().map(|note| format!("It is {note}.")));
    }
    if about.projection == Projection::Flat {
        notes.push(
            "Flat content is in view as a whole, so viewport takes all of it at the density of \
             the display."
                .to_owned(),
        );
    }
    notes
}
