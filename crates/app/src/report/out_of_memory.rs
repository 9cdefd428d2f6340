//! How is running out of memory reported, without any memory?

use crate::report::called::json_asked;
use crate::report::output::has_printed;
use std::io::Write;

/// Longest line that is printed, in bytes.
const MOST_BYTES: usize = 320;

/// What can be done about it.
const NEXT: &str = "close other programs, raise the limit (`ulimit -v`), or give less to do at \
                    once, as with --jobs 1";

/// Says on stderr, and under `--json` on stdout, that so many bytes could not be had. Allocates
/// nothing and takes no lock.
pub(crate) fn tell(bytes: usize) {
    let mut line = Line::default();
    let told = writeln!(
        line,
        "error: there is no memory left: {bytes} bytes more cannot be had; {NEXT}"
    );
    if told.is_ok() {
        line.send(2);
    }
    if !json_asked() || has_printed() {
        return;
    }
    let mut object = Line::default();
    let told = writeln!(
        object,
        "{{\"error\":{{\"what\":\"there is no memory left: {bytes} bytes more cannot be had\",\
         \"where\":\"foveal\",\"next\":\"{NEXT}\"}}}}"
    );
    if told.is_ok() {
        object.send(1);
    }
}

/// A line on the stack.
struct Line {
    bytes: [u8; MOST_BYTES],
    length: usize,
}

impl Default for Line {
    fn default() -> Self {
        Self {
            bytes: [0; MOST_BYTES],
            length: 0,
        }
    }
}

impl Line {
    /// Writes it to a file that is open, past what buffers it.
    #[cfg(unix)]
    fn send(&self, to: i32) {
        #[allow(unsafe_code, reason = "a call of C")]
        // SAFETY: the bytes are there, and so many; where it fails, stderr is closed.
        unsafe {
            libc::write(to, self.bytes.as_ptr().cast(), self.length);
        }
    }

    #[cfg(not(unix))]
    fn send(&self, _to: i32) {}
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let room = &mut self.bytes[self.length..];
        let taken = bytes.len().min(room.len());
        room[..taken].copy_from_slice(&bytes[..taken]);
        self.length += taken;
        Ok(taken)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_holds_what_is_told_of_the_most_bytes() {
        let mut line = Line::default();
        write!(line, "{}: {NEXT}{NEXT}{NEXT}{NEXT}", usize::MAX).unwrap_err();
        assert_eq!(line.length, MOST_BYTES);
        let mut object = Line::default();
        let wraps = "{\"error\":{\"what\":\"there is no memory left:  bytes more cannot be had\",\
                     \"where\":\"foveal\",\"next\":\"\"}}\n";
        write!(object, "{}{wraps}{NEXT}", usize::MAX).unwrap();
    }
}
