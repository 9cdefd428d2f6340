//! Where does the source lie before panels, and what part of it does each eye see?

use super::args::{MOST_PROBES, StereoName, WarpArgs, WarpModeName};
use super::sent::SentLayout;
use super::source::{EyePart, PanelSource};
use crate::commands::panels::rig_args::{PlacementName, source_size};
use crate::options::panels::tell_part;
use crate::report::output::{WrongUsage, say};
use anyhow::bail;
use foveal_core::view::panel::fit::{SourceFit, SourceSize};
use foveal_core::view::panel::pixel_map::PixelMap;
use foveal_core::view::panel::rig::{Panel, Rig};
use foveal_core::view::panel::seed::SeedTexel;
use foveal_core::view::panel::share::multi_probe_share;
use foveal_core::view::surface::Eye;
use foveal_render::warp::{PanelOnSource, WarpPlan};
use glam::DVec3;

/// Where each panel's part of the source lies.
pub(super) struct Laid {
    pub(super) placement: &'static str,
    pub(super) size: [u32; 2],
    /// Columns and rows that are needed, where a world has as many as that or as can be drawn.
    pub(super) need: Option<[u32; 2]>,
    pub(super) parts: Vec<EyePart>,
}

impl WarpArgs {
    /// Refuses what this source has no use for.
    pub(super) fn check_source(&self, source: &PanelSource) -> anyhow::Result<()> {
        let is_world = source.world().is_some();
        let wrong = |text: String| Err(WrongUsage(text).into());
        match source.size() {
            Some([w, h]) if self.source.is_some() => wrong(format!(
                "--source: {} has its own size, {w}x{h}; leave it out",
                self.source_name
            )),
            _ if self.compare && !is_world => wrong(format!(
                "--compare: {} is a picture already and cannot be drawn directly; give \
                 world:valley or world:gratings",
                self.source_name
            )),
            _ if self.compare && self.show_anisotropy => wrong(
                "--compare: --show-anisotropy paints over what is compared; leave one".to_owned(),
            ),
            _ if is_world && self.stereo != StereoName::Mono => {
                wrong("--stereo: a world is drawn for each eye; leave it out".to_owned())
            }
            _ => Ok(()),
        }
    }

    /// Places a source of a size, or of any, before panels.
    fn fit(&self, rig: &Rig, panels: &[&Panel], source: SourceSize) -> anyhow::Result<SourceFit> {
        let mut args = self.rig.clone();
        if self.mode.is_some() && args.placement == PlacementName::Auto {
            args.placement = PlacementName::Seed;
        }
        args.fit(rig, panels, source)
    }

    /// Places the source before the eyes: a world for each by itself, no larger than `most` on a
    /// side unless its size is given, a file before all panels.
    pub(super) fn lay(
        &self,
        rig: &Rig,
        panels: &[&Panel],
        (source, most): (&PanelSource, u32),
    ) -> anyhow::Result<Laid> {
        if panels.is_empty() {
            bail!(WrongUsage(format!(
                "{}: no panel is seen by this eye; choose another --eye",
                self.rig.rig.display()
            )));
        }
        let mut laid = match source.size() {
            Some(size) => self.lay_file(rig, panels, size)?,
            None => self.lay_world(rig, panels, most)?,
        };
        if let Some(distance) = self.distance {
            for it in &mut laid.parts {
                let side = match it.eye {
                    Eye::Left => -0.5,
                    Eye::Right => 0.5,
                };
                let eye = DVec3::X * (side * rig.ipd);
                it.placement = it.placement.seen_from(eye, distance);
            }
        }
        Ok(laid)
    }

    fn lay_file(&self, rig: &Rig, panels: &[&Panel], size: [u32; 2]) -> anyhow::Result<Laid> {
        let [w, h] = size;
        let parts = match self.stereo {
            StereoName::Mono => [[0, 0, w, h]; 2],
            StereoName::Sbs => [[0, 0, w / 2, h], [w / 2, 0, w / 2, h]],
            StereoName::Tb => [[0, 0, w, h / 2], [0, h / 2, w, h / 2]],
        };
        if parts[0].contains(&0) && parts[0][2..].contains(&0) {
            bail!(
                "{}: {w}x{h} pixels have no two halves; leave --stereo",
                self.source_name
            );
        }
        let found = self.fit(rig, panels, SourceSize::Picture([parts[0][2], parts[0][3]]))?;
        tell_part(panels, &found.placement, [parts[0][2], parts[0][3]]);
        let eyes = [Eye::Left, Eye::Right];
        let part = |(eye, part)| EyePart {
            eye,
            placement: found.placement,
            part,
        };
        Ok(Laid {
            placement: found.name,
            size,
            need: None,
            parts: eyes.into_iter().zip(parts).map(part).collect(),
        })
    }

