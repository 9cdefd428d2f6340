//! Which colours do the vertices, points and faces of a PLY file have?

use std::collections::HashMap;

use super::super::colour::{Depth, Full, intensities_shown, lighten};
use super::header::{Element, PlyHeader, Property, Scalar};
use crate::source::{Repairs, SourceMesh};

/// What the first coefficient of a splat's colour counts for: the spherical harmonic of degree 0.
const OF_SPLAT: f64 = 0.282_094_79;
/// Codes of clouds have sixteen bits.
const MOST_CODE: f64 = 65_535.0;
/// What belongs to no part of a colour.
const NONE: usize = usize::MAX;
/// All light of a code of eight bits.
const BYTE: f64 = 255.0;

/// Where in the rows of an element its colours are.
pub(super) struct ColourColumns {
    /// For each property red, green, blue or alpha as 0 to 3, or none.
    parts: Vec<usize>,
    /// The value that would stand for all light by the kind of its numbers.
    usual: f64,
    kind: Kind,
}

/// How rows give colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Kind {
    /// By red, green and blue.
    #[default]
    Parts,
    /// By the first coefficients of splats.
    Splat,
    /// By one number for all parts, as the Point Cloud Library writes them.
    Packed,
    /// Not at all; by how much light came back, from the least to the most.
    Intensity,
}

/// Which part of a colour a property is, in lower case, and whether of a splat.
fn part(name: &str) -> Option<(usize, bool)> {
    // CloudCompare gives this prefix to every property that it does not know.
    let part = match name.strip_prefix("scalar_").unwrap_or(name) {
        "red" | "r" | "diffuse_red" | "red_diffuse" => (0, false),
        "green" | "g" | "diffuse_green" | "green_diffuse" => (1, false),
        "blue" | "b" | "diffuse_blue" | "blue_diffuse" => (2, false),
        "alpha" | "a" | "diffuse_alpha" => (3, false),
        "f_dc_0" => (0, true),
        "f_dc_1" => (1, true),
        "f_dc_2" => (2, true),
        _ => return None,
    };
    Some(part)
}

/// What has all parts of a colour in one number.
const PACKED: [&str; 2] = ["rgb", "rgba"];
/// What says how much light came back, in lower case.
const INTENSITIES: [&str; 11] = [
    "intensity",
    "intensities",
    "scalar_intensity",
    "scalar_intensities",
    "reflectance",
    "scalar_reflectance",
    "reflectivity",
    "scalar_reflectivity",
    "gray",
    "grey",
    "luminance",
];

/// The name of a number of a row, in lower case.
fn named(property: &Property) -> Option<String> {
    match property {
        Property::One { name, .. } => Some(name.to_ascii_lowercase()),
        Property::List { .. } => None,
    }
}

impl ColourColumns {
    /// Of an element; none where it has no colours.
    pub(super) fn of(element: &Element) -> Option<Self> {
        let of_parts = |wanted: bool| {
            let mut usual = 1.0;
            let mut met = [false; 4];
            let column = |property: &Property| {
                let Property::One { name, scalar } = property else {
                    return NONE;
                };
                match part(&name.to_ascii_lowercase()) {
                    Some((at, is_splat)) if is_splat == wanted && !met[at] => {
                        met[at] = true;
                        if at < 3 {
                            usual = scalar.full();
                        }
                        at
                    }
                    _ => NONE,
                }
            };
            let parts: Vec<usize> = element.properties.iter().map(column).collect();
            let kind = if wanted { Kind::Splat } else { Kind::Parts };
            (met[..3] == [true; 3]).then_some(Self { parts, usual, kind })
        };
        let of_one = |names: &[&str], kind: Kind| {
            let is_it = |it: &Property| named(it).is_some_and(|name| names.contains(&&*name));
            let at = element.properties.iter().position(is_it)?;
            let mut parts = vec![NONE; element.properties.len()];
            parts[at] = 0;
            let usual = if kind == Kind::Packed { BYTE } else { 1.0 };
            Some(Self { parts, usual, kind })
        };
        of_parts(false)
            .or_else(|| of_parts(true))
            .or_else(|| of_one(&PACKED, Kind::Packed))
            .or_else(|| of_one(&INTENSITIES, Kind::Intensity))
    }

    /// Whether an element without colours has some parts of them.
    pub(super) fn is_part_of(element: &Element) -> bool {
        let is_colour = |it: &Property| {
            let part = named(it).and_then(|name| part(&name));
            part.is_some_and(|(at, is_splat)| at < 3 && !is_splat)
        };
        Self::of(element).is_none_or(|it| it.kind != Kind::Parts)
            && element.properties.iter().any(is_colour)
    }

