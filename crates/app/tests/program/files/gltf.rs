//! Is glTF read as other programs write it, with textures in other formats?

use super::row::{Row, png_of};
use crate::support::{Folder, json, refused};
use base64::Engine;
use base64::engine::general_purpose::{STANDARD, URL_SAFE_NO_PAD};

const RED: [u8; 3] = [220, 20, 20];
/// Triangles of the grid.
const ALL: u64 = 128;

/// Places, places on a texture, and indices of a grid of 9 x 9.
fn binary() -> Vec<u8> {
    let at = |k: u32| (k as f32) / 8.0;
    let all = || (0..9).flat_map(|j| (0..9).map(move |i| [at(i), at(j)]));
    let mut bytes: Vec<u8> = Vec::new();
    bytes.extend(
        all()
            .flat_map(|[x, y]| [x, y, 0.0])
            .flat_map(f32::to_le_bytes),
    );
    bytes.extend(
        all()
            .flat_map(|[x, y]| [x, 1.0 - y])
            .flat_map(f32::to_le_bytes),
    );
    for j in 0..8u16 {
        for i in 0..8 {
            let a = j * 9 + i;
            let corners = [a, a + 1, a + 10, a, a + 10, a + 9];
            bytes.extend(corners.iter().flat_map(|it| it.to_le_bytes()));
        }
    }
    bytes
}

/// The grid as glTF whose buffer has this URI and whose picture is said so.
fn document(uri: &str, image: &str) -> String {
    let all = binary().len();
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
"nodes":[{{"mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"indices":2,
"material":0}}]}}],
"materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
"textures":[{{"source":0}}],"images":[{image}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":81,"type":"VEC3"}},
{{"bufferView":1,"componentType":5126,"count":81,"type":"VEC2"}},
{{"bufferView":2,"componentType":5123,"count":384,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":972}},
{{"buffer":0,"byteOffset":972,"byteLength":648}},
{{"buffer":0,"byteOffset":1620,"byteLength":768}}],
"buffers":[{{"byteLength":{all}{}}}]}}"#,
        match uri {
            "" => String::new(),
            uri => format!(r#","uri":"{uri}""#),
        }
    )
}

fn inline() -> String {
    format!(
        "data:application/octet-stream;base64,{}",
        STANDARD.encode(binary())
    )
}

/// A .glb, whose JSON is filled up with some byte.
fn glb(json: &str, fill: u8) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4) + 4, fill);
    let binary = binary();
    let mut file = b"glTF".to_vec();
    let all = 12 + 8 + json.len() + 8 + binary.len();
    file.extend([2, all as u32].iter().flat_map(|it| it.to_le_bytes()));
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// Files that break rules in the buffer that they name.
fn with_odd_buffers(plain: &str) -> Vec<(&'static str, Vec<u8>)> {
    let inline = inline();
    let lines: Vec<&str> = (0..inline.len().div_ceil(76))
        .map(|at| &inline[76 * at..inline.len().min(76 * at + 76)])
        .collect();
    let of = |uri: &str| document(uri, "").into_bytes();
    let after = |from: &str, to: &str| plain.replacen(from, to, 1).into_bytes();
    let for_addresses = format!("data:;base64,{}", URL_SAFE_NO_PAD.encode(binary()));
    vec![
        ("escaped lines", of(&lines.join("\\r\\n"))),
        ("raw lines", of(&lines.join("\n"))),
        ("blanks", of(&lines.join(" "))),
        (
            "capitals",
            after("data:application/octet-stream;base64", "DATA:;BASE64"),
        ),
        ("for addresses", of(&for_addresses)),
        ("named with %20", of("a%20b.bin")),
        ("named with a blank", of("c d.bin")),
        ("with %20 for a blank", of("c%20d.bin")),
        ("asked for", of("file:///C:/x/a%20b.bin?v=2")),
        ("by its path", of("C:\\\\models\\\\a%20b.bin")),
        (
            "stride",
            after("\"byteLength\":972", "\"byteLength\":972,\"byteStride\":0"),
        ),
        (
            "short",
            after(
                "\"buffers\":[{\"byteLength\":2388",
                "\"buffers\":[{\"byteLength\":2400",
            ),
        ),
        ("zeros", glb(&document("", ""), 0)),
        ("glb", glb(&document("", ""), b' ')),
    ]
}

