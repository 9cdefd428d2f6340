//! Which units does each texture become?

use super::built::{BuildError, BuiltUnit};
use super::mesh::grid_mesh::GridMesh;
use super::pyramid::{BAND_ROWS, PageLevels, PageMaker};
use super::regions::{ShownRegion, regions};
use super::sphere::LocalSphere;
use super::textures::{ShownImage, ShownImages};
use crate::read::image::PictureRows;
use crate::source::SourceScene;
use foveal_core::content::images::halving::Halving;
use foveal_core::content::images::payload::{PageCodec, page_bytes};
use foveal_core::content::images::picture::TexturePicture;
use foveal_core::content::images::shape::{PagePlace, TextureShape};
use foveal_core::content::scene::description::{SceneTexture, most_growth};
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::content::scene::part_ref::PartRef;
use foveal_core::content::scene::unit_table::{OF_ALL, UnitRow};
use foveal_core::pack::PackError;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::luminance::grey_from_rgb;
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::perception::measures::signature::signature_of;
use foveal_core::units::one_line;
use foveal_core::view::picture::{Colour, Matrix, Picture};
use glam::DVec3;
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Quality of pages as JPEG, on the scale of the Independent JPEG Group: what photographs of
/// surfaces are mostly stored with, so that a page is no larger than its part of the source.
const JPEG_QUALITY: u8 = 85;
/// Side of a block of a JPEG, and what its samples may be off on average, in codes.
const BLOCK: usize = 8;
const MOST_OFF: u32 = 24;
/// How luma is described for a signature.
const GREY: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: true,
    chroma_left: false,
};

/// A page of a texture, written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BuiltPage {
    /// Where in its texture.
    pub place: PagePlace,
    /// Which page of the texture it lies in, by its place in their list; none of a root.
    pub coarser: Option<usize>,
    row: UnitRow,
    payload: Vec<u8>,
}

impl BuiltPage {
    /// Which quarter of the page that it lies in it is.
    fn quarter(&self) -> PartRef {
        PartRef {
            need: 0,
            part: self.place.quarter(),
        }
    }

    /// The page as a unit, given its level and the units of all pages of its texture.
    pub(super) fn unit(&self, level: u8, unit_of: &[UnitId]) -> BuiltUnit {
        BuiltUnit {
            level,
            row: UnitRow {
                needs: self.coarser.map(|it| unit_of[it]).into_iter().collect(),
                replaces: self.coarser.map(|_| self.quarter()).into_iter().collect(),
                ..self.row.clone()
            },
            payload: self.payload.clone(),
        }
    }
}

/// The textures of a scene, written.
#[derive(Clone, Debug, Default)]
pub(super) struct WrittenTextures {
    /// What is known of each.
    pub textures: Vec<SceneTexture>,
    /// The pages of each.
    pub all: Vec<Vec<BuiltPage>>,
    /// Number of pictures that are broken: their texture is white, so that colours stand as they
    /// are.
    pub broken: u64,
    /// Which of them, the first ones.
    pub remarks: Vec<String>,
}

/// Most broken pictures that are named.
const MOST_NAMED: usize = 8;
/// Bytes that pages may take besides eight for each byte of their pictures.
const MOST_PAGE_BYTES: u64 = 64 << 20;
const MOST_PAGE_BYTES_A_BYTE: u64 = 8;

/// Writes the textures that meshes show, and gives these their numbers.
///
/// Some hundred rows of one texture after the other are in memory, and the pages of all.
pub(super) fn write(
    source: &SourceScene,
    shown: &ShownImages,
    meshes: &mut [GridMesh],
    exact: bool,
) -> Result<WrittenTextures, BuildError> {
    let mut written = WrittenTextures::default();
    let named: BTreeSet<usize> = shown.all.iter().map(|it| it.image).collect();
    let bytes = named.iter().map(|it| source.images[*it].bytes.len() as u64);
    let mut left = MOST_PAGE_BYTES + MOST_PAGE_BYTES_A_BYTE * bytes.sum::<u64>();
    for number in 0..shown.all.len() as u16 {
        let about = &shown.all[usize::from(number)];
        let seen = seen_regions(meshes, number, about);
        if seen.regions.is_empty() {
            continue;
        }
        let texture = Texture {
            number: written.all.len() as u16,
            about: ShownImage { ..*about },
            exact,
            seen,
        };
        let image = &source.images[about.image];
        let mut made = texture.write(PictureRows::open(&image.bytes), left)?;
        if made.is_none() {
            written.broken += 1;
            if written.remarks.len() < MOST_NAMED {
                let name: String = image.name.chars().take(80).collect();
                written.remarks.push(one_line(&format!(
                    "the picture {name:?} is damaged or cut short: surfaces have their colour alone"
                )));
            }
            made = texture.white()?;
        }
        let Some((mut told, pages)) = made else {
            continue;
        };
        told.name.clone_from(&image.name);
        left = left.saturating_sub(payload_bytes(&pages));
        written.textures.push(told);
        written.all.push(pages);
        for texturing in meshes
            .iter_mut()
            .filter_map(|it| it.object.texturing.as_mut())
        {
            let numbers = texturing.textures.iter_mut();
            let own = numbers.filter(|it| **it == number);
            own.for_each(|it| *it = texture.number);
        }
    }
    Ok(written)
}

