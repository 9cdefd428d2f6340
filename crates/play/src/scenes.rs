//! What happens between a gaze and a picture of a scene, step by step?
//!
//! Choose, fetch, parse, draw: steps come one by one, as fast as they can be made, at times that
//! the caller gives.

use crate::at_once::AtOnce;
use crate::error::PlayError;
use crate::making::Made;
use crate::options::PlayerOptions;
use crate::player::Player;
use crate::rendered_worth::RenderedWorth;
use foveal_core::content::opened::Opened;
use foveal_core::content::policy::{ImportanceSource, Policy};
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::{Now, Pace, SessionEvent};
use foveal_core::session::bounds::Bounds;
use foveal_core::session::decoder::{PackBytes, Parser};
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::mounted::MountedPanel;
use foveal_media::pack::scene_file::SceneFile;
use foveal_render::params::Overlay;
use foveal_render::{DrawDevice, Drawer, RgbaImage};
use std::sync::Arc;

impl Player {
    /// A player of an open scene, without a window.
    ///
    /// # Errors
    /// It cannot be drawn.
    pub fn of_scene(file: &Arc<SceneFile>, options: PlayerOptions) -> Result<Self, PlayError> {
        let opened = Opened::Scene(Arc::clone(file.scene()));
        // What draws may take an eighth more than units do.
        let most = options.gpu_bytes - options.gpu_bytes / 8;
        let drawer = Drawer::of_scene(&options.drawing, file.scene(), most)?;
        let config = &options.config;
        let is_rendered =
            config.policy == Policy::Perceptual && config.importance == ImportanceSource::Rendered;
        let rendered = match &options.drawing {
            DrawDevice::Gpu(gpu) if is_rendered => {
                Some(RenderedWorth::new(file, gpu, &config.perception))
            }
            _ => None,
        };
        let bytes = PackBytes::new(opened.content(), file.source());
        let supply = Box::new(AtOnce::new(bytes, Box::<Parser>::default()));
        let bounds = Bounds {
            gpu: most,
            ..Bounds::default()
        };
        let measures = !matches!(options.drawing, DrawDevice::Nothing);
        let settings = options.settings(measures, bounds);
        let mut player = Self::new(opened, settings, drawer, supply, options.tell);
        player.run.rendered = rendered;
        Ok(player)
    }

    /// The same, every moment of which is seen through panels that turn with its head.
    #[must_use]
    pub fn through(mut self, panels: Vec<MountedPanel>) -> Self {
        self.session_mut().take(SessionEvent::Mounted(panels));
        self
    }

    /// Chooses, fetches and hands to what draws what a viewer gets who looks so at `time`, until
    /// which the link has brought what is spent.
    ///
    /// # Errors
    /// All roots are damaged, or the device was lost.
    pub fn stand(&mut self, time: Seconds, moment: &Moment) -> Result<Made, PlayError> {
        let now = Now {
            wall: time,
            media: Seconds(0.0),
            pace: Pace::Standing,
            drawing: Seconds(0.0),
            until: time,
            moment: moment.clone(),
        };
        self.make(0, &now, None)
    }

    /// The picture that a view shows, with the colours of levels over it if `levels`; `None` when
    /// nothing draws. What a viewer would see change comes gradually: in a picture soon after
    /// [`Self::stand`] it is on its way.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn picture(
        &mut self,
        view: &EyeView,
        levels: bool,
    ) -> Result<Option<RgbaImage>, PlayError> {
        let marks = levels.then(Overlay::default);
        Ok(self.drawer_mut().picture(view, marks.as_ref())?)
    }

    /// The same with everything that came in its place.
    ///
    /// # Errors
    /// As there.
    pub fn picture_in_place(&mut self, view: &EyeView) -> Result<Option<RgbaImage>, PlayError> {
        let scene = self.drawer_mut().scene_mut();
        let picture = scene
            .map(|scene| scene.picture_in_place(view))
            .transpose()?;
        Ok(picture.flatten())
    }
}