/// And in what their JSON says.
fn with_odd_json(plain: &str) -> Vec<(&'static str, Vec<u8>)> {
    let after = |from: &str, to: &str| plain.replacen(from, to, 1).into_bytes();
    let node = |more: &str| after("\"mesh\":0", &format!("\"mesh\":0,{more}"));
    let numbers = plain.replace(":0,", ":0.0,").replace("5126", "5.126e3");
    vec![
        ("plain", plain.into()),
        ("count", plain.replace(":81,", ":81.0,").into()),
        ("numbers", numbers.into()),
        ("nulls", node("\"children\":null,\"skin\":-1")),
        ("comma", after("{\"mesh\":0}", "{\"mesh\":0,},")),
        ("comment", format!("// by hand\n{plain}").into()),
        ("not a number", node("\"extras\":{\"x\":NaN}")),
        ("mark", format!("\u{feff}{plain}").into()),
        ("version", after("\"2.0\"", "2.0")),
        ("metadata", required(plain, "KHR_xmp_json_ld")),
        ("looks", required(plain, "KHR_materials_clearcoat")),
        ("unheard of looks", required(plain, "EXT_materials_fur")),
    ]
}

#[test]
fn a_file_that_breaks_rules_without_harm_is_read() {
    let folder = Folder::new();
    let plain = document(&inline(), "");
    folder.holding("a%20b.bin", &binary());
    folder.holding("c d.bin", &binary());
    let files = [with_odd_buffers(&plain), with_odd_json(&plain)].concat();
    for (what, bytes) in &files {
        let name = folder.holding(&format!("{what}.gltf"), bytes);
        let told = json(&["prepare", "scene", &name, "--dry-run"]);
        assert_eq!(told["triangles"], ALL, "{what}: {told}");
    }
    for (what, words) in [
        ("VENDOR_shapes", "VENDOR_shapes"),
        ("KHR_gaussian_splatting", "splat"),
    ] {
        let name = folder.holding("needs.gltf", &required(&plain, what));
        refused(
            1,
            &["prepare", "scene", &name, "--dry-run"],
            &[words, "export it without"],
        );
    }
}

fn required(plain: &str, extension: &str) -> Vec<u8> {
    let said = format!(
        "\"extensionsUsed\":[{extension:?}],\"extensionsRequired\":[{extension:?}],\"scene\":0"
    );
    plain.replacen("\"scene\":0", &said, 1).into()
}

fn bmp() -> Vec<u8> {
    let mut file = b"BM".to_vec();
    let half = |it: u16| it.to_le_bytes();
    let word = |it: u32| it.to_le_bytes();
    file.extend(
        [
            word(54 + 192),
            word(0),
            word(54),
            word(40),
            word(8),
            word(8),
        ]
        .concat(),
    );
    file.extend([half(1), half(24)].concat());
    file.extend([0; 24]);
    file.extend([20, 20, 220].repeat(64));
    file
}

fn tga() -> Vec<u8> {
    let mut file = vec![0; 18];
    (file[2], file[12], file[14], file[16]) = (10, 8, 8, 24);
    // A run of 64 texels.
    file.extend([191, 20, 20, 220]);
    file
}

/// A WebP of 8 x 8 without loss.
fn webp() -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = image_webp::WebPEncoder::new(&mut file);
    encoder
        .encode(&RED.repeat(64), 8, 8, image_webp::ColorType::Rgb8)
        .unwrap();
    file
}

/// Chunks of a WebP file as a whole.
fn riff(chunks: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut body = b"WEBP".to_vec();
    for (name, says) in chunks {
        body.extend(*name);
        body.extend((says.len() as u32).to_le_bytes());
        body.extend(says);
        body.resize(body.len().next_multiple_of(2), 0);
    }
    let mut file = b"RIFF".to_vec();
    file.extend((body.len() as u32).to_le_bytes());
    file.extend(body);
    file
}

/// One that moves: red, then nothing that is looked at.
fn moving() -> Vec<u8> {
    let still = webp();
    let mut frame = [0, 0, 0, 0, 0, 0, 7, 0, 0, 7, 0, 0, 100, 0, 0, 0].to_vec();
    frame.extend(&still[12..]);
    riff(&[
        (b"VP8X", vec![2, 0, 0, 0, 7, 0, 0, 7, 0, 0]),
        (b"ANIM", vec![0; 6]),
        (b"ANMF", frame.clone()),
        (b"ANMF", frame),
    ])
}

