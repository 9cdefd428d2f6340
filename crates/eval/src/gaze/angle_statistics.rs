//! How large are the errors of a predictor, in one line?

use serde::Serialize;

/// Errors of a predictor over all samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AngleStatistics {
    /// Mean angle in degrees.
    pub mean_deg: f64,
    /// Median angle in degrees.
    pub median_deg: f64,
    /// 90th percentile in degrees.
    pub p90_deg: f64,
    /// 95th percentile in degrees.
    pub p95_deg: f64,
    /// Share of samples within 5 degrees.
    pub within_5_deg_share: f64,
    /// Share of samples within 10 degrees.
    pub within_10_deg_share: f64,
    /// Share of samples within 15 degrees.
    pub within_15_deg_share: f64,
}

impl AngleStatistics {
    /// The statistics of angles in degrees; all 0 of none. Sorts, so it costs n log n.
    #[must_use]
    pub fn of(mut angles_deg: Vec<f64>) -> Self {
        if angles_deg.is_empty() {
            return Self::default();
        }
        let mean_deg = mean(&angles_deg);
        angles_deg.sort_unstable_by(f64::total_cmp);
        let count = angles_deg.len() as f64;
        let within = |most: f64| angles_deg.partition_point(|&angle| angle <= most) as f64 / count;
        Self {
            mean_deg,
            median_deg: percentile(&angles_deg, 0.5),
            p90_deg: percentile(&angles_deg, 0.9),
            p95_deg: percentile(&angles_deg, 0.95),
            within_5_deg_share: within(5.0),
            within_10_deg_share: within(10.0),
            within_15_deg_share: within(15.0),
        }
    }
}

/// The mean; 0 of nothing.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / (values.len().max(1)) as f64
}

/// The value below which a share of sorted values lies, linear between neighbours.
fn percentile(sorted: &[f64], share: f64) -> f64 {
    let at = share * (sorted.len() - 1) as f64;
    let below = at as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (sorted[above] - sorted[below]) * (at - below as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_steps_have_their_percentiles_and_shares() {
        let found = AngleStatistics::of((0..=20).rev().map(f64::from).collect());
        assert_eq!((found.mean_deg, found.median_deg), (10.0, 10.0));
        assert_eq!((found.p90_deg, found.p95_deg), (18.0, 19.0));
        assert_eq!(found.within_5_deg_share, 6.0 / 21.0);
        assert_eq!(
            (found.within_10_deg_share, found.within_15_deg_share),
            (11.0 / 21.0, 16.0 / 21.0)
        );
    }

    #[test]
    fn nothing_and_one_angle_have_statistics() {
        assert_eq!(AngleStatistics::of(Vec::new()), AngleStatistics::default());
        assert_eq!(AngleStatistics::of(vec![7.0]).p95_deg, 7.0);
    }
}
