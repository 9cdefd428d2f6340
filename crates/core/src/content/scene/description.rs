//! What does a pack say about its scene?

use crate::content::images::shape::MOST_SIDE;
use crate::content::images::wrap::Wrap;
use crate::content::mesh::payload::Attributes;
use crate::content::points::cloud::Cloud;
use crate::content::scene::kind::UnitKind;
use crate::content::scene::lighting::LAMP_DIRECTION;
use crate::pack::{Identity, PackError, TableEntry};
use glam::{DAffine3, DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// What the description of every scene has as its kind, and needs of its reader.
pub const KIND: &str = "scene";
/// Most objects of a scene: a row of the table of units names one in 16 bits, of which the last
/// stands for all.
pub const MOST_OBJECTS: usize = 65_535;
/// What the description needs whose objects lie in a side table of that name.
pub const OBJECTS: &str = "objects";
/// Most levels of a scene.
const MOST_LEVELS: usize = 40;
/// Most textures of a scene.
const MOST_TEXTURES: usize = 65_535;
/// Most textures of an object: a vertex names one in a byte, or none.
pub const MOST_TEXTURES_OF_OBJECT: usize = 254;
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
    /// What stands in it; of a description that needs [`OBJECTS`] nothing, until
    /// [`Self::with_objects`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<SceneObject>,
    /// What its surfaces have; the same.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub textures: Vec<SceneTexture>,
    /// For each object the names of the parts that it was joined of, where that is not one: what is
    /// written into a side table, and not read with the rest.
    #[serde(skip)]
    pub parts: Vec<Vec<String>>,
    /// What was joined.
    #[serde(default, skip_serializing_if = "JoinedParts::are_none")]
    pub joined: JoinedParts,
    /// Number of units of each level, finest first; the roots of all objects are the coarsest.
    pub units: Vec<u32>,
    /// Entries of a full page of the index, and rows of a full page of tables.
    pub page: u32,
    /// What is round its objects.
    #[serde(default, skip_serializing_if = "Backdrop::is_usual")]
    pub look: Backdrop,
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

/// How many small objects of the source were joined to few.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct JoinedParts {
    /// The objects that they became.
    pub bundles: u64,
    /// Those of the source.
    pub objects: u64,
    /// Places where these stand.
    pub places: u64,
}

impl JoinedParts {
    fn are_none(&self) -> bool {
        *self == Self::default()
    }
}

/// What is seen where nothing stands, and where light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Backdrop {
    /// What is seen where nothing stands: red, green and blue in linear light, 0 to 1.
    pub background: [f32; 3],
    /// Where light comes from, in the world; finite, of any length but 0.
    pub light: [f64; 3],
}

impl Default for Backdrop {
    fn default() -> Self {
        Self {
            background: [0.03; 3],
            light: LAMP_DIRECTION.to_array(),
        }
    }
}

impl Backdrop {
    fn is_usual(&self) -> bool {
        *self == Self::default()
    }

    fn check(&self) -> Result<(), PackError> {
        if !self.background.iter().all(|it| (0.0..=1.0).contains(it)) {
            let found = format!("{:?}", self.background);
            return Err(PackError::new("look.background", found, "0 to 1"));
        }
        let light = DVec3::from_array(self.light);
        match light.try_normalize() {
            Some(_) if light.abs().max_element() <= 1e15 => Ok(()),
            _ => {
                let found = format!("{:?}", self.light);
                Err(PackError::new("look.light", found, "a finite direction"))
            }
        }
    }
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
#[serde(from = "ObjectFields", into = "ObjectFields")]
pub struct SceneObject {
    /// Its name, for people.
    pub name: String,
    /// What it is made of.
    pub shape: Shape,
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
    /// The textures of its vertices; there where they have any.
    pub texturing: Option<Texturing>,
}

/// What an object is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A mesh.
    Mesh {
        /// Triangles at the finest level.
        leaf_triangles: u64,
    },
    /// A cloud of points.
    Cloud(Cloud),
}

impl Shape {
    /// The kind of its units.
    #[must_use]
    pub fn kind(&self) -> UnitKind {
        match self {
            Self::Mesh { .. } => UnitKind::Mesh,
            Self::Cloud(_) => UnitKind::Points,
        }
    }

    /// Samples at the finest level: triangles or points.
    #[must_use]
    pub fn samples(&self) -> u64 {
        match self {
            Self::Mesh { leaf_triangles } => *leaf_triangles,
            Self::Cloud(cloud) => cloud.count,
        }
    }

    /// The cloud that it is; `None` where it is something else.
    #[must_use]
    pub fn cloud(&self) -> Option<&Cloud> {
        match self {
            Self::Mesh { .. } => None,
            Self::Cloud(cloud) => Some(cloud),
        }
    }
}

