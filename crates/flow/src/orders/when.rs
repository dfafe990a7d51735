//! When orders from practice software arrive, by the habit of the practice.

/// Whether an order arrives before the press of the button or after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OrdersWhen {
    /// Before it: an order names the patient of the next press.
    #[default]
    BeforePress,
    /// After it: an order names the patient of the press that is open.
    AfterPress,
}
