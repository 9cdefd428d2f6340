//! Are packs served, and put into sites, as a browser needs them?

use crate::scenes::{waves, write_clip};
use crate::support::{Folder, command, done, foveal, json, refused, skipped};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdout, Stdio};

/// A server that ends with the value.
pub(crate) struct Server {
    pub(crate) child: Child,
    pub(crate) address: String,
    _stdout: BufReader<ChildStdout>,
}

impl Server {
    pub(crate) fn start(arguments: &[&str]) -> Self {
        Self::listening("127.0.0.1:0", arguments)
    }

    /// One that listens at an address.
    pub(crate) fn listening(address: &str, arguments: &[&str]) -> Self {
        let mut command = command(&["serve"]);
        command
            .args(arguments)
            .args(["--listen", address, "--json"]);
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        stdout.read_line(&mut line).unwrap();
        let told: Value = serde_json::from_str(&line).unwrap();
        let address = told["address"].as_str().unwrap().to_owned();
        assert_eq!(told["url"], format!("http://{address}/"));
        Self {
            child,
            address,
            _stdout: stdout,
        }
    }

    /// The answer to a request with these header lines.
    pub(crate) fn ask(&self, method: &str, path: &str, headers: &[&str]) -> Answer {
        let host = format!("Host: {}", self.address);
        self.ask_as(&host, method, path, headers)
    }

    pub(crate) fn ask_as(&self, host: &str, method: &str, path: &str, headers: &[&str]) -> Answer {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        let lines = headers.join("\r\n");
        let more = if lines.is_empty() { "" } else { "\r\n" };
        let head = format!("{method} {path} HTTP/1.1\r\n{host}\r\nConnection: close{more}{lines}");
        stream
            .write_all(format!("{head}\r\n\r\n").as_bytes())
            .unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        Answer::parse(&bytes)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn parse(bytes: &[u8]) -> Self {
        let end = bytes
            .windows(4)
            .position(|four| four == b"\r\n\r\n")
            .unwrap();
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        Self {
            status: head.split(' ').nth(1).unwrap().parse().unwrap(),
            body: bytes[end + 4..].to_vec(),
            head,
        }
    }

    /// The value of a header, by its name in small letters.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        let line = self.head.lines().find(|line| {
            line.split_once(':')
                .is_some_and(|(found, _)| found.eq_ignore_ascii_case(name))
        });
        line.and_then(|line| Some(line.split_once(':')?.1.trim()))
    }
}

/// A folder with a page and a file that counts.
fn counted() -> (Folder, Vec<u8>) {
    let folder = Folder::new();
    folder.holding("index.html", b"<!doctype html><title>a</title>");
    let bytes: Vec<u8> = (0..300_000_u32).map(|n| (n / 3) as u8).collect();
    folder.holding("a b.foveal", &bytes);
    std::fs::create_dir(folder.name("inner")).unwrap();
    folder.holding("inner/index.html", b"inner");
    (folder, bytes)
}

#[test]
fn a_served_range_is_that_part_of_the_file() {
    let (folder, bytes) = counted();
    let server = Server::start(&[&folder.name(".")]);
    let whole = server.ask("GET", "/a%20b.foveal", &[]);
    assert_eq!((whole.status, &whole.body), (200, &bytes));
    assert_eq!(whole.header("accept-ranges"), Some("bytes"));
    assert_eq!(
        whole.header("content-type"),
        Some("application/octet-stream")
    );
    for (range, first, end) in [
        ("0-63", 0, 64),
        ("70000-250000", 70_000, 250_001),
        ("299999-", 299_999, 300_000),
        ("-10", 299_990, 300_000),
    ] {
        let part = server.ask("GET", "/a%20b.foveal", &[&format!("Range: bytes={range}")]);
        assert_eq!(part.status, 206, "{range}");
        let told = format!("bytes {first}-{}/300000", end - 1);
        assert_eq!(part.header("content-range"), Some(told.as_str()));
        assert_eq!(part.body, bytes[first..end], "{range}");
    }
    let beyond = server.ask("GET", "/a%20b.foveal", &["Range: bytes=300000-"]);
    assert_eq!(beyond.status, 416);
    assert_eq!(beyond.header("content-range"), Some("bytes */300000"));
    let head = server.ask("HEAD", "/a%20b.foveal", &["Range: bytes=0-9"]);
    assert_eq!(
        (head.status, head.header("content-length")),
        (200, Some("300000"))
    );
    assert!(head.body.is_empty());
    let part = server.ask("GET", "/a%20b.foveal", &["Range: Bytes=0-9"]);
    assert_eq!(part.status, 206, "units are written in any case");
}

