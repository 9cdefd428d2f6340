//! What does a pack say about its scene?

use crate::content::mesh::payload::Attributes;
use crate::content::points::payload::PointAttributes;
use crate::pack::{Identity, PackError, TableEntry};
use glam::{DAffine3, DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// What the description of every scene has as its kind, and needs of its reader.
pub const KIND: &str = "scene";
/// Most objects of a scene.
const MOST_OBJECTS: usize = 4096;
/// Most levels of a scene.
const MOST_LEVELS: usize = 40;
/// Bits of a place on the grid of an object.
pub const GRID_BITS: core::ops::RangeInclusive<u8> = 10..=16;

/// The description of a scene pack.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneDescription {
    /// `scene`.
    pub kind: String,
    /// What a reader must understand.
    pub needs: Vec<String>,
    /// Who wrote the pack.
    pub generator: String,
    /// What it was made of.
    pub source: SceneSource,
    /// What stands in it.
    pub objects: Vec<SceneObject>,
    /// Number of units of each level, finest first; the roots of all objects are the coarsest.
    pub units: Vec<u32>,
    /// Entries of a full page of the index, and rows of a full page of tables.
    pub page: u32,
    /// How it was made, for who would make it again.
    #[serde(default)]
    pub identity: Identity,
    /// What a person should know: what of the source's looks is not drawn.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// What was repaired or left out of the source, by name.
    #[serde(default)]
    pub repairs: std::collections::BTreeMap<String, u64>,
    /// Where side tables lie.
    pub tables: Vec<TableEntry>,
}

/// What a scene was made of.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneSource {
    /// Names of the files.
    pub names: Vec<String>,
    /// Their bytes together.
    pub bytes: u64,
}

/// Something that stands in a scene, once or more often.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneObject {
    /// Its name, for people.
    pub name: String,
    /// Triangles at the finest level; of points none.
    pub leaf_triangles: u64,
    /// A small sphere round it, in its own space.
    pub bounds: ObjectBounds,
    /// The grid of its vertices.
    pub grid: Grid,
    /// What its vertices have.
    pub attributes: Attributes,
    /// Its colour in linear light, red, green, blue and alpha; colours of vertices stand instead
    /// where there are any.
    pub colour: [f32; 4],
    /// Whether it is seen from both sides.
    pub two_sided: bool,
    /// Whether no light falls on it.
    pub unlit: bool,
    /// Where it stands: world from object, columns x, y, z and place; at least one.
    pub placements: Vec<[f64; 12]>,
    /// The cloud of points that it is, where it is no mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub points: Option<Cloud>,
}

/// A cloud of points, on the grid of its file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cloud {
    /// Number of all points.
    pub count: u64,
    /// Length of a step along each axis, in the object's space.
    pub scale: [f64; 3],
    /// Where the file's coordinates are 0, in the object's space.
    pub offset: [f64; 3],
    /// The file's coordinates of the place [0, 0, 0].
    pub least: [i64; 3],
    /// What its points have.
    pub attributes: PointAttributes,
    /// Bits of a code of a colour: 8 or 16.
    pub colour_bits: u8,
    /// What a code of eight bits was multiplied by in the file.
    pub colour_times: u16,
    /// The largest intensity.
    pub most_intensity: u16,
}

impl Default for Cloud {
    fn default() -> Self {
        Self {
            count: 0,
            scale: [1.0; 3],
            offset: [0.0; 3],
            least: [0; 3],
            attributes: PointAttributes::default(),
            colour_bits: 8,
            colour_times: 1,
            most_intensity: 0,
        }
    }
}

impl Cloud {
    /// A place on its grid, in the object's space: as the file says by whole numbers.
    #[must_use]
    pub fn at(&self, place: [u32; 3]) -> DVec3 {
        let along = |axis: usize| {
            let steps = self.least[axis] + i64::from(place[axis]);
            steps as f64 * self.scale[axis] + self.offset[axis]
        };
        DVec3::from_array([0, 1, 2].map(along))
    }

    /// A code of a colour as one of eight bits.
    #[must_use]
    pub fn shown_code(&self, code: u16) -> u8 {
        match self.colour_bits {
            8 => code.min(255) as u8,
            _ => (code >> 8) as u8,
        }
    }

    /// The grey of an intensity, as a code of a colour of this cloud.
    pub(crate) fn grey_of(&self, intensity: u16) -> u16 {
        let most = u32::from(self.most_intensity).max(1);
        let white = if self.colour_bits == 8 { 255 } else { 65535 };
        // The square root, about as a display encodes light.
        let share = f64::from(intensity) / f64::from(most);
        (libm::sqrt(share.min(1.0)) * f64::from(white)) as u16
    }

    fn check(&self) -> Result<(), PackError> {
        let wrong = |field: &str, found: String, expected: &str| {
            let field = format!("objects.points.{field}");
            Err(PackError::new(&field, found, expected))
        };
        let is_step = |it: &f64| *it > 0.0 && *it <= 1e12;
        if !(self.scale.iter().all(is_step) && self.offset.iter().all(|it| it.abs() <= 1e15)) {
            let found = format!("{:?}, {:?}", self.scale, self.offset);
            return wrong("scale, offset", found, "a finite grid");
        }
        if self.least.iter().any(|it| it.unsigned_abs() > 1 << 40) {
            return wrong("least", format!("{:?}", self.least), "below 2^40");
        }
        match self.colour_bits {
            8 | 16 => Ok(()),
            bits => wrong("colour_bits", bits.to_string(), "8 or 16"),
        }
    }
}

