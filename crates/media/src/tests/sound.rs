//! Is the sound of a pack heard when its pictures are seen?

use std::path::Path;

use av::codec::{Context, encoder};
use av::format::{Pixel, Sample, sample};
use av::{ChannelLayout, Packet, Rational, format, frame};
use ffmpeg_next as av;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::units::Seconds;

use crate::pack::pack_file::PackFile;
use crate::prepare::{PrepareSettings, ProjectionChoice, prepare};
use crate::read::frame::new_frame;
use crate::tests::scenes::{Scratch, plan_of, prepared, settings};
use crate::tiles::encoder::new_encoder;
use crate::tiles::sound::SoundTrack;

/// A clip of pictures and clicks.
#[derive(Clone, Copy)]
struct Clicks {
    ending: &'static str,
    codec: &'static str,
    rate: u32,
    channels: i32,
    /// When picture and sound begin on the clock of the file, in milliseconds.
    starts_ms: [i64; 2],
}

/// Frames a second, frames, and those at whose time there is a click.
const FPS: i32 = 25;
const FRAMES: i64 = 60;
const CLICKS: [i64; 4] = [12, 25, 38, 51];
/// Samples of a frame of sound, as all its coders take it.
const BLOCK: usize = 1024;

/// One sample of the sound, `moment` seconds after the first picture: silence, and a decaying tone
/// from every click on.
fn heard(moment: f64) -> f32 {
    let since = |click: i64| moment - click as f64 / f64::from(FPS);
    let click = CLICKS
        .into_iter()
        .map(since)
        .find(|s| (0.0..0.03).contains(s));
    click.map_or(0.0, |s| {
        (0.9 * (-s * 150.0).exp() * (s * std::f64::consts::TAU * 1500.0).cos()) as f32
    })
}

fn write(clip: &Clicks) -> Scratch {
    crate::ffmpeg::start();
    let path = Scratch::new(clip.ending);
    let mut output = format::output(&*path).unwrap();
    let (codec, mut video) = new_encoder("mjpeg", Pixel::YUVJ420P, [64, 48], [FPS, 1]).unwrap();
    video.set_flags(av::codec::Flags::GLOBAL_HEADER);
    let mut pictures = crate::ffmpeg::open_encoder(video, codec, &[]).unwrap();
    output
        .add_stream_with(&pictures)
        .unwrap()
        .set_time_base(Rational(1, 1000));
    let mut sound = sound_encoder(clip);
    output
        .add_stream_with(&sound)
        .unwrap()
        .set_time_base(Rational(1, clip.rate as i32));
    output.write_header().unwrap();
    let ticks = [Rational(1, 1000), Rational(1, clip.rate as i32)];
    let mut send = |packet: Packet, stream: usize| {
        let mut packet = packet;
        let to = output.stream(stream).unwrap().time_base();
        packet.rescale_ts(ticks[stream], to);
        packet.set_stream(stream);
        packet.write_interleaved(&mut output).unwrap();
    };
    for number in 0..FRAMES {
        let mut frame = new_frame(Pixel::YUVJ420P, [64, 48]).unwrap();
        (0..3).for_each(|p| frame.data_mut(p).fill(100 + number as u8));
        frame.set_pts(Some(number));
        pictures.send_frame(&frame).unwrap();
        let mut packet = Packet::empty();
        pictures.receive_packet(&mut packet).unwrap();
        let stamp = clip.starts_ms[0] + number * 1000 / i64::from(FPS);
        packet.set_pts(Some(stamp));
        packet.set_dts(Some(stamp));
        send(packet, 0);
    }
    let late = (clip.starts_ms[1] - clip.starts_ms[0]) as f64 / 1000.0;
    let first = clip.starts_ms[1] * i64::from(clip.rate) / 1000;
    let blocks = (FRAMES as f64 / f64::from(FPS) - late) * f64::from(clip.rate) / BLOCK as f64;
    for block in 0..blocks as usize {
        let at = |n: usize| heard(late + (block * BLOCK + n) as f64 / f64::from(clip.rate));
        let samples: Vec<f32> = (0..BLOCK).map(at).collect();
        sound
            .send_frame(&sound_frame(clip, &samples, first + (block * BLOCK) as i64))
            .unwrap();
        drain(&mut sound, |packet| send(packet, 1));
    }
    sound.send_eof().unwrap();
    drain(&mut sound, |packet| send(packet, 1));
    output.write_trailer().unwrap();
    path
}

