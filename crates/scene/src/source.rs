//! What was read of 3D files?

use foveal_core::content::images::wrap::Wrap;
use foveal_core::content::scene::description::Backdrop;
use foveal_core::units::one_line;
use glam::{DAffine2, DAffine3, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Most missing pictures that are named.
const MOST_MISSING_NAMED: u64 = 8;

/// A scene as its files describe it: nothing is simplified or put on a grid yet.
#[derive(Clone, Debug, Default)]
pub struct SourceScene {
    /// What stands in the scene.
    pub objects: Vec<SourceObject>,
    /// The meshes that objects show.
    pub meshes: Vec<SourceMesh>,
    /// The clouds of points that stand in the scene next to objects.
    pub clouds: Vec<SourceCloud>,
    /// What surfaces look like; triangles name them by number.
    pub materials: Vec<Material>,
    /// Pictures on surfaces; materials name them by number.
    pub images: Vec<SourceImage>,
    /// What was repaired or left out on reading, by name.
    pub repairs: Repairs,
    /// What is seen where nothing stands, in linear light; `None` where no file says it.
    pub background: Option<[f32; 3]>,
    /// Where light comes from, in the world; `None` where no file says it.
    pub light: Option<DVec3>,
    /// What a person should know: what of a file's looks is not drawn.
    pub remarks: Vec<String>,
    /// Bytes of all files that were read, with those that they name.
    pub bytes: u64,
    /// SHA-256 of each of these files, in hexadecimal, in the order in which they were read.
    pub hashes: Vec<String>,
}

impl SourceScene {
    /// Whether nothing stands in it.
    pub(crate) fn is_empty(&self) -> bool {
        self.objects.is_empty() && self.clouds.is_empty()
    }

    /// The places of each thing that stands in it.
    pub(crate) fn placements(&self) -> impl Iterator<Item = &Vec<DAffine3>> {
        let objects = self.objects.iter().map(|it| &it.placements);
        objects.chain(self.clouds.iter().map(|it| &it.placements))
    }

    /// The same, to be changed.
    pub(crate) fn placements_mut(&mut self) -> impl Iterator<Item = &mut Vec<DAffine3>> {
        let objects = self.objects.iter_mut().map(|it| &mut it.placements);
        objects.chain(self.clouds.iter_mut().map(|it| &mut it.placements))
    }

    /// For each thing, in the same order, its name and how far from the origin of its space it
    /// reaches along each axis, at most.
    pub(crate) fn reaches(&self) -> impl Iterator<Item = (&str, DVec3)> {
        let reach = |mesh: &SourceMesh| {
            let all = mesh.positions.iter();
            all.fold(DVec3::ZERO, |reach, position| reach.max(position.abs()))
        };
        let reach: Vec<DVec3> = self.meshes.iter().map(reach).collect();
        let objects = self.objects.iter();
        let objects = objects.map(move |it| (it.name.as_str(), reach[it.mesh]));
        objects.chain(self.clouds.iter().map(|it| (it.name.as_str(), it.reach())))
    }

    /// Where each vertex and point is in the world, wherever it stands.
    pub(crate) fn places(&self) -> impl Iterator<Item = DVec3> {
        let objects = self.objects.iter().flat_map(|object| {
            let positions = &self.meshes[object.mesh].positions;
            let each = move |it: &DAffine3| {
                let it = *it;
                positions.iter().map(move |at| it.transform_point3(*at))
            };
            object.placements.iter().flat_map(each)
        });
        let clouds = self.clouds.iter().flat_map(|cloud| {
            let each = move |it: &DAffine3| {
                let it = *it;
                (0..cloud.places.len()).map(move |at| it.transform_point3(cloud.at(at)))
            };
            cloud.placements.iter().flat_map(each)
        });
        objects.chain(clouds)
    }

    /// Puts all of another scene next to what stands here.
    pub(crate) fn append(&mut self, other: Self) {
        let (meshes, materials) = (self.meshes.len(), self.materials.len());
        let images = self.images.len();
        self.objects
            .extend(other.objects.into_iter().map(|object| SourceObject {
                mesh: object.mesh + meshes,
                ..object
            }));
        self.meshes.extend(other.meshes.into_iter().map(|mut mesh| {
            mesh.shift_materials(materials as u32);
            mesh
        }));
        self.clouds.extend(other.clouds);
        self.materials
            .extend(other.materials.into_iter().map(|mut material| {
                if let Some(texture) = &mut material.texture {
                    texture.image += images;
                }
                material
            }));
        self.images.extend(other.images);
        self.hashes.extend(other.hashes);
        for (name, times) in other.repairs {
            *self.repairs.entry(name).or_default() += times;
        }
        for remark in other.remarks {
            self.remark(remark);
        }
        self.background = other.background.or(self.background);
        self.light = other.light.or(self.light);
        self.bytes += other.bytes;
    }

    /// What is round its objects, as far as files say it.
    #[must_use]
    pub fn look(&self) -> Backdrop {
        let usual = Backdrop::default();
        Backdrop {
            background: self.background.unwrap_or(usual.background),
            light: self.light.map_or(usual.light, |light| light.to_array()),
        }
    }

    /// Says something that a person should know, once.
    pub(crate) fn remark(&mut self, remark: impl Into<String>) {
        let remark = one_line(&remark.into());
        if !self.remarks.contains(&remark) {
            self.remarks.push(remark);
        }
    }

    /// Counts a picture that is not there, and says which of the first ones and why.
    pub(crate) fn missing_picture(&mut self, name: &str, reason: &str) {
        let missing = self.repairs.entry("missing_images".to_owned()).or_default();
        *missing += 1;
        if *missing <= MOST_MISSING_NAMED {
            let name = one_line(&name.chars().take(80).collect::<String>());
            self.remark(format!(
                "the picture \"{name}\" is missing: {reason}; surfaces have their colour alone"
            ));
        }
    }

    /// Leaves out meshes without triangles, the objects that show them, and clouds without points.
    pub(crate) fn leave_out_empty(&mut self) {
        self.clouds.retain(|cloud| !cloud.places.is_empty());
        let mut next = 0;
        let number: Vec<Option<usize>> = self
            .meshes
            .iter()
            .map(|mesh| {
                let number = (!mesh.triangles.is_empty()).then_some(next);
                next += usize::from(number.is_some());
                number
            })
            .collect();
        self.meshes.retain(|mesh| !mesh.triangles.is_empty());
        self.objects.retain_mut(|object| {
            let kept = number[object.mesh];
            object.mesh = kept.unwrap_or(object.mesh);
            kept.is_some()
        });
    }
}

/// How often something was repaired or left out, by a short name in snake case, such as
/// `zero_area_triangles`.
pub type Repairs = BTreeMap<String, u64>;

/// A mesh and the places where it stands.
#[derive(Clone, Debug)]
pub struct SourceObject {
    /// Its name in the file, or one made of the file's name.
    pub name: String,
    /// Number of its mesh.
    pub mesh: usize,
    /// World from mesh: right-handed, y up, metres; at least one.
    pub placements: Vec<DAffine3>,
}

/// A mesh of triangles. Vertices that differ in anything else share their position
/// exactly, so that the surface is closed where the file's is.
#[derive(Clone, Debug, Default)]
pub struct SourceMesh {
    /// Positions of vertices, in the mesh's own space; finite.
    pub positions: Vec<DVec3>,
    /// Unit normals, one a vertex; empty where the file has none: faces are flat then.
    pub normals: Vec<[f32; 3]>,
    /// Colours, one a vertex: linear light, red, green, blue and alpha from 0 to 1; empty where the
    /// file has none.
    pub colours: Vec<[f32; 4]>,
    /// Places on the material's texture, one a vertex: [0, 0] is its top left and [1, 1] its bottom
    /// right corner; finite; empty where the file has none.
    pub uvs: Vec<[f32; 2]>,
    /// Triangles by numbers of vertices, all in range, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The material of each triangle; empty where all have material 0 of the scene, or there is
    /// none.
    pub materials: Vec<u32>,
}

impl SourceMesh {
    /// Keeps the triangles that are marked, and the vertices of them.
    pub(crate) fn keep_triangles(&mut self, stays: &[bool]) {
        keep(&mut self.triangles, stays);
        keep(&mut self.materials, stays);
        self.leave_out_unused_vertices();
    }

    /// Leaves out vertices that no triangle names; gives how many.
    pub(crate) fn leave_out_unused_vertices(&mut self) -> usize {
        let mut used = vec![false; self.positions.len()];
        for vertex in self.triangles.iter().flatten() {
            used[*vertex as usize] = true;
        }
        let unused = used.iter().filter(|used| !**used).count();
        if unused == 0 {
            return 0;
        }
        let mut next = 0;
        let number: Vec<u32> = used
            .iter()
            .map(|used| {
                let number = next;
                next += u32::from(*used);
                number
            })
            .collect();
        for vertex in self.triangles.iter_mut().flatten() {
            *vertex = number[*vertex as usize];
        }
        keep(&mut self.positions, &used);
        keep(&mut self.normals, &used);
        keep(&mut self.colours, &used);
        keep(&mut self.uvs, &used);
        unused
    }

    /// Makes room for other materials before those of this mesh.
    fn shift_materials(&mut self, by: u32) {
        if by == 0 {
            return;
        }
        self.materials.resize(self.triangles.len(), 0);
        for material in &mut self.materials {
            *material += by;
        }
    }
}

/// Keeps what is marked; of an empty list, nothing is to be kept.
pub(crate) fn keep<T>(list: &mut Vec<T>, stays: &[bool]) {
    let mut marks = stays.iter();
    list.retain(|_| marks.next().copied().unwrap_or(false));
}

/// A cloud of points on a grid, and the places where it stands. A point lies, along each axis, at
/// its place times the scale and the offset from 0.
#[derive(Clone, Debug, Default)]
pub struct SourceCloud {
    /// Its name in the file, or one made of the file's name.
    pub name: String,
    /// World from cloud: right-handed, y up, metres; at least one.
    pub placements: Vec<DAffine3>,
    /// Length of a step along each axis; positive.
    pub scale: [f64; 3],
    /// Where places are 0.
    pub offset: [f64; 3],
    /// The place of each point.
    pub places: Vec<[i32; 3]>,
    /// Red, green and blue of each point, as codes of sixteen bits, or of eight bits times 1, 256
    /// or 257; empty where the file has none.
    pub colours: Vec<[u16; 3]>,
    /// How much light came back from each point; empty where the file has none.
    pub intensities: Vec<u16>,
    /// What each point lies on, as the file counts it; empty where the file has none.
    pub classes: Vec<u8>,
}

impl SourceCloud {
    /// A cloud of points that lie anywhere, put on a grid of their own: half a step off at most, a
    /// step being a power of two and at most a 2^20th of the longest side.
    pub(crate) fn on_grid(name: &str, positions: &[DVec3]) -> Self {
        let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (least, most) = positions
            .iter()
            .fold(none, |(least, most), it| (least.min(*it), most.max(*it)));
        let side = (most - least).max_element();
        let is_extended = side.is_finite() && side > 1e-290;
        let step = if is_extended {
            (side.log2().floor() - 20.0).exp2()
        } else {
            1.0
        };
        // Half a step off a corner of the grid nothing is cut off.
        let origin = if positions.is_empty() {
            DVec3::ZERO
        } else {
            (least / step).floor() * step
        };
        let place = |it: &DVec3| {
            ((*it - origin) / step)
                .round()
                .to_array()
                .map(|it| it as i32)
        };
        Self {
            name: name.to_owned(),
            placements: vec![DAffine3::IDENTITY],
            scale: [step; 3],
            offset: origin.to_array(),
            places: positions.iter().map(place).collect(),
            ..Self::default()
        }
    }

    /// Where a point lies.
    pub(crate) fn at(&self, number: usize) -> DVec3 {
        self.of_place(self.places[number])
    }

    /// Where a place of its grid lies.
    pub(crate) fn of_place(&self, place: [i32; 3]) -> DVec3 {
        let along = |k: usize| f64::from(place[k]) * self.scale[k] + self.offset[k];
        DVec3::from_array([0, 1, 2].map(along))
    }

    /// How far from the origin of its space a point is along each axis, at most.
    pub(crate) fn reach(&self) -> DVec3 {
        let most = self.places.iter().fold([0.0_f64; 3], |most, it| {
            [0, 1, 2].map(|k| most[k].max(f64::from(it[k]).abs()))
        });
        DVec3::from_array([0, 1, 2].map(|k| most[k] * self.scale[k] + self.offset[k].abs()))
    }
}

/// What a surface looks like.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file.
    pub name: String,
    /// Linear light, red, green, blue and alpha, multiplied with colours of vertices.
    pub colour: [f32; 4],
    /// Whether it is seen from both sides.
    pub two_sided: bool,
    /// Whether no light falls on it.
    pub unlit: bool,
    /// What its colour is multiplied with.
    pub texture: Option<MaterialTexture>,
}

/// How a material shows a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialTexture {
    /// Number of the picture.
    pub image: usize,
    /// What lies outside it.
    pub wrap: [Wrap; 2],
    /// Places on the picture from those of vertices.
    pub picture_from_uv: DAffine2,
    /// Where the picture's alpha is less, nothing is drawn; without, all of it is.
    pub cutoff: Option<f32>,
}

/// A picture as its file has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SourceImage {
    /// Its name, for people.
    pub name: String,
    /// Bytes of a JPEG or PNG; what is neither, or broken, is left out when units are built.
    pub bytes: Arc<[u8]>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            colour: [1.0; 4],
            two_sided: false,
            unlit: false,
            texture: None,
        }
    }
}
