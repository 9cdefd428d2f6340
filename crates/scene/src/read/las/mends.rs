//! What of a scan was mended or left out, and how is that reported?

use crate::source::Repairs;
use foveal_core::units::counted;

/// What of a file was mended or left out.
#[derive(Debug, Default)]
pub(super) struct LasMends {
    pub(super) remarks: Vec<String>,
    pub(super) repairs: Repairs,
}

impl LasMends {
    pub(super) fn remark(&mut self, remark: String) {
        self.remarks.push(remark);
    }

    fn count(&mut self, name: &str, times: u64) {
        *self.repairs.entry(name.to_owned()).or_default() += times;
    }

    /// A number in the header that the rest of the file contradicts.
    pub(super) fn stale_count(&mut self, remark: String) {
        self.remark(remark);
        self.count("stale_counts", 1);
    }

    /// A scale that counts the other way.
    pub(super) fn negative_scale(&mut self, remark: String) {
        self.remark(remark);
        self.count("negative_scales", 1);
    }

    /// So many points of all that the header counts are not there.
    pub(super) fn miss(&mut self, missing: u64, all: u64, why: &str) {
        if missing > 0 {
            self.remark(format!("{missing} of {all} points are missing: {why}"));
            self.count("missing_points", missing);
        }
    }

    /// So many bytes lie behind the points that the header counts, and belong to nothing.
    pub(super) fn leave_behind(&mut self, bytes: usize, points: u64) {
        if bytes > 0 {
            self.remark(format!(
                "{} behind the {points} points that the header counts are left out",
                counted(bytes, "byte")
            ));
            self.count("bytes_behind_points", bytes as u64);
        }
    }
}
