//! Which display does a warp mesh describe?
//!
//! Bourke's text: the type of picture it is for, columns and rows of nodes, and for each node, row
//! by row, x and y on the display (x in half heights), u and v in the picture, both up, and the
//! share of light i, below 0 where nothing is drawn. Other programs write i from 0 to 255, and
//! words that are not numbers where nothing is drawn.

use foveal_core::units::counted;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::panel::alpha::AlphaMap;
use foveal_core::view::panel::rig::{Panel, PanelOutput, Rig};
use foveal_core::view::surface::Eye;
use glam::DVec3;

use super::super::entries::usual_surface;
use super::super::error::{NEXT, RigFault};
use super::foreign_text::text_of;
use super::warp_map::WarpMap;

/// Rows of the display: a mesh does not give them.
const ROWS: u32 = 1080;
/// Largest half width of a display, in half heights.
const WIDEST: f64 = 8.0;
/// Most nodes, and how often they may cover a display's pixels.
const MOST_NODES: usize = 1 << 20;
const MOST_COVERED: u64 = 64;
/// Most bytes of a text whose lines do not follow nodes.
const MOST_REFLOWED: usize = 1 << 26;
/// Largest number of a node.
const LARGEST: f64 = 1e5;
/// Largest place of a node in the picture that is a share of its width or height; larger ones count
/// pixels.
const MOST_SHARE: f64 = 2.0;
/// Largest number that is a share of light, and what other programs write for full light.
const MOST_LIGHT: f64 = 2.0;
const ALL_LIGHT: [f64; 2] = [255.0, 65_535.0];
const PERCENT: f64 = 100.0;
/// Width and height of the screen that the picture fills, in distances from the eye. How large it
/// looks is unknown.
const SCREEN: [f64; 2] = [1.0; 2];

/// A node: where on the display, where in the picture, and how bright.
#[derive(Clone, Copy)]
struct MeshNode {
    line: usize,
    at: [f64; 2],
    shows: [f64; 2],
    light: f64,
    /// Whether its light is the mean of red, green and blue.
    is_coloured: bool,
}

/// The share of light where nothing is drawn.
const UNLIT: f64 = -1.0;

impl MeshNode {
    fn next<'a>(lines: &mut impl Iterator<Item = (usize, &'a str)>) -> Result<Self, RigFault> {
        let (line, five) = next_numbers(lines, "x, y, u, v and i of a node", 4..=7)?;
        if five.len() == 6 {
            let what = "is not x, y, u, v and i of a node";
            return Err(RigFault::new(&format!("line {line}"), what, NEXT));
        }
        let is_number = five.iter().all(|it| it.is_finite());
        if is_number && five.iter().any(|it| it.abs() > LARGEST) {
            let what = format!("a node has numbers above {LARGEST}");
            return Err(RigFault::new(&format!("line {line}"), what, NEXT));
        }
        Ok(Self {
            line,
            at: [five[0], five[1]],
            shows: [five[2], five[3]],
            // A node with a value that is not a number is not drawn.
            light: match five.get(4..) {
                _ if !is_number => f64::NAN,
                Some(colours) if !colours.is_empty() => {
                    colours.iter().sum::<f64>() / colours.len() as f64
                }
                _ => 1.0,
            },
            is_coloured: five.len() == 7,
        })
    }

    fn is_number(&self) -> bool {
        !self.light.is_nan()
    }
}

impl Default for MeshNode {
    /// A node where nothing is drawn.
    fn default() -> Self {
        Self {
            line: 0,
            at: [0.0; 2],
            shows: [0.0; 2],
            light: UNLIT,
            is_coloured: false,
        }
    }
}

/// A grid of nodes.
struct WarpMesh {
    columns: usize,
    nodes: Vec<MeshNode>,
}

/// Reads a mesh, and says what of it is left out.
pub(in super::super) fn read(bytes: &[u8]) -> Result<(Rig, Vec<String>), RigFault> {
    let text = text_of(bytes)?;
    let (mesh, notes) = WarpMesh::of(&text.replace("\r\n", "\n").replace('\r', "\n"))?;
    let aspect = mesh
        .nodes
        .iter()
        .filter(|it| it.at[0].is_finite())
        .map(|it| it.at[0].abs())
        .fold(0.0, f64::max);
    if !(0.01..=WIDEST).contains(&aspect) {
        let what = format!("x reaches {aspect}, and is to reach 0.01 to {WIDEST}");
        return Err(RigFault::new("", what, NEXT));
    }
    let size = [((f64::from(ROWS) * aspect).round() as u32).max(2), ROWS];
    let view = EyeView {
        position: DVec3::ZERO,
        axes: Axes::FRONT,
        field: Field::symmetric(SCREEN.map(|side| side / 2.0)),
        size,
        eye: Eye::Left,
    };
    let mut panel = Panel {
        is_for_both: true,
        output: PanelOutput {
            surface: usual_surface(),
            ..PanelOutput::default()
        },
        ..Panel::flat("mesh", view)
    };
    let drawn = mesh.drawn(aspect, size)?;
    let share = |row: usize, column: usize| drawn.shows[row * size[0] as usize + column];
    let bent = WarpMap::of(size, drawn.is_mirrored, &share);
    let is_dimmed = drawn.light.iter().any(|it| *it != u16::MAX);
    let alpha = is_dimmed.then(|| AlphaMap::new(size, drawn.light.clone()));
    let bent = bent.and_then(|bent| bent.bend(&mut panel, alpha));
    bent.map_err(|what| RigFault::new("", what, NEXT))?;
    let rig = Rig {
        panels: vec![panel],
        ipd: 0.063,
        screen: Some(SCREEN),
    };
    Ok((rig, notes))
}

