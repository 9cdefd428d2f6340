//! Is what a window shows where the viewer went?

use super::*;
use proptest::prelude::*;

fn pane(size: [u32; 2]) -> Pane {
    Pane::new(size, [1920, 1080], Screen::default())
}

fn flat(size: [u32; 2]) -> Navigation {
    Navigation::new(Surface::flat(size, Screen::default()), Radians(1.0))
}

fn content_at(scene: &Navigation, pane: &Pane, place: [f64; 2]) -> [f64; 2] {
    let shown = scene.shown(pane);
    let ray = shown.view.ray(shown.in_picture(place));
    let Place::Before(surface) = scene.place else {
        panic!("not flat");
    };
    surface.locate(ray).unwrap().1
}

#[test]
fn whole_flat_content_is_the_view_that_it_fills() {
    let scene = flat([1920, 1080]);
    let shown = scene.shown(&pane([960, 540]));
    let surface = Surface::flat([1920, 1080], Screen::default());
    let filling = EyeView::filling(&surface, [960, 540]);
    assert_eq!(shown.origin, [0, 0]);
    assert_eq!(
        Field {
            at_eye: None,
            ..shown.view.field
        },
        filling.field
    );
    let boxed = scene.shown(&pane([960, 740]));
    assert_eq!((boxed.origin, boxed.view.size), ([0, 100], [960, 540]));
    assert_eq!(
        Field {
            at_eye: None,
            ..boxed.view.field
        },
        filling.field
    );
}

#[test]
fn a_window_fills_the_same_angle_at_the_eye_however_far_it_is_zoomed() {
    let mut scene = Navigation::new(Surface::cube(4096), Radians::from_degrees(100.0));
    let pane = pane([1920, 1080]);
    let before = scene.shown(&pane).view;
    scene.zoom_by(20.0, [0.0, 0.0], &pane);
    let after = scene.shown(&pane).view;
    assert_eq!(before.field.at_eye, after.field.at_eye);
    assert!(after.field.left < before.field.left / 19.0);
    // 24 inches at 0.6 m, 16:9: 47.7° across.
    let across = before.as_seen().field.left.atan() * 2.0;
    assert!((across.to_degrees() - 47.77).abs() < 0.1);
}

#[test]
fn a_window_held_upright_shows_the_same_angle_along_its_longer_side() {
    let mut scene = Navigation::new(Surface::cube(4096), Radians::from_degrees(100.0));
    let (upright, lying) = (pane([360, 640]), pane([640, 360]));
    let [tall, wide] = [upright, lying].map(|pane| scene.shown(&pane).view.field);
    assert_eq!((tall.up, tall.left), (wide.left, wide.up));
    assert!((tall.up.atan().to_degrees() - 50.0).abs() < 1e-9);
    assert_eq!(scene.scale(&upright), scene.scale(&lying));
    // A hand draws along what is under it, however the window is held.
    scene.drag([0.0, 1.0], &upright);
    scene.drag([0.0, -1.0], &lying);
    assert!(scene.head().pitch.0.abs() < 1e-15);
}

#[test]
fn the_wheel_ends_where_one_pixel_is_thirty_two() {
    let mut scene = flat([16_384, 8192]);
    let pane = pane([1280, 800]);
    (0..200).for_each(|_| scene.zoom_by(1.25, [100.0, 700.0], &pane));
    assert!((scene.scale(&pane) - CLOSEST).abs() < 1e-9);
    (0..200).for_each(|_| scene.zoom_by(0.8, [100.0, 700.0], &pane));
    assert_eq!(scene.shown(&pane), flat([16_384, 8192]).shown(&pane));
}

#[test]
fn dragging_a_sphere_turns_the_head_against_the_hand_and_never_over_the_top() {
    let mut scene = Navigation::new(Surface::cube(1024), Radians::from_degrees(90.0));
    let pane = pane([1000, 1000]);
    scene.drag([10.0, 0.0], &pane);
    assert!((scene.head().yaw.0 + 0.02).abs() < 1e-12);
    scene.drag([0.0, 1e6], &pane);
    assert!((scene.head().pitch.to_degrees() - STEEPEST_DEG).abs() < 1e-9);
}

