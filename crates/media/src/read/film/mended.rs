//! What was mended of a film while it was read, by name and in words?

use std::collections::BTreeMap;

use foveal_core::units::counted;

use crate::read::film::clusters::Clusters;

/// What was mended of a file so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mended {
    /// Frames at the beginning that lean on what the file lacks, and were left out.
    pub dropped_at_start: u64,
    /// Damaged frames that are shown as far as they can be restored.
    pub damaged: u64,
    /// Number of the first of them, counted from 0, and its time in nanoseconds.
    pub first_damaged: Option<(u64, i64)>,
    /// Damaged packets after the first frame that became no frame.
    pub lost: u64,
    /// Clusters of a Matroska file, and which of them are damaged by what it says of itself.
    pub clusters: Clusters,
    /// Why the file ends before it should.
    pub breaks_off: Option<String>,
    /// Time stamps that did not rise and were replaced by the frame rate.
    pub repaired_stamps: u64,
    /// Places where recordings were joined, so that time stamps start again.
    pub joined: u64,
    /// Interlaced frames that were made pictures of one moment.
    pub deinterlaced: u64,
    /// Interlaced frames that were left as they are, and why.
    pub interlaced: u64,
    /// Frames of another size than the first, which were scaled to it.
    pub resized: u64,
    /// Sizes of the first frame and of the first other one.
    pub sizes: Option<[[u32; 2]; 2]>,
    /// Frames whose pixels have another shape than those of the first.
    pub reshaped: u64,
    /// Whether a frame had pixels that can be seen through.
    pub is_transparent: bool,
}

impl Mended {
    /// Counts by name, without those of 0.
    #[must_use]
    pub fn repairs(&self) -> BTreeMap<String, u64> {
        let all = [
            ("frames_dropped_at_start", self.dropped_at_start),
            ("damaged_frames", self.damaged),
            ("lost_packets", self.lost),
            ("damaged_clusters", self.clusters.damaged),
            ("cut_short", u64::from(self.breaks_off.is_some())),
            ("time_stamps", self.repaired_stamps),
            ("joined_recordings", self.joined),
            ("deinterlaced_frames", self.deinterlaced),
            ("resized_frames", self.resized),
            ("reshaped_frames", self.reshaped),
        ];
        let there = all.into_iter().filter(|(_, count)| *count > 0);
        there
            .map(|(name, count)| (name.to_owned(), count))
            .collect()
    }

    /// What a person should know of it, of `frames` frames that last `seconds`.
    #[must_use]
    pub fn remarks(&self, frames: u64, seconds: f64) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.dropped_at_start > 0 {
            remarks.push(format!(
                "it begins in the middle of a stream: {} left out at its start, whose beginning \
                 lies before it",
                are(self.dropped_at_start, "frame")
            ));
        }
        if let Some((first, time_ns)) = self.first_damaged {
            remarks.push(format!(
                "{} damaged, the first at frame {first} ({:.3} s), and shown as far as FFmpeg \
                 restores {}; copy the file again if another copy is good",
                are(self.damaged, "frame"),
                time_ns as f64 / 1e9,
                if self.damaged == 1 { "it" } else { "them" }
            ));
        }
        if self.lost > 0 {
            remarks.push(format!(
                "{} damaged and lost after the first frame; the frame before stays there",
                are(self.lost, "packet")
            ));
        }
        let Clusters { all, damaged } = self.clusters;
        if damaged > 0 {
            remarks.push(format!(
                "{} damaged, by its checksum or its structure, of {all}: frames are missing \
                 there, or wrong where the decoder does not notice",
                are(damaged, "cluster")
            ));
        }
        if let Some(why) = &self.breaks_off {
            remarks.push(format!(
                "it breaks off after {}, at {seconds:.2} s ({why}); copy it again if it was cut \
                 short",
                counted(frames, "frame")
            ));
        }
        if self.joined > 0 {
            remarks.push(format!(
                "its time stamps start again {}, as they do where recordings are joined: the parts \
                 are played one after the other",
                counted(self.joined, "time")
            ));
        }
        remarks.extend(self.interlacing());
        if let Some([from, to]) = self.sizes {
            remarks.push(format!(
                "its pictures change from {}x{} to {}x{} pixels; {} scaled into the first size",
                from[0],
                from[1],
                to[0],
                to[1],
                are(self.resized, "frame")
            ));
        }
        if self.reshaped > 0 {
            remarks.push(format!(
                "the shape of its pixels changes: {} shown with that of the first",
                are(self.reshaped, "frame")
            ));
        }
        remarks
    }

    fn interlacing(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.deinterlaced > 0 {
            remarks.push(format!(
                "{} deinterlaced (bwdif); --deinterlace fields makes a picture of each field, off \
                 leaves frames as they are",
                are(self.deinterlaced, "interlaced frame")
            ));
        }
        if self.interlaced > 0 {
            remarks.push(format!(
                "{} interlaced and left so: edges that move are combs",
                are(self.interlaced, "frame")
            ));
        }
        remarks
    }
}

/// A number of things, and the verb that follows.
fn are(number: u64, what: &str) -> String {
    let verb = if number == 1 { "is" } else { "are" };
    format!("{} {verb}", counted(number, what))
}
