//! What is written over the picture?

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, pos2, vec2};

const TEXT: Color32 = Color32::from_rgb(235, 235, 235);
const FAINT: Color32 = Color32::from_rgb(160, 165, 170);
const BACK: Color32 = Color32::from_black_alpha(190);
const SIZE: f32 = 12.0;
const LINE: f32 = 15.5;
const GAP: f32 = 10.0;
/// Less than half of a small window: the middle stays free.
const FIGURES_WIDTH: f32 = 290.0;

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
        let lines = figures
            .iter()
            .map(|(what, value)| (what.as_str(), value.as_str()));
        table(
            painter,
            whole.left_top() + vec2(GAP, GAP),
            85.0,
            FIGURES_WIDTH,
            lines,
        );
        let width = 190.0;
        let right = whole.right() - width - GAP;
        // A narrow window shows figures, not keys.
        if right > FIGURES_WIDTH + 3.0 * GAP {
            table(
                painter,
                pos2(right, whole.top() + GAP),
                75.0,
                width,
                keys.iter().copied(),
            );
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

fn table<'a>(
    painter: &Painter,
    at: Pos2,
    indent: f32,
    width: f32,
    lines: impl IntoIterator<Item = (&'a str, &'a str)>,
) {
    // What does not fit into the height is left out, what does not fit into the width cut off.
    let room = (painter.clip_rect().bottom() - at.y - 2.0 * GAP) / LINE;
    let lines: Vec<(&str, &str)> = lines.into_iter().take(room.max(0.0) as usize).collect();
    let height = LINE * lines.len() as f32 + GAP;
    let rect = Rect::from_min_size(at, vec2(width, height));
    painter.rect_filled(rect, 4.0, BACK);
    let painter = painter.with_clip_rect(rect);
    let font = FontId::proportional(SIZE);
    for (row, (what, value)) in lines.into_iter().enumerate() {
        let left = at + vec2(GAP, GAP / 2.0 + LINE * row as f32);
        painter.text(left, Align2::LEFT_TOP, what, font.clone(), FAINT);
        let value_at = left + vec2(indent, 0.0);
        painter.text(value_at, Align2::LEFT_TOP, value, font.clone(), TEXT);
    }
}
