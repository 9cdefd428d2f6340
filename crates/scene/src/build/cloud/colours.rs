//! Of how many bits are the colours of a cloud, and what is their mean?

/// How colours are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Codes {
    /// Bits of a code: 8 or 16.
    pub(super) bits: u8,
    /// What codes of 8 bits were multiplied by in the file.
    pub(super) times: u16,
}

impl Codes {
    /// How these are stored: in eight bits where all of them are such times 1, 257 or 256.
    pub(super) fn of(colours: &[[u16; 3]]) -> Self {
        let all = colours.as_flattened();
        let eight = |times: u16| Self { bits: 8, times };
        if all.iter().all(|it| *it < 256) {
            return eight(1);
        }
        let fitting = [257, 256].into_iter();
        let mut fitting = fitting.filter(|times| all.iter().all(|it| it.is_multiple_of(*times)));
        fitting.next().map_or(Self { bits: 16, times: 1 }, eight)
    }

    /// How a colour of the file is stored.
    pub(super) fn told(&self, colour: [u16; 3]) -> [u16; 3] {
        colour.map(|it| it / self.times)
    }
}

/// Colours that are mixed. The mean is that of squares, nearly as light adds up.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mix {
    squares: [u64; 3],
    count: u64,
}

impl Mix {
    pub(super) fn add(&mut self, colour: [u16; 3]) {
        self.count += 1;
        for (sum, code) in self.squares.iter_mut().zip(colour) {
            *sum += u64::from(code).pow(2);
        }
    }

    /// The mean, rounded; black of none.
    pub(super) fn mean(&self) -> [u16; 3] {
        let count = self.count.max(1) as f64;
        self.squares
            .map(|it| (it as f64 / count).sqrt().round() as u16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_bits_are_found_in_sixteen() {
        let of = |colour: [u16; 3]| {
            let codes = Codes::of(&[[0; 3], colour]);
            (codes.bits, codes.times, codes.told(colour))
        };
        assert_eq!(of([255, 3, 9]), (8, 1, [255, 3, 9]));
        assert_eq!(of([257, 65_535, 0]), (8, 257, [1, 255, 0]));
        assert_eq!(of([256, 65_280, 0]), (8, 256, [1, 255, 0]));
        assert_eq!(of([256, 65_281, 0]), (16, 1, [256, 65_281, 0]));
    }

    #[test]
    fn the_mean_of_one_colour_is_that_colour() {
        let mut mix = Mix::default();
        assert_eq!(mix.mean(), [0; 3]);
        (0..9).for_each(|_| mix.add([65_535, 12_345, 7]));
        assert_eq!(mix.mean(), [65_535, 12_345, 7]);
    }
}
