//! What is known of a unit before it is fetched?
//!
//! The side table `units`, in pages; `docs/formats/pack.md` is normative.

use super::kind::UnitKind;
use super::part_ref::{MOST_PARTS, PartRef};
use crate::content::bits::{push_varint, read_varint};
use crate::pack::paged_table::{PageDirectory, write_pages};
use crate::pack::unit::UnitId;
use crate::pack::{PackError, UnitNumbers, u32_at};
use crate::perception::measures::contrast::Signature;

/// Name of the side table.
pub const UNITS: &str = "units";
/// Version of its layout.
pub const UNITS_VERSION: u32 = 2;
/// Most prerequisites of a unit.
pub const MOST_NEEDS: usize = 16;
/// Bytes of a row before its signature.
const SPHERE_BYTES: usize = 24;
/// Bytes of a row before what differs in length.
const FIXED_BYTES: usize = SPHERE_BYTES + Signature::BYTES;
/// The object of what belongs to no object alone, and whose sphere and error are in the world: a
/// page of a texture that several objects have.
pub const OF_ALL: u16 = u16::MAX;

/// What is known of one unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnitRow {
    /// What it is made of.
    pub kind: UnitKind,
    /// Number of its object, or [`OF_ALL`].
    pub object: u16,
    /// Centre of a sphere round all that it shows, in the object's space, from the origin of its
    /// grid. The spheres of its prerequisites enclose it.
    pub centre: [f32; 3],
    /// Radius of the sphere.
    pub radius: f32,
    /// How far what it is shown in place of is from the source, in the object's space; of a root
    /// infinite. No prerequisite's is smaller. Of a page it is the side of a texel of the next
    /// coarser level.
    pub error: f32,
    /// What it adds to what it is shown in place of, both drawn so that [`Self::error`] is a pixel,
    /// of a page two pixels; of a root nothing.
    pub signature: Signature,
    /// Samples that it shows: triangles of a mesh, texels of a page without its border, points that
    /// are added to a cloud.
    pub samples: u32,
    /// Vertices of all its clusters, those that came before and those of several clusters counted
    /// in each.
    pub vertices: u32,
    /// The units that must be there first, at most 16, all with lower numbers; none that another of
    /// them needs in turn.
    pub needs: Vec<UnitId>,
    /// What it is shown in place of, at most 16: coarse clusters of meshes, the quarter of the page
    /// that a page lies in, the octant of the unit that points need.
    pub replaces: Vec<PartRef>,
}

impl UnitRow {
    /// Bytes that it takes on the GPU, at most.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        let cost = self.kind.facts().gpu;
        let root = if self.needs.is_empty() { cost.root } else { 0 };
        let [vertices, samples] = [self.vertices, self.samples].map(u64::from);
        cost.unit + root + vertices * cost.vertex + samples * cost.sample
    }

    fn write(&self, unit: u32) -> Vec<u8> {
        let mut bytes = vec![self.kind.facts().byte, self.needs.len() as u8];
        bytes.extend(self.object.to_le_bytes());
        let [x, y, z] = self.centre;
        let numbers = [x, y, z, self.radius, self.error];
        bytes.extend(numbers.iter().flat_map(|it| it.to_le_bytes()));
        bytes.extend(self.signature.to_bytes());
        push_varint(&mut bytes, self.samples);
        push_varint(&mut bytes, self.vertices);
        for UnitId(need) in &self.needs {
            push_varint(&mut bytes, unit - need);
        }
        bytes.push(self.replaces.len() as u8);
        bytes.extend(self.replaces.iter().map(|it| it.to_byte()));
        bytes
    }

    /// Reads the row of `unit` from the start of `bytes`; returns what is behind it as well.
    fn read(unit: u32, bytes: &[u8]) -> Result<(Self, &[u8]), PackError> {
        let wrong = |what: &str, found: String, expected: &str| {
            let field = format!("table {UNITS}, unit {unit}, {what}");
            Err(PackError::new(&field, found, expected))
        };
        let Some((fixed, mut rest)) = bytes.split_at_checked(FIXED_BYTES) else {
            return wrong("row", format!("{} bytes", bytes.len()), "36 and more");
        };
        let Some(kind) = UnitKind::from_byte(fixed[0]) else {
            let kinds = UnitKind::ALL.map(UnitKind::facts);
            let kinds = kinds.map(|it| format!("{} for {}", it.byte, it.name));
            return wrong("kind", fixed[0].to_string(), &kinds.join(", "));
        };
        let count = usize::from(fixed[1]);
        let number = |at| f32::from_bits(u32_at(fixed, at));
        let row = Self {
            kind,
            object: u16::from_le_bytes([fixed[2], fixed[3]]),
            centre: [4, 8, 12].map(number),
            radius: number(16),
            error: number(20),
            ..Self::default()
        };
        let (_, signature) = fixed.split_at(SPHERE_BYTES);
        let signature = signature.first_chunk().copied().unwrap_or_default();
        let is_placed = row.centre.iter().all(|it| it.is_finite()) && row.radius.is_finite();
        if !(is_placed && row.radius >= 0.0 && row.error >= 0.0) {
            return wrong("sphere, error", format!("{row:?}"), "a sphere and an error");
        }
        let mut next = |what: &str| match read_varint(rest) {
            Some((value, behind)) => {
                rest = behind;
                Ok(value)
            }
            None => Err(PackError::new(
                &format!("table {UNITS}, unit {unit}, {what}"),
                "no number",
                "a number of 32 bits",
            )),
        };
        let (samples, vertices) = (next("samples")?, next("vertices")?);
        let mut needs = Vec::with_capacity(count.min(MOST_NEEDS));
        for _ in 0..count.min(MOST_NEEDS + 1) {
            let back = next("needs")?;
            match unit.checked_sub(back) {
                Some(need) if back > 0 && needs.len() < MOST_NEEDS => needs.push(UnitId(need)),
                _ => return wrong("needs", format!("{back} back"), "at most 16 units before"),
            }
        }
        let (replaces, rest) = match read_replaces(rest) {
            Some((replaces, rest)) if replaces.iter().all(|it| it.is_of(&needs)) => {
                (replaces, rest)
            }
            _ => {
                let found = format!("{:?}", rest.first());
                return wrong("replaces", found, "at most 16 clusters of what it needs");
            }
        };
        let row = Self {
            signature: Signature::from_bytes(signature),
            samples,
            vertices,
            needs,
            replaces,
            ..row
        };
        Ok((row, rest))
    }
}

