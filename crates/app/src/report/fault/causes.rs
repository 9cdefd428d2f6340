//! What is to be done about a cause that says only what it is?

use foveal_core::pack::PackError;
use foveal_render::RenderError;
use std::io::ErrorKind;

/// Advice for the innermost cause that there is some for.
pub(super) fn advice(error: &anyhow::Error) -> Option<&'static str> {
    error.chain().rev().find_map(|cause| {
        if let Some(system) = cause.downcast_ref::<std::io::Error>() {
            return of_number(system).or_else(|| of_system(system.kind()));
        }
        if cause.is::<PackError>() {
            return Some("copy the pack again, or prepare it again");
        }
        if cause.is::<RenderError>() {
            return Some("give --renderer cpu, or another GPU");
        }
        None
    })
}

/// Advice for what the system ran out of, which has no kind of its own.
#[cfg(unix)]
fn of_number(error: &std::io::Error) -> Option<&'static str> {
    Some(match error.raw_os_error()? {
        libc::EMFILE => "raise the limit on open files: `ulimit -n 4096` before the command",
        libc::ENFILE => "too many files are open on this machine: close other programs",
        libc::ENOMEM => "close other programs, or raise the limit on memory: `ulimit -v`",
        libc::EAGAIN => "raise the limits on threads and memory: `ulimit -u`, `ulimit -v`",
        libc::ENAMETOOLONG => "give a shorter name",
        libc::ELOOP => "links lead round in a circle there; give the file itself",
        libc::EIO => "the disk cannot be read or written there; check it, or copy from elsewhere",
        _ => return None,
    })
}

#[cfg(not(unix))]
fn of_number(_error: &std::io::Error) -> Option<&'static str> {
    None
}

/// Advice for what the system refused.
fn of_system(kind: ErrorKind) -> Option<&'static str> {
    Some(match kind {
        ErrorKind::NotFound => "check the path",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "check the permissions",
        ErrorKind::AlreadyExists => "give another name",
        ErrorKind::NotADirectory => "a part of the path is a file; check the path",
        ErrorKind::IsADirectory => "give a file, not a folder",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "make room, or write elsewhere"
        }
        ErrorKind::InvalidData => "check that this is the right file",
        ErrorKind::UnexpectedEof => "the file ends early; copy it again",
        ErrorKind::AddrInUse => "give another port",
        ErrorKind::AddrNotAvailable => "give an address of this machine",
        ErrorKind::ConnectionRefused | ErrorKind::TimedOut | ErrorKind::HostUnreachable => {
            "check that the other side runs and listens there"
        }
        _ => return None,
    })
}
