//! Which part of a sphere does a pixel of an equirectangular picture cover?
//!
//! Sun, Lu and Yu 2017, *Weighted-to-spherically-uniform quality evaluation for omnidirectional
//! video* (WS-PSNR); Yu, Lakshman and Girod 2015, *A framework to evaluate omnidirectional
//! video coding schemes* (S-PSNR, nearest neighbour), whose places are ours: a lattice
//! on Fibonacci's spiral, González 2010, *Measurement of areas on a sphere using Fibonacci and
//! latitude-longitude lattices*.

use std::f64::consts::PI;

/// As many places as Yu et al. use.
const PLACES: u32 = 655_362;

/// Weight of every row: the cosine of its latitude.
pub(super) fn equator_weights(rows: u32) -> Vec<f64> {
    let latitude = |row: u32| (f64::from(row) + 0.5 - f64::from(rows) / 2.0) * PI / f64::from(rows);
    (0..rows).map(|row| latitude(row).cos()).collect()
}

/// The pixels nearest to places that lie evenly on the sphere.
pub(super) fn sphere_places([w, h]: [u32; 2]) -> impl Iterator<Item = usize> {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    (0..PLACES).map(move |n| {
        let height = 1.0 - (2.0 * f64::from(n) + 1.0) / f64::from(PLACES);
        let turn = (f64::from(n) / golden).fract();
        let row = (0.5 - height.asin() / PI) * f64::from(h);
        let column = (turn * f64::from(w)) as u32;
        (row as u32).min(h - 1) as usize * w as usize + column.min(w - 1) as usize
    })
}
