//! Which tiles of a video does one viewer want?
//!
//! By a rule, by a score, or step by step within a budget; whichever the policy says.

use super::grid::level_map::{LevelMap, histogram, pixels};
use super::grid::places::SharedPlaces;
use super::grid::tile_grid::TileGrid;
use super::losses::LossMeter;
use super::purchases::Purchases;
use super::rules::known_acuity::KnownAcuity;
use super::rules::steady::SteadySelector;
use super::rules::target::TargetSelector;
use super::rules::{Occasion, Selection, places_hash};
use super::units::{UnknownUnits, VideoUnits};
use super::worth::Worth;
use crate::content::demand::{Chosen, Demand, Offer, Record};
use crate::content::head::ContentHead;
use crate::content::policy::{Policy, PolicyConfig};
use crate::perception::glance::Glance;
use crate::perception::moment::Moment;
use std::sync::{Arc, OnceLock};

/// What one viewer wants of a video under one policy.
#[derive(Clone, Debug)]
pub struct VideoDemand {
    content: Arc<dyn VideoUnits>,
    grid: TileGrid,
    config: PolicyConfig,
    /// What chooses where bytes are not limited, and remembers what it showed: one for each view of
    /// the moment, and at least one. None where that, too, is buying.
    rules: Vec<Rule>,
    /// What their eye resolves.
    known: KnownAcuity,
    /// Under a policy that spends a budget.
    purchases: Option<Box<Purchases>>,
    /// Computes what is lost; made when first asked for.
    meter: OnceLock<LossMeter>,
    last: Option<Last>,
    /// What is being bought for.
    begun: Option<(u32, Moment)>,
}

#[derive(Clone, Debug)]
enum Rule {
    /// A frame depends on its moment, and on what was shown as far as it keeps levels steady.
    Steady(Box<SteadySelector>),
    /// For a score.
    Target(Box<TargetSelector>),
}

impl Rule {
    /// The level that each cell needs.
    fn needed(
        &mut self,
        content: &dyn VideoUnits,
        (frame, glance): (u32, &Glance),
        known: &mut KnownAcuity,
    ) -> LevelMap {
        let occasion = Occasion {
            content: Some(content),
            frame,
            glance,
        };
        match self {
            Self::Steady(selector) => selector.needed(&occasion, known),
            Self::Target(selector) => selector.needed(content, (frame, glance), known),
        }
    }

    /// From now on chooses from other content.
    fn forget_losses(&mut self) {
        if let Self::Target(selector) = self {
            selector.forget_losses();
        }
    }

    /// The same for another view.
    fn without_memory(&self) -> Self {
        match self {
            Self::Steady(selector) => Self::Steady(Box::new(selector.without_memory())),
            Self::Target(selector) => Self::Target(Box::new(selector.without_memory())),
        }
    }
}

/// What was chosen last, for what.
#[derive(Clone, Debug)]
struct Last {
    frame: u32,
    moment: Moment,
    levels: LevelMap,
    /// The score to expect for it; computed when first asked for.
    jod: OnceLock<Option<f64>>,
}

impl VideoDemand {
    /// What is wanted of the tiles of `grid` under a policy. `content` must know its signatures
    /// where [`PolicyConfig::needs_signatures`] says so, and its cues where
    /// [`PolicyConfig::needs_cues`] does.
    #[must_use]
    pub fn new(content: Arc<dyn VideoUnits>, grid: TileGrid, config: PolicyConfig) -> Self {
        let spends = config.policy.spends_a_budget();
        let own = SharedPlaces::default();
        let places = content.places(&grid).unwrap_or(&own);
        let meter = OnceLock::new();
        let make = || LossMeter::sharing(places, &grid, &config.perception);
        let target = TargetSelector::with_meter(&grid, &config, || meter.get_or_init(make).clone());
        let purchases = spends.then(|| {
            let worth = Worth::sharing(places, &grid, &config);
            let meter = config.target.map(|_| meter.get_or_init(make).clone());
            Box::new(Purchases::new(grid, config.clone(), worth, meter))
        });
        let rules = match target {
            Some(target) => vec![Rule::Target(Box::new(target))],
            None if spends => Vec::new(),
            None => {
                let steady = SteadySelector::new(grid, config.clone());
                vec![Rule::Steady(Box::new(steady))]
            }
        };
        Self {
            content,
            grid,
            purchases,
            config,
            rules,
            known: KnownAcuity::default(),
            meter,
            last: None,
            begun: None,
        }
    }

    /// What was wanted of the video of a log, of which no more is known than its head: rules need
    /// no more.
    ///
    /// # Panics
    /// The head must be of a video. Choosing panics under a policy that needs signatures or cues.
    #[must_use]
    pub fn of_head(head: &ContentHead, config: &PolicyConfig) -> Self {
        match head.video() {
            Some(grid) => Self::new(Arc::new(UnknownUnits::new(*grid)), *grid, config.clone()),
            None => panic!("{head:?} is no video"),
        }
    }

    /// The same wish, with what was made for it, for other content of the same grid.
    #[must_use]
    pub fn of_content(&self, content: Arc<dyn VideoUnits>) -> Self {
        let mut of_content = Self {
            content,
            ..self.clone()
        };
        of_content.rules.iter_mut().for_each(Rule::forget_losses);
        of_content
    }