    fn lay_world(&self, rig: &Rig, panels: &[&Panel], most: u32) -> anyhow::Result<Laid> {
        let size = source_size(self.source.as_deref())?;
        let mut fits: Vec<(Eye, SourceFit)> = Vec::new();
        for eye in [Eye::Left, Eye::Right] {
            let of_eye = panels.iter().copied().filter(|it| it.view.eye == eye);
            let of_eye: Vec<&Panel> = of_eye.collect();
            if !of_eye.is_empty() {
                fits.push((eye, self.fit(rig, &of_eye, size)?));
            }
        }
        // One below another: sources are wider than high, and devices draw squares.
        let stacked = |all: &[(Eye, SourceFit)]| {
            let sizes = all.iter().map(|(_, it)| it.size);
            sizes.fold([0; 2], |[w, h], [own_w, own_h]| [w.max(own_w), h + own_h])
        };
        let need = (size == SourceSize::Needed).then(|| stacked(&fits));
        if let Some([w, h]) = need
            && w.max(h) > most
        {
            let share = f64::from(most) / f64::from(w.max(h));
            for (_, it) in &mut fits {
                it.size = it
                    .size
                    .map(|side| ((f64::from(side) * share) as u32).max(1));
            }
        }
        let mut top = 0;
        let parts = fits.iter().map(|(eye, it)| {
            let [w, h] = it.size;
            top += h;
            EyePart {
                eye: *eye,
                placement: it.placement,
                part: [0, top - h, w, h],
            }
        });
        Ok(Laid {
            placement: fits.last().map_or("", |(_, it)| it.name),
            parts: parts.collect(),
            size: stacked(&fits),
            need,
        })
    }

    /// Says where a world is drawn smaller than panels could show.
    pub(super) fn tell_shrunk(&self, laid: &Laid) {
        let Some(need) = laid.need.filter(|need| *need != laid.size) else {
            return;
        };
        let ([w, h], [nw, nh]) = (laid.size, need);
        let by = [0, 1].map(|k| f64::from(need[k]) / f64::from(laid.size[k]));
        let instead = match self.window {
            true => "",
            false => "; --renderer cpu draws all of them",
        };
        say(&format!(
            "the source has {w}x{h} of the {nw}x{nh} pixels that are needed: this device holds no \
             larger one, and panels magnify it up to {:.2} times{instead}",
            by[0].max(by[1])
        ));
    }

    pub(super) fn plan(&self, panels: &[&Panel], laid: &Laid, layout: &SentLayout) -> WarpPlan {
        let placed: Vec<PanelOnSource<'_>> = panels
            .iter()
            .zip(&layout.origins)
            .map(|(panel, origin)| PanelOnSource {
                panel,
                placement: &laid.of(panel).placement,
                part: laid.of(panel).part,
                origin: *origin,
            })
            .collect();
        let plan = WarpPlan::new(&placed);
        match self.mode {
            None => match self.eye.blur() {
                Some(eye) => plan.seen_blurred(&placed, &eye),
                None => plan,
            },
            Some(WarpModeName::Seed) => {
                let maps: Vec<Vec<SeedTexel>> = placed.iter().map(seed_map).collect();
                plan.by_seed_maps(&maps.iter().map(Vec::as_slice).collect::<Vec<_>>())
            }
        }
    }
}

/// The seed's texels of a panel, in the order in which its pixels are sent.
pub(in crate::commands::panels) fn seed_map(it: &PanelOnSource<'_>) -> Vec<SeedTexel> {
    let [left, top, width, height] = it.part;
    let map = PixelMap {
        panel: it.panel,
        placement: it.placement,
        size: [width, height],
    };
    let back = it.panel.scanout.seen_from_sent(it.panel.view.size);
    let [columns, rows] = it.panel.sent_size();
    let pixels = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    let texel = |[column, row]: [u32; 2]| {
        let seen = back * DVec3::new(f64::from(column) + 0.5, f64::from(row) + 0.5, 1.0);
        let mut texel = SeedTexel::of(&map, [seen.x as u32, seen.y as u32]);
        // The part of this eye.
        let from = [left, top].map(|k| u16::try_from(k).unwrap_or(u16::MAX));
        texel.whole = [0, 1].map(|k| texel.whole[k].saturating_add(from[k]));
        texel
    };
    pixels.map(texel).collect()
}

impl Laid {
    /// The part that a panel looks at.
    pub(super) fn of(&self, panel: &Panel) -> &EyePart {
        let own = self.parts.iter().find(|it| it.eye == panel.view.eye);
        own.unwrap_or(&self.parts[0])
    }

    pub(super) fn multi_probe_share(&self, panels: &[&Panel]) -> f64 {
        let (mut several, mut pixels) = (0.0, 0.0);
        for panel in panels {
            let it = self.of(panel);
            let size = [it.part[2], it.part[3]];
            let share = multi_probe_share(&[*panel], &it.placement, size, MOST_PROBES);
            several += share * panel.pixels();
            pixels += panel.pixels();
        }
        several / pixels
    }
}
