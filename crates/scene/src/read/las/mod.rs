//! How are LAS and LAZ files read?
//!
//! Sources: ASPRS, "LAS Specification", 1.0 to 1.4 R15; for LAZ the records that LASzip (Isenburg
//! 2013, "LASzip: lossless compression of LiDAR data") writes, decompressed by the crate `laz`. A
//! COPC file is a LAZ file with a hierarchy, which is not needed here.

mod header;
mod packed;
#[cfg(test)]
mod tests;

use super::colour::mend_codes;
use super::error::Fault;
use super::outliers;
use super::text::shortened;
use crate::source::{Repairs, SourceCloud, SourceScene};
use foveal_core::units::counted;
use glam::DAffine3;
use header::{LasHeader, Layout};

/// Reads a LAS or LAZ file into one cloud called `name`.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<SourceScene, Fault> {
    let mut mends = LasMends::default();
    let header = LasHeader::parse(bytes, &mut mends)?;
    let mut records = Records::new(header.layout);
    let length = header.record_bytes;
    if header.is_packed {
        packed::read(bytes, &header, &mut records, &mut mends)?;
    } else {
        let all = header.plain_records(bytes, &mut mends)?;
        all.chunks_exact(length)
            .for_each(|record| records.add(record));
    }
    let mut scene = SourceScene::default();
    if records.has_waves {
        scene.remark("waveforms of laser echoes are not drawn");
    }
    for remark in mends.remarks {
        scene.remark(format!("{name}: {remark}"));
    }
    scene.repairs = mends.repairs;
    let what = format!("points of {:?}", shortened(name));
    let remark = mend_codes(&what, &mut records.cloud.colours, &mut scene.repairs);
    remark.into_iter().for_each(|it| scene.remark(it));
    let cloud = SourceCloud {
        name: name.to_owned(),
        placements: vec![DAffine3::IDENTITY],
        scale: header.scale,
        offset: header.offset,
        ..records.cloud
    };
    scene.clouds = outliers::clouds_on_grid(cloud, &mut scene);
    Ok(scene)
}

/// What of a file was mended or left out.
#[derive(Debug, Default)]
struct LasMends {
    remarks: Vec<String>,
    repairs: Repairs,
}

impl LasMends {
    fn remark(&mut self, remark: String) {
        self.remarks.push(remark);
    }

    fn count(&mut self, name: &str, times: u64) {
        *self.repairs.entry(name.to_owned()).or_default() += times;
    }

    /// A number in the header that the rest of the file contradicts.
    fn stale_count(&mut self, remark: String) {
        self.remark(remark);
        self.count("stale_counts", 1);
    }

    /// So many points of all that the header counts are not there.
    fn miss(&mut self, missing: u64, all: u64, why: &str) {
        if missing > 0 {
            self.remark(format!("{missing} of {all} points are missing: {why}"));
            self.count("missing_points", missing);
        }
    }

    /// So many bytes lie behind the points that the header counts, and belong to nothing.
    fn leave_behind(&mut self, bytes: usize, points: u64) {
        if bytes > 0 {
            self.remark(format!(
                "{} behind the {points} points that the header counts are left out",
                counted(bytes, "byte")
            ));
            self.count("bytes_behind_points", bytes as u64);
        }
    }
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

    /// Number of points so far.
    fn len(&self) -> usize {
        self.cloud.places.len()
    }

    /// Forgets all points but the first so many.
    fn truncate(&mut self, points: usize) {
        let cloud = &mut self.cloud;
        cloud.places.truncate(points);
        cloud.intensities.truncate(points);
        cloud.classes.truncate(points);
        cloud.colours.truncate(points);
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
