//! Is what a rig file says a rig, and which?

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::panel::alpha::AlphaMap;
use foveal_core::view::panel::rig::{
    MOST_PANELS, Panel, PanelOutput, Rig, Scanout, axes_from_seed_angles,
};
use foveal_core::view::surface::Eye;
use glam::{DQuat, DVec3, DVec4};

use super::alpha;
use super::distortion::distortion;
use super::entries::{
    EyeEntry, OutputEntry, PanelEntry, PoseEntry, PoseOrder, RigEntries, RigFormat, ScanoutEntry,
    usual_surface,
};
use super::error::WrongKey;
use super::pfm::ReadBeside;

/// Most columns or rows of a panel.
const MOST_PIXELS: u32 = 32_768;
/// Most columns or rows before a panel in its surface.
const MOST_OFFSET: u32 = 1_000_000;
/// Largest angle, in degrees.
const MOST_DEGREES: f64 = 3600.0;
/// What stands after the id of a twin.
const TWIN: &str = ".right";

/// The rig that entries describe, none of whose panels lies over another in its output.
pub(super) fn rig(said: &RigEntries, read: ReadBeside<'_>) -> Result<Rig, WrongKey> {
    let rig = placed(said, read)?;
    match overlaps(&rig.panels).first() {
        None => Ok(rig),
        Some((number, other)) => {
            let what = format!("it lies over that of {:?}", rig.panels[*other].id);
            Err(WrongKey::new(format!("panel[{}].output", number + 1), what))
        }
    }
}

/// The same, wherever panels lie in their outputs.
pub(super) fn placed(said: &RigEntries, read: ReadBeside<'_>) -> Result<Rig, WrongKey> {
    let RigFormat::TiledView1 = said.format;
    if said.panel.is_empty() {
        return Err(WrongKey::new(
            "panel",
            "there is none: nothing would be shown",
        ));
    }
    if said.panel.len() > MOST_PANELS {
        let what = format!("{} are more than {MOST_PANELS}", said.panel.len());
        return Err(WrongKey::new("panel", what));
    }
    if !(0.0..=1000.0).contains(&said.ipd_mm) {
        let what = format!("{} is no distance of 0 to 1000 mm", said.ipd_mm);
        return Err(WrongKey::new("ipd_mm", what));
    }
    if let Some(size) = said
        .screen
        .filter(|size| !Field::symmetric(*size).is_open())
    {
        let what = format!("{size:?} are no width and height of a screen");
        return Err(WrongKey::new("screen", what));
    }
    let ipd = said.ipd_mm / 1000.0;
    let mut panels = Vec::new();
    for (number, entry) in (1..).zip(&said.panel) {
        panels.push(panel(entry, &format!("panel[{number}]"), ipd, read)?);
    }
    put_out(&said.panel, &mut panels);
    if said.mirror {
        add_twins(&said.panel, &mut panels)?;
    }
    check_ids(&panels)?;
    check_monitors(&panels)?;
    Ok(Rig {
        panels,
        ipd,
        screen: said.screen,
    })
}

