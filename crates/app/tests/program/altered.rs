//! Is what a player refuses refused by `verify` too, and does one bad unit cost that unit alone?
//!
//! Packs are altered and sealed again, so that no checksum shows it.

use crate::support::{Folder, foveal, json_of};
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::scene::description::{KIND, SceneDescription, SceneSource, Shape};
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::content::scene::pack::{begin_scene, chunk_name, finish_scene};
use foveal_core::content::scene::part_ref::PartRef;
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::moment::Moment;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_media::pack::scene_file::SceneFile;
use foveal_play::{Player, PlayerOptions};
use foveal_render::DrawDevice;
use foveal_scene::build::{BuildOptions, build};
use foveal_scene::read::{ReadOptions, read};
use serde_json::json;
use std::path::Path;
use std::sync::Arc;

/// A pack in parts.
#[derive(Clone)]
struct Parts {
    about: SceneDescription,
    units: Vec<(UnitRow, Vec<u8>)>,
}

impl Parts {
    /// A textured square of many triangles that stands twice, a second mesh, and a cloud.
    fn new(folder: &Folder) -> Self {
        let png = folder.holding("t.png", &picture());
        assert!(Path::new(&png).exists());
        folder.holding("t.mtl", b"newmtl t\nmap_Kd t.png\n");
        let sheet = folder.holding("sheet.obj", sheet().as_bytes());
        let plain = folder.holding("plain.obj", plain().as_bytes());
        let cloud = folder.holding("cloud.ply", cloud().as_bytes());
        let inputs = [&sheet, &plain, &cloud].map(|it| Path::new(it.as_str()));
        let source = read(&inputs, &ReadOptions::default()).unwrap();
        let built = build(&source, &BuildOptions::default(), &|_, _| ()).unwrap();
        let mut units = vec![0; usize::from(built.levels)];
        for unit in &built.units {
            units[usize::from(unit.level)] += 1;
        }
        let about = SceneDescription {
            kind: KIND.to_owned(),
            needs: vec![KIND.to_owned()],
            generator: String::new(),
            source: SceneSource::default(),
            objects: built.objects,
            textures: built.textures,
            parts: Vec::new(),
            joined: Default::default(),
            units,
            page: 64,
            look: Default::default(),
            identity: Default::default(),
            remarks: Vec::new(),
            repairs: Default::default(),
            tables: Vec::new(),
        };
        let units = built.units.into_iter().map(|it| (it.row, it.payload));
        Self {
            about,
            units: units.collect(),
        }
    }

    /// The pack, if parts like these can be written at all. It is not read back: what it is to be
    /// refused for is in it.
    fn write(&self, path: &str) -> bool {
        let mut builder = begin_scene(&self.about);
        let mut file = vec![0; builder.data_offset() as usize];
        for (unit, (_, payload)) in (0..).map(UnitId).zip(&self.units) {
            builder.push(chunk_name(unit), payload);
            file.extend_from_slice(payload);
        }
        let rows: Vec<UnitRow> = self.units.iter().map(|(row, _)| row.clone()).collect();
        let Ok(parts) = finish_scene(builder, self.about.clone(), &rows) else {
            return false;
        };
        file[..parts.head.len()].copy_from_slice(&parts.head);
        file.extend_from_slice(&parts.tail);
        std::fs::write(path, file).is_ok()
    }
}

fn picture() -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 600, 300);
    encoder.set_color(png::ColorType::Rgb);
    let texels = (0..600 * 300_u32).flat_map(|it| [it as u8, (it >> 5) as u8, (it >> 9) as u8]);
    let mut writer = encoder.write_header().unwrap();
    writer
        .write_image_data(&texels.collect::<Vec<u8>>())
        .unwrap();
    drop(writer);
    file
}

/// A wavy sheet of 2 x 24 x 24 triangles.
fn sheet() -> String {
    let mut text = "mtllib t.mtl\nusemtl t\n".to_owned();
    for (row, column) in (0..25).flat_map(|row| (0..25).map(move |column| (row, column))) {
        let height = f64::from((row * 7 + column * 5) % 11) / 50.0;
        let [x, y] = [column, row].map(|it| f64::from(it) / 24.0);
        text += &format!("v {x} {y} {height}\nvt {x} {y}\n");
    }
    for (row, column) in (0..24).flat_map(|row| (0..24).map(move |column| (row, column))) {
        let [a, b] = [row * 25 + column + 1, row * 25 + column + 26];
        let [c, d] = [a + 1, b + 1];
        text += &format!("f {a}/{a} {c}/{c} {b}/{b}\nf {c}/{c} {d}/{d} {b}/{b}\n");
    }
    text
}