    /// Whether red, green and blue are given one by one.
    pub(super) fn is_parts(&self) -> bool {
        self.kind == Kind::Parts
    }

    /// Whether one number gives all parts of a colour.
    pub(super) fn is_packed(&self) -> bool {
        self.kind == Kind::Packed
    }

    /// Which part of a colour the property of a number is.
    pub(super) fn part(&self, property: usize) -> Option<usize> {
        self.parts.get(property).copied().filter(|it| *it != NONE)
    }
}

/// Gives the colours of vertices, where these have intensities too, names that say nothing;
/// `false` where nothing else says how light they are.
pub(super) fn forget_colours(header: &mut PlyHeader) -> bool {
    let mut elements = header.elements.iter_mut();
    let Some(vertex) = elements.find(|it| it.name == "vertex") else {
        return false;
    };
    let before = vertex.clone();
    let is_colour = |name: &str| PACKED.contains(&name) || part(name).is_some();
    for property in &mut vertex.properties {
        if let Property::One { name, .. } = property
            && is_colour(&name.to_ascii_lowercase())
        {
            *name = format!("black {name}");
        }
    }
    let has_light = ColourColumns::of(vertex).is_some();
    if !has_light {
        *vertex = before;
    }
    has_light
}

/// The colours of rows, as the file has them.
#[derive(Default)]
pub(super) struct PlyColours {
    raw: Vec<[f32; 4]>,
    depth: Depth,
    usual: f64,
    most_alpha: f32,
    kind: Kind,
    /// The least and most of intensities.
    range: Option<[f64; 2]>,
    /// Which of them are black and white.
    shown: Option<[f64; 2]>,
}

impl PlyColours {
    pub(super) fn new(columns: &ColourColumns) -> Self {
        Self {
            usual: columns.usual,
            kind: columns.kind,
            ..Self::default()
        }
    }

    pub(super) fn len(&self) -> usize {
        self.raw.len()
    }

    /// Whether all are black.
    pub(super) fn is_black(&self) -> bool {
        let is_given = matches!(self.kind, Kind::Parts | Kind::Packed);
        let mut all = self.raw.iter();
        is_given && !self.raw.is_empty() && all.all(|it| it[..3] == [0.0; 3])
    }

    /// Adds a colour; `false` if it is invalid, and will be white. An alpha below 0 is not said.
    pub(super) fn add(&mut self, mut colour: [f64; 4]) -> bool {
        match self.kind {
            Kind::Splat => {
                colour = colour.map(|it| (0.5 + OF_SPLAT * it).clamp(0.0, 1.0));
                colour[3] = -1.0;
            }
            Kind::Packed => {
                let [_, red, green, blue] = (colour[0] as u32).to_be_bytes();
                colour = [red, green, blue, 255].map(f64::from);
            }
            Kind::Intensity => {
                let light = colour[0];
                colour = [light, light, light, -1.0];
                let [least, most] = self.range.unwrap_or([light; 2]);
                if light.is_finite() {
                    self.range = Some([least.min(light), most.max(light)]);
                }
            }
            Kind::Parts => {}
        }
        let is_one = colour.iter().all(|it| it.is_finite());
        if !is_one {
            colour = [f64::NAN; 4];
        }
        let [red, green, blue, alpha] = colour;
        self.depth.add([red, green, blue]);
        self.most_alpha = self.most_alpha.max(alpha as f32);
        self.raw.push(colour.map(|it| it as f32));
        is_one
    }

    fn full(&self) -> Full {
        match self.kind {
            Kind::Splat | Kind::Intensity => Depth::default().full(1.0),
            Kind::Packed => Depth::default().full(BYTE),
            Kind::Parts => self.depth.full(self.usual),
        }
    }

    /// Makes intensities parts of 1.
    fn spread_intensities(&mut self) {
        if self.kind != Kind::Intensity {
            return;
        }
        let values = self.raw.iter().map(|it| f64::from(it[0])).collect();
        let Some([from, to]) = intensities_shown(values) else {
            return;
        };
        self.shown = Some([from, to]);
        let length = (to - from).max(f64::MIN_POSITIVE);
        for colour in &mut self.raw {
            let light = ((f64::from(colour[0]) - from) / length).clamp(0.0, 1.0) as f32;
            if !colour[0].is_nan() {
                *colour = [light, light, light, colour[3]];
            }
        }
    }

