//! Which displays does an MPCDI describe?
//!
//! VESA, Multiple Projection Common Data Interchange 2.0 (2015). Writers disagree in the case of
//! names, in where `fileset` stands, and in zipping at all: all of these are read.

use foveal_core::view::panel::rig::{MOST_PANELS, Panel, Rig};

use super::super::checked;
use super::super::entries::{
    EyeEntry, OutputEntry, PanelEntry, PoseEntry, PoseOrder, RigEntries, RigFormat, ScanoutEntry,
    TangentsEntry,
};
use super::super::error::{RigFault, WrongKey};
use super::super::pfm::{FloatMap, ReadBeside};
use super::archive::Archive;
use super::foreign_text::{without_doctype, xml_text_of};
use super::mpcdi_files::{MpcdiFiles, MpcdiFilling, named};
use super::space_map::SpaceMap;
use super::warp_map::WarpMap;
use super::xml::{XmlElement, parse};

/// Most bytes of the document.
const MOST_XML: u64 = 1 << 24;
/// Most documents of an archive that are tried besides the first.
const MOST_OTHERS: usize = 16;
/// What of a share of a buffer rounding may add.
const ROUNDED: f64 = 1e-3;
/// Pixels by which a region may differ from its share of the buffer.
const NEAR_SHARE: f64 = 1.5;
/// Largest angle from the axis, in degrees.
const WIDEST: f64 = 89.9;

/// What an MPCDI describes.
#[derive(Debug, PartialEq)]
pub(in super::super) struct MpcdiRig {
    pub(in super::super) rig: Rig,
    /// What it says besides and is left out.
    pub(in super::super) notes: Vec<String>,
}

/// Reads an MPCDI, zipped or not; `beside` reads what a bare document names. Points in space are
/// seen from an eye so many metres to the right of, above and behind their origin.
pub(in super::super) fn read(
    bytes: &[u8],
    beside: ReadBeside<'_>,
    eye: Option<[f64; 3]>,
) -> Result<MpcdiRig, RigFault> {
    if !Archive::is_one(bytes) {
        return read_document(bytes, MpcdiFiles::Beside(beside), eye);
    }
    let whole = |what: String| RigFault::new("", what, "export it again");
    let mut archive = Archive::open(bytes).map_err(whole)?;
    let names = archive.xml_names();
    let Some(first) = names.first().cloned() else {
        return Err(whole("the archive holds no .xml".to_owned()));
    };
    let mut read = |name: &str| {
        let text = archive.read("", name, MOST_XML);
        text.map_err(|what| whole(format!("{name:?} {what}")))
    };
    let (mut name, mut text) = (first.clone(), read(&first)?.0);
    // Others may lie next to it that are no MPCDI.
    for other in names.iter().skip(1).take(MOST_OTHERS) {
        if is_mpcdi(&text) {
            break;
        }
        if let Ok((bytes, _)) = read(other)
            && is_mpcdi(&bytes)
        {
            (name, text) = (other.clone(), bytes);
        }
    }
    let folder = name
        .rsplit_once(['/', '\\'])
        .map_or("", |(folder, _)| folder);
    let files = MpcdiFiles::Zipped(archive, folder.to_owned());
    read_document(&text, files, eye)
}

/// Whether bytes are a document whose first element is that of an MPCDI.
fn is_mpcdi(bytes: &[u8]) -> bool {
    let Ok((text, _)) = xml_text_of(bytes) else {
        return false;
    };
    let text = without_doctype(&text);
    let document = parse(&text);
    document.is_ok_and(|document| XmlElement::root(&document).is_called("mpcdi"))
}

fn read_document(
    bytes: &[u8],
    files: MpcdiFiles<'_>,
    eye: Option<[f64; 3]>,
) -> Result<MpcdiRig, RigFault> {
    let (text, notes) = xml_text_of(bytes)?;
    let text = without_doctype(&text);
    let document = parse(&text)?;
    let mut filling = MpcdiFilling::of(files, eye);
    filling.notes.extend(notes);
    let rig = MpcdiDocument::of(XmlElement::root(&document))?.rig(&mut filling)?;
    let notes = filling.notes;
    Ok(MpcdiRig { rig, notes })
}

/// What the pictures of a document are for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum MpcdiProfile {
    /// One flat picture: a region shows the part where it lies.
    Flat,
    /// Directions from an eye; where there are maps of profile a3, points that it sees.
    Eye,
    /// Points that projectors light, wherever the eye is.
    Lamps,
}

/// A document whose outline is sound.
struct MpcdiDocument<'a> {
    root: XmlElement<'a>,
    profile: MpcdiProfile,
    regions: Vec<MpcdiRegion<'a>>,
}

