//! Which score does a viewer ask for?

use crate::content::policy::{DEFAULT_TARGET, Policy, PolicyConfig};
use crate::perception::acuity::AcuityModel;
use core::ops::RangeInclusive;
use serde::{Deserialize, Serialize};

/// Scores that can be asked for, in JOD: 10 is every finest tile, which `full` shows.
pub const TARGETS: RangeInclusive<f64> = 1.0..=9.99;
/// Slopes that can be asked for, in degrees of a pixel a degree of eccentricity.
pub const SLOPES: RangeInclusive<f64> = 0.0..=1.0;

/// The scores that a key steps through, rising, before none.
const STEPS: [f64; 5] = [8.5, 9.0, 9.25, 9.5, 9.75];

/// How much detail is asked for, in addition to the policy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Detail {
    /// [`DEFAULT_TARGET`] for `acuity` and `perceptual`, none for others.
    #[default]
    Usual,
    /// What a score takes, in JOD; `None`: whatever is worth anything.
    Target(Option<f64>),
    /// Of `acuity`: what an eye sees whose smallest pixel grows so fast; of others as usual.
    Slope(f64),
}

impl Detail {
    /// A policy at this detail, its other parameters by default.
    ///
    /// ```
    /// use foveal_core::content::policy::asked::Detail;
    /// use foveal_core::content::policy::Policy;
    /// assert_eq!(Detail::Usual.of(Policy::Acuity).target, Some(9.5));
    /// assert_eq!(Detail::Target(Some(9.0)).of(Policy::Viewport).target, None);
    /// ```
    #[must_use]
    pub fn of(self, policy: Policy) -> PolicyConfig {
        let usual = policy.facts().keeps_a_score.then_some(DEFAULT_TARGET);
        let config = PolicyConfig::new(policy);
        match self {
            Self::Slope(slope) if policy == Policy::Acuity => PolicyConfig {
                acuity: AcuityModel::linear(slope),
                ..config
            },
            Self::Target(target) if policy.has_target() => PolicyConfig { target, ..config },
            _ => PolicyConfig {
                target: usual,
                ..config
            },
        }
    }
}

/// A score as people write it: a number, or `none`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Target {
    /// In JOD.
    Jod(f64),
    /// No score.
    None(NoTarget),
}

/// The word for no score.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NoTarget {
    /// As it is written.
    #[serde(rename = "none")]
    None,
}

impl Target {
    /// The score, if it is one that can be asked for.
    ///
    /// # Errors
    /// Says which can.
    pub fn checked(self) -> Result<Option<f64>, String> {
        match self {
            Self::None(_) => Ok(None),
            Self::Jod(jod) if TARGETS.contains(&jod) => Ok(Some(jod)),
            Self::Jod(jod) => Err(format!("target: found {jod}, expected 1 to 9.99 or none")),
        }
    }
}

/// The score that is so many steps on, or back, from `target`; after the highest comes none, and
/// after that the lowest.
#[must_use]
pub fn next_target(target: Option<f64>, by: i32) -> Option<f64> {
    let at = target.unwrap_or(f64::INFINITY);
    let (below, here) = STEPS.iter().fold((0, 0), |(below, here), step| {
        (below + i32::from(*step < at), here + i32::from(*step == at))
    });
    let count = STEPS.len() as i32 + 1;
    // Between two steps, the next is the one above, or the one below.
    let between = target.is_some() && here == 0 && by > 0;
    let next = (below + by - i32::from(between)).rem_euclid(count);
    STEPS.get(next as usize).copied()
}

/// How what is asked for and what is expected read to people.
///
/// ```
/// use foveal_core::content::policy::asked::score_told;
/// assert_eq!(score_told(Some(9.5), Some(9.56)), "9.5 asked, 9.56 expected");
/// assert_eq!(score_told(None, None), "none asked");
/// ```
#[must_use]
pub fn score_told(target: Option<f64>, expected: Option<f64>) -> String {
    let asked = target.map_or_else(|| "none".to_owned(), |jod| jod.to_string());
    let expected = expected.map(|jod| format!(", {jod:.2} expected"));
    format!("{asked} asked{}", expected.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_go_round_and_back() {
        let mut target = Some(8.5);
        let mut seen = Vec::new();
        for _ in 0..7 {
            seen.push(target);
            let next = next_target(target, 1);
            assert_eq!(next_target(next, -1), target);
            target = next;
        }
        let all = [Some(9.0), Some(9.25), Some(9.5), Some(9.75), None];
        assert_eq!(seen[1..6], all);
        assert_eq!(seen[6], Some(8.5));
    }

    #[test]
    fn from_between_two_steps_a_key_goes_to_one_of_them() {
        assert_eq!(next_target(Some(9.1), 1), Some(9.25));
        assert_eq!(next_target(Some(9.1), -1), Some(9.0));
        assert_eq!(next_target(Some(9.9), 1), None);
        assert_eq!(next_target(Some(5.0), -1), None);
    }

    #[test]
    fn detail_is_only_asked_of_policies_that_have_it() {
        let slope = Detail::Slope(0.011);
        assert_eq!(slope.of(Policy::Acuity).acuity, AcuityModel::linear(0.011));
        assert_eq!(slope.of(Policy::Acuity).target, None);
        assert_eq!(slope.of(Policy::Perceptual).target, Some(DEFAULT_TARGET));
        assert_eq!(Detail::Usual.of(Policy::Uniform).target, None);
        let nine = Detail::Target(Some(9.0));
        assert_eq!(nine.of(Policy::Uniform).target, Some(9.0));
        assert_eq!(nine.of(Policy::Full), PolicyConfig::new(Policy::Full));
        assert_eq!(Detail::Target(None).of(Policy::Acuity).target, None);
    }

    #[test]
    fn scores_that_cannot_be_asked_for_are_refused() {
        let read = |text| serde_json::from_str::<Target>(text).map(Target::checked);
        assert_eq!(read("9").unwrap(), Ok(Some(9.0)));
        assert_eq!(read("\"none\"").unwrap(), Ok(None));
        assert!(read("10").unwrap().is_err() && read("0.5").unwrap().is_err());
        assert!(read("\"high\"").is_err());
    }
}