    fn tell(&self, full: &Full, strays: usize, reported: &mut ColourRemarks) {
        if let (Kind::Intensity, Some([least, most])) = (self.kind, self.range) {
            let what = &reported.what;
            let [from, to] = self.shown.unwrap_or([least, most]);
            let mut cut = String::new();
            if from > least {
                cut += &format!("; {from} and less are black");
            }
            if to < most {
                cut += &format!("; {to} and more are white");
            }
            reported.remarks.push(format!(
                "{what} have no colours, but intensities from {least} to {most}: they are shown as \
                 grey{cut}"
            ));
        }
        if self.kind == Kind::Splat {
            reported.remark("splats are drawn as points, each in its own colour from all sides");
        }
        let counts = (self.raw.len(), strays);
        if let Some(remark) = full.tell(&reported.what, counts, &mut reported.repairs) {
            reported.remark(remark);
        }
    }

    /// In linear light; white where there was no number.
    pub(super) fn lights(mut self, reported: &mut ColourRemarks) -> Vec<[f32; 4]> {
        self.spread_intensities();
        let full = self.full();
        let alpha = match self.most_alpha {
            most if most <= 1.0 => 1.0,
            most if most <= 255.0 => 255.0,
            _ => self.usual.max(full.largest()),
        };
        for colour in &mut self.raw {
            if colour[0].is_nan() {
                *colour = [full.largest() as f32; 4];
            }
            if colour[3] < 0.0 {
                colour[3] = alpha as f32;
            }
        }
        let strays = lighten(&mut self.raw, &full, alpha);
        self.tell(&full, strays, reported);
        self.raw
    }

    /// As codes of sixteen bits; one of eight bits becomes 257 times as much.
    pub(super) fn codes(mut self, reported: &mut ColourRemarks) -> Vec<[u16; 3]> {
        self.spread_intensities();
        let full = self.full();
        let mut strays = 0;
        let code = |raw: &[f32; 4]| {
            let parts = [0, 1, 2].map(|k| f64::from(raw[k]));
            if parts[0].is_nan() {
                return [u16::MAX; 3];
            }
            strays += usize::from(full.is_stray(parts));
            let shares = full.shares(parts);
            shares.map(|share| (share * MOST_CODE).round() as u16)
        };
        let codes = self.raw.iter().map(code).collect();
        self.tell(&full, strays, reported);
        codes
    }
}

/// What is said and counted while colours are read.
pub(super) struct ColourRemarks {
    /// What the colours are of: vertices, points or faces of a file.
    pub(super) what: String,
    pub(super) repairs: Repairs,
    pub(super) remarks: Vec<String>,
}

impl ColourRemarks {
    pub(super) fn of(what: String) -> Self {
        Self {
            what,
            repairs: Repairs::new(),
            remarks: Vec::new(),
        }
    }

    fn remark(&mut self, remark: impl Into<String>) {
        self.remarks.push(remark.into());
    }
}

/// Gives each triangle the colour of its face, by the number of that: vertices between triangles of
/// several colours stand there once for each.
pub(super) fn colour_triangles(mesh: &mut SourceMesh, faces: &[u32], colours: &[[f32; 4]]) {
    let mut of: HashMap<(u32, [u32; 4]), u32> = HashMap::with_capacity(mesh.positions.len());
    let mut coloured = SourceMesh::default();
    for (triangle, face) in mesh.triangles.iter_mut().zip(faces) {
        let colour = colours.get(*face as usize).copied().unwrap_or([1.0; 4]);
        for corner in triangle {
            let at = *corner as usize;
            let Some(position) = mesh.positions.get(at) else {
                // An invalid one is left out with its triangle.
                *corner = u32::MAX;
                continue;
            };
            let next = coloured.positions.len() as u32;
            let number = *of
                .entry((*corner, colour.map(f32::to_bits)))
                .or_insert(next);
            if number == next {
                coloured.positions.push(*position);
                coloured.normals.extend(mesh.normals.get(at));
                coloured.uvs.extend(mesh.uvs.get(at));
                coloured.colours.push(colour);
            }
            *corner = number;
        }
    }
    mesh.positions = coloured.positions;
    mesh.normals = coloured.normals;
    mesh.uvs = coloured.uvs;
    mesh.colours = coloured.colours;
}

impl Scalar {
    /// The value that would stand for all light.
    fn full(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::I32 => f64::from(i32::MAX),
            Self::U32 => f64::from(u32::MAX),
            Self::I64 => i64::MAX as f64,
            Self::U64 => u64::MAX as f64,
            Self::F16 | Self::F32 | Self::F64 => 1.0,
        }
    }
}
