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
/// From the name of a figure, and from a key, to what is said of it.
const INDENTS: [f32; 2] = [85.0, 75.0];

/// One line: what it is, and its value.
pub(crate) type Line = (String, String);

/// One line: keys, and what they do.
pub(crate) type Key = (&'static str, &'static str);

/// Paints figures at the left, keys at the right, and a message at the bottom.
pub(crate) fn paint(
    painter: &Painter,
    told: Option<&(Vec<Line>, Vec<Key>)>,
    message: Option<&str>,
) {
    let whole = painter.clip_rect();
    if let Some((figures, keys)) = told {
        let figures = figures.iter().map(|(what, value)| [what.as_str(), value]);
        let figures = Table::new(painter, INDENTS[0], figures);
        let keys = keys.iter().map(|(key, what)| [*key, *what]);
        let keys = Table::new(painter, INDENTS[1], keys);
        let width = figures.width.max(FIGURES_WIDTH);
        figures.paint(painter, whole.left_top() + vec2(GAP, GAP), width);
        let keys_width = keys.width;
        let right = whole.right() - keys_width - GAP;
        // A narrow window shows figures, not keys.
        if right > width + 3.0 * GAP {
            keys.paint(painter, pos2(right, whole.top() + GAP), keys_width);
        }
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
    fn new<'a>(
        painter: &Painter,
        indent: f32,
        lines: impl IntoIterator<Item = [&'a str; 2]>,
    ) -> Self {
        let font = FontId::proportional(SIZE);
        let laid =
            |text: &str, colour| painter.layout_no_wrap(text.to_owned(), font.clone(), colour);
        let row = |[what, value]: [&str; 2]| [laid(what, FAINT), laid(value, TEXT)];
        let rows: Vec<_> = lines.into_iter().map(row).collect();
        let values = rows.iter().map(|[_, value]| value.size().x);
        let width = indent + values.fold(0.0, f32::max) + 2.0 * GAP;
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
