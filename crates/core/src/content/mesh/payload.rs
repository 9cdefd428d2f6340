//! What do the bytes of a unit of a mesh say?
//!
//! A unit holds the fine clusters of one group and the vertices that lie inside it: each vertex of
//! a mesh is sent once. The vertices that stay when the group is simplified are those of the
//! coarse clusters, which came with units before; the table of units lists them.
//! Normative: docs/formats/pack.md.
//!
//! In order, numbers little-endian:
//!
//! 1. Head: a byte with the version in its high four bits and which attributes there are in its low
//!    ones (1: normals, 2: colours, 4: textures); the number of clusters, a byte; the number of
//!    staying vertices and that of new ones, two bytes each.
//! 2. For each cluster: the number of its vertices, that of its triangles, and the length of its
//!    stream: in one byte, or in two, of which the first adds 128 to the low seven bits.
//! 3. For each cluster its triangles: meshoptimizer's meshlet codec, without vertices.
//! 4. Bits, lowest first, up to a whole byte: which vertices clusters have, and where new ones lie,
//!    as `payload/vertices.rs` says.
//! 5. Normals and colours: meshoptimizer's vertex codec, four bytes of each that there is; of
//!    textures eight: the place, two bytes along each axis, which texture, and three zeros.

mod cluster;
#[cfg(test)]
mod tests;
mod vertices;

use crate::content::bits::{BitReader, BitWriter};
use crate::content::scene::part_ref::{MOST_PARTS, PartRef};
use crate::pack::PackError;
use cluster::wrong;
pub use cluster::{Cluster, MOST_OF_CLUSTER, MeshVertex, NO_TEXTURE};
use meshoptimizer_rs::codec::{
    VertexEncoding, decode_meshlet_into, decode_vertex_buffer_into, encode_meshlet,
    encode_vertex_buffer,
};
use meshoptimizer_rs::{Error, Workspace};

/// Version of the layout.
const VERSION: u8 = 2;
/// Bytes before the list of replaced clusters.
const HEAD_BYTES: usize = 6;
/// Most clusters of a unit.
pub const MOST_CLUSTERS: usize = MOST_PARTS;

/// What one unit says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MeshUnit {
    /// The coarse clusters in whose place these are shown; of a root none.
    pub replaces: Vec<PartRef>,
    /// Number of vertices that stay: those of the replaced clusters, each once, in the order in
    /// which they are first named.
    pub staying: u16,
    /// The vertices that lie inside the group.
    pub vertices: Vec<MeshVertex>,
    /// The fine clusters.
    pub clusters: Vec<Cluster>,
}

/// What vertices of an object have in addition to a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Attributes {
    /// Normals; without, faces are flat.
    pub normals: bool,
    /// Colours; without, the object's own.
    pub colours: bool,
    /// Places on textures.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub textured: bool,
}

impl Attributes {
    fn flags(self) -> u8 {
        u8::from(self.normals) | u8::from(self.colours) << 1 | u8::from(self.textured) << 2
    }

    /// Bytes of a vertex's attributes, before they are compressed.
    fn stride(self) -> usize {
        // The codec takes multiples of four.
        let [normals, colours, textured] =
            [self.normals, self.colours, self.textured].map(usize::from);
        4 * (normals + colours + 2 * textured)
    }
}

impl MeshUnit {
    /// Whether all vertices have textures of an object that has so many: a reader looks them up.
    pub(crate) fn check_textures(&self, count: usize) -> Result<(), PackError> {
        let is_known = |it: &u8| *it == NO_TEXTURE || usize::from(*it) < count;
        match self.vertices.iter().find(|it| !is_known(&it.texture)) {
            None => Ok(()),
            Some(vertex) => {
                let expected = format!("fewer than {count}");
                Err(PackError::new("texture", vertex.texture, expected))
            }
        }
    }

