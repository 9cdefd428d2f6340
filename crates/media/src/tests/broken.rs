//! Are files that cannot be read or written refused in words?

use av::format::Pixel;
use ffmpeg_next as av;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::view::picture::Picture;

use crate::pack::pack_file::PackFile;
use crate::prepare::ProjectionChoice;
use crate::tests::scenes::{
    Scratch, VIDEO, group, prepared, raw, read, read_strictly, settings, write_clip, write_raw,
};
use crate::{ClipCodec, ClipFormat, ClipWriter, MediaError, VideoInput};

#[test]
fn a_truncated_file_is_told_with_file_frame_and_time_after_its_good_frames() {
    let pictures = group([64, 64], 40, 3);
    for (ending, codec) in [
        ("mkv", ClipCodec::Ffv1),
        ("mkv", ClipCodec::H264(20)),
        ("webm", ClipCodec::Vp9(20)),
        ("avi", ClipCodec::Mjpeg(3)),
        ("mp4", ClipCodec::H264(20)),
        ("mov", ClipCodec::Mjpeg(3)),
    ] {
        let whole = std::fs::read(&*write_clip(ending, codec, &pictures)).unwrap();
        for tenths in [1, 3, 5, 7, 9] {
            let cut = Scratch::holding(ending, &whole[..whole.len() * tenths / 10]);
            let error = read_strictly(&cut).unwrap_err();
            let what = format!("{ending} {codec:?} {tenths}/10: {error}");
            assert!(what.contains(&cut.display().to_string()), "{what}");
            match error {
                MediaError::Broken { frame, seconds, .. } => {
                    assert!(frame > 0 && frame < 40, "{what}");
                    // Where the cut takes a B-frame, the frames after it have been shown.
                    assert!((seconds - frame as f64 / 25.0).abs() < 0.1, "{what}");
                    // Unless that is refused, what is there is shown.
                    let (input, pictures) = read(&cut);
                    let (shown, mended) = (pictures.unwrap().len() as u64, input.mended());
                    assert!((frame..40).contains(&shown), "{shown}: {what}");
                    let [damaged, lost] = [mended.damaged, mended.lost];
                    let is_cut = mended.breaks_off.is_some();
                    assert!(is_cut || damaged + lost <= 2, "{what}: {mended:?}");
                }
                MediaError::NotVideo { .. } | MediaError::NoFrames { .. } => {
                    assert!(tenths < 5, "{what}");
                }
                // The index itself is cut, without which nothing is known of the frames.
                MediaError::OtherFile { .. } => {
                    assert!(
                        tenths < 5 && what.contains("ends within its index"),
                        "{what}"
                    );
                }
                _ => panic!("{what}"),
            }
        }
    }
}

/// Where the blocks of a Matroska file of one track say how many milliseconds after their cluster
/// they are shown.
fn stamps_of_blocks(bytes: &[u8], count: usize) -> Vec<usize> {
    let mut from = 0;
    let mut found = Vec::new();
    for frame in 0..count {
        let [high, low] = (frame as u16 * 40).to_be_bytes();
        let is_block = |four: &[u8]| four[..3] == [0x81, high, low] && four[3] & 0x7f == 0;
        let place = bytes[from..].windows(4).position(is_block);
        from += place.unwrap() + 1;
        found.push(from);
    }
    found
}