fn panel(entry: &PanelEntry, key: &str, ipd: f64, read: ReadBeside<'_>) -> Result<Panel, WrongKey> {
    let wrong = |name: &str, what: String| Err(WrongKey::new(format!("{key}.{name}"), what));
    if let Some(what) = bad_id(&entry.id) {
        return wrong("id", what);
    }
    if entry
        .pixels
        .iter()
        .any(|it| !(1..=MOST_PIXELS).contains(it))
    {
        let [w, h] = entry.pixels;
        return wrong(
            "pixels",
            format!("{w} x {h} are not 1 to {MOST_PIXELS} on a side"),
        );
    }
    let field = field(entry, key)?;
    let axes = axes(&entry.pose, key)?;
    if !(0.0..=90.0).contains(&entry.blend) {
        return wrong(
            "blend",
            format!("{} is not an angle of 0 to 90°", entry.blend),
        );
    }
    if entry.gain.iter().any(|it| !(0.0..=100.0).contains(it)) {
        return wrong("gain", format!("{:?} are not all 0 to 100", entry.gain));
    }
    if !(0.0..=1.0).contains(&entry.black) {
        return wrong("black", format!("{} is no light of 0 to 1", entry.black));
    }
    let (eye, x) = match entry.eye {
        EyeEntry::Left => (Eye::Left, -ipd / 2.0),
        EyeEntry::Right => (Eye::Right, ipd / 2.0),
        EyeEntry::Both => (Eye::Left, 0.0),
    };
    let view = EyeView {
        position: DVec3::new(x, 0.0, 0.0),
        axes,
        field,
        size: entry.pixels,
        eye,
    };
    Ok(Panel {
        is_for_both: entry.eye == EyeEntry::Both,
        scanout: match entry.scanout {
            ScanoutEntry::Normal => Scanout::Normal,
            ScanoutEntry::Rot90 => Scanout::Rot90,
            ScanoutEntry::Rot180 => Scanout::Rot180,
            ScanoutEntry::Rot270 => Scanout::Rot270,
            ScanoutEntry::FlipX => Scanout::FlipX,
            ScanoutEntry::FlipY => Scanout::FlipY,
        },
        output: output(entry.output.as_ref(), key)?,
        distortion: distortion(entry.distortion.as_ref(), &view, key, read)?,
        blend: entry.blend.to_radians(),
        alpha: alpha_of(entry, key, read)?,
        gain: entry.gain,
        black: entry.black,
        ..Panel::flat(&entry.id, view)
    })
}

fn alpha_of(
    entry: &PanelEntry,
    key: &str,
    read: ReadBeside<'_>,
) -> Result<Option<Arc<AlphaMap>>, WrongKey> {
    let Some(file) = &entry.alpha else {
        return Ok(None);
    };
    let found = read(file).and_then(|bytes| alpha::read(&bytes, entry.pixels, 1.0));
    found.map(|it| Some(Arc::new(it))).map_err(|what| {
        let file: String = file.chars().take(80).collect();
        WrongKey::new(format!("{key}.alpha"), format!("{file:?} {what}"))
    })
}

/// Whether a character cannot be part of a file's name on every system.
fn names_no_file(it: char) -> bool {
    it.is_control() || "/\\:*?\"<>|".contains(it)
}

/// An id that can name a panel and its files, as close to the one given as it gets.
pub(super) fn good_id(id: &str) -> String {
    const MOST: usize = 80;
    let safe = id.replace(names_no_file, "-");
    let safe = safe.trim_matches(['.', ' ']);
    let mut end = safe.len().min(MOST);
    while !safe.is_char_boundary(end) {
        end -= 1;
    }
    match safe[..end].trim_end_matches(['.', ' ']) {
        "" => "region".to_owned(),
        "atlas" => "atlas-region".to_owned(),
        safe => safe.to_owned(),
    }
}

/// Why an id cannot name a panel and its files.
pub(super) fn bad_id(id: &str) -> Option<String> {
    let short: String = id.chars().take(40).collect();
    if id.is_empty() || id.len() > 100 {
        return Some(format!("{short:?} is not 1 to 100 bytes long"));
    }
    if id.contains(names_no_file) || id.starts_with('.') || id.ends_with(['.', ' ']) {
        return Some(format!(
            "{short:?} names no file: pictures are called as panels are"
        ));
    }
    (id == "atlas").then(|| format!("{short:?} is the name of the picture of all panels"))
}