fn payload_bytes(pages: &[BuiltPage]) -> u64 {
    pages.iter().map(|it| it.payload.len() as u64).sum()
}

/// Which parts of surfaces show the pages of level 0 of a texture.
struct SeenRegions {
    /// The object that all of them are of, or [`OF_ALL`].
    object: u16,
    regions: BTreeMap<PagePlace, ShownRegion>,
}

fn seen_regions(meshes: &[GridMesh], texture: u16, image: &ShownImage) -> SeenRegions {
    let of_mesh = meshes.par_iter().enumerate().map(|(object, mesh)| {
        let slots = mesh.object.texturing.iter().flat_map(|it| &it.textures);
        let slot = slots.zip(0..).find(|(it, _)| **it == texture);
        let regions = slot.map(|(_, slot)| regions(mesh, slot, image));
        (object, regions.unwrap_or_default())
    });
    let of_mesh: Vec<_> = of_mesh.collect();
    let mut of_mesh: Vec<_> = of_mesh
        .into_iter()
        .filter(|(_, it)| !it.is_empty())
        .collect();
    if let [(object, regions)] = &mut of_mesh[..] {
        return SeenRegions {
            object: *object as u16,
            regions: std::mem::take(regions),
        };
    }
    let mut in_world: BTreeMap<PagePlace, Vec<ShownRegion>> = BTreeMap::new();
    for (object, regions) in of_mesh {
        let object = &meshes[object].object;
        for (page, region) in regions {
            let placed = object.placements().map(|world_from_object| {
                let origin = DVec3::from_array(object.grid.origin);
                let centre = origin + DVec3::from_array(region.sphere.centre.map(f64::from));
                let centre = world_from_object.transform_point3(centre);
                let growth = most_growth(&world_from_object);
                let rounded = centre.as_vec3();
                let off = (centre - rounded.as_dvec3()).length();
                let radius = f64::from(region.sphere.radius) * growth + off;
                ShownRegion {
                    sphere: LocalSphere {
                        centre: rounded.to_array(),
                        radius: (radius as f32).next_up(),
                    },
                    texel: region.texel * growth,
                }
            });
            in_world.entry(page).or_default().extend(placed);
        }
    }
    let regions = in_world.into_iter().map(|(page, all)| (page, round(&all)));
    SeenRegions {
        object: OF_ALL,
        regions: regions.collect(),
    }
}

/// What encloses regions, of which there is at least one.
fn round(regions: &[ShownRegion]) -> ShownRegion {
    if let [region] = regions {
        return *region;
    }
    let spheres: Vec<LocalSphere> = regions.iter().map(|it| it.sphere).collect();
    ShownRegion {
        sphere: LocalSphere::round(&spheres),
        texel: regions.iter().map(|it| it.texel).fold(0.0, f64::max),
    }
}

/// A texture on its way to pages.
struct Texture {
    number: u16,
    about: ShownImage,
    exact: bool,
    seen: SeenRegions,
}

/// The pages of a texture that are shown, finest level first.
struct PlannedPages<'a> {
    texture: &'a Texture,
    shape: TextureShape,
    planned: &'a [BTreeMap<PagePlace, ShownRegion>],
}

