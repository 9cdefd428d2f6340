//! Do nine bytes a tile say what a step is worth as well as the pictures themselves?
//!
//! The value of going from a blurred to a sharp picture, tile by tile: from signatures, as
//! selection weighs units that it has not seen, against the pixel twin, which saw both pictures.

use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use foveal_core::content::video::units::VideoUnits;
use foveal_core::content::video::worth::Worth;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::eye::Gaze;
use foveal_core::perception::gain::step_gain;
use foveal_core::perception::glance::Glance;
use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::perception::measures::cues::Cues;
use foveal_core::perception::measures::pyramid::{Pyramid, doubled, halved};
use foveal_core::perception::measures::signature::{band_steps, signature_of};
use foveal_core::perception::parameters::{EyeState, Model, Parameters};
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::angle_between;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::{Colour, Matrix, Picture};
use foveal_core::view::random::Random;
use foveal_core::view::surface::{Screen, Surface};

const SIZE: [u32; 2] = [384, 192];
const TILE: u32 = 32;
const COLUMNS: u32 = SIZE[0] / TILE;
const ROWS: u32 = SIZE[1] / TILE;
const COLOUR: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: true,
    chroma_left: false,
};

fn picture(grey: impl Fn(u32, u32) -> f64) -> Picture {
    let mut picture = Picture::filled(SIZE[0], SIZE[1], [128; 3]);
    for (k, sample) in (0..).zip(&mut picture.planes[0]) {
        *sample = grey(k % SIZE[0], k / SIZE[0]).clamp(0.0, 255.0) as u8;
    }
    picture
}

/// Bilinear noise of cells of `cell` pixels, -1 to 1.
fn lattice(seed: u64, cell: u32) -> impl Fn(u32, u32) -> f64 {
    let mut random = Random::new(seed);
    let side = SIZE[0] / cell + 2;
    let knots: Vec<f64> = (0..side * side)
        .map(|_| 2.0 * random.unit() - 1.0)
        .collect();
    move |x, y| {
        let at = |x: u32, y: u32| knots[(y * side + x) as usize];
        let (i, j) = (x / cell, y / cell);
        let [u, v] = [x, y].map(|k| f64::from(k % cell) / f64::from(cell));
        let across = |j| at(i, j) * (1.0 - u) + at(i + 1, j) * u;
        across(j) * (1.0 - v) + across(j + 1) * v
    }
}

/// Noise of about the spectrum of photographs, stronger here than there.
fn natural(seed: u64) -> Picture {
    let octave = |k: u32| (f64::from(1 << k), lattice(seed + u64::from(k), 1 << k));
    let octaves: Vec<_> = (0..7).map(octave).collect();
    let strength = lattice(seed + 50, 64);
    picture(|x, y| {
        let parts = octaves.iter().map(|(weight, noise)| weight * noise(x, y));
        128.0 + parts.sum::<f64>() * (1.0 + strength(x, y))
    })
}

/// Checkers from fine to coarse across, from weak to strong downwards.
fn checkers() -> Picture {
    picture(|x, y| {
        let side = 1 << (x / 64);
        let sign = if (x / side + y / side) % 2 == 0 {
            1.0
        } else {
            -1.0
        };
        128.0 + sign * f64::from(4 + y / 3)
    })
}

/// Lines of strokes like letters, on paper that gets greyer, next to an empty margin.
fn text() -> Picture {
    let letters = lattice(31, 2);
    picture(|x, y| {
        let paper = 235.0 - f64::from(y) / 3.0;
        let line = y % 16 < 9 && (40..330).contains(&x) && x % 9 < 7;
        let ink = line && (x % 9 < 2 || letters(x, y) > 0.15);
        if ink { 30.0 } else { paper }
    })
}

/// A slope with a few hard edges in it.
fn smooth() -> Picture {
    picture(|x, y| {
        let edges = f64::from(u8::from(x > 150) + u8::from(x + y > 400)) * 45.0;
        50.0 + f64::from(x) / 6.0 + f64::from(y) / 8.0 + edges
    })
}

