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
    /// Room for this many vertices.
    pub(super) fn new(most: usize) -> Self {
        Self {
            slots: vec![[NONE; 2]; (2 * most).next_power_of_two().max(16)],
            vertices: Vec::with_capacity(most),
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

    /// The number of a vertex, a new one if it has none; no more than there is room for.
    pub(super) fn number(&mut self, vertex: u32) -> u32 {
        let at = self.slot(vertex);
        if self.slots[at][0] == NONE {
            self.slots[at] = [vertex, self.vertices.len() as u32];
            self.vertices.push(vertex);
        }
        self.slots[at][1]
    }
}