impl PageMaker for PlannedPages<'_> {
    type Made = BuiltPage;
    type Error = PackError;

    fn wanted(&self, level: u8, row: u16) -> Vec<PagePlace> {
        let [columns, _] = self.shape.pages(level);
        let all = (0..columns as u16).map(|column| PagePlace {
            level,
            place: [column, row],
        });
        let planned = &self.planned[usize::from(level)];
        all.filter(|it| planned.contains_key(it)).collect()
    }

    fn make(&self, place: PagePlace, texels: &TexturePicture) -> Result<BuiltPage, PackError> {
        let region = &self.planned[usize::from(place.level)][&place];
        self.texture.page(&self.shape, (place, region), texels)
    }
}

/// A texture's description, and its pages: coarsest first.
type Written = (SceneTexture, Vec<BuiltPage>);

impl Texture {
    /// Its description, and its pages; `None` where the picture is broken, or where they take
    /// more than `most` bytes.
    fn write(
        &self,
        picture: Option<PictureRows<'_>>,
        most: u64,
    ) -> Result<Option<Written>, PackError> {
        let Some(mut picture) = picture else {
            return Ok(None);
        };
        self.made_of(self.about.size, &mut |rows| picture.next(rows), most)
    }

    /// The same of a broken picture, which is white.
    fn white(&self) -> Result<Option<Written>, PackError> {
        let mut texel = Some(vec![[255; 4]]);
        let mut next = |_: u32| Some(texel.take().unwrap_or_default());
        self.made_of([1, 1], &mut next, u64::MAX)
    }

    fn made_of(
        &self,
        size: [u32; 2],
        next: &mut dyn FnMut(u32) -> Option<Vec<[u8; 4]>>,
        most: u64,
    ) -> Result<Option<Written>, PackError> {
        let shape = TextureShape { size };
        let planned = self.planned(&shape);
        let maker = PlannedPages {
            texture: self,
            shape,
            planned: &planned,
        };
        let mut pyramid = PageLevels::new(&maker, shape, self.about.wrap);
        let mut pages: Vec<BuiltPage> = Vec::new();
        let mut bytes = 0;
        loop {
            let Some(mut rows) = next(BAND_ROWS) else {
                return Ok(None);
            };
            if rows.is_empty() {
                break;
            }
            if self.about.cutoff.is_none() {
                rows.par_iter_mut().for_each(|it| it[3] = 255);
            }
            pyramid.push(rows)?;
            let made = pyramid.take_made();
            bytes += payload_bytes(&made);
            pages.extend(made);
            if bytes > most {
                return Ok(None);
            }
        }
        let [r, g, b, _] = pyramid.mean();
        let halving = Halving::default();
        let told = SceneTexture {
            name: String::new(),
            size,
            wrap: self.about.wrap,
            colour: [r, g, b].map(|it| halving.light(it)),
            cutoff: self.about.cutoff,
        };
        Ok(Some((told, linked(pages))))
    }

    /// The pages of each level, finest first; each in order.
    fn planned(&self, shape: &TextureShape) -> Vec<BTreeMap<PagePlace, ShownRegion>> {
        let is_there = |page: &PagePlace| shape.page_size(*page).is_some();
        let mut level = self.seen.regions.clone();
        if !level.keys().all(is_there) {
            // The picture is broken: one page has all.
            let all: Vec<ShownRegion> = level.values().copied().collect();
            level = BTreeMap::from([(PagePlace::default(), round(&all))]);
        }
        let mut levels = Vec::new();
        for _ in 0..shape.root() {
            let mut coarser: BTreeMap<PagePlace, Vec<ShownRegion>> = BTreeMap::new();
            for (page, region) in &level {
                coarser.entry(page.coarser()).or_default().push(*region);
            }
            let coarser = coarser.into_iter().map(|(page, all)| (page, round(&all)));
            let finer = std::mem::replace(&mut level, coarser.collect());
            levels.push(finer);
        }
        levels.push(level);
        levels
    }

