//! What do the panels of a rig need of one source?

use crate::commands::demo::page::part::{Card, FigureRow, ReportPart};
use crate::commands::demo::video::common::{
    bytes_card, little_saved, percent, pictures, pixels_plot, score_card, table, time_card,
};
use crate::commands::demo::video::facts::paragraphs;
use crate::commands::demo::video::run::{FOVEATED, Played, VIEWPORT};
use crate::commands::demo::video::setup::PlaySetup;
use crate::options::panels::around_the_head;
use crate::report::output;
use anyhow::Context;
use foveal_core::content::policy::Policy;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::surface::Eye;
use foveal_scene::rig::read_rig;
use std::path::Path;

/// Twelve displays before each eye.
const TWELVE: &str = include_str!("../../../../../examples/panels/twelve.toml");

/// The panels before the left eye of a rig, or of twelve where none is given; `out` then gets its
/// file.
pub(super) fn panels(rig: Option<&Path>, out: &Path) -> anyhow::Result<Vec<MountedPanel>> {
    let twelve = out.join("twelve.toml");
    let path = match rig {
        Some(path) => path,
        None => {
            output::write_whole(&twelve, TWELVE.as_bytes())?;
            &twelve
        }
    };
    let rig = read_rig(path)?;
    let panels: Vec<_> = rig.seen_by(Some(Eye::Left)).into_iter().cloned().collect();
    let found = (!panels.is_empty()).then(|| around_the_head(&panels));
    found.with_context(|| format!("{}: no panel is before the left eye", path.display()))
}

/// The part of a sphere that was played on panels.
pub(super) fn part(setup: &PlaySetup<'_>, played: &Played) -> anyhow::Result<ReportPart> {
    let content = setup.content;
    let apart = apart(setup, played.moment.frame)?;
    let needed = mean_pixels(played, VIEWPORT);
    let count = setup.panels.len();
    let shown: u64 = setup
        .panels
        .iter()
        .map(|panel| panel.size.map(u64::from).iter().product::<u64>())
        .sum();
    let mut table = table(played, setup);
    table.rows.insert(0, megapixels(played));
    let little = little_saved(played).map(|what| {
        format!(
            "the panels are about as coarse as what the eye resolves: <code>auto</code> takes \
             nearly as many {what} as <code>viewport</code>"
        )
    });
    let facts = format!(
        "The {} panels have {:.2} million pixels in all, turn with the head, and share one set \
         of tiles.",
        words(count).to_lowercase(),
        shown as f64 / 1e6
    );
    Ok(ReportPart {
        title: format!("{} panels from one source: {}", words(count), content.name),
        facts: paragraphs(content, &facts),
        cards: vec![
            needed_card(needed, apart),
            decoded_card(played, needed),
            bytes_card(played, content),
            time_card(played),
            score_card(played),
        ],
        little,
        pictures: pictures(played, content),
        plot: pixels_plot(played),
        table,
        took_s: 0.0,
    })
}

fn words(count: usize) -> String {
    match count {
        12 => "Twelve".to_owned(),
        _ => count.to_string(),
    }
}

/// Pixels of the tiles that all panels need at their own density, together and each for itself.
fn needed_card(together: f64, apart: f64) -> Card {
    Card {
        name: "Pixels needed",
        value: format!("{:.2}&#8239;MPix", together / 1e6),
        notes: vec![
            "by all panels together, at their density (viewport)".to_owned(),
            format!("{:.2} MPix if each fetched its own", apart / 1e6),
        ],
    }
}

/// Pixels that are decoded for one eye.
fn decoded_card(played: &Played, needed: f64) -> Card {
    let decoded = mean_pixels(played, FOVEATED);
    Card {
        name: "Pixels decoded",
        value: format!("{:.2}&#8239;MPix", decoded / 1e6),
        notes: vec![
            format!("a frame, {} of those needed", percent(decoded / needed)),
            format!(
                "{} of the source",
                percent(played.runs[FOVEATED].summary.pixels_share_mean)
            ),
        ],
    }
}

/// Pixels of the tiles of a frame.
fn mean_pixels(played: &Played, run: usize) -> f64 {
    let reports = &played.runs[run].reports;
    let sum: u64 = reports.iter().map(|report| report.pixels).sum();
    sum as f64 / reports.len().max(1) as f64
}

fn megapixels(played: &Played) -> FigureRow {
    let cell = |run| format!("{:.2}", mean_pixels(played, run) / 1e6);
    FigureRow {
        what: "Pixels a frame, mean".to_owned(),
        unit: "MPix",
        cells: (0..played.runs.len()).map(cell).collect(),
        opens_group: false,
    }
}

/// Pixels of the tiles of a picture if each panel fetched its own at its own density.
fn apart(setup: &PlaySetup<'_>, picture: u32) -> anyhow::Result<f64> {
    let (player, mut gaze) = setup.player(Policy::Viewport)?;
    let mut look = gaze.look(setup.shown.time(0, &player));
    for picture in 1..=picture {
        look = gaze.look(setup.shown.time(picture, &player));
    }
    let mut sum = 0;
    for panel in &setup.panels {
        let mut alone = setup.player_on(Policy::Viewport, vec![panel.clone()])?;
        sum += alone.show(setup.shown.frame(picture), &look)?.pixels;
    }
    Ok(sum as f64)
}
