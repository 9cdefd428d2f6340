//! Are pictures as people have them shown, and are repairs reported?

use super::film_file::coded;
use super::odd_stills::{self, remarks};
use crate::support::{Folder, Rgb, done, foveal, frame_picture, json, refused};
use ffmpeg_next::format::Pixel;
use image_webp::{ColorType, WebPEncoder};

/// Prepares a picture without loss and gives what is seen of its first frame.
pub(super) fn seen(folder: &Folder, file: &str, view: &str) -> (serde_json::Value, Rgb, String) {
    let (pack, out) = (folder.name("seen.foveal"), folder.name("seen"));
    let prepare = [
        "prepare",
        "video",
        file,
        "--out",
        &pack,
        "--force",
        "--no-loss",
    ];
    let ran = done(&[&prepare[..], &["--codec", "png", "--levels", "1", "--json"]].concat());
    let told = crate::support::json_of(&ran);
    let play = ["simulate", &pack, "--policy", "full", "--renderer", "cpu"];
    done(&[&play[..], &["--view", view, "--out", &out]].concat());
    (told, frame_picture(&out, 0), ran.stderr)
}

fn boxed(name: &[u8; 4], contents: &[u8]) -> Vec<u8> {
    let length = (contents.len() as u32 + 8).to_be_bytes();
    [&length[..], name, contents].concat()
}

/// An item of a HEIF file: its kind, its bytes, and the numbers of its properties.
type Item<'a> = (&'a [u8; 4], Vec<u8>, &'a [u8]);