#[test]
fn what_did_not_change_is_not_sent_again() {
    let (folder, bytes) = counted();
    let server = Server::start(&[&folder.name(".")]);
    let ask = |headers: &[&str]| server.ask("GET", "/a%20b.foveal", headers);
    let first = ask(&[]);
    let tag = first.header("etag").unwrap().to_owned();
    let date = first.header("last-modified").unwrap().to_owned();
    assert_eq!(first.header("cache-control"), Some("no-cache"));
    assert_eq!(ask(&[&format!("If-None-Match: {tag}")]).status, 304);
    assert_eq!(ask(&[&format!("If-Modified-Since: {date}")]).status, 304);
    assert_eq!(ask(&["If-None-Match: \"other\""]).status, 200);
    assert_eq!(
        ask(&["If-Match: \"other\"", "Range: bytes=0-9"]).status,
        412
    );
    assert_eq!(
        ask(&[&format!("If-Match: {tag}"), "Range: bytes=0-9"]).status,
        206
    );
    // A range of another file than the one that is there is of no use: all of it comes.
    let stale = ask(&["If-Range: \"other\"", "Range: bytes=0-9"]);
    assert_eq!((stale.status, stale.body.len()), (200, bytes.len()));
    assert_eq!(
        ask(&[&format!("If-Range: {tag}"), "Range: bytes=0-9"]).status,
        206
    );
    let by_date = |date: &str| ask(&[&format!("If-Range: {date}"), "Range: bytes=0-9"]).status;
    assert_eq!(by_date(&date), 206);
    assert_eq!(by_date("Fri, 01 Jan 2100 00:00:00 GMT"), 200);
}

#[test]
fn nothing_outside_the_folder_is_served() {
    let (folder, _) = counted();
    let outside = Folder::new();
    outside.holding("secret.txt", b"secret");
    folder.holding(".hidden", b"secret");
    let name = outside.file_name().unwrap().to_str().unwrap().to_owned();
    std::os::unix::fs::symlink(outside.name("secret.txt"), folder.name("link.txt")).unwrap();
    std::os::unix::fs::symlink(&*outside, folder.name("links")).unwrap();
    let server = Server::start(&[&folder.name(".")]);
    let paths = [
        "/link.txt".to_owned(),
        "/links/secret.txt".to_owned(),
        "/.hidden".to_owned(),
        format!("/../{name}/secret.txt"),
        format!("/%2e%2e/{name}/secret.txt"),
        format!("/inner/..%2f..%2f{name}/secret.txt"),
        format!("//{}", outside.name("secret.txt")),
        "/etc/passwd".to_owned(),
        "/inner//index.html".to_owned(),
    ];
    for path in paths {
        let answer = server.ask("GET", &path, &[]);
        assert_eq!(answer.status, 404, "{path}: {answer:?}");
    }
    assert_eq!(server.ask("GET", "/", &[]).status, 200);
    assert_eq!(server.ask("GET", "/inner/", &[]).body, b"inner");
    assert_eq!(
        server.ask("GET", "/inner", &[]).header("location"),
        Some("/inner/")
    );
    assert_eq!(server.ask("POST", "/", &[]).status, 405);
}

#[test]
fn pages_of_other_origins_read_nothing_unless_they_are_allowed() {
    let (folder, _) = counted();
    let dot = folder.name(".");
    let origin = "Origin: https://other.example";
    let server = Server::start(&[&dot]);
    let answer = server.ask("GET", "/a%20b.foveal", &[origin]);
    assert_eq!(answer.header("access-control-allow-origin"), None);
    assert_eq!(
        answer.header("cross-origin-resource-policy"),
        Some("same-origin")
    );
    // A foreign host name that was made to lead here.
    for host in [
        "Host: other.example",
        "Host: 10.0.0.1:80",
        "Host: localhost.other.example",
    ] {
        assert_eq!(server.ask_as(host, "GET", "/", &[]).status, 421, "{host}");
    }
    for host in ["Host: LOCALHOST:80", "Host: [::1]:80", "Host: a.localhost"] {
        assert_eq!(server.ask_as(host, "GET", "/", &[]).status, 200, "{host}");
    }
    let open = Server::start(&[&dot, "--allow-origin", "https://other.example"]);
    let answer = open.ask("OPTIONS", "/a%20b.foveal", &[origin]);
    assert_eq!(answer.status, 204);
    let answer = open.ask("GET", "/a%20b.foveal", &[origin, "Range: bytes=0-9"]);
    let allowed = answer.header("access-control-allow-origin");
    assert_eq!(
        (answer.status, allowed),
        (206, Some("https://other.example"))
    );
    let told = answer.header("access-control-expose-headers").unwrap();
    assert!(told.contains("content-range") && told.contains("etag"));
}