/// What the pixels of a display show, row by row from above; not a number where nothing is drawn.
struct DrawnMesh {
    shows: Vec<[f64; 2]>,
    light: Vec<u16>,
    /// Whether left is right.
    is_mirrored: bool,
}

/// A line without what is meant for people: from `#` or `//` on, or all of it after `;` or `%` at
/// its start.
fn without_comment(line: &str) -> &str {
    let end = [line.find('#'), line.find("//")]
        .into_iter()
        .flatten()
        .min();
    let line = line[..end.unwrap_or(line.len())].trim();
    if line.starts_with([';', '%']) {
        ""
    } else {
        line
    }
}

/// Whether a line names the columns below it.
fn is_heading(line: &str) -> bool {
    let words = words(line, 8);
    let is_name = |it: &&str| {
        let it = it.trim_matches(['"', '\'']);
        [
            "x",
            "y",
            "u",
            "v",
            "i",
            "intensity",
            "type",
            "columns",
            "rows",
        ]
        .iter()
        .any(|name| it.eq_ignore_ascii_case(name))
    };
    !words.is_empty() && words.iter().all(is_name)
}

/// The words of a line, separated by blanks, or by commas or semicolons where a word ends in one or
/// blanks separate nothing. At most one more than `most`.
fn words(line: &str, most: usize) -> Vec<&str> {
    let of = |parts: &[char]| -> Vec<&str> {
        let is_end = |it: char| it.is_whitespace() || parts.contains(&it);
        let words = line.split(is_end).filter(|it| !it.is_empty());
        words.take(most + 1).collect()
    };
    let by_blanks = of(&[]);
    let ends = |it: &&&str| it.ends_with([',', ';']);
    match by_blanks.len() == 1 || by_blanks.iter().any(|it| ends(&it)) {
        true => of(&[',', ';']),
        false => by_blanks,
    }
}

/// A number, with a point or a comma before its fraction.
fn number(word: &&str) -> Option<f64> {
    word.parse()
        .or_else(|_| word.replace(',', ".").parse())
        .ok()
}

/// The numbers of the next line, whose count must be in `counts`.
fn next_numbers<'a>(
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
    what: &str,
    counts: std::ops::RangeInclusive<usize>,
) -> Result<(usize, Vec<f64>), RigFault> {
    let Some((line, text)) = lines.next() else {
        return Err(RigFault::new("", format!("ends before {what}"), NEXT));
    };
    let numbers: Option<Vec<f64>> = words(text, *counts.end()).iter().map(number).collect();
    let sound = numbers.filter(|it| counts.contains(&it.len()));
    let fault = || RigFault::new(&format!("line {line}"), format!("is not {what}"), NEXT);
    sound.map(|it| (line, it)).ok_or_else(fault)
}

/// The same text with a line for each node, where its lines do not follow nodes; none where they
/// do, or its numbers do not come out even.
fn reflowed(text: &str) -> Option<String> {
    let lines = text.lines().map(without_comment);
    let lines: Vec<&str> = lines
        .filter(|it| !it.is_empty() && !is_heading(it))
        .collect();
    let counts = words(lines.get(..2).map_or("", |it| it[1]), 7).len();
    let first = words(lines.first()?, 8).len();
    // The type alone or with the counts, then lines of nodes.
    let is_usual = match (first, counts) {
        (1, 2) => lines
            .get(2)
            .is_none_or(|it| (4..=7).contains(&words(it, 8).len())),
        (3, 4..=7) => true,
        _ => false,
    };
    if is_usual || text.len() > MOST_REFLOWED {
        return None;
    }
    let all: Vec<&str> = lines
        .iter()
        .flat_map(|it| words(it, MOST_NODES * 8))
        .collect();
    let count = |k: usize| {
        all.get(k)?
            .parse::<usize>()
            .ok()
            .filter(|it| *it <= MOST_NODES)
    };
    let nodes = count(1)?.checked_mul(count(2)?).filter(|it| *it > 0)?;
    let rest = all.get(3..)?;
    let of_node = [5, 4].into_iter().find(|of| rest.len() == nodes * of)?;
    let mut text = format!("{}\n{} {}\n", all[0], all[1], all[2]);
    for node in rest.chunks(of_node) {
        text.push_str(&node.join(" "));
        text.push('\n');
    }
    Some(text)
}

