//! Are films shown right whose heads are wrong, or which hold more than is shown?

use super::film_file::Film;
use super::films::{moving, prepared, remarks, repair};
use crate::support::{Folder, refused};
use ffmpeg_next as av;
use std::path::Path;

/// A short film in a container.
fn film(folder: &Folder, name: &str, encoder: &str) -> Vec<u8> {
    let path = folder.name(name);
    let format = match encoder {
        "mjpeg" => av::format::Pixel::YUVJ420P,
        _ => av::format::Pixel::YUV420P,
    };
    let film = Film {
        encoder,
        format,
        frames: 12,
        gop: 4,
        ..Film::default()
    };
    film.write(&path, moving);
    std::fs::read(path).unwrap()
}

/// Where the contents of the first box of a name begin.
fn inside(bytes: &[u8], name: &[u8; 4]) -> usize {
    bytes.windows(4).position(|it| it == name).unwrap() + 4
}

fn set(bytes: &mut [u8], at: usize, word: u32) {
    bytes[at..at + 4].copy_from_slice(&word.to_be_bytes());
}

#[test]
fn an_mp4_with_a_time_scale_of_0_or_another_speed_shows_all_its_frames() {
    let folder = Folder::new();
    let whole = film(&folder, "whole.mp4", "libx264");
    let mut no_scale = whole.clone();
    let mdhd = inside(&whole, b"mdhd");
    set(&mut no_scale, mdhd + 12, 0);
    let told = prepared(&folder, &folder.holding("a.mp4", &no_scale), &[]);
    assert_eq!(told["frames"], 12, "{told}");
    assert!(
        (told["seconds"].as_f64().unwrap() - 0.48).abs() < 0.05,
        "{told}"
    );
    assert!(remarks(&told).contains("time scale of 0"), "{told}");
    assert_eq!(repair(&told, "broken_tags"), 1, "{told}");
    let mut slow = whole.clone();
    let elst = inside(&whole, b"elst");
    set(&mut slow, elst + 16, 0x8000);
    let told = prepared(&folder, &folder.holding("a.mp4", &slow), &[]);
    assert!(
        told["frames"] == 12 && remarks(&told).contains("speed 0.500"),
        "{told}"
    );
    let told = prepared(&folder, &folder.name("whole.mp4"), &[]);
    assert!(!remarks(&told).contains("speed"), "{told}");
}

#[test]
fn a_film_behind_the_end_of_another_is_shown_or_told() {
    let folder = Folder::new();
    for (name, encoder, is_shown) in [
        ("a.mp4", "libx264", false),
        ("a.mov", "libx264", false),
        ("a.flv", "libx264", false),
        ("a.wmv", "mpeg4", false),
        ("a.mkv", "libx264", true),
        ("a.ts", "libx264", true),
        ("a.avi", "mjpeg", true),
        ("a.ogv", "libtheora", true),
    ] {
        let whole = film(&folder, name, encoder);
        let joined = folder.holding(&format!("joined-{name}"), &[&whole[..], &whole].concat());
        let told = prepared(&folder, &joined, &[]);
        let frames = if is_shown { 24 } else { 12 };
        assert_eq!(told["frames"], frames, "{name}: {told}");
        let behind = format!(
            "{} bytes from byte {} on are not shown",
            whole.len(),
            whole.len()
        );
        assert_eq!(
            remarks(&told).contains(&behind),
            !is_shown,
            "{name}: {told}"
        );
        for wrong in ["lost_packets", "frames_dropped_at_start", "damaged_frames"] {
            assert_eq!(repair(&told, wrong), 0, "{name}: {told}");
        }
        let told = prepared(&folder, &folder.name(name), &[]);
        assert!(!remarks(&told).contains("another film"), "{name}: {told}");
    }
}

