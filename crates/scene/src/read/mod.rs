//! How do files become a scene?