fn field(entry: &PanelEntry, key: &str) -> Result<Field, WrongKey> {
    let wrong = |name: &str, what: String| Err(WrongKey::new(format!("{key}{name}"), what));
    let (name, field) = match (entry.size, entry.tangents) {
        (Some([w, h]), None) => {
            if !(w > 0.0 && h > 0.0) {
                return wrong(".size", format!("{w} x {h} is not a size above 0"));
            }
            (".size", Field::symmetric([w / 2.0, h / 2.0]))
        }
        (None, Some(it)) => (".tangents", Field::of([it.left, it.right, it.up, it.down])),
        _ => {
            let what = "it needs either size or tangents".to_owned();
            return wrong("", what);
        }
    };
    match field.is_open() {
        true => Ok(field),
        false => wrong(name, "its width or height is not 1e-6 to 2e6".to_owned()),
    }
}

fn axes(pose: &PoseEntry, key: &str) -> Result<Axes, WrongKey> {
    let wrong = |name: &str, what: String| Err(WrongKey::new(format!("{key}.pose{name}"), what));
    let angles = [
        ("roll", pose.roll),
        ("pitch", pose.pitch),
        ("yaw", pose.yaw),
    ];
    for (name, angle) in angles {
        if let Some(angle) = angle.filter(|it| it.is_nan() || it.abs() > MOST_DEGREES) {
            return wrong(
                &format!(".{name}"),
                format!("{angle} is not an angle in degrees"),
            );
        }
    }
    let has_angle = angles.iter().any(|it| it.1.is_some());
    let [roll, pitch, yaw] = angles.map(|it| it.1.unwrap_or(0.0).to_radians());
    match (pose.order, pose.quaternion) {
        (None, Some(quaternion)) if !has_angle => {
            let four = DVec4::from_array(quaternion);
            let length = four.length();
            if !(length.is_finite() && length > 1e-9) {
                return wrong(".quaternion", format!("{quaternion:?} is no turn"));
            }
            let turn = DQuat::from_vec4(four / length);
            Ok(Axes {
                forward: turn * DVec3::NEG_Z,
                right: turn * DVec3::X,
                down: turn * DVec3::NEG_Y,
            })
        }
        (_, Some(_)) => wrong(
            "",
            "it has a quaternion and angles; give one of them".to_owned(),
        ),
        (Some(PoseOrder::Seed002), None) => Ok(axes_from_seed_angles(roll, pitch, yaw)),
        (Some(PoseOrder::YawPitchRoll), None) => Ok(Axes::from_yaw_pitch_roll(
            Radians(yaw),
            Radians(pitch),
            Radians(roll),
        )),
        (None, None) if has_angle => {
            let what = "angles without an order: give order = \"seed002\" or \"yaw-pitch-roll\"";
            wrong("", what.to_owned())
        }
        (None, None) => Ok(Axes::FRONT),
    }
}

fn output(entry: Option<&OutputEntry>, key: &str) -> Result<PanelOutput, WrongKey> {
    let Some(entry) = entry else {
        return Ok(PanelOutput::default());
    };
    if let Some(what) = bad_id(&entry.surface) {
        return Err(WrongKey::new(format!("{key}.output.surface"), what));
    }
    if entry.x.max(entry.y) > MOST_OFFSET {
        let what = format!("{} is more than {MOST_OFFSET}", entry.x.max(entry.y));
        return Err(WrongKey::new(format!("{key}.output"), what));
    }
    Ok(PanelOutput {
        surface: entry.surface.clone(),
        monitor: entry.monitor.clone(),
        x: entry.x,
        y: entry.y,
    })
}

/// Columns and rows of each surface.
fn extents(panels: &[Panel]) -> HashMap<String, [u32; 2]> {
    let mut extents: HashMap<String, [u32; 2]> = HashMap::new();
    for panel in panels.iter().filter(|it| !it.output.surface.is_empty()) {
        let own = extents.entry(panel.output.surface.clone()).or_default();
        let [w, h] = panel.sent_size();
        *own = [
            own[0].max(panel.output.x + w),
            own[1].max(panel.output.y + h),
        ];
    }
    extents
}

