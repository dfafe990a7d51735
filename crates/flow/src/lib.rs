//! State and `now` → decisions.
//!
#![doc = include_str!("../README.md")]

pub mod account;
pub mod acquired;
pub mod backoff;
pub mod booth;
pub mod cause;
pub mod complaint;
pub mod confinement;
pub mod decision;
pub mod disposition;
pub mod explain;
pub mod export;
pub mod facts;
pub mod health;
pub mod lifecycle;
pub mod light;
pub mod orders;
pub mod outbox;
pub mod page;
pub mod patient;
pub mod phantom;
pub mod retention;
pub mod round;
pub mod settle;
pub mod trigger;
pub mod views;
pub mod words;
pub mod worklist;

pub use disposition::{Disposition, Task};
pub use export::companions::{Companion, DoneFile, Group};
pub use export::file_system::FileSystem;
pub use export::mask::Mask;
pub use export::space::Space;
pub use export::stamp::Stamp;
pub use export::writing::{Appeared, Fingerprint, Writing};
pub use facts::Facts;
pub use gaiter_record::ScanId;
pub use lifecycle::{Closed, DeliveryState, DeliveryStep, IllegalStep, ScanState, ScanStep};
pub use orders::{News, OrderState, OrdersWhen};
pub use outbox::Outbox;
pub use patient::identity::{Identity, StatedPatient, Verdict, Whose};
pub use settle::{Look, LookTime, Settled, Settling};
