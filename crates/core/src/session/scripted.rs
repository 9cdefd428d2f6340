//! What does every policy choose in a scripted run?

use crate::content::demand::Content;
use crate::content::policy::PolicyConfig;
use crate::content::scripted::{SCRIPTED_POLICIES, scripted_demand, scripted_head};
use crate::gaze::sample::{GazeSample, HeadPose};
use crate::gaze::scan::ScanPath;
use crate::perception::moment::Moment;
use crate::selection::scheduler::Scheduler;
use crate::session::log::{SessionFrame, SessionHead, SessionLogPart};
use crate::units::{Radians, Seconds};
use crate::view::eye_view::{EyeView, Field};
use crate::view::route::Route;
use crate::view::surface::{Screen, Surface};
use glam::DVec3;
use std::sync::Arc;

/// A scripted run over a 16K cube and a flat picture under every policy, as logs: the same text on
/// every machine, natively and in wasm.
#[must_use]
pub fn scripted_sessions() -> Vec<SessionLogPart> {
    let flat = Surface::flat([3840, 2160], Screen::default());
    scripted_sessions_over([Surface::cube(4096), flat])
}

/// A scripted run over each surface under every policy.
pub(super) fn scripted_sessions_over(surfaces: [Surface; 2]) -> Vec<SessionLogPart> {
    let runs = surfaces.iter().flat_map(|surface| {
        let configs = SCRIPTED_POLICIES.map(PolicyConfig::new);
        configs.map(|config| scripted_session(*surface, config))
    });
    runs.collect()
}

/// What is chosen of content by a policy over two seconds, ten moments a second, while the eye goes
/// round a sphere of the content, its middle and its radius in metres, and looks past its middle.
#[must_use]
pub fn scripted_flight(
    content: Arc<dyn Content>,
    sphere: (DVec3, f64),
    config: PolicyConfig,
) -> SessionLogPart {
    let head = content.head();
    let demand = content.demand(&head, &config);
    let mut scheduler = Scheduler::new(&config, vec![demand]);
    let view = window();
    let pose = |frame: u32| Route::Orbit.pose(Seconds(f64::from(frame) * 0.6), sphere, &view.field);
    let frames = (0..20).map(|frame| {
        let pose = pose(frame);
        let turn = HeadPose::of(&pose.axes);
        let beside = Radians(0.3 * libm::sin(f64::from(frame)));
        let gaze = GazeSample {
            head: Some(turn),
            ..GazeSample::at(
                Seconds(f64::from(frame) * 0.1),
                Radians(turn.yaw.0 + beside.0),
                turn.pitch,
            )
        };
        let seen = EyeView {
            position: pose.position,
            axes: turn.axes(),
            ..view
        };
        let moment = Moment {
            head: turn,
            ..Moment::new(gaze, vec![seen])
        };
        let budget = Some(4000);
        let chosen = scheduler.choose(&[0], &moment, budget);
        SessionFrame::new(0, &moment, budget, &chosen[0].record)
    });
    SessionLogPart {
        frames: frames.collect(),
        head: SessionHead::new("scripted", head, config, &[view]),
    }
}

fn window() -> EyeView {
    let size = [1280, 720];
    EyeView {
        position: Default::default(),
        axes: HeadPose::default().axes(),
        field: Field::across(Radians::from_degrees(100.0), size),
        size,
        eye: Default::default(),
    }
}

/// Two seconds of a scan over a surface, ten frames a second, with a head that turns.
pub(super) fn scripted_session(surface: Surface, config: PolicyConfig) -> SessionLogPart {
    let head = scripted_head(surface);
    let config = PolicyConfig {
        saliency: true,
        noise_threshold: Some(3000.0),
        ..config
    };
    let mut path = ScanPath::new(&surface, 7);
    let demand = scripted_demand(&head, &config);
    let mut scheduler = Scheduler::new(&config, vec![demand]);
    let view = window();
    let frames = (0..20).map(|frame| {
        let gaze = path.at(Seconds(f64::from(frame) * 0.1)).0;
        let head = HeadPose {
            yaw: Radians(f64::from(frame) * 0.05),
            ..HeadPose::default()
        };
        let axes = head.axes();
        let moment = Moment {
            head,
            ..Moment::new(gaze, vec![EyeView { axes, ..view }])
        };
        let budget = Some(40_000);
        let chosen = scheduler.choose(&[frame], &moment, budget);
        SessionFrame::new(frame, &moment, budget, &chosen[0].record)
    });
    SessionLogPart {
        frames: frames.collect(),
        head: SessionHead::new("scripted", head, config, &[view]),
    }
}
