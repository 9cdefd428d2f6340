//! How large is a pack, what of it is needed first, and is every cut of it closed?

use super::conditions::BenchConditions;
use super::row::{BenchRow, Turns};
use super::subject::Subject;
use foveal_core::content::demand::Content;
use foveal_core::pack::unit::UnitId;
use foveal_scene::baseline::WholeMesh;
use foveal_scene::cracks::{CutTrial, check_cuts};
use std::collections::BTreeSet;

/// Foveated cuts, and orders in which units come.
const TRIAL: CutTrial = CutTrial {
    cuts: 100,
    orders: 200,
    seed: 1,
    ignore_prerequisites: false,
};

/// Odd edges over all cuts and orders.
pub(super) fn closed(subject: &Subject, _: &BenchConditions) -> anyhow::Result<Vec<BenchRow>> {
    let file = &subject.file;
    let pack = file.pack();
    let rows = pack
        .units()
        .map(|unit| (pack.level_of(unit), pack.row(unit).clone()));
    let rows: Vec<_> = rows.collect();
    let mut payload_of = |unit: UnitId| file.read_mesh(unit).map_err(anyhow::Error::from);
    let report = check_cuts(&rows, &mut payload_of, &TRIAL)?;
    let what = format!(
        "odd edges of {} cuts and {} orders",
        report.cuts, report.orders
    );
    let row = Turns::once(report.odd_edges_max as f64, None).row(&subject.name, what, "edges");
    Ok(vec![row.asked(format!(
        "ours <= {}, those of the source",
        report.source_odd_edges
    ))])
}

/// Bytes a triangle of the finest level, against codecs for the whole mesh on the same grid.
pub(super) fn of_leaves(subject: &Subject, _: &BenchConditions) -> anyhow::Result<Vec<BenchRow>> {
    let (pack, header) = (subject.file.pack(), subject.file.header());
    let of_meshes = pack
        .units()
        .filter(|unit| pack.row(*unit).kind.facts().has_triangles);
    let units: u64 = of_meshes
        .map(|unit| u64::from(pack.entry(unit).bytes))
        .sum();
    let tables: u64 = pack.description().tables.iter().map(|it| it.bytes).sum();
    let mut whole = 0;
    for mesh in &subject.finest {
        whole += WholeMesh::encode(mesh)?.bytes();
    }
    let per_leaf = |bytes: u64| bytes as f64 / subject.leaves();
    let row = |what: &str, bytes: u64, asked: &str| {
        let turns = Turns::once(per_leaf(bytes), Some(per_leaf(whole as u64)));
        turns.row(&subject.name, what, "bytes").asked(asked)
    };
    let all = units + tables + header.index_bytes;
    Ok(vec![
        row("bytes a leaf triangle, units alone", units, "ours <= 5.8"),
        row(
            "bytes a leaf triangle, with index and table",
            all,
            "ours <= 6.3",
        ),
    ])
}

/// Bytes until there is a picture, of those of the whole pack.
pub(super) fn first_picture(
    subject: &Subject,
    _: &BenchConditions,
) -> anyhow::Result<Vec<BenchRow>> {
    let file = &subject.file;
    let pack = file.pack();
    let mut pages = [BTreeSet::new(), BTreeSet::new()];
    let mut bytes = pack.head_bytes(file.header());
    for root in file.scene().base(0) {
        bytes += u64::from(pack.entry(root).bytes);
        for (page, seen) in pack.pages_of(root).into_iter().zip(&mut pages) {
            bytes += if seen.insert(page.0) { page.1 } else { 0 };
        }
    }
    let row = Turns::once(bytes as f64, Some(file.bytes() as f64));
    let row = row.row(&subject.name, "first picture, of the whole pack", "bytes");
    Ok(vec![row.asked("ratio <= 0.02")])
}
