//! Orders from practice software: which are new, and when they arrive.

pub mod habit;
pub mod news;

/// Whether an order arrives before the press of the button or after it, by the habit of the practice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OrdersWhen {
    /// Before it: an order names the patient of the next press.
    #[default]
    BeforePress,
    /// After it: an order names the patient of the press that is open.
    AfterPress,
}