/// Puts panels that do not say where into the usual surface: in rows of about as many as there are
/// rows, below those that say it.
fn put_out(entries: &[PanelEntry], panels: &mut [Panel]) {
    let below = extents(panels).get(&usual_surface()).map_or(0, |it| it[1]);
    let placed = panels.iter_mut().zip(entries);
    let silent = placed.filter(|(_, entry)| entry.output.is_none());
    let mut silent: Vec<&mut Panel> = silent.map(|(panel, _)| panel).collect();
    let most = |k: usize| silent.iter().map(|it| it.sent_size()[k]).max();
    let [w, h] = [0, 1].map(|k| most(k).unwrap_or(0));
    let mut columns = 1;
    while columns * columns < silent.len() {
        columns += 1;
    }
    for (k, panel) in silent.iter_mut().enumerate() {
        panel.output = PanelOutput {
            surface: usual_surface(),
            monitor: String::new(),
            x: (k % columns) as u32 * w,
            y: below + (k / columns) as u32 * h,
        };
    }
}

/// Adds the twins of the left eye's panels, in their order; their pictures lie to the right of all
/// others of their surface.
fn add_twins(entries: &[PanelEntry], panels: &mut Vec<Panel>) -> Result<(), WrongKey> {
    let extents = extents(panels);
    let lefts = panels.iter().zip(entries);
    let lefts = lefts.filter(|(_, entry)| entry.eye == EyeEntry::Left);
    let twins: Vec<Panel> = lefts
        .map(|(panel, _)| {
            let mut twin = panel.mirrored();
            twin.id.push_str(TWIN);
            twin.output.x += extents.get(&twin.output.surface).map_or(0, |it| it[0]);
            twin
        })
        .collect();
    if twins.is_empty() {
        return Err(WrongKey::new("mirror", "no panel has eye = \"left\""));
    }
    panels.extend(twins);
    match panels.len() > MOST_PANELS {
        true => {
            let what = format!("{} with twins are more than {MOST_PANELS}", panels.len());
            Err(WrongKey::new("panel", what))
        }
        false => Ok(()),
    }
}

fn check_ids(panels: &[Panel]) -> Result<(), WrongKey> {
    let mut ids = HashSet::new();
    for (number, panel) in (1..).zip(panels) {
        // Some file systems know no case.
        if !ids.insert(panel.id.to_lowercase()) {
            let what = format!("{:?} is there twice", panel.id);
            return Err(WrongKey::new(format!("panel[{number}].id"), what));
        }
    }
    Ok(())
}

fn check_monitors(panels: &[Panel]) -> Result<(), WrongKey> {
    for (number, panel) in (1..).zip(panels) {
        let (surface, monitor) = (&panel.output.surface, &panel.output.monitor);
        let is_other = |it: &Panel| it.output.surface == *surface && it.output.monitor != *monitor;
        if panels[..number - 1].iter().any(is_other) {
            let what = format!("surface {surface:?} is on two monitors");
            return Err(WrongKey::new(format!("panel[{number}].output"), what));
        }
    }
    Ok(())
}

/// The panels, by their places in the list, that lie over an earlier one in their surface, with
/// that one.
pub(super) fn overlaps(panels: &[Panel]) -> Vec<(usize, usize)> {
    let lies_over = |panel: &Panel, other: &Panel| {
        let (a, b) = (&panel.output, &other.output);
        let ([aw, ah], [bw, bh]) = (panel.sent_size(), other.sent_size());
        let is_over = |a: u32, a_side: u32, b: u32, b_side: u32| a < b + b_side && b < a + a_side;
        a.surface == b.surface && is_over(a.x, aw, b.x, bw) && is_over(a.y, ah, b.y, bh)
    };
    let first_below = |(number, panel): (usize, &Panel)| {
        let other = panels[..number]
            .iter()
            .position(|other| lies_over(panel, other));
        other.map(|other| (number, other))
    };
    panels.iter().enumerate().filter_map(first_below).collect()
}
