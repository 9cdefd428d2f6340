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
mod unpacking;

use super::colour::mend_codes;
use super::error::Fault;
use super::outliers;
use super::text::{plain, shortened};
use crate::source::{SourceCloud, SourceScene};
use glam::DAffine3;
use header::{LasHeader, is_place, is_step};
use mends::LasMends;
use records::Records;

/// Reads a LAS or LAZ file into one cloud called `name`.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<SourceScene, Fault> {
    let mut mends = LasMends::default();
    let mut header = LasHeader::parse(bytes, &mut mends)?;
    mend_packing(bytes, &mut header, &mut mends);
    let mut records = Records::new(header.layout);
    let length = header.record_bytes;
    if header.is_packed {
        packed::read(bytes, &header, &mut records, &mut mends)?;
    } else {
        let all = header.plain_records(bytes, &mut mends)?;
        all.chunks_exact(length)
            .for_each(|record| records.add(record));
    }
    fit_to_bounds(bytes, &mut header, &records, &mut mends)?;
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

/// Treats points as plain that are said to be packed, though no record says how, and that fit
/// exactly as they are.
fn mend_packing(bytes: &[u8], header: &mut LasHeader, mends: &mut LasMends) {
    let room = header.points_end.saturating_sub(header.points_at) as u64;
    let is_exact = header.count.checked_mul(header.record_bytes as u64) == Some(room);
    if header.is_packed && is_exact && !packed::is_explained(bytes, header) {
        header.is_packed = false;
        mends.stale_count(
            "the points are said to be packed, but are not: they are read as they are".to_owned(),
        );
    }
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

/// Makes lengths of steps that are no lengths, and beginnings of grids that are no places, from how
/// far the header says that points reach.
fn fit_to_bounds(
    bytes: &[u8],
    header: &mut LasHeader,
    records: &Records,
    mends: &mut LasMends,
) -> Result<(), Fault> {
    for (k, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        let (scale, offset) = (header.scale[k], header.offset[k]);
        if is_step(scale) && is_place(offset) {
            continue;
        }
        let along = || records.places().iter().map(|it| f64::from(it[k]));
        let reach = along().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], it| {
            [low.min(it), high.max(it)]
        });
        let [low, high] = header::bounds_of(bytes, k);
        let fitting = (high - low) / (reach[1] - reach[0]);
        let step = if is_step(scale) { scale } else { fitting };
        if !(is_step(step) && is_place(low) && low < high) {
            let [scale, offset] = [scale, offset].map(plain);
            let what = format!(
                "the scale {scale} and the offset {offset} along {name} are no grid, and no bounds \
                 show which is meant"
            );
            return Err(Fault::at("byte 131", what));
        }
        header.scale[k] = step;
        header.offset[k] = low - (reach[0] * step).min(reach[1] * step);
        let [scale, offset, step, place] = [scale, offset, step, header.offset[k]].map(plain);
        mends.stale_count(format!(
            "the scale along {name} is {scale} and the offset {offset}, which is no grid: {step} \
             and {place} fit the bounds of all points"
        ));
    }
    Ok(())
}
