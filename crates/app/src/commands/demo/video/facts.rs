//! What is known of a film or a picture before it is played?

use crate::commands::demo::video::content::{FRAMES, Prepared};
use crate::report::html::escape;
use foveal_core::content::video::grid::tile_grid::Cut;
use foveal_core::units::counted;
use foveal_core::view::surface::Projection;

/// What is shown and how, source, pack, licence and notes as paragraphs.
pub(crate) fn paragraphs(content: &Prepared, shown: &str) -> String {
    let licence = content.licence.map(|licence| format!("{licence}."));
    let soft = [Some(pack(content)), notes(content), licence]
        .into_iter()
        .flatten();
    let soft: String = soft
        .map(|text| format!("<p class=\"soft\">{}</p>\n", escape(&text)))
        .collect();
    format!(
        "<p>{} {}</p>\n{soft}",
        escape(&source(content)),
        escape(shown)
    )
}

/// What it is, its size and its length.
fn source(content: &Prepared) -> String {
    let about = content.file.pack().description();
    let [w, h] = about.source.size;
    let kind = match about.projection {
        Projection::Flat => "flat".to_owned(),
        Projection::Cube => format!("360°, on a cube of {0}×{0} pixel faces", about.size[0]),
        Projection::Equirect => "360°, equirectangular".to_owned(),
    };
    let origin = match content.generated {
        true => "Drawn by the program, with fine detail everywhere",
        false => &about.source.name,
    };
    let length = match about.is_still() {
        true => "a still".to_owned(),
        false => {
            let frames = counted(about.frames, "frame");
            format!("{frames} at {} a second", rate(about.fps()))
        }
    };
    format!("{origin}: {w}×{h}, {kind}, {length}.")
}

/// How the pack is cut and coded, and how long that took.
fn pack(content: &Prepared) -> String {
    let file = &content.file;
    let about = file.pack().description();
    let cut = match about.cut {
        Cut::Tile(px) => format!("tiles of {px} pixels"),
        Cut::Grid([c, r]) => format!("a grid of {c}×{r} a face"),
    };
    let is_calibrated = matches!(file.calibration(), Ok(Some(_)));
    let took = match content.took {
        Some(took) => {
            let drawn = if content.generated { "drawn, " } else { "" };
            let calibrated = match is_calibrated {
                true => " and calibrated",
                false => ", not calibrated,",
            };
            format!("{drawn}prepared{calibrated} in {:.1} s", took.as_secs_f64())
        }
        None => "prepared by an earlier run and used again".to_owned(),
    };
    // Of pictures `prepare` takes the same quantisers.
    let quality = match about.is_still() {
        true => "",
        false => {
            ", all of one quality to save time (foveal prepare looks for one by content, so its \
             packs differ in size)"
        }
    };
    format!(
        "Pack: {}, {}, {cut}, {}, {} from {}{quality}; {took}.",
        about.codec.name().to_uppercase(),
        counted(about.levels, "level"),
        counted(file.pack().units().count(), "unit"),
        size(file.bytes() as f64),
        size(about.source.bytes as f64),
    )
}

/// What a reader should know, where there is something.
fn notes(content: &Prepared) -> Option<String> {
    let mut notes = Vec::new();
    if content.is_cut_short() {
        notes.push(format!("Only its first {FRAMES} frames are played."));
    }
    let found = content.plan.remarks.all();
    if !content.generated && !found.is_empty() {
        notes.push(format!("Found on preparing: {}.", found.join("; ")));
    }
    (!notes.is_empty()).then(|| notes.join(" "))
}

/// Bytes in the unit that suits them.
pub(crate) fn size(bytes: f64) -> String {
    match bytes {
        ..1e6 => format!("{:.1} kB", bytes / 1e3),
        _ => format!("{:.2} MB", bytes / 1e6),
    }
}

/// Frames a second with two decimals at most.
fn rate(fps: f64) -> String {
    let text = format!("{fps:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
