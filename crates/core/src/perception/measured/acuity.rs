//! How fine a detail does an eye resolve whose smallest angles were measured?

use super::rows::{Column, MOST_ROWS, MeasuredError, rows};
use crate::units::{Cpd, Radians};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The columns of a table.
const COLUMNS: [Column; 2] = [
    Column {
        names: &[("ecc_deg", 1.0)],
        range: [0.0, 180.0],
        expected: "degrees from 0 to 180",
    },
    Column {
        names: &[("mar_deg", 1.0), ("mar_arcmin", 60.0)],
        range: [1e-5, 90.0],
        expected: "an angle from 1e-5 to 90 degrees (0.0006 to 5400 minutes of arc)",
    },
];
/// Their names, for messages.
const NAMES: &str = "ecc_deg and mar_deg or mar_arcmin";

/// Minimum angle of resolution by eccentricity: linear between rows, constant beyond the first and
/// the last. It never falls with eccentricity. A copy shares the rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<[f64; 2]>", into = "Vec<[f64; 2]>")]
pub struct MeasuredAcuity {
    /// Eccentricity and the smallest pixel that can be resolved there, both in degrees.
    rows: Arc<[[f64; 2]]>,
}

impl MeasuredAcuity {
    /// Reads CSV with `ecc_deg` and `mar_deg` or `mar_arcmin`, the smallest pixel that can
    /// be resolved: half a cycle.
    ///
    /// # Errors
    /// It lacks a column, has a cell out of range, or rows that are not in the order of
    /// eccentricity or fall with it.
    ///
    /// ```
    /// use foveal_core::perception::measured::acuity::MeasuredAcuity;
    /// use foveal_core::units::Radians;
    /// let eye = MeasuredAcuity::parse("ecc_deg,mar_arcmin\n0,1\n20,11\n")?;
    /// assert_eq!(eye.acuity(Radians(0.0)).0, 30.0);
    /// assert!(MeasuredAcuity::parse("ecc_deg,mar_arcmin\n0,1\n20,0.5\n").is_err());
    /// # Ok::<(), foveal_core::perception::measured::rows::MeasuredError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, MeasuredError> {
        Self::try_from(rows(text, COLUMNS, NAMES)?)
    }

    /// Highest spatial frequency that is resolved at an eccentricity: half a cycle to an angle.
    #[must_use]
    pub fn acuity(&self, eccentricity: Radians) -> Cpd {
        Cpd(0.5 / self.smallest_angle_deg(eccentricity.to_degrees()))
    }

    fn smallest_angle_deg(&self, degrees: f64) -> f64 {
        let after = self.rows.partition_point(|[at, _]| *at <= degrees);
        let before = after
            .checked_sub(1)
            .and_then(|before| self.rows.get(before));
        match (before, self.rows.get(after)) {
            (Some([a, from]), Some([b, to])) => from + (to - from) * (degrees - a) / (b - a),
            (Some([_, angle]), None) | (None, Some([_, angle])) => *angle,
            (None, None) => COLUMNS[1].range[1],
        }
    }
}

impl TryFrom<Vec<[f64; 2]>> for MeasuredAcuity {
    type Error = MeasuredError;

    fn try_from(rows: Vec<[f64; 2]>) -> Result<Self, MeasuredError> {
        let wrong = |why: String| Err(MeasuredError::Rows(why));
        if rows.is_empty() || rows.len() > MOST_ROWS {
            let found = rows.len();
            return wrong(format!("found {found} rows, expected 1 to {MOST_ROWS}"));
        }
        let is_outside =
            |[ecc, mar]: &&[f64; 2]| !(COLUMNS[0].holds(*ecc) && COLUMNS[1].holds(*mar));
        if let Some([ecc, mar]) = rows.iter().find(is_outside) {
            return wrong(format!(
                "found {ecc}° with a smallest angle of {mar}°, expected 0 to 180° and 1e-5 to 90°"
            ));
        }
        for pair in rows.windows(2) {
            let [[a, from], [b, to]] = [pair[0], pair[1]];
            if b <= a {
                return wrong(format!(
                    "{b}° of eccentricity follows {a}°; sort the rows and keep one of each"
                ));
            }
            if to < from {
                return wrong(format!(
                    "the smallest angle falls from {from}° to {to}° between {a}° and {b}° of \
                     eccentricity; give one that never falls"
                ));
            }
        }
        Ok(Self { rows: rows.into() })
    }
}

