//! What is known of a still that is decoded here, and what does it show?

use av::frame::Video;
use ffmpeg_next as av;
use foveal_core::view::picture::Picture;

use crate::read::deliver::FrameConversion;
use crate::read::source::{SourceInfo, Transparency, pixel_aspect};
use crate::read::still::still_tags::StillTags;

/// A still that is read, and handed out once.
pub(crate) struct DecodedStill {
    info: SourceInfo,
    picture: Option<Picture>,
}

impl DecodedStill {
    /// Of its samples and of what a file of so many bytes says of them. The error says why they
    /// cannot be shown.
    pub(crate) fn of(
        frame: &Video,
        mut tags: StillTags,
        (codec, bytes): (&str, u64),
    ) -> Result<Self, String> {
        let mut conversion = FrameConversion::new(frame, tags.orientation, false)?;
        tags.notes.extend(conversion.light_as(frame, tags.power));
        let picture = conversion.picture(frame)?;
        let format = frame.format().descriptor();
        let names = (codec, format.map_or("unknown", |it| it.name()));
        let aspect = pixel_aspect(frame.aspect_ratio(), 1);
        let size = [picture.width, picture.height];
        let info = SourceInfo {
            transparency: conversion
                .has_seen_through()
                .then_some(Transparency::OverBlack),
            pixel_aspect: aspect.map(|[w, h]| match tags.orientation.transpose {
                true => [h, w],
                false => [w, h],
            }),
            ..SourceInfo::of_still(size, conversion.colour(), names, tags, bytes)
        };
        Ok(Self {
            info,
            picture: Some(picture),
        })
    }

    /// What is known of it.
    pub(crate) fn info(&self) -> &SourceInfo {
        &self.info
    }

    /// The picture; `None` when it has been taken.
    pub(crate) fn picture(&mut self) -> Option<Picture> {
        self.picture.take()
    }
}