    /// The level of every cell that was chosen last; `None` before any choice.
    #[must_use]
    pub fn levels(&self) -> Option<&LevelMap> {
        self.last.as_ref().map(|last| &last.levels)
    }

    /// Notes what was chosen, and says which units show it: the whole coarsest level, which is
    /// always resident, and the finer tiles.
    fn chosen(&mut self, frame: u32, moment: &Moment, selection: Selection) -> Chosen {
        let (grid, coarsest) = (&self.grid, self.grid.coarsest());
        let finer = selection.tiles.iter().filter(|tile| tile.level != coarsest);
        let tiles = grid.tiles_of(coarsest).chain(finer.copied());
        let units = tiles.map(|tile| self.content.unit(tile, frame)).collect();
        let record = Record {
            per_level: histogram(grid, &selection.tiles),
            samples: pixels(grid, &selection.tiles),
            sha256: places_hash(&selection.tiles),
        };
        self.last = Some(Last {
            frame,
            moment: moment.clone(),
            levels: selection.levels,
            jod: OnceLock::new(),
        });
        Chosen { units, record }
    }
}

impl Demand for VideoDemand {
    fn needed(&mut self, frame: u32, moment: &Moment) -> Chosen {
        let Some(first) = self.rules.first() else {
            panic!("{:?} spends a budget", self.config.policy)
        };
        let views = moment.views.len().max(1);
        if self.rules.len() != views {
            let anew = first.without_memory();
            self.rules.resize_with(views, || anew.clone());
        }
        let rules = self.rules.iter_mut().zip(moment.glances());
        let known = &mut self.known;
        let (grid, covers_each) = (&self.grid, !self.config.together);
        let through_each = rules.map(|(rule, glance)| {
            let glance = glance.on_surface();
            let mut levels = rule.needed(&*self.content, (frame, &glance), known);
            if covers_each && views > 1 {
                let _ = levels.cover(grid);
            }
            levels
        });
        let finest = through_each.reduce(|mut finest, one| {
            finest.refine_to(&one);
            finest
        });
        let Some(mut levels) = finest else {
            return Chosen::default();
        };
        let tiles = levels.cover(grid);
        let selection = Selection { levels, tiles };
        self.chosen(frame, moment, selection)
    }

    fn buys(&self, budget: Option<u64>) -> bool {
        let is_limited = budget.is_some_and(|bytes| bytes < u64::MAX);
        self.purchases.is_some() && (is_limited || self.rules.is_empty())
    }

    fn steps(&self) -> Vec<Vec<u32>> {
        let purchases = self.purchases.as_ref();
        purchases.map_or(Vec::new(), |purchases| purchases.steps())
    }

    fn begin(&mut self, frame: u32, moment: &Moment, budget: Option<u64>) {
        if let Some(purchases) = &mut self.purchases {
            purchases.begin(&*self.content, frame, moment, budget);
        }
        self.begun = Some((frame, moment.clone()));
    }

    fn offers(&mut self) -> Vec<Offer> {
        let purchases = self.purchases.as_ref();
        purchases.map_or(Vec::new(), |purchases| purchases.offers(&*self.content))
    }

    fn is_missed(&mut self, step: u32) -> bool {
        let purchases = self.purchases.as_mut();
        purchases.is_some_and(|purchases| purchases.is_missed(step))
    }

    fn buy(&mut self, steps: &[u32]) -> u64 {
        let purchases = self.purchases.as_mut();
        purchases.map_or(0, |purchases| purchases.buy(&*self.content, steps))
    }

    fn bought(&mut self) -> Chosen {
        let selection = self.purchases.as_ref().map(|it| it.selection());
        match (self.begun.take(), selection) {
            (Some((frame, moment)), Some(selection)) => self.chosen(frame, &moment, selection),
            _ => Chosen::default(),
        }
    }

    fn has_reached(&self) -> bool {
        let purchases = self.purchases.as_ref();
        purchases.is_some_and(|purchases| purchases.has_reached())
    }

    fn expected_jod(&self) -> Option<f64> {
        let last = self.last.as_ref()?;
        // Samples are not shown by tiles.
        if self.config.policy == Policy::Sampled || !self.content.has_signatures() {
            return None;
        }
        let meter = || {
            let own = SharedPlaces::default();
            let places = self.content.places(&self.grid).unwrap_or(&own);
            LossMeter::sharing(places, &self.grid, &self.config.perception)
        };
        let jod = || {
            let meter = self.meter.get_or_init(meter);
            let rule = self.config.policy.expectation();
            let through = |glance: Glance| {
                let shown = (&*self.content, last.frame);
                let lost = meter.lost(&self.grid, shown, &glance, &last.levels);
                let scale = self.content.scale(glance.view.as_ref());
                let expected = scale.expected(rule, &lost);
                expected.is_known.then_some(expected.jod)
            };
            let mut views = last.moment.glances().map(through);
            views.try_fold(f64::INFINITY, |least, jod| Some(least.min(jod?)))
        };
        *last.jod.get_or_init(jod)
    }
}
