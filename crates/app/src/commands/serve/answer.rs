//! What does the server answer to a request?

use crate::commands::serve::body::{AnswerBody, FilePart};
use crate::commands::serve::place::{Found, FoundContent, FoundFile, ServedPlace};
use crate::commands::serve::range::{Part, part_of};
use http_body_util::{Either, Full};
use hyper::body::Bytes;
use hyper::header::{self, HeaderMap, HeaderName, HeaderValue};
use hyper::http::uri::Authority;
use hyper::{Method, Request, Response, StatusCode, Version};
use std::net::IpAddr;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Everything that an answer depends on besides the request.
pub(super) struct Server {
    pub(super) place: ServedPlace,
    /// Names of hosts that requests may ask for besides this machine's; `None` for any.
    pub(super) hosts: Option<Vec<String>>,
    /// Pages of which origin may read what is served: none but its own without this.
    pub(super) allow_origin: Option<HeaderValue>,
}

/// Headers that a page of another origin may send, and that it may read.
const ASKED: &str = "range, if-match, if-none-match, if-range, if-modified-since, cache-control";
const TOLD: &str = "accept-ranges, content-length, content-range, etag, last-modified";

impl Server {
    /// The answer to a request.
    pub(super) fn answer<B>(&self, request: &Request<B>) -> Response<AnswerBody> {
        let mut response = self.content(request);
        let headers = response.headers_mut();
        put(headers, header::X_CONTENT_TYPE_OPTIONS, "nosniff");
        put(headers, header::REFERRER_POLICY, "no-referrer");
        // Always ask whether it is still so: what changed is shown, what did not costs no bytes.
        put(headers, header::CACHE_CONTROL, "no-cache");
        match &self.allow_origin {
            Some(origin) => {
                headers.insert(header::ACCESS_CONTROL_ALLOW_ORIGIN, origin.clone());
                put(headers, header::ACCESS_CONTROL_ALLOW_HEADERS, ASKED);
                put(headers, header::ACCESS_CONTROL_EXPOSE_HEADERS, TOLD);
                put(headers, header::VARY, "origin");
            }
            None => {
                let name = HeaderName::from_static("cross-origin-resource-policy");
                put(headers, name, "same-origin");
            }
        }
        response
    }

    fn content<B>(&self, request: &Request<B>) -> Response<AnswerBody> {
        match self.asks_for(request) {
            Asked::Here => {}
            Asked::Elsewhere => {
                // A page elsewhere whose name was made to lead here must not read what is served.
                let text = "this server answers to its own names only, such as localhost\n";
                return plain(StatusCode::MISDIRECTED_REQUEST, text);
            }
            Asked::Unclear => return plain(StatusCode::BAD_REQUEST, "one Host line is needed\n"),
        }
        match *request.method() {
            Method::GET | Method::HEAD => {}
            Method::OPTIONS if self.allow_origin.is_some() => {
                return plain(StatusCode::NO_CONTENT, "");
            }
            _ => {
                let mut refused = plain(StatusCode::METHOD_NOT_ALLOWED, "only GET and HEAD\n");
                put(refused.headers_mut(), header::ALLOW, "GET, HEAD");
                return refused;
            }
        }
        match self.place.find(request.uri().path()) {
            Found::File(file) => {
                let ranges = *request.method() == Method::GET;
                of_file(file, request.headers(), ranges)
            }
            Found::Folder => {
                let mut moved = plain(StatusCode::PERMANENT_REDIRECT, "");
                let there = format!("{}/", request.uri().path());
                if let Ok(there) = HeaderValue::from_str(&there) {
                    moved.headers_mut().insert(header::LOCATION, there);
                }
                moved
            }
            Found::Nothing => self.nothing(request),
        }
    }

    /// Where nothing lies: a page for people that says what does, a line for everything else.
    fn nothing<B>(&self, request: &Request<B>) -> Response<AnswerBody> {
        let accepted = request.headers().get(header::ACCEPT);
        let accepted = accepted.and_then(|value| value.to_str().ok());
        let for_people = accepted.is_some_and(|types| types.contains("text/html"));
        let page = for_people.then(|| self.place.page_of_nothing()).flatten();
        let Some(page) = page else {
            return plain(StatusCode::NOT_FOUND, "nothing here; the list is at /\n");
        };
        let mut response = Response::new(Either::Left(Full::new(Bytes::from(page))));
        *response.status_mut() = StatusCode::NOT_FOUND;
        for_a_page(response.headers_mut());
        response
    }
}