/// A HEIF file whose first item is shown.
fn heif(brand: &[u8; 4], items: &[Item<'_>], properties: &[Vec<u8>], references: &[u8]) -> Vec<u8> {
    let count = items.len() as u8;
    let infe = |(number, item): (usize, &Item<'_>)| {
        boxed(
            b"infe",
            &[&[2, 0, 0, 0, 0, number as u8 + 1, 0, 0][..], item.0, &[0]].concat(),
        )
    };
    let infes: Vec<u8> = items.iter().enumerate().flat_map(infe).collect();
    let mut ipma = vec![0, 0, 0, 0, 0, 0, 0, count];
    for (number, item) in items.iter().enumerate() {
        ipma.extend([0, number as u8 + 1, item.2.len() as u8]);
        ipma.extend(item.2);
    }
    let ftyp = boxed(b"ftyp", &[&brand[..], &[0; 4], brand, b"mif1"].concat());
    let meta_of = |from: u32| {
        let mut iloc = vec![0, 0, 0, 0, 0x44, 0, 0, count];
        let mut at = from;
        for (number, item) in items.iter().enumerate() {
            iloc.extend([0, number as u8 + 1, 0, 0, 0, 1]);
            iloc.extend(at.to_be_bytes());
            iloc.extend((item.1.len() as u32).to_be_bytes());
            at += item.1.len() as u32;
        }
        let parts = [
            vec![0; 4],
            boxed(b"hdlr", b"\0\0\0\0\0\0\0\0pict\0\0\0\0\0\0\0\0\0\0\0\0\0"),
            boxed(b"pitm", &[0, 0, 0, 0, 0, 1]),
            boxed(b"iloc", &iloc),
            boxed(b"iinf", &[&[0, 0, 0, 0, 0, count][..], &infes].concat()),
            boxed(b"iref", references),
            boxed(
                b"iprp",
                &[boxed(b"ipco", &properties.concat()), boxed(b"ipma", &ipma)].concat(),
            ),
        ];
        boxed(b"meta", &parts.concat())
    };
    let from = ftyp.len() + meta_of(0).len() + 8;
    let data: Vec<u8> = items.iter().flat_map(|it| it.1.clone()).collect();
    [ftyp, meta_of(from as u32), boxed(b"mdat", &data)].concat()
}

fn ispe(size: [u32; 2]) -> Vec<u8> {
    let sides: Vec<u8> = size.iter().flat_map(|side| side.to_be_bytes()).collect();
    boxed(b"ispe", &[&[0; 4][..], &sides].concat())
}

/// Luma of four quarters: bright at the upper left, then darker along the rows.
fn quarters(size: [u32; 2]) -> impl Fn(usize, u32, u32) -> u8 {
    move |p, x, y| {
        let quarter = usize::from(x >= size[0] / 2) + 2 * usize::from(y >= size[1] / 2);
        if p > 0 {
            128
        } else {
            [240, 170, 110, 40][quarter]
        }
    }
}

/// Luma in the middle of each quarter of a picture.
fn of_quarters(picture: &Rgb) -> [u8; 4] {
    let [w, h] = picture.size;
    [[1, 1], [3, 1], [1, 3], [3, 3]].map(|[x, y]| picture.at([w * x / 4, h * y / 4])[1])
}

fn ranks(picture: &Rgb) -> [usize; 4] {
    let found = of_quarters(picture);
    found.map(|code| found.iter().filter(|other| **other > code).count())
}

#[test]
fn an_avif_picture_is_turned_and_mirrored_as_its_file_says() {
    let folder = Folder::new();
    let size = [64, 32];
    let picture = coded("libaom-av1", (Pixel::YUV420P, size), quarters(size));
    for (turn, mirror, wanted, order) in [
        (None, None, [64, 32], [0, 1, 2, 3]),
        // A quarter anticlockwise: what was at the right is above.
        (Some(1), None, [32, 64], [1, 3, 0, 2]),
        (Some(2), None, [64, 32], [3, 2, 1, 0]),
        (Some(3), None, [32, 64], [2, 0, 3, 1]),
        (None, Some(1), [64, 32], [1, 0, 3, 2]),
        (None, Some(0), [64, 32], [2, 3, 0, 1]),
        (Some(1), Some(1), [32, 64], [3, 1, 2, 0]),
    ] {
        let mut properties = vec![ispe(size)];
        properties.extend(turn.map(|it| boxed(b"irot", &[it])));
        properties.extend(mirror.map(|it| boxed(b"imir", &[it])));
        let numbers: Vec<u8> = (1..=properties.len() as u8).collect();
        let item = (b"av01", picture.clone(), &numbers[..]);
        let file = folder.holding("a.avif", &heif(b"avif", &[item], &properties, &[0; 4]));
        let view = format!("{}x{}", wanted[0], wanted[1]);
        let (told, shown, _) = seen(&folder, &file, &view);
        assert_eq!(
            [&told["width"], &told["height"]],
            [wanted[0], wanted[1]],
            "{told}"
        );
        assert_eq!(ranks(&shown), order, "{turn:?} {mirror:?}");
    }
}

#[test]
fn an_avif_picture_of_tiles_is_whole() {
    let folder = Folder::new();
    let tile = coded("libaom-av1", (Pixel::YUV420P, [64, 64]), |p, x, _| {
        if p > 0 {
            128
        } else {
            [60, 200][usize::from(x >= 32)]
        }
    });
    let grid = vec![0, 0, 0, 1, 0, 96, 0, 64];
    let items = [
        (b"grid", grid, &[1][..]),
        (b"av01", tile.clone(), &[2][..]),
        (b"av01", tile, &[2][..]),
    ];
    let references = [vec![0; 4], boxed(b"dimg", &[0, 1, 0, 2, 0, 2, 0, 3])].concat();
    let properties = [ispe([96, 64]), ispe([64, 64])];
    let file = heif(b"avif", &items, &properties, &references);
    let (_, shown, _) = seen(&folder, &folder.holding("grid.avif", &file), "96x64");
    let across = [8, 48, 80].map(|x| shown.at([x, 32])[1]);
    assert!(
        across[0] < 90 && across[1] > 170 && across[2] < 90,
        "{across:?}"
    );
}

#[test]
fn an_avif_picture_with_alpha_is_seen_through_and_heic_is_named() {
    let folder = Folder::new();
    let size = [64, 32];
    let picture = coded("libaom-av1", (Pixel::YUV420P, size), quarters(size));
    // The right half is seen through.
    for is_clear in [true, false] {
        let alpha = coded("libaom-av1", (Pixel::YUV420P, size), |p, x, _| {
            let strength = if is_clear && x >= 32 { 0 } else { 255 };
            if p > 0 { 128 } else { strength }
        });
        let aux = boxed(
            b"auxC",
            b"\0\0\0\0urn:mpeg:mpegB:cicp:systems:auxiliary:alpha\0",
        );
        let items = [
            (b"av01", picture.clone(), &[1][..]),
            (b"av01", alpha, &[1, 2][..]),
        ];
        let references = [vec![0; 4], boxed(b"auxl", &[0, 2, 0, 1, 0, 1])].concat();
        let file = heif(b"avif", &items, &[ispe(size), aux], &references);
        let file = folder.holding("alpha.avif", &file);
        let (_, shown, said) = seen(&folder, &file, "64x32");
        let [a, b, ..] = of_quarters(&shown);
        assert!(
            a > 200 && if is_clear { b < 12 } else { b > 140 },
            "{a} {b}"
        );
        assert_eq!(said.contains("over black"), is_clear, "{said}");
    }
    let heic = heif(
        b"heic",
        &[(b"hvc1", vec![1; 9], &[1])],
        &[ispe(size)],
        &[0; 4],
    );
    let heic = folder.holding("IMG_1.HEIC", &heic);
    let out = folder.name("x.foveal");
    refused(
        1,
        &["prepare", "video", &heic, "--out", &out],
        &["HEIC", "heif-convert"],
    );
}

fn chunk(name: &[u8; 4], contents: &[u8]) -> Vec<u8> {
    let mut bytes = [&name[..], &(contents.len() as u32).to_le_bytes(), contents].concat();
    bytes.resize(bytes.len() + contents.len() % 2, 0);
    bytes
}

#[test]
fn animations_are_played_with_the_times_of_all_their_pictures() {
    let folder = Folder::new();
    let delays = [100u32, 300, 1500];
    let mut webp = b"WEBP".to_vec();
    webp.extend(chunk(b"VP8X", &[2, 0, 0, 0, 31, 0, 0, 31, 0, 0]));
    webp.extend(chunk(b"ANIM", &[0; 6]));
    let mut gif = b"GIF89a\x20\0\x20\0\x80\0\0\0\0\0\xff\xff\xff".to_vec();
    let mut png_bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut png_bytes, 32, 32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_animated(3, 0).unwrap();
    let mut apng = encoder.write_header().unwrap();
    for (number, delay) in delays.into_iter().enumerate() {
        let white = number != 1;
        let pixels = [if white { 255 } else { 0 }; 32 * 32 * 3];
        let mut still = Vec::new();
        WebPEncoder::new(&mut still)
            .encode(&pixels, 32, 32, ColorType::Rgb8)
            .unwrap();
        let [a, b, c, _] = delay.to_le_bytes();
        let mut frame = vec![0, 0, 0, 0, 0, 0, 31, 0, 0, 31, 0, 0, a, b, c, 2];
        frame.extend(&still[12..]);
        webp.extend(chunk(b"ANMF", &frame));
        apng.set_frame_delay(delay as u16, 1000).unwrap();
        apng.write_image_data(&pixels).unwrap();
        let [low, high] = (delay as u16 / 10).to_le_bytes();
        gif.extend([0x21, 0xf9, 4, 4, low, high, 0, 0]);
        gif.extend(b"\x2c\0\0\0\0\x20\0\x20\0\0\x02");
        // Codes of three bits: a clear, then each pixel by itself.
        let mut bits = Vec::new();
        for _ in 0..32 * 32 {
            bits.extend([[0, 0, 1], [u8::from(white), 0, 0]].concat());
        }
        bits.extend([1, 0, 1]);
        let packed = bits.chunks(8).map(|eight| {
            eight
                .iter()
                .enumerate()
                .fold(0, |byte, (at, bit)| byte | bit << at)
        });
        for block in packed.collect::<Vec<u8>>().chunks(255) {
            gif.push(block.len() as u8);
            gif.extend(block);
        }
        gif.push(0);
    }
    apng.finish().unwrap();
    gif.push(0x3b);
    let files = [
        folder.holding("a.webp", &chunk(b"RIFF", &webp)),
        folder.holding("a.gif", &gif),
        folder.holding("a.png", &png_bytes),
    ];
    for file in files {
        let (told, shown, _) = seen(&folder, &file, "32x32");
        assert_eq!(
            (&told["content"], &told["frames"]),
            (&"video".into(), &3.into()),
            "{told}"
        );
        let seconds = told["seconds"].as_f64().unwrap();
        assert!((seconds - 1.9).abs() < 0.02, "{file}: {told}");
        assert!(shown.at([9, 9])[1] > 240);
        let out = folder.name("seen");
        let second = frame_picture(&out, 1);
        assert!(second.at([9, 9])[1] < 10, "{file}");
        done(&["verify", &folder.name("seen.foveal")]);
    }
}

#[test]
fn an_animated_webp_vanishes_where_it_says_and_is_shown_as_far_as_it_is_whole() {
    let folder = Folder::new();
    let mut webp = b"WEBP".to_vec();
    webp.extend(chunk(b"VP8X", &[0x12, 0, 0, 0, 31, 0, 0, 31, 0, 0]));
    webp.extend(chunk(b"ANIM", &[0; 6]));
    // A white square that goes from corner to corner.
    for [x, y] in [[0, 0], [8, 0], [0, 8]] {
        let mut still = Vec::new();
        let square = WebPEncoder::new(&mut still);
        square
            .encode(&[255; 16 * 16 * 4], 16, 16, ColorType::Rgba8)
            .unwrap();
        let mut frame = vec![x, 0, 0, y, 0, 0, 15, 0, 0, 15, 0, 0, 100, 0, 0, 1];
        frame.extend(&still[12..]);
        webp.extend(chunk(b"ANMF", &frame));
    }
    let whole = chunk(b"RIFF", &webp);
    let (told, _, _) = seen(&folder, &folder.holding("a.webp", &whole), "32x32");
    assert_eq!(told["repairs"], serde_json::json!({}), "{told}");
    for (frame, lit) in [0, 1, 2].into_iter().enumerate() {
        let shown = of_quarters(&frame_picture(&folder.name("seen"), frame));
        for (quarter, luma) in shown.into_iter().enumerate() {
            assert_eq!(luma > 128, quarter == lit, "{frame}: {shown:?}");
        }
    }
    let cut = folder.holding("cut.webp", &whole[..whole.len() - 20]);
    let (told, _, _) = seen(&folder, &cut, "32x32");
    let found = (&told["frames"], &told["repairs"]["cut_short"]);
    assert_eq!(found, (&2.into(), &1.into()), "{told}");
    let out = folder.name("never.foveal");
    let strict = ["prepare", "video", &cut, "--strict", "--out", &out];
    refused(1, &strict, &["cut short: 1"]);
}

#[test]
fn alpha_that_is_opaque_everywhere_is_no_transparency() {
    let folder = Folder::new();
    let pixels: Vec<u8> = (0..64 * 64u32)
        .flat_map(|at| [40 + at as u8 % 64 * 2; 3].into_iter().chain([255]))
        .collect();
    let mut webp = Vec::new();
    WebPEncoder::new(&mut webp)
        .encode(&pixels, 64, 64, ColorType::Rgba8)
        .unwrap();
    let webp = folder.holding("a.webp", &webp);
    let png = folder.name("a.png");
    let mut encoder = png::Encoder::new(std::fs::File::create(&png).unwrap(), 64, 64);
    encoder.set_color(png::ColorType::Rgba);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&pixels)
        .unwrap();
    for file in [&webp, &png] {
        let (told, _, said) = seen(&folder, file, "64x64");
        assert!(
            !said.contains("transparent") && !said.contains("black"),
            "{said}"
        );
        assert!(
            !told["remarks"].to_string().contains("transparent"),
            "{told}"
        );
    }
    let score = json(&["score", &webp, &png, "--display", "standard_fhd"]);
    assert!(score["jod"].as_f64().unwrap() > 9.9, "{score}");
    let clear: Vec<u8> = pixels
        .chunks(4)
        .flat_map(|it| [it[0], it[1], it[2], 200])
        .collect();
    let mut webp = Vec::new();
    WebPEncoder::new(&mut webp)
        .encode(&clear, 64, 64, ColorType::Rgba8)
        .unwrap();
    let clear = folder.holding("clear.webp", &webp);
    let ran = foveal(&["score", &clear, &png, "--display", "standard_fhd"]);
    assert!(
        ran.code == Some(1) && ran.stderr.contains("transparency"),
        "{ran:?}"
    );
    let (_, _, said) = seen(&folder, &clear, "64x64");
    assert!(said.contains("over black"), "{said}");
}

