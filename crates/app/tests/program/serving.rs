//! Can no client stop the server for others, and does it send what was asked for?

use crate::bounded::crc32c;
use crate::scenes::{waves, write_clip};
use crate::site::{Answer, Server, wave_pack};
use crate::support::{Folder, done};
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::pack::{HEADER_BYTES, Header};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Longest wait for an answer, so that a server that hangs is a failure.
const PATIENCE: Duration = Duration::from_secs(30);

/// Sends these bytes and reads the answer, or none where the server hangs.
fn sent(address: &str, bytes: &[u8]) -> Option<Answer> {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(bytes).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).ok()?;
    (!answer.is_empty()).then(|| Answer::parse(&answer))
}

/// Whether a process ends well within the patience after SIGTERM.
fn ends(server: &mut Server) -> bool {
    let id = server.child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-TERM", &id])
            .status()
            .unwrap()
            .success()
    );
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        if let Some(status) = server.child.try_wait().unwrap() {
            return status.success();
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    false
}

#[test]
fn a_name_that_is_a_file_and_a_pipe_in_turn_stops_nobody() {
    let folder = Folder::new();
    folder.holding("index.html", b"page");
    let name = folder.name("turns.bin");
    let mut server = Server::start(&[&folder.name(".")]);
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let [file, pipe] = ["file", "pipe"].map(|it| folder.name(it));
            while !over.load(Ordering::Relaxed) {
                std::fs::write(&file, b"a file").unwrap();
                std::fs::rename(&file, &name).unwrap();
                if Command::new("mkfifo").arg(&pipe).status().is_ok() {
                    let _ = std::fs::rename(&pipe, &name);
                }
            }
        });
        let request = format!(
            "GET /turns.bin HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n",
            server.address
        );
        for number in 0..4000 {
            let answer = sent(&server.address, request.as_bytes());
            let status = answer.map(|it| it.status);
            if !matches!(status, Some(200 | 404)) {
                over.store(true, Ordering::Relaxed);
                panic!("request {number}: {status:?}");
            }
        }
        over.store(true, Ordering::Relaxed);
    });
    assert!(ends(&mut server), "SIGTERM does not end it");
}

#[test]
fn a_pack_that_was_named_is_sent_or_nothing() {
    let folder = Folder::new();
    let Some(pack) = wave_pack(&folder) else {
        return;
    };
    let server = Server::start(&[&pack]);
    let ask = || server.ask("GET", "/a.foveal", &["Range: bytes=0-7"]);
    let first = ask();
    assert_eq!(first.status, 206);
    let aside = folder.name("aside.foveal");
    std::fs::rename(&pack, &aside).unwrap();
    assert_eq!(ask().status, 404);
    std::os::unix::fs::symlink(&aside, &pack).unwrap();
    assert_eq!(ask().status, 404, "a link");
    std::fs::remove_file(&pack).unwrap();
    std::fs::create_dir(&pack).unwrap();
    assert_eq!(ask().status, 404, "a folder");
    std::fs::remove_dir(&pack).unwrap();
    std::fs::write(
        &pack,
        b"another file, long enough for a header of sixty-four bytes.....",
    )
    .unwrap();
    assert_eq!(ask().status, 404, "another file");
    std::fs::remove_file(&pack).unwrap();
    let clip = write_clip(&folder, "other.mkv", &waves([64, 64], 3));
    done(&["prepare", "video", &clip, "--out", &pack]);
    let other = ask();
    assert_eq!(other.status, 206);
    assert_ne!(other.header("etag"), first.header("etag"));
}

/// The pack with one bit of a chunk turned, and all checksums right again.
fn with_other_pixels(good: &[u8]) -> Vec<u8> {
    let header = Header::parse(good).unwrap();
    let description = &good[HEADER_BYTES..header.data_offset() as usize];
    let pack = VideoPack::begin(&header, description).unwrap();
    let mut bytes = good.to_vec();
    let turned = header.index_offset as usize - 1;
    bytes[turned] ^= 1;
    for page in 0..pack.index().pages() {
        let place = pack.index().page_place(page).unwrap();
        let place = place.start as usize..place.end as usize;
        let mut row = place.start + 16;
        while row < place.end {
            let number = |at: usize, n: usize| {
                let bytes = bytes[at..at + n].iter().rev();
                bytes.fold(0_u64, |sum, byte| sum << 8 | u64::from(*byte)) as usize
            };
            let (offset, length) = (number(row, 8), number(row + 8, 4));
            if offset + length == turned + 1 {
                let crc = crc32c(&bytes[offset..offset + length]);
                bytes[row + 12..row + 16].copy_from_slice(&crc.to_le_bytes());
            }
            row += 16;
        }
        let told = [
            &bytes[place.start..place.start + 12],
            &bytes[place.start + 16..place.end],
        ];
        let crc = crc32c(&told.concat());
        bytes[place.start + 12..place.start + 16].copy_from_slice(&crc.to_le_bytes());
    }
    bytes
}

