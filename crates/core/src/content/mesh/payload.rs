//! What do the bytes of a unit of a mesh say?
//!
//! A unit holds the fine clusters of one group and the vertices that lie inside it: each vertex of
//! a mesh is sent once. The vertices that stay when the group is simplified are those of the
//! coarse clusters, which came with units before. Normative: docs/formats/pack.md.

use crate::pack::PackError;
use meshoptimizer_rs::codec::{
    VertexEncoding, decode_meshlet_into, decode_vertex_buffer_into, encode_meshlet,
    encode_vertex_buffer,
};
use meshoptimizer_rs::{Error, Workspace};

/// Version of the layout.
const VERSION: u8 = 1;
/// Bytes before the list of replaced clusters.
const HEAD_BYTES: usize = 8;
/// Bytes that tell of a cluster before its stream.
const CLUSTER_BYTES: usize = 4;
/// Most clusters of a unit.
pub const MOST_CLUSTERS: usize = 16;
/// Most vertices, and most triangles, of a cluster.
pub const MOST_OF_CLUSTER: usize = 128;

/// A cluster that came with another unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ClusterRef {
    /// Which of the unit's prerequisites it came with.
    pub need: u8,
    /// Its number there.
    pub cluster: u8,
}

/// A vertex on the grid of its object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MeshVertex {
    /// Place on the grid.
    pub place: [u16; 3],
    /// Normal, octahedral; zeros where the object has none.
    pub normal: [i8; 2],
    /// Colour: red, green and blue as sRGB codes, and alpha; zeros where the object has none.
    pub colour: [u8; 4],
}

/// Triangles that are shown or hidden together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cluster {
    /// The vertices by number: first those that stay, then the new ones of the unit.
    pub vertices: Vec<u16>,
    /// Triangles, by place in `vertices`, counter-clockwise seen from outside.
    pub triangles: Vec<[u8; 3]>,
}

/// What one unit says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MeshUnit {
    /// The coarse clusters in whose place these are shown; of a root none.
    pub replaces: Vec<ClusterRef>,
    /// Number of vertices that stay: those of the replaced clusters, each once, in the order in
    /// which they are first named.
    pub staying: u16,
    /// The vertices that lie inside the group.
    pub vertices: Vec<MeshVertex>,
    /// The fine clusters.
    pub clusters: Vec<Cluster>,
}

/// What vertices of an object have beside a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Attributes {
    /// Normals; without, faces are flat.
    pub normals: bool,
    /// Colours; without, the object's own.
    pub colours: bool,
}

impl Attributes {
    fn flags(self) -> u8 {
        u8::from(self.normals) | u8::from(self.colours) << 1
    }

    /// Bytes of a vertex before it is compressed.
    fn stride(self) -> usize {
        if self.colours { 12 } else { 8 }
    }
}

impl MeshUnit {
    /// The unit as bytes, of an object whose vertices have these attributes.
    ///
    /// # Errors
    /// More clusters, vertices or triangles than a unit can tell of.
    pub fn write(&self, attributes: Attributes) -> Result<Vec<u8>, PackError> {
        let counts = [self.replaces.len(), self.clusters.len()];
        let most =
            |what: &str, found: usize, most: usize| wrong(what, found, format!("at most {most}"));
        if let Some(count) = counts.iter().find(|count| **count > MOST_CLUSTERS) {
            return Err(most("clusters", *count, MOST_CLUSTERS));
        }
        let vertices = u16::try_from(self.vertices.len());
        let vertices =
            vertices.map_err(|_| most("vertices", self.vertices.len(), usize::from(u16::MAX)))?;
        let mut bytes = vec![
            VERSION,
            attributes.flags(),
            counts[0] as u8,
            counts[1] as u8,
        ];
        bytes.extend(self.staying.to_le_bytes());
        bytes.extend(vertices.to_le_bytes());
        let replaced = self.replaces.iter();
        bytes.extend(replaced.map(|it| it.need << 4 | (it.cluster & 15)));
        let mut workspace = Workspace::default();
        let mut streams = Vec::new();
        for cluster in &self.clusters {
            let sides = [cluster.vertices.len(), cluster.triangles.len()];
            if let Some(side) = sides.iter().find(|side| **side > MOST_OF_CLUSTER) {
                return Err(most("cluster", *side, MOST_OF_CLUSTER));
            }
            let named: Vec<u32> = cluster.vertices.iter().map(|it| u32::from(*it)).collect();
            let corners = cluster.triangles.as_flattened();
            let stream = encode_meshlet(&named, corners, &mut workspace).map_err(refused)?;
            bytes.extend(sides.map(|side| side as u8));
            bytes.extend((stream.len() as u16).to_le_bytes());
            streams.extend(stream);
        }
        bytes.extend(streams);
        bytes.extend(self.write_vertices(attributes, &mut workspace)?);
        Ok(bytes)
    }

    fn write_vertices(
        &self,
        attributes: Attributes,
        workspace: &mut Workspace,
    ) -> Result<Vec<u8>, PackError> {
        if self.vertices.is_empty() {
            return Ok(Vec::new());
        }
        let mut raw = Vec::with_capacity(self.vertices.len() * attributes.stride());
        for vertex in &self.vertices {
            raw.extend(vertex.place.iter().flat_map(|it| it.to_le_bytes()));
            raw.extend(vertex.normal.map(|it| it as u8));
            if attributes.colours {
                raw.extend(vertex.colour);
            }
        }
        let (count, stride) = (self.vertices.len(), attributes.stride());
        let encoding = VertexEncoding::DEFAULT;
        encode_vertex_buffer(&raw, count, stride, encoding, workspace).map_err(refused)
    }

