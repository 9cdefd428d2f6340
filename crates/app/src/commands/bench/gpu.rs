//! What does it cost to weigh the steps of a decision on the GPU?

use foveal_core::perception::parameters::Parameters;
use foveal_eval::importance_bench::Decision;
use foveal_eval::timing::{Clock, TimedRow};
use foveal_render::importance::{Importance, UnitIds, upload_picture};
use foveal_render::{Gpu, RenderError, RgbaImage};
use std::time::{Duration, Instant};

/// Times `decision`, whose pictures are on the GPU already, `runs` times after one to warm up: by
/// the GPU's own clock where it has one, else until the values are back.
pub(super) fn time_on_gpu(
    gpu: &Gpu,
    decision: &Decision,
    runs: usize,
) -> Result<TimedRow, RenderError> {
    let size = decision.onlooker.view.size;
    let mut importance = Importance::new(gpu, size, &Parameters::default())?;
    let ids = UnitIds::upload(gpu, size, &decision.unit_ids, decision.units)?;
    let levels = decision.luma.iter();
    let levels: Vec<_> = levels
        .map(|luma| upload_picture(gpu, &grey(size, luma)))
        .collect::<Result<_, _>>()?;
    let levels: Vec<_> = levels.iter().collect();
    let mut has_clock = false;
    let mut once = || -> Result<Duration, RenderError> {
        let start = Instant::now();
        let gains = importance.run(&levels, &ids, &decision.onlooker)?;
        has_clock = gains.gpu_time.is_some();
        Ok(gains.gpu_time.unwrap_or_else(|| start.elapsed()))
    };
    once()?;
    let times: Result<Vec<Duration>, _> = (0..runs).map(|_| once()).collect();
    let mut times = times?;
    times.sort_unstable();
    let ms = |at: usize| times[at].as_secs_f64() * 1000.0;
    Ok(TimedRow {
        name: "GPU".to_owned(),
        median_ms: ms(runs / 2),
        range_ms: [ms(0), ms(runs - 1)],
        runs,
        clock: if has_clock { Clock::Gpu } else { Clock::Wall },
    })
}

fn grey(size: [u32; 2], luma: &[u8]) -> RgbaImage {
    RgbaImage {
        size,
        pixels: luma
            .iter()
            .flat_map(|&code| [code, code, code, 255])
            .collect(),
    }
}
