//! What does an open pack hold, and what follows from its kind?

use super::demand::Content;
use super::policy::Policy;
use super::scene::Scene;
use super::scene::demand::why_not;
use super::scene::sight::Sphere;
use super::video::Video;
use crate::pack::unit::UnitId;
use crate::units::Radians;
use crate::view::navigation::Navigation;
use std::sync::Arc;

/// What follows from what a pack holds for those who play and show it.
#[derive(Clone, Copy, Debug)]
pub struct ContentFacts {
    /// What people call it.
    pub noun: &'static str,
    /// Whether a viewer moves through it; else they look at it from one place.
    pub is_entered: bool,
    /// Whether it is drawn of tiles, which are reconstructed, blurred and framed.
    pub has_tiles: bool,
    /// Whether what is visible of its units is measured on what was drawn.
    pub is_measured: bool,
    /// The policies of which a step of detail is a score that is asked for.
    pub scored: fn(Policy) -> bool,
    /// The policies for one eye where none is named: of content at hand, and through a link.
    pub usual_policies: [Policy; 2],
}

impl ContentFacts {
    /// Of a film or still.
    pub const VIDEO: Self = Self {
        noun: "video",
        is_entered: false,
        has_tiles: true,
        is_measured: false,
        scored: |policy| policy.has_target(),
        usual_policies: [Policy::Perceptual; 2],
    };
    /// Of a scene. Its score is unknown while levels are chosen, so a policy that buys by worth
    /// would buy all of what is at hand.
    pub const SCENE: Self = Self {
        noun: "scene",
        is_entered: true,
        has_tiles: false,
        is_measured: true,
        scored: |policy| matches!(policy, Policy::Acuity),
        usual_policies: [Policy::Acuity, Policy::Eccentricity],
    };
}

/// The content of a pack whose index has been read, or is read as it plays.
#[derive(Clone, Debug)]
pub enum Opened {
    /// A film or still, on the screen or sphere that it fills.
    Video(Arc<Video>),
    /// A scene of meshes and clouds.
    Scene(Arc<Scene>),
}

impl Opened {
    /// What follows from what it holds.
    #[must_use]
    pub fn facts(&self) -> &'static ContentFacts {
        match self {
            Self::Video(_) => &ContentFacts::VIDEO,
            Self::Scene(_) => &ContentFacts::SCENE,
        }
    }

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

    /// The units without which, all together, nothing can be shown of a frame: the tiles of the
    /// coarsest level, and the roots of meshes and clouds.
    #[must_use]
    pub fn roots(&self, frame: u32) -> Vec<UnitId> {
        match self {
            Self::Video(video) => video.base(frame),
            Self::Scene(scene) => {
                let pack = scene.pack();
                let is_root = |unit: &UnitId| {
                    let row = pack.row(*unit);
                    row.needs.is_empty() && row.kind.facts().is_shape
                };
                pack.units().filter(is_root).collect()
            }
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
