//! Where in a window does each panel of a rig lie, and what does it show there?

use crate::commands::panels::warp::sent::SentLayout;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::head_pose::HeadPose;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::navigation::Shown;
use foveal_core::view::panel::rig::{Panel, Scanout};
use glam::DVec3;

/// The panels of a rig, side by side as they are sent.
pub(crate) struct RigPanes {
    panes: Vec<RigPane>,
    mounted: Vec<MountedPanel>,
    atlas: [u32; 2],
    /// Whether they turn with the head: flat content stays before it.
    turns: bool,
}

/// Where a panel's picture is sent.
struct RigPane {
    scanout: Scanout,
    origin: [u32; 2],
    size: [u32; 2],
}

/// What is drawn at a place of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PanePart {
    pub(crate) view: EyeView,
    /// Left and top in the window.
    pub(crate) origin: [u32; 2],
    /// Whether left is right, and up is down, of what is drawn.
    pub(crate) flips: [bool; 2],
}

impl RigPanes {
    /// Panels as they are mounted for some content, before which they turn or do not.
    pub(crate) fn new(panels: &[Panel], mounted: Vec<MountedPanel>, turns: bool) -> Self {
        let all: Vec<&Panel> = panels.iter().collect();
        let origins = SentLayout::of(&all).origins;
        let panes: Vec<RigPane> = panels
            .iter()
            .zip(origins)
            .map(|(panel, origin)| RigPane {
                scanout: panel.scanout,
                origin,
                size: panel.sent_size(),
            })
            .collect();
        let end = |k: usize| panes.iter().map(move |pane| pane.origin[k] + pane.size[k]);
        Self {
            atlas: [0, 1].map(|k| end(k).max().unwrap_or(1)),
            panes,
            mounted,
            turns,
        }
    }

    /// Columns and rows of all of them together.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.atlas
    }

    /// The panels, for the session.
    pub(crate) fn mounted(&self) -> &[MountedPanel] {
        &self.mounted
    }

    /// Where the head of content is turned to, as far as the panels turn with it.
    pub(crate) fn head(&self, head: HeadPose) -> HeadPose {
        match self.turns {
            true => head,
            false => HeadPose::default(),
        }
    }

    /// What the panels of a head show that is here.
    pub(crate) fn views(&self, head: HeadPose, at: DVec3) -> Vec<EyeView> {
        MountedPanel::views_from(&self.mounted, &self.head(head), at)
    }

    /// What is drawn where in a window of so many pixels: pixel for pixel where all have room, else
    /// smaller.
    pub(crate) fn parts(&self, window: [u32; 2], head: HeadPose, at: DVec3) -> Vec<PanePart> {
        let views = self.views(head, at);
        let parts = self.panes.iter().zip(views);
        let part = |(pane, view): (&RigPane, EyeView)| {
            let (origin, size) = self.placed(pane, window);
            PanePart {
                view: EyeView {
                    size,
                    ..quarter_turned(&view, pane.scanout)
                },
                origin,
                flips: [
                    pane.scanout == Scanout::FlipX,
                    pane.scanout == Scanout::FlipY,
                ],
            }
        };
        parts.map(part).collect()
    }

    /// Left and top, and columns and rows, of a pane in a window.
    fn placed(&self, pane: &RigPane, window: [u32; 2]) -> ([u32; 2], [u32; 2]) {
        let fits = [0, 1].map(|k| f64::from(window[k]) / f64::from(self.atlas[k]));
        let scale = fits[0].min(fits[1]).min(1.0);
        let edge = |k: usize, pixel: u32| {
            let whole = (f64::from(self.atlas[k]) * scale).round() as u32;
            let beside = window[k].saturating_sub(whole) / 2;
            beside + (f64::from(pixel) * scale).round() as u32
        };
        let first = [0, 1].map(|k| edge(k, pane.origin[k]));
        let end = [0, 1].map(|k| edge(k, pane.origin[k] + pane.size[k]));
        (first, [0, 1].map(|k| (end[k] - first[k]).max(1)))
    }
}

impl PanePart {
    /// What a window shows round a place, by the part that it lies in or is nearest to.
    pub(crate) fn shown_at(parts: &[Self], place: [f64; 2]) -> Option<Shown> {
        let away = |part: &&Self| {
            let off = [0, 1].map(|k| {
                let first = f64::from(part.origin[k]);
                let last = first + f64::from(part.view.size[k]);
                (first - place[k]).max(place[k] - last).max(0.0)
            });
            off[0].hypot(off[1])
        };
        let nearest = parts.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.map(|part| Shown {
            view: mirrored(&part.view, part.flips),
            origin: part.origin,
        })
    }
}

