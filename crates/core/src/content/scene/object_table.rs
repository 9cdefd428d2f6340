//! What stands in a scene of many objects, where a description would be too long for it?
//!
//! The side tables `objects`, which a reader needs, and `names`, which is for people;
//! `docs/formats/pack.md` is normative.

use super::description::{
    Grid, MOST_OBJECTS, OBJECTS, ObjectBounds, SceneObject, SceneTexture, Shape, Texturing,
};
use crate::content::bits::{push_varint, read_varint};
use crate::content::images::wrap::Wrap;
use crate::content::mesh::payload::Attributes;
use crate::content::points::cloud::Cloud;
use crate::content::points::payload::PointAttributes;
use crate::pack::PackError;
use std::collections::HashMap;
use std::hash::Hash;

/// Version of the layout of the table of objects.
pub const OBJECTS_VERSION: u32 = 1;

/// Name of the side table of names.
pub const NAMES: &str = "names";
/// Version of its layout.
pub const NAMES_VERSION: u32 = 1;

const NORMALS: u8 = 1;
const COLOURS: u8 = 2;
const TEXTURED: u8 = 4;
const TWO_SIDED: u8 = 8;
const UNLIT: u8 = 16;
const POINTS: u8 = 32;

const INTENSITIES: u8 = 2;
const CLASSES: u8 = 4;

/// What lies outside a texture, by the number that stands for it.
const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

/// The table of these objects and textures.
#[must_use]
pub fn write_objects(objects: &[SceneObject], textures: &[SceneTexture]) -> Vec<u8> {
    let (mut looks, mut turns) = (Numbered::default(), Numbered::default());
    let mut rows = Vec::new();
    for object in objects {
        write_object(object, (&mut looks, &mut turns), &mut rows);
    }
    let mut bytes = Vec::new();
    for count in [
        objects.len(),
        textures.len(),
        looks.all.len(),
        turns.all.len(),
    ] {
        bytes.extend((count as u32).to_le_bytes());
    }
    looks.all.iter().for_each(|look| bytes.extend(look));
    turns.all.iter().for_each(|turn| bytes.extend(turn));
    bytes.extend(rows);
    for texture in textures {
        write_text(&texture.name, &mut bytes);
        bytes.extend(texture.size.iter().flat_map(|it| it.to_le_bytes()));
        let wrap = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => 0,
            Wrap::Mirror => 1,
            Wrap::Clamp => 2,
        });
        bytes.extend([wrap[0] | wrap[1] << 4, u8::from(texture.cutoff.is_some())]);
        singles(&texture.colour, &mut bytes);
        singles(&[texture.cutoff.unwrap_or_default()], &mut bytes);
    }
    bytes
}

/// Values by numbers in the order in which they were first met.
struct Numbered<T> {
    all: Vec<T>,
    number_of: HashMap<T, u32>,
}

impl<T> Default for Numbered<T> {
    fn default() -> Self {
        Self {
            all: Vec::new(),
            number_of: HashMap::new(),
        }
    }
}

impl<T: Clone + Eq + Hash> Numbered<T> {
    fn number(&mut self, value: T) -> u32 {
        let next = self.all.len() as u32;
        let number = *self.number_of.entry(value.clone()).or_insert(next);
        if number == next {
            self.all.push(value);
        }
        number
    }
}

fn write_text(text: &str, bytes: &mut Vec<u8>) {
    push_varint(bytes, text.len() as u32);
    bytes.extend(text.as_bytes());
}

fn doubles(numbers: &[f64], bytes: &mut Vec<u8>) {
    bytes.extend(numbers.iter().flat_map(|it| it.to_le_bytes()));
}

fn singles(numbers: &[f32], bytes: &mut Vec<u8>) {
    bytes.extend(numbers.iter().flat_map(|it| it.to_le_bytes()));
}

