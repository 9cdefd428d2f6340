//! Which colour has a texture somewhere, as far as its pages are there? Twin of
//! `shaders/shared/pages.wgsl`.

use super::wgsl::mix;
use crate::error::RenderError;
use crate::pages::table::{HEAD_WORDS, NO_PAGE, PageSlot, PageTable};
use crate::scene::coming::Coming;
use foveal_core::content::images::halving::Halving;
use foveal_core::content::images::payload::ImagePage;
use foveal_core::content::images::picture::TexturePicture;
use foveal_core::content::scene::description::{SceneObject, SceneTexture};
use foveal_core::pack::unit::UnitId;
use glam::{UVec2, Vec2, Vec4};
use std::collections::HashSet;

const FIRST_LEVEL: u32 = 8;
const PAGE_SIDE: u32 = 256;
pub(crate) const NO_TEXTURE: u32 = u32::MAX;
const NO_TEXTURE_BYTE: u8 = 255;
const MIRROR: u32 = 1;
const CLAMP: u32 = 2;

/// Pages in main memory: each lies in a layer of its own.
pub(crate) struct TwinPages {
    pub(crate) table: PageTable,
    layers: Vec<TexturePicture>,
    free: Vec<PageSlot>,
    halving: Halving,
}

#[derive(Clone, Copy)]
struct Sampled {
    colour: Vec4,
    level: u32,
}

impl TwinPages {
    /// No page of these textures, which these objects have.
    pub(crate) fn new(textures: &[SceneTexture], objects: &[SceneObject]) -> Self {
        Self {
            table: PageTable::new(textures, objects),
            layers: Vec::new(),
            free: Vec::new(),
            halving: Halving::default(),
        }
    }

    /// Adds a page; one that is there stays as it is.
    pub(crate) fn insert(
        &mut self,
        coming: &Coming<'_>,
        payload: &ImagePage,
    ) -> Result<(), RenderError> {
        let Coming { unit, needs, .. } = *coming;
        if self.table.show_again(unit) || self.table.is_there(unit) {
            return Ok(());
        }
        let pictures = self.table.pictures_of(unit, needs, payload)?;
        let slots = pictures
            .into_iter()
            .map(|picture| self.keep(picture))
            .collect();
        self.table
            .insert(unit, needs, (payload.texture, payload.page), slots);
        Ok(())
    }

    fn keep(&mut self, picture: TexturePicture) -> PageSlot {
        let free = self.free.pop().unwrap_or(PageSlot {
            at: [0; 2],
            layer: self.layers.len() as u16,
        });
        let layer = usize::from(free.layer);
        self.layers
            .resize(self.layers.len().max(layer + 1), TexturePicture::default());
        self.layers[layer] = picture;
        free
    }

    /// Shows only pages that are wanted, what these need, and roots; of the others those stay that
    /// are `staying`.
    pub(crate) fn keep_only(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        self.free.extend(self.table.keep(wanted, staying));
    }

    fn word(&self, at: u32) -> u32 {
        self.table.words()[at as usize]
    }

    fn page_number(&self, word: u32) -> f32 {
        f32::from_bits(self.word(word))
    }

    fn texture_size(&self, head: u32) -> UVec2 {
        UVec2::new(self.word(head), self.word(head + 1))
    }

    /// What the GPU's sampler gives: between four texels, in linear light.
    fn sample(&self, layer: u32, at: Vec2) -> Vec4 {
        let picture = &self.layers[layer as usize];
        let corner = at - 0.5;
        let share = corner - corner.floor();
        let first = corner.floor().as_ivec2();
        let texel = |column: i32, row: i32| {
            let [x, y] = [(first.x + column, 0), (first.y + row, 1)];
            let [x, y] = [x, y].map(|(at, k)| at.clamp(0, picture.size[k] as i32 - 1) as u32);
            let [r, g, b, alpha] = picture.at([x, y]);
            let light = [r, g, b].map(|code| self.halving.light(code));
            Vec4::new(light[0], light[1], light[2], f32::from(alpha) / 255.0)
        };
        let row = |row| texel(0, row).lerp(texel(1, row), share.x);
        row(0).lerp(row(1), share.y)
    }
}

fn pages_of(size: UVec2, level: u32) -> UVec2 {
    let texels = (size + (1 << level) - 1) >> level;
    (texels + PAGE_SIDE - 1) / PAGE_SIDE
}

fn fract(value: f32) -> f32 {
    value - value.floor()
}

fn wrapped(wrap: u32, along: f32) -> f32 {
    if wrap == CLAMP {
        return along.clamp(0.0, 1.0);
    }
    if wrap == MIRROR {
        return 1.0 - (2.0 * fract(0.5 * along) - 1.0).abs();
    }
    fract(along)
}

fn sampled(pages: &TwinPages, head: u32, level: u32, place: Vec2) -> Sampled {
    let size = pages.texture_size(head);
    let wanted = pages_of(size, level);
    let page = (place / (PAGE_SIDE << level) as f32)
        .as_uvec2()
        .min(wanted - 1);
    let entry = pages.word(head + FIRST_LEVEL + level) + 2 * (page.y * wanted.x + page.x);
    let lies = pages.word(entry + 1);
    if lies == NO_PAGE {
        let mean = [4, 5, 6].map(|it| pages.page_number(head + it));
        let [r, g, b] = mean;
        return Sampled {
            colour: Vec4::new(r, g, b, 1.0),
            level: NO_PAGE,
        };
    }
    let found = lies >> 16;
    let texel = place / (1_u32 << found) as f32;
    let shown = (texel / PAGE_SIDE as f32)
        .as_uvec2()
        .min(pages_of(size, found) - 1);
    let first = Vec2::new(
        (pages.word(entry) & 65535) as f32,
        (pages.word(entry) >> 16) as f32,
    );
    let at = first + texel - (shown * PAGE_SIDE).as_vec2();
    Sampled {
        colour: pages.sample(lies & 65535, at),
        level: found,
    }
}

pub(crate) fn texture_colour(
    pages: &TwinPages,
    head: u32,
    uv: Vec2,
    [right, down]: [Vec2; 2],
) -> Vec4 {
    let size = pages.texture_size(head).as_vec2();
    let kind = pages.word(head + 2);
    let inside = Vec2::new(wrapped(kind >> 8 & 255, uv.x), wrapped(kind >> 16, uv.y));
    let texels = (right * size).length().max((down * size).length());
    let coarsest = ((kind & 255) - 1) as f32;
    let detail = texels.max(1e-9).log2().clamp(0.0, coarsest);
    let level = detail as u32;
    let fine = sampled(pages, head, level, inside * size);
    let share = fract(detail);
    if fine.level != level || share == 0.0 {
        return fine.colour;
    }
    let coarse = sampled(pages, head, level + 1, inside * size);
    mix(fine.colour, coarse.colour, share)
}

pub(crate) fn texture_of(pages: &TwinPages, list: u32, number: u8) -> u32 {
    if number == NO_TEXTURE_BYTE {
        return NO_TEXTURE;
    }
    HEAD_WORDS as u32 * pages.word(list + u32::from(number))
}

pub(crate) fn is_cut_out(pages: &TwinPages, head: u32, alpha: f32) -> bool {
    alpha < pages.page_number(head + 3)
}
