//! How are a site or packs served to a browser?
//!
//! Plain HTTP/1.1 on loopback unless asked otherwise: files, byte ranges and the headers that
//! viewers in browsers need. Connections are bounded, and idle or slow ones end. No file is opened
//! on the thread that answers.

mod answer;
mod body;
mod connections;
mod place;
mod range;
mod tags;

use crate::commands::site::{About, Site, open_packs};
use crate::report::output::{self, WrongUsage};
use answer::Server;
use anyhow::{Context, bail};
use body::WatchedBody;
use clap::Args;
use connections::{Admitted, Connections};
use hyper::Uri;
use hyper::body::Incoming;
use hyper::header::HeaderValue;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Request, Response};
use hyper_util::rt::{TokioIo, TokioTimer};
use place::{Holds, ServedPlace};
use serde::Serialize;
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime};
use tags::ContentTags;
use tokio::net::{TcpListener, TcpStream};
use tokio::signal::unix::{SignalKind, signal};
use tokio_io_timeout::TimeoutStream;

#[derive(Clone, Debug, Args)]
pub(crate) struct ServeArgs {
    /// The folder of a site, or packs: then a site of them that is never written.
    #[arg(required = true, value_name = "DIR|PACK")]
    what: Vec<PathBuf>,
    /// Address and port to listen on; port 0 takes a free one.
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080")]
    listen: String,
    /// Let pages of this origin read what is served, as https://example.org; * for any.
    #[arg(long, value_name = "ORIGIN", value_parser = parse_origin)]
    allow_origin: Option<HeaderValue>,
    /// A name under which this machine may be asked for, where others reach it; several times for
    /// several. Without it any name is answered to.
    #[arg(long, value_name = "NAME", value_parser = parse_host)]
    host: Vec<String>,
    /// Print one JSON object when it serves.
    #[arg(long)]
    json: bool,
}

/// What `serve` prints once it listens.
#[derive(Serialize)]
struct Serving {
    url: String,
    address: SocketAddr,
}

/// How long the first byte of a connection may take.
const FIRST_BYTE: Duration = Duration::from_secs(5);
/// How long a connection may take to ask, stay without asking, and read nothing of its answer.
const PATIENCE: Duration = Duration::from_secs(30);
/// How long after a failure to accept a connection, as when files run out, it is tried again.
const PAUSE: Duration = Duration::from_millis(200);

pub(crate) fn run(args: &ServeArgs) -> anyhow::Result<()> {
    let place = place(&args.what)?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .context("the server cannot start")?;
    let served = runtime.block_on(serve(args, place));
    // Whatever a file system makes a thread wait for, the server ends.
    runtime.shutdown_background();
    served
}

/// Reads `*`, or an origin as browsers write it: compared letter by letter.
fn parse_origin(text: &str) -> anyhow::Result<HeaderValue> {
    let expected = "expected * or an origin without a path, as https://example.org:8443";
    let uri = text.parse::<Uri>().ok();
    let origin = uri.and_then(|uri| {
        let authority = uri.authority().filter(|one| !one.as_str().contains('@'))?;
        Some(format!("{}://{authority}", uri.scheme_str()?))
    });
    match origin.map(|origin| origin.to_ascii_lowercase()) {
        Some(origin) if origin != text => bail!("{expected}; did you mean {origin}?"),
        None if text != "*" => bail!(expected),
        _ => Ok(HeaderValue::from_str(text)?),
    }
}

/// Reads a name of a host as requests carry it, without a port: in small letters, no brackets.
fn parse_host(text: &str) -> anyhow::Result<String> {
    let bare = text.trim_start_matches('[').trim_end_matches(']');
    let is_address = bare.parse::<IpAddr>().is_ok();
    let is_letter = |letter: char| letter.is_ascii_alphanumeric() || "-._".contains(letter);
    let is_name = !bare.is_empty() && bare.chars().all(is_letter);
    if !(is_address || is_name) {
        bail!(
            "expected a name or an address without a port, as media.example; names of other \
             letters as browsers send them, as xn--bcher-kva.example"
        );
    }
    Ok(bare.trim_end_matches('.').to_ascii_lowercase())
}