#[test]
fn a_segment_alone_is_refused_with_what_joins_it() {
    let folder = Folder::new();
    let path = folder.name("whole.mp4");
    let film = Film {
        frames: 12,
        gop: 4,
        ..Film::default()
    };
    film.write(&folder.name("a.mkv"), moving);
    in_pieces(&folder.name("a.mkv"), &path);
    let whole = std::fs::read(&path).unwrap();
    let first = inside(&whole, b"moof") - 8;
    let out = folder.name("never.foveal");
    let refuse = |file: &str, words: &[&str]| {
        refused(1, &["prepare", "video", file, "--out", &out], words);
    };
    let segment = folder.holding("1.m4s", &whole[first..]);
    refuse(
        &segment,
        &["init segment", "cat init.mp4 1.m4s > whole.mp4"],
    );
    let init = folder.holding("init-stream0.m4s", &whole[..first]);
    refuse(&segment, &["cat init-stream0.m4s 1.m4s > whole.mp4"]);
    refuse(&init, &["init segment", "holds no pictures"]);
    let told = prepared(&folder, &path, &[]);
    assert_eq!(told["frames"], 12, "{told}");
    let joined = folder.holding("joined.mp4", &[&whole[..], &whole].concat());
    let told = prepared(&folder, &joined, &[]);
    assert!(remarks(&told).contains("are mixed"), "{told}");
}

/// Copies a film into an MP4 of pieces, a film by itself before the first of them.
fn in_pieces(from: &str, to: &str) {
    let mut input = av::format::input(Path::new(from)).unwrap();
    let mut output = av::format::output(to).unwrap();
    let base = copied(&mut output, &input);
    let mut options = av::Dictionary::new();
    options.set("movflags", "frag_keyframe+empty_moov+default_base_moof");
    output.write_header_with(options).unwrap();
    let base_out = output.stream(0).unwrap().time_base();
    for (_, mut packet) in input.packets() {
        packet.rescale_ts(base, base_out);
        packet.set_position(-1);
        packet.write_interleaved(&mut output).unwrap();
    }
    output.write_trailer().unwrap();
}

/// Adds a copy of the first stream of a file; its unit of time.
#[allow(unsafe_code)] // The tag of a codec has no safe name.
fn copied(
    output: &mut av::format::context::Output,
    input: &av::format::context::Input,
) -> av::Rational {
    let stream = input.stream(0).unwrap();
    let none = av::encoder::find(av::codec::Id::None);
    let mut copy = output.add_stream(none).unwrap();
    copy.set_parameters(stream.parameters());
    // SAFETY: the parameters are the stream's own; another container has other tags.
    unsafe { (*(*copy.as_mut_ptr()).codecpar).codec_tag = 0 };
    copy.set_time_base(stream.time_base());
    copy.set_avg_frame_rate(stream.avg_frame_rate());
    stream.time_base()
}

#[test]
fn of_several_video_tracks_the_film_is_shown_and_others_are_named() {
    let folder = Folder::new();
    film(&folder, "film.mkv", "libx264");
    let cover = Film {
        encoder: "mjpeg",
        format: av::format::Pixel::YUVJ420P,
        frames: 1,
        size: [80, 60],
        ..Film::default()
    };
    cover.write(&folder.name("cover.mkv"), moving);
    for (name, parts, shown, left_out) in [
        (
            "a.mkv",
            ["cover.mkv", "film.mkv"],
            "h264",
            "track 0 (mjpeg, 80x60)",
        ),
        (
            "b.mkv",
            ["film.mkv", "cover.mkv"],
            "h264",
            "track 1 (mjpeg, 80x60)",
        ),
        (
            "a.mp4",
            ["cover.mkv", "film.mkv"],
            "h264",
            "track 0 (mjpeg, 80x60)",
        ),
        (
            "two.mkv",
            ["film.mkv", "film.mkv"],
            "h264",
            "track 1 (h264, 64x48)",
        ),
    ] {
        let path = folder.name(name);
        let mut output = av::format::output(&path).unwrap();
        let mut inputs = parts.map(|it| av::format::input(Path::new(&folder.name(it))).unwrap());
        let bases = [0, 1].map(|k| copied(&mut output, &inputs[k]));
        output.write_header().unwrap();
        for (number, input) in inputs.iter_mut().enumerate() {
            let base_out = output.stream(number).unwrap().time_base();
            for (_, mut packet) in input.packets() {
                packet.rescale_ts(bases[number], base_out);
                packet.set_position(-1);
                packet.set_stream(number);
                packet.write_interleaved(&mut output).unwrap();
            }
        }
        output.write_trailer().unwrap();
        let told = prepared(&folder, &path, &[]);
        assert_eq!(told["frames"], 12, "{name} {shown}: {told}");
        assert!(remarks(&told).contains(left_out), "{name}: {told}");
    }
}