fn plain() -> String {
    "v 2 0 0\nv 3 0 0\nv 2 1 0\nf 1 2 3\n".to_owned()
}

fn cloud() -> String {
    let mut text =
        "ply\nformat ascii 1.0\nelement vertex 3000\nproperty float x\nproperty float y\n\
                    property float z\nproperty uchar red\nproperty uchar green\n\
                    property uchar blue\nend_header\n"
            .to_owned();
    for k in 0..3000_u32 {
        let at = [k * 7919 % 1000, k * 104_729 % 1000, k * 31 % 17].map(|it| f64::from(it) / 1e3);
        text += &format!(
            "{} {} {} {} {} 9\n",
            at[0] - 2.0,
            at[1],
            at[2],
            k % 256,
            k / 12
        );
    }
    text
}

/// What two commands make of a pack.
#[derive(Debug)]
struct Made {
    /// Places that `verify` lists; `None` where it cannot be opened.
    damage: Option<u64>,
    /// Units that a player could not show; or why it ended.
    played: Result<u64, String>,
}

fn made_of(path: &str) -> Made {
    let opened = SceneFile::open(Path::new(path)).map(Arc::new);
    let Ok(file) = opened else {
        return Made {
            damage: None,
            played: Err("it cannot be opened".to_owned()),
        };
    };
    Made {
        damage: Some(file.verify(|_, _| ()).places()),
        played: played(&file).map_err(|error| error.to_string()),
    }
}

fn played(file: &Arc<SceneFile>) -> Result<u64, Box<foveal_play::PlayError>> {
    let options = PlayerOptions {
        gpu_bytes: 1 << 30,
        ..PlayerOptions::new(PolicyConfig::new(Policy::Full), &DrawDevice::Twin, |_| ())
    };
    let mut player = Player::of_scene(file, options)?;
    let view = EyeView {
        position: glam::DVec3::new(0.5, 0.5, 4.0),
        axes: Axes::FRONT,
        field: Field::symmetric([1.0; 2]),
        size: [48, 48],
        eye: Default::default(),
    };
    let moment = Moment::new(
        GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0)),
        vec![view],
    );
    for second in 0..2 {
        player.stand(Seconds(f64::from(second)), &moment)?;
        player.picture(&view, false)?;
    }
    Ok(player.damaged_units())
}

/// Numbers that repeat.
struct Dice(u64);

impl Dice {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % most.max(1)
    }
}

/// Alters one thing in the scene's description; returns what.
fn alter_description(about: &mut SceneDescription, dice: &mut Dice) -> String {
    const NUMBERS: [f64; 7] = [0.0, -1.0, 1e-300, 1e9, 1e15, -1e15, 0.5];
    let number = NUMBERS[dice.below(NUMBERS.len())];
    let at = dice.below(about.objects.len());
    let object = &mut about.objects[at];
    let what = dice.below(12);
    match what {
        0 => object.grid.step = number,
        1 => object.grid.origin[dice.below(3)] = number,
        2 => object.grid.bits = 10 + dice.below(7) as u8,
        3 => object.bounds.radius = number,
        4 => object.bounds.centre[dice.below(3)] = number,
        5 => object.placements[0][dice.below(12)] = number,
        6 => object.attributes.normals ^= true,
        7 => object.attributes.colours ^= true,
        8 => {
            if let Shape::Cloud(cloud) = &mut object.shape {
                match dice.below(4) {
                    0 => cloud.scale[dice.below(3)] = number,
                    1 => cloud.least[dice.below(3)] = number as i64 >> 11,
                    2 => cloud.colour_bits = 24 - cloud.colour_bits,
                    _ => cloud.attributes.intensities ^= true,
                }
            }
        }
        9 => {
            if let Some(texturing) = &mut object.texturing {
                texturing.step[dice.below(2)] = number;
                texturing.textures = vec![0; dice.below(3)];
            }
        }
        10 => {
            let side = [1, 255, 256, 257, 599, 600, 16_384][dice.below(7)];
            about.textures[0].size[dice.below(2)] = side;
        }
        _ => about.look.light[dice.below(3)] = number,
    }
    format!("description of object {at}, {what}, {number}")
}

