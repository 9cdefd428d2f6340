//! How are a site or packs served to a browser?
//!
//! Plain HTTP/1.1 on loopback unless asked otherwise: files, byte ranges and the headers that
//! viewers in browsers need. Connections are bounded, and idle or slow ones end.

mod answer;
mod body;
mod place;
mod range;

use crate::commands::site::{About, Site};
use crate::report::output::{self, WrongUsage};
use answer::Server;
use anyhow::{Context, bail};
use clap::Args;
use hyper::Uri;
use hyper::header::HeaderValue;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use place::ServedPlace;
use serde::Serialize;
use std::convert::Infallible;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime};
use tokio::net::{TcpListener, TcpStream};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
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

/// Connections at a time; a browser opens six.
const CONNECTIONS: usize = 256;
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
    runtime.block_on(serve(args, place))
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

/// A folder, or a site of packs.
fn place(what: &[PathBuf]) -> anyhow::Result<ServedPlace> {
    let folder = what.iter().find(|path| path.is_dir());
    match (folder, what) {
        (Some(folder), [_]) => Ok(ServedPlace::Folder(checked(folder)?)),
        (Some(folder), _) => bail!(WrongUsage(format!(
            "{}: is a folder; give one folder, or packs",
            folder.display()
        ))),
        (None, packs) => Ok(ServedPlace::Site(
            Box::new(Site::of(packs, &About::default())?),
            SystemTime::now(),
        )),
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
    let server = Arc::new(Server {
        place,
        local: address.ip().is_loopback(),
        allow_origin: args.allow_origin.clone(),
    });
    let text = format!("{}\nCtrl-C ends it", serving.url);
    output::result(args.json, &serving, &text)?;
    let room = Arc::new(Semaphore::new(CONNECTIONS));
    loop {
        let permit = Arc::clone(&room).acquire_owned();
        let accepted = async {
            let permit = permit.await;
            (permit, listener.accept().await)
        };
        let accepted = tokio::select! {
            accepted = accepted => accepted,
            _ = interrupt.recv() => return Ok(()),
            _ = end.recv() => return Ok(()),
        };
        match accepted {
            (Ok(permit), Ok((stream, _))) => {
                tokio::spawn(connection(stream, permit, Arc::clone(&server)));
            }
            (Err(_), _) => return Ok(()),
            (Ok(_), Err(_)) => tokio::time::sleep(PAUSE).await,
        }
    }
}

/// Answers what one connection asks until it ends.
async fn connection(stream: TcpStream, permit: OwnedSemaphorePermit, server: Arc<Server>) {
    let _ = stream.set_nodelay(true);
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(PATIENCE));
    let answer = service_fn(move |request| {
        let response = server.answer(&request);
        async move { Ok::<_, Infallible>(response) }
    });
    // A connection that breaks off concerns nobody but its other end.
    let _ = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(PATIENCE)
        .serve_connection(TokioIo::new(Box::pin(stream)), answer)
        .await;
    drop(permit);
}