fn plain(status: StatusCode, text: &'static str) -> Response<AnswerBody> {
    let mut response = Response::new(Either::Left(Full::new(Bytes::from_static(text.as_bytes()))));
    *response.status_mut() = status;
    put(
        response.headers_mut(),
        header::CONTENT_TYPE,
        "text/plain; charset=utf-8",
    );
    response
}

fn put(headers: &mut HeaderMap, name: HeaderName, value: &'static str) {
    headers.insert(name, HeaderValue::from_static(value));
}

/// What every page is sent with.
fn for_a_page(headers: &mut HeaderMap) {
    put(headers, header::CONTENT_TYPE, content_type("a.html"));
    put(headers, header::CONTENT_SECURITY_POLICY, PAGE_POLICY);
    let name = HeaderName::from_static("permissions-policy");
    put(headers, name, PAGE_MAY);
}

/// Whom a request asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Asked {
    Here,
    Elsewhere,
    /// It does not say so, or more than once.
    Unclear,
}

/// A host with or without a port; nothing else may stand in a `Host` line.
fn authority_of(text: &str) -> Option<Authority> {
    let authority: Authority = text.parse().ok()?;
    let rest = text.strip_prefix(authority.host())?;
    // None is the usual one (RFC 9110, section 4.2.3).
    let is_port = |it: &str| {
        let is_number = it.bytes().all(|digit| digit.is_ascii_digit());
        is_number && (it.is_empty() || it.parse::<u16>().is_ok())
    };
    let is_plain = rest.is_empty() || rest.strip_prefix(':').is_some_and(is_port);
    is_plain.then_some(authority)
}

impl Server {
    /// Whether a request asks for this server by one of its names: in its `Host` line, and in its
    /// target where that names a host (RFC 9112, sections 3.2 and 3.2.2).
    fn asks_for<B>(&self, request: &Request<B>) -> Asked {
        let mut lines = request.headers().get_all(header::HOST).iter();
        let (host, more) = (lines.next(), lines.next());
        if more.is_some() || (host.is_none() && request.version() != Version::HTTP_10) {
            return Asked::Unclear;
        }
        let of_line = host.map(|host| host.to_str().ok().and_then(authority_of));
        if of_line == Some(None) {
            return Asked::Unclear;
        }
        let named = of_line.flatten();
        let asked = named.iter().chain(request.uri().authority());
        match asked.into_iter().all(|it| self.is_called(it)) {
            true => Asked::Here,
            false => Asked::Elsewhere,
        }
    }

    fn is_called(&self, authority: &Authority) -> bool {
        let Some(hosts) = &self.hosts else {
            return true;
        };
        let name = authority
            .host()
            .trim_start_matches('[')
            .trim_end_matches(']')
            .trim_end_matches('.')
            .to_ascii_lowercase();
        hosts.contains(&name)
            || name == "localhost"
            || name.ends_with(".localhost")
            || name
                .parse()
                .is_ok_and(|address: IpAddr| address.is_loopback())
    }
}

/// The file as it was asked for; only a GET may ask for a part (RFC 9110 section 14.2).
fn of_file(file: FoundFile, asked: &HeaderMap, ranges: bool) -> Response<AnswerBody> {
    let text = |name: HeaderName| asked.get(name).and_then(|value| value.to_str().ok());
    let (status, part) = match verdict(&file, text) {
        Some(status) => (status, Part::Whole),
        None if !ranges => (StatusCode::OK, Part::Whole),
        None => match range(&file, text) {
            Part::Whole => (StatusCode::OK, Part::Whole),
            Part::Outside => (StatusCode::RANGE_NOT_SATISFIABLE, Part::Outside),
            part => (StatusCode::PARTIAL_CONTENT, part),
        },
    };
    let (first, last) = match part {
        Part::Range(first, last) => (first, last + 1),
        _ => (0, file.length),
    };
    let has_body = status.is_success();
    let mut headers = HeaderMap::new();
    put(&mut headers, header::ACCEPT_RANGES, "bytes");
    put(&mut headers, header::CONTENT_TYPE, content_type(&file.name));
    if file.name.ends_with(".html") {
        for_a_page(&mut headers);
    }
    let mut tell = |name: HeaderName, value: String| {
        if let Ok(value) = HeaderValue::from_str(&value) {
            headers.insert(name, value);
        }
    };
    tell(header::ETAG, file.tag.clone());
    tell(
        header::LAST_MODIFIED,
        httpdate::fmt_http_date(file.modified),
    );
    match part {
        Part::Range(first, last) => {
            let told = format!("bytes {first}-{last}/{}", file.length);
            tell(header::CONTENT_RANGE, told);
        }
        Part::Outside => tell(header::CONTENT_RANGE, format!("bytes */{}", file.length)),
        Part::Whole => {}
    }
    if has_body {
        tell(header::CONTENT_LENGTH, (last - first).to_string());
    }
    let body = match file.content {
        FoundContent::File(file) if has_body => Either::Right(FilePart::new(file, first, last)),
        FoundContent::Bytes(bytes) if has_body => {
            let bytes = &bytes[first as usize..last as usize];
            Either::Left(Full::new(Bytes::copy_from_slice(bytes)))
        }
        _ => Either::Left(Full::default()),
    };
    let mut response = Response::new(body);
    *response.status_mut() = status;
    *response.headers_mut() = headers;
    response
}

