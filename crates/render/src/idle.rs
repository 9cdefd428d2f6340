//! What stays in memory without being drawn, and what of it gives way first?

use std::collections::HashSet;
use std::hash::Hash;

/// Units, by their numbers or places, that are not drawn and stay where they lie: in what would be
/// free otherwise, until their places are needed. Nothing grows because of them.
#[derive(Clone, Debug)]
pub struct IdleUnits<K> {
    /// First what is to stay longest; each after those that it needs.
    order: Vec<K>,
    /// Those that are about to be drawn again.
    spared: HashSet<K>,
    /// Those that gave way and are not reported yet.
    evicted: Vec<K>,
}

impl<K> Default for IdleUnits<K> {
    fn default() -> Self {
        Self {
            order: Vec::new(),
            spared: HashSet::new(),
            evicted: Vec::new(),
        }
    }
}

impl<K: Copy + Eq + Hash> IdleUnits<K> {
    /// From now on these are idle, first what is to stay longest.
    pub fn set(&mut self, order: Vec<K>) {
        self.order = order;
    }

    /// These do not give way, until others are spared.
    pub fn spare(&mut self, units: &[K]) {
        self.spared = units.iter().copied().collect();
    }

    /// A unit is not idle any more.
    pub fn remove(&mut self, unit: K) {
        self.order.retain(|it| *it != unit);
    }

    /// The next unit that gives way.
    pub fn give_way(&mut self) -> Option<K> {
        let is_free = |unit: &K| !self.spared.contains(unit);
        let place = self.order.iter().rposition(is_free)?;
        let unit = self.order.remove(place);
        self.evicted.push(unit);
        Some(unit)
    }

    /// What gave way since this was last asked.
    pub fn take_evicted(&mut self) -> Vec<K> {
        std::mem::take(&mut self.evicted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_to_stay_longest_gives_way_last_and_what_is_spared_never() {
        let mut idle = IdleUnits::default();
        idle.set(vec![7, 5, 9, 4]);
        idle.spare(&[9]);
        idle.remove(5);
        assert_eq!(idle.give_way(), Some(4));
        assert_eq!(idle.give_way(), Some(7));
        assert_eq!(idle.give_way(), None);
        assert_eq!(idle.take_evicted(), [4, 7]);
        assert!(idle.take_evicted().is_empty());
    }
}
