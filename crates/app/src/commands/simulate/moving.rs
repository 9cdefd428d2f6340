//! Where does a viewer of a scene stand and look, at any time?

use crate::gaze_source::{GazeChoice, GazeSource, ViewerModel};
use crate::report::output::{self, WrongUsage};
use anyhow::{Context, bail};
use foveal_core::content::scene::sight::Sphere;
use foveal_core::gaze::read::route::parse_route;
use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::Parameters;
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::route::{EyePose, Route};
use foveal_core::view::surface::{Screen, Surface};
use std::path::Path;

/// How far a gaze stays from the route's forward, in degrees.
const MOST_GAZE_DEG: f64 = 20.0;

/// Reads the value of `--route`.
pub(crate) fn route_of(text: &str) -> anyhow::Result<Route> {
    Ok(match text {
        "still" => Route::Still,
        "orbit" => Route::Orbit,
        file => {
            let forms = "give still, orbit or a file with t_s,x,y,z,yaw_deg,pitch_deg";
            let of_file = |what: &str| format!("--route {file}: {what}; {forms}");
            let text = output::read_text(Path::new(file), "a route")
                .with_context(|| of_file("cannot be read"))?;
            parse_route(&text).with_context(|| of_file("no route"))?
        }
    })
}

/// A viewer who moves along a route and looks around.
pub(crate) struct Mover {
    route: Route,
    gaze: GazeSource,
    bounds: Sphere,
    view: EyeView,
    /// What shows it in the place of that view, if anything.
    panels: Vec<MountedPanel>,
}

/// What is so of a viewer when a picture is shown.
pub(crate) struct Standing {
    /// Where the eye does look, in the world.
    pub(crate) gaze: GazeSample,
    /// What was known of that in time.
    pub(crate) moment: Moment,
}

impl Mover {
    /// Along `route` with a gaze that counts from its forward, for so long.
    pub(crate) fn new(
        (route, bounds): (Route, Sphere),
        choice: &GazeChoice,
        seed: u64,
        length: Seconds,
        viewer: &ViewerModel,
    ) -> anyhow::Result<Self> {
        match choice {
            GazeChoice::Head(_) | GazeChoice::Live(_) => bail!(WrongUsage(
                "--gaze: a scene is simulated with YAW,PITCH, center, scan or trace:FILE; a live \
                 gaze is for `foveal view`, a head for --route"
                    .to_owned()
            )),
            GazeChoice::At(at) if at.iter().any(|it| it.abs() > MOST_GAZE_DEG) => {
                bail!(output::out_of_range(
                    "--gaze",
                    format!("{},{}", at[0], at[1]),
                    "at most 20 degrees from the route's forward"
                ))
            }
            GazeChoice::At(_) | GazeChoice::Scan | GazeChoice::Trace(_) | GazeChoice::Table(..) => {
            }
        }
        // A gaze wanders over what lies within 20 degrees of straight ahead.
        let mut reach = Surface::flat([1000, 1000], Screen::default());
        reach.tangents = [MOST_GAZE_DEG.to_radians().tan(); 2];
        Ok(Self {
            gaze: GazeSource::new(choice, &reach, seed, length, viewer)?,
            route,
            bounds,
            view: EyeView::filling(&reach, [1, 1]),
            panels: Vec::new(),
        })
    }

    /// How long a recorded gaze lasts; 0 of every other.
    pub(crate) fn gaze_lasts(&self) -> Seconds {
        self.gaze.lasts()
    }

    /// The same through this view, wherever it is.
    pub(crate) fn through(self, view: EyeView) -> Self {
        Self { view, ..self }
    }

    /// The same through panels on the head, wherever that is, if there are any; a route that asks
    /// how much is shown goes by the first.
    pub(crate) fn on_panels(self, panels: Vec<MountedPanel>) -> Self {
        let ahead = panels
            .first()
            .map(|first| first.turned(&HeadPose::default()));
        Self {
            view: ahead.unwrap_or(self.view),
            panels,
            ..self
        }
    }

    /// The viewer at a time; times must not decrease.
    pub(crate) fn at(&mut self, time: Seconds, parameters: &Parameters) -> Standing {
        let look = self.gaze.look(time);
        let sphere = (self.bounds.centre, self.bounds.radius);
        let pose = self.route.pose(time, sphere, &self.view.field);
        let head = HeadPose::of(&pose.axes);
        let views = match self.panels.as_slice() {
            [] => vec![pose.view(&self.view)],
            panels => MountedPanel::views_from(panels, &head, pose.position),
        };
        let expected = &look.expected;
        Standing {
            gaze: in_world(&look.gaze, &pose),
            moment: Moment {
                gaze: in_world(&expected.gaze, &pose),
                head,
                state: parameters.eye_state(expected.event, expected.since_saccade),
                behind_sound: None,
                views,
            },
        }
    }
}

/// A gaze that counts from straight ahead, in the world.
fn in_world(gaze: &GazeSample, pose: &EyePose) -> GazeSample {
    GazeSample {
        gaze_in_content: pose.world_from_head(gaze.gaze_in_content).normalize(),
        ..*gaze
    }
}
