//! How is an imported rig written as TOML?

use std::fmt::Write as _;

use foveal_core::view::panel::distortion::{Distortion, GREEN};
use foveal_core::view::panel::residual_grid::ResidualGrid;
use foveal_core::view::panel::rig::{Panel, Rig, Scanout};

use super::super::{alpha, pfm};
use super::neat;

/// The rig file, and the maps that it names, by name.
pub(in super::super) fn written(rig: &Rig, stem: &str) -> Result<Vec<(String, Vec<u8>)>, String> {
    let mut text = "format = \"tiled-view/1\"\n".to_owned();
    if let Some([width, height]) = rig.screen {
        let _ = writeln!(text, "screen = [{width:?}, {height:?}]");
    }
    let mut files = Vec::new();
    for panel in &rig.panels {
        text.push_str(&lines_of(panel));
        if let Some(alpha) = &panel.alpha {
            let name = format!("{stem}.{}.alpha.png", panel.id);
            let _ = writeln!(text, "alpha = {}", quoted(&name));
            let picture = alpha::written(alpha, panel.view.size);
            files.push((name, picture.map_err(|error| error.to_string())?));
        }
        match &panel.distortion {
            Distortion::None => {}
            Distortion::Grid(grids) if is_by_pixels(&grids[GREEN], panel.view.size) => {
                let name = format!("{stem}.{}.pfm", panel.id);
                let file = quoted(&name);
                let _ = writeln!(text, "distortion = {{ model = \"pfm\", file = {file} }}");
                files.push((name, map_of(&grids[GREEN], panel.view.size)));
            }
            _ => return Err(format!("panel {}: its optics are no map", panel.id)),
        }
    }
    files.insert(0, (format!("{stem}.toml"), text.into_bytes()));
    Ok(files)
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn lines_of(panel: &Panel) -> String {
    let [yaw, pitch, roll] = panel
        .view
        .axes
        .yaw_pitch_roll()
        .map(|it| neat(it.to_degrees()));
    let [w, h] = panel.view.size;
    let f = panel.view.field;
    let [left, right, up, down] = [f.left, f.right, f.up, f.down].map(neat);
    let scanout = match panel.scanout {
        Scanout::Normal => "normal",
        Scanout::Rot90 => "rot90",
        Scanout::Rot180 => "rot180",
        Scanout::Rot270 => "rot270",
        Scanout::FlipX => "flip-x",
        Scanout::FlipY => "flip-y",
    };
    let output = &panel.output;
    let mut text = format!(
        "\n[[panel]]\nid = {}\npixels = [{w}, {h}]\n\
         pose = {{ order = \"yaw-pitch-roll\", yaw = {yaw:?}, pitch = {pitch:?}, \
         roll = {roll:?} }}\n\
         tangents = {{ left = {left:?}, right = {right:?}, up = {up:?}, down = {down:?} }}\n\
         scanout = \"{scanout}\"\n\
         output = {{ surface = {}, x = {}, y = {} }}\n",
        quoted(&panel.id),
        quoted(&output.surface),
        output.x,
        output.y,
    );
    if panel.blend > 0.0 {
        let _ = writeln!(text, "blend = {:?}", neat(panel.blend.to_degrees()));
    }
    if panel.gain != [1.0; 3] {
        let _ = writeln!(text, "gain = {:?}", panel.gain);
    }
    if panel.black > 0.0 {
        let _ = writeln!(text, "black = {:?}", panel.black);
    }
    text
}

fn is_by_pixels(grid: &ResidualGrid, size: [u32; 2]) -> bool {
    grid.nodes == size.map(|side| side as usize) && grid.origin == [0.5; 2]
}

/// The map of a grid with a node for each pixel, the lowest line first.
fn map_of(grid: &ResidualGrid, size: [u32; 2]) -> Vec<u8> {
    pfm::written(size, |line, column| {
        let row = size[1] - 1 - line;
        let residual = grid.residuals[row as usize * size[0] as usize + column as usize];
        let at = [column, row];
        [0, 1].map(|k| {
            let place = f64::from(at[k]) + 0.5 + f64::from(residual[k]);
            place / f64::from(size[k])
        })
    })
}
