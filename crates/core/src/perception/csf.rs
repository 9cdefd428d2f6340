//! How little contrast does a young eye need at its fovea?
//!
//! Barten 1990 in two forms: as Chen et al. 2022 print it, and with the term for the size of what
//! is looked at as Barten has it. Sources and tests: docs/papers.md, rows "contrast sensitivity".

use crate::units::{Cpd, Radians};

/// Which size term divides the sensitivity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SizeTerm {
    /// `1 / (1 + f/3)`: Chen et al. 2022, Eq. 12, without width and without the square.
    Printed,
    /// `12 / (w (1 + f/3)²)`: Barten 1990, with the angular width `w` of the display.
    Barten(Radians),
}

/// Contrast sensitivity (1 / threshold contrast) at a spatial frequency and an adapting luminance
/// in cd/m². 0 at 0 cycles per degree. Chen et al. 2022, Eq. 12; Barten 1990.
#[must_use]
pub fn barten(Cpd(f): Cpd, luminance: f64, size: SizeTerm) -> f64 {
    let size = match size {
        SizeTerm::Printed => 1.0 / (1.0 + f / 3.0),
        SizeTerm::Barten(width) => {
            let frequency = 1.0 + f / 3.0;
            12.0 / (width.to_degrees() * frequency * frequency)
        }
    };
    let a = 540.0 * libm::pow(1.0 + 0.7 / luminance, -0.2) / (1.0 + size);
    let b = 0.3 * libm::pow(1.0 + 100.0 / luminance, 0.15);
    a * f * libm::exp(-b * f) * (1.0 + 0.06 * libm::exp(b * f)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(f: f64, luminance: f64) -> f64 {
        barten(Cpd(f), luminance, SizeTerm::Printed)
    }

    fn corrected(f: f64) -> f64 {
        barten(Cpd(f), 100.0, SizeTerm::Barten(Radians::from_degrees(10.0)))
    }

    #[test]
    fn barten_sensitivity_has_the_golden_values() {
        for (f, paper, barten) in [
            (0.5, 127.203184, 125.547611),
            (1.0, 229.953481, 240.249906),
            (2.0, 366.057311, 409.002583),
            (3.0, 428.441647, 494.355746),
            (4.0, 441.720526, 517.064161),
            (8.0, 322.422442, 376.730319),
            (16.0, 132.351307, 148.797327),
            (24.0, 52.695530, 57.695836),
            (32.0, 18.939129, 20.382782),
            (60.0, 0.348251, 0.363844),
        ] {
            assert!((printed(f, 100.0) - paper).abs() < 1e-6, "{f}");
            assert!((corrected(f) - barten).abs() < 1e-6, "{f}");
        }
        for (f, luminance, expected) in [
            (4.0, 10.0, 308.779755),
            (4.0, 200.0, 465.224738),
            (16.0, 10.0, 58.377254),
            (16.0, 200.0, 149.604356),
        ] {
            assert!((printed(f, luminance) - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn barten_sensitivity_peaks_where_it_should() {
        let peak = |s: &dyn Fn(f64) -> f64| {
            (1..20_000)
                .map(|i| f64::from(i) / 2000.0)
                .map(|f| (f, s(f)))
                .fold((0.0, 0.0), |a, b| if b.1 > a.1 { b } else { a })
        };
        let (f, s) = peak(&|f| printed(f, 100.0));
        assert!(
            (f - 3.863).abs() < 1e-3 && (s - 442.0027).abs() < 1e-4,
            "{f} {s}"
        );
        let (f, s) = peak(&corrected);
        assert!(
            (f - 3.994).abs() < 1e-3 && (s - 517.0649).abs() < 1e-4,
            "{f} {s}"
        );
    }
}
