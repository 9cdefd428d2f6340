//! What is in the pack of a scene?

use crate::report::output;
use crate::report::remarks::remarks_told;
use foveal_core::content::scene::description::JoinedParts;
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::pack::unit::UnitId;
use foveal_core::units::{counted, one_line};
use foveal_media::pack::scene_file::SceneFile;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// What `info` and `prepare` say of a scene.
#[derive(Debug, Serialize)]
pub(crate) struct SceneInfo {
    kind: &'static str,
    /// Things of the source, and their places; those too that were joined.
    objects: usize,
    placements: usize,
    /// Objects that small ones were joined to, and how many these are.
    bundles: u64,
    joined_objects: u64,
    units: usize,
    levels: u8,
    pub(crate) bytes: u64,
    /// Bytes of units, finest level first.
    bytes_per_level: Vec<u64>,
    bytes_by_kind: BytesByKind,
    leaf_triangles: u64,
    points: u64,
    texels: u64,
    /// Bytes of units a triangle or point of the finest level, and with index and table.
    bytes_per_leaf: f64,
    bytes_per_leaf_with_tables: f64,
    repairs: BTreeMap<String, u64>,
    remarks: Vec<String>,
    centre: [f64; 3],
    radius: f64,
    source: Vec<String>,
    source_bytes: u64,
    generator: String,
    /// How long preparing took, where this just did; null else.
    pub(crate) seconds: Option<f64>,
    /// The most memory that the program had by then, where this just prepared.
    pub(crate) peak_memory_bytes: Option<u64>,
}

/// Bytes of units, by what they are made of.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BytesByKind([u64; UnitKind::ALL.len()]);

impl BytesByKind {
    /// The bytes of units of a pack.
    pub(crate) fn of(file: &SceneFile, units: impl Iterator<Item = UnitId>) -> Self {
        let mut bytes = Self::default();
        for unit in units {
            bytes.0[file.pack().row(unit).kind as usize] +=
                u64::from(file.pack().entry(unit).bytes);
        }
        bytes
    }

    fn each(&self) -> impl Iterator<Item = (UnitKind, u64)> {
        UnitKind::ALL.into_iter().zip(self.0)
    }

    /// Those of what stands in space, or of what lies on it.
    fn of_shapes(&self, are_shapes: bool) -> u64 {
        let of = self
            .each()
            .filter(|(kind, _)| kind.facts().is_shape == are_shapes);
        of.map(|(_, bytes)| bytes).sum()
    }
}

impl Serialize for BytesByKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.each().map(|(kind, bytes)| (kind.facts().name, bytes)))
    }
}

/// Texels of the finest level of all textures.
fn texels(file: &SceneFile) -> u64 {
    let textures = file.pack().description().textures.iter();
    let texels = textures.map(|it| it.size.map(u64::from).iter().product::<u64>());
    texels.sum()
}

impl SceneInfo {
    pub(crate) fn new(file: &SceneFile) -> Self {
        let (pack, scene) = (file.pack(), file.scene());
        let about = pack.description();
        let JoinedParts {
            bundles,
            objects,
            places,
        } = about.joined;
        let more = |joined: u64| joined.saturating_sub(bundles) as usize;
        let placements: usize = about.objects.iter().map(|it| it.placements.len()).sum();
        let bytes_per_level = pack.index().bytes_per_level();
        let bytes_by_kind = BytesByKind::of(file, pack.units());
        let tables: u64 = about.tables.iter().map(|it| it.bytes).sum();
        let leaf_triangles = about.objects.iter().map(|it| it.leaf_triangles).sum();
        let points = about.objects.iter().filter_map(|it| it.points);
        let points = points.map(|it| it.count).sum();
        let leaves: u64 = leaf_triangles + points;
        let bytes = bytes_by_kind.of_shapes(true);
        let per_leaf = |bytes: u64| bytes as f64 / leaves.max(1) as f64;
        Self {
            kind: "scene",
            objects: about.objects.len() + more(objects),
            placements: placements + more(places),
            bundles,
            joined_objects: objects,
            units: pack.len(),
            levels: pack.coarsest() + 1,
            bytes: file.bytes(),
            bytes_per_level,
            bytes_by_kind,
            leaf_triangles,
            points,
            texels: texels(file),
            bytes_per_leaf: per_leaf(bytes),
            bytes_per_leaf_with_tables: per_leaf(bytes + tables + file.header().index_bytes),
            repairs: about.repairs.clone(),
            remarks: about.remarks.clone(),
            centre: scene.bounds().centre.to_array(),
            radius: scene.bounds().radius,
            source: about.source.names.clone(),
            source_bytes: about.source.bytes,
            generator: about.generator.clone(),
            seconds: None,
            peak_memory_bytes: None,
        }
    }

    /// Its triangles and points, of what there is.
    fn samples_text(&self) -> String {
        let all = [(self.leaf_triangles, "triangle"), (self.points, "point")];
        let there = all.into_iter().filter(|(count, _)| *count > 0);
        let told: Vec<String> = there.map(|(count, what)| counted(count, what)).collect();
        told.join(", ")
    }

    pub(crate) fn text(&self) -> String {
        let mut text = format!(
            "{}: {}, {}, {} of {} from {}\n{}, {:.2} bytes a {}, {:.2} with index and table\n",
            one_line(&self.source.join(", ")),
            counted(self.objects, "object"),
            self.samples_text(),
            counted(self.levels, "level"),
            output::size(self.bytes),
            output::size(self.source_bytes),
            counted(self.units, "unit"),
            self.bytes_per_leaf,
            if self.leaf_triangles > 0 {
                "triangle"
            } else {
                "point"
            },
            self.bytes_per_leaf_with_tables,
        );
        if self.bundles > 0 {
            let joined = counted(self.joined_objects, "small object");
            let _ = writeln!(text, "{joined} joined to {}", self.bundles);
        }
        if self.texels > 0 {
            let size = output::size(self.bytes_by_kind.of_shapes(false));
            let _ = writeln!(
                text,
                "{} in textures, {size}",
                counted(self.texels, "texel")
            );
        }
        // Nothing is 0, and not -0.
        let [x, y, z] = self.centre.map(|it| (it * 1e4).round() / 1e4 + 0.0);
        let _ = writeln!(
            text,
            "centre {x:.4}, {y:.4}, {z:.4}, radius {:.4} m",
            self.radius
        );
        for (level, bytes) in self.bytes_per_level.iter().enumerate() {
            let _ = writeln!(text, "level {level}: {}", output::size(*bytes));
        }
        text + &remarks_told(&self.repairs, &self.remarks)
    }
}