#[test]
fn flat_content_keeps_its_shape_in_a_view_of_another() {
    let folder = Folder::new();
    let png = folder.name("a.png");
    let mut encoder = png::Encoder::new(std::fs::File::create(&png).unwrap(), 128, 64);
    encoder.set_color(png::ColorType::Grayscale);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&[200; 128 * 64])
        .unwrap();
    for (view, lit) in [
        ("96x96", [96, 48]),
        ("240x48", [96, 48]),
        ("64x32", [64, 32]),
    ] {
        let (_, shown, _) = seen(&folder, &png, view);
        let [w, h] = shown.size;
        let across = (0..w).filter(|x| shown.at([*x, h / 2])[1] > 100).count() as u32;
        let down = (0..h).filter(|y| shown.at([w / 2, *y])[1] > 100).count() as u32;
        assert!(
            across.abs_diff(lit[0]) < 2 && down.abs_diff(lit[1]) < 2,
            "{view} {across} {down}"
        );
        assert!(view == "64x32" || shown.at([0, 0]) == [0; 3], "{view}");
    }
}

/// An uncompressed OpenEXR picture of 32 x 32 samples a channel, by channel, column and row.
fn exr(channels: &[&str], sample: impl Fn(&str, u32, u32) -> f32) -> Vec<u8> {
    let attribute = |name: &str, kind: &str, inside: &[u8]| {
        let length = (inside.len() as u32).to_le_bytes();
        let names = [name, "\0", kind, "\0"].concat();
        [names.as_bytes(), &length, inside].concat()
    };
    let channel = |name: &&str| {
        let numbers = [2_u32, 0, 1, 1].map(u32::to_le_bytes);
        [name.as_bytes(), b"\0", numbers.as_flattened()].concat()
    };
    let list: Vec<u8> = channels.iter().flat_map(channel).chain([0]).collect();
    let window = [0_u32, 0, 31, 31].map(u32::to_le_bytes);
    let one = 1.0_f32.to_le_bytes();
    let mut bytes = b"\x76\x2f\x31\x01\x02\0\0\0".to_vec();
    for (name, kind, inside) in [
        ("channels", "chlist", &list[..]),
        ("compression", "compression", &[0]),
        ("dataWindow", "box2i", window.as_flattened()),
        ("displayWindow", "box2i", window.as_flattened()),
        ("lineOrder", "lineOrder", &[0]),
        ("pixelAspectRatio", "float", &one),
        ("screenWindowCenter", "v2f", &[0; 8]),
        ("screenWindowWidth", "float", &one),
    ] {
        bytes.extend(attribute(name, kind, inside));
    }
    bytes.push(0);
    let row = 32 * 4 * channels.len();
    let first = bytes.len() + 32 * 8;
    bytes.extend((0..32).flat_map(|y| ((first + y * (8 + row)) as u64).to_le_bytes()));
    for y in 0..32 {
        bytes.extend([y, row as u32].map(u32::to_le_bytes).as_flattened());
        for name in channels {
            bytes.extend((0..32).flat_map(|x| sample(name, x, y).to_le_bytes()));
        }
    }
    bytes
}

