//! When does a level that is shown give way to a coarser one?
//!
//! A gaze that stays is never still: it trembles and drifts, and a tracker adds its noise. Levels
//! that followed it would flicker wherever it rests near a border. So a cell becomes finer as soon
//! as it must, and coarser only when it need not be that fine for a gaze anywhere within a small
//! angle of where it is (a Schmitt trigger in space).
//!
//! A head turns while the eye stays. So under `acuity` cells are chosen through the view in which
//! the gaze was first found there, with room for what the head is about to turn to.

use crate::content::policy::{Policy, PolicyConfig};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::tile_grid::TileGrid;
use crate::content::video::rules::known_acuity::KnownAcuity;
use crate::content::video::rules::still::{gaze_stays, head_room, stays};
use crate::content::video::rules::{Occasion, Rules, Selection};
use crate::content::video::units::VideoUnits;
use crate::perception::acuity::AcuityModel;
use crate::perception::glance::Glance;
use crate::units::Radians;

/// A rule that remembers what it showed.
#[derive(Clone, Debug)]
pub struct SteadySelector {
    exact: Rules,
    loose: Rules,
    slack: Radians,
    /// Whether the view is that of where the gaze was first found.
    keeps_view: bool,
    before: Option<Shown>,
}

/// What was shown, and the glance whose view it was chosen through.
#[derive(Clone, Debug)]
struct Shown {
    levels: LevelMap,
    anchor: Glance,
    /// Room around that view for a head that turns; it never shrinks while the gaze stays.
    room: Radians,
    /// The glance that it was chosen for, where nothing else counts.
    chosen_for: Option<Glance>,
    /// What was shown through other views while the eye stayed, once the head turned too far for
    /// one view to serve. It is kept in addition to what is chosen.
    floor: Option<LevelMap>,
}

impl SteadySelector {
    /// The rule of a policy, as steady as it asks for.
    #[must_use]
    pub fn new(grid: TileGrid, config: PolicyConfig) -> Self {
        let slack = config.steadiness;
        let keeps_view = config.policy == Policy::Acuity && slack.0 > 0.0;
        let exact = Rules::new(grid, config);
        Self {
            loose: exact.loosened(slack),
            exact,
            slack,
            keeps_view,
            before: None,
        }
    }

    /// The rule without its memory.
    #[must_use]
    pub(crate) fn exact(&self) -> &Rules {
        &self.exact
    }

    /// The same rule, which showed nothing yet.
    #[must_use]
    pub(crate) fn without_memory(&self) -> Self {
        Self {
            before: None,
            ..self.clone()
        }
    }

    /// From now on chooses for another eye.
    pub(crate) fn set_acuity(&mut self, acuity: AcuityModel) {
        self.exact.set_acuity(acuity.clone());
        self.loose.set_acuity(acuity);
        if let Some(before) = &mut self.before {
            before.chosen_for = None;
        }
    }

    /// The choice for one glance, after those before. Costs at most twice a
    /// [`Rules::select_of`].
    ///
    /// # Panics
    /// As [`Rules::select_of`].
    pub fn select(
        &mut self,
        content: Option<&dyn VideoUnits>,
        frame: u32,
        glance: &Glance,
    ) -> Selection {
        let occasion = Occasion {
            content,
            frame,
            glance,
        };
        let mut levels = self.needed(&occasion, &mut KnownAcuity::default());
        let tiles = levels.cover(self.exact.grid());
        Selection { levels, tiles }
    }

