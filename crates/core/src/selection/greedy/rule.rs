//! By which rule are steps offered and misfits met?

/// What happens when the best step does not fit into what is left of the budget.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Misfit {
    /// Nothing more is chosen. Then what a budget buys is the beginning of what a larger one buys,
    /// and more bytes are never worth less.
    #[default]
    Stop,
    /// It is left out and the next best is tried (Chen et al. 2022).
    Skip,
}

/// How far one step may go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reach {
    /// To the next corner of the upper convex hull of the unit's (bytes, value) curve: a poor step
    /// before a rich one is taken together with it.
    #[default]
    Hull,
    /// One level at a time (Chen et al. 2022): a poor step hides what lies behind it.
    Level,
}

/// How steps are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rule {
    /// How far one step may go.
    pub reach: Reach,
    /// What happens when the best step does not fit.
    pub misfit: Misfit,
}

impl Rule {
    /// Chen et al. 2022 (Instant Reality), section 3: the unit with the most value per byte that
    /// still fits is raised one level. Other than theirs, a step without value is never taken.
    pub const PAPER: Self = Self {
        reach: Reach::Level,
        misfit: Misfit::Skip,
    };
}