/// Red, green and blue of four quarters of 32 x 32, as light.
fn light(x: u32, y: u32) -> [f32; 3] {
    let colours = [
        [0.9, 0.1, 0.1],
        [0.1, 0.9, 0.1],
        [0.1, 0.1, 0.9],
        [0.9, 0.9, 0.1],
    ];
    colours[usize::from(x >= 16) + 2 * usize::from(y >= 16)]
}

#[test]
fn an_exr_shows_the_layer_with_the_whole_picture() {
    let folder = Folder::new();
    let of = |name: &str, x: u32, y: u32| match name.rsplit('.').next() {
        Some("R" | "r") => light(x, y)[0],
        Some("G" | "g") => light(x, y)[1],
        Some("B" | "b") => light(x, y)[2],
        _ => 1.0,
    };
    let blender = [
        "AO.B",
        "AO.G",
        "AO.R",
        "Combined.A",
        "Combined.B",
        "Combined.G",
        "Combined.R",
    ]
    .map(|it| format!("ViewLayer.{it}"));
    let blender = blender.each_ref().map(String::as_str);
    for (channels, words) in [
        (&["B", "G", "R"][..], ""),
        (&["b", "g", "r"], ""),
        (
            &["diffuse.B", "diffuse.G", "diffuse.R"],
            "its layer \\\"diffuse\\\" is shown",
        ),
        (
            &blender,
            "ViewLayer.Combined\\\" is shown, without 1 other layer",
        ),
    ] {
        let file = folder.holding("a.exr", &exr(channels, of));
        let (told, shown) = odd_stills::seen(&folder, &file, "32x32");
        odd_stills::assert_quarters(&shown, channels[0]);
        assert!(remarks(&told).contains(words), "{told}");
        assert_eq!(
            remarks(&told).contains("layer"),
            !words.is_empty(),
            "{told}"
        );
    }
}