/// A region, its place in its buffer's picture and its pixels.
struct MpcdiRegion<'a> {
    element: XmlElement<'a>,
    id: String,
    surface: String,
    /// Left, lower edge, width and height, as shares of the buffer.
    part: [f64; 4],
    size: [u32; 2],
    /// First column and row.
    origin: [u32; 2],
    /// Width over height of the buffer.
    aspect: f64,
    /// Columns and rows of the buffer, where it gives them.
    buffer: Option<[f64; 2]>,
    /// Whether its own id names no file.
    is_renamed: bool,
    /// What was mended, in words.
    notes: Vec<String>,
}

impl<'a> MpcdiDocument<'a> {
    fn of(root: XmlElement<'a>) -> Result<Self, RigFault> {
        if !root.is_called("mpcdi") {
            return Err(root.fault("", "is not an MPCDI: its first element has another name"));
        }
        let profile = root.said("profile").unwrap_or("3d");
        let profile = match profile.to_ascii_lowercase().as_str() {
            "2d" => MpcdiProfile::Flat,
            "3d" | "a3" => MpcdiProfile::Eye,
            "sl" => MpcdiProfile::Lamps,
            _ => return Err(root.fault("profile", "is not 2d, 3d, a3 or sl")),
        };
        let mut regions: Vec<MpcdiRegion<'_>> = Vec::new();
        let displays = root.children("display");
        for buffer in displays.flat_map(|display| display.children("buffer")) {
            for element in buffer.children("region") {
                if regions.len() == MOST_PANELS {
                    let what = format!("there are more than {MOST_PANELS} regions");
                    return Err(element.fault("", what));
                }
                regions.push(MpcdiRegion::of(buffer, element, regions.len() + 1)?);
            }
        }
        for region in &mut regions {
            if checked::bad_id(&region.id).is_some() {
                region.id = checked::good_id(&region.id);
                region.is_renamed = true;
            }
        }
        let mut known = std::collections::HashSet::new();
        for (number, region) in (1..).zip(&mut regions) {
            if !known.insert(region.id.to_lowercase()) {
                region.id = format!("{}-{number}", region.id);
                known.insert(region.id.to_lowercase());
            }
        }
        match regions.is_empty() {
            true => Err(root.fault("", "has no display with a buffer and a region in it")),
            false => Ok(Self {
                root,
                profile,
                regions,
            }),
        }
    }

    fn rig(&self, filling: &mut MpcdiFilling<'_>) -> Result<Rig, RigFault> {
        let first = &self.regions[0];
        let screen = (self.profile == MpcdiProfile::Flat).then_some([first.aspect, 1.0]);
        let spaces = self.regions.iter().map(|it| self.space_of(it, filling));
        let spaces: Vec<Option<SpaceMap>> = spaces.collect::<Result<_, _>>()?;
        let panels = self.regions.iter().zip(&spaces).map(|(region, space)| {
            let (pose, tangents) = match (screen, space) {
                (Some(screen), _) => (PoseEntry::default(), region.on_screen(screen)),
                (None, Some(space)) => space.around(),
                (None, None) => region.before_eye(&mut filling.notes)?,
            };
            Ok(region.entry(pose, tangents))
        });
        let entries = RigEntries {
            format: RigFormat::TiledView1,
            mirror: false,
            ipd_mm: 63.0,
            screen,
            panel: panels.collect::<Result<_, RigFault>>()?,
        };
        let nothing = |_: &str| Err("is not read".to_owned());
        let mut rig =
            checked::placed(&entries, &nothing).map_err(|wrong| self.fault(&wrong, &spaces))?;
        self.note_places(&rig.panels, &mut filling.notes);
        self.note_filesets(&mut filling.notes);
        let all = self.regions.iter().zip(spaces).zip(&mut rig.panels);
        for ((region, space), panel) in all {
            let Some(set) = self.files_of(region) else {
                continue;
            };
            filling.note_unread(&region.id, set);
            let alpha = filling.shares((region.element, region.size), set, "alphaMap")?;
            let warp = match (space, named(set, "geometryWarpFile")) {
                (Some(space), _) => space.map,
                (None, Some(warp)) => {
                    let read = |map: &FloatMap<'_>| WarpMap::read(map, region.size);
                    filling.floats((region.element, region.size), (warp, true), &read)?
                }
                (None, None) => WarpMap::Even,
            };
            let bent = warp.bend(panel, alpha);
            bent.map_err(|what| set.fault("geometryWarpFile", what))?;
            panel.black = filling.black((region.element, region.size), set)?;
        }
        Ok(rig)
    }

