//! Does what was encoded come back?

use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::view::picture::Picture;
use proptest::prelude::*;

use crate::tests::scenes::{group, psnr, scene};
use crate::{EncodeSettings, GroupDecoder, MediaError, Rate, Speed, encode_group};

const SIZES: [[u32; 2]; 7] = [
    [1, 1],
    [2, 1],
    [3, 5],
    [47, 47],
    [255, 3],
    [16, 8],
    [256, 256],
];
const CODECS: [Codec; 7] = Codec::ALL;
const PREDICTING: [Codec; 5] = [Codec::Vp9, Codec::Vp8, Codec::H264, Codec::Hevc, Codec::Av1];

fn settings(codec: Codec) -> EncodeSettings {
    let quality = match codec {
        Codec::Jpeg => 3,
        Codec::Vp8 => 16,
        _ => 24,
    };
    EncodeSettings {
        codec,
        rate: Rate::Quantiser(quality),
        frame_rate: [30, 1],
        speed: Speed::Default,
    }
}

fn rated(settings: EncodeSettings, rate: Rate) -> EncodeSettings {
    EncodeSettings { rate, ..settings }
}

/// A soft scene under noise that no codec can predict.
fn group_of_noise(size: [u32; 2], count: u32) -> Vec<Picture> {
    let mut state = 1u32;
    let mut pictures = group(size, count, 3);
    for sample in pictures.iter_mut().flat_map(|p| p.planes[0].iter_mut()) {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *sample = sample.saturating_add((state >> 27) as u8);
    }
    pictures
}

fn encode(codec: Codec, pictures: &[Picture]) -> Vec<Vec<u8>> {
    encode_group(&settings(codec), pictures).unwrap()
}

fn decode_all(decoder: &mut GroupDecoder, units: &[Vec<u8>]) -> Vec<Picture> {
    units
        .iter()
        .map(|unit| decoder.decode(unit, 0).unwrap().0)
        .collect()
}

#[test]
fn the_same_group_gives_the_same_bytes_whatever_is_coded_before_and_beside_it() {
    let groups = [[128, 96], [32, 18], [128, 16], [20, 70]].map(|size| group_of_noise(size, 12));
    let speeds = [Speed::Fast, Speed::Default, Speed::Small];
    let settings = CODECS.map(settings).into_iter();
    let at_each_speed = |s| speeds.map(|speed| EncodeSettings { speed, ..s });
    for settings in settings.flat_map(at_each_speed) {
        let bytes_of = |k: usize| encode_group(&settings, &groups[k]).unwrap();
        let first = [0, 1, 2, 3].map(bytes_of);
        let check = |turns: [usize; 12]| {
            for k in turns {
                assert_eq!(bytes_of(k), first[k], "{settings:?}, group {k}");
            }
        };
        std::thread::scope(|scope| {
            scope.spawn(|| check([2, 1, 3, 1, 2, 3, 0, 1, 2, 1, 0, 3]));
            check([0, 1, 2, 2, 3, 1, 0, 3, 1, 2, 0, 1]);
        });
    }
}

#[test]
fn a_group_decoded_alone_equals_the_group_decoded_in_sequence() {
    for codec in CODECS {
        let groups: Vec<_> = (0..3)
            .map(|seed| encode(codec, &group([130, 66], 6, seed)))
            .collect();
        let mut sequential = GroupDecoder::new(codec, [130, 66]).unwrap();
        let mut jumping = GroupDecoder::new(codec, [130, 66]).unwrap();
        jumping.decode(&groups[2][0], 5).unwrap();
        for units in &groups {
            let mut alone = GroupDecoder::new(codec, [130, 66]).unwrap();
            jumping.restart();
            let wanted = decode_all(&mut alone, units);
            assert_eq!(decode_all(&mut sequential, units), wanted, "{codec:?}");
            assert_eq!(decode_all(&mut jumping, units), wanted, "{codec:?}");
            jumping.decode(&units[0], 9).unwrap();
        }
    }
}

#[test]
fn frame_numbers_come_out_as_they_went_in() {
    for codec in CODECS {
        let units = encode(codec, &group([40, 30], 5, 1));
        let mut decoder = GroupDecoder::new(codec, [40, 30]).unwrap();
        for numbers in [[0, 1, 2, 3, 4], [7, 5, 5, -1, 1 << 40]] {
            decoder.restart();
            let out = units
                .iter()
                .zip(numbers)
                .map(|(unit, n)| decoder.decode(unit, n).unwrap().1);
            assert_eq!(out.collect::<Vec<_>>(), numbers, "{codec:?}");
        }
    }
}

#[test]
fn odd_and_tiny_sizes_keep_their_size_in_all_codecs() {
    for codec in CODECS {
        for size in SIZES {
            let pictures = group(size, 3, 2);
            let units = encode(codec, &pictures);
            assert_eq!(units.len(), pictures.len());
            let mut decoder = GroupDecoder::new(codec, size).unwrap();
            for (decoded, picture) in decode_all(&mut decoder, &units).iter().zip(&pictures) {
                assert!(decoded.is_consistent());
                assert!(psnr(decoded, picture) > 25.0, "{codec:?} {size:?}");
            }
        }
    }
}