/// A view as it is seen in what is sent, but for mirrors.
fn quarter_turned(view: &EyeView, scanout: Scanout) -> EyeView {
    let Axes {
        right,
        down,
        forward,
    } = view.axes;
    let f = view.field;
    let (right, down, field) = match scanout {
        Scanout::Normal | Scanout::FlipX | Scanout::FlipY => return *view,
        Scanout::Rot90 => (-down, right, [f.down, f.up, f.left, f.right]),
        Scanout::Rot180 => (-right, -down, [f.right, f.left, f.down, f.up]),
        Scanout::Rot270 => (down, -right, [f.up, f.down, f.right, f.left]),
    };
    EyeView {
        axes: Axes {
            right,
            down,
            forward,
        },
        field: Field::of(field),
        size: scanout.sent_size(view.size),
        ..*view
    }
}

/// A view in a mirror that changes left for right, or up for down: for rays, not to be drawn.
fn mirrored(view: &EyeView, [x, y]: [bool; 2]) -> EyeView {
    let (f, axes) = (view.field, view.axes);
    let sign = |flips: bool| if flips { -1.0 } else { 1.0 };
    let pair = |flips: bool, pair: [f64; 2]| match flips {
        true => [pair[1], pair[0]],
        false => pair,
    };
    let [left, right] = pair(x, [f.left, f.right]);
    let [up, down] = pair(y, [f.up, f.down]);
    EyeView {
        axes: Axes {
            right: axes.right * sign(x),
            down: axes.down * sign(y),
            ..axes
        },
        field: Field::of([left, right, up, down]),
        ..*view
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::panel::rig::PanelOutput;
    use foveal_core::view::surface::Eye;

    fn panel(scanout: Scanout, x: u32) -> Panel {
        let view = EyeView {
            position: DVec3::ZERO,
            axes: Axes::from_yaw_pitch_roll(
                Default::default(),
                Default::default(),
                Default::default(),
            ),
            field: Field::of([0.5, 0.7, 0.2, 0.4]),
            size: [120, 60],
            eye: Eye::Left,
        };
        let output = PanelOutput {
            x,
            ..PanelOutput::default()
        };
        Panel {
            scanout,
            output,
            ..Panel::flat(&format!("at {x}"), view)
        }
    }

    #[test]
    fn what_is_sent_looks_where_the_display_turns_it_back_to() {
        for scanout in Scanout::ALL {
            let panel = panel(scanout, 0);
            let panes = RigPanes::new(
                std::slice::from_ref(&panel),
                vec![MountedPanel::of(&panel)],
                true,
            );
            let parts = panes.parts([300, 300], HeadPose::default(), DVec3::ZERO);
            let sent = panel.sent_size();
            assert_eq!(parts[0].view.size, sent);
            let seen_from_sent = scanout.seen_from_sent(panel.view.size);
            for place in [[3.5, 10.5], [40.0, 51.5]] {
                let in_window = [0, 1].map(|k| place[k] + f64::from(parts[0].origin[k]));
                let shown = PanePart::shown_at(&parts, in_window).unwrap();
                let ray = shown.view.ray(shown.in_picture(in_window)).normalize();
                let seen = seen_from_sent * DVec3::new(place[0], place[1], 1.0);
                let own = panel.view.ray([seen.x, seen.y]).normalize();
                assert!((ray - own).length() < 1e-12, "{scanout:?}");
            }
        }
    }

    #[test]
    fn panels_shrink_together_and_a_place_beside_them_belongs_to_the_nearest() {
        let panels = [panel(Scanout::Normal, 0), panel(Scanout::Rot180, 120)];
        let mounted = panels.iter().map(MountedPanel::of).collect();
        let panes = RigPanes::new(&panels, mounted, true);
        assert_eq!(panes.size(), [240, 60]);
        let parts = panes.parts([120, 100], HeadPose::default(), DVec3::ZERO);
        let rects = parts.iter().map(|part| (part.origin, part.view.size));
        let expected = [([0, 35], [60, 30]), ([60, 35], [60, 30])];
        assert_eq!(rects.collect::<Vec<_>>(), expected);
        let shown = PanePart::shown_at(&parts, [110.0, 5.0]).unwrap();
        assert_eq!(shown.origin, [60, 35]);
    }
}
