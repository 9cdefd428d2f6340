//! Where should the source lie, and how many pixels of it does each panel use?

use super::drawn_grid::DrawnGrid;
use super::pixel_map::PixelMap;
use super::placement::{Placement, SourceProjection};
use super::placing::curved::best_curved;
use super::placing::plane::{best_plane, least_sigma};
use super::placing::samples::{PanelSamples, cone_of};
use super::rig::Panel;
use super::seed::SeedPlane;
use super::share::seen_share;
use crate::view::axes::Axes;
use glam::DVec3;

/// Cones of panels up to this half angle (65°) get a plane by default, in radians.
pub const WIDEST_PLANE: f64 = 1.134_464_013_796_314_4;
/// Inner pixels along a side while searching, and to judge by at last.
const SEARCHED: u32 = 9;
const JUDGED: u32 = 65;
/// Minified by less than this nothing is: sizes are whole.
const EVEN: f64 = 1.01;

/// How the source is placed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PlacementRule {
    /// A plane while the panels are within a cone of 65°, else the curved source that needs least.
    #[default]
    Auto,
    /// Square to the head and centred, as Strege 2009 has it.
    Seed,
    /// The plane that needs the fewest pixels.
    Plane,
    /// A cylinder round the head.
    Cylinder,
    /// A sphere round the head, in azimuth and elevation.
    Equirect,
    /// A flat screen straight ahead of this width and height, seen or not.
    Screen([f64; 2]),
}

/// Why no source can be placed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// There is no panel to place it before.
    #[error("no panel is before this eye; choose another --eye")]
    NoPanel,
    /// A place of it lies at 90° or more from where the source would lie, of the best plane at 85°.
    #[error(
        "panel {panel}: it looks too far away from a {placement} source's axis, where that has no \
         place; use --placement {works}"
    )]
    Beyond {
        /// The panel's id.
        panel: String,
        /// What was asked for.
        placement: &'static str,
        /// What works.
        works: &'static str,
    },
    /// Nothing of the panels is lit.
    #[error("panel {panel}: no place of it is lit; check its distortion")]
    Unlit {
        /// The panel's id.
        panel: String,
    },
}

/// How a panel's pixels are best taken from the source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelFilter {
    /// Nothing is minified: smooth between source pixels.
    Bicubic,
    /// Minified evenly.
    Trilinear,
    /// Minified more along one direction than across.
    Anisotropic,
}

impl PanelFilter {
    /// What it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Bicubic => "bicubic",
            Self::Trilinear => "trilinear",
            Self::Anisotropic => "anisotropic",
        }
    }
}

/// What a panel gets of the source.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelFit {
    /// Square root of source pixels it covers over its own.
    pub density: f64,
    /// The least factor by which a step on the panel grows in the source.
    pub sigma_min: f64,
    /// The largest.
    pub sigma_max: f64,
    /// What that asks for.
    pub filter: PanelFilter,
}

/// Where the source lies and what that costs.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFit {
    /// Where it lies.
    pub placement: Placement,
    /// What was chosen: seed, plane, cylinder, equirect or screen.
    pub name: &'static str,
    /// z, in its own axes, of the farthest corner that a plane is cut at; it changes no place.
    pub depth: Option<f64>,
    /// Columns and rows at which no panel pixel is magnified, as computed.
    pub need: [f64; 2],
    /// The source's size: as given, else as needed.
    pub size: [u32; 2],
    /// Share of the source that is seen.
    pub seen_share: f64,
    /// How far the grids of residuals that are drawn by are from the distortion at most, in source
    /// pixels.
    pub map_error: f64,
    /// Of each panel, in order.
    pub panels: Vec<PanelFit>,
}

/// Columns and rows of a source that is placed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SourceSize {
    /// As many as are needed.
    #[default]
    Needed,
    /// So many, drawn for the window: pixels need not be square. Only the seed's placement, which
    /// is the seed's, keeps their aspect.
    Drawn([u32; 2]),
    /// Those of a picture that is there, which no placement stretches.
    Picture([u32; 2]),
}

impl From<Option<[u32; 2]>> for SourceSize {
    fn from(size: Option<[u32; 2]>) -> Self {
        size.map_or(Self::Needed, Self::Drawn)
    }
}

impl SourceSize {
    /// The size, where one is given.
    #[must_use]
    pub fn told(self) -> Option<[u32; 2]> {
        match self {
            Self::Needed => None,
            Self::Drawn(size) | Self::Picture(size) => Some(size),
        }
    }

