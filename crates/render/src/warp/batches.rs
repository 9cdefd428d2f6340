//! How do the grids of many panels fit into what a device binds at once?

use super::params::PanelParams;
use super::plan::WarpPlan;
use std::ops::Range;

/// Most bytes that are bound at once where panels can be divided: uploading takes as much again.
const MOST_BYTES: u64 = 1 << 28;

/// Panels that are drawn together, and the words of grids that they read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Batch {
    pub(super) panels: Range<u32>,
    pub(super) words: Range<usize>,
}

/// The panels of a plan in their order, in as few batches as have grids of at most `most` bytes;
/// one whose own grid is larger is a batch by itself.
pub(super) fn batches(plan: &WarpPlan, most: u64) -> Vec<Batch> {
    let most = (most.min(MOST_BYTES) / 4) as usize;
    let mut batches: Vec<Batch> = Vec::new();
    let mut start = 0;
    for (panel, end) in (0..).zip(&plan.grid_ends) {
        match batches.last_mut() {
            Some(last) if end - last.words.start <= most => {
                last.panels.end = panel + 1;
                last.words.end = *end;
            }
            _ => batches.push(Batch {
                panels: panel..panel + 1,
                words: start..*end,
            }),
        }
        start = *end;
    }
    batches
}

/// The records of a plan, whose grids begin with those of their batch.
pub(super) fn records(plan: &WarpPlan, batches: &[Batch]) -> Vec<PanelParams> {
    let mut records = plan.panels.clone();
    for batch in batches {
        let first = batch.words.start as u32;
        for record in &mut records[batch.panels.start as usize..batch.panels.end as usize] {
            // What has none is not asked for it.
            record.grid = record.grid.wrapping_sub(first);
            if record.alpha > 0 {
                record.alpha -= first;
            }
        }
    }
    records
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Panels with so many words of grids.
    fn plan(words: &[usize]) -> WarpPlan {
        let mut plan = WarpPlan::default();
        for count in words {
            let record = PanelParams {
                grid: plan.grids.len() as u32,
                alpha: plan.grids.len() as u32 + 1,
                ..PanelParams::default()
            };
            plan.panels.push(record);
            plan.grids.resize(plan.grids.len() + count, 0);
            plan.grid_ends.push(plan.grids.len());
        }
        plan
    }

    #[test]
    fn batches_take_every_panel_once_in_order_and_none_is_too_large() {
        for words in [
            &[0, 0, 0][..],
            &[5, 5, 5, 5],
            &[1, 9, 12, 1, 1],
            &[12],
            &[0, 10, 0, 1],
        ] {
            let plan = plan(words);
            let all = batches(&plan, 40);
            assert_eq!(all[0].panels.start, 0);
            assert_eq!(all.last().unwrap().panels.end as usize, words.len());
            assert_eq!(all.last().unwrap().words.end, plan.grids.len());
            for pair in all.windows(2) {
                assert_eq!(pair[0].panels.end, pair[1].panels.start);
                assert_eq!(pair[0].words.end, pair[1].words.start);
            }
            for batch in &all {
                assert!(
                    batch.words.len() <= 10 || batch.panels.len() == 1,
                    "{words:?}"
                );
            }
            let records = records(&plan, &all);
            for batch in &all {
                for k in batch.panels.clone() {
                    let own = &records[k as usize];
                    let start = batch.words.start as u32;
                    assert_eq!(own.grid + start, plan.panels[k as usize].grid);
                    assert_eq!(own.alpha + start, plan.panels[k as usize].alpha);
                }
            }
        }
    }
}
