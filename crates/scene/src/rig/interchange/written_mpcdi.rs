//! How is a rig written as an MPCDI?
//!
//! Profile 3d, version 2.0, a buffer a surface, maps that are linear between pixels; fades and
//! black are pictures, alphaMap and betaMap.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::Field;
use foveal_core::view::panel::alpha::AlphaMap;
use foveal_core::view::panel::distortion::GREEN;
use foveal_core::view::panel::drawn_grid::DrawnGrid;
use foveal_core::view::panel::fading::Fades;
use foveal_core::view::panel::placement::{Placement, SourceProjection};
use foveal_core::view::panel::rig::{Panel, Scanout};
use glam::DVec3;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::super::alpha;
use super::super::pfm;
use super::neat;

/// Least depth of a ray before the panel's axis: 89.9°.
const LEAST_DEPTH: f64 = 0.001_745;

/// An MPCDI, and what of the panels it has no place for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenMpcdi {
    /// The file.
    pub bytes: Vec<u8>,
    /// A line each, for people.
    pub left_out: Vec<String>,
}

/// What a panel says to others: as its picture is sent.
struct SentPanel<'a> {
    panel: &'a Panel,
    axes: Axes,
    field: Field,
    size: [u32; 2],
    /// Tangents right and down of pixels, row by row; none where nothing is bent.
    tangents: Vec<Option<[f64; 2]>>,
}

/// A zip while files are added.
struct Zipping {
    zip: ZipWriter<Cursor<Vec<u8>>>,
    names: BTreeSet<String>,
}

/// The file of panels, with a buffer for each surface that they are sent to.
pub(in super::super) fn written(panels: &[&Panel]) -> Result<WrittenMpcdi, String> {
    let fades = faded(panels);
    let mut surfaces = BTreeMap::<&str, Vec<(usize, &Panel)>>::new();
    for (index, panel) in panels.iter().enumerate() {
        let own = surfaces.entry(&panel.output.surface).or_default();
        own.push((index, panel));
    }
    let mut files = Zipping::new();
    let (mut buffers, mut sets) = (String::new(), String::new());
    for (surface, panels) in surfaces {
        let mut extent = [0; 2];
        for (_, panel) in &panels {
            let size = panel.sent_size();
            let end = [panel.output.x + size[0], panel.output.y + size[1]];
            extent = [0, 1].map(|k| extent[k].max(end[k]));
        }
        let ([w, h], id) = (extent, escaped(surface));
        let _ = writeln!(
            buffers,
            "    <buffer id=\"{id}\" xResolution=\"{w}\" yResolution=\"{h}\">"
        );
        for (index, panel) in panels {
            let sent = SentPanel::of(panel)?;
            buffers.push_str(&sent.region(extent));
            let fade = fades.of_panel[index].map(|fade| (&fades, fade));
            sets.push_str(&sent.files(fade, &mut files)?);
        }
        buffers.push_str("    </buffer>\n");
    }
    let xml = format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\
         <MPCDI profile=\"3d\" geometry=\"1\" color=\"0\" version=\"2.0\">\n  <display>\n\
         {buffers}  </display>\n  <files>\n{sets}  </files>\n</MPCDI>\n"
    );
    files.add("mpcdi.xml", || Ok(xml.into_bytes()))?;
    Ok(WrittenMpcdi {
        bytes: files.finish()?,
        left_out: left_out(panels),
    })
}

/// How panels fade into each other.
fn faded(panels: &[&Panel]) -> Fades {
    let anywhere = Placement::new(SourceProjection::Plane, Axes::FRONT, [1.0; 4]);
    let fading = panels.iter().map(|it| match it.blend > 0.0 {
        true => DrawnGrid::of(it, &anywhere),
        false => None,
    });
    let grids: Vec<Option<DrawnGrid>> = fading.collect();
    let both = panels.iter().zip(&grids);
    let both = both.map(|(panel, grid)| (*panel, grid.as_ref()));
    Fades::of(&both.collect::<Vec<(&Panel, _)>>())
}

/// What a file of this kind has no place for.
fn left_out(panels: &[&Panel]) -> Vec<String> {
    type IsLeftOut = fn(&Panel) -> bool;
    let kinds: [(&str, IsLeftOut); 4] = [
        ("the eye that looks at a panel", |it| !it.is_for_both),
        ("gain", |it| it.gain != [1.0; 3]),
        ("maps of red and blue (that of green counts)", |it| {
            it.distortion.parts_colours()
        }),
        ("the monitor of a surface", |it| {
            !it.output.monitor.is_empty()
        }),
    ];
    let one = |(what, is_lost): (&str, IsLeftOut)| {
        let all = panels.iter().filter(|it| is_lost(it));
        let ids: Vec<&str> = all.map(|it| it.id.as_str()).collect();
        let shown = ids.iter().take(4).copied().collect::<Vec<_>>().join(", ");
        match ids.len() {
            0 => None,
            1..=4 => Some(format!("{what}: {shown}")),
            all => Some(format!("{what}: {shown} and {} more", all - 4)),
        }
    };
    kinds.into_iter().filter_map(one).collect()
}

