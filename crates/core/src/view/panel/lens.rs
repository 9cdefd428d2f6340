//! How do formulas bend what a panel shows?

use crate::view::eye_view::EyeView;

/// The pixel of the ideal panel, and its change with the pixel that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bent {
    /// Column and row of the ideal panel.
    pub place: [f64; 2],
    /// Rows: the change of the ideal column, and of the ideal row, with the column and row seen.
    pub jacobian: [[f64; 2]; 2],
}

impl Bent {
    /// What nothing bends.
    #[must_use]
    pub fn straight(place: [f64; 2]) -> Self {
        Self {
            place,
            jacobian: [[1.0, 0.0], [0.0, 1.0]],
        }
    }

    /// How many ideal pixels a pixel is, negative where it is turned over.
    #[must_use]
    pub fn area(&self) -> f64 {
        let [[a, b], [c, d]] = self.jacobian;
        a * d - b * c
    }

    /// From tangents to the right and down of the axis, and their change with the tangents seen.
    fn from_tangent(view: &EyeView, tangent: [f64; 2], jacobian: [[f64; 2]; 2]) -> Self {
        let pitch = pitch(view);
        let edge = [view.field.left, view.field.up];
        Self {
            place: [0, 1].map(|k| (tangent[k] + edge[k]) / pitch[k]),
            jacobian: [0, 1].map(|k| [0, 1].map(|l| jacobian[k][l] * pitch[l] / pitch[k])),
        }
    }
}

/// A pixel's width and height in tangents.
fn pitch(view: &EyeView) -> [f64; 2] {
    let f = view.field;
    [
        (f.left + f.right) / f64::from(view.size[0]),
        (f.up + f.down) / f64::from(view.size[1]),
    ]
}

/// Tangents to the right and down of a place in a view.
fn tangent(view: &EyeView, place: [f64; 2]) -> [f64; 2] {
    let pitch = pitch(view);
    let edge = [view.field.left, view.field.up];
    [0, 1].map(|k| place[k] * pitch[k] - edge[k])
}

/// The elliptic paraboloid of Strege 2009, section 3.2.4: `max(0, b (1 - X² - Y²))` of X and Y from
/// -1 to 1 over the panel, along its normal. A pixel is where the ray through its height meets the
/// flat panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bulge {
    /// Height in the middle, towards the eye; negative away from it.
    pub height: f64,
}

impl Bulge {
    /// The height at a place of a panel of `size`, towards the eye.
    #[must_use]
    pub fn height_at(&self, size: [u32; 2], place: [f64; 2]) -> f64 {
        let [x, y] = [0, 1].map(|k| 2.0 * place[k] / f64::from(size[k]) - 1.0);
        self.height * (1.0 - x * x - y * y).max(0.0)
    }

    pub(super) fn ideal(&self, view: &EyeView, place: [f64; 2]) -> Option<Bent> {
        let height = self.height_at(view.size, place);
        // A height that reaches the eye is seen from nowhere.
        if height >= 1.0 - 1e-6 {
            return None;
        }
        let grown = 1.0 / (1.0 - height);
        let at = tangent(view, place);
        let pitch = pitch(view);
        // Change of the height with the tangent; on the flat rim there is none.
        let slope = [0, 1].map(|k| {
            let size = f64::from(view.size[k]);
            let x = 2.0 * place[k] / size - 1.0;
            match height == 0.0 {
                true => 0.0,
                false => self.height * -2.0 * x * 2.0 / (size * pitch[k]),
            }
        });
        let jacobian = [0, 1].map(|k| {
            [0, 1].map(|l| {
                let own = if k == l { grown } else { 0.0 };
                own + at[k] * grown * grown * slope[l]
            })
        });
        Some(Bent::from_tangent(view, at.map(|t| t * grown), jacobian))
    }
}

/// Tangents from a centre are multiplied by `c0 + c1 r + c2 r² + ..` of their length r.
#[derive(Clone, Debug, PartialEq)]
pub struct RadialPolynomial {
    /// Tangents to the right and down of the axis.
    pub centre: [f64; 2],
    /// c0 and on.
    pub coefficients: Vec<f64>,
}

impl RadialPolynomial {
    pub(super) fn ideal(&self, view: &EyeView, place: [f64; 2]) -> Bent {
        let at = tangent(view, place);
        let off = [0, 1].map(|k| at[k] - self.centre[k]);
        let r = (off[0] * off[0] + off[1] * off[1]).sqrt();
        // Horner's scheme of the factor and of its change with r.
        let (mut factor, mut slope) = (0.0, 0.0);
        for coefficient in self.coefficients.iter().rev() {
            slope = slope * r + factor;
            factor = factor * r + coefficient;
        }
        let across = if r > 1e-12 { slope / r } else { 0.0 };
        let jacobian = [0, 1]
            .map(|k| [0, 1].map(|l| off[k] * off[l] * across + if k == l { factor } else { 0.0 }));
        let bent = [0, 1].map(|k| self.centre[k] + off[k] * factor);
        Bent::from_tangent(view, bent, jacobian)
    }
}

/// Brown 1966, *Decentering distortion of lenses*, on tangents to the right and down of a centre:
/// radial terms of r², r⁴ and r⁶, and two tangential ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrownConrady {
    /// Tangents to the right and down of the axis.
    pub centre: [f64; 2],
    /// k1, k2, k3.
    pub radial: [f64; 3],
    /// p1, p2.
    pub tangential: [f64; 2],
}

impl BrownConrady {
    pub(super) fn ideal(&self, view: &EyeView, place: [f64; 2]) -> Bent {
        let at = tangent(view, place);
        let [x, y] = [0, 1].map(|k| at[k] - self.centre[k]);
        let [k1, k2, k3] = self.radial;
        let [p1, p2] = self.tangential;
        let r2 = x * x + y * y;
        let factor = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        // Change of the factor with r², twice.
        let slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));
        let bent = [
            self.centre[0] + x * factor + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            self.centre[1] + y * factor + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        ];
        let mixed = x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
        let jacobian = [
            [factor + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, mixed],
            [mixed, factor + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x],
        ];
        Bent::from_tangent(view, bent, jacobian)
    }
}
