//! Do clips come in as they are, at their time and the right way up?

use av::ffi::AVPacketSideDataType as SideData;
use av::format::Pixel;
use ffmpeg_next as av;

use crate::tests::scenes::{
    RawFile, Scratch, VIDEO, group, psnr, raw, read, read_one, write_clip, write_raw,
};
use crate::{ClipCodec, ClipFormat, ClipWriter, SphericalProjection, StereoLayout, VideoInput};

const FRAME_NS: i64 = 40_000_000;

#[test]
fn a_lossless_clip_comes_back_sample_by_sample() {
    for size in [[64, 48], [47, 47], [1, 1], [255, 3]] {
        let pictures = group(size, 7, 1);
        let path = write_clip("mkv", ClipCodec::Ffv1, &pictures);
        let (input, read) = read(&path);
        let read = read.unwrap();
        assert_eq!(read.len(), pictures.len());
        for (i, (timed, picture)) in read.iter().zip(&pictures).enumerate() {
            assert_eq!(timed.time_ns, i as i64 * FRAME_NS);
            assert_eq!(timed.picture, *picture);
        }
        let info = input.info();
        assert_eq!([info.width, info.height], size);
        assert_eq!(info.colour, VIDEO);
        assert_eq!(info.frame_rate, [25, 1]);
        assert_eq!(
            (info.codec.as_str(), info.pixel_format.as_str()),
            ("ffv1", "yuv420p")
        );
        assert_eq!(info.bytes, std::fs::metadata(&*path).unwrap().len());
        assert_eq!(info.frames, Some(7));
        assert!(info.transparency.is_none() && !info.looks_still && info.spherical.is_none());
    }
}

#[test]
fn coded_clips_come_back_in_order_and_alike() {
    let pictures = group([96, 64], 20, 2);
    for (ending, codec) in [
        ("mp4", ClipCodec::H264(18)),
        ("mkv", ClipCodec::H264(18)),
        ("webm", ClipCodec::Vp9(16)),
        ("mp4", ClipCodec::Vp9(16)),
        ("avi", ClipCodec::Mjpeg(2)),
        ("mov", ClipCodec::Mjpeg(2)),
    ] {
        let path = write_clip(ending, codec, &pictures);
        let (input, read) = read(&path);
        let read = read.unwrap();
        assert_eq!(read.len(), pictures.len(), "{codec:?}");
        for (i, (timed, picture)) in read.iter().zip(&pictures).enumerate() {
            assert_eq!(timed.time_ns, i as i64 * FRAME_NS, "{ending} {codec:?}");
            assert!(
                psnr(&timed.picture, picture) > 38.0,
                "{ending} {codec:?} frame {i}"
            );
        }
        let is_jpeg = matches!(codec, ClipCodec::Mjpeg(_));
        assert_eq!(
            input.info().colour.full_range,
            is_jpeg,
            "{ending} {codec:?}"
        );
        assert_eq!(
            input.info().colour.chroma_left,
            !is_jpeg,
            "{ending} {codec:?}"
        );
    }
}

#[test]
fn a_clip_is_the_same_bytes_each_time() {
    let pictures = group([32, 32], 3, 2);
    let bytes = || std::fs::read(&*write_clip("mkv", ClipCodec::Ffv1, &pictures)).unwrap();
    assert_eq!(bytes(), bytes());
}

#[test]
fn a_variable_frame_rate_is_kept() {
    let ticks = [0u64, 40, 50, 130, 131];
    for ending in ["mkv", "mp4"] {
        let path = Scratch::new(ending);
        let (codec, size) = (ClipCodec::Vp9(30), [32, 32]);
        let format = ClipFormat {
            codec,
            size,
            frame_rate: [1000, 1],
            colour: VIDEO,
        };
        let mut clip = ClipWriter::create(&path, &format).unwrap();
        for (picture, tick) in group(size, 5, 1).iter().zip(ticks) {
            clip.push_at(picture, tick).unwrap();
        }
        clip.finish().unwrap();
        let times: Vec<i64> = read(&path)
            .1
            .unwrap()
            .iter()
            .map(|timed| timed.time_ns)
            .collect();
        assert_eq!(times, ticks.map(|tick| tick as i64 * 1_000_000), "{ending}");
    }
}

/// A display matrix of a clockwise turn by quarters.
fn display_matrix(cos: i32, sin: i32) -> Vec<u8> {
    let one = 1 << 16;
    let matrix = [
        cos * one,
        sin * one,
        0,
        -sin * one,
        cos * one,
        0,
        0,
        0,
        1 << 30,
    ];
    matrix.iter().flat_map(|n: &i32| n.to_ne_bytes()).collect()
}

