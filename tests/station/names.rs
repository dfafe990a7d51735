//! Whose a scan is: what people say, what names in files show, what must never happen.

mod by_hand;
mod listed;
mod planted;
mod right_patient;
mod unheard;