impl Zipping {
    fn new() -> Self {
        Self {
            zip: ZipWriter::new(Cursor::new(Vec::new())),
            names: BTreeSet::new(),
        }
    }

    /// Adds a file, unless one of its name is there.
    fn add(
        &mut self,
        name: &str,
        bytes: impl FnOnce() -> Result<Vec<u8>, String>,
    ) -> Result<(), String> {
        if !self.names.insert(name.to_owned()) {
            return Ok(());
        }
        let bytes = bytes()?;
        let options = SimpleFileOptions::default();
        let started = self.zip.start_file(name, options);
        started.map_err(|error| error.to_string())?;
        let written = self.zip.write_all(&bytes);
        written.map_err(|error| error.to_string())
    }

    fn finish(self) -> Result<Vec<u8>, String> {
        let whole = self.zip.finish();
        Ok(whole.map_err(|error| error.to_string())?.into_inner())
    }
}

fn escaped(text: &str) -> String {
    let mut out = String::new();
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            letter => out.push(letter),
        }
    }
    out
}

/// The turn of a scan-out that a frustum can express, and whether left is right besides.
fn turn_of(scanout: Scanout) -> (Scanout, bool) {
    match scanout {
        Scanout::FlipX => (Scanout::Normal, true),
        Scanout::FlipY => (Scanout::Rot180, true),
        turn => (turn, false),
    }
}

impl<'a> SentPanel<'a> {
    fn of(panel: &'a Panel) -> Result<Self, String> {
        let (turn, _) = turn_of(panel.scanout);
        let seen_from_sent = turn.seen_from_sent(panel.view.size);
        let axes = panel.view.axes;
        let turned = |way: DVec3| axes.right * way.x + axes.down * way.y;
        let mut sent = Self {
            panel,
            axes: Axes {
                forward: axes.forward,
                right: turned(seen_from_sent.x_axis),
                down: turned(seen_from_sent.y_axis),
            },
            field: panel.view.field,
            size: panel.sent_size(),
            tangents: Vec::new(),
        };
        let [w, h] = sent.size;
        if panel.distortion.is_none() {
            let corners = panel.corners().map(|ray| sent.tangent(ray));
            sent.field = sent.round(corners.into_iter().flatten())?;
            return Ok(sent);
        }
        let pixels = (0..h).flat_map(|row| (0..w).map(move |column| [column, row]));
        let seen = panel.scanout.seen_from_sent(panel.view.size);
        let tangents = pixels.map(|at| {
            let place = seen * DVec3::new(f64::from(at[0]) + 0.5, f64::from(at[1]) + 0.5, 1.0);
            let ray = panel.ray_at([place.x, place.y], GREEN)?;
            Some(sent.tangent(ray.ray).ok_or(at))
        });
        let tangents = tangents
            .map(Option::transpose)
            .collect::<Result<Vec<_>, _>>();
        sent.tangents = tangents.map_err(|[column, row]| {
            let what = "looks 90° or more from its axis, which no frustum does";
            format!("panel {}: pixel {column}, {row} {what}", panel.id)
        })?;
        sent.field = sent.round(sent.tangents.iter().copied().flatten())?;
        Ok(sent)
    }

    /// Right and down of the axis; `None` at its side or behind it.
    fn tangent(&self, ray: DVec3) -> Option<[f64; 2]> {
        let depth = ray.dot(self.axes.forward);
        let [x, y] = [self.axes.right, self.axes.down].map(|it| ray.dot(it) / depth);
        (depth > LEAST_DEPTH * ray.length()).then_some([x, y])
    }

    /// The field that holds all.
    fn round(&self, all: impl Iterator<Item = [f64; 2]>) -> Result<Field, String> {
        let mut reach = [f64::NEG_INFINITY; 4];
        for [x, y] in all {
            for (most, own) in reach.iter_mut().zip([-x, x, -y, y]) {
                *most = most.max(own);
            }
        }
        let field = Field::of(reach);
        match field.is_open() {
            true => Ok(field),
            false => Err(format!(
                "panel {}: it has no width or height",
                self.panel.id
            )),
        }
    }

    fn region(&self, extent: [u32; 2]) -> String {
        let [w, h] = self.size;
        let share = |k: usize, pixels: u32| neat(f64::from(pixels) / f64::from(extent[k]));
        let output = &self.panel.output;
        let (x, y) = (share(0, output.x), share(1, extent[1] - output.y - h));
        let (x_size, y_size) = (share(0, w), share(1, h));
        let [yaw, pitch, roll] = self.axes.yaw_pitch_roll().map(|it| neat(it.to_degrees()));
        let f = self.field;
        let [left, right, up, down] =
            [-f.left, f.right, f.up, -f.down].map(|it| neat(it.atan().to_degrees()));
        let id = escaped(&self.panel.id);
        format!(
            "      <region id=\"{id}\" xResolution=\"{w}\" yResolution=\"{h}\" x=\"{x}\" \
             y=\"{y}\" xSize=\"{x_size}\" ySize=\"{y_size}\">\n        <frustum>\n          \
             <yaw>{yaw}</yaw>\n          <pitch>{pitch}</pitch>\n          \
             <roll>{roll}</roll>\n          <rightAngle>{right}</rightAngle>\n          \
             <leftAngle>{left}</leftAngle>\n          <upAngle>{up}</upAngle>\n          \
             <downAngle>{down}</downAngle>\n        </frustum>\n      </region>\n"
        )
    }

