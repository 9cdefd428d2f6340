//! What was chosen, in which order?

/// One unit raised, by one level or several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Number of the unit in the catalog.
    pub unit: u32,
    /// The level it had: held, or chosen before in the same selection.
    pub from: u8,
    /// The finer level it gets.
    pub level: u8,
    /// Bytes this adds. Where a finer level replaces the coarser and this unit was chosen before
    /// in the same selection, that choice falls away, and this is what the finer level costs more.
    pub bytes: u64,
    /// Value this adds, the sum over the levels between.
    pub value: f64,
}

/// A finished selection.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// The steps, best first. Every beginning of them meets its own prerequisites.
    pub choices: Vec<Choice>,
    /// Bytes of all of them; never more than the budget.
    pub bytes: u64,
    /// Value of all of them.
    pub value: f64,
}

impl FromIterator<Choice> for Plan {
    fn from_iter<I: IntoIterator<Item = Choice>>(choices: I) -> Self {
        let choices: Vec<Choice> = choices.into_iter().collect();
        Self {
            bytes: choices.iter().map(|choice| choice.bytes).sum(),
            value: choices.iter().map(|choice| choice.value).sum(),
            choices,
        }
    }
}