impl From<MeasuredAcuity> for Vec<[f64; 2]> {
    fn from(measured: MeasuredAcuity) -> Self {
        measured.rows.to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(eye: &MeasuredAcuity, degrees: f64) -> f64 {
        eye.acuity(Radians::from_degrees(degrees)).0
    }

    #[test]
    fn acuity_is_met_at_rows_falls_between_them_and_stays_beyond() {
        let eye = MeasuredAcuity::parse("# mine\nnote,mar_arcmin,ecc_deg\na,1,0\n,6,10\n").unwrap();
        assert!((at(&eye, 10.0) - 5.0).abs() < 1e-9 && (at(&eye, 90.0) - 5.0).abs() < 1e-9);
        assert!((at(&eye, 2.0) - 15.0).abs() < 1e-9);
        let mut before = f64::INFINITY;
        for step in 0..400 {
            let found = at(&eye, f64::from(step) / 20.0);
            assert!(found <= before, "{step}");
            before = found;
        }
    }

    #[test]
    fn degrees_and_minutes_of_arc_are_one_table_and_a_log_reads_it_back() {
        let degrees = MeasuredAcuity::parse("ecc_deg,mar_deg\n0,0.5\n10,2\n").unwrap();
        assert_eq!(
            MeasuredAcuity::parse("ecc_deg,mar_arcmin\n0,30\n10,120\n").unwrap(),
            degrees
        );
        let text = serde_json::to_string(&degrees).unwrap();
        assert_eq!(text, "[[0.0,0.5],[10.0,2.0]]");
        assert_eq!(
            serde_json::from_str::<MeasuredAcuity>(&text).unwrap(),
            degrees
        );
        for bad in [
            "[]",
            "[[0,0]]",
            "[[0,1],[0,2]]",
            "[[0,2],[1,1]]",
            "[[-1,1]]",
            "[[0]]",
        ] {
            assert!(
                serde_json::from_str::<MeasuredAcuity>(bad).is_err(),
                "{bad}"
            );
        }
    }

    #[test]
    fn what_is_no_table_is_refused_by_its_place() {
        let error = |text: &str| MeasuredAcuity::parse(text).unwrap_err().to_string();
        for (text, part) in [
            ("", "lacks ecc_deg"),
            (
                "ecc_deg,mar\n0,1\n",
                "lacks mar_deg; it must name ecc_deg and mar_deg or mar_arcmin",
            ),
            (
                "ecc_deg,mar_arcmin\n0,nan\n",
                "line 2, column mar_arcmin: found \"nan\"",
            ),
            (
                "ecc_deg,mar_deg\n\n0,1\n181,1\n",
                "line 4, column ecc_deg: found \"181\"",
            ),
            ("ecc_deg,mar_deg\n0\n", "line 2, column mar_deg: found \"\""),
            (
                "ecc_deg,mar_deg\n5,1\n0,1\n",
                "0° of eccentricity follows 5°",
            ),
            ("ecc_deg,mar_deg\n", "found 0 rows"),
            (
                "ecc_deg,mar_deg,mar_arcmin\n0,0.02,5\n",
                "names mar_deg and mar_arcmin more than once",
            ),
            (
                "ecc_deg,mar_deg,mar_deg\n0,1,2\n",
                "names mar_deg and mar_deg more than once",
            ),
        ] {
            assert!(error(text).contains(part), "{text:?}: {}", error(text));
        }
        let long = format!("ecc_deg,mar_deg\n{}", "0,1\n".repeat(MOST_ROWS + 1));
        assert!(error(&long).contains("more than 4096 rows"));
    }
}