fn sound_encoder(clip: &Clicks) -> encoder::audio::Encoder {
    let codec = encoder::find_by_name(clip.codec).unwrap();
    let mut audio = Context::new_with_codec(codec).encoder().audio().unwrap();
    audio.set_rate(clip.rate as i32);
    audio.set_format(format_of(clip));
    audio.set_channel_layout(ChannelLayout::default(clip.channels));
    audio.set_time_base(Rational(1, clip.rate as i32));
    audio.set_bit_rate(128_000);
    audio.set_flags(av::codec::Flags::GLOBAL_HEADER);
    audio.open_as(codec).unwrap()
}

fn format_of(clip: &Clicks) -> Sample {
    match clip.codec {
        "aac" => Sample::F32(sample::Type::Planar),
        _ => Sample::I16(sample::Type::Packed),
    }
}

fn sound_frame(clip: &Clicks, samples: &[f32], pts: i64) -> frame::Audio {
    let layout = ChannelLayout::default(clip.channels);
    let mut frame = frame::Audio::new(format_of(clip), samples.len(), layout);
    frame.set_rate(clip.rate);
    frame.set_pts(Some(pts));
    let bytes: Vec<u8> = match clip.codec {
        "aac" => samples.iter().flat_map(|s| s.to_ne_bytes()).collect(),
        _ => {
            let code = |s: &f32| {
                ((s * 32_000.0) as i16)
                    .to_ne_bytes()
                    .repeat(clip.channels as usize)
            };
            samples.iter().flat_map(code).collect()
        }
    };
    for plane in 0..frame.planes() {
        frame.data_mut(plane)[..bytes.len()].copy_from_slice(&bytes);
    }
    frame
}

fn drain(encoder: &mut encoder::audio::Encoder, mut send: impl FnMut(Packet)) {
    let mut packet = Packet::empty();
    while encoder.receive_packet(&mut packet).is_ok() {
        send(std::mem::replace(&mut packet, Packet::empty()));
    }
}

fn track(pack: &Path) -> SoundTrack {
    SoundTrack::open(&PackFile::open(pack).unwrap())
        .unwrap()
        .unwrap()
}

fn whole(track: &mut SoundTrack) -> Vec<f32> {
    let moments = (track.length().0 * f64::from(track.rate())).round() as usize;
    let mut samples = vec![0.0; moments * track.channels()];
    track.read(Seconds(0.0), &mut samples);
    samples
}

/// The moments at which it gets loud after silence.
fn onsets(samples: &[f32], channels: usize) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for (at, sample) in samples.iter().step_by(channels).enumerate() {
        let moment = at as f64 / 48_000.0;
        if sample.abs() > 0.3 && found.last().is_none_or(|last| moment - last > 0.1) {
            found.push(moment);
        }
    }
    found
}

#[test]
fn clicks_are_heard_at_their_frames() {
    let plain = Clicks {
        ending: "mkv",
        codec: "pcm_s16le",
        rate: 48_000,
        channels: 2,
        starts_ms: [0, 0],
    };
    for clip in [
        plain,
        Clicks {
            rate: 44_100,
            ..plain
        },
        Clicks {
            rate: 44_100,
            channels: 1,
            ..plain
        },
        Clicks {
            ending: "mp4",
            codec: "aac",
            rate: 44_100,
            ..plain
        },
        Clicks {
            ending: "mp4",
            codec: "aac",
            starts_ms: [0, 300],
            ..plain
        },
        Clicks {
            starts_ms: [500, 200],
            ..plain
        },
        Clicks {
            starts_ms: [2000, 2400],
            channels: 1,
            ..plain
        },
        Clicks {
            ending: "mov",
            starts_ms: [400, 0],
            channels: 6,
            ..plain
        },
    ] {
        let file = write(&clip);
        let pack = prepared(&file, &settings(ProjectionChoice::Flat, Codec::Jpeg));
        let mut track = track(&pack);
        let name = format!("{} {} {:?}", clip.ending, clip.codec, clip.starts_ms);
        assert!(
            (track.length().0 - 2.4).abs() < 0.05,
            "{name}: {}",
            track.length().0
        );
        assert_eq!(track.channels(), clip.channels.min(2) as usize);
        let samples = whole(&mut track);
        let found = onsets(&samples, track.channels());
        let expected = CLICKS.map(|frame| frame as f64 / f64::from(FPS));
        assert_eq!(found.len(), expected.len(), "{name}: {found:?}");
        for (found, expected) in found.iter().zip(expected) {
            println!("{name}: off by {:.2} ms", (found - expected) * 1e3);
            assert!(
                (found - expected).abs() < 0.005,
                "{name}: {found} {expected}"
            );
        }
    }
}