#[test]
fn what_cannot_be_served_or_exported_is_refused_with_the_next_step() {
    let folder = Folder::new();
    let dot = folder.name(".");
    refused(
        1,
        &["serve", &dot],
        &["no index.html", "foveal export site"],
    );
    refused(
        1,
        &["serve", &folder.name("none")],
        &["none", "cannot be opened"],
    );
    refused(2, &["serve", &dot, &dot], &["is a folder"]);
    for origin in [
        "https://other.example/",
        "other.example",
        "HTTPS://a.example",
    ] {
        refused(
            2,
            &["serve", &dot, "--allow-origin", origin],
            &[origin, "an origin without a path"],
        );
    }
    folder.holding("index.html", b"");
    refused(
        1,
        &["serve", &dot, "--listen", "256.0.0.1:1"],
        &["256.0.0.1:1", "give another"],
    );
    let text = folder.holding(
        "text.foveal",
        b"no pack at all, but long enough to have a header..",
    );
    let out = folder.name("site");
    let export = |packs: &[&str], out: &str, code: i32, words: &[&str]| {
        let mut arguments = vec!["export", "site"];
        arguments.extend(packs);
        arguments.extend(["--out", out]);
        refused(code, &arguments, words);
    };
    export(&[&text], &out, 1, &["text.foveal"]);
    export(
        &[&text, &text],
        &out,
        2,
        &["both be text.foveal", "rename one"],
    );
    export(
        &[&text],
        &dot,
        2,
        &["not empty", "give a new or an empty one"],
    );
    export(&[&text], &text, 1, &["text.foveal", "no folder"]);
    assert_eq!(folder.names(), ["index.html", "text.foveal"]);
}

/// A pack of waves, and whether this program carries its pages.
pub(crate) fn wave_pack(folder: &Folder) -> Option<String> {
    let clip = write_clip(folder, "a.mkv", &waves([96, 64], 9));
    let pack = folder.name("a.foveal");
    done(&["prepare", "video", &clip, "--out", &pack]);
    let ran = foveal(&["export", "site", &pack, "--out", "none", "--dry-run"]);
    if ran.stderr.contains("built without its pages") {
        skipped("the program carries no pages; run `cargo xtask web` and build again");
        return None;
    }
    assert_eq!(ran.code, Some(0), "{ran:?}");
    Some(pack)
}

#[test]
fn a_damaged_pack_is_published_and_told() {
    let folder = Folder::new();
    let Some(pack) = wave_pack(&folder) else {
        return;
    };
    let mut bytes = std::fs::read(&pack).unwrap();
    // Before the index, whose place the header gives (docs/formats/pack.md), is the last chunk.
    let index = u64::from_le_bytes(bytes[24..32].try_into().unwrap());
    bytes[index as usize - 9] ^= 1;
    let pack = folder.holding("b.foveal", &bytes);
    let ran = done(&["export", "site", &pack, "--out", &folder.name("site")]);
    assert!(
        ran.stderr.contains("1 damaged place in all"),
        "{}",
        ran.stderr
    );
    assert!(
        !done(&[
            "export",
            "site",
            &folder.name("a.foveal"),
            "--out",
            &folder.name("whole")
        ])
        .stderr
        .contains("damaged")
    );
}

#[test]
fn a_list_tells_pictures_which_have_no_time_from_videos() {
    let folder = Folder::new();
    let Some(video) = wave_pack(&folder) else {
        return;
    };
    let clip = write_clip(&folder, "b.mkv", &waves([96, 64], 1));
    let picture = folder.name("b.foveal");
    done(&["prepare", "video", &clip, "--out", &picture]);
    let site = folder.name("site");
    done(&["export", "site", &video, &picture, "--out", &site]);
    let list = std::fs::read(format!("{site}/packs.json")).unwrap();
    let list: Value = serde_json::from_slice(&list).unwrap();
    let told = |pack: usize, key: &str| &list["packs"][pack][key];
    assert_eq!(
        [told(0, "content"), told(1, "content")],
        ["video", "picture"]
    );
    for key in ["fps", "seconds"] {
        assert!(told(0, key).is_f64() && told(1, key).is_null(), "{list}");
    }
}

