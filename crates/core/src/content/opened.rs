//! What does an open pack hold, and what follows from its kind?

use super::demand::Content;
use super::policy::Policy;
use super::scene::Scene;
use super::scene::demand::why_not;
use super::scene::sight::Sphere;
use super::video::Video;
use crate::units::Radians;
use crate::view::navigation::Navigation;
use std::sync::Arc;

/// The content of a pack whose index has been read, or is read as it plays.
#[derive(Clone, Debug)]
pub enum Opened {
    /// A film or still, on the screen or sphere that it fills.
    Video(Arc<Video>),
    /// A scene of meshes and clouds.
    Scene(Arc<Scene>),
}

impl Opened {
    /// What a session chooses from.
    #[must_use]
    pub fn content(&self) -> Arc<dyn Content> {
        match self {
            Self::Video(video) => Arc::clone(video) as Arc<dyn Content>,
            Self::Scene(scene) => Arc::clone(scene) as Arc<dyn Content>,
        }
    }

    /// The video; `None` of a scene.
    #[must_use]
    pub fn video(&self) -> Option<&Arc<Video>> {
        match self {
            Self::Video(video) => Some(video),
            Self::Scene(_) => None,
        }
    }

    /// The scene; `None` of a video.
    #[must_use]
    pub fn scene(&self) -> Option<&Arc<Scene>> {
        match self {
            Self::Video(_) => None,
            Self::Scene(scene) => Some(scene),
        }
    }

    /// Where a viewer begins, whose view is `field` wide: flat content whole, a sphere towards its
    /// front, and a scene from where all of it is in view.
    #[must_use]
    pub fn navigation(&self, field: Radians) -> Navigation {
        match self {
            Self::Video(video) => {
                let front = Radians::from_degrees(video.pack().description().front_deg);
                Navigation::new(video.grid().surface, field).facing(front)
            }
            Self::Scene(scene) => {
                let Sphere { centre, radius } = scene.bounds();
                Navigation::through((centre, radius), scene.rise(), field)
            }
        }
    }

    /// Why a policy cannot choose from it, whatever tables it has; `None` where it can.
    #[must_use]
    pub fn why_not(&self, policy: Policy) -> Option<&'static str> {
        match self {
            Self::Video(_) => None,
            Self::Scene(_) => why_not(policy),
        }
    }
}