#[test]
fn a_view_that_was_told_is_found_again_by_what_is_told_of_it() {
    let mut scene = Navigation::new(Surface::cube(1024), Radians::from_degrees(100.0));
    let pane = pane([1000, 600]);
    assert!((scene.field().to_degrees() - 100.0).abs() < 1e-9);
    let degrees = |degrees: f64| Some(Radians::from_degrees(degrees));
    scene.look([degrees(-350.0), degrees(20.0), degrees(60.0)], &pane);
    assert!((scene.head().yaw.to_degrees() - 10.0).abs() < 1e-9);
    assert!((scene.head().pitch.to_degrees() - 20.0).abs() < 1e-9);
    assert!((scene.field().to_degrees() - 60.0).abs() < 1e-9);
    let across = scene.shown(&pane).view.field.left.atan() * 2.0;
    assert!((across.to_degrees() - 60.0).abs() < 1e-9);
    scene.look([None, degrees(-90.0), None], &pane);
    assert!((scene.head().pitch.to_degrees() + STEEPEST_DEG).abs() < 1e-9);
    assert!((scene.field().to_degrees() - 60.0).abs() < 1e-9);
    // Wider and closer than may be is as wide and as close as may be.
    scene.look([None, None, degrees(170.0)], &pane);
    assert!((scene.field().to_degrees() - 2.0 * WIDEST_HALF_DEG).abs() < 1e-9);
    scene.look([None, None, degrees(1e-3)], &pane);
    assert!((scene.scale(&pane) - CLOSEST).abs() < 1e-6);
    let mut plane = flat([640, 360]);
    plane.look([degrees(10.0), degrees(10.0), degrees(10.0)], &pane);
    assert_eq!(plane, flat([640, 360]));
}

#[test]
fn a_view_begins_at_its_front_and_goes_back_there() {
    let pane = pane([1000, 600]);
    let sphere = Navigation::new(Surface::cube(1024), Radians::from_degrees(100.0));
    let mut scene = sphere.facing(Radians::from_degrees(200.0));
    assert!((scene.head().yaw.to_degrees() + 160.0).abs() < 1e-9);
    let begun = scene;
    scene.drag([30.0, 40.0], &pane);
    assert_ne!(scene, begun);
    scene.reset();
    assert_eq!(scene, begun);
    let plane = flat([640, 360]);
    assert_eq!(plane.facing(Radians(1.0)), plane);
}

#[test]
fn a_hand_turns_a_led_head_on_and_takes_the_gaze_along() {
    let mut scene = Navigation::new(Surface::cube(1024), Radians::from_degrees(90.0));
    let pane = pane([1000, 1000]);
    let led = HeadPose {
        yaw: Radians(0.5),
        pitch: Radians(0.2),
        roll: Radians(0.1),
    };
    scene.look_along(led);
    let gaze = scene.shown(&pane).view.ray([300.0, 700.0]).normalize();
    assert_eq!(scene.with_the_hand(gaze), gaze);
    scene.drag([-50.0, 20.0], &pane);
    scene.look_along(led);
    assert!((scene.head().yaw.0 - 0.6).abs() < 1e-12);
    assert!((scene.head().pitch.0 - 0.24).abs() < 1e-12);
    let place = scene
        .shown(&pane)
        .view
        .place(scene.with_the_hand(gaze))
        .unwrap();
    assert!((place[0] - 300.0).abs() < 1e-6 && (place[1] - 700.0).abs() < 1e-6);
    scene.reset();
    assert_eq!(scene.head(), led);
}

proptest! {
    #[test]
    fn any_way_through_flat_content_stays_on_it(
        steps in prop::collection::vec(
            (-500.0..500.0f64, -500.0..500.0f64, 0.5..2.0f64), 1..20,
        ),
        size in (1u32..3000, 1u32..3000),
        window in (1u32..2000, 1u32..2000),
    ) {
        let mut scene = flat([size.0, size.1]);
        let pane = pane([window.0, window.1]);
        for (x, y, factor) in steps {
            scene.zoom_by(factor, [x.abs(), y.abs()], &pane);
            scene.drag([x, y], &pane);
            let shown = scene.shown(&pane);
            prop_assert!(shown.view.field.is_open(), "{shown:?}");
            for k in 0..2 {
                prop_assert!(shown.origin[k] + shown.view.size[k] <= pane.size[k]);
            }
        }
    }

    #[test]
    fn what_is_under_the_cursor_stays_there(
        x in 300.0..900.0f64, y in 300.0..500.0f64, factor in 1.0..5.0f64,
    ) {
        let mut scene = flat([4000, 2500]);
        let pane = pane([1280, 800]);
        scene.zoom_by(4.0, [640.0, 400.0], &pane);
        let before = content_at(&scene, &pane, [x, y]);
        scene.zoom_by(factor, [x, y], &pane);
        let after = content_at(&scene, &pane, [x, y]);
        for k in 0..2 {
            prop_assert!((before[k] - after[k]).abs() < 1e-6, "{before:?} {after:?}");
        }
    }
}
