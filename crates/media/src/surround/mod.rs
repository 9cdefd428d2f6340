//! How an input surrounds the eyes: by metadata, name and size.

pub mod camera;
pub(crate) mod clean_aperture;
pub mod cube_layout;
pub mod eye_layout;
pub(crate) mod found;
pub(crate) mod name_words;
pub mod photo_sphere;
pub mod sphere_part;
pub mod spherical;
pub mod spherical_boxes;
