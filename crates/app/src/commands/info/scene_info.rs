//! What is in the pack of a scene?

use crate::report::output;
use crate::report::remarks::remarks_told;
use foveal_core::content::scene::description::{JoinedParts, SceneDescription};
use foveal_core::content::scene::kind::{KindFacts, UnitKind};
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
    #[serde(flatten)]
    leaves: Leaves,
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

/// Samples of the finest level, by what they are of: first what stands in space.
#[derive(Clone, Debug)]
struct Leaves(Vec<(&'static KindFacts, u64)>);

impl Leaves {
    fn of(about: &SceneDescription) -> Self {
        let count = |kind: UnitKind| (kind.facts(), about.finest_samples_of(kind));
        let (mut shapes, others): (Vec<_>, Vec<_>) = UnitKind::ALL
            .map(count)
            .into_iter()
            .partition(|(facts, _)| facts.is_shape);
        shapes.extend(others);
        Self(shapes)
    }

    /// Those of what stands in space, or of what lies on it, of which there are some.
    fn there(&self, are_shapes: bool) -> impl Iterator<Item = (&'static KindFacts, u64)> {
        let all = self.0.iter().copied();
        all.filter(move |(facts, count)| facts.is_shape == are_shapes && *count > 0)
    }

    /// The same as text.
    fn text(&self, are_shapes: bool) -> String {
        let there = self.there(are_shapes);
        let told: Vec<String> = there.map(|(it, count)| counted(count, it.sample)).collect();
        told.join(", ")
    }
}

impl Serialize for Leaves {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(facts, count)| (facts.leaves, count)))
    }
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
        let leaves = Leaves::of(about);
        let all: u64 = leaves.there(true).map(|(_, count)| count).sum();
        let bytes = bytes_by_kind.of_shapes(true);
        let per_leaf = |bytes: u64| bytes as f64 / all.max(1) as f64;
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
            leaves,
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

    pub(crate) fn text(&self) -> String {
        let first = self.leaves.there(true).next();
        let mut text = format!(
            "{}: {}, {}, {} of {} from {}\n{}, {:.2} bytes a {}, {:.2} with index and table\n",
            one_line(&self.source.join(", ")),
            counted(self.objects, "object"),
            self.leaves.text(true),
            counted(self.levels, "level"),
            output::size(self.bytes),
            output::size(self.source_bytes),
            counted(self.units, "unit"),
            self.bytes_per_leaf,
            first.map_or("sample", |(facts, _)| facts.sample),
            self.bytes_per_leaf_with_tables,
        );
        if self.bundles > 0 {
            let joined = counted(self.joined_objects, "small object");
            let _ = writeln!(text, "{joined} joined to {}", self.bundles);
        }
        let lying = self.leaves.text(false);
        if !lying.is_empty() {
            let size = output::size(self.bytes_by_kind.of_shapes(false));
            let _ = writeln!(text, "{lying} in textures, {size}");
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