#[test]
fn textures_in_tga_bmp_and_webp_are_shown() {
    let folder = Folder::new();
    let files: Vec<(&str, Vec<u8>)> = vec![
        ("red.png", png_of(RED, 8)),
        ("red.bmp", bmp()),
        ("red.tga", tga()),
        ("red.webp", webp()),
        ("moving.webp", moving()),
        // What it is called does not count.
        ("webp.png", webp()),
    ];
    let mut names = Vec::new();
    for (name, bytes) in &files {
        folder.holding(name, bytes);
        let model = format!("{name}.gltf");
        let text = document(&inline(), &format!(r#"{{"uri":"{name}"}}"#));
        let text = match *name {
            "red.webp" => text.replace(
                r#""textures":[{"source":0}]"#,
                r#""textures":[{"extensions":{"EXT_texture_webp":{"source":0}}}]"#,
            ),
            _ => text,
        };
        folder.holding(&model, text.as_bytes());
        names.push(model);
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let row = Row::of(&folder, &names);
    row.assert_alike(&names);
    let [r, g, b] = row.colours[0];
    assert!(r > 150 && g < 60 && b < 60, "{:?}", row.colours);
    assert_eq!(row.told["texels"], 6 * 64);
    row.assert_remarks(&["moving.webp", "the first of its pictures"]);
    assert_eq!(row.mended("animated_images"), 1);
}

#[test]
fn a_texture_that_is_cut_short_or_claims_too_much_leaves_the_colour_and_is_named() {
    let folder = Folder::new();
    let cut = |bytes: Vec<u8>| bytes[..bytes.len() - 5].to_vec();
    let mut wide = riff(&[(b"VP8L", vec![0x2f, 0xff, 0xff, 0xff, 0x0f, 0, 0, 0])]);
    let huge = riff(&[(b"VP8X", vec![0, 0, 0, 0, 255, 255, 255, 255, 255, 255])]);
    wide.extend([0; 20]);
    let mut tga_claims = tga();
    tga_claims[12..16].copy_from_slice(&[255, 63, 255, 63]);
    let files: Vec<(&str, Vec<u8>)> = vec![
        ("cut.bmp", cut(bmp())),
        ("cut.tga", tga()[..20].to_vec()),
        ("cut.webp", cut(webp())),
        ("wide.webp", wide),
        ("huge.webp", huge),
        ("claims.tga", tga_claims),
        ("a.gif", b"GIF89a\x01\0\x01\0".to_vec()),
        (
            "data.png",
            b"version https://git-lfs.github.com/spec/v1\n".to_vec(),
        ),
    ];
    let mut names = Vec::new();
    for (name, bytes) in &files {
        folder.holding(name, bytes);
        let model = format!("{name}.gltf");
        let text = document(&inline(), &format!(r#"{{"uri":"{name}"}}"#));
        folder.holding(&model, text.as_bytes());
        names.push(model);
    }
    folder.holding(
        "inline.gltf",
        document(&inline(), r#"{"uri":"data:image/png;base64,@@"}"#).as_bytes(),
    );
    names.push("inline.gltf".to_owned());
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let row = Row::of(&folder, &names);
    row.assert_alike(&names);
    assert!(row.colours[0].iter().all(|it| *it > 100), "white");
    assert_eq!(
        row.mended("missing_images"),
        names.len() as u64,
        "{}",
        row.told
    );
    for (name, _) in &files {
        row.assert_remarks(&[name]);
    }
    row.assert_remarks(&["a.gif", "is a GIF, which is not read"]);
    row.assert_remarks(&["data.png", "Git LFS"]);
    row.assert_remarks(&["base64"]);
}

#[test]
fn hidden_materials_and_nodes_placed_twice_are_told_and_mends_are_counted_once() {
    let folder = Folder::new();
    folder.holding("a.bin", &binary());
    folder.holding("red.png", &png_of(RED, 8));
    let plain = document("a.bin", r#"{"uri":"red.png"}"#);
    let hidden = r#"},{"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[0,0,1,0.0]}}],
"textures""#;
    let front = r#""nodes":[{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],
"translation":[0.0,0.0,7.0]},{"mesh":1,"translation":[0,0,0.5]}],"#;
    let second =
        r#""meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":2,"material":1}]},"#;
    let changed = plain
        .replace("}],\n\"textures\"", hidden)
        .replace(
            "\"scenes\":[{\"nodes\":[0]}]",
            "\"scenes\":[{\"nodes\":[0,1]}]",
        )
        .replace("\"nodes\":[{\"mesh\":0}],", front)
        .replace("\"meshes\":[", second)
        .replace("\"mesh\":1", "\"mesh\":2")
        .replace("\"mesh\":0", "\"mesh\":1")
        .replace("\"mesh\":2", "\"mesh\":0");
    folder.holding("plain.gltf", plain.as_bytes());
    // A comma too many, besides numbers that are whole all the same.
    folder.holding("a.gltf", changed.replacen("7.0]", "7.0,]", 1).as_bytes());
    let row = Row::of(&folder, &["plain.gltf", "a.gltf"]);
    row.assert_alike(&["plain.gltf", "a.gltf"]);
    for (name, times) in [
        ("triangles_hidden", ALL),
        ("nodes_placed_twice", 1),
        ("json_mended", 1),
    ] {
        assert_eq!(row.mended(name), times, "{name}: {}", row.told);
    }
    row.assert_remarks(&["breaks its rules in 1 place"]);
    row.assert_remarks(&["the matrix counts", "node 0"]);
}