fn are_singles(numbers: &[f64]) -> bool {
    let is_single = |it: &f64| f64::from(*it as f32).to_bits() == it.to_bits();
    numbers.iter().all(is_single)
}

/// What an object has in common with others, as bytes.
fn look_of(object: &SceneObject) -> Vec<u8> {
    let Attributes {
        normals,
        colours,
        textured,
    } = object.attributes;
    let flags = [
        (normals, NORMALS),
        (colours, COLOURS),
        (textured, TEXTURED),
        (object.two_sided, TWO_SIDED),
        (object.unlit, UNLIT),
        (object.shape.cloud().is_some(), POINTS),
    ];
    let flags = flags.into_iter().filter(|it| it.0).map(|it| it.1).sum();
    let mut bytes = vec![flags, object.grid.bits];
    singles(&object.colour, &mut bytes);
    bytes
}

fn write_object(
    object: &SceneObject,
    (looks, turns): (&mut Numbered<Vec<u8>>, &mut Numbered<Vec<u8>>),
    bytes: &mut Vec<u8>,
) {
    push_varint(bytes, looks.number(look_of(object)));
    let leaf_triangles = match object.shape {
        Shape::Mesh { leaf_triangles } => leaf_triangles,
        Shape::Cloud(_) => 0,
    };
    bytes.extend(leaf_triangles.to_le_bytes());
    let ObjectBounds {
        centre,
        radius,
        half,
    } = object.bounds;
    doubles(&centre, bytes);
    singles(&[rounded_up(radius)], bytes);
    singles(&half.map(rounded_up), bytes);
    doubles(&object.grid.origin, bytes);
    doubles(&[object.grid.step], bytes);
    if let Some(texturing) = &object.texturing {
        bytes.push(texturing.textures.len() as u8);
        bytes.extend(texturing.textures.iter().flat_map(|it| it.to_le_bytes()));
        doubles(&texturing.origin, bytes);
        doubles(&texturing.step, bytes);
    }
    if let Shape::Cloud(cloud) = &object.shape {
        write_cloud(cloud, bytes);
    }
    push_varint(bytes, object.placements.len() as u32);
    for place in &object.placements {
        let (turn, away) = place.split_at(9);
        let mut turn_bytes = Vec::new();
        doubles(turn, &mut turn_bytes);
        let short = are_singles(away);
        push_varint(bytes, turns.number(turn_bytes) << 1 | u32::from(short));
        match short {
            true => away.iter().for_each(|it| singles(&[*it as f32], bytes)),
            false => doubles(away, bytes),
        }
    }
}

/// The next larger number of 32 bits, so that what is enclosed stays so.
fn rounded_up(number: f64) -> f32 {
    let near = number as f32;
    if f64::from(near) < number {
        near.next_up()
    } else {
        near
    }
}

fn write_cloud(cloud: &Cloud, bytes: &mut Vec<u8>) {
    bytes.extend(cloud.count.to_le_bytes());
    doubles(&cloud.scale, bytes);
    doubles(&cloud.offset, bytes);
    bytes.extend(cloud.least.iter().flat_map(|it| it.to_le_bytes()));
    let PointAttributes {
        colours,
        intensities,
        classes,
    } = cloud.attributes;
    let flags = [(colours, 1), (intensities, INTENSITIES), (classes, CLASSES)];
    let flags = flags.into_iter().filter(|it| it.0).map(|it| it.1).sum();
    bytes.extend([flags, cloud.colour_bits]);
    bytes.extend(cloud.colour_times.to_le_bytes());
    bytes.extend(cloud.most_intensity.to_le_bytes());
}

