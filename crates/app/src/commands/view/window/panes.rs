//! Where in a window does each panel of a rig lie, and what does it show there?

use crate::commands::panels::warp::sent::SentLayout;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::head_pose::HeadPose;
use foveal_core::view::mounted::MountedPanel;
use foveal_core::view::navigation::Shown;
use foveal_core::view::panel::distortion::GREEN;
use foveal_core::view::panel::rig::{Panel, Scanout};
use glam::DVec3;
use std::cell::RefCell;
use std::rc::Rc;

/// The panels of a rig, side by side as they are sent.
pub(crate) struct RigPanes {
    panels: Vec<Panel>,
    /// First column and row of each as it is sent.
    origins: Vec<[u32; 2]>,
    mounted: Vec<MountedPanel>,
    atlas: [u32; 2],
    /// Whether they turn with the head: flat content stays before it.
    turns: bool,
    /// In the window that was asked for last.
    in_window: RefCell<Option<Rc<WindowPanes>>>,
}

/// The panels with the pixels that a window has for them.
struct WindowPanes {
    window: [u32; 2],
    panels: Vec<Panel>,
    /// All that each can show.
    reaching: Vec<MountedPanel>,
    /// Each as if nothing bent it.
    flat: Vec<MountedPanel>,
    /// Left and top of each.
    origins: Vec<[u32; 2]>,
}

/// What is drawn at a place of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PanePart {
    /// What is drawn.
    pub(crate) view: EyeView,
    /// Left and top in the window.
    pub(crate) origin: [u32; 2],
    /// Columns and rows there: of the view, but where optics are between.
    pub(crate) size: [u32; 2],
    /// Whether left is right, and up is down, of what is drawn.
    pub(crate) flips: [bool; 2],
}