    /// The unit as bytes, of an object whose vertices have these attributes.
    ///
    /// # Errors
    /// More clusters, vertices or triangles than a unit can hold.
    pub fn write(&self, attributes: Attributes) -> Result<Vec<u8>, PackError> {
        let counts = [self.replaces.len(), self.clusters.len()];
        let most =
            |what: &str, found: usize, most: usize| wrong(what, found, format!("at most {most}"));
        if let Some(count) = counts.iter().find(|count| **count > MOST_CLUSTERS) {
            return Err(most("clusters", *count, MOST_CLUSTERS));
        }
        let new = u16::try_from(self.vertices.len());
        let new = new.map_err(|_| most("vertices", self.vertices.len(), usize::from(u16::MAX)))?;
        let mut bytes = vec![VERSION << 4 | attributes.flags(), counts[1] as u8];
        bytes.extend(self.staying.to_le_bytes());
        bytes.extend(new.to_le_bytes());
        let mut workspace = Workspace::default();
        let mut streams = Vec::new();
        let mut clusters = Vec::with_capacity(self.clusters.len());
        for cluster in &self.clusters {
            let sides = [cluster.vertices.len(), cluster.triangles.len()];
            if let Some(side) = sides.iter().find(|side| **side > MOST_OF_CLUSTER) {
                return Err(most("cluster", *side, MOST_OF_CLUSTER));
            }
            let corners = cluster.triangles.as_flattened();
            if let Some(corner) = corners.iter().find(|it| usize::from(**it) >= sides[0]) {
                return Err(wrong("corner", corner, format!("fewer than {}", sides[0])));
            }
            let stream = encode_meshlet(&[], corners, &mut workspace).map_err(refused)?;
            let sides = sides.map(|side| side as u8);
            bytes.extend(sides);
            write_length(stream.len(), &mut bytes);
            // Places are predicted along triangles, and the codec may turn these: as they are read.
            let Cluster { triangles, .. } = parse_cluster(sides, &stream, &mut workspace)?;
            clusters.push(Cluster {
                vertices: cluster.vertices.clone(),
                triangles,
            });
            streams.extend(stream);
        }
        bytes.extend(streams);
        let places: Vec<_> = self.vertices.iter().map(|it| it.place).collect();
        let mut writer = BitWriter::default();
        vertices::write_names(&clusters, self.staying, &mut writer);
        vertices::write_places(&clusters, self.staying, &places, &mut writer);
        bytes.extend(writer.finish());
        bytes.extend(self.write_attributes(attributes, &mut workspace)?);
        Ok(bytes)
    }

    fn write_attributes(
        &self,
        attributes: Attributes,
        workspace: &mut Workspace,
    ) -> Result<Vec<u8>, PackError> {
        let (count, stride) = (self.vertices.len(), attributes.stride());
        if count * stride == 0 {
            return Ok(Vec::new());
        }
        let mut raw = Vec::with_capacity(count * stride);
        for vertex in &self.vertices {
            if attributes.normals {
                raw.extend(vertex.normal.map(|it| it as u8));
                raw.extend([0; 2]);
            }
            if attributes.colours {
                raw.extend(vertex.colour);
            }
            if attributes.textured {
                raw.extend(vertex.uv.iter().flat_map(|it| it.to_le_bytes()));
                raw.extend([vertex.texture, 0, 0, 0]);
            }
        }
        let encoding = VertexEncoding::DEFAULT;
        encode_vertex_buffer(&raw, count, stride, encoding, workspace).map_err(refused)
    }

    /// Reads the unit of an object whose vertices have these attributes, which is shown in place of
    /// these clusters.
    ///
    /// Every number of a cluster is in range then; whether the replaced clusters exist shows where
    /// they are looked up. Takes at most some hundred bytes for each byte that is read.
    ///
    /// # Errors
    /// The bytes are no such unit.
    pub fn parse(
        bytes: &[u8],
        attributes: Attributes,
        replaces: &[PartRef],
    ) -> Result<Self, PackError> {
        let mut reader = Reader { bytes };
        let head = reader.take(HEAD_BYTES, "head")?;
        if head[0] >> 4 != VERSION {
            return Err(wrong("version", head[0] >> 4, VERSION));
        }
        if head[0] & 15 != attributes.flags() {
            return Err(wrong("attributes", head[0] & 15, attributes.flags()));
        }
        let clusters = usize::from(head[1]);
        if clusters.max(replaces.len()) > MOST_CLUSTERS {
            return Err(wrong(
                "clusters",
                clusters.max(replaces.len()),
                "at most 16",
            ));
        }
        let [staying, new] = [2, 4].map(|at| u16::from_le_bytes([head[at], head[at + 1]]));
        let mut workspace = Workspace::default();
        let mut clusters = parse_clusters(&mut reader, clusters, &mut workspace)?;
        let mut bits = BitReader::new(reader.bytes);
        vertices::read_names(&mut clusters, [staying, new], &mut bits)?;
        let places = vertices::read_places(&clusters, [staying, new], &mut bits)?;
        let rest = bits.rest();
        let rest = rest.ok_or_else(|| wrong("vertices", "the end", "more bytes"))?;
        Ok(Self {
            replaces: replaces.to_vec(),
            staying,
            vertices: parse_attributes(rest, &places, attributes, &mut workspace)?,
            clusters,
        })
    }

