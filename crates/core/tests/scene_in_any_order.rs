//! Is a scene shown without a hole, whatever comes when?

use crate::looking;
use foveal_core::content::demand::{Content, Demand};
use foveal_core::content::mesh::payload::Attributes;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::demand::{SceneDemand, why_not};
use foveal_core::content::scene::description::{
    Grid, KIND, ObjectBounds, SceneDescription, SceneObject, SceneSource, Shape,
};
use foveal_core::content::scene::pack::{ScenePack, begin_scene, chunk_name, finish_scene};
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::content::unit::AssetId;
use foveal_core::pack::unit::UnitId;
use foveal_core::pack::{HEADER_BYTES, Header, Identity};
use foveal_core::perception::moment::Moment;
use foveal_core::selection::scheduler::Scheduler;
use foveal_core::session::actions::{Pace, SessionAction, SessionEvent};
use foveal_core::session::bounds::Bounds;
use foveal_core::session::log_of_parts::SessionLog;
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::session::unit_states::UnitState;
use foveal_core::view::random::Random;
use glam::DVec3;
use std::collections::{BTreeSet, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// Levels of a row of units before the viewer: one root, and twice as many in each finer level,
/// each of which needs the two that it lies under.
const LEVELS: u32 = 9;
const BYTES: u32 = 500;

fn first_of(level: u32) -> u32 {
    (1 << level) - 1
}

/// The rows of the units, the root first, each level from the left.
fn rows() -> Vec<UnitRow> {
    let mut rows = Vec::new();
    for level in 0..LEVELS {
        let count = 1_u32 << level;
        for number in 0..count {
            let width = 8.0 / f64::from(count);
            let needs: BTreeSet<u32> = match level {
                0 => BTreeSet::new(),
                _ => {
                    let over = |side: u32| ((number + side) / 2).min(count / 2 - 1);
                    [0, 1].map(|side| first_of(level - 1) + over(side)).into()
                }
            };
            rows.push(UnitRow {
                centre: [((f64::from(number) + 0.5) * width - 4.0) as f32, 0.0, 0.0],
                // Encloses what lies under it, and that in turn.
                radius: (4.0 * width) as f32,
                error: if level == 0 {
                    f32::INFINITY
                } else {
                    (width * 0.6) as f32
                },
                samples: 256,
                vertices: 200,
                needs: needs.into_iter().map(UnitId).collect(),
                ..UnitRow::default()
            });
        }
    }
    rows
}

fn scene() -> Arc<Scene> {
    let description = SceneDescription {
        kind: KIND.to_owned(),
        needs: vec![KIND.to_owned()],
        generator: "a test".to_owned(),
        source: SceneSource::default(),
        objects: vec![SceneObject {
            name: "row".to_owned(),
            shape: Shape::Mesh {
                leaf_triangles: 65536,
            },
            bounds: ObjectBounds {
                centre: [0.0; 3],
                radius: 4.0,
                half: [0.0; 3],
            },
            grid: Grid {
                origin: [0.0; 3],
                step: 1e-3,
                bits: 14,
            },
            attributes: Attributes::default(),
            colour: [1.0; 4],
            two_sided: false,
            unlit: false,
            placements: vec![[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -6.0]],
            texturing: None,
        }],
        textures: Vec::new(),
        parts: Vec::new(),
        joined: Default::default(),
        units: (0..LEVELS).rev().map(|level| 1 << level).collect(),
        page: 16,
        look: Default::default(),
        identity: Identity::default(),
        remarks: Vec::new(),
        repairs: Default::default(),
        tables: Vec::new(),
    };
    let mut builder = begin_scene(&description);
    let rows = rows();
    for unit in 0..rows.len() as u32 {
        builder.push(chunk_name(UnitId(unit)), &[unit as u8; BYTES as usize]);
    }
    let index_at = builder.end();
    let parts = finish_scene(builder, description, &rows).unwrap();
    let header = Header::parse(&parts.head).unwrap();
    let about = ScenePack::describe(&header, &parts.head[HEADER_BYTES..]).unwrap();
    let table = about.units_table().unwrap();
    let [index, table] =
        [(index_at, header.index_bytes), (table.offset, table.bytes)].map(|(from, bytes)| {
            let from = (from - index_at) as usize;
            parts.tail[from..from + bytes as usize].to_vec()
        });
    let pack = ScenePack::new(&header, about, &index, &table).unwrap();
    Arc::new(Scene::new("row.foveal", Arc::new(pack)))
}

fn settings(policy: Policy, bytes_per_s: Option<f64>, gpu: u64) -> SessionSettings {
    SessionSettings {
        policy: PolicyConfig::new(policy),
        bytes_per_s,
        since: None,
        zooms: false,
        measures: false,
        bounds: Bounds {
            gpu,
            ..Bounds::default()
        },
    }
}

fn moment(gaze: [f64; 2]) -> Moment {
    looking::looking(0.0, 0.0, Pace::Standing, gaze, 800).moment
}

fn chosen(scene: &Arc<Scene>, policy: Policy, gaze: [f64; 2]) -> HashSet<UnitId> {
    let mut demand = SceneDemand::new(Arc::clone(scene), &PolicyConfig::new(policy));
    demand.needed(0, &moment(gaze)).units.into_iter().collect()
}

#[test]
fn whatever_comes_when_a_unit_is_on_screen_only_after_what_it_needs() {
    let scene = scene();
    for (seed, policy) in (0..40).zip(
        [Policy::Full, Policy::Acuity, Policy::Viewport]
            .iter()
            .cycle(),
    ) {
        let mut random = Random::new(seed);
        let mut session = Session::new(
            vec![Arc::clone(&scene) as Arc<dyn Content>],
            settings(*policy, None, u64::MAX / 4),
        );
        let (mut shown, mut at_hand) = (BTreeSet::new(), Vec::new());
        for step in 0..400 {
            let gaze = if step < 200 { [0.2, 0.0] } else { [-0.3, 0.0] };
            let now = looking::looking(f64::from(step) * 0.04, 0.0, Pace::Standing, gaze, 800);
            for action in session.step(&now) {
                match action {
                    SessionAction::Upload(piece) => {
                        let unit = piece.unit.unit;
                        let missing = scene.needs(unit).iter().find(|need| !shown.contains(*need));
                        assert_eq!(missing, None, "of {unit:?}, seed {seed}");
                        shown.insert(unit);
                    }
                    SessionAction::Show(piece) => {
                        let needs = scene.needs(piece.unit.unit);
                        assert!(needs.iter().all(|need| shown.contains(need)), "seed {seed}");
                        shown.insert(piece.unit.unit);
                    }
                    SessionAction::Keep { shown: kept, .. } => {
                        let kept: HashSet<UnitId> = kept.iter().map(|it| it.unit).collect();
                        shown.retain(|unit| kept.contains(unit));
                        let is_held = |unit: &UnitId| {
                            scene.needs(*unit).iter().all(|need| shown.contains(need))
                        };
                        assert!(
                            shown.iter().all(is_held),
                            "what is needed stays, seed {seed}"
                        );
                    }
                    SessionAction::Want(pieces) => at_hand = pieces,
                    _ => {}
                }
            }
            for _ in 0..3 {
                if at_hand.is_empty() {
                    break;
                }
                let next = (random.unit() * at_hand.len() as f64) as usize;
                let piece = at_hand.swap_remove(next.min(at_hand.len() - 1));
                let event = match random.unit() < 0.02 && !scene.needs(piece.unit.unit).is_empty() {
                    true => SessionEvent::Damaged { piece, frames: 1 },
                    false => SessionEvent::Decoded { piece, frames: 1 },
                };
                session.take(event);
            }
        }
        assert!(shown.len() > 10, "{policy:?} shows {}", shown.len());
    }
}

#[test]
fn what_a_rule_wants_holds_what_each_of_it_needs_and_no_more_beside_the_gaze() {
    let scene = scene();
    for policy in [
        Policy::Full,
        Policy::Coarsest,
        Policy::Viewport,
        Policy::Acuity,
    ] {
        let wanted = chosen(&scene, policy, [0.3, 0.0]);
        for unit in &wanted {
            assert!(
                scene.needs(*unit).iter().all(|need| wanted.contains(need)),
                "{policy:?}"
            );
        }
    }
    let [all, roots, viewport, acuity] = [
        Policy::Full,
        Policy::Coarsest,
        Policy::Viewport,
        Policy::Acuity,
    ]
    .map(|policy| chosen(&scene, policy, [0.3, 0.0]));
    assert_eq!((all.len(), roots.len()), (scene.pack().len(), 1));
    assert!(acuity.is_subset(&viewport) && viewport.is_subset(&all));
    assert!(acuity.len() * 4 < viewport.len() * 3);
    let finest = |units: &HashSet<UnitId>| {
        let finest = units.iter().filter(|it| scene.pack().level_of(**it) == 0);
        finest
            .map(|it| scene.direction(*it, DVec3::ZERO).x)
            .collect::<Vec<f64>>()
    };
    let gaze = libm::sin(0.3);
    let [beside, all] = [acuity, viewport].map(|units| finest(&units));
    assert!(beside.len() * 2 < all.len() && beside.iter().any(|x| (x - gaze).abs() < 0.02));
    assert!(beside.iter().all(|x| (x - gaze).abs() < 0.4), "{beside:?}");
}

#[test]
fn more_bytes_buy_what_fewer_buy_and_more() {
    let scene = scene();
    for policy in [Policy::Uniform, Policy::Eccentricity] {
        let config = PolicyConfig::new(policy);
        let bought = |budget: u64| {
            let demand = Box::new(SceneDemand::new(Arc::clone(&scene), &config));
            let mut scheduler = Scheduler::new(&config, vec![demand]);
            let chosen = scheduler.choose(&[0], &moment([0.1, 0.0]), Some(budget));
            assert!(scheduler.spent() <= budget);
            let units: HashSet<UnitId> = chosen[0].units.iter().copied().collect();
            let is_held = |unit: &UnitId| scene.needs(*unit).iter().all(|it| units.contains(it));
            assert!(units.iter().all(is_held), "{policy:?} {budget}");
            units
        };
        let mut before = bought(0);
        assert_eq!(before.len(), 1, "the root costs nothing");
        for steps in [3, 20, 100, 400] {
            let now = bought(steps * u64::from(BYTES));
            assert!(
                now.is_superset(&before) && now.len() > before.len(),
                "{policy:?} {steps}"
            );
            before = now;
        }
    }
}

#[test]
fn no_more_is_on_the_gpu_than_fits_and_the_root_always_is() {
    let scene = scene();
    let of_unit = scene.unit(UnitId(0)).gpu_bytes;
    let mut session = Session::new(
        vec![Arc::clone(&scene) as Arc<dyn Content>],
        settings(Policy::Full, None, 50 * of_unit),
    );
    for step in 0..40 {
        let now = looking::looking(f64::from(step) * 0.04, 0.0, Pace::Standing, [0.0; 2], 800);
        let _ = session.step(&now);
        for piece in session.requested().to_vec() {
            session.take(SessionEvent::Decoded { piece, frames: 1 });
        }
    }
    let resident = session.states().resident();
    assert!((40..=50).contains(&resident.len()), "{}", resident.len());
    assert!(resident.iter().any(|piece| piece.unit.unit == UnitId(0)));
}

/// Looks one way for some steps, in which what is wanted comes at once. Returns what was wanted.
fn look(session: &mut Session, gaze: f64, steps: Range<u32>) -> Vec<UnitId> {
    let mut wanted = Vec::new();
    for step in steps {
        let at = f64::from(step) * 0.04;
        let now = looking::looking(at, 0.0, Pace::Standing, [gaze, 0.0], 800);
        session.step(&now);
        for piece in session.requested().to_vec() {
            wanted.push(piece.unit.unit);
            session.take(SessionEvent::Decoded { piece, frames: 1 });
        }
    }
    wanted
}

fn in_state(session: &Session, state: UnitState) -> BTreeSet<UnitId> {
    let pieces = session.states().in_state(state).into_iter();
    pieces.map(|piece| piece.unit.unit).collect()
}

#[test]
fn who_looks_away_and_back_wants_nothing_again() {
    let scene = scene();
    let of_unit = scene.unit(UnitId(0)).gpu_bytes;
    let mut session = Session::new(
        vec![Arc::clone(&scene) as Arc<dyn Content>],
        settings(Policy::Acuity, None, 1000 * of_unit),
    );
    let first = look(&mut session, 0.4, 0..30);
    let before = in_state(&session, UnitState::Shown);
    let other = look(&mut session, -0.4, 30..60);
    assert!(!other.is_empty() && in_state(&session, UnitState::Shown) != before);
    assert!(!in_state(&session, UnitState::Resident).is_empty());
    assert_eq!(look(&mut session, 0.4, 60..90), []);
    assert_eq!(in_state(&session, UnitState::Shown), before);
    let figures = session.figures();
    let fetched = (first.len() + other.len()) as u64 * u64::from(BYTES);
    assert_eq!(
        [figures.fetched_bytes, figures.refetched_bytes],
        [fetched, 0]
    );
}

#[test]
fn where_room_is_short_the_finest_go_first_and_are_fetched_again() {
    let scene = scene();
    let of_unit = scene.unit(UnitId(0)).gpu_bytes;
    let shown = chosen(&scene, Policy::Acuity, [0.4, 0.0]).len() as u64;
    let mut tight = settings(Policy::Acuity, None, (shown + 8) * of_unit);
    tight.bounds.client = (shown + 8) * u64::from(BYTES);
    let mut session = Session::new(vec![Arc::clone(&scene) as Arc<dyn Content>], tight);
    look(&mut session, 0.4, 0..30);
    let before = in_state(&session, UnitState::Shown);
    look(&mut session, -0.4, 30..60);
    let there = session.states().resident().into_iter();
    let there: BTreeSet<UnitId> = there.map(|piece| piece.unit.unit).collect();
    assert!(there.len() as u64 <= shown + 8);
    let level = |unit: &UnitId| scene.pack().level_of(*unit);
    let gone = before.difference(&there).map(level).max();
    let stayed = in_state(&session, UnitState::Resident);
    let stayed = stayed.iter().map(level).min();
    assert!(gone.is_some() && gone <= stayed, "{gone:?} {stayed:?}");
    let back = look(&mut session, 0.4, 60..90);
    let figures = session.figures();
    assert!(figures.refetched_bytes > 0, "{back:?}");
    assert!(figures.refetched_bytes <= back.len() as u64 * u64::from(BYTES));
    assert_eq!(in_state(&session, UnitState::Shown), before);
}

#[test]
fn a_run_replays_from_its_log() {
    let scene = scene();
    let mut session = Session::new(
        vec![Arc::clone(&scene) as Arc<dyn Content>],
        settings(Policy::Eccentricity, Some(40_000.0), u64::MAX / 4),
    );
    let mut text = String::new();
    for step in 0..60 {
        let at = f64::from(step) * 0.04;
        let now = looking::looking(at, 0.0, Pace::Standing, [at * 0.2 - 0.2, 0.05], 800);
        for action in session.step(&now) {
            if let SessionAction::Log(lines) = action {
                text.push_str(&lines);
            }
        }
        for piece in session.requested().to_vec() {
            session.take(SessionEvent::Decoded { piece, frames: 1 });
        }
    }
    let log = SessionLog::parse(&text).unwrap();
    let again = log.replay(&|asset, head, config| {
        assert_eq!(asset, AssetId::ONLY);
        Arc::clone(&scene).demand(head, config)
    });
    assert_eq!(again.write(), text);
    assert!(log.parts[0].frames.last().unwrap().samples > 256 * 50);
}

#[test]
fn policies_of_pictures_are_refused_with_the_reason() {
    let refused = Policy::ALL
        .into_iter()
        .filter(|policy| why_not(*policy).is_some());
    let refused: Vec<&str> = refused.map(Policy::name).collect();
    assert_eq!(refused, ["grid", "distance", "sampled"]);
}