#[test]
fn a_site_holds_pages_packs_posters_and_their_list() {
    let folder = Folder::new();
    let Some(pack) = wave_pack(&folder) else {
        return;
    };
    let out = folder.name("deep/site");
    let dry = json(&["export", "site", &pack, "--out", &out, "--dry-run"]);
    assert!(!std::path::Path::new(&out).exists());
    let told = json(&["export", "site", &pack, "--out", &out]);
    assert_eq!(told["files"], dry["files"]);
    assert_eq!(told["bytes"], dry["bytes"]);
    let read = |name: &str| std::fs::read(format!("{out}/{name}")).unwrap();
    let list: Value = serde_json::from_slice(&read("packs.json")).unwrap();
    let listed = &list["packs"][0];
    assert_eq!(
        (&listed["name"], &listed["file"]),
        (&"a".into(), &"a.foveal".into())
    );
    assert_eq!(read("a.foveal"), std::fs::read(&pack).unwrap());
    let poster = read(listed["poster"]["file"].as_str().unwrap());
    assert_eq!(poster[..3], [0xff, 0xd8, 0xff]);
    for page in ["index.html", "view.html"] {
        let page = String::from_utf8(read(page)).unwrap();
        assert!(page.contains("Content-Security-Policy"));
        assert!(!page.contains("http://") && !page.contains("https://"));
    }
    let partial = |name: &String| name.ends_with(".partial");
    assert!(!folder.names().iter().any(partial));
    // A site may be made again in its place, be it from the pack that lies there.
    let there = format!("{out}/a.foveal");
    json(&["export", "site", &there, "--out", &out]);
    assert_eq!(read("a.foveal"), std::fs::read(&pack).unwrap());
    assert!(!std::path::Path::new(&format!("{there}.partial")).exists());
    // What is withdrawn is gone; what others put there stays.
    let other = folder.name("b.foveal");
    std::fs::copy(&pack, &other).unwrap();
    std::fs::write(format!("{out}/robots.txt"), "mine").unwrap();
    json(&["export", "site", &other, "--out", &out]);
    assert_eq!(read("b.foveal"), std::fs::read(&pack).unwrap());
    assert!(!std::path::Path::new(&there).exists());
    assert_eq!(read("robots.txt"), b"mine");
}

