//! Does decoding a tile begin with this access unit?
//!
//! Only what distinguishes a key frame from others is read; the decoder judges the rest. Decoders
//! do not all say so themselves: FFmpeg's H.264 decoder takes a delta after a flush without an
//! error and gives no picture.

use crate::content::video::bytes::codec::Codec;

/// Network abstraction layer units of H.264 (ITU-T H.264, table 7-1).
const H264_IDR: u8 = 5;
const H264_SPS: u8 = 7;
const H264_PPS: u8 = 8;
/// Those of HEVC (ITU-T H.265, table 7-1).
const HEVC_IDR: [u8; 2] = [19, 20];
const HEVC_SETS: [u8; 3] = [32, 33, 34];
/// Open bitstream units of AV1 (AV1 bitstream specification, section 6.2.2).
const AV1_SEQUENCE: u8 = 1;
const AV1_FRAME_HEADER: u8 = 3;
const AV1_FRAME: u8 = 6;

/// Whether an access unit is a key frame with everything that its group needs: a decoder can begin
/// with it, and nothing after it refers to what came before.
///
/// JPEG and PNG always are. Never panics, whatever the bytes; costs one pass over them at most.
///
/// ```
/// use foveal_core::content::video::bytes::codec::Codec;
/// use foveal_core::content::video::bytes::key_frame::is_key_frame;
/// assert!(is_key_frame(Codec::Vp9, &[0b1000_0010]));
/// assert!(!is_key_frame(Codec::H264, &[0, 0, 1, 0x41]));
/// ```
#[must_use]
pub fn is_key_frame(codec: Codec, unit: &[u8]) -> bool {
    match codec {
        Codec::Vp8 => is_vp8_key(unit),
        Codec::Vp9 => is_vp9_key(unit),
        Codec::H264 => {
            let kinds: Vec<u8> = nal_units(unit).map(|nal| nal[0] & 31).collect();
            [H264_SPS, H264_PPS, H264_IDR]
                .iter()
                .all(|kind| kinds.contains(kind))
        }
        Codec::Hevc => {
            let kinds: Vec<u8> = nal_units(unit).map(|nal| nal[0] >> 1 & 63).collect();
            HEVC_SETS.iter().all(|kind| kinds.contains(kind))
                && HEVC_IDR.iter().any(|kind| kinds.contains(kind))
        }
        Codec::Av1 => is_av1_key(unit),
        Codec::Jpeg | Codec::Png => true,
    }
}

/// Frame type 0 and the start code (RFC 6386, section 9.1).
fn is_vp8_key(unit: &[u8]) -> bool {
    unit.len() >= 10 && unit[0] & 1 == 0 && unit[3..6] == [0x9d, 0x01, 0x2a]
}

/// Frame marker 2, profile 0, no repeated frame, frame type 0 (VP9 bitstream specification, section
/// 6.2).
fn is_vp9_key(unit: &[u8]) -> bool {
    unit.first()
        .is_some_and(|byte| byte & 0b1111_1100 == 0b1000_0000)
}

/// A sequence header, and a first frame header that is shown and of type 0 (AV1 bitstream
/// specification, section 5.9.2).
fn is_av1_key(mut unit: &[u8]) -> bool {
    let mut has_sequence = false;
    while let Some((kind, payload, rest)) = open_bitstream_unit(unit) {
        match kind {
            AV1_SEQUENCE => has_sequence = true,
            AV1_FRAME | AV1_FRAME_HEADER => {
                let shown_key = payload.first().is_some_and(|byte| byte >> 4 == 0b0001);
                return has_sequence && shown_key;
            }
            _ => {}
        }
        unit = rest;
    }
    false
}

