//! Which textured mesh do the tests draw? A plate of two triangles, or two plates side by side.

use foveal_core::content::images::halving::Halving;
use foveal_core::content::images::payload::ImagePage;
use foveal_core::content::images::picture::TexturePicture;
use foveal_core::content::images::shape::{PagePlace, TextureShape};
use foveal_core::content::images::wrap::Wrap;
use foveal_core::content::mesh::payload::{Attributes, Cluster, MeshUnit, MeshVertex};
use foveal_core::content::payload::PayloadView;
use foveal_core::content::scene::description::{Grid, SceneObject, SceneTexture, Shape, Texturing};
use foveal_core::pack::unit::UnitId;
use foveal_render::Coming;
use glam::DAffine3;

/// Places of the grid along a side of a plate, and of places on textures.
const PLACES: u16 = 1000;
/// The first unit of pages.
pub const FIRST_PAGE: u32 = 10;

/// Vertices have normals and places on textures.
pub const TEXTURED: Attributes = Attributes {
    normals: false,
    colours: false,
    textured: true,
};

/// Plates of 1 m next to each other, each with the texture of its number, all of which is seen
/// `times` along each axis; seen from the front, with its top at the top.
pub fn plates(count: u8) -> MeshUnit {
    let mut unit = MeshUnit::default();
    for texture in 0..count {
        let vertex = |[x, y]: [u16; 2]| MeshVertex {
            place: [u16::from(texture) * PLACES + x * PLACES, y * PLACES, 0],
            uv: [x * PLACES, (1 - y) * PLACES],
            texture,
            ..MeshVertex::default()
        };
        let first = unit.vertices.len() as u16;
        unit.vertices
            .extend([[0, 0], [1, 0], [1, 1], [0, 1]].map(vertex));
        unit.clusters.push(Cluster {
            vertices: (first..first + 4).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        });
    }
    unit
}

/// What shows plates, from x = 0 and y = 0 on, whose textures repeat so often.
pub fn object(textures: u16, times: f64) -> SceneObject {
    SceneObject {
        name: "plate".to_owned(),
        shape: Shape::Mesh {
            leaf_triangles: 2 * u64::from(textures),
        },
        bounds: Default::default(),
        grid: Grid {
            origin: [0.0; 3],
            step: 1.0 / f64::from(PLACES),
            bits: 12,
        },
        attributes: TEXTURED,
        colour: [1.0; 4],
        two_sided: false,
        unlit: true,
        placements: vec![DAffine3::IDENTITY.to_cols_array()],
        texturing: Some(Texturing {
            textures: (0..textures).collect(),
            origin: [0.0; 2],
            step: [times / f64::from(PLACES); 2],
        }),
    }
}

/// What is known of a texture.
pub fn texture(picture: &TexturePicture, wrap: Wrap) -> SceneTexture {
    SceneTexture {
        name: "plate".to_owned(),
        size: picture.size,
        wrap: [wrap; 2],
        colour: [0.5, 0.25, 0.125],
        cutoff: None,
    }
}

/// Squares of so many texels in two colours, with a gradient over all, so that each place differs.
pub fn checker(size: [u32; 2], side: u32) -> TexturePicture {
    let texel = |column: u32, row: u32| {
        let is_light = (column / side + row / side).is_multiple_of(2);
        let [x, y] = [column * 200 / size[0], row * 200 / size[1]];
        let base = if is_light { 55 } else { 0 };
        [
            base + x as u8,
            base + y as u8,
            if is_light { 230 } else { 40 },
            255,
        ]
    };
    let rows = (0..size[1]).flat_map(|row| (0..size[0]).map(move |column| texel(column, row)));
    TexturePicture {
        size,
        texels: rows.collect(),
    }
}

/// A page with its unit and what it needs.
pub struct PlatePage {
    pub unit: UnitId,
    pub needs: Vec<UnitId>,
    pub page: ImagePage,
}

impl PlatePage {
    pub fn coming(&self) -> Coming<'_> {
        Coming {
            unit: self.unit,
            object: 0,
            level: self.page.page.level,
            needs: &self.needs,
            part: None,
            payload: PayloadView::Image(&self.page),
        }
    }
}

/// All pages of a texture, coarsest first; units count from `first`.
pub fn pages(
    number: u16,
    about: &SceneTexture,
    picture: &TexturePicture,
    first: u32,
) -> Vec<PlatePage> {
    let shape = TextureShape { size: picture.size };
    let mut levels = vec![picture.clone()];
    for _ in 0..shape.root() {
        let coarser = Halving::default().halved(levels.last().unwrap());
        levels.push(coarser);
    }
    let mut pages: Vec<PlatePage> = Vec::new();
    for (level, whole) in (0..=shape.root()).zip(&levels).rev() {
        let [columns, rows] = shape.pages(level).map(|it| it as u16);
        for place in (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row])) {
            let page = PagePlace { level, place };
            let needs = pages.iter().filter(|it| it.page.page == page.coarser());
            let needs = needs.map(|it| it.unit).collect();
            pages.push(PlatePage {
                unit: UnitId(first + pages.len() as u32),
                needs,
                page: ImagePage {
                    texture: number,
                    page,
                    picture: shape.cut(whole, page, about.wrap),
                },
            });
        }
    }
    pages
}
