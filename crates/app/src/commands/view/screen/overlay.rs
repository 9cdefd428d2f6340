//! What is written over the picture?

use egui::{Align2, Color32, FontId, Galley, Painter, Pos2, Rect, Shape, pos2, vec2};
use std::sync::Arc;

const TEXT: Color32 = Color32::from_rgb(235, 235, 235);
const FAINT: Color32 = Color32::from_rgb(160, 165, 170);
const BACK: Color32 = Color32::from_black_alpha(190);
const SIZE: f32 = 12.0;
const LINE: f32 = 15.5;
const GAP: f32 = 10.0;
/// Figures change; what is behind them stays as wide as this, where they are not wider.
const FIGURES_WIDTH: f32 = 290.0;
/// From the name of a figure, or from a key, to what is said of it, where names are not longer.
const INDENT: f32 = 85.0;

/// One line: what it is, and its value.
pub(crate) type Line = (String, String);

/// One line: keys, and what they do.
pub(crate) type KeyLine = (&'static str, &'static str);

/// A page over the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum OverlayPage {
    Keys(Vec<KeyLine>),
    Figures(Vec<Line>),
}

/// Paints a page at the top left, and a message at the bottom.
pub(crate) fn paint(painter: &Painter, page: Option<&OverlayPage>, message: Option<&str>) {
    let whole = painter.clip_rect();
    let corner = whole.left_top() + vec2(GAP, GAP);
    match page {
        Some(OverlayPage::Keys(keys)) => {
            let keys = Table::new(painter, keys.iter().map(|(key, what)| [*key, *what]));
            let width = keys.width;
            keys.paint(painter, corner, width);
        }
        Some(OverlayPage::Figures(figures)) => {
            let figures = figures.iter().map(|(what, value)| [what.as_str(), value]);
            let figures = Table::new(painter, figures);
            let width = figures.width.max(FIGURES_WIDTH);
            figures.paint(painter, corner, width);
        }
        None => {}
    }
    if let Some(message) = message {
        let place = pos2(whole.center().x, whole.bottom() - 2.0 * GAP);
        let font = FontId::proportional(SIZE + 1.0);
        let back = painter.add(Shape::Noop);
        let rect = painter.text(place, Align2::CENTER_BOTTOM, message, font, TEXT);
        painter.set(back, Shape::rect_filled(rect.expand(6.0), 4.0, BACK));
    }
}

/// Lines of two columns, laid out.
struct Table {
    rows: Vec<[Arc<Galley>; 2]>,
    indent: f32,
    width: f32,
}

impl Table {
    fn new<'a>(painter: &Painter, lines: impl IntoIterator<Item = [&'a str; 2]>) -> Self {
        let font = FontId::proportional(SIZE);
        let laid =
            |text: &str, colour| painter.layout_no_wrap(text.to_owned(), font.clone(), colour);
        let row = |[what, value]: [&str; 2]| [laid(what, FAINT), laid(value, TEXT)];
        let rows: Vec<_> = lines.into_iter().map(row).collect();
        let widest = |k: usize| rows.iter().map(|row| row[k].size().x).fold(0.0, f32::max);
        let indent = INDENT.max(widest(0) + GAP);
        let width = indent + widest(1) + 2.0 * GAP;
        Self {
            rows,
            indent,
            width,
        }
    }

    /// What does not fit into the window's height is left out, what does not fit into its width is
    /// cut off.
    fn paint(self, painter: &Painter, at: Pos2, width: f32) {
        let room = (painter.clip_rect().bottom() - at.y - 2.0 * GAP) / LINE;
        let count = self.rows.len().min(room.max(0.0) as usize);
        let rect = Rect::from_min_size(at, vec2(width, LINE * count as f32 + GAP));
        painter.rect_filled(rect, 4.0, BACK);
        for (row, [what, value]) in self.rows.into_iter().take(count).enumerate() {
            let left = at + vec2(GAP, GAP / 2.0 + LINE * row as f32);
            painter.galley(left, what, FAINT);
            painter.galley(left + vec2(self.indent, 0.0), value, TEXT);
        }
    }
}
