//! What does a rig file say of a panel's optics?

use std::sync::Arc;

use foveal_core::view::eye_view::EyeView;
use foveal_core::view::panel::distortion::Distortion;
use foveal_core::view::panel::lens::{BrownConrady, Bulge, RadialPolynomial};
use foveal_core::view::panel::residual_grid::ResidualGrid;

use super::entries::{BulgeSign, ChannelEntry, DistortionEntry, DistortionModel};
use super::error::WrongKey;
use super::pfm::{self, ReadBeside};

/// Largest number of a lens.
const LARGEST: f64 = 1e6;
/// Most coefficients of a polynomial, and points of a grid.
const MOST_COEFFICIENTS: usize = 32;
const MOST_POINTS: usize = 1 << 22;
/// Places along a side at which a map is looked for folds.
const TRIED: u32 = 129;

/// The distortion of an entry, which folds nowhere.
pub(super) fn distortion(
    entry: Option<&DistortionEntry>,
    view: &EyeView,
    key: &str,
    read: ReadBeside<'_>,
) -> Result<Distortion, WrongKey> {
    let Some(entry) = entry else {
        return Ok(Distortion::None);
    };
    let key = format!("{key}.distortion");
    check_keys(entry, &key)?;
    let lens = Lens {
        entry,
        view,
        key: &key,
        read,
    };
    let found = match entry.model {
        DistortionModel::Bulge => lens.bulge()?,
        DistortionModel::Polynomial => Distortion::Polynomial(Box::new(
            lens.each(|channel, key| lens.polynomial(channel, key))?,
        )),
        DistortionModel::BrownConrady => Distortion::BrownConrady(Box::new(
            lens.each(|channel, key| lens.brown(channel, key))?,
        )),
        DistortionModel::Grid => Distortion::Grid(lens.grids(|it, key| lens.grid(it, key))?),
        DistortionModel::Pfm => Distortion::Grid(lens.grids(|it, key| lens.map(it, key))?),
    };
    check_folds(&found, view, &key)?;
    Ok(found)
}

/// Refuses keys that belong to another model.
fn check_keys(entry: &DistortionEntry, key: &str) -> Result<(), WrongKey> {
    use DistortionModel::{BrownConrady, Bulge, Grid, Pfm, Polynomial};
    let channels = [&entry.red, &entry.green, &entry.blue];
    let has = |own: bool, of: fn(&ChannelEntry) -> bool| {
        own || channels.iter().any(|it| it.as_ref().is_some_and(of))
    };
    let there: [(&str, bool, &[DistortionModel]); 9] = [
        ("b", entry.b.is_some(), &[Bulge]),
        ("sign", entry.sign.is_some(), &[Bulge]),
        (
            "centre",
            has(entry.centre.is_some(), |it| it.centre.is_some()),
            &[Polynomial, BrownConrady],
        ),
        (
            "coefficients",
            has(entry.coefficients.is_some(), |it| it.coefficients.is_some()),
            &[Polynomial],
        ),
        (
            "k",
            has(entry.k.is_some(), |it| it.k.is_some()),
            &[BrownConrady],
        ),
        (
            "p",
            has(entry.p.is_some(), |it| it.p.is_some()),
            &[BrownConrady],
        ),
        (
            "columns",
            entry.columns.is_some() || entry.rows.is_some(),
            &[Grid],
        ),
        (
            "points",
            has(entry.points.is_some(), |it| it.points.is_some()),
            &[Grid],
        ),
        (
            "file",
            has(entry.file.is_some(), |it| it.file.is_some()),
            &[Pfm],
        ),
    ];
    for (name, is_there, models) in there {
        if is_there && !models.contains(&entry.model) {
            let what = format!("model {:?} has no {name}", entry.model);
            return Err(WrongKey::new(format!("{key}.{name}"), what));
        }
    }
    let given = channels.iter().filter(|it| it.is_some()).count();
    let is_bulge = entry.model == Bulge;
    if given != 0 && (given != 3 || is_bulge) {
        let what = match is_bulge {
            true => "a bulge is the same for all colours",
            false => "red, green and blue are given together or not at all",
        };
        return Err(WrongKey::new(key, what));
    }
    Ok(())
}