impl RigPanes {
    /// Panels as they are mounted for some content, before which they turn or do not.
    pub(crate) fn new(panels: &[Panel], mounted: Vec<MountedPanel>, turns: bool) -> Self {
        let all: Vec<&Panel> = panels.iter().collect();
        let origins = SentLayout::of(&all).origins;
        let end = |k: usize| {
            let sent = panels.iter().zip(&origins);
            sent.map(move |(panel, origin)| origin[k] + panel.sent_size()[k])
        };
        Self {
            atlas: [0, 1].map(|k| end(k).max().unwrap_or(1)),
            panels: panels.to_vec(),
            origins,
            mounted,
            turns,
            in_window: RefCell::default(),
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

    /// The panels with the pixels that a window of so many has for them.
    pub(crate) fn panels_in(&self, window: [u32; 2]) -> Vec<Panel> {
        self.in_window(window).panels.clone()
    }

    /// What is drawn where in a window of so many pixels: pixel for pixel where all have room, else
    /// smaller.
    pub(crate) fn parts(&self, window: [u32; 2], head: HeadPose, at: DVec3) -> Vec<PanePart> {
        let panes = self.in_window(window);
        let views = MountedPanel::views_from(&panes.reaching, &self.head(head), at);
        let parts = panes.panels.iter().zip(&panes.origins).zip(views);
        let part = |((panel, origin), view): ((&Panel, &[u32; 2]), EyeView)| {
            // What bends or dims a panel turns its picture, too.
            let (view, flips) = match panel.is_plain() {
                true => (quarter_turned(&view, panel.scanout), flips_of(panel)),
                false => (view, [false; 2]),
            };
            PanePart {
                view,
                origin: *origin,
                size: panel.sent_size(),
                flips,
            }
        };
        parts.map(part).collect()
    }

    /// What such a window shows round a place, by the panel that it lies in or is nearest to:
    /// along the ray of that place through its optics.
    pub(crate) fn shown_at(
        &self,
        (window, place): ([u32; 2], [f64; 2]),
        head: HeadPose,
        at: DVec3,
    ) -> Option<Shown> {
        let panes = self.in_window(window);
        let away = |number: &usize| {
            let (origin, size) = (panes.origins[*number], panes.panels[*number].sent_size());
            let off = [0, 1].map(|k| {
                let first = f64::from(origin[k]);
                let last = first + f64::from(size[k]);
                (first - place[k]).max(place[k] - last).max(0.0)
            });
            off[0].hypot(off[1])
        };
        let all = 0..panes.panels.len();
        let nearest = all.min_by(|a, b| away(a).total_cmp(&away(b)))?;
        let (panel, origin) = (&panes.panels[nearest], panes.origins[nearest]);
        let views = MountedPanel::views_from(&panes.flat, &self.head(head), at);
        let flat = quarter_turned(&views[nearest], panel.scanout);
        let flat = mirrored(&flat, flips_of(panel));
        let sent = [0, 1].map(|k| place[k] - f64::from(origin[k]));
        Some(Shown {
            view: moved(&flat, bent_by(panel, sent)),
            origin,
        })
    }

    fn in_window(&self, window: [u32; 2]) -> Rc<WindowPanes> {
        let mut known = self.in_window.borrow_mut();
        let made = match known.take().filter(|known| known.window == window) {
            Some(known) => known,
            None => Rc::new(self.fit(window)),
        };
        Rc::clone(known.insert(made))
    }

    fn fit(&self, window: [u32; 2]) -> WindowPanes {
        let places = self.panels.iter().zip(&self.origins);
        let places = places.map(|(panel, origin)| self.placed(panel, *origin, window));
        let (origins, sizes): (Vec<_>, Vec<_>) = places.unzip();
        let fitted = |(panel, sent): (&Panel, &[u32; 2])| {
            let size = panel.scanout.sent_size(*sent);
            match size == panel.view.size {
                true => panel.clone(),
                false => panel.resized(size),
            }
        };
        let panels: Vec<Panel> = self.panels.iter().zip(&sizes).map(fitted).collect();
        let mounted = |view: &dyn Fn(&Panel) -> EyeView| {
            let all = panels.iter().zip(&self.mounted);
            let one = |(panel, mounted): (&Panel, &MountedPanel)| MountedPanel {
                position: mounted.position,
                ..MountedPanel::new(&panel.id, &view(panel))
            };
            all.map(one).collect()
        };
        WindowPanes {
            window,
            reaching: mounted(&Panel::reach),
            flat: mounted(&|panel| panel.view),
            panels,
            origins,
        }
    }

    /// Left and top, and columns and rows, of a panel in a window.
    fn placed(&self, panel: &Panel, own: [u32; 2], window: [u32; 2]) -> ([u32; 2], [u32; 2]) {
        let fits = [0, 1].map(|k| f64::from(window[k]) / f64::from(self.atlas[k]));
        let scale = fits[0].min(fits[1]).min(1.0);
        let edge = |k: usize, pixel: u32| {
            let whole = (f64::from(self.atlas[k]) * scale).round() as u32;
            let beside = window[k].saturating_sub(whole) / 2;
            beside + (f64::from(pixel) * scale).round() as u32
        };
        let first = [0, 1].map(|k| edge(k, own[k]));
        let end = [0, 1].map(|k| edge(k, own[k] + panel.sent_size()[k]));
        (first, [0, 1].map(|k| (end[k] - first[k]).max(1)))
    }
}

/// Whether left is right, and up is down, of a panel as it is sent.
fn flips_of(panel: &Panel) -> [bool; 2] {
    [Scanout::FlipX, Scanout::FlipY].map(|flip| panel.scanout == flip)
}

/// Pixels as sent by which a place as sent looks past a flat panel.
fn bent_by(panel: &Panel, sent: [f64; 2]) -> [f64; 2] {
    let seen_from_sent = panel.scanout.seen_from_sent(panel.view.size);
    let seen = seen_from_sent * DVec3::new(sent[0], sent[1], 1.0);
    let ideal = panel.distortion.ideal(&panel.view, [seen.x, seen.y], GREEN);
    let Some(ideal) = ideal else {
        return [0.0; 2];
    };
    let moved = DVec3::new(ideal.place[0] - seen.x, ideal.place[1] - seen.y, 0.0);
    let moved = seen_from_sent.inverse() * moved;
    [moved.x, moved.y]
}

/// A view of which every place shows what lies so many pixels away.
fn moved(view: &EyeView, [x, y]: [f64; 2]) -> EyeView {
    let f = view.field;
    let x = x * (f.left + f.right) / f64::from(view.size[0]);
    let y = y * (f.up + f.down) / f64::from(view.size[1]);
    EyeView {
        field: Field::of([f.left - x, f.right + x, f.up - y, f.down + y]),
        ..*view
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
    use foveal_core::view::panel::distortion::Distortion;
    use foveal_core::view::panel::lens::Bulge;
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
            let flat = panel(scanout, 0);
            let bent = Panel {
                distortion: Distortion::Bulge(Bulge { height: 0.2 }),
                ..flat.clone()
            };
            for panel in [flat, bent] {
                let mounted = vec![MountedPanel::of(&panel)];
                let panes = RigPanes::new(std::slice::from_ref(&panel), mounted, true);
                let (window, head) = ([300, 300], HeadPose::default());
                let part = panes.parts(window, head, DVec3::ZERO)[0];
                let sent = panel.sent_size();
                assert_eq!(part.size, sent);
                assert!(!panel.is_plain() || part.view.size == sent);
                let seen_from_sent = scanout.seen_from_sent(panel.view.size);
                for place in [[3.5, 10.5], [40.0, 51.5]] {
                    let in_window = [0, 1].map(|k| place[k] + f64::from(part.origin[k]));
                    let shown = panes.shown_at((window, in_window), head, DVec3::ZERO);
                    let shown = shown.unwrap();
                    let ray = shown.view.ray(shown.in_picture(in_window)).normalize();
                    let seen = seen_from_sent * DVec3::new(place[0], place[1], 1.0);
                    let own = panel.ray_at([seen.x, seen.y], GREEN).unwrap().ray;
                    assert!((ray - own.normalize()).length() < 1e-12, "{scanout:?}");
                }
            }
        }
    }

    #[test]
    fn panels_shrink_together_and_a_place_beside_them_belongs_to_the_nearest() {
        let panels = [panel(Scanout::Normal, 0), panel(Scanout::Rot180, 120)];
        let mounted = panels.iter().map(MountedPanel::of).collect();
        let panes = RigPanes::new(&panels, mounted, true);
        assert_eq!(panes.size(), [240, 60]);
        let (window, head) = ([120, 100], HeadPose::default());
        let parts = panes.parts(window, head, DVec3::ZERO);
        let rects = parts.iter().map(|part| (part.origin, part.view.size));
        let expected = [([0, 35], [60, 30]), ([60, 35], [60, 30])];
        assert_eq!(rects.collect::<Vec<_>>(), expected);
        let shown = panes.shown_at((window, [110.0, 5.0]), head, DVec3::ZERO);
        assert_eq!(shown.unwrap().origin, [60, 35]);
    }
}