/// Reads the table: objects and textures. Memory is a small multiple of the table's bytes.
///
/// # Errors
/// It ends early, has bytes left over, or names what it does not have.
pub fn read_objects(bytes: &[u8]) -> Result<(Vec<SceneObject>, Vec<SceneTexture>), PackError> {
    let mut rest = Rest { bytes };
    let wrong = |what: String| {
        let found = "it ends early, or says what cannot be";
        PackError::new(
            &format!("table {OBJECTS}, {what}"),
            found,
            "as docs/formats/pack.md says",
        )
    };
    let head = || wrong("head".to_owned());
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = rest.word().ok_or_else(head)?;
    }
    let [objects, textures, looks, turns] = counts;
    if objects.max(textures) as usize > MOST_OBJECTS {
        return Err(head());
    }
    let looks = (0..looks).map(|_| rest.look());
    let looks: Vec<Look> = looks.collect::<Option<_>>().ok_or_else(head)?;
    let turns = (0..turns).map(|_| rest.doubles::<9>());
    let turns: Vec<[f64; 9]> = turns.collect::<Option<_>>().ok_or_else(head)?;
    let read = |number: u32| {
        let object = rest.object(&looks, &turns);
        object.ok_or_else(|| wrong(format!("object {number}")))
    };
    let objects = (0..objects).map(read).collect::<Result<Vec<_>, _>>()?;
    let read = |number: u32| {
        let texture = rest.texture();
        texture.ok_or_else(|| wrong(format!("texture {number}")))
    };
    let textures = (0..textures).map(read).collect::<Result<Vec<_>, _>>()?;
    match rest.bytes.len() {
        0 => Ok((objects, textures)),
        left => {
            let found = format!("{left} bytes behind its rows");
            Err(PackError::new(&format!("table {OBJECTS}"), found, "none"))
        }
    }
}

/// The table of the names of objects: of each its own, or those of the parts that it was joined of.
#[must_use]
pub fn write_names(objects: &[SceneObject], parts: &[Vec<String>]) -> Vec<u8> {
    let mut bytes = (objects.len() as u32).to_le_bytes().to_vec();
    for (number, object) in objects.iter().enumerate() {
        let own = core::slice::from_ref(&object.name);
        let parts = parts.get(number).map_or(own, Vec::as_slice);
        let names = if parts.is_empty() { own } else { parts };
        push_varint(&mut bytes, names.len() as u32);
        names.iter().for_each(|name| write_text(name, &mut bytes));
    }
    bytes
}

/// Reads the table of names: a list for each object. Memory is a small multiple of its bytes.
///
/// # Errors
/// It ends early, has bytes left over, or something that is no text.
pub fn read_names(bytes: &[u8]) -> Result<Vec<Vec<String>>, PackError> {
    let mut rest = Rest { bytes };
    let mut read = || -> Option<Vec<Vec<String>>> {
        let count = rest.word()?;
        let names = (0..count).map(|_| {
            let count = rest.varint()?;
            (0..count).map(|_| rest.text()).collect()
        });
        names.collect()
    };
    let names = read().filter(|_| rest.bytes.is_empty());
    names.ok_or_else(|| {
        let found = "bytes that are no lists of names";
        PackError::new(
            &format!("table {NAMES}"),
            found,
            "as docs/formats/pack.md says",
        )
    })
}

/// What objects have in common.
struct Look {
    flags: u8,
    bits: u8,
    colour: [f32; 4],
}

/// What of a table was not read yet.
struct Rest<'a> {
    bytes: &'a [u8],
}