    fn page(
        &self,
        shape: &TextureShape,
        (place, region): (PagePlace, &ShownRegion),
        picture: &TexturePicture,
    ) -> Result<BuiltPage, PackError> {
        let failed = |found| PackError {
            field: "page of a texture".to_owned(),
            found,
            expected: "a file".to_owned(),
        };
        let jpeg = match self.exact || self.about.cutoff.is_some() {
            true => None,
            false => Some(jpeg_of(picture).map_err(failed)?),
        };
        let (codec, file) = match jpeg.filter(|file| comes_back(file, picture)) {
            Some(file) => (PageCodec::Jpeg, file),
            None => {
                let file = png_of(picture, self.about.cutoff.is_some());
                (PageCodec::Png, file.map_err(failed)?)
            }
        };
        let is_root = place.level == shape.root();
        let texel_of_coarser = region.texel * f64::from(1_u32 << (place.level + 1));
        let [columns, rows] = shape.page_size(place).unwrap_or_default();
        Ok(BuiltPage {
            place,
            coarser: None,
            row: UnitRow {
                kind: UnitKind::Image,
                object: self.seen.object,
                centre: region.sphere.centre,
                radius: region.sphere.radius,
                error: if is_root {
                    f32::INFINITY
                } else {
                    texel_of_coarser as f32
                },
                signature: if is_root {
                    Signature::default()
                } else {
                    signature(picture)
                },
                samples: columns * rows,
                ..UnitRow::default()
            },
            payload: page_bytes(self.number, place, codec, &file),
        })
    }
}

/// All pages, coarsest level first, each with the one that it lies in.
fn linked(mut pages: Vec<BuiltPage>) -> Vec<BuiltPage> {
    pages.sort_by_key(|it| (Reverse(it.place.level), it.place));
    let numbers: BTreeMap<PagePlace, usize> = pages.iter().map(|it| it.place).zip(0..).collect();
    for page in &mut pages {
        page.coarser = numbers.get(&page.place.coarser()).copied();
    }
    pages
}

fn signature(picture: &TexturePicture) -> Signature {
    let rgb: Vec<[u8; 3]> = picture
        .texels
        .iter()
        .map(|[r, g, b, _]| [*r, *g, *b])
        .collect();
    let [width, height] = picture.size;
    let grey = Picture {
        width,
        height,
        planes: [grey_from_rgb(&rgb), Vec::new(), Vec::new()],
    };
    signature_of(&grey, GREY, 2)
}

fn rgb_of(picture: &TexturePicture) -> Vec<u8> {
    let texels = picture.texels.iter();
    texels.flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
}

fn jpeg_of(picture: &TexturePicture) -> Result<Vec<u8>, String> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, JPEG_QUALITY);
    encoder.set_sampling_factor(SamplingFactor::R_4_4_4);
    encoder.set_optimized_huffman_tables(true);
    // A page with its border has at most 258 texels along a side.
    let [columns, rows] = picture.size.map(|side| side as u16);
    let written = encoder.encode(&rgb_of(picture), columns, rows, ColorType::Rgb);
    written.map_err(|error| error.to_string())?;
    Ok(file)
}

/// Whether the decoder that shows a JPEG makes the picture of it again: of plain pictures with next
/// to no bytes it loses the last blocks.
fn comes_back(file: &[u8], picture: &TexturePicture) -> bool {
    let all = picture.size[0] * picture.size[1];
    let decoded = PictureRows::open(file).and_then(|mut rows| {
        let mut texels = Vec::new();
        while texels.len() < all as usize {
            texels.extend(rows.next(BLOCK as u32).filter(|some| !some.is_empty())?);
        }
        Some(texels)
    });
    let Some(decoded) = decoded.filter(|it| it.len() == all as usize) else {
        return false;
    };
    let columns = picture.size[0] as usize;
    let mut errors = BTreeMap::<[usize; 2], [u32; 2]>::new();
    for (at, (is, was)) in decoded.iter().zip(&picture.texels).enumerate() {
        let block = errors
            .entry([at / columns / BLOCK, at % columns / BLOCK])
            .or_default();
        let off = (0..3).map(|k| u32::from(is[k].abs_diff(was[k])));
        block[0] += off.sum::<u32>();
        block[1] += 3;
    }
    errors.values().all(|[off, of]| *off <= MOST_OFF * of)
}

fn png_of(picture: &TexturePicture, has_alpha: bool) -> Result<Vec<u8>, String> {
    let [columns, rows] = picture.size;
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, columns, rows);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let (kind, texels) = match has_alpha {
        true => (png::ColorType::Rgba, picture.bytes().to_vec()),
        false => (png::ColorType::Rgb, rgb_of(picture)),
    };
    encoder.set_color(kind);
    let write = || {
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&texels)?;
        writer.finish()
    };
    write().map_err(|error: png::EncodingError| error.to_string())?;
    Ok(file)
}
