//! A button's downs and ups → presses, short and long, never two at once.

use std::time::Duration;

use super::debounce::Change;
use crate::booth::Press;

/// A button that is held this long is a long press. Nobody holds a button this long by mistake.
const LONG_PRESS: Duration = Duration::from_secs(3);

#[derive(Debug, Clone)]
pub(super) struct Button {
    /// How long after a press no other press counts: people press twice when nothing seems to happen.
    lock_out: Duration,
    /// Since when it is down; `None` if this is not a press, or has already been counted as one.
    down_since: Option<Duration>,
    locked_until: Duration,
}

impl Button {
    /// A button that is up.
    pub fn new(lock_out: Duration) -> Button {
        Button { lock_out, down_since: None, locked_until: Duration::ZERO }
    }

    /// Processes a change of the button's contact.
    pub fn change(&mut self, change: Change, now: Duration) -> Option<Press> {
        match change {
            Change::Down => {
                self.down_since = (now >= self.locked_until).then_some(now);
                None
            }
            Change::Up => {
                let long = self.tick(now);
                let short = self.down_since.take().map(|_| Press::Short);
                long.or_else(|| short.and_then(|press| self.press(press, now)))
            }
        }
    }

    /// A long press counts as soon as it is long enough: the person who holds the button sees the light
    /// change.
    pub fn tick(&mut self, now: Duration) -> Option<Press> {
        self.due().filter(|due| now >= *due)?;
        self.down_since = None;
        self.press(Press::Long, now)
    }

    /// Processes a press that the button itself has reported.
    pub fn press(&mut self, press: Press, now: Duration) -> Option<Press> {
        if now < self.locked_until {
            return None;
        }
        self.locked_until = now + self.lock_out;
        Some(press)
    }

    /// When a held button becomes a long press.
    pub fn due(&self) -> Option<Duration> {
        self.down_since.map(|since| since + LONG_PRESS)
    }

    /// Whatever is down now does not count as a press; the lock-out stays.
    pub fn let_go(&mut self) {
        self.down_since = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(time: u64) -> Duration {
        Duration::from_millis(time)
    }

    fn button() -> Button {
        Button::new(ms(1000))
    }

    #[test]
    fn a_button_is_pressed_when_it_is_let_go() {
        let mut button = button();
        assert_eq!(button.change(Change::Down, ms(10)), None);
        assert_eq!(button.tick(ms(500)), None);
        assert_eq!(button.change(Change::Up, ms(600)), Some(Press::Short));
    }

    #[test]
    fn a_button_that_is_held_is_pressed_long_and_not_again_when_it_is_let_go() {
        let mut held = button();
        held.change(Change::Down, ms(10));
        assert_eq!(held.due(), Some(ms(3010)));
        assert_eq!((held.tick(ms(3009)), held.tick(ms(3010))), (None, Some(Press::Long)));
        assert_eq!((held.tick(ms(9999)), held.change(Change::Up, ms(9999))), (None, None));
        // There was no tick in between.
        let mut late = button();
        late.change(Change::Down, ms(10));
        assert_eq!(late.change(Change::Up, ms(3010)), Some(Press::Long));
    }

    #[test]
    fn presses_within_the_lock_out_are_one() {
        let mut pressed = button();
        assert_eq!(pressed.press(Press::Short, ms(0)), Some(Press::Short));
        let again: Vec<u64> =
            (1..1500).filter(|at| pressed.press(Press::Short, ms(*at)).is_some()).collect();
        assert_eq!(again, [1000]);
        // A button that goes down within the lock-out is not pressed, however long it is held.
        pressed.change(Change::Down, ms(1999));
        assert_eq!((pressed.due(), pressed.change(Change::Up, ms(9000))), (None, None));
    }

    #[test]
    fn a_button_that_is_up_when_it_should_go_up_is_not_pressed() {
        assert_eq!(button().change(Change::Up, ms(10)), None);
        let mut button = button();
        button.change(Change::Down, ms(10));
        button.let_go();
        assert_eq!(button.change(Change::Up, ms(100)), None);
    }
}