/// A picture of two levels, cut into tiles.
#[derive(Debug)]
struct Tiled {
    grid: TileGrid,
    signatures: Vec<Signature>,
}

impl Tiled {
    fn of(picture: &Picture) -> Self {
        let surface = Surface::flat(SIZE, Screen::default());
        let grid = TileGrid::new(surface, Cut::Grid([COLUMNS, ROWS]), 2, 2).unwrap();
        let shown = |tile| signature_of(&cut_out(picture, grid.origin(tile)), COLOUR, 2);
        // As they lie in a pack.
        let told = |tile| Signature::from_bytes(shown(tile).to_bytes());
        Self {
            signatures: grid.tiles_of(0).map(told).collect(),
            grid,
        }
    }
}

impl VideoUnits for Tiled {
    fn has_signatures(&self) -> bool {
        true
    }

    fn unit(&self, tile: Tile, _: u32) -> UnitId {
        UnitId(u32::from(tile.level) << 16 | self.grid.rank(tile))
    }

    fn next_group(&self, _: u32) -> Option<u32> {
        None
    }

    fn bytes(&self, _: UnitId) -> u32 {
        1
    }

    fn signature(&self, unit: UnitId) -> Option<Signature> {
        self.signatures.get(unit.0 as usize).copied()
    }

    fn cues(&self, _: UnitId) -> Option<Cues> {
        None
    }
}

fn cut_out(picture: &Picture, origin: [u32; 2]) -> Picture {
    let mut out = Picture::filled(TILE, TILE, [128; 3]);
    for (row, line) in (0..).zip(out.planes[0].chunks_exact_mut(TILE as usize)) {
        let from = ((origin[1] + row) * SIZE[0] + origin[0]) as usize;
        line.copy_from_slice(&picture.planes[0][from..from + TILE as usize]);
    }
    out
}

/// Who looks, a little aside, and at what.
struct Look {
    tiled: Tiled,
    view: EyeView,
    gaze: GazeSample,
}

impl Look {
    fn at(picture: &Picture) -> Self {
        let tiled = Tiled::of(picture);
        Self {
            view: EyeView::filling(&tiled.grid.surface, SIZE),
            gaze: GazeSample::at(Seconds(0.0), Radians::from_degrees(-6.0), Radians(0.05)),
            tiled,
        }
    }

    fn onlooker(&self) -> Onlooker {
        Onlooker {
            gaze: Gaze {
                direction: self.gaze.gaze_in_content,
                spread: self.gaze.spread,
            },
            ..Onlooker::at_rest(&self.view)
        }
    }

    /// The value of each tile as selection finds it.
    fn by_worth(&self, parameters: &Parameters) -> Vec<f64> {
        let config = PolicyConfig {
            perception: parameters.clone(),
            ..PolicyConfig::new(Policy::Perceptual)
        };
        let glance = Glance {
            gaze: self.gaze,
            view: Some(self.view),
            state: EyeState::Steady,
        };
        let grid = &self.tiled.grid;
        let gains = Worth::new(grid, &config).gains(grid, &self.tiled, 0, &glance);
        grid.tiles_of(0)
            .map(|cell| gains.step(grid, cell, 0))
            .collect()
    }

    /// The value of each tile from its signature, seen at its middle.
    fn by_middle(&self, parameters: &Parameters) -> Vec<f64> {
        let grid = &self.tiled.grid;
        let by_area = parameters.weights(EyeState::Steady).by_area;
        let value = |(cell, signature): (Tile, &Signature)| {
            let middle = grid.origin(cell).map(|k| f64::from(k + TILE / 2));
            let spot = self.onlooker().spot(middle);
            let bands = band_steps(signature, spot.ppd);
            let apart = angle_between(self.gaze.gaze_in_content, spot.direction);
            let luminance = parameters.luminance;
            let gain = step_gain(parameters, &bands, apart, EyeState::Steady, luminance);
            gain / if by_area {
                spot.ppd.0 * spot.ppd.0
            } else {
                1.0
            }
        };
        let tiles = grid.tiles_of(0).zip(&self.tiled.signatures);
        tiles.map(value).collect()
    }

