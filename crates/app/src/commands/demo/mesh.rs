//! How soon is a mesh or a cloud sharp that comes through a narrow link?

use crate::commands::demo::page::part::{
    Card, FigureRow, Plot, ReportPart, Table, is_little, picture,
};
use crate::commands::demo::scene::content::PreparedScene;
use crate::commands::demo::scene::watched::{
    LEVELS_S, LINK_BYTES, LinkMoment, MOMENTS_S, Runs, SHARP, SceneRun, WATCHED,
};
use crate::commands::demo::video::facts::size;
use crate::report::html::escape;
use crate::report::output;
use crate::report::plot::{PlotLine, PlottedRun, lines};
use crate::run::run_folder::LOG;
use anyhow::Context;
use foveal_core::units::counted;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A mesh that is there whole within this time needs no choice, in seconds.
const SOON_S: f64 = 2.0;

/// What one policy brought, as the demo prints it.
#[derive(Debug, Serialize)]
pub(super) struct SceneFigures {
    /// Until the fovea was within 1 % of all detail; null where it never was.
    seconds_to_sharp: Option<f64>,
    bytes_to_sharp: Option<u64>,
    time_of_uniform: Option<f64>,
    bytes_of_uniform: Option<f64>,
    moments: Vec<MomentFigures>,
}

/// What it shows at one moment.
#[derive(Debug, Serialize)]
struct MomentFigures {
    t_s: f64,
    bytes: u64,
    triangles: u64,
    units: u32,
    error_fovea: Option<f64>,
    error_all: f64,
    psnr_db: Option<f64>,
    jod: Option<f64>,
}

/// Writes the logs of both policies into folders of their own under `out`.
pub(super) fn write_logs(scene: &PreparedScene, runs: &Runs, out: &Path) -> anyhow::Result<()> {
    for run in &runs.runs {
        let folder = out.join(format!("{}-{}", scene.content.name, run.name));
        std::fs::create_dir_all(&folder)
            .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
        output::write_whole(&folder.join(LOG), run.log.as_bytes())?;
    }
    Ok(())
}

/// The figures of both policies, by name.
pub(super) fn by_policy(runs: &Runs) -> BTreeMap<&'static str, SceneFigures> {
    let [uniform, _] = &runs.runs;
    let figures = |run: &SceneRun| SceneFigures {
        seconds_to_sharp: run.sharp.map(|it| it.0),
        bytes_to_sharp: run.sharp.map(|it| it.1),
        time_of_uniform: ratio(run, uniform, |it| it.0),
        bytes_of_uniform: ratio(run, uniform, |it| it.1 as f64),
        moments: run.moments.iter().map(MomentFigures::of).collect(),
    };
    runs.runs
        .iter()
        .map(|run| (run.name, figures(run)))
        .collect()
}

/// What a policy took until all was sharp, over what another did.
fn ratio(run: &SceneRun, other: &SceneRun, of: fn((f64, u64)) -> f64) -> Option<f64> {
    Some(of(run.sharp?) / of(other.sharp?).max(f64::MIN_POSITIVE))
}

impl MomentFigures {
    fn of(moment: &LinkMoment) -> Self {
        Self {
            t_s: moment.t_s,
            bytes: moment.bytes,
            triangles: moment.triangles,
            units: moment.units,
            error_fovea: moment.error_fovea,
            error_all: moment.error_all,
            psnr_db: moment.psnr_db,
            jod: moment.jod,
        }
    }
}

/// The part of a scene that was watched.
pub(super) fn part(scene: &PreparedScene, runs: &Runs) -> ReportPart {
    let what = match runs.triangles {
        0 => "cloud",
        _ => "mesh",
    };
    ReportPart {
        title: format!("A {what} through 4 Mbit/s: {}", scene.content.name),
        facts: facts(scene, runs),
        cards: cards(runs),
        little: little(scene, runs),
        pictures: pictures(runs),
        plot: plot(runs),
        table: table(runs),
        took_s: 0.0,
    }
}

