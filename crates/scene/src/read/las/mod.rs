//! How are LAS and LAZ files read?
//!
//! Sources: ASPRS, "LAS Specification", 1.0 to 1.4 R15; for LAZ the records that LASzip (Isenburg
//! 2013, "LASzip: lossless compression of LiDAR data") writes, decompressed by the crate `laz`. A
//! COPC file is a LAZ file with a hierarchy, which is not needed here.

mod header;
mod packed;
#[cfg(test)]
mod tests;

use super::error::Fault;
use super::mends::{Mends, ROW_MISSING};
use crate::source::{SourceCloud, SourceScene};
use glam::DAffine3;
use header::{LasHeader, Layout};

/// Reads a LAS or LAZ file into one cloud called `name`.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<SourceScene, Fault> {
    let header = LasHeader::parse(bytes)?;
    let mut records = Records::new(header.layout);
    let length = header.record_bytes;
    if header.is_packed {
        packed::read(bytes, &header, &mut |record| records.add(record))?;
    } else {
        let all = header.plain_records(bytes)?;
        all.chunks_exact(length)
            .for_each(|record| records.add(record));
    }
    let mut scene = SourceScene::default();
    let mut mends = Mends::default();
    let there = records.cloud.places.len();
    let missing = (header.count as usize).saturating_sub(there);
    mends.add(ROW_MISSING, missing, || format!("is point {there}"));
    mends.tell(name, &mut scene);
    if records.has_waves {
        scene.remark("waveforms of laser echoes are not drawn");
    }
    scene.clouds = vec![SourceCloud {
        name: name.to_owned(),
        placements: vec![DAffine3::IDENTITY],
        scale: header.scale,
        offset: header.offset,
        ..records.cloud
    }];
    Ok(scene)
}

/// Takes out of records what is kept of a point.
struct Records {
    layout: Layout,
    has_waves: bool,
    cloud: SourceCloud,
}

impl Records {
    fn new(layout: Layout) -> Self {
        Self {
            layout,
            has_waves: layout.has_waves,
            cloud: SourceCloud::default(),
        }
    }

    /// Adds a record, which is as long as its layout.
    fn add(&mut self, record: &[u8]) {
        let cloud = &mut self.cloud;
        cloud
            .places
            .push([0, 4, 8].map(|at| header::word_at(record, at) as i32));
        cloud.intensities.push(header::half_at(record, 12));
        cloud.classes.push(self.layout.class_of(record));
        if let Some(at) = self.layout.colour {
            let colour = [at, at + 2, at + 4].map(|at| header::half_at(record, at));
            cloud.colours.push(colour);
        }
    }
}
