//! Which window of an X display has a title?

use super::source::CaptureError;
use foveal_core::units::one_line;
use x11rb::connection::Connection;
use x11rb::protocol::composite::{ConnectionExt as _, Redirect};
use x11rb::protocol::xproto::{Atom, AtomEnum, ConnectionExt, Window};
use x11rb::rust_connection::RustConnection;

/// Most windows that are asked for their titles, and most titles that a message lists.
const MOST_WINDOWS: usize = 4096;
const MOST_LISTED: usize = 12;
/// Most bytes of a title that are looked at, in words.
const TITLE_WORDS: u32 = 256;

/// The window called `title`, or else the only one whose title holds it.
pub(super) fn window_titled(title: &str) -> Result<u32, CaptureError> {
    let name = format!("x11:{title}");
    let wrong = |reason: String, next: String| CaptureError::Open {
        name: name.clone(),
        reason,
        next,
    };
    let (connection, screen) = x11rb::connect(None).map_err(|error| {
        let (reason, next) = no_display(&error.to_string());
        wrong(reason, next)
    })?;
    let titles = titles(&connection, screen).map_err(|error| {
        let next = "try again, or give the window by its number, as xwininfo prints it";
        wrong(
            format!("the X server does not list its windows: {error}"),
            next.to_owned(),
        )
    })?;
    let called = |is_it: &dyn Fn(&str) -> bool| -> Vec<Window> {
        let found = titles.iter().filter(|(_, it)| is_it(it));
        found.map(|(window, _)| *window).collect()
    };
    let whole = called(&|it| it == title);
    let found = match whole.is_empty() {
        true => called(&|it| it.contains(title)),
        false => whole,
    };
    match found[..] {
        [window] => Ok(window),
        [] => {
            let known: Vec<&str> = titles.iter().map(|(_, it)| it.as_str()).collect();
            Err(wrong(
                format!("no window has this title; {}", listed(&known)),
                SEES.to_owned(),
            ))
        }
        _ => {
            let numbers: Vec<String> = found.iter().map(|it| format!("x11:{it:#x}")).collect();
            Err(wrong(
                "several windows have this title".to_owned(),
                format!("give one of {}", numbers.join(", ")),
            ))
        }
    }
}

/// Has the X server keep all of a window, also what others cover, as long as the connection that
/// is returned lives; `None` where it has no such extension.
pub(super) fn keep_covered(window: u32) -> Option<RustConnection> {
    let (connection, _) = x11rb::connect(None).ok()?;
    connection
        .composite_query_version(0, 4)
        .ok()?
        .reply()
        .ok()?;
    let kept = connection.composite_redirect_window(window, Redirect::AUTOMATIC);
    kept.ok()?.check().ok()?;
    Some(connection)
}

/// What to do where a window is not found.
const SEES: &str = "give a title or `x11:root`; X does not see windows of Wayland: start the \
                    application with GDK_BACKEND=x11 or QT_QPA_PLATFORM=xcb";

/// What is wrong, and what to do, where no display answers.
pub(super) fn no_display(reason: &str) -> (String, String) {
    let next = match std::env::var_os("WAYLAND_DISPLAY") {
        Some(_) => {
            "this is a Wayland session: set DISPLAY to that of Xwayland, and start what is \
                    to be shown as an X application"
        }
        None => "set DISPLAY to that of a running X server, such as :0",
    };
    (format!("no X display answers: {reason}"), next.to_owned())
}

fn listed(titles: &[&str]) -> String {
    let some = titles.iter().take(MOST_LISTED);
    let some = some.map(|it| format!("`{}`", one_line(it)));
    let some: Vec<String> = some.collect();
    let more = titles.len().saturating_sub(MOST_LISTED);
    match (some.is_empty(), more) {
        (true, _) => "no window has one".to_owned(),
        (false, 0) => format!("there are {}", some.join(", ")),
        (false, more) => format!("there are {} and {more} more", some.join(", ")),
    }
}

/// All windows that have a title, and it.
fn titles(
    connection: &RustConnection,
    screen: usize,
) -> Result<Vec<(Window, String)>, Box<dyn std::error::Error>> {
    let atom = |name: &[u8]| -> Result<Atom, Box<dyn std::error::Error>> {
        Ok(connection.intern_atom(false, name)?.reply()?.atom)
    };
    let properties = [
        (atom(b"_NET_WM_NAME")?, atom(b"UTF8_STRING")?),
        (AtomEnum::WM_NAME.into(), AtomEnum::ANY.into()),
    ];
    let root = connection.setup().roots[screen].root;
    let mut windows = vec![root];
    let mut titles = Vec::new();
    let mut next = 0;
    while next < windows.len().min(MOST_WINDOWS) {
        let window = windows[next];
        next += 1;
        // A window may go while it is asked.
        if let Ok(tree) = connection.query_tree(window)?.reply() {
            windows.extend(tree.children);
        }
        for (property, kind) in properties {
            let asked = connection.get_property(false, window, property, kind, 0, TITLE_WORDS)?;
            let Ok(told) = asked.reply() else { continue };
            if !told.value.is_empty() {
                titles.push((window, String::from_utf8_lossy(&told.value).into_owned()));
                break;
            }
        }
    }
    Ok(titles)
}