fn facts(scene: &PreparedScene, runs: &Runs) -> String {
    let about = scene.file.pack().description();
    let origin = match scene.content.is_drawn {
        true => "Drawn by the program: a rope in a knot, with a colour a vertex",
        false => &about.source.names.join(", "),
    };
    let shapes = match runs.triangles {
        0 => "points".to_owned(),
        triangles => format!("{} in view", counted(triangles, "triangle")),
    };
    let [w, h] = runs.view.size;
    let (across, [right, up]) = (WATCHED.fov_deg, runs.gaze_deg);
    let shown = format!(
        "{origin}: {shapes}. The view is {w}×{h} pixels, {across:.0}° across; the viewer stands \
         still and looks {right}° to the right of its middle and {up}° up."
    );
    let pack = format!(
        "Pack: {}, {} from {}; read and prepared in {:.1} s.",
        counted(scene.file.pack().rows().len(), "unit"),
        size(scene.file.bytes() as f64),
        size(about.source.bytes as f64),
        scene.took.as_secs_f64(),
    );
    format!(
        "<p>{}</p>\n<p class=\"soft\">{}</p>\n<p class=\"soft\">The link brings 4 Mbit/s without \
         loss or delay. <code>uniform</code> buys what the view resolves, <code>perceptual</code> \
         what the eye resolves where it looks. The picture of all units is both full and source: \
         the finest level is the source’s own shape, on a grid of 14 bits. The judge was made \
         for video, and its scores of such stills have not been checked with viewers; PSNR and the \
         error of luminance stand next to them in the table.</p>\n",
        escape(&shown),
        escape(&pack)
    )
}

fn cards(runs: &Runs) -> Vec<Card> {
    let [uniform, own] = &runs.runs;
    let second = |run: &SceneRun| run.moments.iter().find(|it| it.t_s == LEVELS_S).cloned();
    let (of_uniform, of_own) = (
        second(uniform).unwrap_or_default(),
        second(own).unwrap_or_default(),
    );
    let detail = match runs.triangles {
        0 => Card {
            name: "Units after 2 s",
            value: of_own.units.to_string(),
            notes: vec![format!("uniform {}", of_uniform.units)],
        },
        all => Card {
            name: "Triangles after 2 s",
            value: thousands(of_own.triangles),
            notes: vec![
                format!("uniform {}", thousands(of_uniform.triangles)),
                format!("of {} in view", thousands(all)),
            ],
        },
    };
    let jod = |moment: &LinkMoment| moment.jod.map_or("–".to_owned(), |jod| format!("{jod:.2}"));
    vec![
        detail,
        Card {
            name: "Bytes until sharp",
            value: bytes_told(own.sharp),
            notes: vec![
                "where the eye looks".to_owned(),
                format!("uniform {}", bytes_told(uniform.sharp)),
            ],
        },
        Card {
            name: "Time until sharp",
            value: seconds_told(own.sharp),
            notes: vec![
                "within 1 % of all detail".to_owned(),
                format!("uniform {}", seconds_told(uniform.sharp)),
            ],
        },
        Card {
            name: "Score after 2 s",
            value: format!("{}&#8239;JOD", jod(&of_own)),
            notes: vec![
                "against full, which is the source".to_owned(),
                format!("uniform {}", jod(&of_uniform)),
            ],
        },
    ]
}

fn thousands(count: u64) -> String {
    match count {
        ..10_000 => count.to_string(),
        _ => format!("{:.0}&#8239;k", count as f64 / 1e3),
    }
}

fn bytes_told(sharp: Option<(f64, u64)>) -> String {
    sharp.map_or("not reached".to_owned(), |(_, bytes)| {
        format!("{:.2}&#8239;MB", bytes as f64 / 1e6)
    })
}

fn seconds_told(sharp: Option<(f64, u64)>) -> String {
    let most = WATCHED.longest_s;
    sharp.map_or(format!("over {most:.0}&#8239;s"), |(seconds, _)| {
        format!("{seconds:.1}&#8239;s")
    })
}

/// Why little is gained, where that is so.
fn little(scene: &PreparedScene, runs: &Runs) -> Option<String> {
    let [uniform, own] = &runs.runs;
    let [of_uniform, of_own] = [uniform, own].map(|run| match run.sharp {
        Some((seconds, _)) => seconds,
        None => WATCHED.longest_s,
    });
    if !is_little(of_own, of_uniform) {
        return None;
    }
    let whole_s = scene.file.bytes() as f64 / LINK_BYTES;
    Some(match whole_s <= SOON_S {
        true => format!("the link brings the whole pack within {whole_s:.1} s"),
        false => "nearly all of what is in view lies where the eye looks, or what is missing \
                  there is as large as all the rest"
            .to_owned(),
    })
}

