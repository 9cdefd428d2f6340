//! What is a row of the table of formats?

/// What the program does with the files of one format.
#[derive(serde::Serialize)]
pub(crate) struct Format {
    /// As its users name it, with the ends of its file names.
    pub name: &'static str,
    /// What of the format is read, and what is left out.
    pub read: &'static str,
    /// What such files have been found to hold, and what comes of it.
    pub rows: &'static [Finding],
}

/// Something a file may hold that another program would stumble over.
#[derive(serde::Serialize)]
pub(crate) struct Finding {
    pub found: &'static str,
    pub outcome: Outcome,
    /// What is shown instead, and the words or the name in `repairs` that report it.
    pub told: &'static str,
}

/// What comes of it.
#[derive(Clone, Copy, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Outcome {
    /// Shown as it was meant, without a word.
    Read,
    /// Mended, and counted in `repairs`.
    Mended,
    /// Shown as far as it can be, with a remark.
    Remarked,
    /// An error: there is nothing to show, or what is right cannot be known.
    Refused,
}

impl Outcome {
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Mended => "mended",
            Self::Remarked => "remarked",
            Self::Refused => "refused",
        }
    }
}
