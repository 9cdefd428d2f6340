//! Where do the regions of an MPCDI lie, and how do they look?

use super::super::checked;
use super::super::entries::{
    EyeEntry, OutputEntry, PanelEntry, PoseEntry, PoseOrder, ScanoutEntry, TangentsEntry,
};
use super::super::error::RigFault;
use super::xml::XmlElement;

/// What of a share of a buffer rounding may add.
const ROUNDED: f64 = 1e-3;
/// Pixels by which a region may differ from its share of the buffer.
const NEAR_SHARE: f64 = 1.5;
/// Largest angle from the axis, in degrees.
const WIDEST: f64 = 89.9;

/// A region, its place in its buffer's picture and its pixels.
pub(super) struct MpcdiRegion<'a> {
    pub(super) element: XmlElement<'a>,
    pub(super) id: String,
    surface: String,
    /// Left, lower edge, width and height, as shares of the buffer.
    part: [f64; 4],
    pub(super) size: [u32; 2],
    /// First column and row.
    origin: [u32; 2],
    /// Width over height of the buffer.
    pub(super) aspect: f64,
    /// Columns and rows of the buffer, where it gives them.
    buffer: Option<[f64; 2]>,
    /// Whether its own id names no file.
    pub(super) is_renamed: bool,
    /// What was mended, in words.
    pub(super) notes: Vec<String>,
}

fn count_of_pixels(element: XmlElement<'_>, name: &str, pixels: f64) -> Result<u32, RigFault> {
    let whole = pixels.round();
    if (pixels - whole).abs() > ROUNDED || !(1.0..=1e6).contains(&whole) {
        return Err(element.fault(name, format!("{pixels} is not a count of pixels")));
    }
    Ok(whole as u32)
}

impl<'a> MpcdiRegion<'a> {
    /// The region of an element, the so manieth of its document.
    pub(super) fn of(
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
    pub(super) fn other_share(&self) -> Option<[f64; 2]> {
        let buffer = self.buffer?;
        let share = [0, 1].map(|k| buffer[k] * self.part[k + 2]);
        let is_other = |k: usize| (share[k] - f64::from(self.size[k])).abs() > NEAR_SHARE;
        (is_other(0) || is_other(1)).then(|| share.map(f64::round))
    }

    pub(super) fn entry(&self, pose: PoseEntry, tangents: TangentsEntry) -> PanelEntry {
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

    pub(super) fn on_screen(&self, [width, height]: [f64; 2]) -> TangentsEntry {
        let [x, y, w, h] = self.part;
        TangentsEntry {
            left: (0.5 - x) * width,
            right: (x + w - 0.5) * width,
            up: (y + h - 0.5) * height,
            down: (0.5 - y) * height,
        }
    }

    pub(super) fn before_eye(
        &self,
        notes: &mut Vec<String>,
    ) -> Result<(PoseEntry, TangentsEntry), RigFault> {
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
