//! Which steps are worth their bytes when there are not bytes for all?
//!
//! A [`Catalog`] holds units, each a chain of levels with bytes and a value for every step, and
//! what must be held before a step is of use. [`Catalog::choices`] hands out steps by value per
//! byte until the budget is spent. Chen et al. 2022 (Instant Reality), Eqs. 5–7, print the goal as
//! a sum of ratios; what is meant, and what this does, is the most value under a byte budget: see
//! docs/papers.md, row "selection by value".
//!
//! The values decide what is compared: the eccentricity baseline (ECC) is this same order over
//! acuity plus pedestal, without content and popping. The uniform baseline (UNI) has an order of
//! its own, [`Catalog::uniform`].
//!
//! ```
//! use foveal_core::selection::greedy::{CatalogBuilder, Chain, Rule, Rung, Step};
//!
//! let mut builder = CatalogBuilder::default();
//! let step = |bytes, value| Step { bytes, value };
//! // Level 0 is the finest; the last step leads away from the coarsest level, always held.
//! let tile = builder.add(Chain::Refining, &[step(900, 2.0), step(300, 6.0)])?;
//! let page = builder.add(Chain::Replacing, &[step(500, 8.0)])?;
//! builder.require(Rung { unit: page, level: 0 }, &[Rung { unit: tile, level: 1 }]);
//! let mut catalog = builder.build(Rule::default())?;
//!
//! catalog.set_values(tile, &[2.5, 7.0]);
//! let plan = catalog.select(1_000);
//! let order: Vec<_> = plan.choices.iter().map(|choice| (choice.unit, choice.level)).collect();
//! assert_eq!(order, [(tile, 1), (page, 0)]);
//! assert_eq!((plan.bytes, plan.value), (800, 15.0));
//! # Ok::<(), foveal_core::selection::greedy::CatalogError>(())
//! ```

mod build;
mod catalog;
mod choices;
mod closure;
mod frontier;
mod hull;
mod plan;
mod progress;
mod rule;
mod uniform;

#[cfg(test)]
mod tests;

pub use build::{CatalogBuilder, CatalogError};
pub use catalog::{Catalog, Rung, Step};
pub use choices::Choices;
pub use plan::{Choice, Plan};
pub use rule::{Chain, Misfit, Reach, Rule};
pub use uniform::Uniform;
