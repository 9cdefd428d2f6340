//! What is written over the picture, and until when?

use foveal_core::units::Seconds;

/// How long a message stays, in seconds.
const MESSAGE_S: f64 = 3.0;
/// What is said at the beginning, and for how many seconds.
const HINT: (&str, f64) = ("H: keys", 5.0);
/// How often figures are repainted, in seconds.
const FIGURES_S: f64 = 0.25;

/// A page of the overlay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Page {
    #[default]
    Nothing,
    Keys,
    Figures,
}

/// The page that is open, and a message.
#[derive(Debug, Default)]
pub(crate) struct Words {
    page: Page,
    message: Option<(String, f64)>,
    /// Until when the hint stays; nothing before the first picture.
    hint: Option<f64>,
    /// What was painted last, and when.
    painted: (Page, Option<String>),
    painted_at: f64,
}

impl Words {
    /// Shows a message for some seconds.
    pub(crate) fn say(&mut self, message: String, now: Seconds) {
        self.message = Some((message, now.0 + MESSAGE_S));
    }

    /// Goes on to the next page; who does so needs no hint.
    pub(crate) fn turn_the_page(&mut self) {
        self.hint = Some(f64::NEG_INFINITY);
        self.page = match self.page {
            Page::Nothing => Page::Keys,
            Page::Keys => Page::Figures,
            Page::Figures => Page::Nothing,
        };
    }

    /// Figures, or nothing.
    pub(crate) fn toggle_figures(&mut self) {
        self.page = match self.page {
            Page::Figures => Page::Nothing,
            Page::Keys | Page::Nothing => Page::Figures,
        };
    }

    /// What is to be seen at `now`.
    fn seen(&self, now: Seconds) -> (Page, Option<String>) {
        let message = self.message.as_ref().filter(|(_, until)| now.0 < *until);
        let hint = self.hint.is_some_and(|until| now.0 < until);
        let hint = hint.then(|| HINT.0.to_owned());
        let message = message.map(|(message, _)| message.clone());
        (self.page, message.or(hint))
    }

    /// What to paint at `now`, with a picture.
    pub(crate) fn paint(&mut self, now: Seconds) -> (Page, Option<String>) {
        self.hint.get_or_insert(now.0 + HINT.1);
        self.painted = self.seen(now);
        self.painted_at = now.0;
        self.painted.clone()
    }

    /// Whether something else is to be seen than what was painted.
    pub(crate) fn are_stale(&self, now: Seconds, is_moving: bool) -> bool {
        let figures_are = self.page == Page::Figures && now.0 - self.painted_at >= FIGURES_S;
        let others_are = self.hint.is_some() && self.seen(now) != self.painted;
        is_moving && figures_are || others_are
    }

    /// When to look again whether they are, after `now`.
    pub(crate) fn due(&self, now: Seconds, is_moving: bool) -> impl Iterator<Item = f64> {
        let message = self.message.as_ref().map(|(_, until)| *until);
        let figures = is_moving && self.page == Page::Figures;
        let figures = figures.then_some(self.painted_at + FIGURES_S);
        let times = [message, self.hint].into_iter().flatten();
        times.filter(move |time| *time > now.0).chain(figures)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(words: &mut Words, now: f64) -> Option<String> {
        words.paint(Seconds(now)).1
    }

    #[test]
    fn for_five_seconds_from_the_first_picture_on_a_window_says_which_key_lists_the_keys() {
        let mut words = Words::default();
        // However long the first picture takes.
        assert!(!words.are_stale(Seconds(59.0), false));
        assert_eq!(message(&mut words, 60.0).as_deref(), Some("H: keys"));
        assert_eq!(words.due(Seconds(60.0), false).collect::<Vec<_>>(), [65.0]);
        assert!(!words.are_stale(Seconds(64.9), false));
        assert!(words.are_stale(Seconds(65.0), false));
        assert_eq!(message(&mut words, 65.0), None);
        assert_eq!(words.due(Seconds(65.0), false).count(), 0);
    }

    #[test]
    fn what_a_key_says_stands_before_the_hint() {
        let mut words = Words::default();
        assert_eq!(message(&mut words, 0.0).as_deref(), Some("H: keys"));
        words.say("policy acuity".to_owned(), Seconds(1.0));
        assert!(words.are_stale(Seconds(1.0), false));
        assert_eq!(message(&mut words, 1.0).as_deref(), Some("policy acuity"));
        assert_eq!(message(&mut words, 4.0).as_deref(), Some("H: keys"));
    }

    #[test]
    fn the_first_page_is_the_keys_the_second_the_figures_and_then_there_is_none() {
        let mut words = Words::default();
        words.paint(Seconds(0.0));
        for page in [Page::Keys, Page::Figures, Page::Nothing] {
            words.turn_the_page();
            assert!(words.are_stale(Seconds(0.1), false));
            assert_eq!(words.paint(Seconds(0.1)), (page, None));
        }
        words.turn_the_page();
        words.toggle_figures();
        assert_eq!(words.paint(Seconds(0.2)).0, Page::Figures);
        assert!(!words.are_stale(Seconds(9.0), false));
        assert!(words.are_stale(Seconds(9.0), true));
        words.toggle_figures();
        assert_eq!(words.paint(Seconds(0.3)).0, Page::Nothing);
    }
}
