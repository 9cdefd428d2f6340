//! What is a point of a cloud?

use crate::pack::PackError;

/// A point of a cloud; what its object's points have not is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CloudPoint {
    /// Its place on the grid of its object, in steps along each axis.
    pub place: [u32; 3],
    /// Red, green and blue as codes of the file, of eight or sixteen bits as the object says.
    pub colour: [u16; 3],
    /// How much light came back to the scanner.
    pub intensity: u16,
    /// What it lies on, as the file counts it.
    pub class: u8,
}

/// What is missing to the own colour of a point that is shown in a mean one.
pub type Correction = [i32; 3];

/// What is wrong with points.
pub(super) fn wrong(what: &str, found: impl ToString, expected: impl ToString) -> PackError {
    PackError::new(
        &format!("points, {what}"),
        found.to_string(),
        expected.to_string(),
    )
}
