//! Does `prepare` keep what is there, and say what it takes an input for?

mod again;
mod pictures;
mod quality;
mod told;
