//! What does a portable float map say of each pixel?

use foveal_core::view::panel::residual_grid::ResidualGrid;

/// Reads the bytes of a file beside the rig file, or tells why not.
pub(super) type ReadBeside<'a> = &'a dyn Fn(&str) -> Result<Vec<u8>, String>;

/// Reads a map of three floats a pixel for a panel of `size`: the share of the ideal panel to the
/// right and down, and one that is not read. The first line of pixels is the lowest.
pub(super) fn read(bytes: &[u8], size: [u32; 2]) -> Result<ResidualGrid, String> {
    let (words, floats) = header(bytes)?;
    let [kind, width, height, scale] = words;
    if kind != "PF" {
        return Err("is no map of three floats: it does not begin with PF".to_owned());
    }
    let whole = |word: &str| word.parse::<u32>().ok();
    let found = [whole(width), whole(height)];
    if found != size.map(Some) {
        let [w, h] = size;
        return Err(format!(
            "is {width} x {height} pixels, and the panel {w} x {h}"
        ));
    }
    let scale: f64 = scale
        .parse()
        .ok()
        .filter(|it| *it != 0.0)
        .ok_or("has no scale")?;
    let [w, h] = size.map(|side| side as usize);
    if w < 2 || h < 2 {
        return Err("has fewer than 2 columns or rows".to_owned());
    }
    if floats.len() != w * h * 12 {
        return Err(format!("has {} bytes of {}", floats.len(), w * h * 12));
    }
    let float = |bytes: &[u8]| {
        let four = [bytes[0], bytes[1], bytes[2], bytes[3]];
        match scale < 0.0 {
            true => f32::from_le_bytes(four),
            false => f32::from_be_bytes(four),
        }
    };
    let mut residuals = Vec::with_capacity(w * h);
    for row in 0..h {
        let line = &floats[(h - 1 - row) * w * 12..][..w * 12];
        for (column, pixel) in line.chunks_exact(12).enumerate() {
            let share = [float(pixel), float(&pixel[4..])];
            if share.iter().any(|it| it.is_infinite() || it.abs() > 1e6) {
                return Err(format!("is infinite at column {column}, row {row}"));
            }
            let place = [column, row].map(|it| it as f64 + 0.5);
            residuals
                .push([0, 1].map(|k| (f64::from(share[k]) * f64::from(size[k]) - place[k]) as f32));
        }
    }
    Ok(ResidualGrid {
        nodes: [w, h],
        origin: [0.5; 2],
        step: [1.0; 2],
        residuals,
    })
}

/// The four words before the floats, and what follows the single white space after them.
fn header(bytes: &[u8]) -> Result<([&str; 4], &[u8]), String> {
    let cut = || "ends within its header".to_owned();
    let mut rest = bytes;
    let mut words = [""; 4];
    for word in &mut words {
        let start = rest.iter().position(|it| !it.is_ascii_whitespace());
        rest = &rest[start.ok_or_else(cut)?..];
        let end = rest.iter().take(32).position(u8::is_ascii_whitespace);
        let end = end.ok_or_else(cut)?;
        *word = std::str::from_utf8(&rest[..end]).map_err(|_| "is no such map".to_owned())?;
        rest = &rest[end..];
    }
    Ok((words, &rest[1..]))
}
