//! How little contrast does an eye need whose sensitivity was measured?

use super::rows::{Column, MOST_ROWS, MeasuredError, rows};
use crate::units::{Cpd, Radians};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The columns of a table.
const COLUMNS: [Column; 3] = [
    Column {
        names: &[("cpd", 1.0)],
        range: [1e-3, 1000.0],
        expected: "cycles per degree from 0.001 to 1000",
    },
    Column {
        names: &[("ecc_deg", 1.0)],
        range: [0.0, 180.0],
        expected: "degrees from 0 to 180",
    },
    Column {
        names: &[("sensitivity", 1.0)],
        range: [0.0, 1e6],
        expected: "a number from 0 to 1e6",
    },
];
/// Their names, for messages.
const NAMES: &str = "cpd, ecc_deg and sensitivity";

/// Sensitivity (1 / threshold contrast) by spatial frequency and eccentricity. Between measurements
/// its logarithm is linear in those of frequency and in eccentricity, and sensitivity itself where
/// one of them is 0. Below the lowest frequency and beyond both ends of eccentricity the nearest
/// measurement counts; above the highest frequency nothing is seen. A copy shares the numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<[f64; 3]>", into = "Vec<[f64; 3]>")]
pub struct MeasuredSensitivity {
    grid: Arc<Grid>,
}

#[derive(Debug, PartialEq)]
struct Grid {
    /// Rising.
    cpd: Vec<f64>,
    /// Rising.
    ecc_deg: Vec<f64>,
    /// For each eccentricity, of each frequency.
    sensitivity: Vec<f64>,
}

impl MeasuredSensitivity {
    /// Reads CSV with `cpd`, `ecc_deg` and `sensitivity`, in any order: every frequency at every
    /// eccentricity.
    ///
    /// # Errors
    /// It lacks a column or a combination, has one twice, or a cell out of range.
    ///
    /// ```
    /// use foveal_core::perception::measured::sensitivity::MeasuredSensitivity;
    /// use foveal_core::units::{Cpd, Radians};
    /// let eye = MeasuredSensitivity::parse("cpd,ecc_deg,sensitivity\n1,0,100\n4,0,25\n")?;
    /// assert!((eye.at(Cpd(2.0), Radians(0.3)) - 50.0).abs() < 1e-9);
    /// # Ok::<(), foveal_core::perception::measured::rows::MeasuredError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, MeasuredError> {
        Self::try_from(rows(text, COLUMNS, NAMES)?)
    }

    /// Sensitivity at a frequency and an eccentricity.
    #[must_use]
    pub fn at(&self, Cpd(frequency): Cpd, eccentricity: Radians) -> f64 {
        let Grid {
            cpd,
            ecc_deg,
            sensitivity,
        } = &*self.grid;
        if cpd.last().is_none_or(|highest| frequency > *highest) {
            return 0.0;
        }
        let (f, right) = between(cpd, frequency, libm::log2);
        let (e, down) = between(ecc_deg, eccentricity.to_degrees(), |degrees| degrees);
        let value = |e: usize, f: usize| {
            let row = e.min(ecc_deg.len() - 1) * cpd.len();
            sensitivity[row + f.min(cpd.len() - 1)]
        };
        let across = |e| mix(value(e, f), value(e, f + 1), right);
        mix(across(e), across(e + 1), down)
    }
}

/// The place of the entry before `at` in a rising list, and how far `at` is on the way to the next,
/// as `scale` measures it.
fn between(list: &[f64], at: f64, scale: fn(f64) -> f64) -> (usize, f64) {
    let after = list.partition_point(|entry| *entry <= at);
    match (after.checked_sub(1), list.get(after)) {
        (Some(before), Some(next)) => {
            let from = scale(list[before]);
            (before, (scale(at) - from) / (scale(*next) - from))
        }
        (Some(before), None) => (before, 0.0),
        (None, _) => (0, 0.0),
    }
}

fn mix(a: f64, b: f64, share: f64) -> f64 {
    match a > 0.0 && b > 0.0 {
        true => a * libm::pow(b / a, share),
        false => a + (b - a) * share,
    }
}

impl TryFrom<Vec<[f64; 3]>> for MeasuredSensitivity {
    type Error = MeasuredError;

