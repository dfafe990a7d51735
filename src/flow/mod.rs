//! The station's decisions as functions of state and `now`: when a file has settled, whose scan it
//! is, which steps a scan and its deliveries may take, when to try again, what folders are called.
//!
//! Nothing here touches a file, a clock or a random source: looks, times and chances come in.

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod account;
pub mod acquired;
pub mod backoff;
pub mod booth;
pub mod capture;
pub mod check_digit;
pub mod companions;
pub mod confinement;
pub mod decision;
pub mod explain;
pub mod facts;
pub mod file_system;
pub mod health;
pub mod identity;
pub mod lifecycle;
pub mod light;
pub mod mask;
pub mod mount;
pub mod name_check;
pub mod naming;
pub mod order_habit;
pub mod order_news;
pub mod orders_when;
pub mod outbox;
pub mod page;
pub mod retention;
pub mod scan_id;
pub mod settle;
pub mod space;
pub mod stamp;
pub mod trigger;
pub mod trusted_time;
pub mod writing;

pub use companions::{Companion, DoneFile, Group};
pub use facts::Facts;
pub use file_system::FileSystem;
pub use identity::{Identity, NameSays, Verdict, Whose};
pub use lifecycle::{DeliveryState, DeliveryStep, IllegalStep, ScanState, ScanStep};
pub use mask::Mask;
pub use order_news::{News, OrderState};
pub use orders_when::OrdersWhen;
pub use outbox::Outbox;
pub use scan_id::ScanId;
pub use settle::{Look, LookTime, Settled, Settling};
pub use space::Space;
pub use stamp::Stamp;
pub use writing::{Appeared, Mark, Writing};