#[test]
fn a_bare_stream_without_a_rate_says_which_one_is_taken_and_an_ogg_may_not_begin_anywhere() {
    let folder = Folder::new();
    let avi = film(&folder, "a.avi", "mjpeg");
    let bare = folder.holding("bare.avi", &avi[100..]);
    let told = prepared(&folder, &bare, &[]);
    assert!(
        remarks(&told).contains("25.000 frames a second are taken"),
        "{told}"
    );
    // The stream itself gives one.
    film(&folder, "a.h264", "libx264");
    let told = prepared(&folder, &folder.name("a.h264"), &[]);
    assert!(!remarks(&told).contains("are taken"), "{told}");
    let told = prepared(&folder, &folder.name("a.avi"), &[]);
    assert!(!remarks(&told).contains("are taken"), "{told}");
    let ogg = film(&folder, "a.ogv", "libtheora");
    let page = ogg.windows(4).rposition(|it| it == b"OggS").unwrap();
    let middle = folder.holding("middle.ogv", &ogg[page..]);
    let out = folder.name("never.foveal");
    refused(
        1,
        &["prepare", "video", &middle, "--out", &out],
        &["begins in the middle of an Ogg", "from its beginning"],
    );
}

#[test]
fn a_folder_is_refused_with_what_to_give_and_messages_have_no_numbers_of_errors() {
    let folder = Folder::new();
    let inside = folder.name(".");
    let out = folder.name("never.foveal");
    let missing = folder.name("missing.mp4");
    let rig = folder.name("missing.toml");
    for (code, arguments, words) in [
        (
            2,
            &["prepare", &inside][..],
            &["is a folder", "foveal prepare video"][..],
        ),
        (
            1,
            &["prepare", "video", &inside, "--out", &out],
            &["it is a folder", "give a file in it"],
        ),
        (
            2,
            &["panels", &inside],
            &["is a folder", "foveal panels fit"],
        ),
        (
            2,
            &["panels", "import", &inside, "--out", &rig],
            &["is a folder", ".mpcdi"],
        ),
        (1, &["panels", "fit", &inside], &["is a folder", "rig file"]),
        (
            1,
            &["panels", "fit", "a.foo"],
            &["is not a rig file that Foveal reads"],
        ),
        (1, &["panels", "fit", &rig], &["No such file"]),
        (
            1,
            &["prepare", "video", &missing, "--out", &out],
            &["No such file"],
        ),
    ] {
        let ran = refused(code, arguments, words);
        assert!(!ran.stderr.contains("os error"), "{ran:?}");
    }
}

#[test]
fn edit_lists_that_would_show_nothing_or_lose_frames_are_corrected() {
    let folder = Folder::new();
    let path = folder.name("whole.mp4");
    let film = Film {
        frames: 12,
        gop: 12,
        b_frames: 2,
        ..Film::default()
    };
    film.write(&path, moving);
    let whole = std::fs::read(&path).unwrap();
    let [elst, ctts] = [b"elst", b"ctts"].map(|it| inside(&whole, it));
    type Change<'a> = &'a dyn Fn(&mut Vec<u8>);
    let changes: [(Change<'_>, &str); 4] = [
        (&|it| set(it, elst + 8, 0), "length of 0"),
        (
            &|it| set(it, elst + 12, 100_000_000),
            "behind its last frame",
        ),
        (&|it| it[ctts - 4..ctts].copy_from_slice(b"free"), "(ctts)"),
        (
            &|it| set(it, ctts + 12, -5000_i32 as u32),
            "before its beginning",
        ),
    ];
    for (change, words) in changes {
        let mut wrong = whole.clone();
        change(&mut wrong);
        let told = prepared(&folder, &folder.holding("a.mp4", &wrong), &[]);
        assert!(
            told["frames"] == 12 && remarks(&told).contains(words),
            "{words}: {told}"
        );
    }
    let told = prepared(&folder, &path, &[]);
    assert!(
        told["frames"] == 12 && repair(&told, "broken_tags") == 0,
        "{told}"
    );
    let moov = inside(&whole, b"moov");
    for (bytes, words) in [
        (&whole[..moov - 8], "without its index (moov)"),
        (&whole[..moov + 60], "ends within its index"),
    ] {
        let file = folder.holding("never.mp4", bytes);
        let out = folder.name("never.foveal");
        refused(
            1,
            &["prepare", "video", &file, "--out", &out],
            &[words, "untrunc"],
        );
    }
}
