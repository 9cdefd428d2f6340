//! How does a part of a file become the body of an answer?

use crate::commands::serve::connections::Answering;
use http_body_util::{Either, Full};
use hyper::body::{Body, Bytes, Frame, SizeHint};
use std::io::{self, ErrorKind, SeekFrom};
use std::pin::Pin;
use std::task::{Context, Poll, ready};
use tokio::io::{AsyncRead, AsyncSeek, ReadBuf};

/// Bytes at hand, or a part of a file.
pub(super) type AnswerBody = Either<Full<Bytes>, FilePart>;

/// A body, and the note that its connection is answering.
pub(super) struct WatchedBody {
    body: AnswerBody,
    _answering: Answering,
}

impl WatchedBody {
    pub(super) fn new(body: AnswerBody, answering: Answering) -> Self {
        Self {
            body,
            _answering: answering,
        }
    }
}

impl Body for WatchedBody {
    type Data = Bytes;
    type Error = Box<dyn std::error::Error + Send + Sync>;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

/// Bytes that are read at a time: all that a connection keeps in memory of a file.
const PIECE: usize = 128 << 10;

/// A part of a file, read as it is sent.
pub(super) struct FilePart {
    file: tokio::fs::File,
    first: u64,
    left: u64,
    state: State,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Opened,
    Seeking,
    Reading,
}

impl FilePart {
    /// The bytes from `first` up to `end`.
    pub(super) fn new(file: std::fs::File, first: u64, end: u64) -> Self {
        Self {
            file: tokio::fs::File::from_std(file),
            first,
            left: end - first,
            state: State::Opened,
        }
    }

    fn poll_seek(&mut self, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        let file = &mut self.file;
        if self.state == State::Opened {
            Pin::new(&mut *file).start_seek(SeekFrom::Start(self.first))?;
            self.state = State::Seeking;
        }
        if self.state == State::Seeking {
            ready!(Pin::new(file).poll_complete(context))?;
            self.state = State::Reading;
        }
        Poll::Ready(Ok(()))
    }
}

impl Body for FilePart {
    type Data = Bytes;
    type Error = io::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<io::Result<Frame<Bytes>>>> {
        if self.left == 0 {
            return Poll::Ready(None);
        }
        ready!(self.poll_seek(context))?;
        let mut piece = vec![0; PIECE.min(usize::try_from(self.left).unwrap_or(PIECE))];
        let mut read = ReadBuf::new(&mut piece);
        ready!(Pin::new(&mut self.file).poll_read(context, &mut read))?;
        let bytes = read.filled().len();
        if bytes == 0 {
            // The file was cut short after its length was sent.
            return Poll::Ready(Some(Err(ErrorKind::UnexpectedEof.into())));
        }
        piece.truncate(bytes);
        self.left -= bytes as u64;
        Poll::Ready(Some(Ok(Frame::data(piece.into()))))
    }

    fn is_end_stream(&self) -> bool {
        self.left == 0
    }

    fn size_hint(&self) -> SizeHint {
        SizeHint::with_exact(self.left)
    }
}
