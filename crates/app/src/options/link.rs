//! What does `--link` say of the way between a pack and a viewer?

use anyhow::{Context, bail};
use foveal_core::units::Seconds;

/// A link of constant throughput.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Link {
    /// Infinite for content that lies at hand.
    pub(crate) bytes_per_s: f64,
    /// From asking until the first byte is there.
    pub(crate) delay: Seconds,
}

impl Default for Link {
    /// Content that lies at hand.
    fn default() -> Self {
        Self {
            bytes_per_s: f64::INFINITY,
            delay: Seconds(0.0),
        }
    }
}

/// Bits per second of the mobile networks that Chen et al. 2022 emulate.
const NAMED: [(&str, f64); 3] = [("3g", 2e6), ("4g", 40e6), ("5g", 67e6)];
const UNITS: [(&str, f64); 3] = [("gbit", 1e9), ("mbit", 1e6), ("kbit", 1e3)];

/// Reads `RATE[,DELAY]`: `4g`, `40mbit`, `8mbit,50ms`.
pub(crate) fn parse_link(text: &str) -> anyhow::Result<Link> {
    let mut parts = text.split(',').map(str::trim);
    let rate = parts.next().unwrap_or_default();
    let delay = parts.next().map_or(Ok(Seconds(0.0)), parse_delay)?;
    if parts.next().is_some() {
        bail!("expected RATE[,DELAY] as 4g,30ms; loss is not emulated");
    }
    let bits_per_s = parse_rate(rate).with_context(|| {
        format!("\"{rate}\": expected 3g, 4g, 5g or a rate of 1kbit to 100gbit, as 40mbit")
    })?;
    Ok(Link {
        bytes_per_s: bits_per_s / 8.0,
        delay,
    })
}

/// Bits per second of `4g`, `40mbit` and the like.
pub(crate) fn parse_rate(text: &str) -> Option<f64> {
    if let Some((_, rate)) = NAMED.iter().find(|(name, _)| *name == text) {
        return Some(*rate);
    }
    let (number, unit) = UNITS
        .iter()
        .find_map(|(name, unit)| Some((text.strip_suffix(name)?, unit)))?;
    let rate = number.trim().parse::<f64>().ok()? * unit;
    (1e3..=1e11).contains(&rate).then_some(rate)
}

/// Reads a delay as `30ms`, at most ten seconds.
pub(crate) fn parse_delay(text: &str) -> anyhow::Result<Seconds> {
    let ms = text
        .strip_suffix("ms")
        .unwrap_or(text)
        .trim()
        .parse::<f64>();
    match ms {
        Ok(ms) if (0.0..=10_000.0).contains(&ms) => Ok(Seconds(ms / 1e3)),
        _ => bail!("\"{text}\": expected a delay of 0 to 10000 ms, as 30ms"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_delays_are_read() {
        let link = |text: &str| {
            let link = parse_link(text).unwrap();
            (link.bytes_per_s, link.delay.0)
        };
        assert_eq!(link("4g"), (5e6, 0.0));
        assert_eq!(link("40mbit,30ms"), (5e6, 0.03));
        assert_eq!(link("0.5gbit, 5"), (62.5e6, 0.005));
    }

    #[test]
    fn what_is_no_link_is_refused() {
        for text in [
            "",
            "6g",
            "40",
            "mbit",
            "-1mbit",
            "nanmbit",
            "4g,x",
            "4g,-1ms",
            "4g,1ms,1%",
            "1e30gbit",
        ] {
            assert!(parse_link(text).is_err(), "{text}");
        }
    }
}