    /// What is odd about the places of regions in their buffers, and stays as it is.
    fn note_places(&self, panels: &[Panel], notes: &mut Vec<String>) {
        for region in &self.regions {
            let id = &region.id;
            let own = region.notes.iter();
            notes.extend(own.map(|note| format!("region {id:?}: {note}")));
            if region
                .element
                .attribute("id")
                .is_some_and(|own| !own.is_empty() && own != id)
            {
                let own = region.element.attribute("id").unwrap_or_default();
                notes.push(match region.is_renamed {
                    true => format!(
                        "region {:?} is called {id:?} here: its id cannot be part of a file's name",
                        own.chars().take(40).collect::<String>()
                    ),
                    false => format!("region {id:?} is called so here: its id is there twice"),
                });
            }
            if let Some([w, h]) = region.other_share() {
                let [own_w, own_h] = region.size;
                notes.push(format!(
                    "region {id:?} has {own_w} x {own_h} pixels, and its share of the buffer is \
                     {w} x {h}: it is placed by its share"
                ));
            }
        }
        for (one, other) in checked::overlaps(panels) {
            notes.push(format!(
                "region {:?} lies over {:?} in the output of {:?}",
                panels[one].id, panels[other].id, panels[one].output.surface
            ));
        }
    }

    /// The points that a region lights, where a map gives them.
    fn space_of(
        &self,
        region: &MpcdiRegion<'a>,
        filling: &mut MpcdiFilling<'_>,
    ) -> Result<Option<SpaceMap>, RigFault> {
        let profile = self.root.said("profile").unwrap_or_default();
        if !["a3", "sl"]
            .iter()
            .any(|it| profile.eq_ignore_ascii_case(it))
        {
            return Ok(None);
        }
        let set = self.files_of(region);
        let warp = set.and_then(|set| named(set, "geometryWarpFile"));
        let Some(warp) = warp else {
            return match self.profile {
                MpcdiProfile::Lamps => {
                    let what = "a projector of profile sl that says where it stands and not what \
                                it lights: export profile a3 or 3d";
                    Err(region.element.fault("geometryWarpFile", what))
                }
                _ => Ok(None),
            };
        };
        let eye = filling.eye_before(warp)?;
        let read = |map: &FloatMap<'_>| SpaceMap::read(map, region.size, eye);
        filling
            .floats((region.element, region.size), (warp, false), &read)
            .map(Some)
    }

    /// The files of a region: in it, else anywhere with its id.
    fn files_of(&self, region: &MpcdiRegion<'a>) -> Option<XmlElement<'a>> {
        let own = region.element.all_within("fileset").next();
        let id = region.element.attribute("id");
        let named = |it: &XmlElement<'_>| id.is_some() && it.attribute("region") == id;
        let own = own.or_else(|| self.root.all_within("fileset").find(named));
        own.or_else(|| {
            self.root
                .all_within("fileset")
                .find(|it| self.means(*it, id))
        })
    }

    /// Whether files are of the region of an id but for the case of letters and blanks in it, and
    /// no region is called as they say.
    fn means(&self, set: XmlElement<'a>, id: Option<&'a str>) -> bool {
        let Some((said, id)) = set.attribute("region").zip(id) else {
            return false;
        };
        let plain = |name: &'a str| {
            let letters = name.chars().filter(|it| !it.is_whitespace());
            letters.flat_map(char::to_lowercase)
        };
        let is_own = |it: &MpcdiRegion<'_>| it.element.attribute("id") == Some(said);
        plain(said).eq(plain(id)) && !self.regions.iter().any(is_own)
    }

    /// What is odd about the regions that files name.
    fn note_filesets(&self, notes: &mut Vec<String>) {
        let taken: Vec<_> = self.regions.iter().map(|it| self.files_of(it)).collect();
        for set in self.root.all_within("fileset") {
            let said = set.attribute("region").unwrap_or_default();
            let by = taken.iter().position(|it| it.is_some_and(|it| it.is(set)));
            match by.map(|at| self.regions[at].element.attribute("id").unwrap_or_default()) {
                Some(id) if said != id && !said.is_empty() => {
                    notes.push(format!("the files of region {said:?} are used for {id:?}"));
                }
                Some(_) => {}
                None => notes.push(format!(
                    "the files of region {said:?} are left out: no region has this name, or other \
                     files of it come before"
                )),
            }
        }
        let lacks = self
            .regions
            .iter()
            .zip(&taken)
            .filter(|(_, it)| it.is_none());
        if taken.iter().any(Option::is_some) {
            notes.extend(lacks.map(|(region, _)| {
                format!(
                    "region {:?} has no files: it is neither bent nor faded",
                    region.id
                )
            }));
        }
    }