/// Type and payload of the first unit, and what follows it; units without a length field end the
/// data.
fn open_bitstream_unit(data: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let header = *data.first()?;
    let kind = header >> 3 & 15;
    let (has_extension, has_size) = (header & 4 != 0, header & 2 != 0);
    let mut rest = data.get(1 + usize::from(has_extension)..)?;
    if !has_size {
        return Some((kind, rest, &[]));
    }
    let mut size = 0u64;
    for byte in 0..8 {
        let (digit, after) = rest.split_first()?;
        rest = after;
        size |= u64::from(digit & 127) << (7 * byte);
        if digit & 128 == 0 {
            break;
        }
    }
    let size = usize::try_from(size).ok()?;
    (size <= rest.len()).then(|| (kind, &rest[..size], &rest[size..]))
}

/// The network abstraction layer units of a byte stream, without start codes, none of them empty
/// (ITU-T H.264, annex B).
///
/// ```
/// use foveal_core::content::video::bytes::key_frame::nal_units;
/// let stream = [0, 0, 0, 1, 7, 9, 0, 0, 1, 5];
/// assert_eq!(nal_units(&stream).collect::<Vec<_>>(), [&[7, 9][..], &[5]]);
/// ```
pub fn nal_units(stream: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = after_start_code(stream);
    core::iter::from_fn(move || {
        loop {
            let from = rest?;
            rest = after_start_code(from);
            let end = rest.map_or(from.len(), |next| from.len() - next.len() - 3);
            // The zero of a longer start code belongs to no unit, nor do trailing zeros.
            let end = from[..end]
                .iter()
                .rposition(|byte| *byte != 0)
                .map_or(0, |at| at + 1);
            if end > 0 {
                return Some(&from[..end]);
            }
        }
    })
}

/// What follows the first start code.
fn after_start_code(stream: &[u8]) -> Option<&[u8]> {
    let at = stream.windows(3).position(|code| code == [0, 0, 1])?;
    Some(&stream[at + 3..])
}

/// Takes any bytes for an access unit of every codec: the body of the fuzz target.
pub fn judge_anything(data: &[u8]) {
    for codec in Codec::ALL {
        let _ = is_key_frame(codec, data);
    }
    let bytes: usize = nal_units(data).map(<[u8]>::len).sum();
    assert!(
        bytes <= data.len(),
        "units of {bytes} bytes in {}",
        data.len()
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn an_idr_without_its_parameter_sets_is_no_beginning() {
        let stream = |kinds: &[u8]| -> Vec<u8> {
            kinds.iter().flat_map(|kind| [0, 0, 1, *kind, 9]).collect()
        };
        assert!(is_key_frame(Codec::H264, &stream(&[0x67, 0x68, 0x65])));
        assert!(!is_key_frame(Codec::H264, &stream(&[0x65])));
        assert!(!is_key_frame(Codec::H264, &stream(&[0x67, 0x68, 0x41])));
        let hevc = |kinds: &[u8]| {
            let kinds: Vec<u8> = kinds.iter().map(|kind| kind << 1).collect();
            is_key_frame(Codec::Hevc, &stream(&kinds))
        };
        assert!(hevc(&[32, 33, 34, 19]));
        // A clean random access picture may be followed by pictures that refer beyond it.
        assert!(!hevc(&[32, 33, 34, 21]));
        assert!(!hevc(&[1]));
    }

    #[test]
    fn an_av1_key_frame_is_shown_and_has_a_sequence_header() {
        let sequence = [0x0a, 1, 0];
        let frame = |first: u8| [0x32, 1, first];
        let is_key = |unit: &[u8]| is_key_frame(Codec::Av1, unit);
        assert!(is_key(
            &[&[0x12, 0], &sequence[..], &frame(0b0001_0000)].concat()
        ));
        assert!(!is_key(&frame(0b0001_0000)));
        assert!(
            !is_key(&[&sequence[..], &frame(0b0011_0000)].concat()),
            "a delta"
        );
        assert!(
            !is_key(&[&sequence[..], &frame(0b1000_0000)].concat()),
            "shown again"
        );
        assert!(!is_key(&[&sequence[..], &frame(0)].concat()), "hidden");
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(data in prop::collection::vec(0u8..4, 0..60)) {
            judge_anything(&data);
        }

        #[test]
        fn nor_do_random_ones(data in prop::collection::vec(any::<u8>(), 0..200)) {
            judge_anything(&data);
        }
    }
}
