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
const UNITS: [(&str, f64); 3] = [("g", 1e9), ("m", 1e6), ("k", 1e3)];
/// How bits per second are written after a letter of [`UNITS`], in any case.
const BITS: [&str; 10] = [
    "bit", "bits", "bit/s", "bits/s", "bitps", "bps", "b/s", "bit/sec", "b", "bits/sec",
];
/// How bytes per second are written, in this case only: eight times as many bits.
const BYTES: [&str; 3] = ["B", "B/s", "Bps"];

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

/// Bits per second of `4g`, `40mbit`, `4 Mbps`, `2 MB/s` and the like.
pub(crate) fn parse_rate(text: &str) -> Option<f64> {
    let is_named = |(name, _): &&(&str, f64)| name.eq_ignore_ascii_case(text);
    if let Some((_, rate)) = NAMED.iter().find(is_named) {
        return Some(*rate);
    }
    let is_of_number = |it: char| it.is_ascii_digit() || matches!(it, '.' | '-' | '+' | ' ');
    let (number, unit) = text.split_at(text.find(|it| !is_of_number(it))?);
    let (prefix, rest) = unit.split_at_checked(1)?;
    let is_prefix = |(letter, _): &&(&str, f64)| letter.eq_ignore_ascii_case(prefix);
    let (_, many) = UNITS.iter().find(is_prefix)?;
    let bits = match BYTES.contains(&rest) {
        true => 8.0,
        false => BITS
            .iter()
            .find(|it| it.eq_ignore_ascii_case(rest))
            .map(|_| 1.0)?,
    };
    let rate = number.trim().parse::<f64>().ok()? * many * bits;
    (1e3..=1e11).contains(&rate).then_some(rate)
}

/// Reads a delay as `30ms` or `0.03s`, at most ten seconds.
pub(crate) fn parse_delay(text: &str) -> anyhow::Result<Seconds> {
    let plain = text.to_ascii_lowercase();
    let (number, unit_ms) = match (plain.strip_suffix("ms"), plain.strip_suffix('s')) {
        (None, Some(seconds)) => (seconds, 1e3),
        (ms, _) => (ms.unwrap_or(&plain), 1.0),
    };
    let ms = number.trim().parse::<f64>().map(|number| number * unit_ms);
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
        for text in [
            "4mbit",
            "4Mbit",
            "4 MBit/s",
            "4 Mbps",
            "4MBPS",
            "4 mb/s",
            "4.0 Mbits/s",
            "4Mb",
            "4000 kbit",
            "4000KBPS",
            "0.004Gbit/sec",
            "0.5MB/s",
            "500 kB/s",
            "+4MBIT",
        ] {
            assert_eq!(link(text), (5e5, 0.0), "{text}");
        }
        assert_eq!(link("4G, 30 MS"), (5e6, 0.03));
        assert_eq!(link("5G,0.03s"), (67e6 / 8.0, 0.03));
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
            "4mib/s",
            "4 m",
            "4bit",
            "mbit4",
            "4\u{20ac}bit",
            "\u{20ac}",
            "4mbit,1h",
        ] {
            assert!(parse_link(text).is_err(), "{text}");
        }
    }
}