    /// Width over height that a window must have.
    fn aspect(self, rule: PlacementRule) -> Option<f64> {
        let is_kept = rule == PlacementRule::Seed || matches!(self, Self::Picture(_));
        let size = self.told().filter(|_| is_kept);
        size.map(|[w, h]| f64::from(w) / f64::from(h))
    }
}

/// Places a source before panels, and judges that.
pub fn fit(
    panels: &[&Panel],
    rule: PlacementRule,
    source: impl Into<SourceSize>,
) -> Result<SourceFit, FitError> {
    let source = source.into();
    let (placement, name) = place(panels, rule, source)?;
    let source = source.told();
    let judged = sampled(panels, JUDGED)?;
    let sigma = least_sigma(&judged, &placement).ok_or_else(|| beyond(&judged, name))?;
    let need = placement.extent().map(|side| side / sigma);
    let size = source.unwrap_or(need.map(|side| libm::ceil(side - 1e-6).max(1.0) as u32));
    let fits = judged.iter().map(|it| panel_fit(it, &placement, size));
    let errors = panels.iter().map(|panel| {
        let drawn = DrawnGrid::of(panel, &placement);
        drawn.map_or(0.0, |it| it.error(panel, &placement, size))
    });
    Ok(SourceFit {
        placement,
        name,
        depth: depth(&judged, &placement),
        need,
        size,
        seen_share: seen_share(panels, &placement, size),
        map_error: errors.fold(0.0, f64::max),
        panels: fits.collect(),
    })
}

/// Where a source lies by a rule, and what the rule chose.
pub fn place(
    panels: &[&Panel],
    rule: PlacementRule,
    source: impl Into<SourceSize>,
) -> Result<(Placement, &'static str), FitError> {
    let all = sampled(panels, SEARCHED)?;
    let aspect = source.into().aspect(rule);
    let curved = |projection| best_curved(&all, projection, aspect);
    let (found, name) = match rule {
        PlacementRule::Seed => (seed(&all, aspect), "seed"),
        PlacementRule::Plane => (best_plane(&all, aspect), "plane"),
        PlacementRule::Cylinder => (curved(SourceProjection::Cylinder), "cylinder"),
        PlacementRule::Equirect => (curved(SourceProjection::Equirect), "equirect"),
        PlacementRule::Screen(size) => {
            let [x, y] = size.map(|side| side / 2.0);
            let window = [x, x, y, y];
            let screen = Placement::new(SourceProjection::Plane, Axes::FRONT, window);
            return Ok((screen, "screen"));
        }
        PlacementRule::Auto => {
            let (found, name) = auto(&all, aspect)?;
            return Ok((round_all(found, &all), name));
        }
    };
    let found = found.ok_or_else(|| beyond(&all, name))?;
    Ok((round_all(found, &all), name))
}

/// Round bent panels a source is wider by a millionth: the rim between places that were tried lies
/// within, too.
fn round_all(placement: Placement, all: &[PanelSamples<'_>]) -> Placement {
    if all.iter().all(|it| it.panel.distortion.is_none()) {
        return placement;
    }
    let [width, height] = placement.extent().map(|side| side * 1e-6);
    let [left, right, up, down] = placement.window;
    Placement {
        window: [left + width, right + width, up + height, down + height],
        ..placement
    }
}

fn sampled<'a>(panels: &[&'a Panel], count: u32) -> Result<Vec<PanelSamples<'a>>, FitError> {
    if panels.is_empty() {
        return Err(FitError::NoPanel);
    }
    let all = panels.iter().map(|panel| {
        let found = PanelSamples::of(panel, count);
        match found.rim.is_empty() || found.inner.is_empty() {
            true => Err(FitError::Unlit {
                panel: panel.id.clone(),
            }),
            false => Ok(found),
        }
    });
    all.collect()
}

