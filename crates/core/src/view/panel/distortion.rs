//! Which pixel of an ideal panel looks where a pixel that is seen through optics does?
//!
//! Every distortion is a residual in the panel's own pixels, so one map serves all content.

use super::lens::{Bent, BrownConrady, Bulge, RadialPolynomial};
use super::residual_grid::ResidualGrid;
use crate::view::eye_view::EyeView;
use std::sync::Arc;

/// The channel by which geometry goes, and the only one where colours do not part.
pub const GREEN: usize = 1;

/// What optics do to the pixels of a panel. What is given three times is of red, green and blue.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Distortion {
    /// Nothing.
    #[default]
    None,
    /// A height over the panel.
    Bulge(Bulge),
    /// A polynomial of the radius.
    Polynomial(Box<[RadialPolynomial; 3]>),
    /// Radial and tangential terms of a camera's lens.
    BrownConrady(Box<[BrownConrady; 3]>),
    /// Measured at places; the same for all colours where the three are one.
    Grid([Arc<ResidualGrid>; 3]),
}

impl Distortion {
    /// Whether nothing is bent.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::None
    }

    /// Whether colours are bent differently.
    #[must_use]
    pub fn parts_colours(&self) -> bool {
        match self {
            Self::None | Self::Bulge(_) => false,
            Self::Polynomial(all) => all[0] != all[1] || all[2] != all[1],
            Self::BrownConrady(all) => all[0] != all[1] || all[2] != all[1],
            Self::Grid(all) => all[0] != all[1] || all[2] != all[1],
        }
    }

    /// The pixel of the ideal panel that a place of a panel's view looks like, and how it moves
    /// with it; `None` where the panel is unlit, or a height reaches the eye.
    #[must_use]
    pub fn ideal(&self, view: &EyeView, place: [f64; 2], channel: usize) -> Option<Bent> {
        match self {
            Self::None => Some(Bent::straight(place)),
            Self::Bulge(bulge) => bulge.ideal(view, place),
            Self::Polynomial(all) => Some(all[channel].ideal(view, place)),
            Self::BrownConrady(all) => Some(all[channel].ideal(view, place)),
            Self::Grid(all) => all[channel].ideal(place),
        }
    }

    /// The same of a panel with so many times the columns and rows.
    #[must_use]
    pub fn scaled(&self, scale: [f64; 2]) -> Self {
        match self {
            // By tangents, or shares of the panel.
            Self::None | Self::Bulge(_) | Self::Polynomial(_) | Self::BrownConrady(_) => {
                self.clone()
            }
            Self::Grid(all) => {
                let [red, green, blue] = all.each_ref().map(|it| Arc::new(it.scaled(scale)));
                Self::Grid([red, green, blue])
            }
        }
    }

    /// The same in a mirror, of a panel of so many columns.
    #[must_use]
    pub fn mirrored(&self, columns: u32) -> Self {
        match self {
            Self::None | Self::Bulge(_) => self.clone(),
            Self::Polynomial(all) => Self::Polynomial(Box::new(all.each_ref().map(|it| {
                let mut it = it.clone();
                it.centre[0] = -it.centre[0];
                it
            }))),
            Self::BrownConrady(all) => Self::BrownConrady(Box::new(all.map(|mut it| {
                it.centre[0] = -it.centre[0];
                it.tangential[1] = -it.tangential[1];
                it
            }))),
            Self::Grid(all) => {
                let [red, green, blue] = all.each_ref().map(|it| Arc::new(it.mirrored(columns)));
                Self::Grid([red, green, blue])
            }
        }
    }
}
