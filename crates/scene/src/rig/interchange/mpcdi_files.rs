//! What do the files that an MPCDI names say, and which of that is left out?

use foveal_core::view::panel::alpha::AlphaMap;
use glam::DVec3;

use super::super::alpha;
use super::super::error::RigFault;
use super::super::pfm::{FloatMap, ReadBeside};
use super::archive::Archive;
use super::xml::XmlElement;

/// Most pixels of all maps of a file: 32 displays of 1920 x 1080. Pictures of shares, which take a
/// quarter of the memory, count a quarter.
const MOST_MAPPED: u64 = 1 << 26;
const PICTURES_A_MAP: u64 = 4;
/// A map of another size than its region has at most so many times its pixels, or so many.
const MOST_FINER: u64 = 4;
const SMALL: u64 = 1 << 16;
/// Bytes of a float map's header.
const HEADER: u64 = 256;
/// Bytes of a picture besides two for each of its pixels in four channels.
const PNG_BESIDE: u64 = 1 << 20;
/// Metres of the units of points.
const UNITS: [(&str, f64); 7] = [
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("dm", 0.1),
    ("m", 1.0),
    ("in", 0.0254),
    ("ft", 0.3048),
    ("yd", 0.9144),
];

/// What of the files of a region is read, and how many other kinds are named.
const READ: [&str; 3] = ["geometryWarpFile", "alphaMap", "betaMap"];
const MOST_UNREAD: usize = 8;

/// What is said of names that lead out of the folder or archive.
const LEADS_OUT: [&str; 2] = ["leads out", "names no file in"];

/// A region's element, and its columns and rows.
pub(super) type SizedRegion<'a> = (XmlElement<'a>, [u32; 2]);

/// Where the files of an MPCDI lie: in it, or next to a bare document.
pub(super) enum MpcdiFiles<'a> {
    /// With the folder of the document, from which names count.
    Zipped(Archive<'a>, String),
    Beside(ReadBeside<'a>),
}

impl MpcdiFiles<'_> {
    /// The bytes of a file, and whether it lies in another place than its name says.
    fn read(&mut self, name: &str, most: u64) -> Result<(Vec<u8>, bool), String> {
        let read = match self {
            Self::Zipped(archive, folder) => return archive.read(folder, name, most),
            Self::Beside(read) => read,
        };
        let parts = name.split(['/', '\\']);
        let parts: Vec<&str> = parts.filter(|part| !matches!(*part, "" | ".")).collect();
        let own = parts.join("/");
        let last = parts.last().copied().unwrap_or_default();
        let found = match read(&own) {
            Err(_) if last != own => read(last).map(|it| (it, true)),
            found => found.map(|it| (it, false)),
        };
        // What is said of the name as it stands.
        let (bytes, is_elsewhere) = match found {
            Ok(found) => found,
            Err(_) => (read(name)?, false),
        };
        match bytes.len() as u64 > most {
            true => Err(format!("is longer than the {most} bytes it can need")),
            false => Ok((bytes, is_elsewhere)),
        }
    }
}

/// What a document is read with, and what is left out of it.
pub(super) struct MpcdiFilling<'a> {
    files: MpcdiFiles<'a>,
    /// Pixels of maps that may still come.
    left: u64,
    /// Metres.
    eye: Option<[f64; 3]>,
    /// What is left out, for people.
    pub(super) notes: Vec<String>,
    /// Why the first region is left out.
    lost: Option<RigFault>,
}

impl<'a> MpcdiFilling<'a> {
    /// From files, for an eye so many metres to the right of, above and behind the origin of
    /// points.
    pub(super) fn of(files: MpcdiFiles<'a>, eye: Option<[f64; 3]>) -> Self {
        Self {
            files,
            left: MOST_MAPPED,
            eye,
            notes: Vec::new(),
            lost: None,
        }
    }

    /// Refuses a document of which no region is left.
    pub(super) fn check_left(&mut self, regions: usize) -> Result<(), RigFault> {
        match self.lost.take() {
            Some(fault) if regions == 0 => Err(fault),
            lost => {
                self.lost = lost;
                Ok(())
            }
        }
    }