#[test]
fn an_exr_is_in_colour_or_names_the_rows_it_lacks() {
    let folder = Folder::new();
    let of = |name: &str, x: u32, y: u32| light(x, y)["RGB".find(name).unwrap_or(0)];
    let chroma = |name: &str, x: u32, y: u32| {
        let [red, green, blue] = light(x, y);
        let luma = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
        match name {
            "RY" => (red - luma) / luma,
            "BY" => (blue - luma) / luma,
            _ => luma,
        }
    };
    let file = folder.holding("chroma.exr", &exr(&["BY", "RY", "Y"], chroma));
    odd_stills::assert_quarters(&odd_stills::seen(&folder, &file, "32x32").1, "chroma");
    let whole = exr(&["B", "G", "R"], of);
    let row = 3 * 32 * 4 + 8;
    let cut = &whole[..whole.len() - 10 * row - 7];
    odd_stills::refuses(&folder, "cut.exr", cut, &["rows 21 to 31 of its 32 rows"]);
    let mut damaged = whole.clone();
    let at = whole.len() - 20 * row;
    damaged[at..at + 2 * row].fill(0);
    odd_stills::refuses(
        &folder,
        "damaged.exr",
        &damaged,
        &["missing", "of its 32 rows"],
    );
    let depth = exr(&["Z"], of);
    odd_stills::refuses(
        &folder,
        "depth.exr",
        &depth,
        &["without a picture", "channels are Z"],
    );
}

#[test]
fn a_qoi_is_whole_or_refused_by_its_rows() {
    let folder = Folder::new();
    let mut bytes = b"qoif\0\0\0\x20\0\0\0\x20\x03\0".to_vec();
    for pixel in odd_stills::quarters(32).chunks(3) {
        bytes.push(0xfe);
        bytes.extend(pixel);
    }
    bytes.extend([0, 0, 0, 0, 0, 0, 0, 1]);
    odd_stills::assert_quarters(
        &odd_stills::seen(&folder, &folder.holding("a.qoi", &bytes), "32x32").1,
        "whole",
    );
    let cut = &bytes[..bytes.len() * 6 / 10];
    odd_stills::refuses(&folder, "cut.qoi", cut, &["rows 19 to 31 of its 32 rows"]);
}
