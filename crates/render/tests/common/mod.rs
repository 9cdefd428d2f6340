//! Which pictures, tiles and views do the tests draw?
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

pub mod ball;
pub mod levels;
pub mod panels;
pub mod plate;
pub mod playing;
pub mod torus;

use foveal_core::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::picture::{Colour, Matrix, Picture, plane_size};
use foveal_core::view::surface::{Eye, Projection, Screen, Surface};
use foveal_render::gpu::readback::BytesBack;
use foveal_render::twin::TwinTiles;
use foveal_render::{Gpu, HalvedBy, Renderer, RgbaImage};

pub const FULL: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: true,
    chroma_left: false,
};
pub const LIMITED: Colour = Colour {
    matrix: Matrix::Bt601,
    full_range: false,
    chroma_left: false,
};
pub const LEFT: Colour = Colour {
    matrix: Matrix::Bt2020,
    full_range: false,
    chroma_left: true,
};

/// A small seeded generator (Knuth's MMIX constants).
pub struct Seeded(pub u64);

impl Seeded {
    pub fn below(&mut self, bound: u32) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as u32) % bound
    }
}

/// Content: every face at level 0, and the grid it is cut by.
pub struct Scene {
    pub grid: TileGrid,
    pub colour: Colour,
    pub faces: Vec<Picture>,
}

pub fn flat(size: [u32; 2]) -> Surface {
    Surface::flat(size, Screen::default())
}

impl Scene {
    /// Content whose Y, U and V (0 to 255) are a function of face and place.
    pub fn new(grid: TileGrid, colour: Colour, yuv: impl Fn(u32, [f64; 2]) -> [f64; 3]) -> Self {
        let [w, h] = grid.surface.size;
        let chroma_x = if colour.chroma_left { 0.5 } else { 1.0 };
        let face = |face| {
            let planes = [0, 1, 2].map(|p| {
                let [columns, rows] = plane_size(w, h, p);
                let at = |x, y| match p {
                    0 => [f64::from(x) + 0.5, f64::from(y) + 0.5],
                    _ => [f64::from(x) * 2.0 + chroma_x, f64::from(y) * 2.0 + 1.0],
                };
                let mut plane = Vec::new();
                for y in 0..rows {
                    plane.extend((0..columns).map(|x| (yuv(face, at(x, y))[p] + 0.5) as u8));
                }
                plane
            });
            Picture {
                width: w,
                height: h,
                planes,
            }
        };
        Self {
            grid,
            colour,
            faces: (0..grid.faces()).map(face).collect(),
        }
    }

    /// A tile as `prepare` makes it: the box average of what it covers.
    pub fn tile(&self, tile: Tile) -> Picture {
        let scale = self.grid.scale(tile.level);
        let [width, height] = self.grid.tile_size(tile);
        let even = [width, height].map(|s| s.next_multiple_of(2) * scale);
        let from = self.faces[usize::from(tile.face)].crop(self.grid.origin(tile), even);
        let planes = [0, 1, 2].map(|p| {
            let [columns, rows] = plane_size(width, height, p);
            let line = from.plane_size(p)[0];
            let mut plane = Vec::new();
            for y in 0..rows {
                for x in 0..columns {
                    let mut sum = scale * scale / 2;
                    for dy in 0..scale {
                        let at = ((y * scale + dy) * line + x * scale) as usize;
                        let row = &from.planes[p][at..at + scale as usize];
                        sum += row.iter().map(|&c| u32::from(c)).sum::<u32>();
                    }
                    plane.push((sum / (scale * scale)) as u8);
                }
            }
            plane
        });
        Picture {
            width,
            height,
            planes,
        }
    }

    /// The coarsest level and `tiles`, on the GPU.
    pub fn on_gpu(&self, gpu: &Gpu, tiles: &[Tile]) -> Renderer {
        self.halved_by(HalvedBy::Cpu, gpu, tiles)
    }

    /// The same, with averages that one or the other makes.
    pub fn halved_by(&self, by: HalvedBy, gpu: &Gpu, tiles: &[Tile]) -> Renderer {
        let mut renderer = Renderer::new(gpu, &self.grid, self.colour, 256).unwrap();
        renderer.tiles().halve_by(by);
        renderer.tiles().begin_frame(1);
        for tile in self
            .grid
            .tiles_of(self.grid.coarsest())
            .chain(tiles.iter().copied())
        {
            renderer.tiles().upload(tile, 1, &self.tile(tile)).unwrap();
        }
        renderer
    }

    /// The same in main memory.
    pub fn in_memory(&self, tiles: &[Tile]) -> TwinTiles {
        let mut twin = TwinTiles::new(&self.grid, self.colour);
        twin.begin_frame(1);
        for tile in self
            .grid
            .tiles_of(self.grid.coarsest())
            .chain(tiles.iter().copied())
        {
            twin.upload(tile, 1, &self.tile(tile)).unwrap();
        }
        twin
    }

