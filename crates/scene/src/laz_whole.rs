//! What does LAZ by itself make of a cloud, for comparison?

use foveal_core::content::points::payload::CloudPoint;
use laz::{LasZipCompressor, LasZipDecompressor, LasZipError, LazItemRecordBuilder, LazVlr};
use std::io::Cursor;

/// Point format 2 of LAS: a place, an intensity, a class and a colour, without a time.
const FORMAT: u8 = 2;
const RECORD_BYTES: usize = 26;

/// A cloud as LASzip packs its points, all in one file.
pub struct LazWhole {
    bytes: Vec<u8>,
    vlr: LazVlr,
    points: usize,
}

impl LazWhole {
    /// Packs points in their order. What all of them lack is packed as zeros, which takes next to
    /// nothing.
    ///
    /// # Errors
    /// Only what writing to memory has.
    pub fn encode(points: impl Iterator<Item = CloudPoint>) -> Result<Self, LasZipError> {
        let vlr = LazVlr::from_laz_items(LazItemRecordBuilder::default_for_point_format_id(
            FORMAT, 0,
        )?);
        let mut file = Cursor::new(Vec::new());
        let mut packing = LasZipCompressor::new(&mut file, vlr.clone())?;
        let mut count = 0;
        for point in points {
            packing.compress_one(&record(&point))?;
            count += 1;
        }
        packing.done()?;
        drop(packing);
        Ok(Self {
            bytes: file.into_inner(),
            vlr,
            points: count,
        })
    }

    /// Bytes of the points, without a header.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.bytes.len()
    }

    /// Unpacks all points, and returns how many these are.
    ///
    /// # Errors
    /// None of what [`Self::encode`] made.
    pub fn decode(&self) -> Result<usize, LasZipError> {
        let mut records = vec![0; RECORD_BYTES * self.points];
        let mut unpacking =
            LasZipDecompressor::new(Cursor::new(&self.bytes[..]), self.vlr.clone())?;
        unpacking.decompress_many(&mut records)?;
        Ok(records.len() / RECORD_BYTES)
    }
}

fn record(point: &CloudPoint) -> [u8; RECORD_BYTES] {
    let mut record = [0; RECORD_BYTES];
    for (k, along) in point.place.iter().enumerate() {
        record[4 * k..4 * k + 4].copy_from_slice(&along.to_le_bytes());
    }
    record[12..14].copy_from_slice(&point.intensity.to_le_bytes());
    // The only return of one.
    record[14] = 1 | 1 << 3;
    record[15] = point.class;
    for (k, code) in point.colour.iter().enumerate() {
        record[20 + 2 * k..22 + 2 * k].copy_from_slice(&code.to_le_bytes());
    }
    record
}
