//! How are LAS and LAZ files read?
//!
//! Sources: ASPRS, "LAS Specification", 1.0 to 1.4 R15; for LAZ the records that LASzip (Isenburg
//! 2013, "LASzip: lossless compression of LiDAR data") writes, decompressed by the crate `laz`. A
//! COPC file is a LAZ file with a hierarchy, which is not needed here.

mod header;
mod mends;
mod packed;
mod records;
#[cfg(test)]
mod tests;

use super::colour::mend_codes;
use super::error::Fault;
use super::outliers;
use super::text::shortened;
use crate::source::{SourceCloud, SourceScene};
use glam::DAffine3;
use header::LasHeader;
use mends::LasMends;
use records::Records;

/// Reads a LAS or LAZ file into one cloud called `name`.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<SourceScene, Fault> {
    let mut mends = LasMends::default();
    let mut header = LasHeader::parse(bytes, &mut mends)?;
    header.mend_packing(bytes, &mut mends);
    let mut records = Records::new(header.layout);
    let length = header.record_bytes;
    if header.is_packed {
        packed::read(bytes, &header, &mut records, &mut mends)?;
    } else {
        let all = header.plain_records(bytes, &mut mends)?;
        all.chunks_exact(length)
            .for_each(|record| records.add(record));
    }
    turn_negative(&mut header, &mut records, &mut mends);
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

/// Makes lengths of steps positive, and turns places along such axes.
fn turn_negative(header: &mut LasHeader, records: &mut Records, mends: &mut LasMends) {
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        if header.scale[k] < 0.0 {
            header.scale[k] = -header.scale[k];
            for place in &mut records.cloud.places {
                place[k] = place[k].saturating_neg();
            }
            mends.negative_scale(format!(
                "the scale along {name} is negative: whole numbers along it count the other way, \
                 and are read so"
            ));
        }
    }
}