    /// Counts a map of a region, or one of so many pictures that are as large as a map.
    fn take(&mut self, (region, size): SizedRegion<'_>, of: u64) -> Result<(), RigFault> {
        let [w, h] = size.map(u64::from);
        let left = self.left.checked_sub(w.saturating_mul(h).div_ceil(of));
        self.left = left.ok_or_else(|| {
            let what = format!("all maps have more than {MOST_MAPPED} pixels");
            region.fault("", what)
        })?;
        Ok(())
    }

    /// The bytes of a file that a map names.
    fn read(&mut self, path: &str, most: u64) -> Result<Vec<u8>, String> {
        let (bytes, is_elsewhere) = self.files.read(path, most)?;
        if is_elsewhere {
            let path = shortened(path);
            self.notes.push(format!(
                "{path}: is not there; the file of that name elsewhere is taken"
            ));
        }
        Ok(bytes)
    }

    /// Says which files of a region are of kinds that are not read.
    pub(super) fn note_unread(&mut self, region: &str, set: XmlElement<'_>) {
        let is_read = |name: &str| READ.iter().any(|it| name.eq_ignore_ascii_case(it));
        let mut unread: Vec<String> = set
            .child_names()
            .filter(|name| !is_read(name))
            .map(|name| name.chars().take(40).collect())
            .take(MOST_UNREAD)
            .collect();
        unread.sort();
        unread.dedup();
        if !unread.is_empty() {
            let verb = if unread.len() == 1 { "is" } else { "are" };
            self.notes.push(format!(
                "region {region:?}: its {} {verb} not read: what that would change is not drawn",
                unread.join(", ")
            ));
        }
    }

    /// Says of a map of a region that it is of another size.
    fn note_size(
        &mut self,
        (region, size): SizedRegion<'_>,
        map: &str,
        nodes: [u64; 2],
        how: &str,
    ) {
        let ([w, h], [columns, rows]) = (size, nodes);
        self.notes.push(format!(
            "region {:?}: its {map} has {columns} x {rows} values for {w} x {h} pixels: {how}",
            region.attribute("id").unwrap_or_default()
        ));
    }

