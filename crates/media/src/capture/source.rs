//! What can be captured, and what comes of it?

use std::fmt;

/// A picture that was captured.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CapturedPicture {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Red, green, blue and 255 of each pixel, as sRGB codes, row by row from above.
    pub rgba: Vec<u8>,
}

/// What is captured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LiveSource {
    /// All of an X display, `x11:root`.
    Screen,
    /// A window by its number, `x11:0x1a00003`.
    Window(u32),
    /// A window by its title, or a part of it: `x11:TITLE`.
    Titled(String),
    /// A camera or grabber of Linux: `v4l2:/dev/video0`.
    Camera(String),
    /// A graph of FFmpeg's filters that makes pictures: `lavfi:testsrc2`.
    Graph(String),
}

/// Why nothing is captured.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// There is nothing to capture from.
    #[error("{name}: {reason}; {next}")]
    Open {
        /// What was to be captured.
        name: String,
        /// What is wrong.
        reason: String,
        /// What can be done.
        next: String,
    },
}

impl LiveSource {
    /// What a name stands for; `None` where it does not name what is captured.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        let (kind, rest) = name.split_once(':')?;
        Some(match kind {
            "x11" if rest == "root" => Self::Screen,
            "x11" => match window_number(rest) {
                Some(number) => Self::Window(number),
                None => Self::Titled(rest.to_owned()),
            },
            "v4l2" => Self::Camera(rest.to_owned()),
            "lavfi" => Self::Graph(rest.to_owned()),
            _ => return None,
        })
    }
}

impl fmt::Display for LiveSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Screen => write!(f, "x11:root"),
            Self::Window(number) => write!(f, "x11:{number:#x}"),
            Self::Titled(title) => write!(f, "x11:{title}"),
            Self::Camera(device) => write!(f, "v4l2:{device}"),
            Self::Graph(graph) => write!(f, "lavfi:{graph}"),
        }
    }
}

/// The number of a window: decimal, or hexadecimal after 0x.
fn window_number(text: &str) -> Option<u32> {
    match text.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_says_what_is_captured() {
        let named = |name: &str| LiveSource::parse(name);
        assert_eq!(named("x11:root"), Some(LiveSource::Screen));
        assert_eq!(named("x11:0x1f"), Some(LiveSource::Window(31)));
        assert_eq!(named("x11:31"), Some(LiveSource::Window(31)));
        let titled = LiveSource::Titled("a: b".to_owned());
        assert_eq!(named("x11:a: b"), Some(titled.clone()));
        assert_eq!(titled.to_string(), "x11:a: b");
        assert_eq!(named("clip.mp4"), None);
        assert_eq!(named("c:/clip.mp4"), None);
    }
}