/// An entry that is read for a view.
struct Lens<'a> {
    entry: &'a DistortionEntry,
    view: &'a EyeView,
    key: &'a str,
    read: ReadBeside<'a>,
}

impl Lens<'_> {
    fn wrong<T>(&self, name: &str, what: impl Into<String>) -> Result<T, WrongKey> {
        Err(WrongKey::new(format!("{}{name}", self.key), what))
    }

    fn bulge(&self) -> Result<Distortion, WrongKey> {
        let Some(b) = self.entry.b.filter(|it| it.abs() <= LARGEST) else {
            return self.wrong(".b", "it needs a height");
        };
        let height = match self.entry.sign {
            Some(BulgeSign::TowardEye) => b,
            Some(BulgeSign::AwayFromEye) => -b,
            None => return self.wrong(".sign", "it needs \"toward-eye\" or \"away-from-eye\""),
        };
        Ok(Distortion::Bulge(Bulge { height }))
    }

    /// What red, green and blue say, each filled up from what all share.
    fn channels(&self) -> [(ChannelEntry, String); 3] {
        let entry = self.entry;
        let all = [
            ("red", &entry.red),
            ("green", &entry.green),
            ("blue", &entry.blue),
        ];
        all.map(|(name, own)| {
            let own = own.clone();
            let key = match own.is_some() {
                true => format!(".{name}"),
                false => String::new(),
            };
            let own = own.unwrap_or_default();
            let filled = ChannelEntry {
                centre: own.centre.or(entry.centre),
                coefficients: own.coefficients.or_else(|| entry.coefficients.clone()),
                k: own.k.or(entry.k),
                p: own.p.or(entry.p),
                points: own.points.or_else(|| entry.points.clone()),
                file: own.file.or_else(|| entry.file.clone()),
            };
            (filled, key)
        })
    }

    fn each<T>(
        &self,
        one: impl Fn(&ChannelEntry, &str) -> Result<T, WrongKey>,
    ) -> Result<[T; 3], WrongKey> {
        let [red, green, blue] = self.channels();
        Ok([
            one(&red.0, &red.1)?,
            one(&green.0, &green.1)?,
            one(&blue.0, &blue.1)?,
        ])
    }

    fn grids(
        &self,
        one: impl Fn(&ChannelEntry, &str) -> Result<ResidualGrid, WrongKey>,
    ) -> Result<[Arc<ResidualGrid>; 3], WrongKey> {
        if self.entry.green.is_none() {
            let [_, (all, key), _] = self.channels();
            let grid = Arc::new(one(&all, &key)?);
            return Ok([grid.clone(), grid.clone(), grid]);
        }
        Ok(self.each(one)?.map(Arc::new))
    }

    fn numbers(&self, name: &str, numbers: &[f64]) -> Result<(), WrongKey> {
        match numbers.iter().all(|it| it.abs() <= LARGEST) {
            true => Ok(()),
            false => self.wrong(name, format!("numbers must be at most {LARGEST}")),
        }
    }

    fn polynomial(&self, entry: &ChannelEntry, key: &str) -> Result<RadialPolynomial, WrongKey> {
        let name = format!("{key}.coefficients");
        let Some(coefficients) = entry.coefficients.clone() else {
            return self.wrong(&name, "there are none");
        };
        if coefficients.is_empty() || coefficients.len() > MOST_COEFFICIENTS {
            return self.wrong(&name, format!("they are not 1 to {MOST_COEFFICIENTS}"));
        }
        self.numbers(&name, &coefficients)?;
        let centre = entry.centre.unwrap_or_default();
        self.numbers(&format!("{key}.centre"), &centre)?;
        Ok(RadialPolynomial {
            centre,
            coefficients,
        })
    }

    fn brown(&self, entry: &ChannelEntry, key: &str) -> Result<BrownConrady, WrongKey> {
        let centre = entry.centre.unwrap_or_default();
        self.numbers(&format!("{key}.centre"), &centre)?;
        let Some(radial) = entry.k else {
            return self.wrong(&format!("{key}.k"), "it needs three numbers");
        };
        self.numbers(&format!("{key}.k"), &radial)?;
        let tangential = entry.p.unwrap_or_default();
        self.numbers(&format!("{key}.p"), &tangential)?;
        Ok(BrownConrady {
            centre,
            radial,
            tangential,
        })
    }

    fn grid(&self, entry: &ChannelEntry, key: &str) -> Result<ResidualGrid, WrongKey> {
        let (Some(columns), Some(rows)) = (self.entry.columns, self.entry.rows) else {
            return self.wrong("", "a grid needs columns and rows");
        };
        if columns < 2 || rows < 2 {
            return self.wrong("", "a grid has at least 2 columns and rows");
        }
        let nodes = [columns, rows].map(|it| it as usize);
        let name = format!("{key}.points");
        let points = entry.points.as_deref().unwrap_or_default();
        let count = nodes[0].saturating_mul(nodes[1]);
        if points.len() != count || count > MOST_POINTS {
            let what = format!("{} are not {columns} x {rows}", points.len());
            return self.wrong(&name, what);
        }
        // Not a number: unlit.
        if points.iter().flatten().any(|it| it.abs() > LARGEST) {
            return self.wrong(&name, format!("pixels must be at most {LARGEST}"));
        }
        let grid = ResidualGrid::over(self.view.size, nodes, |_| [0.0; 2]);
        let place = |k: usize| [k % nodes[0], k / nodes[0]].map(|it| it as f64);
        let residuals = points.iter().enumerate().map(|(k, point)| {
            let place = place(k);
            [0, 1].map(|l| (point[l] - place[l] * grid.step[l]) as f32)
        });
        Ok(ResidualGrid {
            residuals: residuals.collect(),
            ..grid
        })
    }

    fn map(&self, entry: &ChannelEntry, key: &str) -> Result<ResidualGrid, WrongKey> {
        let name = format!("{key}.file");
        let Some(file) = &entry.file else {
            return self.wrong(&name, "there is none");
        };
        let found = (self.read)(file).and_then(|bytes| pfm::read(&bytes, self.view.size));
        match found {
            Ok(grid) => Ok(grid),
            Err(what) => {
                let file: String = file.chars().take(80).collect();
                self.wrong(&name, format!("{file:?} {what}"))
            }
        }
    }
}

/// Refuses what turns a part of the panel over, or looks from nowhere.
pub(super) fn check_folds(found: &Distortion, view: &EyeView, key: &str) -> Result<(), WrongKey> {
    let [w, h] = view.size.map(f64::from);
    let at = |k: u32, side: f64| side * f64::from(k) / f64::from(TRIED - 1);
    let is_bulge = matches!(found, Distortion::Bulge(_));
    let mut lit = false;
    for channel in 0..3 {
        for place in (0..TRIED).flat_map(|y| (0..TRIED).map(move |x| [x, y])) {
            let place = [at(place[0], w), at(place[1], h)];
            let bent = found.ideal(view, place, channel);
            lit |= bent.is_some();
            let is_sound = match bent {
                Some(bent) => bent.area() > 0.0 && bent.place.iter().all(|it| it.is_finite()),
                None => !is_bulge,
            };
            if !is_sound {
                let [x, y] = place;
                let what = format!("it folds rays over at pixel {x:.0}, {y:.0}");
                return Err(WrongKey::new(key, what));
            }
        }
        if channel == 0 && !found.parts_colours() {
            break;
        }
    }
    match lit {
        true => Ok(()),
        false => Err(WrongKey::new(key, "nothing of the panel is lit")),
    }
}