    /// About a third of the tiles of every level but the coarsest.
    pub fn some_tiles(&self, seed: u64) -> Vec<Tile> {
        let mut random = Seeded(seed);
        (0..self.grid.coarsest())
            .flat_map(|level| self.grid.tiles_of(level))
            .filter(|_| random.below(3) == 0)
            .collect()
    }

    /// All tiles of the finest level.
    pub fn finest(&self) -> Vec<Tile> {
        if self.grid.levels == 1 {
            return Vec::new();
        }
        self.grid.tiles_of(0).collect()
    }
}

/// Waves of many lengths and directions over a plane, in luma and in colour, without noise;
/// `phase` moves them against each other.
pub fn waves_moved(phase: f64, [x, y]: [f64; 2]) -> [f64; 3] {
    let wave = |length: f64, turn: f64| {
        let along = x * turn.cos() + y * turn.sin();
        (along * std::f64::consts::TAU / length + phase * (1.0 + 7.0 * turn)).sin()
    };
    let luma = 38.0 * wave(97.0, 0.3) + 25.0 * wave(41.0, 1.4) + 16.0 * wave(23.0, 2.3);
    [
        128.0 + luma + 10.0 * wave(13.0, 2.9) + 10.0 * wave(11.0, 0.8),
        128.0 + 35.0 * wave(67.0, 0.9) + 15.0 * wave(29.0, 2.6),
        128.0 + 35.0 * wave(53.0, 2.0) + 15.0 * wave(31.0, 0.2),
    ]
}

/// [`waves_moved`] at one phase.
pub fn waves(_face: u32, place: [f64; 2]) -> [f64; 3] {
    waves_moved(0.0, place)
}

/// The same kind of waves as a function of the direction that a place lies in.
pub fn waves_around_moved(phase: f64, surface: &Surface, face: u32, place: [f64; 2]) -> [f64; 3] {
    let d = surface.direction(face, place);
    let wave = |x: f64, y: f64, z: f64| (d.x * x + d.y * y + d.z * z + phase * (x + 2.0)).sin();
    let luma = 45.0 * wave(5.0, 2.0, -3.0) + 30.0 * wave(-9.0, 8.0, 7.0);
    [
        128.0 + luma + 15.0 * wave(17.0, 3.0, 9.0) + 10.0 * wave(4.0, -15.0, 11.0),
        128.0 + 50.0 * wave(4.0, -6.0, 2.0),
        128.0 + 50.0 * wave(-3.0, 2.0, 7.0),
    ]
}

/// [`waves_around_moved`] at one phase.
pub fn waves_around(surface: &Surface, face: u32, place: [f64; 2]) -> [f64; 3] {
    waves_around_moved(0.0, surface, face, place)
}

pub fn cube_waves(face_size: u32, cut: Cut, levels: u8, ratio: u32) -> Scene {
    let surface = Surface::cube(face_size);
    let grid = TileGrid::new(surface, cut, levels, ratio).unwrap();
    Scene::new(grid, FULL, |face, place| {
        waves_around(&surface, face, place)
    })
}

/// Waves on a surface of any number of faces and eyes; each eye sees other ones.
pub fn waves_on(surface: Surface, cut: Cut, levels: u8, ratio: u32) -> Scene {
    let grid = TileGrid::new(surface, cut, levels, ratio).unwrap();
    Scene::new(grid, FULL, |face, place| {
        let phase = if face < surface.faces_of_an_eye() {
            0.0
        } else {
            0.8
        };
        match surface.projection {
            Projection::Flat => waves_moved(phase, place),
            Projection::Cube | Projection::Equirect => {
                waves_around_moved(phase, &surface, face, place)
            }
        }
    })
}

/// What the other eye sees.
pub fn of_right_eye(view: EyeView) -> EyeView {
    EyeView {
        eye: Eye::Right,
        ..view
    }
}

/// A view turned by degrees of yaw, pitch and roll, `across` degrees wide.
pub fn turned([yaw, pitch, roll]: [f64; 3], across: f64, size: [u32; 2]) -> EyeView {
    let [yaw, pitch, roll, across] = [yaw, pitch, roll, across].map(Radians::from_degrees);
    EyeView {
        position: Default::default(),
        axes: Axes::from_yaw_pitch_roll(yaw, pitch, roll),
        field: Field::across(across, size),
        size,
        eye: Default::default(),
    }
}

/// A view that shows flat content of `content` pixels pixel for pixel, shifted and cut to `size`.
pub fn window(surface: &Surface, from: [f64; 2], size: [u32; 2], zoom: f64) -> EyeView {
    let tangent =
        |k: usize, at: f64| surface.tangents[k] * (2.0 * at / f64::from(surface.size[k]) - 1.0);
    let to = [0, 1].map(|k| from[k] + f64::from(size[k]) / zoom);
    EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field {
            left: -tangent(0, from[0]),
            right: tangent(0, to[0]),
            up: -tangent(1, from[1]),
            down: tangent(1, to[1]),
            at_eye: None,
        },
        size,
        eye: Default::default(),
    }
}

