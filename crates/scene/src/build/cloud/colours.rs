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

/// The intensity that is white: that of the last hundredth, so that a few that are far above all
/// others leave these their contrast; 0 of none. The largest code stands for more than can be
/// measured, and does not count unless most have it.
pub(super) fn white_of(intensities: impl Iterator<Item = u16>) -> u16 {
    let mut counts = vec![0_u64; usize::from(u16::MAX) + 1];
    let mut all = 0;
    for intensity in intensities {
        counts[usize::from(intensity)] += 1;
        all += 1;
    }
    let saturated = counts[usize::from(u16::MAX)];
    if 2 * saturated <= all {
        counts[usize::from(u16::MAX)] = 0;
        all -= saturated;
    }
    let mut above = all / 100;
    for (intensity, count) in (0..=u16::MAX).zip(&counts).rev() {
        if *count > above && intensity > 0 {
            return intensity;
        }
        above = above.saturating_sub(*count);
    }
    // All but a few are black.
    let most = (0..=u16::MAX).zip(&counts).rev();
    most.into_iter().find(|it| *it.1 > 0).map_or(0, |it| it.0)
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
    fn a_few_bright_intensities_leave_the_others_their_contrast() {
        let of = |bright: usize, with: u16| {
            let dark = (0..1000).map(|it| 500 + it % 100);
            white_of(dark.chain(std::iter::repeat_n(with, bright)))
        };
        assert_eq!(
            (of(0, 0), of(300, u16::MAX), of(5, 60_000)),
            (598, 598, 599)
        );
        assert_eq!(of(500, 60_000), 60_000);
        assert_eq!(white_of(std::iter::repeat_n(u16::MAX, 9)), u16::MAX);
        assert_eq!(white_of([0; 900].into_iter().chain([7])), 7);
        assert_eq!(
            (white_of([0; 9].into_iter()), white_of(std::iter::empty())),
            (0, 0)
        );
    }

    #[test]
    fn the_mean_of_one_colour_is_that_colour() {
        let mut mix = Mix::default();
        assert_eq!(mix.mean(), [0; 3]);
        (0..9).for_each(|_| mix.add([65_535, 12_345, 7]));
        assert_eq!(mix.mean(), [65_535, 12_345, 7]);
    }
}