    /// Reads the unit of an object whose vertices have these attributes.
    ///
    /// Every number of a cluster is in range then; whether the replaced clusters exist shows where
    /// they are looked up. Takes at most some hundred bytes for each byte that is read.
    ///
    /// # Errors
    /// The bytes are no such unit.
    pub fn parse(bytes: &[u8], attributes: Attributes) -> Result<Self, PackError> {
        let mut reader = Reader { bytes };
        let head = reader.take(HEAD_BYTES, "head")?;
        if head[0] != VERSION {
            return Err(wrong("version", head[0], VERSION));
        }
        if head[1] != attributes.flags() {
            return Err(wrong("attributes", head[1], attributes.flags()));
        }
        let [replaces, clusters] = [head[2], head[3]].map(usize::from);
        if replaces > MOST_CLUSTERS || clusters > MOST_CLUSTERS {
            return Err(wrong("clusters", replaces.max(clusters), "at most 16"));
        }
        let [staying, new] = [4, 6].map(|at| u16::from_le_bytes([head[at], head[at + 1]]));
        let named = u32::from(staying) + u32::from(new);
        let replaced = reader.take(replaces, "replaced clusters")?.iter();
        let replaced = replaced.map(|it| ClusterRef {
            need: it >> 4,
            cluster: it & 15,
        });
        let about = reader.take(clusters * CLUSTER_BYTES, "clusters")?;
        let mut workspace = Workspace::default();
        let mut of_cluster = |about: &[u8]| {
            let length = usize::from(u16::from_le_bytes([about[2], about[3]]));
            let stream = reader.take(length, "cluster")?;
            parse_cluster([about[0], about[1]], stream, named, &mut workspace)
        };
        let parsed = about.chunks_exact(CLUSTER_BYTES).map(&mut of_cluster);
        let clusters = parsed.collect::<Result<_, _>>()?;
        let replaces = replaced.collect();
        Ok(Self {
            replaces,
            staying,
            vertices: parse_vertices(reader.bytes, new, attributes, &mut workspace)?,
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

fn parse_cluster(
    [vertices, triangles]: [u8; 2],
    stream: &[u8],
    named: u32,
    workspace: &mut Workspace,
) -> Result<Cluster, PackError> {
    let [vertices, triangles] = [vertices, triangles].map(usize::from);
    if vertices.max(triangles) > MOST_OF_CLUSTER {
        return Err(wrong("cluster", vertices.max(triangles), "at most 128"));
    }
    let mut names = [0; 2 * MOST_OF_CLUSTER];
    let mut corners = [0; 3 * MOST_OF_CLUSTER];
    let (names, corners) = (&mut names[..2 * vertices], &mut corners[..3 * triangles]);
    decode_meshlet_into(names, vertices, 2, corners, triangles, 3, stream, workspace)
        .map_err(refused)?;
    let names = names.chunks_exact(2);
    let cluster = Cluster {
        vertices: names.map(|it| u16::from_le_bytes([it[0], it[1]])).collect(),
        triangles: corners.as_chunks().0.to_vec(),
    };
    let beyond = |vertex: &&u16| u32::from(**vertex) >= named;
    if let Some(vertex) = cluster.vertices.iter().find(beyond) {
        return Err(wrong("vertex", vertex, format!("fewer than {named}")));
    }
    let beyond = |corner: &&u8| usize::from(**corner) >= vertices;
    match corners.iter().find(beyond) {
        Some(corner) => Err(wrong("corner", corner, format!("fewer than {vertices}"))),
        None => Ok(cluster),
    }
}

fn parse_vertices(
    stream: &[u8],
    count: u16,
    attributes: Attributes,
    workspace: &mut Workspace,
) -> Result<Vec<MeshVertex>, PackError> {
    let (count, stride) = (usize::from(count), attributes.stride());
    if count == 0 {
        return match stream.len() {
            0 => Ok(Vec::new()),
            found => Err(wrong("bytes after the clusters", found, 0)),
        };
    }
    // A block of 16 takes at least two bits a byte of a vertex: no more is made of fewer bytes.
    if stream.len() < count.div_ceil(16).div_ceil(4) {
        return Err(wrong("vertices", count, "as many as there are bytes for"));
    }
    let mut raw = vec![0; count * stride];
    decode_vertex_buffer_into(&mut raw, count, stride, stream, workspace).map_err(refused)?;
    let vertices = raw.chunks_exact(stride).map(|it| MeshVertex {
        place: [0, 2, 4].map(|at| u16::from_le_bytes([it[at], it[at + 1]])),
        normal: [it[6] as i8, it[7] as i8],
        colour: match attributes.colours {
            true => [it[8], it[9], it[10], it[11]],
            false => [0; 4],
        },
    });
    Ok(vertices.collect())
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

fn wrong(what: &str, found: impl ToString, expected: impl ToString) -> PackError {
    PackError {
        field: format!("mesh unit, {what}"),
        found: found.to_string(),
        expected: expected.to_string(),
    }
}

fn refused(error: Error) -> PackError {
    wrong("stream", error, "as meshoptimizer writes it")
}