#[test]
fn quality_bounds_the_error_and_speeds_change_the_bytes() {
    let pictures = group([256, 256], 8, 3);
    for codec in CODECS.into_iter().filter(|codec| *codec != Codec::Png) {
        let least = 40.0;
        let units = encode(codec, &pictures);
        let mut decoder = GroupDecoder::new(codec, [256, 256]).unwrap();
        for (decoded, picture) in decode_all(&mut decoder, &units).iter().zip(&pictures) {
            let reached = psnr(decoded, picture);
            assert!(reached > least, "{codec:?}: {reached} dB");
        }
        let worse = EncodeSettings {
            rate: Rate::Quantiser(31),
            ..settings(codec)
        };
        let size = |units: &[Vec<u8>]| units.iter().map(Vec::len).sum::<usize>();
        assert!(size(&encode_group(&worse, &pictures).unwrap()) < size(&units));
    }
    for codec in PREDICTING {
        let of_speed = |speed| {
            let settings = EncodeSettings {
                speed,
                ..settings(codec)
            };
            encode_group(&settings, &pictures).unwrap()
        };
        let default = of_speed(Speed::Default);
        assert_ne!(of_speed(Speed::Fast), default, "{codec:?}");
        assert_ne!(of_speed(Speed::Small), default, "{codec:?}");
    }
}

#[test]
fn decoding_must_start_at_a_key_frame() {
    for codec in PREDICTING {
        let units = encode(codec, &group([64, 64], 4, 1));
        let mut decoder = GroupDecoder::new(codec, [64, 64]).unwrap();
        assert!(decoder.decode(&units[1], 1).is_err());
        decode_all(&mut decoder, &units);
        decoder.restart();
        let message = decoder.decode(&units[2], 2).unwrap_err().to_string();
        let wanted = format!("{} access unit of frame 2", codec.name());
        assert!(message.contains(&wanted), "{message}");
        assert!(message.contains("no key frame"), "{message}");
        decode_all(&mut decoder, &units);
    }
}

#[test]
fn no_encoder_writes_about_itself() {
    for codec in PREDICTING.into_iter().chain([Codec::Jpeg]) {
        let units = encode(codec, &group([64, 64], 2, 1));
        for word in ["x264", "x265", "Lavc", "libaom"] {
            let bytes = word.as_bytes();
            let found = units[0].windows(bytes.len()).any(|part| part == bytes);
            assert!(!found, "{codec:?} names {word}");
        }
    }
}

#[test]
fn jpeg_qualities_are_those_of_the_independent_jpeg_group() {
    // First row of the luma table of annex K at quality 50, and what 90 makes of it.
    let picture = [scene([64, 48], 0, 3)];
    for (quality, tables) in [
        (50, [16, 11, 10, 16, 24, 40, 51, 61]),
        (90, [3, 2, 2, 3, 5, 8, 10, 12]),
        (100, [1; 8]),
    ] {
        let ijg = EncodeSettings {
            rate: Rate::Ijg(quality),
            ..settings(Codec::Jpeg)
        };
        let unit = &encode_group(&ijg, &picture).unwrap()[0];
        let at = unit
            .windows(2)
            .position(|marker| marker == [0xff, 0xdb])
            .unwrap();
        // In zigzag order, behind marker, length and number of the table.
        let table = &unit[at + 5..];
        let row = [0, 1, 5, 6, 14, 15, 27, 28].map(|zigzag| table[zigzag]);
        assert_eq!(row, tables, "quality {quality}");
        let decoded = GroupDecoder::new(Codec::Jpeg, [64, 48])
            .unwrap()
            .decode(unit, 0)
            .unwrap()
            .0;
        let least = [33.0, 40.0, 50.0][usize::from(quality > 50) + usize::from(quality > 90)];
        let reached = psnr(&decoded, &picture[0]);
        assert!(reached > least, "quality {quality}: {reached}");
        for p in 1..3 {
            let off = decoded.planes[p].iter().zip(&picture[0].planes[p]);
            assert!(
                off.map(|(a, b)| a.abs_diff(*b)).max().unwrap() < 24,
                "plane {p}"
            );
        }
    }
}

#[test]
fn no_group_takes_more_than_its_bit_rate_nor_much_less() {
    let pictures = group_of_noise([256, 256], 16);
    for codec in PREDICTING {
        for bits in [800_000u32, 3_200_000] {
            let rated = EncodeSettings {
                rate: Rate::Bits(bits),
                ..settings(codec)
            };
            let units = encode_group(&rated, &pictures).unwrap();
            let bytes: usize = units.iter().map(Vec::len).sum();
            let wanted = f64::from(bits) / 8.0 * 16.0 / 30.0;
            let ratio = bytes as f64 / wanted;
            println!(
                "{codec:?} {bits}: {ratio:.2} of the bytes, key {}",
                units[0].len()
            );
            assert!((0.4..1.6).contains(&ratio), "{codec:?} {bits}: {ratio}");
            assert_eq!(encode_group(&rated, &pictures).unwrap(), units);
        }
    }
}

