//! By which rules do levels cost, are steps offered and misfits met?

/// How the levels of a unit relate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chain {
    /// A level adds to the coarser ones: going several levels costs the bytes of all of them.
    Refining,
    /// A level replaces the coarser ones: going to it costs its own bytes, whatever is held.
    Replacing,
}

/// What happens when the best step does not fit into what is left of the budget.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Misfit {
    /// It is left out, or where it spans several levels cut to what fits, and the next best is
    /// tried (Chen et al. 2022). At least 99 % of the optimum from ten largest steps on
    /// (docs/decisions/0004-what-does-not-fit-is-skipped.md).
    ///
    /// More bytes are never worth less, on hulls and without prerequisites: take the first step A
    /// of `a` bytes that the larger budget takes and the smaller, with `r < a` bytes left, does
    /// not. All that the smaller can still take is no denser than A, so worth at most `r` times its
    /// density: less than A alone.
    #[default]
    Skip,
    /// Nothing more is chosen. What a budget buys is then the beginning of what a larger one buys,
    /// and falls short of the optimum by less than the step that did not fit: for a small budget
    /// that can be several percent, for 2,000 steps it is nothing. For a budget whose rest counts
    /// for the next selection: who goes on spends what the best step would need.
    Stop,
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
