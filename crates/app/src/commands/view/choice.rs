//! Which tiles does the policy choose of a pack, and where is that written down?

use crate::options::link::Link;
use anyhow::{Context, bail};
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::bytes::cue_table::CueTable;
use foveal_core::content::video::bytes::signatures::Signatures;
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::content::video::units::{Content, PackContent};
use foveal_core::perception::parameters::Parameters;
use foveal_core::session::aim::Aim;
use foveal_core::session::budget::Budget;
use foveal_core::session::picker::{HasTables, Picker};
use foveal_core::session::playback::Chooses;
use foveal_core::units::Seconds;
use foveal_media::pack::pack_file::PackFile;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Chooses under one policy at a time, and logs it.
pub(crate) struct Choice {
    file: Arc<PackFile>,
    /// Chooses by `config`, or without what the pack does not tell.
    picker: Picker,
    config: PolicyConfig,
    tables: (Option<Signatures>, Option<CueTable>),
    log: Option<Log>,
    link: Option<Spending>,
}

/// What a link brings, and what was bought of it.
struct Spending {
    budget: Budget,
    /// When it was last asked.
    until: f64,
}

struct Log {
    path: PathBuf,
    out: File,
}

impl Spending {
    /// Bytes that can be spent at a time.
    fn ask(&mut self, now: Seconds) -> u64 {
        let passed = now.0 - std::mem::replace(&mut self.until, now.0);
        self.budget.after(Seconds(passed))
    }
}

impl Log {
    /// Writes whole lines at once: what was written when the program is killed can be replayed.
    fn write(&mut self, text: &str) -> anyhow::Result<()> {
        let written = self.out.write_all(text.as_bytes());
        written.with_context(|| format!("--log {}: cannot be written", self.path.display()))
    }
}

impl Choice {
    /// Chooses tiles of `grid` within what a link brings, and writes down what for and how where
    /// `log` says so.
    pub(crate) fn new(
        file: Arc<PackFile>,
        grid: TileGrid,
        config: PolicyConfig,
        link: Option<Link>,
        log: Option<&Path>,
    ) -> anyhow::Result<Self> {
        let tables = (file.signatures()?, file.cues()?);
        let log = log.map(|path| {
            let out = File::create(path)
                .with_context(|| format!("--log {}: cannot be written", path.display()))?;
            anyhow::Ok(Log {
                path: path.to_owned(),
                out,
            })
        });
        let name = file.path().file_name().unwrap_or_default();
        let usable = usable(&config, tables.0.is_some(), link.is_some());
        let choice = Self {
            picker: Picker::new(&name.to_string_lossy(), grid, usable),
            config,
            file,
            tables,
            log: log.transpose()?,
            link: link.map(|link| Spending {
                budget: Budget::new(link.bytes_per_s),
                until: 0.0,
            }),
        };
        if !choice.can(choice.policy()) {
            bail!(
                "{}: has no signatures or cues, by which this policy chooses; prepare it again",
                choice.file.path().display(),
            );
        }
        Ok(choice)
    }

    pub(crate) fn policy(&self) -> Policy {
        self.config().policy
    }

    pub(crate) fn perception(&self) -> &Parameters {
        &self.config().perception
    }

    /// The policy with its parameters, as far as the pack has what they need.
    pub(crate) fn config(&self) -> &PolicyConfig {
        self.picker.config()
    }

    /// The score that is asked for.
    pub(crate) fn target(&self) -> Option<f64> {
        self.config.target
    }

    /// The score that what was chosen last is expected to have, as far as the pack tells.
    pub(super) fn expected_jod(&self) -> Option<f64> {
        let content = self.content()?;
        self.picker.expected_jod(&content)
    }

    fn content(&self) -> Option<PackContent<'_>> {
        content_of(&self.file, &self.tables)
    }

    /// Whether the pack has what a policy chooses by.
    pub(crate) fn can(&self, policy: Policy) -> bool {
        let has = HasTables {
            signatures: self.tables.0.is_some(),
            cues: self.tables.1.is_some(),
        };
        self.picker.can(policy, has)
    }

    /// Chooses by another policy from now on.
    pub(crate) fn change(&mut self, config: PolicyConfig) {
        let has_signatures = self.tables.0.is_some();
        let usable = usable(&config, has_signatures, self.link.is_some());
        self.picker.change(usable);
        self.config = config;
    }

    /// Whether a link may still bring what was not chosen yet for lack of bytes.
    fn saves_up(&self) -> bool {
        let link = self.link.as_ref();
        let link = link.filter(|_| self.policy().spends_a_budget());
        link.is_some_and(|link| !link.budget.is_done() && !self.picker.has_reached())
    }
}

/// The policy, or what stands in for it where a pack does not tell what its units add; for what is
/// to spend a link nothing can.
fn usable(config: &PolicyConfig, has_signatures: bool, has_link: bool) -> PolicyConfig {
    if has_signatures || has_link && config.policy.spends_a_budget() {
        config.clone()
    } else {
        config.without_signatures()
    }
}

fn content_of<'a>(
    file: &'a PackFile,
    (signatures, cues): &'a (Option<Signatures>, Option<CueTable>),
) -> Option<PackContent<'a>> {
    Some(PackContent {
        pack: file.pack(),
        signatures: signatures.as_ref()?,
        cues: cues.as_ref(),
    })
}

impl Chooses for Choice {
    type Error = anyhow::Error;

    fn differs(&self, now: &Aim, before: &Aim) -> bool {
        self.saves_up() || now.differs(before, self.policy())
    }

    fn choose(&mut self, frame: u32, aim: &Aim) -> anyhow::Result<Vec<Tile>> {
        let content = content_of(&self.file, &self.tables);
        let content = content.as_ref().map(|content| content as &dyn Content);
        let spends = self.policy().spends_a_budget();
        let mut link = self.link.as_mut().filter(|_| spends);
        let budget = link.as_mut().map(|link| link.ask(aim.gaze.time));
        let picked = self.picker.choose(content, frame, aim, budget);
        if let Some(link) = link {
            link.budget.spend(picked.spent);
        }
        if let Some(log) = &mut self.log {
            log.write(&picked.log)?;
        }
        Ok(picked.tiles)
    }
}
