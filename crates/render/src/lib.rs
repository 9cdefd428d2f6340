//! Draws what is resident: planes in, picture out.
