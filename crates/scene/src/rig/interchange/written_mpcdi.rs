//! How is a rig told to other programs, as an MPCDI?
//!
//! Profile 3d, version 2.0, one buffer, maps that are linear between pixels.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::Field;
use foveal_core::view::panel::distortion::GREEN;
use foveal_core::view::panel::rig::{Panel, Scanout};
use glam::DVec3;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::super::alpha;
use super::super::pfm;

/// Least depth of a ray before the panel's axis: 89.9°.
const LEAST_DEPTH: f64 = 0.001_745;

/// What a panel says to others: as its picture is sent.
struct SentPanel<'a> {
    panel: &'a Panel,
    axes: Axes,
    field: Field,
    size: [u32; 2],
    /// Tangents right and down of pixels, row by row; none where nothing is bent.
    tangents: Vec<Option<[f64; 2]>>,
}

/// The file that tells of panels that are sent to one surface.
pub(in super::super) fn written(panels: &[&Panel]) -> Result<Vec<u8>, String> {
    let mut extent = [0; 2];
    for panel in panels {
        let size = panel.sent_size();
        let end = [panel.output.x + size[0], panel.output.y + size[1]];
        extent = [0, 1].map(|k| extent[k].max(end[k]));
    }
    let surface = panels.first().map_or("", |it| &it.output.surface);
    let [w, h] = extent;
    let id = escaped(surface);
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\
         <MPCDI profile=\"3d\" geometry=\"1\" color=\"0\" version=\"2.0\">\n  <display>\n    \
         <buffer id=\"{id}\" xResolution=\"{w}\" yResolution=\"{h}\">\n"
    );
    let mut sets = String::new();
    let mut files = BTreeMap::new();
    for panel in panels {
        let sent = SentPanel::of(panel)?;
        xml.push_str(&sent.region(extent));
        let map = sent.map_name();
        let mut set = format!(
            "      <geometryWarpFile>\n        <path>{}</path>\n        \
             <interpolation>linear</interpolation>\n      </geometryWarpFile>\n",
            escaped(&map)
        );
        files.entry(map).or_insert_with(|| sent.map());
        if let Some(share) = panel.alpha_as_sent() {
            let name = format!("{}.alpha.png", panel.id);
            let _ = write!(
                set,
                "      <alphaMap>\n        <path>{}</path>\n        \
                 <componentDepth>1</componentDepth>\n        <bitDepth>16</bitDepth>\n        \
                 <gammaEmbedded>1</gammaEmbedded>\n      </alphaMap>\n",
                escaped(&name)
            );
            let picture = alpha::written(&share, sent.size);
            files.insert(name, picture.map_err(|error| error.to_string())?);
        }
        let id = escaped(&panel.id);
        let _ = write!(sets, "    <fileset region=\"{id}\">\n{set}    </fileset>\n");
    }
    let _ = write!(
        xml,
        "    </buffer>\n  </display>\n  <files>\n{sets}  </files>\n</MPCDI>\n"
    );
    zipped(&xml, &files).map_err(|error| error.to_string())
}

fn zipped(xml: &str, files: &BTreeMap<String, Vec<u8>>) -> zip::result::ZipResult<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default();
    zip.start_file("mpcdi.xml", options)?;
    zip.write_all(xml.as_bytes())?;
    for (name, bytes) in files {
        zip.start_file(name, options)?;
        zip.write_all(bytes)?;
    }
    Ok(zip.finish()?.into_inner())
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

/// The turn of a scan-out that a frustum can tell, and whether left is right besides.
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

    /// Right and down of the axis; `None` beside or behind it.
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
        let share = |k: usize, pixels: u32| f64::from(pixels) / f64::from(extent[k]);
        let output = &self.panel.output;
        let (x, y) = (share(0, output.x), share(1, extent[1] - output.y - h));
        let (x_size, y_size) = (share(0, w), share(1, h));
        let [yaw, pitch, roll] = self.axes.yaw_pitch_roll().map(|it| it.to_degrees());
        let f = self.field;
        let [left, right, up, down] =
            [-f.left, f.right, f.up, -f.down].map(|it| it.atan().to_degrees());
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

    fn is_mirrored(&self) -> bool {
        turn_of(self.panel.scanout).1
    }

    /// Even maps of one size are one file.
    fn map_name(&self) -> String {
        let [w, h] = self.size;
        match (self.tangents.is_empty(), self.is_mirrored()) {
            (true, false) => format!("even-{w}x{h}.pfm"),
            (true, true) => format!("mirrored-{w}x{h}.pfm"),
            (false, _) => format!("{}.pfm", self.panel.id),
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