#[test]
fn another_size_is_refused() {
    for codec in CODECS {
        let units = encode(codec, &group([64, 48], 1, 1));
        for size in [[48, 64], [64, 40], [32, 32], [128, 96]] {
            let mut decoder = GroupDecoder::new(codec, size).unwrap();
            assert!(decoder.decode(&units[0], 0).is_err(), "{codec:?} {size:?}");
        }
    }
}

#[test]
fn truncated_access_units_are_refused() {
    for codec in CODECS {
        let units = encode(codec, &group([64, 64], 2, 1));
        let mut decoder = GroupDecoder::new(codec, [64, 64]).unwrap();
        // Predicting codecs carry no checksum and read missing bytes as zeros; the pack's CRC sees
        // the rest.
        let half = if codec.is_intra() {
            units[0].len() / 2
        } else {
            9
        };
        for keep in [0, 1, 2, half] {
            assert!(
                decoder.decode(&units[0][..keep], 0).is_err(),
                "{codec:?} {keep} bytes"
            );
        }
        decode_all(&mut decoder, &units);
    }
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let pictures = group([8, 8], 1, 1);
    let refused =
        |settings: &EncodeSettings, pictures: &[Picture]| match encode_group(settings, pictures) {
            Err(MediaError::Setting { field, .. }) => field,
            other => panic!("not refused: {other:?}"),
        };
    let vp9 = settings(Codec::Vp9);
    let jpeg = settings(Codec::Jpeg);
    assert_eq!(
        refused(&rated(vp9, Rate::Quantiser(64)), &pictures),
        "the vp9 quality"
    );
    assert_eq!(
        refused(&rated(jpeg, Rate::Quantiser(0)), &pictures),
        "the jpeg quality"
    );
    assert_eq!(
        refused(&rated(jpeg, Rate::Ijg(0)), &pictures),
        "the jpeg quality"
    );
    assert_eq!(
        refused(&rated(vp9, Rate::Ijg(90)), &pictures),
        "the vp9 rate"
    );
    assert_eq!(
        refused(&rated(jpeg, Rate::Bits(9000)), &pictures),
        "the jpeg rate"
    );
    assert_eq!(
        refused(&rated(vp9, Rate::Bits(9)), &pictures),
        "the vp9 bit rate"
    );
    assert_eq!(
        refused(
            &EncodeSettings {
                frame_rate: [0, 1],
                ..vp9
            },
            &pictures
        ),
        "the frame rate"
    );
    assert_eq!(refused(&vp9, &[]), "the group");
    let mixed = [scene([8, 8], 0, 1), scene([8, 6], 0, 1)];
    assert_eq!(refused(&vp9, &mixed), "the size of picture 1");
    assert!(GroupDecoder::new(Codec::Vp9, [0, 8]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn png_is_lossless(width in 1u32..70, height in 1u32..70, seed: u64) {
        let mut state = seed | 1;
        let mut noise = Picture::filled(width, height, [0; 3]);
        for sample in noise.planes.iter_mut().flatten() {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            *sample = (state >> 56) as u8;
        }
        for speed in [Speed::Fast, Speed::Default, Speed::Small] {
            let png = EncodeSettings { speed, ..settings(Codec::Png) };
            let units = encode_group(&png, std::slice::from_ref(&noise)).unwrap();
            let mut decoder = GroupDecoder::new(Codec::Png, [width, height]).unwrap();
            prop_assert_eq!(&decoder.decode(&units[0], 0).unwrap().0, &noise);
        }
    }

    #[test]
    fn damaged_bytes_never_panic(
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20),
        from in 0usize..3,
    ) {
        for codec in CODECS {
            let units = encode(codec, &group([64, 64], 4, 1));
            let mut decoder = GroupDecoder::new(codec, [64, 64]).unwrap();
            for (i, unit) in units.iter().enumerate() {
                let mut unit = unit.clone();
                for (at, byte) in damage.iter().filter(|_| i >= from) {
                    let at = at.index(unit.len());
                    unit[at] = *byte;
                }
                if let Ok((picture, _)) = decoder.decode(&unit, 0) {
                    prop_assert!(picture.is_consistent());
                    prop_assert_eq!([picture.width, picture.height], [64, 64]);
                }
            }
        }
    }

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        for codec in CODECS {
            let mut decoder = GroupDecoder::new(codec, [33, 65]).unwrap();
            let mut key = bytes.clone();
            match (codec, key.get_mut(..10)) {
                (Codec::Vp9, Some(start)) => start[0] = 0b1000_0010,
                (Codec::Vp8, Some(start)) => {
                    start[0] &= !1;
                    start[3..6].copy_from_slice(&[0x9d, 0x01, 0x2a]);
                }
                _ => {}
            }
            let _ = decoder.decode(&bytes, 0);
            let _ = decoder.decode(&key, 1);
        }
    }
}
