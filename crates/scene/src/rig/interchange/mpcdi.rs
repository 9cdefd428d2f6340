//! Which displays does an MPCDI describe?
//!
//! VESA, Multiple Projection Common Data Interchange 2.0 (2015). Writers disagree in the case of
//! names, in where `fileset` stands, and in zipping at all: all of these are read.

use foveal_core::units::counted;
use foveal_core::view::panel::rig::{MOST_PANELS, Panel, Rig};

use super::super::checked;
use super::super::entries::{PoseEntry, RigEntries, RigFormat};
use super::super::error::{RigFault, WrongKey};
use super::super::pfm::{FloatMap, ReadBeside};
use super::archive::Archive;
use super::foreign_text::{closed, without_doctype, xml_text_of};
use super::mpcdi_files::{MpcdiFiles, MpcdiFilling, named};
use super::mpcdi_region::MpcdiRegion;
use super::space_map::SpaceMap;
use super::warp_map::WarpMap;
use super::xml::{Commas, XmlElement, parse};

/// Most bytes of the document.
const MOST_XML: u64 = 1 << 24;
/// Most documents of an archive that are tried besides the first.
const MOST_OTHERS: usize = 16;

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
    let commas = Commas::default();
    document.is_ok_and(|document| XmlElement::root(&document, &commas).is_called("mpcdi"))
}

fn read_document(
    bytes: &[u8],
    files: MpcdiFiles<'_>,
    eye: Option<[f64; 3]>,
) -> Result<MpcdiRig, RigFault> {
    let (text, notes) = xml_text_of(bytes)?;
    let text = without_doctype(&text);
    let mut filling = MpcdiFilling::of(files, eye);
    filling.notes.extend(notes);
    let text = closed(text, &mut filling.notes);
    let document = parse(&text)?;
    let commas = Commas::default();
    let rig = MpcdiDocument::of(XmlElement::root(&document, &commas))?.rig(&mut filling)?;
    let mut notes = filling.notes;
    if commas.times() > 0 {
        let times = counted(commas.times(), "number");
        notes.push(format!(
            "{times} with a decimal comma: read as with a point"
        ));
    }
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
        let mut regions = Vec::new();
        let mut spaces = Vec::new();
        for region in &self.regions {
            if let Some(space) = self.space_of(region, filling)? {
                regions.push(region);
                spaces.push(space);
            }
        }
        let panels = regions.iter().zip(&spaces).map(|(region, space)| {
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
        filling.check_left(regions.len())?;
        let nothing = |_: &str| Err("is not read".to_owned());
        let mut rig = checked::placed(&entries, &nothing)
            .map_err(|wrong| self.fault(&wrong, &regions, &spaces))?;
        self.note_places(&rig.panels, &mut filling.notes);
        self.note_filesets(&mut filling.notes);
        let mut is_whole = Vec::with_capacity(regions.len());
        for ((region, space), panel) in regions.iter().zip(spaces).zip(&mut rig.panels) {
            is_whole.push(self.bend(region, space, panel, filling)?);
        }
        let mut is_whole = is_whole.into_iter();
        rig.panels.retain(|_| is_whole.next().unwrap_or(true));
        filling.check_left(rig.panels.len())?;
        Ok(rig)
    }

    /// Bends and fades a panel as the files of its region say; `false` if it is to be left out.
    fn bend(
        &self,
        region: &MpcdiRegion<'a>,
        space: Option<SpaceMap>,
        panel: &mut Panel,
        filling: &mut MpcdiFilling<'_>,
    ) -> Result<bool, RigFault> {
        let Some(set) = self.files_of(region) else {
            return Ok(true);
        };
        let sized = (region.element, region.size);
        filling.note_unread(&region.id, set);
        let alpha = filling.shares(sized, set, "alphaMap")?;
        let warp = match (space, named(set, "geometryWarpFile")) {
            (Some(space), _) => space.map,
            (None, Some(warp)) => {
                let read = |map: &FloatMap<'_>| WarpMap::read(map, region.size);
                let Some(warp) = filling.floats(sized, (warp, true), &read)? else {
                    return Ok(false);
                };
                warp
            }
            (None, None) => WarpMap::Even,
        };
        let bent = warp.bend(panel, alpha);
        bent.map_err(|what| set.fault("geometryWarpFile", what))?;
        panel.black = filling.black(sized, set)?;
        Ok(true)
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

    /// The points that a region lights, where a map gives them; none of a region that is left out.
    fn space_of(
        &self,
        region: &MpcdiRegion<'a>,
        filling: &mut MpcdiFilling<'_>,
    ) -> Result<Option<Option<SpaceMap>>, RigFault> {
        let profile = self.root.said("profile").unwrap_or_default();
        if !["a3", "sl"]
            .iter()
            .any(|it| profile.eq_ignore_ascii_case(it))
        {
            return Ok(Some(None));
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
                _ => Ok(Some(None)),
            };
        };
        let eye = filling.eye_before(warp)?;
        let read = |map: &FloatMap<'_>| SpaceMap::read(map, region.size, eye);
        let found = filling.floats((region.element, region.size), (warp, false), &read)?;
        Ok(found.map(Some))
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
    fn fault(
        &self,
        wrong: &WrongKey,
        regions: &[&MpcdiRegion<'a>],
        spaces: &[Option<SpaceMap>],
    ) -> RigFault {
        let number = wrong.key.strip_prefix("panel[");
        let number = number.and_then(|rest| rest.split_once(']'));
        let region = number.and_then(|(number, _)| number.parse::<usize>().ok());
        let at = region.and_then(|number| number.checked_sub(1));
        let region = at.and_then(|at| regions.get(at));
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