/// What the conditions of a request come to, in the order of RFC 9110 section 13.2.2; `None` to
/// send the file.
fn verdict<'a>(
    file: &FoundFile,
    text: impl Fn(HeaderName) -> Option<&'a str>,
) -> Option<StatusCode> {
    let names_tag = |list: &str| {
        let same = |tag: &str| tag == "*" || tag.trim_start_matches("W/") == file.tag;
        list.split(',').any(|tag| same(tag.trim()))
    };
    let is_newer = |date: &str| httpdate::parse_http_date(date).map(|date| newer(file, date));
    if let Some(list) = text(header::IF_MATCH) {
        if !names_tag(list) {
            return Some(StatusCode::PRECONDITION_FAILED);
        }
    } else if let Some(Ok(true)) = text(header::IF_UNMODIFIED_SINCE).map(is_newer) {
        return Some(StatusCode::PRECONDITION_FAILED);
    }
    let unchanged = match text(header::IF_NONE_MATCH) {
        Some(list) => names_tag(list),
        // A date does not distinguish packs of one second.
        None if file.is_by_content => false,
        None => matches!(
            text(header::IF_MODIFIED_SINCE).map(is_newer),
            Some(Ok(false))
        ),
    };
    unchanged.then_some(StatusCode::NOT_MODIFIED)
}

fn range<'a>(file: &FoundFile, text: impl Fn(HeaderName) -> Option<&'a str>) -> Part {
    let Some(range) = text(header::RANGE) else {
        return Part::Whole;
    };
    let still_so = text(header::IF_RANGE).is_none_or(|mark| {
        let date = httpdate::parse_http_date(mark);
        let is_then = date.is_ok_and(|date| date == whole_seconds(file.modified));
        mark == file.tag || (!file.is_by_content && is_then)
    });
    if still_so {
        part_of(range, file.length)
    } else {
        Part::Whole
    }
}

/// A time as dates of headers give it.
fn whole_seconds(time: SystemTime) -> SystemTime {
    let since = time.duration_since(UNIX_EPOCH).unwrap_or_default();
    UNIX_EPOCH + Duration::from_secs(since.as_secs())
}

/// Whether a file changed after a date, which counts whole seconds.
fn newer(file: &FoundFile, date: SystemTime) -> bool {
    file.modified >= date + Duration::from_secs(1)
}

/// What pages may load: their own files, and gazes from this machine.
pub(super) const PAGE_POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; \
    style-src 'self'; img-src 'self' blob: data:; media-src 'self' blob:; worker-src 'self' blob:; \
    connect-src 'self' ws://127.0.0.1:* ws://localhost:*; base-uri 'none'; form-action 'none'; \
    frame-ancestors 'self'";
/// What pages may ask the device for.
const PAGE_MAY: &str = "xr-spatial-tracking=(self), accelerometer=(self), gyroscope=(self), \
    magnetometer=(self), fullscreen=(self), camera=(), microphone=(), geolocation=()";

/// The type of a file by its ending.
fn content_type(name: &str) -> &'static str {
    let ending = Path::new(name)
        .extension()
        .and_then(|ending| ending.to_str());
    match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("json" | "map") => "application/json",
        Some("wasm") => "application/wasm",
        Some("jpg" | "jpeg") => "image/jpeg",
        Some("png") => "image/png",
        Some("svg") => "image/svg+xml",
        Some("txt" | "md") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