impl WarpMesh {
    /// Of text whose lines end in line feeds; with what is left out of it.
    fn of(text: &str) -> Result<(Self, Vec<String>), RigFault> {
        let reflowed = reflowed(text);
        let text = reflowed.as_deref().unwrap_or(text);
        let lines = (1..).zip(text.lines().map(without_comment));
        let lines = lines.filter(|(_, line)| !line.is_empty() && !is_heading(line));
        let mut lines = lines.peekable();
        // Some write the type before the counts, in their line.
        let is_one = lines
            .peek()
            .is_some_and(|(_, line)| words(line, 3).len() == 3);
        if !is_one {
            next_numbers(&mut lines, "the type of the picture", 1..=1)?;
        }
        let own = 2 + usize::from(is_one);
        let (line, counts) = next_numbers(&mut lines, "columns and rows of nodes", own..=own)?;
        let counts = &counts[own - 2..];
        let is_count = |it: &f64| it.fract() == 0.0 && (2.0..=1e5).contains(it);
        let [columns, rows] = [counts[0] as usize, counts[1] as usize];
        if !counts.iter().all(is_count) || columns * rows > MOST_NODES {
            let what =
                format!("columns and rows are not 2 or more, and {MOST_NODES} at most in all");
            return Err(RigFault::new(&format!("line {line}"), what, NEXT));
        }
        let (mut nodes, mut notes) = (Vec::new(), Vec::new());
        while nodes.len() < columns * rows {
            match MeshNode::next(&mut lines) {
                // The file breaks off within a row.
                Err(_) if lines.peek().is_none() && nodes.len() >= 2 * columns => break,
                node => nodes.push(node?),
            }
        }
        let unlit = |count: usize, which: &str| {
            let found = counted(count as u64, "node");
            (count > 0).then(|| format!("nothing is drawn at {found} {which}"))
        };
        let without = nodes.iter().filter(|it| !it.is_number()).count();
        notes.extend(unlit(without, "with a value that is not a number"));
        let missing = columns * rows - nodes.len();
        notes.extend(unlit(missing, "missing at the end of the file"));
        nodes.resize(columns * rows, MeshNode::default());
        notes.extend(lines.next().map(|(line, _)| {
            format!("line {line} and what follows come after the nodes and are not read")
        }));
        let mut mesh = Self { columns, nodes };
        if mesh.nodes.iter().any(|it| it.is_coloured) {
            let what = "its light has colours: the mean of red, green and blue is taken";
            notes.push(what.to_owned());
        }
        notes.extend(mesh.light_up());
        mesh.check_places()?;
        notes.extend(mesh.level_light());
        Ok((mesh, notes))
    }

    fn lit(&self) -> impl Iterator<Item = &MeshNode> {
        self.nodes.iter().filter(|it| it.light >= 0.0)
    }

    /// Refuses places in pixels of a picture, whose size is unknown.
    fn check_places(&self) -> Result<(), RigFault> {
        let reach = |k: usize| self.lit().map(|it| it.shows[k].abs()).fold(0.0, f64::max);
        let [u, v] = [0, 1].map(reach);
        match u.max(v) > MOST_SHARE {
            true => {
                let what = format!(
                    "u reaches {u} and v {v}, as pixels of a picture do, whose size is unknown: \
                     divide them by its width and height"
                );
                Err(RigFault::new("", what, NEXT))
            }
            false => Ok(()),
        }
    }

    /// Lights all nodes where none has any, so that nothing would be drawn, and says so.
    fn light_up(&mut self) -> Option<String> {
        let there = |it: &&mut MeshNode| it.is_number() && it.line > 0;
        if self.nodes.iter().any(|it| it.light > 0.0) {
            return None;
        }
        // Where some have 0, those below it are holes.
        let least = match self.nodes.iter().any(|it| it.light == 0.0) {
            true => 0.0,
            false => f64::NEG_INFINITY,
        };
        let mut dark: Vec<_> = self.nodes.iter_mut().filter(there).collect();
        dark.retain(|it| it.light >= least);
        dark.iter_mut().for_each(|it| it.light = 1.0);
        (!dark.is_empty()).then(|| {
            "none of its nodes has a light above 0, with which nothing would be drawn: it is drawn \
             in full light"
                .to_owned()
        })
    }