    /// What the check of a rig calls wrong, by the region that says it, or its map of points.
    fn fault(&self, wrong: &WrongKey, spaces: &[Option<SpaceMap>]) -> RigFault {
        let number = wrong.key.strip_prefix("panel[");
        let number = number.and_then(|rest| rest.split_once(']'));
        let region = number.and_then(|(number, _)| number.parse::<usize>().ok());
        let at = region.and_then(|number| number.checked_sub(1));
        let region = at.and_then(|at| self.regions.get(at));
        let is_by_map = at
            .and_then(|at| spaces.get(at))
            .is_some_and(Option::is_some);
        let key = number.map_or("", |(_, rest)| rest.trim_start_matches('.'));
        let name = match key {
            "tangents" if is_by_map => "geometryWarpFile, as the eye sees it",
            "tangents" => "frustum",
            "pixels" => "xResolution",
            key => key,
        };
        match region {
            Some(region) => region.element.fault(name, &*wrong.what),
            None => self.root.fault("", &*wrong.what),
        }
    }
}

fn count_of_pixels(element: XmlElement<'_>, name: &str, pixels: f64) -> Result<u32, RigFault> {
    let whole = pixels.round();
    if (pixels - whole).abs() > ROUNDED || !(1.0..=1e6).contains(&whole) {
        return Err(element.fault(name, format!("{pixels} is not a count of pixels")));
    }
    Ok(whole as u32)
}