    /// The level that each cell then needs; what is found of the eye's acuity is kept for other
    /// views.
    pub(crate) fn needed(&mut self, occasion: &Occasion<'_>, known: &mut KnownAcuity) -> LevelMap {
        if self.slack.0 <= 0.0 {
            return self.exact.levels_of(occasion, known, |_| true);
        }
        let grid = *self.exact.grid();
        let floor = self.floor(occasion.glance);
        let (anchor, room) = self.anchor(occasion.glance);
        let glance = Glance {
            view: anchor.view,
            ..*occasion.glance
        };
        let same = |before: &&Shown| {
            let chosen_for = before.chosen_for.as_ref();
            before.room == room && chosen_for.is_some_and(|it| looks_alike(it, &glance))
        };
        if let Some(before) = self.before.as_ref().filter(same) {
            return before.levels.clone();
        }
        let occasion = Occasion {
            glance: &glance,
            ..*occasion
        };
        self.exact.set_head_room(room);
        self.loose.set_head_room(room);
        let mut levels = self.exact.levels_of(&occasion, known, |_| true);
        if let Some(Shown { levels: before, .. }) = &self.before {
            let mut stray = glance;
            stray.gaze.spread = Radians(stray.gaze.spread.0 + self.slack.0);
            let [was, is] = [before, &levels].map(LevelMap::levels);
            let coarser: Vec<bool> = was.iter().zip(is).map(|(was, is)| was < is).collect();
            let strays = Occasion {
                glance: &stray,
                ..occasion
            };
            let enough = self.loose.levels_of(&strays, known, |rank| coarser[rank]);
            for (rank, _) in (0..).zip(&coarser).filter(|(_, coarser)| **coarser) {
                let cell = grid.tile_at(0, rank);
                let kept = before.level(&grid, cell).max(enough.level(&grid, cell));
                levels.refine(&grid, cell, kept);
            }
        }
        if let Some(floor) = &floor {
            levels.refine_to(floor);
        }
        self.before = Some(Shown {
            levels: levels.clone(),
            anchor,
            room,
            chosen_for: self.keeps_view.then_some(glance),
            floor,
        });
        levels
    }

    /// What is kept in addition to what is chosen while the eye stays and the head turns far.
    fn floor(&self, glance: &Glance) -> Option<LevelMap> {
        let grid = self.exact.grid();
        let was = self.before.as_ref().filter(|_| self.keeps_view)?;
        match gaze_stays(grid, &was.anchor, glance, self.slack) {
            true if stays(grid, &was.anchor, glance, self.slack) => was.floor.clone(),
            // What is shown, which the tiles of neighbours may make finer.
            true => Some(was.levels.covered(grid)),
            false => None,
        }
    }

    /// The glance whose view levels are chosen through, that of before while the gaze stays, and
    /// the room around it.
    fn anchor(&self, glance: &Glance) -> (Glance, Radians) {
        if !self.keeps_view {
            return (*glance, Radians(0.0));
        }
        let grid = self.exact.grid();
        let room = |anchor| head_room(grid, anchor, glance).0;
        let stays = |was: &&Shown| stays(grid, &was.anchor, glance, self.slack);
        match self.before.as_ref().filter(stays) {
            Some(was) => (was.anchor, Radians(room(&was.anchor).max(was.room.0))),
            None => (*glance, Radians(room(glance))),
        }
    }
}

