//! What is known of a pack that is loaded in parts?

use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::pack::{HEADER_BYTES, Header, PackError};
use foveal_core::units::counted;
use foveal_core::view::surface::Screen;
use std::ops::Range;
use std::sync::Arc;

/// A pack of which header and description have been loaded.
pub(crate) struct PackInParts {
    pub(crate) header: Header,
    pub(crate) video: Arc<Video>,
}

impl PackInParts {
    /// The pack that begins with `head`, called `name` in logs, flat content filling `screen`.
    pub(crate) fn open(head: &[u8], name: &str, screen: Screen) -> Result<Self, PackError> {
        let header = Header::parse(head)?;
        let end = HEADER_BYTES + header.description_bytes as usize;
        let Some(description) = head.get(HEADER_BYTES..end) else {
            return Err(PackError {
                field: "description".to_owned(),
                found: format!("{} of the file", counted(head.len(), "byte")),
                expected: format!("{end}"),
            });
        };
        let pack = VideoPack::begin(&header, description)?;
        Ok(Self {
            header,
            video: Arc::new(Video::new(name, Arc::new(pack), screen)),
        })
    }

    /// Where a side table lies in the file; `None` where the pack has none of that name.
    pub(crate) fn table_place(&self, name: &str) -> Option<Range<u64>> {
        let table = self.video.table(name)?;
        let end = table.offset.checked_add(table.bytes)?;
        (end <= self.header.file_bytes).then_some(table.offset..end)
    }
}