#[test]
fn a_site_says_of_its_packs_what_its_maker_says_in_the_order_that_was_asked_for() {
    let folder = Folder::new();
    let Some(pack) = wave_pack(&folder) else {
        return;
    };
    let others = ["b c.foveal", "d.foveal"].map(|name| {
        let other = folder.name(name);
        std::fs::copy(&pack, &other).unwrap();
        other
    });
    let out = folder.name("site");
    let about = folder.holding(
        "about.toml",
        b"[a]\ntitle = \"<b>Waves</b> & more\"\ndescription = \"First.\\nSecond.\"\n\
          licence = \"CC BY 4.0\"\n[\"b c.foveal\"]\nlicence = 'CC0'\n",
    );
    let export = [
        "export", "site", &pack, &others[0], &others[1], "--out", &out,
    ];
    let title = "Films & <i>\"more\"</i>";
    let options = ["--title", title, "--order", "d,b c", "--about", &about];
    let told = json(&[&export[..], &options].concat());
    let read = |name: &str| std::fs::read_to_string(format!("{out}/{name}")).unwrap();
    let list: Value = serde_json::from_str(&read("packs.json")).unwrap();
    assert_eq!(told["packs"], list["packs"]);
    let packs = list["packs"].as_array().unwrap();
    let said = |key: &str| {
        packs
            .iter()
            .map(|pack| pack[key].clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(said("name"), ["d", "b c", "a"]);
    assert_eq!(said("title"), ["d", "b c", "<b>Waves</b> & more"]);
    assert_eq!(
        said("licence"),
        [Value::Null, "CC0".into(), "CC BY 4.0".into()]
    );
    assert_eq!(packs[2]["description"], "First.\nSecond.");
    let escaped = "Films &amp; &lt;i&gt;&quot;more&quot;&lt;/i&gt;";
    let page = read("index.html");
    for tag in ["title", "h1"] {
        assert!(
            page.contains(&format!("<{tag}>{escaped}</{tag}>")),
            "{page}"
        );
    }
    // Without a title the name is the title.
    json(&export);
    assert!(read("index.html").contains("<h1>Videos</h1>"));
    let list: Value = serde_json::from_str(&read("packs.json")).unwrap();
    assert_eq!(list["packs"][0]["title"], "a");
    assert_eq!(list["packs"][0].get("licence"), None);
}

#[test]
fn what_a_site_cannot_say_is_refused_with_the_place_and_the_next_step() {
    let folder = Folder::new();
    let Some(pack) = wave_pack(&folder) else {
        return;
    };
    let out = folder.name("site");
    let refused = |code: i32, options: &[&str], words: &[&str]| {
        let export = ["export", "site", &pack, "--out", &out];
        refused(code, &[&export[..], options].concat(), words);
    };
    refused(
        2,
        &["--order", "a,z"],
        &["--order", "no pack is named z", "names out of a"],
    );
    refused(
        2,
        &["--title", " "],
        &["--title is empty", "1 to 200 characters"],
    );
    refused(
        2,
        &["--title", "a\nb"],
        &["--title is broken by a line's end"],
    );
    let long = "x".repeat(201);
    refused(2, &["--title", &long], &["--title is 201 characters long"]);
    refused(
        1,
        &["--about", &folder.name("none.toml")],
        &["none.toml", "about packs"],
    );
    let files = [
        (
            "[z]\ntitle = 'Z'",
            &["[z]", "no pack is named so", "names out of a"][..],
        ),
        ("[a]\ntitel = 'A'", &["line 2", "titel", "title"]),
        ("[a]\nlicence = 3", &["line 2", "string"]),
        ("title = 'A'", &["line 1"]),
        ("[a]\ntitle = ''", &["[a]", "title is empty", "1 to 200"]),
        ("[a]\nlicence = \"a\\nb\"", &["[a]", "licence is broken"]),
        ("[a", &["line 1"]),
    ];
    for (text, words) in files {
        let about = folder.holding("about.toml", text.as_bytes());
        refused(
            1,
            &["--about", &about],
            &[&["--about", "about.toml"], words].concat(),
        );
    }
    assert!(!std::path::Path::new(&out).exists());
}

#[test]
fn packs_are_served_as_a_site_that_nobody_wrote() {
    let folder = Folder::new();
    let Some(pack) = wave_pack(&folder) else {
        return;
    };
    let server = Server::start(&[&pack]);
    let page = server.ask("GET", "/", &[]);
    assert_eq!(
        (page.status, page.header("content-type")),
        (200, Some("text/html; charset=utf-8"))
    );
    assert!(
        page.header("content-security-policy")
            .unwrap()
            .contains("default-src 'none'")
    );
    let part = server.ask("GET", "/a.foveal", &["Range: bytes=0-7"]);
    assert_eq!(
        (part.status, part.body.as_slice()),
        (206, b"FOVEAL\r\n".as_slice())
    );
    assert_eq!(server.ask("GET", "/packs.json", &[]).status, 200);
    assert_eq!(server.ask("GET", "/a.mkv", &[]).status, 404);
}

#[test]
fn where_nothing_lies_people_get_a_page_that_works_at_any_depth_and_others_a_line() {
    let folder = Folder::new();
    let Some(pack) = wave_pack(&folder) else {
        return;
    };
    let site = folder.name("site");
    done(&["export", "site", &pack, "--out", &site]);
    for what in [pack, site] {
        let server = Server::start(&[&what]);
        for path in ["/missing", "/deep/er/missing/"] {
            let told = server.ask("GET", path, &["Accept: text/html,*/*;q=0.8"]);
            let kind = told.header("content-type");
            assert_eq!((told.status, kind), (404, Some("text/html; charset=utf-8")));
            assert!(told.header("content-security-policy").is_some());
            let page = String::from_utf8(told.body).unwrap();
            assert!(page.contains("href=\"/index.html\""), "{page}");
            let script = page.split("src=\"").nth(1).unwrap();
            let script = script.split('"').next().unwrap();
            assert_eq!(server.ask("GET", script, &[]).status, 200, "{script}");
        }
        let told = server.ask("GET", "/missing.foveal", &["Range: bytes=0-7"]);
        let kind = told.header("content-type");
        assert_eq!(
            (told.status, kind),
            (404, Some("text/plain; charset=utf-8"))
        );
    }
}

#[test]
fn a_server_ends_well_when_it_is_interrupted() {
    let (folder, _) = counted();
    let mut server = Server::start(&[&folder.name(".")]);
    let id = server.child.id().to_string();
    let killed = std::process::Command::new("kill")
        .args(["-INT", &id])
        .status();
    assert!(killed.unwrap().success());
    assert_eq!(server.child.wait().unwrap().code(), Some(0));
}