    fn try_from(rows: Vec<[f64; 3]>) -> Result<Self, MeasuredError> {
        let wrong = |why: String| Err(MeasuredError::Rows(why));
        if rows.is_empty() || rows.len() > MOST_ROWS {
            let found = rows.len();
            return wrong(format!("found {found} rows, expected 1 to {MOST_ROWS}"));
        }
        for row in &rows {
            let outside = row
                .iter()
                .zip(COLUMNS)
                .find(|(value, column)| !column.holds(**value));
            if let Some((value, column)) = outside {
                return wrong(format!("found {value}, expected {}", column.expected));
            }
        }
        let listed = |column: usize| {
            let mut values: Vec<f64> = rows.iter().map(|row| row[column]).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        let (cpd, ecc_deg) = (listed(0), listed(1));
        let mut rows = rows;
        rows.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
        let mut given = rows.iter().peekable();
        for (ecc, f) in ecc_deg
            .iter()
            .flat_map(|ecc| cpd.iter().map(move |f| (ecc, f)))
        {
            let here = |row: &&&[f64; 3]| row[0] == *f && row[1] == *ecc;
            if given.next_if(|row| here(&row)).is_none() {
                return wrong(format!(
                    "{f} cycles per degree lack a sensitivity at {ecc}°; give every frequency at \
                     every eccentricity"
                ));
            }
            if given.peek().is_some_and(|row| here(&row)) {
                return wrong(format!(
                    "{f} cycles per degree have two sensitivities at {ecc}°; keep one of them"
                ));
            }
        }
        let sensitivity = rows.iter().map(|row| row[2]).collect();
        Ok(Self {
            grid: Arc::new(Grid {
                cpd,
                ecc_deg,
                sensitivity,
            }),
        })
    }
}

impl From<MeasuredSensitivity> for Vec<[f64; 3]> {
    fn from(measured: MeasuredSensitivity) -> Self {
        let Grid {
            cpd,
            ecc_deg,
            sensitivity,
        } = &*measured.grid;
        let places = ecc_deg
            .iter()
            .flat_map(|ecc| cpd.iter().map(move |f| [*f, *ecc]));
        let rows = places.zip(sensitivity).map(|([f, ecc], s)| [f, ecc, *s]);
        rows.collect()
    }
}

/// Takes any bytes for a table of either kind: the body of the fuzz target. Returns whether they
/// were one.
///
/// # Panics
/// When what was read says something that no eye can.
#[must_use]
pub fn parse_anything(data: &[u8]) -> bool {
    use super::acuity::MeasuredAcuity;
    let Ok(text) = core::str::from_utf8(data) else {
        return false;
    };
    let (sensitivity, acuity) = (
        MeasuredSensitivity::parse(text),
        MeasuredAcuity::parse(text),
    );
    for step in 0..40_u32 {
        let eccentricity = Radians::from_degrees(f64::from(step) * 5.0);
        if let Ok(eye) = &sensitivity {
            let seen = eye.at(Cpd(libm::exp2(f64::from(step) / 2.0 - 10.0)), eccentricity);
            assert!((0.0..=1e6 + 1e-3).contains(&seen), "{seen}");
        }
        if let Ok(eye) = &acuity {
            assert!(eye.acuity(eccentricity).0 > 0.0);
        }
    }
    sensitivity.is_ok() || acuity.is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::random::Random;

    const TABLE: &str =
        "ecc_deg,cpd,sensitivity\n0,1,100\n0,4,64\n0,16,4\n10,1,50\n10,4,8\n10,16,0\n";

    fn at(eye: &MeasuredSensitivity, f: f64, degrees: f64) -> f64 {
        eye.at(Cpd(f), Radians::from_degrees(degrees))
    }

    #[test]
    fn measurements_are_met_joined_and_never_left() {
        let eye = MeasuredSensitivity::parse(TABLE).unwrap();
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-9;
        for (f, degrees, expected) in [
            (1.0, 0.0, 100.0),
            (4.0, 10.0, 8.0),
            (16.0, 10.0, 0.0),
            (8.0, 0.0, 16.0),
            (8.0, 10.0, 4.0),
            (1.0, 5.0, (100.0_f64 * 50.0).sqrt()),
            (0.1, 0.0, 100.0),
            (4.0, 90.0, 8.0),
            (16.1, 0.0, 0.0),
        ] {
            let found = at(&eye, f, degrees);
            assert!(near(found, expected), "{f} {degrees}: {found}");
        }
    }

    #[test]
    fn a_log_reads_back_what_it_holds() {
        let eye = MeasuredSensitivity::parse(TABLE).unwrap();
        let text = serde_json::to_string(&eye).unwrap();
        assert!(
            text.starts_with("[[1.0,0.0,100.0],[4.0,0.0,64.0]"),
            "{text}"
        );
        assert_eq!(
            serde_json::from_str::<MeasuredSensitivity>(&text).unwrap(),
            eye
        );
    }

    #[test]
    fn what_is_no_function_of_both_is_refused() {
        let error = |text: &str| MeasuredSensitivity::parse(text).unwrap_err().to_string();
        for (rows, part) in [
            (
                "1,0,5\n2,0,5\n1,10,5\n",
                "2 cycles per degree lack a sensitivity at 10°",
            ),
            ("1,0,5\n1,0,6\n", "two sensitivities at 0°"),
            ("0,0,5\n", "line 2, column cpd: found \"0\""),
            ("1,0,-5\n", "line 2, column sensitivity"),
            ("", "found 0 rows"),
        ] {
            let found = error(&format!("cpd,ecc_deg,sensitivity\n{rows}"));
            assert!(found.contains(part), "{found}");
        }
        assert!(error("cpd,sensitivity\n1,2\n").contains("lacks ecc_deg"));
    }

    #[test]
    fn a_generated_corpus_of_damaged_tables_never_panics() {
        let acuity = "ecc_deg,mar_arcmin\n0,1\n5,3\n20,9\n";
        let mut random = Random::new(11);
        let mut read = 0;
        for n in 0..4000 {
            let mut bad = [TABLE, acuity][n % 2].as_bytes().to_vec();
            for _ in 0..n % 3 {
                let mut below = |count: usize| (random.unit() * count as f64) as usize;
                let place = below(bad.len());
                let damage = b"0123456789.,-+eNaninf#\n\xff";
                bad[place] = damage[below(damage.len())];
            }
            read += usize::from(parse_anything(&bad));
        }
        assert!((200..3900).contains(&read), "{read}");
    }
}
