//! The habits of a practice.

use std::rc::Rc;

use gaiter_flow::OrdersWhen;
use gaiter_flow::patient::check_digit::CheckDigit;
use gaiter_flow::patient::identity::Identity;
use gaiter_flow::round::Rules;
use regex::Regex;

use super::booth::{LATE, NAME_LASTS, Setup, WINDOW};
use super::laws::Off;

/// How patients are named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Naming {
    /// By orders of the practice software.
    Order,
    /// By card at the booth.
    Card,
    /// From the worklist: by a tap on the page, or by a code that is read.
    Worklist,
    /// By the name of the export.
    FileName,
    /// Not at all.
    Nobody,
}

#[derive(Debug, Clone)]
pub struct Habits {
    pub naming: Naming,
    pub button: bool,
    /// Every export has the same name.
    pub one_name: bool,
    /// Exports are written under a temporary name and renamed.
    pub temporary: bool,
    /// An export is written for a minute.
    pub slow: bool,
    /// Every scan is exported twice, with another comment.
    pub two_exports: bool,
    /// 4 % of the scans are refused.
    pub refused: bool,
    /// 30 % of the orders are sent when the patient before has been scanned.
    pub early: bool,
    /// 2 % of the patients who are ordered never come.
    pub no_shows: bool,
    /// Who answers the light gives up what waits before naming who is there.
    pub gives_up: bool,
    /// Orders come some seconds after the press.
    pub after_press: bool,
    pub identity: Rc<Identity>,
}

impl Habits {
    pub fn new(naming: Naming, button: bool) -> Habits {
        let name = Some(Regex::new("^(?<patient>[0-9]+)_").unwrap());
        let pattern = Regex::new("[0-9]+").unwrap();
        let identity = Identity::new(name, None, &pattern, CheckDigit::None).unwrap();
        Habits {
            naming,
            button,
            one_name: false,
            temporary: false,
            slow: false,
            two_exports: false,
            refused: false,
            early: false,
            no_shows: false,
            gives_up: false,
            after_press: false,
            identity: Rc::new(identity),
        }
    }

    pub fn setup(&self) -> Setup {
        let rules = Rules {
            by_press: self.button,
            window: WINDOW,
            late: LATE,
            name_lasts: NAME_LASTS,
            orders: match self.after_press {
                true => OrdersWhen::AfterPress,
                false => OrdersWhen::BeforePress,
            },
        };
        Setup {
            rules,
            hints: true,
            identity: Rc::clone(&self.identity),
            has_measures: false,
            hold_unpressed: false,
            off: Off::Nothing,
        }
    }
}
