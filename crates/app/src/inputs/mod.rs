//! What does Foveal do with a file of each format: what it reads, mends, remarks on and refuses?
//!
//! `foveal prepare formats` prints the table, and docs/formats/inputs.md is what it prints.

mod cameras;
mod format;
mod gltf;
mod meshes;
mod panels;
mod points;
mod stills;
mod textures;
mod video;

pub(crate) use format::Format;
use std::fmt::Write;

const ALL: [&[Format]; 8] = [
    meshes::FORMATS,
    gltf::FORMATS,
    textures::FORMATS,
    points::FORMATS,
    video::FORMATS,
    stills::FORMATS,
    cameras::FORMATS,
    panels::FORMATS,
];

/// The table.
pub(crate) fn all() -> impl Iterator<Item = &'static Format> {
    ALL.iter().copied().flatten()
}

/// The table as Markdown.
pub(crate) fn markdown() -> String {
    let mut text = "# Inputs\n\n\
        What is read of each format, and how irregular files are handled. *Mended* is \
        counted by name in `repairs`, *remarked* is listed in `remarks`; `prepare` and `info` show \
        both. `foveal prepare formats` prints this page.\n"
        .to_owned();
    for format in all() {
        let _ = write!(text, "\n## {}\n\n{}\n", format.name, format.read);
        if !format.rows.is_empty() {
            text += "\n| found | | what is shown and reported |\n|---|---|---|\n";
        }
        for row in format.rows {
            let _ = writeln!(
                text,
                "| {} | {} | {} |",
                row.found,
                row.outcome.word(),
                row.told
            );
        }
    }
    text
}
