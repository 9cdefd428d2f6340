//! Where does a pixel point? Axes, the surfaces that content lies on, and the views that show it.

pub mod axes;
pub mod eye_view;
pub mod flight;
pub mod frustum;
pub mod head_pose;
pub mod keys;
pub mod mounted;
pub mod navigation;
pub mod panel;
pub mod picture;
pub mod random;
pub mod route;
pub mod slant;
pub mod surface;
pub mod timeline;
