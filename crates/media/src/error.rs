//! What can go wrong between a file and a picture, and what should its owner do next?

use std::path::PathBuf;

use thiserror::Error;

/// Whether the system opens no more files, of this program (EMFILE) or of all (ENFILE).
pub(crate) fn is_system_full(reason: &str) -> bool {
    reason.contains("Too many open files") || reason.contains("os error 23")
}

/// What to do where the system refuses to open a file, by what it says.
fn next_after(reason: &str) -> &'static str {
    match is_system_full(reason) {
        true => "close other programs or files, or allow more with `ulimit -n 4096`",
        false => "check the path and the permissions",
    }
}

/// Why a file could not be read, coded or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MediaError {
    /// The file cannot be opened at all.
    #[error("{}: cannot be opened: {reason}; {}", path.display(), next_after(reason))]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// FFmpeg finds no format in the file, or the file is cut before its index.
    #[error(
        "{}: is not a video or picture that FFmpeg can read ({reason}); look at it with `ffprobe`, \
         and copy it again if it was cut short",
        path.display()
    )]
    NotVideo {
        /// The file.
        path: PathBuf,
        /// What FFmpeg said.
        reason: String,
    },
    /// FFmpeg refuses the file for a box about its projection or its eyes.
    #[error(
        "{}: cannot be opened: its {name} box, at byte {at}, {what}; hide the box in a copy with \
         `printf free | dd of=COPY bs=1 seek={at} conv=notrunc`, and say what it is with \
         --projection or --stereo",
        path.display()
    )]
    BrokenBox {
        /// The file.
        path: PathBuf,
        /// Name of the box.
        name: &'static str,
        /// Where this name stands in the file, in bytes.
        at: u64,
        /// What is wrong with it.
        what: String,
    },
    /// The file is of another kind than one that holds pictures.
    #[error("{}: {what}; {next}", path.display())]
    OtherFile {
        /// The file.
        path: PathBuf,
        /// What it is, as the end of a sentence that begins with the file.
        what: String,
        /// What to do about it.
        next: String,
    },
    /// The file has streams, but none is a video.
    #[error("{}: holds {found}; give a file with pictures", path.display())]
    NoVideoStream {
        /// The file.
        path: PathBuf,
        /// What it holds instead of one.
        found: String,
    },
    /// The video stream ends or breaks before its first frame.
    #[error(
        "{}: no frame of its video stream can be read ({reason}); copy the file again if it was \
         cut short, or record it again",
        path.display()
    )]
    NoFrames {
        /// The file.
        path: PathBuf,
        /// What FFmpeg said.
        reason: String,
    },
    /// The file asks for something that Foveal does not do.
    #[error("{}: {field} is {found}, which is not supported; {next}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// The property of the file.
        field: &'static str,
        /// Its value.
        found: String,
        /// What to do about it.
        next: &'static str,
    },
    /// The file breaks off, or its data are damaged, after the start.
    #[error(
        "{}: broken at frame {frame} ({seconds:.3} s): {reason}; copy the file again, or keep the \
         part before with `ffmpeg -i FILE -t {seconds:.3} -c copy PART`",
        path.display()
    )]
    Broken {
        /// The file.
        path: PathBuf,
        /// Number of the first frame that cannot be delivered, counted from 0.
        frame: u64,
        /// When it would have been shown, in seconds after the first frame.
        seconds: f64,
        /// What FFmpeg said.
        reason: String,
    },
    /// The picture size changes inside the stream.
    #[error(
        "{}: the picture size changes from {} x {} to {} x {} at frame {frame}; bring it to one \
         size with `ffmpeg -i FILE -vf scale={}:{} OUT`",
        path.display(), from[0], from[1], to[0], to[1], from[0], from[1]
    )]
    SizeChange {
        /// The file.
        path: PathBuf,
        /// Number of the first frame with the new size, counted from 0.
        frame: u64,
        /// Width and height of the frames before, as coded.
        from: [u32; 2],
        /// Width and height of this frame, as coded.
        to: [u32; 2],
    },
    /// The system gives no thread.
    #[error("no thread can be had for {what}")]
    Thread {
        /// What it would have done.
        what: &'static str,
        /// What the system said.
        source: std::io::Error,
    },
    /// A setting or a picture that was handed in does not fit.
    #[error("{field} is {found}; expected {expected}")]
    Setting {
        /// Which setting, or which picture.
        field: String,
        /// Its value.
        found: String,
        /// What would be accepted.
        expected: String,
    },
    /// The encoder failed or broke its promises.
    #[error(
        "{codec} encoder, picture {picture} of the group: {reason}; check that this FFmpeg has the \
         encoder with `ffmpeg -encoders`, or choose another codec"
    )]
    Encode {
        /// Name of the encoder.
        codec: &'static str,
        /// Index of the picture in the group, counted from 0.
        picture: usize,
        /// What went wrong.
        reason: String,
    },
    /// An access unit does not decode to the picture that it should.
    #[error(
        "{codec} access unit of frame {frame}: {reason}; check the pack with `foveal verify` and \
         prepare it again if it is damaged"
    )]
    AccessUnit {
        /// Name of the codec.
        codec: &'static str,
        /// Number of the frame that was handed in.
        frame: i64,
        /// What went wrong.
        reason: String,
    },
    /// A video file cannot be written.
    #[error(
        "{}: cannot be written at frame {frame}: {reason}; check the folder, the free space and \
         the ending of the name (.mkv and .mp4 work)",
        path.display()
    )]
    Write {
        /// The file.
        path: PathBuf,
        /// Number of the frame being written, counted from 0.
        frame: u64,
        /// What went wrong.
        reason: String,
    },
}
