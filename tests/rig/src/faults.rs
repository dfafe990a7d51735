//! Disks, shares and processes that fail where a test wants them to.

pub mod disk;
pub mod matrix;
pub mod mock_port;
pub mod player;
pub mod share;
pub mod tracer;