/// An object as its JSON has it: with a field for what each shape has.
#[derive(Serialize, Deserialize)]
struct ObjectFields {
    name: String,
    leaf_triangles: u64,
    bounds: ObjectBounds,
    grid: Grid,
    attributes: Attributes,
    colour: [f32; 4],
    two_sided: bool,
    unlit: bool,
    placements: Vec<[f64; 12]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    points: Option<Cloud>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    texturing: Option<Texturing>,
}

impl From<SceneObject> for ObjectFields {
    fn from(object: SceneObject) -> Self {
        let (leaf_triangles, points) = match object.shape {
            Shape::Mesh { leaf_triangles } => (leaf_triangles, None),
            Shape::Cloud(cloud) => (0, Some(cloud)),
        };
        Self {
            name: object.name,
            leaf_triangles,
            bounds: object.bounds,
            grid: object.grid,
            attributes: object.attributes,
            colour: object.colour,
            two_sided: object.two_sided,
            unlit: object.unlit,
            placements: object.placements,
            points,
            texturing: object.texturing,
        }
    }
}

impl From<ObjectFields> for SceneObject {
    fn from(fields: ObjectFields) -> Self {
        let leaf_triangles = fields.leaf_triangles;
        let mesh = Shape::Mesh { leaf_triangles };
        Self {
            name: fields.name,
            shape: fields.points.map_or(mesh, Shape::Cloud),
            bounds: fields.bounds,
            grid: fields.grid,
            attributes: fields.attributes,
            colour: fields.colour,
            two_sided: fields.two_sided,
            unlit: fields.unlit,
            placements: fields.placements,
            texturing: fields.texturing,
        }
    }
}

/// Which textures an object has, and where its vertices lie on them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Texturing {
    /// Numbers of textures of the scene, at most 254; vertices name them by their place here.
    pub textures: Vec<u16>,
    /// Where the place [0, 0] lies: 0 to 1 is the texture once, to the right and down.
    pub origin: [f64; 2],
    /// Distance of two neighbouring places along each axis.
    pub step: [f64; 2],
}

/// A picture that surfaces have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneTexture {
    /// Its name, for people.
    pub name: String,
    /// Columns and rows of texels, at most 16384 each.
    pub size: [u32; 2],
    /// What lies outside it, along rows and along columns.
    pub wrap: [Wrap; 2],
    /// Its mean colour in linear light, red, green and blue: what stands in until a page is there.
    pub colour: [f32; 3],
    /// Where its alpha is less, nothing is drawn; without, all of it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutoff: Option<f32>,
}

/// A sphere round an object, in its own space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectBounds {
    /// The centre.
    pub centre: [f64; 3],
    /// The radius.
    pub radius: f64,
    /// Half the sides of a box round the same centre; zeros where none is known.
    #[serde(default, skip_serializing_if = "is_no_box")]
    pub half: [f64; 3],
}

