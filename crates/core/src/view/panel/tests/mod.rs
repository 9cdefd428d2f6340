//! Do panels look where Strege 2009's and note them do, and is the source placed as well as said?

mod goldens;
mod sets;
