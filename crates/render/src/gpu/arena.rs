//! Which stretch of a buffer is free?

use std::collections::BTreeMap;

/// The free stretches of a line of equal places; those that touch are one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Arena {
    free: BTreeMap<u32, u32>,
    length: u32,
}

impl Arena {
    /// So many places, all free.
    pub(crate) fn new(length: u32) -> Self {
        let mut arena = Self::default();
        arena.grow(length);
        arena
    }

    /// Number of places, free or not.
    pub(crate) fn length(&self) -> u32 {
        self.length
    }

    /// Whether `count` places in a row are free.
    pub(crate) fn has_place(&self, count: u32) -> bool {
        count == 0 || self.free.values().any(|length| *length >= count)
    }

    /// Number of places that are free.
    pub(crate) fn free(&self) -> u32 {
        self.free.values().sum()
    }

    /// Takes `count` places in a row, the first that are free; `None` where there are none.
    pub(crate) fn take(&mut self, count: u32) -> Option<u32> {
        if count == 0 {
            return Some(0);
        }
        let fitting = self.free.iter().find(|(_, length)| **length >= count);
        let (start, length) = fitting.map(|(start, length)| (*start, *length))?;
        self.free.remove(&start);
        if length > count {
            self.free.insert(start + count, length - count);
        }
        Some(start)
    }

    /// Gives back what [`Self::take`] gave.
    pub(crate) fn give_back(&mut self, start: u32, count: u32) {
        if count == 0 {
            return;
        }
        let (mut start, mut count) = (start, count);
        if let Some(after) = self.free.remove(&(start + count)) {
            count += after;
        }
        let before = self.free.range(..start).next_back();
        let before = before.map(|(start, length)| (*start, *length));
        if let Some((earlier, length)) = before
            && earlier + length == start
        {
            (start, count) = (earlier, length + count);
        }
        self.free.insert(start, count);
    }

    /// Adds free places at the end until there are `length`.
    pub(crate) fn grow(&mut self, length: u32) {
        let old = std::mem::replace(&mut self.length, length);
        self.give_back(old, length - old);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_never_overlaps_and_comes_back_whole() {
        let mut arena = Arena::new(100);
        let mut taken: Vec<(u32, u32)> = Vec::new();
        let mut state = 1_u32;
        for _ in 0..2000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let count = (state >> 24) % 12 + 1;
            if let Some(start) = arena.take(count) {
                let apart =
                    |(at, length): &(u32, u32)| start + count <= *at || at + length <= start;
                assert!(taken.iter().all(apart) && start + count <= arena.length());
                taken.push((start, count));
            } else {
                let (start, count) = taken.swap_remove(state as usize % taken.len());
                arena.give_back(start, count);
            }
        }
        for (start, count) in taken {
            arena.give_back(start, count);
        }
        assert_eq!(arena, Arena::new(100));
    }

    #[test]
    fn growth_adds_to_what_is_free_at_the_end() {
        let mut arena = Arena::new(4);
        assert_eq!(arena.take(3), Some(0));
        assert_eq!(arena.take(2), None);
        arena.grow(5);
        assert_eq!(arena.take(2), Some(3));
    }
}