/// A folder, or a site of packs.
fn place(what: &[PathBuf]) -> anyhow::Result<ServedPlace> {
    let folder = what.iter().find(|path| path.is_dir());
    match (folder, what) {
        (Some(folder), [_]) => Ok(holding(Holds::Folder(checked(folder)?))),
        (Some(folder), _) => bail!(WrongUsage(format!(
            "{}: is a folder; give one folder, or packs",
            folder.display()
        ))),
        (None, packs) => {
            // What a link leads to now is served: no other that it leads to later.
            let whole = packs.iter().map(|pack| {
                let whole = pack.canonicalize();
                whole.with_context(|| format!("{}: cannot be opened", pack.display()))
            });
            let packs = whole.collect::<anyhow::Result<Vec<PathBuf>>>()?;
            let site = Box::new(Site::of(&open_packs(&packs)?, &About::default())?);
            Ok(holding(Holds::Site(site, SystemTime::now())))
        }
    }
}

fn holding(holds: Holds) -> ServedPlace {
    ServedPlace {
        holds,
        tags: ContentTags::default(),
    }
}

fn checked(folder: &Path) -> anyhow::Result<PathBuf> {
    let name = folder.display();
    let whole = folder.canonicalize();
    let whole = whole.with_context(|| format!("{name}: cannot be read"))?;
    if !whole.join("index.html").is_file() {
        bail!("{name}: holds no index.html; make a site: foveal export site PACK.. --out {name}");
    }
    Ok(whole)
}

async fn serve(args: &ServeArgs, place: ServedPlace) -> anyhow::Result<()> {
    let listen = &args.listen;
    let listener = TcpListener::bind(listen).await.with_context(|| {
        format!("--listen {listen}: cannot be listened on; give another, as 127.0.0.1:0")
    })?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut end = signal(SignalKind::terminate())?;
    let address = listener.local_addr()?;
    let serving = Serving {
        url: format!("http://{address}/"),
        address,
    };
    let is_local = address.ip().is_loopback();
    let hosts = args.host.iter().cloned();
    let is_open = !is_local && args.host.is_empty();
    let server = Arc::new(Server {
        place,
        hosts: (!is_open).then(|| hosts.collect()),
        allow_origin: args.allow_origin.clone(),
    });
    if is_open {
        output::say(
            "warning: pages elsewhere can read what is served here; --host NAME answers to that \
             name alone",
        );
    }
    let text = format!("{}\nCtrl-C ends it", serving.url);
    output::result(args.json, &serving, &text)?;
    let connections = Arc::new(Connections::default());
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = interrupt.recv() => return Ok(()),
            _ = end.recv() => return Ok(()),
        };
        let Ok((stream, from)) = accepted else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        let admitted = connections.admit(plain_address(from.ip()));
        tokio::spawn(connection(stream, admitted, Arc::clone(&server)));
    }
}

/// An IPv4 address that came as one of IPv6 is that of IPv4.
fn plain_address(address: IpAddr) -> IpAddr {
    address.to_canonical()
}

/// Answers what one connection asks until it ends.
async fn connection(stream: TcpStream, admitted: Admitted, server: Arc<Server>) {
    let ends = Arc::clone(&admitted.ends);
    let admitted = Arc::new(admitted);
    tokio::select! {
        () = answered(stream, &admitted, server) => {}
        () = ends.notified() => {}
    }
}

async fn answered(stream: TcpStream, admitted: &Arc<Admitted>, server: Arc<Server>) {
    let first = tokio::time::timeout(FIRST_BYTE, stream.peek(&mut [0])).await;
    if !matches!(first, Ok(Ok(1))) {
        return;
    }
    let _ = stream.set_nodelay(true);
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(PATIENCE));
    let answer = service_fn(|request| answer(request, Arc::clone(admitted), Arc::clone(&server)));
    // A connection that breaks off concerns only its other end.
    let _ = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(PATIENCE)
        .serve_connection(TokioIo::new(Box::pin(stream)), answer)
        .await;
}

/// The answer to a request, whose file is opened on another thread.
async fn answer(
    request: Request<Incoming>,
    admitted: Arc<Admitted>,
    server: Arc<Server>,
) -> Result<Response<WatchedBody>, tokio::task::JoinError> {
    let answering = admitted.answering();
    let answered = tokio::task::spawn_blocking(move || server.answer(&request));
    let answered = answered.await?;
    Ok(answered.map(|body| WatchedBody::new(body, answering)))
}