/// A sphere round an object, in its own space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectBounds {
    /// The centre.
    pub centre: [f64; 3],
    /// The radius.
    pub radius: f64,
}

/// Where the places of vertices lie.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// The place [0, 0, 0], in the object's space.
    pub origin: [f64; 3],
    /// Distance of two neighbouring places, the same along each axis.
    pub step: f64,
    /// Bits of a place along an axis.
    pub bits: u8,
}

impl Grid {
    /// A place in the object's space.
    #[must_use]
    pub fn at(&self, place: [u16; 3]) -> DVec3 {
        DVec3::from_array(self.origin) + self.step * DVec3::from_array(place.map(f64::from))
    }

    /// Object space from places on the grid.
    #[must_use]
    pub fn object_from_grid(&self) -> DAffine3 {
        let step = DMat3::from_diagonal(DVec3::splat(self.step));
        DAffine3::from_mat3_translation(step, DVec3::from_array(self.origin))
    }
}

impl SceneObject {
    /// World from object, for each place where it stands.
    pub fn placements(&self) -> impl Iterator<Item = DAffine3> {
        self.placements.iter().map(DAffine3::from_cols_array)
    }
}

/// The fields that are read before all others, which a later version may write otherwise.
#[derive(Deserialize)]
struct Needs {
    kind: Option<String>,
    #[serde(default)]
    needs: Vec<String>,
}

impl Needs {
    fn check(&self) -> Result<(), PackError> {
        let shown = |name: &str| name.chars().take(64).collect::<String>();
        let kind = self.kind.as_deref().unwrap_or("none");
        if kind != KIND {
            return Err(PackError::new("description.kind", shown(kind), KIND));
        }
        match self.needs.iter().find(|name| *name != KIND) {
            None => Ok(()),
            Some(name) => Err(PackError::new(
                "description.needs",
                shown(name),
                "nothing but scene; a newer foveal wrote this pack: update foveal",
            )),
        }
    }
}

impl SceneDescription {
    /// Reads a description.
    ///
    /// # Errors
    /// The bytes are no JSON of a scene, it needs more than this program understands, or a number
    /// is out of range.
    pub fn parse(json: &[u8]) -> Result<Self, PackError> {
        let wrong = |error| {
            PackError::new(
                "description",
                error,
                "a scene, as docs/formats/pack.md says",
            )
        };
        let needs: Needs = serde_json::from_slice(json).map_err(wrong)?;
        needs.check()?;
        let about: Self = serde_json::from_slice(json).map_err(wrong)?;
        about.check()?;
        Ok(about)
    }

    /// Triangles and points at the finest level, each once.
    #[must_use]
    pub fn finest_samples(&self) -> u64 {
        let objects = self.objects.iter();
        objects
            .map(|it| {
                it.leaf_triangles
                    .saturating_add(it.points.map_or(0, |it| it.count))
            })
            .fold(0, u64::saturating_add)
    }

    /// Triangles at the finest level, each as often as it stands there.
    #[must_use]
    pub fn triangles(&self) -> u64 {
        let objects = self.objects.iter();
        objects
            .map(|it| it.leaf_triangles.saturating_mul(it.placements.len() as u64))
            .fold(0, u64::saturating_add)
    }

    fn check(&self) -> Result<(), PackError> {
        let within = |field: &str, found: usize, most: usize| match (1..=most).contains(&found) {
            true => Ok(()),
            false => Err(PackError::new(field, found, format!("1 to {most}"))),
        };
        within("objects", self.objects.len(), MOST_OBJECTS)?;
        within("units", self.units.len(), MOST_LEVELS)?;
        if self.units.last() == Some(&0) {
            return Err(PackError::new("units", "no roots", "at least one"));
        }
        within("page", self.page as usize, 1 << 12)?;
        self.objects.iter().try_for_each(SceneObject::check)
    }
}

impl SceneObject {
    fn check(&self) -> Result<(), PackError> {
        let wrong = |field: &str, found: String, expected: &str| {
            Err(PackError::new(&format!("objects.{field}"), found, expected))
        };
        let Grid { origin, step, bits } = self.grid;
        if !GRID_BITS.contains(&bits) {
            return wrong("grid.bits", bits.to_string(), "10 to 16");
        }
        if !(step > 0.0 && step <= 1e12 && origin.iter().all(|it| it.abs() <= 1e15)) {
            return wrong("grid", format!("{:?}", self.grid), "a finite grid");
        }
        let ObjectBounds { centre, radius } = self.bounds;
        if !((0.0..=1e15).contains(&radius) && centre.iter().all(|it| it.abs() <= 1e15)) {
            return wrong("bounds", format!("{:?}", self.bounds), "a finite sphere");
        }
        if self.placements.is_empty() {
            return wrong("placements", "none".to_owned(), "at least one");
        }
        let is_finite = |it: &&f64| it.abs() <= 1e15;
        if !self.placements.iter().flatten().all(|it| is_finite(&it)) {
            return wrong("placements", "too large".to_owned(), "finite numbers");
        }
        if let Some(points) = &self.points {
            points.check()?;
        }
        match self.colour.iter().all(|it| (0.0..=1.0).contains(it)) {
            true => Ok(()),
            false => wrong("colour", format!("{:?}", self.colour), "0 to 1"),
        }
    }
}
