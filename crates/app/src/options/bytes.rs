//! How is an amount of memory written?

use anyhow::bail;

/// Letters and bytes, as on the packing of memory cards.
const UNITS: [(&str, f64); 3] = [("kb", 1e3), ("mb", 1e6), ("gb", 1e9)];
/// What memory is asked for, in bytes.
const RANGE: std::ops::RangeInclusive<f64> = 1e6..=1e12;

/// Reads `32MB`, `1.5GB` and the like: 1 MB to 1000 GB.
pub(crate) fn parse_memory(text: &str) -> anyhow::Result<u64> {
    let small = text.trim().to_lowercase();
    let unit = |(name, unit): &(&str, f64)| Some((small.strip_suffix(name)?, *unit));
    let found = UNITS.iter().find_map(unit);
    let number = found.and_then(|(number, unit)| Some(number.trim().parse::<f64>().ok()? * unit));
    match number.filter(|bytes| RANGE.contains(bytes)) {
        Some(bytes) => Ok(bytes as u64),
        None => bail!("expected 1MB to 1000GB, as 256MB"),
    }
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
    }
}