    /// What a float map holds: shares of a panel, or points. Where it is missing or is none, its
    /// region is left out, and there is none.
    pub(super) fn floats<T>(
        &mut self,
        (region, size): SizedRegion<'_>,
        (map, are_shares): (XmlElement<'_>, bool),
        read: &dyn Fn(&FloatMap<'_>) -> Result<T, String>,
    ) -> Result<Option<T>, RigFault> {
        self.take((region, size), 1)?;
        let path = map.said("path").unwrap_or_default();
        let most = most_values(size) * 12 + HEADER;
        let found = self.read(path, most).and_then(|bytes| {
            let map = FloatMap::fitted(&bytes, size)?;
            let map = if are_shares { map.of_shares()? } else { map };
            Ok((read(&map)?, map.other_size(), map.notes().to_vec()))
        });
        let id = region.attribute("id").unwrap_or_default();
        let (found, other_size, notes) = match found {
            Ok(found) => found,
            Err(what) => {
                let fault = map.fault("path", format!("{} {what}", shortened(path)));
                // Nothing outside may be tried, not even in vain.
                if LEADS_OUT.iter().any(|it| what.contains(it)) {
                    return Err(fault);
                }
                self.lost.get_or_insert(fault);
                let path = shortened(path);
                self.notes.push(format!(
                    "region {id:?} is left out: its geometryWarpFile {path} {what}"
                ));
                return Ok(None);
            }
        };
        let notes = notes.into_iter();
        self.notes
            .extend(notes.map(|note| format!("region {id:?}: {}: {note}", shortened(path))));
        if let Some(nodes) = other_size {
            let nodes = nodes.map(|side| side as u64);
            let how = "it is interpolated between them";
            self.note_size((region, size), "geometryWarpFile", nodes, how);
        }
        Ok(Some(found))
    }

    /// What a picture of shares of light holds, where there is one.
    pub(super) fn shares(
        &mut self,
        (region, size): SizedRegion<'_>,
        set: XmlElement<'_>,
        name: &str,
    ) -> Result<Option<AlphaMap>, RigFault> {
        let Some(map) = named(set, name) else {
            return Ok(None);
        };
        self.take((region, size), PICTURES_A_MAP)?;
        let path = map.said("path").unwrap_or_default();
        let gamma = map.number("gammaEmbedded")?.unwrap_or(1.0);
        if !(0.01..=100.0).contains(&gamma) {
            return Err(map.fault("gammaEmbedded", format!("{gamma} is not 0.01 to 100")));
        }
        let most = most_values(size);
        let found = match self.read(path, most * 8 + PNG_BESIDE) {
            // Nothing outside may be tried, not even in vain.
            Err(what) if LEADS_OUT.iter().any(|it| what.contains(it)) => {
                return Err(map.fault("path", format!("{} {what}", shortened(path))));
            }
            found => found.and_then(|bytes| alpha::read_any(&bytes, size, (most, gamma))),
        };
        match found {
            Ok((shares, nodes)) => {
                if nodes != size {
                    let how = "it is resampled";
                    self.note_size((region, size), name, nodes.map(u64::from), how);
                }
                Ok(Some(shares))
            }
            Err(what) => {
                self.notes.push(format!(
                    "region {:?}: its {name} is left out: {} {what}",
                    region.attribute("id").unwrap_or_default(),
                    shortened(path)
                ));
                Ok(None)
            }
        }
    }

    /// The light of black: what a map of it holds everywhere alike.
    pub(super) fn black(
        &mut self,
        (region, size): SizedRegion<'_>,
        set: XmlElement<'_>,
    ) -> Result<f64, RigFault> {
        let Some(beta) = self.shares((region, size), set, "betaMap")? else {
            return Ok(0.0);
        };
        let least = beta.shares().iter().min().copied().unwrap_or(0);
        let most = beta.shares().iter().max().copied().unwrap_or(0);
        if least != most {
            self.notes.push(format!(
                "region {:?}: its betaMap lifts black by 0 to {:.3} of white, pixel by pixel, \
                 which is not drawn: black is left as it is; fade overlaps by \"blend\" and lift \
                 them by \"black\" in a rig file that panels import makes",
                region.attribute("id").unwrap_or_default(),
                f64::from(most) / f64::from(u16::MAX)
            ));
            return Ok(0.0);
        }
        Ok(f64::from(most) / f64::from(u16::MAX))
    }

    /// Where the eye is in the units and axes of a map of points.
    pub(super) fn eye_before(&self, map: XmlElement<'_>) -> Result<DVec3, RigFault> {
        let origin = map.said("originOf3DData").unwrap_or("unknown");
        let Some(metres) = self.eye else {
            if origin.eq_ignore_ascii_case("idealEyePoint") {
                return Ok(DVec3::ZERO);
            }
            let origin = shortened(origin);
            let what = format!(
                "{origin} does not say where the eye is: foveal panels import FILE --eye-at X,Y,Z \
                 does, in metres to the right of, above and behind the origin"
            );
            return Err(map.fault("originOf3DData", what));
        };
        let unit = map.said("geometricUnit").unwrap_or("unknown");
        let length = UNITS
            .iter()
            .find(|(name, _)| unit.eq_ignore_ascii_case(name));
        let length = length.map(|(_, length)| *length).ok_or_else(|| {
            let what = format!(
                "{} is not mm, cm, dm, m, in, ft or yd: export it with one",
                shortened(unit)
            );
            map.fault("geometricUnit", what)
        })?;
        Ok(DVec3::from(metres) / length)
    }
}

/// Most values that a map of a region of `size` may have.
fn most_values(size: [u32; 2]) -> u64 {
    (u64::from(size[0]) * u64::from(size[1]) * MOST_FINER).max(SMALL)
}

/// An element that names a file.
pub(super) fn named<'a>(set: XmlElement<'a>, name: &str) -> Option<XmlElement<'a>> {
    set.child(name).filter(|it| it.said("path").is_some())
}

fn shortened(path: &str) -> String {
    format!("{:?}", path.chars().take(80).collect::<String>())
}
