//! What is known of a content before it is played?

use crate::commands::demo::content::FRAMES;
use crate::commands::demo::figures::frames;
use crate::commands::demo::run::Played;
use crate::report::html::escape;
use foveal_core::content::video::grid::tile_grid::Cut;
use foveal_core::units::counted;
use foveal_core::view::surface::Projection;

/// Source, pack, licence and notes as paragraphs.
pub(super) fn paragraphs(played: &Played) -> String {
    let licence = played.content.licence.map(|licence| format!("{licence}."));
    let soft = [Some(pack(played)), notes(played), licence]
        .into_iter()
        .flatten();
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
        Projection::Equirect => "360°, equirectangular".to_owned(),
    };
    let origin = if played.content.generated {
        "Drawn by the program, with fine detail everywhere"
    } else {
        &about.source.name
    };
    let frames = frames(&played.runs);
    let fps = rate(about.fps());
    format!("{origin}: {w}×{h}, {kind}, {frames} at {fps} a second.")
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
        Some(took) => {
            let drawn = if played.content.generated {
                "drawn and "
            } else {
                ""
            };
            format!("{drawn}prepared in {:.1} s", took.as_secs_f64())
        }
        None => "prepared by an earlier run and used again".to_owned(),
    };
    format!(
        "Pack: {}, {}, {cut}, {}, {} from {}; {took}.",
        about.codec.name().to_uppercase(),
        counted(about.levels, "level"),
        counted(file.pack().units().count(), "unit"),
        size(file.bytes()),
        size(about.source.bytes),
    )
}

/// What a reader should know, where there is something.
fn notes(played: &Played) -> Option<String> {
    let content = &played.content;
    let about = content.file.pack().description();
    let mut notes = Vec::new();
    if content.cut_short {
        notes.push(format!("Only its first {FRAMES} frames are played."));
    }
    let found = content.remarks.all();
    if !content.generated && !found.is_empty() {
        notes.push(format!("Found on preparing: {}.", found.join("; ")));
    }
    if about.projection == Projection::Flat {
        notes.push(
            "Flat content is in view as a whole, so viewport takes all of it at the density of \
             the display."
                .to_owned(),
        );
    }
    (!notes.is_empty()).then(|| notes.join(" "))
}

fn size(bytes: u64) -> String {
    match bytes {
        1_000_000.. => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{:.1} kB", bytes as f64 / 1e3),
    }
}

/// Frames a second with two decimals at most.
fn rate(fps: f64) -> String {
    let text = format!("{fps:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
