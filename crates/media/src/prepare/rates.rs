//! How fine, or of how many bytes, is each level coded?

pub(super) mod samples;
pub(super) mod tile_rates;

use super::error::PrepareError;
use super::settings::{PrepareSettings, Quality};
use crate::read::source::SourceInfo;
use crate::tiles::encode_settings::Rate;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::bytes::description::Description;
use foveal_core::content::video::bytes::rate::QualityScale;
use foveal_core::units::counted;
use tile_rates::follows_content;

/// The rate of each level, finest first; the codec's default for a still or for film where nothing
/// is asked for.
pub(super) fn rates_of(
    settings: &PrepareSettings,
    is_still: bool,
    levels: u8,
) -> Result<Vec<Rate>, PrepareError> {
    let asked: Vec<Rate> = match &settings.quality {
        None | Some(Quality::Auto) => {
            let [of_film, of_still] = default_quantisers(settings.codec);
            vec![Rate::Quantiser(if is_still { of_still } else { of_film })]
        }
        Some(Quality::Quantiser(all)) => all.iter().map(|q| Rate::Quantiser(*q)).collect(),
        Some(Quality::Ijg(all)) => all.iter().map(|q| Rate::Ijg(*q)).collect(),
        Some(Quality::BitRate(all)) => all.iter().map(|bits| Rate::Bits(*bits)).collect(),
    };
    match asked.len() {
        1 => Ok(vec![asked[0]; usize::from(levels)]),
        count if count == usize::from(levels) => Ok(asked),
        count => Err(PrepareError::Option(format!(
            "{count} qualities or bit rates for {}; give one for all, or one a level, finest first",
            counted(levels, "level")
        ))),
    }
}

/// Whether quantisers are to follow what is seen.
pub(super) fn is_auto(settings: &PrepareSettings, info: &SourceInfo) -> bool {
    settings.quality == Some(Quality::Auto) && !info.looks_still && follows_content(settings.codec)
}

/// Writes the rates into a description.
pub(super) fn describe(rates: &[Rate], description: &mut Description) {
    let quality = |rate: &Rate| match rate {
        Rate::Quantiser(q) | Rate::Ijg(q) => *q,
        Rate::Bits(_) => 0,
    };
    let bits = |rate: &Rate| match rate {
        Rate::Bits(bits) => Some(*bits),
        _ => None,
    };
    description.quality = rates.iter().map(quality).collect();
    description.bit_rates = rates.iter().filter_map(bits).collect();
    description.quality_scale = match rates.first() {
        Some(Rate::Ijg(_)) => QualityScale::Ijg,
        _ => QualityScale::Quantiser,
    };
}

/// Of film, 40 to 44 dB in every codec on natural video; and of a still, which is looked at for
/// long and from near: what coding takes from its finest level is then 0.15 JOD at most, also where
/// a pixel is drawn four times as wide (docs/concepts/preparing.md).
fn default_quantisers(codec: Codec) -> [u8; 2] {
    match codec {
        Codec::Vp9 => [24, 4],
        Codec::Vp8 => [16, 0],
        Codec::H264 => [26, 15],
        Codec::Hevc => [27, 16],
        Codec::Av1 => [28, 3],
        Codec::Jpeg => [3, 1],
        Codec::Png => [0, 0],
    }
}