    /// Adds its files, and lists them.
    fn files(&self, fade: Option<(&Fades, usize)>, files: &mut Zipping) -> Result<String, String> {
        let id = escaped(&self.panel.id);
        let map = self.map_name();
        files.add(&map, || Ok(self.map()))?;
        let mut set = format!(
            "    <fileset region=\"{id}\">\n      <geometryWarpFile>\n        \
             <path>{}</path>\n        <interpolation>linear</interpolation>\n      \
             </geometryWarpFile>\n",
            escaped(&map)
        );
        let [light, black] = self.shares(fade);
        let pictures = [
            (
                "alphaMap",
                "alpha",
                light,
                "\n        <gammaEmbedded>1</gammaEmbedded>",
            ),
            ("betaMap", "beta", black, ""),
        ];
        for (element, ending, shares, gamma) in pictures {
            let Some(shares) = shares else { continue };
            let name = format!("{}.{ending}.png", self.panel.id);
            let _ = write!(
                set,
                "      <{element}>\n        <path>{}</path>\n        \
                 <componentDepth>1</componentDepth>\n        \
                 <bitDepth>16</bitDepth>{gamma}\n      </{element}>\n",
                escaped(&name)
            );
            files.add(&name, || {
                let picture = alpha::written(&shares, self.size);
                picture.map_err(|error| error.to_string())
            })?;
        }
        set.push_str("    </fileset>\n");
        Ok(set)
    }

    /// The light that pixels keep, and the light that they have where the picture is black, both
    /// linear; nothing where that is all and none.
    fn shares(&self, fade: Option<(&Fades, usize)>) -> [Option<AlphaMap>; 2] {
        let panel = self.panel;
        if panel.alpha.is_none() && fade.is_none() && panel.black <= 0.0 {
            return [None, None];
        }
        let kept = panel.alpha_as_sent();
        let most = f64::from(u16::MAX);
        let seen = panel.scanout.seen_from_sent(panel.view.size);
        let (mut light, mut black) = (Vec::new(), Vec::new());
        let [w, h] = self.size;
        for at in (0..h).flat_map(|row| (0..w).map(move |column| [column, row])) {
            let place = seen * DVec3::new(f64::from(at[0]) + 0.5, f64::from(at[1]) + 0.5, 1.0);
            let ray = panel.ray_at([place.x, place.y], GREEN);
            let (share, lifts) = match (ray, fade) {
                (None, _) => (0.0, 0.0),
                (Some(_), None) => (1.0, 1.0),
                (Some(ray), Some((fades, fade))) => {
                    let it = fades.share(fade, ray.ray.normalize());
                    (it.light, it.lifts)
                }
            };
            let kept = kept.as_ref().map_or(1.0, |it| f64::from(it.at(at)) / most);
            light.push((share * kept * most).round() as u16);
            black.push(((panel.black * lifts).min(1.0) * most).round() as u16);
        }
        let is_dimmed = light.iter().any(|it| *it < u16::MAX);
        let is_lifted = black.iter().any(|it| *it > 0);
        [(light, is_dimmed), (black, is_lifted)]
            .map(|(shares, is_told)| is_told.then(|| AlphaMap::new(self.size, shares)))
    }

    fn is_mirrored(&self) -> bool {
        turn_of(self.panel.scanout).1
    }

    /// Even maps of one size are one file.
    fn map_name(&self) -> String {
        let [w, h] = self.size;
        match (self.tangents.is_empty(), self.is_mirrored()) {
            (true, false) => format!("even-{w}x{h}.pfm"),
            (true, true) => format!("mirrored-{w}x{h}.pfm"),
            (false, _) => format!("{}.warp.pfm", self.panel.id),
        }
    }

    /// Shares of the frustum to the right and up, lines from above.
    fn map(&self) -> Vec<u8> {
        let f = self.field;
        pfm::written(self.size, |row, column| {
            if self.tangents.is_empty() {
                let column = match self.is_mirrored() {
                    true => self.size[0] - 1 - column,
                    false => column,
                };
                let share = |at: u32, k: usize| (f64::from(at) + 0.5) / f64::from(self.size[k]);
                return [share(column, 0), 1.0 - share(row, 1)];
            }
            let at = row as usize * self.size[0] as usize + column as usize;
            self.tangents[at].map_or([f64::NAN; 2], |[x, y]| {
                [
                    (x + f.left) / (f.left + f.right),
                    (f.down - y) / (f.up + f.down),
                ]
            })
        })
    }
}