impl<'a> MpcdiRegion<'a> {
    fn of(
        buffer: XmlElement<'a>,
        element: XmlElement<'a>,
        number: usize,
    ) -> Result<Self, RigFault> {
        let id = element.attribute("id").filter(|id| !id.is_empty());
        let id = id.map_or_else(|| format!("region{number}"), str::to_owned);
        let number = |it: XmlElement<'_>, name: &str| it.number(name);
        let mut notes = Vec::new();
        let mut count = |it: XmlElement<'_>, name: &str, of: &str| {
            let found = number(it, name)?;
            if found == Some(0.0) {
                notes.push(format!("0 as the {name} of {of} is treated as missing"));
            }
            Ok(found.filter(|it| *it != 0.0))
        };
        let whole = [
            count(buffer, "xResolution", "its buffer")?,
            count(buffer, "yResolution", "its buffer")?,
        ];
        let own = [
            count(element, "xResolution", "its own")?,
            count(element, "yResolution", "its own")?,
        ];
        let (part, counts_pixels) = Self::part_of(element, whole)?;
        if counts_pixels {
            notes.push("its place counts pixels: it is divided by the buffer's size".to_owned());
        }
        let mut size = [0; 2];
        for (k, name) in ["xResolution", "yResolution"].into_iter().enumerate() {
            let pixels = own[k].or_else(|| whole[k].map(|whole| (whole * part[k + 2]).round()));
            let pixels = pixels.ok_or_else(|| {
                element.fault(
                    name,
                    "neither it nor its buffer says how many pixels there are",
                )
            })?;
            size[k] = count_of_pixels(element, name, pixels)?;
        }
        // A buffer without pixels is no picture: each region is a display by itself.
        let picture = whole[0].zip(whole[1]);
        let name = buffer
            .attribute("id")
            .filter(|it| checked::bad_id(it).is_none());
        let is_alone = buffer.children("region").count() == 1;
        let own = [f64::from(size[0]) / part[2], f64::from(size[1]) / part[3]];
        let [w, h] = picture.map_or(own, |(w, h)| [w, h]);
        let origin = match picture {
            Some((w, h)) => [part[0] * w, (1.0 - part[1] - part[3]).max(0.0) * h],
            None => [0.0; 2],
        };
        Ok(Self {
            surface: match picture {
                Some(_) if name.is_some() || !is_alone => name.unwrap_or("main").to_owned(),
                _ => id.clone(),
            },
            element,
            id,
            part,
            size,
            origin: origin.map(|at| at.round().clamp(0.0, 1e6) as u32),
            aspect: (w / h).clamp(1e-3, 1e3),
            buffer: picture.map(|(w, h)| [w, h]),
            is_renamed: false,
            notes,
        })
    }

    /// Left, lower edge, width and height of a region as shares of a buffer with these columns and
    /// rows, and whether the file counts pixels.
    fn part_of(
        element: XmlElement<'_>,
        whole: [Option<f64>; 2],
    ) -> Result<([f64; 4], bool), RigFault> {
        const NAMES: [&str; 4] = ["x", "y", "xSize", "ySize"];
        let mut said = [None; 4];
        for (said, name) in said.iter_mut().zip(NAMES) {
            *said = element.number(name)?;
        }
        let of = [whole[0], whole[1], whole[0], whole[1]];
        let are_known = whole.iter().all(|it| it.is_some());
        let is_more = |it: &Option<f64>| it.is_some_and(|it| it > 1.0 + ROUNDED);
        // Some files give the size in pixels, and the place as a share.
        let counts_pixels = are_known && said[2..].iter().any(is_more);
        let counts_places = counts_pixels && said[..2].iter().any(is_more);
        let counted = [counts_places, counts_places, counts_pixels, counts_pixels];
        let mut part = [0.0, 0.0, 1.0, 1.0];
        for (k, name) in NAMES.into_iter().enumerate() {
            let Some(said) = said[k] else { continue };
            part[k] = match of[k].filter(|_| counted[k]) {
                Some(of) => said / of,
                None => said,
            };
            if !(-ROUNDED..=1.0 + ROUNDED).contains(&part[k]) {
                let what = format!("{said} is not a share from 0 to 1");
                return Err(element.fault(name, what));
            }
            part[k] = part[k].clamp(0.0, 1.0);
        }
        Ok((part, counts_pixels))
    }

    /// Columns and rows of its share of the buffer, where it has others.
    fn other_share(&self) -> Option<[f64; 2]> {
        let buffer = self.buffer?;
        let share = [0, 1].map(|k| buffer[k] * self.part[k + 2]);
        let is_other = |k: usize| (share[k] - f64::from(self.size[k])).abs() > NEAR_SHARE;
        (is_other(0) || is_other(1)).then(|| share.map(f64::round))
    }

    fn entry(&self, pose: PoseEntry, tangents: TangentsEntry) -> PanelEntry {
        PanelEntry {
            id: self.id.clone(),
            eye: EyeEntry::Both,
            pixels: self.size,
            pose,
            size: None,
            tangents: Some(tangents),
            scanout: ScanoutEntry::Normal,
            output: Some(OutputEntry {
                surface: self.surface.clone(),
                monitor: String::new(),
                x: self.origin[0],
                y: self.origin[1],
            }),
            distortion: None,
            blend: 0.0,
            alpha: None,
            gain: [1.0; 3],
            black: 0.0,
        }
    }

    fn on_screen(&self, [width, height]: [f64; 2]) -> TangentsEntry {
        let [x, y, w, h] = self.part;
        TangentsEntry {
            left: (0.5 - x) * width,
            right: (x + w - 0.5) * width,
            up: (y + h - 0.5) * height,
            down: (0.5 - y) * height,
        }
    }

    fn before_eye(&self, notes: &mut Vec<String>) -> Result<(PoseEntry, TangentsEntry), RigFault> {
        let Some(frustum) = self.element.child("frustum") else {
            let what = "missing: where the region looks is unknown";
            return Err(self.element.fault("frustum", what));
        };
        let angle = |name: &str| {
            let said = frustum.number(name)?;
            said.ok_or_else(|| self.element.fault(name, "its frustum does not give it"))
        };
        let tangent = |name: &str| {
            let degrees = angle(name)?;
            match degrees.abs() <= WIDEST {
                true => Ok(degrees.to_radians().tan()),
                false => {
                    let what = format!("{degrees} is not an angle within {WIDEST}°");
                    Err(self.element.fault(name, what))
                }
            }
        };
        let [mut left, right, up, mut down] = [
            tangent("leftAngle")?,
            tangent("rightAngle")?,
            tangent("upAngle")?,
            tangent("downAngle")?,
        ];
        for (name, low, high) in [
            ("leftAngle", &mut left, right),
            ("downAngle", &mut down, up),
        ] {
            // Some write how far it reaches to each side, without signs.
            if *low > 0.0 && high > 0.0 && *low >= high {
                *low = -*low;
                notes.push(format!(
                    "region {:?}: its {name} is positive, which lies on the other side of its \
                     axis: it is treated as negative",
                    self.id
                ));
            }
        }
        for (name, low, high) in [("leftAngle", left, right), ("downAngle", down, up)] {
            if low >= high {
                let what = "it is not below the opposite one: left and down are negative";
                return Err(self.element.fault(name, what));
            }
        }
        let pose = PoseEntry {
            order: Some(PoseOrder::YawPitchRoll),
            roll: Some(angle("roll")?),
            pitch: Some(angle("pitch")?),
            yaw: Some(angle("yaw")?),
            quaternion: None,
        };
        let tangents = TangentsEntry {
            left: -left,
            right,
            up,
            down: -down,
        };
        Ok((pose, tangents))
    }
}
