//! Which units does a client hold in main memory, and which does it let go?
//!
//! The bytes of a unit stay after they were decoded, so that what is chosen again is not fetched
//! again. What is chosen now is held whatever it takes; of the rest, what is worth least goes
//! first where all of it would take more than the bound.

use crate::content::unit::{Unit, UnitRef};
use std::collections::HashMap;

/// By how many choices longer a unit is held than one of the next finer level: it stands in for
/// several of these, and takes less.
const CHOICES_A_LEVEL: u64 = 64;
/// Shares of the bound that become free at once.
const FREED: u64 = 8;

/// How little is lost with a unit that was chosen last at a choice, by the number of that: the
/// least goes first. What was in view last is likely to be again.
pub(super) fn worth_of(level: u8, chosen: u64) -> u64 {
    chosen + CHOICES_A_LEVEL * u64::from(level)
}

/// What the bytes of a unit that came are to a client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fetched {
    /// They were there.
    Held,
    /// They came for the first time.
    First,
    /// They came before, and were let go.
    Again,
}

/// The units whose bytes a client holds.
#[derive(Debug)]
pub(super) struct ClientMemory {
    most: u64,
    bytes: u64,
    held: HashMap<UnitRef, HeldUnit>,
    /// A bit for each unit of each asset that came once.
    came: Vec<Vec<u64>>,
    /// Number of the last choice.
    choice: u64,
}

#[derive(Clone, Copy, Debug)]
struct HeldUnit {
    bytes: u32,
    level: u8,
    /// Number of the last choice that wanted it.
    chosen: u64,
}

impl ClientMemory {
    /// Nothing yet, of at most so many bytes.
    pub(super) fn new(most: u64) -> Self {
        Self {
            most,
            bytes: 0,
            held: HashMap::new(),
            came: Vec::new(),
            choice: 0,
        }
    }

    /// Number of the last choice.
    pub(super) fn choice(&self) -> u64 {
        self.choice
    }

    /// These are chosen from now on.
    pub(super) fn choose(&mut self, units: impl Iterator<Item = UnitRef>) {
        self.choice += 1;
        for unit in units {
            if let Some(held) = self.held.get_mut(&unit) {
                held.chosen = self.choice;
            }
        }
    }

    /// The bytes of a unit are there.
    pub(super) fn receive(&mut self, unit: UnitRef, about: &Unit) -> Fetched {
        let held = HeldUnit {
            bytes: about.bytes.unwrap_or(0),
            level: about.level,
            chosen: self.choice,
        };
        if self.held.contains_key(&unit) {
            return Fetched::Held;
        }
        self.held.insert(unit, held);
        self.bytes += u64::from(held.bytes);
        if self.bytes > self.most {
            self.shrink();
        }
        match self.mark(unit) {
            true => Fetched::Again,
            false => Fetched::First,
        }
    }

    /// Records that a unit came; whether it had before.
    fn mark(&mut self, unit: UnitRef) -> bool {
        let (asset, number) = (usize::from(unit.asset.0), unit.unit.0 as usize);
        if self.came.len() <= asset {
            self.came.resize(asset + 1, Vec::new());
        }
        let bits = &mut self.came[asset];
        let (word, bit) = (number / 64, 1 << (number % 64));
        if bits.len() <= word {
            bits.resize(word + 1, 0);
        }
        let had = bits[word] & bit > 0;
        bits[word] |= bit;
        had
    }

    /// Lets go of what is worth least, but for what is chosen now.
    fn shrink(&mut self) {
        let idle = self.held.iter().filter(|(_, it)| it.chosen < self.choice);
        let mut idle: Vec<(u64, UnitRef)> = idle
            .map(|(unit, it)| (worth_of(it.level, it.chosen), *unit))
            .collect();
        idle.sort_unstable();
        let most = self.most - self.most / FREED;
        for (_, unit) in idle {
            if self.bytes <= most {
                return;
            }
            let gone = self.held.remove(&unit);
            self.bytes -= gone.map_or(0, |gone| u64::from(gone.bytes));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::unit::AssetId;
    use crate::pack::unit::UnitId;

    fn unit(number: u32) -> UnitRef {
        UnitRef {
            asset: AssetId::ONLY,
            unit: UnitId(number),
        }
    }

    fn about(level: u8) -> Unit {
        Unit {
            level,
            bytes: Some(100),
            samples: 1,
            gpu_bytes: 1,
            frames: 0..1,
        }
    }

    #[test]
    fn what_is_worth_least_goes_first_and_is_fetched_again() {
        let mut memory = ClientMemory::new(800);
        // Units 0 and 1 are coarse; what has a larger number was chosen later.
        for number in 0..8 {
            memory.choose([unit(number)].into_iter());
            let level = u8::from(number < 2);
            assert_eq!(memory.receive(unit(number), &about(level)), Fetched::First);
        }
        memory.choose([unit(8)].into_iter());
        assert_eq!(memory.receive(unit(8), &about(0)), Fetched::First);
        assert_eq!(memory.bytes, 700);
        let mut came = |number| memory.receive(unit(number), &about(0));
        assert_eq!([0, 1, 4, 8].map(&mut came), [Fetched::Held; 4]);
        assert_eq!(came(2), Fetched::Again);
    }

    #[test]
    fn what_is_chosen_is_held_whatever_it_takes() {
        let mut memory = ClientMemory::new(250);
        memory.choose((0..5).map(unit));
        for number in 0..5 {
            memory.receive(unit(number), &about(0));
        }
        assert_eq!(memory.bytes, 500);
        memory.choose([unit(9)].into_iter());
        memory.receive(unit(9), &about(0));
        assert!(memory.bytes <= 250 && memory.held.contains_key(&unit(9)));
    }
}
