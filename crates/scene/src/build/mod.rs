//! How does a scene become units?
