//! Which number does a vertex have in a small part of a mesh?

/// No vertex.
const NONE: u32 = u32::MAX;

/// Numbers vertices in the order in which they are first named.
#[derive(Clone, Debug)]
pub(super) struct Numbering {
    /// Open addressing: a vertex and its number.
    slots: Vec<[u32; 2]>,
    /// The vertices by their numbers.
    pub vertices: Vec<u32>,
}

impl Numbering {
    /// Room for about this many vertices.
    pub(super) fn new(about: usize) -> Self {
        Self {
            slots: vec![[NONE; 2]; (2 * about).next_power_of_two().max(16)],
            vertices: Vec::with_capacity(about),
        }
    }

    /// The slot of a vertex, or the free one where it belongs.
    fn slot(&self, vertex: u32) -> usize {
        let last = self.slots.len() - 1;
        // Fibonacci hashing (Knuth, TAOCP 3, 6.4).
        let mut at = (vertex.wrapping_mul(0x9e37_79b9) >> 7) as usize & last;
        while self.slots[at][0] != vertex && self.slots[at][0] != NONE {
            at = (at + 1) & last;
        }
        at
    }

    /// The number of a vertex, a new one if it has none.
    pub(super) fn number(&mut self, vertex: u32) -> u32 {
        let at = self.slot(vertex);
        if self.slots[at][0] == vertex {
            return self.slots[at][1];
        }
        let number = self.vertices.len() as u32;
        self.slots[at] = [vertex, number];
        self.vertices.push(vertex);
        if 2 * self.vertices.len() > self.slots.len() {
            self.double();
        }
        number
    }

    fn double(&mut self) {
        self.slots = vec![[NONE; 2]; 2 * self.slots.len()];
        for number in 0..self.vertices.len() {
            let vertex = self.vertices[number];
            let at = self.slot(vertex);
            self.slots[at] = [vertex, number as u32];
        }
    }
}

/// Hashes keys of one integer or two by a multiplication whose halves are folded: faster than what
/// the standard library does against chosen keys, and a file that is slow to build does no
/// other harm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fold(u64);

impl Fold {
    fn fold(&mut self, key: u64) {
        // The fraction of the golden ratio (Knuth, TAOCP 3, 6.4).
        let product = u128::from(self.0 ^ key) * 0x9e37_79b9_7f4a_7c15;
        self.0 = (product >> 64) as u64 ^ product as u64;
    }
}

impl std::hash::Hasher for Fold {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|it| self.fold(u64::from(*it)));
    }

    fn write_u64(&mut self, key: u64) {
        self.fold(key);
    }

    fn write_u128(&mut self, key: u128) {
        self.fold(key as u64);
        self.fold((key >> 64) as u64);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

/// A map whose keys are few integers.
pub(super) type IntegerMap<K, V> =
    std::collections::HashMap<K, V, std::hash::BuildHasherDefault<Fold>>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_count_up_and_stay() {
        let mut numbering = Numbering::new(1);
        let vertices: Vec<u32> = (0..1000).map(|it| it * 7919 % 4096).collect();
        let numbers: Vec<u32> = vertices.iter().map(|it| numbering.number(*it)).collect();
        assert_eq!(numbers, (0..1000).collect::<Vec<_>>());
        assert_eq!(numbering.number(vertices[500]), 500);
        assert_eq!(numbering.vertices, vertices);
    }
}