#[test]
fn rotated_files_come_upright_with_their_chroma() {
    let [w, h] = [32usize, 16usize];
    // Left half dark with high U, right half bright with high V.
    let fill = |_: u32, p: usize, x: usize, _: usize| {
        let right = x >= if p == 0 { w / 2 } else { w / 4 };
        [[50, 200], [180, 90], [90, 180]][p][usize::from(right)]
    };
    // Where the dark half lies after the turn, as a corner that it covers.
    for (cos, sin, dark) in [
        (1, 0, [0, 0]),
        (0, 1, [1, 0]),
        (-1, 0, [1, 1]),
        (0, -1, [0, 1]),
    ] {
        let side_data = [(
            SideData::AV_PKT_DATA_DISPLAYMATRIX,
            display_matrix(cos, sin),
        )];
        let size = [w as u32, h as u32];
        let plain = raw("mjpeg", "mov", Pixel::YUVJ420P, size);
        let path = write_raw(
            &RawFile {
                side_data: &side_data,
                ..plain
            },
            2,
            fill,
        );
        let (_, picture) = read_one(&path);
        let turned = if sin == 0 { [w, h] } else { [h, w] };
        assert_eq!([picture.width as usize, picture.height as usize], turned);
        for (p, wanted) in [50u8, 180, 90].into_iter().enumerate() {
            let [pw, ph] = picture.plane_size(p).map(|n| n as usize);
            let at = dark[1] * (ph - 1) * pw + dark[0] * (pw - 1);
            let got = picture.planes[p][at];
            assert!(
                got.abs_diff(wanted) <= 6,
                "{cos} {sin} plane {p}: {got}, not {wanted}"
            );
        }
    }
}

#[test]
fn a_slanted_rotation_is_told_and_not_followed() {
    let slanted = [46341i32, 46341, 0, -46341, 46341, 0, 0, 0, 1 << 30];
    let bytes = slanted.iter().flat_map(|n| n.to_ne_bytes()).collect();
    let side_data = [(SideData::AV_PKT_DATA_DISPLAYMATRIX, bytes)];
    let plain = raw("mjpeg", "mov", Pixel::YUVJ420P, [16, 16]);
    let path = write_raw(
        &RawFile {
            side_data: &side_data,
            ..plain
        },
        1,
        |_, _, _, _| 9,
    );
    let input = VideoInput::open(&path).unwrap();
    let told = input.info().tags.broken.join("; ");
    assert!(told.contains("45.0°"), "{told}");
}

#[test]
fn projection_and_stereo_are_read() {
    let quarter = 1u32 << 30;
    let words = |words: &[u32]| {
        words
            .iter()
            .flat_map(|n| n.to_ne_bytes())
            .collect::<Vec<u8>>()
    };
    let cases = [
        (
            [0, 90 << 16, 0, 0, 0, 0, 0, 0, 0],
            SphericalProjection::Equirect,
        ),
        (
            [2, 0, 0, 0, quarter, 0, quarter, 0, 0],
            SphericalProjection::EquirectPart {
                cut: [0.25, 0.0, 0.25, 0.0],
            },
        ),
        (
            [1, 0, 0, 0, 0, 0, 0, 0, 4],
            SphericalProjection::Cube { padding: 4 },
        ),
    ];
    for (mapping, projection) in cases {
        let side_data = [
            (SideData::AV_PKT_DATA_SPHERICAL, words(&mapping)),
            (SideData::AV_PKT_DATA_STEREO3D, words(&[2, 0, 0])),
        ];
        let plain = raw("mjpeg", "mp4", Pixel::YUVJ420P, [64, 64]);
        let path = write_raw(
            &RawFile {
                side_data: &side_data,
                ..plain
            },
            1,
            |_, _, _, _| 9,
        );
        let (input, _) = read_one(&path);
        let spherical = input.info().spherical.unwrap();
        match (spherical.projection, projection) {
            (
                SphericalProjection::EquirectPart { cut: a },
                SphericalProjection::EquirectPart { cut: b },
            ) => {
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "{a:?}");
                assert!(spherical.is_half());
            }
            (read, wanted) => assert_eq!(read, wanted),
        }
        assert_eq!(spherical.yaw_deg, if mapping[1] == 0 { 0.0 } else { 90.0 });
        let stereo = input.info().stereo.unwrap();
        assert_eq!(
            (stereo.layout, stereo.right_first),
            (StereoLayout::TopBottom, false)
        );
    }
}
