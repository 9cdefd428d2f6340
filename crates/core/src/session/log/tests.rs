//! Does a log read back, and does what was given lead to the same choice?

use super::*;
use crate::content::policy::Policy;
use crate::content::scripted::scripted_demand;
use crate::content::video::demand::VideoDemand;
use crate::session::scripted::{scripted_session, scripted_sessions, scripted_sessions_over};
use crate::view::axes::Axes;
use crate::view::panel::tests::sets::six;
use crate::view::slant::Slant;
use crate::view::surface::{Screen, Surface};

/// A short run under a policy that is a rule.
fn flat_session(policy: Policy) -> SessionLogPart {
    let surface = Surface::flat([1920, 1080], Screen::default());
    scripted_session(surface, PolicyConfig::new(policy))
}

#[test]
fn a_written_log_reads_back_and_replays_to_the_same_text() {
    let flat = Surface::flat([1920, 1080], Screen::default());
    for session in scripted_sessions_over([Surface::cube(1024), flat]) {
        let text = session.write();
        let read = SessionLogPart::parse(&text).unwrap();
        assert_eq!(read, session);
        let again = read.replay(&|_, head, config| scripted_demand(head, config));
        assert_eq!(again.write(), text);
    }
}

#[test]
fn a_run_through_several_views_replays_to_the_same_text() {
    let mut session = flat_session(Policy::Viewport);
    let head = session.head.clone();
    let other = EyeView {
        position: DVec3::new(0.06, 1.6, 0.0),
        axes: HeadPose {
            yaw: Radians(-0.4),
            ..HeadPose::default()
        }
        .axes(),
        field: Field::symmetric([0.2; 2]),
        size: [300, 300],
        eye: Eye::Right,
    };
    let views = |moment: &Moment| vec![moment.views[0], other];
    let through_both = |frame: &SessionFrame| {
        let moment = frame.moment(&head);
        let views = views(&moment);
        let moment = Moment { views, ..moment };
        SessionFrame::new(frame.frame, &moment, None, &Record::default())
    };
    session.frames = session.frames.iter().map(through_both).collect();
    let both = views(&session.frames[0].moment(&head));
    session.head = SessionHead::new("two", head.content, head.policy, &both);
    let through_both = session.replay(&|_, head, config| scripted_demand(head, config));
    let text = through_both.write();
    let read = SessionLogPart::parse(&text).unwrap();
    assert_eq!(read, through_both);
    assert_eq!(
        read.replay(&|_, head, config| scripted_demand(head, config))
            .write(),
        text
    );
    let one_less = text.replacen("\"more_poses\":[{", "\"others\":[{", 1);
    let told = SessionLogPart::parse(&one_less).unwrap_err().to_string();
    assert!(
        told.starts_with("line 2: more_poses: found 0, expected 1"),
        "{told}"
    );
    // The second view looks where the first does not.
    let alone = flat_session(Policy::Viewport);
    assert_ne!(through_both.frames[0].sha256, alone.frames[0].sha256);
}

/// Six panels, turned through a run of any policy.
fn session_on_panels(policy: Policy) -> SessionLogPart {
    let config = PolicyConfig {
        together: true,
        ..PolicyConfig::new(policy)
    };
    let alone = scripted_session(Surface::cube(1024), config);
    let panels: Vec<MountedPanel> = six().iter().map(MountedPanel::of).collect();
    let head = alone.head.clone().on_panels(&panels);
    let through_all = |frame: &SessionFrame| {
        let roll = Radians(0.1 * f64::from(frame.frame));
        SessionFrame {
            head: HeadPose { roll, ..frame.head },
            ..frame.clone()
        }
    };
    let frames = alone.frames.iter().map(through_all).collect();
    let asked = SessionLogPart { head, frames };
    asked.replay(&|_, head, config| scripted_demand(head, config))
}

#[test]
fn a_run_on_six_panels_replays_to_the_same_text() {
    for policy in [Policy::Viewport, Policy::Acuity, Policy::Eccentricity] {
        let session = session_on_panels(policy);
        let text = session.write();
        let read = SessionLogPart::parse(&text).unwrap();
        assert_eq!(read, session);
        let again = read.replay(&|_, head, config| scripted_demand(head, config));
        assert_eq!(again.write(), text);
        assert!(!text.contains("more_poses"));
        assert_eq!(read.frames[2].moment(&read.head).views.len(), 6);
    }
}

