//! How is an amount of bytes written?

use anyhow::bail;

/// Letters and bytes, as on the packing of memory cards.
const UNITS: [(&str, f64); 3] = [("kb", 1e3), ("mb", 1e6), ("gb", 1e9)];
/// What memory is asked for, in bytes.
const MEMORY: std::ops::RangeInclusive<f64> = 1e6..=1e12;
/// What may be spent at once, in bytes.
const BUDGET: std::ops::RangeInclusive<f64> = 1e3..=1e9;

/// Reads `32MB`, `1.5GB` and the like: 1 MB to 1000 GB.
pub(crate) fn parse_memory(text: &str) -> anyhow::Result<u64> {
    match bytes_of(text).filter(|bytes| MEMORY.contains(bytes)) {
        Some(bytes) => Ok(bytes as u64),
        None => bail!("expected 1MB to 1000GB, as 256MB"),
    }
}

/// Reads `100KB` and the like, which a budget brings: 1 kB to 1 GB.
pub(crate) fn parse_budget(text: &str) -> anyhow::Result<u64> {
    match bytes_of(text).filter(|bytes| BUDGET.contains(bytes)) {
        Some(bytes) => Ok(bytes as u64),
        None => bail!("expected 1KB to 1GB, as 100KB"),
    }
}

/// A number and a unit.
fn bytes_of(text: &str) -> Option<f64> {
    let small = text.trim().to_lowercase();
    let unit = |(name, unit): &(&str, f64)| Some((small.strip_suffix(name)?, *unit));
    let (number, unit) = UNITS.iter().find_map(unit)?;
    Some(number.trim().parse::<f64>().ok()? * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_a_number_and_a_unit() {
        for (text, bytes) in [
            ("32MB", 32_000_000),
            ("1GB", 1_000_000_000),
            ("1.5 gb", 1_500_000_000),
            ("2000kB", 2_000_000),
        ] {
            assert_eq!(parse_memory(text).unwrap(), bytes, "{text}");
        }
        for text in ["", "MB", "256", "1kB", "-1MB", "nanMB", "2000GB", "1TB"] {
            assert!(parse_memory(text).is_err(), "{text}");
        }
        assert_eq!(parse_budget("100KB").unwrap(), 100_000);
        assert!(parse_budget("2GB").is_err() && parse_budget("0KB").is_err());
    }
}