impl Rest<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.bytes.split_first_chunk::<N>()?;
        self.bytes = rest;
        Some(*taken)
    }

    fn word(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn half(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    fn long(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    fn varint(&mut self) -> Option<u32> {
        let (number, rest) = read_varint(self.bytes)?;
        self.bytes = rest;
        Some(number)
    }

    fn doubles<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.take().map(f64::from_le_bytes)?;
        }
        Some(numbers)
    }

    fn singles<const N: usize>(&mut self) -> Option<[f32; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.take().map(f32::from_le_bytes)?;
        }
        Some(numbers)
    }

    fn text(&mut self) -> Option<String> {
        let length = self.varint()? as usize;
        let (text, rest) = self.bytes.split_at_checked(length)?;
        self.bytes = rest;
        core::str::from_utf8(text).ok().map(str::to_owned)
    }

    fn look(&mut self) -> Option<Look> {
        let [flags, bits] = self.take()?;
        let colour = self.singles()?;
        (flags < 2 * POINTS).then_some(Look {
            flags,
            bits,
            colour,
        })
    }

    fn object(&mut self, looks: &[Look], turns: &[[f64; 9]]) -> Option<SceneObject> {
        let look = looks.get(self.varint()? as usize)?;
        let has = |flag: u8| look.flags & flag != 0;
        let leaf_triangles = self.long()?;
        let bounds = ObjectBounds {
            centre: self.doubles()?,
            radius: self.singles::<1>()?[0].into(),
            half: self.singles::<3>()?.map(f64::from),
        };
        let grid = Grid {
            origin: self.doubles()?,
            step: self.doubles::<1>()?[0],
            bits: look.bits,
        };
        let texturing = if has(TEXTURED) {
            Some(self.texturing()?)
        } else {
            None
        };
        let shape = if has(POINTS) {
            Shape::Cloud(self.cloud()?)
        } else {
            Shape::Mesh { leaf_triangles }
        };
        let count = self.varint()?;
        let placements = (0..count).map(|_| self.placement(turns));
        Some(SceneObject {
            name: String::new(),
            shape,
            bounds,
            grid,
            attributes: Attributes {
                normals: has(NORMALS),
                colours: has(COLOURS),
                textured: has(TEXTURED),
            },
            colour: look.colour,
            two_sided: has(TWO_SIDED),
            unlit: has(UNLIT),
            placements: placements.collect::<Option<_>>()?,
            texturing,
        })
    }

    fn placement(&mut self, turns: &[[f64; 9]]) -> Option<[f64; 12]> {
        let told = self.varint()?;
        let turn = turns.get((told >> 1) as usize)?;
        let away = match told & 1 {
            1 => self.singles::<3>()?.map(f64::from),
            _ => self.doubles::<3>()?,
        };
        let mut place = [0.0; 12];
        place[..9].copy_from_slice(turn);
        place[9..].copy_from_slice(&away);
        Some(place)
    }

    fn texturing(&mut self) -> Option<Texturing> {
        let [count] = self.take()?;
        let textures = (0..count).map(|_| self.half());
        Some(Texturing {
            textures: textures.collect::<Option<_>>()?,
            origin: self.doubles()?,
            step: self.doubles()?,
        })
    }

    fn cloud(&mut self) -> Option<Cloud> {
        let (count, scale, offset) = (self.long()?, self.doubles()?, self.doubles()?);
        let mut least = [0; 3];
        for along in &mut least {
            *along = self.take().map(i64::from_le_bytes)?;
        }
        let [flags, colour_bits] = self.take()?;
        Some(Cloud {
            count,
            scale,
            offset,
            least,
            attributes: PointAttributes {
                colours: flags & 1 != 0,
                intensities: flags & INTENSITIES != 0,
                classes: flags & CLASSES != 0,
            },
            colour_bits,
            colour_times: self.half()?,
            most_intensity: self.half()?,
        })
    }

    fn texture(&mut self) -> Option<SceneTexture> {
        let name = self.text()?;
        let size = [self.word()?, self.word()?];
        let [wrap, cut] = self.take()?;
        let wrap = [wrap & 15, wrap >> 4].map(|it| WRAPS.get(usize::from(it)).copied());
        let colour = self.singles()?;
        let [cutoff] = self.singles()?;
        Some(SceneTexture {
            name,
            size,
            wrap: [wrap[0]?, wrap[1]?],
            colour,
            cutoff: (cut != 0).then_some(cutoff),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DAffine3, DVec3};

    fn object(number: u32) -> SceneObject {
        let along = f64::from(number);
        let mut turned = DAffine3::from_rotation_y(along / 7.0);
        turned.translation = DVec3::new(along / 3.0, 1.0, -2.0);
        let places = [
            DAffine3::from_translation(DVec3::new(along, 0.5, -2.0)),
            turned,
        ];
        SceneObject {
            name: String::new(),
            shape: match number {
                3 => Shape::Cloud(Cloud {
                    least: [-5, 1 << 33, 7],
                    most_intensity: 900,
                    ..Cloud::default()
                }),
                _ => Shape::Mesh {
                    leaf_triangles: u64::from(number) << 33,
                },
            },
            bounds: ObjectBounds {
                centre: [along, 1e7 + 0.1, -3.0],
                radius: 0.5,
                half: [0.25, 0.0, 0.5],
            },
            grid: Grid {
                origin: [1e7 + 0.1, along, 0.0],
                step: 0.1,
                bits: 14,
            },
            attributes: Attributes {
                normals: number.is_multiple_of(2),
                colours: number.is_multiple_of(3),
                textured: number == 4,
            },
            colour: [0.1, 0.2, 0.3, 1.0],
            two_sided: number.is_multiple_of(5),
            unlit: number.is_multiple_of(7),
            placements: places.iter().map(DAffine3::to_cols_array).collect(),
            texturing: (number == 4).then(|| Texturing {
                textures: vec![1, 0],
                origin: [0.1, -2.0],
                step: [1e-3, 2e-3],
            }),
        }
    }

    fn texture(number: u32) -> SceneTexture {
        SceneTexture {
            name: format!("wood {number}"),
            size: [1024, 1 + number],
            wrap: [Wrap::Clamp, Wrap::Mirror],
            colour: [0.5, 0.25, 0.125],
            cutoff: (number == 1).then_some(0.5),
        }
    }

    #[test]
    fn objects_and_textures_come_back_as_they_were_written() {
        let objects: Vec<_> = (0..30).map(object).collect();
        let textures: Vec<_> = (0..2).map(texture).collect();
        let table = write_objects(&objects, &textures);
        assert_eq!(read_objects(&table).unwrap(), (objects, textures));
    }

    #[test]
    fn names_come_back_and_no_table_of_them_panics() {
        let mut objects: Vec<_> = (0..3).map(object).collect();
        objects[1].name = "wall é".to_owned();
        let parts = [vec![], vec![], vec!["a".to_owned(), String::new()]];
        let table = write_names(&objects, &parts);
        let expected = [vec![""], vec!["wall é"], vec!["a", ""]];
        assert_eq!(read_names(&table).unwrap(), expected);
        for place in 0..table.len() {
            assert!(read_names(&table[..place]).is_err());
            let mut bad = table.clone();
            bad[place] ^= 0xff;
            let _ = read_names(&bad);
        }
    }

    #[test]
    fn what_is_enclosed_stays_enclosed() {
        let mut one = object(1);
        (one.bounds.radius, one.bounds.half) = (0.1, [1.0 / 3.0, 2.0 / 3.0, 0.0]);
        let (back, _) = read_objects(&write_objects(core::slice::from_ref(&one), &[])).unwrap();
        let [own, back] = [one.bounds, back[0].bounds];
        assert!(back.radius >= own.radius && back.radius < own.radius * 1.000_001);
        assert!((0..3).all(|k| back.half[k] >= own.half[k]));
    }

    #[test]
    fn no_table_panics_or_takes_more_memory_than_its_bytes_allow() {
        let objects: Vec<_> = (0..6).map(object).collect();
        let good = write_objects(&objects, &[texture(0), texture(1)]);
        for place in 0..good.len() {
            assert!(read_objects(&good[..place]).is_err(), "cut at {place}");
            for bits in [1, 0x80, 0xff] {
                let mut bad = good.clone();
                bad[place] ^= bits;
                let _ = read_objects(&bad);
            }
        }
        assert!(read_objects(&[good, vec![0]].concat()).is_err());
        assert!(read_objects(&[0xff; 16]).is_err());
    }
}