    /// Converts light in other units to shares, and says so.
    fn level_light(&mut self) -> Option<String> {
        let most = self.lit().map(|it| it.light).fold(0.0, f64::max);
        if most <= 1.0 {
            return None;
        }
        if most <= MOST_LIGHT {
            return Some(format!(
                "its light reaches {most}: values above 1 are treated as 1"
            ));
        }
        let all = match most == PERCENT {
            true => PERCENT,
            false => ALL_LIGHT
                .into_iter()
                .find(|all| most <= *all)
                .unwrap_or(most),
        };
        self.nodes.iter_mut().for_each(|it| it.light /= all);
        Some(format!(
            "its light reaches {most}, where 1 is full light: it is divided by {all}"
        ))
    }

    /// Its triangles, two a cell, of lit nodes.
    fn triangles(&self) -> impl Iterator<Item = [MeshNode; 3]> {
        let rows = self.nodes.len() / self.columns;
        let cells = (0..rows - 1).flat_map(|row| (0..self.columns - 1).map(move |k| (row, k)));
        let all = cells.flat_map(move |(row, column)| {
            let node = |down: usize, right: usize| {
                self.nodes[(row + down) * self.columns + column + right]
            };
            let [a, b, c, d] = [node(0, 0), node(0, 1), node(1, 1), node(1, 0)];
            [[a, b, c], [a, c, d]]
        });
        all.filter(|three| three.iter().all(|it| it.light >= 0.0))
    }

    /// Draws it as a player of meshes does: linear over triangles.
    fn drawn(&self, aspect: f64, size: [u32; 2]) -> Result<DrawnMesh, RigFault> {
        let count = size[0] as usize * size[1] as usize;
        let mut drawn = DrawnMesh {
            shows: vec![[f64::NAN; 2]; count],
            light: vec![u16::MAX; count],
            is_mirrored: false,
        };
        let (mut at_sign, mut shows_sign) = (0.0_f64, 0.0_f64);
        let mut covered = 0;
        for three in self.triangles() {
            let signs = [three.map(|it| it.at), three.map(|it| it.shows)].map(area);
            for (known, own) in [&mut at_sign, &mut shows_sign].into_iter().zip(signs) {
                if *known * own < 0.0 {
                    let place = format!("line {}", three[0].line);
                    let what = "the mesh folds over there: its cells do not all turn one way";
                    return Err(RigFault::new(&place, what, NEXT));
                }
                if own != 0.0 {
                    *known = own;
                }
            }
            covered += drawn.draw(&three, aspect, size);
            if covered > MOST_COVERED * count as u64 {
                let place = format!("line {}", three[0].line);
                let what = format!("the mesh covers the display more than {MOST_COVERED} times");
                return Err(RigFault::new(&place, what, NEXT));
            }
        }
        drawn.is_mirrored = at_sign * shows_sign < 0.0;
        Ok(drawn)
    }
}

/// Twice the area of a triangle, negative where it turns the other way.
fn area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

impl DrawnMesh {
    /// Draws a triangle, and returns how many pixels were tried.
    fn draw(&mut self, three: &[MeshNode; 3], aspect: f64, size: [u32; 2]) -> u64 {
        let [w, h] = size.map(f64::from);
        let corners = three.map(|it| {
            let [x, y] = it.at;
            [(x / aspect + 1.0) / 2.0 * w, (1.0 - y) / 2.0 * h]
        });
        let whole = area(corners);
        if whole == 0.0 {
            return 0;
        }
        let span = |k: usize| {
            let all = corners.iter().map(|it| it[k]);
            let low = all.clone().fold(f64::INFINITY, f64::min);
            let high = all.fold(f64::NEG_INFINITY, f64::max);
            let most = f64::from(size[k]);
            let first = (low - 0.5).ceil().clamp(0.0, most) as usize;
            let end = ((high - 0.5).floor() + 1.0).clamp(0.0, most) as usize;
            first..end.max(first)
        };
        let (columns, rows) = (span(0), span(1));
        for row in rows.clone() {
            for column in columns.clone() {
                let at = [column as f64 + 0.5, row as f64 + 0.5];
                let [a, b, c] = corners;
                let weights = [area([at, b, c]), area([a, at, c]), area([a, b, at])];
                let weights = weights.map(|it| it / whole);
                if weights.iter().any(|it| *it < -1e-9) {
                    continue;
                }
                let mean = |of: fn(&MeshNode) -> f64| {
                    let parts = three.iter().zip(weights);
                    parts.map(|(node, weight)| of(node) * weight).sum::<f64>()
                };
                let k = row * size[0] as usize + column;
                self.shows[k] = [mean(|it| it.shows[0]), 1.0 - mean(|it| it.shows[1])];
                self.light[k] = (mean(|it| it.light).clamp(0.0, 1.0) * 65_535.0).round() as u16;
            }
        }
        (columns.len() * rows.len()) as u64 + 1
    }
}
