//! How much of the GPU's memory is taken, by whom, and how much is left?

/// Bytes of the GPU's memory that one of those who share it takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TakenBytes {
    /// What lies there.
    pub used: u64,
    /// The same, and what is kept for more.
    pub held: u64,
}

/// One ledger of the bytes that layers of units, and pictures of them, take of the GPU's memory.
///
/// All units together may use what was promised to them. They may hold an eighth more, so that what
/// is free seldom lies in too small pieces; pictures and tables take their bytes out of that bound.
#[derive(Clone, Debug)]
pub(crate) struct GpuRoom {
    most: TakenBytes,
    layers: Vec<TakenBytes>,
    pictures: u64,
    tables: u64,
}

impl GpuRoom {
    /// Nothing is taken so far; units may use `most_bytes`.
    pub(crate) fn new(most_bytes: u64) -> Self {
        Self {
            most: TakenBytes {
                used: most_bytes,
                held: most_bytes.saturating_add(most_bytes / 8),
            },
            layers: Vec::new(),
            pictures: 0,
            tables: 0,
        }
    }

    /// From now on these are the bytes that each layer takes, in order, that pictures take and that
    /// tables of units take.
    pub(crate) fn balance(
        &mut self,
        layers: impl Iterator<Item = TakenBytes>,
        pictures: u64,
        tables: u64,
    ) {
        self.layers.clear();
        self.layers.extend(layers);
        self.pictures = pictures;
        self.tables = tables;
    }

    /// Bytes that a layer may take, its own so far among them.
    pub(crate) fn left_for(&self, layer: usize) -> TakenBytes {
        let promised = self.promised_to(layer);
        TakenBytes {
            held: promised.held.saturating_sub(self.pictures + self.tables),
            ..promised
        }
    }

    /// The same as if there were no pictures and tables: units that were promised room have it,
    /// even where these leave less than that.
    pub(crate) fn promised_to(&self, layer: usize) -> TakenBytes {
        let others = self.layers.iter().enumerate().filter(|(k, _)| *k != layer);
        let sum = |all: TakenBytes, (_, it): (usize, &TakenBytes)| TakenBytes {
            used: all.used + it.used,
            held: all.held + it.held,
        };
        let others = others.fold(TakenBytes::default(), sum);
        TakenBytes {
            used: self.most.used.saturating_sub(others.used),
            held: self.most.held.saturating_sub(others.held),
        }
    }

    /// Bytes that units may use so that all they hold fits next to the pictures.
    pub(crate) fn for_units(&self) -> u64 {
        let left = self.most.held.saturating_sub(self.pictures);
        self.most.used.min(left - left / 9)
    }

    /// Whether more is held than may be.
    pub(crate) fn is_over(&self) -> bool {
        let held: u64 = self.layers.iter().map(|it| it.held).sum();
        held + self.pictures + self.tables > self.most.held
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(used: u64, held: u64) -> TakenBytes {
        TakenBytes { used, held }
    }

    #[test]
    fn a_layer_has_what_others_and_pictures_leave_and_always_what_was_promised() {
        let mut room = GpuRoom::new(800);
        assert_eq!(room.for_units(), 800);
        room.balance(
            [taken(300, 400), taken(0, 50), taken(100, 100)].into_iter(),
            200,
            50,
        );
        assert_eq!(room.left_for(0), taken(700, 500));
        assert_eq!(room.promised_to(0), taken(700, 750));
        assert_eq!(room.left_for(2), taken(500, 200));
        assert!(!room.is_over());
        // The pictures leave 700, of which an eighth of what is used lies idle.
        assert_eq!(room.for_units(), 623);
    }

    #[test]
    fn what_is_taken_too_much_leaves_nothing_and_is_seen() {
        let mut room = GpuRoom::new(800);
        room.balance([taken(900, 1000), taken(0, 0)].into_iter(), 2000, 0);
        assert!(room.is_over());
        assert_eq!(room.left_for(1), taken(0, 0));
        assert_eq!(room.for_units(), 0);
        room.balance([].into_iter(), 0, 901);
        assert!(room.is_over());
        room.balance([].into_iter(), 0, 900);
        assert!(!room.is_over());
    }
}
