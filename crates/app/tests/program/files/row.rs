//! How do files look that stand side by side?

use crate::support::{Folder, Rgb, done, json};
use serde_json::Value;

/// What came of files that stand in a row before the eye, a metre wide each.
pub(super) struct Row {
    /// What `prepare` says.
    pub(super) told: Value,
    /// The colour in the middle of each.
    pub(super) colours: Vec<[u8; 3]>,
}

impl Row {
    /// Prepares and draws files of this folder, whose contents are from 0 to 1 along x and y.
    pub(super) fn of(folder: &Folder, names: &[&str]) -> Self {
        let mut site = "light = [0, 0, 1]\n".to_owned();
        for (number, name) in names.iter().enumerate() {
            let x = 1.5 * number as f64;
            site += &format!(
                "[[input]]\nfile = {name:?}\nup = \"y\"\n\
                 place = [{{ translation = [{x}, 0, 0] }}]\n"
            );
        }
        let site = folder.holding("row.toml", site.as_bytes());
        let pack = folder.name("row.foveal");
        let told = json(&["prepare", "scene", &site, "--out", &pack, "--force"]);
        let out = folder.name("row");
        done(&[
            "simulate",
            &pack,
            "--out",
            &out,
            "--view",
            "600x200",
            "--frames",
            "1",
            "--policy",
            "full",
            "--renderer",
            "cpu",
        ]);
        let picture = Rgb::read(&format!("{out}/frame_00000.png"));
        let background = picture.at([0, 0]);
        let middle = picture.size[1] / 2;
        let is_shown = |x: u32| picture.at([x, middle]) != background;
        let mut runs: Vec<[u32; 2]> = Vec::new();
        for x in (0..picture.size[0]).filter(|x| is_shown(*x)) {
            match runs.last_mut() {
                Some(run) if run[1] + 1 == x => run[1] = x,
                _ => runs.push([x, x]),
            }
        }
        Self {
            told,
            colours: runs
                .iter()
                .map(|run| picture.at([run[0].midpoint(run[1]), middle]))
                .collect(),
        }
    }

    /// Whether all show what the first does.
    pub(super) fn assert_alike(&self, names: &[&str]) {
        assert_eq!(self.colours.len(), names.len(), "{:?}", self.colours);
        for (colour, name) in self.colours.iter().zip(names) {
            let off = [0, 1, 2].map(|k| colour[k].abs_diff(self.colours[0][k]));
            assert!(
                off.iter().all(|it| *it <= 5),
                "{name}: {colour:?} {:?}",
                self.colours
            );
        }
    }

    /// Whether there is a remark with all of these words.
    pub(super) fn assert_remarks(&self, words: &[&str]) {
        let remarks = self.told["remarks"].as_array().unwrap();
        let has = |it: &Value| words.iter().all(|word| it.as_str().unwrap().contains(word));
        assert!(remarks.iter().any(has), "no {words:?} in {remarks:#?}");
    }

    /// How often something was mended.
    pub(super) fn mended(&self, name: &str) -> u64 {
        self.told["repairs"][name].as_u64().unwrap_or(0)
    }
}

/// A PNG of one colour.
pub(super) fn png_of(colour: [u8; 3], side: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side, side);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer
        .write_image_data(&colour.repeat((side * side) as usize))
        .unwrap();
    drop(writer);
    bytes
}