/// Whether an eye that resolves the same sees the same through both.
fn looks_alike(was: &Glance, is: &Glance) -> bool {
    was.view == is.view
        && was.gaze.gaze_in_content == is.gaze.gaze_in_content
        && was.gaze.spread == is.gaze.spread
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::video::grid::tile_grid::Cut;
    use crate::gaze::sample::{GazeSample, HeadPose};
    use crate::perception::parameters::EyeState;
    use crate::units::Seconds;
    use crate::view::eye_view::{EyeView, Field};
    use crate::view::frustum::Frustum;
    use crate::view::random::Random;
    use crate::view::surface::{Eye, Surface};

    const RULES: [Policy; 5] = [
        Policy::Viewport,
        Policy::Grid,
        Policy::Distance,
        Policy::Sampled,
        Policy::Acuity,
    ];

    fn sphere() -> TileGrid {
        TileGrid::new(Surface::cube(1024), Cut::Tile(64), 5, 2).unwrap()
    }

    /// A gaze and a head, each at a yaw and a pitch in degrees.
    fn glance(gaze: [f64; 2], head: [f64; 2]) -> Glance {
        let [yaw, pitch] = gaze.map(Radians::from_degrees);
        let [head_yaw, head_pitch] = head.map(Radians::from_degrees);
        let head = HeadPose {
            yaw: head_yaw,
            pitch: head_pitch,
            roll: Radians(0.0),
        };
        let size = [1600, 1000];
        Glance {
            gaze: GazeSample::at(Seconds(0.0), yaw, pitch),
            view: Some(EyeView {
                position: Default::default(),
                axes: head.axes(),
                field: Field::across(Radians::from_degrees(100.0), size),
                size,
                eye: Eye::Left,
            }),
            state: EyeState::Steady,
        }
    }

    #[test]
    fn a_gaze_that_trembles_at_a_corner_of_tiles_settles() {
        for policy in RULES {
            let mut steady = SteadySelector::new(sphere(), PolicyConfig::new(policy));
            let mut random = Random::new(5);
            let mut tremble = || [0, 1].map(|_| 0.6 * (random.unit() - 0.5));
            let mut shown = Vec::new();
            for _ in 0..400 {
                let chosen = steady.select(None, 0, &glance(tremble(), [0.0; 2]));
                shown.push(chosen.levels);
            }
            let last = &shown[399];
            assert!(
                shown[200..].iter().all(|levels| levels == last),
                "{policy:?}"
            );
        }
    }

    #[test]
    fn without_steadiness_that_gaze_flickers() {
        let config = PolicyConfig {
            steadiness: Radians(0.0),
            ..PolicyConfig::new(Policy::Grid)
        };
        let mut rule = SteadySelector::new(sphere(), config);
        let [left, right] = [-0.3, 0.3].map(|yaw| glance([yaw, 0.1], [0.0; 2]));
        let first = rule.select(None, 0, &left);
        assert_ne!(rule.select(None, 0, &right), first);
        assert_eq!(rule.select(None, 0, &left), first);
    }

    #[test]
    fn a_nodding_head_under_a_steady_eye_changes_no_level() {
        // Of the display and sparser: what the display shows of a cell binds in one of them.
        for face in [1024, 8192] {
            let grid = TileGrid::new(Surface::cube(face), Cut::Tile(face / 16), 5, 2).unwrap();
            for policy in [Policy::Grid, Policy::Acuity] {
                let mut steady = SteadySelector::new(grid, PolicyConfig::new(policy));
                let mut at = |pitch: f64| {
                    let head = [0.3 * pitch, pitch];
                    steady.select(None, 0, &glance([12.0, -7.0], head)).levels
                };
                let first = at(0.0);
                for step in 0..60 {
                    let pitch = 9.0 * libm::sin(f64::from(step) * 0.4);
                    assert_eq!(at(pitch), first, "{policy:?} at {pitch}");
                }
            }
        }
    }

    #[test]
    fn a_head_that_nods_far_changes_no_level_in_view_and_after_the_first_nod_none_at_all() {
        // An eye that resolves much away from its gaze, so that what comes into view is not as
        // coarse as what does not.
        let config = PolicyConfig {
            acuity: AcuityModel::linear(0.004),
            ..PolicyConfig::new(Policy::Acuity)
        };
        let mut steady = SteadySelector::new(sphere(), config);
        let mut before: Option<(Frustum, LevelMap)> = None;
        let mut changes_beyond = 0;
        for step in 0..60 {
            let pitch = 28.0 * libm::sin(f64::from(step) * 0.3);
            let glance = glance([12.0, -7.0], [0.1 * pitch, pitch]);
            let levels = steady.select(None, 0, &glance).levels;
            let view = glance.view.unwrap();
            let sight = Frustum::new(&view, Radians(0.0));
            if let Some((sight, before)) = before {
                let changed = levels.levels().iter().zip(before.levels());
                let changed = changed.map(|(is, was)| is != was);
                for (bounds, changed) in steady.exact.cells.iter().zip(changed) {
                    assert!(!changed || bounds.is_beyond(&sight), "step {step}");
                    assert!(!changed || step < 20, "step {step}");
                    changes_beyond += u32::from(changed);
                }
            }
            before = Some((sight, levels));
        }
        assert!(
            changes_beyond > 0,
            "nothing was kept coarse outside the view"
        );
    }

    #[test]
    fn a_head_that_nods_however_far_settles_with_the_first_nod_and_a_jump_forgets_it() {
        let config = PolicyConfig {
            acuity: AcuityModel::linear(0.004),
            ..PolicyConfig::new(Policy::Acuity)
        };
        let mut steady = SteadySelector::new(sphere(), config.clone());
        let mut at =
            |gaze: [f64; 2], head: [f64; 2]| steady.select(None, 0, &glance(gaze, head)).levels;
        let mut before = at([8.0, -5.0], [0.0; 2]);
        let mut changes = 0;
        for step in 1..90 {
            let pitch = 40.0 * libm::sin(f64::from(step) * 0.3);
            let levels = at([8.0, -5.0], [0.1 * pitch, pitch]);
            for (is, was) in levels.levels().iter().zip(before.levels()) {
                // Nothing becomes coarser.
                assert!(is <= was, "step {step}");
                changes += u32::from(is != was);
            }
            assert!(step < 22 || levels == before, "step {step}");
            before = levels;
        }
        assert!(changes > 0);
        let jumped = at([120.0, 10.0], [120.0, 10.0]);
        let mut fresh = SteadySelector::new(sphere(), config);
        let far = glance([120.0, 10.0], [120.0, 10.0]);
        let fresh = fresh.select(None, 0, &far).levels;
        let beyond = jumped.levels().iter().zip(fresh.levels());
        assert!(beyond.filter(|(jumped, fresh)| jumped < fresh).count() < 12);
    }

    #[test]
    fn a_head_that_nods_while_the_gaze_trembles_settles() {
        let mut steady = SteadySelector::new(sphere(), PolicyConfig::new(Policy::Acuity));
        let mut random = Random::new(5);
        let mut shown = Vec::new();
        for step in 0..400 {
            let pitch = 20.0 * libm::sin(f64::from(step) * 0.4);
            let gaze = [0, 1].map(|_| 0.6 * (random.unit() - 0.5));
            let chosen = steady.select(None, 0, &glance(gaze, [0.0, pitch]));
            shown.push(chosen.levels);
        }
        assert!(shown[200..].iter().all(|levels| levels == &shown[399]));
    }

    #[test]
    fn a_turned_head_is_shown_at_most_a_level_less_than_if_it_had_pointed_there_before() {
        let rule = Rules::new(sphere(), PolicyConfig::new(Policy::Acuity));
        let mut steady = SteadySelector::new(sphere(), PolicyConfig::new(Policy::Acuity));
        let _ = steady.select(None, 0, &glance([5.0, 0.0], [0.0; 2]));
        let turned = glance([5.0, 0.0], [20.0, 10.0]);
        let [shown, needed] = [steady.select(None, 0, &turned), rule.select(&turned)];
        for cell in sphere().tiles_of(0) {
            let [shown, needed] = [&shown, &needed].map(|it| it.levels.level(&sphere(), cell));
            // At the border of its view a turned head is shown a level less.
            assert!(shown <= needed + 1, "{cell:?}");
        }
    }

    #[test]
    fn levels_are_never_coarser_than_the_rule_and_a_jump_leaves_nothing_behind() {
        for policy in RULES {
            let config = PolicyConfig::new(policy);
            let rule = Rules::new(sphere(), config.clone());
            let mut steady = SteadySelector::new(sphere(), config);
            let grid = sphere();
            let _ = steady.select(None, 0, &glance([0.0; 2], [0.0; 2]));
            let far = glance([150.0, 10.0], [150.0, 10.0]);
            let occasion = Occasion {
                content: None,
                frame: 0,
                glance: &far,
            };
            let needed = rule.levels_of(&occasion, &mut KnownAcuity::default(), |_| true);
            let jumped = steady.select(None, 0, &far);
            for cell in grid.tiles_of(0) {
                assert!(jumped.levels.level(&grid, cell) <= needed.level(&grid, cell));
            }
            // Nothing near the old gaze stays finer than a gaze that strays would have it.
            let front = grid.cell_at(0, [512.0, 512.0]);
            assert_eq!(
                jumped.levels.level(&grid, front),
                grid.coarsest(),
                "{policy:?}"
            );
        }
    }
}