    /// Number of triangles.
    #[must_use]
    pub fn triangles(&self) -> usize {
        let clusters = self.clusters.iter();
        clusters.map(|cluster| cluster.triangles.len()).sum()
    }
}

/// Reads so many clusters, whose vertices are not known yet.
fn parse_clusters(
    reader: &mut Reader<'_>,
    count: usize,
    workspace: &mut Workspace,
) -> Result<Vec<Cluster>, PackError> {
    let mut about = [([0; 2], 0); MOST_CLUSTERS];
    for about in &mut about[..count] {
        let sides = reader.take(2, "cluster")?;
        *about = ([sides[0], sides[1]], read_length(reader)?);
    }
    let parse = |(sides, length): &([u8; 2], usize)| {
        parse_cluster(*sides, reader.take(*length, "cluster")?, workspace)
    };
    about[..count].iter().map(parse).collect()
}

fn parse_cluster(
    [vertices, triangles]: [u8; 2],
    stream: &[u8],
    workspace: &mut Workspace,
) -> Result<Cluster, PackError> {
    let [vertices, triangles] = [vertices, triangles].map(usize::from);
    if vertices.max(triangles) > MOST_OF_CLUSTER {
        return Err(wrong("cluster", vertices.max(triangles), "at most 128"));
    }
    let mut corners = [0; 3 * MOST_OF_CLUSTER];
    let corners = &mut corners[..3 * triangles];
    decode_meshlet_into(&mut [], 0, 2, corners, triangles, 3, stream, workspace)
        .map_err(refused)?;
    let beyond = |corner: &&u8| usize::from(**corner) >= vertices;
    match corners.iter().find(beyond) {
        Some(corner) => Err(wrong("corner", corner, format!("fewer than {vertices}"))),
        None => Ok(Cluster {
            vertices: vec![0; vertices],
            triangles: corners.as_chunks().0.to_vec(),
        }),
    }
}

fn parse_attributes(
    stream: &[u8],
    places: &[[u16; 3]],
    attributes: Attributes,
    workspace: &mut Workspace,
) -> Result<Vec<MeshVertex>, PackError> {
    let mut vertices: Vec<_> = places.iter().map(|place| MeshVertex::at(*place)).collect();
    let (count, stride) = (places.len(), attributes.stride());
    if count * stride == 0 {
        return match stream.len() {
            0 => Ok(vertices),
            found => Err(wrong("bytes after the vertices", found, 0)),
        };
    }
    let mut raw = vec![0; count * stride];
    decode_vertex_buffer_into(&mut raw, count, stride, stream, workspace).map_err(refused)?;
    for (vertex, raw) in vertices.iter_mut().zip(raw.chunks_exact(stride)) {
        if attributes.normals {
            vertex.normal = [raw[0] as i8, raw[1] as i8];
        }
        let rest = &raw[4 * usize::from(attributes.normals)..];
        if let (true, Some(colour)) = (attributes.colours, rest.first_chunk()) {
            vertex.colour = *colour;
        }
        if let (true, Some([u, u_high, v, v_high, texture, ..])) =
            (attributes.textured, raw.last_chunk::<8>())
        {
            vertex.uv = [[*u, *u_high], [*v, *v_high]].map(u16::from_le_bytes);
            vertex.texture = *texture;
        }
    }
    Ok(vertices)
}

/// Writes a length below 2^14: in one byte where it is below 2^7.
fn write_length(length: usize, bytes: &mut Vec<u8>) {
    if length < 0x80 {
        return bytes.push(length as u8);
    }
    bytes.extend([length as u8 & 0x7f | 0x80, (length >> 7) as u8]);
}

fn read_length(reader: &mut Reader<'_>) -> Result<usize, PackError> {
    let first = usize::from(reader.take(1, "length")?[0]);
    if first < 0x80 {
        return Ok(first);
    }
    let second = usize::from(reader.take(1, "length")?[0]);
    Ok(first & 0x7f | second << 7)
}

/// Bytes that are read from the front.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize, what: &str) -> Result<&'a [u8], PackError> {
        let taken = self.bytes.split_at_checked(count);
        let (taken, rest) = taken.ok_or_else(|| {
            let found = format!("{} bytes left", self.bytes.len());
            wrong(what, found, format!("{count} bytes"))
        })?;
        self.bytes = rest;
        Ok(taken)
    }
}

fn refused(error: Error) -> PackError {
    wrong("stream", error, "as meshoptimizer writes it")
}
