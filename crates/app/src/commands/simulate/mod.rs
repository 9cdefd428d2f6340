//! What does an eye get from a pack, and what did that take?

mod expected;
mod frames;
pub(crate) mod length;
pub(crate) mod moving;
pub(crate) mod options;
pub(crate) mod pictures;
mod scene;
pub(crate) mod scene_errors;
pub(crate) mod scoring;
pub(crate) mod summary;

pub(crate) use frames::session;

use crate::options::unused::Given;
use foveal_core::content::policy::Policy;
use foveal_media::pack::pack::Pack;
use options::SimulateArgs;

pub(crate) fn run(args: &SimulateArgs, given: &Given) -> anyhow::Result<()> {
    let args = &args.with_table()?;
    let pack = Pack::open(&args.pack)?;
    args.say_unused(given, &pack);
    match &pack {
        Pack::Video(file) => frames::run(args, file),
        Pack::Scene(file) => scene::run(args, file),
    }
}

impl SimulateArgs {
    /// These options with the gaze of a tracker's table, where that is named.
    fn with_table(&self) -> anyhow::Result<Self> {
        Ok(Self {
            gaze: self.tracker.read_as(&self.gaze)?,
            ..self.clone()
        })
    }

    /// Whether what may be fetched is limited.
    fn is_limited(&self) -> bool {
        self.watching.link.is_some() || self.budget.is_some()
    }

    fn say_unused(&self, given: &Given, pack: &Pack) {
        let about = pack.facts();
        let is_flat = pack.video().is_some_and(|file| {
            let projection = file.pack().description().projection;
            !projection.surrounds()
        });
        let usual = match about.has_tiles || self.is_limited() {
            true => Policy::Perceptual,
            false => Policy::Acuity,
        };
        given.say_unused((about, is_flat), (self.policy.named(), usual));
    }
}