/// Alters one thing; returns what.
fn alter(parts: &mut Parts, dice: &mut Dice) -> String {
    if dice.below(4) == 0 {
        return alter_description(&mut parts.about, dice);
    }
    let unit = dice.below(parts.units.len());
    let number = unit as u32;
    let (row, payload) = &mut parts.units[unit];
    let what = dice.below(12);
    match what {
        0..=4 => {
            let at = dice.below(payload.len());
            payload[at] ^= 1 << dice.below(8);
            return format!("byte {at} of unit {unit}, {:?}", row.kind);
        }
        5 => {
            row.samples = row
                .samples
                .wrapping_add(dice.below(5) as u32)
                .wrapping_sub(2);
        }
        6 => {
            row.vertices = row
                .vertices
                .wrapping_add(dice.below(5) as u32)
                .wrapping_sub(2);
        }
        7 => {
            let at = dice.below(row.needs.len());
            if let Some(need) = row.needs.get_mut(at) {
                *need = UnitId(dice.below(unit) as u32);
            }
        }
        8 => {
            let at = dice.below(row.replaces.len());
            if let Some(replaced) = row.replaces.get_mut(at) {
                *replaced = PartRef::from_byte(dice.below(256) as u8);
            }
        }
        9 => row.object = dice.below(4) as u16,
        10 => row.kind = [UnitKind::Mesh, UnitKind::Image, UnitKind::Points][dice.below(3)],
        _ => {
            let of_float = [0.0, -0.0, 1e30, f32::MIN_POSITIVE, f32::INFINITY];
            row.error = of_float[dice.below(of_float.len())];
            row.radius = of_float[dice.below(4)].abs();
            row.centre[dice.below(3)] = of_float[dice.below(4)];
        }
    }
    format!("row {number}, {what}")
}

#[test]
fn what_a_player_refuses_verify_refuses_and_one_bad_unit_costs_that_unit() {
    let folder = Folder::new();
    let whole = Parts::new(&folder);
    let path = folder.name("altered.foveal");
    assert!(whole.write(&path));
    let made = made_of(&path);
    assert_eq!((made.damage, made.played), (Some(0), Ok(0)));
    let turns = std::env::var("FOVEAL_ALTERED").map_or(300, |it| it.parse().unwrap());
    let mut dice = Dice(1);
    let mut survived = 0;
    for turn in 0..turns {
        let mut parts = whole.clone();
        let what = alter(&mut parts, &mut dice);
        if !parts.write(&path) {
            continue;
        }
        let made = made_of(&path);
        let told = format!("turn {turn}, {what}: {made:?}");
        match (&made.damage, &made.played) {
            (None, _) => {}
            (Some(0), played) => assert_eq!(played, &Ok(0), "{told}"),
            (Some(_), played) => {
                // Another mesh and a cloud stand there whatever happens to a unit.
                assert!(played.is_ok(), "{told}");
                survived += 1;
            }
        }
    }
    assert!(survived > turns / 6, "{survived} of {turns}");
}

#[test]
fn a_bad_root_costs_its_object_and_the_last_one_the_run() {
    let folder = Folder::new();
    let mut parts = Parts::new(&folder);
    let path = folder.name("roots.foveal");
    let roots: Vec<usize> = (0..parts.units.len())
        .filter(|it| parts.units[*it].0.needs.is_empty())
        .filter(|it| parts.units[*it].0.kind != UnitKind::Image)
        .collect();
    assert_eq!(roots.len(), 3);
    let out = folder.name("out");
    for (bad, root) in (1..).zip(&roots) {
        parts.units[*root].1[0] ^= 0xf0;
        assert!(parts.write(&path));
        let verified = foveal(&["verify", &path, "--json"]);
        assert_eq!(verified.code, Some(1), "{verified:?}");
        assert!(json_of(&verified)["damaged_places"].as_u64() >= Some(bad));
        let play = [
            "simulate",
            &path,
            "--out",
            &out,
            "--renderer",
            "cpu",
            "--frames",
            "1",
            "--policy",
            "full",
            "--view",
            "64x64",
            "--json",
        ];
        let ran = foveal(&play);
        if bad < 3 {
            assert_eq!(ran.code, Some(0), "{ran:?}");
            assert!(
                json_of(&ran)["damaged_units"].as_u64() >= Some(bad),
                "{ran:?}"
            );
        } else {
            assert_eq!(ran.code, Some(1), "{ran:?}");
            assert!(ran.stderr.contains("roots.foveal"), "{ran:?}");
            assert_eq!(json_of(&ran)["error"]["where"], json!(path));
        }
    }
}