/// The parts that a row is shown in place of, and what is behind them.
fn read_replaces(bytes: &[u8]) -> Option<(Vec<PartRef>, &[u8])> {
    let (count, rest) = bytes.split_first()?;
    let count = usize::from(*count);
    let (parts, rest) = rest.split_at_checked(count)?;
    let parts = parts.iter().copied().map(PartRef::from_byte);
    (count <= MOST_PARTS).then(|| (parts.collect(), rest))
}

/// The table of these units, in their order, with so many rows in a page; each level begins one.
#[must_use]
pub fn write_units(rows: &[UnitRow], page_rows: u32, numbers: &UnitNumbers) -> Vec<u8> {
    let written: Vec<Vec<u8>> = (0..).zip(rows).map(|(unit, row)| row.write(unit)).collect();
    let starts: Vec<u32> = numbers.pages().iter().map(|page| page.start).collect();
    write_pages(&written, page_rows, &starts)
}

/// Reads the rows of a page.
///
/// # Errors
/// A wrong checksum, or invalid rows.
///
/// # Panics
/// The directory must have such a page.
pub fn read_units(
    directory: &PageDirectory,
    page: u32,
    bytes: &[u8],
) -> Result<Vec<UnitRow>, PackError> {
    directory.check(page, bytes)?;
    let mut rest = bytes;
    let mut rows = Vec::new();
    for unit in directory.rows(page) {
        let (row, behind) = UnitRow::read(unit, rest)?;
        rows.push(row);
        rest = behind;
    }
    match rest.len() {
        0 => Ok(rows),
        left => {
            let field = format!("table {UNITS}, page {page}");
            let found = format!("{left} bytes behind its rows");
            Err(PackError::new(&field, found, "none"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<UnitRow> {
        let row = |unit: u32| UnitRow {
            kind: UnitKind::ALL[unit as usize % 3],
            object: (unit % 3) as u16,
            centre: [unit as f32, -1.5, 2.0],
            radius: 10.0 / (unit + 1) as f32,
            error: if unit == 0 { f32::INFINITY } else { 0.1 },
            samples: unit * 97,
            vertices: unit * 31,
            signature: Signature::from_bytes([unit as u8; Signature::BYTES]),
            needs: (0..unit.min(3)).map(UnitId).collect(),
            replaces: (0..unit.min(3) as u8).map(PartRef::from_byte).collect(),
        };
        (0..40).map(row).collect()
    }

    #[test]
    fn rows_come_back_as_they_were_written_page_by_page() {
        let numbers = UnitNumbers::in_pages_of(8, &[30, 9, 1]).unwrap();
        let table = write_units(&rows(), 8, &numbers);
        let directory = PageDirectory::parse(&table, 40, table.len() as u64).unwrap();
        let mut back = Vec::new();
        for page in 0..directory.len() {
            let place = directory.place(page);
            let bytes = &table[place.start as usize..place.end as usize];
            back.extend(read_units(&directory, page, bytes).unwrap());
        }
        assert_eq!(back, rows());
        assert_eq!(directory.rows(0), 0..1, "the root has a page of its own");
    }

    #[test]
    fn no_row_panics_whatever_its_bytes_are() {
        let good = rows()[30].write(30);
        for place in 0..good.len() {
            for bit in 0..8 {
                let mut bad = good.clone();
                bad[place] ^= 1 << bit;
                let _ = UnitRow::read(30, &bad);
            }
            assert!(UnitRow::read(30, &good[..place]).is_err(), "cut at {place}");
        }
        assert!(
            UnitRow::read(1, &good).is_err(),
            "it would need units before the first"
        );
    }
}