#[test]
fn stamps_that_jump_back_forward_or_not_at_all_give_times_that_rise() {
    let clip = write_clip("mkv", ClipCodec::Ffv1, &group([64, 48], 12, 5));
    let good = std::fs::read(&*clip).unwrap();
    let places = stamps_of_blocks(&good, 12);
    let stamps: [fn(usize) -> i16; 6] = [
        |_| 0,
        |frame| 440 - frame as i16 * 40,
        |frame| if frame < 6 { frame as i16 * 40 } else { 30_000 },
        |frame| {
            if frame < 6 {
                30_000 + frame as i16
            } else {
                frame as i16
            }
        },
        |frame| if frame % 2 == 0 { i16::MIN } else { i16::MAX },
        |frame| (frame as i16).wrapping_mul(7919),
    ];
    for (turn, stamp) in stamps.into_iter().enumerate() {
        let mut bad = good.clone();
        for (frame, at) in places.iter().enumerate() {
            bad[*at..at + 2].copy_from_slice(&stamp(frame).to_be_bytes());
        }
        let bad = Scratch::holding("mkv", &bad);
        let pictures = read(&bad).1.unwrap();
        assert_eq!(pictures.len(), 12, "{turn}");
        assert_eq!(pictures[0].time_ns, 0);
        let rises = |pair: &[crate::TimedPicture]| pair[0].time_ns < pair[1].time_ns;
        assert!(pictures.windows(2).all(rises), "{turn}");
        let pack = prepared(&bad, &settings(ProjectionChoice::Flat, Codec::Png));
        let times = PackFile::open(&pack).unwrap().frame_times().unwrap();
        let shown: Vec<i64> = pictures.iter().map(|timed| timed.time_ns).collect();
        assert_eq!(times, shown, "{turn}");
    }
}

#[test]
fn a_file_that_is_cut_while_it_is_read_is_told_and_ends() {
    let pictures = group([256, 192], 60, 3);
    for (ending, codec) in [
        ("mkv", ClipCodec::Ffv1),
        ("mp4", ClipCodec::H264(4)),
        ("avi", ClipCodec::Mjpeg(2)),
    ] {
        let clip = write_clip(ending, codec, &pictures);
        let mut input = VideoInput::open(&clip).unwrap();
        assert!(input.next_frame().unwrap().is_some());
        let file = std::fs::File::options().write(true).open(&*clip).unwrap();
        file.set_len(file.metadata().unwrap().len() * 6 / 10)
            .unwrap();
        let mut count = 1;
        let end = loop {
            match input.next_frame() {
                Ok(Some(_)) => count += 1,
                Ok(None) => break None,
                Err(error) => break Some(error),
            }
            assert!(count <= 60, "{ending}");
        };
        assert!(count < 60, "{ending}: all frames of a file that lost some");
        let told = matches!(end, Some(MediaError::Broken { .. }));
        assert!(told, "{ending}: {count} frames, then {end:?}");
    }
}

#[test]
fn files_that_are_no_video_are_told_apart() {
    let message = |path: &std::path::Path| VideoInput::open(path).err().unwrap().to_string();
    let text = b"This is a text, not a video.\n".repeat(100);
    for ending in ["mp4", "txt", "png", "mkv", "jpg"] {
        let empty = message(&Scratch::holding(ending, b""));
        assert!(empty.contains("empty"), "{empty}");
        let text = message(&Scratch::holding(ending, &text));
        assert!(text.contains(&format!(".{ending}: ")), "{text}");
    }
    let missing = Scratch::new("mp4");
    assert!(message(&missing).contains("cannot be opened"));
    assert!(message(&std::env::temp_dir()).contains("it is a folder"));
    assert!(message("nul\0.mp4".as_ref()).contains("cannot be opened"));
}

#[test]
fn a_sound_file_is_refused_by_its_streams() {
    let mut wav = b"RIFF\x24\x10\0\0WAVEfmt \x10\0\0\0\x01\0\x01\0".to_vec();
    wav.extend(b"\x40\x1f\0\0\x80\x3e\0\0\x02\0\x10\0data\0\x10\0\0");
    wav.resize(44 + 4096, 0);
    let error = VideoInput::open(&Scratch::holding("wav", &wav))
        .err()
        .unwrap();
    assert!(matches!(error, MediaError::NoVideoStream { .. }), "{error}");
    let told = error.to_string();
    assert!(
        told.contains("holds no video stream, only audio;"),
        "{told}"
    );
}