#[test]
fn packs_of_other_pixels_have_another_tag_whatever_their_size_and_time() {
    let folder = Folder::new();
    folder.holding("index.html", b"page");
    let clip = write_clip(&folder, "a.mkv", &waves([96, 64], 3));
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack]);
    let good = std::fs::read(&pack).unwrap();
    let other = with_other_pixels(&good);
    let server = Server::start(&[&folder.name(".")]);
    let time = std::fs::metadata(&pack).unwrap().modified().unwrap();
    let tag = |bytes: &[u8]| {
        let place = folder.holding("b.foveal", bytes);
        let file = std::fs::File::options().write(true).open(&place).unwrap();
        file.set_modified(time).unwrap();
        let answer = server.ask("HEAD", "/b.foveal", &[]);
        answer.header("etag").unwrap().to_owned()
    };
    let [first, second, again] = [&good, &other, &good].map(|bytes| tag(bytes));
    assert_ne!(first, second);
    assert_eq!(first, again);
    // Both have one date: so a part of one must not pass as a part of the other.
    let whole = server.ask("GET", "/b.foveal", &[]);
    let date = whole.header("last-modified").unwrap();
    let by_date = server.ask(
        "GET",
        "/b.foveal",
        &[&format!("If-Range: {date}"), "Range: bytes=0-9"],
    );
    assert_eq!(by_date.status, 200);
    let by_date = server.ask("GET", "/b.foveal", &[&format!("If-Modified-Since: {date}")]);
    assert_eq!(by_date.status, 200);
    let verified = |bytes: &[u8]| {
        let place = folder.holding("c.foveal", bytes);
        done(&["info", &place])
    };
    verified(&other);
}

#[test]
fn a_new_client_is_answered_beside_many_that_say_nothing() {
    let folder = Folder::new();
    folder.holding("index.html", b"page");
    let server = Server::start(&[&folder.name(".")]);
    let mut idle = Vec::new();
    for _ in 0..700 {
        idle.extend(TcpStream::connect(&server.address));
    }
    assert!(idle.len() > 600, "{} connections", idle.len());
    assert_eq!(server.ask("GET", "/", &[]).body, b"page");
    // One that says nothing ends long before others would wait for it.
    let mut silent = TcpStream::connect(&server.address).unwrap();
    silent.set_read_timeout(Some(PATIENCE / 2)).unwrap();
    assert_eq!(silent.read_to_end(&mut Vec::new()).unwrap(), 0);
}

#[test]
fn many_slow_readers_keep_nobody_out() {
    let folder = Folder::new();
    folder.holding("index.html", b"page");
    let large = std::fs::File::create(folder.name("large.bin")).unwrap();
    large.set_len(1 << 30).unwrap();
    let server = Server::start(&[&folder.name(".")]);
    let request = format!(
        "GET /large.bin HTTP/1.1\r\nHost: {}\r\n\r\n",
        server.address
    );
    let mut readers = Vec::new();
    for _ in 0..300 {
        let mut reader = TcpStream::connect(&server.address).unwrap();
        if reader.write_all(request.as_bytes()).is_ok() {
            readers.push(reader);
        }
    }
    assert_eq!(server.ask("GET", "/", &[]).body, b"page");
}

#[test]
fn a_request_names_its_host_once_and_by_a_name_of_the_server() {
    let folder = Folder::new();
    folder.holding("index.html", b"page");
    let dot = folder.name(".");
    let server = Server::start(&[&dot]);
    let status = |server: &Server, head: &str| {
        let request = format!("{head}\r\nConnection: close\r\n\r\n");
        sent(&server.address, request.as_bytes()).map(|it| it.status)
    };
    let here = format!("Host: {}", server.address);
    for (head, expected) in [
        (format!("GET / HTTP/1.1\r\n{here}"), 200),
        (format!("GET / HTTP/1.1\r\n{here}\r\n{here}"), 400),
        ("GET / HTTP/1.1".to_owned(), 400),
        ("GET / HTTP/1.0".to_owned(), 200),
        (
            format!("GET http://{}/ HTTP/1.1\r\n{here}", server.address),
            200,
        ),
        (format!("GET http://other.example/ HTTP/1.1\r\n{here}"), 421),
        ("GET / HTTP/1.1\r\nHost: a@localhost".to_owned(), 400),
        ("GET / HTTP/1.1\r\nHost: localhost:x".to_owned(), 400),
        ("GET / HTTP/1.1\r\nHost: localhost:99999".to_owned(), 400),
        ("GET / HTTP/1.1\r\nHost: localhost:65536".to_owned(), 400),
        ("GET / HTTP/1.1\r\nHost: localhost:65535".to_owned(), 200),
        ("GET / HTTP/1.1\r\nHost: [::1]:99999".to_owned(), 400),
    ] {
        assert_eq!(status(&server, &head), Some(expected), "{head}");
    }
    let open = Server::listening("0.0.0.0:0", &[&dot]);
    let named = Server::listening("0.0.0.0:0", &[&dot, "--host", "Wall.example"]);
    for (name, of_open, of_named) in [
        ("other.example", 200, 421),
        ("wall.example", 200, 200),
        ("localhost", 200, 200),
    ] {
        let head = format!("GET / HTTP/1.1\r\nHost: {name}");
        let port = |server: &Server| {
            let port = server.address.rsplit(':').next().unwrap().to_owned();
            format!("127.0.0.1:{port}")
        };
        let of = |server: &Server| {
            let request = format!("{head}\r\nConnection: close\r\n\r\n");
            sent(&port(server), request.as_bytes()).map(|it| it.status)
        };
        assert_eq!(of(&open), Some(of_open), "{name}");
        assert_eq!(of(&named), Some(of_named), "{name}");
    }
}
