//! How are repairs and remarks about a source reported?

use foveal_core::units::one_line;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// A line for everything that was mended, with its count, and for every remark.
pub(crate) fn remarks_told(repairs: &BTreeMap<String, u64>, remarks: &[String]) -> String {
    let mut text = String::new();
    for (what, count) in repairs {
        let _ = writeln!(text, "{}: {count}", one_line(&what.replace('_', " ")));
    }
    for remark in remarks {
        let _ = writeln!(text, "{}", one_line(remark));
    }
    text
}