/// Largest difference of a channel, and the share of channels that differ by more than 1.
pub fn difference(a: &RgbaImage, b: &RgbaImage) -> (u8, f64) {
    assert_eq!(a.size, b.size);
    let apart = |(x, y): (&u8, &u8)| x.abs_diff(*y);
    let pairs = || a.pixels.iter().zip(&b.pixels);
    let worst = pairs().map(apart).max().unwrap_or(0);
    let off = pairs().filter(|&pair| apart(pair) > 1).count();
    (worst, off as f64 / a.pixels.len() as f64)
}

/// Writes a picture as PNG.
pub fn write_png(path: &std::path::Path, image: &RgbaImage) {
    let file = std::io::BufWriter::new(std::fs::File::create(path).unwrap());
    let mut encoder = png::Encoder::new(file, image.size[0], image.size[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&image.pixels).unwrap();
    writer.finish().unwrap();
}

/// Reads a picture written by [`write_png`].
pub fn read_png(path: &std::path::Path) -> RgbaImage {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    RgbaImage {
        size: [info.width, info.height],
        pixels,
    }
}

/// The tiles that show a disc of `radius` level-0 pixels (on a cube: of the face's middle) round a
/// place finely, and every ring of `ring` more one level coarser.
pub fn fine_around(
    grid: &TileGrid,
    face: u32,
    place: [f64; 2],
    [radius, ring]: [f64; 2],
) -> Vec<Tile> {
    let surface = &grid.surface;
    let gaze = surface.direction(face, place);
    let level_of = |cell: &Tile| {
        let (origin, covered) = (grid.origin(*cell), grid.covered(*cell));
        let middle = [0, 1].map(|k| f64::from(origin[k]) + f64::from(covered[k]) / 2.0);
        let there = surface.direction(u32::from(cell.face), middle);
        let away = (there - gaze).length() / surface.pitch();
        let beyond = (away - radius).max(0.0) / ring;
        (beyond.ceil() as u8).min(grid.coarsest())
    };
    let mut tiles: Vec<Tile> = grid
        .tiles_of(0)
        .map(|cell| grid.tile_over(cell, level_of(&cell)))
        .filter(|tile| tile.level < grid.coarsest())
        .collect();
    tiles.sort_unstable();
    tiles.dedup();
    tiles
}

/// Crisp content: a chequered ground, thin bright lines, and rings that get closer outwards.
pub fn detail(x: f64, y: f64, hue: f64) -> [f64; 3] {
    let chequer = ((x * 4.0).floor() + (y * 4.0).floor()).rem_euclid(2.0);
    let line = |a: f64| f64::from(a.rem_euclid(1.0) < 0.04);
    let rings = (40.0 * (x * x + y * y)).cos();
    let luma = 90.0 + 60.0 * chequer + 30.0 * rings + 70.0 * line(x).max(line(y));
    [
        luma.clamp(0.0, 255.0),
        128.0 + 50.0 * (hue + x * 1.5).sin(),
        128.0 + 50.0 * (hue * 2.0 + y * 2.0).cos(),
    ]
}

/// [`detail`] over a cube, by yaw and pitch in units of 20 degrees.
pub fn detail_around(surface: &Surface, face: u32, place: [f64; 2]) -> [f64; 3] {
    let d = surface.direction(face, place);
    let yaw = d.x.atan2(-d.z).to_degrees() / 20.0;
    let pitch = d.y.asin().to_degrees() / 20.0;
    let mut yuv = detail(yaw - 2.0, pitch - 1.5, 0.0);
    yuv[1] = 128.0 + 50.0 * (d.x * 3.0).sin();
    yuv[2] = 128.0 + 50.0 * (d.y * 3.0).cos();
    yuv
}

/// The bytes of a picture of 4 bytes a pixel, whose rows are multiples of 256 bytes.
pub fn bytes_of(gpu: &Gpu, image: &wgpu::Texture) -> Vec<u8> {
    let row = image.width() * 4;
    let buffer = BytesBack::buffer(gpu, u64::from(row * image.height()));
    let mut encoder = gpu.encoder("units to read");
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(row),
        rows_per_image: None,
    };
    encoder.copy_texture_to_buffer(
        image.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout,
        },
        image.size(),
    );
    gpu.submit(encoder);
    BytesBack::map(buffer).wait(gpu).unwrap()
}

/// Share of pixels of which a channel differs by more than `most`.
pub fn share_beyond(a: &RgbaImage, b: &RgbaImage, most: u8) -> f64 {
    assert_eq!(a.size, b.size);
    let pixels = a.pixels.chunks(4).zip(b.pixels.chunks(4));
    let off = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > most));
    off.count() as f64 / (a.pixels.len() / 4) as f64
}
