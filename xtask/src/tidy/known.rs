//! Which breaches are older than the rule they break, and which of those are gone?
//!
//! Rules that came late have a list of what broke them then. It may only grow shorter.

use std::collections::BTreeMap;

use super::Finding;

/// One a line: the check, what breaks it, and where it counts something, the most there may be.
pub(super) const LIST: &str = "xtask/known-breaches.txt";

/// A broken rule that may be listed.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Breach {
    check: &'static str,
    /// Stays the same as long as the breach does; holds no line number.
    key: String,
    /// How many there are, where the rule is a limit.
    count: Option<usize>,
    finding: Finding,
}

impl Breach {
    pub(super) fn new(check: &'static str, key: impl Into<String>, finding: Finding) -> Self {
        Self {
            check,
            key: key.into(),
            count: None,
            finding,
        }
    }

    pub(super) fn counting(self, count: usize) -> Self {
        Self {
            count: Some(count),
            ..self
        }
    }

    fn name(&self) -> String {
        format!("{} {}", self.check, self.key)
    }

    /// The line of the list that would allow it, and what it is.
    pub(super) fn told(&self) -> String {
        let count = self
            .count
            .map_or(String::new(), |count| format!(" {count}"));
        format!("{}{count}\n    {}", self.name(), self.finding)
    }

    #[cfg(test)]
    pub(super) fn key(&self) -> &str {
        &self.key
    }
}

/// What is not on the list, and lines of the list that nothing breaks any more.
pub(super) fn unlisted(list: &str, breaches: &[Breach]) -> Vec<Finding> {
    let lines = (1..).zip(list.lines());
    let lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let mut known: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    let mut findings = Vec::new();
    for (number, line) in lines {
        let limit = line.rsplit_once(' ');
        let limit = limit.and_then(|(name, most)| Some((name, most.parse().ok()?)));
        let (name, most) = limit.unwrap_or((line, 1));
        if known.insert(name, (number, most)).is_some() {
            findings.push(Finding::new(LIST, number, "listed twice: remove this line"));
        }
    }
    let mut met = Vec::new();
    for breach in breaches {
        let name = breach.name();
        match known.get(name.as_str()) {
            Some((_, most)) if breach.count.unwrap_or(1) <= *most => {}
            Some((_, most)) => {
                let mut finding = breach.finding.clone();
                finding.message += &format!(" (it was {most} when this was first checked)");
                findings.push(finding);
            }
            None => findings.push(breach.finding.clone()),
        }
        met.push(name);
    }
    let gone = known
        .iter()
        .filter(|(name, _)| !met.iter().any(|met| met == *name));
    findings.extend(gone.map(|(name, (number, _))| {
        let message = format!("`{name}` no longer occurs: remove this line");
        Finding::new(LIST, *number, message)
    }));
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn breach(key: &str) -> Breach {
        Breach::new("rule", key, Finding::new("a.rs", 3, "wrong"))
    }

    #[test]
    fn a_breach_that_is_listed_passes_and_one_that_is_not_does_not() {
        let list = "# Known.\n\nrule a -> b\n";
        assert!(unlisted(list, &[breach("a -> b")]).is_empty());
        let found = unlisted(list, &[breach("a -> b"), breach("b -> a")]);
        assert_eq!(found, [Finding::new("a.rs", 3, "wrong")]);
    }

    #[test]
    fn a_listed_breach_that_no_longer_occurs_is_to_be_removed() {
        let found = unlisted("rule a\nrule b\n", &[breach("a")]);
        let message = "`rule b` no longer occurs: remove this line";
        assert_eq!(found, [Finding::new(LIST, 2, message)]);
        assert_eq!(unlisted("rule a\nrule a\n", &[breach("a")]).len(), 1);
    }

    #[test]
    fn a_count_may_fall_and_not_rise() {
        let found = |count| unlisted("rule folder 17\n", &[breach("folder").counting(count)]);
        assert!(found(16).is_empty());
        assert!(found(17).is_empty());
        assert!(found(18)[0].message.contains("it was 17"));
    }
}
