//! A button's downs and ups → presses, short and long, never two at once.

use std::time::Duration;

use super::edge::Change;
use crate::flow::booth::Press;

/// How long things take at a button.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Times {
    /// So long after a press nothing is another: people press twice when nothing seems to happen.
    pub lock_out: Duration,
    /// A button that is held for so long is pressed long.
    pub long_press: Duration,
}

/// A button.
#[derive(Debug, Clone)]
pub struct Button {
    times: Times,
    /// Since when it is down; none where this down is no press, or has been one already.
    down_since: Option<Duration>,
    locked_until: Duration,
}

impl Button {
    /// A button that is up.
    pub fn new(times: Times) -> Button {
        Button { times, down_since: None, locked_until: Duration::ZERO }
    }

    /// Takes in what the button's contact has done.
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

    /// A long press is one as soon as it is long enough: who holds the button sees the light change.
    pub fn tick(&mut self, now: Duration) -> Option<Press> {
        self.due().filter(|due| now >= *due)?;
        self.down_since = None;
        self.press(Press::Long, now)
    }

    /// Takes a press that the button itself has told.
    pub fn press(&mut self, press: Press, now: Duration) -> Option<Press> {
        if now < self.locked_until {
            return None;
        }
        self.locked_until = now + self.times.lock_out;
        Some(press)
    }

    /// When a button that is held has been held for long.
    pub fn due(&self) -> Option<Duration> {
        self.down_since.map(|since| since + self.times.long_press)
    }

    /// Whatever is down now is no press; the lock-out stays.
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
        Button::new(Times { lock_out: ms(1000), long_press: ms(3000) })
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
        // Nobody looked in between.
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
        // A button that goes down within it has not been pressed, however long it is held.
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
