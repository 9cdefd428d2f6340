//! What should a person know of a preparation?

/// What is said of an input and of its pack, what matters most first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Remarks {
    /// What is lost, broken, or shown otherwise than the input means it.
    pub warnings: Vec<String>,
    /// What was found and done otherwise.
    pub notes: Vec<String>,
}

impl Remarks {
    /// The warnings, then the notes.
    #[must_use]
    pub fn all(&self) -> Vec<&str> {
        let all = self.warnings.iter().chain(&self.notes);
        all.map(String::as_str).collect()
    }

    pub(crate) fn warn(&mut self, text: String) {
        self.warnings.push(text);
    }

    pub(crate) fn note(&mut self, text: String) {
        self.notes.push(text);
    }
}
