//! How do the bytes of a sender come in?

use crate::gaze_source::choice::LiveChoice;
use crate::report::output::say;
use anyhow::{Context, anyhow, bail};
use std::io::ErrorKind;
use std::net::{SocketAddr, TcpStream, ToSocketAddrs, UdpSocket};
use std::time::{Duration, Instant};
use tungstenite::http::Uri;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

/// Longest wait for a message, so that whoever waits can see that it should stop.
const POLL: Duration = Duration::from_millis(20);
/// Largest message: what a datagram can hold.
const MOST_BYTES: usize = 65_536;
/// A sender who says nothing for this long holds a source no longer.
const SILENCE: Duration = Duration::from_secs(1);
/// Longest wait for a server's answer.
const ANSWER: Duration = Duration::from_secs(3);
/// Pause before a lost server is tried again.
const AGAIN: Duration = Duration::from_secs(1);

/// Where messages come from.
pub(super) enum GazeFeed {
    Datagrams(UdpSocket, SourceHolder),
    WebSocket(Box<WebSocketFeed>),
}

/// What one wait gave.
#[derive(Debug, PartialEq)]
pub(super) enum Received {
    /// A message, in the buffer, and who sent it where there may be several.
    Message(Option<SocketAddr>),
    Nothing,
    /// A message of another sender than the one who holds the source.
    Foreign(SocketAddr),
    /// The server is gone, for this reason; it will be tried again.
    Lost(String),
}

impl GazeFeed {
    /// Listens at the port of a choice, or connects to its server. Says where it listens: port 0
    /// is any that is free.
    pub(super) fn open(choice: &LiveChoice) -> anyhow::Result<Self> {
        match choice {
            LiveChoice::Udp(address) | LiveChoice::Osc(address) => {
                let socket = UdpSocket::bind(address).with_context(|| {
                    format!("--gaze {choice}: cannot listen there; choose another port or host")
                })?;
                socket.set_read_timeout(Some(POLL))?;
                say(&format!(
                    "foveal: {choice} listens on {}",
                    socket.local_addr()?
                ));
                Ok(Self::Datagrams(socket, SourceHolder::default()))
            }
            LiveChoice::WebSocket(url) => Ok(Self::WebSocket(Box::new(WebSocketFeed {
                socket: Some(connect(url).with_context(|| {
                    format!("--gaze {choice}: no connection; start the server first")
                })?),
                url: url.clone(),
                tried: Instant::now(),
            }))),
        }
    }

    /// Waits a little for the next message, which replaces what is in the buffer.
    pub(super) fn receive(&mut self, buffer: &mut Vec<u8>) -> Received {
        match self {
            Self::Datagrams(socket, holder) => {
                buffer.resize(MOST_BYTES, 0);
                match socket.recv_from(buffer) {
                    Ok((_, sender)) if !holder.may_speak(sender, Instant::now()) => {
                        Received::Foreign(sender)
                    }
                    Ok((length, sender)) => {
                        buffer.truncate(length);
                        Received::Message(Some(sender))
                    }
                    Err(error) => {
                        // Such as an answer to what was never sent: the next wait may be better.
                        if !is_wait(error.kind()) {
                            std::thread::sleep(POLL);
                        }
                        Received::Nothing
                    }
                }
            }
            Self::WebSocket(feed) => feed.receive(buffer),
        }
    }

    /// Notes that what this sender said is a gaze: it holds the source.
    pub(super) fn hold(&mut self, sender: SocketAddr) {
        if let Self::Datagrams(_, holder) = self {
            holder.held = Some((sender, Instant::now()));
        }
    }
}

/// Who is listened to of several that send: the first that sent a gaze, until it has been silent.
#[derive(Debug, Default)]
pub(super) struct SourceHolder {
    held: Option<(SocketAddr, Instant)>,
}

impl SourceHolder {
    /// Whether a message of this sender is looked at.
    fn may_speak(&self, sender: SocketAddr, now: Instant) -> bool {
        let other = self.held.filter(|(holder, _)| *holder != sender);
        let is_silent = |since: Instant| now.saturating_duration_since(since) > SILENCE;
        other.is_none_or(|(_, since)| is_silent(since))
    }
}

/// A client of a WebSocket server, which connects again when it is lost.
pub(super) struct WebSocketFeed {
    url: String,
    socket: Option<WebSocket<TcpStream>>,
    tried: Instant,
}

impl WebSocketFeed {
    fn receive(&mut self, buffer: &mut Vec<u8>) -> Received {
        let Some(socket) = &mut self.socket else {
            if self.tried.elapsed() < AGAIN {
                std::thread::sleep(POLL);
            } else {
                self.socket = connect(&self.url).ok();
                self.tried = Instant::now();
            }
            return Received::Nothing;
        };
        let message = match socket.read() {
            Ok(Message::Text(text)) => text.as_bytes().to_vec(),
            Ok(Message::Binary(bytes)) => bytes.to_vec(),
            Ok(_) => return Received::Nothing,
            Err(tungstenite::Error::Io(error)) if is_wait(error.kind()) => {
                return Received::Nothing;
            }
            Err(error) => {
                self.socket = None;
                self.tried = Instant::now();
                return Received::Lost(error.to_string());
            }
        };
        *buffer = message;
        Received::Message(None)
    }
}

fn is_wait(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

fn connect(url: &str) -> anyhow::Result<WebSocket<TcpStream>> {
    let uri: Uri = url.parse().context("no address of a WebSocket server")?;
    let host = uri.host().context("the address names no host")?;
    let host = host.trim_start_matches('[').trim_end_matches(']');
    let mut failure = anyhow!("the host has no address");
    for address in (host, uri.port_u16().unwrap_or(80)).to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, ANSWER) {
            Ok(stream) => return greet(url, stream),
            Err(error) => failure = error.into(),
        }
    }
    Err(failure)
}

fn greet(url: &str, stream: TcpStream) -> anyhow::Result<WebSocket<TcpStream>> {
    stream.set_read_timeout(Some(ANSWER))?;
    stream.set_write_timeout(Some(ANSWER))?;
    stream.set_nodelay(true)?;
    let config = WebSocketConfig::default()
        .read_buffer_size(MOST_BYTES)
        .write_buffer_size(0)
        .max_write_buffer_size(MOST_BYTES)
        .max_message_size(Some(MOST_BYTES))
        .max_frame_size(Some(MOST_BYTES));
    match tungstenite::client::client_with_config(url, stream, Some(config)) {
        Ok((socket, _)) => {
            socket.get_ref().set_read_timeout(Some(POLL))?;
            Ok(socket)
        }
        Err(tungstenite::HandshakeError::Interrupted(_)) => {
            bail!("the server did not answer within {} s", ANSWER.as_secs())
        }
        Err(tungstenite::HandshakeError::Failure(error)) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_sender_holds_a_source_until_it_is_silent() {
        let [a, b] = [1, 2].map(|port| SocketAddr::from(([127, 0, 0, 1], port)));
        let begun = Instant::now();
        let at = |ms: u64| begun + Duration::from_millis(ms);
        let mut holder = SourceHolder::default();
        let taken = [
            (a, 0),
            (b, 10),
            (a, 900),
            (b, 1800),
            (b, 1901),
            (a, 1950),
            (b, 2000),
        ]
        .map(|(sender, ms)| {
            let may = holder.may_speak(sender, at(ms));
            if may {
                holder.held = Some((sender, at(ms)));
            }
            may
        });
        assert_eq!(taken, [true, false, true, false, true, false, true]);
    }
}
