//! How do the bytes of a sender come in?

use crate::gaze_source::choice::LiveChoice;
use crate::report::output::say;
use anyhow::{Context, anyhow};
use std::io::{ErrorKind, Read, Write};
use std::net::{IpAddr, SocketAddr, TcpStream, ToSocketAddrs, UdpSocket};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};
use tungstenite::http::Uri;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

/// Longest wait for a message, so that a waiting thread can see that it should stop.
const POLL: Duration = Duration::from_millis(20);
/// Largest message: what a datagram can hold.
const MOST_BYTES: usize = 65_536;
/// A sender who says nothing for this long holds a source no longer.
const SILENCE: Duration = Duration::from_secs(1);
/// Longest time until a server has answered, from finding its address to the last byte of its
/// greeting.
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
                say(&format!("{choice} listens on {}", socket.local_addr()?));
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
    socket: Option<WebSocket<TimelyStream>>,
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

/// A connection all of whose reads and writes end by one time, however little each of them brings.
#[derive(Debug)]
struct TimelyStream {
    stream: TcpStream,
    /// None once the server has greeted: reads then wait for [`POLL`].
    until: Option<Instant>,
}

impl TimelyStream {
    /// What is left of the time; an error where nothing is.
    fn left(&self) -> std::io::Result<Option<Duration>> {
        let Some(until) = self.until else {
            return Ok(None);
        };
        match until.saturating_duration_since(Instant::now()) {
            Duration::ZERO => Err(ErrorKind::WouldBlock.into()),
            left => Ok(Some(left)),
        }
    }
}

impl Read for TimelyStream {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        if let Some(left) = self.left()? {
            self.stream.set_read_timeout(Some(left))?;
        }
        self.stream.read(bytes)
    }
}

impl Write for TimelyStream {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if let Some(left) = self.left()? {
            self.stream.set_write_timeout(Some(left))?;
        }
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.stream.flush()
    }
}

fn no_answer() -> anyhow::Error {
    anyhow!("the server did not answer within {} s", ANSWER.as_secs())
}

fn connect(url: &str) -> anyhow::Result<WebSocket<TimelyStream>> {
    let until = Instant::now() + ANSWER;
    let uri: Uri = url.parse().context("no address of a WebSocket server")?;
    let host = uri.host().context("the address names no host")?;
    let host = host.trim_start_matches('[').trim_end_matches(']');
    let mut failure = anyhow!("the host has no address");
    for address in addresses_of(host, uri.port_u16().unwrap_or(80))? {
        match until.saturating_duration_since(Instant::now()) {
            Duration::ZERO => return Err(no_answer()),
            left => match TcpStream::connect_timeout(&address, left) {
                Ok(stream) => return greet(url, stream, until),
                Err(error) => failure = error.into(),
            },
        }
    }
    Err(failure)
}

/// The addresses of a host. Finding them may take the system longer than anybody should wait, and
/// cannot be stopped; so it has a thread of its own.
fn addresses_of(host: &str, port: u16) -> anyhow::Result<Vec<SocketAddr>> {
    if let Ok(address) = host.parse::<IpAddr>() {
        return Ok(vec![(address, port).into()]);
    }
    let (send, receive) = channel();
    let host = host.to_owned();
    std::thread::Builder::new()
        .name("address".to_owned())
        .spawn(move || {
            let found = (host.as_str(), port).to_socket_addrs();
            // The receiver may be gone.
            let _ = send.send(found.map(Iterator::collect));
        })?;
    let found = receive.recv_timeout(ANSWER);
    let found = found.map_err(|_| anyhow!("its address was not found in time"))?;
    Ok(found?)
}

fn greet(url: &str, stream: TcpStream, until: Instant) -> anyhow::Result<WebSocket<TimelyStream>> {
    stream.set_nodelay(true)?;
    let stream = TimelyStream {
        stream,
        until: Some(until),
    };
    let config = WebSocketConfig::default()
        .read_buffer_size(MOST_BYTES)
        .write_buffer_size(0)
        .max_write_buffer_size(MOST_BYTES)
        .max_message_size(Some(MOST_BYTES))
        .max_frame_size(Some(MOST_BYTES));
    match tungstenite::client::client_with_config(url, stream, Some(config)) {
        Ok((mut socket, _)) => {
            let greeted = socket.get_mut();
            greeted.until = None;
            greeted.stream.set_read_timeout(Some(POLL))?;
            greeted.stream.set_write_timeout(Some(ANSWER))?;
            Ok(socket)
        }
        Err(tungstenite::HandshakeError::Interrupted(_)) => Err(no_answer()),
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
