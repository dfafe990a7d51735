//! What the integration tests share.

pub mod chance;
pub mod cloud;
pub mod metric;
pub mod test_leg;
