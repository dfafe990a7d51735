//! What the integration tests share.

pub mod metric;
pub mod test_leg;