#[test]
fn a_change_of_size_is_told_with_its_frame() {
    let mut bytes = Vec::new();
    for size in [[64, 48], [48, 64]] {
        let file = raw("mjpeg", "mjpeg", Pixel::YUVJ420P, size);
        bytes.extend(std::fs::read(&*write_raw(&file, 3, |_, _, x, _| x as u8)).unwrap());
    }
    let film = Scratch::holding("mjpeg", &bytes);
    let (input, pictures) = read(&film);
    let fits = |it: &crate::TimedPicture| [it.picture.width, it.picture.height] == [64, 48];
    let pictures = pictures.unwrap();
    assert!(pictures.len() == 6 && pictures.iter().all(fits));
    let mended = input.mended();
    assert_eq!(
        (mended.resized, mended.sizes),
        (3, Some([[64, 48], [48, 64]]))
    );
    // Upright in the middle, with black on both sides.
    let upright = &pictures[4].picture;
    assert_eq!(
        (upright.planes[0][24 * 64], upright.planes[0][24 * 64 + 63]),
        (0, 0)
    );
    assert!(upright.planes[0][24 * 64 + 45] > 20);
    let error = read_strictly(&film).unwrap_err();
    assert!(
        matches!(
            error,
            MediaError::SizeChange {
                frame: 3,
                from: [64, 48],
                to: [48, 64],
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn clips_refuse_what_they_cannot_hold() {
    let path = Scratch::new("mkv");
    let good = ClipFormat {
        codec: ClipCodec::Ffv1,
        size: [16, 16],
        frame_rate: [25, 1],
        colour: VIDEO,
    };
    for bad in [
        ClipFormat {
            codec: ClipCodec::Mjpeg(2),
            ..good
        },
        ClipFormat {
            codec: ClipCodec::H264(52),
            ..good
        },
        ClipFormat {
            codec: ClipCodec::H264(20),
            size: [15, 16],
            ..good
        },
        ClipFormat {
            size: [0, 16],
            ..good
        },
        ClipFormat {
            frame_rate: [0, 1],
            ..good
        },
    ] {
        assert!(ClipWriter::create(&path, &bad).is_err(), "{bad:?}");
    }
    assert!(ClipWriter::create(&Scratch::new("unknown"), &good).is_err());
    let mut clip = ClipWriter::create(&path, &good).unwrap();
    assert!(clip.push(&Picture::filled(16, 14, [0; 3])).is_err());
    assert!(
        clip.finish()
            .unwrap_err()
            .to_string()
            .contains("no picture")
    );
}

#[test]
fn damage_in_the_middle_is_told_with_its_frame() {
    let pictures = group([128, 128], 40, 3);
    for (ending, codec) in [
        ("mkv", ClipCodec::H264(20)),
        ("mp4", ClipCodec::H264(20)),
        ("avi", ClipCodec::Mjpeg(3)),
    ] {
        let mut bytes = std::fs::read(&*write_clip(ending, codec, &pictures)).unwrap();
        let middle = bytes.len() / 2;
        for byte in &mut bytes[middle..middle + 300] {
            *byte ^= 0x5A;
        }
        let film = Scratch::holding(ending, &bytes);
        let (input, pictures) = read(&film);
        let mended = input.mended();
        let [shown, bad] = [pictures.unwrap().len() as u64, mended.damaged + mended.lost];
        assert!(
            bad > 0 && (25..=40).contains(&shown),
            "{ending} {shown} {mended:?}"
        );
        let (first, time_ns) = mended.first_damaged.unwrap_or_default();
        assert!(
            mended.damaged == 0 || (5..35).contains(&first) && time_ns > 0,
            "{mended:?}"
        );
        let frames = read_strictly(&film).map(|pictures| pictures.len());
        assert!(
            matches!(frames, Err(MediaError::Broken { frame: 5..35, .. })),
            "{ending} {codec:?} {frames:?}"
        );
    }
}

#[test]
fn a_cut_image_is_refused() {
    for (encoder, ending, format) in [
        ("png", "png", Pixel::RGB24),
        ("mjpeg", "jpg", Pixel::YUVJ420P),
        ("bmp", "bmp", Pixel::BGR24),
        ("tiff", "tif", Pixel::RGB24),
    ] {
        let noise = |_: u32, _: usize, x: usize, y: usize| (x * x + 7 * x * y) as u8;
        let path = write_raw(&raw(encoder, ending, format, [200, 200]), 1, noise);
        let whole = std::fs::read(&*path).unwrap();
        for tenths in [0, 1, 5, 9] {
            let cut = Scratch::holding(ending, &whole[..whole.len() * tenths / 10]);
            assert!(VideoInput::open(&cut).is_err(), "{ending} {tenths}/10");
        }
    }
}