/// Of the seed only corners count where nothing is bent; else all places that are mapped.
///
/// With a free aspect it is as narrow as it can be; the seed has 4:3 throughout.
fn seed(all: &[PanelSamples<'_>], aspect: Option<f64>) -> Option<Placement> {
    let mut places = Vec::new();
    for one in all {
        match one.panel.distortion.is_none() {
            true => places.extend(one.panel.corners()),
            false => places.extend(one.outer.iter().copied()),
        }
    }
    Some(SeedPlane::round(&places, aspect)?.placement())
}

fn auto(
    all: &[PanelSamples<'_>],
    aspect: Option<f64>,
) -> Result<(Placement, &'static str), FitError> {
    let (_, half) = cone_of(all);
    if half <= WIDEST_PLANE
        && let Some(plane) = best_plane(all, aspect)
    {
        return Ok((plane, "plane"));
    }
    let curved = [
        (SourceProjection::Cylinder, "cylinder"),
        (SourceProjection::Equirect, "equirect"),
    ];
    let found = curved.iter().filter_map(|&(projection, name)| {
        let placement = best_curved(all, projection, aspect)?;
        let [width, height] = placement.extent();
        let sigma = least_sigma(all, &placement)?;
        Some((placement, name, width * height / (sigma * sigma)))
    });
    let least = found.min_by(|a, b| a.2.total_cmp(&b.2));
    let (placement, name, _) = least.ok_or_else(|| beyond(all, "equirect"))?;
    Ok((placement, name))
}

/// Names the panel that reaches farthest from the axis that all share.
fn beyond(all: &[PanelSamples<'_>], placement: &'static str) -> FitError {
    let axis = match placement {
        "plane" => cone_of(all).0,
        _ => DVec3::NEG_Z,
    };
    let least = |one: &PanelSamples<'_>| {
        let depths = one.rim.iter().map(|ray| ray.dot(axis));
        depths.fold(f64::INFINITY, f64::min)
    };
    let worst = all.iter().min_by(|a, b| least(a).total_cmp(&least(b)));
    let (_, half) = cone_of(all);
    FitError::Beyond {
        panel: worst.map_or_else(String::new, |it| it.panel.id.clone()),
        placement,
        works: match placement {
            "seed" if half <= WIDEST_PLANE => "plane",
            _ => "equirect",
        },
    }
}

/// z of the farthest corner in the axes of a plane.
fn depth(all: &[PanelSamples<'_>], placement: &Placement) -> Option<f64> {
    if placement.projection != SourceProjection::Plane {
        return None;
    }
    let corners = all.iter().flat_map(|it| it.panel.corners());
    let depths = corners.map(|it| -it.dot(placement.axes.forward));
    Some(depths.fold(0.0, f64::min))
}

fn panel_fit(one: &PanelSamples<'_>, placement: &Placement, size: [u32; 2]) -> PanelFit {
    let map = PixelMap {
        panel: one.panel,
        placement,
        size,
    };
    let extent = placement.extent();
    let scale = [0, 1].map(|k| f64::from(size[k]) / extent[k]);
    let (mut sigma_min, mut sigma_max, mut stretched) = (f64::INFINITY, 0.0_f64, 1.0_f64);
    for found in one
        .inner
        .iter()
        .filter_map(|ray| ray.coordinates(placement))
    {
        let jacobian = [0, 1].map(|k| found.jacobian[k].map(|it| it * scale[k]));
        let [large, small] = super::pixel_map::singular_values(jacobian);
        sigma_min = sigma_min.min(small);
        sigma_max = sigma_max.max(large);
        stretched = stretched.max(large / small);
    }
    PanelFit {
        density: (covered(&map) / one.panel.pixels()).sqrt(),
        sigma_min,
        sigma_max,
        filter: match () {
            () if sigma_max <= EVEN => PanelFilter::Bicubic,
            () if stretched < 1.5 => PanelFilter::Trilinear,
            () => PanelFilter::Anisotropic,
        },
    }
}

/// Source pixels that a panel covers: the Jacobian's determinant over it, by Gauss's rule of two
/// points in 32 x 32 parts.
#[must_use]
pub fn covered(map: &PixelMap<'_>) -> f64 {
    const PARTS: u32 = 32;
    let size = map.panel.view.size.map(f64::from);
    let nodes = |side: f64| {
        let step = side / f64::from(PARTS);
        let off = step / (2.0 * 3.0_f64.sqrt());
        (0..PARTS).flat_map(move |k| {
            let middle = (f64::from(k) + 0.5) * step;
            [middle - off, middle + off]
        })
    };
    let all = nodes(size[1]).flat_map(|y| nodes(size[0]).map(move |x| [x, y]));
    let areas = all.filter_map(|place| map.at(place)).map(|found| {
        let [[a, b], [c, d]] = found.jacobian;
        (a * d - b * c).abs()
    });
    let parts = f64::from(4 * PARTS * PARTS);
    areas.sum::<f64>() * size[0] * size[1] / parts
}
