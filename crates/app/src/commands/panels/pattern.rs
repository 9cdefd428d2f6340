//! Which pictures show by eye how panels stand?

use crate::options::policy::parse_size;
use crate::report::output;
use crate::report::output::say_replaced;
use crate::report::picture_file::write_png;
use anyhow::Context;
use clap::{Args, ValueEnum};
use foveal_render::RgbaImage;
use serde::Serialize;
use std::path::PathBuf;

/// Pixels from line to line of a grid, and how wide a line is.
const GRID: [u32; 2] = [16, 2];

/// Most pixels of a side.
const MOST: u32 = 16_384;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PatternName {
    /// Light lines on dark, closer than they are wide to the eye at a panel's far edge.
    Grid,
    /// All white: overlaps and feathers.
    White,
    /// Cells that show their column and row, and so what is turned, swapped or misplaced.
    Numbers,
}

/// Pictures to line up panels by.
#[derive(Clone, Debug, Args)]
pub(crate) struct PatternArgs {
    /// What it shows.
    #[arg(value_enum)]
    pattern: PatternName,
    /// Columns and rows.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: [u32; 2],
    /// The file to write, a PNG.
    #[arg(long, value_name = "FILE.png")]
    out: PathBuf,
    /// One JSON object on stdout.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct PatternResult {
    pattern: &'static str,
    size: [u32; 2],
    file: PathBuf,
}

pub(crate) fn run(args: &PatternArgs) -> anyhow::Result<()> {
    let [w, h] = args.size;
    if w.max(h) > MOST || w.min(h) == 0 {
        let range = format!("sides of 1 to {MOST} pixels, as 1600x1200");
        return Err(output::out_of_range("--size", format!("{w}x{h}"), &range).into());
    }
    let ending = args.out.extension().map(|it| it.to_string_lossy());
    if let Some(ending) = ending.filter(|it| !it.eq_ignore_ascii_case("png")) {
        let file = args.out.display();
        return Err(output::WrongUsage(format!(
            "--out {file}: pictures are written as PNG, not {ending}; end it in .png"
        ))
        .into());
    }
    let (name, image) = match args.pattern {
        PatternName::Grid => ("grid", grid(args.size)),
        PatternName::White => ("white", painted(args.size, |_| [255; 3])),
        PatternName::Numbers => ("numbers", numbers(args.size)),
    };
    say_replaced(&args.out);
    write_png(&args.out, &image).with_context(|| format!("--out {}", args.out.display()))?;
    let result = PatternResult {
        pattern: name,
        size: args.size,
        file: args.out.clone(),
    };
    let text = format!("{name}, {w}x{h}: {}\n", args.out.display());
    output::result(args.json, &result, &text)
}

fn painted(size: [u32; 2], colour: impl Fn([u32; 2]) -> [u8; 3]) -> RgbaImage {
    let mut image = RgbaImage::black(size);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let [r, g, b] = colour([x, y]);
            image.set_pixel([x, y], [r, g, b, 255]);
        }
    }
    image
}

/// Light lines on dark; every eighth is yellow, those through the middle are red.
pub(super) fn grid(size: [u32; 2]) -> RgbaImage {
    let [pitch, width] = GRID;
    painted(size, |at| {
        let line = |k: usize| {
            let from_middle = i64::from(at[k]) - i64::from(size[k] / 2) + i64::from(width / 2);
            let number = from_middle.div_euclid(i64::from(pitch));
            (from_middle.rem_euclid(i64::from(pitch)) < i64::from(width)).then_some(number)
        };
        match (line(0), line(1)) {
            (Some(0), _) | (_, Some(0)) => [255, 60, 40],
            (Some(n), _) | (_, Some(n)) if n % 8 == 0 => [255, 220, 60],
            (None, None) => [24; 3],
            _ => [235; 3],
        }
    })
}

/// Side of a cell of the numbers, in pixels.
const CELL: u32 = 64;

/// Rows of dots of digits, 3 x 5, from the upper left, a bit a dot.
const DIGITS: [u16; 10] = [
    0b111_101_101_101_111,
    0b010_110_010_010_111,
    0b111_001_111_100_111,
    0b111_001_011_001_111,
    0b101_101_111_001_001,
    0b111_100_111_001_111,
    0b111_100_111_101_111,
    0b111_001_010_010_010,
    0b111_101_111_101_111,
    0b111_101_111_001_111,
];

/// Cells of 64 pixels: the column above the row, on a colour that goes right and down.
fn numbers(size: [u32; 2]) -> RgbaImage {
    painted(size, |at| {
        let cell = at.map(|k| k / CELL);
        let within = at.map(|k| k % CELL);
        let share = |k: usize| (40 + 150 * u64::from(at[k]) / u64::from(size[k].max(1))) as u8;
        let ground = match (cell[0] + cell[1]) % 2 {
            0 => [share(0), share(1), 90],
            _ => [share(0) / 2, share(1) / 2, 60],
        };
        let edge = within.contains(&0);
        let row = usize::from(within[1] >= CELL / 2);
        let place = [within[0], within[1] % (CELL / 2)];
        match edge || is_inked(cell[row], place) {
            true => [255; 3],
            false => ground,
        }
    })
}

/// Whether a pixel of half a cell lies on a digit of a number of at most three.
fn is_inked(number: u32, [x, y]: [u32; 2]) -> bool {
    const DOT: u32 = 4;
    let (Some(x), Some(y)) = (x.checked_sub(8), y.checked_sub(7)) else {
        return false;
    };
    let (dot_x, dot_y) = (x / DOT, y / DOT);
    let (place, column) = (dot_x / 4, dot_x % 4);
    if place > 2 || column > 2 || dot_y > 4 {
        return false;
    }
    let digit = number / 10_u32.pow(2 - place) % 10;
    DIGITS[digit as usize] >> (14 - (3 * dot_y + column)) & 1 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_legible_and_differ_from_cell_to_cell() {
        let image = numbers([256, 128]);
        let cell = |column: u32| {
            let pixels = (0..CELL * CELL / 2).map(|k| [column * CELL + k % CELL, k / CELL]);
            pixels
                .map(|at| image.pixel(at)[..3] == [255; 3])
                .collect::<Vec<_>>()
        };
        assert_ne!(cell(1), cell(2));
        assert!(cell(3).iter().filter(|inked| **inked).count() > 200);
    }

    #[test]
    fn the_middle_of_a_grid_is_marked() {
        let image = grid([160, 120]);
        assert_eq!(image.pixel([80, 5]), [255, 60, 40, 255]);
        assert_eq!(image.pixel([5, 60]), [255, 60, 40, 255]);
    }
}
