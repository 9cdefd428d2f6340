//! What does the metadata of a photo sphere say of where its picture lies?
//!
//! Their names are those of the XMP namespace GPano.

use roxmltree::{Document, Node, NodeType};

use crate::surround::sphere_part::{MOST_PIXELS, MOST_SIDE, SpherePart};

const NAMESPACE: &str = "http://ns.google.com/photos/1.0/panorama/";
/// Across and down: of the whole, of what was cut from it, and where that begins.
const NAMES: [[&str; 3]; 2] = [
    [
        "FullPanoWidthPixels",
        "CroppedAreaImageWidthPixels",
        "CroppedAreaLeftPixels",
    ],
    [
        "FullPanoHeightPixels",
        "CroppedAreaImageHeightPixels",
        "CroppedAreaTopPixels",
    ],
];
/// More nodes than any XMP packet has.
const MOST_NODES: u32 = 100_000;
/// Pixels by which sizes that were scaled and rounded may be off.
const ROUNDED: f64 = 1.5;

/// What a file says in the namespace GPano.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PhotoSphere {
    /// Names and values.
    said: Vec<(String, String)>,
}

/// How a picture lies on the sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Where on the whole, whose middle is north, or as it was taken where no heading is said.
    pub part: SpherePart,
    /// Compass direction of the middle of the whole as it was taken, from north to east, in
    /// degrees; `None` where it is not said.
    pub heading_deg: Option<f64>,
    /// Pitch and roll in degrees, 0 of a sphere that stands upright.
    pub tilt_deg: [f64; 2],
}

impl PhotoSphere {
    /// Reads an XMP packet; `None` where it says nothing in the namespace. The error says what is
    /// wrong with the packet.
    pub fn of_xmp(packet: &[u8]) -> Result<Option<Self>, String> {
        if !packet
            .windows(NAMESPACE.len())
            .any(|bytes| bytes == NAMESPACE.as_bytes())
        {
            return Ok(None);
        }
        let text = std::str::from_utf8(packet).map_err(|e| e.to_string())?;
        let text = text
            .trim_start_matches('\u{feff}')
            .trim_matches(['\0', ' ', '\n', '\r']);
        let options = roxmltree::ParsingOptions {
            nodes_limit: MOST_NODES,
            ..Default::default()
        };
        let document =
            Document::parse_with_options(text, options).map_err(|error| error.to_string())?;
        let mut said = Vec::new();
        for node in document.descendants().filter(Node::is_element) {
            let attributes = node.attributes();
            let ours = attributes.filter(|one| one.namespace() == Some(NAMESPACE));
            said.extend(ours.map(|one| (one.name().to_owned(), one.value().trim().to_owned())));
            if node.tag_name().namespace() == Some(NAMESPACE) {
                let texts = node
                    .children()
                    .filter(|one| one.node_type() == NodeType::Text);
                let text: String = texts.filter_map(|one| one.text()).collect();
                said.push((node.tag_name().name().to_owned(), text.trim().to_owned()));
            }
        }
        Ok((!said.is_empty()).then_some(Self { said }))
    }

    fn text(&self, name: &str) -> Option<&str> {
        let found = self.said.iter().find(|(said, _)| said == name);
        found.map(|(_, value)| value.as_str())
    }

    /// A finite number; `None` where it is not said.
    fn number(&self, name: &str) -> Result<Option<f64>, String> {
        let Some(text) = self.text(name) else {
            return Ok(None);
        };
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number
            .map(Some)
            .ok_or_else(|| format!("{name} is {text:?}, not a number"))
    }

    /// Why its picture is to be looked at as a flat one all the same; `None` where it is not.
    #[must_use]
    pub fn flat_because(&self) -> Option<String> {
        if self
            .text("UsePanoramaViewer")
            .is_some_and(|text| text.eq_ignore_ascii_case("false"))
        {
            return Some("UsePanoramaViewer is False".to_owned());
        }
        match self.text("ProjectionType") {
            Some(kind) if kind.eq_ignore_ascii_case("equirectangular") => None,
            Some(kind) => Some(format!("ProjectionType is {kind:?}, not equirectangular")),
            None => Some("it has no ProjectionType".to_owned()),
        }
    }

    /// How a picture of this size lies on the sphere; one that was scaled since lies where it lay.
    ///
    /// The error says what cannot be meant.
    pub fn placed(&self, size: [u32; 2]) -> Result<Placed, String> {
        let [w, h] = size.map(f64::from);
        let (mut whole, mut crop, mut at) = ([w, h], [w, h], [0.0; 2]);
        for (k, [of, cropped, from]) in NAMES.into_iter().enumerate() {
            let [said_whole, said_crop] = [self.number(of)?, self.number(cropped)?];
            whole[k] = match (said_whole, said_crop) {
                (None, Some(_)) => return Err(format!("{of} is missing")),
                (said, _) => said.unwrap_or(whole[k]),
            };
            crop[k] = said_crop.unwrap_or(whole[k]);
            at[k] = match self.number(from)? {
                None if crop[k] < whole[k] => return Err(format!("{from} is missing")),
                said => said.unwrap_or(0.0),
            };
            if crop[k] < 1.0 {
                return Err(format!("{cropped} is {}, less than a pixel", crop[k]));
            }
            if at[k] < 0.0 || at[k] + crop[k] > whole[k] {
                return Err(format!(
                    "{from} {} and {cropped} {} reach beyond {of} {}",
                    at[k], crop[k], whole[k]
                ));
            }
        }
        let scale = w / crop[0];
        if (crop[1] * scale - h).abs() > ROUNDED.max(ROUNDED * scale) {
            return Err(format!(
                "{} x {} is {} x {}, of another shape than its {} x {} pixels",
                NAMES[0][1], NAMES[1][1], crop[0], crop[1], size[0], size[1]
            ));
        }
        let whole = [whole[0] * scale, whole[1] * h / crop[1]].map(f64::round);
        if whole.iter().any(|side| *side > MOST_SIDE) || whole[0] * whole[1] > MOST_PIXELS as f64 {
            return Err(format!(
                "the whole sphere would have {} x {} pixels, more than {MOST_PIXELS}",
                whole[0], whole[1]
            ));
        }
        let heading_deg = self.number("PoseHeadingDegrees")?;
        if let Some(degrees) = heading_deg.filter(|degrees| degrees.abs() > 360.0) {
            return Err(format!("PoseHeadingDegrees is {degrees}, more than a turn"));
        }
        let turned = heading_deg.unwrap_or(0.0) / 360.0 * whole[0];
        let left = even(at[0] * scale + turned).rem_euclid(whole[0]);
        let lowest = 2.0 * ((whole[1] - h) / 2.0).floor();
        let top = even(at[1] * h / crop[1]).min(lowest);
        let tilt = |name| Ok::<_, String>(self.number(name)?.unwrap_or(0.0));
        Ok(Placed {
            part: SpherePart {
                whole: whole.map(|side| side as u32),
                at: [left, top].map(|place| place as u32 & !1),
            },
            heading_deg,
            tilt_deg: [tilt("PosePitchDegrees")?, tilt("PoseRollDegrees")?],
        })
    }
}

/// The even number nearest to a place.
fn even(place: f64) -> f64 {
    2.0 * (place / 2.0).round()
}