fn is_no_box(half: &[f64; 3]) -> bool {
    *half == [0.0; 3]
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

/// By how much lengths grow at most where an object stands.
#[must_use]
pub fn most_growth(world_from_object: &DAffine3) -> f64 {
    let axes = world_from_object.matrix3;
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis];
    let lengths = [x, y, z].map(DVec3::length_squared);
    // Of perpendicular axes the longest is meant; others may together stretch more.
    let skew = [x.dot(y), y.dot(z), z.dot(x)].map(f64::abs);
    let most = lengths.into_iter().fold(0.0, f64::max) + skew.iter().sum::<f64>();
    libm::sqrt(most)
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
        let is_known = |name: &&String| [KIND, OBJECTS].contains(&name.as_str());
        match self.needs.iter().find(|name| !is_known(name)) {
            None => Ok(()),
            Some(name) => Err(PackError::new(
                "description.needs",
                shown(name),
                "nothing but scene and objects; a newer foveal wrote this pack: update foveal",
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
        if about.has_object_table() {
            let told = about.objects.len() + about.textures.len();
            if told > 0 {
                return Err(PackError::new(
                    "objects, textures",
                    told,
                    "none next to their table",
                ));
            }
            return about.check_rest().map(|()| about);
        }
        about.check()?;
        Ok(about)
    }

    /// Whether its objects and textures lie in a side table.
    pub(super) fn has_object_table(&self) -> bool {
        self.needs.iter().any(|need| need == OBJECTS)
    }

    /// Triangles, points and texels at the finest level, each once.
    #[must_use]
    pub fn finest_samples(&self) -> u64 {
        let of_kinds = UnitKind::ALL.map(|kind| self.finest_samples_of(kind));
        of_kinds.into_iter().fold(0, u64::saturating_add)
    }

    /// The same of one kind.
    #[must_use]
    pub fn finest_samples_of(&self, kind: UnitKind) -> u64 {
        let texels = |it: &SceneTexture| it.size.map(u64::from).iter().product::<u64>();
        let textures = self.textures.iter().filter(|_| kind == UnitKind::Image);
        let objects = self.objects.iter().filter(|it| it.shape.kind() == kind);
        let samples = objects.map(|it| it.shape.samples());
        samples
            .chain(textures.map(texels))
            .fold(0, u64::saturating_add)
    }

    /// Samples of a kind of objects at the finest level, each as often as it stands there.
    #[must_use]
    pub fn samples_of(&self, kind: UnitKind) -> u64 {
        let objects = self.objects.iter().filter(|it| it.shape.kind() == kind);
        objects
            .map(|it| {
                it.shape
                    .samples()
                    .saturating_mul(it.placements.len() as u64)
            })
            .fold(0, u64::saturating_add)
    }

    pub(super) fn check(&self) -> Result<(), PackError> {
        within("objects", self.objects.len(), MOST_OBJECTS)?;
        within("textures", self.textures.len() + 1, MOST_TEXTURES + 1)?;
        self.textures.iter().try_for_each(SceneTexture::check)?;
        let textures = self.textures.len();
        self.objects.iter().try_for_each(|it| it.check(textures))?;
        self.check_rest()
    }

    /// All but objects and textures.
    fn check_rest(&self) -> Result<(), PackError> {
        within("units", self.units.len(), MOST_LEVELS)?;
        if self.units.last() == Some(&0) {
            return Err(PackError::new("units", "no roots", "at least one"));
        }
        within("page", self.page as usize, 1 << 12)?;
        self.look.check()
    }
}

fn within(field: &str, found: usize, most: usize) -> Result<(), PackError> {
    match (1..=most).contains(&found) {
        true => Ok(()),
        false => Err(PackError::new(field, found, format!("1 to {most}"))),
    }
}

impl SceneTexture {
    fn check(&self) -> Result<(), PackError> {
        let wrong = |field: &str, found: String, expected: &str| {
            Err(PackError::new(
                &format!("textures.{field}"),
                found,
                expected,
            ))
        };
        if !self.size.iter().all(|side| (1..=MOST_SIDE).contains(side)) {
            return wrong("size", format!("{:?}", self.size), "1 to 16384 each");
        }
        let numbers = self.colour.iter().chain(&self.cutoff);
        match numbers.clone().all(|it| (0.0..=2.0).contains(it)) {
            true => Ok(()),
            false => wrong("colour, cutoff", format!("{self:?}"), "0 to 2"),
        }
    }
}

impl Texturing {
    fn check(&self, textures: usize) -> Result<(), PackError> {
        let wrong = |found: String, expected: String| {
            Err(PackError::new("objects.texturing", found, expected))
        };
        let count = self.textures.len();
        if !(1..=MOST_TEXTURES_OF_OBJECT).contains(&count) {
            return wrong(format!("{count} textures"), "1 to 254".to_owned());
        }
        if let Some(beyond) = self
            .textures
            .iter()
            .find(|it| usize::from(**it) >= textures)
        {
            return wrong(
                format!("texture {beyond}"),
                format!("fewer than {textures}"),
            );
        }
        let mut numbers = self.origin.iter().chain(&self.step);
        match numbers.all(|it| it.abs() <= 1e9) {
            true => Ok(()),
            false => wrong(format!("{self:?}"), "numbers of at most 1e9".to_owned()),
        }
    }
}

impl SceneObject {
    fn check(&self, textures: usize) -> Result<(), PackError> {
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
        let ObjectBounds {
            centre,
            radius,
            half,
        } = self.bounds;
        if !((0.0..=1e15).contains(&radius) && centre.iter().all(|it| it.abs() <= 1e15)) {
            return wrong("bounds", format!("{:?}", self.bounds), "a finite sphere");
        }
        if !half.iter().all(|it| (0.0..=1e15).contains(it)) {
            return wrong("bounds", format!("{:?}", self.bounds), "a finite box");
        }
        if self.placements.is_empty() {
            return wrong("placements", "none".to_owned(), "at least one");
        }
        let is_finite = |it: &&f64| it.abs() <= 1e15;
        if !self.placements.iter().flatten().all(|it| is_finite(&it)) {
            return wrong("placements", "too large".to_owned(), "finite numbers");
        }
        if let Shape::Cloud(cloud) = &self.shape {
            cloud.check()?;
        }
        if !self.colour.iter().all(|it| (0.0..=1.0).contains(it)) {
            return wrong("colour", format!("{:?}", self.colour), "0 to 1");
        }
        match (&self.texturing, self.attributes.textured) {
            (Some(texturing), true) => texturing.check(textures),
            (None, false) => Ok(()),
            (there, _) => wrong(
                "texturing",
                format!("{there:?}"),
                "as attributes.textured says",
            ),
        }
    }
}

#[cfg(test)]
mod tests;