/// What each policy shows at each moment, and all of it.
fn pictures(runs: &Runs) -> String {
    let [uniform, own] = &runs.runs;
    let mut figures = String::new();
    let moments = uniform.moments.iter().zip(&own.moments);
    for (moment, t_s) in moments.zip(MOMENTS_S) {
        for (moment, name) in [(moment.0, uniform.name), (moment.1, own.name)] {
            let jod = moment
                .jod
                .map_or(String::new(), |jod| format!(", {jod:.2} JOD"));
            let title = format!("{name}, {t_s} s");
            let text = format!("{}{jod}.", size(moment.bytes as f64));
            figures += &picture("", &moment.png, &title, &text);
        }
    }
    figures += &picture(
        "",
        &runs.whole,
        "All of it",
        "Every unit at its finest. The ring is 2.5° round the gaze.",
    );
    if let Some(levels) = &own.levels {
        let title = format!("{}, {LEVELS_S} s: levels", own.name);
        let text = "What it bought, from red, the finest level, to blue.";
        figures += &picture("", levels, &title, text);
    }
    format!("<h3>At the same moments</h3>\n<div class=\"pictures\">\n{figures}</div>\n")
}

/// The error where the eye looks, over time.
fn plot(runs: &Runs) -> Plot {
    let [uniform, own] = &runs.runs;
    let longest = match uniform.times.len() > own.times.len() {
        true => &uniform.times,
        false => &own.times,
    };
    let shared = PlottedRun {
        times: longest,
        unit: "seconds",
        moving: &[],
        pictured: None,
    };
    let line = |run: &SceneRun| PlotLine {
        class: run.name,
        values: run.errors.iter().map(|error| error * 100.0).collect(),
    };
    Plot {
        title: "Error where the eye looks",
        text: "root mean square of the difference of luminance within 2.5° of the gaze, in % of \
               its mean.",
        svg: lines(
            "Error where the eye looks",
            &shared,
            &[line(uniform), line(own)],
        ),
    }
}

fn table(runs: &Runs) -> Table {
    let [uniform, own] = &runs.runs;
    let both = |what: String, unit, cell: &dyn Fn(&SceneRun) -> String| FigureRow {
        what,
        unit,
        cells: vec![cell(uniform), cell(own)],
        opens_group: false,
    };
    let known = |value: Option<f64>, decimals: usize| {
        value.map_or("–".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let mut rows = vec![
        both("Sharp where the eye looks".to_owned(), "s", &|run| {
            known(run.sharp.map(|it| it.0), 1)
        }),
        both("Bytes until then".to_owned(), "MB", &|run| {
            known(run.sharp.map(|it| it.1 as f64 / 1e6), 2)
        }),
    ];
    for (at, t_s) in MOMENTS_S.into_iter().enumerate() {
        rows.push(FigureRow {
            opens_group: true,
            ..both(format!("After {t_s} s: score"), "JOD", &|run| {
                known(run.moments[at].jod, 2)
            })
        });
        rows.push(both("error where the eye looks".to_owned(), "%", &|run| {
            known(run.moments[at].error_fovea.map(|it| it * 100.0), 1)
        }));
        rows.push(both("error over the picture".to_owned(), "%", &|run| {
            format!("{:.1}", run.moments[at].error_all * 100.0)
        }));
        rows.push(both("PSNR over the picture".to_owned(), "dB", &|run| {
            known(run.moments[at].psnr_db, 1)
        }));
        rows.push(both("fetched".to_owned(), "MB", &|run| {
            format!("{:.2}", run.moments[at].bytes as f64 / 1e6)
        }));
        let shown = match runs.triangles {
            0 => both("units".to_owned(), "", &|run| {
                run.moments[at].units.to_string()
            }),
            _ => both("triangles".to_owned(), "", &|run| {
                run.moments[at].triangles.to_string()
            }),
        };
        rows.push(shown);
    }
    Table {
        title: format!(
            "Figures of both policies, sharp within {:.0} %",
            SHARP * 100.0
        ),
        columns: vec![uniform.name, own.name],
        rows,
    }
}