#[test]
fn panels_of_a_log_that_nothing_is_seen_through_are_refused() {
    let text = session_on_panels(Policy::Viewport).write();
    let view =
        "{\"field\":{\"left\":1,\"right\":1,\"up\":1,\"down\":1},\"size\":[1,1],\"eye\":\"left\"}";
    let beside = format!("\"more_views\":[{view}],\"panels\":[");
    let right = "\"r0c0\",\"right\":[";
    let bent = "\"r0c0\",\"right\":[9,0,0],\"x\":[";
    for (was, is, told) in [
        ("[800,600]}]", "[800,0]}]", "panels, r1c2: size"),
        (right, bent, "r0c0: right"),
        ("\"panels\":[", beside.as_str(), "more_views: expected none"),
    ] {
        let changed = text.replacen(was, is, 1);
        assert_ne!(changed, text, "{was}");
        let error = SessionLogPart::parse(&changed).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn a_run_before_a_slanted_picture_replays_to_the_same_text_and_a_bent_one_is_refused() {
    let axes = Axes::from_yaw_pitch_roll(Radians(-0.3), Radians(0.1), Radians(0.05));
    let screen = Screen {
        slant: Some(Slant::new(axes, [0.1, -0.2])),
        ..Screen::default()
    };
    let surface = Surface::flat([3840, 2160], screen);
    let square = Surface::flat([3840, 2160], Screen::default());
    for policy in [Policy::Viewport, Policy::Acuity, Policy::Eccentricity] {
        let session = scripted_session(surface, PolicyConfig::new(policy));
        let text = session.write();
        let read = SessionLogPart::parse(&text).unwrap();
        assert_eq!(read, session);
        let again = read.replay(&|_, head, config| scripted_demand(head, config));
        assert_eq!(again.write(), text);
        let ahead = scripted_session(square, PolicyConfig::new(policy));
        assert_ne!(session.frames[0].sha256, ahead.frames[0].sha256);
        assert!(!ahead.write().contains("slant"));
        let bent = text.replacen(
            "\"slant\":{\"right\":[",
            "\"slant\":{\"right\":[9,0,0],\"x\":[",
            1,
        );
        let told = SessionLogPart::parse(&bent).unwrap_err().to_string();
        assert!(
            told.contains("slant: expected three unit vectors"),
            "{told}"
        );
        let nowhere = text.replacen("\"middle\":[", "\"middle\":[1e9,0],\"x\":[", 1);
        let told = SessionLogPart::parse(&nowhere).unwrap_err().to_string();
        assert!(told.contains("slant, middle"), "{told}");
    }
}

#[test]
fn every_policy_chooses_what_it_always_did() {
    let logs: String = scripted_sessions()
        .iter()
        .map(SessionLogPart::write)
        .collect();
    let expected = "4b83fb2cbdeb15692190b14700a2139dc04b3f44430fe1296f5596338df1bc53";
    assert_eq!(sha256_hex(logs.as_bytes()), expected);
}

#[test]
fn a_changed_gaze_changes_the_replay() {
    let mut session = flat_session(Policy::Acuity);
    session.frames[3].gaze = [1.0, 0.0, 0.0];
    let again = session.replay(&|_, head, config| Box::new(VideoDemand::of_head(head, config)));
    assert_ne!(again, session);
}

/// The grid of a log's head, as it stands there.
fn grid_of(text: &str) -> &str {
    let (_, grid) = text.split_once("\"grid\":").unwrap();
    grid.split_once(",\"policy\"").unwrap().0
}

#[test]
fn damaged_logs_are_refused_with_their_line() {
    let text = flat_session(Policy::Acuity).write();
    let third = text.replacen("\"frame\":1,", "\"frame\":x,", 1);
    assert!(
        SessionLogPart::parse(&third)
            .unwrap_err()
            .to_string()
            .starts_with("line 3")
    );
    let version = text.replacen("\"foveal_session\":1", "\"foveal_session\":9", 1);
    assert_eq!(
        SessionLogPart::parse(&version),
        Err(SessionError::Version { line: 1, found: 9 })
    );
    assert_eq!(SessionLogPart::parse(""), Err(SessionError::Empty));
    let newer = SessionLogPart::parse("{\"foveal_session\":2,\"other\":1}\n");
    assert_eq!(newer, Err(SessionError::Version { line: 1, found: 2 }));
    let asset = format!("{{\"pack\":\"x\",\"grid\":{}}}", grid_of(&text));
    let assets = format!("\"more\":[{}],\"policy\"", vec![asset; 70_000].join(","));
    let many = text.replacen("\"policy\"", &assets, 1);
    let told = SessionLogPart::parse(&many).unwrap_err().to_string();
    assert_eq!(told, "line 1: more: found 70000, at most 255 are replayed");
    let gaze = text.replacen("\"gaze\":[0.0,0.0,-1.0]", "\"gaze\":[0.0,0.0,-2.0]", 1);
    assert!(
        SessionLogPart::parse(&gaze)
            .unwrap_err()
            .to_string()
            .contains("length 2")
    );
}
