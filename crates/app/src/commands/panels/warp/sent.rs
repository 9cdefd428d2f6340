//! Where in one atlas is each panel's picture, as it is sent and as it is seen?

use foveal_core::view::panel::rig::Panel;
use foveal_render::RgbaImage;
use glam::DVec3;

/// The surfaces of a rig, side by side in one atlas.
pub(crate) struct SentLayout {
    /// First column and row of each panel.
    pub(crate) origins: Vec<[u32; 2]>,
    /// Name, first column, width and height of each surface.
    surfaces: Vec<(String, u32, [u32; 2])>,
}

impl SentLayout {
    pub(crate) fn of(panels: &[&Panel]) -> Self {
        let mut sizes: Vec<(String, [u32; 2])> = Vec::new();
        for panel in panels {
            let name = &panel.output.surface;
            let at = sizes.iter().position(|(known, _)| known == name);
            let at = at.unwrap_or_else(|| {
                sizes.push((name.clone(), [0; 2]));
                sizes.len() - 1
            });
            let sent = panel.sent_size();
            let end = [panel.output.x + sent[0], panel.output.y + sent[1]];
            let size = &mut sizes[at].1;
            *size = [0, 1].map(|k| size[k].max(end[k]));
        }
        let mut first = 0;
        let mut surfaces = Vec::new();
        for (name, size) in sizes {
            surfaces.push((name, first, size));
            first += size[0];
        }
        let origin = |panel: &&Panel| {
            let surface = surfaces.iter().find(|it| it.0 == panel.output.surface);
            let first = surface.map_or(0, |it| it.1);
            [first + panel.output.x, panel.output.y]
        };
        Self {
            origins: panels.iter().map(origin).collect(),
            surfaces,
        }
    }

    /// Name of each surface, with its first column, its columns and its rows.
    pub(super) fn parts(&self) -> impl Iterator<Item = (&str, [u32; 3])> {
        let surfaces = self.surfaces.iter();
        surfaces.map(|(name, first, [w, h])| (name.as_str(), [*first, *w, *h]))
    }

    /// File name, without its ending, and picture of each surface.
    pub(super) fn surfaces(&self, atlas: &RgbaImage) -> Vec<(String, RgbaImage)> {
        let several = self.surfaces.len() > 1;
        let one = |(name, first, size): &(String, u32, [u32; 2])| {
            let file = match several {
                true => format!("atlas-{name}"),
                false => "atlas".to_owned(),
            };
            (file, part(atlas, [*first, 0], *size))
        };
        self.surfaces.iter().map(one).collect()
    }
}

/// A part of a picture, black where the picture has none.
fn part(image: &RgbaImage, origin: [u32; 2], size: [u32; 2]) -> RgbaImage {
    let mut out = RgbaImage::black(size);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let at = [x + origin[0], y + origin[1]];
            if (0..2).all(|k| at[k] < image.size[k]) {
                out.set_pixel([x, y], image.pixel(at));
            }
        }
    }
    out
}

/// What the eye sees of a panel whose picture is sent at a place of the atlas.
pub(super) fn as_seen(panel: &Panel, atlas: &RgbaImage, origin: [u32; 2]) -> RgbaImage {
    let sent_from_seen = panel.scanout.seen_from_sent(panel.view.size).inverse();
    let mut out = RgbaImage::black(panel.view.size);
    for y in 0..out.size[1] {
        for x in 0..out.size[0] {
            let seen = DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0);
            let sent = sent_from_seen * seen;
            let at = [sent.x as u32 + origin[0], sent.y as u32 + origin[1]];
            out.set_pixel([x, y], atlas.pixel(at));
        }
    }
    out
}