    /// The value of each tile from all pixels of both pictures.
    fn by_pixels(&self, picture: &Picture, parameters: &Parameters) -> Vec<f64> {
        let luminance = parameters.luma_table();
        let codes = picture.planes[0].iter();
        let sharp: Vec<f64> = codes.map(|code| luminance[usize::from(*code)]).collect();
        let (coarse, coarse_size) = halved(&sharp, SIZE);
        let blurred = doubled(&coarse, coarse_size, SIZE);
        let levels = [sharp, blurred].map(|luminance| Pyramid::of(luminance, SIZE));
        let id = |k: u32| k / SIZE[0] / TILE * COLUMNS + k % SIZE[0] / TILE;
        let ids: Vec<u32> = (0..SIZE[0] * SIZE[1]).map(id).collect();
        let units = (COLUMNS * ROWS) as usize;
        let mut steps = self.onlooker().unit_gains(parameters, &levels, &ids, units);
        steps.remove(0)
    }
}

/// Spearman's rank correlation; equal values share the mean of their ranks.
fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
    let ranks = |values: &[f64]| -> Vec<f64> {
        let rank = |value: &f64| {
            let below = values.iter().filter(|other| *other < value).count();
            let equal = values.iter().filter(|other| *other == value).count();
            below as f64 + (equal as f64 - 1.0) / 2.0
        };
        values.iter().map(rank).collect()
    };
    let (a, b) = (ranks(a), ranks(b));
    let mean = (a.len() as f64 - 1.0) / 2.0;
    let together = |a: &[f64], b: &[f64]| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum()
    };
    together(&a, &b) / (together(&a, &a) * together(&b, &b)).sqrt()
}

#[test]
fn a_rank_correlation_is_one_for_one_order_and_minus_one_for_the_other() {
    let a = [3.0, 1.0, 2.0, 10.0];
    assert_eq!(rank_correlation(&a, &[30.0, 10.0, 20.0, 30.5]), 1.0);
    assert_eq!(rank_correlation(&a, &a.map(|value| -value)), -1.0);
    assert!((rank_correlation(&[1.0, 1.0, 2.0], &[1.0, 2.0, 2.0]) - 0.5).abs() < 1e-12);
}

#[test]
fn tiles_rank_by_their_signatures_as_by_their_pixels() {
    let pictures = [
        ("natural", natural(1)),
        ("checkers", checkers()),
        ("text", text()),
        ("smooth", smooth()),
    ];
    // As printed, a step is worth something without any detail, and popping reduces that: a small
    // difference of large numbers, which signatures know less well.
    for (model, least) in [(Model::Default, 0.9), (Model::Paper, 0.85)] {
        let parameters = Parameters::of(model);
        let mut all = [const { Vec::new() }; 2];
        for (name, picture) in &pictures {
            let look = Look::at(picture);
            let pixels = look.by_pixels(picture, &parameters);
            let worth = look.by_worth(&parameters);
            let rank = rank_correlation(&worth, &pixels);
            let middle = rank_correlation(&look.by_middle(&parameters), &pixels);
            eprintln!("{model:?}, {name}: worth {rank:.4}, step_gain {middle:.4}");
            assert!(rank >= least, "{model:?}, {name}: {rank}");
            assert!(middle >= least, "{model:?}, {name}: {middle}");
            all[0].extend(worth);
            all[1].extend(pixels);
        }
        let pooled = rank_correlation(&all[0], &all[1]);
        eprintln!("{model:?}, all tiles of all pictures: worth {pooled:.4}");
        assert!(pooled >= least, "{model:?}: {pooled}");
    }
}