#[test]
fn any_moment_can_be_jumped_to_and_reading_on_has_no_seam() {
    let clip = Clicks {
        ending: "mkv",
        codec: "pcm_s16le",
        rate: 48_000,
        channels: 2,
        starts_ms: [0, 0],
    };
    let pack = prepared(
        &write(&clip),
        &settings(ProjectionChoice::Flat, Codec::Jpeg),
    );
    let mut track = track(&pack);
    let all = whole(&mut track);
    // In pieces of any size, with the clock of a sound card that runs a little off.
    let mut pieces = Vec::new();
    for (turn, count) in [700, 1, 480, 4096, 12_345].into_iter().enumerate() {
        let mut piece = vec![9.0; count * 2];
        let clock = (pieces.len() / 2) as f64 / 48_000.0 + turn as f64 * 1e-4;
        track.read(Seconds(clock), &mut piece);
        pieces.extend(piece);
    }
    assert_eq!(pieces, all[..pieces.len()]);
    for from in [1.5, 0.47, 2.03, 0.0] {
        let mut piece = vec![9.0; 4800 * 2];
        track.read(Seconds(from), &mut piece);
        let there = &all[(from * 48_000.0).round() as usize * 2..][..piece.len()];
        let worst = piece
            .iter()
            .zip(there)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max);
        assert!(worst < 0.02, "{from}: {worst}");
    }
    let mut silent = vec![9.0; 960];
    for from in [-5.0, 2.5, 1e300, -1e300, f64::NAN] {
        silent.fill(9.0);
        track.read(Seconds(from), &mut silent);
        assert!(silent.iter().all(|sample| *sample == 0.0), "{from}");
    }
    let across = 480;
    track.read(Seconds(-0.005), &mut silent);
    assert_eq!(silent[..across], vec![0.0; across]);
}

#[test]
fn a_track_may_be_played_on_another_thread() {
    fn assert_send<T: Send>() {}
    assert_send::<SoundTrack>();
}

#[test]
fn without_sound_or_wish_for_it_a_pack_is_silent_and_that_is_said() {
    let clip = Clicks {
        ending: "mkv",
        codec: "pcm_s16le",
        rate: 48_000,
        channels: 2,
        starts_ms: [0, 0],
    };
    let file = write(&clip);
    let unwanted = PrepareSettings {
        sound: false,
        ..settings(ProjectionChoice::Flat, Codec::Jpeg)
    };
    let pack = PackFile::open(&prepared(&file, &unwanted)).unwrap();
    assert!(SoundTrack::open(&pack).unwrap().is_none());
    let mute = crate::tests::scenes::write_clip(
        "mkv",
        crate::ClipCodec::Ffv1,
        &[
            foveal_core::view::picture::Picture::filled(64, 48, [90, 128, 128]),
            foveal_core::view::picture::Picture::filled(64, 48, [91, 128, 128]),
        ],
    );
    let plan = plan_of(&mute, &settings(ProjectionChoice::Flat, Codec::Jpeg)).unwrap();
    assert!(
        plan.remarks.all().contains(&"it has no sound"),
        "{:?}",
        plan.remarks
    );
}

#[test]
fn broken_sound_is_noted_and_the_pictures_are_prepared_anyhow() {
    let clip = Clicks {
        ending: "mp4",
        codec: "aac",
        rate: 48_000,
        channels: 2,
        starts_ms: [0, 0],
    };
    let whole = write(&clip);
    let pictures = crate::tests::scenes::read(&whole).1.unwrap().len() as u32;
    let mut bytes = std::fs::read(&*whole).unwrap();
    // An MP4 names the sound's coder in a box of four letters; ffff is none.
    let at = bytes.windows(4).position(|four| four == b"mp4a").unwrap();
    bytes[at..at + 4].copy_from_slice(b"ffff");
    let esds = bytes[at..].windows(4).position(|four| four == b"esds");
    let esds = at + esds.unwrap();
    bytes[esds..esds + 4].copy_from_slice(b"free");
    let broken = Scratch::holding("mp4", &bytes);
    let plan = plan_of(&broken, &settings(ProjectionChoice::Flat, Codec::Jpeg)).unwrap();
    let out = Scratch::new("foveal");
    let done = prepare(&broken, &out, &plan, &mut |_| {}).unwrap();
    assert_eq!((done.description.frames, pictures > 50), (pictures, true));
    assert!(
        done.warnings.iter().any(|said| said.contains("sound")),
        "{:?}",
        done.warnings
    );
    let pack = PackFile::open(&out).unwrap();
    assert!(pack.verify(|_, _| {}).is_empty() && pack.sound().unwrap().is_none());
}
