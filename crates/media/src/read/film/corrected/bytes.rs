//! Which bytes of a file are replaced while it is read?

/// Bytes that replace those of a file, and what was wrong.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Corrections {
    /// Where they stand in the file, and what they are to be.
    pub(in crate::read) bytes: Vec<(u64, Vec<u8>)>,
    /// In words, for people.
    pub(crate) told: Vec<String>,
}

impl Corrections {
    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Corrects bytes that stand at a place in the file.
    pub(in crate::read) fn correct(&self, at: u64, bytes: &mut [u8]) {
        let end = at + bytes.len() as u64;
        for (place, right) in &self.bytes {
            for (place, byte) in (*place..)
                .zip(right)
                .filter(|(it, _)| (at..end).contains(it))
            {
                bytes[(place - at) as usize] = *byte;
            }
        }
    }
}
